//! Tests of remedies: after the first one of a refusal the lab has a result.

use super::*;
use crate::LabError;
use crate::fixtures::*;
use crate::params::List;
use segue_formats::bvh;

fn set(session: &mut Session, values: Vec<(Key, Value)>) {
    session.apply(Command::Set(values)).unwrap();
    settle(session);
}

fn text(id: &str) -> Value {
    Value::Text(id.to_owned())
}

/// Returns the first frames of the built-in walk as a file in the library.
fn short(session: &mut Session, frames: usize) -> String {
    let walk = opened("lab=view&a=walk");
    let clip = walk.main_outcome().unwrap().motion.clip().crop(0..frames).unwrap();
    let bytes = bvh::write(&clip, &bvh::WriteOptions::default()).into_bytes();
    session.load(&format!("first_{frames}.bvh"), bytes.into()).unwrap().ids.remove(0)
}

/// A body of two bones without names that are known.
fn snake(session: &mut Session) -> String {
    let text = "HIERARCHY\nROOT seg_1\n{\n OFFSET 0 0 0\n CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation\n JOINT seg_2\n {\n  OFFSET 0 0 0.3\n  CHANNELS 3 Zrotation Xrotation Yrotation\n  End Site\n  {\n   OFFSET 0 0 0.3\n  }\n }\n}\nMOTION\nFrames: 4\nFrame Time: 0.0333333\n0 0 0 0 0 0 0 0 0\n0 0 1 0 5 0 0 5 0\n0 0 2 0 9 0 0 9 0\n0 0 3 0 5 0 0 5 0\n";
    session.load("snake.bvh", bytes(text)).unwrap().ids.remove(0)
}

/// Returns the remedies of the first pane.
fn found(session: &Session) -> Vec<Remedy> {
    let pane = &session.panes()[0];
    assert!(pane.problem.is_some(), "{} was made", session.query());
    session.remedies(pane)
}

/// Applies a remedy and asserts that the lab then has a result. Where the graph has transitions at
/// last, it may still need a higher threshold for a way that goes round: its next remedy says so.
fn assert_helps(session: &mut Session, remedy: &Remedy) {
    let state = session.query();
    let mut next = Some(remedy.clone());
    for _ in 0..3 {
        for command in next.iter().flat_map(Remedy::commands) {
            session.apply(command).unwrap();
        }
        settle(session);
        let pane = &session.panes()[0];
        if pane.result().is_ok() {
            return;
        }
        let is_graph = matches!(pane.problem, Some(LabError::Graph(_)));
        next = session.remedies(pane).into_iter().next().filter(|_| is_graph);
    }
    panic!("{state}: {remedy:?} gives {:?}", session.panes()[0].problem);
}

#[test]
fn first_remedy_of_a_refusal_gives_a_result() {
    let visits: Value = List::Visits(vec![(6.0, 9)]).into();
    let pins: Value = List::Pins(vec![(9999, 3)]).into();
    let graph = "lab=graph&clips=walk,walk_left,walk_right&walk_seconds=20";
    let matched = "lab=match&mirrored=off&match_clips=idle,walk,walk_left&scenario=straight";
    for (link, values, words) in [
        // A gait without a cycle: declared one where it travels, replaced where it does not.
        ("lab=speed&a=edit(a:run,edit_to:0.32)&b=walk", Vec::new(), "Treat A as a loop"),
        ("lab=speed&a=walk&b=edit(a:run,edit_to:0.32)", Vec::new(), "Treat B as a loop"),
        ("lab=speed", vec![(Key::A, text("idle"))], "Use Walk as A"),
        ("lab=speed", vec![(Key::B, text("walk"))], "Use Run as B"),
        ("lab=speed", vec![(Key::A, text("run"))], "Use Walk as B"),
        ("lab=blend", vec![(Key::A, text("nobody"))], "Use Walk as A"),
        ("lab=blend", vec![(Key::B, text("nobody"))], "Use Run as B"),
        ("lab=path", vec![(Key::A, text("idle"))], "Use Walk as A"),
        ("lab=loop&loop_to=1.5", vec![(Key::LoopFrom, Value::Number(1.5))], "Reset Cycle from"),
        ("lab=register", vec![(Key::Pins, pins)], "Reset Pins"),
        (
            "lab=register&warp_mode=join&warp_to=1",
            vec![(Key::WarpFrom, Value::Number(1.0))],
            "Reset Leave A at, Reach B at",
        ),
        (graph, vec![(Key::GoTo, visits)], "Reset Go to"),
        (graph, vec![(Key::Clips, List::ClipIds(Vec::new()).into())], "Reset Clips"),
        (
            "lab=graph&clips=start,stop&walk_seconds=20",
            vec![(Key::EdgeThreshold, Value::Number(0.1))],
            "Set ",
        ),
        (matched, vec![(Key::AskTag, text("tired"))], "Reset Only frames of"),
        (matched, vec![(Key::AheadFar, Value::Number(0.3))], "Reset "),
    ] {
        let mut session = opened(link);
        set(&mut session, values);
        let remedies = found(&session);
        let first = remedies.first().unwrap_or_else(|| panic!("{} has none", session.query()));
        let label = first.label().to_string();
        assert!(label.to_lowercase().starts_with(&words.to_lowercase()), "{label}, not {words}");
        assert_helps(&mut session, first);
    }
}

#[test]
fn every_remedy_of_short_clips_gives_a_result() {
    let mut session = opened("lab=loop");
    let id = short(&mut session, 8);
    set(&mut session, vec![(Key::A, text(&id))]);
    let remedies = found(&session);
    assert_eq!(remedies, [Remedy::TreatAsLoop { slot: Slot::A, id }]);
    assert_helps(&mut session, &remedies[0]);
    assert!(session.params().text(Key::A).contains("as_loop:on"));
    // One step of undo takes back the clip and the choice of it.
    session.apply(Command::Undo).unwrap();
    settle(&mut session);
    assert_eq!(found(&session), remedies);
    // One frame is nothing to close.
    let one = short(&mut session, 1);
    set(&mut session, vec![(Key::A, text(&one))]);
    assert_eq!(found(&session), []);
    // In the Edit lab, the edits that leave too little are taken back.
    let link = "lab=edit&a=walk&edit_from=1&edit_to=1&as_loop=on";
    session.apply(Command::OpenLink(link.into())).unwrap();
    settle(&mut session);
    let remedies = found(&session);
    assert_eq!(remedies, [Remedy::Reset(vec![Key::EditFrom, Key::EditTo, Key::AsLoop])]);
    assert_helps(&mut session, &remedies[0]);
}

#[test]
fn unknown_body_leads_to_its_body_parts() {
    for lab in ["blend", "transition", "speed", "layers", "register", "graph", "match"] {
        let mut session = opened("lab=view&a=walk");
        let id = snake(&mut session);
        let listed: Value = List::ClipIds(vec!["walk".into(), id.clone()]).into();
        set(
            &mut session,
            vec![
                (Key::Lab, Value::Choice(lab_word(lab))),
                (Key::A, text("walk")),
                (Key::B, text(&id)),
                (Key::Clips, listed.clone()),
                (Key::MatchClips, listed),
            ],
        );
        let remedies = found(&session);
        assert_eq!(
            remedies.first().map(|remedy| remedy.label().to_string()),
            Some("Set body parts of snake".to_owned()),
            "{lab}: {:?}",
            session.panes()[0].problem
        );
        assert_helps(&mut session, &remedies[0]);
        assert_eq!(session.params().lab(), LabId::View);
        assert_eq!(session.params().text(Key::A), id);
    }
    // A body without sides has no mirror image.
    let mut session = opened("lab=edit&mirror=on");
    let id = snake(&mut session);
    set(&mut session, vec![(Key::A, text(&id))]);
    let remedies = found(&session);
    assert_eq!(remedies.len(), 2);
    assert_helps(&mut session, &remedies[1]);
}

/// Returns the word of a lab as a choice.
fn lab_word(word: &str) -> &'static str {
    let Kind::Choice(choices) = Key::Lab.param().kind else { panic!() };
    choices.iter().find(|choice| choice.key == word).unwrap().key
}

#[test]
fn path_of_a_standing_clip_offers_to_edit_it() {
    let mut session = opened("lab=path&a=idle&mirror=on&scale=2");
    let remedies = found(&session);
    let edit = remedies.last().unwrap();
    assert_eq!(*edit, Remedy::EditClip { id: "idle".into() });
    assert_helps(&mut session, edit);
    // With no edits left from before.
    assert_eq!(session.query(), "lab=edit&a=idle");
}

#[test]
fn result_and_loading_have_no_remedies() {
    let session = opened("lab=blend");
    assert_eq!(session.remedies(&session.panes()[0]), []);
    let params = crate::Params::default();
    for problem in [LabError::Stopped, LabError::Loading { name: "a take" }] {
        assert_eq!(remedies(&problem, &params, session.library()), []);
    }
}

#[test]
fn clips_with_too_many_pairs_of_frames_get_a_lower_rate() {
    use segue_motion::registration::RegistrationError;
    let mut session = opened("lab=register&a=walk&b=run");
    let problem: LabError =
        RegistrationError::TooManyPairs { pairs: 99_000_000, most: 67_000_000, stride: 2 }.into();
    let remedies = remedies(&problem, session.params(), session.library());
    let [Remedy::Resample { slot: Slot::A, fps: 30, .. }] = remedies.as_slice() else {
        panic!("{remedies:?}")
    };
    assert_eq!(remedies[0].label().to_string(), "Resample A to 30 fps");
    assert_helps(&mut session, &remedies[0]);
    assert_eq!(session.main_outcome().unwrap().motion.clip().fps(), 30.0);
    assert_eq!(session.params().text(Key::A), "edit(a:walk,resample:30)");
}
