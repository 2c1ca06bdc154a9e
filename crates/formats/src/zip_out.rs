//! Writing of zip archives.

use flate2::{Compression, Crc, write::DeflateEncoder};
use std::collections::BTreeSet;
use std::io::Write as _;

/// The date of all entries, 1 January 1980 in MS-DOS format, so that the same files always give the
/// same bytes.
const DOS_DATE: u16 = 1 << 5 | 1;
/// The flag for UTF-8 names.
const UTF8: u16 = 1 << 11;
const STORED: u16 = 0;
const DEFLATED: u16 = 8;
/// The size of an entry's headers without its name and content, bytes.
const OVERHEAD: usize = 30 + 46;
/// The size of the end-of-archive record, bytes.
const END: usize = 22;

/// A file that is ready for an archive.
#[derive(Clone, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct PackedFile {
    /// Its CRC-32.
    pub crc: u32,
    /// The number of its bytes before they were compressed.
    pub size: u32,
    /// Its compressed bytes (RFC 1951).
    #[serde(skip)]
    pub deflated: Vec<u8>,
}

impl PackedFile {
    /// Compresses a file; `None` if it has 4 GiB or more.
    #[must_use]
    pub fn new(bytes: &[u8]) -> Option<Self> {
        let size = u32::try_from(bytes.len()).ok()?;
        let mut crc = Crc::new();
        crc.update(bytes);
        let mut encoder = DeflateEncoder::new(Vec::new(), Compression::fast());
        // Writing to a vector cannot fail.
        encoder.write_all(bytes).ok()?;
        Some(Self { crc: crc.sum(), size, deflated: encoder.finish().ok()? })
    }
}

/// An archive has no room for a file: it would have 4 GiB or more, or 65,536 files.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error, segue_text::ToMessage)]
#[error("the archive is full: convert the remaining files in a second run")]
pub struct ZipFull;

/// A zip archive that is written file by file.
#[derive(Clone, Debug, Default)]
pub struct ZipWriter {
    bytes: Vec<u8>,
    /// The central directory so far.
    list: Vec<u8>,
    names: BTreeSet<String>,
}

impl ZipWriter {
    /// Adds a file without compressing it, unless there is one of that name.
    ///
    /// # Errors
    /// [`ZipFull`] when there is no room for it; the archive is as before.
    pub fn store(&mut self, path: &str, bytes: &[u8]) -> Result<(), ZipFull> {
        let mut crc = Crc::new();
        crc.update(bytes);
        let size = u32::try_from(bytes.len()).map_err(|_| ZipFull)?;
        self.add(path, STORED, [crc.sum(), size], bytes)
    }

    /// Adds a compressed file, unless there is one of that name.
    ///
    /// # Errors
    /// [`ZipFull`] when there is no room for it; the archive is as before.
    pub fn add_packed(&mut self, path: &str, file: &PackedFile) -> Result<(), ZipFull> {
        self.add(path, DEFLATED, [file.crc, file.size], &file.deflated)
    }

    /// Returns the number of bytes so far.
    #[must_use]
    pub fn len(&self) -> usize {
        self.bytes.len() + self.list.len() + END
    }

    /// Returns whether there is no file yet.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.names.is_empty()
    }

    fn add(
        &mut self,
        path: &str,
        method: u16,
        [crc, size]: [u32; 2],
        content: &[u8],
    ) -> Result<(), ZipFull> {
        let length = u16::try_from(path.len()).map_err(|_| ZipFull)?;
        let grown = self.len() + content.len() + OVERHEAD + 2 * path.len();
        if u32::try_from(grown).is_err() || self.names.len() >= usize::from(u16::MAX) {
            return Err(ZipFull);
        }
        if !self.names.insert(path.to_owned()) {
            return Ok(());
        }
        let mut common: Vec<u8> = Vec::new();
        let flags = if path.is_ascii() { 0 } else { UTF8 };
        // Version 2.0; flags, method, time and date.
        for field in [20, flags, method, 0, DOS_DATE] {
            common.extend(u16::to_le_bytes(field));
        }
        for field in [crc, content.len() as u32, size] {
            common.extend(field.to_le_bytes());
        }
        common.extend(length.to_le_bytes());
        common.extend(0_u16.to_le_bytes());
        let at = self.bytes.len() as u32;
        self.bytes.extend(b"PK\x03\x04");
        self.bytes.extend(&common);
        self.bytes.extend(path.as_bytes());
        self.bytes.extend(content);
        self.list.extend(b"PK\x01\x02\x14\0");
        self.list.extend(&common);
        // No comment, first disk, no attributes.
        self.list.extend([0; 10]);
        self.list.extend(at.to_le_bytes());
        self.list.extend(path.as_bytes());
        Ok(())
    }

    /// Returns the archive.
    #[must_use]
    pub fn finish(mut self) -> Vec<u8> {
        let (at, size) = (self.bytes.len() as u32, self.list.len() as u32);
        let count = self.names.len() as u16;
        self.bytes.append(&mut self.list);
        self.bytes.extend(b"PK\x05\x06\0\0\0\0");
        for number in [count, count] {
            self.bytes.extend(number.to_le_bytes());
        }
        for number in [size, at] {
            self.bytes.extend(number.to_le_bytes());
        }
        self.bytes.extend(0_u16.to_le_bytes());
        self.bytes
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::archive::{ArchiveLimits, unpack};

    #[test]
    fn archive_is_unpacked_to_its_files() {
        let text = "HIERARCHY ".repeat(5000);
        let mut zip = ZipWriter::default();
        assert!(zip.is_empty());
        zip.store("a/stored.bvh", text.as_bytes()).unwrap();
        let stored = zip.len();
        let packed = PackedFile::new(text.as_bytes()).unwrap();
        zip.add_packed("走/packed.bvh", &packed).unwrap();
        // A second file of the same name is skipped.
        zip.store("a/stored.bvh", b"other").unwrap();
        assert!(zip.len() - stored < 2000);
        let length = zip.len();
        let bytes = zip.finish();
        assert_eq!(bytes.len(), length);
        let files = unpack("x.zip", &bytes, &ArchiveLimits::default()).unwrap().files;
        let names: Vec<&str> = files.iter().map(|file| file.path.as_str()).collect();
        assert_eq!(names, ["a/stored.bvh", "走/packed.bvh"]);
        assert!(files.iter().all(|file| file.bytes == text.as_bytes()));
    }

    #[test]
    fn archive_refuses_a_name_that_is_too_long() {
        let mut zip = ZipWriter::default();
        assert_eq!(zip.store(&"x".repeat(70_000), b""), Err(ZipFull));
        assert!(zip.is_empty());
    }
}
