//! Terms of pairs of frames, from which the distances of all windows follow.

use super::align::{Alignment, PairMoments};
use super::cloud::{COLUMN_GROUPS, Cloud, GroupSums, LANES, Products, Shares, Spread, multiply};
use super::points::checked_sum;
use super::{DistanceMatrix, PointClouds, RegistrationError, align};
use crate::clip::Clip;
use glam::DVec2;
use std::ops::Range;
use std::sync::Arc;

/// The progress of a computation in slices.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Progress {
    /// Rows done.
    pub done: usize,
    /// Rows in all.
    pub total: usize,
}

impl Progress {
    /// Returns whether nothing is left to do.
    #[must_use]
    pub fn is_complete(&self) -> bool {
        self.done >= self.total
    }
}

/// The greatest number of pairs in memory: 768 MiB of terms.
pub(crate) const MAX_PAIRS: usize = 1 << 26;

/// The strength of a rotation that is within rounding, as a share of the clouds' spread, for `f32`
/// products.
const ROUNDING: f64 = 1e-6;

/// The number of groups of source samples that are multiplied with [`COLUMN_GROUPS`] groups of
/// target samples while these are in the first-level cache.
const GROUPS_AT_ONCE: usize = 4;

/// The terms of all pairs of frames of two clips, from which the distance of any two windows of any
/// length follows.
///
/// Every term of the window distance (D in the [module](super)'s formula) is a sum over the frame
/// pairs on a diagonal of the frame-by-frame matrix. The terms of one pair are products of two
/// point clouds, summed over the joints; for all pairs together they are a matrix product, O(N²J),
/// computed once. A window of any length is then a running sum along the diagonals: O(N²) for a new
/// window length in place of O(N²JK) (Kovar, Gleicher, Pighin 2002, section 3.1). Frames are
/// sampled every `stride`; a window of K frames uses the samples `i, i + stride, … < i + K`, which
/// is exact at stride 1.
///
/// # Accuracy
/// The clouds are multiplied relative to their own centres in `f32`, everything else is `f64`. The
/// error of the mean squared distance per point is less than 4e-7 m² for a body of human size: 0.6
/// mm where windows are nearly equal, 8 µm at 2.5 cm. The distance of equal poses is 0. The bits
/// are the same on every machine.
///
/// # Slices
/// The work is done in slices: call [`advance`](Self::advance) until it is complete. A row of 1,500
/// pairs of 31 joints takes about 15 µs.
#[derive(Clone, Debug)]
pub struct PairTerms {
    stride: usize,
    shares: Shares,
    /// Σw of one frame.
    frame_weight: f64,
    pub(super) source: Arc<Cloud>,
    pub(super) target: Arc<Cloud>,
    /// Only pairs with |row - column| ≤ band are multiplied.
    band: usize,
    /// Whether a clip is compared with itself: only pairs with column ≥ row are multiplied and
    /// stored, in whole groups.
    triangle: bool,
    /// The rows that are compared. They begin with a whole group.
    rows: Range<usize>,
    /// The columns that are compared, in whole groups.
    columns: Range<usize>,
    /// The number of rows in memory, where each takes the place of the one that many rows before.
    /// `None`: all rows are in memory.
    ring_rows: Option<usize>,
    /// The end of the rows that are compared so far.
    done: usize,
    /// Per row: the three [`Products::terms`], each of all columns that are stored.
    terms: Vec<f32>,
    spread: Vec<Spread>,
}

/// One row of terms: dot, cross and height products with every target sample from `first` on.
#[derive(Clone, Copy)]
pub(super) struct TermRow<'a> {
    pub(super) first: usize,
    pub(super) dot: &'a [f32],
    pub(super) cross: &'a [f32],
    pub(super) height: &'a [f32],
}

impl PairTerms {
    /// Prepares the comparison of `source_frames` of one clip with `target_frames` of another,
    /// every `stride`-th frame of each (at least 1), with one weight per joint. Ranges are clamped
    /// to the clips. Nothing is compared yet: call [`advance`](Self::advance).
    ///
    /// Memory: 12 bytes per pair of samples.
    ///
    /// # Errors
    /// [`RegistrationError`] when a clip or range is empty, the skeletons or weights differ in
    /// size, a position is not finite, or there are more than 67 million pairs.
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

    /// Prepares the comparison as [`new`](Self::new) does, for pairs with |row - column| ≤ `band`
    /// only: sufficient for windows that start within `band` samples of both ranges' starts.
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
            return Err(RegistrationError::Skeletons { source_joints, target_joints });
        }
        let frame_weight = checked_sum(weights, source_joints)?;
        let clamped =
            |range: Range<usize>, frames: usize| range.start.min(frames)..range.end.min(frames);
        let (source_frames, target_frames) =
            (clamped(source_frames, source.frames()), clamped(target_frames, target.frames()));
        for (which, frames) in [("outgoing", &source_frames), ("incoming", &target_frames)] {
            if frames.is_empty() {
                return Err(RegistrationError::Empty { which });
            }
        }
        let stride = stride.max(1);
        let pairs = |stride| {
            source_frames
                .len()
                .div_ceil(stride)
                .saturating_mul(target_frames.len().div_ceil(stride))
        };
        check_pairs(pairs(stride), || {
            (pairs(1) as f64 / MAX_PAIRS as f64).sqrt().ceil() as usize + 1
        })?;
        let shares = Shares::new(weights, frame_weight);
        let level = shares.mean_height(source, source_frames.start);
        let clouds = |clip, frames| {
            Ok(PointClouds {
                cloud: Arc::new(Cloud::new(clip, frames, stride, &shares, level)?),
                shares: shares.clone(),
                frame_weight,
                stride,
            })
        };
        let (source, target) = (clouds(source, source_frames)?, clouds(target, target_frames)?);
        Ok(Self::of(&source, &target, band, false, 0..source.samples()))
    }

    /// Returns terms of which none is computed yet. The number of pairs is checked by the caller;
    /// `rows` lie inside the source and begin with a whole group.
    fn of(
        source: &PointClouds,
        target: &PointClouds,
        band: usize,
        triangle: bool,
        rows: Range<usize>,
    ) -> Self {
        let mut terms = Self {
            stride: source.stride,
            shares: source.shares.clone(),
            frame_weight: source.frame_weight,
            band,
            triangle,
            done: rows.start,
            rows,
            columns: 0..target.cloud.groups() * LANES,
            ring_rows: None,
            terms: Vec::new(),
            source: Arc::clone(&source.cloud),
            target: Arc::clone(&target.cloud),
            spread: Vec::new(),
        };
        terms.reserve();
        terms
    }

    /// Reserves the memory of the terms, exactly: grown step by step, it would take twice as much.
    /// It is only reserved, because to clear all of it at once would take longer than a frame of
    /// the screen.
    fn reserve(&mut self) {
        // Whole groups are compared.
        let end = self.rows.end.next_multiple_of(LANES).min(self.source.samples);
        let more = self.length(end).saturating_sub(self.terms.len());
        self.terms.reserve_exact(more);
    }

    /// Returns the number of terms in memory as soon as the rows before `end` are compared.
    fn length(&self, end: usize) -> usize {
        self.ring_rows.map_or_else(|| self.row_start(end), |rows| 3 * self.columns.len() * rows)
    }

    /// Prepares the comparison of two clips whose point clouds are known. Both clouds must have the
    /// same skeleton, weights, stride and level.
    ///
    /// # Errors
    /// [`RegistrationError::TooManyPairs`] when there are more than 67 million pairs.
    pub(crate) fn of_clouds(
        source: &PointClouds,
        target: &PointClouds,
    ) -> Result<Self, RegistrationError> {
        let pairs = source.cloud.samples.saturating_mul(target.cloud.samples);
        check_pairs(pairs, || source.stride * 2)?;
        Ok(Self::of(source, target, usize::MAX, false, 0..source.samples()))
    }

    /// Prepares the comparison of a clip with itself: the pairs with column ≥ row alone.
    pub(super) fn of_itself(of: &PointClouds) -> Result<Self, RegistrationError> {
        let samples = of.cloud.samples;
        check_pairs(samples.saturating_mul(samples + 1) / 2, || of.stride * 2)?;
        Ok(Self::of(of, of, usize::MAX, true, 0..samples))
    }

    /// Prepares the comparison of some of the source's samples with the target: of `rows`, clamped
    /// to the source, and those before them in the same group of four. With `is_itself` both clouds
    /// are those of one clip, and only the pairs with column ≥ row are compared.
    ///
    /// The terms of a pair have the same bits as among all rows.
    ///
    /// # Errors
    /// [`RegistrationError::TooManyPairs`] when there are more than 67 million pairs.
    pub(super) fn of_rows(
        source: &PointClouds,
        target: &PointClouds,
        is_itself: bool,
        rows: &Range<usize>,
    ) -> Result<Self, RegistrationError> {
        let rows = rows.start.min(source.samples()) / LANES * LANES..rows.end.min(source.samples());
        check_pairs(rows.len().saturating_mul(target.samples()), || source.stride * 2)?;
        Ok(Self::of(source, target, usize::MAX, is_itself, rows))
    }

    /// Prepares the comparison of the source's samples `rows` with the target's samples `columns`,
    /// both extended to whole groups. Only the last rows are in memory: those that were asked for
    /// last, and at least `kept` in all.
    pub(super) fn with_ring(
        source: &PointClouds,
        target: &PointClouds,
        rows: &Range<usize>,
        columns: &Range<usize>,
        kept: usize,
    ) -> Self {
        let groups = |of: &Range<usize>, cloud: &Cloud| {
            of.start / LANES * LANES..of.end.div_ceil(LANES).min(cloud.groups()) * LANES
        };
        let compared = groups(rows, &source.cloud);
        let rows = compared.start..compared.end.min(source.samples());
        let none = rows.start..rows.start;
        let mut terms = Self {
            columns: groups(columns, &target.cloud),
            // Whole groups are compared: up to three rows more than are asked for.
            ring_rows: Some((kept + LANES).min(rows.len()).max(1)),
            ..Self::of(source, target, usize::MAX, false, none)
        };
        terms.rows = rows;
        terms.reserve();
        terms
    }

    /// Extends the rows that are compared to those before `end`; the new ones are not compared yet.
    ///
    /// # Errors
    /// [`RegistrationError::TooManyPairs`] when there are more than 67 million pairs.
    pub(super) fn extend_rows(&mut self, end: usize) -> Result<(), RegistrationError> {
        let end = end.min(self.source.samples).max(self.rows.end);
        let pairs = (end - self.rows.start).saturating_mul(self.target.samples);
        check_pairs(pairs, || self.stride * 2)?;
        self.rows.end = end;
        self.reserve();
        Ok(())
    }

    /// Returns the number of bytes of the terms in memory.
    #[must_use]
    pub fn bytes(&self) -> usize {
        size_of::<f32>() * self.terms.capacity()
    }

    /// Compares at least `rows` more frames of the source with all frames of the target (in groups
    /// of four rows), and returns the progress.
    pub fn advance(&mut self, rows: usize) -> Progress {
        let end = self.done.saturating_add(rows).min(self.rows.end).div_ceil(LANES);
        let mut group = self.done / LANES;
        while group < end {
            let groups = group..(group + GROUPS_AT_ONCE).min(end);
            group = groups.end;
            self.multiply(groups);
        }
        self.done = (end * LANES).min(self.source.samples).max(self.done);
        self.progress()
    }

    /// Compares the rows before `end`, as far as they are not compared yet.
    pub(super) fn advance_to(&mut self, end: usize) {
        if self.done < end.min(self.rows.end) {
            self.advance(end - self.done);
        }
    }

    /// Compares all remaining rows.
    pub fn finish(&mut self) {
        self.advance(usize::MAX);
    }

    /// Returns the progress.
    #[must_use]
    pub fn progress(&self) -> Progress {
        let compared = self.done.clamp(self.rows.start, self.rows.end);
        Progress { done: compared - self.rows.start, total: self.rows.len() }
    }

    /// Returns the number of frames between samples.
    #[must_use]
    pub fn stride(&self) -> usize {
        self.stride
    }

    fn multiply(&mut self, groups: Range<usize>) {
        let rows = groups.start * LANES..groups.end * LANES;
        let first_group =
            if self.triangle { groups.start } else { rows.start.saturating_sub(self.band) / LANES };
        let first_group = first_group.max(self.columns.start / LANES);
        let last = rows.end.saturating_add(self.band).div_ceil(LANES).min(self.columns.end / LANES);
        self.terms.resize(self.length(rows.end.min(self.source.samples)), 0.0);
        self.spread.clear();
        for group in groups.clone() {
            self.source.spread(group, &self.shares, &mut self.spread);
        }
        // Rows of groups that are not compared have no place.
        let starts: [[usize; LANES]; GROUPS_AT_ONCE] = std::array::from_fn(|group| {
            std::array::from_fn(|lane| {
                self.row_start((rows.start + group * LANES + lane).min(rows.end - 1))
            })
        });
        let mut products = [Products::default(); GROUPS_AT_ONCE];
        for column in (first_group..last).step_by(COLUMN_GROUPS) {
            let columns: [usize; COLUMN_GROUPS] = std::array::from_fn(|at| column + at);
            // Beyond the end the last group is multiplied once more.
            let points = columns.map(|column| self.target.group(column.min(last - 1)));
            multiply(&self.spread, points, &mut products);
            for ((group, products), starts) in groups.clone().zip(&products).zip(&starts) {
                for (at, &column) in columns.iter().enumerate() {
                    if column < last && column >= self.first_column(group * LANES) / LANES {
                        self.store(group, starts, column, products.terms(at));
                    }
                }
            }
        }
    }

    /// Stores the terms of a group of rows, which begin at `starts`, with a group of columns.
    fn store(
        &mut self,
        group: usize,
        starts: &[usize; LANES],
        column: usize,
        terms: [GroupSums; 3],
    ) {
        let first = self.first_column(group * LANES);
        let width = self.columns.end - first;
        let rows = self.source.samples.saturating_sub(group * LANES);
        for (lane, start) in starts.iter().enumerate().take(rows) {
            let at = start + column * LANES - first;
            for (term, sums) in terms.iter().enumerate() {
                sums[lane].write_to_slice(&mut self.terms[at + term * width..][..LANES]);
            }
        }
    }

    /// Returns the first stored column of a row.
    fn first_column(&self, row: usize) -> usize {
        if self.triangle { row / LANES * LANES } else { self.columns.start }
    }

    /// Returns the offset of a stored row's terms.
    fn row_start(&self, row: usize) -> usize {
        if let Some(rows) = self.ring_rows {
            return 3 * self.columns.len() * (row % rows);
        }
        self.offset(row) - self.offset(self.rows.start)
    }

    /// Returns the offset of a row's terms where all rows are stored.
    fn offset(&self, row: usize) -> usize {
        let (groups, lane) = (row / LANES, row % LANES);
        // Every group of rows is one group of columns shorter than the one above.
        let missing = if self.triangle {
            LANES * LANES * (groups * groups.saturating_sub(1) / 2) + lane * groups * LANES
        } else {
            0
        };
        3 * (row * self.columns.len() - missing)
    }

    pub(super) fn row(&self, row: usize) -> TermRow<'_> {
        let first = self.first_column(row);
        let (start, width) = (self.row_start(row), self.columns.end - first);
        let row = &self.terms[start..start + 3 * width];
        TermRow {
            first,
            dot: &row[..width],
            cross: &row[width..2 * width],
            height: &row[2 * width..],
        }
    }

    /// Returns whether these rows are compared and in memory.
    pub(super) fn holds(&self, rows: &Range<usize>) -> bool {
        let dropped = self.ring_rows.map_or(0, |rows| self.done.saturating_sub(rows));
        rows.start >= self.rows.start.max(dropped) && rows.end <= self.done
    }

    pub(super) fn samples_in(&self, window: usize) -> usize {
        (window.max(1) - 1) / self.stride + 1
    }

    pub(super) fn is_triangle(&self) -> bool {
        self.triangle
    }

    pub(super) fn complete(&self) -> Result<(), RegistrationError> {
        let Progress { done, total } = self.progress();
        if done < total { Err(RegistrationError::Unfinished { done, total }) } else { Ok(()) }
    }

    /// Returns the samples at which the windows of `window` frames start that start in `sources`,
    /// and those that start in `targets` (frames of the clips).
    pub(super) fn starts(
        &self,
        window: usize,
        sources: &Range<usize>,
        targets: &Range<usize>,
    ) -> [Range<usize>; 2] {
        [
            self.source.starts(sources, window, self.stride),
            self.target.starts(targets, window, self.stride),
        ]
    }

    /// Returns the alignment of the windows of `window` frames that start at the samples next to
    /// frame `source` and frame `target`. O(window).
    ///
    /// # Errors
    /// [`RegistrationError`] before the rows of the windows are compared, or when a window crosses
    /// the end of the compared part.
    pub fn alignment(
        &self,
        source: usize,
        target: usize,
        window: usize,
        fallback_yaw: f64,
    ) -> Result<Alignment, RegistrationError> {
        let (row, column) = (
            source.saturating_sub(self.source.start) / self.stride,
            target.saturating_sub(self.target.start) / self.stride,
        );
        let samples = self.samples_in(window);
        for (which, start, cloud) in
            [("outgoing", row, &self.source), ("incoming", column, &self.target)]
        {
            if start.saturating_add(samples) > cloud.samples {
                return Err(RegistrationError::TooShort {
                    which,
                    frames: cloud.span.saturating_sub(start.saturating_mul(self.stride)),
                    window,
                });
            }
        }
        let is_compared = self.columns.contains(&column)
            && self.columns.contains(&(column + samples - 1))
            && (!self.triangle || column >= row)
            && self.holds(&(row..row + samples));
        if !is_compared {
            let Progress { done, total } = self.progress();
            return Err(RegistrationError::Unfinished { done, total });
        }
        let mut sums = PairMoments::default();
        for k in 0..samples {
            let (w, terms) = (self.frame_weight, self.row(row + k));
            let (p, q) = (self.source.centre(row + k), self.target.centre(column + k));
            sums.weight += w;
            sums.source += w * p;
            sums.target += w * q;
            // The squares contain those of heights, which belong to the height term: only their sum
            // matters.
            sums.source_square += w * (self.source.square[row + k] + p.length_squared());
            sums.target_square += w * (self.target.square[column + k] + q.length_squared());
            let at = column + k - terms.first;
            sums.dot += w * (f64::from(terms.dot[at]) + p.dot(q));
            sums.cross += w * (f64::from(terms.cross[at]) + p.perp_dot(q));
            sums.height -= 2.0 * w * f64::from(terms.height[at]);
        }
        sums.alignment(fallback_yaw, self.source.origin, self.target.origin, ROUNDING)
    }
}

impl PairTerms {
    /// Returns the weighted centre on the ground of the target's window of `window` frames next to
    /// frame `target`, metres, as far as it lies inside.
    pub(super) fn target_centre(&self, target: usize, window: usize) -> DVec2 {
        let first =
            (target.saturating_sub(self.target.start) / self.stride).min(self.target.samples - 1);
        let samples = first..(first + self.samples_in(window)).min(self.target.samples);
        let count = samples.len() as f64;
        self.target.origin + samples.map(|sample| self.target.centre(sample)).sum::<DVec2>() / count
    }
}

/// Refuses more than [`MAX_PAIRS`] pairs; `stride` returns one that would fit.
pub(crate) fn check_pairs(
    pairs: usize,
    stride: impl FnOnce() -> usize,
) -> Result<(), RegistrationError> {
    if pairs > MAX_PAIRS {
        return Err(RegistrationError::TooManyPairs { pairs, most: MAX_PAIRS, stride: stride() });
    }
    Ok(())
}

/// Computes [`PairTerms::distances`] by the definition: every pair of windows that start in
/// `sources` and `targets` is aligned point by point, O(N²JK) in `f64`. The slow reference against
/// which the fast method is tested and timed.
///
/// # Errors
/// [`RegistrationError`] when the clips cannot be compared.
pub fn distances_directly(
    (source, sources): (&Clip, Range<usize>),
    (target, targets): (&Clip, Range<usize>),
    weights: &[f64],
    window: usize,
    stride: usize,
) -> Result<DistanceMatrix, RegistrationError> {
    let (window, stride) = (window.max(1), stride.max(1));
    let windows = |clip: &Clip, starts: &Range<usize>| {
        let positions = clip.world_positions(0..clip.frames());
        let joints = clip.skeleton().len();
        let starts = (starts.start..starts.end.min((clip.frames() + 1).saturating_sub(window)))
            .step_by(stride);
        let windows = starts.map(|start| {
            let samples = (start..start + window).step_by(stride);
            samples
                .flat_map(|frame| positions[frame * joints..(frame + 1) * joints].iter().copied())
                .collect()
        });
        windows.collect::<Vec<Vec<glam::Vec3>>>()
    };
    let (source_start, target_start) = (sources.start, targets.start);
    let (sources, targets) = (windows(source, &sources), windows(target, &targets));
    let mut rms_m = Vec::with_capacity(sources.len() * targets.len());
    for source in &sources {
        for target in &targets {
            rms_m.push(align(source, target, weights, 0.0)?.rms_m() as f32);
        }
    }
    Ok(DistanceMatrix {
        stride,
        window,
        source_start,
        target_start,
        rows: sources.len(),
        columns: targets.len(),
        rms_m,
    })
}

/// Returns the product of two centres as in the pair's terms: dot, cross.
pub(super) fn centre_product(p: DVec2, q: DVec2) -> (f64, f64) {
    (p.dot(q), p.perp_dot(q))
}

#[cfg(test)]
mod tests;
