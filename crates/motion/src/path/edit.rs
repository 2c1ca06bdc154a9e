//! Edits of paths.

use super::fit::{FitOptions, fit_with_knots};
use super::{ArcLengthPath, GroundSpline, PathEditError, SplineEnds};
use crate::math::wrap_angle;
use glam::DVec2;
use std::f64::consts::TAU;

/// The pinned ends of a path, which no edit moves.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Pins {
    /// The start.
    pub start: bool,
    /// The end.
    pub end: bool,
}

/// An edit of a path. Positions are (x, z), metres.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum PathEdit {
    /// Moves a control point. On a closed path the ends move together, and their neighbours with
    /// them.
    Move {
        /// Index of the point.
        index: usize,
        /// The target.
        to: DVec2,
    },
    /// Inserts a control point at this parameter; the curve does not change (Boehm, "Inserting New
    /// Knots into B-spline Curves", 1980).
    Insert {
        /// The parameter, inside 0 and 1 and not on a knot.
        at: f64,
    },
    /// Removes a control point; the others move as little as necessary to keep the curve (least
    /// squares). The inverse of [`Self::Insert`].
    Remove {
        /// Index of the point; not an end.
        index: usize,
    },
    /// Moves every point between the ends by this share towards the line between its neighbours.
    Smooth {
        /// From 0 to 1.
        share: f64,
    },
    /// Moves every point to the nearest crossing of a grid.
    Snap {
        /// Width of the grid, metres.
        grid_m: f64,
    },
    /// Shifts the whole path.
    Shift {
        /// The shift.
        by: DVec2,
    },
    /// Rotates the whole path about its pinned end, or its middle.
    Rotate {
        /// About +Y.
        radians: f64,
    },
    /// Scales the whole path from its pinned end, or its middle.
    Scale {
        /// From 0.01 to 100.
        factor: f64,
    },
    /// Mirrors the path at the line from its start to its end. The character is not mirrored.
    Mirror,
    /// Straightens curves and keeps the length; 1 makes a straight line.
    Straighten {
        /// From 0 to 1.
        share: f64,
    },
    /// Bends the path by a whole turn, until it ends in its starting point and direction. The
    /// length is nearly kept; a path whose ends are near each other is only joined.
    Close,
    /// Opens a closed path: it gets two ends, at the same position.
    Open,
}

/// The largest factor of [`PathEdit::Scale`], and the inverse of the smallest.
const MAX_SCALE: f64 = 100.0;
/// The widest grid, metres.
const MAX_GRID_M: f64 = 100.0;
/// The number of samples per control point at which a path is measured before it is bent.
const SAMPLES: usize = 32;
/// Ends that are nearer to each other than this share of the length are joined without a turn.
const NEARLY_CLOSED: f64 = 0.25;
/// A closed path has an end, a neighbour to either side of it, and at least two more points.
const MIN_CLOSED: usize = 6;

impl GroundSpline {
    /// Returns the path after an edit.
    ///
    /// # Errors
    /// [`PathEditError`] for an unknown point, a pinned end that would have to move, a number out
    /// of range, or too few or too many points.
    pub fn edited(&self, edit: &PathEdit, pins: Pins) -> Result<Self, PathEditError> {
        if self.ends() == SplineEnds::Uniform {
            return self.edited_unclamped(edit, pins);
        }
        let held = pins.start || pins.end;
        let all = |f: &dyn Fn(DVec2) -> DVec2| {
            self.with_points(self.points().iter().map(|&p| f(p)).collect())
        };
        match *edit {
            PathEdit::Move { index, to } => self.with_moved(index, to, pins),
            PathEdit::Insert { at } => self.refined(at),
            PathEdit::Remove { index } => self.without(index),
            PathEdit::Smooth { share } => {
                check("smoothing", share, 0.0, 1.0)?;
                self.smoothed(share)
            }
            PathEdit::Snap { grid_m } => {
                check("grid (m)", grid_m, 1e-3, MAX_GRID_M)?;
                let mut points: Vec<DVec2> =
                    self.points().iter().map(|p| (p / grid_m).round() * grid_m).collect();
                let last = points.len() - 1;
                if pins.start {
                    points[0] = self.points()[0];
                }
                if pins.end {
                    points[last] = self.points()[last];
                }
                let snapped = self.with_points(points)?;
                // The ends of a loop follow from their neighbours.
                if self.is_closed() { snapped.held_by(self, pins) } else { Ok(snapped) }
            }
            PathEdit::Shift { by } => {
                if held {
                    return Err(PathEditError::Pinned);
                }
                all(&|p| p + by)
            }
            PathEdit::Rotate { radians } => {
                check("turn (radians)", radians, -TAU * 10.0, TAU * 10.0)?;
                let pivot = self.pivot(pins)?;
                all(&|p| pivot + turned(p - pivot, radians))
            }
            PathEdit::Scale { factor } => {
                check("scale", factor, MAX_SCALE.recip(), MAX_SCALE)?;
                let pivot = self.pivot(pins)?;
                all(&|p| pivot + (p - pivot) * factor)
            }
            PathEdit::Mirror => {
                let start = self.points()[0];
                let yaw = self.overall_yaw();
                let axis = DVec2::new(libm::sin(yaw), libm::cos(yaw));
                all(&|p| start + axis * (2.0 * axis.dot(p - start)) - (p - start))
            }
            PathEdit::Straighten { share } => {
                check("straightening", share, 0.0, 1.0)?;
                let yaw = self.overall_yaw();
                let open = Self::with_knots(self.points().to_vec(), self.inner_knots())?;
                let straight = |heading: f64, _: f64, mean: f64| {
                    heading + (mean + wrap_angle(yaw - mean) - heading) * share
                };
                open.bent(straight, false)?.held_by(self, pins)
            }
            PathEdit::Close => self.closed(pins),
            PathEdit::Open => Self::with_knots(self.points().to_vec(), self.inner_knots()),
        }
    }

    /// Moves control points of an unclamped path directly; all other edits are applied to the same
    /// curve, clamped.
    fn edited_unclamped(&self, edit: &PathEdit, pins: Pins) -> Result<Self, PathEditError> {
        let count = self.points().len();
        let PathEdit::Move { index, to } = *edit else {
            return Ok(self
                .with_ends(SplineEnds::Clamped)
                .edited(edit, pins)?
                .with_ends(SplineEnds::Uniform));
        };
        // Three points determine either end.
        if (pins.start && index < 3) || (pins.end && index + 3 >= count) {
            return Err(PathEditError::Pinned);
        }
        let mut points = self.points().to_vec();
        *points.get_mut(index).ok_or(PathEditError::NoSuchPoint { index, points: count })? = to;
        self.with_points(points)
    }

    fn with_moved(&self, index: usize, to: DVec2, pins: Pins) -> Result<Self, PathEditError> {
        let mut points = self.points().to_vec();
        let last = points.len() - 1;
        let Some(point) = points.get_mut(index) else {
            return Err(PathEditError::NoSuchPoint { index, points: last + 1 });
        };
        let by = to - *point;
        *point = to;
        let end = index == 0 || index == last;
        let pinned = (index == 0 && pins.start) || (index == last && pins.end);
        if !self.is_closed() {
            return if pinned { Err(PathEditError::Pinned) } else { self.with_points(points) };
        }
        let held = pins.start || pins.end;
        if end && held {
            return Err(PathEditError::Pinned);
        }
        if end {
            points[1] += by;
            points[last - 1] += by;
        } else if held && (index == 1 || index == last - 1) {
            // The end stays, so that its other neighbour moves in the opposite direction.
            let [first_span, last_span] = self.end_spans();
            if index == 1 {
                points[last - 1] = points[0] - (points[1] - points[0]) * (last_span / first_span);
            } else {
                points[1] = points[0] - (points[last - 1] - points[0]) * (first_span / last_span);
            }
        }
        self.with_points(points)
    }

    fn without(&self, index: usize) -> Result<Self, PathEditError> {
        let count = self.points().len();
        if index >= count {
            return Err(PathEditError::NoSuchPoint { index, points: count });
        }
        let least = if self.is_closed() { MIN_CLOSED } else { super::MIN_POINTS };
        if index == 0 || index == count - 1 || count <= least {
            return Err(PathEditError::NotRemoved { index, least });
        }
        // The knot nearest to the point's Greville abscissa is removed with it.
        let at = self.greville()[index];
        let mut knots = self.inner_knots().to_vec();
        let nearest =
            (knots.iter().enumerate()).min_by(|a, b| (a.1 - at).abs().total_cmp(&(b.1 - at).abs()));
        if let Some((knot, _)) = nearest {
            knots.remove(knot);
        }
        let last = (count * SAMPLES) as f64;
        let parameters: Vec<f64> = (0..=count * SAMPLES).map(|k| k as f64 / last).collect();
        let points: Vec<DVec2> = parameters.iter().map(|&u| self.position(u)).collect();
        let fitted = fit_with_knots(&points, &parameters, &knots, &pinned_fit())?;
        if self.is_closed() { fitted.closed_in_place() } else { Ok(fitted) }
    }

    fn smoothed(&self, share: f64) -> Result<Self, PathEditError> {
        let (g, old) = (self.greville(), self.points());
        let mut points = old.to_vec();
        for i in 1..old.len() - 1 {
            let between = (g[i] - g[i - 1]) / (g[i + 1] - g[i - 1]);
            points[i] = old[i].lerp(old[i - 1].lerp(old[i + 1], between), share);
        }
        self.with_points(points)
    }

    /// Returns the pivot of rotations.
    fn pivot(&self, pins: Pins) -> Result<DVec2, PathEditError> {
        let points = self.points();
        match (pins.start, pins.end) {
            (true, true) if self.is_closed() => Ok(points[0]),
            (true, true) => Err(PathEditError::Pinned),
            (true, false) => Ok(points[0]),
            (false, true) => Ok(points[points.len() - 1]),
            (false, false) => Ok(points.iter().sum::<DVec2>() / points.len() as f64),
        }
    }

    /// Returns the direction from the start to the end; that of the start where they coincide.
    fn overall_yaw(&self) -> f64 {
        let way = self.points()[self.points().len() - 1] - self.points()[0];
        if way.length() > super::arc_length::MIN_LENGTH_M {
            libm::atan2(way.x, way.y)
        } else {
            self.heading(0.0)
        }
    }

    /// Returns this path with its pinned ends as in `before`: shifted, or with two pinned ends
    /// rotated and scaled as well. Coinciding ends are moved alone.
    fn held_by(self, before: &Self, pins: Pins) -> Result<Self, PathEditError> {
        let ends = |spline: &Self| (spline.points()[0], spline.points()[spline.points().len() - 1]);
        let ((start, end), (from, to)) = (ends(before), ends(&self));
        let all = |f: &dyn Fn(DVec2) -> DVec2| {
            self.with_points(self.points().iter().map(|&p| f(p)).collect())
        };
        match (pins.start, pins.end) {
            (false, false) => Ok(self),
            (true, false) => all(&|p| p + (start - from)),
            (false, true) => all(&|p| p + (end - to)),
            (true, true) => {
                let (way, own) = (end - start, to - from);
                if way.length() < super::arc_length::MIN_LENGTH_M
                    || own.length() < super::arc_length::MIN_LENGTH_M
                {
                    return all(&|p| p + (start - from));
                }
                // The quotient of the two chords, as complex numbers, rotates and scales.
                let quotient = DVec2::new(way.dot(own), own.perp_dot(way)) / own.length_squared();
                all(&|p| start + quotient.rotate(p - from))
            }
        }
    }

    /// Returns the path whose direction is a function of its direction (unwrapped), the share of
    /// the length before the point, and the mean direction. It has the same length and start. For a
    /// loop, the gap between its ends is distributed evenly.
    fn bent(
        &self,
        heading: impl Fn(f64, f64, f64) -> f64,
        to_loop: bool,
    ) -> Result<Self, PathEditError> {
        let curve = ArcLengthPath::new(self.clone())?;
        let steps = self.points().len() * SAMPLES;
        let along = |k: f64| curve.length_m() * k / steps as f64;
        // Directions apply to the middle of each step.
        let mut headings: Vec<f64> = Vec::with_capacity(steps);
        for k in 0..steps {
            let own = curve.at_length(along(k as f64 + 0.5)).frame.yaw;
            headings.push(headings.last().map_or(own, |before| before + wrap_angle(own - before)));
        }
        let mean = headings.iter().sum::<f64>() / steps as f64;
        let mut points = vec![self.points()[0]];
        for (k, own) in headings.into_iter().enumerate() {
            let yaw = heading(own, (k as f64 + 0.5) / steps as f64, mean);
            points.push(points[k] + DVec2::new(libm::sin(yaw), libm::cos(yaw)) * along(1.0));
        }
        if to_loop {
            let missing = points[0] - points[steps];
            for (k, point) in points.iter_mut().enumerate() {
                *point += missing * (k as f64 / steps as f64);
            }
        }
        // Each point keeps its parameter, so that frames stay in place.
        let parameters: Vec<f64> =
            (0..=steps).map(|k| curve.parameter_at(along(k as f64))).collect();
        fit_with_knots(&points, &parameters, self.inner_knots(), &pinned_fit())
    }

    fn closed(&self, pins: Pins) -> Result<Self, PathEditError> {
        if self.is_closed() {
            return Ok(self.clone());
        }
        let (count, last) = (self.points().len(), self.points().len() - 1);
        if count < MIN_CLOSED {
            return Err(PathEditError::TooFewToClose { points: count, least: MIN_CLOSED });
        }
        let gap = self.points()[0] - self.points()[last];
        if pins.start && pins.end && gap.length() > super::arc_length::MIN_LENGTH_M {
            return Err(PathEditError::Pinned);
        }
        let curve = ArcLengthPath::new(self.clone())?;
        let near = gap.length() < NEARLY_CLOSED * curve.length_m();
        let bent = if near {
            let g = self.greville();
            self.with_points(self.points().iter().zip(&g).map(|(&p, &g)| p + gap * g).collect())?
        } else {
            let turn = curve.total_turn();
            let whole = (turn / TAU).round();
            let wanted = if whole == 0.0 { TAU.copysign(turn) } else { whole * TAU };
            self.bent(|heading, along, _| heading + (wanted - turn) * along, true)?
        };
        bent.closed_in_place()?
            .held_by(self, Pins { start: pins.start || !pins.end, end: pins.end && !pins.start })
    }

    /// Returns the closed path for coinciding ends: the neighbours of the end are put on one line
    /// through it.
    fn closed_in_place(&self) -> Result<Self, PathEditError> {
        let mut points = self.points().to_vec();
        let last = points.len() - 1;
        let [first_span, last_span] = self.end_spans();
        let derivative = ((points[1] - points[0]) / first_span
            + (points[last] - points[last - 1]) / last_span)
            * 0.5;
        points[1] = points[0] + derivative * first_span;
        points[last - 1] = points[last] - derivative * last_span;
        Ok(Self::with_knots(points, self.inner_knots())?.joined())
    }
}

impl ArcLengthPath {
    /// Returns the total turn of the path from its start to its end, radians, positive to the left.
    fn total_turn(&self) -> f64 {
        let places = self.evenly(self.spline().points().len() * SAMPLES);
        let steps = places.windows(2).map(|pair| wrap_angle(pair[1].frame.yaw - pair[0].frame.yaw));
        steps.sum()
    }
}

/// Returns options that fix both ends.
fn pinned_fit() -> FitOptions {
    FitOptions { pin_ends: true, ..FitOptions::default() }
}

/// Rotates a point of the ground about +Y.
fn turned(p: DVec2, radians: f64) -> DVec2 {
    crate::math::Planar::new(radians, 0.0, 0.0).apply_ground(p)
}

fn check(what: &'static str, value: f64, least: f64, most: f64) -> Result<(), PathEditError> {
    if (least..=most).contains(&value) {
        Ok(())
    } else {
        Err(PathEditError::Option { what, value, least, most })
    }
}

#[cfg(test)]
mod tests;
