//! Loops: clips that end as they began.

use super::moving::{View, travel, with_travel};
use super::{LoopCurve, LoopMethod, MovingPose};
use crate::blend::{Assembly, MAX_SECS, moving_joints};
use crate::clip::{Clip, ClipError, Motion};
use crate::math::{Planar, Response, quat};
use glam::{Quat, Vec3};
use std::ops::Range;

/// Options for closing a cycle.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct LoopOptions {
    /// The distribution of the difference over the cycle.
    pub method: LoopMethod,
    /// The share of the difference at the start, 0 to 1; the end has the rest.
    pub ratio: f64,
}

impl Default for LoopOptions {
    fn default() -> Self {
        Self { method: LoopMethod::Exact { half_life_secs: 0.2 }, ratio: 0.5 }
    }
}

/// Error closing a cycle.
#[derive(Clone, Debug, PartialEq, thiserror::Error, segue_text::ToMessage)]
pub enum LoopError {
    /// The frames are not in the clip, or too few.
    #[error(
        "a cycle from frame {start} to frame {end} does not fit a clip of {frames} frames: it needs two frames or more between, and frame {end} itself"
    )]
    Range {
        /// The cycle's first frame.
        start: usize,
        /// The frame that corresponds to the first one.
        end: usize,
        /// Frames of the clip.
        frames: usize,
    },
    /// The clip is shorter than the shortest requested cycle.
    #[error(
        "no cycle of {min_secs} s and more fits into {secs:.2} s: use a longer clip, or treat this one as a loop"
    )]
    TooShort {
        /// The shortest requested cycle, seconds.
        min_secs: f64,
        /// The clip's duration, seconds.
        secs: f64,
    },
    /// A half-life out of range.
    #[error("a half-life of {0} s cannot be used: give a number of seconds from 0 to {MAX_SECS}")]
    HalfLife(f64),
    /// The clip cannot be compared with itself.
    #[error(transparent)]
    Registration(#[from] crate::registration::RegistrationError),
    /// The result is not a valid clip.
    #[error(transparent)]
    Clip(#[from] ClipError),
}

/// The difference between the end of a cycle and its next start.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LoopSeam {
    /// The largest angle of a joint between the two poses, in the character's frame, degrees.
    pub turn_deg: f64,
    /// The joint of that angle.
    pub turn_joint: usize,
    /// The largest difference of angular velocities, degrees per second.
    pub turn_dps: f64,
    /// The largest difference of translations (of the root's height, and of joints that move
    /// relative to their parent), centimetres.
    pub shift_cm: f64,
}

/// A clip that ends in the pose in which it began, moved over the ground by [`cycle`](Self::cycle).
#[derive(Clone, Debug, PartialEq)]
pub struct Loop {
    /// One cycle. The frame after its last one is its first, moved by `cycle`.
    pub clip: Clip,
    /// The transform of one cycle: the k-th repetition is transformed by `cycle^k`.
    pub cycle: Planar,
    /// The ground frames of the cycle (`world_from_character`).
    pub frames: Vec<Planar>,
    /// The seam before closing.
    pub before: LoopSeam,
    /// The remaining seam.
    pub seam: LoopSeam,
}

impl Loop {
    /// Repeats the cycle `times` times; see [`repeat_clip`].
    ///
    /// # Errors
    /// [`ClipError`] when the result is not a valid clip.
    pub fn repeat(&self, times: usize) -> Result<Clip, ClipError> {
        repeat_clip(&self.clip, &self.cycle, times)
    }

    /// Returns the same cycle starting at another of its frames; `frame` is taken modulo the cycle.
    ///
    /// # Errors
    /// [`ClipError`] when the result is not a valid clip.
    pub fn starting_at(&self, frame: usize) -> Result<Self, ClipError> {
        let frames = self.clip.frames();
        let first = frame % frames.max(1);
        let (earlier, later) = self.frames.split_at(first.min(self.frames.len()));
        Ok(Self {
            clip: self.repeat(2)?.crop(first..first + frames)?,
            frames: later
                .iter()
                .copied()
                .chain(earlier.iter().map(|stands| self.cycle.after(stands)))
                .collect(),
            ..self.clone()
        })
    }
}

/// Repeats a clip `times` times, at most 1,024, each repetition moved over the ground by `cycle`
/// from the one before. The transforms are accumulated in `f64`, so that poses do not drift.
///
/// # Errors
/// [`ClipError`] when the result is not a valid clip.
pub fn repeat_clip(clip: &Clip, cycle: &Planar, times: usize) -> Result<Clip, ClipError> {
    let times = times.min(1 << 10);
    let mut made = Assembly::new(clip, clip, clip.frames().saturating_mul(times));
    let mut world_from_clip = Planar::IDENTITY;
    for _ in 0..times {
        made.play_moved(clip, 0..clip.frames(), &world_from_clip);
        world_from_clip = cycle.after(&world_from_clip);
    }
    made.finish(clip.name().to_owned())
}

/// Closes a part of a clip into a cycle: frames `cycle.start..cycle.end` play, and frame
/// `cycle.end`, which the clip must have, is made equal to the first one.
///
/// Rotations, heights and translations of joints are closed in the character's own frame, with
/// their velocities. Ground position and yaw do not belong to the difference: over the ground the
/// *velocities* of both ends are matched (sideways, forward, yaw rate), and the cycle continues
/// along its own curve. Offsets of rotations are rotation vectors applied on the left; since
/// angular velocities do not add, the remainder of each solution is solved for again, until it is
/// below a millionth of a radian.
///
/// The velocities of the two ends are steps of the same kind: into the frames after them if the
/// clip continues after the end, from the frames before them if it begins before the start; where
/// the cycle is the whole clip, one-sided differences of second order.
///
/// # Errors
/// [`LoopError`] when the cycle has fewer than two frames or is not inside the clip, or the
/// half-life is out of range.
pub fn close_loop(
    source: &Motion,
    cycle: Range<usize>,
    options: &LoopOptions,
) -> Result<Loop, LoopError> {
    let clip = source.clip();
    if cycle.end >= clip.frames() || cycle.start.saturating_add(2) > cycle.end {
        return Err(LoopError::Range { start: cycle.start, end: cycle.end, frames: clip.frames() });
    }
    if let LoopMethod::Exact { half_life_secs }
    | LoopMethod::Classic { half_life_secs }
    | LoopMethod::Crossed { half_life_secs } = options.method
        && !(0.0..=MAX_SECS).contains(&half_life_secs)
    {
        return Err(LoopError::HalfLife(half_life_secs));
    }
    let moving = moving_joints(clip, clip);
    let view = View { source, moving: &moving, fixed: None };
    let dt_secs = clip.fps().recip();
    let curve = LoopCurve::new(options.method, options.ratio, cycle.len() as f64 * dt_secs);
    let [first, last] = view.ends(&cycle);
    let ends = Ends {
        at_start: curve.at(0.0),
        at_end: curve.at(cycle.len() as f64 * dt_secs),
        closes: curve.closes(),
    };
    let mut seam = LoopSeam::default();
    let mut before = LoopSeam::default();
    let closings: Vec<JointOffsets> = (0..first.rotations.len())
        .map(|joint| {
            let [start, end] =
                [&first, &last].map(|pose| (pose.rotations[joint], pose.angular_velocities[joint]));
            before.turn(joint, &start, &end);
            let (closing, start, end) = ends.close(start, end);
            seam.turn(joint, &start, &end);
            closing
        })
        .collect();
    let shifts: Vec<(Vec3, Vec3)> = (0..first.translations.len())
        .map(|slot| {
            let (d, v) = (
                last.translations[slot] - first.translations[slot],
                last.velocities[slot] - first.velocities[slot],
            );
            let left = d - (ends.at_start.of_vec3(d, v).0 - ends.at_end.of_vec3(d, v).0);
            before.shift_cm = before.shift_cm.max(f64::from(d.length()) * 100.0);
            seam.shift_cm = seam.shift_cm.max(f64::from(left.length()) * 100.0);
            (d, v)
        })
        .collect();
    let travels = last.travel - first.travel;

    let mut made = Assembly::new(clip, clip, cycle.len());
    let (mut rotations, mut translations) = (Vec::new(), Vec::new());
    let mut here = source.ground_frames()[cycle.start];
    let mut frames = Vec::with_capacity(cycle.len());
    for (index, frame) in cycle.clone().enumerate() {
        let now = curve.at(index as f64 * dt_secs);
        view.pose_into(frame, &mut rotations, &mut translations);
        for (closing, rotation) in closings.iter().zip(&mut rotations) {
            *rotation = closing.apply(&now, *rotation);
        }
        for (&(d, v), translation) in shifts.iter().zip(&mut translations) {
            *translation += now.of_vec3(d, v).0;
        }
        rotations[0] = quat::renormalize(here.rotation() * rotations[0]);
        let root = here.apply(translations[0]);
        made.push(root, &rotations, &translations[1..]);
        frames.push(here);
        let middle = curve.at((index as f64 + 0.5) * dt_secs).of_vec3(travels, Vec3::ZERO).0;
        here = here.after(&with_travel(&source.step_into(frame + 1), middle, dt_secs));
    }
    let start = source.ground_frames()[cycle.start];
    Ok(Loop {
        clip: made.finish(clip.name().to_owned())?,
        cycle: here.after(&start.inverse()),
        frames,
        before,
        seam,
    })
}

/// The offsets that close one joint: differences of rotation and velocity, one pair for every
/// solution.
struct JointOffsets {
    solved: [(Vec3, Vec3); MAX_SOLUTIONS],
    count: usize,
}

/// The greatest number of solutions; the error of each is about the square of the error of the one
/// before.
const MAX_SOLUTIONS: usize = 4;
/// Errors below these, radians and radians per second, are within the rounding of `f32`.
const TOLERANCES: [f32; 2] = [1e-6, 1e-4];

impl JointOffsets {
    fn apply(&self, now: &Response, rotation: Quat) -> Quat {
        let closed = self.solved.iter().take(self.count).fold(rotation, |rotation, &(d, v)| {
            let (offset, _) = now.of_vec3(d, v);
            quat::exp(offset) * rotation
        });
        quat::renormalize(closed)
    }
}

/// The curve at both ends of the cycle.
struct Ends {
    at_start: Response,
    at_end: Response,
    closes: [bool; 2],
}

impl Ends {
    /// Solves for one joint from its rotation and angular velocity at both ends; returns the
    /// offsets and both ends after closing.
    fn close(
        &self,
        mut start: (Quat, Vec3),
        mut end: (Quat, Vec3),
    ) -> (JointOffsets, (Quat, Vec3), (Quat, Vec3)) {
        let mut closing =
            JointOffsets { solved: [(Vec3::ZERO, Vec3::ZERO); MAX_SOLUTIONS], count: 0 };
        for slot in &mut closing.solved {
            let difference = quat::with_positive_scalar(end.0 * start.0.conjugate());
            let d = quat::log(difference);
            let v = quat::vector_rate(d, end.1 - difference * start.1);
            let open = d.length() > TOLERANCES[0] || (self.closes[1] && v.length() > TOLERANCES[1]);
            if !open || (closing.count > 0 && !self.closes[0]) {
                break;
            }
            *slot = (d, v);
            closing.count += 1;
            start = offset(start, self.at_start.of_vec3(d, v));
            end = offset(end, self.at_end.of_vec3(d, v));
        }
        (closing, start, end)
    }
}

/// Applies an offset and its rate to a rotation and its angular velocity.
fn offset((rotation, velocity): (Quat, Vec3), (x, rate): (Vec3, Vec3)) -> (Quat, Vec3) {
    let turned = quat::exp(x);
    (
        quat::renormalize(turned * rotation),
        quat::rate_to_angular_velocity(x, rate) + turned * velocity,
    )
}

impl LoopSeam {
    fn turn(&mut self, joint: usize, start: &(Quat, Vec3), end: &(Quat, Vec3)) {
        let degrees = f64::from(quat::angle_between(start.0, end.0).to_degrees());
        if degrees > self.turn_deg {
            (self.turn_deg, self.turn_joint) = (degrees, joint);
        }
        let difference = (start.1 - end.1).length().to_degrees();
        self.turn_dps = self.turn_dps.max(f64::from(difference));
    }
}

impl View<'_> {
    /// Returns the poses at both ends of a cycle with velocities of the same kind.
    fn ends(&self, cycle: &Range<usize>) -> [MovingPose; 2] {
        let frames = self.source.clip().frames();
        // Steps away from the frame, and their weights in a derivative per frame.
        let stencils: [&[(isize, f32)]; 2] = if cycle.end + 1 < frames {
            [&[(1, 1.0)]; 2]
        } else if cycle.start > 0 {
            [&[(-1, -1.0)]; 2]
        } else {
            [&[(1, 2.0), (2, -0.5)], &[(-1, -2.0), (-2, 0.5)]]
        };
        [(cycle.start, stencils[0]), (cycle.end, stencils[1])]
            .map(|(frame, stencil)| self.moving_by(frame, stencil))
    }

    fn moving_by(&self, frame: usize, stencil: &[(isize, f32)]) -> MovingPose {
        let fps = self.source.clip().fps();
        let (rotations, translations) = self.pose(frame);
        let mut pose = MovingPose {
            angular_velocities: vec![Vec3::ZERO; rotations.len()],
            velocities: vec![Vec3::ZERO; translations.len()],
            rotations,
            translations,
            travel: Vec3::ZERO,
            steady_travel: Vec3::ZERO,
        };
        for &(steps, weight) in stencil {
            let other = frame.saturating_add_signed(steps);
            let rate = weight * fps as f32;
            let (rotations, translations) = self.pose(other);
            for ((velocity, &from), &to) in
                pose.angular_velocities.iter_mut().zip(&pose.rotations).zip(&rotations)
            {
                *velocity += quat::log(to * from.conjugate()) * rate;
            }
            for ((velocity, &from), &to) in
                pose.velocities.iter_mut().zip(&pose.translations).zip(&translations)
            {
                *velocity += (to - from) * rate;
            }
            let step = self.source.ground_frames()[frame]
                .inverse()
                .after(&self.source.ground_frames()[other]);
            pose.travel += travel(&step, fps) * weight;
        }
        // Both ends are at the same phase of the stride, so that no difference is sway.
        pose.steady_travel = pose.travel;
        pose
    }
}

#[cfg(test)]
mod tests;
