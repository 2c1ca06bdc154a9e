//! A motion and the path fitted to it.

use super::fit::{FitOptions, chord_parameters, extent, fit_spline};
use super::{ArcLengthPath, PathEditError};
use crate::clip::Motion;
use crate::math::{Planar, wrap_angle};
use glam::DVec2;
use std::sync::Arc;

/// The standard deviation of the Gaussian that removes the sway of the hips before distances are
/// measured, seconds.
const SWAY_SECS: f64 = 0.3;
/// A motion that stays within this distance counts as standing, metres.
const STANDS_M: f64 = 0.2;

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
        options.validate()?;
        let way: Vec<DVec2> = source.ground_frames().iter().map(|frame| frame.shift).collect();
        if way.len() != source.clip().frames() {
            return Err(PathEditError::Parameters);
        }
        if way.len() < 2 {
            return Err(PathEditError::Frames { frames: way.len() });
        }
        let calm = smoothed(&way, SWAY_SECS * source.clip().fps());
        let extent_m = extent(&calm);
        if extent_m < STANDS_M {
            return Err(PathEditError::NoTravel { extent_m });
        }
        let (parameters, _) = chord_parameters(&calm);
        let curve = ArcLengthPath::new(fit_spline(&way, &parameters, options)?)?;
        let places = parameters.iter().map(|&u| curve.at(u)).collect();
        Ok(Self { source, curve, parameters, places })
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

/// Returns a Gaussian mean with the deviation in frames. Beyond its ends the trajectory is
/// continued point-symmetrically, so that the ends stay in place.
fn smoothed(way: &[DVec2], deviation: f64) -> Vec<DVec2> {
    let (Some(&first), Some(&last)) = (way.first(), way.last()) else {
        return vec![];
    };
    let count = way.len() as isize;
    let reach = ((3.0 * deviation).ceil() as isize).min(count - 1);
    let weights: Vec<f64> =
        (0..=reach).map(|k| libm::exp(-0.5 * (k as f64 / deviation.max(1e-9)).powi(2))).collect();
    let sum = 2.0 * weights.iter().sum::<f64>() - 1.0;
    let at = |index: isize| {
        if index < 0 {
            first * 2.0 - way[-index as usize]
        } else if index >= count {
            last * 2.0 - way[(2 * (count - 1) - index) as usize]
        } else {
            way[index as usize]
        }
    };
    let continued: Vec<DVec2> = (-reach..count + reach).map(at).collect();
    let reach = reach as usize;
    let mean = |around: &[DVec2]| {
        let (before, here, after) = (&around[..reach], around[reach], &around[reach + 1..]);
        let sides = before.iter().rev().zip(after).zip(&weights[1..]);
        (sides.map(|((a, b), weight)| (a + b) * *weight).sum::<DVec2>() + here) / sum
    };
    continued.windows(2 * reach + 1).map(mean).collect()
}
