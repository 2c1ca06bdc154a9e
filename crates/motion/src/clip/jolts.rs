use super::Clip;
use crate::math::{quat, stats};
use glam::{Quat, Vec3};

/// A joint whose turning changes by less than this from one step to the next is still, radians:
/// what single precision makes of a joint at rest.
const STILL_RADIANS: f32 = 1e-4;
/// Frames that are looked at for what is usual: enough for a 99th percentile, and bounded for long
/// clips.
const SAMPLES: usize = 1_000;

/// How much a joint's turn changes from the step into `frame` to the step out of it: the length of
/// the difference of the two rotation vectors, radians. `None` in the first and the last frame, and
/// where there is no such frame or joint.
pub(crate) fn turn_change(clip: &Clip, frame: usize, joint: usize) -> Option<f32> {
    let at = |frame: usize| {
        (frame < clip.frames()).then(|| clip.rotations(frame).get(joint).copied()).flatten()
    };
    let (before, here, after) =
        (at(frame.checked_sub(1)?)?, at(frame)?, at(frame.checked_add(1)?)?);
    Some((turn(here, after) - turn(before, here)).length())
}

/// The rotation vector from one rotation to another. As [`quat::log`], but by an arc tangent that
/// is the same to the last digit on every machine: what a motion graph goes by.
fn turn(from: Quat, to: Quat) -> Vec3 {
    let q = quat::with_positive_scalar(to * from.conjugate());
    let v = Vec3::new(q.x, q.y, q.z);
    let sine = v.length();
    if sine < 1e-9 {
        return v * 2.0;
    }
    v * (2.0 * libm::atan2f(sine, q.w) / sine)
}

/// For every frame how much the joints jolt in it: the largest [`turn_change`] of a joint over what
/// is usual for that joint, which is the 99th percentile of the clip. Above 1 stands what one frame
/// in a hundred does: a heel strikes, or the capture trembles. 0 in the first and the last frame.
pub(crate) fn jolts(clip: &Clip) -> Vec<f32> {
    let mut jolting = Jolting::new(clip);
    while !jolting.advance(clip, usize::MAX) {}
    jolting.jolts
}

/// [`jolts`] in slices. Between them it does not hold the clip: every call is given the same one.
#[derive(Clone, Debug)]
pub(crate) struct Jolting {
    jolts: Vec<f32>,
    /// The joint that comes next.
    joint: usize,
}

impl Jolting {
    pub(crate) fn new(clip: &Clip) -> Self {
        Self { jolts: vec![0.0; clip.frames()], joint: 0 }
    }

    /// Looks at up to so many more joints, at least one; `true` when nothing is left to do. 30,000
    /// frames of a joint take about 3 ms.
    pub(crate) fn advance(&mut self, clip: &Clip, joints: usize) -> bool {
        let all = clip.skeleton().len();
        let stride = clip.frames().div_ceil(SAMPLES).max(1);
        for joint in self.joint..self.joint.saturating_add(joints.max(1)).min(all) {
            let changes: Vec<f32> = (0..clip.frames())
                .map(|frame| turn_change(clip, frame, joint).unwrap_or(0.0))
                .collect();
            let sampled: Vec<f32> = changes.iter().copied().step_by(stride).collect();
            let usual = stats::percentile(&sampled, 0.99).unwrap_or(0.0).max(STILL_RADIANS);
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
    fn a_jerk_of_one_joint_in_one_frame_stands_out() {
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
        // There and back again: twice the jerk, but for the little that the joint turns anyway.
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
    }

    #[test]
    fn turns_are_those_of_the_logarithm() {
        for angle in [0.0_f32, 1e-5, 0.01, 1.0, 3.0] {
            let (from, axis) = (Quat::from_rotation_y(0.7), Vec3::new(0.6, 0.0, 0.8));
            let to = Quat::from_axis_angle(axis, angle) * from;
            let wanted = quat::log(to * from.conjugate());
            assert!(turn(from, to).distance(wanted) <= 1e-6 * angle, "{angle}");
            assert!(turn(from, -to).distance(wanted) <= 1e-6 * angle);
        }
    }

    #[test]
    fn a_still_clip_has_no_jolts() {
        let skeleton = fixtures::lafan();
        for frames in [1, 2, 5] {
            let rotations = vec![Quat::IDENTITY; frames * skeleton.len()];
            let clip =
                Clip::new("still", Arc::clone(&skeleton), 60.0, rotations, vec![Vec3::Y; frames])
                    .unwrap();
            assert_eq!(jolts(&clip), vec![0.0; frames]);
        }
    }
}
