//! The foot lock of a long clip, and the metrics of a clip by itself.

use super::clip_parcel::{ClipHead, put_clip};
use super::error::JobError;
use super::parcel::ArrayReader;
use super::task::{JobClip, Task};
use super::worker_memory::WorkerMemory;
use super::{Parcel, ParcelError};
use segue_motion::clip::Clip;
use segue_motion::metrics::{ClipMetrics, Extreme, worst_foot_slide};
use segue_motion::transition::{FootLockError, FootLockOptions, foot_lock};
use serde::{Deserialize, Serialize};

/// The foot lock of the job's only clip, if it is asked for, and its measurement.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(crate) struct ViewTask {
    pub(crate) lock: Option<FootLockOptions>,
}

/// A clip as it is shown.
#[derive(Debug)]
pub(crate) struct ViewAnswer {
    /// The clip with locked feet; `None` where it is shown as it is.
    pub(crate) locked: Option<Clip>,
    /// The foot slide before locking, if that was asked for.
    pub(crate) before: Option<Extreme>,
    /// The metrics of what is shown.
    pub(crate) found: ClipMetrics,
}

/// An answer without the arrays of its clip.
#[derive(Serialize, Deserialize)]
struct Head<'a> {
    #[serde(borrow)]
    locked: Option<ClipHead<'a>>,
    before: Option<Extreme>,
    found: ClipMetrics,
}

impl Task for ViewTask {
    type Answer = ViewAnswer;

    fn run(&self, clips: &[JobClip], _memory: &mut WorkerMemory) -> Result<ViewAnswer, JobError> {
        let motion = &clips.first().ok_or(JobError::NoResult)?.motion;
        let (clip, roles, contacts) = (motion.clip(), motion.roles(), motion.contacts());
        let lock = |options| match foot_lock(clip, roles, contacts, options) {
            Ok(locked) => Ok(Some(locked)),
            Err(FootLockError::NoLegs) => Ok(None),
            // The reason is found where the work is done in slices.
            Err(_) => Err(JobError::NoResult),
        };
        let locked = self.lock.as_ref().map(lock).transpose()?.flatten();
        let before = self.lock.and_then(|_| worst_foot_slide(clip, roles, contacts));
        let shown = locked.as_ref().unwrap_or(clip);
        let (places, ground_m) = (motion.ground_frames(), motion.ground_m());
        let found = ClipMetrics::measure(shown, roles, contacts, places, ground_m);
        Ok(ViewAnswer { locked, before, found })
    }

    fn pack(_clips: &[JobClip], answer: ViewAnswer) -> Result<Parcel, ParcelError> {
        let ViewAnswer { locked, before, found } = &answer;
        let (before, found) = (*before, *found);
        let head = Head { locked: locked.as_ref().map(ClipHead::of), before, found };
        let mut parcel = Parcel { head: serde_json::to_string(&head)?, ..Parcel::default() };
        if let Some(locked) = locked {
            put_clip(&mut parcel, locked);
        }
        Ok(parcel)
    }

    fn unpack(&self, clips: &[JobClip], parcel: Parcel) -> Result<ViewAnswer, ParcelError> {
        let Head { locked, before, found } = serde_json::from_str(&parcel.head)?;
        let skeleton = clips.first().ok_or(ParcelError::Arrays)?.motion.clip().skeleton();
        let mut arrays = ArrayReader::new(parcel.rotations, &parcel.floats, &parcel.bytes);
        let locked = locked.map(|head| head.take(skeleton, &mut arrays)).transpose()?;
        Ok(ViewAnswer { locked, before, found })
    }
}
