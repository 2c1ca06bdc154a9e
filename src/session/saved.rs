//! What is stored of the work, so that it survives a reload. The files' bytes are stored beside it, by their SHA-256.

use super::library::{Entry, Origin};
use super::reading::Companion;
use crate::formats::{FileKind, ImportOptions};
use crate::skeleton::Roles;
use serde::{Deserialize, Serialize};

/// The work, without the bytes of its files.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Saved {
    /// The parameters, as a link.
    pub query: String,
    /// The library in order.
    pub entries: Vec<SavedEntry>,
}

/// One clip of the library.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SavedEntry {
    /// Its id.
    pub id: String,
    /// Its name.
    pub name: String,
    /// The file it comes from; `None` for what Segue can make or fetch again by the id.
    pub file: Option<SavedFile>,
    /// Roles that were corrected by hand.
    pub roles: Option<Roles>,
}

/// A file without its bytes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SavedFile {
    /// The file's name.
    pub name: String,
    /// SHA-256 of its bytes, hexadecimal: where they are stored.
    pub sha256: String,
    /// How many bytes it has.
    #[serde(default)]
    pub size: u64,
    /// What it is.
    #[serde(default = "bvh")]
    pub kind: FileKind,
    /// The skeleton file that it is read with.
    #[serde(default)]
    pub companion: Option<Companion>,
    /// Which of the clips in it.
    pub index: usize,
    /// How to read it.
    pub options: ImportOptions,
}

/// What there was before there were other kinds.
fn bvh() -> FileKind {
    FileKind::Bvh
}

impl From<&Entry> for SavedEntry {
    fn from(entry: &Entry) -> Self {
        let file = match &entry.origin {
            Origin::File(file) => Some(SavedFile {
                name: file.name.clone(),
                sha256: file.sha256.clone(),
                size: file.size,
                kind: file.kind,
                companion: file.companion.clone(),
                index: file.index,
                options: file.options,
            }),
            Origin::Preset | Origin::Sample(_) | Origin::Made => None,
        };
        Self {
            id: entry.id.clone(),
            name: entry.name.clone(),
            file,
            roles: entry.roles_by_hand.clone(),
        }
    }
}
