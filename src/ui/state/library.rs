//! The state of the library between frames.

use super::clip_order::ClipOrder;
use crate::ui::library_panel::arrange::{Arranged, RowHeights};
use std::collections::BTreeSet;
use std::sync::Arc;

/// The state of the library: what is searched, folded and selected.
#[derive(Clone, Debug, Default)]
pub(crate) struct LibraryState {
    /// The text that the names of the shown clips contain.
    pub(crate) search: String,
    /// The order of the clips.
    pub(crate) order: ClipOrder,
    /// The keys of the groups that are folded.
    pub(crate) folded: BTreeSet<String>,
    /// The ids of the selected clips.
    pub(crate) picked: BTreeSet<String>,
    /// The clip from which Shift selects a range.
    pub(crate) anchor: Option<String>,
    /// Whether the list is shown in this frame.
    pub(crate) is_shown: bool,
    /// Whether the list was shown in the last frame.
    pub(crate) was_shown: bool,
    /// The list as it was arranged last.
    pub(crate) arranged: Option<Arc<Arranged>>,
    /// The heights of its rows.
    pub(crate) heights: RowHeights,
    /// The id of the clip whose row has the focus.
    pub(crate) focused: Option<String>,
}

/// The keys that are held during a click.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct HeldKeys {
    /// Shift, which selects a range.
    pub(crate) shift: bool,
    /// Ctrl or Cmd, which selects one more.
    pub(crate) command: bool,
}

impl LibraryState {
    /// Takes a click on a clip as a selection: with a key held, or while clips are selected.
    /// `shown` are the clips of the list in order. Returns whether it was one.
    pub(crate) fn take_click(&mut self, id: &str, shown: &[&str], held: HeldKeys) -> bool {
        if held.shift {
            let from = self.anchor.as_deref().unwrap_or(id);
            let places = [from, id].map(|id| shown.iter().position(|known| *known == id));
            if let [Some(one), Some(other)] = places {
                let range = shown.get(one.min(other)..=one.max(other)).unwrap_or_default();
                self.picked.extend(range.iter().map(|id| (*id).to_owned()));
            } else {
                self.picked.insert(id.to_owned());
            }
            return true;
        }
        self.anchor = Some(id.to_owned());
        if !held.command && self.picked.is_empty() {
            return false;
        }
        self.toggle(id);
        true
    }

    /// Selects a clip, or no longer.
    pub(crate) fn toggle(&mut self, id: &str) {
        if !self.picked.remove(id) {
            self.picked.insert(id.to_owned());
        }
    }

    /// Begins a frame, in which the list may be shown or not.
    pub(crate) fn begin_frame(&mut self) {
        self.was_shown = std::mem::take(&mut self.is_shown);
    }

    /// Undoes what stands in front of the whole list: the search, then the selection. Returns
    /// whether there was any.
    pub(crate) fn close(&mut self) -> bool {
        if !self.was_shown {
            return false;
        }
        if !self.search.is_empty() {
            self.search.clear();
            return true;
        }
        let had_any = !self.picked.is_empty();
        self.picked.clear();
        had_any
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SHOWN: [&str; 5] = ["a", "b", "c", "d", "e"];
    const SHIFT: HeldKeys = HeldKeys { shift: true, command: false };
    const COMMAND: HeldKeys = HeldKeys { shift: false, command: true };

    fn picked(state: &LibraryState) -> String {
        state.picked.iter().map(String::as_str).collect()
    }

    #[test]
    fn clicks_select_only_with_a_key_or_among_selected_clips() {
        let mut state = LibraryState { was_shown: true, ..LibraryState::default() };
        assert!(!state.take_click("b", &SHOWN, HeldKeys::default()), "it is used");
        assert!(state.take_click("d", &SHOWN, SHIFT), "from the one that was clicked");
        assert_eq!(picked(&state), "bcd");
        assert!(state.take_click("c", &SHOWN, COMMAND));
        assert_eq!(picked(&state), "bd");
        assert!(state.take_click("e", &SHOWN, HeldKeys::default()));
        assert_eq!(picked(&state), "bde");
        assert!(state.take_click("a", &SHOWN, SHIFT), "backwards, from the last one");
        assert_eq!(picked(&state), "abcde");
        assert!(state.close() && !state.close());
        assert!(!state.take_click("b", &SHOWN, HeldKeys::default()));
    }

    #[test]
    fn range_from_a_clip_that_is_not_shown_is_one_clip() {
        let mut state = LibraryState { anchor: Some("gone".into()), ..LibraryState::default() };
        assert!(state.take_click("c", &SHOWN, SHIFT));
        assert_eq!(picked(&state), "c");
    }

    #[test]
    fn escape_ends_the_search_before_the_selection() {
        let mut state = LibraryState { search: "walk".into(), ..LibraryState::default() };
        state.toggle("a");
        assert!(!state.close(), "it is not in sight");
        state.is_shown = true;
        state.begin_frame();
        assert!(state.close() && state.search.is_empty() && picked(&state) == "a");
        assert!(state.close() && picked(&state).is_empty());
    }
}
