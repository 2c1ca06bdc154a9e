//! Tests of the Match lab, by commands.

use crate::DriveHistory;
use crate::fixtures::*;
use glam::DVec2;
use segue_motion::matching::{
    Control, Controller, Database, DatabaseOptions, Normalisation, RATE, Scenario, Tag, TagSet,
    drive, made_clips,
};
use segue_text::ToMessage;

/// A database that is built quickly.
const SMALL: &str =
    "lab=match&mirrored=off&match_clips=idle,walk,walk_left,walk_right,walk(make_seconds:6)";

fn driven(session: &Session) -> &DriveHistory {
    assert_eq!(session.panes()[0].problem, None);
    session.main_outcome().unwrap().driven().unwrap()
}

fn ask(session: &mut Session, x: f64, z: f64) {
    session
        .apply(Command::Drive(DriveCommand::Steer(Control::new(DVec2::new(x, z), None))))
        .unwrap();
}

#[test]
fn scenario_of_a_link_equals_the_core() {
    let session = opened("lab=match&scenario=spin");
    let outcome = session.main_outcome().unwrap();
    let database =
        Arc::new(Database::new(made_clips(1.75).unwrap(), &DatabaseOptions::default()).unwrap());
    assert_eq!(driven(&session).database.frames(), database.frames());
    let mut options = crate::labs::options_of(session.params());
    options.candidates = 1;
    let played = drive(&database, options, &Scenario::Spin.recording()).unwrap();
    // The trajectory times of the sliders are hundredths of a second, and round to the same frames.
    assert_eq!(outcome.motion.clip().root_translations(), played.clip.root_translations());
    assert_eq!(outcome.motion.clip().rotations(200), played.clip.rotations(200));
    let metrics = super::trace::of_drive(&played.metrics(&database));
    // After the metrics of every lab.
    assert_eq!(outcome.metrics[4..][..metrics.len()], metrics);
    assert!(
        driven(&session).jumps_secs().count() == played.jumps.len() && !played.jumps.is_empty()
    );
}

#[test]
fn driven_motion_is_recorded_and_replayed_exactly() {
    let mut session = opened(SMALL);
    assert!(session.is_driven() && session.jobs().is_empty());
    let rest = driven(&session).moments.last().unwrap().root;
    for (x, z, ticks) in [(0.0, 0.0, 20), (0.0, 1.4, 90), (1.0, 1.0, 60), (0.0, 0.0, 40)] {
        ask(&mut session, x, z);
        for _ in 0..ticks {
            assert!(session.tick(1.0 / 60.0));
        }
    }
    let clip = Arc::clone(session.main_outcome().unwrap().motion.clip());
    let frames = clip.frames();
    assert!(session.recording().ticks().abs_diff(210) <= 1, "{}", session.recording().ticks());
    assert!(driven(&session).moments.last().unwrap().root.shift.distance(rest.shift) > 1.5);
    let ticks = session.recording().ticks();
    session.apply(Command::Drive(DriveCommand::Replay)).unwrap();
    while session.work() {}
    assert!(!session.is_driven());
    let replay = Arc::clone(session.main_outcome().unwrap().motion.clip());
    assert_eq!(replay.frames(), ticks);
    for back in 1..frames.min(ticks) {
        assert_eq!(
            (replay.rotations(ticks - back), replay.root_translations()[ticks - back]),
            (clip.rotations(frames - back), clip.root_translations()[frames - back])
        );
    }
    // The link alone restores it, and it is kept like any other clip.
    let mut other = opened(&session.query());
    let again = Arc::clone(other.main_outcome().unwrap().motion.clip());
    assert_eq!(again.root_translations(), replay.root_translations());
    other.apply(Command::Keep(0)).unwrap();
    let id = other.library().entries().last().unwrap().id.clone();
    assert!(id.starts_with("match(drive:"), "{id}");
    let viewed = opened(&format!("lab=view&a={}", id.replace('%', "%25")));
    assert_eq!(
        viewed.main_outcome().unwrap().motion.clip().root_translations(),
        replay.root_translations()
    );
    // Undo leads back to a character that stands.
    session.apply(Command::Undo).unwrap();
    while session.work() {}
    assert!(session.is_driven() && session.recording().ticks() == 0);
}

#[test]
fn time_at_any_rate_makes_whole_ticks_and_none_while_paused() {
    let mut session = opened(SMALL);
    ask(&mut session, 0.0, 1.4);
    for _ in 0..50 {
        session.tick(0.01);
    }
    let ticks = session.recording().ticks();
    assert!((29..=30).contains(&ticks), "{ticks}");
    let shown = session.now_secs();
    session.tick(0.004);
    assert!(
        session.recording().ticks() > ticks || session.now_secs() > shown,
        "smooth between two ticks"
    );
    session.apply(Command::Playback(PlaybackCommand::TogglePlay)).unwrap();
    let now = (session.recording().ticks(), session.now_secs());
    assert!(!session.tick(0.5));
    assert_eq!((session.recording().ticks(), session.now_secs()), now);
    session.apply(Command::Playback(PlaybackCommand::Step(3))).unwrap();
    assert_eq!(session.recording().ticks(), now.0 + 3);
    // A page that was suspended does not catch up for hours.
    session.apply(Command::Playback(PlaybackCommand::TogglePlay)).unwrap();
    session.tick(3600.0);
    assert!(session.recording().ticks() < now.0 + 3 + RATE);
}

#[test]
fn stick_input_starts_playback() {
    let mut session = opened(&format!("{SMALL}&play=off"));
    assert!(session.is_driven() && !session.tick(0.5));
    ask(&mut session, 0.0, 1.4);
    assert!(session.params().is_on(Key::Play) && session.tick(0.5));
    let ticks = session.recording().ticks();
    assert!(ticks > 10);
    // Paused with the stick held, it stays paused until the stick moves again.
    session.apply(Command::Playback(PlaybackCommand::TogglePlay)).unwrap();
    ask(&mut session, 0.5, 1.4);
    assert!(!session.params().is_on(Key::Play) && session.recording().ticks() == ticks);
    ask(&mut session, 0.0, 0.0);
    assert!(!session.params().is_on(Key::Play));
    ask(&mut session, 0.0, 1.4);
    assert!(session.params().is_on(Key::Play));
    // From the Graph lab, which has nothing to show at first, playback continues.
    let mut session = Session::new();
    for lab in ["lab=graph", "lab=match"] {
        session.apply(Command::OpenLink(lab.into())).unwrap();
        session.tick(0.1);
        assert!(session.params().is_on(Key::Play), "{lab}");
    }
}

#[test]
fn character_appears_beside_a_pane_that_waits() {
    // The second database is known, the first is not.
    let mut session = opened(&format!("{SMALL}&ahead_far=1.2"));
    session.apply(Command::OpenLink("lab=view".into())).unwrap();
    session.apply(Command::OpenLink(format!("{SMALL}&compare=ahead_far:1.1,1.2"))).unwrap();
    assert!(session.panes()[0].result().is_err() && session.panes()[1].result().is_ok());
    while session.work() {}
    assert!(session.panes().iter().all(|pane| pane.result().is_ok()));
    ask(&mut session, 0.0, 1.4);
    session.tick(0.2);
    let moments = |pane: usize| {
        session.panes()[pane].outcome.as_ref().unwrap().driven().unwrap().moments.len()
    };
    assert_eq!(moments(0), moments(1), "both begin together");
}

#[test]
fn sliders_change_the_moving_character_and_panes_share_the_input() {
    let mut session = opened(&format!("{SMALL}&compare=hysteresis:none,bias,votes"));
    ask(&mut session, 0.7, 1.2);
    for _ in 0..90 {
        session.tick(1.0 / 60.0);
    }
    let database = Arc::clone(&driven(&session).database);
    let roots = |session: &Session| -> Vec<_> {
        let last = |pane: &Pane| {
            pane.outcome.as_ref().unwrap().driven().unwrap().moments.last().unwrap().root
        };
        session.panes().iter().map(last).collect()
    };
    let before = roots(&session);
    assert_eq!(before.len(), 3);
    session.apply(Command::Set(vec![(Key::WeightPath, Value::Number(3.0))])).unwrap();
    assert!(
        Arc::ptr_eq(&driven(&session).database, &database) && roots(&session) == before,
        "live, without a rebuild"
    );
    session.apply(Command::Set(vec![(Key::AheadFar, Value::Number(0.8))])).unwrap();
    assert!(session.is_driven() && session.jobs().len() == 1);
    session.tick(1.0 / 30.0);
    while session.work() {}
    assert_eq!(driven(&session).database.features().layout().ahead(), [20, 40, 48]);
    assert!(
        roots(&session)[0].shift.distance(before[0].shift) < 0.2,
        "it goes on from where it was"
    );
    session.apply(Command::Set(vec![(Key::AheadFar, Value::Number(0.4))])).unwrap();
    while session.work() {}
    assert!(session.panes()[0].problem.as_ref().unwrap().to_string().contains("must rise"));
    session.apply(Command::Set(vec![(Key::Lab, Value::Choice("view"))])).unwrap();
    assert!(!session.is_driven() && session.panes()[0].problem.is_none());
}

#[test]
fn tag_filter_restricts_the_candidates_of_searches() {
    let mut session = opened("lab=match&ask_tag=walk&shown_candidates=4");
    for _ in 0..120 {
        session.tick(1.0 / 60.0);
    }
    let moment = driven(&session).moments.last().unwrap();
    let database = &driven(&session).database;
    let search = moment.search.as_ref().unwrap();
    for candidate in &search.candidates {
        assert!(
            database
                .tags(database.number(candidate.place).unwrap())
                .has(segue_motion::matching::Tag::Walk)
        );
    }
    assert_eq!(search.candidates.len(), 4);
    assert_eq!(search.candidates[0].place, search.winner.unwrap().place);
    assert!(search.candidates.windows(2).all(|pair| pair[0].cost <= pair[1].cost));
}

#[test]
fn tags_by_hand_are_required_and_excluded() {
    let session = opened(&format!(
        "{SMALL}&tags=walk:0-1:proud,walk:0.5-2:-walk,idle:0-10:exclude&ask_tag=proud"
    ));
    let database = &driven(&session).database;
    let own = TagSet::of(&[Tag::Own(0)]);
    for (motion, name) in [(0, "stand"), (1, "walk")] {
        assert!(database.motions()[motion].clip().name().to_lowercase().contains(name));
    }
    let at = |motion: usize, frame: usize| {
        let before: usize = database.motions()[..motion].iter().map(|motion| motion.frames()).sum();
        database.tags(before + frame)
    };
    assert!(at(0, 30).has(Tag::Exclude) && !at(1, 30).has(Tag::Exclude));
    assert!(
        at(1, 10).meets(own)
            && at(1, 10).has(Tag::Walk)
            && !at(1, 45).has(Tag::Walk)
            && !at(1, 90).meets(own)
    );
    // A word that no frame has is refused, with the remedy.
    let problem = opened(&format!("{SMALL}&scenario=straight&forbid_tag=tired")).panes()[0]
        .problem
        .clone()
        .unwrap();
    assert!(problem.to_string().contains("`tired`"), "{problem}");
    // Tags change during driving: the character continues from where it is.
    let mut session = opened(SMALL);
    ask(&mut session, 0.0, 1.4);
    for _ in 0..90 {
        session.tick(1.0 / 60.0);
    }
    let there = driven(&session).moments.last().unwrap().root;
    session
        .apply(Command::Set(vec![(
            Key::Tags,
            Key::Tags.param().parse("walk_left:0-9:exclude").unwrap(),
        )]))
        .unwrap();
    session.tick(1.0 / 60.0);
    assert!(driven(&session).moments.last().unwrap().root.shift.distance(there.shift) < 0.1);
    assert!(driven(&session).moments.len() > 60);
}

#[test]
fn crowd_shares_the_database() {
    let mut session = opened(&format!("{SMALL}&crowd=6"));
    for _ in 0..30 {
        session.tick(1.0 / 60.0);
    }
    let (database, poses) = session.crowd().unwrap();
    assert!(Arc::ptr_eq(database, &driven(&session).database));
    let before: Vec<_> = poses.iter().map(|pose| pose.root_translation).collect();
    assert_eq!(before.len(), 5);
    for _ in 0..60 {
        session.tick(1.0 / 60.0);
    }
    let moved = session
        .crowd()
        .unwrap()
        .1
        .iter()
        .zip(&before)
        .filter(|(a, b)| a.root_translation.distance(**b) > 0.2)
        .count();
    assert!(moved >= 3, "{moved}");
    session.apply(Command::Set(vec![(Key::Crowd, Value::Number(1.0))])).unwrap();
    assert!(session.crowd().is_none());
}

#[test]
fn impossible_settings_are_refused_with_a_sentence() {
    for (link, part) in [
        (
            "lab=match&match_clips=walk(make_seconds:2)&ahead_far=3&match_cycles=off",
            "has a frame that can be searched",
        ),
        ("lab=match&match_clips=nobody", "is not here"),
        ("lab=match&ahead_near=1&ahead_far=0.5", "must rise"),
    ] {
        let session = opened(link);
        let problem =
            session.panes()[0].problem.as_ref().map(|problem| problem.to_sentence().to_string());
        let problem = problem.unwrap_or_default();
        assert!(problem.contains(part) && problem.ends_with('.'), "{link}: {problem}");
        assert!(session.jobs().is_empty());
    }
    let mut session = opened(SMALL);
    assert!(matches!(
        session.apply(Command::Drive(DriveCommand::Replay)),
        Err(CommandError::NotPossible(_))
    ));
    // A controller of the core begins at the same frame.
    let core = Controller::new(
        Arc::clone(&driven(&session).database),
        crate::labs::options_of(session.params()),
        &segue_motion::math::Planar::IDENTITY,
    );
    assert_eq!(core.unwrap().place(), driven(&session).moments[0].place);
}

#[test]
fn literal_forms_of_a_course_are_choices() {
    let given =
        "lab=match&mirrored=off&match_clips=walk,walk_left,walk(make_seconds:6)&scenario=straight";
    let usual = opened(given);
    let options = |session: &Session| driven(session).database.options().clone();
    assert!(
        options(&usual).cycles && options(&usual).features.normalisation == Normalisation::Block
    );
    let literal = opened(&format!(
        "{given}&normalisation=dimension&hysteresis=clip_votes&prefer_clip=walk_left&prefer_current=1&match_cycles=off"
    ));
    assert!(
        !options(&literal).cycles
            && options(&literal).features.normalisation == Normalisation::Dimension
    );
    // The preferred clip plays, although it leads elsewhere.
    let played = |session: &Session| {
        let driven = driven(session);
        let left = |moment: &&Arc<crate::DriveMoment>| {
            driven.database.motions()[moment.place.motion].source() == 1
        };
        driven.moments.iter().skip(120).filter(left).count() as f64
            / (driven.moments.len() - 120) as f64
    };
    assert!(
        played(&literal) > 0.8 && played(&usual) < 0.3,
        "{} {}",
        played(&literal),
        played(&usual)
    );
    let unknown = opened(&format!("{given}&prefer_clip=run"));
    let problem = unknown.panes()[0].problem.as_ref().unwrap();
    assert!(problem.to_string().contains("`run` is not among the clips"), "{problem}");
}
