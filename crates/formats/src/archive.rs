//! Zip archives of motion files.
//!
//! Only motion files and what they refer to are unpacked, in the order of their paths. Sizes in
//! headers are not trusted for allocation. Archives inside the archive are opened, to a depth of
//! one. Paths are only names and never lead out of the archive.

use super::gzip::{no_memory, read_at_most};
use super::text::name as decoded;
use super::warning::{ImportWarning, Tally, WarningKind};
use super::{ImportError, ImportOptions, MOTION_ENDINGS, has_extension};
use flate2::bufread::{DeflateDecoder, GzDecoder};
use rawzip::{CompressionMethod, ErrorKind, ZipArchive, ZipFileHeaderRecord, ZipSliceArchive};
use segue_text::{Message, ToMessage, msg};
use std::io;

/// The greatest number of motion files by default; see [`ArchiveLimits::default`].
pub const MAX_FILES: usize = 2000;

/// The endings of the images that textures are.
const IMAGE_ENDINGS: [&str; 3] = ["png", "jpg", "jpeg"];

/// The ending of the arrays of glTF files, which may stand beside them.
const ARRAYS_ENDING: &str = "bin";

/// The endings of files that may refer to images and arrays.
const SCENE_ENDINGS: [&str; 2] = ["fbx", "gltf"];

/// The depth to which archives inside archives are opened.
const MAX_DEPTH: usize = 1;

/// Limits of an archive.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct ArchiveLimits {
    /// The greatest size of all motion files together after unpacking, bytes. Larger archives are
    /// refused.
    pub max_bytes: usize,
    /// The greatest number of motion files that are read. Further ones are left out with a warning.
    pub max_files: usize,
}

impl Default for ArchiveLimits {
    /// The size limit of a single file, and as many files as fit into a list that users can look
    /// through.
    fn default() -> Self {
        Self { max_bytes: ImportOptions::default().max_bytes, max_files: MAX_FILES }
    }
}

/// An unpacked file of an archive.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ArchivedFile {
    /// Its path in the archive, with `/` between folders; in an archive inside the archive, after
    /// that one's path. The ending `.gz` of a compressed file is removed.
    pub path: String,
    /// Its content.
    pub bytes: Vec<u8>,
}

/// The content of an archive.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct UnpackedArchive {
    /// The motion files, at least one, and the files that they may refer to; sorted by path.
    pub files: Vec<ArchivedFile>,
    /// The files that were left out, and why: one per kind.
    pub warnings: Vec<ImportWarning>,
}

/// Returns whether the bytes start as those of a zip archive.
#[must_use]
pub(crate) fn is_zip(bytes: &[u8]) -> bool {
    // The second one is an archive without files.
    bytes.starts_with(b"PK\x03\x04") || bytes.starts_with(b"PK\x05\x06")
}

/// Unpacks the motion files of a zip archive, those with [`MOTION_ENDINGS`], and the `.bin` of a
/// `.gltf`, each also compressed as `.gz`. Of an archive with scenes, FBX or glTF, the images are
/// unpacked as well: they may be those of textures.
///
/// A file that is damaged, encrypted or compressed in an unusual way is left out with a warning, as
/// long as there are others.
///
/// # Errors
/// [`ImportError`] when this is not a zip archive, when it is truncated, when its files unpack to
/// more than the limit, and when no motion file is unpacked.
pub fn unpack(
    name: &str,
    bytes: &[u8],
    limits: &ArchiveLimits,
) -> Result<UnpackedArchive, ImportError> {
    let mut unpacking = Unpacker {
        name,
        left: limits.max_bytes,
        limits: *limits,
        files: Vec::new(),
        motions: 0,
        images: 0,
        takes_images: false,
        tally: Tally::default(),
    };
    let archive = open(bytes).map_err(|why| ImportError::whole_file(name, why, "a zip archive"))?;
    unpacking.archive(&archive, "", 0)?;
    let Unpacker { mut files, motions, tally, .. } = unpacking;
    let warnings = tally.into_warnings(b"");
    if motions == 0 {
        let unreadable = warnings
            .iter()
            .find(|warning| matches!(warning.kind, WarningKind::UnreadableFiles { .. }));
        let found = unreadable.map_or_else(
            || Message::word("an archive without motion files"),
            ToMessage::to_message,
        );
        return Err(ImportError::whole_file(
            name,
            found,
            "motion files (.bvh, .asf, .amc, .fbx, .glb, .gltf, .vrm, .vrma, .npz, .npy, .c3d, .trc)",
        ));
    }
    // The sort is stable: of two files with one path, the one that comes first in the archive stays
    // first.
    files.sort_by(|a, b| a.path.cmp(&b.path));
    Ok(UnpackedArchive { files, warnings })
}

/// Returns the list of an archive's files.
pub(super) fn open(bytes: &[u8]) -> Result<ZipSliceArchive<&[u8]>, Message> {
    let cut_off = || Message::word("a zip archive without an end: it was cut off");
    let archive = ZipArchive::from_slice(bytes).map_err(|error| match error.kind() {
        ErrorKind::MissingEndOfCentralDirectory if is_zip(bytes) => cut_off(),
        ErrorKind::MissingEndOfCentralDirectory => "no zip archive".into(),
        _ => msg!("a damaged zip archive ({error})", error = error.to_string()),
    })?;
    // The end of an inner archive of a truncated archive may look like its own. In that case
    // nothing in it is at the start, and something follows.
    let is_inner = archive.end_offset() < bytes.len() as u64
        && bytes.starts_with(b"PK\x03\x04")
        && archive.entries().all(|entry| entry.is_ok_and(|entry| entry.local_header_offset() > 0));
    if is_inner { Err(cut_off()) } else { Ok(archive) }
}

struct Unpacker<'a> {
    name: &'a str,
    /// The number of bytes that may still be unpacked.
    left: usize,
    limits: ArchiveLimits,
    files: Vec<ArchivedFile>,
    /// The number of motion files among them.
    motions: usize,
    /// The number of images among them.
    images: usize,
    /// Whether the present archive has scenes that may refer to images.
    takes_images: bool,
    tally: Tally,
}

/// The reason why a file was not unpacked.
pub(super) enum UnpackFailure {
    /// It cannot be read, and is left out.
    Unreadable(Message),
    /// It exceeds the size limit; the archive is refused.
    TooMuch,
    /// There is no memory for the file; the archive is refused.
    NoMemory,
}

impl From<io::Error> for UnpackFailure {
    fn from(error: io::Error) -> Self {
        match error.kind() {
            io::ErrorKind::OutOfMemory => Self::NoMemory,
            _ => Self::Unreadable(msg!("it is damaged ({error})", error = error.to_string())),
        }
    }
}

impl Unpacker<'_> {
    fn archive(
        &mut self,
        archive: &ZipSliceArchive<&[u8]>,
        folder: &str,
        depth: usize,
    ) -> Result<(), ImportError> {
        let takes_images = self.takes_images || has_scene(archive);
        let outside = std::mem::replace(&mut self.takes_images, takes_images);
        let done = self.entries(archive, folder, depth);
        self.takes_images = outside;
        done
    }

    fn entries(
        &mut self,
        archive: &ZipSliceArchive<&[u8]>,
        folder: &str,
        depth: usize,
    ) -> Result<(), ImportError> {
        let mut entries = archive.entries();
        loop {
            match entries.next_entry() {
                Ok(Some(entry)) => self.entry(archive, &entry, folder, depth)?,
                Ok(None) => return Ok(()),
                Err(error) if depth == 0 => {
                    let found = msg!("a damaged zip archive ({error})", error = error.to_string());
                    return Err(ImportError::whole_file(self.name, found, "a list of its files"));
                }
                Err(error) => {
                    self.unreadable(folder, msg!("damaged ({error})", error = error.to_string()));
                    return Ok(());
                }
            }
        }
    }

    fn entry(
        &mut self,
        archive: &ZipSliceArchive<&[u8]>,
        entry: &ZipFileHeaderRecord<'_>,
        folder: &str,
        depth: usize,
    ) -> Result<(), ImportError> {
        if entry.is_dir() {
            return Ok(());
        }
        let (path, leads_out) = sanitized_path(&decoded(entry.file_path().as_bytes()).0);
        if path.split('/').any(|part| part.starts_with('.') || part == "__MACOSX") {
            self.tally.add(WarningKind::HiddenFiles, None);
            return Ok(());
        }
        let path = if folder.is_empty() { path } else { format!("{folder}/{path}") };
        let is_zip = has_extension(&path, "zip");
        let packed_once_more = has_extension(&path, "gz").then(|| path.rsplit_once('.')).flatten();
        let motion = packed_once_more.map(|(inner, _)| inner).filter(|inner| is_motion(inner));
        let is_image = self.takes_images
            && self.images < self.limits.max_files
            && IMAGE_ENDINGS.iter().any(|ending| has_extension(&path, ending));
        if !is_zip && motion.is_none() && !is_motion(&path) && !is_image {
            self.tally.add(WarningKind::OtherFiles, None);
            return Ok(());
        }
        if self.motions >= self.limits.max_files && !is_image {
            let most = self.limits.max_files;
            self.tally.add(WarningKind::TooManyFiles { most }, None);
            return Ok(());
        }
        if leads_out {
            self.tally.add(WarningKind::PathsOutside, None);
        }
        if is_zip && depth >= MAX_DEPTH {
            self.unreadable(&path, "an archive inside an archive inside this one".into());
            return Ok(());
        }
        let mut bytes = match unpack_entry(archive, entry, self.left) {
            Ok(bytes) => bytes,
            Err(failure) => return self.handle_failure(&path, failure),
        };
        if is_zip {
            match open(&bytes) {
                Ok(inner) => self.archive(&inner, &path, depth + 1)?,
                Err(why) => self.unreadable(&path, why),
            }
            return Ok(());
        }
        let mut kept = path.as_str();
        if let Some(inner) = motion {
            match read_at_most(GzDecoder::new(bytes.as_slice()), self.left) {
                Ok(Some(unpacked)) => (bytes, kept) = (unpacked, inner),
                Ok(None) => return Err(self.too_much()),
                Err(error) => return self.handle_failure(&path, error.into()),
            }
        }
        self.left = self.left.saturating_sub(bytes.len());
        *(if is_image { &mut self.images } else { &mut self.motions }) += 1;
        let path = kept.to_owned();
        self.files.push(ArchivedFile { path, bytes });
        Ok(())
    }

    /// Leaves a file out, or refuses the archive.
    fn handle_failure(&mut self, path: &str, failure: UnpackFailure) -> Result<(), ImportError> {
        match failure {
            UnpackFailure::TooMuch => Err(self.too_much()),
            UnpackFailure::NoMemory => Err(no_memory(self.name)),
            UnpackFailure::Unreadable(why) => {
                self.unreadable(path, why);
                Ok(())
            }
        }
    }

    fn unreadable(&mut self, path: &str, why: Message) {
        let path = super::text::short(path.as_bytes());
        self.tally.add(WarningKind::UnreadableFiles { path, why }, None);
    }

    fn too_much(&self) -> ImportError {
        let mb = self.limits.max_bytes >> 20;
        ImportError::whole_file(
            self.name,
            msg!("more than {mb} MB after unpacking"),
            msg!("at most {mb} MB"),
        )
        .with_hint("unpack the archive and open a part of its files")
    }
}

/// Unpacks a file of an archive, up to `most` bytes.
pub(super) fn unpack_entry(
    archive: &ZipSliceArchive<&[u8]>,
    entry: &ZipFileHeaderRecord<'_>,
    most: usize,
) -> Result<Vec<u8>, UnpackFailure> {
    if entry.flags().is_encrypted() {
        return Err(UnpackFailure::Unreadable("it is encrypted".into()));
    }
    let packed = archive.get_entry(entry.wayfinder());
    let packed = packed.map_err(|error| {
        UnpackFailure::Unreadable(msg!("it is damaged ({error})", error = error.to_string()))
    })?;
    let bytes = match entry.compression_method() {
        CompressionMethod::STORE => read_at_most(packed.verifying_reader(packed.data()), most),
        CompressionMethod::DEFLATE => {
            read_at_most(packed.verifying_reader(DeflateDecoder::new(packed.data())), most)
        }
        other => {
            let name = other
                .name()
                .map_or_else(|| msg!("method {number}", number = other.as_u16()), Message::word);
            return Err(UnpackFailure::Unreadable(msg!(
                "it is packed with {name}, which is not read here"
            )));
        }
    };
    bytes?.ok_or(UnpackFailure::TooMuch)
}

/// Returns whether an archive has files that may refer to images.
fn has_scene(archive: &ZipSliceArchive<&[u8]>) -> bool {
    archive.entries().any(|entry| {
        entry.is_ok_and(|entry| {
            let path = decoded(entry.file_path().as_bytes()).0;
            let path = path.strip_suffix(".gz").unwrap_or(&path);
            SCENE_ENDINGS.iter().any(|ending| has_extension(path, ending))
        })
    })
}

fn is_motion(path: &str) -> bool {
    MOTION_ENDINGS.iter().chain(&[ARRAYS_ENDING]).any(|ending| has_extension(path, ending))
}

/// Returns whether a file may refer to others beside it, by its name.
#[must_use]
pub fn is_scene(name: &str) -> bool {
    SCENE_ENDINGS.iter().any(|ending| has_extension(name, ending))
}

/// Returns whether scenes may refer to a file, an image or arrays, by its name.
#[must_use]
pub fn is_beside_scene(name: &str) -> bool {
    IMAGE_ENDINGS.iter().chain([&ARRAYS_ENDING]).any(|ending| has_extension(name, ending))
}

/// Returns a path inside the archive with `/` only, and without drives, roots, `.` and `..`, and
/// whether it would have led out.
fn sanitized_path(path: &str) -> (String, bool) {
    let is_drive = |part: &str| part.len() == 2 && part.ends_with(':');
    let mut leads_out = path.starts_with(['/', '\\']);
    let mut parts: Vec<&str> = Vec::new();
    for (index, part) in path.split(['/', '\\']).enumerate() {
        match part {
            "" | "." => {}
            ".." => leads_out = true,
            drive if index == 0 && is_drive(drive) => leads_out = true,
            part => parts.push(part),
        }
    }
    (parts.join("/"), leads_out)
}

#[cfg(test)]
mod tests;
