//! The Loop lab: a part of a clip becomes a cycle.

use super::feet::Lock;
use super::lab::{HasPart, Inputs, Lab, LabClips, LabInputs};
use super::repetition::{Repetition, repeat_cycle, repeated};
use super::{Cycle, CycleMade, Outcome, PlacedClip, Slot};
use crate::choices;
use crate::labs::LabError;
use crate::metrics::{Metric, MetricId};
use crate::params::{Key, Params};
use segue_motion::clip::Motion;
use segue_motion::math::Planar;
use segue_motion::transition::{
    CutPoints, CycleSearch, LoopMethod, LoopOptions, close_loop, find_cycle,
};
use segue_text::{Message, msg};
use std::sync::Arc;

/// The Loop lab: a cycle cut from a clip, with matching ends.
pub(super) struct LoopLab;

impl<S: HasPart<CycleFinder>> Lab<S> for LoopLab {
    fn result_name(&self, _params: &Params, a: Message, _b: Message) -> Message {
        msg!("{a}, looped", a)
    }

    fn file_stem(&self, params: &Params) -> String {
        format!("{} loop", params.text(Key::A))
    }

    fn found(&self, outcome: &Outcome, _fps: [f64; 2]) -> Vec<(Key, f64)> {
        match outcome.cycle.map(|cycle| cycle.made) {
            Some(CycleMade::Cut { from_secs, to_secs, .. }) => {
                vec![(Key::LoopFrom, from_secs), (Key::LoopTo, to_secs)]
            }
            _ => Vec::new(),
        }
    }

    fn captured_link(&self) -> Option<&'static str> {
        Some("a=cmu16_walk")
    }

    fn inputs(
        &self,
        labs: &mut S,
        clips: LabClips,
        params: &Params,
        _match_window: usize,
    ) -> Result<Option<Inputs>, LabError> {
        Ok(Some(Inputs::new(HasPart::<CycleFinder>::part(labs).inputs(clips.first()?, params)?)))
    }
}

/// The inputs of a loop. Equal inputs give equal results.
#[derive(Clone, Debug)]
pub(crate) struct LoopInputs {
    found: Arc<FoundCycle>,
    options: LoopOptions,
    foot_lock: Option<Lock>,
}

impl PartialEq for LoopInputs {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.found, &other.found)
            && self.options == other.options
            && self.foot_lock == other.foot_lock
    }
}

/// The ends of a cycle, and the request for them.
#[derive(Debug)]
struct FoundCycle {
    motion: Arc<Motion>,
    /// The ends that the user set.
    given: [Option<usize>; 2],
    cut: CutPoints,
}

/// A cache of the last search for a cycle.
#[derive(Debug, Default)]
pub(crate) struct CycleFinder {
    known: Option<Arc<FoundCycle>>,
}

impl CycleFinder {
    /// Returns the loop of the parameters for a clip.
    pub(crate) fn inputs(
        &mut self,
        motion: &Arc<Motion>,
        params: &Params,
    ) -> Result<LoopInputs, LabError> {
        let fps = motion.clip().fps();
        let last = motion.clip().frames().saturating_sub(1);
        let mut given = [Key::LoopFrom, Key::LoopTo]
            .map(|key| params.optional(key).map(|secs| ((secs * fps).round() as usize).min(last)));
        if let [Some(from), Some(to)] = &mut given
            && from > to
        {
            std::mem::swap(from, to);
        }
        Ok(LoopInputs {
            found: self.found(motion, given)?,
            options: options(params),
            foot_lock: Lock::of(params),
        })
    }

    fn found(
        &mut self,
        motion: &Arc<Motion>,
        given: [Option<usize>; 2],
    ) -> Result<Arc<FoundCycle>, LabError> {
        if let Some(found) = &self.known
            && Arc::ptr_eq(&found.motion, motion)
            && found.given == given
        {
            return Ok(Arc::clone(found));
        }
        let search =
            CycleSearch { start: given[0], end: given[1], ..CycleSearch::new(motion.clip().fps()) };
        let cut = find_cycle(motion, &search)?;
        let found = Arc::new(FoundCycle { motion: Arc::clone(motion), given, cut });
        self.known = Some(Arc::clone(&found));
        Ok(found)
    }
}

fn options(params: &Params) -> LoopOptions {
    let half_life_secs = params.number(Key::HalfLife);
    let ratio = params.number(Key::LoopRatio);
    let classic = LoopMethod::Classic { half_life_secs };
    let (method, ratio) = match params.choice::<choices::LoopMethod>() {
        choices::LoopMethod::Both => (classic, ratio),
        choices::LoopMethod::Crossed => (LoopMethod::Crossed { half_life_secs }, ratio),
        choices::LoopMethod::Start => (classic, 1.0),
        choices::LoopMethod::End => (classic, 0.0),
        choices::LoopMethod::Linear => (LoopMethod::Linear, ratio),
        choices::LoopMethod::Cubic => (LoopMethod::Cubic, ratio),
        choices::LoopMethod::Exact => (LoopMethod::Exact { half_life_secs }, ratio),
    };
    LoopOptions { method, ratio }
}

impl LabInputs for LoopInputs {
    fn run(&self) -> Result<Outcome, LabError> {
        let FoundCycle { motion, cut, .. } = &*self.found;
        let looped = close_loop(motion, cut.cycle.clone(), &self.options)?;
        let (fps, frames) = (looped.clip.fps(), cut.cycle.len());
        // Four repetitions, cropped to three and the first frame of the fourth.
        let three = looped.repeat(4).and_then(|clip| clip.crop(0..3 * frames + 1));
        let three = three?;
        let contacts = repeated(motion.contacts(), &cut.cycle, 3 * frames + 1);
        let Repetition { motion: played, mut slides } = repeat_cycle(
            motion.roles(),
            frames,
            three,
            &contacts,
            motion.ground_m(),
            self.foot_lock,
        )?;
        let secs = |frame: usize| frame as f64 / fps;
        let step = looped
            .frames
            .first()
            .map_or(Planar::IDENTITY, |first| first.inverse().after(&looped.cycle.after(first)));
        // The seam is where the first cycle ends.
        let at_seam = |id, value: f64| Metric::at_frame(id, value, Some(frames), fps);
        let mut metrics = vec![
            at_seam(MetricId::LoopSeam, looped.seam.turn_deg),
            at_seam(MetricId::LoopVelocitySeam, looped.seam.turn_dps),
        ];
        metrics.append(&mut slides);
        metrics.extend([
            Metric::new(MetricId::GapBeforeClosing, looped.before.turn_deg),
            Metric::new(MetricId::CycleTime, secs(frames)),
            Metric::new(MetricId::CycleFrames, frames as f64),
            Metric::new(MetricId::CycleLength, step.shift.length()),
            Metric::new(MetricId::CycleTurn, step.yaw.to_degrees()),
        ]);
        Ok(Outcome {
            sources: vec![PlacedClip::new(
                Slot::A,
                motion,
                -secs(cut.cycle.start),
                Planar::IDENTITY,
            )],
            cycle: Some(Cycle {
                secs: secs(frames),
                made: CycleMade::Cut {
                    from_secs: secs(cut.cycle.start),
                    to_secs: secs(cut.cycle.end),
                    distance_cm: cut.rms_cm,
                },
            }),
            metrics,
            beside: vec![Arc::clone(motion.clip())],
            ..Outcome::plain(Arc::new(played))
        })
    }
}
