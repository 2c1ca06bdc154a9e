//! Fast reading of lines of plain decimal numbers, which make up almost all of a motion file.
//!
//! Eight bytes are handled at a time in one 64-bit word, the first byte lowest: checking that they
//! are digits and computing their number takes a handful of operations without a branch (D. Lemire,
//! "Number parsing at a gigabyte per second", Software: Practice and Experience 51, 2021). The end
//! of a number is found before and independently of its value, so that the next one can begin in
//! the meantime. In most files nearly all numbers have the same number of decimals, and then the
//! position of the point gives the rest.
//!
//! All other numbers are left to [`super::number`], which reads the same numbers slowly.

/// Returns a word with a byte in all eight places.
const fn all(byte: u8) -> u64 {
    u64::from_le_bytes([byte; 8])
}

/// A position of the decimal point.
#[derive(Clone, Copy, Debug)]
struct Point {
    /// Mask of the bytes behind the point, which stay in place when the point is taken out of the
    /// last eight bytes.
    kept: u64,
    /// The power of ten by which all digits are divided, for a number without and with a minus
    /// sign.
    divisors: [f64; 2],
}

/// Points by the number of digits behind them, up to 7; the last entry is for no point.
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

/// The index of the last row of [`POINTS`].
const NO_POINT: usize = 8;

/// The greatest number of digits that a double holds exactly; powers of ten are exact up to 1e22.
const MAX_DIGITS: usize = 15;

/// Larger magnitudes come from overflow, not from measurement: they would overflow when scaled in
/// `f32`.
pub(super) const MAX_MAGNITUDE: f64 = 1e30;

/// Returns the number of eight digits minus `b'0'` each, the first one lowest, so that missing
/// digits are zeros. `None` if they are not digits.
#[inline]
fn eight_digits(digits: u64) -> Option<u32> {
    // Digits are 0 to 9 now; for anything else the highest bit is set, perhaps by a carry from such
    // a byte.
    if (digits.wrapping_add(all(0x76)) | digits) & all(0x80) != 0 {
        return None;
    }
    // Combines neighbours to pairs, pairs to fours, and fours to all eight.
    let pairs = digits.wrapping_mul(10).wrapping_add(digits >> 8);
    let low = (pairs & 0x0000_00ff_0000_00ff).wrapping_mul(100 + (1_000_000 << 32));
    let high = ((pairs >> 16) & 0x0000_00ff_0000_00ff).wrapping_mul(1 + (10_000 << 32));
    Some((low.wrapping_add(high) >> 32) as u32)
}

/// Returns the last `count` (1 to 8) of eight bytes as digits for [`eight_digits`].
#[inline]
fn last_digits(word: u64, count: usize) -> u64 {
    let unused = 64_usize.wrapping_sub(8 * count);
    (word ^ all(b'0')) >> unused << unused
}

/// Reads any number between two offsets. `None` if there is none, or if it is too large to be a
/// measurement.
#[cold]
fn long_number(text: &[u8], start: usize, end: usize) -> Option<f64> {
    let value = fast_float2::parse::<f64, _>(text.get(start..end)?).ok()?;
    (value.abs() <= MAX_MAGNITUDE).then_some(value)
}

/// The digits of a number, their divisor, and the row of its point in [`POINTS`].
type Parts = (f64, f64, usize);

/// Reads a number between two offsets that has an optional minus sign and at most 15 digits, with
/// an optional point and at most 7 digits behind it. Its digits and the power of ten are exact, so
/// that their quotient is the double nearest to the number (W. Clinger, "How to read floating point
/// numbers accurately", 1990).
#[inline]
fn short_number(text: &[u8], start: usize, end: usize) -> Option<Parts> {
    let bytes: &[u8; 9] = text.get(end.checked_sub(9)?..end)?.first_chunk()?;
    let [_, last @ ..] = bytes;
    let (last, before) = (u64::from_le_bytes(*last), u64::from_le_bytes(*bytes.first_chunk()?));
    let length = end.wrapping_sub(start);
    let negative = *text.get(start)? == b'-';

    // The last point, as seen from the end: the highest byte that is zero after removing its bits.
    // No carry crosses bytes.
    let points = last ^ all(b'.');
    let points = !((points & all(0x7f)).wrapping_add(all(0x7f)) | points | all(0x7f));
    let decimals = (points.leading_zeros() / 8) as usize;
    let at = if decimals < length { decimals } else { NO_POINT };
    let &Point { kept, divisors } = POINTS.get(at)?;
    let has_point = usize::from(at != NO_POINT);
    // The digits before the point move up by one.
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

/// The number of decimals that most numbers of a file share. With it, the end of a number follows
/// from its point, and everything counted from the end is the same for all numbers.
#[derive(Clone, Copy, Debug)]
struct UsualDecimals {
    decimals: usize,
    point: Point,
    /// Mask of the byte of the point among the last eight.
    at: u64,
}

impl UsualDecimals {
    fn new(decimals: usize) -> Option<Self> {
        Some(Self { decimals, point: *POINTS.get(decimals)?, at: 0xff_u64 << 56 >> (8 * decimals) })
    }

    /// Reads a number as [`short_number`] does, of at most 8 digits and with a blank behind it.
    /// Returns its digits, their divisor and the number's end; `None` for any other number.
    #[inline]
    fn number(&self, text: &[u8], start: usize) -> Option<(f64, f64, usize)> {
        let word = u64::from_le_bytes(*text.get(start..)?.first_chunk()?);
        // Digits have the bit 0x10 set, a point does not. The first byte may be a sign.
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

/// A reader of lines of plain numbers.
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
    /// Returns `None` if the line contains anything else. The values in `row` are then invalid up
    /// to that point, and unchanged after it.
    pub(super) fn line(&mut self, text: &[u8], at: usize, row: &mut [f64]) -> Option<usize> {
        self.divisors.resize(row.len(), 1.0);
        let usual = UsualDecimals::new(self.decimals)?;
        let fewer = UsualDecimals::new(self.decimals.saturating_sub(1))?;
        let mut points = OtherPoints { decimals: self.decimals, ..OtherPoints::default() };
        let mut at = at;
        for (digits, divisor) in row.iter_mut().zip(&mut self.divisors) {
            if let Some((number, power, end)) = usual.number(text, at) {
                (*digits, *divisor) = (number, power);
                at = end + 1;
                continue;
            }
            (*digits, *divisor, at) = other_number(text, at, &fewer, &mut points)?;
        }
        let end = past_blanks(text, at)?;
        if !matches!(text.get(end), Some(b'\n' | b'\r')) {
            return None;
        }
        // If most numbers of a line that have decimals are unusual, they become the new usual.
        if 2 * points.numbers > row.len() - points.whole {
            self.decimals = points.decimals;
        }
        row.iter_mut().zip(&self.divisors).for_each(|(digits, divisor)| *digits /= divisor);
        Some(end)
    }
}

/// The points of the numbers in a line that are not the usual ones.
#[derive(Debug, Default)]
struct OtherPoints {
    /// The count of numbers with decimals, and the number of decimals of the last of them.
    numbers: usize,
    decimals: usize,
    /// The count of numbers without a point.
    whole: usize,
}

/// Reads a number that is not a usual one, after blanks; `fewer` has one decimal less. Returns its
/// digits, their divisor and the offset of the next number.
// Not inlined: the loop over the usual numbers is faster by a fifth without it.
#[inline(never)]
fn other_number(
    text: &[u8],
    at: usize,
    fewer: &UsualDecimals,
    points: &mut OtherPoints,
) -> Option<(f64, f64, usize)> {
    // Zeros of joints that do not turn are a quarter of some files.
    let signed = text.get(at..)?.first_chunk()?;
    let (sign, digit, length) = match *signed {
        [b'-', digit, b' ' | b'\t'] => (-1.0, digit, 3),
        [digit, b' ' | b'\t', _] => (1.0, digit, 2),
        _ => (1.0, b' ', 0),
    };
    if digit.is_ascii_digit() {
        points.whole += 1;
        return Some((f64::from(digit - b'0'), sign, at + length));
    }
    // Where zeros at the end are left out, a tenth of the numbers have one decimal less.
    if let Some((number, power, end)) = fewer.number(text, at) {
        points.numbers += 1;
        points.decimals = fewer.decimals;
        return Some((number, power, end + 1));
    }
    let at = past_blanks(text, at)?;
    let end = end_of_word(text, at)?;
    let next = past_blanks(text, end)?;
    let Some((number, power, point)) = short_number(text, at, end) else {
        return Some((long_number(text, at, end)?, 1.0, next));
    };
    if point == NO_POINT {
        points.whole += 1;
    } else {
        points.numbers += 1;
        points.decimals = point;
    }
    Some((number, power, next))
}

/// Returns the offset of the next byte that is neither a space nor a tab.
#[inline]
fn past_blanks(text: &[u8], mut at: usize) -> Option<usize> {
    while matches!(text.get(at)?, b' ' | b'\t') {
        at += 1;
    }
    Some(at)
}

/// Returns the offset of the first byte from `at` on that is a space or lower. `None` near the end
/// of the text.
#[inline]
fn end_of_word(text: &[u8], at: usize) -> Option<usize> {
    let (words, _) = text.get(at..at.checked_add(16)?)?.as_chunks::<8>();
    let &[first, second] = words else { return None };
    let (first, second) = (blanks(u64::from_le_bytes(first)), blanks(u64::from_le_bytes(second)));
    // Both words are evaluated without a branch, because it would be unpredictable.
    let in_second = if first == 0 { second.trailing_zeros() } else { 0 };
    match (first.trailing_zeros() + in_second) / 8 {
        16 => text.get(at..)?.iter().position(|b| *b <= b' ').map(|length| at + length),
        length => Some(at + length as usize),
    }
}

/// Sets the highest bit of the first byte that is a space or lower. Bits above it may be set by its
/// borrow.
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

    /// Reads one number by the slow path, if the text is one.
    fn slow(text: &str) -> Option<u64> {
        match scan(text.as_bytes(), 0, false) {
            Scan::Value { value, end, glued: false } if end == text.len() => Some(value.to_bits()),
            _ => None,
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2000))]

        #[test]
        fn short_number_equals_the_slow_path(
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
        fn short_number_reads_all_usual_numbers(
            before in "[-0-9. ]{17}",
            text in "-?([0-9]{1,15}|[0-9]{0,9}\\.[0-9]{1,6}|[0-9]{1,8}\\.)",
        ) {
            let all = format!("{before}{text}");
            let found = short(&all, before.len(), all.len());
            prop_assert_eq!(found.map(f64::to_bits), slow(&text));
        }

        #[test]
        fn usual_number_equals_the_slow_path(
            before in "[-0-9. ]{9}",
            text in "[-+]?[0-9]{0,9}[.,]?[0-9]{0,9}|[!-~]{1,12}",
            after in "[ \t][ -~]{10}",
            decimals in 0..8_usize,
        ) {
            let all = format!("{before}{text}{after}");
            let (start, end) = (before.len(), before.len() + text.len());
            let usual = UsualDecimals::new(decimals).unwrap();
            if let Some((digits, divisor, found)) = usual.number(all.as_bytes(), start) {
                prop_assert_eq!((found, Some((digits / divisor).to_bits())), (end, slow(&text)));
            }
        }

        #[test]
        fn usual_number_reads_numbers_of_its_shape(
            before in "[-0-9. ]{9}",
            whole in "-?[0-9]{1,4}",
            decimals in "[0-9]{1,4}",
            blank in "[ \t]",
        ) {
            let text = format!("{whole}.{decimals}");
            let all = format!("{before}{text}{blank}2.345678901");
            let found = UsualDecimals::new(decimals.len()).unwrap().number(all.as_bytes(), before.len());
            let expected = slow(&text).map(|value| (value, all.len() - 12));
            prop_assert_eq!(
                found.map(|(digits, divisor, end)| ((digits / divisor).to_bits(), end)),
                expected
            );
        }

        #[test]
        fn end_of_word_is_the_first_blank(
            word in "[!-~\u{80}-\u{ff}]{0,40}",
            blank in 0..=b' ',
            after: [u8; 16],
        ) {
            let text = [word.as_bytes(), &[blank], &after].concat();
            prop_assert_eq!(end_of_word(&text, 0), Some(word.len()));
        }

        #[test]
        fn lines_equal_their_words(
            words in prop::collection::vec("-?[0-9]{1,4}(\\.[0-9]{0,9})?|1e-7", 0..40),
            gap in "[ \t]{1,70}",
            indent in "[ \t]{0,3}",
        ) {
            let text = format!("{indent}{}\n{}", words.join(&gap), "\n".repeat(16));
            let mut row = vec![0.0; words.len()];
            let mut lines = Lines::default();
            // In the second pass the usual number of decimals is known.
            for _ in 0..2 {
                let end = lines.line(text.as_bytes(), 0, &mut row);
                prop_assert_eq!(end, text.find('\n'));
                prop_assert_eq!(
                    &row,
                    &words.iter().map(|word| word.parse::<f64>().unwrap()).collect::<Vec<_>>()
                );
            }
            prop_assert_eq!(
                Lines::default().line(text.as_bytes(), 0, &mut vec![0.0; words.len() + 1]),
                None
            );
        }
    }

    #[test]
    fn lines_with_anything_odd_are_refused() {
        let line = |text: &str, row: &mut [f64]| Lines::default().line(text.as_bytes(), 0, row);
        let padding = " ".repeat(16);
        for second in
            ["nan", "1.#IND", "1,5", "2-3", "2x", "# 2", "\0", "\x0b2", "1e40", "-", ".", "--2", ""]
        {
            let mut row = [7.0, 8.0];
            assert_eq!(line(&format!("1 {second}\n{padding}"), &mut row), None, "{second}");
            assert_eq!(row[1], 8.0, "{second}");
        }
        // Too many numbers, a comment, other white space, and the end of the text, where fewer than
        // sixteen bytes are left.
        for text in ["1 2 3\n", "1 2 # 3\n", "1 2\x0b\n", "1 2\0\n"] {
            assert_eq!(line(&format!("{text}{padding}"), &mut [7.0, 8.0]), None, "{text}");
        }
        assert_eq!(line("1 2\n", &mut [7.0, 8.0]), None);
    }
}
