//! Candidates for transitions.

use super::candidate_sort::{CandidateSort, keep_closest};
use super::cells::smallest;
use super::{
    AllPairs, Construction, FrameDistances, FrameSet, GraphError, GraphOptions, Place,
    TileCandidates,
};
use crate::math::Planar;
use crate::registration::Progress;
use std::ops::Range;
use std::sync::Arc;

/// The greatest number of candidates that a search returns; the closest are kept.
const MAX_CANDIDATES: usize = 400_000;
/// The number of candidates in memory above which the farthest are dropped, down to
/// [`MAX_CANDIDATES`].
const MAX_IN_MEMORY: usize = MAX_CANDIDATES + MAX_CANDIDATES / 4;

/// The cost of aligning one candidate, in cells scanned (for progress).
const CELLS_PER_FOUND: usize = 100;

/// The greatest jolt ([`jolts`](crate::clip)) of a frame at which a clip is left or entered, as a
/// multiple of the clip's 99th percentile.
const MAX_JOLT: f32 = 4.0;

/// A possible transition.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Candidate {
    /// The frame at which its clip is left.
    pub leave: Place,
    /// The frame at which the other clip, or the same, is entered.
    pub enter: Place,
    /// The distance of the two windows, centimetres on the reference body, rounded to 0.001 cm.
    pub distance_cm: f64,
    /// The best alignment of the entered clip with the one that is left:
    /// `left_world_from_entered_world`.
    pub alignment: Planar,
}

/// All candidates below the threshold, closest first.
#[derive(Clone, Debug, PartialEq)]
pub struct Candidates {
    pub(super) found: Vec<Candidate>,
    /// The smallest distance of any possible transition, below the threshold or not.
    pub(super) nearest_cm: Option<f64>,
    /// The number of candidates below the threshold that are not kept.
    pub(super) left_out: usize,
    /// The threshold of the search, centimetres: the result is valid for all lower ones.
    pub(super) threshold_cm: f64,
}

impl Candidates {
    /// Finds the candidates for a construction: starts and ends of segments, or local minima of the
    /// distance, up to the threshold.
    ///
    /// A candidate is left out if a window crosses the end of its clip, nothing of the outgoing
    /// clip would play before it, or nothing of the incoming one after it; if it is shorter than
    /// the shortest jump inside a clip; and, for minima, if a joint jolts there.
    ///
    /// # Errors
    /// [`GraphError`] when the options do not fit the clips, or the distances have another window.
    pub fn find(
        all: &AllPairs,
        distances: &FrameDistances,
        options: &GraphOptions,
    ) -> Result<Self, GraphError> {
        let mut search = CandidateSearch::new(distances, options)?;
        while !search.advance(all, distances, usize::MAX)?.is_complete() {}
        Ok(search.into_sort().finish())
    }

    /// Returns the candidates, closest first.
    #[must_use]
    pub fn found(&self) -> &[Candidate] {
        &self.found
    }

    /// Returns the smallest distance of two windows with a possible transition, centimetres, below
    /// the threshold or not.
    #[must_use]
    pub fn nearest_cm(&self) -> Option<f64> {
        self.nearest_cm
    }

    /// Returns the number of candidates below the threshold beyond the limit of 400,000; the
    /// closest are kept.
    #[must_use]
    pub fn left_out(&self) -> usize {
        self.left_out
    }

    /// Returns whether all candidates up to this distance are included.
    #[must_use]
    pub fn are_all_within(&self, cm: f64) -> bool {
        let farthest = self.found.last().map_or(0.0, |last| last.distance_cm);
        cm <= self.threshold_cm && (self.left_out == 0 || cm < farthest)
    }
}

/// The search of [`Candidates::find`] in slices. It holds neither the pairs nor the distances.
#[derive(Clone, Debug)]
pub struct CandidateSearch {
    picker: Picker,
    /// The next clips a ≤ b and row.
    next: (usize, usize, usize),
    done: usize,
    total: usize,
}

impl CandidateSearch {
    /// Begins the search.
    ///
    /// # Errors
    /// [`GraphError`] when the options do not fit the clips, or the distances have another window.
    pub fn new(distances: &FrameDistances, options: &GraphOptions) -> Result<Self, GraphError> {
        let set = distances.set();
        options.check(set)?;
        if distances.window() != options.blend_window {
            return Err(GraphError::OtherWindow {
                found: distances.window(),
                expected: options.blend_window,
            });
        }
        let clips = set.clips().len();
        let pairs = (0..clips).flat_map(|a| (a..clips).map(move |b| (a, b)));
        let cells = pairs
            .filter_map(|(a, b)| distances.block(a, b))
            .map(|block| block.size().0 * block.size().1);
        Ok(Self {
            picker: Picker::new(Arc::clone(set), *options),
            next: (0, 0, 0),
            done: 0,
            total: cells.sum(),
        })
    }

    /// Scans about `cells` more cells of the matrix (fewer where many candidates are found), at
    /// least one row of a pair of clips, and returns the progress. For the construction by segments
    /// a pair of clips is one slice.
    ///
    /// # Errors
    /// [`GraphError::Registration`]; not for the pairs and distances from which it was made.
    pub fn advance(
        &mut self,
        all: &AllPairs,
        distances: &FrameDistances,
        cells: usize,
    ) -> Result<Progress, GraphError> {
        let clips = distances.set().clips().len();
        let window = distances.window();
        let align = |leave, enter| all.alignment(leave, enter, window).map(|found| found.transform);
        let place = |clip, frame| Place { clip, frame };
        let until = self.done.saturating_add(cells.max(1));
        let found = self.picker.found.len();
        let work = |search: &Self| {
            search.done + CELLS_PER_FOUND * search.picker.found.len().saturating_sub(found)
        };
        while self.next.0 < clips && work(self) < until {
            let (a, b, row) = self.next;
            let Some(block) = distances.block(a, b) else {
                self.next = following(a, b, clips);
                continue;
            };
            let (rows, columns) = block.size();
            if let Construction::Segments { .. } = self.picker.options.construction {
                for (row, column) in self.picker.cells(a, b) {
                    if let Some(distance) = block.get(row, column) {
                        self.picker.offer(
                            place(a, row),
                            place(b, column),
                            distance,
                            || true,
                            align,
                        )?;
                    }
                }
                self.done += rows * columns;
                self.next = following(a, b, clips);
                continue;
            }
            if row >= rows {
                self.next = following(a, b, clips);
                continue;
            }
            let (first, cells) = block.row(row);
            let minimum = |at: usize| is_minimum(|r, c| block.get(r, c), row, first + at);
            let places = [place(a, row), place(b, first)];
            self.picker.offer_minima(places, cells, 0..cells.len(), minimum, align)?;
            self.done += columns;
            self.next.2 += 1;
        }
        let done = if self.next.0 < clips {
            self.done.min(self.total.saturating_sub(1))
        } else {
            self.total
        };
        Ok(Progress { done, total: self.total })
    }

    /// Returns the progress.
    #[must_use]
    pub fn progress(&self) -> Progress {
        Progress { done: self.done.min(self.total), total: self.total }
    }

    /// Returns the sort of the candidates found so far.
    #[must_use]
    pub fn into_sort(self) -> CandidateSort {
        self.picker.into_sort()
    }
}

/// Returns the pair of clips after a ≤ b, with its first row.
fn following(a: usize, b: usize, clips: usize) -> (usize, usize, usize) {
    if b + 1 < clips { (a, b + 1, 0) } else { (a + 1, a + 1, 0) }
}

/// Returns whether a cell is no larger than its eight neighbours; of a plateau the first cell.
/// Unrounded distances are compared: products and sums in an order that is the same on every
/// machine.
pub(super) fn is_minimum(
    at: impl Fn(usize, usize) -> Option<f32>,
    row: usize,
    column: usize,
) -> bool {
    let Some(here) = at(row, column) else {
        return false;
    };
    for r in row.saturating_sub(1)..=row + 1 {
        for c in column.saturating_sub(1)..=column + 1 {
            let Some(there) = at(r, c) else { continue };
            // Strictly smaller than previous cells, so that a plateau is counted once.
            if there < here || (there == here && (r, c) < (row, column)) {
                return false;
            }
        }
    }
    true
}

/// The collection of candidates, offered in any order.
#[derive(Clone, Debug)]
pub(super) struct Picker {
    set: Arc<FrameSet>,
    pub(super) options: GraphOptions,
    min_jump: usize,
    /// The threshold, metres of the clips' own body.
    threshold_m: f32,
    nearest_m: f32,
    found: Vec<Candidate>,
    left_out: usize,
}

impl Picker {
    pub(super) fn new(set: Arc<FrameSet>, options: GraphOptions) -> Self {
        Self {
            min_jump: options.min_jump(&set),
            // A little above the threshold; the rounded distance decides.
            threshold_m: ((options.edge_threshold_cm + 0.001) / set.cm_per_m()) as f32,
            nearest_m: f32::INFINITY,
            found: Vec::new(),
            left_out: 0,
            set,
            options,
        }
    }

    /// Offers the minima of a row of the matrix, among the cells `within`, that are below the
    /// threshold or closer than all before. The places are the window of the row and that of its
    /// first cell; `is_minimum` takes the index of a cell in the row.
    pub(super) fn offer_minima(
        &mut self,
        [a, b]: [Place; 2],
        row: &[f32],
        within: Range<usize>,
        is_minimum: impl Fn(usize) -> bool,
        alignment: impl Fn(Place, Place) -> Result<Planar, GraphError>,
    ) -> Result<(), GraphError> {
        let mut from = within.start;
        while let Some(at) = self.next_low(row, from..within.end) {
            let b = Place { frame: b.frame + at, ..b };
            self.offer(a, b, row[at], || is_minimum(at), &alignment)?;
            from = at + 1;
        }
        Ok(())
    }

    /// Returns the first of some cells of a row that may be a candidate: its distance is below the
    /// threshold, or no larger than the smallest before, and no larger than its neighbours in the
    /// row. [`Self::offer`] decides; most cells are passed over here, a few instructions each. A
    /// separate function, because browsers optimise a function between two of its calls.
    #[inline(never)]
    fn next_low(&self, row: &[f32], within: Range<usize>) -> Option<usize> {
        const GROUP: usize = 16;
        let most =
            if self.nearest_m > self.threshold_m { self.nearest_m } else { self.threshold_m };
        let is_low = |at: usize| {
            let here = row[at];
            here <= most
                && !(at > 0 && row[at - 1] <= here)
                && !row.get(at + 1).is_some_and(|&next| next < here)
        };
        let end = within.end.min(row.len());
        let mut at = within.start;
        while at < end {
            // Most groups have no low distance at all.
            let group = row.get(at..end).and_then(<[f32]>::first_chunk::<GROUP>);
            if group.is_some_and(|group| smallest(group) > most) {
                at += GROUP;
                continue;
            }
            let next = end.min(at + GROUP);
            if let Some(found) = (at..next).find(|&at| is_low(at)) {
                return Some(found);
            }
            at = next;
        }
        None
    }

    /// Returns whether a distance is relevant: below the threshold, or smaller than all before it.
    pub(super) fn is_worth(&self, distance: f32) -> bool {
        distance <= self.threshold_m || distance < self.nearest_m
    }

    /// Returns the cells of clips a ≤ b in which a segment is left and another entered, each once.
    pub(super) fn cells(&self, a: usize, b: usize) -> Vec<(usize, usize)> {
        let (of_a, of_b) = (self.ends(a), self.ends(b));
        let mut cells = Vec::new();
        for &row in &of_a {
            for &column in &of_b {
                if a < b || row < column {
                    cells.push((row, column));
                }
            }
        }
        cells
    }

    /// Returns the frames of a clip at which its segments are entered or left.
    fn ends(&self, clip: usize) -> Vec<usize> {
        let mut frames: Vec<usize> = (self.options.stretches(&self.set, clip).iter())
            .flat_map(|stretch| [stretch.start, stretch.end - self.options.blend_window])
            .collect();
        frames.sort_unstable();
        frames.dedup();
        frames
    }

    /// Offers a pair of windows; a ≤ b. `alignment` is called for accepted ones.
    pub(super) fn offer(
        &mut self,
        a: Place,
        b: Place,
        distance: f32,
        is_minimum: impl Fn() -> bool,
        alignment: impl Fn(Place, Place) -> Result<Planar, GraphError>,
    ) -> Result<(), GraphError> {
        if a.clip == b.clip && a.frame.abs_diff(b.frame) < self.min_jump {
            return Ok(());
        }
        let (there, back) = (self.can_go(a, b), self.can_go(b, a));
        if !there && !back {
            return Ok(());
        }
        let distance_cm = self.set.rounded_cm(distance);
        let is_near = distance_cm <= self.options.edge_threshold_cm;
        if !(is_near || distance < self.nearest_m) || !is_minimum() {
            return Ok(());
        }
        self.nearest_m = self.nearest_m.min(distance);
        if !is_near {
            return Ok(());
        }
        let (leave, enter) = (a, b);
        let alignment = alignment(leave, enter)?;
        let candidate = Candidate { leave, enter, distance_cm, alignment };
        self.found.extend(there.then_some(candidate));
        self.found.extend(back.then(|| Candidate {
            leave: enter,
            enter: leave,
            alignment: alignment.inverse(),
            ..candidate
        }));
        if self.found.len() > MAX_IN_MEMORY {
            self.left_out += keep_closest(&mut self.found, MAX_CANDIDATES);
        }
        Ok(())
    }

    /// Returns whether a frame plays before the transition, its windows fit, and a frame plays
    /// after it.
    fn can_go(&self, leave: Place, enter: Place) -> bool {
        let window = self.options.blend_window;
        let fits = leave.frame >= 1
            && leave.frame + window <= self.set.frames_of(leave.clip)
            && enter.frame + window < self.set.frames_of(enter.clip);
        fits && match self.options.construction {
            Construction::Minima => self.is_calm(leave) && self.is_calm(enter),
            Construction::Segments { .. } => {
                self.options.is_left_at(&self.set, leave)
                    && self.options.is_entered_at(&self.set, enter)
            }
        }
    }

    /// Returns whether no joint jolts around a frame: a transition would carry on the velocities of
    /// a trembling capture.
    fn is_calm(&self, place: Place) -> bool {
        let around = place.frame.saturating_sub(1)..=place.frame;
        let jolts = self.set.jolts(place.clip).get(around);
        jolts.is_some_and(|jolts| jolts.iter().all(|&jolt| jolt <= MAX_JOLT))
    }

    /// Returns the candidates of a part of the matrix.
    pub(super) fn into_tile(self) -> TileCandidates {
        TileCandidates {
            nearest_m: self.nearest_m.is_finite().then_some(self.nearest_m),
            found: self.found,
            left_out: self.left_out,
        }
    }

    /// Includes the candidates of a part of the matrix.
    pub(super) fn absorb(&mut self, tile: TileCandidates) {
        self.nearest_m = tile.nearest_m.map_or(self.nearest_m, |near| near.min(self.nearest_m));
        self.left_out += tile.left_out;
        let more = tile.found.len();
        if self.found.len() + more > MAX_IN_MEMORY {
            self.left_out += keep_closest(&mut self.found, MAX_CANDIDATES);
        }
        let known = self.found.len();
        if known + more > MAX_CANDIDATES / 8 {
            // A vector that doubles would copy hundreds of thousands of candidates several times.
            self.found.reserve_exact(more.max(MAX_IN_MEMORY.saturating_sub(known)));
        }
        self.found.extend(tile.found);
    }

    /// Returns the sort of the candidates.
    pub(super) fn into_sort(self) -> CandidateSort {
        let candidates = Candidates {
            found: self.found,
            nearest_cm: self.nearest_m.is_finite().then(|| self.set.rounded_cm(self.nearest_m)),
            left_out: self.left_out,
            threshold_cm: self.options.edge_threshold_cm,
        };
        CandidateSort::new(self.set, candidates, MAX_CANDIDATES)
    }
}
