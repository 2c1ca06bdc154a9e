//! Metrics of one transition, measured at its seam.

use super::Extreme;
use super::lowest::LowPoints;
use crate::blend::Concatenation;
use crate::clip::{Clip, FootSteps, Motion, UsualMotion, facing, stillest_step, turn, turn_change};
use crate::math::{Planar, wrap_angle};
use crate::skeleton::{Foot, Roles, WorldPose};
use glam::{DVec2, Vec3};
use std::ops::{Range, RangeInclusive};

/// The time on each side of a transition in which stances are followed, seconds.
const MARGIN_SECS: f64 = 0.5;
/// The least turn at the seam for which a joint is named, degrees: smaller ones are invisible.
const MIN_NAMED_DEG: f64 = 0.1;
/// The least difference of velocities for which lag is measured, metres per second.
const MIN_CHANGE_MPS: f64 = 0.1;

/// A transition to be measured: frame f of the result shows frame f of clip A before it, and frame
/// `enter + (f - transition.start)` of clip B after it. Inside both are mixed.
struct Subject<'a> {
    /// The clip with the transition in it.
    result: &'a Clip,
    /// The first mixed frame of the result (for a cut: the first of B).
    start: usize,
    /// One past the last mixed frame; the start for a cut.
    end: usize,
    /// The first frame in which B has the greater part ([`crate::blend::Concatenation::handover`]):
    /// contacts are A's before it, and B's from then on.
    handover: usize,
    /// The frame of B that is shown, or mixed in, at `start`.
    enter: usize,
    /// The outgoing clip.
    a: &'a Motion,
    /// The incoming clip.
    b: &'a Motion,
    /// Roles of the result's joints.
    roles: &'a Roles,
    /// Height of the ground, metres ([`crate::clip::estimate_ground`]).
    ground_m: f32,
}

/// The artefacts of a transition, measured at its seam alone, beyond the values of the clips in the
/// very frames that play. [`ResultMetrics`](super::ResultMetrics) are those of any result.
///
/// "Usual" is the 99th percentile over the whole source clip or the value of the source in the very
/// frame that is shown, whichever is greater; the larger of the two sources'. A clip that continues
/// as itself therefore has no jump, however wild it is.
///
/// "Steps" go from one frame to the next; those of the transition are all steps into its frames and
/// the one out of it, so that both borders count.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TransitionMetrics {
    /// Turn at the seam, degrees. Over all joints and steps of the transition, the largest turn of
    /// a joint relative to its parent in one step, minus the usual value for that joint; 0 where no
    /// step is unusual.
    pub seam_deg: Option<f64>,
    /// The joint of [`seam_deg`](Self::seam_deg), where that is above 0.1°.
    pub seam_joint: Option<usize>,
    /// Change of velocity at the seam, degrees per second: over all joints and steps of the
    /// transition, the largest change of a joint's angular velocity (a vector in the parent's
    /// frame) from one step to the next, minus the usual value for that joint.
    pub seam_dps: Option<f64>,
    /// Position jump, centimetres: the largest step of the character over the ground, minus the
    /// usual one.
    pub jump_cm: Option<f64>,
    /// The frame into which that step goes; `None` where no step is beyond the usual one.
    pub jump_at: Option<usize>,
    /// Yaw of the blend, degrees. With `r`, `a`, `b` the yaw of a step of the result and of the
    /// sources: the largest sum, over any run of consecutive steps of the transition, of
    /// `r - max(0, a, b)` or of `min(0, a, b) - r`. That is the turn beyond that of either source.
    pub spin_deg: Option<f64>,
    /// Slide at the seam, centimetres. A foot is planted while its source has it planted: A before
    /// the handover, B from then on. For every step between planted frames, the step over the
    /// ground of the foot's stillest point (ankle, ball or tip), minus the length that the stillest
    /// point moves in the source, is added as a vector; the value is the greatest length of this
    /// sum in any stance that touches the transition. Stances are followed for half a second on
    /// each side. `None` without feet or stances.
    pub skate_cm: Option<f64>,
    /// Penetration, centimetres: the depth of the deepest joint or end site below the ground in the
    /// transition.
    pub penetration_cm: Option<f64>,
    /// Its frame; `None` where nothing is below the ground.
    pub penetration_at: Option<usize>,
    /// Lag: seconds from the transition's start until the last step whose velocity (forward and
    /// sideways, in the character's frame) differs from the incoming clip's by more than 10 % of
    /// the difference between the two clips: the root mean square, over the transition, of the
    /// difference of their velocities. `None` where that is below 0.1 m/s.
    pub lag_s: Option<f64>,
}

impl TransitionMetrics {
    /// Measures the transition from A to B that was made by any method, on the lower of their
    /// grounds. Only its frames and half a second around it are read.
    #[must_use]
    pub fn measure(a: &Motion, b: &Motion, made: &Concatenation) -> Self {
        Self::of(&Subject {
            result: &made.clip,
            start: made.transition.start,
            end: made.transition.end,
            handover: made.handover,
            enter: made.enter,
            a,
            b,
            roles: a.roles(),
            ground_m: a.ground_m().min(b.ground_m()),
        })
    }

    /// Measures a transition. Frames that do not exist are left out.
    fn of(subject: &Subject<'_>) -> Self {
        let last = subject.result.frames().saturating_sub(1);
        if subject.result.frames() == 0 {
            return Self::default();
        }
        let steps = subject.start.max(1)..=subject.end.max(subject.start).min(last);
        let around = SeamPoses::new(subject, &steps);
        let (seam_deg, seam_joint) = seam(subject, &steps);
        let jump = jump(subject, &steps, &around);
        let depth = around.lowest.map(|lowest| depth(lowest, subject.ground_m));
        Self {
            seam_deg,
            seam_joint,
            seam_dps: velocity_seam(subject, &steps),
            jump_cm: jump.map(|jump| jump.value),
            jump_at: jump.and_then(|jump| jump.place()),
            spin_deg: spin(subject, &steps, &around),
            skate_cm: skate(subject, &steps, &around),
            penetration_cm: depth.map(|depth| depth.value),
            penetration_at: depth.and_then(|depth| depth.place()),
            lag_s: lag(subject, &steps, &around),
        }
    }
}

/// Returns the penetration in some frames of a clip, centimetres: the depth of the deepest joint or
/// end site below the ground. Frames that do not exist are left out; `None` if none is left.
#[must_use]
pub fn penetration_cm(clip: &Clip, frames: Range<usize>, ground_m: f32) -> Option<f64> {
    deepest_penetration(clip, frames, ground_m).map(|depth| depth.value)
}

/// Returns the penetration in some frames of a clip, as [`penetration_cm`], and the frame where the
/// deepest point is deepest.
#[must_use]
pub fn deepest_penetration(clip: &Clip, frames: Range<usize>, ground_m: f32) -> Option<Extreme> {
    let low_points = LowPoints::of(clip.skeleton());
    let mut world = WorldPose::default();
    let lowest = (frames.start..frames.end.min(clip.frames())).filter_map(|frame| {
        clip.world_pose_into(frame, &mut world);
        Some((low_points.lowest(&world)?, frame))
    });
    lowest.min_by(|a, b| a.0.total_cmp(&b.0)).map(|lowest| depth(lowest, ground_m))
}

/// Returns the depth of a point at a height below the ground, centimetres, in its frame.
fn depth((lowest_m, frame): (f32, usize), ground_m: f32) -> Extreme {
    Extreme { value: f64::from((ground_m - lowest_m).max(0.0)) * 100.0, frame }
}

impl Subject<'_> {
    /// Returns the frame of B that corresponds to `frame` of the result.
    fn in_b(&self, frame: usize) -> Option<usize> {
        let frame = self.enter.saturating_add(frame).checked_sub(self.start)?;
        (frame < self.b.ground_frames().len()).then_some(frame)
    }

    /// Returns the steps of A and B, in the characters' own frames, that correspond to the step
    /// into `frame` of the result. After its end clip A continues with its last step: an
    /// inertialization may leave it there.
    fn source_steps(&self, frame: usize) -> [Option<Planar>; 2] {
        let last = self.a.ground_frames().len().checked_sub(1);
        let a = last.map(|last| self.a.step_into(frame.min(last)));
        [a, self.in_b(frame).map(|frame| self.b.step_into(frame))]
    }

    fn usual(&self, of: fn(&UsualMotion) -> &[f32], joint: usize) -> f32 {
        let get = |motion: &Motion| of(motion.usual()).get(joint).copied().unwrap_or(0.0);
        get(self.a).max(get(self.b))
    }

    /// Returns the clip that contacts are taken from in a frame, 0 for A and 1 for B, and its own
    /// frame there, if it has one.
    fn source_of(&self, frame: usize) -> (usize, Option<usize>) {
        if frame < self.handover { (0, Some(frame)) } else { (1, self.in_b(frame)) }
    }

    /// Returns whether a foot is planted in the source of a frame.
    fn is_planted(&self, foot: Foot, frame: usize) -> bool {
        let (source, frame) = self.source_of(frame);
        frame.is_some_and(|frame| [self.a, self.b][source].contacts().planted(foot, frame))
    }
}

/// Forward kinematics of the frames around a transition, computed once.
struct SeamPoses {
    frames: Range<usize>,
    /// Ground frames of the character.
    character: Vec<Planar>,
    /// Per foot ([`Foot::of`]), per frame: its points.
    feet: Vec<Vec<Vec<Vec3>>>,
    /// The lowest point of the body over the transition itself, metres, and its frame.
    lowest: Option<(f32, usize)>,
}

impl SeamPoses {
    fn new(subject: &Subject<'_>, steps: &RangeInclusive<usize>) -> Self {
        let clip = subject.result;
        let margin = (MARGIN_SECS * clip.fps()).round() as usize;
        let frames = subject.start.saturating_sub(margin.max(1)).min(clip.frames())
            ..steps.end().saturating_add(margin + 1).min(clip.frames());
        let feet = Foot::of(subject.roles.body_plan()).iter();
        let points: Vec<_> =
            feet.map(|&foot| subject.roles.foot_points(clip.skeleton(), foot)).collect();
        let low_points = LowPoints::of(clip.skeleton());
        let mut around = Self {
            frames: frames.clone(),
            character: vec![],
            feet: vec![vec![]; points.len()],
            lowest: None,
        };
        let mut world = WorldPose::default();
        let mut yaw = None;
        for frame in frames {
            clip.world_pose_into(frame, &mut world);
            let at = world.positions.first().copied().unwrap_or_default();
            let mut standing = Planar::standing_at(at, Vec3::Z);
            if let Some(facing) = facing(&world, subject.roles) {
                yaw = Some(Planar::standing_at(at, facing).yaw);
            }
            standing.yaw = yaw.unwrap_or(0.0);
            around.character.push(standing);
            for (points, feet) in points.iter().zip(&mut around.feet) {
                feet.push(points.iter().map(|&(joint, point)| world.point(joint, point)).collect());
            }
            if (subject.start.saturating_sub(1)..=*steps.end()).contains(&frame) {
                let low = low_points.lowest(&world).map(|low| (low, frame));
                let lowest = around.lowest.into_iter().chain(low);
                around.lowest = lowest.min_by(|a, b| a.0.total_cmp(&b.0));
            }
        }
        around
    }

    /// Returns the character's step into `frame`, in its own frame at the frame before.
    fn step_into(&self, frame: usize) -> Option<Planar> {
        let at = frame.checked_sub(self.frames.start)?;
        Some(self.character.get(at.checked_sub(1)?)?.inverse().after(self.character.get(at)?))
    }
}

/// Returns the turn of a joint in the step into `frame`, radians.
fn joint_turn(clip: &Clip, frame: usize, joint: usize) -> Option<f32> {
    let before = frame.checked_sub(1)?;
    let at = |frame: usize| {
        (frame < clip.frames()).then(|| clip.rotations(frame).get(joint).copied()).flatten()
    };
    Some(turn(at(before)?, at(frame)?).length())
}

/// Returns the largest value of any joint in `frames`, minus the usual value of that joint or that
/// of its sources in the same frames, and the joint where the excess is above 0.
fn unusual(
    subject: &Subject<'_>,
    frames: RangeInclusive<usize>,
    value: fn(&Clip, usize, usize) -> Option<f32>,
    usual: fn(&UsualMotion) -> &[f32],
) -> (Option<f32>, Option<usize>) {
    let clip = subject.result;
    let mut worst: Option<f32> = None;
    let mut of_joint = None;
    for frame in frames {
        for joint in 0..clip.skeleton().len() {
            let Some(found) = value(clip, frame, joint) else {
                continue;
            };
            let threshold = worst.unwrap_or(0.0);
            worst = Some(threshold);
            let excess = found - subject.usual(usual, joint);
            // The sources' own frames are evaluated only where they matter.
            if excess > threshold {
                let in_a = value(subject.a.clip(), frame, joint);
                let in_b =
                    subject.in_b(frame).and_then(|frame| value(subject.b.clip(), frame, joint));
                let own = in_a.into_iter().chain(in_b).fold(0.0, f32::max);
                let excess = excess.min(found - own);
                if excess > threshold {
                    (worst, of_joint) = (Some(excess), Some(joint));
                }
            }
        }
    }
    (worst, of_joint)
}

fn seam(subject: &Subject<'_>, steps: &RangeInclusive<usize>) -> (Option<f64>, Option<usize>) {
    let (worst, joint) = unusual(subject, steps.clone(), joint_turn, |usual| &usual.turn);
    let degrees = worst.map(|turn| f64::from(turn).to_degrees());
    (degrees, joint.filter(|_| degrees > Some(MIN_NAMED_DEG)))
}

fn velocity_seam(subject: &Subject<'_>, steps: &RangeInclusive<usize>) -> Option<f64> {
    // Every frame between two steps of which one belongs to the transition.
    let (worst, _) =
        unusual(subject, steps.start() - 1..=*steps.end(), turn_change, |usual| &usual.change);
    worst.map(|change| f64::from(change).to_degrees() * subject.result.fps())
}

fn jump(
    subject: &Subject<'_>,
    steps: &RangeInclusive<usize>,
    around: &SeamPoses,
) -> Option<Extreme> {
    let usual = f64::from(subject.a.usual().step.max(subject.b.usual().step));
    let excess = |frame| {
        let own = subject.source_steps(frame).into_iter().flatten().map(|step| step.shift.length());
        let metres = around.step_into(frame)?.shift.length() - own.fold(usual, f64::max);
        Some((frame, metres.max(0.0) * 100.0))
    };
    Extreme::largest(steps.clone().filter_map(excess))
}

fn spin(subject: &Subject<'_>, steps: &RangeInclusive<usize>, around: &SeamPoses) -> Option<f64> {
    // The largest sum of a run of steps (Kadane), for left and right turns.
    let (mut left, mut right, mut worst) = (0.0_f64, 0.0_f64, None);
    for frame in steps.clone() {
        let Some(result) = around.step_into(frame) else {
            continue;
        };
        let sources =
            subject.source_steps(frame).map(|step| step.map_or(0.0, |step| wrap_angle(step.yaw)));
        let yaw = wrap_angle(result.yaw);
        left = (left + yaw - sources[0].max(sources[1]).max(0.0)).max(0.0);
        right = (right - yaw + sources[0].min(sources[1]).min(0.0)).max(0.0);
        worst = Some(left.max(right).max(worst.unwrap_or(0.0)));
    }
    worst.map(f64::to_degrees)
}

fn skate(subject: &Subject<'_>, steps: &RangeInclusive<usize>, around: &SeamPoses) -> Option<f64> {
    let touches = subject.start.saturating_sub(1)..=*steps.end();
    let mut worst: Option<f32> = None;
    for (foot, feet) in Foot::ALL.into_iter().zip(&around.feet) {
        if feet.first().is_none_or(Vec::is_empty) {
            continue;
        }
        let mut in_sources = [subject.a, subject.b].map(|source| FootSteps::new(source, foot));
        let mut drift = Vec3::ZERO;
        let mut farthest = None;
        for (at, frame) in around.frames.clone().enumerate() {
            if !subject.is_planted(foot, frame) {
                (drift, farthest) = (Vec3::ZERO, None);
                continue;
            }
            let stance = farthest.get_or_insert((0.0_f32, false));
            // Only between two planted frames: the step onto the ground is not a slide.
            let before_planted = at > 0 && subject.is_planted(foot, frame - 1);
            if let Some(step) =
                before_planted.then(|| stillest_step(&feet[at - 1], &feet[at])).flatten()
            {
                let length = step.length();
                if length > 0.0 {
                    let (source, frame) = subject.source_of(frame);
                    let in_source = frame.map_or(0.0, |frame| in_sources[source].length_m(frame));
                    drift += step * ((length - in_source).max(0.0) / length);
                }
            }
            stance.0 = stance.0.max(drift.length());
            stance.1 |= touches.contains(&frame);
            if stance.1 {
                worst = Some(worst.map_or(stance.0, |worst| worst.max(stance.0)));
            }
        }
    }
    worst.map(|metres| f64::from(metres) * 100.0)
}

fn lag(subject: &Subject<'_>, steps: &RangeInclusive<usize>, around: &SeamPoses) -> Option<f64> {
    let fps = subject.result.fps();
    let (mut squares, mut count, mut distances): (f64, usize, Vec<(usize, f64)>) = (0.0, 0, vec![]);
    for frame in steps.clone() {
        let (Some(result), [a, Some(b)]) = (around.step_into(frame), subject.source_steps(frame))
        else {
            continue;
        };
        let off = |step: Planar| -> DVec2 { (step.shift - b.shift) * fps };
        distances.push((frame, off(result).length()));
        // The step out of the transition is all B: it shows when B is reached, not how far away it
        // was.
        if let Some(a) = a.filter(|_| frame < subject.end || subject.start == subject.end) {
            squares += off(a).length_squared();
            count += 1;
        }
    }
    let between = (squares / count.max(1) as f64).sqrt();
    if count == 0 || between < MIN_CHANGE_MPS {
        return None;
    }
    let reached = distances
        .iter()
        .rev()
        .find(|(_, distance)| *distance > 0.1 * between)
        .map_or(subject.start, |(frame, _)| frame + 1);
    Some(reached.saturating_sub(subject.start) as f64 / fps)
}

#[cfg(test)]
mod tests;
