//! Two-bone inverse kinematics.

use glam::Vec3;

/// The directions of two bones that reach a target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TwoBoneIk {
    /// Unit direction of the upper bone, from its joint to the middle one.
    pub upper: Vec3,
    /// Unit direction of the lower bone, from the middle joint to the end.
    pub lower: Vec3,
    /// Unit axis about which the lower bone is bent against the upper one, perpendicular to both;
    /// the bend about it is never negative.
    pub hinge: Vec3,
}

/// Solves two-bone inverse kinematics (the law of cosines): bends two bones so that their end lies
/// at `line` from their start. The middle joint bends about `hinge` as nearly as the line allows: a
/// knee for a hip-to-ankle line and a hinge to the character's left.
///
/// For a target out of reach the bones are straight and point at it; for one that is too near they
/// are folded. Only for a line along the hinge the plane of the bend is undefined; any is taken
/// then. Lengths in metres, above 0; everything in one frame of reference.
#[must_use]
pub fn two_bone_ik(line: Vec3, upper: f32, lower: f32, hinge: Vec3) -> TwoBoneIk {
    let (distance, along) = (line.length(), line.normalize_or(Vec3::NEG_Y));
    let hinge = hinge.reject_from_normalized(along).normalize_or(along.any_orthonormal_vector());
    let distance = distance.clamp((upper - lower).abs() + 1e-4, upper + lower);
    // The distance of the middle joint along the line, and beside it. In f64: near full stretch the
    // square root takes half of the digits.
    let [a, b, d] = [upper, lower, distance].map(f64::from);
    let foot = (a * a + d * d - b * b) / (2.0 * d);
    let beside = (a * a - foot * foot).max(0.0).sqrt();
    let out = along.cross(hinge);
    TwoBoneIk {
        upper: (along * (foot / a) as f32 + out * (beside / a) as f32).normalize_or(along),
        lower: (along * ((d - foot) / b) as f32 - out * (beside / b) as f32).normalize_or(along),
        hinge,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn two_bone_ik_within_reach_bends_about_the_hinge(
            x in -0.3f32..0.3,
            y in -0.8f32..-0.3,
            z in -0.4f32..0.4,
            upper in 0.3f32..0.5,
            side in -0.4f32..0.4,
        ) {
            let (line, lower) = (Vec3::new(x, y, z), 0.42);
            prop_assume!(line.length() < upper + lower - 1e-3);
            let bones = two_bone_ik(line, upper, lower, Vec3::new(1.0, side, 0.0));
            prop_assert!((bones.upper * upper + bones.lower * lower - line).length() < 2e-5);
            prop_assert!(bones.upper.cross(bones.lower).dot(bones.hinge) >= -1e-5);
            prop_assert!(bones.hinge.dot(bones.upper).abs() < 1e-5 && bones.hinge.x > 0.0);
            // A knee that bends about the left side moves forwards.
            let knee = bones.upper * upper;
            prop_assert!((knee - line * knee.dot(line) / line.length_squared()).z >= -1e-4);
        }

        #[test]
        fn two_bone_ik_out_of_reach_is_straight(
            x in -3.0f32..3.0,
            y in -3.0f32..-0.9,
            z in -3.0f32..3.0,
        ) {
            let line = Vec3::new(x, y, z);
            let bones = two_bone_ik(line, 0.43, 0.42, Vec3::X);
            for bone in [bones.upper, bones.lower] {
                prop_assert!(bone.distance(line.normalize_or_zero()) < 1e-3);
            }
        }
    }

    #[test]
    fn two_bone_ik_too_near_is_folded_and_finite() {
        for line in [Vec3::ZERO, Vec3::NEG_Y * 1e-6, Vec3::X] {
            for (upper, lower) in [(0.4, 0.4), (0.5, 0.3)] {
                let bones = two_bone_ik(line, upper, lower, Vec3::X);
                assert!(
                    (bones.upper.length() - 1.0).abs() < 1e-5
                        && (bones.lower.length() - 1.0).abs() < 1e-5
                );
            }
        }
        let folded = two_bone_ik(Vec3::NEG_Y * 1e-6, 0.5, 0.3, Vec3::X);
        assert!(folded.upper.dot(folded.lower) < -0.999);
    }
}
