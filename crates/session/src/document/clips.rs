//! Clips that parameters name: found in the library, or added to it by their id.

use super::Document;
use crate::built_in::{built_in_entries, sample_entry};
use crate::labs::{lab_of, recipe_name, recipe_params};
use crate::library::{Entry, Origin};
use crate::params::{Kind, Value};
use crate::samples;

impl Document {
    /// Returns the clips that are compared with each other.
    pub(crate) fn compared_clips(&self) -> Vec<String> {
        let compare =
            self.params.compare().filter(|compare| matches!(compare.key.param().kind, Kind::Clip));
        let values = compare.map_or(&[][..], |compare| &compare.values);
        let clips = values.iter().filter_map(|value| match value {
            Value::Text(id) => Some(id.clone()),
            _ => None,
        });
        clips.collect()
    }

    /// Makes sure that a clip is in the library. Returns whether it is, or can be made or fetched
    /// by its id.
    pub(crate) fn ensure_clip(&mut self, reference: &str) -> bool {
        if self.library.find(reference).is_some() || self.ensure_sample(reference) {
            return true;
        }
        let Some(params) = recipe_params(reference) else {
            return false;
        };
        self.library.put(Entry::new(reference, recipe_name(&params), Origin::Made));
        self.library_revision += 1;
        true
    }

    /// Makes sure that a bundled take is in the library. Returns whether the id is that of one.
    pub(crate) fn ensure_sample(&mut self, id: &str) -> bool {
        let Some(sample) = samples::all().find(|sample| sample.id == id) else {
            return false;
        };
        if self.library.get(id).is_none() {
            self.library.put(sample_entry(sample));
            self.library_revision += 1;
        }
        true
    }

    /// Returns the built-in clip with that id, if it is not in the library.
    pub(super) fn removed_built_in(&self, id: &str) -> Option<Entry> {
        let is_gone = self.library.get(id).is_none();
        is_gone.then(|| built_in_entries().find(|entry| entry.id == id)).flatten()
    }

    /// Restores a built-in clip that was removed from the library. Returns whether it did.
    pub(crate) fn restore_built_in(&mut self, id: &str) -> bool {
        let Some(entry) = self.removed_built_in(id) else {
            return false;
        };
        self.library.put(entry);
        self.library_revision += 1;
        true
    }

    /// Restores the built-in clips in the open lab's own list.
    pub(crate) fn restore_listed(&mut self) {
        for id in lab_of(self.params.lab()).listed(&self.params) {
            self.restore_built_in(&id);
        }
    }

    /// Returns the id of a clip that a parameter may name: one of the library, or a bundled take,
    /// which joins the library when it is named.
    pub(crate) fn nameable(&self, reference: &str) -> Option<String> {
        let in_library = self.library.find(reference).map(|entry| entry.id.clone());
        in_library.or_else(|| {
            samples::all().find(|sample| sample.id == reference).map(|sample| sample.id.to_owned())
        })
    }

    /// Returns whether a clip of the library is a motion without its skeleton, or a skeleton
    /// without a motion.
    pub(crate) fn is_unpaired(&self, id: &str) -> bool {
        let is_skeleton =
            |entry: &Entry| matches!(&entry.origin, Origin::File(file) if file.kind.is_skeleton());
        self.library.get(id).is_some_and(|entry| entry.awaits_skeleton() || is_skeleton(entry))
    }
}
