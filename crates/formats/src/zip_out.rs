//! Writing of zip archives.

pub use flate2::Crc;
use flate2::{Compression, write::DeflateEncoder};
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

/// All of a zip archive but the contents of its files, for whoever has these elsewhere: the headers
/// that stand before them, and the directory behind the last.
#[derive(Clone, Debug, Default)]
pub struct ZipIndex {
    /// The number of bytes of the headers and contents so far.
    at: usize,
    /// The central directory so far.
    list: Vec<u8>,
    names: BTreeSet<String>,
}

impl ZipIndex {
    /// Adds a file that is not compressed, and returns the header that stands before its content;
    /// `None` if there is a file of that name.
    ///
    /// # Errors
    /// [`ZipFull`] when there is no room for it; the index is as before.
    pub fn store(&mut self, path: &str, content: &Crc) -> Result<Option<Vec<u8>>, ZipFull> {
        let size = content.amount();
        self.add(path, STORED, [content.sum(), size], size as usize)
    }

    /// Returns the directory, which stands behind the content of the last file.
    #[must_use]
    pub fn finish(mut self) -> Vec<u8> {
        let (at, size) = (self.at as u32, self.list.len() as u32);
        let count = self.names.len() as u16;
        self.list.extend(b"PK\x05\x06\0\0\0\0");
        for number in [count, count] {
            self.list.extend(number.to_le_bytes());
        }
        for number in [size, at] {
            self.list.extend(number.to_le_bytes());
        }
        self.list.extend(0_u16.to_le_bytes());
        self.list
    }

    fn len(&self) -> usize {
        self.at + self.list.len() + END
    }

    /// Adds a file with `packed` bytes of content; see [`Self::store`].
    fn add(
        &mut self,
        path: &str,
        method: u16,
        [crc, size]: [u32; 2],
        packed: usize,
    ) -> Result<Option<Vec<u8>>, ZipFull> {
        let length = u16::try_from(path.len()).map_err(|_| ZipFull)?;
        let grown = self.len() + packed + OVERHEAD + 2 * path.len();
        if u32::try_from(grown).is_err() || self.names.len() >= usize::from(u16::MAX) {
            return Err(ZipFull);
        }
        if !self.names.insert(path.to_owned()) {
            return Ok(None);
        }
        let mut common: Vec<u8> = Vec::new();
        let flags = if path.is_ascii() { 0 } else { UTF8 };
        // Version 2.0; flags, method, time and date.
        for field in [20, flags, method, 0, DOS_DATE] {
            common.extend(u16::to_le_bytes(field));
        }
        for field in [crc, packed as u32, size] {
            common.extend(field.to_le_bytes());
        }
        common.extend(length.to_le_bytes());
        common.extend(0_u16.to_le_bytes());
        let header = [b"PK\x03\x04", &common[..], path.as_bytes()].concat();
        self.list.extend(b"PK\x01\x02\x14\0");
        self.list.extend(&common);
        // No comment, first disk, no attributes.
        self.list.extend([0; 10]);
        self.list.extend((self.at as u32).to_le_bytes());
        self.list.extend(path.as_bytes());
        self.at += header.len() + packed;
        Ok(Some(header))
    }
}

/// A zip archive that is written file by file.
#[derive(Clone, Debug, Default)]
pub struct ZipWriter {
    bytes: Vec<u8>,
    index: ZipIndex,
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
        self.index.len()
    }

    /// Returns whether there is no file yet.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.index.names.is_empty()
    }

    fn add(
        &mut self,
        path: &str,
        method: u16,
        sums: [u32; 2],
        content: &[u8],
    ) -> Result<(), ZipFull> {
        if let Some(header) = self.index.add(path, method, sums, content.len())? {
            self.bytes.extend(header);
            self.bytes.extend(content);
        }
        Ok(())
    }

    /// Returns the archive.
    #[must_use]
    pub fn finish(mut self) -> Vec<u8> {
        self.bytes.append(&mut self.index.finish());
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
    fn archive_of_pieces_is_that_of_the_writer() {
        let (mut zip, mut index, mut pieces) =
            (ZipWriter::default(), ZipIndex::default(), Vec::new());
        for (path, content) in [("a.gltf", &b"{}"[..]), ("b/skin.png", b""), ("a.gltf", b"other")] {
            zip.store(path, content).unwrap();
            let mut crc = Crc::new();
            // In parts, as they are read.
            content.chunks(1).for_each(|part| crc.update(part));
            if let Some(header) = index.store(path, &crc).unwrap() {
                pieces.extend([&header, content].concat());
            }
        }
        pieces.extend(index.finish());
        assert_eq!(pieces, zip.finish());
    }

    #[test]
    fn archive_refuses_a_name_that_is_too_long() {
        let mut zip = ZipWriter::default();
        assert_eq!(zip.store(&"x".repeat(70_000), b""), Err(ZipFull));
        assert!(zip.is_empty());
    }
}
