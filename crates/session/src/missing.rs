//! Clips that the parameters name and the library does not have: a notice says which file to drop.

use crate::document::Document;
use crate::labs::Slot;
use crate::library::split_reference;
use crate::notice::Notices;
use crate::outside;
use segue_text::msg;

/// Adds every clip that the parameters name to the library, and asks the user for those that are
/// not available.
pub(crate) fn look_for_clips(document: &mut Document, notices: &mut Notices) {
    for slot in [Slot::A, Slot::B] {
        let reference = document.params.text(slot.key()).to_owned();
        look_for(document, notices, slot.label(), &reference);
    }
    for reference in document.compared_clips() {
        look_for(document, notices, "A clip to compare", &reference);
    }
    for (reference, _) in document.params.weighted_clips().to_vec() {
        look_for(document, notices, "A clip of the blend", &reference);
    }
    document.restore_listed();
}

fn look_for(document: &mut Document, notices: &mut Notices, what: &'static str, reference: &str) {
    if reference.is_empty()
        || document.restore_built_in(reference)
        || document.ensure_clip(reference)
    {
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
    notices.say_missing(reference, text);
}

/// Removes the notices about clips that have arrived since, or are no longer named.
pub(crate) fn dismiss_found(document: &Document, notices: &mut Notices) {
    let slots = [Slot::A, Slot::B].map(|slot| document.params.text(slot.key()).to_owned());
    let others = document.params.weighted_clips().iter().map(|(reference, _)| reference.clone());
    let named: Vec<String> =
        slots.into_iter().chain(document.compared_clips()).chain(others).collect();
    notices.keep_missing(|reference| match document.library.find(reference) {
        Some(entry) => document.is_unpaired(&entry.id),
        None => named.iter().any(|name| name == reference),
    });
}
