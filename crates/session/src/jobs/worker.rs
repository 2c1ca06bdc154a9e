//! The worker's side: clips, and the memory between jobs.

use super::motion_parcel;
use super::task::{Answer, AnyTask, Job, JobClip, Message};
use super::{Parcel, ParcelError};
use segue_motion::clip::Motion;
use segue_motion::graph::{GraphError, StreamComputer, TileComputer};
use segue_motion::matching::MatchError;
use segue_motion::registration::{DistanceMatrix, PairTerms, RegistrationError};
use std::collections::BTreeMap;
use std::sync::Arc;

/// The reason why a job has no answer. The labs then compute in slices, and find the error of the
/// computation itself there.
#[derive(Debug, thiserror::Error)]
pub enum JobError {
    /// A clip that the worker does not have.
    #[error("clip {0} was not sent")]
    NoClip(u32),
    /// A message that cannot be read.
    #[error(transparent)]
    Parcel(#[from] ParcelError),
    /// The computation failed: distances.
    #[error(transparent)]
    Graph(#[from] GraphError),
    /// The computation failed: registration.
    #[error(transparent)]
    Registration(#[from] RegistrationError),
    /// The computation failed: a clip of a database.
    #[error(transparent)]
    Match(#[from] MatchError),
    /// The computation has no result.
    #[error("the job has no result")]
    NoResult,
}

/// The intermediate results that a worker keeps between jobs.
#[derive(Debug)]
pub(crate) struct WorkerMemory {
    /// The limit for each of the two, bytes.
    pub(super) max_bytes: usize,
    /// Products of the frames of a set of clips, by the numbers of these.
    pub(super) tiles: Option<(Vec<u32>, TileComputer)>,
    /// The points of a set of long clips, by the numbers of these.
    pub(super) stream: Option<(Vec<u32>, StreamComputer)>,
    /// Products of the frames of two clips, by the numbers of these and the stride, the last one
    /// last.
    pub(super) pairs: Vec<([u32; 2], usize, PairTerms)>,
    /// The last distances of two clips, by their numbers and the stride.
    pub(super) matrix: Option<([u32; 2], usize, Arc<DistanceMatrix>)>,
}

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
        let memory = WorkerMemory {
            max_bytes: max_bytes / 2,
            tiles: None,
            stream: None,
            pairs: Vec::new(),
            matrix: None,
        };
        Self { clips: BTreeMap::new(), memory }
    }

    /// Takes in a clip ([`JobClip::parcel`]).
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
        let memory = &mut self.memory;
        if memory.tiles.as_ref().is_some_and(|(clips, _)| clips.contains(&number)) {
            memory.tiles = None;
        }
        if memory.stream.as_ref().is_some_and(|(clips, _)| clips.contains(&number)) {
            memory.stream = None;
        }
        memory.pairs.retain(|(clips, _, _)| !clips.contains(&number));
        if memory.matrix.as_ref().is_some_and(|(clips, _, _)| clips.contains(&number)) {
            memory.matrix = None;
        }
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
