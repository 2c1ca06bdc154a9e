//! The search for faults in a long take.

use super::error::JobError;
use super::task::{JobClip, Task};
use super::worker_memory::WorkerMemory;
use super::{Parcel, ParcelError};
use segue_motion::clean::{Fault, find_faults};
use serde::{Deserialize, Serialize};

/// The search in the job's only clip.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(crate) struct FaultTask;

impl Task for FaultTask {
    type Answer = Vec<Fault>;

    fn run(&self, clips: &[JobClip], _memory: &mut WorkerMemory) -> Result<Vec<Fault>, JobError> {
        Ok(find_faults(&clips.first().ok_or(JobError::NoResult)?.motion))
    }

    fn pack(_clips: &[JobClip], answer: Vec<Fault>) -> Result<Parcel, ParcelError> {
        Ok(Parcel { head: serde_json::to_string(&answer)?, ..Parcel::default() })
    }

    fn unpack(&self, _clips: &[JobClip], parcel: Parcel) -> Result<Vec<Fault>, ParcelError> {
        Ok(serde_json::from_str(&parcel.head)?)
    }
}
