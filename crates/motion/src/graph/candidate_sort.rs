//! The order of candidates.

use super::candidates::Picker;
use super::grouped::grouped;
use super::{Candidate, Candidates, FrameSet, GraphOptions, Place, TileCandidates};
use std::cmp::Ordering;
use std::sync::Arc;

/// The greatest number of groups for each candidate, by distance or by place. With more, comparing
/// the candidates is quicker than grouping them.
const GROUPS_PER_FOUND: usize = 4;

/// The sort of the candidates of a search in slices: closest first; of equal distances, by the
/// places at which clips are left and then entered. Hundreds of thousands take longer than a frame
/// of the screen; a step of [`advance`](Self::advance) takes some milliseconds.
///
/// Distances are multiples of 0.001 cm and places have numbers, so that very many candidates are
/// grouped by them, without comparisons.
#[derive(Clone, Debug)]
pub struct CandidateSort {
    set: Arc<FrameSet>,
    candidates: Candidates,
    /// The candidates in the order of the groupings so far, by their indices.
    order: Vec<usize>,
    /// The steps that are left, in reverse order: the next one is taken from the end.
    steps: Vec<Step>,
}

/// A step of the sort.
#[derive(Clone, Copy, Debug)]
enum Step {
    /// Drops all but this number of the closest.
    KeepClosest(usize),
    // The least significant key first: a grouping keeps the order of the one before within its
    // groups.
    GroupByEntry,
    GroupByExit,
    GroupByDistance,
    /// Moves the candidates to their places.
    Move,
}

impl CandidateSort {
    /// Returns the sort of candidates, of which at most `most` are kept.
    pub(super) fn new(set: Arc<FrameSet>, candidates: Candidates, most: usize) -> Self {
        let steps = vec![
            Step::Move,
            Step::GroupByDistance,
            Step::GroupByExit,
            Step::GroupByEntry,
            Step::KeepClosest(most),
        ];
        Self { set, candidates, order: Vec::new(), steps }
    }

    /// Returns the sort of the candidates of all tiles of a set's matrix together, which may come
    /// in any order.
    #[must_use]
    pub fn of_tiles(
        set: &Arc<FrameSet>,
        options: &GraphOptions,
        tiles: impl IntoIterator<Item = TileCandidates>,
    ) -> Self {
        let mut picker = Picker::new(Arc::clone(set), *options);
        for tile in tiles {
            picker.absorb(tile);
        }
        picker.into_sort()
    }

    /// Does the next step; returns `true` when nothing is left to do.
    pub fn advance(&mut self) -> bool {
        let Self { set, candidates, order, steps } = self;
        let found = &mut candidates.found;
        let number = |place: Place| set.number(place).unwrap_or(0);
        match steps.pop() {
            Some(Step::KeepClosest(most)) => {
                candidates.left_out += keep_closest(found, most);
                if distance_groups(found).max(set.frames()) > GROUPS_PER_FOUND * found.len() {
                    found.sort_unstable_by(closest_first);
                    steps.clear();
                } else {
                    *order = (0..found.len()).collect();
                }
            }
            Some(Step::GroupByEntry) => {
                *order = regrouped(order, set.frames(), found, |of| number(of.enter));
            }
            Some(Step::GroupByExit) => {
                *order = regrouped(order, set.frames(), found, |of| number(of.leave));
            }
            Some(Step::GroupByDistance) => {
                *order = regrouped(order, distance_groups(found), found, thousandths);
            }
            Some(Step::Move) => *found = order.iter().map(|&at| found[at]).collect(),
            None => {}
        }
        self.steps.is_empty()
    }

    /// Does what is left to do, and returns the candidates.
    #[must_use]
    pub fn finish(mut self) -> Candidates {
        while !self.advance() {}
        self.candidates
    }
}

/// Returns indices of candidates, grouped by a key below `groups`; within a group in the order that
/// they have.
fn regrouped(
    order: &[usize],
    groups: usize,
    found: &[Candidate],
    key: impl Fn(&Candidate) -> usize,
) -> Vec<usize> {
    // Computed in memory order: in the order of the groups, nearly every read of a candidate would
    // be a cache miss.
    let keys: Vec<usize> = found.iter().map(key).collect();
    let (_, by_key) = grouped(groups, order.iter().map(|&at| keys[at]));
    by_key.into_iter().map(|at| order[at]).collect()
}

/// Returns the distance of a candidate in units of 0.001 cm.
fn thousandths(of: &Candidate) -> usize {
    (of.distance_cm * 1_000.0).round_ties_even() as usize
}

/// Returns the number of groups by distance: one more than the greatest distance in units of
/// 0.001 cm.
fn distance_groups(found: &[Candidate]) -> usize {
    found.iter().map(thousandths).max().map_or(0, |most| most.saturating_add(1))
}

/// Drops all but the `most` closest candidates, and returns the number of the dropped ones. The
/// order may change.
pub(super) fn keep_closest(found: &mut Vec<Candidate>, most: usize) -> usize {
    let extra = found.len().saturating_sub(most);
    if extra == 0 {
        return 0;
    }
    let groups = distance_groups(found);
    if groups > GROUPS_PER_FOUND * found.len() {
        found.select_nth_unstable_by(most, closest_first);
        found.truncate(most);
        return extra;
    }
    let mut counts = vec![0; groups];
    for of in found.iter() {
        counts[thousandths(of)] += 1;
    }
    // The distance at which only some of the candidates are kept.
    let mut within = 0;
    let limit = counts.iter().position(|count| {
        within += count;
        within > most
    });
    let limit = limit.unwrap_or(groups);
    let mut farthest: Vec<Candidate> =
        found.iter().copied().filter(|of| thousandths(of) == limit).collect();
    found.retain(|of| thousandths(of) < limit);
    let kept = most.saturating_sub(found.len()).min(farthest.len());
    if kept < farthest.len() {
        farthest.select_nth_unstable_by(kept, closest_first);
    }
    found.extend(farthest.into_iter().take(kept));
    extra
}

fn closest_first(a: &Candidate, b: &Candidate) -> Ordering {
    let places = |of: &Candidate| (of.leave, of.enter);
    a.distance_cm.total_cmp(&b.distance_cm).then(places(a).cmp(&places(b)))
}

#[cfg(test)]
mod tests {
    use super::super::tests::three;
    use super::*;
    use crate::math::Planar;
    use proptest::prelude::*;
    use std::sync::LazyLock;

    static SET: LazyLock<Arc<FrameSet>> = LazyLock::new(|| three([9; 3]));

    proptest! {
        #[test]
        fn closest_candidates_are_kept_in_their_order(
            found in prop::collection::vec((0..90_000_u32, 0..3_usize, 0..9_usize, 0..9_usize), 0..300),
            scale in prop::sample::select(vec![1_u32, 300, 30_000]),
            most in 0..320_usize,
        ) {
            let found: Vec<Candidate> = found
                .into_iter()
                .map(|(thousandths, clip, leave, enter)| Candidate {
                    leave: Place { clip, frame: leave },
                    enter: Place { clip, frame: enter },
                    distance_cm: f64::from(thousandths / scale) / 1_000.0,
                    alignment: Planar::IDENTITY,
                })
                .collect();
            let mut expected = found.clone();
            expected.sort_by(closest_first);
            let left_out = expected.len().saturating_sub(most);
            expected.truncate(most);
            let candidates =
                Candidates { found, nearest_cm: None, left_out: 3, threshold_cm: 90.0 };
            let sorted = CandidateSort::new(Arc::clone(&SET), candidates, most).finish();
            prop_assert_eq!((sorted.found, sorted.left_out), (expected, 3 + left_out));
        }
    }
}
