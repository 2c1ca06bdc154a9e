//! Retargeting of a motion in slices.

use super::feet::{self, FootGoals};
use super::report::ErrorMeter;
use super::solve::Solution;
use super::tracks::Tracks;
use super::twist::TwistSpread;
use super::{RetargetErrors, RetargetOptions, RetargetedMotion, TargetBody, Task};
use crate::clip::{Clip, ClipError, Directions, Motion, RetargetError};
use crate::math::Planar;
use crate::transition::repeat_clip;
use std::ops::ControlFlow;
use std::sync::Arc;

/// The passes over all frames: two for directions, then reading, planning, moving, measuring, and
/// twist.
const PASSES: usize = 7;

/// The computation of [`retarget_motion`](super::retarget_motion) in slices, for long motions.
#[derive(Debug)]
pub struct MotionRetargeting {
    source: Arc<Motion>,
    target: TargetBody,
    options: RetargetOptions,
    stage: Stage,
    /// The number of frames that this stage has done.
    done: usize,
    /// The cycle of a motion that is one.
    cycle: Option<Cycle>,
}

/// A cycle, of which three repetitions are retargeted: the one in the middle begins as it ends.
#[derive(Debug)]
struct Cycle {
    /// The number of frames after which it begins again.
    frames: usize,
    /// The transform from one repetition to the next, at the scale of the source.
    step: Planar,
}

impl Cycle {
    /// Returns the cycle of a motion and three repetitions of it; `None` for one that is no cycle.
    fn of(motion: &Motion) -> Option<(Self, Motion)> {
        let frames = motion.clip().frames().checked_sub(1).filter(|&frames| frames > 0)?;
        let places = motion.ground_frames();
        let (first, end) = (places.first()?, places.get(frames).filter(|_| motion.is_cycle())?);
        let step = end.after(&first.inverse());
        let before = motion.clip().crop(0..frames).ok()?.transformed(&step.inverse());
        let order: Vec<usize> = (0..3 * frames).map(|frame| frame % frames).collect();
        let three = Motion::with_roles(repeat_clip(&before, &step, 3).ok()?, motion.roles())
            .with_contacts(motion.contacts().of_frames(&order))
            .with_ground_m(motion.ground_m());
        Some((Self { frames, step }, three))
    }

    /// Returns the cycle in the middle of its repetitions on a body `scale` times as large.
    fn middle(&self, three: &Clip, scale: f32) -> Result<Clip, ClipError> {
        let step = Planar { shift: self.step.shift * f64::from(scale), ..self.step };
        let middle = three.crop(self.frames..2 * self.frames)?;
        repeat_clip(&middle, &step, 2)?.crop(0..self.frames + 1)
    }
}

#[derive(Debug)]
enum Stage {
    /// Bones get their directions; `None` on the same skeleton.
    Directions(Option<Box<Directions>>),
    /// Limbs are read.
    Reading(Box<(Task, Tracks)>),
    /// The places of limbs are found: those of feet first.
    Planning(Box<(Task, Tracks, Option<FootGoals>)>),
    /// Limbs are moved.
    Moving(Box<(Task, Tracks, Solution)>),
    /// The result is measured.
    Measuring(Box<Measuring>),
    /// Twist is spread; with the report and the scale of the body.
    Twisting(Box<(Clip, (RetargetErrors, f32), TwistSpread)>),
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
        let (cycle, three) = Cycle::of(&source).filter(|_| !is_same).unzip();
        let source = three.map_or(source, Arc::new);
        let (clip, skeleton) = (source.clip(), &target.skeleton);
        let (from, to) = ((&**clip, source.roles()), (skeleton, &target.roles));
        let directions = (!is_same)
            .then(|| Directions::new(from, to, target.stance.as_ref()))
            .transpose()?
            .map(Box::new);
        let (options, stage) = (options.clamped(), Stage::Directions(directions));
        Ok(Self { source, target, options, stage, done: 0, cycle })
    }

    /// Processes up to `frames` more frames (at least one) of the present pass, of which there are
    /// seven; that in which places are found has two slices. Returns the result when it is
    /// complete. A frame of 34 joints takes 10 µs in all.
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
        let cycle = self.cycle.as_ref();
        self.stage = match self.stage {
            Stage::Directions(None) => {
                let clip = Clip::clone(self.source.clip());
                return made(clip, None, (None, 1.0));
            }
            Stage::Directions(Some(mut directions)) => {
                let found = directions.advance(self.source.clip(), frames)?;
                self.done = if found.is_some() { 0 } else { directions.frames_done() };
                match found {
                    None => Stage::Directions(Some(directions)),
                    Some((plain, way)) if way.is_same_rig() => {
                        return made(plain, None, (cycle, 1.0));
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
                    Stage::Planning(Box::new((task, tracks, None)))
                } else {
                    Stage::Reading(at)
                }
            }
            Stage::Planning(at) => match *at {
                (task, tracks, None) => {
                    // Half of this pass, whatever the number of frames.
                    self.done = last / 2;
                    let feet = feet::goals(&task, &tracks);
                    Stage::Planning(Box::new((task, tracks, Some(feet))))
                }
                (task, tracks, Some(feet)) => {
                    self.done = 0;
                    let solution = Solution::new(&task, &tracks, feet);
                    Stage::Moving(Box::new((task, tracks, solution)))
                }
            },
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
                        None => return made(clip, Some(&report), (cycle, task.scale)),
                        Some(twist) => {
                            Stage::Twisting(Box::new((clip, (report, task.scale), twist)))
                        }
                    }
                } else {
                    Stage::Measuring(at)
                }
            }
            Stage::Twisting(mut at) => {
                let (clip, _, twist) = &mut *at;
                twist.spread(clip, next);
                if is_last {
                    let (clip, (report, scale), twist) = *at;
                    return made(twist.clip(&clip)?, Some(&report), (cycle, scale));
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
            Stage::Planning(_) => 3,
            Stage::Moving(_) => 4,
            Stage::Measuring(_) => 5,
            Stage::Twisting(_) => 6,
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

fn made(
    clip: Clip,
    report: Option<&RetargetErrors>,
    (cycle, scale): (Option<&Cycle>, f32),
) -> Result<ControlFlow<RetargetedMotion, MotionRetargeting>, RetargetError> {
    let clip = match cycle {
        Some(cycle) => cycle.middle(&clip, scale)?,
        None => clip,
    };
    let (report, is_same_rig) = (report.copied().unwrap_or_default(), report.is_none());
    Ok(ControlFlow::Break(RetargetedMotion { clip, report, is_same_rig }))
}
