//! Sampling of clips between frames.

use super::Clip;
use crate::math::{curve, quat};
use crate::skeleton::Pose;
use glam::{Quat, Vec3};

/// The interpolation between two frames.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Interpolation {
    /// The nearest frame.
    Nearest,
    /// Linear for positions, spherical (slerp) for rotations.
    #[default]
    Linear,
    /// Catmull-Rom for positions (C¹); for rotations the same in the tangent space of the previous
    /// frame, whose velocity is continuous where the axis is constant, and nearly so for small
    /// steps.
    Cubic,
}

/// A time is that of a frame if it is closer than this, in frames: what is left of the rounding of
/// times and rates.
const SAME_FRAME: f64 = 1e-6;

impl Clip {
    /// Returns the pose at a time, clamped to the clip; `None` for a clip without frames.
    #[must_use]
    pub fn sample(&self, time_secs: f64, interpolation: Interpolation) -> Option<Pose> {
        if interpolation == Interpolation::Linear {
            let mut pose = Pose::default();
            return self.sample_into(time_secs, None, &mut pose).then_some(pose);
        }
        let (frame, part) = self.place_of(time_secs)?;
        if interpolation == Interpolation::Nearest || part == 0.0 {
            return Some(self.pose(if part < 0.5 { frame } else { frame + 1 }));
        }
        // `part > 0` means that there is a next frame.
        let (before, next) = (frame.saturating_sub(1), frame + 1);
        let after = (frame + 2).min(self.frames() - 1);
        let position = |of: &dyn Fn(usize) -> Vec3| {
            curve::catmull_rom(of(before), of(frame), of(next), of(after), part)
        };
        let rotation = |joint: usize| {
            let of = |f: usize| self.rotations(f)[joint];
            cubic_rotation(of(before), of(frame), of(next), of(after), part)
        };
        Some(Pose {
            root_translation: position(&|f| self.root_translations()[f]),
            rotations: (0..self.skeleton().len()).map(rotation).collect(),
            translations: self
                .translations()
                .iter()
                .map(|track| (track.joint, position(&|f| track.values[f])))
                .collect(),
        })
    }

    /// Computes the pose at a time, clamped to the clip, into a buffer: [`Interpolation::Linear`].
    /// A joint for which `wanted` is `false` gets its rotation of the frame before. Returns `false`
    /// for a clip without frames.
    pub(crate) fn sample_into(
        &self,
        time_secs: f64,
        wanted: Option<&[bool]>,
        pose: &mut Pose,
    ) -> bool {
        let Some((frame, part)) = self.place_of(time_secs) else {
            return false;
        };
        let next = if part > 0.0 { frame + 1 } else { frame };
        let position = |values: &[Vec3]| match part {
            0.0 => values[frame],
            _ => values[frame].lerp(values[next], part),
        };
        pose.root_translation = position(self.root_translations());
        pose.translations.clear();
        let tracks = self.translations().iter();
        pose.translations.extend(tracks.map(|track| (track.joint, position(&track.values))));
        pose.rotations.clear();
        pose.rotations.extend_from_slice(self.rotations(frame));
        if part > 0.0 {
            let pairs = pose.rotations.iter_mut().zip(self.rotations(next));
            for (joint, (rotation, &next)) in pairs.enumerate() {
                if wanted.is_none_or(|wanted| wanted[joint]) {
                    *rotation = quat::slerp(*rotation, next, part);
                }
            }
        }
        true
    }

    /// Returns the frame at or before a time that is clamped to the clip, and the part of the way
    /// to the next, 0 in a frame; `None` for a clip without frames.
    fn place_of(&self, time_secs: f64) -> Option<(usize, f32)> {
        let last = self.frames().checked_sub(1)?;
        // NaN gives frame 0: `max` returns the other operand.
        let at = (time_secs * self.fps()).max(0.0).min(last as f64);
        let nearest = at.round();
        if (at - nearest).abs() < SAME_FRAME {
            return Some((nearest as usize, 0.0));
        }
        Some((at.floor() as usize, at.fract() as f32))
    }
}

/// Interpolates by Catmull-Rom between `q1` and `q2` on rotation vectors relative to `q1`.
fn cubic_rotation(q0: Quat, q1: Quat, q2: Quat, q3: Quat, t: f32) -> Quat {
    let relative = |q: Quat| quat::log(q * q1.conjugate());
    let (v0, v2) = (relative(q0), relative(q2));
    // The last vector continues from q2, so that two steps of up to half a turn each do not wrap.
    let v3 = v2 + quat::log(q3 * q2.conjugate());
    quat::renormalize(quat::exp(curve::catmull_rom(v0, Vec3::ZERO, v2, v3, t)) * q1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clip::fixtures::wander;
    use crate::skeleton::fixtures;

    #[test]
    fn time_of_a_frame_gives_its_pose_in_spite_of_rounding() {
        let clip = wander(&fixtures::lafan(), 40, 3);
        let all = [Interpolation::Nearest, Interpolation::Linear, Interpolation::Cubic];
        for interpolation in all {
            for frame in 0..40 {
                for off in [-1e-9, 0.0, 1e-9] {
                    let pose = clip.sample(clip.time_of(frame) + off, interpolation).unwrap();
                    assert_eq!(pose, clip.pose(frame), "{interpolation:?}, frame {frame}");
                }
            }
            let between = clip.sample(clip.time_of(7) + 0.4 / clip.fps(), interpolation).unwrap();
            assert_eq!(between == clip.pose(7), interpolation == Interpolation::Nearest);
        }
        assert_eq!(clip.sample(f64::NAN, Interpolation::Linear), Some(clip.pose(0)));
    }

    #[test]
    fn pose_of_some_joints_is_that_of_all_there() {
        let clip = wander(&fixtures::lafan(), 20, 5);
        let wanted: Vec<bool> = (0..clip.skeleton().len()).map(|joint| joint % 3 == 0).collect();
        let mut some = Pose::default();
        for at in 0..57 {
            let secs = f64::from(at) / 3.0 / clip.fps();
            let all = clip.sample(secs, Interpolation::Linear).unwrap();
            assert!(clip.sample_into(secs, Some(&wanted), &mut some));
            assert_eq!(some.root_translation, all.root_translation);
            for joint in (0..wanted.len()).filter(|&joint| wanted[joint]) {
                assert_eq!(some.rotations[joint], all.rotations[joint], "{at} {joint}");
            }
        }
    }
}
