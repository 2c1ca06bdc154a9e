//! Restoring of stored work to the library.

use super::intake::FileIntake;
use crate::built_in::built_in_entries;
use crate::document::Document;
use crate::labs::{recipe_name, recipe_params};
use crate::library::{Entry, Library, Origin, SourceFile};
use crate::notice::{Level, Notices};
use crate::outside;
use crate::reading::{Content, LARGE_BYTES};
use crate::saved::{KnownClip, SavedEntry, SavedFile};
use segue_formats::ImportOptions;
use segue_text::msg;
use std::sync::Arc;

impl FileIntake {
    /// Reads the files of the library of which nothing is known yet, and requests the bundled
    /// takes. The motions of the others are read when they are needed. Names those that can no
    /// longer be read together with those that are already `lost`, and removes their clips.
    pub(crate) fn read_stored(
        &mut self,
        document: &mut Document,
        notices: &mut Notices,
        mut lost: Vec<String>,
    ) {
        self.request_missing_samples(document);
        let entries = document.library.entries().to_vec();
        for entry in entries {
            let Origin::File(file) = &entry.origin else {
                continue;
            };
            // A motion that waits for a skeleton was reported when it was read.
            let waits = |entry: &Entry| entry.awaits_skeleton() && !entry.warnings.is_empty();
            let read_by_now = |entry: &Arc<Entry>| {
                entry.facts.is_some() || entry.unread.is_some() || waits(entry)
            };
            if document.library.get(&entry.id).is_none_or(read_by_now) {
                continue;
            }
            if self.read_anew(document, file, None).is_err() {
                document.library.remove(&entry.id);
                lost.push(file.name.clone());
            }
        }
        if !lost.is_empty() {
            notices.say(
                Level::Warning,
                msg!("Not found in this browser's storage any more: {lost}. Drop them again."),
            );
        }
    }
}

/// Returns the clips of stored work, and the names of missing files; `content_of` returns a file's
/// bytes by its SHA-256.
pub(crate) fn stored_entries(
    library: &Library,
    saved: &[SavedEntry],
    mut content_of: impl FnMut(&str) -> Option<Content>,
) -> (Vec<Entry>, Vec<String>) {
    let (mut entries, mut lost) = (Vec::new(), Vec::new());
    for stored in saved {
        let here = library.get(&stored.id).map(|entry| (**entry).clone());
        let is_as_stored = |entry: &Entry| {
            let is_read_so = match (&entry.origin, &stored.file) {
                (Origin::File(here), Some(file)) => {
                    here.options == file.options && here.skeleton_file == file.skeleton_file
                }
                (Origin::File(_), None) => false,
                (_, file) => file.is_none(),
            };
            is_read_so && entry.roles_by_hand == stored.roles
        };
        let entry = match (here, &stored.file) {
            (Some(here), _) if is_as_stored(&here) => here,
            (_, Some(file)) => {
                let Some(content) = content_of(&file.sha256) else {
                    lost.push(file.name.clone());
                    continue;
                };
                let entry =
                    Entry::new(&stored.id, stored.name.clone(), Origin::File(file.with(content)));
                match &stored.known {
                    Some(KnownClip { facts, about, warnings }) => Entry {
                        facts: Some(Arc::new(facts.clone())),
                        about: about.clone(),
                        warnings: warnings.clone(),
                        ..entry
                    },
                    None => entry,
                }
            }
            // Its motion was made with other roles.
            (Some(here), None) => Entry { motion: None, ..here },
            (None, None) => match built_in_entries().find(|entry| entry.id == stored.id) {
                Some(entry) if matches!(entry.origin, Origin::Sample(_)) && !stored.is_sample => {
                    continue;
                }
                Some(entry) => entry,
                None => match recipe_params(&stored.id) {
                    Some(params) => Entry::new(&stored.id, recipe_name(&params), Origin::Made),
                    None => continue,
                },
            },
        };
        entries.push(Entry {
            name: stored.name.clone(),
            roles_by_hand: stored.roles.clone(),
            batch: stored.batch,
            ..entry
        });
    }
    (entries, lost)
}

/// Returns whether nothing of a clip was set by hand.
pub(crate) fn is_as_it_came(entry: &Entry) -> bool {
    let own_name = match &entry.origin {
        Origin::File(_) => entry.facts.as_ref().map(|facts| outside::clip_name(&facts.name)),
        Origin::Made => recipe_params(&entry.id).map(|params| recipe_name(&params).to_string()),
        Origin::Preset | Origin::Sample(_) => {
            built_in_entries().find(|known| known.id == entry.id).map(|known| known.name)
        }
    };
    let is_read_as_ever =
        !matches!(&entry.origin, Origin::File(file) if file.options != ImportOptions::default());
    is_read_as_ever
        && entry.roles_by_hand.is_none()
        && own_name.is_none_or(|name| name == entry.name)
}

impl SavedFile {
    fn with(&self, content: Content) -> SourceFile {
        let size = match &content {
            Content::Here(bytes) => bytes.len() as u64,
            // Older states have no size, and only large files outside the document.
            Content::Outside(_) if self.size == 0 => LARGE_BYTES + 1,
            Content::Outside(_) => self.size,
        };
        SourceFile {
            name: self.name.clone(),
            sha256: self.sha256.clone(),
            content,
            size,
            kind: self.kind,
            skeleton_file: self.skeleton_file.clone(),
            index: self.index,
            options: self.options,
        }
    }
}
