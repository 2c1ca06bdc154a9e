//! Rotations from turns about axes: those of a whole row at once, so that the compiler makes vectors of them.

use glam::Quat;

/// Joints in a row that turn about the same axes.
#[derive(Debug)]
struct Run {
    joints: usize,
    /// The axes (0 to 2) of the turns of each, in order.
    axes: Vec<usize>,
}

/// What turns the joints of a character, and room for one row of it.
#[derive(Debug, Default)]
pub(super) struct Turns {
    runs: Vec<Run>,
    /// The columns of the angles: run by run, and in each the first turns of all joints, then the second ones, and so on.
    columns: Vec<usize>,
    /// The angles of the row.
    degrees: Vec<f64>,
    half_angles: HalfAngles,
    product: Product,
}

impl Turns {
    /// Of the turns of each joint: axis and column, in order.
    pub(super) fn new(joints: &[Vec<(usize, usize)>]) -> Self {
        let alike = |a: &Vec<(usize, usize)>, b: &Vec<(usize, usize)>| a.iter().map(|turn| turn.0).eq(b.iter().map(|turn| turn.0));
        let mut turns = Self::default();
        for run in joints.chunk_by(alike) {
            let axes: Vec<usize> = run.iter().take(1).flatten().map(|turn| turn.0).collect();
            for place in 0..axes.len() {
                turns.columns.extend(run.iter().filter_map(|joint| Some(joint.get(place)?.1)));
            }
            turns.runs.push(Run { joints: run.len(), axes });
        }
        turns
    }

    /// Appends the rotation of each joint in a row of values, degrees: the product `R₀ · R₁ · …` of its turns.
    pub(super) fn rotations_into(&mut self, row: &[f64], rotations: &mut Vec<Quat>) {
        self.degrees.clear();
        self.degrees
            .extend(self.columns.iter().map(|&column| row.get(column).copied().unwrap_or_default()));
        self.half_angles.set(&mut self.degrees);
        let (mut sines, mut cosines) = (self.half_angles.sines.as_slice(), self.half_angles.cosines.as_slice());
        for run in &self.runs {
            self.product.start(run.joints);
            for (place, &axis) in run.axes.iter().enumerate() {
                let (Some((s, later_sines)), Some((c, later_cosines))) =
                    (sines.split_at_checked(run.joints), cosines.split_at_checked(run.joints))
                else {
                    break;
                };
                if place == 0 {
                    self.product.set(axis, s, c);
                } else {
                    self.product.turn(axis, s, c);
                }
                (sines, cosines) = (later_sines, later_cosines);
            }
            self.product.append_to(rotations);
        }
    }
}

/// Sines and cosines of half of angles.
#[derive(Debug, Default)]
struct HalfAngles {
    /// What is left of the half angles without whole quarter turns, radians.
    rests: Vec<f32>,
    /// Those quarter turns; whole turns may be missing.
    quarters: Vec<u32>,
    sines: Vec<f32>,
    cosines: Vec<f32>,
}

impl HalfAngles {
    /// Takes angles, degrees. Sines and cosines are within 1e-7 of what they should be, which is what `f32` can tell apart.
    fn set(&mut self, degrees: &mut [f64]) {
        // Far beyond what turns, the whole turns go first, at the cost of a division.
        if !degrees.iter().fold(true, |small, angle| small & (angle.abs() < 1e9)) {
            for angle in degrees.iter_mut() {
                *angle %= 720.0;
            }
        }
        self.rests.resize(degrees.len(), 0.0);
        self.quarters.resize(degrees.len(), 0);
        for ((&degrees, rest), quarter) in degrees.iter().zip(&mut self.rests).zip(&mut self.quarters) {
            (*rest, *quarter) = reduced(degrees);
        }
        self.sines.resize(degrees.len(), 0.0);
        self.cosines.resize(degrees.len(), 0.0);
        let reduced = self.rests.iter().zip(&self.quarters);
        for ((sin, cos), (&rest, &quarter)) in self.sines.iter_mut().zip(&mut self.cosines).zip(reduced) {
            (*sin, *cos) = sin_cos(rest, quarter);
        }
    }
}

/// Half an angle below 1e9 degrees as the nearest number of quarter turns, and a rest of at most π/4.
#[inline]
fn reduced(degrees: f64) -> (f32, u32) {
    // Adding this rounds to a whole number and leaves it in the lowest bits, for magnitudes below 2⁵¹.
    const ROUND: f64 = 6_755_399_441_055_744.0;
    let quarters = degrees * (1.0 / 180.0);
    let rounded = quarters + ROUND;
    let rest = (quarters - (rounded - ROUND)) * std::f64::consts::FRAC_PI_2;
    (rest as f32, rounded.to_bits() as u32)
}

/// Sine and cosine of a rest and quarter turns.
#[inline]
fn sin_cos(x: f32, quarter: u32) -> (f32, f32) {
    let x2 = x * x;
    // The Taylor series; the first terms left out are below 2e-9 at π/4.
    let sin = x + x * (x2 * (-1.0 / 6.0 + x2 * (1.0 / 120.0 + x2 * (-1.0 / 5040.0 + x2 * (1.0 / 362_880.0)))));
    let cos = 1.0 + x2 * (-0.5 + x2 * (1.0 / 24.0 + x2 * (-1.0 / 720.0 + x2 * (1.0 / 40_320.0 + x2 * (-1.0 / 3_628_800.0)))));
    // Every quarter turn makes (sin, cos) into (cos, -sin): an odd one swaps them, the signs go by the second bit.
    let different = (sin.to_bits() ^ cos.to_bits()) & (quarter & 1).wrapping_neg();
    let minus = |quarter: u32| (quarter & 2) << 30;
    (
        f32::from_bits(sin.to_bits() ^ different ^ minus(quarter)),
        f32::from_bits(cos.to_bits() ^ different ^ minus(quarter.wrapping_add(1))),
    )
}

/// Quaternions that grow turn by turn, each coordinate on its own.
#[derive(Debug, Default)]
struct Product {
    /// The coordinates x, y and z.
    axes: [Vec<f32>; 3],
    w: Vec<f32>,
}

impl Product {
    /// So many that do not turn.
    fn start(&mut self, joints: usize) {
        for axis in &mut self.axes {
            axis.clear();
            axis.resize(joints, 0.0);
        }
        self.w.clear();
        self.w.resize(joints, 1.0);
    }

    /// The first turn. What comes of it has one axis.
    fn set(&mut self, axis: usize, sines: &[f32], cosines: &[f32]) {
        if let Some(values) = self.axes.get_mut(axis) {
            values.copy_from_slice(sines);
        }
        self.w.copy_from_slice(cosines);
    }

    /// One more turn, given sine and cosine of half the angles.
    fn turn(&mut self, axis: usize, sines: &[f32], cosines: &[f32]) {
        let [x, y, z] = &mut self.axes;
        // The next axis and the one after it, in a circle.
        let (along, next, after) = match axis {
            0 => (x, y, z),
            1 => (y, z, x),
            _ => (z, x, y),
        };
        turn_about(along, next, after, &mut self.w, sines, cosines);
    }

    fn append_to(&self, rotations: &mut Vec<Quat>) {
        let [x, y, z] = &self.axes;
        let coordinates = x.iter().zip(y).zip(z).zip(&self.w);
        rotations.extend(coordinates.map(|(((&x, &y), &z), &w)| Quat::from_xyzw(x, y, z, w)));
    }
}

/// Quaternions times turns about the axis of their coordinate `along`.
fn turn_about(along: &mut [f32], next: &mut [f32], after: &mut [f32], w: &mut [f32], sines: &[f32], cosines: &[f32]) {
    let turns = sines.iter().zip(cosines);
    for ((((along, next), after), w), (s, c)) in along.iter_mut().zip(next).zip(after).zip(w).zip(turns) {
        (*along, *w) = (*along * c + *w * s, *w * c - *along * s);
        (*next, *after) = (*next * c + *after * s, *after * c - *next * s);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DQuat, DVec3};
    use proptest::prelude::*;

    #[test]
    fn the_fast_sine_is_the_sine() {
        let mut half = HalfAngles::default();
        let degrees: Vec<f64> = (-80_000..80_000).map(|step| f64::from(step) * 0.037_1).collect();
        half.set(&mut degrees.clone());
        for (degrees, (&sin, &cos)) in degrees.iter().zip(half.sines.iter().zip(&half.cosines)) {
            let (expected_sin, expected_cos) = (0.5 * degrees.to_radians()).sin_cos();
            let error = (f64::from(sin) - expected_sin).abs().max((f64::from(cos) - expected_cos).abs());
            assert!(error < 1e-7, "{degrees}: {error}");
        }
    }

    #[test]
    fn whole_turns_of_huge_angles_go_first() {
        let joints = [[(0, 0)], [(1, 1)], [(1, 3)]].map(Vec::from);
        let mut rotations = vec![];
        Turns::new(&joints).rotations_into(&[1e30, -7.2e12 - 90.0, 77.0, 90.0], &mut rotations);
        assert!((rotations[0].length() - 1.0).abs() < 1e-6);
        assert!((rotations[2] - Quat::from_rotation_y(std::f32::consts::FRAC_PI_2)).length() < 1e-6);
        assert!((rotations[1] * rotations[2] - Quat::IDENTITY).length() < 1e-6);
    }

    proptest! {
        #[test]
        fn turns_multiply_in_their_order(
            kinds in prop::collection::vec((prop::collection::vec(0..3_usize, 0..7), 1..6_usize), 0..5),
            angles in prop::collection::vec(-1e4..1e4, 1..200),
        ) {
            // Any columns, in any order.
            let mut column = 0;
            let mut next = || { column += 31; column % angles.len() };
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
                let turn = |&(axis, column): &(usize, usize)| DQuat::from_axis_angle(DVec3::AXES[axis], angles[column].to_radians());
                let expected = joint.iter().map(turn).fold(DQuat::IDENTITY, |q, turn| q * turn);
                prop_assert!((*found - expected.as_quat()).length() < 1.5e-7 * (1.0 + joint.len() as f32));
            }
        }
    }
}
