//! Rotations in 48 bits: the three smallest components of a quaternion.
//!
//! The largest component follows from the others, because the length is 1, and is positive, because
//! a quaternion and its negative are one rotation. The others are at most 1/√2, in 15 bits each:
//! half a step is an error of the rotation below 0.01°.

use glam::Quat;
use std::f32::consts::{FRAC_1_SQRT_2, SQRT_2};

/// The greatest number of a component; the least is its negative, and 0 is exact.
const MOST: i64 = 16_383;
/// Bits of a component.
const BITS: u32 = 15;

/// Returns a rotation in 48 bits, little-endian: from the top the index of the largest component
/// (x, y, z, w) in two bits that follow an unused one, then the others in order, 15 bits each,
/// raised by 16,383. One that is not finite, or 0, becomes the identity.
#[must_use]
pub fn encode_rotation(rotation: Quat) -> [u8; 6] {
    let own = unit(rotation.to_array());
    let (mut largest, mut most) = (0, own[0].abs());
    for (index, part) in own.iter().enumerate().skip(1) {
        if part.abs() > most {
            (largest, most) = (index, part.abs());
        }
    }
    let sign = if own[largest] < 0.0 { -1.0 } else { 1.0 };
    let mut bits = largest as u64;
    for (_, part) in own.iter().enumerate().filter(|(index, _)| *index != largest) {
        let step = (sign * part * SQRT_2 * MOST as f32).round() as i64;
        bits = (bits << BITS) | (step.clamp(-MOST, MOST) + MOST) as u64;
    }
    let [a, b, c, d, e, f, ..] = bits.to_le_bytes();
    [a, b, c, d, e, f]
}

/// Returns the rotation of [`encode_rotation`]; any bytes give a unit quaternion.
#[must_use]
pub fn decode_rotation(bytes: [u8; 6]) -> Quat {
    let [a, b, c, d, e, f] = bytes;
    let bits = u64::from_le_bytes([a, b, c, d, e, f, 0, 0]);
    let largest = ((bits >> (3 * BITS)) & 3) as usize;
    let mut parts = [0.0f32; 4];
    let mut squares = 0.0;
    let mut shift = 3 * BITS;
    for (_, part) in parts.iter_mut().enumerate().filter(|(index, _)| *index != largest) {
        shift -= BITS;
        let step = ((bits >> shift) & ((1 << BITS) - 1)) as i64 - MOST;
        *part = step as f32 / MOST as f32 * FRAC_1_SQRT_2;
        squares += *part * *part;
    }
    parts[largest] = (1.0 - squares).max(0.0).sqrt();
    Quat::from_array(unit(parts))
}

/// Returns the components of a unit quaternion, in the same order of sums on every machine.
fn unit(parts: [f32; 4]) -> [f32; 4] {
    let length = parts.iter().map(|part| part * part).sum::<f32>().sqrt();
    if length.is_finite() && length > 1e-6 {
        parts.map(|part| part / length)
    } else {
        Quat::IDENTITY.to_array()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Returns the angle between two rotations, degrees; `acos` has no digits for small ones.
    fn degrees_between(a: Quat, b: Quat) -> f32 {
        let apart = (b * a.dot(b).signum() - a).length();
        (4.0 * (0.5 * apart).asin()).to_degrees()
    }

    proptest! {
        #[test]
        fn rotation_in_48_bits_is_kept_to_a_hundredth_of_a_degree(
            axis in prop::array::uniform3(-1.0f32..1.0), angle in -7.0f32..7.0
        ) {
            let axis = glam::Vec3::from_array(axis);
            prop_assume!(axis.length() > 1e-3);
            let rotation = Quat::from_axis_angle(axis / axis.length(), angle);
            let back = decode_rotation(encode_rotation(rotation));
            let degrees = degrees_between(rotation, back);
            prop_assert!(degrees < 0.01, "{degrees}");
        }

        #[test]
        fn any_bytes_are_a_rotation(bytes in prop::array::uniform6(any::<u8>())) {
            prop_assert!((decode_rotation(bytes).length() - 1.0).abs() < 1e-6);
        }
    }

    #[test]
    fn identity_is_exact_and_nonsense_becomes_it() {
        assert_eq!(decode_rotation(encode_rotation(Quat::IDENTITY)), Quat::IDENTITY);
        for odd in [Quat::from_xyzw(0.0, 0.0, 0.0, 0.0), Quat::from_xyzw(f32::NAN, 0.0, 0.0, 1.0)] {
            assert_eq!(decode_rotation(encode_rotation(odd)), Quat::IDENTITY);
        }
        let half = Quat::from_xyzw(0.0, -1.0, 0.0, 0.0);
        assert_eq!(decode_rotation(encode_rotation(half)), Quat::from_xyzw(0.0, 1.0, 0.0, 0.0));
    }
}
