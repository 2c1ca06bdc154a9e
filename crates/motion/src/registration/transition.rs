//! The search for the best transition between two clips.

use super::{Alignment, PairTerms, Progress, RegistrationError, rms_cm};
use crate::clip::Clip;
use std::ops::Range;
use std::sync::Arc;

/// The part of a clip in which a window may start, as shares of its frames: 0 is the first frame, 1
/// the end.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Region {
    /// The start, 0 to 1.
    pub from: f64,
    /// The end, 0 to 1.
    pub to: f64,
}

impl Region {
    /// The whole clip.
    pub const ALL: Self = Self { from: 0.0, to: 1.0 };
    /// The first half.
    pub const FIRST_HALF: Self = Self { from: 0.0, to: 0.5 };
    /// The second half.
    pub const SECOND_HALF: Self = Self { from: 0.5, to: 1.0 };

    /// Returns the region of a single frame of a clip of `frames`.
    fn frame(frame: usize, frames: usize) -> Self {
        // Half a frame to both sides, so that rounding does not move it to a neighbour.
        let share = |at: f64| at / frames.max(1) as f64;
        Self { from: share(frame as f64 - 0.5), to: share(frame as f64 + 0.5) }
    }

    /// Returns the frames at which a window of `window` frames may start, and whether the region
    /// had to grow to the whole clip because no window that starts in it ends before the clip does.
    /// `None` when the window is longer than the clip.
    fn starts(self, frames: usize, window: usize) -> Option<(Range<usize>, bool)> {
        let end = (frames + 1).checked_sub(window.max(1)).filter(|&end| end > 0)?;
        // `as usize` maps NaN and negative numbers to 0.
        let frame = |share: f64| (share.clamp(0.0, 1.0) * frames as f64).ceil() as usize;
        let region = frame(self.from)..frame(self.to).max(frame(self.from) + 1).min(end);
        Some(if region.is_empty() { (0..end, true) } else { (region, false) })
    }
}

/// Options of the search for a transition.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct SearchOptions {
    /// Number of frames of both windows; 0 counts as 1.
    pub window: usize,
    /// The region in which the outgoing clip may be left.
    pub leave: Region,
    /// The region in which the incoming clip may be entered.
    pub enter: Region,
}

impl SearchOptions {
    /// Returns options that leave in the second half and enter in the first half.
    #[must_use]
    pub fn new(window: usize) -> Self {
        Self { window, leave: Region::SECOND_HALF, enter: Region::FIRST_HALF }
    }

    /// Returns options that leave an outgoing clip of `frames` at `frame`. The window is shortened
    /// to the rest of the clip there, so that exactly this frame is compared.
    #[must_use]
    pub fn leaving_at(self, frame: usize, frames: usize) -> Self {
        let (leave, window) = self.fixed_at(frame, frames);
        Self { window, leave, ..self }
    }

    /// Returns options that enter an incoming clip of `frames` at `frame`; the window is shortened
    /// as in [`leaving_at`](Self::leaving_at).
    #[must_use]
    pub fn entering_at(self, frame: usize, frames: usize) -> Self {
        let (enter, window) = self.fixed_at(frame, frames);
        Self { window, enter, ..self }
    }

    fn fixed_at(&self, frame: usize, frames: usize) -> (Region, usize) {
        let frame = frame.min(frames.saturating_sub(1));
        (Region::frame(frame, frames), self.window.min(frames - frame).max(1))
    }

    /// Returns the frames at which an outgoing clip of `frames` may be left, and whether its region
    /// had to grow.
    pub(super) fn leave_starts(
        &self,
        frames: usize,
    ) -> Result<(Range<usize>, bool), RegistrationError> {
        self.starts(self.leave, "outgoing", frames)
    }

    /// Returns the frames at which an incoming clip of `frames` may be entered, and whether its
    /// region had to grow.
    pub(super) fn enter_starts(
        &self,
        frames: usize,
    ) -> Result<(Range<usize>, bool), RegistrationError> {
        self.starts(self.enter, "incoming", frames)
    }

    fn starts(
        &self,
        region: Region,
        which: &'static str,
        frames: usize,
    ) -> Result<(Range<usize>, bool), RegistrationError> {
        let window = self.window.max(1);
        let starts = region.starts(frames, window);
        starts.ok_or(RegistrationError::TooShort { which, frames, window })
    }
}

/// A transition between two clips: the pair of windows, and their alignment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WindowMatch {
    /// The frame at which the outgoing clip is left: its window is `leave..leave + window`.
    pub leave: usize,
    /// The frame at which the incoming clip is entered: its window is `enter..enter + window`.
    pub enter: usize,
    /// The best alignment of the incoming window with the outgoing one (`outgoing_from_incoming`),
    /// and the remaining distance.
    pub alignment: Alignment,
    /// The root-mean-square distance per point, centimetres on the reference body.
    pub rms_cm: f64,
    /// Whether a clip was too short for the requested region, so that all of it was searched.
    pub grown: bool,
}

/// The number of minima of the coarse matrix that are refined.
const CANDIDATES: usize = 4;

/// The search for the best transition between two clips, with everything cached that does not
/// depend on the window.
///
/// The search goes from coarse to fine. All pairs of windows are compared every
/// `max(⌈fps / 30⌉, ⌈frames / 400⌉)` frames; the four lowest minima of that grid are searched again
/// at the full frame rate, within one stride. The root-mean-square distance of the result is within
/// 5 % or 0.2 cm of the smallest over *all* pairs of frames (tested against them), and is exact for
/// the pair returned if it was refined.
#[derive(Clone, Debug)]
pub struct TransitionSearch {
    outgoing: Arc<Clip>,
    incoming: Arc<Clip>,
    weights: Vec<f64>,
    body_height: f64,
    terms: PairTerms,
}

impl TransitionSearch {
    /// Prepares a search; `weights` has one weight per joint ([`super::limb_weights`]), and
    /// distances are scaled by `body_height` (metres, [`crate::skeleton::Roles::body_height`]).
    ///
    /// # Errors
    /// [`RegistrationError`] when a clip is empty, the skeletons or frame rates differ, or the
    /// number of weights differs from that of the joints.
    pub fn new(
        outgoing: Arc<Clip>,
        incoming: Arc<Clip>,
        weights: &[f64],
        body_height: f64,
    ) -> Result<Self, RegistrationError> {
        let (source_fps, target_fps) = (outgoing.fps(), incoming.fps());
        if (source_fps - target_fps).abs() > 1e-4 * source_fps {
            return Err(RegistrationError::FrameRates { source_fps, target_fps });
        }
        let longest = outgoing.frames().max(incoming.frames());
        let stride = ((source_fps / 30.0).ceil() as usize).max(longest.div_ceil(400)).max(1);
        let terms = PairTerms::new(
            &outgoing,
            0..outgoing.frames(),
            &incoming,
            0..incoming.frames(),
            weights,
            stride,
        )?;
        Ok(Self { outgoing, incoming, weights: weights.to_vec(), body_height, terms })
    }

    /// Compares up to `rows` more rows of the coarse matrix; there are at most about 400.
    pub fn advance(&mut self, rows: usize) -> Progress {
        self.terms.advance(rows)
    }

    /// Returns the coarse terms, for a picture of all distances.
    #[must_use]
    pub fn terms(&self) -> &PairTerms {
        &self.terms
    }

    /// Returns the best transition for these options.
    ///
    /// # Errors
    /// [`RegistrationError::Unfinished`] before the comparison is complete,
    /// [`RegistrationError::TooShort`] when the window does not fit.
    pub fn best(&self, options: &SearchOptions) -> Result<WindowMatch, RegistrationError> {
        let window = options.window.max(1);
        let (leave, leave_grew) = options.leave_starts(self.outgoing.frames())?;
        let (enter, enter_grew) = options.enter_starts(self.incoming.frames())?;
        let grid = self.terms.distances(window, &leave, &enter)?;
        let mut candidates: Vec<(usize, usize)> =
            (grid.local_minima().into_iter().take(CANDIDATES))
                .map(|(r, c)| grid.frames(r, c))
                .collect();
        if candidates.is_empty() {
            // The region lies between two samples of the grid.
            candidates.push((leave.start, enter.start));
        }
        let mut best: Option<(f32, usize, usize)> = None;
        for (i, j) in candidates {
            let found = self.refined(i, j, self.terms.stride(), window, &leave, &enter)?;
            if best.is_none_or(|best| found.0 < best.0) {
                best = Some(found);
            }
        }
        let Some((_, i, j)) = best else {
            return Err(RegistrationError::Empty { which: "outgoing" });
        };
        let alignment = exact(&self.outgoing, i, &self.incoming, j, window, &self.weights)?;
        Ok(WindowMatch {
            leave: i,
            enter: j,
            alignment,
            rms_cm: rms_cm(alignment.distance, alignment.weight, self.body_height),
            grown: leave_grew || enter_grew,
        })
    }

    /// Returns the best pair within `radius` frames of (i, j), in two passes of 17 × 17 pairs each
    /// where the radius is large.
    fn refined(
        &self,
        i: usize,
        j: usize,
        radius: usize,
        window: usize,
        leave: &Range<usize>,
        enter: &Range<usize>,
    ) -> Result<(f32, usize, usize), RegistrationError> {
        let around = |at: usize, region: &Range<usize>| {
            at.saturating_sub(radius).max(region.start)..(at + radius + 1).min(region.end)
        };
        let (rows, columns) = (around(i, leave), around(j, enter));
        let stride = radius.div_ceil(8).max(1);
        let band = rows.len().max(columns.len()).div_ceil(stride);
        let with_window = |starts: &Range<usize>| starts.start..starts.end + window - 1;
        let mut terms = PairTerms::banded(
            &self.outgoing,
            with_window(&rows),
            &self.incoming,
            with_window(&columns),
            &self.weights,
            stride,
            band,
        )?;
        terms.finish();
        let grid = terms.distances(window, &rows, &columns)?;
        let (row, column) = grid.minimum().unwrap_or_default();
        let (i, j) = grid.frames(row, column);
        if stride > 1 {
            return self.refined(i, j, stride, window, leave, enter);
        }
        Ok((grid.get(row, column).unwrap_or(f32::INFINITY), i, j))
    }
}

/// Returns the alignment of two windows at the full frame rate.
fn exact(
    a: &Clip,
    i: usize,
    b: &Clip,
    j: usize,
    window: usize,
    weights: &[f64],
) -> Result<Alignment, RegistrationError> {
    super::align(&a.world_positions(i..i + window), &b.world_positions(j..j + window), weights, 0.0)
}

/// Returns the pair of windows with the smallest distance per point after the best alignment on the
/// ground, and that alignment: the search of [`TransitionSearch`] in one call.
///
/// `weights` has one weight per joint ([`super::limb_weights`]), `body_height` (metres,
/// [`crate::skeleton::Roles::body_height`]) scales the distance to centimetres on the reference
/// body, and `options` give the length of the windows and the regions in which they may start.
///
/// # Errors
/// [`RegistrationError`] when the clips cannot be compared or the window does not fit.
pub fn best_transition(
    outgoing: &Arc<Clip>,
    incoming: &Arc<Clip>,
    weights: &[f64],
    body_height: f64,
    options: &SearchOptions,
) -> Result<WindowMatch, RegistrationError> {
    let mut search =
        TransitionSearch::new(Arc::clone(outgoing), Arc::clone(incoming), weights, body_height)?;
    search.terms.finish();
    search.best(options)
}

#[cfg(test)]
mod tests;
