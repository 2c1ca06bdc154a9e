//! Pairs of numbers with a colon between them: `12.5:3,40:0`.

use super::{Misread, between_commas, entries};

/// The greatest number of pairs; a link with more is an accident.
const MAX_PAIRS: usize = 1_000;
/// The bound of numbers in a list; all useful ones are nearer to zero.
const NUMBER_BOUND: f64 = 1e5;

pub(super) fn read(text: &str, expected: &'static str) -> Result<Vec<(f64, f64)>, Misread> {
    let number =
        |text: &str| text.trim().parse::<f64>().ok().filter(|number| number.abs() < NUMBER_BOUND);
    entries(between_commas(text), MAX_PAIRS, expected, |entry| {
        let (a, b) = entry.split_once(':')?;
        number(a).zip(number(b))
    })
}
