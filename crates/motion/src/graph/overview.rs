//! Coarse pictures of all distances.

use super::cells::{Histogram, smaller, smallest};
use super::parts::{PART, Part, Parts};
use super::{FrameSet, Place, StreamRow};
use crate::blend::align_onto;
use crate::registration::{DistanceMatrix, Progress};
use std::ops::Range;
use std::sync::Arc;

/// The greatest number of cells of an overview to a side: 8 MB.
const MAX_CELLS: usize = 2_000;

/// A coarse picture of all distances of a set: for every square of [`block`](Self::block) × `block`
/// windows the smallest distance, and a histogram of all of them. It replaces the matrix of all
/// distances where that does not fit into memory; a [`CandidateStream`](super::CandidateStream)
/// makes it.
///
/// A [`DistanceDetail`] computes the distances of a part of the matrix on demand.
#[derive(Clone, Debug)]
pub struct DistanceOverview {
    parts: Arc<Parts>,
    block: usize,
    side: usize,
    /// Smallest distances of the blocks (row, column) with row ≤ column, row by row, metres;
    /// infinity where no window starts.
    nearest_m: Vec<f32>,
    /// Counts saturate: 93,000 frames have more pairs than 32 bits can count.
    counts: Vec<u32>,
}

impl DistanceOverview {
    /// Width of a bin of the histogram, centimetres.
    pub const BIN_CM: f64 = 0.5;
    /// Number of bins of the histogram; the last one also counts all larger distances.
    pub const BINS: usize = 120;

    /// Returns an overview without distances.
    pub(super) fn new(parts: Arc<Parts>) -> Self {
        let frames = parts.set().frames();
        let block = frames.div_ceil(MAX_CELLS).next_power_of_two();
        let side = frames.div_ceil(block);
        Self {
            parts,
            block,
            side,
            nearest_m: vec![f32::INFINITY; side * (side + 1) / 2],
            counts: vec![0; Self::BINS],
        }
    }

    /// Includes the distances of the windows of two parts a ≤ b. A separate function, because
    /// browsers optimise a function between two of its calls.
    #[inline(never)]
    pub(super) fn take(&mut self, a: &Part, b: &Part, distances: &DistanceMatrix) {
        let cm_per_m = self.set().cm_per_m();
        let mut histogram = Histogram::new(cm_per_m, Self::BIN_CM, self.counts.len());
        for (row, i) in a.numbers().zip(a.starts.start - a.from..) {
            // Distances within one part are symmetric: only those above the diagonal are counted.
            let first = b.number.max(row);
            let cells = distances
                .row(i)
                .get(first - b.number + (b.starts.start - b.from)..)
                .unwrap_or_default();
            let mut cells = cells.get(..b.numbers().end - first).unwrap_or(cells);
            histogram.count(cells.get(usize::from(first == row)..).unwrap_or_default());
            let mut column = first;
            while !cells.is_empty() {
                let (here, rest) =
                    cells.split_at((self.block - column % self.block).min(cells.len()));
                let at = self.at(row / self.block, column / self.block);
                if let Some(known) = self.nearest_m.get_mut(at) {
                    *known = smaller(*known, smallest(here));
                }
                (column, cells) = (column + here.len(), rest);
            }
        }
        histogram.add_to(&mut self.counts);
    }

    /// Returns the blocks of the rows of one part, and the histogram, of an overview in which
    /// nothing else is included.
    pub(super) fn into_row(self, part: usize) -> (Vec<f32>, Vec<u32>) {
        let blocks = self.blocks_of(part);
        (self.nearest_m.get(blocks).unwrap_or_default().to_vec(), self.counts)
    }

    /// Includes the rows of one part.
    pub(super) fn include(&mut self, row: &StreamRow) {
        let blocks = self.blocks_of(row.part);
        for (known, nearest) in
            self.nearest_m.get_mut(blocks).unwrap_or_default().iter_mut().zip(&row.nearest_m)
        {
            *known = known.min(*nearest);
        }
        for (count, more) in self.counts.iter_mut().zip(&row.counts) {
            *count = count.saturating_add(*more);
        }
    }

    /// Returns the indices of the blocks in the rows of a part.
    fn blocks_of(&self, part: usize) -> Range<usize> {
        let Some(part) = self.parts.made().get(part) else { return 0..0 };
        let rows = part.numbers();
        let (first, end) = (rows.start / self.block, rows.end.div_ceil(self.block));
        self.at(first, first)..self.at(end, end).min(self.nearest_m.len())
    }

    /// Returns the index of the block (row, column), row ≤ column.
    fn at(&self, row: usize, column: usize) -> usize {
        row * (2 * self.side - row).saturating_sub(1) / 2 + column
    }

    /// Returns the frames that are compared.
    #[must_use]
    pub fn set(&self) -> &Arc<FrameSet> {
        self.parts.set()
    }

    /// Returns the number of frames of each window.
    #[must_use]
    pub fn window(&self) -> usize {
        self.parts.window()
    }

    /// Returns the number of frames of a cell to a side, a power of two.
    #[must_use]
    pub fn block(&self) -> usize {
        self.block
    }

    /// Returns the number of cells in memory.
    #[must_use]
    pub fn cells(&self) -> usize {
        self.nearest_m.len()
    }

    /// Returns the number of pairs of windows in each of [`Self::BINS`] ranges of [`Self::BIN_CM`].
    /// Every pair counts once; a window with itself does not count.
    #[must_use]
    pub fn histogram(&self) -> &[u32] {
        &self.counts
    }

    /// Returns the distance of the windows that start at two frames, centimetres, computed from the
    /// clips; `None` where a window crosses the end of its clip.
    #[must_use]
    pub fn cm(&self, a: Place, b: Place) -> Option<f64> {
        let (set, window) = (self.set(), self.window());
        let fits = |place: Place| place.frame + window <= set.frames_of(place.clip);
        if !fits(a) || !fits(b) {
            return None;
        }
        let (source, target) = (set.clip(a.clip)?.clip(), set.clip(b.clip)?.clip());
        let found =
            align_onto(source, a.frame, target, b.frame, window, set.weights(), 0.0).ok()?;
        Some(set.rounded_cm(found.rms_m() as f32))
    }

    /// Returns a picture of a part of the matrix: `rows` and `columns` are frames of the set, every
    /// value is the smallest distance (centimetres) in a square of `factor` × `factor` of them,
    /// row-major; NaN where no window starts. Its resolution is that of the blocks: a square that
    /// is not made of whole blocks includes all blocks that it overlaps.
    #[must_use]
    pub fn picture(&self, rows: Range<usize>, columns: Range<usize>, factor: usize) -> Vec<f32> {
        let (frames, scale) = (self.set().frames(), self.set().cm_per_m() as f32);
        let blocks = |of: &Range<usize>| of.start / self.block..of.end.div_ceil(self.block);
        let columns: Vec<Range<usize>> =
            squares(columns, factor, frames).map(|columns| blocks(&columns)).collect();
        let mut picture = Vec::new();
        for rows in squares(rows, factor, frames).map(|rows| blocks(&rows)) {
            for columns in &columns {
                let mut nearest = f32::INFINITY;
                for row in rows.clone() {
                    for column in columns.clone() {
                        let at = self.at(row.min(column), row.max(column));
                        let here = self.nearest_m.get(at).copied();
                        nearest = smaller(nearest, here.unwrap_or(f32::INFINITY));
                    }
                }
                picture.push(if nearest.is_finite() { nearest * scale } else { f32::NAN });
            }
        }
        picture
    }

    /// Returns the computation of a picture as [`Self::picture`] describes it, from the distances
    /// themselves. Nothing is computed yet: call [`DistanceDetail::advance`].
    #[must_use]
    pub fn detail(
        &self,
        rows: Range<usize>,
        columns: Range<usize>,
        factor: usize,
    ) -> DistanceDetail {
        let (frames, factor) = (self.set().frames(), factor.max(1));
        let within = |of: Range<usize>| of.start.min(frames)..of.end.min(frames);
        let (rows, columns) = (within(rows), within(columns));
        let width = columns.len().div_ceil(factor);
        let (down, across) = (pieces(&self.parts, &rows), pieces(&self.parts, &columns));
        DistanceDetail {
            parts: Arc::clone(&self.parts),
            picture: vec![f32::NAN; rows.len().div_ceil(factor) * width],
            width,
            factor,
            tiles: (down.iter())
                .flat_map(|a| across.iter().map(|b| [a.clone(), b.clone()]))
                .collect(),
            rows,
            columns,
            done: 0,
        }
    }
}

/// Returns the number of squares of `factor` × `factor` frames.
fn squares(of: Range<usize>, factor: usize, frames: usize) -> impl Iterator<Item = Range<usize>> {
    let (factor, end) = (factor.max(1), of.end.min(frames));
    (of.start.min(end)..end).step_by(factor).map(move |from| from..(from + factor).min(end))
}

/// The greatest number of rows or columns of a tile of a [`DistanceDetail`]: so few that it is
/// computed within a frame of the screen. Parts are cut at multiples of it.
const TILE: usize = 256;
const _: () = assert!(PART.is_multiple_of(TILE));

/// Some windows of a part of the set, at most [`TILE`].
#[derive(Clone, Debug)]
struct Piece {
    part: usize,
    /// The numbers in the set of their first frames.
    numbers: Range<usize>,
}

/// Returns the windows that start in these frames of the set, in pieces that are cut at the parts'
/// ends and at every [`TILE`]-th frame of the set.
fn pieces(parts: &Parts, of: &Range<usize>) -> Vec<Piece> {
    let mut pieces = Vec::new();
    for part in parts.between(of) {
        let Some(all) = parts.made().get(part).map(Part::numbers) else { continue };
        let (mut start, end) = (all.start.max(of.start), all.end.min(of.end));
        while start < end {
            let next = end.min((start / TILE + 1) * TILE);
            pieces.push(Piece { part, numbers: start..next });
            start = next;
        }
    }
    pieces
}

/// The computation of a part of the matrix of all distances, tile by tile, on demand.
#[derive(Clone, Debug)]
pub struct DistanceDetail {
    parts: Arc<Parts>,
    rows: Range<usize>,
    columns: Range<usize>,
    factor: usize,
    width: usize,
    picture: Vec<f32>,
    /// The rows and columns of each tile.
    tiles: Vec<[Piece; 2]>,
    done: usize,
}

impl DistanceDetail {
    /// Computes up to `tiles` more tiles of at most 256 × 256 distances, 1 ms each, and returns
    /// the number of completed tiles.
    pub fn advance(&mut self, tiles: usize) -> Progress {
        let total = self.tiles.len();
        let end = self.done.saturating_add(tiles).min(total);
        for at in self.done..end {
            self.tile(at);
        }
        self.done = self.done.max(end);
        Progress { done: self.done, total }
    }

    /// Returns the computed part of the picture, row-major; NaN for squares without computed
    /// distances or windows.
    #[must_use]
    pub fn picture(&self) -> &[f32] {
        &self.picture
    }

    fn tile(&mut self, at: usize) {
        let Some([down, across]) = self.tiles.get(at) else {
            return;
        };
        // Distances are symmetric: those of a later window with an earlier one are computed the
        // other way round. Where rows and columns may overlap, all windows from the first to the
        // last are compared with themselves.
        let is_one =
            down.part == across.part && down.numbers.start / TILE == across.numbers.start / TILE;
        let start = down.numbers.start.min(across.numbers.start);
        let whole = start..down.numbers.end.max(across.numbers.end);
        let (earlier, later) = if is_one {
            (&whole, &whole)
        } else if down.numbers.start < across.numbers.start {
            (&down.numbers, &across.numbers)
        } else {
            (&across.numbers, &down.numbers)
        };
        let part = |index: usize| self.parts.made().get(index);
        let (Some(p), Some(q)) =
            (part(down.part.min(across.part)), part(down.part.max(across.part)))
        else {
            return;
        };
        let frames = [&p.frames(earlier), &q.frames(later)];
        let distances = p.sweep(q, self.parts.window(), frames).finish();
        let scale = self.parts.set().cm_per_m() as f32;
        for row in down.numbers.clone() {
            let start = (row - self.rows.start) / self.factor * self.width;
            for column in across.numbers.clone() {
                let [i, j] = [row.min(column) - earlier.start, row.max(column) - later.start];
                let found = distances.get(i, j).map(|distance| distance * scale);
                if let (Some(texel), Some(found)) = (
                    self.picture.get_mut(start + (column - self.columns.start) / self.factor),
                    found,
                ) {
                    // The smaller of the two; `min` ignores NaN.
                    *texel = texel.min(found);
                }
            }
        }
    }
}
