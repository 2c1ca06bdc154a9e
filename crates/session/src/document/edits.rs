//! Edits of the library's clips by hand.

use super::Document;
use super::places::forget_places;
use crate::LabId;
use crate::Selected;
use crate::command::CommandError;
use crate::contact_edits::forget_edits;
use crate::labs::{Slot, lab_of};
use crate::library::Entry;
use crate::outside;
use crate::params::{Key, Value};
use std::sync::Arc;

impl Document {
    /// Returns a clip of the library.
    ///
    /// # Errors
    /// [`CommandError::NoClip`] if there is none of that name.
    pub(crate) fn clip(&self, reference: &str) -> Result<&Arc<Entry>, CommandError> {
        self.library.find(reference).ok_or_else(|| CommandError::NoClip(reference.to_owned()))
    }

    /// Gives a clip another name.
    pub(crate) fn rename(&mut self, id: &str, name: &str) -> Result<(), CommandError> {
        if name.trim().is_empty() {
            return Err(CommandError::NotPossible("a clip needs a name"));
        }
        let name = outside::clip_name(name);
        self.change_entry(id, |entry| entry.name = name)
    }

    /// Changes a clip of the library, as a step for undo.
    pub(crate) fn change_entry(
        &mut self,
        id: &str,
        change: impl FnOnce(&mut Entry),
    ) -> Result<(), CommandError> {
        self.clip(id)?;
        self.remember(None);
        self.library.change(id, change);
        self.library_revision += 1;
        Ok(())
    }

    /// Removes a clip from the library and from everything that names it, as a step for undo.
    /// Returns its name.
    pub(crate) fn remove(&mut self, id: &str) -> Result<String, CommandError> {
        let entry = Arc::clone(self.clip(id)?);
        self.remember(None);
        self.take_out(&entry);
        Ok(entry.name.clone())
    }

    /// Removes a clip as [`Document::remove`] does, but not as a step of its own.
    ///
    /// # Errors
    /// [`CommandError::NoClip`] if there is no such clip.
    pub(crate) fn discard(&mut self, id: &str) -> Result<(), CommandError> {
        let entry = Arc::clone(self.clip(id)?);
        self.take_out(&entry);
        Ok(())
    }

    /// Removes several clips as [`Document::remove`] does, in one step. Returns their number.
    ///
    /// # Errors
    /// [`CommandError::NoClip`] if one of them is not there; all stay then.
    pub(crate) fn remove_all(&mut self, ids: &[String]) -> Result<usize, CommandError> {
        let mut entries: Vec<Arc<Entry>> = Vec::new();
        for id in ids {
            let entry = self.clip(id)?;
            if entries.iter().all(|known| known.id != entry.id) {
                entries.push(Arc::clone(entry));
            }
        }
        if entries.is_empty() {
            return Ok(0);
        }
        self.remember(None);
        for entry in &entries {
            self.take_out(entry);
        }
        Ok(entries.len())
    }

    fn take_out(&mut self, entry: &Entry) {
        self.library.remove(&entry.id);
        for lab in LabId::ALL {
            for (key, value) in lab_of(*lab).without_clip(&self.params, &entry.id) {
                self.set_unchecked(key, value);
            }
        }
        forget_edits(&mut self.params, &entry.id);
        self.library_revision += 1;
        if self.params.text(Key::Character) == entry.id {
            self.set_unchecked(Key::Character, Value::Text(String::new()));
        }
        // A slot that held the clip takes the first one that the other slot does not hold.
        for slot in [Slot::A, Slot::B] {
            let key = slot.key();
            if self.params.text(key) != entry.id {
                continue;
            }
            let other = self.params.text(if slot == Slot::A { Key::B } else { Key::A }).to_owned();
            let entries = self.library.entries();
            let next =
                entries.iter().find(|e| e.id != other && e.is_known()).or_else(|| entries.first());
            let next = next.map(|e| e.id.clone()).unwrap_or_default();
            self.set_unchecked(key, Value::Text(next));
            forget_places(&mut self.params, slot, &[]);
        }
    }

    /// Puts a clip into the library, as a step for undo.
    pub(crate) fn add(&mut self, entry: Entry) {
        self.remember(None);
        self.library.put(entry);
        self.library_revision += 1;
    }

    /// Puts a clip into the library, unless it is there, and into a slot, as one step for undo.
    pub(crate) fn add_to_slot(&mut self, entry: Entry, slot: Option<Slot>) {
        self.remember(None);
        let id = entry.id.clone();
        if self.library.get(&id).is_none() {
            self.library.put(entry);
            self.library_revision += 1;
        }
        if let Some(slot) = slot {
            self.put_into(slot, &id);
        }
    }
}
