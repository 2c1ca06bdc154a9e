//! Lines of plain decimal numbers, fast: what almost all of a motion file is.
//!
//! Eight bytes at a time in one 64-bit word, the first one lowest: whether they are digits, and
//! what number they make, takes a handful of operations without a branch (D. Lemire, "Number
//! parsing at a gigabyte per second", Software: Practice and Experience 51, 2021). Where a number
//! ends is found before and apart from what it is, so that the next one can be begun meanwhile. In
//! a file nearly all numbers have as many digits behind the point, and where that is known the rest
//! follows from where the point is.
//!
//! Whatever is not plain is left to [`super::number`], which reads the same numbers slowly.

/// A byte in all places of a word.
const fn all(byte: u8) -> u64 {
    u64::from_le_bytes([byte; 8])
}

/// Where the point of a number stands.
#[derive(Clone, Copy, Debug)]
struct Point {
    /// What stays where it is when the point is taken out of the last eight bytes: those behind it.
    kept: u64,
    /// The power of ten that all digits are to be divided by, for a number without and with a minus
    /// sign.
    divisors: [f64; 2],
}

/// By the number of digits behind the point, up to 7, and at last for no point.
const POINTS: [Point; 9] = [
    point(0, 1.0),
    point(!0 << 56, 1e1),
    point(!0 << 48, 1e2),
    point(!0 << 40, 1e3),
    point(!0 << 32, 1e4),
    point(!0 << 24, 1e5),
    point(!0 << 16, 1e6),
    point(!0 << 8, 1e7),
    point(!0, 1.0),
];

const fn point(kept: u64, divisor: f64) -> Point {
    Point { kept, divisors: [divisor, -divisor] }
}

/// The last row of [`POINTS`].
const NO_POINT: usize = 8;

/// So many digits, and a power of ten up to 1e22, are exact as doubles.
const MAX_DIGITS: usize = 15;

/// Larger magnitudes are overflows, not measures: they would not survive being scaled in `f32`.
pub(super) const LARGEST: f64 = 1e30;

/// The number that eight digits make, the first one lowest; less eight times `b'0'`, so that
/// missing ones are zeros. `None` if they are no digits.
#[inline]
fn eight_digits(digits: u64) -> Option<u32> {
    // Digits are 0 to 9 now, and the highest bit is set for anything else. A carry would come from
    // such a byte.
    if (digits.wrapping_add(all(0x76)) | digits) & all(0x80) != 0 {
        return None;
    }
    // Neighbours become pairs, pairs fours, fours all eight.
    let pairs = digits.wrapping_mul(10).wrapping_add(digits >> 8);
    let low = (pairs & 0x0000_00ff_0000_00ff).wrapping_mul(100 + (1_000_000 << 32));
    let high = ((pairs >> 16) & 0x0000_00ff_0000_00ff).wrapping_mul(1 + (10_000 << 32));
    Some((low.wrapping_add(high) >> 32) as u32)
}

/// The last `count` (1 to 8) of eight bytes as digits for [`eight_digits`].
#[inline]
fn last_digits(word: u64, count: usize) -> u64 {
    let unused = 64_usize.wrapping_sub(8 * count);
    (word ^ all(b'0')) >> unused << unused
}

/// Any number between two offsets. `None` where there is none, or one too large to be a measure.
#[cold]
fn long_number(text: &[u8], start: usize, end: usize) -> Option<f64> {
    let value = fast_float2::parse::<f64, _>(text.get(start..end)?).ok()?;
    (value.abs() <= LARGEST).then_some(value)
}

/// All digits of a number, what they are to be divided by, and where its point stands, a row of
/// [`POINTS`].
type Parts = (f64, f64, usize);

/// A number between two offsets that is made of a minus sign or none and at most 15 digits, among
/// them perhaps a point with at most 7 behind it. Its digits and the power of ten are exact, so
/// that their quotient is the double next to the number (W. Clinger, "How to read floating point
/// numbers accurately", 1990).
#[inline]
fn short_number(text: &[u8], start: usize, end: usize) -> Option<Parts> {
    let bytes: &[u8; 9] = text.get(end.checked_sub(9)?..end)?.first_chunk()?;
    let [_, last @ ..] = bytes;
    let (last, before) = (u64::from_le_bytes(*last), u64::from_le_bytes(*bytes.first_chunk()?));
    let length = end.wrapping_sub(start);
    let negative = *text.get(start)? == b'-';

    // The last point, seen from the end: the highest byte that is zero without its bits. Nothing is
    // carried from one byte to the next.
    let points = last ^ all(b'.');
    let points = !((points & all(0x7f)).wrapping_add(all(0x7f)) | points | all(0x7f));
    let decimals = (points.leading_zeros() / 8) as usize;
    let at = if decimals < length { decimals } else { NO_POINT };
    let &Point { kept, divisors } = POINTS.get(at)?;
    let has_point = usize::from(at != NO_POINT);
    // What is before the point moves up by one.
    let digits = last & kept | before & !kept;

    let count = length.wrapping_sub(usize::from(negative)).wrapping_sub(has_point);
    let divisor = divisors[usize::from(negative)];
    if let 1..=8 = count {
        return Some((f64::from(eight_digits(last_digits(digits, count))?), divisor, at));
    }
    if !(9..=MAX_DIGITS).contains(&count) {
        return None;
    }
    let end = end.wrapping_sub(8 + has_point);
    let first: &[u8; 8] = text.get(end.checked_sub(8)?..end)?.first_chunk()?;
    let first = eight_digits(last_digits(u64::from_le_bytes(*first), count - 8))?;
    let rest = eight_digits(digits ^ all(b'0'))?;
    Some(((u64::from(first) * 100_000_000 + u64::from(rest)) as f64, divisor, at))
}

/// Numbers with the same number of digits behind the point: those of a file are mostly alike. Where
/// the end of such a number is follows from where its point is, and all that follows from where the
/// point is seen from the end is the same for all.
#[derive(Clone, Copy, Debug)]
struct Usual {
    decimals: usize,
    point: Point,
    /// The byte of the point among the last eight.
    at: u64,
}

impl Usual {
    fn new(decimals: usize) -> Option<Self> {
        Some(Self { decimals, point: *POINTS.get(decimals)?, at: 0xff_u64 << 56 >> (8 * decimals) })
    }

    /// As [`short_number`], of at most 8 digits and with a blank behind it: all digits, what to
    /// divide them by, and the number's end. `None` for any other number.
    #[inline]
    fn number(&self, text: &[u8], start: usize) -> Option<(f64, f64, usize)> {
        let word = u64::from_le_bytes(*text.get(start..)?.first_chunk()?);
        // Of digits the bit of 0x10 is set, of a point it is not. The first byte may be a sign.
        let whole = ((!word & (all(0x10) << 8)).trailing_zeros() / 8) as usize;
        let end = start.wrapping_add(whole).wrapping_add(1 + self.decimals);
        let bytes: &[u8; 10] = text.get(end.wrapping_sub(9)..end.checked_add(1)?)?.first_chunk()?;
        let [before @ .., _, _] = bytes;
        let [_, last @ .., blank] = bytes;
        let (last, before) = (u64::from_le_bytes(*last), u64::from_le_bytes(*before));
        let negative = usize::from(word as u8 == b'-');
        let count = whole.wrapping_add(self.decimals).wrapping_sub(negative);
        let is_usual = (last ^ all(b'.')) & self.at == 0
            && matches!(blank, b' ' | b'\t')
            && count.wrapping_sub(1) < 8;
        if !is_usual {
            return None;
        }
        let digits = last & self.point.kept | before & !self.point.kept;
        let digits = eight_digits(last_digits(digits, count))?;
        Some((f64::from(digits), self.point.divisors[negative], end))
    }
}

/// Reads lines of plain numbers.
#[derive(Debug, Default)]
pub(super) struct Lines {
    /// The power of ten that divides the digits of each number. The divisions are done together,
    /// because one alone takes as long as the rest of reading a number.
    divisors: Vec<f64>,
    /// The usual number of digits after the decimal point in the lines before.
    decimals: usize,
}

impl Lines {
    /// Reads a line of `row.len()` plain numbers with blanks between them into `row`, and returns
    /// the offset of the line's end.
    ///
    /// `None` when there is anything else in it: what stands in `row` for the numbers before that
    /// is then of no use, and the rest is as it was.
    pub(super) fn line(&mut self, text: &[u8], at: usize, row: &mut [f64]) -> Option<usize> {
        self.divisors.resize(row.len(), 1.0);
        let usual = Usual::new(self.decimals)?;
        let mut unusual = (0, self.decimals);
        let mut at = at;
        for (digits, divisor) in row.iter_mut().zip(&mut self.divisors) {
            if let Some((number, power, end)) = usual.number(text, at) {
                (*digits, *divisor) = (number, power);
                at = end + 1;
                continue;
            }
            at = past_blanks(text, at)?;
            let end = end_of_word(text, at)?;
            if let Some((number, power, point)) = short_number(text, at, end) {
                (*digits, *divisor) = (number, power);
                unusual = (unusual.0 + 1, point);
            } else {
                (*digits, *divisor) = (long_number(text, at, end)?, 1.0);
            }
            at = past_blanks(text, end)?;
        }
        let end = past_blanks(text, at)?;
        if !matches!(text.get(end), Some(b'\n' | b'\r')) {
            return None;
        }
        // What is unusual in most of a line is the rule.
        if 2 * unusual.0 > row.len() && unusual.1 != NO_POINT {
            self.decimals = unusual.1;
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

/// Marks the first byte that is a space or lower, by its highest bit. What is set above that may be
/// the borrow of it.
#[inline]
fn blanks(word: u64) -> u64 {
    word.wrapping_sub(all(b' ' + 1)) & !word & all(0x80)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::number::{Scan, scan};
    use proptest::prelude::*;

    fn short(text: &str, start: usize, end: usize) -> Option<f64> {
        short_number(text.as_bytes(), start, end).map(|(digits, divisor, _)| digits / divisor)
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
            before in "[-0-9. ]{0,17}",
            text in "[-+]{0,2}[0-9]{0,17}[.,]{0,2}[0-9]{0,18}([eE][-+]?[0-9]{0,3})?",
            after in "[ 0-9.]{0,9}",
        ) {
            let all = format!("{before}{text}{after}");
            let (start, end) = (before.len(), before.len() + text.len());
            let found = short(&all, start, end).or_else(|| long_number(all.as_bytes(), start, end));
            prop_assert_eq!(found.map(f64::to_bits), slow(&text));
        }

        #[test]
        fn usual_numbers_are_short(before in "[-0-9. ]{17}", text in "-?([0-9]{1,15}|[0-9]{0,9}\\.[0-9]{1,6}|[0-9]{1,8}\\.)") {
            let all = format!("{before}{text}");
            let found = short(&all, before.len(), all.len());
            prop_assert_eq!(found.map(f64::to_bits), slow(&text));
        }

        #[test]
        fn numbers_of_usual_shape_are_those_of_the_slow_way(
            before in "[-0-9. ]{9}",
            text in "[-+]?[0-9]{0,9}[.,]?[0-9]{0,9}|[!-~]{1,12}",
            after in "[ \t][ -~]{10}",
            decimals in 0..8_usize,
        ) {
            let all = format!("{before}{text}{after}");
            let (start, end) = (before.len(), before.len() + text.len());
            let usual = Usual::new(decimals).unwrap();
            if let Some((digits, divisor, found)) = usual.number(all.as_bytes(), start) {
                prop_assert_eq!((found, Some((digits / divisor).to_bits())), (end, slow(&text)));
            }
        }

        #[test]
        fn numbers_of_usual_shape_are_read_as_such(before in "[-0-9. ]{9}", whole in "-?[0-9]{1,4}", decimals in "[0-9]{1,4}", blank in "[ \t]") {
            let text = format!("{whole}.{decimals}");
            let all = format!("{before}{text}{blank}2.345678901");
            let found = Usual::new(decimals.len()).unwrap().number(all.as_bytes(), before.len());
            let expected = slow(&text).map(|value| (value, all.len() - 12));
            prop_assert_eq!(found.map(|(digits, divisor, end)| ((digits / divisor).to_bits(), end)), expected);
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
            let mut lines = Lines::default();
            // The second time it knows what is usual.
            for _ in 0..2 {
                let end = lines.line(text.as_bytes(), 0, &mut row);
                prop_assert_eq!(end, text.find('\n'));
                prop_assert_eq!(&row, &words.iter().map(|word| word.parse::<f64>().unwrap()).collect::<Vec<_>>());
            }
            prop_assert_eq!(Lines::default().line(text.as_bytes(), 0, &mut vec![0.0; words.len() + 1]), None);
        }
    }

    #[test]
    fn what_is_odd_is_left_to_the_slow_way() {
        let line = |text: &str, row: &mut [f64]| Lines::default().line(text.as_bytes(), 0, row);
        let padding = " ".repeat(16);
        for second in
            ["nan", "1.#IND", "1,5", "2-3", "2x", "# 2", "\0", "\x0b2", "1e40", "-", ".", "--2", ""]
        {
            let mut row = [7.0, 8.0];
            assert_eq!(line(&format!("1 {second}\n{padding}"), &mut row), None, "{second}");
            assert_eq!(row[1], 8.0, "{second}");
        }
        // Too many, a comment, other white space, and the end of the text, where there are no
        // sixteen bytes to look at.
        for text in ["1 2 3\n", "1 2 # 3\n", "1 2\x0b\n", "1 2\0\n"] {
            assert_eq!(line(&format!("{text}{padding}"), &mut [7.0, 8.0]), None, "{text}");
        }
        assert_eq!(line("1 2\n", &mut [7.0, 8.0]), None);
    }
}
