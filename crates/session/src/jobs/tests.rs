//! Tests of jobs: results do not depend on where and in which order they are run.

use super::any_task::Kind as _;
use super::*;
use crate::fixtures::*;
use crate::labs::Distances;
use crate::params::MAX_PANES;
use crate::reading::{Content, read};
use crate::{ClipEdit, JobKind, Request};
use proptest::prelude::*;
use segue_motion::clip::ContactCorrection;
use segue_motion::clip::fixtures::QuadrupedWalk;
use segue_motion::matching::Database;
use segue_motion::skeleton::{Foot, Side};
use std::collections::BTreeSet;

mod results;

/// Workers as a page has them: jobs, clips and answers are messages.
struct Workers {
    all: Vec<Worker>,
    clips: Vec<BTreeSet<u32>>,
    /// Jobs that were run, whose answers have not been handed in.
    ended: Vec<(u64, Answer)>,
    /// The number of jobs that were run.
    run: usize,
    state: u64,
}

impl Workers {
    fn new(count: usize, seed: u64) -> Self {
        Self {
            all: (0..count).map(|_| Worker::new(1 << 26)).collect(),
            clips: vec![BTreeSet::new(); count],
            ended: Vec::new(),
            run: 0,
            state: seed,
        }
    }

    fn draw(&mut self, below: usize) -> usize {
        let next = self.state.wrapping_mul(6_364_136_223_846_793_005);
        self.state = next.wrapping_add(1_442_695_040_888_963_407);
        (self.state >> 33) as usize % below.max(1)
    }

    /// Replaces a worker that ended.
    fn replace(&mut self, session: &mut Session, worker: usize) {
        self.all[worker] = Worker::new(1 << 26);
        self.clips[worker].clear();
        session.forget_worker(worker);
    }

    /// Runs one waiting job in a worker drawn by chance; returns `false` without one.
    fn run_one(&mut self, session: &mut Session) -> bool {
        let at = self.draw(self.all.len());
        for number in session.take_dropped_clips() {
            for (worker, clips) in self.all.iter_mut().zip(&mut self.clips) {
                worker.drop_clip(number);
                clips.remove(&number);
            }
        }
        let Some(job) = session.take_job(at) else { return false };
        let worker = &mut self.all[at];
        for clip in &job.clips {
            if self.clips[at].insert(clip.number) {
                worker.take_clip(clip.number, &parcel_of(clip)).unwrap();
            }
        }
        let parcel = worker.run_message(&job.message().unwrap()).unwrap();
        self.ended.push((job.number, job.answer(parcel).unwrap()));
        self.run += 1;
        true
    }

    /// Does all work of a session, in an order drawn by chance.
    fn settle(&mut self, session: &mut Session) {
        loop {
            while session.work() {}
            let has_run = self.draw(3) > 0 && self.run_one(session);
            if !has_run && !self.ended.is_empty() {
                let at = self.draw(self.ended.len());
                let (number, answer) = self.ended.swap_remove(at);
                session.finish_job(number, Some(answer), 0.01);
            } else if !has_run && !self.run_one(session) {
                assert!(session.jobs().is_empty(), "{:?}", session.jobs());
                return;
            }
        }
    }
}

/// Returns the parcel of a clip, put together from its pieces as a worker does.
fn parcel_of(clip: &JobClip) -> Parcel {
    let mut parcel = clip.parcel_without_floats().unwrap();
    while parcel.floats.len() < clip.floats() {
        let piece = clip.piece(parcel.floats.len(), 1000);
        assert!((1..=1000).contains(&piece.len()));
        parcel.floats.extend_from_slice(piece);
    }
    assert!(clip.piece(clip.floats(), 1000).is_empty());
    parcel
}

fn set(session: &mut Session, key: Key, value: Value) {
    session.apply(Command::Set(vec![(key, value)])).unwrap();
}

/// A session that computes by itself, and one with workers.
struct Both {
    alone: Session,
    session: Session,
}

impl Both {
    /// Opens the same in both, and waits for the results.
    fn opened(workers: &mut Workers, open: impl Fn(&mut Session)) -> Self {
        let mut both = Self { alone: Session::new(), session: Session::new() };
        both.session.set_workers(workers.all.len());
        both.change(workers, open);
        both
    }

    /// Changes both, and waits for the results, which are the same.
    fn change(&mut self, workers: &mut Workers, change: impl Fn(&mut Session)) {
        change(&mut self.alone);
        while self.alone.work() {}
        change(&mut self.session);
        workers.settle(&mut self.session);
        assert_same(&self.session, &self.alone);
    }
}

/// Asserts that two sessions show the same, to the last bit.
fn assert_same(one: &Session, other: &Session) {
    for (one, other) in one.panes().iter().zip(other.panes()) {
        assert_eq!(one.problem, other.problem);
        let (one, other) = (one.outcome.as_ref().unwrap(), other.outcome.as_ref().unwrap());
        assert!(one.motion == other.motion, "another motion");
        assert_eq!(one.metrics, other.metrics);
    }
    match (one.graph_field(), other.graph_field()) {
        (Some(one), Some(other)) => {
            assert_eq!(one.histogram(), other.histogram());
            let [Distances::Held(one), Distances::Held(other)] =
                [one.distances(), other.distances()]
            else {
                panic!("the distances are not held");
            };
            assert!(one == other, "other distances");
        }
        (None, None) => {}
        _ => panic!("one has distances"),
    }
    let jumps =
        |session: &Session| session.graph_built().map(|built| built.graph().jumps().to_vec());
    assert!(jumps(one) == jumps(other), "another graph");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4))]
    #[test]
    fn graph_of_workers_is_that_of_a_session_without(workers in 1usize..4, seed: u64) {
        let link = "lab=graph&walk_seconds=10&play=off";
        let mut workers = Workers::new(workers, seed);
        let mut both = Both::opened(&mut workers, |session| {
            session.apply(Command::OpenLink(link.into())).unwrap();
        });
        prop_assert!(workers.run > 1);
        // Another window from the same products; another threshold from the same distances.
        for (key, value) in [(Key::BlendWindow, 17.0), (Key::EdgeThreshold, 19.0)] {
            let before = workers.run;
            both.change(&mut workers, |session| set(session, key, Value::Number(value)));
            prop_assert!(workers.run > before);
        }
    }

    #[test]
    fn registrations_of_workers_are_those_of_a_session_without(workers in 1usize..4, seed: u64) {
        let made = [1.0, 2.0, 3.0].map(made_bvh_of_12_secs);
        let open = |session: &mut Session| {
            let ids: Vec<String> = (made.iter().zip(["x.bvh", "y.bvh", "z.bvh"]))
                .map(|(bytes, name)| session.load(name, Arc::clone(bytes)).unwrap().ids.remove(0))
                .collect();
            let link = format!(
                "lab=register&play=off&a={}&b={}&warp_also=0.3:{}", ids[0], ids[1], ids[2]
            );
            session.apply(Command::OpenLink(link)).unwrap();
        };
        let mut workers = Workers::new(workers, seed);
        let mut both = Both::opened(&mut workers, open);
        prop_assert_eq!(workers.run, 2);
        for (key, value) in [(Key::RegistrationWindow, 9.0), (Key::SlopeLimit, 3.0)] {
            both.change(&mut workers, |session| set(session, key, Value::Number(value)));
        }
        prop_assert_eq!(workers.run, 6);
    }

    #[test]
    fn database_of_workers_is_that_of_a_session_without(workers in 1usize..4, seed: u64) {
        let open = |session: &mut Session| {
            let link = format!("lab=match&scenario=spin&match_clips={}", load_mixed_clips(session));
            session.apply(Command::OpenLink(link)).unwrap();
        };
        let mut workers = Workers::new(workers, seed);
        let mut both = Both::opened(&mut workers, open);
        prop_assert_eq!(workers.run, 4);
        assert!(database(&both.session) == database(&both.alone), "another database");
        let found = database(&both.session);
        prop_assert_eq!((found.motions().len(), found.skipped().len()), (6, 1));
        prop_assert_eq!(found.retargeted().len(), 1);
        // Without mirror images all are measured again; other trajectory times need no worker.
        for (key, value, run) in
            [(Key::Mirrored, Value::Switch(false), 8), (Key::AheadFar, Value::Number(0.9), 8)]
        {
            both.change(&mut workers, |session| set(session, key, value.clone()));
            prop_assert_eq!(workers.run, run);
            assert!(database(&both.session) == database(&both.alone), "another database");
        }
    }
}

fn database(session: &Session) -> &Arc<Database> {
    &session.main_outcome().unwrap().driven().unwrap().database
}

/// Loads clips of two rigs and one that is too short, and returns their ids as in a link.
fn load_mixed_clips(session: &mut Session) -> String {
    let mut made = opened("lab=make&make_seconds=30");
    made.work();
    let long = Arc::clone(made.main_outcome().unwrap().motion.clip());
    let short = Arc::new(long.crop(0..20).unwrap());
    let tall = Arc::new(long.scaled(1.3));
    let clips = [("x.bvh", &long), ("y.bvh", &short), ("z.bvh", &tall), ("w.bvh", &long)];
    let ids = clips.map(|(name, clip)| {
        let options = segue_formats::bvh::WriteOptions::default();
        let file = segue_formats::bvh::write(clip, &options).into_bytes().into();
        session.load(name, file).unwrap().ids.remove(0)
    });
    ids.join(",")
}

/// Returns a synthesised walk of 12 seconds as a BVH file.
fn made_bvh_of_12_secs(seed: f64) -> Arc<[u8]> {
    let mut session = opened(&format!("lab=make&make_seconds=12&seed={seed}"));
    session.work();
    let clip = Arc::clone(session.main_outcome().unwrap().motion.clip());
    segue_formats::bvh::write(&clip, &segue_formats::bvh::WriteOptions::default())
        .into_bytes()
        .into()
}

/// Returns a walk of more than two minutes as a BVH file: some seconds again and again.
fn long_bvh(times: usize) -> Arc<[u8]> {
    let once = made_bvh_of_12_secs(4.0);
    let text = std::str::from_utf8(&once).unwrap();
    let (head, rows) = text.split_once("Frame Time:").unwrap();
    let (time, rows) = rows.split_once('\n').unwrap();
    let (skeleton, _) = head.split_once("Frames:").unwrap();
    let frames = times * rows.lines().count();
    format!("{skeleton}Frames: {frames}\nFrame Time:{time}\n{}", rows.repeat(times))
        .into_bytes()
        .into()
}

/// Loads a long file as a page does, and returns the id of its clip.
fn load_long(bytes: &[u8], session: &mut Session) -> String {
    let size = bytes.len() as u64;
    let task = session.begin_reading("long.bvh", Content::Outside("file 1".into()), size);
    let setup = session.take_requests().into_iter().find_map(|request| match request {
        Request::Read(task) => Some(task.setup),
        _ => None,
    });
    let report = read("long.bvh", bytes, &setup.unwrap(), &mut |_| true).unwrap();
    session.finish_reading(task, Ok(report)).unwrap().unwrap().ids.remove(0)
}

#[test]
fn work_for_a_long_clip_is_the_same_by_workers_and_without() {
    let bytes = long_bvh(12);
    let open = |session: &mut Session| {
        let id = load_long(&bytes, session);
        session.apply(Command::OpenLink(format!("lab=view&play=off&a={id}"))).unwrap();
    };
    let mut workers = Workers::new(2, 3);
    let mut both = Both::opened(&mut workers, open);
    // The analysis of the clip, and its measurement.
    assert_eq!(workers.run, 2);
    let changes = [
        (Key::FootLock, Value::Switch(true), 3),
        // The feet are read anew, and the clip is another one.
        (Key::ContactHeight, Value::Number(3.0), 5),
        // The clip with its usual contacts is known; its cycle is searched, and its feet are not
        // locked.
        (Key::Lab, Value::Choice("loop"), 6),
        (Key::LoopFrom, Value::Number(3.0), 7),
        // Its faults, and their mends.
        (Key::Lab, Value::Choice("clean"), 9),
        (Key::CleanJitter, Value::Switch(false), 10),
    ];
    for (key, value, run) in changes {
        both.change(&mut workers, |session| set(session, key, value.clone()));
        assert_eq!(workers.run, run, "{key:?}");
    }
    assert!(both.session.main_outcome().unwrap().cleaned().is_some());
    // A layer of it over itself, and another one.
    both.change(&mut workers, |session| {
        let long = session.params().text(Key::A).to_owned();
        set(session, Key::B, Value::Text(long));
        set(session, Key::Lab, Value::Choice("layers"));
    });
    assert!(both.session.main_outcome().unwrap().layer().is_some());
    let run = workers.run;
    both.change(&mut workers, |session| set(session, Key::LayerWeight, Value::Number(0.5)));
    assert_eq!(workers.run, run + 1);
    // Where no worker has an answer, the session has its own.
    let mut alone = Session::new();
    alone.set_workers(1);
    open(&mut alone);
    let motion = |session: &Session| session.slot(Slot::A).unwrap().motion.clone().unwrap();
    assert!(alone.is_analyzing(&motion(&alone)) && !both.alone.is_analyzing(&motion(&both.alone)));
    assert!(alone.contact_clips().is_empty() && !motion(&alone).is_analyzed());
    assert_eq!(alone.jobs().first().map(|job| &job.kind), Some(&JobKind::Analyzing));
    while alone.work() || alone.has_waiting_jobs() {
        if let Some(job) = alone.take_job(0) {
            // A job of a worker is listed: the page's API waits until none is.
            assert!(!alone.jobs().is_empty());
            alone.finish_job(job.number, None, 0.0);
        }
    }
    open(&mut both.alone);
    while both.alone.work() {}
    assert_same(&alone, &both.alone);
    assert!(!alone.is_analyzing(&motion(&alone)));
}

#[test]
fn registration_without_a_path_is_tried_by_a_worker_once() {
    let made = [1.0, 2.0].map(made_bvh_of_12_secs);
    let open = |session: &mut Session| {
        let ids: Vec<String> = (made.iter().zip(["x.bvh", "y.bvh"]))
            .map(|(bytes, name)| session.load(name, Arc::clone(bytes)).unwrap().ids.remove(0))
            .collect();
        // No path leads forwards through both pins.
        let link = format!(
            "lab=register&play=off&a={}&b={}&pins=600-100,100-600&compare=slope_limit:2,3",
            ids[0], ids[1]
        );
        session.apply(Command::OpenLink(link)).unwrap();
    };
    let problems = |session: &Session| -> Vec<_> {
        session.panes().iter().map(|pane| pane.problem.clone().unwrap()).collect()
    };
    let mut alone = Session::new();
    open(&mut alone);
    while alone.work() {}
    let (mut workers, mut session) = (Workers::new(1, 1), Session::new());
    session.set_workers(1);
    open(&mut session);
    while session.work() {}
    while workers.run_one(&mut session) {}
    // Both answers are there before the session looks for a reason.
    for (number, answer) in std::mem::take(&mut workers.ended) {
        session.finish_job(number, Some(answer), 0.01);
    }
    while session.work() {}
    assert!(!session.has_waiting_jobs(), "it is offered again");
    assert_eq!((workers.run, problems(&session)), (2, problems(&alone)));
}

#[test]
fn edit_for_the_library_waits_for_no_worker() {
    let mut session = Session::new();
    let id = load_long(&long_bvh(48), &mut session);
    assert!(session.library().find(&id).unwrap().facts.as_ref().unwrap().frames >= 32_000);
    session.set_workers(1);
    session.apply(Command::OpenLink(format!("lab=view&play=off&a={id}"))).unwrap();
    Workers::new(1, 1).settle(&mut session);
    let clips = session.library().entries().len();
    session.apply(Command::Edit(id, ClipEdit::Mirror, None)).unwrap();
    assert_eq!(session.library().entries().len(), clips + 1);
}

#[test]
fn job_of_a_worker_that_ended_is_done_by_another() {
    let link = "lab=graph&walk_seconds=10&play=off";
    let mut workers = Workers::new(2, 1);
    let mut session = Session::new();
    session.set_workers(2);
    session.apply(Command::OpenLink(link.into())).unwrap();
    while session.work() {}
    // The first job is lost with its worker; the app keeps it, and gives it to the next one.
    let lost = session.take_job(0).unwrap();
    workers.replace(&mut session, 0);
    assert!(session.is_job_wanted(lost.number));
    let mut other = Worker::new(1 << 20);
    workers.ended.push((lost.number, other.run(&lost).unwrap()));
    workers.settle(&mut session);
    assert_same(&session, &opened(link));
}

#[test]
fn job_that_no_worker_can_run_is_done_by_the_session() {
    let link = "lab=graph&walk_seconds=10&play=off";
    let alone = opened(link);
    for all in [false, true] {
        let mut session = Session::new();
        session.set_workers(2);
        session.apply(Command::OpenLink(link.into())).unwrap();
        while session.work() {}
        let job = session.take_job(1).unwrap();
        if all {
            // All workers have ended for good.
            session.set_workers(0);
        } else {
            session.finish_job(job.number, None, 0.0);
        }
        while session.work() {}
        assert!(session.take_job(0).is_none());
        assert_same(&session, &alone);
    }
}

#[test]
fn jobs_for_what_was_left_are_cancelled() {
    let mut session = Session::new();
    session.set_workers(1);
    session.apply(Command::OpenLink("lab=graph&play=off".into())).unwrap();
    while session.work() {}
    let job = session.take_job(0).unwrap();
    assert!(session.has_waiting_jobs() && session.is_job_wanted(job.number));
    let progress = |session: &Session| session.jobs().first().map(|job| job.progress);
    let before = progress(&session).unwrap();
    let answer = Worker::new(0).run(&job).unwrap();
    session.finish_job(job.number, Some(answer), 0.1);
    while session.work() {}
    assert!(progress(&session).unwrap() > before);
    // Another window: the jobs of the first one are not run.
    set(&mut session, Key::BlendWindow, Value::Number(12.0));
    let stale = session.take_job(0).unwrap();
    while session.work() {}
    assert!(!session.is_job_wanted(stale.number));
    let job = session.take_job(0).unwrap();
    assert!(session.is_job_wanted(job.number) && job.message().unwrap().contains(":12,"));
    session.apply(Command::OpenLink("lab=view".into())).unwrap();
    while session.work() {}
    assert!(!session.has_waiting_jobs() && !session.is_job_wanted(job.number));
    assert!(session.jobs().is_empty());
}

#[test]
fn database_whose_clips_workers_cannot_measure_is_built_by_the_session() {
    let open = |session: &mut Session| {
        let link = format!("lab=match&scenario=spin&match_clips={}", load_mixed_clips(session));
        session.apply(Command::OpenLink(link)).unwrap();
    };
    let mut alone = Session::new();
    open(&mut alone);
    while alone.work() {}
    let mut session = Session::new();
    session.set_workers(1);
    open(&mut session);
    while session.work() {}
    let progress = |session: &Session| session.jobs().first().map(|job| job.progress);
    let before = progress(&session).unwrap();
    // One has an answer, one has none, and the others are left when all workers have ended.
    let [first, second] = [(); 2].map(|()| session.take_job(0).unwrap());
    session.finish_job(second.number, Some(Worker::new(0).run(&second).unwrap()), 0.1);
    while session.work() {}
    assert!(progress(&session).unwrap() > before);
    session.finish_job(first.number, None, 0.0);
    while session.work() {}
    let third = session.take_job(0).unwrap();
    assert!(session.is_job_wanted(third.number));
    session.set_workers(0);
    while session.work() {}
    assert_same(&session, &alone);
    assert!(database(&session) == database(&alone), "another database");
}

#[test]
fn measurement_of_clips_is_cancelled_when_the_lab_is_left_and_goes_on_later() {
    let mut workers = Workers::new(1, 7);
    let mut session = Session::new();
    session.set_workers(1);
    let link = format!("lab=match&scenario=spin&match_clips={}", load_mixed_clips(&mut session));
    session.apply(Command::OpenLink(link.clone())).unwrap();
    while session.work() {}
    assert!(workers.run_one(&mut session) && session.has_waiting_jobs());
    for (number, answer) in std::mem::take(&mut workers.ended) {
        session.finish_job(number, Some(answer), 0.1);
    }
    while session.work() {}
    session.apply(Command::OpenLink("lab=view".into())).unwrap();
    while session.work() {}
    assert!(!session.has_waiting_jobs() && session.jobs().is_empty());
    session.apply(Command::OpenLink(link)).unwrap();
    workers.settle(&mut session);
    assert_eq!(workers.run, 4, "the clip that was measured is not measured again");
    assert_eq!(database(&session).motions().len(), 6);
}

#[test]
fn clip_of_a_database_that_is_the_own_one_is_not_sent_back() {
    let mut session = Session::new();
    session.set_workers(1);
    session.apply(Command::OpenLink("lab=match&scenario=spin".into())).unwrap();
    while session.work() {}
    let (mut own, mut all, mut worker) = (0, 0, Worker::new(0));
    while let Some(job) = session.take_job(0) {
        let clip = &job.clips[0];
        worker.take_clip(clip.number, &parcel_of(clip)).unwrap();
        let parcel = worker.run_message(&job.message().unwrap()).unwrap();
        let measured = DatabaseClipTask::output(job.answer(parcel.clone()).unwrap()).unwrap();
        // A cycle is closed, and is another clip.
        let is_own = Arc::ptr_eq(measured.motions[0].clip(), clip.motion.clip());
        assert_ne!(is_own, measured.motions[0].is_cycle());
        own += usize::from(is_own);
        all += 1;
        let torn = Parcel { bytes: parcel.bytes[1..].to_vec(), ..parcel.clone() };
        assert!(job.answer(torn).is_err());
        let torn = Parcel { floats: parcel.floats[1..].to_vec(), ..parcel };
        assert!(job.answer(torn).is_err());
    }
    assert!(own > 0 && own < all, "{own} of {all}");
}

#[test]
fn short_work_is_not_offered() {
    let mut session = Session::new();
    session.set_workers(MAX_PANES);
    for link in [
        "lab=graph&clips=walk,walk_left&play=off",
        "lab=register&play=off",
        "lab=blend",
        "lab=match&scenario=spin&match_clips=idle,walk,walk_left",
    ] {
        session.apply(Command::OpenLink(link.into())).unwrap();
        while session.work() {}
        assert!(!session.has_waiting_jobs() && session.main_outcome().is_some(), "{link}");
    }
}

#[test]
fn motion_in_a_parcel_stays_the_same() {
    let session = opened("lab=view&a=walk");
    let motion = &session.main_outcome().unwrap().motion;
    let correction = ContactCorrection { foot: Side::Left.into(), frames: 3..9, planted: false };
    let corrected = Motion::clone(motion)
        .with_contact_corrections([correction].into_iter().collect())
        .with_seams(std::iter::once(4..7).collect())
        .declared_cycle(true);
    let fresh = Motion::with_roles(Arc::clone(motion.clip()), motion.roles());
    let on_four = Motion::analyze(QuadrupedWalk::default().clip());
    let correction = ContactCorrection { foot: Foot::ALL[3], frames: 3..9, planted: true };
    let of_forefeet =
        on_four.clone().with_contact_corrections(std::iter::once(correction).collect());
    assert_eq!(of_forefeet.contacts().feet(), Foot::ALL);
    for motion in [Motion::clone(motion), corrected, fresh, on_four, of_forefeet] {
        let clip = JobClip { number: 1, motion: Arc::new(motion.clone()) };
        let parcel = parcel_of(&clip);
        assert!(motion_parcel::unpack(&parcel).unwrap() == motion);
        // A message that is cut off is refused.
        let torn = Parcel { floats: parcel.floats[1..].to_vec(), ..parcel.clone() };
        assert!(motion_parcel::unpack(&torn).is_err());
        let torn = Parcel { head: parcel.head[1..].to_owned(), ..parcel };
        assert!(motion_parcel::unpack(&torn).is_err());
    }
}

#[test]
fn answer_that_is_none_is_refused() {
    let mut session = Session::new();
    session.set_workers(1);
    session.apply(Command::OpenLink("lab=graph&play=off".into())).unwrap();
    while session.work() {}
    let job = session.take_job(0).unwrap();
    let parcel = Worker::new(0).run(&job).unwrap().pack(&job.clips).unwrap();
    assert!(job.answer(parcel.clone()).is_ok());
    let torn = Parcel { bytes: parcel.bytes[4..].to_vec(), ..parcel.clone() };
    assert!(job.answer(torn).is_err());
    assert!(job.answer(Parcel { head: "{}".into(), ..parcel }).is_err());
    assert!(Worker::new(0).run_message(&job.message().unwrap()).is_err(), "without the clips");
    assert!(Worker::new(0).run_message("no message").is_err());
}
