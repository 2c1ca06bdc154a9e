//! Transfer of a report from a worker: a JSON header, and the long arrays as bytes in pieces, so
//! that neither side copies for longer than a frame.

use super::{About, Companion, ReadClip, ReadClips, ReadFile, ReadReport};
use crate::memory::motion_bytes;
use bytemuck::{AnyBitPattern, NoUninit, pod_read_unaligned};
use glam::{DVec2, Quat, Vec3};
use segue_formats::{FileKind, ImportError};
use segue_motion::clip::{Clip, ClipError, Contacts, JointTranslations, Motion, Provenance};
use segue_motion::math::Planar;
use segue_motion::skeleton::{FoldedChain, Joint, Roles, Side, Skeleton, SkeletonError};
use segue_motion::skin::{RigidTransform, SkinnedMesh};
use segue_text::Message;
use serde::{Deserialize, Serialize};
use std::collections::TryReserveError;
use std::sync::Arc;

/// The length of a piece, bytes: a multiple of the size of every value below, and copied in well
/// under a millisecond.
const PIECE_BYTES: usize = 48 << 14;

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
    result: Result<ClipsHead, ImportError>,
}

#[derive(Serialize, Deserialize)]
struct ClipsHead {
    clips: Vec<ClipHead>,
    #[serde(default)]
    meshes: Vec<MeshHead>,
    warnings: Vec<Message>,
    companion: Option<Companion>,
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
#[derive(Clone, Copy, Serialize, Deserialize)]
struct MeshHead {
    vertices: usize,
    triangles: usize,
    joints: usize,
    /// The number of vertex colours: all vertices or none.
    colors: usize,
}

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

    /// Sends the arrays piece by piece, in the order that [`Unpacker::push`] expects.
    pub fn pieces(&self, mut send: impl FnMut(&[u8])) {
        let mut piece = Piece { bytes: Vec::with_capacity(PIECE_BYTES), send: &mut send };
        for file in &self.report.files {
            piece.put(file.unpacked.as_deref().unwrap_or_default());
            let clips = file.result.as_ref().map_or(&[][..], |read| &read.clips);
            for clip in clips {
                put_motion(&mut piece, &clip.motion);
            }
            for mesh in meshes(clips) {
                put_mesh(&mut piece, mesh);
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
    for frame in 0..clip.frames() {
        piece.put(&[Side::BOTH.map(|side| u8::from(motion.contacts().planted(side, frame)))]);
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
            result: match &file.result {
                Ok(read) => Ok(ClipsHead {
                    clips: read
                        .clips
                        .iter()
                        .map(|clip| ClipHead::of(clip, &meshes(&read.clips)))
                        .collect(),
                    meshes: meshes(&read.clips)
                        .into_iter()
                        .map(|mesh| MeshHead::of(mesh))
                        .collect(),
                    warnings: read.warnings.clone(),
                    companion: read.companion.clone(),
                    awaits_skeleton: read.awaits_skeleton,
                }),
                Err(error) => Err(error.clone()),
            },
        }
    }

    fn clips(&self) -> &[ClipHead] {
        self.result.as_ref().map_or(&[], |read| &read.clips)
    }

    fn meshes(&self) -> &[MeshHead] {
        self.result.as_ref().map_or(&[], |read| &read.meshes)
    }

    /// Returns the number of bytes of its arrays.
    fn bytes(&self) -> usize {
        let clips: usize = self.clips().iter().map(ClipHead::bytes).sum();
        let meshes =
            self.meshes().iter().fold(0usize, |sum, mesh| sum.saturating_add(mesh.bytes()));
        clips.saturating_add(meshes).saturating_add(self.unpacked.unwrap_or(0))
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
    fn of(mesh: &SkinnedMesh) -> Self {
        Self {
            vertices: mesh.positions.len(),
            triangles: mesh.triangles.len(),
            joints: mesh.bind.len(),
            colors: mesh.colors.len(),
        }
    }

    /// Returns the number of bytes of its arrays.
    fn bytes(&self) -> usize {
        let vertices = self
            .vertices
            .saturating_mul(12 + 12 + 8 + 16)
            .saturating_add(self.colors.saturating_mul(16));
        vertices
            .saturating_add(self.triangles.saturating_mul(12))
            .saturating_add(self.joints.saturating_mul(28))
    }

    /// Returns an empty mesh with memory for its arrays.
    fn room(&self) -> Result<SkinnedMesh, TryReserveError> {
        let mut mesh = SkinnedMesh::default();
        mesh.positions.try_reserve_exact(self.vertices)?;
        mesh.normals.try_reserve_exact(self.vertices)?;
        mesh.joints.try_reserve_exact(self.vertices)?;
        mesh.weights.try_reserve_exact(self.vertices)?;
        mesh.colors.try_reserve_exact(self.colors)?;
        mesh.triangles.try_reserve_exact(self.triangles)?;
        mesh.bind.try_reserve_exact(self.joints)?;
        Ok(mesh)
    }

    /// Moves what the mesh still needs from the front of `bytes`.
    fn take(&self, mesh: &mut SkinnedMesh, bytes: &mut &[u8]) {
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
    }
}

/// The arrays of one clip during the transfer.
#[derive(Default)]
struct Arrays {
    rotations: Vec<Quat>,
    /// The root's, then those of each joint that moves.
    translations: Vec<Vec<Vec3>>,
    ground_frames: Vec<Planar>,
    contacts: [Vec<bool>; 2],
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
                flags.push(flag != 0);
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
        Ok(ReadClip {
            motion: Motion::with_ground_frames(
                clip.with_translations(tracks)?.with_provenance(head.provenance),
                &head.roles,
                self.ground_frames,
            )
            .with_contacts(Contacts::from_flags(self.contacts))
            .with_ground_m(head.ground_m),
            about: head.about,
            mesh,
        })
    }
}

/// Moves values written by [`Piece::put`] from the front of `bytes` to `values` until there are
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
        Ok(Self { unpacked, clips: clips?, meshes: meshes? })
    }

    fn take(&mut self, head: &FileHead, bytes: &mut &[u8]) {
        fill(&mut self.unpacked, head.unpacked.unwrap_or(0), bytes, |byte| byte);
        for (head, clip) in head.clips().iter().zip(&mut self.clips) {
            clip.take(head, bytes);
        }
        for (head, mesh) in head.meshes().iter().zip(&mut self.meshes) {
            head.take(mesh, bytes);
        }
    }

    fn into_file(self, head: FileHead) -> Result<ReadFile, WireError> {
        let result = match head.result {
            Ok(read) => {
                let clips = read.clips.into_iter().zip(self.clips);
                let meshes: Vec<Arc<SkinnedMesh>> = self.meshes.into_iter().map(Arc::new).collect();
                let clips: Result<Vec<ReadClip>, WireError> =
                    clips.map(|(head, arrays)| arrays.into_clip(head, &meshes)).collect();
                Ok(ReadClips {
                    clips: clips?,
                    warnings: read.warnings,
                    companion: read.companion,
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
            result,
        })
    }
}

impl ClipHead {
    /// Returns the number of bytes of its arrays.
    fn bytes(&self) -> usize {
        usize::try_from(motion_bytes(self.frames, self.joints.len(), self.moving.len()))
            .unwrap_or(usize::MAX)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reading::{ReadSetup, read};
    use segue_formats::bvh;
    use segue_motion::synth::{Action, Params, synthesize};

    impl Unpacker {
        /// Returns the capacities of its arrays.
        fn room(&self) -> Vec<usize> {
            let of_clip = |clip: &Arrays| {
                let translations: usize = clip.translations.iter().map(Vec::capacity).sum();
                let contacts: usize = clip.contacts.iter().map(Vec::capacity).sum();
                [clip.rotations.capacity(), translations, clip.ground_frames.capacity(), contacts]
            };
            let of_mesh = |mesh: &SkinnedMesh| {
                let vertices = mesh.positions.capacity()
                    + mesh.normals.capacity()
                    + mesh.joints.capacity()
                    + mesh.weights.capacity();
                [vertices, mesh.colors.capacity(), mesh.triangles.capacity(), mesh.bind.capacity()]
            };
            let of_file = |file: &Incoming| {
                let clips = file.clips.iter().flat_map(of_clip);
                clips
                    .chain(file.meshes.iter().flat_map(of_mesh))
                    .chain([file.unpacked.capacity()])
                    .collect::<Vec<_>>()
            };
            self.files.iter().flat_map(of_file).collect()
        }
    }

    fn report(secs: f32) -> ReadReport {
        let made = synthesize(&Params { duration_secs: secs, ..Params::new(Action::Walk) });
        let text = bvh::write(&made.unwrap().clip, &bvh::WriteOptions::default());
        read("walk.bvh", text.as_bytes(), &ReadSetup::default(), &mut |_| true).unwrap()
    }

    fn sent(report: &ReadReport) -> ReadReport {
        let parcel = Parcel::new(report.clone()).unwrap();
        let mut unpacker = Unpacker::new(parcel.head(), u64::MAX).unwrap();
        let room = unpacker.room();
        parcel.pieces(|piece| unpacker.push(piece));
        assert_eq!(unpacker.room(), room, "nothing grows on the way");
        unpacker.finish().unwrap()
    }

    #[test]
    fn unpacker_without_memory_is_refused_at_the_header() {
        let mut report = report(1.0);
        report.files[0].unpacked = Some(vec![7; 7]);
        let parcel = Parcel::new(report).unwrap();
        let head = parcel.head().replace("\"unpacked\":7", "\"unpacked\":1125899906842624");
        assert_ne!(head, parcel.head());
        let Err(error) = Unpacker::new(&head, u64::MAX) else {
            panic!("there is no petabyte");
        };
        assert!(matches!(error, WireError::NoRoom { .. }), "{error}");
        assert!(error.to_string().contains("remove clips"), "{error}");
        // The memory that is needed is known in bytes.
        let bytes = Unpacker::new(parcel.head(), u64::MAX).unwrap().bytes();
        assert!(Unpacker::new(parcel.head(), bytes).is_ok());
        assert!(matches!(Unpacker::new(parcel.head(), bytes - 1), Err(WireError::NoRoom { .. })));
    }

    #[test]
    fn unpacker_returns_the_report_as_sent() {
        // Long enough for several pieces.
        let mut long = report(60.0);
        long.files
            .push(ReadFile { unpacked: Some((0..=255).collect()), ..report(1.0).files.remove(0) });
        let skeleton =
            long.files[0].result.as_ref().unwrap().clips[0].motion.clip().skeleton().clone();
        let mesh = Arc::new(SkinnedMesh {
            colors: vec![[0.5, 0.25, 1.0, 1.0]; 3],
            ..SkinnedMesh::around(&skeleton, &Roles::detect(&skeleton), 1.0)
        });
        for file in &mut long.files {
            let read = file.result.as_mut().unwrap();
            read.clips.push(read.clips[0].clone());
            read.clips.iter_mut().for_each(|clip| clip.mesh = Some(Arc::clone(&mesh)));
        }
        long.notes.push("two".into());
        let mut pieces = 0;
        Parcel::new(long.clone()).unwrap().pieces(|_| pieces += 1);
        assert!(pieces > 1, "{pieces}");
        let arrived = sent(&long);
        assert_eq!(arrived, long);
        let clips = &arrived.files[0].result.as_ref().unwrap().clips;
        assert!(Arc::ptr_eq(clips[0].mesh.as_ref().unwrap(), clips[1].mesh.as_ref().unwrap()));
        let refused = read("no.bvh", b"HIERARCHY x", &ReadSetup::default(), &mut |_| true).unwrap();
        assert!(refused.files[0].result.is_err());
        assert_eq!(sent(&refused), refused);
    }

    #[test]
    fn unpacker_with_missing_bytes_is_refused() {
        let parcel = Parcel::new(report(2.0)).unwrap();
        let mut unpacker = Unpacker::new(parcel.head(), u64::MAX).unwrap();
        parcel.pieces(|piece| unpacker.push(&piece[..piece.len() - 2]));
        assert!(matches!(unpacker.finish(), Err(WireError::Length { .. })));
        assert!(Unpacker::new("{}", u64::MAX).is_err());
    }
}
