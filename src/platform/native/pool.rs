//! A pool of threads that compute, each with a memory of its own.

use crate::platform::Inbox;
use crate::platform::pool_size::{PoolSize, PoolStats};
use segue_session::Session;
use segue_session::jobs::{Answer, Job, Worker};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::Instant;

/// The memory that all threads together may keep of intermediate results, bytes.
const MAX_KEPT_BYTES: usize = 1 << 30;

/// A pool of threads. They begin with the first job.
#[derive(Debug)]
pub(crate) struct Pool {
    inbox: Inbox,
    /// The number of threads that it starts, at most.
    size: usize,
    threads: Vec<Sender<Task>>,
    /// The number of jobs that each thread has.
    running: Vec<usize>,
    answers: Receiver<Ended>,
    sender: Sender<Ended>,
    jobs: u64,
}

/// A message to a thread.
#[derive(Debug)]
enum Task {
    Run(Job),
    Drop(u32),
}

/// A job that has ended.
#[derive(Debug)]
struct Ended {
    thread: usize,
    number: u64,
    answer: Option<Answer>,
    secs: f64,
}

/// Does nothing, because a window draws a frame when it is woken.
pub(crate) fn set_answer_listener(_listener: impl Fn() + 'static) {}

impl Pool {
    /// Returns a pool that wakes the app by `inbox`.
    pub(crate) fn new(inbox: &Inbox) -> Self {
        let (sender, answers) = channel();
        Self {
            inbox: inbox.clone(),
            size: PoolSize::for_cores(std::thread::available_parallelism().map_or(1, usize::from)),
            threads: Vec::new(),
            running: Vec::new(),
            answers,
            sender,
            jobs: 0,
        }
    }

    /// Returns the number of threads.
    pub(crate) fn size(&self) -> usize {
        self.size
    }

    /// Returns what the threads have done.
    pub(crate) fn stats(&self) -> PoolStats {
        PoolStats { running: self.threads.len(), jobs: self.jobs, replaced: 0 }
    }

    /// Returns whether threads are at jobs.
    pub(crate) fn is_busy(&self) -> bool {
        self.running.iter().any(|&jobs| jobs > 0)
    }

    /// Hands the session the answers that have arrived.
    pub(crate) fn receive(&mut self, session: &mut Session) {
        while let Ok(Ended { thread, number, answer, secs }) = self.answers.try_recv() {
            self.jobs += u64::from(answer.is_some());
            session.finish_job(number, answer, secs);
            if let Some(running) = self.running.get_mut(thread) {
                *running = running.saturating_sub(1);
            }
        }
    }

    /// Hands the session's jobs to threads. Returns `false`: nothing is left to send.
    pub(crate) fn send(&mut self, session: &mut Session, _has_begun: bool, _until_ms: f64) -> bool {
        let dropped = session.take_dropped_clips();
        for thread in &self.threads {
            for &clip in &dropped {
                // A thread that has ended has no clips.
                thread.send(Task::Drop(clip)).ok();
            }
        }
        if session.has_waiting_jobs() {
            while self.threads.len() < self.size() {
                self.start_thread();
            }
        }
        for (at, (thread, running)) in self.threads.iter().zip(&mut self.running).enumerate() {
            if *running > 0 {
                continue;
            }
            let Some(job) = session.take_job(at) else { break };
            let number = job.number;
            if thread.send(Task::Run(job)).is_ok() {
                *running += 1;
            } else {
                session.finish_job(number, None, 0.0);
            }
        }
        false
    }

    fn start_thread(&mut self) {
        let (sender, tasks) = channel();
        let (answers, inbox) = (self.sender.clone(), self.inbox.clone());
        let (thread, max_bytes) = (self.threads.len(), MAX_KEPT_BYTES / self.size());
        std::thread::spawn(move || {
            let mut worker = Worker::new(max_bytes);
            while let Ok(task) = tasks.recv() {
                let job = match task {
                    Task::Run(job) => job,
                    Task::Drop(clip) => {
                        worker.drop_clip(clip);
                        continue;
                    }
                };
                let began = Instant::now();
                let answer = catch_unwind(AssertUnwindSafe(|| worker.run(&job).ok()));
                if answer.is_err() {
                    worker = Worker::new(max_bytes);
                }
                let secs = began.elapsed().as_secs_f64();
                let (number, answer) = (job.number, answer.ok().flatten());
                if answers.send(Ended { thread, number, answer, secs }).is_err() {
                    return;
                }
                inbox.wake();
            }
        });
        self.threads.push(sender);
        self.running.push(0);
    }
}
