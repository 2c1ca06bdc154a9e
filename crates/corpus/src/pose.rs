//! Poses of a clip on the standard body, as they lie in a shard.

use crate::CorpusError;
use crate::bytes::{Reader, f32s, push_f32s, push_u32};
use crate::rotation::{decode_rotation, encode_rotation};
use glam::Vec3;
use segue_motion::clip::{Clip, Contacts};
use segue_motion::skeleton::{Side, Skeleton};
use std::sync::Arc;

/// The first bytes of a clip.
const MARK: [u8; 4] = *b"SGPO";
/// Bytes before the frames of a clip.
const HEAD_BYTES: usize = 16;
/// Bytes of a rotation.
const ROTATION_BYTES: usize = 6;

/// A clip that was read from a shard.
#[derive(Clone, Debug)]
pub struct PoseClip {
    /// The clip, on the standard body.
    pub clip: Clip,
    /// The contacts of its feet.
    pub contacts: Contacts,
}

/// Returns the bytes of a clip: `SGPO`, frames and joints (u32), frames per second (f32), then for
/// all frames the root's positions (three f32, metres), the contacts (a byte: 1 left, 2 right), and
/// the rotations of all joints in their parents (six bytes, [`encode_rotation`]).
///
/// # Errors
/// [`CorpusError::TooLarge`].
pub fn encode_poses(clip: &Clip, contacts: &Contacts) -> Result<Vec<u8>, CorpusError> {
    let (frames, joints) = (clip.frames(), clip.skeleton().len());
    let mut out = MARK.to_vec();
    push_u32(&mut out, frames)?;
    push_u32(&mut out, joints)?;
    push_f32s(&mut out, [clip.fps() as f32]);
    push_f32s(&mut out, clip.root_translations().iter().flat_map(Vec3::to_array));
    out.extend((0..frames).map(|frame| {
        let of = |side, bit| if contacts.planted(side, frame) { bit } else { 0 };
        of(Side::Left, 1u8) | of(Side::Right, 2)
    }));
    for frame in 0..frames {
        out.extend(clip.rotations(frame).iter().flat_map(|own| encode_rotation(*own)));
    }
    Ok(out)
}

/// Returns the number of bytes of a clip.
pub(crate) const fn poses_bytes(frames: usize, joints: usize) -> usize {
    HEAD_BYTES + frames * (12 + 1 + joints * ROTATION_BYTES)
}

/// Reads a clip: the range of a shard that its row names.
///
/// # Errors
/// [`CorpusError`] if these are not the bytes of one clip on this skeleton.
pub fn decode_poses(
    name: &str,
    bytes: &[u8],
    skeleton: &Arc<Skeleton>,
) -> Result<PoseClip, CorpusError> {
    let mut reader = Reader::new(bytes, "poses");
    reader.mark(MARK)?;
    let (frames, joints) = (reader.u32()? as usize, reader.u32()? as usize);
    if joints != skeleton.len() {
        let expected = skeleton.len();
        return Err(CorpusError::Mismatch { what: "joints of poses", found: joints, expected });
    }
    let fps = f64::from(reader.f32()?);
    let root: Vec<f32> = f32s(reader.take_items(frames, 12)?).collect();
    let flags = reader.take(frames)?;
    let rotations = reader.take_items(frames, joints * ROTATION_BYTES)?;
    reader.end()?;
    let rotations = rotations.chunks_exact(ROTATION_BYTES).map(|bytes| {
        let mut own = [0; ROTATION_BYTES];
        own.copy_from_slice(bytes);
        decode_rotation(own)
    });
    let root = root.chunks_exact(3).map(Vec3::from_slice).collect();
    let clip = Clip::new(name, Arc::clone(skeleton), fps, rotations.collect(), root)?;
    let planted = |bit: u8| flags.iter().map(|flag| flag & bit != 0).collect();
    Ok(PoseClip { clip, contacts: Contacts::from_flags([planted(1), planted(2)]) })
}
