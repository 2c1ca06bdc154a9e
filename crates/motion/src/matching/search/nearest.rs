//! The search for several frames.

use super::{Candidates, Hit, Query};
use std::collections::BinaryHeap;

/// A hit, ordered so that the one that every other beats is the greatest.
#[derive(PartialEq)]
struct Worst(Hit);

impl Eq for Worst {}

impl Ord for Worst {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        let (own, other) = (&self.0, &other.0);
        own.cost.total_cmp(&other.cost).then(own.frame.cmp(&other.frame))
    }
}

impl PartialOrd for Worst {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

/// Returns the `count` admitted frames of least cost, the best first; of equal costs the earlier
/// frame. Fewer where fewer are admitted, none where the query is not a finite row. The first is
/// that of [`scan`](super::scan). O(frames × dimensions).
#[must_use]
pub fn scan_nearest(candidates: &Candidates<'_>, query: &Query<'_>, count: usize) -> Vec<Hit> {
    if !query.is_sound(candidates.features.layout().dims()) {
        return Vec::new();
    }
    let mut best = BinaryHeap::new();
    for &frame in candidates.valid {
        let frame = frame as usize;
        let tags = candidates.tags.get(frame).copied().unwrap_or_default();
        let Some(row) = candidates.features.row(frame).filter(|_| query.filter.admits(tags)) else {
            continue;
        };
        best.push(Worst(Hit { frame, cost: query.cost(row) }));
        if best.len() > count {
            best.pop();
        }
    }
    best.into_sorted_vec().into_iter().map(|Worst(hit)| hit).collect()
}
