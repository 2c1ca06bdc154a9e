//! Tests of the Edit lab: every edit from its link, its recipe, and edits of the library's clips.

use super::*;
use crate::fixtures::*;
use segue_formats::bvh;
use segue_motion::clip::Clip;
use segue_motion::skeleton::Side;

fn motion(session: &Session) -> Arc<Motion> {
    let made = session.panes()[0].result().expect("a result");
    Arc::clone(&made.outcome.motion)
}

fn edited(link: &str) -> Arc<Motion> {
    motion(&opened_without_problems(&format!("lab=edit&{link}")))
}

fn source(id: &str) -> Arc<Motion> {
    motion(&opened_without_problems(&format!("lab=view&a={id}")))
}

/// Adds a clip as a file; returns its id.
fn load(session: &mut Session, name: &str, clip: &Clip) -> String {
    let bytes = bvh::write(clip, &bvh::WriteOptions::default()).into_bytes();
    session.load(name, bytes.into()).unwrap().ids.remove(0)
}

/// Every edit, with its recipe without the clip, and the name of its result.
const EDITS: [(&str, &str, &str); 10] = [
    ("edit_from=0.5&edit_to=1.5", "edit_from:0.5,edit_to:1.5", "Walk, 0.50 to 1.50 s"),
    ("edit_from=0.5", "edit_from:0.5", "Walk, from 0.50 s"),
    ("edit_to=1.5", "edit_to:1.5", "Walk, to 1.50 s"),
    ("as_loop=on", "as_loop:on", "Walk, as a loop"),
    ("reverse=on", "reverse:on", "Walk, reversed"),
    ("mirror=on", "mirror:on", "Walk, mirrored"),
    ("resample=25", "resample:25", "Walk, 25 fps"),
    ("scale=1.5", "scale:1.5", "Walk, scaled by 1.5"),
    ("turn=90", "turn:90", "Walk, turned by 90°"),
    ("move_x=2&move_z=-1", "move_x:2,move_z:-1", "Walk, moved by 2, -1 m"),
];

#[test]
fn every_edit_is_kept_and_made_again_with_equal_bits() {
    let all: Vec<&str> = EDITS.iter().map(|(link, ..)| *link).collect();
    let (recipes, names): (Vec<&str>, Vec<&str>) = (
        EDITS.iter().map(|(_, recipe, _)| *recipe).collect(),
        EDITS.iter().map(|(.., name)| *name).collect(),
    );
    let held = "edit_from=0.4&as_loop=on&mirror=on&foot_lock=on";
    let together = [all[0], all[3], all[4], all[5], all[6], all[7], all[8], all[9]].join("&");
    let more = [
        (together.as_str(), None),
        (held, Some("Walk, from 0.40 s, as a loop, mirrored, feet held".to_owned())),
    ];
    let single = all.iter().zip(&names).map(|(link, name)| (*link, Some((*name).to_owned())));
    for (index, (link, name)) in single.chain(more).enumerate() {
        let mut session = opened_without_problems(&format!("lab=edit&a=walk&{link}"));
        session.apply(Command::Keep(0)).unwrap();
        let kept = Arc::clone(session.library().entries().last().unwrap());
        if let Some(recipe) = recipes.get(index) {
            assert_eq!(kept.id, format!("edit(a:walk,{recipe})"));
        }
        if let Some(name) = name {
            assert_eq!(kept.name.to_lowercase(), name.to_lowercase(), "{link}");
        }
        // Another session has nothing but the link.
        let again = source(&kept.id);
        assert_eq!(*again, *motion(&session), "{link}");
        // After a reload it is made from its recipe.
        let mut restored = Session::new();
        restored.restore(&session.saved(), |_| None, Some(&format!("lab=view&a={}", kept.id)));
        settle(&mut restored);
        assert_eq!(*motion(&restored), *motion(&session), "{link}");
    }
}

#[test]
fn clip_without_edits_stays_the_same_and_is_not_kept() {
    let mut session = opened_without_problems("lab=edit&a=walk");
    assert_eq!(*motion(&session), *source("walk"));
    assert!(session.apply(Command::Keep(0)).unwrap_err().to_string().contains("already"));
    assert_eq!(edits_of(session.params()), []);
}

#[test]
fn trimmed_part_is_that_of_the_clip() {
    let (walk, part) = (source("walk"), edited("a=walk&edit_from=0.5&edit_to=1.5"));
    assert_eq!(*part, walk.cropped(30..91).unwrap());
    // Ends in the other order, and beyond the clip.
    assert_eq!(*edited("a=walk&edit_from=1.5&edit_to=0.5"), *part);
    assert_eq!(*edited("a=walk&edit_to=600"), *walk);
    assert_eq!(edited("a=walk&edit_from=600").clip().frames(), 1);
    let session = opened_without_problems("lab=edit&a=walk&edit_from=0.5");
    let found = [Key::EditFrom, Key::EditTo, Key::Resample].map(|key| session.automatic_value(key));
    assert_eq!(found, [Some(0.0), Some(walk.clip().duration_secs()), Some(60.0)]);
}

#[test]
fn edits_are_applied_in_their_order() {
    let link = "a=walk_left&edit_from=0.2&edit_to=2.2&reverse=on&mirror=on&resample=30&scale=1.5&turn=90&move_x=2&move_z=-1";
    let walk = source("walk_left");
    let made = walk.cropped(12..133).unwrap().reversed().mirrored().unwrap();
    let made = made.resampled(30.0, Interpolation::Cubic).unwrap().scaled(1.5);
    let first = made.ground_frames()[0];
    let wanted =
        Planar::new(first.yaw + 90f64.to_radians(), first.shift.x + 2.0, first.shift.y - 1.0);
    let there = edited(link);
    assert_eq!(there.clip().frames(), 61);
    let apart = wanted.inverse().after(&there.ground_frames()[0]);
    assert!(apart.shift.length() < 1e-9 && apart.yaw.abs() < 1e-9, "{apart:?}");
    assert_eq!(there.contacts(), made.contacts());
    assert_eq!(*there, made.moved(&wanted.after(&first.inverse())));
}

#[test]
fn numbers_are_those_of_the_edited_clip() {
    let session = opened_without_problems("lab=edit&a=walk&edit_from=0.5&edit_to=2.5&scale=2");
    let outcome = session.main_outcome().unwrap();
    assert_eq!(number_of(outcome, MetricId::ClipLength), 2.0);
    assert_eq!(number_of(outcome, MetricId::ClipFrames), 121.0);
    let mps = number_of(outcome, MetricId::MeanSpeed);
    assert!((mps - 2.8).abs() < 0.1, "{mps} m/s");
}

#[test]
fn edits_are_compared() {
    for compare in
        ["mirror:off,on", "reverse:off,on", "as_loop:off,on", "scale:0.5,1,2", "turn:0,90"]
    {
        let session = opened_without_problems(&format!("lab=edit&a=walk_left&compare={compare}"));
        let frames: Vec<_> = session.panes().iter().map(|pane| pane.result().unwrap()).collect();
        assert!(frames.len() >= 2, "{compare}");
        assert_ne!(*frames[0].outcome.motion, *frames[1].outcome.motion, "{compare}");
    }
}

#[test]
fn clip_of_one_frame_and_of_none() {
    let mut session = opened("lab=edit");
    let one = load(&mut session, "one.bvh", &source("walk").clip().crop(0..1).unwrap());
    for (link, is_made) in [
        ("edit_from=1", true),
        ("reverse=on&mirror=on&scale=2&turn=3&move_x=1&foot_lock=on", true),
        ("resample=120", true),
        ("as_loop=on", false),
    ] {
        session.apply(Command::OpenLink(format!("lab=edit&a={one}&{link}"))).unwrap();
        settle(&mut session);
        let pane = &session.panes()[0];
        assert_eq!(pane.result().is_ok(), is_made, "{link}: {:?}", pane.problem);
        assert!(is_made || pane.problem.as_ref().unwrap().to_string().contains("frames"));
    }
    let edits = Edits::of(&Params::default());
    let none = source("walk").cropped(0..0).unwrap();
    assert_eq!(edits.apply(&none).err(), Some(LabError::NoFrames));
}

#[test]
fn clip_with_too_many_frames_is_refused() {
    let mut edits = Edits::of(&Params::default());
    edits.fps = Some(240.0);
    let walk = Motion::clone(&source("walk"));
    let slow = Clip::new(
        "slow",
        Arc::clone(walk.clip().skeleton()),
        1e-4,
        [walk.clip().rotations(0), walk.clip().rotations(1)].concat(),
        walk.clip().root_translations()[..2].to_vec(),
    );
    let refused = edits.apply(&Motion::analyze(slow.unwrap())).err();
    assert!(matches!(refused, Some(LabError::TooManyFrames { .. })), "{refused:?}");
}

/// At 30 and at 120 frames per second, and with a root that stands still.
#[test]
fn rates_and_rigs_are_edited_alike() {
    let mut session = opened("lab=edit");
    for fps in [30.0, 120.0] {
        let walk = source("walk").resampled(fps, Interpolation::Cubic).unwrap();
        let id = load(&mut session, &format!("walk_{fps}.bvh"), walk.clip());
        let link = "edit_from=0.5&edit_to=1.5&as_loop=on&mirror=on&foot_lock=on";
        session.apply(Command::OpenLink(format!("lab=edit&a={id}&{link}"))).unwrap();
        settle(&mut session);
        let made = motion(&session);
        assert_eq!(made.clip().fps(), fps);
        assert!(made.is_cycle() && made.clip().duration_secs() > 0.9);
    }
    let idle = edited("a=idle&as_loop=on&reverse=on&mirror=on&resample=24&scale=0.5&turn=-90");
    assert!(idle.is_cycle() && idle.clip().frames() > 20);
}

/// The held feet of a cycle do not open it again.
#[test]
fn locked_cycle_ends_as_it_begins() {
    let made = edited("a=walk_left&edit_from=0.31&edit_to=1.4&as_loop=on&foot_lock=on");
    let last = made.clip().frames() - 1;
    assert!(made.is_cycle());
    let pose = |frame: usize| {
        let here = made.ground_frames()[frame].inverse();
        made.clip().world_pose(frame).positions.into_iter().map(move |p| here.apply(p))
    };
    let apart = pose(0).zip(pose(last)).map(|(a, b)| a.distance(b)).fold(0.0, f32::max);
    assert!(apart < 1e-4, "{apart} m");
    for side in Side::BOTH {
        assert_eq!(made.contacts().planted(side, 0), made.contacts().planted(side, last));
    }
}

/// A third of a second of a run is no cycle: Speed refuses it, and takes it as soon as it is
/// treated as one.
#[test]
fn clip_treated_as_a_loop_is_a_cycle_for_speed_loop_and_match() {
    let refused = opened("lab=speed&a=walk&b=edit(a:run,edit_to:0.32)");
    assert!(refused.panes()[0].problem.is_some());
    let id = "edit(a:run,edit_to:0.32,as_loop:on)";
    let session = opened_without_problems(&format!("lab=speed&a=walk&b={id}"));
    assert!(session.panes()[0].result().is_ok());

    let whole = source(id);
    let last = whole.clip().frames() - 1;
    let session = opened_without_problems(&format!("lab=loop&a={id}"));
    let cycle = session.main_outcome().unwrap().cycle.unwrap();
    assert!((cycle.secs - last as f64 / whole.clip().fps()).abs() < 1e-9, "{cycle:?}");

    // A short part alone lasts less than the shortest cycle of a search, and than the trajectory of
    // a search.
    let id = "edit(a:walk,edit_to:0.3,as_loop:on)";
    assert!(opened("lab=loop&a=edit(a:walk,edit_to:0.3)").panes()[0].problem.is_some());
    opened_without_problems(&format!("lab=loop&a={id}"));
    let matched = "lab=match&scenario=straight&mirrored=off&match_clips=";
    assert!(opened(&format!("{matched}edit(a:walk,edit_to:0.3)")).panes()[0].problem.is_some());
    let session = opened_without_problems(&format!("{matched}{id}"));
    assert!(session.panes()[0].result().is_ok());
}

#[test]
fn clips_of_the_library_are_edited_at_once() {
    let mut session = opened_without_problems("lab=blend&a=walk&b=run");
    let before = (session.library().entries().len(), session.query());
    for (edit, id) in [
        (ClipEdit::Mirror, "edit(a:walk_left,mirror:on)"),
        (ClipEdit::Reverse, "edit(a:walk_left,reverse:on)"),
        (ClipEdit::Loop, "edit(a:walk_left,as_loop:on)"),
    ] {
        session.apply(Command::Edit("walk_left".into(), edit, None)).unwrap();
        let added = session.library().entries().last().unwrap();
        assert_eq!(added.id, id);
        assert_eq!(**added.motion.as_ref().unwrap(), *source(id));
        assert!(
            session
                .notices()
                .list()
                .iter()
                .any(|notice| { notice.text.to_string().contains("Added to the library") })
        );
        let again = session.apply(Command::Edit("walk_left".into(), edit, None));
        assert!(again.unwrap_err().to_string().contains("already"));
        // The stage does not change, and one step of undo takes the clip out again.
        assert_eq!(session.query(), before.1);
        session.apply(Command::Undo).unwrap();
        assert_eq!(session.library().entries().len(), before.0);
        assert!(session.library().get(id).is_none());
    }
    // Into a slot, in the same step.
    session.apply(Command::Edit("walk".into(), ClipEdit::Mirror, Some(Slot::A))).unwrap();
    assert_eq!(session.params().text(Key::A), "edit(a:walk,mirror:on)");
    session.apply(Command::Undo).unwrap();
    assert_eq!((session.library().entries().len(), session.query()), before);
    // An edit of an edit.
    session.apply(Command::Edit("walk".into(), ClipEdit::Mirror, None)).unwrap();
    let mirrored = session.library().entries().last().unwrap().id.clone();
    session.apply(Command::Edit(mirrored.clone(), ClipEdit::Loop, None)).unwrap();
    let id = &session.library().entries().last().unwrap().id;
    assert_eq!(*id, format!("edit(a:{mirrored},as_loop:on)"));
}

#[test]
fn edit_that_cannot_be_made_changes_nothing() {
    let mut session = opened("lab=view");
    let one = load(&mut session, "one.bvh", &source("walk").clip().crop(0..1).unwrap());
    let before = (session.library().entries().len(), session.query());
    let refused = session.apply(Command::Edit(one, ClipEdit::Loop, Some(Slot::A)));
    assert!(matches!(refused, Err(CommandError::NoResult(_))), "{refused:?}");
    let missing = session.apply(Command::Edit("nobody".into(), ClipEdit::Mirror, None));
    assert_eq!(missing, Err(CommandError::NoClip("nobody".into())));
    assert_eq!((session.library().entries().len(), session.query()), before);
}
