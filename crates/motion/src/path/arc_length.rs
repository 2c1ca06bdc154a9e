//! Paths by arc length.

use super::spline::unit;
use super::{GroundSpline, PathEditError};
use crate::math::Planar;
use glam::DVec2;

/// The least number of parts into which each polynomial piece is divided.
const MIN_PARTS: usize = 8;
/// The tolerance of a part's length against the sum of its halves, metres.
const QUADRATURE_TOLERANCE_M: f64 = 1e-6;
/// The greatest number of bisections of a part. Near the tip of a hairpin the error falls to a
/// quarter with each.
const MAX_HALVINGS: u32 = 24;
/// Gauss-Legendre with five points on `[-1, 1]`: exact up to degree nine.
const NODES: [(f64, f64); 5] = [
    (-0.906_179_845_938_664, 0.236_926_885_056_189_1),
    (-0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
    (0.0, 0.568_888_888_888_888_9),
    (0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
    (0.906_179_845_938_664, 0.236_926_885_056_189_1),
];
/// The least length of a path, metres.
pub(super) const MIN_LENGTH_M: f64 = 1e-3;
/// The tolerance of parameters, as a length, metres.
const TOLERANCE_M: f64 = 1e-11;
/// Lengths that differ by less are equal within rounding, metres.
const SAME_M: f64 = 1e-8;

/// A path with arc length: evaluated by parameter or by distance from its start.
///
/// Lengths are integrals of the speed by adaptive Gauss-Legendre quadrature: at least eight parts
/// of five nodes per piece, bisected until both halves agree with the whole to a micrometre. Only
/// the tip of a hairpin, where the speed nearly vanishes, needs more parts.
#[derive(Clone, Debug, PartialEq)]
pub struct ArcLengthPath {
    spline: GroundSpline,
    /// The end of each part.
    parameters: Vec<f64>,
    /// Distance from the start to these ends, metres.
    lengths: Vec<f64>,
    /// Speed at these ends, metres per unit of the parameter.
    speeds: Vec<f64>,
}

/// The frame of a path at one point, `world_from_path`: +Z runs along the path.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Waypoint {
    /// Position and direction.
    pub frame: Planar,
    /// Curvature, 1/m, positive to the left.
    pub curvature: f64,
    /// Distance from the start of the path, metres; may lie before the start and after the end.
    pub along_m: f64,
}

impl ArcLengthPath {
    /// Measures a path.
    ///
    /// # Errors
    /// [`PathEditError::NoLength`] when it is shorter than a millimetre.
    pub fn new(spline: GroundSpline) -> Result<Self, PathEditError> {
        let speed = |u: f64| spline.jet(u).first.length();
        let (mut parameters, mut lengths, mut speeds) = (vec![0.0], vec![0.0], vec![speed(0.0)]);
        let mut total = 0.0;
        for piece in spline.breaks().windows(2) {
            for part in 0..MIN_PARTS {
                let at = |k: usize| piece[0] + (piece[1] - piece[0]) * k as f64 / MIN_PARTS as f64;
                measure(&spline, at(part), at(part + 1), MAX_HALVINGS, &mut |end, length| {
                    total += length;
                    parameters.push(end);
                    lengths.push(total);
                    speeds.push(speed(end));
                });
            }
        }
        if total < MIN_LENGTH_M {
            return Err(PathEditError::NoLength { length_m: total });
        }
        Ok(Self { spline, parameters, lengths, speeds })
    }

    /// Returns the path.
    #[must_use]
    pub fn spline(&self) -> &GroundSpline {
        &self.spline
    }

    /// Returns its length, metres.
    #[must_use]
    pub fn length_m(&self) -> f64 {
        self.lengths.last().copied().unwrap_or(0.0)
    }

    /// Returns the distance from the start to `parameter`, which is clamped to the path, metres.
    #[must_use]
    pub fn length_at(&self, parameter: f64) -> f64 {
        let u = unit(parameter);
        let part = part_of(&self.parameters, u);
        self.lengths[part] + length_between(&self.spline, self.parameters[part], u)
    }

    /// Returns the parameter at the distance `along_m` from the start, clamped to the path.
    #[must_use]
    pub fn parameter_at(&self, along_m: f64) -> f64 {
        let wanted = along_m.max(0.0).min(self.length_m());
        let part = part_of(&self.lengths, wanted);
        let (from, to) = (self.parameters[part], self.parameters[part + 1]);
        let (low, high) = (self.lengths[part], self.lengths[part + 1]);
        if high <= low {
            return from;
        }
        // Newton's method, safeguarded by bounds: the length is monotonic.
        let (mut left, mut right) = (from, to);
        let mut u = self.guess(part, wanted).clamp(from, to);
        for _ in 0..40 {
            let missing = wanted - low - length_between(&self.spline, from, u);
            if missing.abs() < TOLERANCE_M {
                break;
            }
            if missing > 0.0 {
                left = u;
            } else {
                right = u;
            }
            let next = u + missing / self.spline.jet(u).first.length();
            // If the speed is 0 the step is not finite, and the middle is taken.
            u = if next > left && next < right { next } else { 0.5 * (left + right) };
        }
        u
    }

    /// Returns an estimate of the parameter at a length inside of a part: by the cubic with its
    /// ends and slopes, or linearly where the speed is 0.
    fn guess(&self, part: usize, wanted: f64) -> f64 {
        let (from, to) = (self.parameters[part], self.parameters[part + 1]);
        let length = self.lengths[part + 1] - self.lengths[part];
        let t = (wanted - self.lengths[part]) / length;
        let slopes = [self.speeds[part], self.speeds[part + 1]].map(|speed| length / speed);
        let line = from + (to - from) * t;
        // Beyond three times the mean slope the cubic is not monotonic.
        if slopes.iter().any(|&slope| slope.is_nan() || slope > 3.0 * (to - from)) {
            return line;
        }
        let bow = slopes.map(|slope| slope - (to - from));
        line + t * (1.0 - t) * (bow[0] * (1.0 - t) - bow[1] * t)
    }

    /// Returns the frame of the path at `parameter`, which is clamped to the path.
    #[must_use]
    pub fn at(&self, parameter: f64) -> Waypoint {
        self.waypoint(parameter, self.length_at(parameter))
    }

    /// Returns the frame of the path at the distance `along_m` from its start. Beyond its ends an
    /// open path continues straight and a closed one repeats.
    #[must_use]
    pub fn at_length(&self, along_m: f64) -> Waypoint {
        let length = self.length_m();
        if self.spline.is_closed() && !(0.0..=length).contains(&along_m) {
            return self.waypoint(self.parameter_at(along_m.rem_euclid(length)), along_m);
        }
        let mut waypoint = self.waypoint(self.parameter_at(along_m), along_m);
        let beyond = along_m - along_m.max(0.0).min(length);
        if beyond != 0.0 {
            let yaw = waypoint.frame.yaw;
            waypoint.frame.shift += DVec2::new(libm::sin(yaw), libm::cos(yaw)) * beyond;
            waypoint.curvature = 0.0;
        }
        waypoint
    }

    /// Returns [`Self::at_length`], but the frame at `parameter` if that is at the same distance.
    /// In the tip of a hairpin many parameters lie within any tolerance on the length, and the path
    /// reverses between them.
    pub(super) fn at_length_near(&self, along_m: f64, parameter: f64) -> Waypoint {
        if (self.length_at(parameter) - along_m).abs() < SAME_M {
            self.waypoint(parameter, along_m)
        } else {
            self.at_length(along_m)
        }
    }

    fn waypoint(&self, parameter: f64, along_m: f64) -> Waypoint {
        let jet = self.spline.jet(parameter);
        Waypoint {
            frame: Planar::new(
                self.spline.heading_of(parameter, &jet),
                jet.position.x,
                jet.position.y,
            ),
            curvature: jet.curvature(),
            along_m,
        }
    }

    /// Returns points along the path, evenly spaced by length, for drawing and for fits: `count` of
    /// them, at least two.
    #[must_use]
    pub fn evenly(&self, count: usize) -> Vec<Waypoint> {
        let last = count.max(2) - 1;
        (0..=last)
            .map(|k| {
                let along = self.length_m() * k as f64 / last as f64;
                self.waypoint(self.parameter_at(along), along)
            })
            .collect()
    }
}

/// Returns the part that holds `value`.
fn part_of(ends: &[f64], value: f64) -> usize {
    ends.partition_point(|&end| end <= value).clamp(1, ends.len() - 1) - 1
}

/// Measures `from..to` of one piece and passes the end and the length of each part of it to `add`,
/// in order.
fn measure(
    spline: &GroundSpline,
    from: f64,
    to: f64,
    halvings: u32,
    add: &mut impl FnMut(f64, f64),
) {
    let middle = 0.5 * (from + to);
    let whole = length_between(spline, from, to);
    let halves = length_between(spline, from, middle) + length_between(spline, middle, to);
    if halvings == 0 || (halves - whole).abs() <= QUADRATURE_TOLERANCE_M {
        add(to, whole);
    } else {
        measure(spline, from, middle, halvings - 1, add);
        measure(spline, middle, to, halvings - 1, add);
    }
}

/// Returns the length between two parameters of one piece.
fn length_between(spline: &GroundSpline, from: f64, to: f64) -> f64 {
    let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
    let piece = spline.piece(middle);
    let speed = |node: f64| piece.first(middle + half * node).length();
    NODES.iter().map(|&(node, weight)| weight * speed(node)).sum::<f64>() * half
}

#[cfg(test)]
mod tests;
