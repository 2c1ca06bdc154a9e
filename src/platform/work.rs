//! The user's work on its way to storage and back.

use super::file_bytes::{FileBytes, StoredFiles};
use segue_session::{Saved, SavedEntry};
use std::collections::BTreeSet;

/// Work that was stored on an earlier visit, or by another window.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct StoredWork {
    /// The library and the parameters; `None` where no record of them can be read.
    pub(crate) saved: Option<Saved>,
    /// Clips of files that no record names.
    pub(crate) loose: Vec<SavedEntry>,
    /// The bytes of the library's files.
    pub(crate) files: StoredFiles,
}

/// A clip that has just been read from a file, with the file's bytes. It is stored at once.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct NewClip {
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
    /// The ids of all clips that this window has ever read or written; see
    /// [`Saved::with_others_of`].
    pub(crate) known: BTreeSet<String>,
    /// The bytes of the library's files. Stored files that no stored clip comes from are deleted.
    pub(crate) files: StoredFiles,
    /// The SHA-256 of files that are not deleted, because undo may restore their clips.
    pub(crate) kept: BTreeSet<String>,
}

impl Work {
    /// Returns the record to store in place of the present one, `there`: this work, and what other
    /// windows have added. Clips whose files are not `held` in the storage are left out.
    pub(super) fn over(&self, there: &Saved, held: impl Fn(&str) -> bool) -> Saved {
        let mut all = self.saved.clone().with_others_of(there, &self.known);
        all.entries.retain(|entry| entry.file.as_ref().is_none_or(|file| held(&file.sha256)));
        all
    }

    /// Returns the clips whose files are not `held` in the storage, each with its file.
    #[cfg(any(test, target_arch = "wasm32"))]
    pub(super) fn missing(&self, held: impl Fn(&str) -> bool) -> Vec<NewClip> {
        let entries =
            self.saved.entries.iter().filter_map(|entry| Some((entry, entry.file.as_ref()?)));
        entries
            .filter(|(_, file)| !held(&file.sha256))
            .filter_map(|(entry, file)| {
                Some(NewClip {
                    entry: entry.clone(),
                    sha256: file.sha256.clone(),
                    bytes: self.files.get(&file.sha256)?.clone(),
                })
            })
            .collect()
    }
}

/// Returns a stored clip with that id; `name~sha` is one that came from a file.
#[cfg(test)]
pub(super) fn clip_of(id: &str) -> SavedEntry {
    let sha256 = id.split_once('~').map(|(_, sha256)| sha256);
    let file = sha256
        .map(|sha256| serde_json::json!({ "name": id, "sha256": sha256, "index": 0, "options": segue_formats::ImportOptions::default() }));
    serde_json::from_value(serde_json::json!({ "id": id, "name": id, "file": file, "roles": null }))
        .unwrap()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;

    #[test]
    fn clip_without_its_file_is_not_recorded() {
        let work = Work {
            saved: Saved {
                query: "t=1".to_owned(),
                entries: ["idle", "a~11", "b~22", "c~33"].map(clip_of).into(),
                ..Saved::default()
            },
            known: BTreeSet::new(),
            files: [("22".to_owned(), FileBytes::Here(Arc::from([2_u8])))].into(),
            kept: BTreeSet::new(),
        };
        let held = |sha256: &str| sha256 == "11";
        let ids: Vec<String> =
            work.over(&Saved::default(), held).entries.into_iter().map(|entry| entry.id).collect();
        assert_eq!(ids, ["idle", "a~11"]);
        // The bytes of the third are neither in the storage nor in the work.
        let missing: Vec<String> = work.missing(held).into_iter().map(|clip| clip.sha256).collect();
        assert_eq!(missing, ["22"]);
    }
}
