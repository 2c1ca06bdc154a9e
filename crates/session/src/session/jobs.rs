//! Jobs for workers.

use super::Session;
use crate::jobs::{Answer, Job};

impl Session {
    /// Sets the number of workers that take jobs. Without any, which is how a session begins,
    /// everything is done by [`work`](Self::work), with the same results; so are the jobs that
    /// workers have not finished.
    pub fn set_workers(&mut self, workers: usize) {
        self.labs.jobs.set_workers(workers);
    }

    /// Returns whether jobs wait for a worker.
    #[must_use]
    pub fn has_waiting_jobs(&self) -> bool {
        self.labs.jobs.has_waiting()
    }

    /// Takes the next job for a worker, counted from 0: those of what is on screen come first, and
    /// a worker gets what it has done before with other settings. `None` if there is none.
    pub fn take_job(&mut self, worker: usize) -> Option<Job> {
        self.labs.jobs.next(worker)
    }

    /// Returns whether the answer to a job that was taken is still wanted.
    #[must_use]
    pub fn is_job_wanted(&self, number: u64) -> bool {
        self.labs.jobs.is_wanted(number)
    }

    /// Takes in the answer to a job, and the time that it took, seconds. `None` is a job that no
    /// worker can run; [`work`](Self::work) then does its work.
    pub fn finish_job(&mut self, number: u64, answer: Option<Answer>, secs: f64) {
        self.labs.jobs.finish(number, answer, secs);
    }

    /// Notes that another worker has taken the place of one, and knows nothing yet.
    pub fn forget_worker(&mut self, worker: usize) {
        self.labs.jobs.forget_worker(worker);
    }

    /// Returns the numbers of clips, since the last call, that no job needs any more: workers
    /// should drop them.
    pub fn take_dropped_clips(&mut self) -> Vec<u32> {
        self.labs.jobs.take_dropped_clips()
    }
}
