//! The form in which clips and answers travel.

use bytemuck::{NoUninit, Pod, pod_read_unaligned};
use glam::Quat;
use std::vec;

/// The number of floats of an answer in one message of a worker: the page copies them in about
/// 2 ms. A multiple of 4, so that no rotation is divided.
pub const ANSWER_PIECE_FLOATS: usize = 1 << 19;

/// The size of a buffer that holds a full piece of an answer, bytes. The page gives buffers of this
/// size back.
pub const ANSWER_PIECE_BYTES: usize = size_of::<f32>() * ANSWER_PIECE_FLOATS;

/// A message between a page and its workers: a JSON header, and long arrays. The arrays have the
/// byte order of the machine, on which both sides run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Parcel {
    /// The header.
    pub head: String,
    /// The rotations of each clip of an answer, which are moved into the clip without a copy. Empty
    /// in a clip that is sent to a worker: its rotations are the first of its floats.
    pub rotations: Vec<Vec<Quat>>,
    /// The other numbers.
    pub floats: Vec<f32>,
    /// Everything else, as bytes.
    pub bytes: Vec<u8>,
}

/// The reason why a parcel cannot be made or opened.
#[derive(Debug, thiserror::Error)]
pub enum ParcelError {
    /// An invalid header.
    #[error("the head of a message cannot be read: {0}")]
    Head(#[from] serde_json::Error),
    /// Arrays of other lengths than the header states, or with invalid content.
    #[error("a message has other arrays than its head states")]
    Arrays,
}

/// The values of a parcel that are not read yet. Each read takes values from the front.
#[derive(Debug)]
pub(super) struct ArrayReader<'a> {
    pub(super) rotations: vec::IntoIter<Vec<Quat>>,
    pub(super) floats: &'a [f32],
    pub(super) bytes: &'a [u8],
}

impl<'a> ArrayReader<'a> {
    pub(super) fn new(rotations: Vec<Vec<Quat>>, floats: &'a [f32], bytes: &'a [u8]) -> Self {
        Self { rotations: rotations.into_iter(), floats, bytes }
    }

    /// Takes the `count` rotations of the next clip. An answer has an array of them for each clip;
    /// a clip that is sent to a worker has them among its floats.
    ///
    /// # Errors
    /// [`ParcelError::Arrays`] when there are more or fewer.
    pub(super) fn take_rotations(&mut self, count: usize) -> Result<Vec<Quat>, ParcelError> {
        match self.rotations.next() {
            Some(rotations) if rotations.len() == count => Ok(rotations),
            Some(_) => Err(ParcelError::Arrays),
            None => {
                let floats = split_floats(&mut self.floats, count, 4)?;
                Ok(floats.as_chunks().0.iter().copied().map(Quat::from_array).collect())
            }
        }
    }
}

/// Appends values to bytes.
pub(super) fn put<T: NoUninit>(bytes: &mut Vec<u8>, values: &[T]) {
    bytes.extend_from_slice(bytemuck::cast_slice(values));
}

/// Moves `count` values from the front of `bytes`.
pub(crate) fn take<T: Pod>(bytes: &mut &[u8], count: usize) -> Result<Vec<T>, ParcelError> {
    Ok(split_values(bytes, count)?.collect())
}

/// Moves `count` values from the front of `bytes`, as an iterator.
///
/// # Errors
/// [`ParcelError::Arrays`] when there are fewer.
pub(super) fn split_values<'a, T: Pod>(
    bytes: &mut &'a [u8],
    count: usize,
) -> Result<impl Iterator<Item = T> + 'a, ParcelError> {
    let length = count.checked_mul(size_of::<T>()).ok_or(ParcelError::Arrays)?;
    let (now, later) = bytes.split_at_checked(length).ok_or(ParcelError::Arrays)?;
    *bytes = later;
    Ok(now.chunks_exact(size_of::<T>()).map(pod_read_unaligned))
}

/// Moves `count` numbers from the front of `floats`.
pub(super) fn take_floats(floats: &mut &[f32], count: usize) -> Result<Vec<f32>, ParcelError> {
    Ok(split_floats(floats, count, 1)?.to_vec())
}

/// Splits `rows` rows of `columns` numbers from the front of `floats`.
pub(super) fn split_floats<'a>(
    floats: &mut &'a [f32],
    rows: usize,
    columns: usize,
) -> Result<&'a [f32], ParcelError> {
    let count = rows.checked_mul(columns).ok_or(ParcelError::Arrays)?;
    let (now, later) = floats.split_at_checked(count).ok_or(ParcelError::Arrays)?;
    *floats = later;
    Ok(now)
}
