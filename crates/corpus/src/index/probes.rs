//! The number of lists that a search probes.
//!
//! The more alike the clips of a corpus are, the more lists the neighbours of a moment lie in.
//! The number is therefore measured on the corpus itself: the ten nearest moments of some moments,
//! in other clips than their own, are found exhaustively, and as many lists are read as have nearly
//! all of them.

use super::build::MomentRows;
use super::squared;

/// The number of moments that are looked up.
const QUERIES: usize = 128;
/// The number of their neighbours.
const NEIGHBOURS: usize = 10;
/// The share of neighbours that are found: more than the promised 95 %, because distances are
/// rounded, and others may ask than these moments.
const SHARE: f64 = 0.975;
/// The least and the greatest number of lists.
const LIMITS: [usize; 2] = [8, 64];

/// Returns the number of lists that a search reads. `rows` has the features of all moments,
/// `list_of` the list of each.
pub(super) fn needed(
    rows: &[f32],
    dims: usize,
    clips: &[MomentRows],
    list_of: &[Option<usize>],
    lists: &[f32],
) -> usize {
    let mut ranks: Vec<usize> = Vec::new();
    let step = (list_of.len() / QUERIES).max(1);
    let mut start = 0;
    for clip in clips {
        let own = start..start + clip.count;
        start = own.end;
        // The moments of this clip that are looked up.
        for query in own.clone().filter(|moment| moment % step == step / 2) {
            let Some(query) = rows.get(query * dims..(query + 1) * dims) else { continue };
            let near = nearest(query, rows, dims, &own);
            let order = list_ranks(query, lists, dims);
            ranks.extend(
                near.into_iter().filter_map(|moment| order.get((*list_of.get(moment)?)?).copied()),
            );
        }
    }
    ranks.sort_unstable();
    let at = (ranks.len() as f64 * SHARE).ceil() as usize;
    let worst = at.checked_sub(1).and_then(|at| ranks.get(at));
    worst.map_or(LIMITS[0], |rank| rank + 1).clamp(LIMITS[0], LIMITS[1])
}

/// Returns the moments nearest to a query, without some of them.
fn nearest(
    query: &[f32],
    rows: &[f32],
    dims: usize,
    without: &std::ops::Range<usize>,
) -> Vec<usize> {
    let mut best: Vec<(f32, usize)> = Vec::with_capacity(NEIGHBOURS + 1);
    for (moment, row) in rows.chunks_exact(dims).enumerate() {
        let distance = squared(query, row);
        let is_full = best.len() == NEIGHBOURS;
        if is_full && best.last().is_some_and(|last| distance >= last.0)
            || without.contains(&moment)
        {
            continue;
        }
        let at = best.partition_point(|own| own.0 <= distance);
        best.insert(at, (distance, moment));
        best.truncate(NEIGHBOURS);
    }
    best.into_iter().map(|(_, moment)| moment).collect()
}

/// Returns for each list how many others are nearer to a query.
fn list_ranks(query: &[f32], lists: &[f32], dims: usize) -> Vec<usize> {
    let distances: Vec<f32> =
        lists.chunks_exact(dims).map(|centre| squared(query, centre)).collect();
    let mut order: Vec<usize> = (0..distances.len()).collect();
    order.sort_by(|a, b| distances[*a].total_cmp(&distances[*b]));
    let mut ranks = vec![0; order.len()];
    for (rank, list) in order.into_iter().enumerate() {
        ranks[list] = rank;
    }
    ranks
}
