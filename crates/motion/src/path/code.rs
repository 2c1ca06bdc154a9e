//! The compact text form of paths, for links.

use super::spline::{MAX_POINTS, uniform_knots};
use super::{GroundSpline, PathEditError, SplineEnds};
use base64::Engine as _;
use base64::engine::general_purpose::URL_SAFE_NO_PAD;
use glam::{DVec2, I64Vec2};
use std::ops::Range;

/// Unit of encoded points, metres.
const UNIT_M: f64 = 0.01;
/// Unit of encoded knots.
const KNOT_UNIT: f64 = 1.0 / 1_048_576.0;
const CLOSED: u64 = 1;
const KNOTS: u64 = 2;
const UNCLAMPED: u64 = 4;

impl GroundSpline {
    /// Encodes the path as a short text for links, of letters, digits, `-` and `_`: control points
    /// to 1 cm, about three characters per point and coordinate.
    ///
    /// The text is base64 of variable-length integers of seven bits to a byte: flags for a closed
    /// path, for knots of its own and for an unclamped path, the number of points, the differences
    /// of their coordinates, and the differences of the inner knots where they are not uniform. The
    /// ends of a closed path follow from its other points and are left out.
    #[must_use]
    pub fn to_code(&self) -> String {
        let uniform = self.inner_knots() == uniform_knots(self.points().len());
        let mut bytes = Vec::new();
        let unclamped = self.ends() == SplineEnds::Uniform;
        let flags = u64::from(self.is_closed()) * CLOSED
            + u64::from(!uniform) * KNOTS
            + u64::from(unclamped) * UNCLAMPED;
        write(&mut bytes, flags);
        write(&mut bytes, self.points().len() as u64);
        let mut before = I64Vec2::ZERO;
        for point in &self.points()[own_points(self.points().len(), self.is_closed())] {
            let here = (*point / UNIT_M).round().as_i64vec2();
            let step = here - before;
            before = here;
            for value in [step.x, step.y] {
                // The sign is stored in the lowest bit.
                write(&mut bytes, ((value << 1) ^ (value >> 63)) as u64);
            }
        }
        if !uniform {
            let mut before = 0;
            for knot in self.inner_knots() {
                let here = (knot / KNOT_UNIT).round() as u64;
                write(&mut bytes, here.saturating_sub(before));
                before = here;
            }
        }
        URL_SAFE_NO_PAD.encode(bytes)
    }

    /// Decodes a path from [`Self::to_code`].
    ///
    /// # Errors
    /// [`PathEditError::Code`] for an invalid text, and the errors of [`GroundSpline::with_knots`].
    pub fn from_code(code: &str) -> Result<Self, PathEditError> {
        // Two integers of at most ten bytes per point are far less.
        let bytes = (code.len() <= MAX_POINTS * 40)
            .then(|| URL_SAFE_NO_PAD.decode(code).ok())
            .flatten()
            .ok_or(PathEditError::Code)?;
        let mut bytes = bytes.into_iter();
        let mut next = || read(&mut bytes);
        let (flags, count) = (next()?, next()?);
        super::spline::check_count(usize::try_from(count).unwrap_or(usize::MAX))?;
        let count = count as usize;
        let (closed, unclamped) = (flags & CLOSED != 0, flags & UNCLAMPED != 0);
        if flags > CLOSED | KNOTS | UNCLAMPED || (closed && unclamped) {
            return Err(PathEditError::Code);
        }
        let mut points = vec![DVec2::ZERO; count];
        let mut here = [0i64; 2];
        let own = own_points(count, closed);
        for (index, point) in points[own].iter_mut().enumerate() {
            for value in &mut here {
                let word = next()?;
                let step = (word >> 1) as i64 ^ -((word & 1) as i64);
                *value = value.checked_add(step).ok_or(PathEditError::Point { index })?;
            }
            *point = DVec2::new(here[0] as f64, here[1] as f64) * UNIT_M;
        }
        let knots = if flags & KNOTS == 0 {
            uniform_knots(count)
        } else {
            let mut knots = Vec::with_capacity(count);
            let mut knot = 0u64;
            for _ in 4..count {
                knot = knot.checked_add(next()?).ok_or(PathEditError::Knots)?;
                knots.push(knot as f64 * KNOT_UNIT);
            }
            knots
        };
        let spline = if unclamped {
            Self::unclamped(points, &knots)?
        } else {
            Self::with_knots(points, &knots)?
        };
        if bytes.next().is_some() {
            return Err(PathEditError::Code);
        }
        Ok(if closed { spline.joined() } else { spline })
    }

    /// Returns the path rounded to what its text form can hold.
    ///
    /// # Errors
    /// [`PathEditError::Knots`] where knots come too close to each other.
    pub fn rounded(&self) -> Result<Self, PathEditError> {
        Self::from_code(&self.to_code())
    }
}

/// Returns the range of the points that are encoded.
fn own_points(count: usize, closed: bool) -> Range<usize> {
    let ends = usize::from(closed);
    ends..count - ends
}

fn write(bytes: &mut Vec<u8>, mut value: u64) {
    while value >= 0x80 {
        bytes.push(value as u8 | 0x80);
        value >>= 7;
    }
    bytes.push(value as u8);
}

fn read(bytes: &mut impl Iterator<Item = u8>) -> Result<u64, PathEditError> {
    let mut value = 0u64;
    for shift in (0..64).step_by(7) {
        let byte = bytes.next().ok_or(PathEditError::Code)?;
        value |= u64::from(byte & 0x7f) << shift;
        if byte < 0x80 {
            return Ok(value);
        }
    }
    Err(PathEditError::Code)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::path::MAX_DISTANCE_M;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        #[test]
        fn code_of_a_path_decodes_to_the_centimetre(
            way in prop::collection::vec((-50.0f64..50.0, -50.0f64..50.0), 6..20),
            at in 0.01f64..0.99,
            closed: bool,
        ) {
            let mut path =
                GroundSpline::uniform(way.into_iter().map(DVec2::from).collect()).unwrap();
            if closed {
                path = path.joined();
            }
            let refined = path.refined(at).unwrap_or_else(|_| path.clone());
            let unclamped = [&path, &refined].map(|path| path.with_ends(SplineEnds::Uniform));
            for path in [path, refined].into_iter().chain(unclamped) {
                let back = GroundSpline::from_code(&path.to_code()).unwrap();
                let own = own_points(path.points().len(), path.is_closed());
                for (a, b) in path.points()[own.clone()].iter().zip(&back.points()[own]) {
                    prop_assert!((*a - *b).abs().max_element() < 0.011, "{a} {b}");
                }
                prop_assert_eq!(back.is_closed(), path.is_closed());
                prop_assert_eq!(back.points().len(), path.points().len());
                // The encoding of a decoded path is the same.
                prop_assert_eq!(back.to_code(), path.to_code());
                prop_assert_eq!(back.rounded().unwrap(), back);
            }
        }

        #[test]
        fn from_code_of_any_text_does_not_panic(word in "[A-Za-z0-9_-]{0,60}") {
            if let Ok(path) = GroundSpline::from_code(&word) {
                prop_assert!(path.points().iter().all(|p| p.abs().max_element() <= MAX_DISTANCE_M));
            }
        }
    }

    #[test]
    fn code_of_a_path_is_short() {
        let points = (0..8).map(|k| DVec2::new(f64::from(k).sin(), 1.3 * f64::from(k))).collect();
        let path = GroundSpline::uniform(points).unwrap();
        assert!(path.to_code().len() <= 48, "{}", path.to_code());
        for word in ["", "A", "AA", "!", "AAD_", "_____________"] {
            assert!(GroundSpline::from_code(word).is_err(), "{word}");
        }
    }
}
