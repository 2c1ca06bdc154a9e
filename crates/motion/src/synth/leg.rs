//! Two-bone inverse kinematics from the hip to a given ankle.

use crate::skeleton::two_bone_ik;
use glam::{Mat3, Quat, Vec3};

/// Returns the world rotations of thigh and shank that bring the ankle to its position, with the
/// knee bent about `hinge` as nearly as the ankle allows.
///
/// Both bones point down -Y at rest and the knee bends about +X, the left side of the body. For a
/// target out of reach the leg is straight and points at it. Only a leg that is stretched out
/// sideways has no plane to bend in; a thigh may be lifted to any height.
pub(super) fn leg(hip: Vec3, ankle: Vec3, thigh: f32, shank: f32, hinge: Vec3) -> (Quat, Quat) {
    let bones = two_bone_ik(ankle - hip, thigh, shank, hinge);
    let rotation =
        |bone: Vec3| Quat::from_mat3(&Mat3::from_cols(bones.hinge, -bone, bone.cross(bones.hinge)));
    (rotation(bones.upper), rotation(bones.lower))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn leg_within_reach_ends_at_the_ankle(
            x in -0.3f32..0.3,
            y in -0.8f32..-0.3,
            z in -0.4f32..0.4,
        ) {
            let (thigh, shank) = (0.43, 0.42);
            let (hip, ankle) = (Vec3::new(0.1, 0.9, 0.0), Vec3::new(0.1 + x, 0.9 + y, z));
            prop_assume!((ankle - hip).length() < 0.849);
            let (a, b) = leg(hip, ankle, thigh, shank, Vec3::X);
            let knee = hip + a * Vec3::new(0.0, -thigh, 0.0);
            prop_assert!((knee + b * Vec3::new(0.0, -shank, 0.0) - ankle).length() < 2e-5);
            prop_assert!((a * Vec3::X - b * Vec3::X).length() < 1e-5);
        }
    }
}
