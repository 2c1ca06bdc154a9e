//! The search for a cycle in a long clip.

use super::error::JobError;
use super::task::{JobClip, Task};
use super::worker_memory::WorkerMemory;
use super::{Parcel, ParcelError};
use segue_motion::transition::{CutPoints, CycleSearch, find_cycle};
use serde::{Deserialize, Serialize};

/// The search in the job's only clip.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(crate) struct CycleTask {
    pub(crate) search: CycleSearch,
}

impl Task for CycleTask {
    type Answer = CutPoints;

    fn run(&self, clips: &[JobClip], _memory: &mut WorkerMemory) -> Result<CutPoints, JobError> {
        let clip = clips.first().ok_or(JobError::NoResult)?;
        // The reason why there is none is found where the search is done in slices.
        find_cycle(&clip.motion, &self.search).map_err(|_| JobError::NoResult)
    }

    fn pack(_clips: &[JobClip], answer: CutPoints) -> Result<Parcel, ParcelError> {
        Ok(Parcel { head: serde_json::to_string(&answer)?, ..Parcel::default() })
    }

    fn unpack(&self, _clips: &[JobClip], parcel: Parcel) -> Result<CutPoints, ParcelError> {
        Ok(serde_json::from_str(&parcel.head)?)
    }
}
