//! Tiles of the matrix of all distances, each of which is computed by itself.

use super::all_pairs::level_m;
use super::candidates::{Picker, is_minimum};
use super::cells::{Histogram, row_start};
use super::{Candidate, Construction, DistanceOverview, FrameSet, GraphError, GraphOptions, Place};
use crate::registration::{PointClouds, ROWS_PER_SUM, RowTerms};
use serde::{Deserialize, Serialize};
use std::collections::VecDeque;
use std::ops::Range;
use std::sync::Arc;

/// Some rows of the matrix of distances between the windows of two clips a ≤ b.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct DistanceTile {
    /// The clip of the rows.
    pub a: usize,
    /// The clip of the columns.
    pub b: usize,
    /// The windows of the rows, by their first frames. They begin at a fixed multiple.
    pub rows: Range<usize>,
}

impl DistanceTile {
    /// Returns the tiles of the whole matrix of the windows of `window` frames, clip by clip.
    #[must_use]
    pub fn all(set: &FrameSet, window: usize) -> Vec<Self> {
        let clips = set.clips().len();
        let windows = |clip: usize| (set.frames_of(clip) + 1).saturating_sub(window.max(1));
        let mut tiles = Vec::new();
        for (a, b) in (0..clips).flat_map(|a| (a..clips).map(move |b| (a, b))) {
            let rows = if windows(b) == 0 { 0 } else { windows(a) };
            tiles.extend((0..rows).step_by(ROWS_PER_SUM).map(|first| Self {
                a,
                b,
                rows: first..(first + ROWS_PER_SUM).min(rows),
            }));
        }
        tiles
    }

    /// Returns the number of its distances; of a clip with itself, of those on and above the
    /// diagonal.
    #[must_use]
    pub fn cells(&self, set: &FrameSet, window: usize) -> usize {
        let columns = (set.frames_of(self.b) + 1).saturating_sub(window.max(1));
        if self.a < self.b {
            return self.rows.len() * columns;
        }
        self.rows.clone().map(|row| columns.saturating_sub(row)).sum()
    }
}

/// The result of a tile.
#[derive(Clone, Debug, PartialEq)]
pub struct TileDistances {
    /// The distances row by row, metres; of a clip with itself, each row from the diagonal on.
    pub rms_m: Vec<f32>,
    /// The number of pairs of windows in each of [`DistanceOverview::BINS`] ranges; a window with
    /// itself does not count.
    pub counts: Vec<u32>,
    /// The candidates for transitions.
    pub candidates: TileCandidates,
}

/// The candidates of one tile or several.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TileCandidates {
    /// The candidates below the threshold, in any order.
    pub found: Vec<Candidate>,
    /// The smallest distance of any possible transition, metres; `None` without one.
    pub nearest_m: Option<f32>,
    /// The number of candidates that are not kept.
    pub left_out: usize,
}

/// The computation of tiles of one set, in any order. The distances, the histogram and the
/// candidates of all tiles together are those of [`AllPairs`](super::AllPairs), to the last bit.
///
/// It keeps the products of frames, so that the same tile with another window takes a part of the
/// time.
#[derive(Debug)]
pub struct TileComputer {
    set: Arc<FrameSet>,
    level_m: f64,
    /// The points of each clip; computed on demand.
    clouds: Vec<Option<PointClouds>>,
    /// The products of the tiles that were computed last: clips and first row.
    kept: VecDeque<((usize, usize, usize), RowTerms)>,
    max_bytes: usize,
}

impl TileComputer {
    /// Returns the computation, which keeps at most `max_bytes` of products.
    ///
    /// # Errors
    /// [`GraphError::NoClips`].
    pub fn new(set: Arc<FrameSet>, max_bytes: usize) -> Result<Self, GraphError> {
        let clouds = vec![None; set.clips().len()];
        Ok(Self { level_m: level_m(&set)?, set, clouds, kept: VecDeque::new(), max_bytes })
    }

    /// Returns the set.
    #[must_use]
    pub fn set(&self) -> &Arc<FrameSet> {
        &self.set
    }

    /// Computes a tile: the distances of the windows of [`GraphOptions::blend_window`] frames, and
    /// the candidates for the other options.
    ///
    /// # Errors
    /// [`GraphError`] when the options do not fit the set, or a position is not finite.
    pub fn compute(
        &mut self,
        tile: &DistanceTile,
        options: &GraphOptions,
    ) -> Result<TileDistances, GraphError> {
        options.check(&self.set)?;
        let window = options.blend_window;
        let windows = |clip: usize| (self.set.frames_of(clip) + 1).saturating_sub(window);
        let (height, width) = (windows(tile.a), windows(tile.b));
        let rows = tile.rows.start / ROWS_PER_SUM * ROWS_PER_SUM..tile.rows.end.min(height);
        if rows.is_empty() || width == 0 {
            let counts = vec![0; DistanceOverview::BINS];
            return Ok(TileDistances {
                rms_m: Vec::new(),
                counts,
                candidates: TileCandidates::default(),
            });
        }
        // Minima are recognised by their neighbours. The row above the first one would need its
        // whole tile; so its own minima belong to the tile above, which computes two rows more.
        let seen = rows.start..(rows.end + 2).min(height);
        let terms = self.terms(tile.a, tile.b, &(seen.start..seen.end + window - 1))?;
        let view = TileView {
            first: rows.start,
            is_itself: tile.a == tile.b,
            width,
            rms_m: terms.distances(window, &seen)?,
        };
        let mut picker = Picker::new(Arc::clone(&self.set), *options);
        self.pick(&mut picker, tile, &view, &rows, height, &terms)?;
        self.keep((tile.a, tile.b, rows.start), terms);
        let mut rms_m = view.rms_m;
        let end = row_start(view.is_itself, width, view.first, rows.end);
        rms_m.truncate(end);
        let bins = DistanceOverview::BINS;
        let mut histogram = Histogram::new(self.set.cm_per_m(), DistanceOverview::BIN_CM, bins);
        for row in rows {
            let own = row_start(view.is_itself, width, view.first, row);
            let next = row_start(view.is_itself, width, view.first, row + 1);
            let cells = rms_m.get(own + usize::from(view.is_itself)..next).unwrap_or_default();
            histogram.count(cells);
        }
        let mut counts = vec![0; bins];
        histogram.add_to(&mut counts);
        Ok(TileDistances { rms_m, counts, candidates: picker.into_tile() })
    }

    /// Offers the pairs of windows of a tile to the picker.
    fn pick(
        &self,
        picker: &mut Picker,
        tile: &DistanceTile,
        view: &TileView,
        rows: &Range<usize>,
        height: usize,
        terms: &RowTerms,
    ) -> Result<(), GraphError> {
        let DistanceTile { a, b, .. } = *tile;
        let window = picker.options.blend_window;
        let facing = |place: Place| {
            let source = self.set.clip(place.clip);
            let frame = source.and_then(|source| source.ground_frames().get(place.frame));
            frame.map_or(0.0, |frame| frame.yaw)
        };
        let align = |leave: Place, enter: Place| {
            let fallback = facing(leave) - facing(enter);
            Ok(terms.alignment(leave.frame, enter.frame, window, fallback)?.transform)
        };
        let place = |clip, frame| Place { clip, frame };
        if let Construction::Segments { .. } = picker.options.construction {
            for (row, column) in picker.cells(a, b) {
                if let Some(distance) = view.get(row, column).filter(|_| rows.contains(&row)) {
                    picker.offer(place(a, row), place(b, column), distance, || true, align)?;
                }
            }
            return Ok(());
        }
        let first = if rows.start == 0 { 0 } else { rows.start + 1 };
        for row in first..(rows.end + 1).min(height) {
            let (column, cells) = view.row(row);
            let minimum = |at: usize| is_minimum(|r, c| view.get(r, c), row, column + at);
            let places = [place(a, row), place(b, column)];
            picker.offer_minima(places, cells, 0..cells.len(), minimum, align)?;
        }
        Ok(())
    }

    /// Returns the products of the frames `rows` of clip a with all of clip b: those that are kept,
    /// extended where they end too early.
    fn terms(&mut self, a: usize, b: usize, rows: &Range<usize>) -> Result<RowTerms, GraphError> {
        let key = (a, b, rows.start);
        if let Some(at) = self.kept.iter().position(|(known, _)| *known == key)
            && let Some((_, mut terms)) = self.kept.remove(at)
        {
            terms.extend(rows.end)?;
            return Ok(terms);
        }
        for clip in [a, b] {
            let missing = self.clouds.get(clip).is_some_and(Option::is_none);
            if let (true, Some(source)) = (missing, self.set.clip(clip)) {
                let (clip_frames, weights) = (0..source.clip().frames(), self.set.weights());
                let clouds =
                    PointClouds::new(source.clip(), clip_frames, weights, 1, self.level_m)?;
                self.clouds[clip] = Some(clouds);
            }
        }
        let clouds = |clip: usize| self.clouds.get(clip).and_then(Option::as_ref);
        let (Some(source), Some(target)) = (clouds(a), clouds(b)) else {
            return Err(GraphError::NoClips);
        };
        Ok(RowTerms::new(source, target, a == b, rows)?)
    }

    /// Keeps the products of a tile, and drops the oldest ones above the limit.
    fn keep(&mut self, key: (usize, usize, usize), terms: RowTerms) {
        self.kept.push_back((key, terms));
        let mut bytes: usize = self.kept.iter().map(|(_, terms)| terms.bytes()).sum();
        while bytes > self.max_bytes
            && let Some((_, oldest)) = self.kept.pop_front()
        {
            bytes -= oldest.bytes();
        }
    }
}

/// The distances of some rows.
struct TileView {
    first: usize,
    is_itself: bool,
    width: usize,
    rms_m: Vec<f32>,
}

impl TileView {
    fn row(&self, row: usize) -> (usize, &[f32]) {
        let column = if self.is_itself { row } else { 0 };
        let [own, next] =
            [row, row + 1].map(|row| row_start(self.is_itself, self.width, self.first, row));
        (column, self.rms_m.get(own..next).unwrap_or_default())
    }

    fn get(&self, row: usize, column: usize) -> Option<f32> {
        let (row, column) =
            if self.is_itself { (row.min(column), row.max(column)) } else { (row, column) };
        if row < self.first {
            return None;
        }
        let (first, cells) = self.row(row);
        cells.get(column - first).copied()
    }
}
