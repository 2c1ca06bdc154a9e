//! The analysis of a long clip: its ground frames, contacts and ground height.

use super::error::JobError;
use super::motion_parcel::{take_contacts, take_places};
use super::parcel::put;
use super::task::{JobClip, Task};
use super::worker_memory::WorkerMemory;
use super::{Parcel, ParcelError};
use segue_motion::clip::MotionAnalysis;
use segue_motion::skeleton::Foot;
use serde::{Deserialize, Serialize};

/// The analysis of the job's only clip.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(crate) struct AnalysisTask;

/// An analysis without its arrays.
#[derive(Serialize, Deserialize)]
struct Head {
    frames: usize,
    /// The number of feet that have contacts.
    feet: usize,
    /// The bits of the height of the ground: it is exact.
    ground_m: u32,
}

impl Task for AnalysisTask {
    type Answer = MotionAnalysis;

    fn run(
        &self,
        clips: &[JobClip],
        _memory: &mut WorkerMemory,
    ) -> Result<MotionAnalysis, JobError> {
        Ok(clips.first().ok_or(JobError::NoResult)?.motion.analysis())
    }

    fn pack(_clips: &[JobClip], answer: MotionAnalysis) -> Result<Parcel, ParcelError> {
        let MotionAnalysis { ground_frames, contacts, ground_m } = answer;
        let head = Head {
            frames: ground_frames.len(),
            feet: contacts.feet().len(),
            ground_m: ground_m.to_bits(),
        };
        let mut parcel = Parcel { head: serde_json::to_string(&head)?, ..Parcel::default() };
        for place in &ground_frames {
            put(&mut parcel.bytes, &[place.yaw, place.shift.x, place.shift.y]);
        }
        for &foot in contacts.feet() {
            let frames = 0..ground_frames.len();
            parcel.bytes.extend(frames.map(|frame| u8::from(contacts.planted(foot, frame))));
        }
        Ok(parcel)
    }

    fn unpack(&self, _clips: &[JobClip], parcel: Parcel) -> Result<MotionAnalysis, ParcelError> {
        let head: Head = serde_json::from_str(&parcel.head)?;
        let mut bytes = &parcel.bytes[..];
        let places = take_places(&mut bytes, head.frames)?;
        let feet = Foot::ALL.get(..head.feet).ok_or(ParcelError::Arrays)?;
        Ok(MotionAnalysis {
            ground_frames: places,
            contacts: take_contacts(&mut bytes, head.frames, feet)?,
            ground_m: f32::from_bits(head.ground_m),
        })
    }
}
