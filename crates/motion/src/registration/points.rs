//! Weights of joints, and the unit of distances.

use super::RegistrationError;
use crate::skeleton::Skeleton;

/// The body height to which distances are scaled, metres.
pub const REFERENCE_HEIGHT_M: f64 = 1.75;

/// Returns the root-mean-square distance per point, centimetres on a body of
/// [`REFERENCE_HEIGHT_M`].
///
/// `distance` is a weighted sum of squared distances (m²) over points with the total weight
/// `weight` (D and W of the [module](super)'s formula), measured on a body `body_height` metres
/// tall ([`crate::skeleton::Roles::body_height`]): `100 · √(D / W) · 1.75 / height`. NaN if height
/// or weight is not above 0.
#[must_use]
pub fn rms_cm(distance: f64, weight: f64, body_height: f64) -> f64 {
    if !(weight > 0.0 && body_height > 0.0) {
        return f64::NAN;
    }
    100.0 * (distance.max(0.0) / weight).sqrt() * REFERENCE_HEIGHT_M / body_height
}

/// Returns the same weight for every joint; their sum is 1.
#[must_use]
pub fn uniform_weights(skeleton: &Skeleton) -> Vec<f64> {
    vec![1.0 / skeleton.len() as f64; skeleton.len()]
}

/// Returns weights by limb length; their sum is 1.
///
/// Every joint gets half of each bone that meets in it, so that the weighted sum is the integral
/// over the limbs by the trapezoid rule. Thirty finger joints then have the weight of the hands'
/// length, not that of thirty joints. Uniform for a skeleton without lengths.
#[must_use]
pub fn limb_weights(skeleton: &Skeleton) -> Vec<f64> {
    let mut weights = vec![0.0; skeleton.len()];
    for (index, joint) in skeleton.joints().iter().enumerate() {
        if let Some(parent) = joint.parent {
            let half = f64::from(joint.offset.length()) / 2.0;
            weights[index] += half;
            weights[parent] += half;
        }
        if let Some(end) = joint.end_site {
            weights[index] += f64::from(end.length()) / 2.0;
        }
    }
    let total: f64 = weights.iter().sum();
    if !(total.is_finite() && total > 0.0) {
        return uniform_weights(skeleton);
    }
    weights.into_iter().map(|weight| weight / total).collect()
}

/// Returns the sum of the weights.
///
/// # Errors
/// [`RegistrationError::Weights`] unless there are `expected` of them, none negative or not finite,
/// and at least one above 0.
pub(super) fn checked_sum(weights: &[f64], expected: usize) -> Result<f64, RegistrationError> {
    let sum: f64 = weights.iter().sum();
    if weights.len() == expected
        && weights.iter().all(|&w| w >= 0.0)
        && sum > 0.0
        && sum.is_finite()
    {
        Ok(sum)
    } else {
        Err(RegistrationError::Weights { found: weights.len(), expected })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::skeleton::Joint;
    use glam::Vec3;

    fn joint(parent: Option<usize>, offset: Vec3, end_site: Option<Vec3>) -> Joint {
        Joint { name: "j".into(), parent, offset, end_site, channels: vec![] }
    }

    #[test]
    fn limb_weights_are_proportional_to_bone_lengths() {
        let skeleton = Skeleton::new(vec![
            joint(None, Vec3::ZERO, None),
            joint(Some(0), Vec3::Y * 0.6, None),
            joint(Some(1), Vec3::Y * 0.2, Some(Vec3::Y * 0.2)),
        ])
        .unwrap();
        let weights = limb_weights(&skeleton);
        // Halves: 0.3 | 0.3 + 0.1 | 0.1 + 0.1, of 0.9 (the outer half of the end site belongs to no
        // joint).
        for (weight, expected) in weights.iter().zip([3.0 / 9.0, 4.0 / 9.0, 2.0 / 9.0]) {
            assert!((weight - expected).abs() < 1e-6);
        }
    }

    #[test]
    fn limb_weights_without_lengths_are_uniform() {
        let skeleton =
            Skeleton::new(vec![joint(None, Vec3::ZERO, None), joint(Some(0), Vec3::ZERO, None)])
                .unwrap();
        assert_eq!(limb_weights(&skeleton), [0.5, 0.5]);
    }

    #[test]
    fn rms_cm_is_scaled_to_the_reference_body() {
        // Points 3 cm apart on a body of 0.875 m are 6 cm apart on one of 1.75 m.
        assert!((rms_cm(0.03 * 0.03 * 8.0, 8.0, 0.875) - 6.0).abs() < 1e-12);
        assert!(rms_cm(1.0, 0.0, 1.75).is_nan());
    }
}
