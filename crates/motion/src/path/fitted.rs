//! A motion and the path fitted to it.

use super::fit::{FitOptions, chord_parameters, extent, fit_spline};
use super::{ArcLengthPath, PathEditError};
use crate::clip::Motion;
use crate::math::{Planar, wrap_angle};
use glam::DVec2;
use std::ops::ControlFlow;
use std::sync::Arc;

/// The standard deviation of the Gaussian that removes the sway of the hips before distances are
/// measured, seconds.
const SWAY_SECS: f64 = 0.3;
/// A motion that stays within this distance counts as standing, metres.
const STANDS_M: f64 = 0.2;
/// The number of frames that a slice of a fit smooths or places: about 3 ms in a browser.
const FRAMES_PER_SLICE: usize = 8_000;

/// A motion, the path that was fitted to its trajectory, and the position of each frame on it.
#[derive(Clone, Debug)]
pub struct FittedPath {
    source: Arc<Motion>,
    curve: ArcLengthPath,
    parameters: Vec<f64>,
    places: Vec<super::Waypoint>,
}

/// The accuracy of a fit.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FitError {
    /// Root of the mean squared distance between root and path, centimetres.
    pub rms_cm: f64,
    /// The largest distance, centimetres.
    pub most_cm: f64,
    /// The frame that is farthest off.
    pub frame: usize,
}

impl FittedPath {
    /// Fits a path to the trajectory of a motion's root over the ground.
    ///
    /// The parameter of a frame is the share of the distance before it, by chord length; sway of
    /// the hips and small steps on the spot do not count as distance, because it is measured on the
    /// trajectory smoothed over about one step. The fit is to the root itself.
    ///
    /// # Errors
    /// [`PathEditError`] for options out of range, fewer than two frames, and a motion that stays
    /// within 20 cm.
    pub fn new(source: Arc<Motion>, options: &FitOptions) -> Result<Self, PathEditError> {
        let mut fitting = PathFitting::new(source, options)?;
        loop {
            match fitting.advance()? {
                ControlFlow::Continue(rest) => fitting = rest,
                ControlFlow::Break(path) => return Ok(path),
            }
        }
    }

    /// Returns the motion.
    #[must_use]
    pub fn source(&self) -> &Arc<Motion> {
        &self.source
    }

    /// Returns the path.
    #[must_use]
    pub fn curve(&self) -> &ArcLengthPath {
        &self.curve
    }

    /// Returns the parameter of each frame on the path; not descending.
    #[must_use]
    pub fn parameters(&self) -> &[f64] {
        &self.parameters
    }

    /// Returns the frame of the path to which each frame of the motion belongs.
    #[must_use]
    pub fn places(&self) -> &[super::Waypoint] {
        &self.places
    }

    /// Returns the residual of every frame, `path_from_character`: metres to the left of the path
    /// (x) and along it (z), and the yaw against its direction.
    pub fn residuals(&self) -> impl Iterator<Item = Planar> + '_ {
        let frames = self.places.iter().zip(self.source.ground_frames());
        frames.map(|(place, character)| place.frame.inverse().after(character))
    }

    /// Returns the distances of the root from the path.
    #[must_use]
    pub fn error(&self) -> FitError {
        let (mut sum, mut most, mut frame) = (0.0, 0.0, 0);
        for (index, residual) in self.residuals().enumerate() {
            let squared = residual.shift.length_squared();
            sum += squared;
            if squared > most {
                (most, frame) = (squared, index);
            }
        }
        FitError {
            rms_cm: (sum / self.parameters.len().max(1) as f64).sqrt() * 100.0,
            most_cm: f64::sqrt(most) * 100.0,
            frame,
        }
    }

    /// Returns the parameter at a fractional frame, clamped to the motion.
    pub(super) fn parameter(&self, frame: f64) -> f64 {
        let (index, part) = self.between(frame);
        let (from, to) =
            (self.parameters[index], self.parameters[(index + 1).min(self.parameters.len() - 1)]);
        from + (to - from) * part
    }

    /// Returns the ground frame at a fractional frame.
    pub(super) fn character(&self, frame: f64) -> Planar {
        let frames = self.source.ground_frames();
        let (index, part) = self.between(frame);
        let (from, to) = (frames[index], frames[(index + 1).min(frames.len() - 1)]);
        let shift = from.shift.lerp(to.shift, part);
        Planar::new(from.yaw + wrap_angle(to.yaw - from.yaw) * part, shift.x, shift.y)
    }

    /// Returns the frame before a fractional one, and the fraction.
    pub(super) fn between(&self, frame: f64) -> (usize, f64) {
        let at = frame.max(0.0).min((self.parameters.len() - 1) as f64);
        (at.floor() as usize, at.fract())
    }
}

/// The fit of a path to a motion in slices, for motions of minutes.
#[derive(Clone, Debug)]
pub struct PathFitting {
    source: Arc<Motion>,
    options: FitOptions,
    /// The trajectory of the root over the ground.
    way: Vec<DVec2>,
    stage: Stage,
}

#[derive(Clone, Debug)]
enum Stage {
    /// The trajectory without sway, as far as it is there.
    Smooth(Smoothing, Vec<DVec2>),
    Fit(Vec<f64>),
    /// The places of frames on the path, as far as they are there.
    Place(Vec<f64>, ArcLengthPath, Vec<super::Waypoint>),
}

impl PathFitting {
    /// Begins a fit; see [`FittedPath::new`].
    ///
    /// # Errors
    /// [`PathEditError`] for options out of range, and fewer than two frames.
    pub fn new(source: Arc<Motion>, options: &FitOptions) -> Result<Self, PathEditError> {
        options.validate()?;
        let way: Vec<DVec2> = source.ground_frames().iter().map(|frame| frame.shift).collect();
        if way.len() != source.clip().frames() {
            return Err(PathEditError::Parameters);
        }
        if way.len() < 2 {
            return Err(PathEditError::Frames { frames: way.len() });
        }
        let smoothing = Smoothing::new(&way, SWAY_SECS * source.clip().fps());
        Ok(Self { source, options: *options, way, stage: Stage::Smooth(smoothing, Vec::new()) })
    }

    /// Does a slice of the work.
    ///
    /// # Errors
    /// [`PathEditError`] for a motion that stays within 20 cm, and values that are not finite.
    pub fn advance(mut self) -> Result<ControlFlow<FittedPath, Self>, PathEditError> {
        let until = |done: usize| (done + FRAMES_PER_SLICE).min(self.way.len());
        self.stage = match self.stage {
            Stage::Smooth(smoothing, mut calm) => {
                calm.extend((calm.len()..until(calm.len())).map(|frame| smoothing.at(frame)));
                if calm.len() < self.way.len() {
                    Stage::Smooth(smoothing, calm)
                } else {
                    let extent_m = extent(&calm);
                    if extent_m < STANDS_M {
                        return Err(PathEditError::NoTravel { extent_m });
                    }
                    Stage::Fit(chord_parameters(&calm).0)
                }
            }
            Stage::Fit(parameters) => {
                let spline = fit_spline(&self.way, &parameters, &self.options)?;
                Stage::Place(parameters, ArcLengthPath::new(spline)?, Vec::new())
            }
            Stage::Place(parameters, curve, mut places) => {
                let next = &parameters[places.len()..until(places.len())];
                places.extend(next.iter().map(|&parameter| curve.at(parameter)));
                if places.len() == parameters.len() {
                    let source = self.source;
                    return Ok(ControlFlow::Break(FittedPath {
                        source,
                        curve,
                        parameters,
                        places,
                    }));
                }
                Stage::Place(parameters, curve, places)
            }
        };
        Ok(ControlFlow::Continue(self))
    }
}

/// A Gaussian mean of a trajectory. Beyond its ends that is continued point-symmetrically, so that
/// the ends stay in place.
#[derive(Clone, Debug)]
struct Smoothing {
    continued: Vec<DVec2>,
    /// The weights of a frame and of those at each distance from it.
    weights: Vec<f64>,
    sum: f64,
}

impl Smoothing {
    /// Prepares the mean of a trajectory that is not empty, with the deviation in frames.
    fn new(way: &[DVec2], deviation: f64) -> Self {
        let (first, last) = (way[0], way[way.len() - 1]);
        let count = way.len() as isize;
        let reach = ((3.0 * deviation).ceil() as isize).min(count - 1);
        let weights: Vec<f64> = (0..=reach)
            .map(|k| libm::exp(-0.5 * (k as f64 / deviation.max(1e-9)).powi(2)))
            .collect();
        let at = |index: isize| {
            if index < 0 {
                first * 2.0 - way[-index as usize]
            } else if index >= count {
                last * 2.0 - way[(2 * (count - 1) - index) as usize]
            } else {
                way[index as usize]
            }
        };
        Self {
            continued: (-reach..count + reach).map(at).collect(),
            sum: 2.0 * weights.iter().sum::<f64>() - 1.0,
            weights,
        }
    }

    /// Returns the mean around a frame.
    fn at(&self, frame: usize) -> DVec2 {
        let reach = self.weights.len() - 1;
        let around = &self.continued[frame..=frame + 2 * reach];
        let (before, here, after) = (&around[..reach], around[reach], &around[reach + 1..]);
        let sides = before.iter().rev().zip(after).zip(&self.weights[1..]);
        (sides.map(|((a, b), weight)| (a + b) * *weight).sum::<DVec2>() + here) / self.sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clip::Clip;
    use crate::synth::{Action, Params, synthesize};

    /// A walk there and back again and again, of more frames than a slice takes.
    fn long_walk() -> Arc<Motion> {
        let walk = synthesize(&Params::new(Action::Walk)).unwrap().clip;
        let there = (0..walk.frames()).chain((0..walk.frames()).rev());
        let poses: Vec<_> = there.cycle().take(FRAMES_PER_SLICE * 2 + 500).collect();
        let poses = poses.into_iter().map(|frame| walk.pose(frame));
        let long = Clip::from_poses("long", Arc::clone(walk.skeleton()), walk.fps(), poses);
        Arc::new(Motion::analyze(Arc::new(long.unwrap())))
    }

    #[test]
    fn slices_of_a_long_motion_give_a_place_to_each_frame() {
        let motion = long_walk();
        let options = FitOptions::default();
        let mut fitting = PathFitting::new(Arc::clone(&motion), &options).unwrap();
        let mut slices = 1;
        let path = loop {
            match fitting.advance().unwrap() {
                ControlFlow::Continue(rest) => fitting = rest,
                ControlFlow::Break(path) => break path,
            }
            slices += 1;
        };
        assert_eq!(slices, 3 + 1 + 3, "smoothed, fitted, placed");
        assert_eq!(path.places().len(), motion.clip().frames());
        let way: Vec<DVec2> = motion.ground_frames().iter().map(|frame| frame.shift).collect();
        let smoothing = Smoothing::new(&way, SWAY_SECS * motion.clip().fps());
        let calm: Vec<DVec2> = (0..way.len()).map(|frame| smoothing.at(frame)).collect();
        let (parameters, _) = chord_parameters(&calm);
        let spline = fit_spline(&way, &parameters, &options).unwrap();
        assert_eq!(path.curve().spline(), &spline);
        let place = |u: &f64| path.curve().at(*u);
        assert_eq!(path.places(), parameters.iter().map(place).collect::<Vec<_>>());
    }

    #[test]
    fn smoothing_keeps_ends_and_straight_lines() {
        let line: Vec<DVec2> = (0..40).map(|i| DVec2::new(f64::from(i), 3.0)).collect();
        let smoothing = Smoothing::new(&line, 5.0);
        for (frame, point) in line.iter().enumerate() {
            assert!(smoothing.at(frame).distance(*point) < 1e-12, "{frame}");
        }
    }
}
