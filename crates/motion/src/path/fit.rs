//! Least-squares fit of paths.

use super::PathEditError;
use super::spline::{GroundSpline, SplineEnds, bounds, check_count, uniform_knots};
use glam::DVec2;

/// Options of a fit.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default)]
pub struct FitOptions {
    /// Number of control points, from 4 to 256. Four cannot follow a turn; many follow every sway
    /// of the hips.
    pub control_points: usize,
    /// The weight of bending relative to the distance from the points: 0 for least squares alone.
    pub smoothing: f64,
    /// Whether the path starts in the first and ends in the last point.
    pub pin_ends: bool,
    /// The kind of control points returned; the curve is the same.
    pub ends: SplineEnds,
}

impl Default for FitOptions {
    fn default() -> Self {
        Self { control_points: 8, smoothing: 0.0, pin_ends: false, ends: SplineEnds::default() }
    }
}

/// The greatest smoothing: the path is then a straight line.
pub const MAX_SMOOTHING: f64 = 1e6;
/// Smoothing where the points do not determine every control point.
const FILL: f64 = 1e-8;
/// The least pivot, as a share of the largest one.
const MIN_PIVOT: f64 = 1e-7;
/// The least length of a drawn curve, metres.
const MIN_DRAWN_M: f64 = 0.1;

impl FitOptions {
    /// Checks the numbers.
    ///
    /// # Errors
    /// [`PathEditError`] for a count or a smoothing out of range.
    pub fn validate(&self) -> Result<(), PathEditError> {
        check_count(self.control_points)?;
        if (0.0..=MAX_SMOOTHING).contains(&self.smoothing) {
            Ok(())
        } else {
            Err(PathEditError::Option {
                what: "smoothing",
                value: self.smoothing,
                least: 0.0,
                most: MAX_SMOOTHING,
            })
        }
    }
}

/// Returns the path with uniform knots that is closest to `points` (x, z; metres) at their
/// `parameters` (from 0 to 1, not descending).
///
/// It minimizes `mean |C(u_k) - p_k|² + smoothing · mean |h Δ_i|²`, with `Δ_i` the change of slope
/// of the control polygon over the Greville abscissae at its inner point i, and h the mean spacing:
/// a straight path costs nothing (after Eilers and Marx, "Flexible Smoothing with B-splines and
/// Penalties", 1996). Rows are added one by one to a banded triangle by Givens rotations, which
/// does not square the condition of the problem (Cox, in "The State of the Art in Numerical
/// Analysis", 1977; Dierckx, "Curve and Surface Fitting with Splines", 1993, section 4.1): O(points
/// + control points). The path is straight where points for a control point are missing.
///
/// # Errors
/// [`PathEditError`] for options out of range, no points, lists of different length, and values
/// that are not finite.
pub fn fit_spline(
    points: &[DVec2],
    parameters: &[f64],
    options: &FitOptions,
) -> Result<GroundSpline, PathEditError> {
    // Before memory is allocated for the knots.
    options.validate()?;
    let knots = uniform_knots(options.control_points);
    fit_with_knots(points, parameters, &knots, options)
}

/// Returns the closest path with given inner knots, which determine the number of control points.
pub(super) fn fit_with_knots(
    points: &[DVec2],
    parameters: &[f64],
    inner_knots: &[f64],
    options: &FitOptions,
) -> Result<GroundSpline, PathEditError> {
    let (Some(&first), Some(&last)) = (points.first(), points.last()) else {
        return Err(PathEditError::Frames { frames: 0 });
    };
    let rises = parameters.windows(2).all(|pair| pair[0] <= pair[1])
        && parameters.iter().all(|u| (0.0..=1.0).contains(u));
    if points.len() != parameters.len() || !rises {
        return Err(PathEditError::Parameters);
    }
    if let Some(index) = points.iter().position(|point| !point.is_finite()) {
        return Err(PathEditError::Point { index });
    }
    // Relative to the first point, so that numbers are small.
    let count = inner_knots.len() + 4;
    let shape = GroundSpline::with_knots(vec![DVec2::ZERO; count], inner_knots)?;
    let pins: Vec<(usize, DVec2)> =
        if options.pin_ends { vec![(0, DVec2::ZERO), (count - 1, last - first)] } else { vec![] };
    let solve = |smoothing: f64| {
        let mut band = Band::new(count);
        let weight = (points.len() as f64).sqrt().recip();
        for (&point, &u) in points.iter().zip(parameters) {
            let (start, shares) = shape.shares(u);
            band.add_pinned(
                start,
                shares.map(|share| share * weight),
                (point - first) * weight,
                &pins,
            );
        }
        if smoothing > 0.0 {
            let g = shape.greville();
            let spacing = 1.0 / (count - 1) as f64;
            let weight = (smoothing / (count - 2) as f64).sqrt() * spacing;
            for i in 1..count - 1 {
                let (before, after) = (weight / (g[i] - g[i - 1]), weight / (g[i + 1] - g[i]));
                band.add_pinned(i - 1, [before, -before - after, after, 0.0], DVec2::ZERO, &pins);
            }
        }
        for &(index, point) in &pins {
            band.add(index, [1.0, 0.0, 0.0, 0.0], point);
        }
        band.solve()
    };
    let relative = solve(options.smoothing)
        .or_else(|| solve(options.smoothing.max(FILL)))
        .ok_or(PathEditError::Parameters)?;
    let fitted = GroundSpline::with_knots(
        relative.into_iter().map(|point| point + first).collect(),
        inner_knots,
    )?;
    Ok(fitted.with_ends(options.ends))
}

/// Returns a curve drawn by hand, (x, z) in metres in the order of drawing, as a path with uniform
/// knots over its chord length.
///
/// # Errors
/// [`PathEditError`] for options out of range, values that are not finite, and a curve that is
/// shorter than 10 cm.
pub fn drawn_path(points: &[DVec2], options: &FitOptions) -> Result<GroundSpline, PathEditError> {
    let (parameters, length_m) = chord_parameters(points);
    if !length_m.is_finite() {
        let index = points.iter().position(|point| !point.is_finite()).unwrap_or(0);
        return Err(PathEditError::Point { index });
    }
    if length_m < MIN_DRAWN_M {
        return Err(PathEditError::NoLength { length_m });
    }
    fit_spline(points, &parameters, options)
}

/// Returns the share of the length before each point, and the whole length, metres; the shares are
/// 0 where the length is.
pub(super) fn chord_parameters(points: &[DVec2]) -> (Vec<f64>, f64) {
    let mut along = 0.0;
    let mut before = points.first().copied().unwrap_or_default();
    let mut lengths: Vec<f64> = Vec::with_capacity(points.len());
    for &point in points {
        along += point.distance(before);
        before = point;
        lengths.push(along);
    }
    if along > 0.0 {
        for length in &mut lengths {
            *length = (*length / along).min(1.0);
        }
    }
    (lengths, along)
}

/// Returns the diagonal of the bounding box of points, metres.
pub(super) fn extent(points: &[DVec2]) -> f64 {
    let (low, high) = bounds(points);
    high.distance(low)
}

/// The triangle of a QR decomposition, with rows of four numbers from the diagonal on, and its
/// right-hand side.
struct Band {
    rows: Vec<[f64; 4]>,
    right: Vec<DVec2>,
}

impl Band {
    fn new(size: usize) -> Self {
        Self { rows: vec![[0.0; 4]; size], right: vec![DVec2::ZERO; size] }
    }

    /// Adds an equation in which the unknowns of `pins` are known.
    fn add_pinned(
        &mut self,
        start: usize,
        mut row: [f64; 4],
        mut right: DVec2,
        pins: &[(usize, DVec2)],
    ) {
        for &(index, point) in pins {
            if let Some(share) = index.checked_sub(start).and_then(|k| row.get_mut(k)) {
                right -= point * *share;
                *share = 0.0;
            }
        }
        self.add(start, row, right);
    }

    /// Adds an equation whose coefficients belong to the unknowns from `start` on.
    fn add(&mut self, start: usize, mut row: [f64; 4], mut right: DVec2) {
        for (own, own_right) in self.rows.iter_mut().zip(&mut self.right).skip(start) {
            if row == [0.0; 4] {
                break;
            }
            // All numbers are far from those whose squares are out of range. One whose square is 0
            // is nothing beside the others.
            let length = (own[0] * own[0] + row[0] * row[0]).sqrt();
            if row[0] != 0.0 && length > 0.0 {
                let (cos, sin) = (own[0] / length, row[0] / length);
                for (a, b) in own.iter_mut().zip(&mut row) {
                    (*a, *b) = (cos * *a + sin * *b, cos * *b - sin * *a);
                }
                (*own_right, right) =
                    (*own_right * cos + right * sin, right * cos - *own_right * sin);
            }
            row = [row[1], row[2], row[3], 0.0];
        }
    }

    /// Returns the unknowns; `None` where the equations do not determine them.
    fn solve(&self) -> Option<Vec<DVec2>> {
        let largest = self.rows.iter().map(|row| row[0].abs()).fold(0.0, f64::max);
        let mut found = vec![DVec2::ZERO; self.rows.len()];
        for i in (0..self.rows.len()).rev() {
            let row = self.rows[i];
            // NaN does not count as a pivot.
            let pivot = row[0].abs() > largest * MIN_PIVOT;
            if !pivot {
                return None;
            }
            let known: DVec2 = (1..4).filter_map(|k| Some(*found.get(i + k)? * row[k])).sum();
            found[i] = (self.right[i] - known) / row[0];
        }
        Some(found)
    }
}

#[cfg(test)]
mod tests;
