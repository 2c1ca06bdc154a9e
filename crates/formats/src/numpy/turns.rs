//! Rotations as the arrays of motion data have them.

use super::array::View;
use crate::error::Fault;
use crate::warning::{Tally, WarningKind};
use glam::{Quat, Vec3};
use segue_motion::math::quat;

/// The greatest deviation of a vector of a rotation from unit length.
const MAX_DEVIATION: f32 = 0.25;
/// The greatest share of rotations beyond it; with more, the values are no rotations.
const MAX_SHARE_OFF: f64 = 0.1;
/// The least difference between the mean sizes of the first and the last component of quaternions
/// from which on the greater one is the scalar part.
const CLEAR_DIFFERENCE: f64 = 0.1;

/// The form of a rotation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Form {
    /// Axis times angle, radians.
    AxisAngle,
    /// A quaternion in either order.
    Quaternion,
    /// The first two columns of the matrix, or its first two rows (Zhou et al., "On the Continuity
    /// of Rotation Representations in Neural Networks", 2019, section 4.2).
    SixNumbers { rows: bool },
    /// A matrix, row by row.
    Matrix,
}

impl Form {
    /// Returns the number of values of a rotation.
    pub(super) const fn width(self) -> usize {
        match self {
            Self::AxisAngle => 3,
            Self::Quaternion => 4,
            Self::SixNumbers { .. } => 6,
            Self::Matrix => 9,
        }
    }
}

/// Returns the rotations of a view in the order of its indices.
///
/// # Errors
/// [`Fault`] when too many values are no rotations, as those of normalised data.
pub(super) fn read(view: &View<'_>, form: Form, tally: &mut Tally) -> Result<Vec<Quat>, Fault> {
    from_numbers(&view.numbers(tally)?, form, tally)
}

/// Returns the rotations of numbers that stand one after the other.
pub(super) fn from_numbers(
    values: &[f32],
    form: Form,
    tally: &mut Tally,
) -> Result<Vec<Quat>, Fault> {
    let rotations = values.chunks_exact(form.width());
    let (count, mut off) = (rotations.len(), 0_usize);
    let scalar_first = form == Form::Quaternion && scalar_is_first(values, tally);
    let mut turns = Vec::with_capacity(count);
    for v in rotations {
        let column = |i: usize| Vec3::new(v[i], v[i + 3], v[i + 6]);
        let (turn, length) = match form {
            Form::AxisAngle => (Quat::from_scaled_axis(Vec3::new(v[0], v[1], v[2])), 1.0),
            Form::Quaternion => {
                let q = if scalar_first {
                    Quat::from_xyzw(v[1], v[2], v[3], v[0])
                } else {
                    Quat::from_xyzw(v[0], v[1], v[2], v[3])
                };
                let length = q.length();
                let unit = q * length.recip();
                (if unit.is_finite() { unit } else { Quat::IDENTITY }, length)
            }
            Form::SixNumbers { rows } => {
                let (a, b) = (Vec3::new(v[0], v[1], v[2]), Vec3::new(v[3], v[4], v[5]));
                let q = from_two_columns(a, b);
                (if rows { q.conjugate() } else { q }, a.length())
            }
            Form::Matrix => (from_two_columns(column(0), column(1)), column(0).length()),
        };
        off += usize::from((length - 1.0).abs() > MAX_DEVIATION);
        // Rotations by more than a few turns are no numbers of a body.
        turns.push(if turn.is_finite() { quat::renormalize(turn) } else { Quat::IDENTITY });
    }
    if off as f64 > MAX_SHARE_OFF * count as f64 {
        return Err(normalised());
    }
    Ok(turns)
}

/// Returns the fault of values without their scale.
pub(super) fn normalised() -> Fault {
    Fault::new(0, "values that are no rotations: they look normalised", "rotations as they are")
        .with_hint("multiply by the standard deviation of the data set and add its mean")
}

/// Returns whether the scalar part comes first: it is large while joints turn by less than 90°.
fn scalar_is_first(values: &[f32], tally: &mut Tally) -> bool {
    let count = (values.len() / 4).max(1) as f64;
    let mean =
        |i: usize| values.chunks_exact(4).map(|q| f64::from(q[i].abs())).sum::<f64>() / count;
    let (first, last) = (mean(0), mean(3));
    if (first - last).abs() < CLEAR_DIFFERENCE {
        tally.add(WarningKind::UnclearQuaternions, None);
        return true;
    }
    first > last
}

/// Returns the rotation whose matrix has these first columns, made perpendicular and of unit
/// length. Identity where they do not span a plane.
fn from_two_columns(a: Vec3, b: Vec3) -> Quat {
    let Some(x) = a.try_normalize() else { return Quat::IDENTITY };
    let Some(y) = (b - x * x.dot(b)).try_normalize() else { return Quat::IDENTITY };
    Quat::from_mat3(&glam::Mat3::from_cols(x, y, x.cross(y)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Mat3;
    use segue_motion::math::quat::angle_between;

    fn some_turns() -> Vec<Quat> {
        (0..40).map(|i| Quat::from_scaled_axis(Vec3::new(0.03, -0.02, 0.05) * i as f32)).collect()
    }

    fn values(form: Form, q: Quat) -> Vec<f32> {
        let m = Mat3::from_quat(q);
        match form {
            Form::AxisAngle => q.to_scaled_axis().to_array().to_vec(),
            Form::Quaternion => vec![q.w, q.x, q.y, q.z],
            Form::SixNumbers { rows: false } => [m.x_axis, m.y_axis].map(|v| v.to_array()).concat(),
            Form::SixNumbers { rows: true } => [m.row(0), m.row(1)].map(|v| v.to_array()).concat(),
            Form::Matrix => [m.row(0), m.row(1), m.row(2)].map(|v| v.to_array()).concat(),
        }
    }

    #[test]
    fn turns_of_every_form_are_the_same() {
        for form in [
            Form::AxisAngle,
            Form::Quaternion,
            Form::SixNumbers { rows: false },
            Form::SixNumbers { rows: true },
            Form::Matrix,
        ] {
            let all: Vec<f32> = some_turns().into_iter().flat_map(|q| values(form, q)).collect();
            let mut tally = Tally::default();
            let read = from_numbers(&all, form, &mut tally).unwrap();
            for (q, read) in some_turns().into_iter().zip(read) {
                assert!(angle_between(q, read) < 1e-3, "{form:?}");
            }
            assert!(tally.into_warnings(b"").is_empty());
        }
    }

    #[test]
    fn quaternions_with_the_scalar_last_are_found() {
        let all: Vec<f32> = some_turns().into_iter().flat_map(|q| q.to_array()).collect();
        let read = from_numbers(&all, Form::Quaternion, &mut Tally::default()).unwrap();
        assert!(some_turns().iter().zip(read).all(|(q, read)| angle_between(*q, read) < 1e-3));
        // Half a turn about X: nothing says which one is the scalar.
        let mut tally = Tally::default();
        from_numbers(&[0.6, 0.5, 0.2, 0.6], Form::Quaternion, &mut tally).unwrap();
        assert_eq!(tally.into_warnings(b"")[0].kind, WarningKind::UnclearQuaternions);
    }

    #[test]
    fn values_that_are_normalised_are_refused() {
        let values: Vec<f32> = (0..600).map(|i| 3.0 * (i as f32).sin()).collect();
        for form in [Form::Quaternion, Form::SixNumbers { rows: true }, Form::Matrix] {
            let fault = from_numbers(&values, form, &mut Tally::default()).unwrap_err();
            assert!(fault.found.to_string().contains("normalised"), "{form:?}");
        }
    }
}
