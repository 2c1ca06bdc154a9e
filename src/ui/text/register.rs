//! The texts of the Register lab.

use crate::ui::language::Word;
use segue_text::{Message, msg};

/// What the Register lab does, and where to look.
pub(crate) const REGISTER_ABOUT: Word = Word::new(
    "Time-warps B so that matching poses line up. Watch the foot contacts on the timeline: A, B and the result strike together.",
);
/// The same over the stage.
pub(crate) const REGISTER_HINT: Word = Word::new(
    "A and B play beside the result, in sync. Compare with plain: steps double, and feet slide.",
);
/// What makes the weight of a registered blend a curve.
pub(crate) const WEIGHT_OVER_TIME: Word = Word::new("Draw over time");
/// And a number again.
pub(crate) const ONE_WEIGHT: Word = Word::new("One weight");
/// The ends of the weight.
pub(crate) const ALL_B: Word = Word::new("all B");
/// See [`ALL_B`].
pub(crate) const ALL_A: Word = Word::new("all A");
/// How the curve is worked.
pub(crate) const WEIGHT_CURVE_HELP: Word =
    Word::new("Drag a key to move it; double-click to add or remove one.");
/// Opens both beside each other.
pub(crate) const REGISTERED_AND_PLAIN: Word = Word::new("Compare registered and plain");
/// The map's name.
pub(crate) const DISTANCES: Word = Word::new("Distances between A and B");
/// What can be done with the map.
pub(crate) const MAP_HELP: Word = Word::new(
    "Hover: shows both poses. Click: goes there. Drag: adds a pin; drag it out or double-click it to remove it.",
);
/// A button.
pub(crate) const REMOVE_PINS: Word = Word::new("Remove pins");
/// Of the parameters below the map.
pub(crate) const REGISTRATION: Word = Word::new("Registration");
/// Before the stripes of feet.
pub(crate) const FEET_OF_A: Word = Word::new("A feet");
/// Likewise.
pub(crate) const FEET_OF_B: Word = Word::new("B feet");
/// Likewise.
pub(crate) const FEET_OF_RESULT: Word = Word::new("Result");

/// How far apart a pair of frames is.
pub(crate) fn pair_apart([a, b]: [f64; 2], cm: Option<f64>) -> Message {
    if let Some(cm) = cm {
        msg!("A {a:.2} s, B {b:.2} s: {cm:.1} cm per joint", a, b, cm)
    } else {
        msg!("A {a:.2} s, B {b:.2} s", a, b)
    }
}

/// The ends of the colours.
pub(crate) fn heat_ends([low, high]: [f64; 2]) -> [Message; 2] {
    [msg!("{low:.0}", low), msg!("{cm:.0} cm per joint", cm = high)]
}

/// How many pins there are.
pub(crate) fn pins(count: usize) -> Message {
    msg!("{count, plural, one {# pin} other {# pins}}", count)
}

/// The letter of a further clip in a blend: those behind A and B.
fn letter(index: usize) -> char {
    char::from_u32('C' as u32 + index as u32).unwrap_or('…')
}

/// What a further clip of a blend is called.
pub(crate) fn blended_clip(index: usize) -> String {
    letter(index).to_string()
}

/// Its weight.
pub(crate) fn weight_of(index: usize) -> Message {
    msg!("Weight of {clip}", clip = letter(index))
}
