//! The jobs that wait for workers, those that run, and the answers.

use super::any_task::{Answer, AnyTask, Job, Kind};
use super::task::JobClip;
use segue_motion::clip::Motion;
use std::collections::{BTreeMap, VecDeque};
use std::marker::PhantomData;
use std::sync::{Arc, Weak};

/// The jobs of all labs. Labs offer jobs and ask for the answers; the app takes jobs and hands the
/// answers in.
///
/// A job is wanted as long as its [`Ticket`] exists: dropping that cancels it.
#[derive(Debug, Default)]
pub(crate) struct JobBoard {
    workers: usize,
    last_number: u64,
    waiting: VecDeque<Offered>,
    running: BTreeMap<u64, Weak<()>>,
    finished: BTreeMap<u64, Finished>,
    clips: ClipNumbers,
    /// The worker that was given the last job with an affinity.
    owners: BTreeMap<u64, usize>,
}

/// A job that waits.
#[derive(Debug)]
struct Offered {
    job: Job,
    affinity: u64,
    wanted: Weak<()>,
}

/// A job that has ended.
#[derive(Debug)]
struct Finished {
    wanted: Weak<()>,
    /// `None` where no worker can run it.
    answer: Option<Answer>,
    secs: f64,
}

/// A claim to the answer of a job; the job is cancelled when it is dropped.
#[derive(Debug)]
pub(crate) struct Ticket<T> {
    number: u64,
    wanted: Arc<()>,
    kind: PhantomData<fn() -> T>,
}

/// The state of a job.
#[derive(Debug)]
pub(crate) enum Taken<A> {
    /// It waits or runs.
    Waits,
    /// Its answer, and the seconds that it took.
    Answer(A, f64),
    /// It cannot be run by workers.
    Failed,
}

/// The numbers under which clips are sent to workers.
#[derive(Debug, Default)]
struct ClipNumbers {
    last: u32,
    known: Vec<(u32, Weak<Motion>)>,
}

impl ClipNumbers {
    fn of(&mut self, motion: &Arc<Motion>) -> u32 {
        let is_it = |(_, known): &&(u32, Weak<Motion>)| {
            std::ptr::eq(known.as_ptr(), Arc::as_ptr(motion)) && known.strong_count() > 0
        };
        if let Some((number, _)) = self.known.iter().find(is_it) {
            return *number;
        }
        self.last += 1;
        self.known.push((self.last, Arc::downgrade(motion)));
        self.last
    }
}

impl JobBoard {
    /// Sets the number of workers that take jobs. Without any, all jobs fail.
    pub(crate) fn set_workers(&mut self, workers: usize) {
        self.workers = workers;
        if workers == 0 {
            let waiting = std::mem::take(&mut self.waiting).into_iter();
            let waiting = waiting.map(|offered| (offered.job.number, offered.wanted));
            let all = waiting.chain(std::mem::take(&mut self.running));
            self.finished.extend(
                all.map(|(number, wanted)| (number, Finished { wanted, answer: None, secs: 0.0 })),
            );
            self.owners.clear();
        }
    }

    /// Returns whether there are workers to offer jobs to.
    pub(crate) fn has_workers(&self) -> bool {
        self.workers > 0
    }

    /// Offers a job, behind those that wait.
    pub(crate) fn offer<T: Kind>(&mut self, task: T, motions: &[Arc<Motion>]) -> Ticket<T> {
        self.last_number += 1;
        let clip = |motion: &Arc<Motion>| JobClip {
            number: self.clips.of(motion),
            motion: Arc::clone(motion),
        };
        let clips = motions.iter().map(clip).collect();
        let task: AnyTask = task.into();
        let job = Job { number: self.last_number, clips, task };
        let wanted = Arc::new(());
        self.waiting.push_back(Offered {
            affinity: job.affinity(),
            job,
            wanted: Arc::downgrade(&wanted),
        });
        Ticket { number: self.last_number, wanted, kind: PhantomData }
    }

    /// Takes the answer of a job, if it is there.
    pub(crate) fn take<T: Kind>(&mut self, ticket: &Ticket<T>) -> Taken<T::Answer> {
        debug_assert!(Arc::strong_count(&ticket.wanted) > 0);
        match self.finished.remove(&ticket.number) {
            None => Taken::Waits,
            Some(Finished { answer, secs, .. }) => match answer.and_then(T::output) {
                Some(answer) => Taken::Answer(answer, secs),
                None => Taken::Failed,
            },
        }
    }

    /// Takes the next job for a worker: one that it has begun with another setting before, one that
    /// no worker has, or one of another worker.
    pub(crate) fn next(&mut self, worker: usize) -> Option<Job> {
        self.waiting.retain(|offered| offered.wanted.strong_count() > 0);
        self.running.retain(|_, wanted| wanted.strong_count() > 0);
        let owner = |offered: &Offered| self.owners.get(&offered.affinity).copied();
        let mut waiting = self.waiting.iter();
        let at = waiting.position(|offered| owner(offered) == Some(worker));
        let at = at.or_else(|| self.waiting.iter().position(|offered| owner(offered).is_none()));
        // From the end, which its owner reaches last.
        let at = at.or_else(|| self.waiting.len().checked_sub(1))?;
        let Offered { job, affinity, wanted } = self.waiting.remove(at)?;
        self.owners.insert(affinity, worker);
        self.running.insert(job.number, wanted);
        Some(job)
    }

    /// Returns whether jobs wait for a worker.
    pub(crate) fn has_waiting(&self) -> bool {
        self.waiting.iter().any(|offered| offered.wanted.strong_count() > 0)
    }

    /// Returns whether a job that runs is still wanted.
    pub(crate) fn is_wanted(&self, number: u64) -> bool {
        self.running.get(&number).is_some_and(|wanted| wanted.strong_count() > 0)
    }

    /// Takes in the answer of a job, `None` where no worker can run it, and the seconds that it
    /// took. Answers that nothing waits for are dropped.
    pub(crate) fn finish(&mut self, number: u64, answer: Option<Answer>, secs: f64) {
        self.finished.retain(|_, finished| finished.wanted.strong_count() > 0);
        if let Some(wanted) =
            self.running.remove(&number).filter(|wanted| wanted.strong_count() > 0)
        {
            self.finished.insert(number, Finished { wanted, answer, secs });
        }
    }

    /// Forgets what a worker has computed before: another one has taken its place.
    pub(crate) fn forget_worker(&mut self, worker: usize) {
        self.owners.retain(|_, owner| *owner != worker);
    }

    /// Returns the numbers of clips that no longer exist, so that workers drop them, too.
    pub(crate) fn take_dropped_clips(&mut self) -> Vec<u32> {
        let mut dropped = Vec::new();
        self.clips.known.retain(|(number, motion)| {
            let exists = motion.strong_count() > 0;
            if !exists {
                dropped.push(*number);
            }
            exists
        });
        if !dropped.is_empty() && self.clips.known.is_empty() {
            self.owners.clear();
        }
        dropped
    }
}
