//! Tests of results that cannot be made, in every lab and for every reason: no other result is
//! shown.

use crate::List;
use crate::fixtures::*;
use crate::{NumberTable, ReportFacts, report};
use segue_formats::bvh;
use segue_motion::clip::Clip;

fn set(session: &mut Session, values: &[(Key, Value)]) {
    session.apply(Command::Set(values.to_vec())).unwrap();
    settle(session);
}

fn bytes_of(clip: &Clip) -> Arc<[u8]> {
    bvh::write(clip, &bvh::WriteOptions::default()).into_bytes().into()
}

/// Returns the first frames of the built-in walk, as a file.
fn first_frames(frames: usize) -> Arc<[u8]> {
    let walk = opened("lab=view&a=walk");
    bytes_of(&walk.main_outcome().unwrap().motion.clip().crop(0..frames).unwrap())
}

/// A motion that has nothing in common with a person: no part of its body is known.
const SNAKE: &[u8] = b"HIERARCHY
ROOT seg_1
{
  OFFSET 0 0 0
  CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
  JOINT seg_2
  {
    OFFSET 0 0 0.3
    CHANNELS 3 Zrotation Xrotation Yrotation
    End Site
    {
      OFFSET 0 0 0.3
    }
  }
}
MOTION
Frames: 4
Frame Time: 0.0333333
0 0 0 0 0 0 0 0 0
0 0 1 0 5 0 0 5 0
0 0 2 0 9 0 0 9 0
0 0 3 0 5 0 0 5 0
";

/// A clip of the test's own library: a file, or the name of a missing one.
#[derive(Clone, Copy, PartialEq)]
enum Clips {
    OneFrame,
    Short,
    Empty,
    Snake,
    Missing,
    BuiltIn(&'static str),
}

impl Clips {
    /// Adds the clip to the library, and to no slot; returns its id.
    fn id(self, session: &mut Session) -> String {
        let (name, bytes) = match self {
            Self::Missing => return "nobody".to_owned(),
            Self::BuiltIn(id) => return id.to_owned(),
            Self::OneFrame => ("one_frame.bvh", first_frames(1)),
            Self::Short => ("short.bvh", first_frames(8)),
            Self::Empty => {
                let text = String::from_utf8(first_frames(1).to_vec()).unwrap();
                let end = text.find("Frame Time").unwrap();
                let text = format!(
                    "{}Frame Time: 0.0166667\n",
                    text[..end].replace("Frames: 1", "Frames: 0")
                );
                ("empty.bvh", text.into_bytes().into())
            }
            Self::Snake => ("snake.bvh", SNAKE.into()),
        };
        let mut other = Session::new();
        let id = other.load(name, bytes).unwrap().ids.remove(0);
        session.document.library.put_shared(Arc::clone(other.library().find(&id).unwrap()));
        id
    }

    fn is_here(self) -> bool {
        self != Self::Missing
    }
}

/// A change that makes a good state a bad one.
enum Change {
    A(Clips),
    B(Clips),
    Both(Clips),
    Clips(Clips),
    Set(Key, Value),
}

const GRAPH: &str = "lab=graph&clips=walk,walk_left,walk_right&walk_seconds=20";
const MATCH: &str =
    "lab=match&mirrored=off&match_clips=idle,walk,walk_left,walk_right,walk(make_seconds:6)";
const REPLAY: &str = "lab=match&mirrored=off&match_clips=idle,walk,walk_left,walk_right,walk(make_seconds:6)&scenario=straight";

/// Returns the refusals of every lab: a link, a change, and a part of the message.
fn refusals() -> Vec<(&'static str, Change, &'static str)> {
    use Change::{A, B, Both, Set};
    use Clips::{BuiltIn, Empty, Missing, OneFrame, Short, Snake};
    let pins = List::Pins(vec![(9999, 3)]).into();
    let also = List::WeightedClips(vec![("nobody".into(), 0.3)]).into();
    vec![
        ("lab=view", A(Missing), "not here"),
        ("lab=view&foot_lock=on", A(Missing), "not here"),
        ("lab=blend", A(Missing), "not here"),
        ("lab=blend", B(Missing), "not here"),
        ("lab=blend", B(Empty), "frames"),
        ("lab=blend", B(Snake), "in common"),
        ("lab=transition", A(Missing), "not here"),
        ("lab=transition", A(Empty), "frames"),
        ("lab=transition", B(Snake), "in common"),
        ("lab=speed", A(BuiltIn("idle")), "cycle"),
        ("lab=speed", B(BuiltIn("walk")), "differ"),
        ("lab=speed", A(OneFrame), "cycle"),
        ("lab=speed", B(Short), "cycle"),
        ("lab=speed", Both(Missing), "not here"),
        ("lab=speed", B(Snake), "in common"),
        ("lab=loop", A(OneFrame), ""),
        ("lab=loop", A(Short), ""),
        ("lab=loop", A(Missing), "not here"),
        ("lab=loop&loop_to=1.5", Set(Key::LoopFrom, Value::Number(1.5)), "cycle"),
        ("lab=layers", A(Missing), "not here"),
        ("lab=layers", B(Empty), ""),
        ("lab=layers", B(Snake), "in common"),
        ("lab=register", B(OneFrame), "shorter than the window"),
        ("lab=register", A(Short), ""),
        ("lab=register", B(Missing), "not here"),
        ("lab=register", B(Snake), "in common"),
        ("lab=register", Set(Key::Pins, pins), "beyond"),
        ("lab=register", Set(Key::WarpAlso, also), "not here"),
        (
            "lab=register&warp_mode=join&warp_to=1",
            Set(Key::WarpFrom, Value::Number(1.0)),
            "move its end",
        ),
        ("lab=path", A(BuiltIn("idle")), "stays within"),
        ("lab=path", A(OneFrame), ""),
        ("lab=path", A(Missing), "not here"),
        (GRAPH, Change::Clips(Short), ""),
        (GRAPH, Change::Clips(Missing), "not here"),
        (GRAPH, Change::Clips(Snake), "in common"),
        (GRAPH, Set(Key::GoTo, List::Visits(vec![(6.0, 9)]).into()), "no clip 9"),
        (GRAPH, Set(Key::Clips, List::ClipIds(Vec::new()).into()), "add at least one"),
        (MATCH, Change::Clips(OneFrame), ""),
        (MATCH, Change::Clips(Missing), "not here"),
        (MATCH, Set(Key::AheadFar, Value::Number(0.3)), "must rise"),
        (REPLAY, Change::Clips(OneFrame), ""),
        (REPLAY, Change::Clips(Missing), "not here"),
        (REPLAY, Set(Key::AskTag, Value::Text("tired".into())), "tired"),
    ]
}

/// Changes a session; returns the slots whose clips are on its stage from then on.
fn change(session: &mut Session, change: &Change) -> Vec<Slot> {
    let lab = session.params().lab().word().to_owned();
    let (mut is_here, mut values) = ([true; 2], Vec::new());
    let put = |session: &mut Session, key: Key, clips: Clips| (key, Value::Text(clips.id(session)));
    match change {
        Change::A(clips) => {
            is_here[0] = clips.is_here();
            values.push(put(session, Key::A, *clips));
        }
        Change::B(clips) => {
            is_here[1] = clips.is_here();
            values.push(put(session, Key::B, *clips));
        }
        Change::Both(clips) => {
            is_here = [clips.is_here(); 2];
            values.extend([Key::A, Key::B].map(|key| put(session, key, *clips)));
        }
        Change::Clips(clips) => {
            let key = if lab == "graph" { Key::Clips } else { Key::MatchClips };
            let mut ids = vec![clips.id(session)];
            if *clips == Clips::Snake && lab == "graph" {
                ids.insert(0, "walk".to_owned());
            }
            values.push((key, List::ClipIds(ids).into()));
        }
        Change::Set(key, value) => values.push((*key, value.clone())),
    }
    set(session, &values);
    let used = [Slot::A, Slot::B].into_iter().zip(is_here);
    used.filter(|(slot, is_here)| *is_here && session.uses(*slot)).map(|(slot, _)| slot).collect()
}

#[test]
fn result_that_cannot_be_made_is_replaced_by_no_other() {
    // All failures are reported together.
    let stale = refusals().into_iter().filter(|(link, bad, part)| {
        let checked = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
            assert_nothing_is_shown(link, bad, part);
        }));
        checked.is_err()
    });
    assert_eq!(stale.count(), 0);
}

fn assert_nothing_is_shown(link: &str, bad: &Change, part: &str) {
    let mut session = opened(link);
    assert!(session.panes()[0].result().is_ok(), "{link}: {:?}", session.panes()[0].problem);
    let stand_in = change(&mut session, bad);
    let state = session.query();
    let pane = &session.panes()[0];
    let problem = pane.problem.clone().unwrap_or_else(|| panic!("{state} was made"));
    assert!(problem.to_string().contains(part), "{state}: {problem}");
    assert!(session.jobs().is_empty(), "{state}");

    // Nothing of the earlier result is shown or passed on in any way.
    let refused = NoResult::Refused(problem.clone());
    assert_eq!(pane.result().err(), Some(refused.clone()), "{state}");
    assert!(
        pane.outcome.is_none() && pane.made_from().is_none() && pane.shown_at(0.5).is_none(),
        "{state}"
    );
    assert!(session.main_outcome().is_none() && !session.is_driven(), "{state}");
    assert!(NumberTable::of(&session).rows.is_empty(), "{state}");
    assert_eq!(report(&session, &ReportFacts::default()), Err(refused.clone()), "{state}");
    let clips: Vec<Slot> = pane.sources.iter().map(|source| source.slot).collect();
    assert_eq!(clips, stand_in, "{state}");
    assert!(
        session.graph_walk().is_none() && session.automatic_value(Key::LeaveA).is_none(),
        "{state}"
    );
    let kept = session.library().entries().len();
    for command in
        [Command::Keep(0), Command::ExtraCharacters(crate::ExtraCharacterCommand::AddResult(0))]
    {
        assert_eq!(session.apply(command), Err(CommandError::NoResult(refused.clone())), "{state}");
    }
    assert_eq!((session.library().entries().len(), session.query()), (kept, state.clone()));

    // Time changes nothing of that, and undo leads to the same result.
    session.tick(0.1);
    assert!(session.panes()[0].outcome.is_none() && session.params().is_on(Key::Play), "{state}");
    session.apply(Command::OpenLink(link.into())).unwrap();
    settle(&mut session);
    let motion =
        |session: &Session| Arc::clone(&session.panes()[0].result().unwrap().outcome.motion);
    if !session.is_driven() {
        assert_eq!(motion(&session).clip(), motion(&opened(link)).clip(), "{state}");
    }
    assert!(session.panes()[0].sources.is_empty(), "{state}");
}

#[test]
fn pane_that_cannot_be_made_leaves_the_others() {
    let session = opened("lab=view&compare=a:walk,nobody,run");
    let made: Vec<bool> = session.panes().iter().map(|pane| pane.result().is_ok()).collect();
    assert_eq!(made, [true, false, true]);
    let table = NumberTable::of(&session);
    assert!(!table.rows.is_empty() && table.rows.iter().all(|row| row.values[1].is_none()));
    let said = report(&session, &ReportFacts::default()).unwrap();
    assert!(said.contains("No result for nobody: `nobody` is not here"), "{said}");
}

#[test]
fn earlier_result_is_outdated_while_another_is_computed() {
    let mut session = opened("lab=graph&clips=walk,walk_left,walk_right&walk_seconds=20");
    let before = Arc::clone(session.main_outcome().unwrap());
    session.apply(Command::Set(vec![(Key::BlendWindow, Value::Number(25.0))])).unwrap();
    let pane = &session.panes()[0];
    assert!(Arc::ptr_eq(pane.outcome.as_ref().unwrap(), &before) && pane.is_outdated());
    assert_eq!(pane.made_from().unwrap().number(Key::BlendWindow), 30.0);
    assert_eq!(pane.result().err(), Some(NoResult::Awaited));
    assert_eq!(session.apply(Command::Keep(0)), Err(CommandError::NoResult(NoResult::Awaited)));
    assert_eq!(report(&session, &ReportFacts::default()), Err(NoResult::Awaited));
    assert!(NumberTable::of(&session).rows.is_empty());
    // Undone before it was made, the shown outcome is the result again.
    session.apply(Command::Set(vec![(Key::BlendWindow, Value::Number(30.0))])).unwrap();
    assert!(session.panes()[0].result().is_ok_and(|made| Arc::ptr_eq(made.outcome, &before)));
    set(&mut session, &[(Key::BlendWindow, Value::Number(25.0))]);
    let pane = &session.panes()[0];
    assert!(!pane.is_outdated() && pane.made_from().unwrap().number(Key::BlendWindow) == 25.0);
    // The result of another lab is not shown.
    session.apply(Command::Set(vec![(Key::Lab, Value::Choice("match"))])).unwrap();
    assert!(
        session.panes()[0].outcome.is_none()
            && session.panes()[0].result().err() == Some(NoResult::Awaited)
    );
}

#[test]
fn guess_of_a_match_is_not_kept() {
    // Clips longer than those that are compared at once.
    let link = "lab=blend&a=walk(make_seconds:20)&b=run(make_seconds:20)";
    let mut session = Session::new();
    session.apply(Command::OpenLink(link.into())).unwrap();
    assert!(session.panes()[0].outcome.is_some() && !session.panes()[0].is_outdated());
    assert_eq!(session.panes()[0].result().err(), Some(NoResult::Awaited));
    assert!(session.apply(Command::Keep(0)).is_err());
    settle(&mut session);
    session.apply(Command::Keep(0)).unwrap();
}

#[test]
fn result_that_arrives_late_plays() {
    // A frame passes before the first slice of work.
    let mut session = Session::new();
    session
        .apply(Command::OpenLink("lab=graph&clips=walk,walk_left&walk_seconds=20".into()))
        .unwrap();
    assert!(session.panes()[0].outcome.is_none());
    session.tick(0.016);
    settle(&mut session);
    assert!(session.params().is_on(Key::Play));
    let before = session.now_secs();
    session.tick(0.1);
    assert!(session.now_secs() > before);
}
