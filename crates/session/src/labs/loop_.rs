//! The Loop lab: a part of a clip becomes a cycle.

use super::delegated::Delegated;
use super::feet::Lock;
use super::lab::{HasPart, Inputs, Lab, LabClips, LabInputs};
use super::repetition::{Repetition, repeat_cycle, repeated};
use super::request_cache::RequestCache;
use super::sliced::{JobKind, Sliced};
use super::{Cycle, CycleMade, Outcome, PlacedClip, Slot};
use crate::choices;
use crate::jobs::{CycleTask, JobBoard};
use crate::labs::LabError;
use crate::metrics::{Metric, MetricId};
use crate::params::{Key, Params};
use segue_motion::clip::Motion;
use segue_motion::math::Planar;
use segue_motion::transition::{
    CutPoints, CycleFinder, CycleSearch, LoopMethod, LoopOptions, close_loop, find_cycle,
};
use segue_text::{Message, msg};
use std::ops::ControlFlow;
use std::sync::Arc;

/// Clips of up to this number of frames are searched at once: about 8 ms for 31 joints.
const AT_ONCE: usize = 800;
/// The number of frames from which on a worker searches: what takes it longer than to begin.
const FOR_WORKERS: usize = 4_000;

/// The Loop lab: a cycle cut from a clip, with matching ends.
pub(super) struct LoopLab;

impl<S: HasPart<CycleCache>> Lab<S> for LoopLab {
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
        let found = HasPart::<CycleCache>::part(labs).inputs(clips.first()?, params)?;
        Ok(found.map(Inputs::new))
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

/// A clip and the ends of a cycle in it.
#[derive(Debug)]
struct FoundCycle {
    motion: Arc<Motion>,
    cut: CutPoints,
}

/// A clip, and the ends of the cycle in it that the user set.
type CycleOf = (Arc<Motion>, [Option<usize>; 2]);

/// A cache of cycles that panes ask for, with the search for them.
#[derive(Debug, Default)]
pub(crate) struct CycleCache {
    cache:
        RequestCache<CycleOf, Delegated<CycleTask, CycleFinder>, Result<Arc<FoundCycle>, LabError>>,
}

impl CycleCache {
    /// Returns the loop of the parameters for a clip; `None` if the search takes longer than a
    /// frame: call [`work`](Self::work), then ask again.
    pub(crate) fn inputs(
        &mut self,
        motion: &Arc<Motion>,
        params: &Params,
    ) -> Result<Option<LoopInputs>, LabError> {
        let fps = motion.clip().fps();
        let last = motion.clip().frames().saturating_sub(1);
        let mut given = [Key::LoopFrom, Key::LoopTo]
            .map(|key| params.optional(key).map(|secs| ((secs * fps).round() as usize).min(last)));
        if let [Some(from), Some(to)] = &mut given
            && from > to
        {
            std::mem::swap(from, to);
        }
        let Some(found) = self.found(motion, given)? else { return Ok(None) };
        Ok(Some(LoopInputs { found, options: options(params), foot_lock: Lock::of(params) }))
    }

    fn found(
        &mut self,
        motion: &Arc<Motion>,
        given: [Option<usize>; 2],
    ) -> Result<Option<Arc<FoundCycle>>, LabError> {
        let is_it = |(of, ends): &CycleOf| Arc::ptr_eq(of, motion) && *ends == given;
        self.cache.request_or_begin((Arc::clone(motion), given), is_it, |of| {
            if motion.clip().frames() > AT_ONCE {
                return Ok(ControlFlow::Continue(Delegated::New));
            }
            Ok(ControlFlow::Break(found_in(of, find_cycle(motion, &search_of(of))?)))
        })
    }
}

fn search_of((motion, given): &CycleOf) -> CycleSearch {
    CycleSearch { start: given[0], end: given[1], ..CycleSearch::new(motion.clip().fps()) }
}

fn found_in((motion, _): &CycleOf, cut: CutPoints) -> Arc<FoundCycle> {
    Arc::new(FoundCycle { motion: Arc::clone(motion), cut })
}

/// Does one slice of a search.
fn search_on(
    of: &CycleOf,
    finder: Option<CycleFinder>,
) -> Result<ControlFlow<CutPoints, CycleFinder>, LabError> {
    let mut finder = match finder {
        Some(finder) => finder,
        None => CycleFinder::new(&of.0, &search_of(of))?,
    };
    Ok(match finder.advance(&of.0)? {
        ControlFlow::Break(cut) => ControlFlow::Break(cut),
        ControlFlow::Continue(()) => ControlFlow::Continue(finder),
    })
}

impl Sliced for CycleCache {
    fn clear_requests(&mut self) {
        self.cache.clear_requests();
    }

    fn work(&mut self, jobs: &mut JobBoard) -> bool {
        self.cache.work(|of, work| {
            let offer = || {
                let is_long = of.0.clip().frames() >= FOR_WORKERS;
                is_long.then(|| (CycleTask { search: search_of(of) }, vec![Arc::clone(&of.0)]))
            };
            let taken = |cut: CutPoints| Some(Ok(found_in(of, cut)));
            work.advance(jobs, offer, taken, |finder| match search_on(of, finder) {
                Ok(flow) => flow.map_break(|cut| Ok(found_in(of, cut))),
                // It is told when a pane asks for the cycle.
                Err(error) => ControlFlow::Break(Err(error)),
            })
        })
    }

    fn is_ready(&self) -> bool {
        self.cache.is_ready()
    }

    fn progress(&self) -> Option<(JobKind, f64)> {
        let (of, work) = self.cache.under_way().next()?;
        let progress = work.here().map_or(0.0, |finder| finder.progress(&of.0));
        Some((JobKind::Matching, f64::from(progress)))
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
