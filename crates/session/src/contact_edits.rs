//! Contacts that are corrected by hand: the clips that they belong to.
//!
//! Corrections are parameters, so that links and recipes contain them and undo takes them back.
//! They belong to their clips all the same: a link leaves those of files alone that it does not
//! correct itself, and is written with those of the clips that it uses.

use crate::labs::{lab_of, slots_of};
use crate::library::{Library, Origin, split_reference};
use crate::params::{ClipContacts, Key, List, Params, Value};
use segue_motion::clip::{ContactCorrections, Motion};
use std::sync::Arc;

/// A clip whose contacts can be corrected on the timeline.
#[derive(Clone, Debug)]
pub struct ContactClip {
    /// Its id.
    pub id: String,
    /// The clip, with its feet read as the parameters say, and with its corrections.
    pub motion: Arc<Motion>,
}

impl Params {
    /// Returns the corrected contacts after those of one clip, by its id, were replaced. Without
    /// corrections the clip is not named.
    #[must_use]
    pub fn contact_edits_with(&self, id: &str, corrections: ContactCorrections) -> Value {
        let mut clips = self.contact_edits().to_vec();
        clips.retain(|edit| !is_same_clip(&edit.clip, id));
        if !corrections.is_empty() {
            clips.push(ClipContacts { clip: id.to_owned(), corrections });
        }
        List::ContactEdits(clips).into()
    }
}

/// Returns the corrections of a clip of the library, by its id.
pub(crate) fn corrections_of<'a>(
    library: &Library,
    params: &'a Params,
    id: &str,
) -> Option<&'a ContactCorrections> {
    let is_its = |edit: &&ClipContacts| {
        edit.clip == id || library.find(&edit.clip).is_some_and(|entry| entry.id == id)
    };
    params.contact_edits().iter().find(is_its).map(|edit| &edit.corrections)
}

/// Returns the parameters with the corrections of those clips alone that the result is made from.
pub(crate) fn with_own_edits(params: &Params) -> Params {
    let slots = slots_of(params.lab()).map(|slot| params.text(slot.key()).to_owned());
    let more = lab_of(params.lab()).more_clips(params).unwrap_or_default();
    with_edits_of(params, &slots.chain(more).collect::<Vec<_>>())
}

/// Returns the parameters with the corrections of those clips alone that they name.
pub(crate) fn with_named_edits(params: &Params) -> Params {
    with_edits_of(params, &named_clips(params))
}

/// Returns the clips that parameters name, by their ids.
pub(crate) fn named_clips(params: &Params) -> Vec<String> {
    let compared = params.compare().map_or(&[][..], |compare| &compare.values);
    let compared = compared.iter().filter_map(|value| match value {
        Value::Text(id) => Some(id.clone()),
        _ => None,
    });
    let slots = [Key::A, Key::B].map(|key| params.text(key).to_owned());
    let listed = lab_of(params.lab()).listed(params);
    let others = params.clip_ids(Key::Others).iter().cloned();
    slots.into_iter().chain(listed).chain(others).chain(compared).collect()
}

fn with_edits_of(params: &Params, clips: &[String]) -> Params {
    let mut params = params.clone();
    let own = params.contact_edits().iter();
    let own = own.filter(|edit| clips.iter().any(|clip| is_same_clip(clip, &edit.clip)));
    let own = List::ContactEdits(own.cloned().collect());
    set(&mut params, own);
    params
}

/// Adds to new parameters the corrections of files among the present ones, except those of clips
/// that the new ones correct themselves.
pub(crate) fn keep_edits_of_files(library: &Library, present: &Params, new: &mut Params) {
    if present.contact_edits().is_empty() {
        return;
    }
    let mut clips = new.contact_edits().to_vec();
    for edit in present.contact_edits() {
        let file = library.find(&edit.clip).filter(|e| matches!(e.origin, Origin::File(_)));
        let is_free = |id: &str| corrections_of(library, new, id).is_none();
        if file.is_some_and(|entry| is_free(&entry.id)) {
            clips.push(edit.clone());
        }
    }
    set(new, List::ContactEdits(clips));
}

/// Removes the corrections of a clip, by its id.
pub(crate) fn forget_edits(params: &mut Params, id: &str) {
    let Value::List(others) = params.contact_edits_with(id, ContactCorrections::default()) else {
        return;
    };
    set(params, others);
}

/// Sets the corrections; more of them than a list can hold change nothing.
fn set(params: &mut Params, edits: List) {
    let _is_changed = params.set(Key::ContactEdits, edits.into());
}

/// Returns whether two references name the same clip: the same id, or the same file under another
/// name.
fn is_same_clip(one: &str, other: &str) -> bool {
    let ((_, a, index_a), (_, b, index_b)) = (split_reference(one), split_reference(other));
    let is_same_file = !a.is_empty() && !b.is_empty() && (a.starts_with(b) || b.starts_with(a));
    one == other || (is_same_file && index_a == index_b)
}

#[cfg(test)]
mod tests;
