//! Pairs of whole numbers: `12-30,50-71`.

use super::{Misread, between_commas, entries, joined};

/// The greatest number of pairs; a link with more is an accident.
const MAX_PAIRS: usize = 64;

/// Reads pairs of numbers up to `max`.
pub(super) fn read(
    text: &str,
    max: usize,
    expected: &'static str,
) -> Result<Vec<(usize, usize)>, Misread> {
    let number = |word: &str| word.trim().parse().ok().filter(|number: &usize| *number <= max);
    entries(between_commas(text), MAX_PAIRS, expected, |entry| {
        let (a, b) = entry.split_once('-')?;
        number(a).zip(number(b))
    })
}

pub(super) fn write(pairs: &[(usize, usize)]) -> String {
    joined(pairs, |(a, b)| format!("{a}-{b}"))
}
