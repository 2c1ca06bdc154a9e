use super::align::{Alignment, PairMoments, ground_mean};
use super::points::checked_sum;
use super::{DistanceGrid, RegistrationError};
use crate::clip::Clip;
use glam::{DVec2, DVec3};
use std::ops::Range;

/// How far a computation in slices has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Progress {
    /// Rows done.
    pub done: usize,
    /// Rows in all.
    pub total: usize,
}

impl Progress {
    /// Nothing is left to do.
    #[must_use]
    pub fn is_complete(&self) -> bool {
        self.done >= self.total
    }
}

/// Every `stride`-th frame of a part of a clip, as points about their mean, joint-major so that loops over frames are contiguous.
#[derive(Clone, Debug)]
struct Track {
    start: usize,
    /// Frames of the clip that the part has, sampled or not.
    span: usize,
    samples: usize,
    centre: DVec3,
    x: Vec<f64>,
    y: Vec<f64>,
    z: Vec<f64>,
    /// Prefix sums over samples, `samples + 1` long: Σw·x and Σw·z of a frame.
    mean: Vec<DVec2>,
    /// Likewise of Σw(x² + z²).
    square: Vec<f64>,
}

impl Track {
    fn new(clip: &Clip, frames: Range<usize>, stride: usize, weights: &[f64]) -> Result<Self, RegistrationError> {
        let joints = clip.skeleton().len();
        let samples = frames.len().div_ceil(stride);
        let mut points = Vec::with_capacity(samples * joints);
        let mut world = crate::skeleton::WorldPose::default();
        for frame in frames.clone().step_by(stride) {
            clip.world_pose_into(frame, &mut world);
            points.extend_from_slice(&world.positions);
        }
        if !points.iter().all(|p| p.is_finite()) {
            return Err(RegistrationError::NotFinite);
        }
        let centre = ground_mean(&points);
        let mut track = Self {
            start: frames.start,
            span: frames.len(),
            samples,
            centre,
            x: vec![0.0; points.len()],
            y: vec![0.0; points.len()],
            z: vec![0.0; points.len()],
            mean: vec![DVec2::ZERO; samples + 1],
            square: vec![0.0; samples + 1],
        };
        for (sample, frame) in points.chunks_exact(joints).enumerate() {
            let (mut mean, mut square) = (DVec2::ZERO, 0.0);
            for (joint, (point, &w)) in frame.iter().zip(weights).enumerate() {
                let p = point.as_dvec3() - centre;
                let at = joint * samples + sample;
                (track.x[at], track.y[at], track.z[at]) = (p.x, p.y, p.z);
                mean += w * DVec2::new(p.x, p.z);
                square += w * (p.x * p.x + p.z * p.z);
            }
            track.mean[sample + 1] = track.mean[sample] + mean;
            track.square[sample + 1] = track.square[sample] + square;
        }
        Ok(track)
    }

    /// Samples whose window of `window` frames starts in `starts` (clip frames) and does not cross the end of the part.
    fn starts(&self, starts: &Range<usize>, window: usize, stride: usize) -> Range<usize> {
        let end = starts.end.min((self.start + self.span + 1).saturating_sub(window));
        let first = starts.start.saturating_sub(self.start).div_ceil(stride);
        let last = end.saturating_sub(self.start).div_ceil(stride).min(self.samples);
        first.min(last)..last
    }
}

/// Sums over all pairs of frames of two clips, from which the distance of any two windows of any length follows at once.
///
/// Every term of the window distance (section A) is a sum over the frame pairs on a diagonal of the frame-by-frame matrix. The sums of one frame
/// pair cost O(joints); they are added up along the diagonals once, O(N²J) in all, and a window of any length is then a difference of two
/// entries: O(N²) for a new window length in place of O(N²JK). Frames are sampled every `stride`; a window of K frames uses the samples
/// `i, i + stride, … < i + K`, which is exact at stride 1.
///
/// The work comes in slices: [`advance`](Self::advance) until it is complete.
#[derive(Clone, Debug)]
pub struct PairSums {
    stride: usize,
    weights: Vec<f64>,
    /// Σw of one frame.
    frame_weight: f64,
    source: Track,
    target: Track,
    /// Only pairs with |row - column| ≤ band are summed.
    band: usize,
    done: usize,
    /// Sums along diagonals, (rows + 1) × (columns + 1), row 0 and column 0 are 0: entry (r + 1, c + 1) = entry (r, c) + pair (r, c).
    dot: Vec<f64>,
    cross: Vec<f64>,
    height: Vec<f64>,
}

impl PairSums {
    /// Prepares the comparison of `source_frames` of one clip with `target_frames` of another, every `stride`-th frame of each (at least 1), with
    /// one weight per joint. Ranges are clamped to the clips. Nothing is compared yet: call [`advance`](Self::advance).
    ///
    /// Memory: 24 bytes per pair of samples.
    ///
    /// # Errors
    /// [`RegistrationError`] when a clip or range is empty, the skeletons' sizes differ, the weights do not fit, or a position is not finite.
    pub fn new(
        source: &Clip,
        source_frames: Range<usize>,
        target: &Clip,
        target_frames: Range<usize>,
        weights: &[f64],
        stride: usize,
    ) -> Result<Self, RegistrationError> {
        Self::banded(source, source_frames, target, target_frames, weights, stride, usize::MAX)
    }

    /// Likewise, for pairs with |row - column| ≤ `band` only: what windows that start within `band` samples of both ranges' starts need.
    pub(super) fn banded(
        source: &Clip,
        source_frames: Range<usize>,
        target: &Clip,
        target_frames: Range<usize>,
        weights: &[f64],
        stride: usize,
        band: usize,
    ) -> Result<Self, RegistrationError> {
        let (source_joints, target_joints) = (source.skeleton().len(), target.skeleton().len());
        if source_joints != target_joints {
            return Err(RegistrationError::Skeletons {
                source_joints,
                target_joints,
            });
        }
        let frame_weight = checked_sum(weights, source_joints)?;
        let clamped = |range: Range<usize>, frames: usize| range.start.min(frames)..range.end.min(frames);
        let (source_frames, target_frames) = (clamped(source_frames, source.frames()), clamped(target_frames, target.frames()));
        for (which, frames) in [("outgoing", &source_frames), ("incoming", &target_frames)] {
            if frames.is_empty() {
                return Err(RegistrationError::Empty { which });
            }
        }
        let stride = stride.max(1);
        let source = Track::new(source, source_frames, stride, weights)?;
        let target = Track::new(target, target_frames, stride, weights)?;
        let entries = (source.samples + 1) * (target.samples + 1);
        Ok(Self {
            stride,
            weights: weights.to_vec(),
            frame_weight,
            source,
            target,
            band,
            done: 0,
            dot: vec![0.0; entries],
            cross: vec![0.0; entries],
            height: vec![0.0; entries],
        })
    }

    /// Compares up to `rows` more frames of the source with all frames of the target, and says how far it has come.
    pub fn advance(&mut self, rows: usize) -> Progress {
        for _ in 0..rows.min(self.source.samples - self.done) {
            self.add_row(self.done);
            self.done += 1;
        }
        self.progress()
    }

    /// All rows at once.
    pub fn finish(&mut self) {
        self.advance(usize::MAX);
    }

    /// How far it has come.
    #[must_use]
    pub fn progress(&self) -> Progress {
        Progress {
            done: self.done,
            total: self.source.samples,
        }
    }

    /// Frames from one sample to the next.
    #[must_use]
    pub fn stride(&self) -> usize {
        self.stride
    }

    fn add_row(&mut self, row: usize) {
        let columns = self.target.samples;
        let span = row.saturating_sub(self.band)..row.saturating_add(self.band).saturating_add(1).min(columns);
        if span.is_empty() {
            return;
        }
        let width = columns + 1;
        let [dot, cross, height] = [&mut self.dot, &mut self.cross, &mut self.height].map(|sums| {
            let (above, below) = sums.split_at_mut((row + 1) * width);
            let out = &mut below[span.start + 1..=span.end];
            out.copy_from_slice(&above[row * width..][span.clone()]);
            out
        });
        for (joint, &w) in self.weights.iter().enumerate() {
            if w == 0.0 {
                continue;
            }
            let at = joint * self.source.samples + row;
            let (x, y, z) = (w * self.source.x[at], self.source.y[at], w * self.source.z[at]);
            let tx = &self.target.x[joint * columns..][span.clone()];
            let ty = &self.target.y[joint * columns..][span.clone()];
            let tz = &self.target.z[joint * columns..][span.clone()];
            let sums = dot.iter_mut().zip(cross.iter_mut()).zip(height.iter_mut());
            for (((dot, cross), height), ((&tx, &ty), &tz)) in sums.zip(tx.iter().zip(ty).zip(tz)) {
                *dot += x * tx + z * tz;
                *cross += x * tz - z * tx;
                *height += w * ((y - ty) * (y - ty));
            }
        }
    }

    fn samples_in(&self, window: usize) -> usize {
        (window.max(1) - 1) / self.stride + 1
    }

    fn complete(&self) -> Result<(), RegistrationError> {
        let Progress { done, total } = self.progress();
        if done < total {
            Err(RegistrationError::Unfinished { done, total })
        } else {
            Ok(())
        }
    }

    /// The distances between all windows of `window` frames that start in `sources` and `targets` (frames of the clips; clamped to what was
    /// compared). Windows that would cross an end are left out: the grid may be empty.
    ///
    /// # Errors
    /// [`RegistrationError::Unfinished`] before all rows are compared.
    pub fn distances(&self, window: usize, sources: &Range<usize>, targets: &Range<usize>) -> Result<DistanceGrid, RegistrationError> {
        self.complete()?;
        let window = window.max(1);
        let rows = self.source.starts(sources, window, self.stride);
        let columns = self.target.starts(targets, window, self.stride);
        let samples = self.samples_in(window);
        let weight = self.frame_weight * samples as f64;
        let inverse = weight.recip();
        let target_mean: (Vec<f64>, Vec<f64>) = (columns.clone())
            .map(|c| {
                let sum = self.target.mean[c + samples] - self.target.mean[c];
                (sum.x, sum.y)
            })
            .unzip();
        let target_square: Vec<f64> = (columns.clone().zip(target_mean.0.iter().zip(&target_mean.1)))
            .map(|(c, (x, z))| self.target.square[c + samples] - self.target.square[c] - (x * x + z * z) * inverse)
            .collect();
        let width = self.target.samples + 1;
        let mut rms_m = vec![0.0_f32; rows.len() * columns.len()];
        for (row, out) in rows.clone().zip(rms_m.chunks_exact_mut(columns.len().max(1))) {
            let mean = self.source.mean[row + samples] - self.source.mean[row];
            let square = self.source.square[row + samples] - self.source.square[row] - mean.length_squared() * inverse;
            let (x, z) = (mean.x * inverse, mean.y * inverse);
            let near = row * width + columns.start;
            let far = (row + samples) * width + columns.start + samples;
            let n = out.len();
            let [dot0, cross0, height0] = [&self.dot, &self.cross, &self.height].map(|sums| &sums[near..near + n]);
            let [dot1, cross1, height1] = [&self.dot, &self.cross, &self.height].map(|sums| &sums[far..far + n]);
            let (tx, tz, ts) = (&target_mean.0[..n], &target_mean.1[..n], &target_square[..n]);
            for c in 0..n {
                let a = (cross1[c] - cross0[c]) - (x * tz[c] - tx[c] * z);
                let b = (dot1[c] - dot0[c]) - (x * tx[c] + z * tz[c]);
                let distance = square + ts[c] - 2.0 * (a * a + b * b).sqrt() + (height1[c] - height0[c]);
                // `max` after the division: rounding leaves tiny negative numbers where windows are equal.
                out[c] = ((distance * inverse) as f32).max(0.0).sqrt();
            }
        }
        Ok(DistanceGrid {
            stride: self.stride,
            window,
            source_start: self.source.start + rows.start * self.stride,
            target_start: self.target.start + columns.start * self.stride,
            rows: rows.len(),
            columns: columns.len(),
            rms_m,
        })
    }

    /// The alignment of the windows of `window` frames that start at the samples next to frame `source` and frame `target`.
    ///
    /// # Errors
    /// [`RegistrationError`] before all rows are compared, or when a window crosses the end of what was compared.
    pub fn alignment(&self, source: usize, target: usize, window: usize, fallback_yaw: f64) -> Result<Alignment, RegistrationError> {
        self.complete()?;
        let (row, column) = (
            source.saturating_sub(self.source.start) / self.stride,
            target.saturating_sub(self.target.start) / self.stride,
        );
        let samples = self.samples_in(window);
        for (which, start, track) in [("outgoing", row, &self.source), ("incoming", column, &self.target)] {
            if start + samples > track.samples {
                return Err(RegistrationError::TooShort {
                    which,
                    frames: track.span.saturating_sub(start * self.stride),
                    window,
                });
            }
        }
        let width = self.target.samples + 1;
        let (near, far) = (row * width + column, (row + samples) * width + column + samples);
        PairMoments {
            weight: self.frame_weight * samples as f64,
            source: self.source.mean[row + samples] - self.source.mean[row],
            target: self.target.mean[column + samples] - self.target.mean[column],
            source_square: self.source.square[row + samples] - self.source.square[row],
            target_square: self.target.square[column + samples] - self.target.square[column],
            dot: self.dot[far] - self.dot[near],
            cross: self.cross[far] - self.cross[near],
            height: self.height[far] - self.height[near],
        }
        .alignment(fallback_yaw, self.source.centre, self.target.centre)
    }

    /// What [`distances`](Self::distances) gives, straight from the definition: every window pair summed point by point, O(N²JK). The slow
    /// way that the fast one is tested and timed against.
    ///
    /// # Errors
    /// [`RegistrationError::NotFinite`] when a sum overflows.
    pub fn distances_directly(
        &self,
        window: usize,
        sources: &Range<usize>,
        targets: &Range<usize>,
    ) -> Result<DistanceGrid, RegistrationError> {
        let window = window.max(1);
        let rows = self.source.starts(sources, window, self.stride);
        let columns = self.target.starts(targets, window, self.stride);
        let samples = self.samples_in(window);
        let mut rms_m = Vec::with_capacity(rows.len() * columns.len());
        for row in rows.clone() {
            for column in columns.clone() {
                let mut sums = PairMoments::default();
                for sample in 0..samples {
                    for (joint, &w) in self.weights.iter().enumerate() {
                        let p = joint * self.source.samples + row + sample;
                        let q = joint * self.target.samples + column + sample;
                        let p = DVec3::new(self.source.x[p], self.source.y[p], self.source.z[p]);
                        let q = DVec3::new(self.target.x[q], self.target.y[q], self.target.z[q]);
                        sums.add(w, p, q);
                    }
                }
                rms_m.push(sums.alignment(0.0, DVec3::ZERO, DVec3::ZERO)?.rms_m() as f32);
            }
        }
        Ok(DistanceGrid {
            stride: self.stride,
            window,
            source_start: self.source.start + rows.start * self.stride,
            target_start: self.target.start + columns.start * self.stride,
            rows: rows.len(),
            columns: columns.len(),
            rms_m,
        })
    }
}

#[cfg(test)]
mod tests;
