//! Lines of plain decimal numbers, fast: what almost all of a motion file is.
//!
//! Eight bytes at a time in one 64-bit word, the first one lowest: whether they are digits, and what number they make, takes a handful of
//! operations without a branch (D. Lemire, "Number parsing at a gigabyte per second", Software: Practice and Experience 51, 2021; the search for
//! blanks after G. Langdale and D. Lemire, "Parsing gigabytes of JSON per second", VLDB Journal 28, 2019). Where the numbers start is found
//! first, so that no number waits for the length of the one before.
//!
//! Whatever is not plain is left to [`super::number`], which reads the same numbers slowly.

/// A byte in all places of a word.
const fn all(byte: u8) -> u64 {
    u64::from_le_bytes([byte; 8])
}

/// Powers of ten that a double holds exactly, as far as digits behind the point are read here.
const TENS: [f64; 9] = [1.0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8];

/// [`TENS`] as integers.
const WHOLE_TENS: [u64; 9] = [1, 10, 100, 1_000, 10_000, 100_000, 1_000_000, 10_000_000, 100_000_000];

/// Larger magnitudes are overflows, not measures: they would not survive being scaled in `f32`.
pub(super) const LARGEST: f64 = 1e30;

/// The number at `at` and where it ends: the same as the slow way, to the last bit. `None` where there is none, or one that is too large to be
/// a measure. What comes after it is not looked at.
#[inline]
pub(super) fn number(text: &[u8], at: usize) -> Option<(f64, usize)> {
    plain(text, at).or_else(|| {
        let (value, length) = fast_float2::parse_partial::<f64, _>(text.get(at..)?).ok()?;
        (value.abs() <= LARGEST).then_some((value, at + length))
    })
}

/// A minus sign or none, at most 7 digits, and at most 7 more behind a point: those are exact.
#[inline]
fn plain(text: &[u8], at: usize) -> Option<(f64, usize)> {
    let word = word(text, at)?;
    let negative = u64::from(word as u8 == b'-');
    // What comes in from above is no digit.
    let word = word >> (8 * negative);
    let digits = count_digits(word);
    let mut end = at + negative as usize + digits;
    let whole = value_of(word, digits)?;
    let mut mantissa = whole;
    let mut decimals = 0;
    if text.get(end) == Some(&b'.') {
        let word = self::word(text, end + 1)?;
        decimals = count_digits(word);
        end += 1 + decimals;
        mantissa = whole * WHOLE_TENS.get(decimals)? + value_of(word, decimals)?;
    }
    // More digits may come, or an exponent.
    let goes_on = matches!(text.get(end), Some(b'0'..=b'9' | b'e' | b'E'));
    if goes_on || digits + decimals == 0 {
        return None;
    }
    // Both are exact, so that the quotient is the double next to the number (W. Clinger, "How to read floating point numbers accurately", 1990).
    let value = mantissa as i64 as f64 / TENS.get(decimals)?;
    Some((f64::from_bits(value.to_bits() | (negative << 63)), end))
}

/// Eight bytes, the first one lowest; `None` near the end of the text.
#[inline]
fn word(text: &[u8], at: usize) -> Option<u64> {
    text.get(at..)?.first_chunk().map(|bytes| u64::from_le_bytes(*bytes))
}

/// How many digits a word starts with.
#[inline]
fn count_digits(word: u64) -> usize {
    // Digits become 0 to 9, and everything else 10 or more: its highest bit is then set. Carries only go to bytes behind the first that is none.
    let values = word ^ all(b'0');
    let none = (values.wrapping_add(all(0x76)) | values) & all(0x80);
    (none.trailing_zeros() / 8) as usize
}

/// The number that the first `digits` bytes of a word make, fewer than 8.
#[inline]
fn value_of(word: u64, digits: usize) -> Option<u64> {
    // Digits go to the upper end, so that zeros are in front of them. Two shifts, since one by 64 is none.
    let free = 56_u32.checked_sub(8 * digits as u32)?;
    let digits = (word ^ all(b'0')) << 8 << free;
    // Neighbours become pairs, pairs fours, fours all eight.
    let pairs = digits.wrapping_mul(10).wrapping_add(digits >> 8);
    let low = (pairs & 0x0000_00ff_0000_00ff).wrapping_mul(100 + (1_000_000 << 32));
    let high = ((pairs >> 16) & 0x0000_00ff_0000_00ff).wrapping_mul(1 + (10_000 << 32));
    Some(low.wrapping_add(high) >> 32)
}

/// Where the numbers of a line start.
#[derive(Debug, Default)]
pub(super) struct Starts(Vec<usize>);

impl Starts {
    /// Reads a line of `row.len()` plain numbers with blanks between them into `row`, and returns the offset of the line's end.
    ///
    /// `None` when there is anything else in it; `row` then holds the numbers before that, and is otherwise as it was.
    pub(super) fn line(&mut self, text: &[u8], at: usize, row: &mut [f64]) -> Option<usize> {
        let rest = text.get(at..)?;
        let line = rest.get(..memchr::memchr2(b'\n', b'\r', rest)?)?;
        if line.iter().fold(false, |odd, &b| odd | (b < b' ' && b != b'\t')) {
            return None;
        }
        self.find(line, at, row.len());
        if self.0.len() != row.len() {
            return None;
        }
        for (slot, &start) in row.iter_mut().zip(&self.0) {
            let (value, end) = number(text, start)?;
            if *text.get(end)? > b' ' {
                return None;
            }
            *slot = value;
        }
        Some(at + line.len())
    }

    /// Finds the bytes that follow a blank, and stops soon after there are more than `most`. `at` is where the line starts.
    fn find(&mut self, line: &[u8], at: usize, most: usize) {
        self.0.clear();
        // Whether the byte before the block is a blank.
        let mut blank_before = 1;
        let (blocks, rest) = line.as_chunks::<64>();
        let mut last = [b' '; 64];
        if let Some(head) = last.get_mut(..rest.len()) {
            head.copy_from_slice(rest);
        }
        for (block, at) in blocks.iter().chain(std::iter::once(&last)).zip((at..).step_by(64)) {
            let blanks = blanks(block);
            let mut starts = !blanks & (blanks << 1 | blank_before);
            blank_before = blanks >> 63;
            if self.0.len() > most {
                break;
            }
            while starts != 0 {
                self.0.push(at + starts.trailing_zeros() as usize);
                starts &= starts - 1;
            }
        }
    }
}

/// One bit for each byte that is a space or lower.
#[inline]
fn blanks(block: &[u8; 64]) -> u64 {
    let (words, _) = block.as_chunks::<8>();
    words.iter().rev().fold(0, |bits, bytes| {
        let word = u64::from_le_bytes(*bytes);
        // The highest bit of a byte is set where it is above a space.
        let above = (word & all(0x7f)).wrapping_add(all(0x7f - b' ')) | word;
        let blank = !above & all(0x80);
        // Gathers the eight bits in the highest byte, in their order.
        let gathered = (blank >> 7).wrapping_mul(0x0102_0408_1020_4080) >> 56;
        bits << 8 | gathered
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::bvh::number::{Scan, scan};
    use proptest::prelude::*;

    /// What the slow way reads, where it reads a number that a blank follows.
    fn slow(text: &[u8]) -> Option<(u64, usize)> {
        match scan(text, 0, false) {
            Scan::Value { value, end, glued: false } => Some((value.to_bits(), end)),
            _ => None,
        }
    }

    fn fast(text: &[u8]) -> Option<(u64, usize)> {
        let ends = |end: usize| matches!(text.get(end), None | Some(b' ' | b'\n'));
        number(text, 0)
            .filter(|&(_, end)| ends(end))
            .map(|(value, end)| (value.to_bits(), end))
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2000))]

        #[test]
        fn numbers_are_those_of_the_slow_way(text in "[-+]{0,2}[0-9]{0,10}[.,]{0,2}[0-9]{0,18}([eE][-+]?[0-9]{0,3})?[ \n]{0,9}") {
            prop_assert_eq!(fast(text.as_bytes()), slow(text.as_bytes()));
        }

        #[test]
        fn usual_numbers_are_plain(text in "-?([0-9]{1,7}(\\.[0-9]{0,7})?|\\.[0-9]{1,7})") {
            let padded = format!("{text}         ");
            let (value, end) = plain(padded.as_bytes(), 0).unwrap();
            prop_assert_eq!((value.to_bits(), end), (text.parse::<f64>().unwrap().to_bits(), text.len()));
        }

        #[test]
        fn words_are_counted_and_read(bytes: [u8; 8], digits in "[0-9]{0,7}") {
            let mut word = bytes;
            word[..digits.len()].copy_from_slice(digits.as_bytes());
            let expected = word.iter().take_while(|b| b.is_ascii_digit()).count();
            let word = u64::from_le_bytes(word);
            prop_assert_eq!(count_digits(word), expected);
            prop_assert_eq!(value_of(word, digits.len()), Some(digits.parse().unwrap_or(0)));
            prop_assert_eq!(value_of(word, 8), None);
        }

        #[test]
        fn blanks_are_found(bytes in prop::collection::vec(prop_oneof![any::<u8>(), Just(b' '), Just(b'\t'), Just(b'!'), Just(0xa0)], 64)) {
            let block: [u8; 64] = bytes.try_into().unwrap();
            let expected = (0..64).filter(|&i| block[i] <= b' ').fold(0, |bits, i| bits | 1_u64 << i);
            prop_assert_eq!(blanks(&block), expected);
        }

        #[test]
        fn a_line_is_its_words(words in prop::collection::vec("-?[0-9]{1,4}(\\.[0-9]{0,9})?|1e-7", 0..40), gap in "[ \t]{1,70}", indent in "[ \t]{0,3}") {
            let text = format!("{indent}{}\n\n         ", words.join(&gap));
            let mut row = vec![0.0; words.len()];
            let end = Starts::default().line(text.as_bytes(), 0, &mut row);
            prop_assert_eq!(end, text.find('\n'));
            prop_assert_eq!(row, words.iter().map(|word| word.parse::<f64>().unwrap()).collect::<Vec<_>>());
            prop_assert_eq!(Starts::default().line(text.as_bytes(), 0, &mut vec![0.0; words.len() + 1]), None);
        }
    }

    #[test]
    fn what_is_odd_is_left_to_the_slow_way() {
        for line in [
            "1 2", "1 2 3", "1 nan", "1 1.#IND", "1 1,5", "1-2", "1 2x", "1 # 2", "1 \0", "1\x0b2", "1 1e40", "1 -", "1 .", "1 --2",
        ] {
            let text = format!("{line}{}", if line == "1 2" { "" } else { "\n         " });
            let mut row = [7.0, 8.0];
            assert_eq!(Starts::default().line(text.as_bytes(), 0, &mut row), None, "{line}");
            assert_eq!(row[1], 8.0, "{line}");
        }
    }
}
