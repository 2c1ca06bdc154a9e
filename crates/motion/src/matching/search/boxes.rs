//! Exact search by bounding boxes.

use super::super::tags::{TagFilter, TagSet};
use super::{Hit, Query, SearchResult};

/// Number of values that are computed side by side.
pub(super) const LANES: usize = 8;
/// Number of frames in a leaf.
pub(super) const LEAF: usize = 16;
const GROUPS: usize = LEAF / LANES;

type Lane = [f32; LANES];

/// Bounding boxes, one after the other: for each its lower bounds in all dimensions, then its upper
/// bounds.
#[derive(Clone, Debug, Default)]
pub(super) struct BoundingBoxes(Vec<f32>);

impl BoundingBoxes {
    pub(super) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    pub(super) fn len(&self, dims: usize) -> usize {
        self.0.len() / (2 * dims)
    }

    /// Makes room for `boxes` more.
    pub(super) fn reserve(&mut self, dims: usize, boxes: usize) {
        self.0.reserve_exact(2 * dims * boxes);
    }

    /// Appends the smallest box around all parts, each given by its lower and upper bounds.
    pub(super) fn push_around<'a>(
        &mut self,
        dims: usize,
        parts: impl Iterator<Item = (&'a [f32], &'a [f32])>,
    ) {
        let start = self.0.len();
        self.0.resize(start + dims, f32::INFINITY);
        self.0.resize(start + 2 * dims, f32::NEG_INFINITY);
        let (low, high) = self.0[start..].split_at_mut(dims);
        for (lower, upper) in parts {
            // Comparisons, as `min` and `max` are calls in WebAssembly.
            for (low, &lower) in low.iter_mut().zip(lower) {
                *low = if lower < *low { lower } else { *low };
            }
            for (high, &upper) in high.iter_mut().zip(upper) {
                *high = if upper > *high { upper } else { *high };
            }
        }
    }

    /// Returns the next level: boxes around `children` consecutive ones each; the last may have
    /// fewer.
    pub(super) fn parents(&self, dims: usize, children: usize) -> Self {
        let mut parents = Self::default();
        for children in self.0.chunks(2 * dims * children) {
            let parts = children.chunks_exact(2 * dims).map(|bounds| bounds.split_at(dims));
            parents.push_around(dims, parts);
        }
        parents
    }
}

/// One level of boxes, in packs of eight: for each pack and each dimension their lower bounds, then
/// their upper bounds.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Level {
    packs: Vec<f32>,
    boxes: usize,
}

impl Level {
    pub(super) fn pack(dims: usize, boxes: &BoundingBoxes) -> Self {
        let count = boxes.len(dims);
        let mut packs = Vec::with_capacity(count.div_ceil(LANES) * dims * 2 * LANES);
        for pack in boxes.0.chunks(2 * dims * LANES) {
            let last = pack.len() / (2 * dims) - 1;
            for dim in 0..dims {
                for end in [0, 1] {
                    // Lanes after the last box repeat it.
                    packs.extend(
                        (0..LANES).map(|lane| pack[(2 * lane.min(last) + end) * dims + dim]),
                    );
                }
            }
        }
        Self { packs, boxes: count }
    }
}

/// An exact search by a hierarchy of bounding boxes, which visits few frames.
///
/// A leaf holds 16 similar frames, of whatever clip; above it every box has eight children. Boxes
/// are opened nearest first, and skipped once they are farther than the best frame so far, which
/// the caller may already have (the frame that is playing). Distances to eight frames or eight
/// boxes are computed side by side.
///
/// Boxes hold normalised features; weights come with the query. Changed weights therefore need no
/// new index. Where boxes do not help, as for a query unlike anything in the database, the
/// remaining frames are scanned leaf by leaf.
#[derive(Clone, Debug, PartialEq)]
pub struct BoxIndex {
    dims: usize,
    /// Frames in the order of leaves.
    ids: Vec<u32>,
    /// Features in that order: for each eight frames and each dimension eight numbers.
    cells: Vec<f32>,
    /// From the leaves up to at most eight boxes.
    levels: Vec<Level>,
}

/// Tags of the boxes: those that any of the frames has, and those that all of them have; for each
/// level of a [`BoxIndex`] one pair per box.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BoxMasks {
    levels: Vec<Vec<(TagSet, TagSet)>>,
    /// Tags of the frames in the order of leaves.
    frames: Vec<TagSet>,
    /// Whether no frame of the database is excluded, so that a query without a filter needs no
    /// tests.
    free: bool,
}

/// A box that is to be opened.
#[derive(Clone, Copy)]
struct Open {
    bound: f32,
    level: u32,
    index: u32,
}

/// The share of all leaves after which the search falls back to a scan.
const FALLBACK_SHARE: f32 = 0.25;

impl BoxIndex {
    pub(super) fn new(dims: usize, ids: Vec<u32>, cells: Vec<f32>, levels: Vec<Level>) -> Self {
        Self { dims, ids, cells, levels }
    }

    /// Returns the number of frames that can be found.
    #[must_use]
    pub fn len(&self) -> usize {
        self.ids.len()
    }

    /// Returns whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.ids.is_empty()
    }

    /// Returns the tags of the boxes from those of all frames. O(frames): tags change without a new
    /// index.
    #[must_use]
    pub fn masks(&self, tags: &[TagSet]) -> BoxMasks {
        let frames: Vec<TagSet> = (self.ids.iter())
            .map(|&id| tags.get(id as usize).copied().unwrap_or_default())
            .collect();
        let joined = |parts: &mut dyn Iterator<Item = (TagSet, TagSet)>| {
            parts.fold((TagSet::NONE, TagSet(u32::MAX)), |(any, all), (a, b)| {
                (TagSet(any.0 | a.0), TagSet(all.0 & b.0))
            })
        };
        let mut levels: Vec<Vec<(TagSet, TagSet)>> = Vec::with_capacity(self.levels.len());
        for _ in &self.levels {
            let level = match levels.last() {
                None => frames
                    .chunks(LEAF)
                    .map(|leaf| joined(&mut leaf.iter().map(|&tags| (tags, tags))))
                    .collect(),
                Some(below) => below
                    .chunks(LANES)
                    .map(|children| joined(&mut children.iter().copied()))
                    .collect(),
            };
            levels.push(level);
        }
        let free = frames.iter().all(|tags| TagFilter::default().admits(*tags));
        BoxMasks { levels, frames, free }
    }

    /// Returns the best admitted frame. `known` is a frame that the filter admits and that is in
    /// the index; it or a better one is returned.
    #[must_use]
    pub fn search(&self, masks: &BoxMasks, query: &Query<'_>, known: Option<Hit>) -> SearchResult {
        if !query.is_sound(self.dims) || self.ids.is_empty() {
            return SearchResult::default();
        }
        let mut search = Search {
            index: self,
            masks,
            query,
            filtered: !(masks.free && query.filter == TagFilter::default()),
            best: known,
            visited: 0,
        };
        search.run();
        SearchResult { best: search.best, visited: search.visited }
    }
}

struct Search<'a> {
    index: &'a BoxIndex,
    masks: &'a BoxMasks,
    query: &'a Query<'a>,
    filtered: bool,
    best: Option<Hit>,
    visited: usize,
}

impl Search<'_> {
    fn limit(&self) -> f32 {
        self.best.map_or(f32::INFINITY, |best| best.cost)
    }

    fn run(&mut self) {
        let top = self.index.levels.len() - 1;
        let leaves = self.index.levels[0].boxes;
        let most = ((leaves as f32 * FALLBACK_SHARE) as usize).max(64);
        let mut opened = 0;
        // Nearest last, level by level: the deepest stack has seven siblings on every level.
        let mut stack: Vec<Open> = Vec::with_capacity(LANES * (top + 1));
        self.open(top, 0, &mut stack);
        let mut seen: Vec<u64> = Vec::new();
        while let Some(next) = stack.pop() {
            if next.bound > self.limit() {
                continue;
            }
            let (level, index) = (next.level as usize, next.index as usize);
            if level > 0 {
                self.open(level - 1, index, &mut stack);
                continue;
            }
            self.leaf(index);
            opened += 1;
            if opened * 8 >= most && seen.is_empty() {
                seen = vec![0; leaves.div_ceil(64)];
            }
            if !seen.is_empty() {
                seen[index / 64] |= 1 << (index % 64);
            }
            if opened >= most {
                // Leaves that were opened before they were marked are scanned again: an eighth of a
                // quarter.
                for leaf in 0..leaves {
                    if seen[leaf / 64] >> (leaf % 64) & 1 == 0 {
                        self.leaf(leaf);
                    }
                }
                return;
            }
        }
    }

    /// Computes the bounds of the eight children in a pack and puts those that may contain a better
    /// frame on the stack.
    fn open(&mut self, level: usize, pack: usize, stack: &mut Vec<Open>) {
        let boxes = &self.index.levels[level];
        let size = self.index.dims * 2 * LANES;
        let Some(cells) = boxes.packs.get(pack * size..(pack + 1) * size) else {
            return;
        };
        let limit = self.limit();
        let bounds = box_bounds(cells, self.query, limit);
        let first = pack * LANES;
        let count = (boxes.boxes - first).min(LANES);
        let base = stack.len();
        for (lane, &bound) in bounds.iter().enumerate().take(count) {
            if bound > limit || (self.filtered && !self.may_admit(level, first + lane)) {
                continue;
            }
            let open = Open { bound, level: level as u32, index: (first + lane) as u32 };
            // Insertion keeps the nearest on top.
            let mut at = stack.len();
            stack.push(open);
            while at > base && stack[at - 1].bound < bound {
                stack[at] = stack[at - 1];
                at -= 1;
            }
            stack[at] = open;
        }
    }

    fn may_admit(&self, level: usize, index: usize) -> bool {
        let masks = self.masks.levels.get(level).and_then(|level| level.get(index));
        masks.is_some_and(|&(any, all)| self.query.filter.may_admit(any, all))
    }

    fn leaf(&mut self, leaf: usize) {
        let size = self.index.dims * LANES;
        for group in leaf * GROUPS..(leaf + 1) * GROUPS {
            let Some(cells) = self.index.cells.get(group * size..(group + 1) * size) else {
                return;
            };
            let first = group * LANES;
            let ids = &self.index.ids[first..(first + LANES).min(self.index.ids.len())];
            self.visited += ids.len();
            let limit = self.limit();
            let Some(costs) = frame_costs(cells, self.query, limit) else {
                continue;
            };
            for (lane, (&id, &cost)) in ids.iter().zip(&costs).enumerate() {
                let hit = Hit { frame: id as usize, cost };
                if self.best.is_none_or(|best| hit.beats(&best)) && self.admits(first + lane) {
                    self.best = Some(hit);
                }
            }
        }
    }

    fn admits(&self, slot: usize) -> bool {
        !self.filtered
            || self.masks.frames.get(slot).is_some_and(|tags| self.query.filter.admits(*tags))
    }
}

/// Number of dimensions between two checks whether a group can be skipped.
const DIMS_PER_CHECK: usize = 9;

/// Returns the costs of eight frames; `None` as soon as all are above `limit`.
#[inline]
fn frame_costs(cells: &[f32], query: &Query<'_>, limit: f32) -> Option<Lane> {
    let mut costs = [0.0; LANES];
    let parts = cells
        .chunks(DIMS_PER_CHECK * LANES)
        .zip(query.row.chunks(DIMS_PER_CHECK).zip(query.weights.chunks(DIMS_PER_CHECK)));
    for (cells, (query, weights)) in parts {
        for (cell, (&q, &w)) in cells.as_chunks::<LANES>().0.iter().zip(query.iter().zip(weights)) {
            for (cost, x) in costs.iter_mut().zip(cell) {
                let difference = w * (q - x);
                *cost += difference * difference;
            }
        }
        if all_above(&costs, limit) {
            return None;
        }
    }
    Some(costs)
}

/// Returns lower bounds of the costs in eight boxes: exact unless all are above `limit`.
#[inline]
fn box_bounds(cells: &[f32], query: &Query<'_>, limit: f32) -> Lane {
    let mut bounds = [0.0; LANES];
    let parts = (cells.chunks(DIMS_PER_CHECK * 2 * LANES))
        .zip(query.row.chunks(DIMS_PER_CHECK).zip(query.weights.chunks(DIMS_PER_CHECK)));
    for (cells, (query, weights)) in parts {
        let ends = cells.as_chunks::<{ 2 * LANES }>().0;
        for (ends, (&q, &w)) in ends.iter().zip(query.iter().zip(weights)) {
            let (low, high) = ends.split_at(LANES);
            for (bound, (low, high)) in bounds.iter_mut().zip(low.iter().zip(high)) {
                let (below, above) = (low - q, q - high);
                let outside = if below > above { below } else { above };
                let outside = if outside > 0.0 { outside } else { 0.0 };
                let difference = w * outside;
                *bound += difference * difference;
            }
        }
        if all_above(&bounds, limit) {
            return bounds;
        }
    }
    bounds
}

#[inline]
fn all_above(values: &Lane, limit: f32) -> bool {
    let mut least = values[0];
    for &value in values {
        least = if value < least { value } else { least };
    }
    least > limit
}
