//! The trait of tasks, and the clips of a job.

use super::clip_parcel::arrays_of;
use super::error::JobError;
use super::motion_parcel;
use super::worker_memory::WorkerMemory;
use super::{Parcel, ParcelError};
use segue_motion::clip::Motion;
use std::sync::Arc;

/// A kind of job: what it needs besides its clips.
pub(crate) trait Task {
    /// The result of the task.
    type Answer;

    /// Computes the answer, a pure function of the task and the clips. The memory may save work,
    /// but changes no bit of the answer.
    fn run(&self, clips: &[JobClip], memory: &mut WorkerMemory) -> Result<Self::Answer, JobError>;

    /// Packs an answer for its transfer; the clips are those of the job.
    fn pack(clips: &[JobClip], answer: Self::Answer) -> Result<Parcel, ParcelError>;

    /// Restores an answer from its parcel; the clips are those of the job.
    fn unpack(&self, clips: &[JobClip], parcel: Parcel) -> Result<Self::Answer, ParcelError>;

    /// Returns a number that jobs have in common which profit from the memory of one worker. Jobs
    /// with the same clips profit from these alone, which are counted besides.
    fn affinity(&self) -> u64 {
        0
    }
}

/// A clip with the number under which workers keep it.
#[derive(Clone, Debug)]
pub struct JobClip {
    /// The number.
    pub number: u32,
    /// The clip.
    pub motion: Arc<Motion>,
}

impl JobClip {
    /// Packs the clip for its transfer to a worker, without its floats, which
    /// [`piece`](Self::piece) returns.
    ///
    /// # Errors
    /// [`ParcelError`] when JSON cannot represent its header.
    pub fn parcel_without_floats(&self) -> Result<Parcel, ParcelError> {
        motion_parcel::pack_without_floats(&self.motion)
    }

    /// Returns the number of floats of the clip's parcel.
    #[must_use]
    pub fn floats(&self) -> usize {
        arrays_of(self.motion.clip()).map(<[f32]>::len).sum()
    }

    /// Returns floats of the clip's parcel, up to `most` from the offset `at` on; none at its end.
    #[must_use]
    pub fn piece(&self, mut at: usize, most: usize) -> &[f32] {
        for array in arrays_of(self.motion.clip()) {
            match array.get(at..) {
                Some(rest) if !rest.is_empty() => return rest.get(..most).unwrap_or(rest),
                _ => at -= array.len(),
            }
        }
        &[]
    }
}
