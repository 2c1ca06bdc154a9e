//! Construction of the index of boxes.

use super::BoxIndex;
use super::boxes::{BoundingBoxes, LANES, LEAF, Level};
use crate::matching::Features;
use crate::matching::features::MAX_DIMS;
use crate::registration::Progress;

/// The construction of a [`BoxIndex`] in slices.
///
/// Frames are sorted into leaves by bisection: a range of frames is split at a whole number of
/// leaves, along the dimension in which it is widest. Splits lie at powers of two, so that groups
/// of eight leaves, of 64 and so on are whole branches of that tree. O(n log n).
///
/// Then the features are packed leaf by leaf, and the bounding box of each leaf is computed.
#[derive(Clone, Debug)]
pub struct BoxBuilder {
    ids: Vec<u32>,
    open: Vec<(usize, usize)>,
    factors: Vec<f32>,
    /// The number of frames that are packed.
    packed: usize,
    /// Their features, as in a [`BoxIndex`].
    cells: Vec<f32>,
    /// The boxes of their leaves.
    leaves: BoundingBoxes,
    done: usize,
    total: usize,
}

/// Number of frames in the sample from which the widest dimension is chosen.
const SAMPLE: usize = 256;

impl BoxBuilder {
    /// Begins the construction for the rows `valid` of some features. `factors` scale the widths of
    /// dimensions (the weights that are most likely used in queries): any are valid, but boxes are
    /// best when they match.
    #[must_use]
    pub fn new(valid: &[u32], factors: &[f32]) -> Self {
        let leaves = valid.len().div_ceil(LEAF);
        let rounds = leaves.max(1).ilog2() as usize + 1;
        Self {
            ids: valid.to_vec(),
            open: if leaves > 1 { vec![(0, leaves)] } else { Vec::new() },
            factors: factors.to_vec(),
            packed: 0,
            cells: Vec::new(),
            leaves: BoundingBoxes::default(),
            done: 0,
            total: valid.len() * (rounds + 1),
        }
    }

    /// Sorts or packs about `frames` more frames.
    pub fn advance(&mut self, features: &Features, frames: usize) -> Progress {
        let mut left = frames;
        while left > 0
            && let Some((first, leaves)) = self.open.pop()
        {
            // The larger part of a tree is on the left.
            let half = leaves.next_power_of_two() / 2;
            let (start, end) = (first * LEAF, ((first + leaves) * LEAF).min(self.ids.len()));
            if let Some(ids) = self.ids.get_mut(start..end) {
                bisect(features, ids, half * LEAF, &self.factors);
            }
            for (from, count) in [(first, half), (first + half, leaves - half)] {
                if count > 1 {
                    self.open.push((from, count));
                }
            }
            self.done = (self.done + (end - start)).min(self.total);
            left = left.saturating_sub(end - start);
        }
        while left > 0 && self.packed < self.ids.len() {
            let frames = self.pack_leaf(features);
            left = left.saturating_sub(frames);
        }
        if self.open.is_empty() && self.packed == self.ids.len() {
            self.done = self.total;
        }
        Progress { done: self.done, total: self.total }
    }

    /// Packs the next leaf. Returns the number of its frames.
    fn pack_leaf(&mut self, features: &Features) -> usize {
        let count = self.ids.len();
        let end = (self.packed + LEAF).min(count);
        let Some(ids) = self.ids.get_mut(self.packed..end) else { return 0 };
        // Within a leaf the frames are in order of time, whatever order bisection gave them.
        ids.sort_unstable();
        let dims = features.layout().dims();
        if self.cells.is_empty() {
            self.cells.reserve_exact(count.div_ceil(LANES) * dims * LANES);
            self.leaves.reserve(dims, count.div_ceil(LEAF));
        }
        for ids in ids.chunks(LANES) {
            let start = self.cells.len();
            self.cells.resize(start + dims * LANES, 0.0);
            for lane in 0..LANES {
                // Lanes after the last frame repeat it.
                let id = ids.get(lane).or(ids.last()).copied().unwrap_or(0);
                let row = features.row(id as usize).unwrap_or(&[]);
                for (to, &value) in self.cells[start + lane..].iter_mut().step_by(LANES).zip(row) {
                    *to = value;
                }
            }
        }
        let rows = ids.iter().filter_map(|&id| features.row(id as usize));
        self.leaves.push_around(dims, rows.map(|row| (row, row)));
        self.done = (self.done + ids.len()).min(self.total);
        self.packed = end;
        ids.len()
    }

    /// Sorts and packs the remaining frames, and builds the upper levels.
    #[must_use]
    pub fn finish(mut self, features: &Features) -> BoxIndex {
        while !self.advance(features, usize::MAX).is_complete() {}
        let dims = features.layout().dims();
        let mut levels = Vec::new();
        let mut boxes = self.leaves;
        while !boxes.is_empty() {
            levels.push(Level::pack(dims, &boxes));
            if boxes.len(dims) <= LANES {
                break;
            }
            boxes = boxes.parents(dims, LANES);
        }
        BoxIndex::new(dims, self.ids, self.cells, levels)
    }
}

/// Partitions frames along the dimension in which they are widest: the `middle` ones with the least
/// values come first. Does nothing if there are no more than `middle`.
fn bisect(features: &Features, ids: &mut [u32], middle: usize, factors: &[f32]) {
    if middle >= ids.len() {
        return;
    }
    let dim = widest(features, ids, factors);
    let value =
        |id: u32| features.row(id as usize).and_then(|row| row.get(dim)).copied().unwrap_or(0.0);
    // Values and frames side by side, so that comparing them reads no rows. Equal values keep the
    // order of frames, so that the same rows give the same tree everywhere.
    let mut keys: Vec<(f32, u32)> = ids.iter().map(|&id| (value(id), id)).collect();
    keys.select_nth_unstable_by(middle, |a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    for (id, key) in ids.iter_mut().zip(&keys) {
        *id = key.1;
    }
}

/// Returns the dimension in which these rows have the greatest spread.
fn widest(features: &Features, ids: &[u32], factors: &[f32]) -> usize {
    let dims = features.layout().dims();
    let stride = ids.len().div_ceil(SAMPLE).max(1);
    let rows = ids.iter().step_by(stride).filter_map(|&id| features.row(id as usize));
    let (mut sums, mut squares, mut count) = ([0.0f32; MAX_DIMS], [0.0f32; MAX_DIMS], 0.0);
    for row in rows {
        count += 1.0;
        for ((sum, square), &value) in sums.iter_mut().zip(&mut squares).zip(row) {
            *sum += value;
            *square += value * value;
        }
    }
    let spread = |dim: usize| {
        let factor = factors.get(dim).copied().unwrap_or(1.0);
        factor * factor * (squares[dim] - sums[dim] * sums[dim] / count)
    };
    (0..dims)
        .map(|dim| (dim, spread(dim)))
        .reduce(|best, next| if next.1 > best.1 { next } else { best })
        .map_or(0, |(dim, _)| dim)
}
