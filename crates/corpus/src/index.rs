//! "More like this": the inverted file of moments, and its search.
//!
//! Every moment is in the list of its nearest centroid, as the difference from it in one byte for
//! each dimension. A search reads the lists whose centroids are nearest to the query. With all
//! lists it is exact but for the rounding to bytes.

mod build;
mod centroids;
mod search;
#[cfg(test)]
mod tests;

pub(crate) use build::{MomentRows, build};
pub use search::{Hit, Index, ListPlace};

/// The first bytes of the centroids.
const MARK: [u8; 4] = *b"SGCE";
/// The version of the index.
const VERSION: u32 = 1;
/// Bytes of a moment beside its numbers: clip and row (u32), and the step of its bytes (f32).
const HEAD_BYTES: usize = 12;
/// The probes with which a search finds at least 95 % of the ten nearest moments: the tests hold
/// it.
pub(crate) const PROBES: usize = 16;

/// Returns the square of the distance of two rows.
fn squared(a: &[f32], b: &[f32]) -> f32 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum()
}
