//! The receiving side: pieces assembled to a report.

use super::{ClipHead, FileHead, Head, MeshHead, TexturedHead, WireError};
use crate::reading::{ReadClip, ReadClips, ReadFile, ReadReport};
use bytemuck::{AnyBitPattern, pod_read_unaligned};
use glam::{DVec2, Quat, Vec3};
use segue_motion::clip::{Clip, Contacts, JointTranslations, Motion};
use segue_motion::math::Planar;
use segue_motion::skeleton::{Foot, FootPair, Skeleton};
use segue_motion::skin::{RigidTransform, SkinnedMesh, Texture, TexturedPart};
use std::collections::TryReserveError;
use std::sync::Arc;

impl MeshHead {
    /// Returns an empty mesh with memory for its arrays.
    pub(super) fn room(&self) -> Result<SkinnedMesh, TryReserveError> {
        let mut mesh = SkinnedMesh::default();
        mesh.positions.try_reserve_exact(self.vertices)?;
        mesh.normals.try_reserve_exact(self.vertices)?;
        mesh.joints.try_reserve_exact(self.vertices)?;
        mesh.weights.try_reserve_exact(self.vertices)?;
        mesh.colors.try_reserve_exact(self.colors)?;
        mesh.triangles.try_reserve_exact(self.triangles)?;
        mesh.bind.try_reserve_exact(self.joints)?;
        mesh.coordinates.try_reserve_exact(self.coordinates)?;
        Ok(mesh)
    }

    /// Moves what the mesh still needs from the front of `bytes`.
    pub(super) fn take(&self, mesh: &mut SkinnedMesh, bytes: &mut &[u8]) {
        fill(&mut mesh.positions, self.vertices, bytes, |v| v);
        fill(&mut mesh.normals, self.vertices, bytes, |v| v);
        fill(&mut mesh.joints, self.vertices, bytes, |joints| joints);
        fill(&mut mesh.weights, self.vertices, bytes, |weights| weights);
        fill(&mut mesh.colors, self.colors, bytes, |color| color);
        fill(&mut mesh.triangles, self.triangles, bytes, |corners| corners);
        fill(&mut mesh.bind, self.joints, bytes, |[x, y, z, w, dx, dy, dz]: [f32; 7]| {
            RigidTransform {
                rotation: Quat::from_xyzw(x, y, z, w),
                translation: Vec3::new(dx, dy, dz),
            }
        });
        fill(&mut mesh.coordinates, self.coordinates, bytes, |place| place);
    }

    /// Returns the textured parts of the mesh; `images` are those of the file.
    pub(super) fn textured(&self, images: &[Arc<[u8]>]) -> Vec<TexturedPart> {
        let part = |part: &TexturedHead| {
            let image = Arc::clone(images.get(part.image)?);
            let texture = Texture { image, sampler: part.sampler, alpha: part.alpha };
            Some(TexturedPart { triangles: part.triangles.clone(), texture })
        };
        self.textured.iter().filter_map(part).collect()
    }
}

/// The arrays of one clip during the transfer.
#[derive(Default)]
struct Arrays {
    rotations: Vec<Quat>,
    /// The root's, then those of each joint that moves.
    translations: Vec<Vec<Vec3>>,
    ground_frames: Vec<Planar>,
    /// For the left and the right, a bit for each foot.
    contacts: [Vec<u8>; 2],
}

impl Arrays {
    /// Returns empty arrays with memory for a clip.
    fn with_room_for(head: &ClipHead) -> Result<Self, TryReserveError> {
        let mut arrays = Self::default();
        arrays.rotations.try_reserve_exact(head.frames.saturating_mul(head.joints.len()))?;
        arrays.translations.resize_with(head.moving.len() + 1, Vec::new);
        for values in &mut arrays.translations {
            values.try_reserve_exact(head.frames)?;
        }
        arrays.ground_frames.try_reserve_exact(head.frames)?;
        for flags in &mut arrays.contacts {
            flags.try_reserve_exact(head.frames)?;
        }
        Ok(arrays)
    }

    /// Moves what the arrays still need from the front of `bytes`.
    fn take(&mut self, head: &ClipHead, bytes: &mut &[u8]) {
        let frames = head.frames;
        fill(&mut self.rotations, frames.saturating_mul(head.joints.len()), bytes, |q| q);
        for values in &mut self.translations {
            fill(values, frames, bytes, |v| v);
        }
        fill(&mut self.ground_frames, frames, bytes, |[yaw, x, z]: [f64; 3]| Planar {
            yaw,
            shift: DVec2::new(x, z),
        });
        let mut pairs: Vec<[u8; 2]> = Vec::new();
        fill(&mut pairs, frames - self.contacts[0].len().min(frames), bytes, |pair| pair);
        for pair in pairs {
            for (flags, flag) in self.contacts.iter_mut().zip(pair) {
                flags.push(flag);
            }
        }
    }

    fn into_clip(self, head: ClipHead, meshes: &[Arc<SkinnedMesh>]) -> Result<ReadClip, WireError> {
        let mesh = head.mesh.and_then(|mesh| meshes.get(mesh)).cloned();
        let skeleton = Arc::new(Skeleton::new(head.joints)?.with_folded_chain(head.above));
        let mut translations = self.translations.into_iter();
        let root = translations.next().unwrap_or_default();
        let tracks = head.moving.into_iter().zip(translations);
        let tracks = tracks.map(|(joint, values)| JointTranslations { joint, values }).collect();
        let clip = Clip::new(head.name, skeleton, head.fps, self.rotations, root)?;
        let contacts = Contacts::of_feet(Foot::of(head.roles.body_plan()), |foot| {
            let bit = match foot.pair {
                FootPair::Hind => 1,
                FootPair::Fore => 2,
            };
            self.contacts[foot.side.index()].iter().map(|flags| flags & bit != 0).collect()
        });
        Ok(ReadClip {
            motion: Motion::with_ground_frames(
                clip.with_translations(tracks)?.with_provenance(head.provenance),
                &head.roles,
                self.ground_frames,
            )
            .with_contacts(contacts)
            .with_ground_m(head.ground_m),
            about: head.about,
            mesh,
        })
    }
}

/// Moves values written by `Piece::put` from the front of `bytes` to `values` until there are
/// `wanted` or no more bytes.
fn fill<T, P: AnyBitPattern>(
    values: &mut Vec<T>,
    wanted: usize,
    bytes: &mut &[u8],
    value_of: impl Fn(P) -> T,
) {
    let missing = wanted.saturating_sub(values.len());
    let coming = missing.min(bytes.len() / size_of::<P>());
    let (now, later) = bytes.split_at(coming * size_of::<P>());
    values.extend(now.chunks_exact(size_of::<P>()).map(|b| value_of(pod_read_unaligned(b))));
    *bytes = later;
}

/// A receiver that assembles the pieces of a report.
pub struct Unpacker {
    head: Head,
    files: Vec<Incoming>,
    /// The number of bytes expected.
    bytes: usize,
    /// The index of the file in transfer; those before it are complete.
    at: usize,
    found: usize,
}

/// A file in transfer.
#[derive(Default)]
struct Incoming {
    unpacked: Vec<u8>,
    clips: Vec<Arrays>,
    meshes: Vec<SkinnedMesh>,
    images: Vec<Vec<u8>>,
}

impl std::fmt::Debug for Unpacker {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Unpacker")
            .field("files", &self.files.len())
            .field("found", &self.found)
            .finish_non_exhaustive()
    }
}

impl Unpacker {
    /// Reads the header and reserves all memory for the arrays, up to `room` bytes: nothing is
    /// allocated when the pieces arrive.
    ///
    /// # Errors
    /// [`WireError::Head`] if the header is invalid, and [`WireError::NoRoom`] if there is no
    /// memory for the arrays.
    pub fn new(head: &str, room: u64) -> Result<Self, WireError> {
        let head: Head = serde_json::from_str(head)?;
        let bytes = (head.files.iter().map(FileHead::bytes)).fold(0, usize::saturating_add);
        let no_room = || WireError::NoRoom { bytes };
        if bytes as u64 > room {
            return Err(no_room());
        }
        let mut files = Vec::new();
        for file in &head.files {
            files.push(Incoming::with_room_for(file).map_err(|_| no_room())?);
        }
        Ok(Self { head, files, bytes, at: 0, found: 0 })
    }

    /// Returns the number of bytes of the arrays.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        self.bytes as u64
    }

    /// Adds the next piece.
    pub fn push(&mut self, piece: &[u8]) {
        self.found += piece.len();
        let mut rest = piece;
        while let (Some(head), Some(file)) =
            (self.head.files.get(self.at), self.files.get_mut(self.at))
        {
            file.take(head, &mut rest);
            if rest.is_empty() {
                // There may be more of this file.
                return;
            }
            self.at += 1;
        }
    }

    /// Returns the report once all pieces have arrived.
    ///
    /// # Errors
    /// [`WireError`] if something is missing or does not form a clip.
    pub fn finish(self) -> Result<ReadReport, WireError> {
        if self.found != self.bytes {
            return Err(WireError::Length { expected: self.bytes, found: self.found });
        }
        let files = self.head.files.into_iter().zip(self.files);
        let files: Result<Vec<ReadFile>, WireError> =
            files.map(|(head, file)| file.into_file(head)).collect();
        Ok(ReadReport { files: files?, notes: self.head.notes })
    }
}

impl Incoming {
    /// Reserves memory for a file.
    fn with_room_for(head: &FileHead) -> Result<Self, TryReserveError> {
        let mut unpacked = Vec::new();
        unpacked.try_reserve_exact(head.unpacked.unwrap_or(0))?;
        let clips: Result<Vec<Arrays>, TryReserveError> =
            head.clips().iter().map(Arrays::with_room_for).collect();
        let meshes: Result<Vec<SkinnedMesh>, TryReserveError> =
            head.meshes().iter().map(MeshHead::room).collect();
        let mut images = vec![Vec::new(); head.images().len()];
        for (image, size) in images.iter_mut().zip(head.images()) {
            image.try_reserve_exact(*size)?;
        }
        Ok(Self { unpacked, clips: clips?, meshes: meshes?, images })
    }

    fn take(&mut self, head: &FileHead, bytes: &mut &[u8]) {
        fill(&mut self.unpacked, head.unpacked.unwrap_or(0), bytes, |byte| byte);
        for (head, clip) in head.clips().iter().zip(&mut self.clips) {
            clip.take(head, bytes);
        }
        for (head, mesh) in head.meshes().iter().zip(&mut self.meshes) {
            head.take(mesh, bytes);
        }
        for (size, image) in head.images().iter().zip(&mut self.images) {
            fill(image, *size, bytes, |byte| byte);
        }
    }

    fn into_file(self, head: FileHead) -> Result<ReadFile, WireError> {
        let result = match head.result {
            Ok(read) => {
                let clips = read.clips.into_iter().zip(self.clips);
                let images: Vec<Arc<[u8]>> = self.images.into_iter().map(Arc::from).collect();
                let meshes = self.meshes.into_iter().zip(&read.meshes);
                let meshes: Vec<Arc<SkinnedMesh>> = meshes
                    .map(|(mesh, head)| {
                        Arc::new(SkinnedMesh { textured: head.textured(&images), ..mesh })
                    })
                    .collect();
                let clips: Result<Vec<ReadClip>, WireError> =
                    clips.map(|(head, arrays)| arrays.into_clip(head, &meshes)).collect();
                Ok(ReadClips {
                    clips: clips?,
                    warnings: read.warnings,
                    skeleton_file: read.skeleton_file,
                    awaits_skeleton: read.awaits_skeleton,
                })
            }
            Err(error) => Err(error),
        };
        Ok(ReadFile {
            name: head.name,
            sha256: head.sha256,
            size: head.size,
            kind: head.kind,
            unpacked: head.unpacked.map(|_| self.unpacked),
            converted: head.converted,
            result,
        })
    }
}

#[cfg(test)]
mod tests;
