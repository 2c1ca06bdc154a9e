//! Curves through given values: quintic pieces and clamped splines.

use std::ops::{Add, Mul, Sub};

/// Value, rate and acceleration at one end of a piece.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct State<V> {
    pub(super) value: V,
    pub(super) rate: V,
    pub(super) acceleration: V,
}

impl<V: Default> State<V> {
    /// Returns the state at rest at a value.
    pub(super) fn rest(value: V) -> Self {
        Self { value, rate: V::default(), acceleration: V::default() }
    }
}

/// Returns the polynomial of degree five from `from` to `to` in `span_secs`, at `secs` from its
/// start (clamped to the piece).
pub(super) fn quintic<V>(from: State<V>, to: State<V>, span_secs: f64, secs: f64) -> V
where
    V: Copy + Add<Output = V> + Sub<Output = V> + Mul<f64, Output = V>,
{
    if span_secs <= 0.0 {
        return to.value;
    }
    let t = (secs / span_secs).clamp(0.0, 1.0);
    let (v0, v1) = (from.rate * span_secs, to.rate * span_secs);
    let (a0, a1) =
        (from.acceleration * (span_secs * span_secs), to.acceleration * (span_secs * span_secs));
    let d = to.value - from.value;
    let c3 = d * 10.0 - v0 * 6.0 - v1 * 4.0 - a0 * 1.5 + a1 * 0.5;
    let c4 = v0 * 8.0 + v1 * 7.0 - d * 15.0 + a0 * 1.5 - a1;
    let c5 = d * 6.0 - v0 * 3.0 - v1 * 3.0 - a0 * 0.5 + a1 * 0.5;
    from.value + (v0 + (a0 * 0.5 + (c3 + (c4 + c5 * t) * t) * t) * t) * t
}

/// Returns the acceleration at the start of the cubic from `from` to `to` in `span_secs`, which is
/// the curve of least bending.
pub(super) fn cubic_start_acceleration<V>(from: State<V>, to: State<V>, span_secs: f64) -> V
where
    V: Copy + Add<Output = V> + Sub<Output = V> + Mul<f64, Output = V>,
{
    let d = to.value - from.value;
    d * (6.0 / (span_secs * span_secs)) - (from.rate * 4.0 + to.rate * 2.0) * span_secs.recip()
}

const MAX_KNOTS: usize = 10;

/// A cubic spline through up to ten knots with given slopes at both ends: twice continuously
/// differentiable inside.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spline {
    count: usize,
    at: [f64; MAX_KNOTS],
    value: [f64; MAX_KNOTS],
    slope: [f64; MAX_KNOTS],
}

impl Spline {
    /// Returns the spline through `knots` (time, value) in rising order of time; more than ten are
    /// cut off.
    pub(super) fn clamped(knots: &[(f64, f64)], start_slope: f64, end_slope: f64) -> Self {
        let count = knots.len().min(MAX_KNOTS);
        let mut spline =
            Self { count, at: [0.0; MAX_KNOTS], value: [0.0; MAX_KNOTS], slope: [0.0; MAX_KNOTS] };
        for (i, &(at, value)) in knots.iter().take(count).enumerate() {
            spline.at[i] = at;
            spline.value[i] = value;
        }
        if count < 2 {
            return spline;
        }
        // Slopes from continuity of the second derivative: a tridiagonal system, solved forwards
        // and back (Thomas).
        let last = count - 1;
        let mut upper = [0.0; MAX_KNOTS];
        spline.slope[0] = start_slope;
        for i in 1..last {
            let (h0, h1) = (spline.at[i] - spline.at[i - 1], spline.at[i + 1] - spline.at[i]);
            let right = 3.0
                * ((spline.value[i] - spline.value[i - 1]) * h1 / h0
                    + (spline.value[i + 1] - spline.value[i]) * h0 / h1);
            let pivot = 2.0 * (h0 + h1) - h1 * upper[i - 1];
            upper[i] = h0 / pivot;
            spline.slope[i] = (right - h1 * spline.slope[i - 1]) / pivot;
        }
        spline.slope[last] = end_slope;
        for i in (1..last).rev() {
            spline.slope[i] -= upper[i] * spline.slope[i + 1];
        }
        spline
    }

    /// Returns the value at a time, constant beyond the ends.
    pub(super) fn at(&self, secs: f64) -> f64 {
        if self.count == 0 {
            return 0.0;
        }
        let last = self.count - 1;
        let i = (0..last).rev().find(|&i| secs >= self.at[i]).unwrap_or(0);
        let next = (i + 1).min(last);
        let h = self.at[next] - self.at[i];
        if h <= 0.0 {
            return self.value[i];
        }
        let t = ((secs - self.at[i]) / h).clamp(0.0, 1.0);
        let (t2, t3) = (t * t, t * t * t);
        self.value[i] * (2.0 * t3 - 3.0 * t2 + 1.0)
            + self.slope[i] * h * (t3 - 2.0 * t2 + t)
            + self.value[next] * (3.0 * t2 - 2.0 * t3)
            + self.slope[next] * h * (t3 - t2)
    }
}

/// Returns 0 before `from`, 1 after `to`, and a curve that is smooth to the second derivative
/// between; also for infinite ends.
pub(super) fn ramp(secs: f64, from: f64, to: f64) -> f64 {
    if secs <= from {
        return 0.0;
    }
    if secs >= to || !from.is_finite() {
        return 1.0;
    }
    let t = (secs - from) / (to - from);
    t * t * t * (t * (t * 6.0 - 15.0) + 10.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quintic_meets_both_ends() {
        let from = State { value: 1.0, rate: -2.0, acceleration: 3.0 };
        let to = State { value: 4.0, rate: 0.5, acceleration: -1.0 };
        let f = |t: f64| quintic(from, to, 0.8, t);
        let h = 1e-4;
        assert!((f(0.0) - 1.0).abs() < 1e-12 && (f(0.8) - 4.0).abs() < 1e-12);
        assert!(((f(h) - f(0.0)) / h + 2.0).abs() < 1e-3);
        assert!(((f(0.8) - f(0.8 - h)) / h - 0.5).abs() < 1e-3);
        assert!(((f(2.0 * h) - 2.0 * f(h) + f(0.0)) / (h * h) - 3.0).abs() < 0.05);
    }

    #[test]
    fn clamped_spline_reproduces_a_cubic() {
        let cubic = |t: f64| 2.0 - t + 0.5 * t * t - 0.3 * t * t * t;
        let slope = |t: f64| -1.0 + t - 0.9 * t * t;
        let knots: Vec<_> = [0.0, 0.4, 0.5, 1.3, 2.0].iter().map(|&t| (t, cubic(t))).collect();
        let spline = Spline::clamped(&knots, slope(0.0), slope(2.0));
        for i in 0..=20 {
            let t = f64::from(i) * 0.1;
            assert!((spline.at(t) - cubic(t)).abs() < 1e-12, "{t}");
        }
    }

    #[test]
    fn ramp_with_infinite_ends_is_0_or_1() {
        assert_eq!(ramp(0.0, f64::NEG_INFINITY, f64::NEG_INFINITY), 1.0);
        assert_eq!(ramp(0.0, f64::INFINITY, f64::INFINITY), 0.0);
        assert_eq!(ramp(0.5, 0.0, 1.0), 0.5);
    }
}
