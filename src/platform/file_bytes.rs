//! Bytes of files, in memory or with the platform.

use super::LargeFile;
use segue_session::reading::Content;
use std::collections::BTreeMap;
use std::sync::Arc;

/// The bytes of a file.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum FileBytes {
    /// A small file in memory.
    Here(Arc<[u8]>),
    /// A file that the platform holds.
    Large(LargeFile),
}

impl FileBytes {
    /// Returns whether only the storage has them.
    pub(crate) fn is_stored(&self) -> bool {
        matches!(self, Self::Large(file) if file.is_stored())
    }
}

/// The files of stored work, by the SHA-256 of their bytes in hexadecimal.
pub(crate) type StoredFiles = BTreeMap<String, FileBytes>;

/// A store of the files that are outside of the document, which refers to them by keys.
#[derive(Debug, Default)]
pub(crate) struct LargeFileStore {
    files: BTreeMap<String, FileBytes>,
    inserted: u64,
}

impl LargeFileStore {
    /// Adds a file that was not read yet. Returns its key until [`Self::set_sha256`].
    pub(crate) fn insert(&mut self, file: LargeFile) -> String {
        self.inserted += 1;
        // A SHA-256 contains no space, so the keys are distinct.
        let key = format!("file {}", self.inserted);
        self.files.insert(key.clone(), FileBytes::Large(file));
        key
    }

    /// Adds the file of that SHA-256.
    pub(crate) fn insert_as(&mut self, sha256: String, bytes: FileBytes) {
        self.files.insert(sha256, bytes);
    }

    /// Makes its SHA-256 the key of a file that was read.
    pub(crate) fn set_sha256(&mut self, key: &str, sha256: &str) {
        if let Some(file) = self.files.remove(key) {
            self.files.insert(sha256.to_owned(), file);
        }
    }

    /// Removes a file.
    pub(crate) fn remove(&mut self, key: &str) {
        self.files.remove(key);
    }

    /// Takes over a file of stored work, if it is large. Returns the content that the document is
    /// to hold for it; `None` where the file is not among the stored ones.
    pub(crate) fn restore(&mut self, stored: &StoredFiles, sha256: &str) -> Option<Content> {
        Some(match stored.get(sha256)? {
            FileBytes::Here(bytes) => Content::Here(bytes.clone()),
            FileBytes::Large(file) => {
                self.files.insert(sha256.to_owned(), FileBytes::Large(file.clone()));
                Content::Outside(sha256.to_owned())
            }
        })
    }

    /// Returns the bytes of a content of the document; `None` for a file that was removed.
    pub(crate) fn bytes_of(&self, content: &Content) -> Option<FileBytes> {
        match content {
            Content::Here(bytes) => Some(FileBytes::Here(bytes.clone())),
            Content::Outside(key) => self.files.get(key).cloned(),
        }
    }
}
