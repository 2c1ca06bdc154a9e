//! The states that undo and redo restore.

use crate::library::{Entry, Library, Origin};
use crate::params::{Key, Mark, PARAMS, Params};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// A state of the document.
#[derive(Clone, Debug)]
struct State {
    params: Params,
    library: Library,
}

/// The steps that can be taken back, and those that were taken back.
#[derive(Clone, Debug, Default)]
pub(super) struct History {
    past: Vec<State>,
    future: Vec<State>,
    /// The parameter that the last step changed, while its slider is held: further changes of it
    /// join that step.
    open: Option<Key>,
    /// The selection of files whose arrival was the last step: further files of it join that step.
    batch: Option<u32>,
    /// Whether the first of several changes that are one step has been made; `None` while each
    /// change is a step.
    joined: Option<bool>,
}

/// A lesson's worth of steps. A state is small: clips are shared.
const MAX_STEPS: usize = 200;

impl History {
    /// Records the state before a change. With `key`, changes of one parameter in one gesture are
    /// one step.
    pub(super) fn before_change(&mut self, params: &Params, library: &Library, key: Option<Key>) {
        if key.is_some() && self.open == key {
            return;
        }
        self.open = key;
        self.batch = None;
        self.future.clear();
        if let Some(has_begun) = &mut self.joined
            && std::mem::replace(has_begun, true)
        {
            return;
        }
        if self.past.len() >= MAX_STEPS {
            self.past.remove(0);
        }
        self.past.push(State { params: params.clone(), library: library.clone() });
    }

    /// Records the state before a file arrives. The files of one selection that arrive one after
    /// the other are one step.
    pub(super) fn before_arrival(
        &mut self,
        params: &Params,
        library: &Library,
        batch: Option<u32>,
    ) {
        if batch.is_none() || self.batch != batch {
            self.before_change(params, library, None);
            self.batch = batch;
        }
    }

    /// Begins or ends several changes that are one step.
    pub(super) fn join(&mut self, begins: bool) {
        self.settle();
        self.joined = begins.then_some(false);
    }

    /// Ends a gesture: the next change is a step of its own.
    pub(super) fn settle(&mut self) {
        self.open = None;
    }

    /// Adds clips to every state that lacks them: they belong to all states, and only arrived late.
    pub(super) fn add_to_all(&mut self, entries: &[Arc<Entry>]) {
        for state in self.past.iter_mut().chain(&mut self.future) {
            for entry in entries
                .iter()
                .filter(|entry| state.library.get(&entry.id).is_none())
                .cloned()
                .collect::<Vec<_>>()
            {
                state.library.put_shared(entry);
            }
        }
    }

    /// Replaces entries in all states by newer ones, by the addresses of the old ones.
    pub(super) fn replace_in_all(&mut self, newer: &BTreeMap<*const Entry, Arc<Entry>>) {
        for state in self.past.iter_mut().chain(&mut self.future) {
            state.library.replace_shared(newer);
        }
    }

    /// Drops the motions of files that `library` does not contain; returns whether there were any.
    /// They are read again when a step restores them.
    pub(super) fn drop_motions_outside(&mut self, library: &Library) -> bool {
        let held: BTreeSet<_> = library
            .entries()
            .iter()
            .filter_map(|entry| entry.motion.as_ref().map(Arc::as_ptr))
            .collect();
        let mut any = false;
        for state in self.past.iter_mut().chain(&mut self.future) {
            let is_outside = |entry: &&Arc<Entry>| {
                let motion = entry.motion.as_ref().map(Arc::as_ptr);
                matches!(entry.origin, Origin::File(_))
                    && motion.is_some_and(|motion| !held.contains(&motion))
            };
            let ids: Vec<String> = state
                .library
                .entries()
                .iter()
                .filter(is_outside)
                .map(|entry| entry.id.clone())
                .collect();
            for id in &ids {
                any |= state.library.change(id, Entry::drop_motion);
            }
        }
        any
    }

    /// Returns the SHA-256 of the files in all states.
    pub(super) fn files(&self) -> BTreeSet<String> {
        let mut files = BTreeSet::new();
        let mut before: &[Arc<Entry>] = &[];
        for state in self.past.iter().chain(&self.future) {
            let entries = state.library.entries();
            for (index, entry) in entries.iter().enumerate() {
                // Most entries are those of the state before.
                let is_known = before.get(index).is_some_and(|known| Arc::ptr_eq(known, entry));
                if let (false, Some(sha256)) = (is_known, entry.sha256()) {
                    files.insert(sha256.to_owned());
                }
            }
            before = entries;
        }
        files
    }

    pub(super) fn can_undo(&self) -> bool {
        !self.past.is_empty()
    }

    pub(super) fn can_redo(&self) -> bool {
        !self.future.is_empty()
    }

    /// Swaps the present for the state before the last step; returns whether there was one.
    pub(super) fn undo(&mut self, params: &mut Params, library: &mut Library) -> bool {
        self.end_step();
        Self::swap(&mut self.past, &mut self.future, &mut self.open, params, library)
    }

    /// Swaps the present for the state that was taken back last; returns whether there was one.
    pub(super) fn redo(&mut self, params: &mut Params, library: &mut Library) -> bool {
        self.end_step();
        Self::swap(&mut self.future, &mut self.past, &mut self.open, params, library)
    }

    /// Has the next file or joined change begin a step.
    fn end_step(&mut self) {
        self.batch = None;
        self.joined = self.joined.map(|_| false);
    }

    fn swap(
        from: &mut Vec<State>,
        to: &mut Vec<State>,
        open: &mut Option<Key>,
        params: &mut Params,
        library: &mut Library,
    ) -> bool {
        let Some(state) = from.pop() else {
            return false;
        };
        to.push(State { params: params.clone(), library: library.clone() });
        *open = None;
        let left = std::mem::replace(library, state.library);
        library.take_motions_of(&left);
        for param in PARAMS.iter().filter(|param| !param.has(Mark::NoUndo)) {
            params.copy_from(&state.params, param.key);
        }
        true
    }
}
