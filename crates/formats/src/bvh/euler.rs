//! Conversion between rotations and angles about axes, in any order and of any size.

use glam::{DMat3, DQuat, DVec3, Quat};
use std::f64::consts::TAU;

/// Below this cosine of the middle angle (1e-7 rad from a quarter turn) the outer two rotations are
/// one; the first one keeps the given angle.
const LOCKED: f64 = 1e-7;

/// Returns the unit vector of an axis (0 to 2).
fn axis(index: usize) -> DVec3 {
    match index {
        0 => DVec3::X,
        1 => DVec3::Y,
        _ => DVec3::Z,
    }
}

fn entry(m: &DMat3, row: usize, column: usize) -> f64 {
    m.col(column)[row]
}

/// Returns a rotation in double precision, normalised.
pub(super) fn precise(q: Quat) -> DQuat {
    let q = DQuat::from_xyzw(f64::from(q.x), f64::from(q.y), f64::from(q.z), f64::from(q.w));
    let length = q.length();
    if length > 1e-6 && length.is_finite() { q * length.recip() } else { DQuat::IDENTITY }
}

/// Returns the product of rotations about axes, the first one outermost: `R₀(angle₀) · R₁(angle₁) ·
/// …`.
pub(super) fn compose(axes: &[usize], angles: &[f64]) -> DQuat {
    axes.iter()
        .zip(angles)
        .fold(DQuat::IDENTITY, |q, (&index, &angle)| q * DQuat::from_axis_angle(axis(index), angle))
}

/// Returns the angle (radians) between two rotations.
pub(super) fn distance(a: DQuat, b: DQuat) -> f64 {
    let q = b * a.conjugate();
    2.0 * libm::atan2(DVec3::new(q.x, q.y, q.z).length(), q.w.abs())
}

/// Returns the angles (radians) about three different `axes` whose product is `q`, of all solutions
/// the one nearest to `near`.
///
/// The last angle is read from the first row of the matrix and removed; the rest has two angles,
/// both well defined. Nothing is lost near a middle angle of a quarter turn (gimbal lock), where
/// the usual formulas read the first angle from two vanishing entries. Compare Shoemake, "Euler
/// angle conversion", Graphics Gems IV, 1994.
pub(super) fn three_angles(q: DQuat, axes: [usize; 3], near: [f64; 3]) -> [f64; 3] {
    let [a, b, _] = axes;
    let c = axes[2];
    let m = DMat3::from_quat(q);
    let sign = parity(axes);
    let cosine = libm::hypot(entry(&m, a, a), entry(&m, a, b));
    let last = if cosine > LOCKED {
        libm::atan2(-sign * entry(&m, a, b), entry(&m, a, a))
    } else {
        near[2]
    };
    let rest = q * DQuat::from_axis_angle(axis(c), -last);
    let [first, middle] = two_angles(rest, [a, b]);
    let here = nearest([first, middle, last], near);
    // The other solution: half a turn more outside, the middle mirrored.
    let half = TAU / 2.0;
    let other = nearest([first + half, half - middle, last + half], near);
    let far = |angles: &[f64; 3]| {
        angles.iter().zip(near).map(|(angle, near)| (angle - near).powi(2)).sum::<f64>()
    };
    // Both are equally far from 0 only in rare cases; then the plain one is preferred.
    if far(&other) + 1e-9 < far(&here) { other } else { here }
}

/// Returns the angles about two different axes whose product is nearest to `q`.
pub(super) fn two_angles(q: DQuat, [a, b]: [usize; 2]) -> [f64; 2] {
    let c = 3 - a - b;
    let m = DMat3::from_quat(q);
    let sign = parity([a, b, c]);
    [
        libm::atan2(sign * entry(&m, c, b), entry(&m, b, b)),
        libm::atan2(sign * entry(&m, a, c), entry(&m, a, a)),
    ]
}

/// Returns the angle about one axis that is nearest to `q`.
pub(super) fn one_angle(q: DQuat, index: usize) -> f64 {
    2.0 * libm::atan2(DVec3::new(q.x, q.y, q.z).dot(axis(index)), q.w)
}

/// Returns 1 for the axes X, Y, Z in cyclic order, -1 otherwise.
fn parity([a, b, _]: [usize; 3]) -> f64 {
    if (a + 1) % 3 == b { 1.0 } else { -1.0 }
}

/// Adds to every angle the full turns that bring it nearest to `near`.
pub(super) fn nearest<const N: usize>(angles: [f64; N], near: [f64; N]) -> [f64; N] {
    std::array::from_fn(|i| angles[i] + TAU * ((near[i] - angles[i]) / TAU).round())
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::f64::consts::{FRAC_PI_2, PI};

    const ORDERS: [[usize; 3]; 6] =
        [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]];

    proptest! {
        #[test]
        fn three_angles_compose_to_the_rotation(
            x in -1.0f64..1.0,
            y in -1.0f64..1.0,
            z in -1.0f64..1.0,
            w in -1.0f64..1.0,
            order in 0usize..6,
            near in -9.0f64..9.0,
        ) {
            let q = DQuat::from_xyzw(x, y, z, w);
            prop_assume!(q.length() > 0.1);
            let q = q * q.length().recip();
            let angles = three_angles(q, ORDERS[order], [near, 0.3, -near]);
            prop_assert!(distance(compose(&ORDERS[order], &angles), q) < 1e-12);
        }

        #[test]
        fn three_angles_in_gimbal_lock_lose_nothing(
            first in -4.0f64..4.0,
            last in -4.0f64..4.0,
            exponent in 0.0f64..18.0,
            order in 0usize..6,
            up: bool,
        ) {
            let middle = if up { FRAC_PI_2 } else { -FRAC_PI_2 } - 10f64.powf(-exponent);
            let q = compose(&ORDERS[order], &[first, middle, last]);
            let angles = three_angles(q, ORDERS[order], [0.1, 0.2, 0.3]);
            prop_assert!(distance(compose(&ORDERS[order], &angles), q) < 2e-7);
            // From the precision of clips.
            let q = precise(Quat::from_xyzw(q.x as f32, q.y as f32, q.z as f32, q.w as f32));
            let angles = three_angles(q, ORDERS[order], [0.0; 3]);
            prop_assert!(distance(compose(&ORDERS[order], &angles), q) < 2e-7);
        }

        #[test]
        fn three_angles_are_nearest_to_the_given(
            first in -9.0f64..9.0,
            middle in -1.5f64..4.6,
            last in -9.0f64..9.0,
            order in 0usize..6,
        ) {
            prop_assume!(
                (middle - FRAC_PI_2).abs() > 0.05
                    && (middle - 3.0 * FRAC_PI_2).abs() > 0.05
                    && (middle + FRAC_PI_2).abs() > 0.05
            );
            let angles = [first, middle, last];
            let found = three_angles(
                compose(&ORDERS[order], &angles),
                ORDERS[order],
                angles.map(|angle| angle + 0.01),
            );
            for (found, angle) in found.iter().zip(angles) {
                prop_assert!((found - angle).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn fewer_axes_give_the_nearest_rotation() {
        let q = compose(&[2, 0], &[0.7, -2.9]);
        let angles = two_angles(q, [2, 0]);
        assert!(distance(compose(&[2, 0], &angles), q) < 1e-12);
        assert!((one_angle(compose(&[1], &[PI - 0.1]), 1) - (PI - 0.1)).abs() < 1e-12);
        assert!(distance(compose(&[1], &[one_angle(q, 1)]), q) > 0.1);
    }
}
