//! Jolts: sudden changes of a joint's angular velocity.

use super::Clip;
use crate::math::{quat, stats};
use glam::{Quat, Vec3};

/// A joint whose rotation per frame changes by less than this is still, radians: the rounding of
/// single precision at rest.
const STILL_RADIANS: f32 = 1e-4;
/// The number of frames from which the usual jolt is computed: enough for a 99th percentile, and
/// bounded for long clips.
const SAMPLES: usize = 1_000;

/// Returns the change of a joint's rotation from the step into `frame` to the step out of it: the
/// length of the difference of the two rotation vectors, radians. `None` in the first and the last
/// frame, and where there is no such frame or joint.
pub(crate) fn turn_change(clip: &Clip, frame: usize, joint: usize) -> Option<f32> {
    let at = |frame: usize| {
        (frame < clip.frames()).then(|| clip.rotations(frame).get(joint).copied()).flatten()
    };
    let (before, here, after) =
        (at(frame.checked_sub(1)?)?, at(frame)?, at(frame.checked_add(1)?)?);
    Some((turn(here, after) - turn(before, here)).length())
}

/// Returns the rotation vector from one rotation to another. It equals that of [`quat::log`], with
/// an arc tangent that is the same to the last digit on every machine, because motion graphs depend
/// on it.
fn turn(from: Quat, to: Quat) -> Vec3 {
    let q = quat::with_positive_scalar(to * from.conjugate());
    let v = Vec3::new(q.x, q.y, q.z);
    let sine = v.length();
    if sine < 1e-9 {
        return v * 2.0;
    }
    v * (2.0 * libm::atan2f(sine, q.w) / sine)
}

/// Returns the [`turn_change`] of a joint in every frame; 0 in the first and the last one.
fn turn_changes(clip: &Clip, joint: usize) -> Vec<f32> {
    let frames = clip.frames();
    let mut changes = vec![0.0; frames];
    let turn_into =
        |frame: usize| turn(clip.rotations(frame - 1)[joint], clip.rotations(frame)[joint]);
    if frames < 3 {
        return changes;
    }
    let mut before = turn_into(1);
    for (frame, change) in changes[..frames - 1].iter_mut().enumerate().skip(1) {
        let after = turn_into(frame + 1);
        *change = (after - before).length();
        before = after;
    }
    changes
}

/// Returns the distance of the frames from which the usual change is computed.
fn stride(clip: &Clip) -> usize {
    clip.frames().div_ceil(SAMPLES).max(1)
}

/// Returns the usual change of a joint, radians; the changes are one in every [`stride`] frames.
fn usual(changes: impl Iterator<Item = f32>) -> f32 {
    let sampled: Vec<f32> = changes.collect();
    stats::percentile(&sampled, 0.99).unwrap_or(0.0).max(STILL_RADIANS)
}

/// The [`jolts`] of single frames of a clip. It does not hold the clip: every call must be given
/// the same one.
#[derive(Clone, Debug)]
pub(crate) struct SingleJolts {
    /// The usual change of each joint, radians.
    usual: Vec<f32>,
}

impl SingleJolts {
    /// Computes the usual changes, in time that does not depend on the length of a long clip.
    pub(crate) fn new(clip: &Clip) -> Self {
        let of_joint = |joint: usize| {
            let frames = (0..clip.frames()).step_by(stride(clip));
            usual(frames.map(|frame| turn_change(clip, frame, joint).unwrap_or(0.0)))
        };
        Self { usual: (0..clip.skeleton().len()).map(of_joint).collect() }
    }

    /// Returns the value of a frame, bit for bit as [`jolts`] does; 0 where there is no such frame.
    pub(crate) fn at(&self, clip: &Clip, frame: usize) -> f32 {
        let jolts = self
            .usual
            .iter()
            .enumerate()
            .map(|(joint, usual)| turn_change(clip, frame, joint).unwrap_or(0.0) / usual);
        jolts.fold(0.0, f32::max)
    }
}

/// Returns for every frame the largest ratio over all joints of the [`turn_change`] to its usual
/// value for that joint, the 99th percentile of the clip. A value above 1 occurs in one frame in a
/// hundred: a heel strike, or a tremble of the capture. 0 in the first and the last frame.
pub(crate) fn jolts(clip: &Clip) -> Vec<f32> {
    let mut jolting = JoltScan::new(clip);
    while !jolting.advance(clip, usize::MAX) {}
    jolting.jolts
}

/// The computation of [`jolts`] in slices. It does not hold the clip: every call must be given the
/// same one.
#[derive(Clone, Debug)]
pub(crate) struct JoltScan {
    jolts: Vec<f32>,
    /// The next joint.
    joint: usize,
}

impl JoltScan {
    pub(crate) fn new(clip: &Clip) -> Self {
        Self { jolts: vec![0.0; clip.frames()], joint: 0 }
    }

    /// Processes up to `joints` more joints, at least one; returns `true` when nothing is left to
    /// do. 30,000 frames of a joint take about 3 ms.
    pub(crate) fn advance(&mut self, clip: &Clip, joints: usize) -> bool {
        let all = clip.skeleton().len();
        for joint in self.joint..self.joint.saturating_add(joints.max(1)).min(all) {
            let changes = turn_changes(clip, joint);
            let usual = usual(changes.iter().copied().step_by(stride(clip)));
            for (jolt, change) in self.jolts.iter_mut().zip(changes) {
                *jolt = jolt.max(change / usual);
            }
            self.joint = joint + 1;
        }
        self.joint >= all
    }

    pub(crate) fn finish(self) -> Vec<f32> {
        self.jolts
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::skeleton::fixtures;
    use std::sync::Arc;

    #[test]
    fn jolts_of_a_jerk_in_one_frame_stand_out() {
        let skeleton = fixtures::lafan();
        let (frames, joints) = (300, skeleton.len());
        let mut rotations: Vec<Quat> = (0..frames)
            .flat_map(|frame| {
                std::iter::repeat_n(Quat::from_rotation_x(0.4 * (0.1 * frame as f32).sin()), joints)
            })
            .collect();
        rotations[150 * joints + 3] *= Quat::from_rotation_x(0.05);
        let clip = Clip::new("jerk", Arc::clone(&skeleton), 60.0, rotations, vec![Vec3::Y; frames])
            .unwrap();
        // The reverse change is twice as large, except for the little that the joint turns anyway.
        assert!((turn_change(&clip, 150, 3).unwrap() - 0.1).abs() < 0.005);
        assert!(turn_change(&clip, 150, 2).unwrap() < 0.005);
        for (frame, joint) in [(0, 3), (frames - 1, 3), (frames, 3), (usize::MAX, 3), (5, joints)] {
            assert_eq!(turn_change(&clip, frame, joint), None);
        }
        let jolts = jolts(&clip);
        assert!(
            jolts[150] > 20.0 && jolts[149] > 10.0 && jolts[151] > 10.0,
            "{:?}",
            &jolts[148..153]
        );
        for (frame, jolt) in jolts.iter().enumerate().filter(|(frame, _)| frame.abs_diff(150) > 1) {
            assert!(*jolt < 1.1, "{frame} {jolt}");
        }
        assert_eq!((jolts[0], jolts[frames - 1]), (0.0, 0.0));
        let single = SingleJolts::new(&clip);
        for (frame, jolt) in jolts.iter().enumerate() {
            assert_eq!(single.at(&clip, frame).to_bits(), jolt.to_bits());
        }
        assert_eq!(single.at(&clip, frames), 0.0);
    }

    #[test]
    fn turn_agrees_with_the_logarithm() {
        for angle in [0.0_f32, 1e-5, 0.01, 1.0, 3.0] {
            let (from, axis) = (Quat::from_rotation_y(0.7), Vec3::new(0.6, 0.0, 0.8));
            let to = Quat::from_axis_angle(axis, angle) * from;
            let wanted = quat::log(to * from.conjugate());
            assert!(turn(from, to).distance(wanted) <= 1e-6 * angle, "{angle}");
            assert!(turn(from, -to).distance(wanted) <= 1e-6 * angle);
        }
    }

    #[test]
    fn jolts_of_a_still_clip_are_zero() {
        let skeleton = fixtures::lafan();
        for frames in [1, 2, 5] {
            let rotations = vec![Quat::IDENTITY; frames * skeleton.len()];
            let clip =
                Clip::new("still", Arc::clone(&skeleton), 60.0, rotations, vec![Vec3::Y; frames])
                    .unwrap();
            assert_eq!(jolts(&clip), vec![0.0; frames]);
            assert_eq!(SingleJolts::new(&clip).at(&clip, 0), 0.0);
        }
    }
}
