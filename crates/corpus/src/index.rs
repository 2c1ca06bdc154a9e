//! "More like this": the inverted file of moments, and its search.
//!
//! Every moment is in the list of its nearest centroid, as the difference from it in one byte for
//! each dimension. A search reads the lists whose centroids are nearest to the query. With all
//! lists it is exact but for the rounding to bytes.

mod build;
mod centroids;
mod list;
mod probes;
mod search;
#[cfg(test)]
mod tests;

pub(crate) use build::{MomentRows, build};
pub use search::{Hit, Index, ListPlace};

/// The first bytes of the centroids.
const MARK: [u8; 4] = *b"SGCE";
/// The version of the index.
const VERSION: u32 = 2;
/// The numbers that are added side by side.
const LANES: usize = 8;

/// Returns the square of the distance of two rows.
fn squared(a: &[f32], b: &[f32]) -> f32 {
    // Sums side by side, which a processor adds at once, in an order that is always the same.
    let mut sums = [0.0f32; LANES];
    let ((a, a_rest), (b, b_rest)) = (a.as_chunks::<LANES>(), b.as_chunks::<LANES>());
    for (a, b) in a.iter().zip(b) {
        for ((sum, a), b) in sums.iter_mut().zip(a).zip(b) {
            *sum += (a - b) * (a - b);
        }
    }
    for ((sum, a), b) in sums.iter_mut().zip(a_rest).zip(b_rest) {
        *sum += (a - b) * (a - b);
    }
    let [a, b, c, d, e, f, g, h] = sums;
    ((a + b) + (c + d)) + ((e + f) + (g + h))
}
