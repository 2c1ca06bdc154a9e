//! Parameters that are places in a clip, and have no meaning in another one.

use crate::labs::Slot;
use crate::params::{Key, Mark, PARAMS, Params};

/// Resets the parameters that are places in a slot's clip, except those `given` for the new clip.
/// Returns the parameters that changed.
pub(super) fn forget_places(params: &mut Params, slot: Slot, given: &[Key]) -> Vec<Key> {
    let mark = match slot {
        Slot::A => Mark::PlaceInA,
        Slot::B => Mark::PlaceInB,
    };
    reset_marked(params, mark, given)
}

/// Resets the parameters with a mark, except those `given`. Returns those that changed.
pub(super) fn reset_marked(params: &mut Params, mark: Mark, given: &[Key]) -> Vec<Key> {
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
