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

impl Clip {
    /// Returns the pose at `time_secs`, clamped to the clip; `None` for a clip without frames.
    #[must_use]
    pub fn sample(&self, time_secs: f64, interpolation: Interpolation) -> Option<Pose> {
        let last = self.frames().checked_sub(1)?;
        // NaN gives frame 0: `max` returns the other operand.
        let at = (time_secs * self.fps()).max(0.0).min(last as f64);
        let (frame, part) = (at.floor() as usize, at.fract() as f32);
        let nearest = at.round() as usize;
        if interpolation == Interpolation::Nearest || part == 0.0 {
            return Some(self.pose(nearest));
        }
        // `part > 0` means that there is a next frame.
        let (before, next, after) = (frame.saturating_sub(1), frame + 1, (frame + 2).min(last));
        let position = |of: &dyn Fn(usize) -> Vec3| match interpolation {
            Interpolation::Cubic => {
                curve::catmull_rom(of(before), of(frame), of(next), of(after), part)
            }
            _ => of(frame).lerp(of(next), part),
        };
        let rotation = |joint: usize| {
            let of = |f: usize| self.rotations(f)[joint];
            match interpolation {
                Interpolation::Cubic => {
                    cubic_rotation(of(before), of(frame), of(next), of(after), part)
                }
                _ => quat::slerp(of(frame), of(next), part),
            }
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
}

/// Interpolates by Catmull-Rom between `q1` and `q2` on rotation vectors relative to `q1`.
fn cubic_rotation(q0: Quat, q1: Quat, q2: Quat, q3: Quat, t: f32) -> Quat {
    let relative = |q: Quat| quat::log(q * q1.conjugate());
    let (v0, v2) = (relative(q0), relative(q2));
    // The last vector continues from q2, so that two steps of up to half a turn each do not wrap.
    let v3 = v2 + quat::log(q3 * q2.conjugate());
    quat::renormalize(quat::exp(curve::catmull_rom(v0, Vec3::ZERO, v2, v3, t)) * q1)
}
