//! Everything that a page and a desktop window do differently: files, addresses, storage, time. The same names on both sides.
//!
//! What takes time answers through an [`Inbox`]; the app takes the answers when it is drawn next.

mod address;
#[cfg_attr(not(target_arch = "wasm32"), expect(dead_code, reason = "some things happen to a page only"))]
mod inbox;
mod vault;

#[cfg(not(target_arch = "wasm32"))]
mod native;
#[cfg(target_arch = "wasm32")]
mod web;

#[cfg(not(target_arch = "wasm32"))]
pub(crate) use native::*;
#[cfg(target_arch = "wasm32")]
pub(crate) use web::*;

pub(crate) use inbox::{Inbox, Incoming};
pub(crate) use vault::Vault;

use segue::session::Saved;
use segue::session::reading::ReadReport;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// The largest file that is read. A motion file of that size holds days; more would only fill the memory.
pub(crate) const MAX_FILE_BYTES: u64 = 512 * 1024 * 1024;

/// The bytes of a file.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum FileBytes {
    /// Here.
    Here(Arc<[u8]>),
    /// A large file: where the platform has it.
    Large(LargeFile),
}

/// The files of stored work, by the SHA-256 of their bytes in hexadecimal.
pub(crate) type StoredFiles = BTreeMap<String, FileBytes>;

/// What a thread or worker that reads a file tells.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum ReadNews {
    /// So many bytes are read.
    Progress(u64),
    /// It is done, or cannot be done.
    Done(Result<ReadReport, String>),
}

/// Work that was stored on an earlier visit.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Stored {
    /// The library and the parameters.
    pub(crate) saved: Saved,
    /// The bytes of the library's files.
    pub(crate) files: StoredFiles,
}

/// Work to be stored.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Work {
    /// The library and the parameters.
    pub(crate) saved: Saved,
    /// The ids of all clips that this window ever read or wrote; see [`Saved::with_others_of`].
    pub(crate) known: BTreeSet<String>,
    /// The bytes of the library's files. Stored files that no stored clip comes from are deleted.
    pub(crate) files: StoredFiles,
}

impl Work {
    /// What is to be stored where `record` is at present: this work, with what other windows have added. As JSON, and the files that it needs.
    fn over(&self, record: Option<&str>) -> Result<(String, BTreeSet<String>), serde_json::Error> {
        let there = record
            .and_then(|record| serde_json::from_str::<Saved>(record).ok())
            .unwrap_or_default();
        let all = self.saved.clone().with_others_of(&there, &self.known);
        Ok((serde_json::to_string(&all)?, all.files().into_iter().map(str::to_owned).collect()))
    }
}

/// What a gamepad says. Sticks from -1 to 1, to the right and up.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Gamepad {
    /// The left stick.
    pub(crate) left: [f32; 2],
    /// The right stick.
    pub(crate) right: [f32; 2],
    /// A right shoulder button, or the first face button.
    pub(crate) run: bool,
    /// A left shoulder button.
    pub(crate) strafe: bool,
}

/// Why a file of that size is not read, where up to `most` bytes are; `None` when it is.
fn too_large(name: &str, bytes: u64, most: u64) -> Option<String> {
    (bytes > most).then(|| {
        let in_words = |bytes: u64| match bytes.div_ceil(1024) {
            small @ ..1024 => format!("{small} KB"),
            large => format!("{} MB", large.div_ceil(1024)),
        };
        format!("{name} has {}; files of up to {} are read.", in_words(bytes), in_words(most))
    })
}

/// How the names of motion files end. A file that is dropped by itself is looked into whatever its name; of a folder these are taken.
const MOTION_ENDINGS: [&str; 7] = ["bvh", "asf", "amc", "glb", "gltf", "zip", "gz"];

/// More files of one folder are not read, as of an archive.
const MOST_FILES_OF_FOLDER: usize = segue::formats::archive::MOST_FILES;

/// Whether a file in a folder is read. Hidden ones are not: what a Mac adds to a folder ends like the files it adds it for.
fn is_motion_file(name: &str) -> bool {
    let known = |own: &str| MOTION_ENDINGS.iter().any(|ending| own.eq_ignore_ascii_case(ending));
    !name.starts_with('.') && name.rsplit_once('.').is_some_and(|(_, own)| known(own))
}

/// What is said of a folder without such files.
fn no_motion_in(folder: &str) -> String {
    format!("{folder} has no motion files (.{}).", MOTION_ENDINGS.join(", ."))
}

/// What is said of a folder with more files than are read.
fn too_many_in(folder: &str) -> String {
    format!("{folder} has more than {MOST_FILES_OF_FOLDER} motion files: the first {MOST_FILES_OF_FOLDER} are read.")
}

/// The name of a file without the folders before it.
fn last_part(path: &str) -> &str {
    path.rsplit(['/', '\\']).find(|part| !part.is_empty()).unwrap_or(path)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn motion_files_are_known_by_their_ending() {
        assert!(["a.bvh", "A.BVH", "x.tar.gz", "01.AMC"].into_iter().all(is_motion_file));
        assert!(
            ![".bvh", "._a.bvh", "bvh", "notes.txt", "a.bvh.bak", ""]
                .into_iter()
                .any(is_motion_file)
        );
    }
}
