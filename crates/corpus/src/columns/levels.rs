//! Numbers in one byte: levels that are even near 0 and grow by a ratio beyond.

use crate::CorpusError;
use serde::{Deserialize, Serialize};

/// The scale as a share of the median magnitude: below it levels are linear, above it logarithmic.
const SHARE_OF_MIDDLE: f64 = 0.25;
/// The number of levels. Code 0 is no value.
const LEVELS: i32 = 255;
/// The least scale, and the greatest size of a value.
const LIMITS: [f64; 2] = [1e-9, 1e12];
/// The digits of a level: rounded, so that a value is what a table shows of it.
const DIGITS: i32 = 3;

/// The levels of a column.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Levels {
    scale: f64,
    step: f64,
    first: i32,
}

impl Levels {
    /// Returns levels that span some values. 0 is one of them. `step` is their distance in the
    /// scale of the inverse hyperbolic sine: beyond the scale, the relative error is at most half
    /// of it.
    pub(crate) fn spanning(values: impl Iterator<Item = f64>, step: f64) -> Self {
        let limited = |value: f64| value.clamp(-LIMITS[1], LIMITS[1]);
        let finite = values.filter(|value| value.is_finite());
        let mut values: Vec<f64> = finite.map(limited).collect();
        let mut sizes: Vec<f64> =
            values.iter().map(|value| value.abs()).filter(|size| *size > 0.0).collect();
        sizes.sort_by(f64::total_cmp);
        let middle = sizes.get(sizes.len() / 2).copied().unwrap_or(1.0);
        let scale = (SHARE_OF_MIDDLE * middle).max(LIMITS[0]);
        values.sort_by(f64::total_cmp);
        let ends = values.first().copied().zip(values.last().copied()).unwrap_or_default();
        let (low, high) = (libm::asinh(ends.0 / scale), libm::asinh(ends.1 / scale));
        // Both ends are rounded to levels.
        let step = step.max((high - low) / f64::from(LEVELS - 2));
        Self { scale, step, first: (low / step).round() as i32 }
    }

    /// Returns the code of a value.
    pub(crate) fn code(&self, value: Option<f64>) -> u8 {
        let Some(value) = value.filter(|value| value.is_finite()) else { return 0 };
        let value = value.clamp(-LIMITS[1], LIMITS[1]);
        let level = (libm::asinh(value / self.scale) / self.step).round() as i32;
        (1 + level.saturating_sub(self.first).clamp(0, LEVELS - 1)) as u8
    }

    /// Returns the value of each code.
    ///
    /// # Errors
    /// [`CorpusError::Damaged`] if scale or step is not positive.
    pub(crate) fn values(&self) -> Result<Vec<Option<f64>>, CorpusError> {
        let is_positive = |number: f64| number > 0.0 && number.is_finite();
        if !is_positive(self.scale) || !is_positive(self.step) {
            return Err(CorpusError::Damaged { what: "levels of a column" });
        }
        let value = |code: i32| {
            let level = f64::from(self.first) + f64::from(code - 1);
            let value = self.scale * libm::sinh(level * self.step);
            Some(rounded(value, DIGITS)).filter(|value| value.is_finite())
        };
        Ok((0..=LEVELS).map(|code| if code == 0 { None } else { value(code) }).collect())
    }
}

/// Returns a value with a number of digits.
pub(crate) fn rounded(value: f64, digits: i32) -> f64 {
    if value == 0.0 || !value.is_finite() {
        return value;
    }
    let mut size = value.abs();
    let mut above = 0;
    // Powers of ten by multiplication: `powi` differs between machines.
    while size >= 10.0 && above < 400 {
        size *= 0.1;
        above += 1;
    }
    while size < 1.0 && above > -400 {
        size *= 10.0;
        above -= 1;
    }
    let shift = digits - 1 - above;
    let power = (0..shift.abs()).fold(1.0, |power: f64, _| power * 10.0);
    let made =
        if shift >= 0 { (value * power).round() / power } else { (value / power).round() * power };
    if made.is_finite() { made } else { value }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn level_of_a_value_is_near_it(
            values in prop::collection::vec(-1e4f64..1e4, 1..40), zeros in 0usize..3
        ) {
            let values = [values, vec![0.0; zeros]].concat();
            let levels = Levels::spanning(values.iter().copied(), 0.04);
            let known = levels.values().unwrap();
            for value in values {
                let read = known[usize::from(levels.code(Some(value)))].unwrap();
                let most = 0.035 * value.abs() + 0.05 * levels.scale;
                prop_assert!((read - value).abs() <= most, "{} {}", value, read);
            }
        }

        #[test]
        fn any_levels_are_numbers_or_refused(
            scale in any::<f64>(), step in any::<f64>(), first in any::<i32>()
        ) {
            if let Ok(values) = (Levels { scale, step, first }).values() {
                prop_assert!(values.len() == 256 && values.iter().flatten().all(|own| own.is_finite()));
            }
        }
    }

    #[test]
    fn none_and_zero_are_exact_and_order_is_kept() {
        let levels = Levels::spanning([-3.0, 0.0, 1e-3, 0.5, 2.0, 900.0].into_iter(), 0.04);
        let values = levels.values().unwrap();
        assert_eq!((levels.code(None), levels.code(Some(f64::NAN)), values[0]), (0, 0, None));
        assert_eq!(values[usize::from(levels.code(Some(0.0)))], Some(0.0));
        let known: Vec<f64> = values.iter().flatten().copied().collect();
        assert!(known.windows(2).all(|pair| pair[0] <= pair[1]));
        let single = Levels::spanning(std::iter::empty(), 0.04);
        assert_eq!(single.values().unwrap()[usize::from(single.code(Some(0.0)))], Some(0.0));
    }

    #[test]
    fn rounded_value_has_three_digits() {
        let rounded = |value| rounded(value, 3);
        assert_eq!(
            [1234.5, 0.123_45, -9.999, 1.0, 0.000_123_4].map(rounded),
            [1230.0, 0.123, -10.0, 1.0, 0.000_123]
        );
        assert!(rounded(f64::MAX).is_finite() && rounded(f64::MIN_POSITIVE) >= 0.0);
    }
}
