//! Storing of the work, and its restoring: before anything is shown, or later.

use super::Session;
use crate::bone_map::{BoneMaps, MAX_RIGS};
use crate::contact_edits::keep_edits_of_files;
use crate::document::Document;
use crate::files::{is_as_it_came, stored_entries};
use crate::library::Origin;
use crate::link;
use crate::missing::look_for_clips;
use crate::params::{Key, Params};
use crate::reading::Content;
use crate::saved::{Saved, SavedEntry};
use std::collections::BTreeSet;
use std::sync::Arc;

impl Session {
    /// Returns the work to be stored.
    #[must_use]
    pub fn saved(&self) -> Saved {
        Saved {
            query: self.stored_query(),
            entries: self
                .document
                .library
                .entries()
                .iter()
                .map(|entry| SavedEntry::from(&**entry))
                .collect(),
            bone_maps: self.document.library.bone_maps().values().cloned().collect(),
        }
    }

    /// Returns the SHA-256 of the files that undo and redo may restore: they have to stay in
    /// storage until the session ends.
    #[must_use]
    pub fn files_of_steps(&self) -> BTreeSet<String> {
        self.document.files_of_steps()
    }

    /// Restores stored work; `content_of` returns a file's bytes by its SHA-256. A notice names the
    /// missing files, and those that can no longer be read if files are read at once; otherwise
    /// they are requested with [`super::Request::Read`], first those on the stage. The parameters
    /// come from `query` if there is one (a link was opened), otherwise from storage.
    pub fn restore(
        &mut self,
        saved: &Saved,
        content_of: impl FnMut(&str) -> Option<Content>,
        query: Option<&str>,
    ) {
        let (entries, lost) = stored_entries(&self.document.library, &saved.entries, content_of);
        if !entries.is_empty() {
            self.document.library = entries.into_iter().collect();
        }
        self.document.library.set_bone_maps(stored_maps(saved));
        // A language that was chosen by hand stays when the page is opened with a link, unless the
        // link names another.
        self.keep_language(saved);
        self.keep_contact_edits(saved);
        self.open_link(query.unwrap_or(&saved.query));
        self.document.forget_steps();
        // The results on the stage do not belong to this work.
        self.panes.list.clear();
        // The files of the clips on the stage are requested first.
        self.refresh();
        self.files.read_stored(&mut self.document, &mut self.notices, lost);
        look_for_clips(&mut self.document, &mut self.notices);
        self.refresh();
    }

    /// Restores stored work in a session that has begun without it. The parameters stay as they
    /// are, and so do clips that were added or changed by hand meanwhile; every stored clip joins
    /// them. Undo of earlier steps does not remove them.
    pub fn restore_late(&mut self, saved: &Saved, content_of: impl FnMut(&str) -> Option<Content>) {
        let (entries, lost) = stored_entries(&self.document.library, &saved.entries, content_of);
        let before = std::mem::take(&mut self.document.library);
        let mut maps = stored_maps(saved);
        for map in before.bone_maps().values() {
            let known = maps.entry(map.rig.clone()).or_default();
            if map.roles.is_empty() {
                known.roles.clear();
            }
            // A link may have corrected some parts of a rig alone.
            known.rig.clone_from(&map.rig);
            known.roles.extend(map.roles.clone());
        }
        self.document.library.set_bone_maps(maps);
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
            // A preset that is not stored was removed on an earlier visit. It returns if the
            // parameters name it.
            let stays = nothing_came || !matches!(entry.origin, Origin::Preset);
            if stays && self.document.library.get(&entry.id).is_none() {
                self.document.library.put_shared(Arc::clone(entry));
            }
        }
        look_for_clips(&mut self.document, &mut self.notices);
        self.files.read_stored(&mut self.document, &mut self.notices, lost);
        let came: Vec<_> =
            came.iter().filter_map(|id| self.document.library.get(id).cloned()).collect();
        self.document.add_to_steps(&came);
        if self.document.params.get(Key::Lang) == &Key::Lang.param().default_value() {
            self.keep_language(saved);
        }
        self.keep_contact_edits(saved);
        self.document.library_revision += 1;
        self.refresh();
    }

    /// Adds clips that another window has stored. Those that are here already stay as they are, and
    /// undo of earlier steps does not remove the others.
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
        let (entries, lost) = stored_entries(&self.document.library, &new, content_of);
        for entry in entries {
            self.document.library.put(entry);
        }
        look_for_clips(&mut self.document, &mut self.notices);
        self.files.read_stored(&mut self.document, &mut self.notices, lost);
        let came: Vec<_> =
            new.iter().filter_map(|entry| self.document.library.get(&entry.id).cloned()).collect();
        self.document.add_to_steps(&came);
        self.document.library_revision += 1;
        self.refresh();
    }

    /// Keeps the corrected contacts of stored files.
    fn keep_contact_edits(&mut self, saved: &Saved) {
        let mut stored = Params::default();
        let values = link::read(&saved.query).values.into_iter();
        for (key, edits) in values.filter(|(key, _)| *key == Key::ContactEdits) {
            let result = stored.set(key, edits);
            debug_assert!(result.is_ok(), "links hold checked values: {result:?}");
        }
        let Document { library, params, .. } = &mut self.document;
        keep_edits_of_files(library, &stored, params);
    }

    /// Keeps the language that was chosen by hand.
    fn keep_language(&mut self, saved: &Saved) {
        if let Some((key, chosen)) =
            link::read(&saved.query).values.into_iter().find(|(key, _)| *key == Key::Lang)
        {
            self.document.set_unchecked(key, chosen);
        }
    }
}

/// Returns the stored body parts by rig.
fn stored_maps(saved: &Saved) -> BoneMaps {
    let maps = saved.bone_maps.iter().take(MAX_RIGS);
    maps.map(|map| (map.rig.clone(), map.clone())).collect()
}
