//! Storage of large files by key.

use super::{FileBytes, LargeFile, StoredFiles};
use segue_session::reading::Content;
use std::collections::BTreeMap;

/// The large files that the document only knows by a key.
#[derive(Debug, Default)]
pub(crate) struct Vault {
    files: BTreeMap<String, LargeFile>,
    taken: u64,
}

impl Vault {
    /// Takes a file that was not read yet; returns its key until then.
    pub(crate) fn take(&mut self, file: LargeFile) -> String {
        self.taken += 1;
        // No SHA-256 has a space.
        let key = format!("file {}", self.taken);
        self.files.insert(key.clone(), file);
        key
    }

    /// A file was read: from now on its SHA-256 is the key.
    pub(crate) fn name(&mut self, key: &str, sha256: &str) {
        if let Some(file) = self.files.remove(key) {
            self.files.insert(sha256.to_owned(), file);
        }
    }

    /// Lets go of a file.
    pub(crate) fn drop_file(&mut self, key: &str) {
        self.files.remove(key);
    }

    /// What is stored comes back: how the document is to hold the file of that SHA-256.
    pub(crate) fn restore(&mut self, stored: &StoredFiles, sha256: &str) -> Option<Content> {
        Some(match stored.get(sha256)? {
            FileBytes::Here(bytes) => Content::Here(bytes.clone()),
            FileBytes::Large(file) => {
                self.files.insert(sha256.to_owned(), file.clone());
                Content::Outside(sha256.to_owned())
            }
        })
    }

    /// The bytes of what the document holds.
    pub(crate) fn bytes_of(&self, content: &Content) -> Option<FileBytes> {
        match content {
            Content::Here(bytes) => Some(FileBytes::Here(bytes.clone())),
            Content::Outside(key) => self.files.get(key).cloned().map(FileBytes::Large),
        }
    }
}
