//! Point clouds that are built once and compared with many others.

use super::RegistrationError;
use super::cloud::{Cloud, Shares};
use super::points::checked_sum;
use super::terms::Progress;
use crate::clip::Clip;
use std::ops::Range;
use std::sync::Arc;

/// Every `stride`-th frame of a part of a clip as a cloud of weighted points, built once and
/// compared with many others.
#[derive(Clone, Debug)]
pub(crate) struct PointClouds {
    pub(super) cloud: Arc<Cloud>,
    pub(super) shares: Shares,
    /// Σw of one frame.
    pub(super) frame_weight: f64,
    pub(super) stride: usize,
}

impl PointClouds {
    /// Builds the clouds of `frames` (clamped to the clip), every `stride`-th (at least 1), with
    /// one weight per joint. Heights are relative to `level_m`: about the middle of the body, the
    /// same for all clouds that are compared ([`Self::level_m`]).
    ///
    /// # Errors
    /// [`RegistrationError`] when the part is empty, the number of weights differs from that of the
    /// joints, or a position is not finite.
    pub(crate) fn new(
        clip: &Clip,
        frames: Range<usize>,
        weights: &[f64],
        stride: usize,
        level_m: f64,
    ) -> Result<Self, RegistrationError> {
        PointCloudsBuilder::new(clip, frames, weights, stride, level_m)?.finish(clip)
    }

    /// Returns the weighted mean height of a clip's first frame, metres; 0 for a clip without
    /// frames.
    ///
    /// # Errors
    /// [`RegistrationError::Weights`] when the number of weights differs from that of the joints.
    pub(crate) fn level_m(clip: &Clip, weights: &[f64]) -> Result<f64, RegistrationError> {
        let sum = checked_sum(weights, clip.skeleton().len())?;
        if clip.frames() == 0 {
            return Ok(0.0);
        }
        Ok(Shares::new(weights, sum).mean_height(clip, 0))
    }

    /// Returns the number of samples.
    #[must_use]
    pub(crate) fn samples(&self) -> usize {
        self.cloud.samples
    }
}

/// The construction of [`PointClouds`] in slices. It does not hold the clip: every call must be
/// given the same one.
#[derive(Clone, Debug)]
pub(crate) struct PointCloudsBuilder {
    cloud: Cloud,
    shares: Shares,
    frame_weight: f64,
    stride: usize,
    level_m: f64,
}

impl PointCloudsBuilder {
    /// Begins the construction of clouds as in [`PointClouds::new`]; no points are known yet.
    ///
    /// # Errors
    /// [`RegistrationError`] when the part is empty, or the number of weights differs from that of
    /// the joints.
    pub(crate) fn new(
        clip: &Clip,
        frames: Range<usize>,
        weights: &[f64],
        stride: usize,
        level_m: f64,
    ) -> Result<Self, RegistrationError> {
        let frame_weight = checked_sum(weights, clip.skeleton().len())?;
        let frames = frames.start.min(clip.frames())..frames.end.min(clip.frames());
        if frames.is_empty() {
            return Err(RegistrationError::Empty { which: "outgoing" });
        }
        let (stride, shares) = (stride.max(1), Shares::new(weights, frame_weight));
        Ok(Self {
            cloud: Cloud::reserved(frames, stride, &shares),
            shares,
            frame_weight,
            stride,
            level_m,
        })
    }

    /// Returns the number of samples whose points are known.
    #[must_use]
    pub(crate) fn done(&self) -> usize {
        self.cloud.done()
    }

    /// Computes the points of at least `samples` more samples (in groups of four), and returns the
    /// progress.
    ///
    /// # Errors
    /// [`RegistrationError::NotFinite`].
    pub(crate) fn advance(
        &mut self,
        clip: &Clip,
        samples: usize,
    ) -> Result<Progress, RegistrationError> {
        self.cloud.advance(clip, self.stride, &self.shares, self.level_m, samples)?;
        Ok(Progress { done: self.cloud.done(), total: self.cloud.samples })
    }

    /// Computes the remaining points and returns the clouds.
    ///
    /// # Errors
    /// [`RegistrationError::NotFinite`].
    pub(crate) fn finish(mut self, clip: &Clip) -> Result<PointClouds, RegistrationError> {
        self.advance(clip, usize::MAX)?;
        Ok(PointClouds {
            cloud: Arc::new(self.cloud),
            shares: self.shares,
            frame_weight: self.frame_weight,
            stride: self.stride,
        })
    }
}
