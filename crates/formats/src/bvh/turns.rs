//! Rotations from angles about axes, for four joints at once.

use crate::raw::WildAngles;
use glam::{Mat4, Quat, Vec4};

/// The number of joints that are computed at once: the lanes of [`Vec4`].
const LANES: usize = 4;

/// A receiver of the rotations of a row, joint by joint.
pub(super) trait Rotations {
    /// Takes those of four joints.
    fn four(&mut self, four: [Quat; LANES]);

    /// Takes the first `count` of four.
    fn fewer(&mut self, four: [Quat; LANES], count: usize);
}

impl Rotations for Vec<Quat> {
    fn four(&mut self, four: [Quat; LANES]) {
        self.extend_from_slice(&four);
    }

    fn fewer(&mut self, four: [Quat; LANES], count: usize) {
        self.extend(four.into_iter().take(count));
    }
}

/// A place for a row, of which each call takes the beginning.
#[cfg(feature = "parallel")]
impl Rotations for &mut [Quat] {
    fn four(&mut self, four: [Quat; LANES]) {
        if let Some(first) = self.split_off_mut(..LANES) {
            first.copy_from_slice(&four);
        }
    }

    fn fewer(&mut self, four: [Quat; LANES], count: usize) {
        let first = self.split_off_mut(..count).unwrap_or_default();
        first.iter_mut().zip(four).for_each(|(place, rotation)| *place = rotation);
    }
}

/// Consecutive joints with the same rotation axes.
#[cfg_attr(feature = "parallel", derive(Clone))]
#[derive(Debug)]
struct Run {
    joints: usize,
    /// The axes (0 to 2) of the rotations of each joint, in order.
    axes: Vec<usize>,
}

/// The rotation channels of a character, with buffers for one row.
#[cfg_attr(feature = "parallel", derive(Clone))]
#[derive(Debug, Default)]
pub(super) struct Turns {
    runs: Vec<Run>,
    /// The columns of the angles: run by run, within a run four joints at a time, and of these for
    /// each rotation in order the columns of the four. If there are fewer than four joints, the
    /// last one is repeated.
    columns: Vec<[usize; LANES]>,
    /// The angles of the row, in the order of `columns`.
    half_angles: Vec<HalfAngles>,
}

impl Turns {
    /// Returns the rotation channels, given axis and column of each joint's rotations in order.
    pub(super) fn new(joints: &[Vec<(usize, usize)>]) -> Self {
        let alike = |a: &Vec<(usize, usize)>, b: &Vec<(usize, usize)>| {
            a.iter().map(|turn| turn.0).eq(b.iter().map(|turn| turn.0))
        };
        let mut turns = Self::default();
        for run in joints.chunk_by(alike) {
            let axes: Vec<usize> = run.iter().take(1).flatten().map(|turn| turn.0).collect();
            for four in run.chunks(LANES) {
                let column = |lane: usize, place: usize| {
                    Some(four.get(lane.min(four.len() - 1))?.get(place)?.1)
                };
                let columns = (0..axes.len()).map(|place| {
                    std::array::from_fn(|lane| column(lane, place).unwrap_or_default())
                });
                turns.columns.extend(columns);
            }
            turns.runs.push(Run { joints: run.len(), axes });
        }
        turns.half_angles.resize(turns.columns.len(), HalfAngles::default());
        turns
    }

    /// Appends the rotation of each joint in a row of values, degrees: the product `R₀ · R₁ · …` of
    /// its rotations. Returns whether some value may be larger than an angle is likely to be.
    // Not inlined, and small: browsers optimise a function only between calls, and small ones
    // sooner.
    #[inline(never)]
    pub(super) fn rotations_into(&mut self, row: &[f64], rotations: &mut impl Rotations) -> bool {
        let is_likely = row.iter().all(|angle| angle.abs() <= WildAngles::LIKELY_DEGREES);
        let reduced;
        let row = if is_likely || row.iter().all(|angle| angle.abs() < 1e9) {
            row
        } else {
            reduced = without_whole_turns(row);
            &reduced
        };
        // Separate from the use of the angles, so that the compiler vectorises it.
        for (half_angles, columns) in self.half_angles.iter_mut().zip(&self.columns) {
            half_angles.set(columns.map(|column| row.get(column).copied().unwrap_or_default()));
        }
        let mut half_angles = self.half_angles.iter();
        for run in &self.runs {
            let mut left = run.joints;
            while left > 0 {
                let turns = run.axes.iter().zip(half_angles.by_ref());
                let product = turns.fold(Product::IDENTITY, |product, (&axis, angles)| {
                    product.turned(axis, angles.sines_and_cosines())
                });
                let four = product.rotations();
                if left >= LANES {
                    rotations.four(four);
                } else {
                    rotations.fewer(four, left);
                }
                left = left.saturating_sub(LANES);
            }
        }
        !is_likely
    }

    /// Returns the largest angle of a row, degrees.
    #[cold]
    pub(super) fn largest(&self, row: &[f64]) -> f64 {
        let columns = self.columns.iter().flatten();
        columns.filter_map(|column| row.get(*column)).fold(0.0, |most, angle| most.max(angle.abs()))
    }
}

/// Removes whole turns from angles that are too large for [`HalfAngles::set`], at the cost of a
/// division.
#[cold]
fn without_whole_turns(row: &[f64]) -> Vec<f64> {
    row.iter().map(|degrees| degrees % 720.0).collect()
}

/// Four half angles.
#[derive(Clone, Copy, Debug, Default)]
struct HalfAngles {
    /// The nearest integers of quarter turns.
    quarters: [f32; LANES],
    /// The half angles without these quarter turns: at most π/4, radians.
    rests: [f32; LANES],
}

impl HalfAngles {
    /// Sets four angles below 1e9, degrees.
    #[inline]
    fn set(&mut self, degrees: [f64; LANES]) {
        // Adding this rounds to an integer in double precision, for magnitudes below 2⁵¹.
        const ROUND: f64 = 6_755_399_441_055_744.0;
        let Self { quarters, rests } = self;
        for ((quarters, rest), degrees) in quarters.iter_mut().zip(rests).zip(degrees) {
            let turns = degrees * (1.0 / 180.0);
            let whole = (turns + ROUND) - ROUND;
            *quarters = whole as f32;
            *rest = ((turns - whole) * std::f64::consts::FRAC_PI_2) as f32;
        }
    }

    /// Returns sines and cosines, to within 1e-7, the precision of `f32`.
    #[inline]
    fn sines_and_cosines(&self) -> (Vec4, Vec4) {
        // Adding this rounds to an integer in single precision, for magnitudes below 2²².
        const ROUND: Vec4 = Vec4::splat(12_582_912.0);
        let (x, quarters) = (Vec4::from_array(self.rests), Vec4::from_array(self.quarters));
        let x2 = x * x;
        // The Taylor series; the first omitted terms are below 2e-9 at π/4.
        let sin = x + x
            * (x2
                * (-1.0 / 6.0
                    + x2 * (1.0 / 120.0 + x2 * (-1.0 / 5040.0 + x2 * (1.0 / 362_880.0)))));
        let cos = 1.0
            + x2 * (-0.5
                + x2 * (1.0 / 24.0
                    + x2 * (-1.0 / 720.0 + x2 * (1.0 / 40_320.0 + x2 * (-1.0 / 3_628_800.0)))));
        // The remaining -2 to 2 quarter turns have integer sines and cosines, so the addition
        // theorem is exact.
        let quarters = quarters - 4.0 * ((quarters * 0.25 + ROUND) - ROUND);
        let (whole_sin, whole_cos) = (quarters * (2.0 - quarters.abs()), 1.0 - quarters.abs());
        (sin * whole_cos + cos * whole_sin, cos * whole_cos - sin * whole_sin)
    }
}

/// Products of rotations as quaternions, by component.
struct Product {
    x: Vec4,
    y: Vec4,
    z: Vec4,
    w: Vec4,
}

impl Product {
    const IDENTITY: Self = Self { x: Vec4::ZERO, y: Vec4::ZERO, z: Vec4::ZERO, w: Vec4::ONE };

    /// Multiplies by rotations about an axis, given the sines and cosines of the half angles.
    #[inline]
    fn turned(self, axis: usize, (s, c): (Vec4, Vec4)) -> Self {
        let Self { x, y, z, w } = self;
        // The axis and the two after it, in cyclic order.
        let turned = |[along, next, after]: [Vec4; 3]| {
            let turned = [along * c + w * s, next * c + after * s, after * c - next * s];
            (turned, w * c - along * s)
        };
        match axis {
            0 => {
                let ([x, y, z], w) = turned([x, y, z]);
                Self { x, y, z, w }
            }
            1 => {
                let ([y, z, x], w) = turned([y, z, x]);
                Self { x, y, z, w }
            }
            _ => {
                let ([z, x, y], w) = turned([z, x, y]);
                Self { x, y, z, w }
            }
        }
    }

    fn rotations(self) -> [Quat; LANES] {
        let Mat4 { x_axis, y_axis, z_axis, w_axis } =
            Mat4::from_cols(self.x, self.y, self.z, self.w).transpose();
        [x_axis, y_axis, z_axis, w_axis].map(Quat::from_vec4)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DQuat, DVec3};
    use proptest::prelude::*;

    #[test]
    fn sines_and_cosines_are_accurate() {
        for degrees in (-80_000..80_000).map(|step| f64::from(step) * 0.037_1) {
            let mut half_angles = HalfAngles::default();
            half_angles.set([degrees; LANES]);
            let (sin, cos) = half_angles.sines_and_cosines();
            assert!(sin == Vec4::splat(sin.x) && cos == Vec4::splat(cos.x));
            let (sin, cos) = (sin.x, cos.x);
            let (expected_sin, expected_cos) = (0.5 * degrees.to_radians()).sin_cos();
            let error =
                (f64::from(sin) - expected_sin).abs().max((f64::from(cos) - expected_cos).abs());
            assert!(error < 1e-7, "{degrees}: {error}");
        }
    }

    #[test]
    fn without_whole_turns_keeps_huge_angles_accurate() {
        let joints = [[(0, 0)], [(1, 1)], [(1, 3)]].map(Vec::from);
        let mut rotations = vec![];
        Turns::new(&joints).rotations_into(&[1e30, -7.2e12 - 90.0, 77.0, 90.0], &mut rotations);
        assert!((rotations[0].length() - 1.0).abs() < 1e-6);
        assert!(
            (rotations[2] - Quat::from_rotation_y(std::f32::consts::FRAC_PI_2)).length() < 1e-6
        );
        assert!((rotations[1] * rotations[2] - Quat::IDENTITY).length() < 1e-6);
    }

    proptest! {
        #[test]
        fn rotations_into_multiplies_in_order(
            kinds in
                prop::collection::vec((prop::collection::vec(0..3_usize, 0..7), 1..6_usize), 0..5),
            angles in prop::collection::vec(-1e4..1e4, 1..200),
        ) {
            // Columns in an arbitrary order.
            let mut column = 0;
            let mut next = || {
                column += 31;
                column % angles.len()
            };
            let joints: Vec<Vec<(usize, usize)>> = kinds
                .iter()
                .flat_map(|(axes, times)| std::iter::repeat_n(axes, *times))
                .map(|axes| axes.iter().map(|&axis| (axis, next())).collect())
                .collect();
            let mut turns = Turns::new(&joints);
            let mut found = vec![];
            turns.rotations_into(&angles, &mut found);
            turns.rotations_into(&angles, &mut found);
            prop_assert_eq!(found.len(), 2 * joints.len());
            for (found, joint) in found.iter().zip(joints.iter().cycle()) {
                let turn = |&(axis, column): &(usize, usize)| {
                    DQuat::from_axis_angle(DVec3::AXES[axis], angles[column].to_radians())
                };
                let expected = joint.iter().map(turn).fold(DQuat::IDENTITY, |q, turn| q * turn);
                prop_assert!(
                    (*found - expected.as_quat()).length() < 1.5e-7 * (1.0 + joint.len() as f32)
                );
            }
        }
    }
}
