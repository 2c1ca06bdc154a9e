//! Cubic B-spline paths over the ground.

use super::PathEditError;
use glam::DVec2;

/// The degree of every path.
const DEGREE: usize = 3;
/// The least number of control points of a cubic.
pub const MIN_POINTS: usize = DEGREE + 1;
/// The greatest number of control points of a path: more than can be told apart on screen, and few
/// enough for a link.
pub const MAX_POINTS: usize = 256;
/// The greatest distance of a control point from the origin, metres.
pub const MAX_DISTANCE_M: f64 = 10_000.0;
/// The least distance between two knots, in the parameter.
const MIN_SPAN: f64 = 1e-4;
/// The least distance of a new knot from others: a little more, so that rounding in a link does not
/// bring it too close.
const MIN_INSERT: f64 = 1e-3;
/// A shorter derivative does not determine a direction, metres per unit of the parameter.
const MIN_SPEED: f64 = 1e-6;

/// The position of a path relative to its first and its last control point.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum SplineEnds {
    /// It starts in the first and ends in the last control point: the outer knots coincide.
    #[default]
    Clamped,
    /// It starts and ends between three control points: the knots continue evenly beyond its ends,
    /// and every piece has the same matrix (1, 4, 1)/6.
    Uniform,
}

/// A path over the ground: a cubic B-spline in (x, z), metres, over the parameter `[0, 1]`.
///
/// It is fitted and edited in clamped form, in which it starts in its first control point and ends
/// in its last; [`Self::with_ends`] returns the control points of the same curve in unclamped form.
/// Knots are uniform after a fit; [`PathEdit::Insert`](super::PathEdit::Insert) adds one at any
/// parameter. Position, direction and curvature are continuous (C²). A *closed* path ends at its
/// start, in the same direction (C¹ there). Source: de Boor, A Practical Guide to Splines, chapters
/// IX and X.
#[derive(Clone, Debug, PartialEq)]
pub struct GroundSpline {
    points: Vec<DVec2>,
    /// All knots: four at most 0, the inner ones, four at least 1.
    knots: Vec<f64>,
    closed: bool,
    /// The same curve as polynomials, computed from points and knots.
    pieces: Vec<Piece>,
}

/// A polynomial piece of a path, stored because it is evaluated many times while the path is
/// dragged.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Piece {
    /// The parameter at its start.
    start: f64,
    /// Position and derivatives by the parameter at its start, each divided by its factorial.
    powers: [DVec2; 4],
}

impl Piece {
    /// Returns the piece that starts at knot `span`.
    fn new(points: &[DVec2], knots: &[f64], span: usize) -> Self {
        let t = &knots[span + 1 - DEGREE..=span + DEGREE];
        let p = &points[span - DEGREE..=span];
        // Differences of the control points are the control points of the derivatives, which have a
        // lower degree.
        let d = |i: usize| (p[i + 1] - p[i]) * (3.0 / (t[i + 3] - t[i]).max(f64::MIN_POSITIVE));
        let first = [d(0), d(1), d(2)];
        let dd = |i: usize| {
            (first[i + 1] - first[i]) * (2.0 / (t[i + 3] - t[i + 1]).max(f64::MIN_POSITIVE))
        };
        let second = [dd(0), dd(1)];
        let third = (second[1] - second[0]) / (t[3] - t[2]);
        let start = t[2];
        let [a, b, c, e] = basis(t, start);
        let [q0, q1, q2] = quadratic(t, start);
        Self {
            start,
            powers: [
                p[0] * a + p[1] * b + p[2] * c + p[3] * e,
                first[0] * q0 + first[1] * q1 + first[2] * q2,
                second[0] * 0.5,
                third / 6.0,
            ],
        }
    }

    /// Returns the polar form of the piece: the control point of a B-spline with these three inner
    /// knots (Ramshaw, Blossoms are Polar Forms, 1989).
    fn blossom(&self, knots: [f64; 3]) -> DVec2 {
        let ([r, s, t], [a, b, c, d]) = (knots.map(|knot| knot - self.start), self.powers);
        a + b * ((r + s + t) / 3.0) + c * ((r * s + s * t + t * r) / 3.0) + d * (r * s * t)
    }

    /// Returns the first derivative by the parameter.
    pub(super) fn first(&self, parameter: f64) -> DVec2 {
        let (s, [_, b, c, d]) = (parameter - self.start, self.powers);
        b + (c * 2.0 + d * (3.0 * s)) * s
    }

    fn jet(&self, parameter: f64) -> Jet {
        let (s, [a, b, c, d]) = (parameter - self.start, self.powers);
        Jet {
            position: a + (b + (c + d * s) * s) * s,
            first: self.first(parameter),
            second: c * 2.0 + d * (6.0 * s),
        }
    }
}

/// Position and derivatives at a point of a path.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Jet {
    /// (x, z), metres.
    pub position: DVec2,
    /// Derivative by the parameter, metres.
    pub first: DVec2,
    /// Second derivative by the parameter, metres.
    pub second: DVec2,
}

impl Jet {
    /// Returns the curvature, 1/m, positive to the left (about +Y); 0 where the speed is 0.
    #[must_use]
    pub fn curvature(&self) -> f64 {
        let speed = self.first.length();
        let turn = self.first.y * self.second.x - self.first.x * self.second.y;
        let curvature = turn / (speed * speed * speed);
        if curvature.is_finite() { curvature } else { 0.0 }
    }
}

impl GroundSpline {
    /// Returns the path of these control points with uniform knots.
    ///
    /// # Errors
    /// [`PathEditError`] for fewer than [`MIN_POINTS`] or more than [`MAX_POINTS`] points, and for
    /// a point that is not finite or farther from the origin than [`MAX_DISTANCE_M`].
    pub fn uniform(points: Vec<DVec2>) -> Result<Self, PathEditError> {
        let knots = uniform_knots(points.len());
        Self::with_knots(points, &knots)
    }

    /// Returns the path of these control points with these inner knots: four fewer than points,
    /// strictly increasing between 0 and 1.
    ///
    /// # Errors
    /// The same as for [`Self::uniform`], and for knots that do not fit or are too close to each
    /// other.
    pub fn with_knots(points: Vec<DVec2>, inner_knots: &[f64]) -> Result<Self, PathEditError> {
        check_count(points.len())?;
        if let Some(index) = points.iter().position(|point| !is_place(*point)) {
            return Err(PathEditError::Point { index });
        }
        let knots = all_knots(inner_knots, SplineEnds::Clamped);
        let apart = knots[DEGREE..knots.len() - DEGREE]
            .windows(2)
            .all(|pair| pair[1] - pair[0] >= MIN_SPAN);
        if knots.len() != points.len() + DEGREE + 1 || !apart {
            return Err(PathEditError::Knots);
        }
        Ok(Self::of(points, knots, false))
    }

    fn of(points: Vec<DVec2>, knots: Vec<f64>, closed: bool) -> Self {
        let pieces = (DEGREE..points.len()).map(|span| Piece::new(&points, &knots, span)).collect();
        Self { points, knots, closed, pieces }
    }

    /// Returns the control points, (x, z) in metres.
    #[must_use]
    pub fn points(&self) -> &[DVec2] {
        &self.points
    }

    /// Returns the knots between the two ends.
    #[must_use]
    pub fn inner_knots(&self) -> &[f64] {
        &self.knots[DEGREE + 1..self.points.len()]
    }

    /// Returns whether the path ends at its start.
    #[must_use]
    pub fn is_closed(&self) -> bool {
        self.closed
    }

    /// Returns the path with the same knots and other points; a closed path stays closed.
    pub(super) fn with_points(&self, points: Vec<DVec2>) -> Result<Self, PathEditError> {
        let spline = Self::with_knots(points, self.inner_knots())?;
        Ok(match self.ends() {
            SplineEnds::Clamped if self.closed => spline.joined(),
            SplineEnds::Clamped => spline,
            SplineEnds::Uniform => Self::of(spline.points, self.knots.clone(), false),
        })
    }

    /// Returns the form of the control points.
    #[must_use]
    pub fn ends(&self) -> SplineEnds {
        if self.knots[0] < self.knots[DEGREE] { SplineEnds::Uniform } else { SplineEnds::Clamped }
    }

    /// Returns the same curve in another form; a closed path is always clamped. Exact except for
    /// rounding.
    #[must_use]
    pub fn with_ends(&self, ends: SplineEnds) -> Self {
        if self.closed || ends == self.ends() {
            return self.clone();
        }
        let knots = all_knots(self.inner_knots(), ends);
        let points = (0..self.points.len()).map(|i| {
            // The polar form is the same on every piece that depends on the control point.
            self.pieces[i.saturating_sub(DEGREE)].blossom([
                knots[i + 1],
                knots[i + 2],
                knots[i + 3],
            ])
        });
        Self::of(points.collect(), knots, false)
    }

    /// Returns the path of unclamped control points.
    pub(super) fn unclamped(
        points: Vec<DVec2>,
        inner_knots: &[f64],
    ) -> Result<Self, PathEditError> {
        let checked = Self::with_knots(points, inner_knots)?;
        Ok(Self::of(checked.points, all_knots(inner_knots, SplineEnds::Uniform), false))
    }

    /// Returns the path with both ends moved to the point between their neighbours at which the
    /// derivative of the closed path is continuous.
    pub(super) fn joined(mut self) -> Self {
        let last = self.points.len() - 1;
        let [first_span, last_span] = self.end_spans();
        let end = (self.points[last - 1] * first_span + self.points[1] * last_span)
            / (first_span + last_span);
        (self.points[0], self.points[last]) = (end, end);
        Self::of(self.points, self.knots, true)
    }

    /// Returns the lengths of the first and the last piece in the parameter.
    pub(super) fn end_spans(&self) -> [f64; 2] {
        let inner = self.inner_knots();
        [inner.first().copied().unwrap_or(1.0), 1.0 - inner.last().copied().unwrap_or(0.0)]
    }

    /// Returns the Greville abscissa of each control point: the mean of its three knots. A path
    /// whose points are these numbers is the parameter itself.
    #[must_use]
    pub fn greville(&self) -> Vec<f64> {
        let mean = |i: usize| (self.knots[i + 1] + self.knots[i + 2] + self.knots[i + 3]) / 3.0;
        (0..self.points.len()).map(mean).collect()
    }

    /// Returns the ends of the polynomial pieces, from 0 to 1.
    pub(super) fn breaks(&self) -> &[f64] {
        &self.knots[DEGREE..=self.points.len()]
    }

    /// Returns position and derivatives at `parameter`, which is clamped to the path.
    #[must_use]
    pub fn jet(&self, parameter: f64) -> Jet {
        let u = unit(parameter);
        let jet = self.piece(u).jet(u);
        match self.points.last() {
            // The path ends exactly in its last point, without rounding.
            Some(&position) if u == 1.0 && self.ends() == SplineEnds::Clamped => {
                Jet { position, ..jet }
            }
            _ => jet,
        }
    }

    /// Returns the piece that holds a parameter from 0 to 1.
    pub(super) fn piece(&self, parameter: f64) -> &Piece {
        &self.pieces[self.inner_knots().partition_point(|&knot| knot <= parameter)]
    }

    /// Returns the position at `parameter`, (x, z) in metres.
    #[must_use]
    pub fn position(&self, parameter: f64) -> DVec2 {
        self.jet(parameter).position
    }

    /// Returns the index of the first of the four control points on which the path depends at
    /// `parameter`, and their shares.
    pub(super) fn shares(&self, parameter: f64) -> (usize, [f64; 4]) {
        let (span, u) = self.span(parameter);
        (span - DEGREE, basis(&self.knots[span + 1 - DEGREE..=span + DEGREE], u))
    }

    /// Returns the direction of the path at `parameter`, radians about +Y, 0 along +Z. Where the
    /// speed is 0 (coinciding control points) it is the direction of the following part of the
    /// path, at its end that of the part before; 0 for a path without length.
    #[must_use]
    pub fn heading(&self, parameter: f64) -> f64 {
        self.heading_of(parameter, &self.jet(parameter))
    }

    pub(super) fn heading_of(&self, parameter: f64, jet: &Jet) -> f64 {
        let moves = |first: DVec2| first.length_squared() > MIN_SPEED * MIN_SPEED;
        let mut first = jet.first;
        for step in [1e-4, -1e-4, 1e-2, -1e-2] {
            if moves(first) {
                break;
            }
            first = self.jet(parameter + step).first;
        }
        if moves(first) { libm::atan2(first.x, first.y) } else { 0.0 }
    }

    /// Returns the same curve with a further control point and a knot at `parameter` (Boehm 1980).
    pub(super) fn refined(&self, parameter: f64) -> Result<Self, PathEditError> {
        check_count(self.points.len() + 1)?;
        let (span, u) = self.span(parameter);
        let near = u - self.knots[span] < MIN_INSERT || self.knots[span + 1] - u < MIN_INSERT;
        // NaN passes this comparison.
        if near || !parameter.is_finite() {
            return Err(PathEditError::Knots);
        }
        let mut points = self.points[..=span - DEGREE].to_vec();
        for i in span - DEGREE + 1..=span {
            let share = (u - self.knots[i]) / (self.knots[i + DEGREE] - self.knots[i]);
            points.push(self.points[i - 1].lerp(self.points[i], share));
        }
        points.extend_from_slice(&self.points[span..]);
        let mut knots = self.knots.clone();
        knots.insert(span + 1, u);
        Ok(Self::of(points, knots, self.closed))
    }

    /// Returns the index of the last knot at or below `parameter`, which is clamped to the path; at
    /// the end, that of the last piece.
    fn span(&self, parameter: f64) -> (usize, f64) {
        let u = unit(parameter);
        let inner = self.inner_knots().partition_point(|&knot| knot <= u);
        (inner + DEGREE, u)
    }
}

/// Returns the evenly spaced inner knots of a path of `points` control points.
pub(super) fn uniform_knots(points: usize) -> Vec<f64> {
    let pieces = points.saturating_sub(DEGREE);
    (1..pieces).map(|k| k as f64 / pieces as f64).collect()
}

/// Returns the inner knots with four knots before and four after them: at 0 and 1, or continuing
/// evenly.
fn all_knots(inner: &[f64], ends: SplineEnds) -> Vec<f64> {
    let (first, last) = match ends {
        SplineEnds::Clamped => (0.0, 0.0),
        SplineEnds::Uniform => {
            (inner.first().copied().unwrap_or(1.0), 1.0 - inner.last().copied().unwrap_or(0.0))
        }
    };
    let before = (0..=DEGREE).rev().map(|k| -first * k as f64);
    let behind = (0..=DEGREE).map(|k| 1.0 + last * k as f64);
    before.chain(inner.iter().copied()).chain(behind).collect()
}

/// Returns a parameter clamped to `[0, 1]`; 0 for NaN.
pub(super) fn unit(parameter: f64) -> f64 {
    if parameter > 0.0 { parameter.min(1.0) } else { 0.0 }
}

fn is_place(point: DVec2) -> bool {
    let near = -MAX_DISTANCE_M..=MAX_DISTANCE_M;
    near.contains(&point.x) && near.contains(&point.y)
}

pub(super) fn check_count(points: usize) -> Result<(), PathEditError> {
    if (MIN_POINTS..=MAX_POINTS).contains(&points) {
        Ok(())
    } else {
        Err(PathEditError::ControlPoints { points })
    }
}

/// Returns the corners of the bounding box of points; zero for none.
pub(super) fn bounds(points: &[DVec2]) -> (DVec2, DVec2) {
    let first = points.first().copied().unwrap_or_default();
    points.iter().fold((first, first), |(low, high), &p| (low.min(p), high.max(p)))
}

/// Returns the quadratic shares at u in `[t2, t3]`.
fn quadratic(t: &[f64], u: f64) -> [f64; 3] {
    let share = |from: f64, to: f64| (u - from) / (to - from);
    let upper = share(t[2], t[3]);
    let (left, right) = (share(t[1], t[3]), share(t[2], t[4]));
    [(1.0 - upper) * (1.0 - left), (1.0 - upper) * left + upper * (1.0 - right), upper * right]
}

/// Returns the cubic shares at u in `[t2, t3]`: the recurrence of Cox and de Boor. `t` are three
/// knots up to the start of the piece and three from its end on.
fn basis(t: &[f64], u: f64) -> [f64; 4] {
    let share = |from: f64, to: f64| (u - from) / (to - from);
    let [a, b, c] = quadratic(t, u);
    let (left, middle, right) = (share(t[0], t[3]), share(t[1], t[4]), share(t[2], t[5]));
    [a * (1.0 - left), a * left + b * (1.0 - middle), b * middle + c * (1.0 - right), c * right]
}
