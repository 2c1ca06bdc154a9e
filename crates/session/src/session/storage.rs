//! The work into storage, and back from it: before anything is shown, or later.

use super::Session;
use crate::files::{is_as_it_came, stored_entries};
use crate::library::Origin;
use crate::link;
use crate::missing::look_for_clips;
use crate::params::Key;
use crate::reading::Content;
use crate::saved::{Saved, SavedEntry};
use std::sync::Arc;

impl Session {
    /// Returns the work as it is stored.
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
        let (entries, lost) = stored_entries(&self.document.library, &saved.entries, content_of);
        if !entries.is_empty() {
            self.document.library = entries.into_iter().collect();
        }
        // A language that was chosen by hand stays, whatever link the page is opened with, unless
        // the link names another.
        self.keep_language(saved);
        self.open_link(query.unwrap_or(&saved.query));
        self.document.forget_steps();
        // The results on the stage are not of this work.
        self.panes.list.clear();
        // The files of what is shown are asked for first.
        self.refresh();
        self.files.read_stored(&mut self.document, &mut self.notices, lost);
        look_for_clips(&mut self.document, &mut self.notices);
        self.refresh();
    }

    /// Brings stored work back into a session that has begun without it. The parameters stay as
    /// they are, and so does what came into the library or was said of a clip by hand meanwhile;
    /// every stored clip joins that. Taking back what was done before does not take them away.
    pub fn restore_late(&mut self, saved: &Saved, content_of: impl FnMut(&str) -> Option<Content>) {
        let (entries, lost) = stored_entries(&self.document.library, &saved.entries, content_of);
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
            // A preset that is not stored was removed on an earlier visit. It comes back where the
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

    /// Keeps the language that was chosen by hand.
    fn keep_language(&mut self, saved: &Saved) {
        if let Some((key, chosen)) =
            link::read(&saved.query).values.into_iter().find(|(key, _)| *key == Key::Lang)
        {
            self.document.set_unchecked(key, chosen);
        }
    }
}
