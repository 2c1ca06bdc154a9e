//! The texts of the stage and of the numbers below it.

use crate::ui::language::Word;
use segue_text::{Message, msg};

/// The button that shows all numbers, with their names in full.
pub(crate) const ALL_NUMBERS: Word = Word::new("All numbers");
/// The button that shows as many numbers as there is room for in one or two rows.
pub(crate) const FEWER_NUMBERS: Word = Word::new("Fewer numbers");
/// The button that moves the playhead to the frame where a number happens.
pub(crate) const SHOW_FRAME: Word = Word::new("Show the frame");
/// The value of a number that a result does not have.
pub(crate) const NOT_MEASURED: Word = Word::new("This result has nothing to measure.");

/// Returns the place of the frame that a button shows.
pub(crate) fn worst_frame(secs: f64, frame: usize) -> Message {
    msg!("{secs:.2} s · frame {frame}", secs, frame)
}
