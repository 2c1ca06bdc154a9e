//! Weight laws of blends.

/// The curve of the outgoing clip's weight over a blend.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize,
)]
pub enum WeightLaw {
    /// 2t³ - 3t² + 1: no slope at either end, so that velocities stay continuous (C¹; Kovar,
    /// Gleicher, Pighin 2002, section 3.3).
    #[default]
    Smooth,
    /// 1 - t: velocities are discontinuous at both ends.
    Linear,
    /// 1 - (6t⁵ - 15t⁴ + 10t³): no slope and no curvature at either end (C²; Perlin 2002), steeper
    /// in the middle.
    Smoother,
}

impl WeightLaw {
    /// All laws, for a list of choices.
    pub const ALL: [Self; 3] = [Self::Smooth, Self::Linear, Self::Smoother];

    /// Returns the weight of the *outgoing* clip at `t` from 0 (weight 1) to 1 (weight 0). `t` is
    /// clamped; NaN counts as 0.
    #[must_use]
    pub fn alpha(self, t: f64) -> f64 {
        // `clamp` would keep NaN.
        let t = if t > 0.0 { t.min(1.0) } else { 0.0 };
        match self {
            Self::Smooth => t * t * (2.0 * t - 3.0) + 1.0,
            Self::Linear => 1.0 - t,
            Self::Smoother => 1.0 - t * t * t * (t * (t * 6.0 - 15.0) + 10.0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn alpha_falls_from_1_to_0_and_is_symmetric(s in 0.0f64..1.0, t in 0.0f64..1.0) {
            for law in WeightLaw::ALL {
                prop_assert_eq!(law.alpha(0.0), 1.0);
                prop_assert!(law.alpha(1.0).abs() < 1e-12);
                prop_assert!((law.alpha(t) + law.alpha(1.0 - t) - 1.0).abs() < 1e-12);
                prop_assert!(law.alpha(s.min(t)) >= law.alpha(s.max(t)));
            }
        }
    }

    #[test]
    fn alpha_is_flat_at_both_ends_as_documented() {
        let slope = |law: WeightLaw, t: f64| (law.alpha(t + 1e-5) - law.alpha(t - 1e-5)) / 2e-5;
        for t in [1e-5, 1.0 - 1e-5] {
            assert!(slope(WeightLaw::Smooth, t).abs() < 1e-4);
            assert!(slope(WeightLaw::Smoother, t).abs() < 1e-8);
            assert!((slope(WeightLaw::Linear, t) + 1.0).abs() < 1e-8);
        }
        assert_eq!(WeightLaw::Smooth.alpha(0.25), 0.84375);
        assert_eq!(WeightLaw::Smoother.alpha(0.25), 1.0 - 0.103_515_625);
        assert_eq!(WeightLaw::Smooth.alpha(-3.0), 1.0);
        assert_eq!(WeightLaw::Smooth.alpha(f64::NAN), 1.0);
    }
}
