//! The worker's side: it runs jobs on clips that it was given.

use super::any_task::{Answer, AnyTask, Job, Message};
use super::error::JobError;
use super::motion_parcel;
use super::task::JobClip;
use super::worker_memory::WorkerMemory;
use super::{Parcel, ParcelError};
use segue_motion::clip::Motion;
use std::collections::BTreeMap;
use std::sync::Arc;

/// A worker: it runs jobs, one after the other, on clips that it was given.
#[derive(Debug)]
pub struct Worker {
    clips: BTreeMap<u32, Arc<Motion>>,
    memory: WorkerMemory,
}

impl Worker {
    /// Returns a worker without clips, which keeps about `max_bytes` of intermediate results.
    #[must_use]
    pub fn new(max_bytes: usize) -> Self {
        Self { clips: BTreeMap::new(), memory: WorkerMemory::new(max_bytes) }
    }

    /// Takes in a clip ([`JobClip::parcel_without_floats`], with its floats).
    ///
    /// # Errors
    /// [`ParcelError`] when the parcel contains none.
    pub fn take_clip(&mut self, number: u32, parcel: &Parcel) -> Result<(), ParcelError> {
        self.clips.insert(number, Arc::new(motion_parcel::unpack(parcel)?));
        Ok(())
    }

    /// Drops a clip, and what was computed from it.
    pub fn drop_clip(&mut self, number: u32) {
        self.clips.remove(&number);
        self.memory.forget(number);
    }

    /// Runs a job that came as a message ([`Job::message`]), on clips that came before.
    ///
    /// # Errors
    /// [`JobError`] when there is no answer.
    pub fn run_message(&mut self, message: &str) -> Result<Parcel, JobError> {
        let message: Message<AnyTask> = serde_json::from_str(message).map_err(ParcelError::Head)?;
        let clip = |number: u32| {
            let motion = self.clips.get(&number).ok_or(JobError::NoClip(number))?;
            Ok(JobClip { number, motion: Arc::clone(motion) })
        };
        let clips: Result<Vec<JobClip>, JobError> = message.clips.into_iter().map(clip).collect();
        let clips = clips?;
        Ok(message.task.run(&clips, &mut self.memory)?.pack(&clips)?)
    }

    /// Runs a job on its own clips, in the memory of the app.
    ///
    /// # Errors
    /// [`JobError`] when there is no answer.
    pub fn run(&mut self, job: &Job) -> Result<Answer, JobError> {
        job.task.run(&job.clips, &mut self.memory)
    }
}
