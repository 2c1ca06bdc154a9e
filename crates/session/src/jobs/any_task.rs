//! The table of the kinds of jobs.

use super::analysis::AnalysisTask;
use super::cycle::CycleTask;
use super::database_clip::DatabaseClipTask;
use super::distances::DistanceTask;
use super::error::JobError;
use super::faults::FaultTask;
use super::mend::MendTask;
use super::registration::RegistrationTask;
use super::result::ResultTask;
use super::stream::StreamTask;
use super::task::{JobClip, Task};
use super::view::ViewTask;
use super::worker_memory::WorkerMemory;
use super::{Parcel, ParcelError};
use serde::{Deserialize, Serialize};
use std::hash::{DefaultHasher, Hash as _, Hasher as _};

/// A task with a place in the table of kinds.
pub(crate) trait Kind: Task + Into<AnyTask> {
    /// Returns the answer, if it is of this kind.
    fn output(answer: Answer) -> Option<Self::Answer>;
}

/// A job that can be run anywhere.
#[derive(Clone, Debug)]
pub struct Job {
    /// Its number.
    pub number: u64,
    /// The clips that it needs.
    pub clips: Vec<JobClip>,
    pub(super) task: AnyTask,
}

/// A job as a message to a worker, which has its clips.
#[derive(Serialize, Deserialize)]
pub(super) struct Message<T> {
    pub(super) clips: Vec<u32>,
    pub(super) task: T,
}

impl Job {
    /// Returns the message for a worker that has the clips.
    ///
    /// # Errors
    /// [`ParcelError`] when JSON cannot represent it.
    pub fn message(&self) -> Result<String, ParcelError> {
        let clips = self.clips.iter().map(|clip| clip.number).collect();
        Ok(serde_json::to_string(&Message { clips, task: &self.task })?)
    }

    /// Restores an answer to this job from its parcel.
    ///
    /// # Errors
    /// [`ParcelError`] when it is none.
    pub fn answer(&self, parcel: Parcel) -> Result<Answer, ParcelError> {
        self.task.unpack(&self.clips, parcel)
    }

    /// Returns a number that jobs have in common which profit from the memory of one worker.
    pub(super) fn affinity(&self) -> u64 {
        let mut hasher = DefaultHasher::new();
        self.task.affinity().hash(&mut hasher);
        for clip in &self.clips {
            clip.number.hash(&mut hasher);
        }
        hasher.finish()
    }
}

macro_rules! tasks {
    ($($kind:ident($task:ty),)*) => {
        /// A task of any kind.
        #[derive(Clone, Debug, Serialize, Deserialize)]
        pub(crate) enum AnyTask {
            $($kind($task),)*
        }

        /// The answer to a job of any kind.
        #[derive(Debug)]
        pub struct Answer(AnyAnswer);

        #[derive(Debug)]
        enum AnyAnswer {
            $($kind(Box<<$task as Task>::Answer>),)*
        }

        impl AnyTask {
            /// Runs the task.
            pub(super) fn run(
                &self,
                clips: &[JobClip],
                memory: &mut WorkerMemory,
            ) -> Result<Answer, JobError> {
                Ok(Answer(match self {
                    $(Self::$kind(task) => AnyAnswer::$kind(Box::new(task.run(clips, memory)?)),)*
                }))
            }

            fn unpack(&self, clips: &[JobClip], parcel: Parcel) -> Result<Answer, ParcelError> {
                Ok(Answer(match self {
                    $(Self::$kind(task) => {
                        AnyAnswer::$kind(Box::new(task.unpack(clips, parcel)?))
                    })*
                }))
            }

            fn affinity(&self) -> u64 {
                match self {
                    $(Self::$kind(task) => task.affinity(),)*
                }
            }
        }

        impl Answer {
            /// Packs the answer for its transfer; the clips are those of the job.
            ///
            /// # Errors
            /// [`ParcelError`] when JSON cannot represent its header.
            pub fn pack(self, clips: &[JobClip]) -> Result<Parcel, ParcelError> {
                match self.0 {
                    $(AnyAnswer::$kind(answer) => <$task as Task>::pack(clips, *answer),)*
                }
            }
        }

        $(
            impl From<$task> for AnyTask {
                fn from(task: $task) -> Self {
                    Self::$kind(task)
                }
            }

            impl Kind for $task {
                fn output(answer: Answer) -> Option<Self::Answer> {
                    match answer.0 {
                        AnyAnswer::$kind(answer) => Some(*answer),
                        _ => None,
                    }
                }
            }
        )*
    };
}

tasks! {
    Analysis(AnalysisTask),
    Cycle(CycleTask),
    DatabaseClip(DatabaseClipTask),
    Distances(DistanceTask),
    Faults(FaultTask),
    Mend(MendTask),
    Registration(RegistrationTask),
    Result(ResultTask),
    Stream(StreamTask),
    View(ViewTask),
}
