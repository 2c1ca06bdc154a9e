//! Construction of the index.

use super::centroids::Centroids;
use super::{HEAD_BYTES, MARK, VERSION};
use crate::CorpusError;
use crate::bytes::{push_f32s, push_u32};
use crate::pack::SHARD_BYTES;

/// The greatest number of lists: their centroids are a megabyte.
const MAX_LISTS: usize = 8_192;

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
    let centroids = Centroids::find(rows, dims, list_count(moments));
    let count = centroids.lists.len() / dims;
    let mut members: Vec<Vec<(usize, usize, usize)>> = vec![Vec::new(); count];
    let owners = clips.iter().flat_map(|own| (0..own.count).map(move |moment| (own.clip, moment)));
    for (at, ((clip, moment), row)) in owners.zip(rows.chunks_exact(dims)).enumerate() {
        if let Some(list) = centroids.list_of(row) {
            members[list].push((clip, moment, at));
        }
    }
    let mut out = MARK.to_vec();
    for number in [VERSION as usize, dims, count, moments] {
        push_u32(&mut out, number)?;
    }
    push_f32s(&mut out, centroids.lists.iter().copied());
    let mut lists: Vec<Vec<u8>> = vec![Vec::new()];
    for (list, members) in members.iter().enumerate() {
        let centre = &centroids.lists[list * dims..(list + 1) * dims];
        let bytes = encode(rows, centre, members)?;
        if lists
            .last()
            .is_none_or(|last| !last.is_empty() && last.len() + bytes.len() > SHARD_BYTES)
        {
            lists.push(Vec::new());
        }
        let file = lists.len() - 1;
        let offset = lists[file].len();
        for number in [file, offset, members.len()] {
            push_u32(&mut out, number)?;
        }
        lists[file].extend(bytes);
    }
    Ok(IndexFiles { centroids: out, lists, count })
}

/// Returns the number of lists of some moments: a search then reads about as much of the centroids
/// as of the lists.
fn list_count(moments: usize) -> usize {
    (2 * moments.isqrt()).clamp(1, MAX_LISTS)
}

/// Returns the bytes of a list: clips, then moments (u32), then steps (f32), then the differences
/// from the centroid in steps, an `i8` for each dimension.
fn encode(
    rows: &[f32],
    centre: &[f32],
    members: &[(usize, usize, usize)],
) -> Result<Vec<u8>, CorpusError> {
    let dims = centre.len();
    let mut out = Vec::with_capacity(members.len() * (HEAD_BYTES + dims));
    for (clip, _, _) in members {
        push_u32(&mut out, *clip)?;
    }
    for (_, moment, _) in members {
        push_u32(&mut out, *moment)?;
    }
    let (mut steps, mut codes) = (Vec::new(), Vec::new());
    for (_, _, at) in members {
        let row = &rows[at * dims..(at + 1) * dims];
        let apart = || row.iter().zip(centre).map(|(value, centre)| value - centre);
        let step = apart().fold(0.0f32, |most, apart| most.max(apart.abs())) / 127.0;
        steps.push(step);
        codes.extend(apart().map(|apart| {
            let code = if step > 0.0 { (apart / step).round().clamp(-127.0, 127.0) } else { 0.0 };
            (code as i8).to_le_bytes()[0]
        }));
    }
    push_f32s(&mut out, steps);
    out.extend(codes);
    Ok(out)
}
