//! Everything that a page and a desktop window do differently: files, addresses, storage, time. The
//! same names on both sides.
//!
//! What takes time answers through an [`Inbox`]; the app takes the answers when it is drawn next.

mod address;
#[cfg_attr(
    not(target_arch = "wasm32"),
    expect(dead_code, reason = "some things happen to a page only")
)]
mod inbox;
#[cfg_attr(
    not(any(test, target_arch = "wasm32")),
    expect(dead_code, reason = "a folder needs no rows and no windows that leave")
)]
mod records;
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

use segue_session::reading::ReadReport;
use segue_session::{Saved, SavedEntry};
use segue_text::{Message, msg};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// The largest file that is read. A motion file of that size holds days; more would only fill the
/// memory.
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
    /// There is no memory for what it gave, so many bytes.
    NoRoom(u64),
    /// It is done, or cannot be done.
    Done(Result<ReadReport, String>),
}

/// Work that was stored on an earlier visit, or by another window.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Stored {
    /// The library and the parameters; none where there is no record of them that can be read.
    pub(crate) saved: Option<Saved>,
    /// Clips that came from files and stand in no record.
    pub(crate) loose: Vec<SavedEntry>,
    /// The bytes of the library's files.
    pub(crate) files: StoredFiles,
}

/// A clip that has just come from a file, with the file's bytes: it is stored at once.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Arrival {
    /// The clip.
    pub(crate) entry: SavedEntry,
    /// The SHA-256 of its file.
    pub(crate) sha256: String,
    /// The file's bytes.
    pub(crate) bytes: FileBytes,
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
    /// What is to be stored where `there` is stored at present: this work, with what other windows
    /// have added. Clips whose files are not `held` in the storage are left out.
    fn over(&self, there: &Saved, held: impl Fn(&str) -> bool) -> Saved {
        let mut all = self.saved.clone().with_others_of(there, &self.known);
        all.entries.retain(|entry| entry.file.as_ref().is_none_or(|file| held(&file.sha256)));
        all
    }

    /// The clips whose files are not `held` in the storage, each with its file.
    #[cfg(any(test, target_arch = "wasm32"))]
    fn missing(&self, held: impl Fn(&str) -> bool) -> Vec<Arrival> {
        let entries =
            self.saved.entries.iter().filter_map(|entry| Some((entry, entry.file.as_ref()?)));
        entries
            .filter(|(_, file)| !held(&file.sha256))
            .filter_map(|(entry, file)| {
                Some(Arrival {
                    entry: entry.clone(),
                    sha256: file.sha256.clone(),
                    bytes: self.files.get(&file.sha256)?.clone(),
                })
            })
            .collect()
    }
}

/// A few names, and how many there are besides: `a.bvh, b.bvh, c.bvh and 12 more`.
#[cfg(any(test, target_arch = "wasm32"))]
fn in_short(names: &[String]) -> Message {
    const MOST: usize = 3;
    let first: Vec<String> = names.iter().take(MOST).cloned().collect();
    match names.len().saturating_sub(MOST) {
        0 => msg!("{names}", names = first),
        more => msg!("{names} and {more} more", names = first, more),
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
fn too_large(name: &str, bytes: u64, most: u64) -> Option<Message> {
    (bytes > most).then(|| {
        let in_words = |bytes: u64| match bytes.div_ceil(1024) {
            size @ ..1024 => msg!("{size} KB", size),
            size => msg!("{size} MB", size = size.div_ceil(1024)),
        };
        let (size, most) = (in_words(bytes), in_words(most));
        msg!(
            "{name} has {size}; files of up to {most} are read.",
            name = name.to_owned(),
            size,
            most
        )
    })
}

/// How the names of motion files end. A file that is dropped by itself is looked into whatever its
/// name; of a folder these are taken.
const MOTION_ENDINGS: [&str; 7] = ["bvh", "asf", "amc", "glb", "gltf", "zip", "gz"];

/// More files of one folder are not read, as of an archive.
const MOST_FILES_OF_FOLDER: usize = segue_formats::archive::MAX_FILES;

/// Whether a file in a folder is read. Hidden ones are not: what a Mac adds to a folder ends like
/// the files it adds it for.
fn is_motion_file(name: &str) -> bool {
    let known = |own: &str| MOTION_ENDINGS.iter().any(|ending| own.eq_ignore_ascii_case(ending));
    !name.starts_with('.') && name.rsplit_once('.').is_some_and(|(_, own)| known(own))
}

/// What is said of a folder without such files.
fn no_motion_in(folder: &str) -> Message {
    let endings = MOTION_ENDINGS.map(|ending| format!(".{ending}")).to_vec();
    msg!("{folder} has no motion files ({endings}).", folder = folder.to_owned(), endings)
}

/// What is said of a folder with more files than are read.
fn too_many_in(folder: &str) -> Message {
    msg!(
        "{folder} has more than {most} motion files: the first {most} are read.",
        folder = folder.to_owned(),
        most = MOST_FILES_OF_FOLDER
    )
}

/// The name of a file without the folders before it.
fn last_part(path: &str) -> &str {
    path.rsplit(['/', '\\']).find(|part| !part.is_empty()).unwrap_or(path)
}

/// A stored clip of that id; `name~sha` is one that came from a file.
#[cfg(test)]
fn clip_of(id: &str) -> SavedEntry {
    let sha256 = id.split_once('~').map(|(_, sha256)| sha256);
    let file = sha256
        .map(|sha256| serde_json::json!({ "name": id, "sha256": sha256, "index": 0, "options": segue_formats::ImportOptions::default() }));
    serde_json::from_value(serde_json::json!({ "id": id, "name": id, "file": file, "roles": null }))
        .unwrap()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_clip_without_its_file_is_not_recorded() {
        let work = Work {
            saved: Saved {
                query: "t=1".to_owned(),
                entries: ["idle", "a~11", "b~22", "c~33"].map(clip_of).into(),
            },
            known: BTreeSet::new(),
            files: [("22".to_owned(), FileBytes::Here(Arc::from([2_u8])))].into(),
        };
        let held = |sha256: &str| sha256 == "11";
        let ids: Vec<String> =
            work.over(&Saved::default(), held).entries.into_iter().map(|entry| entry.id).collect();
        assert_eq!(ids, ["idle", "a~11"]);
        // Nobody has the bytes of the third.
        let missing: Vec<String> =
            work.missing(held).into_iter().map(|arrival| arrival.sha256).collect();
        assert_eq!(missing, ["22"]);
    }

    #[test]
    fn many_names_are_told_in_short() {
        let names: Vec<String> = ["a", "b", "c", "d", "e"].map(str::to_owned).into();
        assert_eq!(
            [in_short(&names[..3]), in_short(&names)].map(|told| told.to_string()),
            ["a, b, c", "a, b, c and 2 more"]
        );
    }

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
