//! The clips in A and B: chosen by hand or by a link, or brought by a file.

use super::Document;
use super::places::{forget_places, reset_marked};
use crate::command::CommandError;
use crate::labs::{Slot, lab_of};
use crate::library::{Arrival, Entry, Origin};
use crate::params::{Key, Mark, Value};

impl Document {
    /// Returns the id of a clip that may be put into a slot: one of the library, or a built-in one
    /// that was removed from it.
    pub(crate) fn assignable(&self, id: String) -> Result<String, CommandError> {
        // The built-in clip comes first: a file of the same name is not meant.
        if self.removed_built_in(&id).is_some() { Ok(id) } else { Ok(self.clip(&id)?.id.clone()) }
    }

    /// Offers a slot to a clip that just arrived: in View that of the clip on the stage, if it is
    /// the first of those that came together; otherwise A, then B, if they hold built-in clips.
    pub(crate) fn offer(&mut self, id: &str, arrival: Arrival) {
        if [Slot::A, Slot::B]
            .iter()
            .any(|slot| self.slot(*slot).is_some_and(|entry| entry.id == id))
        {
            return;
        }
        let is_viewed = arrival.is_by_hand()
            && lab_of(self.params.lab()).shows_clip()
            && self.slot(Slot::A).is_some()
            && self.is_first_of_group(id);
        let free = [Slot::A, Slot::B]
            .into_iter()
            .find(|slot| (is_viewed && *slot == Slot::A) || self.is_free(*slot, arrival));
        if let Some(slot) = free {
            self.put_into(slot, id);
        }
    }

    /// Returns whether no other motion of its group is in the library.
    fn is_first_of_group(&self, id: &str) -> bool {
        let Some(group) = self.library.get(id).and_then(|entry| entry.group()) else {
            return true;
        };
        let mut entries = self.library.entries().iter();
        !entries
            .any(|other| other.id != id && other.moves() && other.group().as_ref() == Some(&group))
    }

    /// Offers slots to clips that arrived together, in turn: in View that of the clip on the stage;
    /// otherwise those with built-in clips.
    pub(crate) fn offer_together<'a>(&mut self, ids: impl IntoIterator<Item = &'a str>) {
        let slots = if lab_of(self.params.lab()).shows_clip() {
            vec![Slot::A]
        } else {
            let free = [Slot::A, Slot::B].into_iter();
            free.filter(|slot| self.is_free(*slot, Arrival::ByHand(None))).collect()
        };
        for (slot, id) in slots.into_iter().zip(ids) {
            self.put_into(slot, id);
        }
    }

    /// Puts a clip into a slot, and forgets the places in the clip before it.
    pub(super) fn put_into(&mut self, slot: Slot, id: &str) {
        self.set_unchecked(slot.key(), Value::Text(id.to_owned()));
        forget_places(&mut self.params, slot, &[]);
        reset_marked(&mut self.params, Mark::PlaceInResult, &[]);
    }

    /// Returns whether an arriving clip may take a slot. A slot that waits for a clip keeps
    /// waiting: only that clip completes the link.
    fn is_free(&self, slot: Slot, arrival: Arrival) -> bool {
        match self.slot(slot) {
            Some(entry) => {
                is_built_in(entry)
                    && !(arrival == Arrival::ByLink && self.named_slots[slot as usize])
            }
            None => self.params.text(slot.key()).is_empty(),
        }
    }

    /// Records which slots were named, so that clips from the link's own addresses leave them
    /// alone. New addresses reset this.
    pub(super) fn note_named_slots(&mut self, named: &[Key], has_new_sources: bool) {
        for slot in [Slot::A, Slot::B] {
            let before = self.named_slots[slot as usize] && !has_new_sources;
            self.named_slots[slot as usize] = before || named.contains(&slot.key());
        }
    }
}

/// Returns whether a clip comes with Segue.
fn is_built_in(entry: &Entry) -> bool {
    matches!(entry.origin, Origin::Preset | Origin::Sample(_))
}
