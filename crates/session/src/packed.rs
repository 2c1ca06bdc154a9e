//! Motions on their way to a worker that writes files of them.
//!
//! Writing a long motion as text takes the better part of a second. [`pack`] and
//! [`pack_conversion`] return what the file is made of, of which only a character's meshes and
//! textures are copied; [`write`] makes the file of it elsewhere, the same to the last bit.

use crate::convert::{ConvertOptions, ConvertedClip, convert_motion};
use crate::export::{Column, ExportBody, ExportFormat, ExportOptions, export};
use crate::jobs::{Parcel, ParcelError, arrays_of, pack_without_floats, take, unpack_motion};
use crate::reading::{CharacterHead, put_character};
use segue_motion::clip::Motion;
use segue_motion::skin::{Character, SkinnedMesh};
use segue_text::{Message, ToMessage as _};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::sync::Arc;

/// The number of poses from which on writing a file is noticed, joints times frames: half a minute
/// of a body at 60 frames a second.
const MANY_POSES: usize = 60_000;

/// The reason why a packed motion gives no file.
#[derive(Debug, thiserror::Error)]
pub enum PackedError {
    /// It is damaged, or holds what JSON cannot: the file may still be written without packing.
    #[error("the message to the writer was damaged")]
    Damaged,
    /// The format cannot hold the motion, or the motion cannot be retargeted: the reason.
    #[error("{0}")]
    Refused(Message),
}

impl From<ParcelError> for PackedError {
    fn from(_: ParcelError) -> Self {
        Self::Damaged
    }
}

/// The file that a worker writes of a packed motion.
#[derive(Serialize, Deserialize)]
enum Purpose {
    /// The file of [`export`].
    Export(ExportOptions),
    /// The clip of [`convert_motion`].
    Conversion(Box<ConvertOptions>),
}

/// A packed motion without its arrays.
#[derive(Serialize, Deserialize)]
struct Head<'a> {
    purpose: Purpose,
    /// The names of the columns.
    columns: Cow<'a, [Cow<'a, str>]>,
    /// The head of the motion.
    motion: Cow<'a, str>,
    /// The number of floats of the motion, and of each column.
    floats: usize,
    frames: usize,
    /// The head of the character.
    character: Option<CharacterHead>,
}

/// Returns whether writing or converting a motion takes so long that it is to be done elsewhere.
/// To retarget it first takes about as long as to write it.
#[must_use]
pub fn takes_long(motion: &Motion) -> bool {
    motion.clip().skeleton().len().saturating_mul(motion.clip().frames()) > MANY_POSES
}

/// Returns whether a file gets the character on the stage, if there is one.
fn writes_character(options: &ExportOptions) -> bool {
    options.format == ExportFormat::Glb && options.body == ExportBody::Character
}

/// A packed motion, in pieces: its long arrays are those of the motion, without a copy.
#[derive(Debug)]
pub struct Packed<'a> {
    pieces: Vec<Cow<'a, [u8]>>,
}

impl Packed<'_> {
    /// Returns the pieces in their order.
    pub fn pieces(&self) -> impl Iterator<Item = &[u8]> {
        self.pieces.iter().map(|piece| &**piece)
    }

    /// Returns the number of bytes of all pieces.
    #[must_use]
    pub fn size(&self) -> usize {
        self.pieces().map(<[u8]>::len).sum()
    }

    /// Returns the pieces, one behind the other.
    #[must_use]
    pub fn to_vec(&self) -> Vec<u8> {
        self.pieces.concat()
    }
}

/// Packs what [`export`] writes.
///
/// # Errors
/// [`ParcelError::Head`] where something cannot be told in JSON.
pub fn pack<'a>(
    motion: &'a Motion,
    character: Option<&Character>,
    columns: &'a [Column],
    options: &ExportOptions,
) -> Result<Packed<'a>, ParcelError> {
    let character = character.filter(|_| writes_character(options));
    pack_for(Purpose::Export(*options), motion, character, columns)
}

/// Packs what [`convert_motion`] converts. [`read_converted`] reads the bytes that [`write`]
/// returns for it.
///
/// # Errors
/// [`ParcelError::Head`] where something cannot be told in JSON.
pub fn pack_conversion<'a>(
    motion: &'a Motion,
    mesh: Option<&Arc<SkinnedMesh>>,
    options: &ConvertOptions,
) -> Result<Packed<'a>, ParcelError> {
    let mesh = mesh.filter(|_| writes_character(&options.export) && options.rig.is_none());
    let character = mesh.map(|mesh| Character {
        skeleton: Arc::clone(motion.clip().skeleton()),
        roles: motion.roles().clone(),
        mesh: Arc::clone(mesh),
    });
    let purpose = Purpose::Conversion(Box::new(options.clone()));
    pack_for(purpose, motion, character.as_ref(), &[])
}

/// Packs a motion: the length of the head, the head as JSON, the floats of the motion and of the
/// columns, the arrays of the character, and the other bytes of the motion. Numbers have the byte
/// order of the machine.
fn pack_for<'a>(
    purpose: Purpose,
    motion: &'a Motion,
    character: Option<&Character>,
    columns: &'a [Column],
) -> Result<Packed<'a>, ParcelError> {
    let Parcel { head, bytes, .. } = pack_without_floats(motion)?;
    let names = columns.iter().map(|(name, _)| Cow::Borrowed(&**name));
    let head = serde_json::to_string(&Head {
        purpose,
        columns: names.collect(),
        motion: head.into(),
        floats: arrays_of(motion.clip()).map(<[f32]>::len).sum(),
        frames: motion.clip().frames(),
        character: character.map(CharacterHead::of),
    })?;
    let mut pieces = vec![Cow::Owned(with_head(&head, 8 + head.len()))];
    pieces.extend(arrays_of(motion.clip()).map(|floats| bytemuck::cast_slice(floats).into()));
    pieces.extend(columns.iter().map(|(_, values)| bytemuck::cast_slice(values).into()));
    if let Some(character) = character {
        let mut arrays = Vec::with_capacity(CharacterHead::of(character).bytes());
        put_character(&mut arrays, character);
        pieces.push(arrays.into());
    }
    pieces.push(bytes.into());
    Ok(Packed { pieces })
}

/// Writes the file of a packed motion. A conversion gives the bytes that [`read_converted`]
/// reads.
///
/// # Errors
/// [`PackedError`]: the reason why there is no file.
pub fn write(packed: &[u8]) -> Result<Vec<u8>, PackedError> {
    let Unpacked { purpose, motion, character, columns } = unpack(packed)?;
    match purpose {
        Purpose::Export(options) => export(&motion, character.as_ref(), &columns, &options)
            .map_err(|error| PackedError::Refused(error.to_message())),
        Purpose::Conversion(options) => {
            let mesh = character.as_ref().map(|character| &character.mesh);
            let made = convert_motion(&motion, mesh, &options).map_err(PackedError::Refused)?;
            let head = serde_json::to_string(&made).map_err(|_| PackedError::Damaged)?;
            let deflated = made.file.deflated;
            let mut bytes = with_head(&head, 8 + head.len() + deflated.len());
            bytes.extend_from_slice(&deflated);
            Ok(bytes)
        }
    }
}

/// Returns the clip that [`write`] has made of a packed conversion; `None` where it is damaged.
#[must_use]
pub fn read_converted(made: &[u8]) -> Option<ConvertedClip> {
    let (head, deflated) = split_head(made)?;
    let mut clip: ConvertedClip = serde_json::from_slice(head).ok()?;
    clip.file.deflated = deflated.to_vec();
    Some(clip)
}

/// A motion as it was packed.
struct Unpacked {
    purpose: Purpose,
    motion: Motion,
    character: Option<Character>,
    columns: Vec<Column>,
}

fn unpack(packed: &[u8]) -> Result<Unpacked, ParcelError> {
    let (head, mut rest) = split_head(packed).ok_or(ParcelError::Arrays)?;
    let head: Head<'_> = serde_json::from_slice(head)?;
    let floats = take::<f32>(&mut rest, head.floats)?;
    let mut columns = Vec::new();
    for name in head.columns.iter() {
        columns.push((name.to_string(), take::<f32>(&mut rest, head.frames)?));
    }
    let character = match head.character {
        Some(character) => Some(character.take(&mut rest).ok_or(ParcelError::Arrays)?),
        None => None,
    };
    let parcel = Parcel {
        head: head.motion.into_owned(),
        floats,
        bytes: rest.to_vec(),
        ..Parcel::default()
    };
    Ok(Unpacked { purpose: head.purpose, motion: unpack_motion(&parcel)?, character, columns })
}

/// Returns bytes that begin with the length of a head and the head, with room for `length` in all.
fn with_head(head: &str, length: usize) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(length);
    bytes.extend_from_slice(&(head.len() as u64).to_le_bytes());
    bytes.extend_from_slice(head.as_bytes());
    bytes
}

/// Splits bytes that begin as those of [`with_head`] after the head.
fn split_head(bytes: &[u8]) -> Option<(&[u8], &[u8])> {
    let (length, rest) = bytes.split_first_chunk()?;
    rest.split_at_checked(usize::try_from(u64::from_le_bytes(*length)).ok()?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::convert::TargetRig;
    use crate::export::plotted_of_result;
    use crate::export::tests::blend;
    use glam::{Quat, Vec3};
    use segue_motion::clip::{Clip, Interpolation, resample};
    use segue_motion::skeleton::{Roles, fixtures::mixamo};
    use segue_motion::skin::{AlphaMode, Sampler, Texture, TexturedPart, Wrap};

    #[test]
    fn packed_exports_give_the_same_files() {
        let session = blend();
        let outcome = session.main_outcome().unwrap();
        let columns = plotted_of_result(outcome, session.params());
        assert!(!columns.is_empty());
        for format in ExportFormat::ALL {
            for fps in [None, Some(24.0)] {
                let options = ExportOptions { format, fps, ..ExportOptions::default() };
                let packed = pack(&outcome.motion, None, &columns, &options).unwrap();
                let packed = packed.to_vec();
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

    /// Returns a character of another rig, with a texture.
    fn textured_character() -> Character {
        let skeleton = mixamo();
        let roles = Roles::detect(&skeleton);
        let mut mesh = SkinnedMesh::around(&skeleton, &roles, 1.0);
        mesh.coordinates = mesh.positions.iter().map(|at| [at.x, at.y]).collect();
        let png = [b"\x89PNG\r\n\x1a\n", &[7; 300][..]].concat();
        mesh.textured = vec![TexturedPart {
            triangles: 3..mesh.triangles.len(),
            texture: Texture {
                image: png.into(),
                sampler: Sampler { wraps: [Wrap::Clamp, Wrap::Mirror], is_nearest: true },
                alpha: AlphaMode::Mask(0.25),
            },
        }];
        Character { skeleton, roles, mesh: Arc::new(mesh) }
    }

    #[test]
    fn packed_exports_of_a_character_give_the_same_files() {
        let session = blend();
        let motion = &session.main_outcome().unwrap().motion;
        let character = textured_character();
        let glb = ExportOptions { format: ExportFormat::Glb, ..ExportOptions::default() };
        let plain = ExportOptions { body: ExportBody::Plain, ..glb };
        for options in [glb, ExportOptions { fps: Some(24.0), ..glb }, plain] {
            let packed = pack(motion, Some(&character), &[], &options).unwrap();
            let made = write(&packed.to_vec()).unwrap();
            let expected = export(motion, Some(&character), &[], &options).unwrap();
            assert!(made == expected, "{:?}", options.body);
            let has_png = made.windows(4).any(|found| found == b"\x89PNG");
            assert_eq!(has_png, options.body == ExportBody::Character);
        }
        let [bvh, alone] = [Some(&character), None].map(|character| {
            let packed = pack(motion, character, &[], &ExportOptions::default()).unwrap();
            assert_eq!(packed.size(), packed.to_vec().len());
            packed.to_vec()
        });
        assert!(bvh == alone, "a format without bodies takes no mesh along");
    }

    #[test]
    fn packed_conversions_give_the_same_clips() {
        let session = blend();
        let motion = &session.main_outcome().unwrap().motion;
        let mesh = SkinnedMesh::around(motion.clip().skeleton(), motion.roles(), 1.0);
        let mesh = Arc::new(mesh);
        let Character { skeleton, roles, .. } = textured_character();
        let rest = vec![Quat::IDENTITY; skeleton.len()];
        let standing = Clip::new("", skeleton, 30.0, rest, vec![Vec3::Y]).unwrap();
        let rig = TargetRig::of(&Motion::with_roles(standing, &roles));
        for format in ExportFormat::ALL {
            for rig in [None, Some(rig.clone())] {
                let export = ExportOptions { format, ..ExportOptions::default() };
                let options = ConvertOptions { export, rig };
                let packed = pack_conversion(motion, Some(&mesh), &options).unwrap().to_vec();
                match convert_motion(motion, Some(&mesh), &options) {
                    Ok(expected) => {
                        let made = write(&packed).unwrap();
                        assert_eq!(read_converted(&made), Some(expected), "{format:?}");
                    }
                    Err(expected) => {
                        assert_eq!(format, ExportFormat::G1Csv, "{expected}");
                        let reason = write(&packed).unwrap_err().to_string();
                        assert_eq!(reason, expected.to_string());
                    }
                }
            }
        }
        let packed = pack_conversion(motion, None, &ConvertOptions::default()).unwrap();
        let made = write(&packed.to_vec()).unwrap();
        for length in 0..64 {
            assert!(read_converted(&made[..length]).is_none(), "{length}");
        }
    }

    #[test]
    fn damaged_packed_exports_are_refused() {
        let session = blend();
        let motion = &session.main_outcome().unwrap().motion;
        let columns = vec![("a".to_owned(), vec![0.5; motion.clip().frames()])];
        let character = textured_character();
        for format in [ExportFormat::Bvh, ExportFormat::Glb] {
            let options = ExportOptions { format, ..ExportOptions::default() };
            let packed = pack(motion, Some(&character), &columns, &options).unwrap().to_vec();
            for length in (0..packed.len()).step_by(packed.len() / 97).chain(0..64) {
                let cut = write(&packed[..length]);
                assert!(matches!(cut, Err(PackedError::Damaged)), "{length}");
            }
        }
    }

    #[test]
    fn only_long_motions_are_written_elsewhere() {
        let session = blend();
        let motion = &session.main_outcome().unwrap().motion;
        assert!(!takes_long(motion), "a blend of seconds");
        let clip = motion.clip();
        let rate = (MANY_POSES / clip.skeleton().len() + 2) as f64 / clip.duration_secs();
        let long = resample(clip, rate, Interpolation::default()).unwrap();
        assert!(takes_long(&Motion::with_roles(long, motion.roles())));
    }
}
