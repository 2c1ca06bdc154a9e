//! The texts of the kit itself. All others are passed in by the panels.

use crate::ui::language::Word;

/// The state of a switch that is on.
pub(super) const ON: Word = Word::new("on");
/// The state of a switch that is off.
pub(super) const OFF: Word = Word::new("off");
/// The sign of a value that the app chooses.
pub(super) const AUTO: Word = Word::new("auto");
/// The sign of the best of several numbers.
pub(super) const BEST: Word = Word::new("best");
/// The sign of the worst of several numbers.
pub(super) const WORST: Word = Word::new("worst");
/// The button that starts playback.
pub(super) const PLAY: Word = Word::new("Play");
/// The button that pauses playback.
pub(super) const PAUSE: Word = Word::new("Pause");
/// The button that steps back by a frame.
pub(super) const STEP_BACK: Word = Word::new("One frame back");
/// The button that steps forward by a frame.
pub(super) const STEP_FORWARD: Word = Word::new("One frame forward");
/// The switch that loops playback.
pub(super) const REPEAT: Word = Word::new("Repeat");
/// The menu of playback speeds.
pub(super) const SPEED: Word = Word::new("Speed");
/// The word before the number of a frame.
pub(super) const FRAME: Word = Word::new("frame");
/// The accessible name of the timeline.
pub(super) const TIMELINE: Word = Word::new("Timeline");
/// The handle where the loop begins.
pub(super) const IN_POINT: Word = Word::new("Loop start");
/// The handle where the loop ends.
pub(super) const OUT_POINT: Word = Word::new("Loop end");
/// The edge where the transition begins.
pub(super) const TRANSITION_START: Word = Word::new("Transition start");
/// The edge where the transition ends.
pub(super) const TRANSITION_END: Word = Word::new("Transition end");
/// The words for the feet of a body.
pub(super) struct FootWords {
    /// Its sign.
    pub(super) sign: Word,
    /// Its name.
    pub(super) name: Word,
    /// The item that adds a contact of it.
    pub(super) add: Word,
}

/// The feet of a body on two legs.
const TWO_FEET: [FootWords; 2] = [
    FootWords {
        sign: Word::new("L"),
        name: Word::new("Left foot"),
        add: Word::new("Add a left contact at the playhead"),
    },
    FootWords {
        sign: Word::new("R"),
        name: Word::new("Right foot"),
        add: Word::new("Add a right contact at the playhead"),
    },
];
/// The feet of a body on four legs: hind feet, then forefeet.
const FOUR_FEET: [FootWords; 4] = [
    FootWords {
        sign: Word::new("LH"),
        name: Word::new("Left hind foot"),
        add: Word::new("Add a left hind contact at the playhead"),
    },
    FootWords {
        sign: Word::new("RH"),
        name: Word::new("Right hind foot"),
        add: Word::new("Add a right hind contact at the playhead"),
    },
    FootWords {
        sign: Word::new("LF"),
        name: Word::new("Left forefoot"),
        add: Word::new("Add a left fore contact at the playhead"),
    },
    FootWords {
        sign: Word::new("RF"),
        name: Word::new("Right forefoot"),
        add: Word::new("Add a right fore contact at the playhead"),
    },
];

/// Returns the words for the feet of a body with this number of feet.
pub(super) fn feet(count: usize) -> &'static [FootWords] {
    if count > TWO_FEET.len() { &FOUR_FEET } else { &TWO_FEET }
}

/// The item that adds a contact under the pointer.
pub(super) const ADD_CONTACT: Word = Word::new("Add a contact here");
/// The item that removes a contact.
pub(super) const REMOVE_CONTACT: Word = Word::new("Remove this contact");
/// The item that reverts the corrections of contacts.
pub(super) const RESET_CONTACTS: Word = Word::new("Back to what was found");
/// The help on a contact.
pub(super) const STANCE_HELP: Word = Word::new(
    "Drag an end, or use the arrow keys: they move the strike, with Shift the lift. Delete removes the contact.",
);
/// The button that opens the menu of a row.
pub(super) const MORE: Word = Word::new("More");
/// The button that clears a search field.
pub(super) const CLEAR_SEARCH: Word = Word::new("Clear the search");
/// The name of the list of notices.
pub(super) const NOTICES: Word = Word::new("Notices");
/// The button that closes all notices.
pub(crate) const DISMISS_ALL: Word = Word::new("Dismiss all");
/// The handle where the used part of a clip begins.
pub(super) const PART_START: Word = Word::new("Start of the part");
/// The handle where the used part of a clip ends.
pub(super) const PART_END: Word = Word::new("End of the part");
/// The button that closes a notice.
pub(crate) const DISMISS: Word = Word::new("Dismiss");
/// The button that stops a task.
pub(super) const CANCEL: Word = Word::new("Cancel");
/// The sign of a help text, behind the name of its row.
pub(super) const HELP: Word = Word::new("help");
/// The hint on a slider's value.
pub(super) const TYPE_VALUE: Word = Word::new("Click to type a value");
/// The hint on the label of a slider or a choice.
pub(super) const RESET_HINT: Word = Word::new("Double-click to reset");
