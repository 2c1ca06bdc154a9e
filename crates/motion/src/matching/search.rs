//! Three searches that agree: a plain scan, boxes, and a k-d tree.
//!
//! Each returns the frame of least cost that a filter admits; of equal costs the first frame. The
//! cost of a frame is `Σ (w_d (q_d - x_d))²`, summed in the order of dimensions in `f32`, so that
//! every search computes the same bits. Bounds are computed in the same order from the nearest
//! value in a box: as rounding is monotonic, a bound is never above the cost of a frame in its box,
//! and no tolerance is needed.

mod boxes;
mod build;
mod nearest;
mod scan;
mod tree;

pub use boxes::{BoxIndex, BoxMasks};
pub use build::BoxBuilder;
pub use nearest::scan_nearest;
pub use scan::scan;
pub use tree::TreeIndex;

use super::tags::{TagFilter, TagSet};

/// A frame and its cost.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Hit {
    /// The frame's number in the database.
    pub frame: usize,
    /// The sum of squared, weighted, normalised differences.
    pub cost: f32,
}

impl Hit {
    /// Returns whether it precedes another: it costs less, or the same and is the earlier frame.
    #[must_use]
    pub fn beats(&self, other: &Self) -> bool {
        self.cost < other.cost || (self.cost == other.cost && self.frame < other.frame)
    }
}

/// A query.
#[derive(Clone, Copy, Debug)]
pub struct Query<'a> {
    /// The normalised features that are searched for.
    pub row: &'a [f32],
    /// One factor for each dimension.
    pub weights: &'a [f32],
    /// The filter of frames.
    pub filter: TagFilter,
}

/// The result of a search.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SearchResult {
    /// The frame of least cost; `None` where no frame is admitted, or the query is not a finite
    /// row.
    pub best: Option<Hit>,
    /// Number of frames whose cost was computed, in whole or in part.
    pub visited: usize,
}

impl Query<'_> {
    /// Returns the cost of a row of features.
    #[must_use]
    pub fn cost(&self, row: &[f32]) -> f32 {
        let mut cost = 0.0;
        for ((q, w), x) in self.row.iter().zip(self.weights).zip(row) {
            let difference = w * (q - x);
            cost += difference * difference;
        }
        cost
    }

    /// Returns whether query and weights have this number of dimensions, and are finite.
    pub(super) fn is_sound(&self, dims: usize) -> bool {
        self.row.len() == dims
            && self.weights.len() == dims
            && self.row.iter().all(|q| q.is_finite())
            && self.weights.iter().all(|w| w.is_finite() && *w >= 0.0)
    }
}

/// The frames of a search: rows, their tags, and which of them are valid.
#[derive(Clone, Copy, Debug)]
pub struct Candidates<'a> {
    /// Normalised rows.
    pub features: &'a super::Features,
    /// Tags of each row.
    pub tags: &'a [TagSet],
    /// The rows that may be found, in rising order: those whose trajectory is known.
    pub valid: &'a [u32],
}

#[cfg(test)]
mod tests;
