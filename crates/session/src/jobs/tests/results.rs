//! Results that workers make: they are those of the labs, to the last bit.

use super::*;
use crate::labs::{MeasuredMotion, Outcome, PlacedClip, Slot};
use crate::metrics::{self, Metric};
use crate::params::{Kind, PARAMS, Params};
use segue_motion::clip::Clip;
use segue_motion::metrics::ResultMetrics;
use std::sync::LazyLock;

/// The labs whose results workers make.
const LABS: [&str; 5] = ["blend", "transition", "layers", "in_place", "edit"];

/// Files of other motion than the built-in one: with longer bones, on four legs, at a rate of 24,
/// standing still, of one frame, of a thing.
static FILES: LazyLock<Vec<(&str, Vec<u8>)>> = LazyLock::new(|| {
    let written =
        |clip: &Clip| segue_formats::bvh::write(clip, &segue_formats::bvh::WriteOptions::default());
    let made = String::from_utf8(made_bvh(2.0).to_vec()).unwrap();
    let (head, rows) = made.split_once("Frame Time:").unwrap();
    let (_, rows) = rows.split_once('\n').unwrap();
    let (skeleton, _) = head.split_once("Frames:").unwrap();
    let first = rows.lines().next().unwrap();
    let held = |frames: usize| {
        let rows = format!("{first}\n").repeat(frames);
        format!("{skeleton}Frames: {frames}\nFrame Time: 0.01\n{rows}")
    };
    let other = made.replace("OFFSET 0 ", "OFFSET 0.01 ");
    assert_ne!(made, other, "another skeleton");
    let slow = format!("{head}Frame Time: {}\n{rows}", 1.0 / 24.0);
    let files = [
        ("other.bvh", other),
        ("four.bvh", written(&QuadrupedWalk::default().clip())),
        ("slow.bvh", slow),
        ("still.bvh", held(50)),
        ("one.bvh", held(1)),
        ("thing.bvh", THING.to_owned()),
    ];
    files.map(|(name, text)| (name, text.into_bytes())).into()
});

/// A file without a body.
const THING: &str = "HIERARCHY\nROOT box\n{\nOFFSET 0 0 0\n\
                     CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation\n\
                     End Site\n{\nOFFSET 0 10 0\n}\n}\nMOTION\nFrames: 3\nFrame Time: 0.02\n\
                     0 0 0 0 0 0\n1 0 0 0 9 0\n2 0 0 0 9 9\n";

/// Returns a session with the files, and the ids of their clips and of two built-in ones.
fn session_of_rigs() -> (Session, Vec<String>) {
    let mut session = Session::new();
    let mut ids = vec!["walk".to_owned(), "run".to_owned()];
    for (name, bytes) in &*FILES {
        ids.append(&mut session.load(name, bytes.clone().into()).unwrap().ids);
    }
    (session, ids)
}

/// Returns the result of a session's first pane as a worker makes it.
fn made_by_worker(session: &mut Session) -> Result<Outcome, JobError> {
    let params = session.panes()[0].params_in(session.params());
    let slots = session.clips().lab_clips(&params).map_err(|_| JobError::NoResult)?.slots;
    let clip = |(number, motion)| JobClip { number, motion };
    let clips: Vec<JobClip> = (1..).zip(slots).map(clip).collect();
    let task = ResultTask::new(&params, params.number(Key::BlendWindow) as usize);
    let job = Job { number: 1, clips, task: task.into() };
    let mut worker = Worker::new(1 << 26);
    for clip in &job.clips {
        worker.take_clip(clip.number, &parcel_of(clip)).unwrap();
    }
    let message = job.message().unwrap();
    let parcel = worker.run_message(&message)?;
    // The second time, the worker remembers.
    assert!(parcel == worker.run_message(&message)?, "the memory changes the result");
    Ok(ResultTask::output(job.answer(parcel)?).unwrap())
}

/// Asserts that a worker makes the result of the first pane, or has none either.
fn assert_same_by_worker(session: &mut Session) {
    let made = made_by_worker(session);
    let pane = &session.panes()[0];
    if let Some(problem) = &pane.problem {
        assert!(made.is_err(), "{problem}, and a worker has a result");
        return;
    }
    let expected = pane.outcome.as_ref().unwrap();
    let skeleton = session.slot(Slot::A).unwrap().motion.as_ref().unwrap().clip().skeleton();
    if expected.motion.clip().skeleton() != skeleton {
        assert!(made.is_err(), "a body that the page does not have");
        return;
    }
    let made = made.unwrap();
    assert!(made.motion.is_analyzed(), "the page computes what a worker could have");
    assert!(made.motion == expected.motion, "another motion");
    assert!(Arc::ptr_eq(made.motion.clip().skeleton(), skeleton), "a new skeleton");
    // The metrics of every lab are measured later.
    let common = metrics::of_result(&ResultMetrics::default(), 1.0);
    let own = |outcome: &Outcome| -> Vec<Metric> {
        let is_own = |metric: &&Metric| common.iter().all(|other| other.id != metric.id);
        outcome.metrics.iter().filter(is_own).copied().collect()
    };
    assert!(!own(&made).is_empty());
    assert_eq!(own(&made), own(expected));
    assert_eq!((made.transition, made.cycle), (expected.transition, expected.cycle));
    assert_eq!(made.retargeted, expected.retargeted);
    assert_eq!(made.layer(), expected.layer());
    assert!(made.beside == expected.beside, "other clips beside it");
    let sources = |outcome: &Outcome| -> Vec<_> {
        let source = |of: &PlacedClip| (of.slot, of.starts_at_secs, of.world_from_clip);
        outcome.sources.iter().map(source).collect()
    };
    assert_eq!(sources(&made), sources(expected));
    for (one, other) in made.sources.iter().zip(&expected.sources) {
        assert!(one.motion == other.motion, "another source");
    }
    let measured = |outcome: &Outcome| match &outcome.measured {
        MeasuredMotion::Clip(clip) => Some(Arc::clone(clip)),
        _ => None,
    };
    assert!(measured(&made) == measured(expected), "another clip is measured");
}

#[test]
fn result_of_a_worker_is_that_of_its_lab() {
    for link in [
        "lab=blend&a=walk&b=run",
        "lab=blend&a=walk&b=other&leave_a=0.4&root_blend=off&foot_lock=on",
        "lab=transition&a=run&b=walk&transition_method=dead&match_by=pose",
        "lab=transition&a=walk&b=run&transition_method=smooth&mistake=euler&mix_frame_b=3",
        // Both frames are given, so that a result is there before the distance of the poses.
        "lab=transition&a=walk&b=walk&mix_frame_a=0&mix_frame_b=0",
        "lab=layers&a=walk&b=run&mask=upper&feather=2&layer_weight=0.7",
        "lab=layers&a=walk&b=other&mask=whole&layer_mode=additive&layer_fit=hold&foot_lock=on",
        "lab=in_place&a=walk&foot_lock=on",
        "lab=in_place&a=walk_left&root_way=put_back&foot_lock=on",
        "lab=edit&a=walk&edit_from=0.2&edit_to=1.3&as_loop=on&mirror=on&foot_lock=on",
        "lab=edit&a=run&reverse=on&resample=24&turn=30&move_x=1",
    ] {
        let (mut session, ids) = session_of_rigs();
        let own = link.replace("b=other", &format!("b={}", ids[2]));
        session.apply(Command::OpenLink(format!("{own}&play=off"))).unwrap();
        settle(&mut session);
        assert_eq!(session.panes()[0].problem, None, "{link}");
        let retargeted = session.main_outcome().unwrap().retargeted.is_some();
        assert_eq!(retargeted, link.contains("b=other"), "{link}");
        assert_same_by_worker(&mut session);
    }
}

#[test]
fn result_that_cannot_be_made_is_none_of_a_worker() {
    let (mut session, ids) = session_of_rigs();
    let thing = &ids[7];
    session.apply(Command::OpenLink(format!("lab=blend&a=walk&b={thing}&play=off"))).unwrap();
    settle(&mut session);
    assert!(session.panes()[0].problem.is_some() && made_by_worker(&mut session).is_err());
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, ..ProptestConfig::default() })]
    #[test]
    fn any_settings_give_the_same_by_a_worker(
        lab in proptest::sample::select(&LABS[..]),
        clips in [0..8_usize, 0..8],
        values in (0..PARAMS.len()).map(any_value).collect::<Vec<_>>(),
    ) {
        let (mut session, ids) = session_of_rigs();
        let lab = Key::Lab.param().parse(lab).unwrap();
        let mut params = Params::default();
        params.set(Key::Lab, lab.clone()).unwrap();
        let of_lab = |(key, _): &(Key, Value)| {
            let param = key.param();
            param.is_ingredient_of(params.lab())
                && !matches!(param.kind, Kind::Clip | Kind::List(_) | Kind::Character)
        };
        let mut changes: Vec<_> = values.into_iter().filter(of_lab).collect();
        changes.extend([(Key::Lab, lab), (Key::Play, Value::Switch(false))]);
        for (key, at) in [Key::A, Key::B].into_iter().zip(clips) {
            changes.push((key, Value::Text(ids[at].clone())));
        }
        session.apply(Command::Set(changes)).unwrap();
        settle(&mut session);
        assert_same_by_worker(&mut session);
    }
}
