//! The texts of the Register lab.

use crate::ui::language::Word;
use segue_text::{Message, msg};

/// The line about the Register lab.
pub(crate) const REGISTER_ABOUT: Word = Word::new("Time-warps B so that matching poses line up.");
/// The help text of the Register lab.
pub(crate) const REGISTER_DETAILS: Word =
    Word::new("Watch the foot contacts on the timeline: A, B and the result strike together.");
/// The hint over the stage in the Register lab.
pub(crate) const REGISTER_HINT: Word = Word::new(
    "A and B play beside the result, in sync. Compare with plain: steps double, and feet slide.",
);
/// The button that makes the weight of a registered blend a curve.
pub(crate) const WEIGHT_OVER_TIME: Word = Word::new("Draw over time");
/// The button that makes the weight a number again.
pub(crate) const ONE_WEIGHT: Word = Word::new("One weight");
/// The upper end of the weight's curve.
pub(crate) const ALL_B: Word = Word::new("all B");
/// The lower end of the weight's curve.
pub(crate) const ALL_A: Word = Word::new("all A");
/// The help below the weight's curve.
pub(crate) const WEIGHT_CURVE_HELP: Word =
    Word::new("Drag a key to move it; double-click to add or remove one.");
/// The button that compares the registered blend with the plain one.
pub(crate) const REGISTERED_AND_PLAIN: Word = Word::new("Compare registered and plain");
/// The accessible name of the map of distances.
pub(crate) const DISTANCES: Word = Word::new("Distances between A and B");
/// The help below the map of distances.
pub(crate) const MAP_HELP: Word = Word::new(
    "Hover: shows both poses. Click: goes there. Drag: adds a pin; drag it out or double-click it to remove it.",
);
/// The help below the map of distances where it is worked by fingers.
pub(crate) const MAP_HELP_TOUCH: Word = Word::new(
    "Tap: goes there. Hold: adds a pin; drag it to move it, or out of the map to remove it.",
);
/// The button that removes all pins.
pub(crate) const REMOVE_PINS: Word = Word::new("Remove pins");
/// The heading of the parameters below the map.
pub(crate) const REGISTRATION: Word = Word::new("Registration");
/// The label of the stripes of A's feet.
pub(crate) const FEET_OF_A: Word = Word::new("A feet");
/// The label of the stripes of B's feet.
pub(crate) const FEET_OF_B: Word = Word::new("B feet");
/// The label of the stripes of the result's feet.
pub(crate) const FEET_OF_RESULT: Word = Word::new("Result");

/// Returns the distance of a pair of frames.
pub(crate) fn pair_apart([a, b]: [f64; 2], cm: Option<f64>) -> Message {
    if let Some(cm) = cm {
        msg!("A {a:.2} s, B {b:.2} s: {cm:.1} cm per joint", a, b, cm)
    } else {
        msg!("A {a:.2} s, B {b:.2} s", a, b)
    }
}

/// Returns the ends of the scale of colours, which begins at no distance.
pub(crate) fn heat_ends(high_cm: f64) -> [Message; 2] {
    [Message::data("0"), msg!("{cm:.0} cm per joint", cm = high_cm)]
}

/// Returns the number of pins.
pub(crate) fn pins(count: usize) -> Message {
    msg!("{count, plural, one {# pin} other {# pins}}", count)
}

/// Returns the letter of a further clip in a blend, after A and B.
fn letter(index: usize) -> char {
    char::from_u32('C' as u32 + index as u32).unwrap_or('…')
}

/// Returns the label of a further clip of a blend.
pub(crate) fn blended_clip(index: usize) -> String {
    letter(index).to_string()
}

/// Returns the label of the weight of a further clip of a blend.
pub(crate) fn weight_of(index: usize) -> Message {
    msg!("Weight of {clip}", clip = letter(index))
}
