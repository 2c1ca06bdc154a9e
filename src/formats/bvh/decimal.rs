//! Lines of plain decimal numbers, fast: what almost all of a motion file is.
//!
//! Eight bytes at a time in one 64-bit word, the first one lowest: whether they are digits, and what number they make, takes a handful of
//! operations without a branch (D. Lemire, "Number parsing at a gigabyte per second", Software: Practice and Experience 51, 2021). Where a number
//! ends is found before and apart from what it is, so that the next one can be begun meanwhile.
//!
//! Whatever is not plain is left to [`super::number`], which reads the same numbers slowly.

/// A byte in all places of a word.
const fn all(byte: u8) -> u64 {
    u64::from_le_bytes([byte; 8])
}

/// For each number of digits behind the point, up to 7, and at last for no point: what stays where it is when the point is taken out of the last
/// eight bytes (those behind it), and the power of ten that all digits are to be divided by, for a number without and with a minus sign.
const POINTS: [(u64, [f64; 2]); 9] = [
    (0, [1.0, -1.0]),
    (!0 << 56, [1e1, -1e1]),
    (!0 << 48, [1e2, -1e2]),
    (!0 << 40, [1e3, -1e3]),
    (!0 << 32, [1e4, -1e4]),
    (!0 << 24, [1e5, -1e5]),
    (!0 << 16, [1e6, -1e6]),
    (!0 << 8, [1e7, -1e7]),
    (!0, [1.0, -1.0]),
];

/// The last row of [`POINTS`].
const NO_POINT: usize = 8;

/// Larger magnitudes are overflows, not measures: they would not survive being scaled in `f32`.
pub(super) const LARGEST: f64 = 1e30;

/// Any number between two offsets. `None` where there is none, or one too large to be a measure.
#[cold]
fn long_number(text: &[u8], start: usize, end: usize) -> Option<f64> {
    let value = fast_float2::parse::<f64, _>(text.get(start..end)?).ok()?;
    (value.abs() <= LARGEST).then_some(value)
}

/// A number between two offsets that is made of a minus sign or none and at most 8 digits, among them perhaps a point: all of its digits, and the
/// power of ten to divide them by. Both are exact, so that the quotient is the double next to the number (W. Clinger, "How to read floating
/// point numbers accurately", 1990).
#[inline]
fn short_number(text: &[u8], start: usize, end: usize) -> Option<(f64, f64)> {
    let bytes: &[u8; 9] = text.get(end.checked_sub(9)?..end)?.first_chunk()?;
    let [_, last @ ..] = bytes;
    let (last, before) = (u64::from_le_bytes(*last), u64::from_le_bytes(*bytes.first_chunk()?));
    let length = end.wrapping_sub(start);
    let negative = *text.get(start)? == b'-';

    // The last point, seen from the end: the lowest byte that is none, whatever a borrow does to those above it.
    let points = last.swap_bytes() ^ all(b'.');
    let points = points.wrapping_sub(all(1)) & !points & all(0x80);
    let decimals = (points.trailing_zeros() / 8) as usize;
    let point = if decimals < length { decimals } else { NO_POINT };
    let &(kept, [plus, minus]) = POINTS.get(point)?;
    // What is before the point moves up by one.
    let digits = last & kept | before & !kept;

    let count = length
        .wrapping_sub(usize::from(negative))
        .wrapping_sub(usize::from(point != NO_POINT));
    // What is before the number goes too: zeros stay.
    let unused = 64_usize.wrapping_sub(8 * count);
    if unused > 56 {
        return None;
    }
    let digits = (digits ^ all(b'0')) >> unused << unused;
    // Digits are 0 to 9 now, and the highest bit is set for anything else. A carry would come from such a byte.
    if (digits.wrapping_add(all(0x76)) | digits) & all(0x80) != 0 {
        return None;
    }
    // Neighbours become pairs, pairs fours, fours all eight.
    let pairs = digits.wrapping_mul(10).wrapping_add(digits >> 8);
    let low = (pairs & 0x0000_00ff_0000_00ff).wrapping_mul(100 + (1_000_000 << 32));
    let high = ((pairs >> 16) & 0x0000_00ff_0000_00ff).wrapping_mul(1 + (10_000 << 32));
    let digits = (low.wrapping_add(high) >> 32) as u32;
    Some((f64::from(digits), if negative { minus } else { plus }))
}

/// Reads lines of plain numbers.
#[derive(Debug, Default)]
pub(super) struct Lines {
    /// What the digits of each number are to be divided by: all at once, since one division takes as long as the rest of a number.
    divisors: Vec<f64>,
}

impl Lines {
    /// Reads a line of `row.len()` plain numbers with blanks between them into `row`, and returns the offset of the line's end.
    ///
    /// `None` when there is anything else in it: what stands in `row` for the numbers before that is then of no use, and the rest is as it was.
    pub(super) fn line(&mut self, text: &[u8], at: usize, row: &mut [f64]) -> Option<usize> {
        self.divisors.resize(row.len(), 1.0);
        let mut at = at;
        for (digits, divisor) in row.iter_mut().zip(&mut self.divisors) {
            at = past_blanks(text, at)?;
            let end = end_of_word(text, at)?;
            (*digits, *divisor) = match short_number(text, at, end) {
                Some(number) => number,
                None => (long_number(text, at, end)?, 1.0),
            };
            at = end;
        }
        let end = past_blanks(text, at)?;
        if !matches!(text.get(end), Some(b'\n' | b'\r')) {
            return None;
        }
        row.iter_mut().zip(&self.divisors).for_each(|(digits, divisor)| *digits /= divisor);
        Some(end)
    }
}

/// The next byte that is neither a space nor a tab.
#[inline]
fn past_blanks(text: &[u8], mut at: usize) -> Option<usize> {
    while matches!(text.get(at)?, b' ' | b'\t') {
        at += 1;
    }
    Some(at)
}

/// The next byte that is a space or lower, after `at` or there. `None` near the end of the text.
#[inline]
fn end_of_word(text: &[u8], at: usize) -> Option<usize> {
    let (words, _) = text.get(at..at.checked_add(16)?)?.as_chunks::<8>();
    let &[first, second] = words else { return None };
    let (first, second) = (blanks(u64::from_le_bytes(first)), blanks(u64::from_le_bytes(second)));
    // Both are looked at and no branch is taken, since no one can tell which it will be.
    let in_second = if first == 0 { second.trailing_zeros() } else { 0 };
    match (first.trailing_zeros() + in_second) / 8 {
        16 => text.get(at..)?.iter().position(|b| *b <= b' ').map(|length| at + length),
        length => Some(at + length as usize),
    }
}

/// Marks the first byte that is a space or lower, by its highest bit. What is set above that may be the borrow of it.
#[inline]
fn blanks(word: u64) -> u64 {
    word.wrapping_sub(all(b' ' + 1)) & !word & all(0x80)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::bvh::number::{Scan, scan};
    use proptest::prelude::*;

    fn short(text: &str, start: usize, end: usize) -> Option<f64> {
        short_number(text.as_bytes(), start, end).map(|(digits, divisor)| digits / divisor)
    }

    /// What the slow way reads, where it reads one number.
    fn slow(text: &str) -> Option<u64> {
        match scan(text.as_bytes(), 0, false) {
            Scan::Value { value, end, glued: false } if end == text.len() => Some(value.to_bits()),
            _ => None,
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2000))]

        #[test]
        fn numbers_are_those_of_the_slow_way(
            before in "[-0-9. ]{0,9}",
            text in "[-+]{0,2}[0-9]{0,10}[.,]{0,2}[0-9]{0,18}([eE][-+]?[0-9]{0,3})?",
            after in "[ 0-9.]{0,9}",
        ) {
            let all = format!("{before}{text}{after}");
            let (start, end) = (before.len(), before.len() + text.len());
            let found = short(&all, start, end).or_else(|| long_number(all.as_bytes(), start, end));
            prop_assert_eq!(found.map(f64::to_bits), slow(&text));
        }

        #[test]
        fn usual_numbers_are_short(before in "[-0-9. ]{10}", text in "-?([0-9]{1,8}|[0-9]{0,4}\\.[0-9]{1,4}|[0-9]{0,2}\\.[0-9]{6}|[0-9]{1,8}\\.)") {
            let all = format!("{before}{text}");
            let found = short(&all, before.len(), all.len());
            prop_assert_eq!(found.map(f64::to_bits), slow(&text));
        }

        #[test]
        fn words_end_at_the_first_blank(word in "[!-~\u{80}-\u{ff}]{0,40}", blank in 0..=b' ', after: [u8; 16]) {
            let text = [word.as_bytes(), &[blank], &after].concat();
            prop_assert_eq!(end_of_word(&text, 0), Some(word.len()));
        }

        #[test]
        fn a_line_is_its_words(words in prop::collection::vec("-?[0-9]{1,4}(\\.[0-9]{0,9})?|1e-7", 0..40), gap in "[ \t]{1,70}", indent in "[ \t]{0,3}") {
            let text = format!("{indent}{}\n{}", words.join(&gap), "\n".repeat(16));
            let mut row = vec![0.0; words.len()];
            let end = Lines::default().line(text.as_bytes(), 0, &mut row);
            prop_assert_eq!(end, text.find('\n'));
            prop_assert_eq!(row, words.iter().map(|word| word.parse::<f64>().unwrap()).collect::<Vec<_>>());
            prop_assert_eq!(Lines::default().line(text.as_bytes(), 0, &mut vec![0.0; words.len() + 1]), None);
        }
    }

    #[test]
    fn what_is_odd_is_left_to_the_slow_way() {
        let line = |text: &str, row: &mut [f64]| Lines::default().line(text.as_bytes(), 0, row);
        let padding = " ".repeat(16);
        for second in [
            "nan", "1.#IND", "1,5", "2-3", "2x", "# 2", "\0", "\x0b2", "1e40", "-", ".", "--2", "",
        ] {
            let mut row = [7.0, 8.0];
            assert_eq!(line(&format!("1 {second}\n{padding}"), &mut row), None, "{second}");
            assert_eq!(row[1], 8.0, "{second}");
        }
        // Too many, a comment, other white space, and the end of the text, where there are no sixteen bytes to look at.
        for text in ["1 2 3\n", "1 2 # 3\n", "1 2\x0b\n", "1 2\0\n"] {
            assert_eq!(line(&format!("{text}{padding}"), &mut [7.0, 8.0]), None, "{text}");
        }
        assert_eq!(line("1 2\n", &mut [7.0, 8.0]), None);
    }
}
