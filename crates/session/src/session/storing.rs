//! The work into storage, and back from it: before anything is shown, or later.

use super::Session;
use crate::document::built_in_entries;
use crate::labs::{recipe_name, recipe_params};
use crate::library::{Entry, Origin, SourceFile};
use crate::link;
use crate::missing::look_for_clips;
use crate::notice::Level;
use crate::params::Key;
use crate::reading::{Content, LARGE_BYTES};
use crate::saved::{Saved, SavedEntry, SavedFile};
use segue_formats::ImportOptions;
use segue_text::msg;
use std::sync::Arc;

impl Session {
    /// What is stored of the work.
    #[must_use]
    pub fn saved(&self) -> Saved {
        Saved {
            query: self.query(),
            entries: self
                .document
                .library
                .entries()
                .iter()
                .map(|entry| SavedEntry::from(&**entry))
                .collect(),
        }
    }

    /// Brings stored work back; `content_of` gives a file's bytes by its SHA-256. Files that are
    /// gone are named in a notice, and so are those that can be read no longer, where they are read
    /// at once; those that are read elsewhere are asked for with [`super::Request::Read`], first
    /// what is shown. The parameters come from `query` when there is one (a link was opened), else
    /// from what was stored.
    pub fn restore(
        &mut self,
        saved: &Saved,
        content_of: impl FnMut(&str) -> Option<Content>,
        query: Option<&str>,
    ) {
        let (entries, lost) = self.stored_entries(&saved.entries, content_of);
        if !entries.is_empty() {
            self.document.library = entries.into_iter().collect();
        }
        // A language that was chosen by hand stays, whatever link the page is opened with, unless
        // the link names another.
        self.speak_as(saved);
        self.open_link(query.unwrap_or(&saved.query));
        self.document.forget_steps();
        // What was shown until now is none of this work's, and stands in for nothing of it.
        self.panes.clear();
        // What is shown is asked for first.
        self.refresh();
        self.read_stored(lost);
        look_for_clips(&mut self.document, &mut self.notices);
        self.refresh();
    }

    /// Brings stored work back into a session that has begun without it. The parameters stay as
    /// they are, and so does what came into the library or was said of a clip by hand meanwhile;
    /// every stored clip joins that. Taking back what was done before does not take them away.
    pub fn restore_late(&mut self, saved: &Saved, content_of: impl FnMut(&str) -> Option<Content>) {
        let (entries, lost) = self.stored_entries(&saved.entries, content_of);
        let before = std::mem::take(&mut self.document.library);
        let mut came = Vec::new();
        for entry in entries {
            let entry = match before.get(&entry.id) {
                Some(here) if !is_as_it_came(here) => Arc::clone(here),
                _ => Arc::new(entry),
            };
            if before.get(&entry.id).is_none() {
                came.push(entry.id.clone());
            }
            self.document.library.put_shared(entry);
        }
        let nothing_came = self.document.library.entries().is_empty();
        for entry in before.entries() {
            // A preset that is not stored was removed on an earlier visit. What the parameters name
            // of these comes back.
            let stays = nothing_came || !matches!(entry.origin, Origin::Preset);
            if stays && self.document.library.get(&entry.id).is_none() {
                self.document.library.put_shared(Arc::clone(entry));
            }
        }
        look_for_clips(&mut self.document, &mut self.notices);
        self.read_stored(lost);
        let came: Vec<_> =
            came.iter().filter_map(|id| self.document.library.get(id).cloned()).collect();
        self.document.history.add_to_all(&came);
        if self.document.params.get(Key::Lang) == &Key::Lang.param().default_value() {
            self.speak_as(saved);
        }
        self.document.library_revision += 1;
        self.refresh();
    }

    /// Adds clips that another window has stored. Those that are here already stay as they are, and
    /// taking back what was done before does not take the others away.
    pub fn add_stored(
        &mut self,
        saved: &[SavedEntry],
        content_of: impl FnMut(&str) -> Option<Content>,
    ) {
        let new: Vec<SavedEntry> = saved
            .iter()
            .filter(|entry| self.document.library.get(&entry.id).is_none())
            .cloned()
            .collect();
        let (entries, lost) = self.stored_entries(&new, content_of);
        for entry in entries {
            self.document.library.put(entry);
        }
        look_for_clips(&mut self.document, &mut self.notices);
        self.read_stored(lost);
        let came: Vec<_> =
            new.iter().filter_map(|entry| self.document.library.get(&entry.id).cloned()).collect();
        self.document.history.add_to_all(&came);
        self.document.library_revision += 1;
        self.refresh();
    }

    /// The clips of stored work, and the names of files that are gone.
    fn stored_entries(
        &self,
        saved: &[SavedEntry],
        mut content_of: impl FnMut(&str) -> Option<Content>,
    ) -> (Vec<Entry>, Vec<String>) {
        let (mut entries, mut lost) = (Vec::new(), Vec::new());
        for stored in saved {
            let here = self.document.library.get(&stored.id).map(|entry| (**entry).clone());
            let is_as_stored = |entry: &Entry| {
                let is_read_so = match (&entry.origin, &stored.file) {
                    (Origin::File(here), Some(file)) => {
                        here.options == file.options && here.companion == file.companion
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
                    Entry::new(&stored.id, &stored.name, Origin::File(file.with(content)))
                }
                // Whatever motion it has was made with other roles.
                (Some(here), None) => Entry { motion: None, ..here },
                (None, None) => match built_in_entries().find(|entry| entry.id == stored.id) {
                    Some(entry)
                        if matches!(entry.origin, Origin::Sample(_)) && !stored.is_sample =>
                    {
                        continue;
                    }
                    Some(entry) => entry,
                    None if recipe_params(&stored.id).is_some() => {
                        Entry::new(&stored.id, &stored.name, Origin::Made)
                    }
                    None => continue,
                },
            };
            entries.push(Entry {
                name: stored.name.clone(),
                roles_by_hand: stored.roles.clone(),
                ..entry
            });
        }
        (entries, lost)
    }

    /// Takes over the language that was chosen by hand.
    fn speak_as(&mut self, saved: &Saved) {
        if let Some((key, chosen)) =
            link::read(&saved.query).values.into_iter().find(|(key, _)| *key == Key::Lang)
        {
            self.document.set_unchecked(key, chosen);
        }
    }

    /// Reads the files of the library that have no motion yet, and asks for the bundled takes.
    /// Those that cannot be read any more are named with those that are `lost` already; their clips
    /// are gone.
    pub(super) fn read_stored(&mut self, mut lost: Vec<String>) {
        self.ask_for_missing_samples();
        let entries = self.document.library.entries().to_vec();
        for entry in entries {
            let Origin::File(file) = &entry.origin else {
                continue;
            };
            // What waits for a skeleton has said so when it was read.
            let waits = |entry: &Entry| entry.awaits_skeleton() && !entry.warnings.is_empty();
            let read_by_now = |entry: &Arc<Entry>| {
                entry.motion.is_some() || entry.unread.is_some() || waits(entry)
            };
            if self.document.library.get(&entry.id).is_none_or(read_by_now) {
                continue;
            }
            if self.read_anew(file, None).is_err() {
                self.document.library.remove(&entry.id);
                lost.push(file.name.clone());
            }
        }
        if !lost.is_empty() {
            self.say(
                Level::Warning,
                msg!("Not found in this browser's storage any more: {lost}. Drop them again."),
            );
        }
    }
}

/// Whether nothing was said of a clip by hand.
fn is_as_it_came(entry: &Entry) -> bool {
    let own_name = match &entry.origin {
        Origin::File(_) => entry.motion.as_ref().map(|motion| motion.clip().name().to_owned()),
        Origin::Made => recipe_params(&entry.id).map(|params| recipe_name(&params)),
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
            Content::Outside(_) => self.size.max(LARGE_BYTES + 1),
        };
        SourceFile {
            name: self.name.clone(),
            sha256: self.sha256.clone(),
            content,
            size,
            kind: self.kind,
            companion: self.companion.clone(),
            index: self.index,
            options: self.options,
        }
    }
}
