//! Registration curves: the time warp between two clips, and the alignment along it.

use super::{DistanceMatrix, PairTerms, PathError, PathOptions, RegistrationPath, optimal_path};
use crate::math::{MonotoneCurve, Planar, unwrap_near};
use glam::DVec2;

/// Options of registration curves.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct RegistrationOptions {
    /// Constraints on the path.
    pub path: PathOptions,
    /// The number of frames to either side over which the curves are smoothed.
    pub smoothing: usize,
}

impl RegistrationOptions {
    /// Returns the options with the default path, smoothed over a tenth of a second to either side
    /// at `fps`.
    #[must_use]
    pub fn new(fps: f64) -> Self {
        Self { path: PathOptions::default(), smoothing: (0.1 * fps).round() as usize }
    }
}

/// The correspondence of a clip (the *target*) to another (the *source*), and the alignment of the
/// target with the source: the registration curve of Kovar and Gleicher (2003), with its time warp
/// and alignment curve.
///
/// The cells of a path are the first frames of two windows, and their middles correspond. A cell
/// (i, j) of windows of K frames therefore stands for the frames i + (K - 1)/2 and j + (K - 1)/2,
/// and the curves reach from the first frames of the first windows to the last frames of the last
/// ones, at equal speed in the two half windows at the ends.
#[derive(Clone, Debug, PartialEq)]
pub struct Registration {
    path: RegistrationPath,
    warp: MonotoneCurve,
    alignment: AlignmentCurve,
}

/// The numbers of which a [`Registration`] is made.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RegistrationParts {
    /// The path through the matrix.
    pub path: RegistrationPath,
    /// The points of the time warp.
    pub warp: Vec<(f64, f64)>,
    /// The mean frames over which the curves of the alignment are.
    pub mean: Vec<f64>,
    /// These curves, each as long: the yaw, and the centres of both windows, x and z.
    pub curves: [Vec<f64>; 5],
    /// The number of frames to either side over which the curves are smoothed.
    pub smoothing: f64,
}

impl Registration {
    /// Finds the path and the curves through `matrix`, which was made from `terms`.
    ///
    /// # Errors
    /// [`PathError`] when no path is possible, or the terms are not those of the matrix.
    pub fn new(
        terms: &PairTerms,
        matrix: &DistanceMatrix,
        options: &RegistrationOptions,
    ) -> Result<Self, PathError> {
        Self::along(terms, matrix, optimal_path(matrix, &options.path)?, options.smoothing)
    }

    /// Returns the curves along a known path, smoothed over `smoothing` frames to either side.
    ///
    /// # Errors
    /// [`PathError`] when the path is empty or leaves the range of the terms.
    pub fn along(
        terms: &PairTerms,
        matrix: &DistanceMatrix,
        path: RegistrationPath,
        smoothing: usize,
    ) -> Result<Self, PathError> {
        let half_window = (matrix.window() - 1) as f64 / 2.0;
        let middle = |&(row, column): &(usize, usize)| {
            let (i, j) = matrix.frames(row, column);
            (i as f64 + half_window, j as f64 + half_window)
        };
        let cells: Vec<(f64, f64)> = path.cells.iter().map(middle).collect();
        let (Some(&first), Some(&last)) = (cells.first(), cells.last()) else {
            return Err(PathError::TooShort { window: matrix.window() });
        };
        let (begin, end) = (
            (first.0 - half_window, first.1 - half_window),
            (last.0 + half_window, last.1 + half_window),
        );
        let mut polyline = vec![begin];
        polyline.extend(&cells);
        polyline.push(end);
        polyline.dedup();
        let mut fixed = vec![begin];
        fixed.extend(path.pins.iter().map(middle));
        fixed.push(end);
        let smoothing = smoothing as f64;
        let warp = time_warp(&polyline, &fixed, smoothing).ok_or(PathError::NotFinite)?;
        let alignment = AlignmentCurve::new(terms, matrix, &path, &cells, smoothing)?;
        Ok(Self { path, warp, alignment })
    }

    /// Returns the numbers of which it is made, for a transfer.
    #[must_use]
    pub fn parts(&self) -> RegistrationParts {
        let AlignmentCurve { yaw, source: [sx, sz], target: [tx, tz], smoothing } = &self.alignment;
        RegistrationParts {
            path: self.path.clone(),
            warp: self.warp.points().collect(),
            mean: yaw.x.clone(),
            curves: [yaw, sx, sz, tx, tz].map(|curve| curve.y.clone()),
            smoothing: *smoothing,
        }
    }

    /// Returns the registration that is made of these numbers, with the bits of the one that
    /// [`parts`](Self::parts) took apart; `None` where they are of none.
    #[must_use]
    pub fn of_parts(parts: RegistrationParts) -> Option<Self> {
        let RegistrationParts { path, warp, mean, curves, smoothing } = parts;
        if mean.is_empty() || curves.iter().any(|curve| curve.len() != mean.len()) {
            return None;
        }
        let [yaw, sx, sz, tx, tz] = curves.map(|curve| SmoothedPolyline::new(mean.clone(), curve));
        let alignment = AlignmentCurve { yaw, source: [sx, sz], target: [tx, tz], smoothing };
        Some(Self { path, warp: MonotoneCurve::through(&warp)?, alignment })
    }

    /// Returns the path through the matrix.
    #[must_use]
    pub fn path(&self) -> &RegistrationPath {
        &self.path
    }

    /// Returns frames of the target over frames of the source, strictly increasing. Its ends are
    /// those of the registered part.
    #[must_use]
    pub fn warp(&self) -> &MonotoneCurve {
        &self.warp
    }

    /// Returns the alignment of the target at `source_frame` (may lie between frames):
    /// `source_world_from_target_world`. Its yaw is unwrapped: it may exceed half a turn, and never
    /// jumps.
    #[must_use]
    pub fn alignment_at(&self, source_frame: f64) -> Planar {
        self.alignment.at(0.5 * (source_frame + self.warp.at(source_frame)))
    }
}

/// A polyline that is smoothed by a moving average: continuously differentiable, and never steeper
/// than the polyline.
#[derive(Clone, Debug, PartialEq)]
struct SmoothedPolyline {
    x: Vec<f64>,
    y: Vec<f64>,
    /// The integral up to each point.
    integral: Vec<f64>,
}

impl SmoothedPolyline {
    /// Returns the smoothed polyline; `x` is strictly increasing, not empty, as long as `y`.
    fn new(x: Vec<f64>, y: Vec<f64>) -> Self {
        let mut sum = 0.0;
        let mut integral = vec![0.0];
        for k in 1..x.len() {
            sum += 0.5 * (y[k] + y[k - 1]) * (x[k] - x[k - 1]);
            integral.push(sum);
        }
        Self { x, y, integral }
    }

    /// Returns the integral up to `at` and the value there; constant beyond the ends.
    fn read(&self, at: f64) -> (f64, f64) {
        let last = self.x.len() - 1;
        if at <= self.x[0] {
            return ((at - self.x[0]) * self.y[0], self.y[0]);
        }
        if at >= self.x[last] {
            return (self.integral[last] + (at - self.x[last]) * self.y[last], self.y[last]);
        }
        let k = self.x.partition_point(|&x| x <= at).clamp(1, last);
        let step = at - self.x[k - 1];
        let value =
            self.y[k - 1] + (self.y[k] - self.y[k - 1]) * step / (self.x[k] - self.x[k - 1]);
        (self.integral[k - 1] + 0.5 * (self.y[k - 1] + value) * step, value)
    }

    fn mean(&self, at: f64, half_width: f64) -> f64 {
        if half_width < 1e-9 {
            return self.read(at).1;
        }
        (self.read(at + half_width).0 - self.read(at - half_width).0) / (2.0 * half_width)
    }
}

/// The least speed of one clip relative to the mean of both: a twentieth, where the fixed points
/// allow it.
const MIN_RATE: f64 = 0.05;

/// Returns the strictly increasing curve fitted to a path of frames (i, j), through the `fixed`
/// ones of its points.
///
/// Both clips are treated symmetrically: the lead v = j - i is a function of the mean u = (i +
/// j)/2, which rises with every step. It is smoothed over `smoothing` frames to either side, less
/// towards a fixed point, which stays; i = u - v/2 and j = u + v/2 both rise while |dv/du| < 2. If
/// a run of steps makes it steeper than a twentieth less than that, the part between its fixed
/// points is drawn towards the straight line. Then a monotone cubic is put through knots, two for
/// every width of smoothing.
fn time_warp(path: &[(f64, f64)], fixed: &[(f64, f64)], smoothing: f64) -> Option<MonotoneCurve> {
    let (mean, lead) = path.iter().map(|&(i, j)| (0.5 * (i + j), j - i)).unzip();
    let lead = SmoothedPolyline::new(mean, lead);
    let mut knots: Vec<(f64, f64)> = Vec::new();
    let mut from = *fixed.first()?;
    knots.push(from);
    let end = *fixed.last()?;
    for &to in &fixed[1..] {
        // A pin near the start or end that is reached by side steps alone is left to the smoothing.
        if to.0 <= from.0 || to.1 <= from.1 || (to != end && (to.0 >= end.0 || to.1 >= end.1)) {
            continue;
        }
        let (low, high) = (0.5 * (from.0 + from.1), 0.5 * (to.0 + to.1));
        let count = ((high - low) / (smoothing / 2.0).max(1.0)).ceil().max(1.0) as usize;
        let step = (high - low) / count as f64;
        let leads: Vec<f64> = (0..=count)
            .map(|k| {
                let u = low + step * k as f64;
                let room = (u - low).min(high - u).max(0.0);
                match k {
                    0 => from.1 - from.0,
                    _ if k == count => to.1 - to.0,
                    _ => lead.mean(u, smoothing.min(room)),
                }
            })
            .collect();
        let line = (leads[count] - leads[0]) / (high - low);
        let steepest = 2.0 - 2.0 * MIN_RATE.min((2.0 - line.abs()) / 4.0);
        let straighten = leads.windows(2).map(|pair| (pair[1] - pair[0]) / step).map(|slope| {
            let over = slope.abs() - steepest;
            if over > 0.0 { over / (slope.abs() - slope.signum() * line) } else { 0.0 }
        });
        let straighten = straighten.fold(0.0, f64::max);
        for (k, v) in leads.into_iter().enumerate().skip(1) {
            let u = low + step * k as f64;
            let v = v + straighten * (from.1 - from.0 + line * (u - low) - v);
            knots.push(if k == count { to } else { (u - 0.5 * v, u + 0.5 * v) });
        }
        from = to;
    }
    MonotoneCurve::through(&knots)
}

/// The alignment of the target with the source along a path.
///
/// It is stored as the yaw and the centres of both windows, and combined on evaluation: each is
/// smoothed where it is small and continuous. Smoothing x and z of the transform themselves would
/// couple them to the yaw by the distance from the origin.
#[derive(Clone, Debug, PartialEq)]
struct AlignmentCurve {
    yaw: SmoothedPolyline,
    source: [SmoothedPolyline; 2],
    target: [SmoothedPolyline; 2],
    smoothing: f64,
}

impl AlignmentCurve {
    fn new(
        terms: &PairTerms,
        matrix: &DistanceMatrix,
        path: &RegistrationPath,
        cells: &[(f64, f64)],
        smoothing: f64,
    ) -> Result<Self, PathError> {
        let mut yaw = 0.0;
        let (mut mean, mut yaws, mut sources, mut targets) = (vec![], vec![], vec![], vec![]);
        for (&(row, column), &(i, j)) in path.cells.iter().zip(cells) {
            let (source, target) = matrix.frames(row, column);
            let found = terms.alignment(source, target, matrix.window(), yaw)?;
            // The nearest of all equivalent yaws, so that the curve is unwrapped.
            yaw = unwrap_near(found.transform.yaw, yaw);
            let centre = terms.target_centre(target, matrix.window());
            mean.push(0.5 * (i + j));
            yaws.push(yaw);
            sources.push(turned(found.transform.yaw, centre) + found.transform.shift);
            targets.push(centre);
        }
        let over = |values: Vec<f64>| SmoothedPolyline::new(mean.clone(), values);
        let both = |points: &[DVec2]| {
            [over(points.iter().map(|p| p.x).collect()), over(points.iter().map(|p| p.y).collect())]
        };
        Ok(Self { yaw: over(yaws), source: both(&sources), target: both(&targets), smoothing })
    }

    fn at(&self, mean_frame: f64) -> Planar {
        let (first, last) = (self.yaw.x[0], self.yaw.x[self.yaw.x.len() - 1]);
        let at = mean_frame.clamp(first, last);
        let half_width = self.smoothing.min(at - first).min(last - at);
        let [source, target] = [&self.source, &self.target]
            .map(|[x, z]| DVec2::new(x.mean(at, half_width), z.mean(at, half_width)));
        let yaw = self.yaw.mean(at, half_width);
        Planar { yaw, shift: source - turned(yaw, target) }
    }
}

/// Rotates a point of the ground about the origin.
fn turned(yaw: f64, point: DVec2) -> DVec2 {
    let turn = Planar { yaw, shift: DVec2::ZERO };
    turn.apply_ground(point)
}

#[cfg(test)]
mod tests;
