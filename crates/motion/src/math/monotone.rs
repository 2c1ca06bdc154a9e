//! Monotone interpolation: strictly increasing cubic curves through points, and their inverses.

/// A strictly increasing, continuously differentiable curve through points. It is piecewise cubic
/// (Fritsch, Carlson 1980), with the slopes of Fritsch and Butland (1984): the weighted harmonic
/// mean of the neighbouring chords, which never overshoots.
#[derive(Clone, Debug, PartialEq)]
pub struct MonotoneCurve {
    x: Vec<f64>,
    y: Vec<f64>,
    slopes: Vec<f64>,
}

impl MonotoneCurve {
    /// Returns the curve through `points` (x, y). `None` when there are no points, a number is not
    /// finite, x is not strictly increasing or y decreases. Where y is constant, so is the curve,
    /// and it has no unique inverse there.
    #[must_use]
    pub fn through(points: &[(f64, f64)]) -> Option<Self> {
        let rises = points.windows(2).all(|pair| pair[0].0 < pair[1].0 && pair[0].1 <= pair[1].1);
        if points.is_empty()
            || !rises
            || !points.iter().all(|(x, y)| x.is_finite() && y.is_finite())
        {
            return None;
        }
        let (x, y): (Vec<f64>, Vec<f64>) = points.iter().copied().unzip();
        let slopes = slopes(&x, &y);
        Some(Self { x, y, slopes })
    }

    /// Returns the first point: (x, y).
    #[must_use]
    pub fn first(&self) -> (f64, f64) {
        (self.x[0], self.y[0])
    }

    /// Returns the last point: (x, y).
    #[must_use]
    pub fn last(&self) -> (f64, f64) {
        let last = self.x.len() - 1;
        (self.x[last], self.y[last])
    }

    /// Returns the points that define the curve: (x, y).
    pub fn points(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        self.x.iter().copied().zip(self.y.iter().copied())
    }

    /// Returns y at `x`, extrapolated with slope 1 beyond the ends.
    #[must_use]
    pub fn at(&self, x: f64) -> f64 {
        let ((from, low), (to, high)) = (self.first(), self.last());
        if x <= from || x.is_nan() {
            return low + (x - from);
        }
        if x >= to {
            return high + (x - to);
        }
        self.piece(self.index(&self.x, x)).0(x)
    }

    /// Returns dy/dx at `x`; 1 beyond the ends.
    #[must_use]
    pub fn slope(&self, x: f64) -> f64 {
        if !(x >= self.first().0 && x <= self.last().0) || self.x.len() < 2 {
            return 1.0;
        }
        self.piece(self.index(&self.x, x)).1(x)
    }

    /// Returns the x at which the curve reaches `y`, to rounding, extrapolated with slope 1 beyond
    /// the ends.
    #[must_use]
    pub fn inverse(&self, y: f64) -> f64 {
        let ((from, low), (to, high)) = (self.first(), self.last());
        if y <= low || y.is_nan() {
            return from + (y - low);
        }
        if y >= high {
            return to + (y - high);
        }
        let piece = self.index(&self.y, y);
        let (at, _) = self.piece(piece);
        let (mut left, mut right) = (self.x[piece], self.x[piece + 1]);
        // Bisection: a piece may be nearly flat at its ends, where Newton's method diverges.
        for _ in 0..60 {
            let middle = 0.5 * (left + right);
            if at(middle) < y { left = middle } else { right = middle }
        }
        0.5 * (left + right)
    }

    /// Returns the index of the piece that holds `value` of the given coordinate, which lies
    /// between the ends.
    fn index(&self, of: &[f64], value: f64) -> usize {
        of.partition_point(|&knot| knot <= value).clamp(1, self.x.len() - 1) - 1
    }

    /// Returns functions for value and slope over one piece.
    fn piece(&self, k: usize) -> (impl Fn(f64) -> f64, impl Fn(f64) -> f64) {
        let (x, step) = (self.x[k], self.x[k + 1] - self.x[k]);
        let (y, chord) = (self.y[k], (self.y[k + 1] - self.y[k]) / step);
        let (m0, m1) = (self.slopes[k], self.slopes[k + 1]);
        let (c2, c3) =
            ((3.0 * chord - 2.0 * m0 - m1) / step, (m0 + m1 - 2.0 * chord) / (step * step));
        (
            move |at| {
                let t = at - x;
                y + t * (m0 + t * (c2 + t * c3))
            },
            move |at| {
                let t = at - x;
                m0 + t * (2.0 * c2 + t * 3.0 * c3)
            },
        )
    }
}

fn slopes(x: &[f64], y: &[f64]) -> Vec<f64> {
    let steps: Vec<f64> = x.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let chords: Vec<f64> =
        y.windows(2).zip(&steps).map(|(pair, step)| (pair[1] - pair[0]) / step).collect();
    let (Some(&first), Some(&last)) = (chords.first(), chords.last()) else {
        return vec![1.0; x.len()];
    };
    if chords.len() == 1 {
        return vec![first; 2];
    }
    let n = chords.len();
    let inner = (1..n).map(|k| {
        let (before, after) = (chords[k - 1], chords[k]);
        if before <= 0.0 || after <= 0.0 {
            return 0.0;
        }
        let (w1, w2) = (2.0 * steps[k] + steps[k - 1], steps[k] + 2.0 * steps[k - 1]);
        (w1 + w2) / (w1 / before + w2 / after)
    });
    // The slope at the end of the parabola through the last three points, at least 0.
    let end = |chord: f64, next: f64, step: f64, next_step: f64| {
        (((2.0 * step + next_step) * chord - step * next) / (step + next_step)).max(0.0)
    };
    let begin = end(first, chords[1], steps[0], steps[1]);
    let finish = end(last, chords[n - 2], steps[n - 1], steps[n - 2]);
    std::iter::once(begin).chain(inner).chain(std::iter::once(finish)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn curve_through_points_increases_and_inverts(
            steps in prop::collection::vec((0.1f64..3.0, 0.01f64..3.0), 0..12),
        ) {
            let mut points = vec![(-1.0, 2.0)];
            for (dx, dy) in steps {
                let &(x, y) = points.last().unwrap();
                points.push((x + dx, y + dy));
            }
            let curve = MonotoneCurve::through(&points).unwrap();
            for &(x, y) in &points {
                prop_assert!((curve.at(x) - y).abs() < 1e-12);
            }
            let (from, to) = (curve.first().0 - 1.0, curve.last().0 + 1.0);
            let mut before = f64::NEG_INFINITY;
            for k in 0..=200 {
                let x = from + (to - from) * f64::from(k) / 200.0;
                let y = curve.at(x);
                prop_assert!(y > before, "{x} {y}");
                before = y;
                prop_assert!((curve.inverse(y) - x).abs() < 1e-4, "{x} {}", curve.inverse(y));
                let h = 1e-6;
                prop_assert!(
                    (curve.slope(x) - (curve.at(x + h) - curve.at(x - h)) / (2.0 * h)).abs() < 1e-3
                        || points.iter().any(|p| (p.0 - x).abs() < 2.0 * h)
                );
                prop_assert!(curve.slope(x) >= 0.0);
            }
        }
    }

    #[test]
    fn curve_through_descending_points_is_none() {
        assert_eq!(MonotoneCurve::through(&[]), None);
        assert_eq!(MonotoneCurve::through(&[(0.0, 0.0), (0.0, 1.0)]), None);
        assert_eq!(MonotoneCurve::through(&[(0.0, 0.0), (1.0, -1.0)]), None);
        assert_eq!(MonotoneCurve::through(&[(0.0, f64::NAN)]), None);
        let line = MonotoneCurve::through(&[(3.0, 5.0)]).unwrap();
        assert_eq!(
            (line.at(4.0), line.at(1.0), line.inverse(5.5), line.slope(3.0)),
            (6.0, 3.0, 3.5, 1.0)
        );
    }
}
