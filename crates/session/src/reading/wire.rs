//! Transfer of a report from a worker: a JSON header, and the long arrays as bytes in pieces, so
//! that neither side copies for longer than a frame. A character goes to a worker in the same form,
//! in one piece.

mod character;
mod parcel;
mod unpacker;

pub(crate) use character::{CharacterHead, put_character};
pub use parcel::Parcel;
pub use unpacker::Unpacker;

use super::{About, SkeletonFile};
use crate::clip_facts::motion_bytes;
use crate::convert::ConvertedClip;
use segue_formats::{FileKind, ImportError};
use segue_motion::clip::{ClipError, Provenance};
use segue_motion::skeleton::{FoldedChain, Joint, Roles, SkeletonError};
use segue_motion::skin::{AlphaMode, Sampler};
use segue_text::Message;
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// The reason why pieces do not form a report.
#[derive(Debug, thiserror::Error, segue_text::ToMessage)]
pub enum WireError {
    /// An invalid header.
    #[error("the head of a report cannot be read: {why}", why = .0.to_string())]
    Head(#[from] serde_json::Error),
    /// Another number of bytes than the header states.
    #[error("a report of {expected} bytes came with {found}")]
    Length {
        /// The number in the header.
        expected: usize,
        /// The number received.
        found: usize,
    },
    /// A report for which there is no memory.
    #[error("there is no memory for its {mb} MB: remove clips that you do not need", mb = .bytes.div_ceil(1_000_000))]
    NoRoom {
        /// The number of its bytes.
        bytes: usize,
    },
    /// Arrays that do not form a clip.
    #[error(transparent)]
    Clip(#[from] ClipError),
    /// Joints that do not form a skeleton.
    #[error(transparent)]
    Skeleton(#[from] SkeletonError),
}

#[derive(Serialize, Deserialize)]
struct Head {
    files: Vec<FileHead>,
    notes: Vec<Message>,
}

#[derive(Serialize, Deserialize)]
struct FileHead {
    name: String,
    sha256: String,
    size: u64,
    kind: FileKind,
    /// The number of bytes of the file itself, if they are included.
    unpacked: Option<usize>,
    #[serde(default)]
    converted: Option<Result<ConvertedClip, Message>>,
    result: Result<ClipsHead, ImportError>,
}

#[derive(Serialize, Deserialize)]
struct ClipsHead {
    clips: Vec<ClipHead>,
    #[serde(default)]
    meshes: Vec<MeshHead>,
    /// The sizes of the images of its meshes, bytes.
    #[serde(default)]
    images: Vec<usize>,
    warnings: Vec<Message>,
    skeleton_file: Option<Box<SkeletonFile>>,
    awaits_skeleton: bool,
}

/// A clip without its arrays.
#[derive(Serialize, Deserialize)]
struct ClipHead {
    name: String,
    joints: Vec<Joint>,
    #[serde(default)]
    above: Option<FoldedChain>,
    fps: f64,
    frames: usize,
    provenance: Provenance,
    /// The joints that have translations.
    moving: Vec<usize>,
    roles: Roles,
    #[serde(default)]
    ground_m: f32,
    about: About,
    /// The index of its mesh among those of the file.
    #[serde(default)]
    mesh: Option<usize>,
}

/// A mesh without its arrays.
#[derive(Serialize, Deserialize)]
struct MeshHead {
    vertices: usize,
    triangles: usize,
    joints: usize,
    /// The number of vertex colours: all vertices or none.
    colors: usize,
    /// The number of texture coordinates: all vertices or none.
    #[serde(default)]
    coordinates: usize,
    #[serde(default)]
    textured: Vec<TexturedHead>,
}

/// A textured part of a mesh, whose image is one of those of the file.
#[derive(Serialize, Deserialize)]
struct TexturedHead {
    triangles: Range<usize>,
    image: usize,
    sampler: Sampler,
    alpha: AlphaMode,
}

impl FileHead {
    fn clips(&self) -> &[ClipHead] {
        self.result.as_ref().map_or(&[], |read| &read.clips)
    }

    fn meshes(&self) -> &[MeshHead] {
        self.result.as_ref().map_or(&[], |read| &read.meshes)
    }

    fn images(&self) -> &[usize] {
        self.result.as_ref().map_or(&[], |read| &read.images)
    }

    /// Returns the number of bytes of its arrays.
    fn bytes(&self) -> usize {
        let clips: usize = self.clips().iter().map(ClipHead::bytes).sum();
        let meshes =
            self.meshes().iter().fold(0usize, |sum, mesh| sum.saturating_add(mesh.bytes()));
        let images = self.images().iter().fold(0usize, |sum, size| sum.saturating_add(*size));
        let arrays = clips.saturating_add(meshes).saturating_add(images);
        arrays.saturating_add(self.unpacked.unwrap_or(0))
    }
}

impl ClipHead {
    /// Returns the number of bytes of its arrays.
    fn bytes(&self) -> usize {
        usize::try_from(motion_bytes(self.frames, self.joints.len(), self.moving.len()))
            .unwrap_or(usize::MAX)
    }
}

impl MeshHead {
    /// Returns the number of bytes of its arrays.
    fn bytes(&self) -> usize {
        let vertices = self
            .vertices
            .saturating_mul(12 + 12 + 8 + 16)
            .saturating_add(self.colors.saturating_mul(16))
            .saturating_add(self.coordinates.saturating_mul(8));
        vertices
            .saturating_add(self.triangles.saturating_mul(12))
            .saturating_add(self.joints.saturating_mul(28))
    }
}
