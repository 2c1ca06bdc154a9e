//! The result of a lab from long clips.

use super::clip_parcel::put_clip;
use super::error::JobError;
use super::motion_parcel::{MotionHead, put_known};
use super::parcel::ArrayReader;
use super::task::{JobClip, Task};
use super::worker_memory::WorkerMemory;
use super::{Parcel, ParcelError};
use crate::labs::{Cycle, LabFacts, LayerFacts, MeasuredMotion, Outcome, PairLabs, PlacedClip};
use crate::labs::{RetargetReport, Slot, Transition, recipe_ingredients};
use crate::metrics::Metric;
use crate::params::{Key, Kind, Params};
use segue_motion::clip::{Clip, Motion};
use segue_motion::math::Planar;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// The result of a lab. The clips are those in its slots.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct ResultTask {
    /// The lab, and the parameters from which its result is made, as in a link.
    params: Vec<(String, String)>,
    /// The length of the windows that an automatic match compares, frames.
    match_window: usize,
}

impl ResultTask {
    /// Returns the task for the result of the parameters.
    pub(crate) fn new(params: &Params, match_window: usize) -> Self {
        let is_clip = |key: Key| matches!(key.param().kind, Kind::Clip);
        let keys = recipe_ingredients(params.lab()).filter(|&key| !is_clip(key));
        let text = |key: Key| (key.param().name.to_owned(), key.param().format(params.get(key)));
        Self { params: std::iter::once(Key::Lab).chain(keys).map(text).collect(), match_window }
    }

    fn params(&self) -> Option<Params> {
        let mut params = Params::default();
        for (name, text) in &self.params {
            let key = Key::from_name(name)?;
            params.set(key, key.param().parse(text).ok()?).ok()?;
        }
        Some(params)
    }
}

/// An outcome without its motions. These are named by their places among the clips of the job,
/// followed by the outcome's own motions.
#[derive(Serialize, Deserialize)]
struct Head<'a> {
    /// The heads of the outcome's own motions, each with the place of the job's clip whose skeleton
    /// and roles it has.
    #[serde(borrow)]
    own: Vec<(usize, MotionHead<'a>)>,
    motion: usize,
    sources: Vec<(Slot, usize, f64, Planar)>,
    transition: Option<Transition>,
    cycle: Option<Cycle>,
    retargeted: Option<RetargetReport>,
    layer: Option<LayerFacts>,
    metrics: Vec<Metric>,
    beside: Vec<usize>,
    /// The clip on which the metrics of every lab are measured, if it is another one.
    measured: Option<usize>,
}

/// Returns the place of the first motion that `is_it` accepts; `new` is appended where there is
/// none.
fn place_of(
    motions: &mut Vec<Arc<Motion>>,
    is_it: impl Fn(&Arc<Motion>) -> bool,
    new: impl FnOnce() -> Arc<Motion>,
) -> usize {
    motions.iter().position(is_it).unwrap_or_else(|| {
        motions.push(new());
        motions.len() - 1
    })
}

impl Task for ResultTask {
    type Answer = Outcome;

    fn run(&self, clips: &[JobClip], memory: &mut WorkerMemory) -> Result<Outcome, JobError> {
        let params = self.params().ok_or(JobError::NoResult)?;
        let numbers: Vec<u32> = clips.iter().map(|clip| clip.number).collect();
        let slots: Vec<_> = clips.iter().map(|clip| Arc::clone(&clip.motion)).collect();
        let kept = memory.labs.take().filter(|(known, _)| *known == numbers);
        let mut labs = kept.map_or_else(PairLabs::default, |(_, labs)| labs);
        let made = labs.result(&slots, &params, self.match_window);
        memory.labs = Some((numbers, labs));
        // The reason why there is none is found where the result is made in slices.
        let outcome = made.ok_or(JobError::NoResult)?;
        // The page draws these motions: what it needs for that travels with them.
        for motion in outcome.sources.iter().map(|source| &source.motion).chain([&outcome.motion]) {
            drop(motion.analysis());
        }
        Ok(outcome)
    }

    fn pack(clips: &[JobClip], answer: Outcome) -> Result<Parcel, ParcelError> {
        // No lab of `PairLabs` drives a character.
        if matches!(answer.measured, MeasuredMotion::Trace(_)) {
            return Err(ParcelError::Arrays);
        }
        let mut motions: Vec<_> = clips.iter().map(|clip| Arc::clone(&clip.motion)).collect();
        let mut of_motion = |motion: &Arc<Motion>| {
            place_of(&mut motions, |known| Arc::ptr_eq(known, motion), || Arc::clone(motion))
        };
        let motion = of_motion(&answer.motion);
        let sources = (answer.sources.iter())
            .map(|source| {
                let place = of_motion(&source.motion);
                (source.slot, place, source.starts_at_secs, source.world_from_clip)
            })
            .collect();
        let mut of_clip = |clip: &Arc<Clip>| {
            let new = || Arc::new(Motion::with_roles(Arc::clone(clip), answer.motion.roles()));
            place_of(&mut motions, |known| Arc::ptr_eq(known.clip(), clip), new)
        };
        let beside = answer.beside.iter().map(&mut of_clip).collect();
        let measured = match &answer.measured {
            MeasuredMotion::Clip(clip) => Some(of_clip(clip)),
            MeasuredMotion::Motion | MeasuredMotion::Trace(_) => None,
        };
        let mut parcel = Parcel::default();
        let mut own = Vec::new();
        for motion in motions.iter().skip(clips.len()) {
            let is_body = |clip: &JobClip| {
                clip.motion.clip().skeleton() == motion.clip().skeleton()
                    && clip.motion.roles() == motion.roles()
            };
            let body = clips.iter().position(is_body).ok_or(ParcelError::Arrays)?;
            own.push((body, MotionHead::of(motion)));
            put_clip(&mut parcel, motion.clip());
            put_known(&mut parcel.bytes, motion);
        }
        parcel.head = serde_json::to_string(&Head {
            own,
            motion,
            sources,
            transition: answer.transition,
            cycle: answer.cycle,
            retargeted: answer.retargeted.as_deref().cloned(),
            layer: answer.layer().map(|facts| LayerFacts::clone(facts)),
            metrics: answer.metrics,
            beside,
            measured,
        })?;
        Ok(parcel)
    }

    fn unpack(&self, clips: &[JobClip], parcel: Parcel) -> Result<Outcome, ParcelError> {
        let head: Head<'_> = serde_json::from_str(&parcel.head)?;
        let mut arrays = ArrayReader::new(parcel.rotations, &parcel.floats, &parcel.bytes);
        let mut motions: Vec<_> = clips.iter().map(|clip| Arc::clone(&clip.motion)).collect();
        for (body, head) in head.own {
            let body = &clips.get(body).ok_or(ParcelError::Arrays)?.motion;
            let (skeleton, roles) = (body.clip().skeleton(), body.roles());
            motions.push(Arc::new(head.take(skeleton, roles, &mut arrays)?));
        }
        let at = |place: usize| motions.get(place).ok_or(ParcelError::Arrays);
        let clip = |place| at(place).map(|motion| Arc::clone(motion.clip()));
        let source = |(slot, place, starts_at_secs, world_from_clip)| {
            Ok(PlacedClip::new(slot, at(place)?, starts_at_secs, world_from_clip))
        };
        Ok(Outcome {
            sources: head.sources.into_iter().map(source).collect::<Result<_, ParcelError>>()?,
            transition: head.transition,
            cycle: head.cycle,
            retargeted: head.retargeted.map(Arc::new),
            facts: head.layer.map_or_else(LabFacts::default, |facts| LabFacts::of(Arc::new(facts))),
            metrics: head.metrics,
            beside: head.beside.into_iter().map(clip).collect::<Result<_, _>>()?,
            measured: match head.measured {
                Some(place) => MeasuredMotion::Clip(clip(place)?),
                None => MeasuredMotion::Motion,
            },
            ..Outcome::plain(Arc::clone(at(head.motion)?))
        })
    }
}
