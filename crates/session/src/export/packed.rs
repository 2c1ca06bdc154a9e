//! Exports on their way to a worker.
//!
//! Writing a long motion as text takes the better part of a second. [`pack`] copies what the file
//! is made of, which takes a few milliseconds, and [`write`] makes the file of it elsewhere, the
//! same to the last bit.

use super::{Column, ExportBody, ExportError, ExportFormat, ExportOptions, export};
use crate::jobs::{Parcel, ParcelError, pack_motion, take, unpack_motion};
use segue_motion::clip::Motion;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// The number of poses from which on writing a file is noticed, joints times frames: half a minute
/// of a body at 60 frames a second.
const MANY_POSES: usize = 60_000;

/// The reason why a packed export gives no file.
#[derive(Debug, thiserror::Error, segue_text::ToMessage)]
pub enum PackedError {
    /// It is damaged.
    #[error("the message to the writer was damaged")]
    Damaged,
    /// The format cannot hold the motion.
    #[error(transparent)]
    Export(#[from] ExportError),
}

impl From<ParcelError> for PackedError {
    fn from(_: ParcelError) -> Self {
        Self::Damaged
    }
}

/// A packed export without its arrays.
#[derive(Serialize, Deserialize)]
struct Head<'a> {
    options: ExportOptions,
    /// The names of the columns.
    columns: Cow<'a, [Cow<'a, str>]>,
    /// The head of the motion.
    motion: Cow<'a, str>,
    /// The number of floats of the motion, and of each column.
    floats: usize,
    frames: usize,
}

/// Returns whether writing a motion takes so long that it is to be done elsewhere, and can be: a
/// mesh does not travel.
#[must_use]
pub fn takes_long(motion: &Motion, has_character: bool, options: &ExportOptions) -> bool {
    let has_mesh = has_character
        && options.format == ExportFormat::Glb
        && options.body == ExportBody::Character;
    motion.clip().skeleton().len().saturating_mul(motion.clip().frames()) > MANY_POSES && !has_mesh
}

/// Packs what [`export`] writes without a character: the length of the head, the head as JSON, the
/// floats of the motion and of the columns, and the other bytes of the motion. Numbers have the
/// byte order of the machine.
///
/// # Errors
/// [`ParcelError::Head`] where something cannot be told in JSON.
pub fn pack(
    motion: &Motion,
    columns: &[Column],
    options: &ExportOptions,
) -> Result<Vec<u8>, ParcelError> {
    let Parcel { head, floats, bytes } = pack_motion(motion)?;
    let names = columns.iter().map(|(name, _)| Cow::Borrowed(&**name));
    let head = serde_json::to_string(&Head {
        options: *options,
        columns: names.collect(),
        motion: head.into(),
        floats: floats.len(),
        frames: motion.clip().frames(),
    })?;
    let arrays = || std::iter::once(&floats).chain(columns.iter().map(|(_, values)| values));
    let length = arrays().map(|floats| size_of_val(&floats[..])).sum::<usize>();
    let mut packed = Vec::with_capacity(8 + head.len() + length + bytes.len());
    packed.extend_from_slice(&(head.len() as u64).to_le_bytes());
    packed.extend_from_slice(head.as_bytes());
    for floats in arrays() {
        packed.extend_from_slice(bytemuck::cast_slice(floats));
    }
    packed.extend_from_slice(&bytes);
    Ok(packed)
}

/// Writes the file of a packed export.
///
/// # Errors
/// [`PackedError`] where it is damaged, or its format cannot hold the motion.
pub fn write(packed: &[u8]) -> Result<Vec<u8>, PackedError> {
    let (length, rest) = packed.split_first_chunk().ok_or(PackedError::Damaged)?;
    let length = usize::try_from(u64::from_le_bytes(*length)).map_err(|_| PackedError::Damaged)?;
    let (head, mut rest) = rest.split_at_checked(length).ok_or(PackedError::Damaged)?;
    let head: Head<'_> = serde_json::from_slice(head).map_err(|_| PackedError::Damaged)?;
    let floats = take::<f32>(&mut rest, head.floats)?;
    let mut columns = Vec::new();
    for name in head.columns.iter() {
        columns.push((name.to_string(), take::<f32>(&mut rest, head.frames)?));
    }
    let parcel = Parcel { head: head.motion.into_owned(), floats, bytes: rest.to_vec() };
    Ok(export(&unpack_motion(&parcel)?, None, &columns, &head.options)?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::export::plotted_of_result;
    use crate::export::tests::blend;
    use segue_motion::clip::{Interpolation, resample};

    #[test]
    fn packed_exports_give_the_same_files() {
        let session = blend();
        let outcome = session.main_outcome().unwrap();
        let columns = plotted_of_result(outcome, session.params());
        assert!(!columns.is_empty());
        for format in ExportFormat::ALL {
            for fps in [None, Some(24.0)] {
                let options = ExportOptions { format, fps, ..ExportOptions::default() };
                let packed = pack(&outcome.motion, &columns, &options).unwrap();
                let made = write(&packed);
                match export(&outcome.motion, None, &columns, &options) {
                    Ok(expected) => assert!(made.is_ok_and(|made| made == expected), "{format:?}"),
                    Err(reason) => {
                        assert_eq!(made.unwrap_err().to_string(), reason.to_string(), "{format:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn damaged_packed_exports_are_refused() {
        let session = blend();
        let motion = &session.main_outcome().unwrap().motion;
        let columns = [("a".to_owned(), vec![0.5; motion.clip().frames()])];
        let packed = pack(motion, &columns, &ExportOptions::default()).unwrap();
        for length in (0..packed.len()).step_by(packed.len() / 97).chain(0..64) {
            assert!(matches!(write(&packed[..length]), Err(PackedError::Damaged)), "{length}");
        }
    }

    #[test]
    fn only_long_motions_without_a_mesh_are_written_elsewhere() {
        let session = blend();
        let motion = &session.main_outcome().unwrap().motion;
        let glb = ExportOptions { format: ExportFormat::Glb, ..ExportOptions::default() };
        assert!(!takes_long(motion, false, &glb), "a blend of seconds");
        let clip = motion.clip();
        let times = MANY_POSES / (clip.frames() * clip.skeleton().len()) + 1;
        let rate = clip.fps() * (times as f64 + 1.0);
        let long = resample(clip, rate, Interpolation::default()).unwrap();
        let long = Motion::with_roles(long, motion.roles());
        assert!(takes_long(&long, false, &glb) && !takes_long(&long, true, &glb));
        let plain = ExportOptions { body: ExportBody::Plain, ..glb };
        assert!(takes_long(&long, true, &plain));
        assert!(takes_long(&long, true, &ExportOptions::default()), "BVH has no body");
    }
}
