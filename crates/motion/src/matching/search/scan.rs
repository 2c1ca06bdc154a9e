//! The slow, obvious search.

use super::{Candidates, Hit, Query, SearchResult};

/// Scans every admitted frame. O(frames × dimensions).
#[must_use]
pub fn scan(candidates: &Candidates<'_>, query: &Query<'_>) -> SearchResult {
    let mut found = SearchResult::default();
    if !query.is_sound(candidates.features.layout().dims()) {
        return found;
    }
    for &frame in candidates.valid {
        let frame = frame as usize;
        let tags = candidates.tags.get(frame).copied().unwrap_or_default();
        let Some(row) = candidates.features.row(frame).filter(|_| query.filter.admits(tags)) else {
            continue;
        };
        found.visited += 1;
        let hit = Hit { frame, cost: query.cost(row) };
        if found.best.is_none_or(|best| hit.beats(&best)) {
            found.best = Some(hit);
        }
    }
    found
}
