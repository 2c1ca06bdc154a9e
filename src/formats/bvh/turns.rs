//! Rotations from turns about axes, a row at a time.

use glam::Quat;
use std::f64::consts::FRAC_PI_2;

/// Sines and cosines of half of the angles of a row.
#[derive(Debug, Default)]
pub(super) struct HalfAngles {
    degrees: Vec<f64>,
    sines: Vec<f64>,
    cosines: Vec<f64>,
}

impl HalfAngles {
    /// Takes the angles of a row, degrees.
    pub(super) fn set(&mut self, degrees: impl Iterator<Item = f64>) {
        self.degrees.clear();
        self.degrees.extend(degrees);
        // Far beyond what turns, the whole turns go first, at the cost of a division.
        if !self.degrees.iter().fold(true, |small, angle| small & (angle.abs() < 1e9)) {
            self.degrees.iter_mut().for_each(|angle| *angle %= 720.0);
        }
        self.sines.resize(self.degrees.len(), 0.0);
        self.cosines.resize(self.degrees.len(), 0.0);
        for ((&degrees, sin), cos) in self.degrees.iter().zip(&mut self.sines).zip(&mut self.cosines) {
            (*sin, *cos) = half_angle_sin_cos(degrees);
        }
    }

    /// The product of the turns from the angle `first` on, one for each of `axes` (0 to 2), in that order: `R₀ · R₁ · …`.
    pub(super) fn product(&self, first: usize, axes: &[usize]) -> Quat {
        let end = first + axes.len();
        let (Some(s), Some(c)) = (self.sines.get(first..end), self.cosines.get(first..end)) else {
            return Quat::IDENTITY;
        };
        let q = match (axes, s, c) {
            (&[a, b, c], &[sa, sb, sc], &[ca, cb, cc]) => {
                let (s, cos) = ([sa, sb, sc], [ca, cb, cc]);
                match (a, b, c) {
                    (0, 1, 2) => three::<0, 1, 2>(s, cos),
                    (0, 2, 1) => three::<0, 2, 1>(s, cos),
                    (1, 0, 2) => three::<1, 0, 2>(s, cos),
                    (1, 2, 0) => three::<1, 2, 0>(s, cos),
                    (2, 0, 1) => three::<2, 0, 1>(s, cos),
                    (2, 1, 0) => three::<2, 1, 0>(s, cos),
                    _ => any(axes, &s, &cos),
                }
            }
            _ => any(axes, s, c),
        };
        let [x, y, z, w] = q.map(|value| value as f32);
        Quat::from_xyzw(x, y, z, w)
    }
}

/// Turns about any axes, one after the other.
fn any(axes: &[usize], sines: &[f64], cosines: &[f64]) -> [f64; 4] {
    let turns = axes.iter().zip(sines.iter().zip(cosines));
    turns.fold([0.0, 0.0, 0.0, 1.0], |q, (&axis, (&s, &c))| turned(q, axis, s, c))
}

/// Turns about three different axes. The first two multiply to four products, since each has one axis.
#[inline]
fn three<const A: usize, const B: usize, const C: usize>([sa, sb, sc]: [f64; 3], [ca, cb, cc]: [f64; 3]) -> [f64; 4] {
    let sign = if (A + 1) % 3 == B { 1.0 } else { -1.0 };
    let mut q = [0.0; 4];
    q[A] = sa * cb;
    q[B] = ca * sb;
    q[C] = sign * sa * sb;
    q[3] = ca * cb;
    turned(q, C, sc, cc)
}

/// `q` (x, y, z, w) times a turn about one axis, given sine and cosine of half the angle.
#[inline]
fn turned([x, y, z, w]: [f64; 4], axis: usize, s: f64, c: f64) -> [f64; 4] {
    match axis {
        0 => [x * c + w * s, y * c + z * s, z * c - y * s, w * c - x * s],
        1 => [x * c - z * s, y * c + w * s, z * c + x * s, w * c - y * s],
        _ => [x * c + y * s, y * c - x * s, z * c + w * s, w * c - z * s],
    }
}

/// Sine and cosine of half an angle below 1e9 degrees, to 2e-9: a thirtieth of what rounding to `f32` changes. Without branches, so that the
/// compiler makes vectors of it.
#[inline]
fn half_angle_sin_cos(degrees: f64) -> (f64, f64) {
    // Adding this rounds to a whole number and leaves it in the lowest bits, for magnitudes below 2⁵¹.
    const ROUND: f64 = 6_755_399_441_055_744.0;
    // The half angle in quarter turns: the nearest whole number of them, and a rest of at most π/4.
    let quarters = degrees * (1.0 / 180.0);
    let rounded = quarters + ROUND;
    let x = (quarters - (rounded - ROUND)) * FRAC_PI_2;
    let x2 = x * x;
    // The Taylor series; the first terms left out are below 2e-9 at π/4.
    let sin = x * (1.0 + x2 * (-1.0 / 6.0 + x2 * (1.0 / 120.0 + x2 * (-1.0 / 5040.0 + x2 * (1.0 / 362_880.0)))));
    let cos = 1.0 + x2 * (-0.5 + x2 * (1.0 / 24.0 + x2 * (-1.0 / 720.0 + x2 * (1.0 / 40_320.0 + x2 * (-1.0 / 3_628_800.0)))));
    // Every quarter turn makes (sin, cos) into (cos, -sin): an odd one swaps them, the signs go by the second bit.
    let quarter = rounded.to_bits();
    let different = (sin.to_bits() ^ cos.to_bits()) & (quarter & 1).wrapping_neg();
    let minus = |quarter: u64| (quarter & 2) << 62;
    (
        f64::from_bits(sin.to_bits() ^ different ^ minus(quarter)),
        f64::from_bits(cos.to_bits() ^ different ^ minus(quarter + 1)),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DQuat;
    use proptest::prelude::*;

    #[test]
    fn the_fast_sine_is_the_sine() {
        let mut half = HalfAngles::default();
        let degrees: Vec<f64> = (-80_000..80_000).map(|step| f64::from(step) * 0.037_1).collect();
        half.set(degrees.iter().copied());
        for (degrees, (sin, cos)) in degrees.iter().zip(half.sines.iter().zip(&half.cosines)) {
            let (expected_sin, expected_cos) = (0.5 * degrees.to_radians()).sin_cos();
            assert!((sin - expected_sin).abs() < 2e-9 && (cos - expected_cos).abs() < 2e-9, "{degrees}");
        }
    }

    #[test]
    fn whole_turns_of_huge_angles_go_first() {
        let mut half = HalfAngles::default();
        half.set([1e9, -7.2e12 - 90.0, 1e30, 90.0].into_iter());
        for (sin, cos) in half.sines.iter().zip(&half.cosines) {
            assert!((sin * sin + cos * cos - 1.0).abs() < 1e-8);
        }
        let [quarter, back] = [half.product(3, &[1]), half.product(1, &[1])];
        assert!((quarter - Quat::from_rotation_y(std::f32::consts::FRAC_PI_2)).length() < 1e-6);
        assert!((back * quarter - Quat::IDENTITY).length() < 1e-6);
    }

    proptest! {
        #[test]
        fn turns_multiply_in_their_order(turns in prop::collection::vec((0..3_usize, -1e4..1e4), 0..6), skip in 0..4_usize) {
            let mut half = HalfAngles::default();
            half.set(std::iter::repeat_n(77.0, skip).chain(turns.iter().map(|turn| turn.1)));
            let axes: Vec<usize> = turns.iter().map(|turn| turn.0).collect();
            let expected = turns.iter().fold(DQuat::IDENTITY, |q, &(axis, degrees)| {
                q * DQuat::from_axis_angle(glam::DVec3::AXES[axis], degrees.to_radians())
            });
            let found = half.product(skip, &axes);
            prop_assert!((found - expected.as_quat()).length() < 1e-7);
        }
    }
}
