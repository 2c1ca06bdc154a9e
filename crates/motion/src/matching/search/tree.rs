//! Exact search by a k-d tree.

use super::{Candidates, Hit, Query, SearchResult};
use crate::matching::TagFilter;
use crate::matching::features::MAX_DIMS;
use kiddo::{ImmutableKdTree, SquaredEuclidean};

/// Number of dimensions of the default features.
const DEFAULT_DIMS: usize = 27;

/// The crate `kiddo`'s k-d tree over the admitted frames.
///
/// Its coordinates are features times weights, and it holds admitted frames only: new weights or
/// another filter need a new tree, where [`super::BoxIndex`] needs none. The tree sums distances in
/// an order of its own; the frames within rounding of the nearest are evaluated again, so that cost
/// and frame are those of the other searches.
#[derive(Debug)]
pub struct TreeIndex {
    tree: Tree,
    /// Frames by their number in the tree.
    ids: Vec<u32>,
    weights: Vec<f32>,
    filter: TagFilter,
}

#[derive(Debug)]
enum Tree {
    Usual(Box<ImmutableKdTree<f32, DEFAULT_DIMS>>),
    /// Rows of other lengths, padded with zeros.
    Any(Box<ImmutableKdTree<f32, MAX_DIMS>>),
}

/// The relative rounding error in `f32` over at most [`MAX_DIMS`] terms.
const ROUNDING_SHARE: f32 = 2e-5;

impl TreeIndex {
    /// Returns a tree for these weights and this filter; `None` where no frame is admitted, or the
    /// tree cannot be built (very many equal rows).
    #[must_use]
    pub fn new(candidates: &Candidates<'_>, weights: &[f32], filter: TagFilter) -> Option<Self> {
        let admitted = |&&id: &&u32| {
            filter.admits(candidates.tags.get(id as usize).copied().unwrap_or_default())
        };
        let ids: Vec<u32> = candidates.valid.iter().filter(admitted).copied().collect();
        if ids.is_empty() {
            return None;
        }
        let tree = if candidates.features.layout().dims() == DEFAULT_DIMS {
            Tree::Usual(Box::new(
                ImmutableKdTree::new_from_slice(&points(candidates, &ids, weights)).ok()?,
            ))
        } else {
            Tree::Any(Box::new(
                ImmutableKdTree::new_from_slice(&points(candidates, &ids, weights)).ok()?,
            ))
        };
        Some(Self { tree, ids, weights: weights.to_vec(), filter })
    }

    /// Returns whether it was built for these weights and this filter.
    #[must_use]
    pub fn fits(&self, weights: &[f32], filter: TagFilter) -> bool {
        self.weights == weights && self.filter == filter
    }

    /// Returns the best admitted frame; nothing for a query for which the tree was not built. The
    /// tree does not report the frames that it visits: `visited` counts those that were evaluated
    /// again.
    #[must_use]
    pub fn search(&self, candidates: &Candidates<'_>, query: &Query<'_>) -> SearchResult {
        let mut found = SearchResult::default();
        if !query.is_sound(candidates.features.layout().dims())
            || !self.fits(query.weights, query.filter)
        {
            return found;
        }
        let near = match &self.tree {
            Tree::Usual(tree) => near(tree, &point(query.row, query.weights)),
            Tree::Any(tree) => near(tree, &point(query.row, query.weights)),
        };
        for item in near {
            let Some(&id) = self.ids.get(item) else {
                continue;
            };
            let Some(row) = candidates.features.row(id as usize) else {
                continue;
            };
            found.visited += 1;
            let hit = Hit { frame: id as usize, cost: query.cost(row) };
            if found.best.is_none_or(|best| hit.beats(&best)) {
                found.best = Some(hit);
            }
        }
        found
    }
}

/// Returns all points that are no farther than the nearest, within rounding.
fn near<const K: usize>(tree: &ImmutableKdTree<f32, K>, query: &[f32; K]) -> Vec<usize> {
    let nearest = tree.query(query).nearest_one::<SquaredEuclidean<f32>>().execute();
    let radius = nearest.distance * (1.0 + ROUNDING_SHARE) + f32::MIN_POSITIVE;
    let within = tree.query(query).within::<SquaredEuclidean<f32>>(radius).unsorted().execute();
    within.into_iter().map(|item| item.item as usize).collect()
}

fn point<const K: usize>(row: &[f32], weights: &[f32]) -> [f32; K] {
    let mut point = [0.0; K];
    for (to, (value, weight)) in point.iter_mut().zip(row.iter().zip(weights)) {
        *to = value * weight;
    }
    point
}

fn points<const K: usize>(
    candidates: &Candidates<'_>,
    ids: &[u32],
    weights: &[f32],
) -> Vec<[f32; K]> {
    let row = |id: u32| candidates.features.row(id as usize).unwrap_or(&[]);
    ids.iter().map(|&id| point(row(id), weights)).collect()
}
