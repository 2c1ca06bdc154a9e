//! Construction of the index.

use super::centroids::Centroids;
use super::list::{self, Member};
use super::{MARK, VERSION, probes};
use crate::CorpusError;
use crate::bytes::{push_f32s, push_u32};
use crate::pack::SHARD_BYTES;
use crate::packed::{push_numbers, push_packed};

/// The greatest number of lists.
const MAX_LISTS: usize = 16_384;

/// The scaled features of a clip's moments.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MomentRows {
    /// The number of the clip's row in the table.
    pub(crate) clip: usize,
    /// The number of its moments.
    pub(crate) count: usize,
}

/// The files of an index.
#[derive(Clone, Debug)]
pub(crate) struct IndexFiles {
    /// The centroids, and the places of lists.
    pub(crate) centroids: Vec<u8>,
    /// The lists.
    pub(crate) lists: Vec<Vec<u8>>,
    /// The number of lists.
    pub(crate) count: usize,
    /// The number of lists that a search reads.
    pub(crate) probes: usize,
}

/// Builds the index of moments: `rows` has their scaled features (row-major, `dims` numbers each),
/// `clips` says whose they are, in order.
///
/// # Errors
/// [`CorpusError::TooLarge`].
pub(crate) fn build(
    rows: &[f32],
    dims: usize,
    clips: &[MomentRows],
) -> Result<IndexFiles, CorpusError> {
    let moments = rows.len() / dims;
    let mut centroids = Centroids::find(rows, dims, list_count(moments));
    let rounded = Rounded::of(&mut centroids.lists, dims);
    let count = centroids.lists.len() / dims;
    let list_of: Vec<Option<usize>> =
        rows.chunks_exact(dims).map(|row| centroids.list_of(row)).collect();
    let mut members: Vec<Vec<Member<'_>>> = vec![Vec::new(); count];
    let mut all = rows.chunks_exact(dims).zip(&list_of);
    for own in clips {
        let clip = u32::try_from(own.clip).map_err(|_| CorpusError::TooLarge)?;
        for (moment, (row, list)) in (0..).zip(all.by_ref().take(own.count)) {
            if let Some(list) = list {
                members[*list].push(Member { clip, moment, row });
            }
        }
    }
    let mut lists: Vec<Vec<u8>> = vec![Vec::new()];
    let mut lengths = Vec::with_capacity(count);
    for (centre, members) in centroids.lists.chunks_exact(dims).zip(&members) {
        let bytes = list::encode(centre, members)?;
        lengths.push(u32::try_from(bytes.len()).map_err(|_| CorpusError::TooLarge)?);
        let is_full = |last: &Vec<u8>| !last.is_empty() && last.len() + bytes.len() > SHARD_BYTES;
        if lists.last().is_none_or(is_full) {
            lists.push(Vec::new());
        }
        if let Some(last) = lists.last_mut() {
            last.extend(bytes);
        }
    }
    let mut out = MARK.to_vec();
    for number in [VERSION as usize, dims, count, moments] {
        push_u32(&mut out, number)?;
    }
    rounded.push(&mut out)?;
    push_numbers(&mut out, &lengths)?;
    let probes = probes::needed(rows, dims, clips, &list_of, &centroids.lists);
    Ok(IndexFiles { centroids: out, lists, count, probes })
}

/// Returns the number of lists of some moments: a search then reads less of the centroids than of
/// the lists, because a centroid has as many bytes as a moment.
fn list_count(moments: usize) -> usize {
    (4 * moments.isqrt()).clamp(1, MAX_LISTS)
}

/// Centroids in one byte a dimension.
struct Rounded {
    /// The least value of each dimension, and its step.
    scales: Vec<[f32; 2]>,
    /// The bytes of each dimension.
    codes: Vec<Vec<u8>>,
}

impl Rounded {
    /// Rounds centroids, which become those that a reader has: moments are sorted by them.
    fn of(centroids: &mut [f32], dims: usize) -> Self {
        let (mut scales, mut codes) = (Vec::new(), Vec::new());
        for dim in 0..dims {
            let own = || centroids.chunks_exact(dims).map(move |centre| centre[dim]);
            let low = own().fold(f32::INFINITY, f32::min);
            let high = own().fold(f32::NEG_INFINITY, f32::max);
            let step = if high > low { (high - low) / 255.0 } else { 0.0 };
            let low = if low.is_finite() { low } else { 0.0 };
            let code = |value: f32| if step > 0.0 { ((value - low) / step).round() } else { 0.0 };
            let rounded: Vec<u8> = own().map(|value| code(value) as u8).collect();
            for (centre, code) in centroids.chunks_exact_mut(dims).zip(&rounded) {
                centre[dim] = value([low, step], *code);
            }
            scales.push([low, step]);
            codes.push(rounded);
        }
        Self { scales, codes }
    }

    /// Appends scales, then the bytes of each dimension.
    fn push(&self, out: &mut Vec<u8>) -> Result<(), CorpusError> {
        push_f32s(out, self.scales.iter().flatten().copied());
        self.codes.iter().try_for_each(|codes| push_packed(out, codes))
    }
}

/// Returns the value of a byte, given the least value and the step.
pub(super) fn value(scale: [f32; 2], code: u8) -> f32 {
    scale[0] + scale[1] * f32::from(code)
}
