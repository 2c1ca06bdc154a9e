//! Distances between all windows of a set of clips.

use super::cells::{Histogram, row_start};
use super::{DistanceTile, FrameSet, Place};
use crate::registration::{DistanceMatrix, ROWS_PER_SUM, SymmetricDistances};
use std::ops::Range;
use std::sync::Arc;

/// The distances between all windows of one length of a set.
#[derive(Clone, Debug)]
pub struct FrameDistances {
    pub(super) set: Arc<FrameSet>,
    pub(super) window: usize,
    pub(super) blocks: Vec<BlockDistances>,
}

impl PartialEq for FrameDistances {
    fn eq(&self, other: &Self) -> bool {
        let same = |(one, other): (&BlockDistances, &BlockDistances)| {
            let rows = 0..one.size().0;
            one.size() == other.size() && rows.into_iter().all(|row| one.row(row) == other.row(row))
        };
        (self.window, self.blocks.len()) == (other.window, other.blocks.len())
            && self.set == other.set
            && self.blocks.iter().zip(&other.blocks).all(same)
    }
}

/// The distances of one pair of clips.
#[derive(Clone, Debug)]
pub(super) enum BlockDistances {
    Itself(SymmetricDistances),
    Pair(DistanceMatrix),
    Tiled(TiledDistances),
}

/// Distances that were computed as tiles.
#[derive(Clone, Debug, Default)]
pub(super) struct TiledDistances {
    is_itself: bool,
    rows: usize,
    columns: usize,
    /// [`ROWS_PER_SUM`] rows each.
    tiles: Vec<Vec<f32>>,
}

impl TiledDistances {
    fn row(&self, row: usize) -> &[f32] {
        if row >= self.rows {
            return &[];
        }
        let first = row / ROWS_PER_SUM * ROWS_PER_SUM;
        let [own, next] =
            [row, row + 1].map(|row| row_start(self.is_itself, self.columns, first, row));
        let tile = self.tiles.get(row / ROWS_PER_SUM);
        tile.and_then(|tile| tile.get(own..next)).unwrap_or_default()
    }
}

impl BlockDistances {
    /// Returns (rows, columns).
    pub(super) fn size(&self) -> (usize, usize) {
        match self {
            Self::Itself(distances) => (distances.rows(), distances.rows()),
            Self::Pair(distances) => (distances.rows(), distances.columns()),
            Self::Tiled(distances) => (distances.rows, distances.columns),
        }
    }

    /// Returns whether a clip is compared with itself.
    fn is_itself(&self) -> bool {
        match self {
            Self::Itself(_) => true,
            Self::Pair(_) => false,
            Self::Tiled(distances) => distances.is_itself,
        }
    }

    pub(super) fn get(&self, row: usize, column: usize) -> Option<f32> {
        match self {
            Self::Itself(distances) => distances.get(row, column),
            Self::Pair(distances) => distances.get(row, column),
            Self::Tiled(distances) if distances.is_itself => {
                distances.row(row.min(column)).get(row.abs_diff(column)).copied()
            }
            Self::Tiled(distances) => distances.row(row).get(column).copied(),
        }
    }

    /// Returns the stored part of a row: its first column, and the distances.
    pub(super) fn row(&self, row: usize) -> (usize, &[f32]) {
        match self {
            Self::Itself(distances) => (row, distances.row(row)),
            Self::Pair(distances) => (0, distances.row(row)),
            Self::Tiled(distances) => {
                (if distances.is_itself { row } else { 0 }, distances.row(row))
            }
        }
    }
}

/// The position up to which a histogram is counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CountedTo {
    block: usize,
    row: usize,
}

impl FrameDistances {
    /// Returns the distances that were computed as the tiles of [`DistanceTile::all`], which may
    /// come in any order; missing ones have no distances.
    #[must_use]
    pub fn of_tiles(
        set: &Arc<FrameSet>,
        window: usize,
        tiles: impl IntoIterator<Item = (DistanceTile, Vec<f32>)>,
    ) -> Self {
        let (window, clips) = (window.max(1), set.clips().len());
        let windows = |clip: usize| (set.frames_of(clip) + 1).saturating_sub(window);
        let mut blocks: Vec<TiledDistances> = (0..clips)
            .flat_map(|a| (a..clips).map(move |b| (a, b)))
            .map(|(a, b)| TiledDistances {
                is_itself: a == b,
                rows: windows(a),
                columns: windows(b),
                tiles: vec![Vec::new(); windows(a).div_ceil(ROWS_PER_SUM)],
            })
            .collect();
        for (DistanceTile { a, b, rows }, distances) in tiles {
            let block = if b < clips { blocks.get_mut(block_of(clips, a, b)) } else { None };
            let place = block.and_then(|block| block.tiles.get_mut(rows.start / ROWS_PER_SUM));
            if let Some(place) = place {
                *place = distances;
            }
        }
        let blocks = blocks.into_iter().map(BlockDistances::Tiled).collect();
        Self { set: Arc::clone(set), window, blocks }
    }

    /// Returns the frames that are compared.
    #[must_use]
    pub fn set(&self) -> &Arc<FrameSet> {
        &self.set
    }

    /// Returns the number of frames of each window.
    #[must_use]
    pub fn window(&self) -> usize {
        self.window
    }

    /// Returns the distance of the windows that start at two frames, centimetres; `None` where a
    /// window crosses the end of its clip.
    #[must_use]
    pub fn cm(&self, a: Place, b: Place) -> Option<f64> {
        let (a, b) = (a.min(b), a.max(b));
        let block = self.block(a.clip, b.clip)?;
        Some(self.set.rounded_cm(block.get(a.frame, b.frame)?))
    }

    /// Returns the distances of clips a ≤ b.
    pub(super) fn block(&self, a: usize, b: usize) -> Option<&BlockDistances> {
        let clips = self.set.clips().len();
        if b >= clips {
            return None;
        }
        self.blocks.get(block_of(clips, a, b))
    }

    /// Returns a picture of a part of the matrix: `rows` and `columns` are frames of the set, every
    /// value is the mean distance (centimetres) of a square of `factor` × `factor` of them, of
    /// which at most 4 × 4 are sampled, row-major; NaN where no window starts.
    #[must_use]
    pub fn picture(&self, rows: Range<usize>, columns: Range<usize>, factor: usize) -> Vec<f32> {
        let factor = factor.max(1);
        let frames = self.set.frames();
        let within = |of: Range<usize>| of.start.min(frames)..of.end.min(frames);
        let (rows, columns) = (within(rows), within(columns));
        let (height, width) = (rows.len().div_ceil(factor), columns.len().div_ceil(factor));
        // Equal ranges give a symmetric picture: only squares on and above the diagonal are read.
        let is_symmetric = rows == columns;
        let row_samples = self.samples(rows, factor);
        let column_samples = self.samples(columns, factor);
        // Each sum, with the number of its values.
        let mut sums = vec![(0.0_f32, 0); height * width];
        let mut add = |square_row: usize, square_column: usize, found: Option<&f32>| {
            let sum = sums.get_mut(square_row * width + square_column);
            if let (Some((sum, count)), Some(found)) = (sum, found) {
                *sum += found;
                *count += 1;
            }
        };
        // Read row by row, as stored: along a column, nearly every cell would be a cache miss.
        for (a, rows) in row_samples.iter().enumerate() {
            for (b, columns) in column_samples.iter().enumerate() {
                let Some(block) = self.block(a.min(b), a.max(b)) else { continue };
                if a <= b {
                    for &(square_row, row) in rows {
                        let (first, cells) = block.row(row);
                        for &(square_column, column) in columns {
                            let at = column.checked_sub(first);
                            add(square_row, square_column, at.and_then(|at| cells.get(at)));
                        }
                    }
                }
                if a >= b {
                    for &(square_column, column) in columns {
                        let (first, cells) = block.row(column);
                        for &(square_row, row) in rows {
                            // Of a clip with itself, what lies below the diagonal is left.
                            let is_left = (a > b || row > column)
                                && (!is_symmetric || square_row == square_column);
                            let at = row.checked_sub(first).filter(|_| is_left);
                            add(square_row, square_column, at.and_then(|at| cells.get(at)));
                        }
                    }
                }
            }
        }
        if is_symmetric {
            for row in 0..height {
                for column in 0..row {
                    sums[row * width + column] = sums[column * width + row];
                }
            }
        }
        let scale = self.set.cm_per_m() as f32;
        sums.into_iter().map(|(sum, count)| sum / count as f32 * scale).collect()
    }

    /// Returns what a picture samples of each clip: (square, frame of the clip), at most 4 frames
    /// of a square, in their order.
    fn samples(&self, of: Range<usize>, factor: usize) -> Vec<Vec<(usize, usize)>> {
        let mut samples = vec![Vec::new(); self.set.clips().len()];
        for (square, first) in of.clone().step_by(factor).enumerate() {
            let frames = (first..(first + factor).min(of.end)).step_by(factor.div_ceil(4));
            for place in frames.filter_map(|frame| self.set.place(frame)) {
                samples[place.clip].push((square, place.frame));
            }
        }
        samples
    }

    /// Returns the number of pairs of windows in each of `bins` ranges of `bin_cm` centimetres; the
    /// last range is open. Every pair counts once, a window with itself does not.
    #[must_use]
    pub fn histogram(&self, bin_cm: f64, bins: usize) -> Vec<u32> {
        let mut counts = vec![0_u32; bins.max(1)];
        self.count(&mut CountedTo::default(), usize::MAX, bin_cm, &mut counts);
        counts
    }

    /// Adds about `cells` more pairs of windows, at least one row, from position `at` on, to the
    /// counts of [`Self::histogram`]; returns `true` after the last.
    pub fn count(&self, at: &mut CountedTo, cells: usize, bin_cm: f64, counts: &mut [u32]) -> bool {
        let mut histogram = Histogram::new(self.set.cm_per_m(), bin_cm, counts.len());
        let mut left = cells.max(1);
        while left > 0 && at.block < self.blocks.len() {
            let Some(block) = self.blocks.get(at.block) else {
                break;
            };
            let (rows, columns) = block.size();
            let end = (at.row + left.div_ceil(columns.max(1))).min(rows);
            count_rows(block, at.row..end, &mut histogram);
            left = left.saturating_sub((end - at.row) * columns);
            *at = if end < rows {
                CountedTo { row: end, ..*at }
            } else {
                CountedTo { block: at.block + 1, row: 0 }
            };
        }
        histogram.add_to(counts);
        at.block >= self.blocks.len()
    }
}

/// Counts the distances of some rows of a block.
fn count_rows(block: &BlockDistances, rows: Range<usize>, histogram: &mut Histogram) {
    for row in rows {
        let (_, distances) = block.row(row);
        let itself = usize::from(block.is_itself());
        histogram.count(distances.get(itself..).unwrap_or_default());
    }
}

/// Returns the index of the block of clips a ≤ b.
pub(super) fn block_of(clips: usize, a: usize, b: usize) -> usize {
    (a * clips + b).saturating_sub(a * (a + 1) / 2)
}
