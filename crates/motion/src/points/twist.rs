//! The twist of a bone about its own direction, as an angle over time.

use crate::math::curve::smoothstep;
use glam::{Quat, Vec3};
use std::f32::consts::{PI, TAU};

/// Angles with less confidence than this are interpolated.
const TRUSTED: f32 = 0.05;
/// The weight of an interpolated angle in the mean over neighbouring frames.
const INTERPOLATED: f32 = 0.3;
/// Standard deviation of the mean over neighbouring frames, seconds.
const SMOOTH_SECS: f64 = 0.04;
/// The greatest number of frames on either side that the mean is taken over.
const MAX_RADIUS: usize = 200;
/// The sines of the flexion between which the confidence in a limb's plane rises from 0 to 1: 6°
/// and 20°.
const BEND: (f32, f32) = (0.1, 0.35);
/// The distances of a helper from the bone, as shares of the bone's length, between which the
/// confidence in it rises from 0 to 1.
const LEVER: (f32, f32) = (0.02, 0.08);

/// The twist of a bone in a frame: an angle and its confidence, 0 to 1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Twist {
    pub(super) angle: f32,
    pub(super) weight: f32,
}

impl Twist {
    /// Returns the angle about the unit vector `axis` that takes `from` to `to`, both projected
    /// across the axis; weight 0 if one of them has no part across it.
    pub(super) fn between(axis: Vec3, from: Vec3, to: Vec3, weight: f32) -> Self {
        let (from, to) = (from.reject_from_normalized(axis), to.reject_from_normalized(axis));
        if from.length_squared() < 1e-12 || to.length_squared() < 1e-12 {
            return Self::default();
        }
        Self { angle: libm::atan2f(from.cross(to).dot(axis), from.dot(to)), weight }
    }

    /// Returns the twist that turns `hinge` into the axis about which the limb bends from the unit
    /// vector `bone` to `next`.
    pub(super) fn of_plane(bone: Vec3, hinge: Vec3, next: Vec3) -> Self {
        let Some(next) = next.try_normalize() else { return Self::default() };
        let axis = bone.cross(next);
        Self::between(bone, hinge, axis, smooth_between(BEND, axis.length()))
    }

    /// Returns the twist that turns `beside` towards a helper at `offset` from the joint.
    pub(super) fn of_helper(bone: Vec3, length: f32, beside: Vec3, offset: Vec3) -> Self {
        let lever = offset.reject_from_normalized(bone).length() / length.max(f32::MIN_POSITIVE);
        Self::between(bone, beside, offset, smooth_between(LEVER, lever))
    }
}

fn smooth_between((from, to): (f32, f32), value: f32) -> f32 {
    smoothstep((value - from) / (to - from))
}

/// Returns an angle for every frame: measured ones averaged over neighbours by their weights, those
/// between interpolated without a jump.
pub(super) fn settle(twists: &[Twist], fps: f64) -> Vec<f32> {
    let known: Vec<bool> = twists.iter().map(|twist| twist.weight > TRUSTED).collect();
    let mut angles: Vec<f32> = twists.iter().map(|twist| twist.angle).collect();
    if !known.contains(&true) {
        return vec![0.0; twists.len()];
    }
    let mut last: Option<f32> = None;
    for (angle, _) in angles.iter_mut().zip(&known).filter(|(_, known)| **known) {
        if let Some(last) = last {
            *angle += TAU * ((last - *angle) / TAU).round();
        }
        last = Some(*angle);
    }
    super::gaps::fill_between(&known, &mut angles, |a, b, t| a + (b - a) * t);
    // Without a valid frame rate every angle stays as it is.
    let sigma = (SMOOTH_SECS * fps).max(1e-3);
    let radius = ((3.0 * sigma).round() as usize).min(MAX_RADIUS);
    let kernel: Vec<f32> =
        (0..=radius).map(|step| libm::exp(-0.5 * (step as f64 / sigma).powi(2)) as f32).collect();
    let weight = |frame: usize| if known[frame] { twists[frame].weight } else { INTERPOLATED };
    (0..angles.len())
        .map(|frame| {
            let window = frame.saturating_sub(radius)..(frame + radius + 1).min(angles.len());
            let (mut sum, mut total) = (0.0, 0.0);
            for other in window {
                let w = kernel[frame.abs_diff(other)] * weight(other);
                sum += w * angles[other];
                total += w;
            }
            sum / total
        })
        .collect()
}

/// Returns the rotation about a unit vector by an angle of any size.
pub(super) fn about(axis: Vec3, angle: f32) -> Quat {
    Quat::from_axis_angle(axis, (angle + PI).rem_euclid(TAU) - PI)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settle_bridges_straight_limbs_without_a_jump() {
        let fps = 30.0;
        let twist = |frame: usize| Twist {
            // Beyond half a turn, so that the measured angle wraps.
            angle: crate::math::wrap_angle(f64::from(frame as f32 * 0.1)) as f32,
            weight: if (20..40).contains(&frame) { 0.0 } else { 1.0 },
        };
        let twists: Vec<Twist> = (0..60).map(twist).collect();
        let settled = settle(&twists, fps);
        for (frame, angle) in settled.iter().enumerate().skip(5).take(50) {
            assert!((angle - frame as f32 * 0.1).abs() < 0.08, "{frame}: {angle}");
        }
        assert_eq!(settle(&[Twist::default(); 3], fps), [0.0; 3]);
        assert_eq!(settle(&[], fps), [0.0; 0]);
    }

    #[test]
    fn twist_of_a_plane_is_the_angle_of_the_hinge() {
        let bent = |angle: f32| about(Vec3::NEG_Y, angle) * Vec3::new(0.0, -1.0, -1.0);
        for angle in [-1.2, 0.0, 0.7] {
            let twist = Twist::of_plane(Vec3::NEG_Y, Vec3::X, bent(angle));
            assert!((twist.angle - angle).abs() < 1e-5, "{twist:?}");
            assert_eq!(twist.weight, 1.0);
        }
        assert_eq!(Twist::of_plane(Vec3::NEG_Y, Vec3::X, Vec3::NEG_Y).weight, 0.0);
        assert_eq!(Twist::of_plane(Vec3::NEG_Y, Vec3::X, Vec3::ZERO).weight, 0.0);
    }
}
