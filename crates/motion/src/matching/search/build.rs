//! Construction of the index of boxes.

use super::BoxIndex;
use super::boxes::{LANES, LEAF, Level};
use crate::matching::Features;
use crate::matching::features::MAX_DIMS;
use crate::registration::Progress;

/// The construction of a [`BoxIndex`] in slices.
///
/// Frames are sorted into leaves by bisection: a range of frames is split at a whole number of
/// leaves, along the dimension in which it is widest. Splits lie at powers of two, so that groups
/// of eight leaves, of 64 and so on are whole branches of that tree. O(n log n).
#[derive(Clone, Debug)]
pub struct BoxBuilder {
    ids: Vec<u32>,
    open: Vec<(usize, usize)>,
    factors: Vec<f32>,
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
            done: 0,
            total: valid.len() * rounds,
        }
    }

    /// Sorts about `frames` more frames.
    pub fn advance(&mut self, features: &Features, frames: usize) -> Progress {
        let mut left = frames;
        while let Some((first, leaves)) = self.open.pop() {
            // The larger part of a tree is on the left.
            let half = leaves.next_power_of_two() / 2;
            let (start, end) = (first * LEAF, ((first + leaves) * LEAF).min(self.ids.len()));
            let middle = half * LEAF;
            let range = self.ids.get_mut(start..end).unwrap_or_default();
            if middle < range.len() {
                let dim = widest(features, range, &self.factors);
                let value = |id: u32| {
                    features.row(id as usize).and_then(|row| row.get(dim)).copied().unwrap_or(0.0)
                };
                // Equal values keep the order of frames, so that the same rows give the same tree
                // everywhere.
                range.select_nth_unstable_by(middle, |&a, &b| {
                    value(a).total_cmp(&value(b)).then(a.cmp(&b))
                });
            }
            for (from, count) in [(first, half), (first + half, leaves - half)] {
                if count > 1 {
                    self.open.push((from, count));
                }
            }
            self.done = (self.done + (end - start)).min(self.total);
            left = left.saturating_sub(end - start);
            if left == 0 {
                break;
            }
        }
        if self.open.is_empty() {
            self.done = self.total;
        }
        Progress { done: self.done, total: self.total }
    }

    /// Sorts the remaining frames, and builds the boxes.
    #[must_use]
    pub fn finish(mut self, features: &Features) -> BoxIndex {
        while !self.open.is_empty() {
            self.advance(features, usize::MAX);
        }
        // Within a leaf the frames are in order of time, whatever order bisection gave them.
        for leaf in self.ids.chunks_mut(LEAF) {
            leaf.sort_unstable();
        }
        let dims = features.layout().dims();
        let groups = self.ids.len().div_ceil(LANES);
        let mut cells = vec![0.0; groups * dims * LANES];
        for (ids, cell) in self.ids.chunks(LANES).zip(cells.chunks_exact_mut(dims * LANES)) {
            for lane in 0..LANES {
                // Lanes after the last frame repeat it.
                let id = ids.get(lane).or(ids.last()).copied().unwrap_or(0);
                let row = features.row(id as usize).unwrap_or(&[]);
                for (dim, &value) in row.iter().enumerate() {
                    if let Some(to) = cell.get_mut(dim * LANES + lane) {
                        *to = value;
                    }
                }
            }
        }
        let mut levels = Vec::new();
        let mut bounds: Vec<(Vec<f32>, Vec<f32>)> = (self.ids.chunks(LEAF))
            .map(|leaf| {
                bounds_of(
                    dims,
                    leaf.iter().filter_map(|&id| features.row(id as usize)).map(|row| (row, row)),
                )
            })
            .collect();
        while !bounds.is_empty() {
            levels.push(Level::pack(dims, &bounds));
            if bounds.len() <= LANES {
                break;
            }
            bounds = (bounds.chunks(LANES))
                .map(|children| {
                    bounds_of(dims, children.iter().map(|(low, high)| (&low[..], &high[..])))
                })
                .collect();
        }
        BoxIndex::new(dims, self.ids, cells, levels)
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

fn bounds_of<'a>(
    dims: usize,
    parts: impl Iterator<Item = (&'a [f32], &'a [f32])>,
) -> (Vec<f32>, Vec<f32>) {
    let (mut low, mut high) = (vec![f32::INFINITY; dims], vec![f32::NEG_INFINITY; dims]);
    for (lower, upper) in parts {
        for ((low, high), (&lower, &upper)) in
            low.iter_mut().zip(&mut high).zip(lower.iter().zip(upper))
        {
            *low = low.min(lower);
            *high = high.max(upper);
        }
    }
    (low, high)
}
