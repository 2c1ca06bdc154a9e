//! The session, by commands: undo, links, files, results that are kept, and the simpler labs.

use crate::JobKind;
use crate::Span;
use crate::fixtures::*;
use crate::reading::{Content, LARGE_BYTES, read};
use glam::Quat;
use segue_motion::clip::Clip;
use segue_motion::metrics::foot_slide_cm;
use segue_motion::transition::{FootLockOptions, foot_lock};

fn blend_window(session: &mut Session, frames: f64) {
    session.apply(Command::Set(vec![(Key::BlendWindow, Value::Number(frames))])).unwrap();
}

#[test]
fn the_first_visit_blends_a_walk_into_a_run_in_three_panes() {
    let session = Session::new();
    assert_eq!(session.panes().len(), 3);
    assert_eq!(session.query(), "compare=blend_window:30,15,10");
    for pane in session.panes() {
        assert_eq!(pane.problem, None);
        let outcome = pane.outcome.as_ref().unwrap();
        let Some((Key::BlendWindow, Value::Number(window))) = pane.variant else { panic!() };
        let window = window as usize;
        assert_eq!(outcome.transition.unwrap().window_frames, window);
        assert_eq!(outcome.sources.len(), 2);
        assert!(outcome.metrics.iter().any(|metric| metric.value.is_some()));
    }
    // The panes differ in the window alone.
    let places: Vec<_> = session
        .panes()
        .iter()
        .map(|pane| pane.outcome.as_ref().unwrap().transition.unwrap())
        .collect();
    assert!(places.windows(2).all(|pair| pair[0].leave_a_secs == pair[1].leave_a_secs
        && pair[0].enter_b_secs == pair[1].enter_b_secs));
    assert!(session.params().is_on(Key::Play));
}

#[test]
fn what_did_not_change_is_not_computed_again() {
    let mut session = Session::new();
    settle(&mut session);
    let before = Arc::clone(session.main_outcome().unwrap());
    session.apply(Command::Set(vec![(Key::CameraYaw, Value::Number(10.0))])).unwrap();
    assert!(Arc::ptr_eq(&before, session.main_outcome().unwrap()));
    session.apply(Command::Set(vec![(Key::WeightLaw, Value::Choice("linear"))])).unwrap();
    assert!(!Arc::ptr_eq(&before, session.main_outcome().unwrap()));
}

#[test]
fn a_bad_value_changes_nothing() {
    let mut session = Session::new();
    let query = session.query();
    let both = vec![(Key::BlendWindow, Value::Number(20.0)), (Key::TurnRate, Value::Number(1e9))];
    let error = session.apply(Command::Set(both)).unwrap_err();
    assert!(error.to_string().contains("turn_rate"), "{error}");
    assert_eq!(session.query(), query);
    assert!(!session.can_undo());
}

#[test]
fn a_drag_is_one_step_of_undo() {
    let mut session = Session::new();
    for frames in [31.0, 32.0, 40.0] {
        blend_window(&mut session, frames);
    }
    session.apply(Command::Settle).unwrap();
    blend_window(&mut session, 50.0);
    session.apply(Command::Undo).unwrap();
    assert_eq!(session.params().number(Key::BlendWindow), 40.0);
    session.apply(Command::Undo).unwrap();
    assert_eq!(session.params().number(Key::BlendWindow), 30.0);
    assert!(!session.can_undo());
    session.apply(Command::Redo).unwrap();
    assert_eq!(session.params().number(Key::BlendWindow), 40.0);
}

#[test]
fn undo_leaves_the_playhead_and_the_camera_alone() {
    let mut session = Session::new();
    blend_window(&mut session, 20.0);
    session.apply(Command::Playback(PlaybackCommand::Seek(1.0))).unwrap();
    session.apply(Command::Set(vec![(Key::CameraYaw, Value::Number(5.0))])).unwrap();
    session.apply(Command::Undo).unwrap();
    assert_eq!((session.now_secs(), session.params().number(Key::CameraYaw)), (1.0, 5.0));
    assert_eq!(session.params().number(Key::BlendWindow), 30.0);
}

#[test]
fn undo_takes_back_marks_speed_and_what_the_camera_follows() {
    let mut session = Session::new();
    let values = [
        (Key::In, Value::Number(1.0)),
        (Key::Rate, Value::Number(0.5)),
        (Key::Follow, Value::Choice("off")),
    ];
    for (key, value) in values.clone() {
        session.apply(Command::Set(vec![(key, value)])).unwrap();
        session.apply(Command::Settle).unwrap();
    }
    for (key, value) in values.into_iter().rev() {
        assert_eq!(session.params().get(key), &value);
        session.apply(Command::Undo).unwrap();
        assert_eq!(session.params().get(key), &key.param().default_value());
    }
}

#[test]
fn a_motion_is_made_whatever_was_set_for_another() {
    let mut session = Session::new();
    let make = [
        (Key::Lab, Value::Choice("make")),
        (Key::Gait, Value::Choice("run")),
        (Key::GaitSpeed, Value::Number(6.0)),
        (Key::MakeSeconds, Value::Number(1.0)),
        (Key::Compare, Value::Compare(None)),
    ];
    session.apply(Command::Set(make.to_vec())).unwrap();
    for gait in ["run", "walk", "idle", "start", "stop", "spin", "jump"] {
        session.apply(Command::Set(vec![(Key::Gait, Value::Choice(gait))])).unwrap();
        assert_eq!(session.panes()[0].problem, None, "{gait}");
        // Side by side, too, each pane shows something, and no two the same.
        if session.range_of(Key::GaitSpeed).is_some() {
            session.apply(Command::Compare(Key::GaitSpeed)).unwrap();
            let values = session.compare().unwrap().values.clone();
            assert!(values[0] != values[1] && values[1] != values[2], "{gait}: {values:?}");
            assert!(
                session.panes().iter().all(|pane| pane.problem.is_none()),
                "{gait}: {values:?}"
            );
            session.apply(Command::Set(vec![(Key::Compare, Value::Compare(None))])).unwrap();
        }
    }
}

#[test]
fn the_playhead_goes_round_in_the_span_between_the_marks() {
    let mut session = Session::new();
    session
        .apply(Command::Set(vec![(Key::In, Value::Number(1.0)), (Key::Out, Value::Number(2.0))]))
        .unwrap();
    assert_eq!(session.span(), Span { start: 1.0, end: 2.0 });
    for _ in 0..100 {
        assert!(session.tick(0.03));
        assert!((1.0..=2.0).contains(&session.now_secs()));
    }
    session.apply(Command::Playback(PlaybackCommand::TogglePlay)).unwrap();
    let now = session.now_secs();
    assert!(!session.tick(0.5));
    assert_eq!(session.now_secs(), now);
    session.apply(Command::Playback(PlaybackCommand::Step(1))).unwrap();
    assert!((session.now_secs() - now - 1.0 / 60.0).abs() < 0.02);
}

#[test]
fn dropped_files_take_a_then_b_and_keep_their_bytes() {
    let mut session = Session::new();
    let first = session.load("first.bvh", made_bvh(1.0)).unwrap();
    let second = session.load("dir/second.bvh", made_bvh(2.0)).unwrap();
    assert_eq!(session.slot(Slot::A).unwrap().id, first.ids[0]);
    assert_eq!(session.slot(Slot::B).unwrap().id, second.ids[0]);
    assert!(first.ids[0].starts_with("first~") && first.ids[0].len() == "first~".len() + 8);
    settle(&mut session);
    assert!(session.panes().iter().all(|pane| pane.problem.is_none()));
    // A third one joins the library and leaves the experiment alone.
    session.load("third.bvh", made_bvh(3.0)).unwrap();
    assert_eq!(session.slot(Slot::B).unwrap().id, second.ids[0]);
}

#[test]
fn a_broken_file_is_named_and_nothing_changes() {
    let mut session = Session::new();
    let (query, clips) = (session.query(), session.clip_infos());
    let error = session
        .load("broken.bvh", Arc::from(&b"HIERARCHY\nROOT Hips\n{\n  OFFSET 0 zero 0\n"[..]))
        .unwrap_err();
    assert!(error.to_string().starts_with("broken.bvh:4:12: found "), "{error}");
    assert_eq!((session.query(), session.clip_infos()), (query, clips));
    assert_eq!(session.notices().list().last().unwrap().level, Level::Error);
}

#[test]
fn a_link_to_a_dropped_file_waits_for_it() {
    let bytes = made_bvh(4.0);
    let mut sender = Session::new();
    sender.load("mine.bvh", Arc::clone(&bytes)).unwrap();
    blend_window(&mut sender, 24.0);
    let query = sender.query();

    let mut receiver = Session::new();
    receiver.apply(Command::OpenLink(query.clone())).unwrap();
    let notice = receiver.notices().list().last().unwrap();
    assert!(
        notice.text.to_string().contains("mine")
            && notice.text.to_string().contains("drop that file"),
        "{}",
        notice.text
    );
    assert!(receiver.panes()[0].problem.is_some());
    receiver.load("renamed.bvh", bytes).unwrap();
    settle(&mut receiver);
    assert_eq!(
        receiver.slot(Slot::A).map(|entry| entry.sha256().map(str::to_owned)),
        sender.slot(Slot::A).map(|entry| entry.sha256().map(str::to_owned))
    );
    assert_eq!(receiver.panes()[0].problem, None);
    let said: Vec<String> =
        receiver.notices().list().iter().map(|notice| notice.text.to_string()).collect();
    assert!(!said.iter().any(|text| text.contains("drop that file")), "{said:?}");
    assert_eq!(receiver.params().number(Key::BlendWindow), 24.0);
}

#[test]
fn the_work_survives_storage() {
    let bytes = made_bvh(5.0);
    let mut session = Session::new();
    let id = session.load("kept.bvh", Arc::clone(&bytes)).unwrap().ids.remove(0);
    session.apply(Command::Rename(id.clone(), "my walk".into())).unwrap();
    session.apply(Command::Remove("idle".into())).unwrap();
    blend_window(&mut session, 17.0);
    let saved = session.saved();

    let mut restored = Session::new();
    restored.restore(&saved, |_| Some(Content::Here(Arc::clone(&bytes))), None);
    settle(&mut restored);
    settle(&mut session);
    assert_eq!(restored.clip_infos(), session.clip_infos());
    assert_eq!(restored.query(), session.query());

    let mut without = Session::new();
    without.restore(&saved, |_| None, None);
    assert!(
        without.notices().list().iter().any(|notice| notice.text.to_string().contains("kept.bvh"))
    );
}

#[test]
fn removing_a_clip_that_plays_puts_another_in_its_place_and_undo_brings_it_back() {
    let mut session = Session::new();
    settle(&mut session);
    session.apply(Command::Remove("walk".into())).unwrap();
    assert!(session.slot(Slot::A).is_some_and(|entry| entry.id != "walk" && entry.id != "run"));
    assert_eq!(session.panes()[0].problem, None);
    session.apply(Command::Undo).unwrap();
    assert_eq!(session.slot(Slot::A).unwrap().id, "walk");
}

#[test]
fn a_bundled_take_is_asked_for_and_takes_its_place() {
    let mut session = Session::new();
    let sample = &Session::samples()[2];
    session.apply(Command::Assign(Slot::A, sample.id.into())).unwrap();
    assert!(session.take_requests().contains(&Request::Sample(sample)));
    let packed = std::fs::read(format!(
        "{}/../../assets/samples/{}",
        env!("CARGO_MANIFEST_DIR"),
        sample.file
    ))
    .unwrap();
    session.load_sample(sample, &packed).unwrap();
    settle(&mut session);
    assert_eq!(session.panes()[0].problem, None);
    assert!(session.main_outcome().unwrap().motion.clip().frames() > 30);
}

#[test]
fn made_clips_are_kept_and_travel_in_the_link() {
    let mut session = Session::new();
    session.apply(Command::OpenLink("lab=make&gait=run&turn_rate=20".into())).unwrap();
    session.apply(Command::Keep(0)).unwrap();
    let id = "run(turn_rate:20)";
    assert!(session.library().find(id).is_some());
    let mut other = Session::new();
    other.apply(Command::OpenLink(format!("lab=view&a={id}"))).unwrap();
    assert_eq!(other.panes()[0].problem, None);
    assert_eq!(
        other.main_outcome().unwrap().motion.clip().rotations(9),
        session.main_outcome().unwrap().motion.clip().rotations(9)
    );
}

#[test]
fn results_of_every_lab_are_kept_as_recipes() {
    for (link, id) in [
        (
            "lab=blend&blend_window=12&leave_a=1.5&enter_b=0.5",
            "blend(a:walk,b:run,blend_window:12,leave_a:1.5,enter_b:0.5)",
        ),
        (
            "lab=loop&a=run&loop_method=linear&loop_from=0.5&loop_to=1.5",
            "loop(a:run,loop_from:0.5,loop_to:1.5,loop_method:linear)",
        ),
        (
            "lab=layers&mask=arms&foot_lock=on&lock_reach=12&lock_clearance=0",
            "layers(a:walk,b:run,foot_lock:on,lock_reach:12,lock_clearance:0,mask:arms)",
        ),
        // Nothing is locked.
        ("lab=layers&mask=arms&lock_reach=12", "layers(a:walk,b:run,mask:arms)"),
        ("lab=view&root_motion=in_place", "view(a:walk,root_motion:in_place)"),
        ("lab=register&warp_weight=0.3", "register(a:walk,b:run,warp_weight:0.3)"),
        ("lab=speed&speed=2", "speed(a:walk,b:run,speed:2)"),
        ("lab=in_place&root_way_turn=off", "in_place(a:walk,root_way_turn:off)"),
        (
            "lab=transition&method=cubic&mix_frame_a=70&mix_frame_b=20",
            "transition(a:walk,b:run,method:cubic,mix_frame_a:70,mix_frame_b:20)",
        ),
    ] {
        let mut session = Session::new();
        session.apply(Command::OpenLink(link.into())).unwrap();
        settle(&mut session);
        session.apply(Command::Keep(0)).unwrap();
        assert!(
            session.library().find(id).is_some(),
            "{link}: {:?}",
            session.library().entries().last().map(|entry| &entry.id)
        );
        assert!(session.apply(Command::Keep(0)).is_err(), "a second one of the same");
        // Whoever opens a link to it has none of the data, and gets the same motion.
        let mut other = Session::new();
        other.apply(Command::OpenLink(format!("lab=view&a={id}"))).unwrap();
        settle(&mut other);
        assert_eq!(other.panes()[0].problem, None, "{id}");
        let clip = |session: &Session| Arc::clone(session.main_outcome().unwrap().motion.clip());
        assert_eq!(clip(&other).frames(), clip(&session).frames(), "{id}");
        assert_eq!(clip(&other).rotations(40), clip(&session).rotations(40), "{id}");
    }
}

#[test]
fn what_was_found_is_part_of_the_recipe() {
    for (lab, named) in [
        ("blend", "leave_a"),
        ("transition", "mix_frame_b"),
        ("loop", "loop_to"),
        ("speed", "speed"),
    ] {
        let mut session = Session::new();
        session.apply(Command::OpenLink(format!("lab={lab}"))).unwrap();
        settle(&mut session);
        session.apply(Command::Keep(0)).unwrap();
        let kept = Arc::clone(session.library().entries().last().unwrap());
        assert!(kept.id.contains(&format!("{named}:")), "{}", kept.id);
        // Kept of what is kept: the link still holds it all.
        session
            .apply(Command::OpenLink(format!(
                "lab=transition&a={}&b=run&mix_frame_a=9&mix_frame_b=9",
                kept.id
            )))
            .unwrap();
        settle(&mut session);
        session.apply(Command::Keep(0)).unwrap();
        let twice = session.library().entries().last().unwrap().id.clone();
        assert!(twice.contains(&kept.id), "{twice}");
        let mut other = Session::new();
        other.apply(Command::OpenLink(format!("lab=view&a={twice}"))).unwrap();
        settle(&mut other);
        assert_eq!(other.panes()[0].problem, None, "{twice}");
        assert_eq!(
            other.main_outcome().unwrap().motion.clip().root_translations().last(),
            session.main_outcome().unwrap().motion.clip().root_translations().last(),
            "{twice}"
        );
    }
}

#[test]
fn addresses_are_asked_for_and_others_are_refused() {
    let mut session = Session::new();
    session
        .apply(Command::OpenLink("src=https://example.org/a.bvh%20ftp://x/b.bvh".into()))
        .unwrap();
    assert_eq!(session.take_requests(), [Request::Fetch("https://example.org/a.bvh".into())]);
    assert!(
        session
            .notices()
            .list()
            .iter()
            .any(|notice| notice.text.to_string().contains("ftp://x/b.bvh"))
    );
}

/// The task that the session has just asked for.
fn asked(session: &mut Session) -> crate::reading::ReadTask {
    let requests = session.take_requests();
    let task = requests.into_iter().find_map(|request| match request {
        Request::Read(task) => Some(task),
        _ => None,
    });
    task.unwrap()
}

#[test]
fn a_large_file_is_read_elsewhere_and_then_joins_the_library() {
    let bytes = made_bvh(6.0);
    let mut session = Session::new();
    let task =
        session.begin_reading("long.bvh", Content::Outside("file 1".into()), LARGE_BYTES + 1);
    let asked_for = asked(&mut session);
    assert_eq!((asked_for.id, asked_for.name.as_str()), (task, "long.bvh"));
    session.progress_reading(task, LARGE_BYTES / 2);
    let job = &session.jobs()[0];
    assert_eq!(
        (job.task, job.kind.name(), job.size),
        (Some(task), "long.bvh", Some(LARGE_BYTES + 1))
    );
    assert!((job.progress - 0.5).abs() < 1e-3);
    let report = read("long.bvh", &bytes, &asked_for.setup, &mut |_| true).unwrap();
    let sha256 = report.files[0].sha256.clone();
    let loaded = session.finish_reading(task, Ok(report.clone())).unwrap().unwrap();
    assert_eq!(session.slot(Slot::A).unwrap().id, loaded.ids[0]);
    assert!(session.jobs().iter().all(|job| job.task.is_none()));
    let Origin::File(file) = &session.slot(Slot::A).unwrap().origin else { panic!() };
    assert_eq!(
        file.content,
        Content::Outside(sha256.clone()),
        "its bytes are where the platform keeps them"
    );
    assert!(session.finish_reading(task, Ok(report.clone())).is_none(), "once is enough");

    // Its roles are corrected by reading it again, elsewhere too.
    session
        .apply(Command::File(FileCommand::CorrectRole(
            loaded.ids[0].clone(),
            segue_motion::skeleton::Role::Head,
            Some(1),
        )))
        .unwrap();
    let again = asked(&mut session);
    assert_eq!(again.content, Content::Outside(sha256));
    let report = read("long.bvh", &bytes, &again.setup, &mut |_| true).unwrap();
    session.finish_reading(again.id, Ok(report)).unwrap().unwrap();
    let motion = session.slot(Slot::A).unwrap().motion.clone().unwrap();
    assert_eq!(motion.roles().get(segue_motion::skeleton::Role::Head), Some(1));

    // After a reload it is asked for again, and is there as soon as it was read.
    let mut restored = Session::new();
    restored.restore(&session.saved(), |key| Some(Content::Outside(key.into())), None);
    assert!(
        restored.panes()[0]
            .problem
            .as_ref()
            .is_some_and(|text| text.to_string().contains("being read"))
    );
    let again = asked(&mut restored);
    assert!(
        restored.take_requests().iter().all(|request| !matches!(request, Request::Read(_))),
        "asked once"
    );
    let report = read("long.bvh", &bytes, &again.setup, &mut |_| true).unwrap();
    restored.finish_reading(again.id, Ok(report)).unwrap().unwrap();
    settle(&mut restored);
    assert_eq!(restored.panes()[0].problem, None);
}

#[test]
fn reading_can_be_given_up() {
    let mut session = Session::new();
    let clips = session.clip_infos();
    let task =
        session.begin_reading("long.bvh", Content::Outside("file 1".into()), LARGE_BYTES + 1);
    session.apply(Command::File(FileCommand::StopReading(task))).unwrap();
    let stop = Request::StopReading { task, forget: Some("file 1".into()) };
    assert!(session.take_requests().contains(&stop));
    assert!(session.finish_reading(task, Err("stopped".into())).is_none());
    assert_eq!(session.clip_infos(), clips);
}

#[test]
fn methods_are_compared_on_one_transition() {
    let mut session = Session::new();
    session
        .apply(Command::OpenLink(
            "lab=transition&compare=method:inertialize,smooth,dead,cut".into(),
        ))
        .unwrap();
    settle(&mut session);
    let outcomes: Vec<_> =
        session.panes().iter().map(|pane| pane.outcome.clone().unwrap()).collect();
    assert!(session.panes().iter().all(|pane| pane.problem.is_none()));
    let places: Vec<_> = outcomes.iter().map(|outcome| outcome.transition.unwrap()).collect();
    assert!(places.windows(2).all(|pair| (pair[0].leave_a_secs, pair[0].enter_b_secs)
        == (pair[1].leave_a_secs, pair[1].enter_b_secs)));
    let seam = |outcome: &Arc<Outcome>| {
        outcome.metrics.iter().find(|metric| metric.id == "pose_jump_deg").unwrap().value.unwrap()
    };
    assert!(seam(&outcomes[3]) > 4.0 * seam(&outcomes[0]), "a cut jumps, inertialization does not");
    // What the slider changes shows at once, and the match stays.
    session.apply(Command::OpenLink("lab=transition".into())).unwrap();
    settle(&mut session);
    let before = Arc::clone(session.main_outcome().unwrap());
    session.apply(Command::Set(vec![(Key::HalfLife, Value::Number(0.6))])).unwrap();
    let after = session.main_outcome().unwrap();
    assert!(after.transition.unwrap().end_secs > before.transition.unwrap().end_secs + 0.5);
    assert_eq!(after.transition.unwrap().leave_a_secs, before.transition.unwrap().leave_a_secs);
}

#[test]
fn mix_frames_are_frames_of_each_clip() {
    let mut session = Session::new();
    session
        .apply(Command::OpenLink(
            "lab=transition&mix_frame_a=90&mix_frame_b=12&method=cubic".into(),
        ))
        .unwrap();
    settle(&mut session);
    let outcome = session.main_outcome().unwrap();
    let fps = outcome.motion.clip().fps();
    let place = outcome.transition.unwrap();
    assert_eq!(
        ((place.leave_a_secs * fps).round(), (place.enter_b_secs * fps).round()),
        (90.0, 12.0)
    );
}

#[test]
fn foot_lock_stills_the_feet_and_tells_what_it_did() {
    let mut session = Session::new();
    session.apply(Command::OpenLink("lab=transition&half_life=0.3&foot_lock=on".into())).unwrap();
    settle(&mut session);
    let outcome = session.main_outcome().unwrap();
    let value =
        |id: &str| outcome.metrics.iter().find(|metric| metric.id == id).unwrap().value.unwrap();
    let (before, after) = (value("foot_slide_before_cm"), value("foot_slide_cm"));
    assert!(before > 3.0 && after < 0.1 * before, "{before} cm, {after} cm");
    session.apply(Command::Set(vec![(Key::FootLock, Value::Switch(false))])).unwrap();
    let skate =
        session.main_outcome().unwrap().metrics.iter().find(|metric| metric.id == "foot_slide_cm");
    assert_eq!(skate.unwrap().value, Some(before));
}

/// Every lab with a foot lock, where it has something to hold.
const LOCKING_LABS: [&str; 9] = [
    "lab=make&gait=stop",
    "lab=view&a=stop",
    "lab=blend",
    "lab=transition",
    "lab=speed",
    "lab=loop",
    "lab=layers&mask=whole",
    "lab=register&b=walk_left",
    "lab=graph&clips=walk,walk_left,walk_right&walk_seconds=20&blend_window=20",
];

/// All local rotations of a clip, frame by frame.
fn rotations_of(clip: &Clip) -> Vec<Quat> {
    (0..clip.frames()).flat_map(|frame| clip.rotations(frame).to_vec()).collect()
}

/// Those of the first pane's result.
fn rotations(session: &Session) -> Vec<Quat> {
    rotations_of(session.main_outcome().unwrap().motion.clip())
}

#[test]
fn lock_settings_change_a_held_result_in_every_lab() {
    // A path is short enough to be held at once, or is held in slices.
    let paths = ["lab=path&a=run", "lab=path&a=walk(make_seconds:12)"];
    for lab in LOCKING_LABS.into_iter().chain(paths) {
        let mut session = opened(&format!("{lab}&foot_lock=on"));
        let usual = rotations(&session);
        let settings = [(Key::LockBlend, 0.6), (Key::LockReach, 1.0), (Key::LockClearance, 10.0)];
        let settings = settings.map(|(key, value)| (key, Value::Number(value)));
        session.apply(Command::Set(settings.to_vec())).unwrap();
        settle(&mut session);
        assert_ne!(rotations(&session), usual, "{lab}");
        for (key, _) in settings {
            session.apply(Command::Reset(key)).unwrap();
        }
        settle(&mut session);
        assert_eq!(rotations(&session), usual, "{lab}");
    }
}

#[test]
fn each_lock_setting_changes_a_held_result_and_no_other() {
    let [held, free] =
        ["on", "off"].map(|lock| format!("lab=transition&half_life=0.3&foot_lock={lock}"));
    let (usual_held, usual_free) = (rotations(&opened(&held)), rotations(&opened(&free)));
    for setting in ["lock_blend=0.6", "lock_reach=3", "lock_clearance=8"] {
        assert_ne!(rotations(&opened(&format!("{held}&{setting}"))), usual_held, "{setting}");
        assert_eq!(rotations(&opened(&format!("{free}&{setting}"))), usual_free, "{setting}");
        // Nor is a clip kept, or shown as changed, for what has no effect.
        let mut view = opened(&format!("lab=view&a=walk&{setting}"));
        assert!(!view.view_is_changed() && view.apply(Command::Keep(0)).is_err(), "{setting}");
        assert!(opened(&format!("lab=view&a=walk&foot_lock=on&{setting}")).view_is_changed());
    }
}

#[test]
fn clearance_of_zero_leaves_the_swing_as_it_is() {
    let free = opened("lab=blend");
    let motion = &free.main_outcome().unwrap().motion;
    let held = |clearance_m| {
        let options = FootLockOptions {
            ground_m: Some(motion.ground_m()),
            clearance_m,
            ..FootLockOptions::default()
        };
        rotations_of(
            &foot_lock(motion.clip(), motion.roles(), motion.contacts(), &options).unwrap(),
        )
    };
    assert_eq!(rotations(&opened("lab=blend&foot_lock=on&lock_clearance=0")), held(None));
    assert_eq!(rotations(&opened("lab=blend&foot_lock=on&lock_clearance=8")), held(Some(0.08)));
    assert_ne!(held(None), held(Some(0.08)));
}

#[test]
fn lock_settings_come_back_from_a_link() {
    let link = "lab=transition&foot_lock=on&lock_blend=0.5&lock_reach=12&lock_clearance=0";
    let session = opened(link);
    let query = session.query();
    for setting in ["lock_blend=0.5", "lock_reach=12", "lock_clearance=0"] {
        assert!(query.split('&').any(|pair| pair == setting), "{setting} in {query}");
    }
    let again = opened(&query);
    assert_eq!(again.query(), query);
    assert_eq!(rotations(&again), rotations(&session));
    let panes = opened("lab=transition&foot_lock=on&compare=lock_reach:30,3");
    let of_pane =
        |pane: usize| rotations_of(panes.panes()[pane].outcome.as_ref().unwrap().motion.clip());
    assert_ne!(of_pane(0), of_pane(1));
}

#[test]
fn one_switch_holds_the_feet_in_every_lab() {
    for lab in LOCKING_LABS {
        let mut session = Session::new();
        session.apply(Command::OpenLink(format!("{lab}&foot_lock=on"))).unwrap();
        settle(&mut session);
        let metrics = &session.main_outcome().unwrap().metrics;
        let value = |wanted: &str| {
            metrics.iter().find(|metric| metric.id.starts_with(wanted)).unwrap().value.unwrap()
        };
        let before = value("foot_slide_before_cm");
        let after = value("foot_slide_cm");
        assert!(after <= before && after < 1.0, "{lab}: {before} cm, {after} cm");
    }
}

#[test]
fn a_held_view_is_kept_under_its_recipe() {
    let mut session = Session::new();
    session.apply(Command::OpenLink("lab=view&a=stop&foot_lock=on".into())).unwrap();
    let held = session.main_outcome().unwrap().motion.clip().clone();
    session.apply(Command::Keep(0)).unwrap();
    session
        .apply(Command::OpenLink(
            "lab=blend&a=view(a:stop,foot_lock:on)&b=walk(foot_lock:on)".into(),
        ))
        .unwrap();
    settle(&mut session);
    let mut other = Session::new();
    other.apply(Command::OpenLink(session.query())).unwrap();
    settle(&mut other);
    for session in [&session, &other] {
        let of_slot = |slot| session.slot(slot).unwrap().motion.as_ref().unwrap();
        assert_eq!(*of_slot(Slot::A).clip(), held);
        assert_eq!(of_slot(Slot::B).clip().name(), "walk(foot_lock:on)");
    }
}

#[test]
fn a_long_clip_is_held_in_slices_while_the_free_one_stays() {
    let mut session = Session::new();
    let long = "walk(make_seconds:25)";
    session.apply(Command::OpenLink(format!("lab=view&a={long}"))).unwrap();
    let free = session.main_outcome().unwrap().clone();
    assert!(
        free.motion.clip().frames() > 1_000
            && free.metrics.iter().all(|metric| metric.value.is_none())
    );
    session.apply(Command::Set(vec![(Key::FootLock, Value::Switch(true))])).unwrap();
    assert!(Arc::ptr_eq(session.main_outcome().unwrap(), &free));
    let mut last = 0.0;
    while let Some(job) = session.jobs().into_iter().find(|job| job.kind == JobKind::HoldingFeet) {
        assert!(job.progress >= last);
        last = job.progress;
        session.work();
    }
    assert!(last > 0.9, "{last}");
    settle(&mut session);
    let held = session.main_outcome().unwrap();
    let motion = &free.motion;
    let whole =
        foot_lock(motion.clip(), motion.roles(), motion.contacts(), &FootLockOptions::default())
            .unwrap();
    assert_eq!(**held.motion.clip(), whole);
    let before = held.metrics.iter().find(|metric| metric.id == "foot_slide_before_cm");
    assert_eq!(
        before.unwrap().value,
        foot_slide_cm(motion.clip(), motion.roles(), motion.contacts())
    );
}

/// A session whose slot A holds a large file from storage, that is being read.
fn with_stored_large_file() -> (Session, crate::reading::ReadTask) {
    let bytes = made_bvh(6.0);
    let mut session = Session::new();
    let task =
        session.begin_reading("long.bvh", Content::Outside("file 1".into()), LARGE_BYTES + 1);
    let setup = asked(&mut session).setup;
    session
        .finish_reading(task, Ok(read("long.bvh", &bytes, &setup, &mut |_| true).unwrap()))
        .unwrap()
        .unwrap();
    let mut restored = Session::new();
    restored.restore(&session.saved(), |key| Some(Content::Outside(key.into())), None);
    let task = asked(&mut restored);
    (restored, task)
}

#[test]
fn a_stored_file_that_cannot_be_read_is_not_read_again_and_again() {
    let reads = |session: &mut Session| {
        session.take_requests().iter().filter(|request| matches!(request, Request::Read(_))).count()
    };
    let (mut session, task) = with_stored_large_file();
    session.finish_reading(task.id, Err("it is gone".into())).unwrap().unwrap_err();
    blend_window(&mut session, 20.0);
    assert_eq!(reads(&mut session), 0);
    assert!(
        session.panes()[0]
            .problem
            .as_ref()
            .is_some_and(|text| text.to_string().contains("it is gone")),
        "{:?}",
        session.panes()[0].problem
    );

    let (mut session, task) = with_stored_large_file();
    session.apply(Command::File(FileCommand::StopReading(task.id))).unwrap();
    blend_window(&mut session, 20.0);
    assert_eq!(reads(&mut session), 0);
    assert!(
        session.panes()[0]
            .problem
            .as_ref()
            .is_some_and(|text| text.to_string().contains("stopped"))
    );
    // Asked for by hand it is read once more.
    let id = session.slot(Slot::A).unwrap().id.clone();
    session
        .apply(Command::File(FileCommand::Reimport(id, segue_formats::ImportOptions::default())))
        .unwrap();
    assert_eq!(reads(&mut session), 1);
}

fn opened(link: &str) -> Session {
    let mut session = Session::new();
    session.apply(Command::OpenLink(link.into())).unwrap();
    settle(&mut session);
    assert!(session.panes().iter().all(|pane| pane.problem.is_none()), "{link}");
    session
}

fn number_of(outcome: &Outcome, id: &str) -> f64 {
    let metric = outcome.metrics.iter().find(|metric| metric.id == id);
    metric.and_then(|metric| metric.value).unwrap_or(f64::NAN)
}

#[test]
fn right_and_wrong_stand_side_by_side() {
    let right = opened("lab=transition");
    let both = opened("lab=transition&compare=mistake:none,euler,hemisphere");
    let outcome = |session: &Session, pane: usize| {
        Arc::clone(session.panes()[pane].outcome.as_ref().unwrap())
    };
    // No mistake is the transition itself, bit for bit.
    assert_eq!(outcome(&right, 0).motion, outcome(&both, 0).motion);
    assert_eq!(outcome(&right, 0).metrics, outcome(&both, 0).metrics);
    let seam = |pane| number_of(&outcome(&both, pane), "velocity_jump_dps");
    assert!(
        seam(1) > 10.0 * seam(0) && seam(2) > 3.0 * seam(0),
        "{} {} {}",
        seam(0),
        seam(1),
        seam(2)
    );
    let others = opened("lab=transition&compare=mistake:none,degrees,atan");
    let of = |pane, id| number_of(&outcome(&others, pane), id);
    let jumps = [0, 1].map(|pane| of(pane, "velocity_jump_dps"));
    assert!(jumps[1] > 10.0 * jumps[0], "{jumps:?}");
    let spins = [0, 2].map(|pane| of(pane, "spin_deg"));
    assert!(spins[0] < 5.0 && spins[1] > 60.0, "{spins:?}");
    // The other labs know nothing of mistakes.
    let [plain, spoiled] =
        ["lab=blend&compare=", "lab=blend&mistake=degrees"].map(|link| outcome(&opened(link), 0));
    assert_eq!(plain.motion, spoiled.motion);
    // Every mistake has a picture and the same numbers, by every method.
    for mistake in ["hemisphere", "euler", "degrees", "atan", "alignment", "velocity", "world_root"]
    {
        for method in ["inertialize", "cubic", "quintic", "dead", "smooth", "linear", "cut"] {
            let session = opened(&format!("lab=transition&method={method}&mistake={mistake}"));
            let good = opened(&format!("lab=transition&method={method}"));
            let differs = outcome(&session, 0).motion != outcome(&good, 0).motion;
            let told = |session: &Session| {
                outcome(session, 0).metrics.iter().map(|metric| metric.id).collect::<Vec<_>>()
            };
            assert_eq!(told(&session), told(&good));
            assert_eq!(differs, crate::mistake_shows(session.params()), "{mistake} {method}");
        }
    }
}

#[test]
fn the_layers_lab_opens_with_a_run_on_walking_legs() {
    let session = opened("lab=layers");
    let outcome = session.main_outcome().unwrap();
    let layer = outcome.layer().unwrap();
    assert_eq!((layer.fit, layer.has_no_steps), (crate::LayerFit::InStep, false));
    assert!(layer.shares[0] == 0.0 && layer.shares.contains(&1.0));
    let walk = session.slot(Slot::A).unwrap().motion.clone().unwrap();
    // The legs are the walk's, bit for bit, and stand as they stood.
    assert_eq!(outcome.motion.clip().root_translations(), walk.clip().root_translations());
    assert_eq!(outcome.motion.contacts(), walk.contacts());
    let slide = foot_slide_cm(walk.clip(), walk.roles(), walk.contacts());
    assert_eq!(
        (number_of(outcome, "foot_slide_cm"), number_of(outcome, "off_legs_deg")),
        (slide.unwrap(), 0.0)
    );
    let jump = number_of(outcome, "velocity_jump_dps");
    assert!(jump < 60.0, "{jump}");
    assert!(number_of(outcome, "off_arms_deg") > 10.0);
    // B's track and A's have the length of A.
    assert!(
        outcome.sources.iter().all(|source| source.motion.clip().frames() == walk.clip().frames())
    );
}

#[test]
fn the_arms_of_a_run_in_step_swing_with_the_legs() {
    // As far apart as the hands are when the left foot strikes, in every cycle.
    let session = opened("lab=layers&mask=arms&keep_orientation=off");
    let outcome = session.main_outcome().unwrap();
    let hand = outcome.motion.roles().get(segue_motion::skeleton::Role::LeftForearm).unwrap();
    let strikes = outcome.motion.contacts().intervals(segue_motion::skeleton::Side::Left);
    let at: Vec<_> = strikes
        .iter()
        .skip(1)
        .map(|stance| outcome.motion.clip().rotations(stance.start)[hand])
        .collect();
    assert!(at.len() >= 2);
    for pair in at.windows(2) {
        assert!(segue_motion::math::quat::angle_between(pair[0], pair[1]) < 0.02, "{at:?}");
    }
}

#[test]
fn layers_are_live_and_say_how_their_time_goes() {
    use crate::LayerFit;
    for (link, fit, has_no_steps) in [
        ("lab=layers&b=run(make_seconds:2)&layer_fit=loop", LayerFit::Looped, false),
        ("lab=layers&layer_fit=hold", LayerFit::Held, false),
        ("lab=layers&a=run(make_seconds:2)&b=walk&layer_fit=loop", LayerFit::Once, false),
        ("lab=layers&b=idle(make_seconds:2)", LayerFit::Looped, true),
        ("lab=layers&a=idle(make_seconds:2)&b=walk", LayerFit::Once, true),
    ] {
        let session = opened(link);
        let layer = session.main_outcome().unwrap().layer().cloned().unwrap();
        assert_eq!((layer.fit, layer.has_no_steps), (fit, has_no_steps), "{link}");
        assert!(number_of(session.main_outcome().unwrap(), "velocity_jump_dps") < 400.0, "{link}");
    }
    let mut session = opened("lab=layers&compare=layer_weight:0,0.5,1");
    let arms: Vec<f64> = session
        .panes()
        .iter()
        .map(|pane| number_of(pane.outcome.as_ref().unwrap(), "off_arms_deg"))
        .collect();
    assert!(arms[0] == 0.0 && arms[1] > 0.3 * arms[2] && arms[1] < 0.7 * arms[2], "{arms:?}");
    // What did not change is not computed again, in any pane, whatever they differ in.
    for compare in [
        "layer_weight:0,0.5",
        "layer_start:0,0.2,0.4",
        "layer_fit:step,loop",
        "mask:upper,head,legs,whole",
    ] {
        session.apply(Command::OpenLink(format!("lab=layers&compare={compare}"))).unwrap();
        let outcomes = |session: &Session| {
            session.panes().iter().map(|pane| pane.outcome.clone().unwrap()).collect::<Vec<_>>()
        };
        let before = outcomes(&session);
        session.apply(Command::Set(vec![(Key::CameraYaw, Value::Number(12.0))])).unwrap();
        assert!(
            before.iter().zip(outcomes(&session)).all(|(a, b)| Arc::ptr_eq(a, &b)),
            "{compare}"
        );
        assert!(before.windows(2).all(|pair| pair[0].motion != pair[1].motion), "{compare}");
    }
    // Against the mean, an additive layer leaves the posture; against the rest pose it adds all of
    // it.
    let off = |reference: &str| {
        let session =
            opened(&format!("lab=layers&layer_mode=additive&layer_reference={reference}"));
        number_of(session.main_outcome().unwrap(), "off_arms_deg")
    };
    assert!(
        off("mean") > 1.0 && off("mean") < 0.5 * off("rest"),
        "{} {}",
        off("mean"),
        off("rest")
    );
}

#[test]
fn comparison_of_a_choice_begins_with_the_one_that_is_set() {
    let mut session = Session::new();
    session.apply(Command::OpenLink("lab=transition&method=dead".into())).unwrap();
    session.apply(Command::Compare(Key::Method)).unwrap();
    let compare = session.compare().unwrap();
    assert_eq!(compare.values.first(), Some(&Value::Choice("dead")));
}
