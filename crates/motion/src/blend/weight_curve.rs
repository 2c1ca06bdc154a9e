//! Weights with keys over the course of a blend.

use super::WeightLaw;
use crate::math::sort::sort_by;

/// A weight over the course of a blend, interpolated smoothly between keys without overshoot.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct WeightCurve {
    /// (share of the blend, 0 to 1; weight, 0 to 1), in the order of shares.
    keys: Vec<(f64, f64)>,
}

impl WeightCurve {
    /// Returns a constant weight.
    #[must_use]
    pub fn constant(weight: f64) -> Self {
        Self::new([(0.0, weight)])
    }

    /// Returns the curve through keys (share of the blend, weight), in any order; both are clamped
    /// to 0 to 1. Where two keys have the same share, the later one applies. Without keys the
    /// weight is 0; keys that are not finite are ignored.
    #[must_use]
    pub fn new(keys: impl IntoIterator<Item = (f64, f64)>) -> Self {
        let mut keys: Vec<(f64, f64)> =
            keys.into_iter().filter(|(at, weight)| !at.is_nan() && !weight.is_nan()).collect();
        sort_by(&mut keys, |a, b| a.0.total_cmp(&b.0));
        Self {
            keys: keys
                .into_iter()
                .map(|(at, weight)| (at.clamp(0.0, 1.0), weight.clamp(0.0, 1.0)))
                .collect(),
        }
    }

    /// Returns the keys.
    #[must_use]
    pub fn keys(&self) -> &[(f64, f64)] {
        &self.keys
    }

    /// Returns the weight at a share of the blend: eased from key to key (no slope at either),
    /// constant outside.
    #[must_use]
    pub fn at(&self, share: f64) -> f64 {
        let next = self.keys.partition_point(|key| key.0 <= share);
        match (next.checked_sub(1).and_then(|before| self.keys.get(before)), self.keys.get(next)) {
            (Some(before), Some(next)) => {
                let left = WeightLaw::Smooth.alpha((share - before.0) / (next.0 - before.0));
                next.1 + (before.1 - next.1) * left
            }
            (Some(only), None) | (None, Some(only)) => only.1,
            (None, None) => 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weight_curve_passes_through_its_keys_without_overshoot() {
        let curve = WeightCurve::new([(0.8, 0.2), (0.25, 1.5), (f64::NAN, 0.5), (0.0, 0.0)]);
        assert_eq!(curve.keys(), [(0.0, 0.0), (0.25, 1.0), (0.8, 0.2)]);
        for &(at, weight) in curve.keys() {
            assert!((curve.at(at) - weight).abs() < 1e-12);
        }
        assert_eq!((curve.at(-1.0), curve.at(0.125), curve.at(2.0)), (0.0, 0.5, 0.2));
        assert_eq!(WeightCurve::constant(0.3).at(0.9), 0.3);
        assert_eq!(WeightCurve::new([]).at(0.5), 0.0);
        let jump = WeightCurve::new([(0.5, 0.0), (0.5, 1.0)]);
        assert_eq!((jump.at(0.49), jump.at(0.5)), (0.0, 1.0));
    }
}
