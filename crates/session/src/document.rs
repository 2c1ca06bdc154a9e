//! The document: parameters and library. Undo and storage see nothing else.

mod clips;
mod edits;
mod history;
mod places;
mod slots;

use crate::bone_map::BoneMap;
use crate::built_in::preset_entries;
use crate::labs::Slot;
use crate::library::{Entry, Library};
use crate::params::{Group, Key, Kind, ListKind, Mark, Params, Value, ValueError};
use history::History;
use places::forget_places;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// The state that a link and undo restore, and the steps between its versions.
#[derive(Debug)]
pub(crate) struct Document {
    pub(crate) params: Params,
    pub(crate) library: Library,
    history: History,
    /// A number that grows with every change of library content.
    pub(crate) library_revision: u64,
    /// Whether A and B were named together with the addresses of the link, or since.
    named_slots: [bool; 2],
    /// The parameters that the opened link names.
    keys_of_link: Vec<Key>,
    /// The corrected body parts that the opened link has.
    pub(crate) maps_of_link: Vec<BoneMap>,
}

/// The changes that a command made to the parameters.
#[derive(Debug)]
pub(crate) struct Changes {
    /// The parameters that have another value than before.
    pub(crate) keys: Vec<Key>,
    /// The addresses of files that were not named before.
    pub(crate) new_sources: Vec<String>,
}

impl Default for Document {
    fn default() -> Self {
        Self {
            params: Params::default(),
            library: preset_entries().collect(),
            history: History::default(),
            library_revision: 0,
            named_slots: [false; 2],
            keys_of_link: Vec::new(),
            maps_of_link: Vec::new(),
        }
    }
}

impl Document {
    /// Returns the clip in a slot.
    pub(crate) fn slot(&self, slot: Slot) -> Option<&Arc<Entry>> {
        self.library.find(self.params.text(slot.key()))
    }

    /// Returns whether the opened link names this parameter, even with its default.
    pub(crate) fn link_names(&self, key: Key) -> bool {
        self.keys_of_link.contains(&key)
    }

    /// Records the state before a change, as a step for undo. With `key`, changes of one parameter
    /// in one gesture are one step.
    pub(crate) fn remember(&mut self, key: Option<Key>) {
        self.history.before_change(&self.params, &self.library, key);
    }

    /// Records the state before a file arrives, as a step for undo. The files of one selection, by
    /// its number, are one step.
    pub(crate) fn remember_arrival(&mut self, batch: Option<u32>) {
        self.history.before_arrival(&self.params, &self.library, batch);
    }

    /// Returns the SHA-256 of the files that steps may restore.
    pub(crate) fn files_of_steps(&self) -> BTreeSet<String> {
        self.history.files()
    }

    /// Records an earlier library as the state before a change.
    pub(crate) fn remember_library(&mut self, library: &Library) {
        self.history.before_change(&self.params, library, None);
    }

    /// Discards all steps of undo and redo.
    pub(crate) fn forget_steps(&mut self) {
        self.history = History::default();
    }

    /// Adds clips to every step that lacks them, so that undo does not remove them.
    pub(crate) fn add_to_steps(&mut self, entries: &[Arc<Entry>]) {
        self.history.add_to_all(entries);
    }

    /// Replaces entries in the library and in every step by newer ones, which `newer` has by the
    /// addresses of the old ones. That is no change of the work.
    pub(crate) fn replace_entries(&mut self, newer: &BTreeMap<*const Entry, Arc<Entry>>) {
        self.library.replace_shared(newer);
        self.history.replace_in_all(newer);
    }

    /// Drops the motions of files that only steps of undo contain. Returns whether there were any.
    pub(crate) fn drop_motions_of_steps(&mut self) -> bool {
        self.history.drop_motions_outside(&self.library)
    }

    /// Returns whether there is a step to take back.
    pub(crate) fn can_undo(&self) -> bool {
        self.history.can_undo()
    }

    /// Returns whether there is a step to make again.
    pub(crate) fn can_redo(&self) -> bool {
        self.history.can_redo()
    }

    /// Begins or ends several changes that are one step of undo.
    pub(crate) fn join_steps(&mut self, begins: bool) {
        self.history.join(begins);
    }

    /// Ends a gesture: the next change is a step of its own.
    pub(crate) fn settle(&mut self) {
        self.history.settle();
    }

    /// Takes back the last step. Returns whether there was one.
    pub(crate) fn undo(&mut self) -> bool {
        let is_undone = self.history.undo(&mut self.params, &mut self.library);
        self.library_revision += u64::from(is_undone);
        is_undone
    }

    /// Makes the step again that was taken back last. Returns whether there was one.
    pub(crate) fn redo(&mut self) -> bool {
        let is_redone = self.history.redo(&mut self.params, &mut self.library);
        self.library_revision += u64::from(is_redone);
        is_redone
    }

    /// Sets a value that is known to be valid.
    pub(crate) fn set_unchecked(&mut self, key: Key, value: Value) {
        let result = self.params.set(key, value);
        debug_assert!(result.is_ok(), "{result:?}");
    }

    /// Sets parameters of the camera, all or none, without a step for undo.
    ///
    /// # Errors
    /// [`ValueError`] names the invalid value.
    pub(crate) fn frame(&mut self, values: Vec<(Key, Value)>) -> Result<(), ValueError> {
        let mut params = self.params.clone();
        for (key, value) in values {
            debug_assert!(key.param().group == Group::Camera, "{key:?} is not of the camera");
            params.set(key, value)?;
        }
        self.params = params;
        Ok(())
    }

    /// Sets parameters, all or none, as a step for undo if any of them takes part in undo.
    ///
    /// # Errors
    /// [`ValueError`] names the invalid value.
    pub(crate) fn set(&mut self, values: Vec<(Key, Value)>) -> Result<Changes, ValueError> {
        let mut params = self.params.clone();
        let named: Vec<Key> = values.iter().map(|(key, _)| *key).collect();
        let mut changed = Vec::new();
        for (key, value) in values {
            if params.set(key, value)? {
                changed.push(key);
            }
        }
        let chosen = [Slot::A, Slot::B].map(|slot| changed.contains(&slot.key()).then_some(slot));
        for slot in chosen.into_iter().flatten() {
            let before = self.slot(slot).map(|entry| &entry.id);
            let now = self.library.find(params.text(slot.key())).map(|entry| &entry.id);
            // Another reference to the same clip changes nothing.
            if before.is_none() || before != now {
                changed.extend(forget_places(&mut params, slot, &named));
            }
        }
        let mut undoable = changed.iter().copied().filter(|key| !key.param().has(Mark::NoUndo));
        if let Some(first) = undoable.next() {
            // Dragging a slider changes one parameter again and again: one step.
            let alone = undoable.next().is_none();
            self.remember(alone.then_some(first));
        }
        let new_sources = self.replace_params(params, &named);
        for slot in chosen.into_iter().flatten() {
            let id = self.params.text(slot.key()).to_owned();
            self.restore_built_in(&id);
        }
        if changed
            .iter()
            .any(|key| *key == Key::Lab || key.param().kind == Kind::List(ListKind::ClipIds))
        {
            self.restore_listed();
        }
        Ok(Changes { keys: changed, new_sources })
    }

    /// Replaces the parameters by those of a link, some of which it names. Returns the addresses of
    /// files that were not named before.
    pub(crate) fn replace_params(&mut self, params: Params, named: &[Key]) -> Vec<String> {
        let before = std::mem::replace(&mut self.params, params);
        let known = before.source_addresses();
        let addresses = self.params.source_addresses().iter();
        let new_sources: Vec<String> =
            addresses.filter(|address| !known.contains(address)).cloned().collect();
        self.note_named_slots(named, !new_sources.is_empty());
        new_sources
    }

    /// Records the parameters that a link names, before it replaces all of them.
    pub(crate) fn note_link(&mut self, named: &[Key]) {
        self.named_slots = [false; 2];
        self.keys_of_link = named.to_vec();
    }
}

#[cfg(test)]
mod history_tests;
#[cfg(test)]
mod slot_tests;
