//! What A and B hold, and other places that name clips: chosen by hand or by a link, brought by a
//! file, or built in and back from where it was taken out.

use super::{Session, built_in_entries};
use crate::command::CommandError;
use crate::labs::{Slot, lab, recipe_name, recipe_params};
use crate::library::{Entry, Origin, split_reference};
use crate::outside;
use crate::params::{Key, Kind, Mark, PARAMS, Params, Value};
use segue_text::msg;

/// How a file has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Came {
    /// Somebody has dropped or opened it, or handed it over by the API.
    ByHand,
    /// It was fetched from an address in the link.
    ByLink,
}

impl Session {
    /// Puts a clip of the library into a slot, or a built-in one that was taken out of it.
    pub(super) fn assign(&mut self, slot: Slot, id: String) -> Result<(), CommandError> {
        // Asked first: a file that is called like the built-in clip is not meant.
        let id = if self.removed_built_in(&id).is_some() {
            id
        } else {
            self.library.find(&id).ok_or(CommandError::NoClip(id))?.id.clone()
        };
        self.set(vec![(slot.key(), Value::Text(id))])?;
        self.history.settle();
        Ok(())
    }

    /// Offers a clip that just came the slot where a user expects it: what is looked at in View;
    /// else A, then B, as long as they hold clips that nobody brought.
    pub(super) fn offer(&mut self, id: &str, came: Came) {
        if [Slot::A, Slot::B]
            .iter()
            .any(|slot| self.slot(*slot).is_some_and(|entry| entry.id == id))
        {
            return;
        }
        let is_looked_at = came == Came::ByHand
            && lab::of(self.params.lab()).shows_clip()
            && self.slot(Slot::A).is_some();
        let free = [Slot::A, Slot::B]
            .into_iter()
            .find(|slot| (is_looked_at && *slot == Slot::A) || self.is_free(*slot, came));
        if let Some(slot) = free {
            self.put_into(slot, id);
        }
    }

    /// Offers clips that came together the slots in turn: in View that of the one that is looked
    /// at; else those with clips that nobody brought.
    pub(super) fn offer_together<'a>(&mut self, ids: impl IntoIterator<Item = &'a str>) {
        let slots = if lab::of(self.params.lab()).shows_clip() {
            vec![Slot::A]
        } else {
            let free = [Slot::A, Slot::B].into_iter();
            free.filter(|slot| self.is_free(*slot, Came::ByHand)).collect()
        };
        for (slot, id) in slots.into_iter().zip(ids) {
            self.put_into(slot, id);
        }
    }

    fn put_into(&mut self, slot: Slot, id: &str) {
        self.set_unchecked(slot.key(), Value::Text(id.to_owned()));
        forget_places(&mut self.params, slot, &[]);
        // Likewise of the whole that was played before.
        for key in [Key::In, Key::Out] {
            self.set_unchecked(key, Value::Auto);
        }
    }

    /// Whether a clip that comes may take a slot. One that waits for a clip keeps waiting: the link
    /// is completed by that clip and no other.
    fn is_free(&self, slot: Slot, came: Came) -> bool {
        match self.slot(slot) {
            Some(entry) => {
                is_built_in(entry) && !(came == Came::ByLink && self.named[slot as usize])
            }
            None => self.params.text(slot.key()).is_empty(),
        }
    }

    /// Remembers which slots were named: what the link's own addresses bring leaves them alone. New
    /// addresses begin anew.
    pub(super) fn note_named(&mut self, named: &[Key], has_new_sources: bool) {
        for slot in [Slot::A, Slot::B] {
            let before = self.named[slot as usize] && !has_new_sources;
            self.named[slot as usize] = before || named.contains(&slot.key());
        }
    }

    /// Looks for every clip that the parameters name.
    pub(super) fn look_for_clips(&mut self) {
        for slot in [Slot::A, Slot::B] {
            let reference = self.params.text(slot.key()).to_owned();
            self.look_for(slot.label(), &reference);
        }
        for reference in self.compared_clips() {
            self.look_for("A clip to compare", &reference);
        }
        for (reference, _) in self.also_blended() {
            self.look_for("A clip of the blend", &reference);
        }
        self.bring_back_listed();
    }

    /// The clips that stand side by side.
    pub(super) fn compared_clips(&self) -> Vec<String> {
        let compare =
            self.compare().filter(|compare| matches!(compare.key.param().kind, Kind::Clip));
        let values = compare.map(|compare| compare.values).unwrap_or_default();
        let clips = values.into_iter().filter_map(|value| match value {
            Value::Text(id) => Some(id),
            _ => None,
        });
        clips.collect()
    }

    /// Tells who opened a link to a clip that is neither here nor can be brought which file to
    /// drop.
    fn look_for(&mut self, what: &'static str, reference: &str) {
        if reference.is_empty() || self.bring_back(reference) || self.bring(reference) {
            return;
        }
        let (name, sha, _) = split_reference(reference);
        let [name, sha] = [name, sha].map(outside::short);
        let text = if sha.is_empty() {
            msg!("{what} is `{name}`, which is not here: drop that file, or choose another clip.")
        } else {
            msg!(
                "{what} is `{name}` (SHA-256 {sha}…), which is not here: drop that file to complete the link."
            )
        };
        self.notices.miss(reference, text);
    }

    /// Forgets what was said of clips that have come since, or that nothing names any more.
    pub(super) fn forget_found(&mut self) {
        let slots = [Slot::A, Slot::B].map(|slot| self.params.text(slot.key()).to_owned());
        let others = self.also_blended().into_iter().map(|(reference, _)| reference);
        let named: Vec<String> =
            slots.into_iter().chain(self.compared_clips()).chain(others).collect();
        let is_missing = |reference: &str| match self.library.find(reference) {
            Some(entry) => self.is_half(&entry.id),
            None => named.iter().any(|name| name == reference),
        };
        let missing: Vec<String> = self
            .notices
            .awaited()
            .filter(|reference| is_missing(reference))
            .map(str::to_owned)
            .collect();
        self.notices.keep_missing(|reference| missing.iter().any(|known| known == reference));
    }

    /// Whether the clip is in the library, or can be made or fetched by its id.
    pub(super) fn bring(&mut self, reference: &str) -> bool {
        if self.library.find(reference).is_some() || self.bring_sample(reference) {
            return true;
        }
        let Some(params) = recipe_params(reference) else {
            return false;
        };
        self.library.put(Entry::new(reference, recipe_name(&params), Origin::Made));
        self.library_revision += 1;
        true
    }

    /// The built-in clip of that id, where it is not in the library.
    fn removed_built_in(&self, id: &str) -> Option<Entry> {
        let is_gone = self.library.get(id).is_none();
        is_gone.then(|| built_in_entries().find(|entry| entry.id == id)).flatten()
    }

    /// Puts a built-in clip back that was taken out of the library, now that it is asked for. Says
    /// whether it did.
    pub(super) fn bring_back(&mut self, id: &str) -> bool {
        let Some(entry) = self.removed_built_in(id) else {
            return false;
        };
        self.library.put(entry);
        self.library_revision += 1;
        true
    }

    /// Puts back what the open lab's own list of clips names.
    pub(super) fn bring_back_listed(&mut self) {
        for id in lab::of(self.params.lab()).listed(&self.params) {
            self.bring_back(&id);
        }
    }
}

/// Whether nobody brought or made it.
pub(super) fn is_built_in(entry: &Entry) -> bool {
    matches!(entry.origin, Origin::Preset | Origin::Sample(_))
}

/// Sets back what says where in a slot's clip something happens, but for what was `given` for the
/// clip that is there now: it means nothing in another clip. Returns what has changed.
pub(super) fn forget_places(params: &mut Params, slot: Slot, given: &[Key]) -> Vec<Key> {
    let mark = match slot {
        Slot::A => Mark::PlaceInA,
        Slot::B => Mark::PlaceInB,
    };
    let places = PARAMS.iter().filter(|param| param.has(mark)).map(|param| param.key);
    let mut changed = Vec::new();
    for key in places.filter(|key| !given.contains(key)) {
        let result = params.set(key, key.param().default_value());
        debug_assert!(result.is_ok(), "defaults fit: {result:?}");
        if result == Ok(true) {
            changed.push(key);
        }
    }
    changed
}
