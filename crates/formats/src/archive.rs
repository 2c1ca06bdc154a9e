//! Zip archives of motion files.
//!
//! What comes out is motion only, in the order of paths, whatever order the archive has. Nothing is
//! ever allocated because a header says so, an archive inside the archive is opened and one inside
//! that is not, and paths never lead out of the archive: they are names, nothing else.

use super::gzip::{no_memory, read_at_most};
use super::text::name as decoded;
use super::warning::{ImportWarning, Tally, WarningKind};
use super::{ImportError, ImportOptions, has_extension};
use flate2::bufread::{DeflateDecoder, GzDecoder};
use rawzip::{CompressionMethod, ErrorKind, ZipArchive, ZipFileHeaderRecord, ZipSliceArchive};
use segue_text::{Message, ToMessage, msg};
use std::io;

/// The endings of files that hold motion, or a part of it.
const MOTION: [&str; 6] = ["bvh", "asf", "amc", "glb", "gltf", "bin"];

/// See [`ArchiveLimits::default`].
pub const MAX_FILES: usize = 2000;

/// Archives inside archives are opened to this depth.
const DEPTH: usize = 1;

/// How much an archive may hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct ArchiveLimits {
    /// The most bytes that its motion files have together once they are unpacked. Larger archives
    /// are refused.
    pub max_bytes: usize,
    /// The most motion files that are read. Further ones are left out, and told.
    pub max_files: usize,
}

impl Default for ArchiveLimits {
    /// As much as a single file may have, in as many files as a list has that a person looks
    /// through.
    fn default() -> Self {
        Self { max_bytes: ImportOptions::default().max_bytes, max_files: MAX_FILES }
    }
}

/// A file of an archive, unpacked.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ArchivedFile {
    /// Where it lies in the archive, with `/` between folders; below an archive inside the archive,
    /// that one's path comes first. The ending `.gz` of a file that was packed once more is gone.
    pub path: String,
    /// What it holds.
    pub bytes: Vec<u8>,
}

/// What comes out of an archive.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Unpacked {
    /// The motion files, sorted by path; at least one.
    pub files: Vec<ArchivedFile>,
    /// What was left out, and why: one line per kind.
    pub warnings: Vec<ImportWarning>,
}

/// Whether the bytes start as a zip archive does.
#[must_use]
pub fn is_zip(bytes: &[u8]) -> bool {
    // The second one is an archive without files.
    bytes.starts_with(b"PK\x03\x04") || bytes.starts_with(b"PK\x05\x06")
}

/// Unpacks the motion files of a zip archive: `.bvh`, `.asf`, `.amc`, `.glb`, `.gltf` with its
/// `.bin`, each also packed once more as `.gz`.
///
/// A file that is damaged, encrypted or packed in an unusual way is left out with a warning, as
/// long as others are there.
///
/// # Errors
/// [`ImportError`] when this is no zip archive, when it is cut off, when its files unpack to more
/// than the limit, and when no motion comes out.
pub fn unpack(name: &str, bytes: &[u8], limits: &ArchiveLimits) -> Result<Unpacked, ImportError> {
    let mut unpacking = Unpacking {
        name,
        left: limits.max_bytes,
        limits: *limits,
        files: Vec::new(),
        tally: Tally::default(),
    };
    let archive = open(bytes).map_err(|why| ImportError::whole_file(name, why, "a zip archive"))?;
    unpacking.archive(&archive, "", 0)?;
    let Unpacking { mut files, tally, .. } = unpacking;
    let warnings = tally.into_warnings(b"");
    if files.is_empty() {
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
            "motion files (.bvh, .asf, .amc, .glb, .gltf)",
        ));
    }
    // Stable: of two files with one path, the one that comes first in the archive stays first.
    files.sort_by(|a, b| a.path.cmp(&b.path));
    Ok(Unpacked { files, warnings })
}

fn open(bytes: &[u8]) -> Result<ZipSliceArchive<&[u8]>, Message> {
    let cut_off = || Message::word("a zip archive without an end: it was cut off");
    let archive = ZipArchive::from_slice(bytes).map_err(|error| match error.kind() {
        ErrorKind::MissingEndOfCentralDirectory if is_zip(bytes) => cut_off(),
        ErrorKind::MissingEndOfCentralDirectory => "no zip archive".into(),
        _ => msg!("a damaged zip archive ({error})", error = error.to_string()),
    })?;
    // The end of an archive inside one that was cut off may look like its own. But then nothing in
    // it is at the start, and something comes after.
    let is_inner = archive.end_offset() < bytes.len() as u64
        && bytes.starts_with(b"PK\x03\x04")
        && archive.entries().all(|entry| entry.is_ok_and(|entry| entry.local_header_offset() > 0));
    if is_inner { Err(cut_off()) } else { Ok(archive) }
}

struct Unpacking<'a> {
    name: &'a str,
    /// Bytes that may still come out.
    left: usize,
    limits: ArchiveLimits,
    files: Vec<ArchivedFile>,
    tally: Tally,
}

/// Why a file did not come out.
enum Miss {
    /// It is left out.
    Unreadable(Message),
    /// The archive is refused.
    TooMuch,
    /// Likewise, for there is no memory for the file.
    NoMemory,
}

impl From<io::Error> for Miss {
    fn from(error: io::Error) -> Self {
        match error.kind() {
            io::ErrorKind::OutOfMemory => Self::NoMemory,
            _ => Self::Unreadable(msg!("it is damaged ({error})", error = error.to_string())),
        }
    }
}

impl Unpacking<'_> {
    fn archive(
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
        let (path, leads_out) = tidy(&decoded(entry.file_path().as_bytes()).0);
        if path.split('/').any(|part| part.starts_with('.') || part == "__MACOSX") {
            self.tally.add(WarningKind::HiddenFiles, None);
            return Ok(());
        }
        let path = if folder.is_empty() { path } else { format!("{folder}/{path}") };
        let is_zip = has_extension(&path, "zip");
        let packed_once_more = has_extension(&path, "gz").then(|| path.rsplit_once('.')).flatten();
        let motion = packed_once_more.map(|(inner, _)| inner).filter(|inner| is_motion(inner));
        if !is_zip && motion.is_none() && !is_motion(&path) {
            self.tally.add(WarningKind::OtherFiles, None);
            return Ok(());
        }
        if self.files.len() >= self.limits.max_files {
            let most = self.limits.max_files;
            self.tally.add(WarningKind::TooManyFiles { most }, None);
            return Ok(());
        }
        if leads_out {
            self.tally.add(WarningKind::PathsOutside, None);
        }
        if is_zip && depth >= DEPTH {
            self.unreadable(&path, "an archive inside an archive inside this one".into());
            return Ok(());
        }
        let mut bytes = match self.read(archive, entry) {
            Ok(bytes) => bytes,
            Err(miss) => return self.miss(&path, miss),
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
                Err(error) => return self.miss(&path, error.into()),
            }
        }
        self.left = self.left.saturating_sub(bytes.len());
        let path = kept.to_owned();
        self.files.push(ArchivedFile { path, bytes });
        Ok(())
    }

    fn read(
        &self,
        archive: &ZipSliceArchive<&[u8]>,
        entry: &ZipFileHeaderRecord<'_>,
    ) -> Result<Vec<u8>, Miss> {
        if entry.flags().is_encrypted() {
            return Err(Miss::Unreadable("it is encrypted".into()));
        }
        let packed = archive.get_entry(entry.wayfinder());
        let packed = packed.map_err(|error| {
            Miss::Unreadable(msg!("it is damaged ({error})", error = error.to_string()))
        })?;
        let bytes = match entry.compression_method() {
            CompressionMethod::STORE => {
                read_at_most(packed.verifying_reader(packed.data()), self.left)
            }
            CompressionMethod::DEFLATE => {
                read_at_most(packed.verifying_reader(DeflateDecoder::new(packed.data())), self.left)
            }
            other => {
                let name = other.name().map_or_else(
                    || msg!("method {number}", number = other.as_u16()),
                    Message::word,
                );
                return Err(Miss::Unreadable(msg!(
                    "it is packed with {name}, which is not read here"
                )));
            }
        };
        bytes?.ok_or(Miss::TooMuch)
    }

    /// Leaves a file out, or refuses the archive.
    fn miss(&mut self, path: &str, miss: Miss) -> Result<(), ImportError> {
        match miss {
            Miss::TooMuch => Err(self.too_much()),
            Miss::NoMemory => Err(no_memory(self.name)),
            Miss::Unreadable(why) => {
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

fn is_motion(path: &str) -> bool {
    MOTION.iter().any(|extension| has_extension(path, extension))
}

/// A path inside the archive: with `/` only, and without drives, roots, `.` and `..`. Tells whether
/// it would have led out.
fn tidy(path: &str) -> (String, bool) {
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
