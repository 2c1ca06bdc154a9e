//! Retargeting of a motion in slices.

use super::report::ErrorMeter;
use super::solve::Solution;
use super::tracks::Tracks;
use super::twist::TwistSpread;
use super::{RetargetErrors, RetargetOptions, RetargetedMotion, TargetBody, Task};
use crate::clip::{Clip, Directions, Motion, RetargetError};
use std::ops::ControlFlow;
use std::sync::Arc;

/// The passes over all frames: two for directions, then reading, moving, measuring, and twist.
const PASSES: usize = 6;

/// The computation of [`retarget_motion`](super::retarget_motion) in slices, for long motions.
#[derive(Debug)]
pub struct MotionRetargeting {
    source: Arc<Motion>,
    target: TargetBody,
    options: RetargetOptions,
    stage: Stage,
    /// The number of frames that this stage has done.
    done: usize,
}

#[derive(Debug)]
enum Stage {
    /// Bones get their directions; `None` on the same skeleton.
    Directions(Option<Box<Directions>>),
    /// Limbs are read.
    Reading(Box<(Task, Tracks)>),
    /// Limbs are moved.
    Moving(Box<(Task, Tracks, Solution)>),
    /// The result is measured.
    Measuring(Box<Measuring>),
    /// Twist is spread.
    Twisting(Box<(Clip, RetargetErrors, TwistSpread)>),
}

#[derive(Debug)]
struct Measuring {
    task: Task,
    tracks: Tracks,
    solution: Solution,
    clip: Clip,
    meter: ErrorMeter,
}

impl MotionRetargeting {
    /// Prepares retargeting. Call [`advance`](Self::advance) until the result is there.
    ///
    /// # Errors
    /// [`RetargetError::NothingInCommon`] when no joint of the body corresponds to one of the
    /// motion's.
    pub fn new(
        source: Arc<Motion>,
        target: TargetBody,
        options: RetargetOptions,
    ) -> Result<Self, RetargetError> {
        let (clip, skeleton) = (source.clip(), &target.skeleton);
        let is_same = Arc::ptr_eq(clip.skeleton(), skeleton) || clip.skeleton() == skeleton;
        let (from, to) = ((&**clip, source.roles()), (skeleton, &target.roles));
        let directions = (!is_same)
            .then(|| Directions::new(from, to, target.stance.as_ref()))
            .transpose()?
            .map(Box::new);
        let (options, stage) = (options.clamped(), Stage::Directions(directions));
        Ok(Self { source, target, options, stage, done: 0 })
    }

    /// Processes up to `frames` more frames (at least one) of the present pass, of which there are
    /// six. Returns the result when it is complete.
    ///
    /// # Errors
    /// [`RetargetError`] when the result is no valid clip.
    pub fn advance(
        mut self,
        frames: usize,
    ) -> Result<ControlFlow<RetargetedMotion, Self>, RetargetError> {
        let last = self.source.clip().frames();
        let next = self.done..self.done.saturating_add(frames.max(1)).min(last);
        let is_last = next.end == last;
        self.done = if is_last { 0 } else { next.end };
        self.stage = match self.stage {
            Stage::Directions(None) => {
                let clip = Clip::clone(self.source.clip());
                return Ok(made(clip, RetargetErrors::default()));
            }
            Stage::Directions(Some(mut directions)) => {
                let found = directions.advance(self.source.clip(), frames)?;
                self.done = if found.is_some() { 0 } else { directions.frames_done() };
                match found {
                    None => Stage::Directions(Some(directions)),
                    Some((plain, way)) if way.is_same_rig() => {
                        return Ok(made(plain, RetargetErrors::default()));
                    }
                    Some((plain, way)) => {
                        let task = Task {
                            source: Arc::clone(&self.source),
                            target: self.target.clone(),
                            options: self.options,
                            plain,
                            scale: way.scale(),
                        };
                        let tracks = Tracks::new(&task);
                        Stage::Reading(Box::new((task, tracks)))
                    }
                }
            }
            Stage::Reading(mut at) => {
                let (task, tracks) = &mut *at;
                tracks.read(task, next);
                if is_last {
                    let (task, mut tracks) = *at;
                    tracks.find_axes(&task);
                    let solution = Solution::new(&task, &tracks);
                    Stage::Moving(Box::new((task, tracks, solution)))
                } else {
                    Stage::Reading(at)
                }
            }
            Stage::Moving(mut at) => {
                let (task, tracks, solution) = &mut *at;
                solution.turn(task, tracks, next);
                if is_last {
                    let (task, tracks, mut solution) = *at;
                    let (clip, meter) = (solution.clip(&task)?, ErrorMeter::new(&task, &tracks));
                    Stage::Measuring(Box::new(Measuring { task, tracks, solution, clip, meter }))
                } else {
                    Stage::Moving(at)
                }
            }
            Stage::Measuring(mut at) => {
                let Measuring { task, tracks, solution, clip, meter } = &mut *at;
                meter.measure(task, (tracks, &solution.goals), clip, next);
                if is_last {
                    let Measuring { task, tracks, clip, meter, .. } = *at;
                    let report = meter.finish(&tracks);
                    match TwistSpread::new(&task.target) {
                        None => return Ok(made(clip, report)),
                        Some(twist) => Stage::Twisting(Box::new((clip, report, twist))),
                    }
                } else {
                    Stage::Measuring(at)
                }
            }
            Stage::Twisting(mut at) => {
                let (clip, _, twist) = &mut *at;
                twist.spread(clip, next);
                if is_last {
                    let (clip, report, twist) = *at;
                    return Ok(made(twist.clip(&clip)?, report));
                }
                Stage::Twisting(at)
            }
        };
        Ok(ControlFlow::Continue(self))
    }

    /// Returns the progress, 0 to 1.
    #[must_use]
    pub fn progress(&self) -> f32 {
        let frames = self.source.clip().frames().max(1);
        let before = match self.stage {
            Stage::Directions(_) => 0,
            Stage::Reading(_) => 2,
            Stage::Moving(_) => 3,
            Stage::Measuring(_) => 4,
            Stage::Twisting(_) => 5,
        };
        (before * frames + self.done) as f32 / (PASSES * frames) as f32
    }

    /// Processes the remaining frames and returns the result.
    ///
    /// # Errors
    /// The same as for [`advance`](Self::advance).
    pub fn finish(mut self) -> Result<RetargetedMotion, RetargetError> {
        loop {
            match self.advance(usize::MAX)? {
                ControlFlow::Continue(rest) => self = rest,
                ControlFlow::Break(made) => return Ok(made),
            }
        }
    }
}

fn made(clip: Clip, report: RetargetErrors) -> ControlFlow<RetargetedMotion, MotionRetargeting> {
    ControlFlow::Break(RetargetedMotion { clip, report })
}
