//! The measurement of one clip of a database for motion matching.

use super::clip_parcel::{ClipHead, put_clip};
use super::error::JobError;
use super::motion_parcel::{take_contacts, take_places};
use super::parcel::{ArrayReader, put, split_floats, split_values, take_floats};
use super::task::{JobClip, Task};
use super::worker_memory::WorkerMemory;
use super::{Parcel, ParcelError};
use glam::Vec3;
use segue_motion::clip::{Clip, Motion};
use segue_motion::matching::{
    ClipMeasurement, DatabaseClip, DatabaseClipParts, DatabaseOptions, FootState, MeasuredClip,
    Pace, TagRange,
};
use segue_motion::math::Planar;
use segue_motion::retarget::RetargetErrors;
use segue_motion::skeleton::{Foot, Roles};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// The measurement of a clip. The clips are that clip, and the first one of the database where that
/// has another skeleton.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct DatabaseClipTask {
    /// The number of the clip in its database.
    pub(crate) source: usize,
    pub(crate) options: DatabaseOptions,
    /// The roles of the joints of the first clip.
    pub(crate) roles: Box<Roles>,
}

#[derive(Serialize, Deserialize)]
struct Head<'a> {
    motions: Vec<MotionHead<'a>>,
    retargeted: Option<RetargetErrors>,
}

/// A motion without its arrays.
#[derive(Serialize, Deserialize)]
struct MotionHead<'a> {
    /// `None` where it is the clip of the job.
    clip: Option<ClipHead<'a>>,
    ground_m: f32,
    stand_m: f32,
    travel_mps: f64,
    turn_radps: f64,
    source: usize,
    mirrored: bool,
    cycle: Option<Planar>,
    tags: Vec<TagRange>,
    /// The number of feet that have contacts, and of those that have states.
    feet: usize,
    states: usize,
}

impl Task for DatabaseClipTask {
    type Answer = MeasuredClip;

    fn run(&self, clips: &[JobClip], _memory: &mut WorkerMemory) -> Result<MeasuredClip, JobError> {
        let (from, first) = match clips {
            [from] => {
                let first = Motion::with_roles(Arc::clone(from.motion.clip()), &self.roles);
                (&from.motion, Arc::new(first))
            }
            [from, first] => (&from.motion, Arc::clone(&first.motion)),
            _ => return Err(JobError::NoResult),
        };
        let measurement =
            ClipMeasurement::new(Arc::clone(from), first, self.source, &self.options)?;
        Ok(measurement.finish()?)
    }

    fn pack(clips: &[JobClip], answer: MeasuredClip) -> Result<Parcel, ParcelError> {
        let motions: Vec<DatabaseClipParts> =
            answer.motions.into_iter().map(DatabaseClip::into_parts).collect();
        let is_own = |parts: &DatabaseClipParts| {
            clips.first().is_some_and(|own| Arc::ptr_eq(own.motion.clip(), &parts.clip))
        };
        let head = |parts| MotionHead::of(parts, is_own(parts));
        let head =
            Head { motions: motions.iter().map(head).collect(), retargeted: answer.retargeted };
        let mut parcel = Parcel { head: serde_json::to_string(&head)?, ..Parcel::default() };
        for parts in &motions {
            if !is_own(parts) {
                put_clip(&mut parcel, &parts.clip);
            }
            put_parts(&mut parcel, parts);
        }
        Ok(parcel)
    }

    fn unpack(&self, clips: &[JobClip], parcel: Parcel) -> Result<MeasuredClip, ParcelError> {
        let head: Head<'_> = serde_json::from_str(&parcel.head)?;
        let ([own, ..], Some(first)) = (clips, clips.last()) else {
            return Err(ParcelError::Arrays);
        };
        let mut arrays = ArrayReader::new(parcel.rotations, &parcel.floats, &parcel.bytes);
        let mut motions = Vec::new();
        for mut head in head.motions {
            let clip = match head.clip.take() {
                Some(clip) => Arc::new(clip.take(first.motion.clip().skeleton(), &mut arrays)?),
                None => Arc::clone(own.motion.clip()),
            };
            motions.push(head.take(clip, &mut arrays)?);
        }
        Ok(MeasuredClip { motions, retargeted: head.retargeted })
    }
}

impl<'a> MotionHead<'a> {
    fn of(parts: &'a DatabaseClipParts, is_own: bool) -> Self {
        Self {
            clip: (!is_own).then(|| ClipHead::of(&parts.clip)),
            ground_m: parts.ground_m,
            stand_m: parts.stand_m,
            travel_mps: parts.pace.travel_mps,
            turn_radps: parts.pace.turn_radps,
            source: parts.source,
            mirrored: parts.mirrored,
            cycle: parts.cycle,
            tags: parts.tags.clone(),
            feet: parts.contacts.feet().len(),
            states: parts.feet.iter().filter(|states| !states.is_empty()).count(),
        }
    }

    /// Takes the arrays of the motion, and returns it.
    fn take(
        self,
        clip: Arc<Clip>,
        ArrayReader { floats, bytes, .. }: &mut ArrayReader<'_>,
    ) -> Result<DatabaseClip, ParcelError> {
        let frames = clip.frames();
        let joints_radps = take_floats(floats, clip.skeleton().len())?;
        let body = split_floats(floats, frames, DatabaseClipParts::BODY_FEATURES)?;
        let body = body.as_chunks().0.to_vec();
        let roots = take_places(bytes, frames)?;
        let with_contacts = Foot::ALL.get(..self.feet).ok_or(ParcelError::Arrays)?;
        let contacts = take_contacts(bytes, frames, with_contacts)?;
        let mut states_of = |foot: Foot| -> Result<Vec<FootState>, ParcelError> {
            let counts = split_values::<[u32; 2]>(bytes, frames)?;
            let numbers = split_floats(floats, frames, 5)?.as_chunks().0;
            let state = |(frame, (counts, numbers)): (usize, ([u32; 2], &[f32; 5]))| FootState {
                planted: contacts.planted(foot, frame),
                stance_frames: counts[0] as usize,
                stillest: counts[1] as usize,
                above_m: numbers[0],
                descent_m: numbers[1],
                velocity_mps: Vec3::from_slice(&numbers[2..]),
            };
            Ok(counts.zip(numbers).enumerate().map(state).collect())
        };
        let mut feet: [Vec<FootState>; 4] = Default::default();
        let with_states = Foot::ALL.get(..self.states).ok_or(ParcelError::Arrays)?;
        for (foot, states) in with_states.iter().zip(&mut feet) {
            *states = states_of(*foot)?;
        }
        let (travel_mps, turn_radps) = (self.travel_mps, self.turn_radps);
        DatabaseClip::of_parts(DatabaseClipParts {
            clip,
            roots,
            contacts,
            ground_m: self.ground_m,
            stand_m: self.stand_m,
            feet,
            body,
            pace: Pace { joints_radps, travel_mps, turn_radps },
            source: self.source,
            mirrored: self.mirrored,
            cycle: self.cycle,
            tags: self.tags,
        })
        .ok_or(ParcelError::Arrays)
    }
}

/// Appends the arrays of a motion beside those of its clip. The flags of its feet are those of its
/// contacts.
fn put_parts(Parcel { floats, bytes, .. }: &mut Parcel, parts: &DatabaseClipParts) {
    floats.extend_from_slice(&parts.pace.joints_radps);
    floats.extend_from_slice(parts.body.as_flattened());
    for root in &parts.roots {
        put(bytes, &[root.yaw, root.shift.x, root.shift.y]);
    }
    for &foot in parts.contacts.feet() {
        let frames = 0..parts.contacts.frames();
        bytes.extend(frames.map(|frame| u8::from(parts.contacts.planted(foot, frame))));
    }
    for foot in parts.feet.iter().flatten() {
        put(bytes, &[foot.stance_frames as u32, foot.stillest as u32]);
        floats.extend_from_slice(&[foot.above_m, foot.descent_m]);
        floats.extend_from_slice(&foot.velocity_mps.to_array());
    }
}
