//! Two bones from the hip to a given ankle.

use glam::{Mat3, Quat, Vec3};

/// World rotations of thigh and shank that bring the ankle to its place, the knee bent about `hinge` as nearly as the ankle allows.
///
/// Both bones point down -Y at rest and the knee bends about +X, the left side of the body. A target out of reach is pointed at with the leg straight.
/// Only a leg stretched out sideways would have no plane to bend in; a thigh may be lifted to any height.
pub(super) fn two_bones(hip: Vec3, ankle: Vec3, thigh: f32, shank: f32, hinge: Vec3) -> (Quat, Quat) {
    let line = ankle - hip;
    let distance = line.length().clamp((thigh - shank).abs() + 1e-4, thigh + shank);
    let up = (-line).normalize_or(Vec3::Y);
    let side = hinge.reject_from_normalized(up).normalize_or(Vec3::X);
    let frame = Quat::from_mat3(&Mat3::from_cols(side, up, side.cross(up)));
    // Law of cosines: between thigh and line at the hip, and between the bones at the knee.
    let at_hip = (thigh * thigh + distance * distance - shank * shank) / (2.0 * thigh * distance);
    let at_knee = (thigh * thigh + shank * shank - distance * distance) / (2.0 * thigh * shank);
    let lift = at_hip.clamp(-1.0, 1.0).acos();
    let flexion = std::f32::consts::PI - at_knee.clamp(-1.0, 1.0).acos();
    let thigh_rotation = frame * Quat::from_rotation_x(-lift);
    (thigh_rotation, thigh_rotation * Quat::from_rotation_x(flexion))
}

/// The identity up to `from`, then bent so that it never passes `to`; its slope has no step.
pub(super) fn soft_limit(value: f32, from: f32, to: f32) -> f32 {
    if value <= from || to <= from {
        return value;
    }
    let room = to - from;
    from + room * (1.0 - (-(value - from) / room).exp())
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn the_ankle_is_reached_and_the_knee_bends_forwards(x in -0.3f32..0.3, y in -0.8f32..-0.3, z in -0.4f32..0.4) {
            let (thigh, shank) = (0.43, 0.42);
            let (hip, ankle) = (Vec3::new(0.1, 0.9, 0.0), Vec3::new(0.1 + x, 0.9 + y, z));
            prop_assume!((ankle - hip).length() < 0.849);
            let (a, b) = two_bones(hip, ankle, thigh, shank, Vec3::X);
            let knee = hip + a * Vec3::new(0.0, -thigh, 0.0);
            prop_assert!((knee + b * Vec3::new(0.0, -shank, 0.0) - ankle).length() < 2e-5);
            let straight = hip + (ankle - hip) * (knee - hip).dot(ankle - hip) / (ankle - hip).length_squared();
            prop_assert!((knee - straight).z >= -1e-4);
        }
    }

    #[test]
    fn the_soft_limit_is_smooth_and_bounded() {
        assert_eq!(soft_limit(0.8, 0.9, 1.0), 0.8);
        assert!((soft_limit(0.9 + 1e-3, 0.9, 1.0) - 0.901).abs() < 1e-4);
        assert!(soft_limit(5.0, 0.9, 1.0) <= 1.0);
    }
}
