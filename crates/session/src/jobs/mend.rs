//! The mends of a long take.

use super::clip_parcel::put_clip;
use super::error::JobError;
use super::motion_parcel::{MotionHead, put_known};
use super::parcel::ArrayReader;
use super::task::{JobClip, Task};
use super::worker_memory::WorkerMemory;
use super::{Parcel, ParcelError};
use segue_motion::clean::{Fault, MendOptions, Mended, mend};
use segue_motion::metrics::{Extreme, worst_foot_slide};
use serde::{Deserialize, Serialize};
use std::ops::Range;
use std::sync::Arc;

/// The mends of faults of the job's only clip.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct MendTask {
    pub(crate) faults: Vec<Fault>,
    pub(crate) options: MendOptions,
}

/// A mended take, and the slide of its feet in the worst stance, centimetres.
pub(crate) type MendAnswer = (Mended, Option<Extreme>);

#[derive(Serialize, Deserialize)]
struct Head<'a> {
    #[serde(borrow)]
    motion: MotionHead<'a>,
    frames: Range<usize>,
    slide: Option<Extreme>,
}

/// Returns a mended take with the slide of its feet in the worst stance, centimetres.
pub(crate) fn with_slide(mended: Mended) -> MendAnswer {
    let motion = &mended.motion;
    let slide = worst_foot_slide(motion.clip(), motion.roles(), motion.contacts());
    (mended, slide)
}

impl Task for MendTask {
    type Answer = MendAnswer;

    fn run(&self, clips: &[JobClip], _memory: &mut WorkerMemory) -> Result<MendAnswer, JobError> {
        let take = &clips.first().ok_or(JobError::NoResult)?.motion;
        let faults: Vec<&Fault> = self.faults.iter().collect();
        // The reason why there is none is found where the work is done in slices.
        let mended = mend(take, &faults, &self.options).map_err(|_| JobError::NoResult)?;
        // The page draws the motion: what it needs for that travels with it.
        drop(mended.motion.analysis());
        Ok(with_slide(mended))
    }

    fn pack(_clips: &[JobClip], (mended, slide): MendAnswer) -> Result<Parcel, ParcelError> {
        let motion = &mended.motion;
        let head = Head { motion: MotionHead::of(motion), frames: mended.frames.clone(), slide };
        let mut parcel = Parcel { head: serde_json::to_string(&head)?, ..Parcel::default() };
        put_clip(&mut parcel, motion.clip());
        put_known(&mut parcel.bytes, motion);
        Ok(parcel)
    }

    fn unpack(&self, clips: &[JobClip], parcel: Parcel) -> Result<MendAnswer, ParcelError> {
        let Head { motion, frames, slide } = serde_json::from_str(&parcel.head)?;
        let take = &clips.first().ok_or(ParcelError::Arrays)?.motion;
        let mut arrays = ArrayReader::new(parcel.rotations, &parcel.floats, &parcel.bytes);
        let motion = motion.take(take.clip().skeleton(), take.roles(), &mut arrays)?;
        Ok((Mended { motion: Arc::new(motion), frames }, slide))
    }
}
