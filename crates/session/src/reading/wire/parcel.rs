//! The sending side: a report as a header and pieces.

use super::{ClipHead, ClipsHead, FileHead, Head, MeshHead, TexturedHead, WireError};
use crate::reading::{ReadClip, ReadClips, ReadFile, ReadReport};
use bytemuck::NoUninit;
use segue_motion::clip::Motion;
use segue_motion::skeleton::{Foot, FootPair, Side};
use segue_motion::skin::{RigidTransform, SkinnedMesh, TexturedPart};
use std::sync::Arc;

/// The length of a piece, bytes: a multiple of the size of every value below, and copied in well
/// under a millisecond.
const PIECE_BYTES: usize = 48 << 14;

/// A report that is ready for transfer.
#[derive(Debug)]
pub struct Parcel {
    head: String,
    report: ReadReport,
}

impl Parcel {
    /// Packs a report.
    ///
    /// # Errors
    /// [`WireError::Head`] when JSON cannot represent it.
    pub fn new(report: ReadReport) -> Result<Self, WireError> {
        let head = Head {
            files: report.files.iter().map(FileHead::of).collect(),
            notes: report.notes.clone(),
        };
        Ok(Self { head: serde_json::to_string(&head)?, report })
    }

    /// Returns the header: everything but the arrays.
    #[must_use]
    pub fn head(&self) -> &str {
        &self.head
    }

    /// Sends the arrays piece by piece, in the order that [`Unpacker::push`](super::Unpacker::push)
    /// expects.
    pub fn pieces(&self, mut send: impl FnMut(&[u8])) {
        let mut piece = Piece { bytes: Vec::with_capacity(PIECE_BYTES), send: &mut send };
        for file in &self.report.files {
            piece.put(file.unpacked.as_deref().unwrap_or_default());
            let clips = file.result.as_ref().map_or(&[][..], |read| &read.clips);
            for clip in clips {
                put_motion(&mut piece, &clip.motion);
            }
            let meshes = meshes(clips);
            for mesh in &meshes {
                put_mesh(&mut piece, mesh);
            }
            for image in images(&meshes) {
                piece.put(image);
            }
        }
        piece.flush();
    }
}

fn put_motion(piece: &mut Piece<'_>, motion: &Motion) {
    let clip = motion.clip();
    for frame in 0..clip.frames() {
        piece.put(clip.rotations(frame));
    }
    piece.put(clip.root_translations());
    for track in clip.translations() {
        piece.put(&track.values);
    }
    for place in motion.ground_frames() {
        piece.put(&[[place.yaw, place.shift.x, place.shift.y]]);
    }
    let contacts = motion.contacts();
    for frame in 0..clip.frames() {
        // A bit for each foot of a side.
        let of_side = |side: Side| {
            let planted = |pair| u8::from(contacts.planted(Foot { pair, side }, frame));
            planted(FootPair::Hind) | planted(FootPair::Fore) << 1
        };
        piece.put(&[Side::BOTH.map(of_side)]);
    }
}

/// Returns the meshes of clips, each once.
fn meshes(clips: &[ReadClip]) -> Vec<&Arc<SkinnedMesh>> {
    let mut meshes: Vec<&Arc<SkinnedMesh>> = Vec::new();
    for mesh in clips.iter().filter_map(|clip| clip.mesh.as_ref()) {
        if !meshes.iter().any(|known| Arc::ptr_eq(known, mesh)) {
            meshes.push(mesh);
        }
    }
    meshes
}

/// Returns the images of meshes, each once.
pub(super) fn images<'a>(meshes: &[&'a Arc<SkinnedMesh>]) -> Vec<&'a Arc<[u8]>> {
    let mut images: Vec<&Arc<[u8]>> = Vec::new();
    for TexturedPart { texture, .. } in meshes.iter().flat_map(|mesh| &mesh.textured) {
        if !images.iter().any(|known| Arc::ptr_eq(known, &texture.image)) {
            images.push(&texture.image);
        }
    }
    images
}

/// Appends the arrays of a mesh to bytes that are sent at once.
pub(super) fn put_whole_mesh(bytes: &mut Vec<u8>, mesh: &SkinnedMesh) {
    let mut append = |piece: &[u8]| bytes.extend_from_slice(piece);
    let mut piece = Piece { bytes: Vec::with_capacity(PIECE_BYTES), send: &mut append };
    put_mesh(&mut piece, mesh);
    piece.flush();
}

fn put_mesh(piece: &mut Piece<'_>, mesh: &SkinnedMesh) {
    piece.put(&mesh.positions);
    piece.put(&mesh.normals);
    piece.put(&mesh.joints);
    piece.put(&mesh.weights);
    piece.put(&mesh.colors);
    piece.put(&mesh.triangles);
    for RigidTransform { rotation, translation } in &mesh.bind {
        let ([x, y, z, w], [dx, dy, dz]) = (rotation.to_array(), translation.to_array());
        piece.put(&[[x, y, z, w, dx, dy, dz]]);
    }
    piece.put(&mesh.coordinates);
}

/// A buffer for the values of one piece; no value is split.
struct Piece<'a> {
    bytes: Vec<u8>,
    send: &'a mut dyn FnMut(&[u8]),
}

impl Piece<'_> {
    /// Adds values in the byte order of this machine, which is also that of the receiver.
    fn put<T: NoUninit>(&mut self, mut values: &[T]) {
        while !values.is_empty() {
            let room = (PIECE_BYTES - self.bytes.len()) / size_of::<T>();
            if room == 0 {
                self.flush();
            }
            let (now, later) = values.split_at(values.len().min(room));
            self.bytes.extend_from_slice(bytemuck::cast_slice(now));
            values = later;
        }
    }

    fn flush(&mut self) {
        if !self.bytes.is_empty() {
            (self.send)(&self.bytes);
            self.bytes.clear();
        }
    }
}

impl FileHead {
    fn of(file: &ReadFile) -> Self {
        Self {
            name: file.name.clone(),
            sha256: file.sha256.clone(),
            size: file.size,
            kind: file.kind,
            unpacked: file.unpacked.as_ref().map(Vec::len),
            converted: file.converted.clone(),
            result: match &file.result {
                Ok(read) => Ok(ClipsHead::of(read)),
                Err(error) => Err(error.clone()),
            },
        }
    }
}

impl ClipsHead {
    fn of(read: &ReadClips) -> Self {
        let meshes = meshes(&read.clips);
        let images = images(&meshes);
        Self {
            clips: read.clips.iter().map(|clip| ClipHead::of(clip, &meshes)).collect(),
            meshes: meshes.iter().map(|mesh| MeshHead::of(mesh, &images)).collect(),
            images: images.iter().map(|image| image.len()).collect(),
            warnings: read.warnings.clone(),
            skeleton_file: read.skeleton_file.clone(),
            awaits_skeleton: read.awaits_skeleton,
        }
    }
}

impl ClipHead {
    fn of(clip: &ReadClip, meshes: &[&Arc<SkinnedMesh>]) -> Self {
        let motion = &clip.motion;
        Self {
            name: motion.clip().name().to_owned(),
            joints: motion.clip().skeleton().joints().to_vec(),
            above: motion.clip().skeleton().folded_chain().cloned(),
            fps: motion.clip().fps(),
            frames: motion.clip().frames(),
            provenance: motion.clip().provenance(),
            moving: motion.clip().translations().iter().map(|track| track.joint).collect(),
            roles: motion.roles().clone(),
            ground_m: motion.ground_m(),
            about: clip.about.clone(),
            mesh: clip
                .mesh
                .as_ref()
                .and_then(|mesh| meshes.iter().position(|known| Arc::ptr_eq(known, mesh))),
        }
    }
}

impl MeshHead {
    /// Returns that of a mesh; `images` are those of the file.
    pub(super) fn of(mesh: &SkinnedMesh, images: &[&Arc<[u8]>]) -> Self {
        let textured = mesh.textured.iter().filter_map(|TexturedPart { triangles, texture }| {
            Some(TexturedHead {
                triangles: triangles.clone(),
                image: images.iter().position(|known| Arc::ptr_eq(known, &texture.image))?,
                sampler: texture.sampler,
                alpha: texture.alpha,
            })
        });
        Self {
            vertices: mesh.positions.len(),
            triangles: mesh.triangles.len(),
            joints: mesh.bind.len(),
            colors: mesh.colors.len(),
            coordinates: mesh.coordinates.len(),
            textured: textured.collect(),
        }
    }
}
