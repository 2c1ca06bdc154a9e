//! Fast reading of lines of plain decimal numbers, which make up almost all of a motion file.
//!
//! Eight bytes are handled at a time in one 64-bit word, the first byte lowest, where a handful of
//! operations without a branch check that they are digits (compare D. Lemire, "Number parsing at a
//! gigabyte per second", Software: Practice and Experience 51, 2021). The end of a number is found
//! before and independently of its value, so that the next one can begin in the meantime. In most
//! files nearly all numbers have the same number of decimals, and then the position of the point
//! gives the rest. The values of a line are computed together.
//!
//! A line with anything but plain numbers is left to [`super::number`], which reads the same
//! numbers slowly.

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
    /// The power of ten by which all digits are divided.
    divisor: f64,
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
    Point { kept, divisor }
}

/// The index of the last row of [`POINTS`].
const NO_POINT: usize = 8;

/// The greatest number of digits that a double holds exactly; powers of ten are exact up to 1e22.
const MAX_DIGITS: usize = 15;

/// Larger magnitudes come from overflow, not from measurement: they would overflow when scaled in
/// `f32`.
pub(super) const MAX_MAGNITUDE: f64 = 1e30;

/// The bit of a minus sign: that of a double, and in [`Digits`] one that no digit has.
const MINUS: u64 = 1 << 63;

/// Masks of the last 1 to 7 bytes of a word, by their number; of all bytes for any other number.
const LAST_BYTES: [u64; 16] = {
    let mut masks = [!0; 16];
    let mut count = 1;
    while count < 8 {
        masks[count] = !(!0 >> (8 * count));
        count += 1;
    }
    masks
};

/// Up to eight digits, one in each byte, the last one in the highest, with zeros in place of
/// missing ones; and the sign.
#[derive(Clone, Copy, Debug, Default)]
struct Digits(u64);

impl Digits {
    /// Returns the last `count` of eight characters, all of them from 8 on. `None` if they are not
    /// digits; where `count` is 0, all of them must be.
    #[inline]
    fn last(word: u64, count: usize) -> Option<Self> {
        let digits = (word ^ all(b'0')) & LAST_BYTES[count & 15];
        // Digits are 0 to 9 now; for anything else the highest bit is set, perhaps by a carry from
        // such a byte.
        let others = (digits.wrapping_add(all(0x76)) | digits) & all(0x80);
        (others == 0).then_some(Self(digits))
    }

    /// Returns digits without a sign with that of a number.
    #[inline]
    fn with_sign(self, negative: bool) -> Self {
        Self(self.0 | if negative { MINUS } else { 0 })
    }

    /// Returns the digits with one more zero behind them, if there is room for it.
    fn with_zero(self) -> Option<Self> {
        let sign = self.0 & MINUS;
        let digits = self.0 ^ sign;
        (digits as u8 == 0).then_some(Self(digits >> 8 | sign))
    }

    /// Returns the number that the digits are, without their sign.
    // Only operations that processors have for several 64-bit integers at once, so that the loop
    // over a line is vectorised: shifts, sums and a product of 32 bits.
    #[inline]
    fn magnitude(self) -> u64 {
        let digits = self.0 & !MINUS;
        // Neighbours become pairs, pairs fours, and fours all eight.
        let pairs = ((digits << 3) + (digits << 1) + (digits >> 8)) & 0x00ff_00ff_00ff_00ff;
        let fours =
            ((pairs << 6) + (pairs << 5) + (pairs << 2) + (pairs >> 16)) & 0x0000_ffff_0000_ffff;
        (fours & 0xffff) * 10_000 + (fours >> 32)
    }

    /// Returns the number, divided by a power of ten.
    #[inline]
    fn over(self, divisor: f64) -> f64 {
        self.quotient(self.magnitude(), divisor)
    }

    /// Returns the number of these eight digits and of the `first` ones before them, at most
    /// [`MAX_DIGITS`] in all, divided by a power of ten.
    fn after(self, first: Self, divisor: f64) -> f64 {
        self.quotient(first.magnitude() * 100_000_000 + self.magnitude(), divisor)
    }

    /// Returns a number below 2⁵², divided by a power of ten, with the sign of these digits.
    #[inline]
    fn quotient(self, magnitude: u64, divisor: f64) -> f64 {
        // The mantissa of 2⁵² is zero, and its last bit is worth 1.
        const MANTISSA: f64 = 4_503_599_627_370_496.0;
        let number = f64::from_bits(MANTISSA.to_bits() | magnitude) - MANTISSA;
        f64::from_bits((number / divisor).to_bits() | self.0 & MINUS)
    }
}

/// Reads any number between two offsets. `None` if there is none, or if it is too large to be a
/// measurement.
#[cold]
fn long_number(text: &[u8], start: usize, end: usize) -> Option<f64> {
    let value = fast_float2::parse::<f64, _>(text.get(start..end)?).ok()?;
    (value.abs() <= MAX_MAGNITUDE).then_some(value)
}

/// Reads a number between two offsets that has an optional minus sign and at most 15 digits, with
/// an optional point and at most 7 digits behind it. Its digits and the power of ten are exact, so
/// that their quotient is the double nearest to the number (W. Clinger, "How to read floating point
/// numbers accurately", 1990). Returns it and the row of its point in [`POINTS`].
#[inline]
fn short_number(text: &[u8], start: usize, end: usize) -> Option<(f64, usize)> {
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
    let &Point { kept, divisor } = POINTS.get(at)?;
    let has_point = usize::from(at != NO_POINT);
    // The digits before the point move up by one.
    let digits = last & kept | before & !kept;

    let count = length.wrapping_sub(usize::from(negative)).wrapping_sub(has_point);
    if let 1..=8 = count {
        return Some((Digits::last(digits, count)?.with_sign(negative).over(divisor), at));
    }
    if !(9..=MAX_DIGITS).contains(&count) {
        return None;
    }
    let end = end.wrapping_sub(8 + has_point);
    let first: &[u8; 8] = text.get(end.checked_sub(8)?..end)?.first_chunk()?;
    let first = Digits::last(u64::from_le_bytes(*first), count - 8)?;
    Some((Digits::last(digits, 8)?.with_sign(negative).after(first, divisor), at))
}

/// The number of bytes before a number that are read with it.
const BEFORE: usize = 8;

/// The number of decimals that most numbers of a file share. With it, the end of a number follows
/// from its point, and everything counted from the end is the same for all numbers.
#[derive(Clone, Copy, Debug)]
struct UsualDecimals {
    decimals: usize,
    point: Point,
    /// Mask of the byte of the point among the last eight.
    point_mask: u64,
}

impl UsualDecimals {
    fn new(decimals: usize) -> Option<Self> {
        let point_mask = 0xff_u64 << 56 >> (8 * decimals);
        Some(Self { decimals, point: *POINTS.get(decimals)?, point_mask })
    }

    /// Reads a number with the usual decimals and a blank behind it, [`BEFORE`] bytes into the
    /// text. Returns it and the rest of the text, from [`BEFORE`] bytes before the next number on;
    /// `None` for any other number.
    #[inline]
    fn number<'t>(&self, text: &'t [u8]) -> Option<(Number, &'t [u8])> {
        // All bytes that matter are within these, so that their places need no further checks.
        let bytes: &[u8; 26] = text.first_chunk()?;
        let word = u64::from_le_bytes(*bytes[BEFORE..].first_chunk()?);
        // Digits have the bit 0x10 set, a point does not. The first byte may be a sign.
        let whole = ((!word & (all(0x10) << 8)).trailing_zeros() / 8) as usize;
        // The next number is that near, too; its place is known as soon as `whole` is.
        let after: &[u8; 18] = bytes[self.decimals & 7..].first_chunk()?;
        let [before @ .., _, _]: &[u8; 10] = after[whole..].first_chunk()?;
        let [_, last @ .., blank]: &[u8; 10] = after[whole..].first_chunk()?;
        let (last, before) = (u64::from_le_bytes(*last), u64::from_le_bytes(*before));
        if (last ^ all(b'.')) & self.point_mask != 0 || !matches!(blank, b' ' | b'\t') {
            return None;
        }
        let negative = word as u8 == b'-';
        let count = whole + self.decimals - usize::from(negative);
        let last = last & self.point.kept | before & !self.point.kept;
        let digits = Digits::last(last, count)?.with_sign(negative);
        let next = &text[(self.decimals & 7) + 2..][whole..];
        if count <= 8 {
            return Some((Number::Digits(digits), next));
        }
        let word = if negative { word >> 8 } else { word };
        Some((Number::Value(self.longer(digits, word, count)?), next))
    }

    /// Returns the value of a number of `count` digits, 9 to 15: `last` holds its sign and the last
    /// eight, and `word` begins with the others.
    // Not inlined, as other numbers are not.
    #[inline(never)]
    fn longer(&self, last: Digits, word: u64, count: usize) -> Option<f64> {
        let first = Digits::last(word << (8 * (16 - count)), count - 8)?;
        Some(last.after(first, self.point.divisor))
    }
}

/// A reader of lines of plain numbers.
#[derive(Debug, Default)]
pub(super) struct Lines {
    /// The digits of each number, to be divided by the power of ten of the usual decimals. The
    /// divisions are done together, because one alone takes as long as the rest of reading a
    /// number.
    digits: Vec<Digits>,
    /// The column and the value of each number that is not among `digits`.
    others: Vec<(usize, f64)>,
    /// The usual number of digits after the decimal point in the lines before.
    decimals: usize,
}

impl Lines {
    /// Reads a line of `row.len()` plain numbers with blanks between them into `row`, and returns
    /// the offset of the line's end.
    ///
    /// Returns `None` and leaves the row as it is if the line contains anything else, or is at the
    /// very beginning or end of the text.
    pub(super) fn line(&mut self, text: &[u8], at: usize, row: &mut [f64]) -> Option<usize> {
        self.digits.resize(row.len(), Digits::default());
        self.others.clear();
        let usual = UsualDecimals::new(self.decimals)?;
        // Without decimals these are the usual ones, by which a number has been refused already.
        let fewer = UsualDecimals::new(self.decimals.saturating_sub(1))?;
        let mut points = OtherPoints { decimals: self.decimals, ..OtherPoints::default() };
        let mut rest = text.get(at.checked_sub(BEFORE)?..)?;
        for (column, place) in self.digits.iter_mut().enumerate() {
            let (number, next) = usual
                .number(rest)
                .or_else(|| one_digit(rest, self.decimals, &mut points))
                .or_else(|| other_number(rest, &fewer, &mut points))?;
            match number {
                Number::Digits(digits) => *place = digits,
                Number::Value(value) => self.others.push((column, value)),
            }
            rest = next;
        }
        let end = past_blanks(text, text.len() - rest.len() + BEFORE)?;
        if !matches!(text.get(end), Some(b'\n' | b'\r')) {
            return None;
        }
        // If most numbers of a line that have decimals are unusual, they become the new usual.
        if 2 * points.numbers > row.len() - points.whole {
            self.decimals = points.decimals;
        }
        let divisor = usual.point.divisor;
        row.iter_mut().zip(&self.digits).for_each(|(value, digits)| *value = digits.over(divisor));
        for &(column, value) in &self.others {
            if let Some(place) = row.get_mut(column) {
                *place = value;
            }
        }
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

/// A number of a line.
#[derive(Clone, Copy, Debug)]
enum Number {
    /// Digits to be divided by the power of ten of the decimals that are looked for.
    Digits(Digits),
    Value(f64),
}

/// Reads one digit with a blank behind it, [`BEFORE`] bytes into the text: zeros of joints that do
/// not turn are a quarter of some files. Returns it with as many zeros as `decimals` behind it, and
/// the rest of the text, from [`BEFORE`] bytes before the next number on.
#[inline]
fn one_digit<'t>(
    text: &'t [u8],
    decimals: usize,
    points: &mut OtherPoints,
) -> Option<(Number, &'t [u8])> {
    let bytes: &[u8; BEFORE + 3] = text.first_chunk()?;
    let &[.., first, second, third] = bytes;
    let negative = first == b'-';
    let (digit, blank) = if negative { (second, third) } else { (first, second) };
    if !digit.is_ascii_digit() || !matches!(blank, b' ' | b'\t') {
        return None;
    }
    points.whole += 1;
    let digits = Digits(u64::from(digit - b'0') << 56 >> (8 * decimals)).with_sign(negative);
    Some((Number::Digits(digits), &text[2 + usize::from(negative)..]))
}

/// Reads a number that is not a usual one, after blanks, [`BEFORE`] bytes into the text; `fewer`
/// has one decimal less. Returns it and the rest of the text, from [`BEFORE`] bytes before the next
/// number on.
// Not inlined: the loop over the usual numbers is faster by a fifth without it.
#[inline(never)]
fn other_number<'t>(
    text: &'t [u8],
    fewer: &UsualDecimals,
    points: &mut OtherPoints,
) -> Option<(Number, &'t [u8])> {
    // Where zeros at the end are left out, a tenth of the numbers have one decimal less.
    if let Some((Number::Digits(digits), next)) = fewer.number(text)
        && let Some(digits) = digits.with_zero()
    {
        points.numbers += 1;
        points.decimals = fewer.decimals;
        return Some((Number::Digits(digits), next));
    }
    let start = past_blanks(text, BEFORE)?;
    let end = end_of_word(text, start)?;
    let next = text.get(past_blanks(text, end)? - BEFORE..)?;
    let Some((number, point)) = short_number(text, start, end) else {
        return Some((Number::Value(long_number(text, start, end)?), next));
    };
    if point == NO_POINT {
        points.whole += 1;
    } else {
        points.numbers += 1;
        points.decimals = point;
    }
    Some((Number::Value(number), next))
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
        short_number(text.as_bytes(), start, end).map(|(value, _)| value)
    }

    /// Returns the bits of a number.
    fn value(usual: &UsualDecimals, number: Number) -> u64 {
        match number {
            Number::Digits(digits) => digits.over(usual.point.divisor).to_bits(),
            Number::Value(value) => value.to_bits(),
        }
    }

    /// Reads a line with other text around it, and returns the offset of its end.
    fn line(lines: &mut Lines, text: &str, row: &mut [f64]) -> Option<usize> {
        let around = " ".repeat(16);
        let end = lines.line(format!("{around}{text}{around}").as_bytes(), around.len(), row)?;
        Some(end - around.len())
    }

    fn bits(row: &[f64]) -> Vec<u64> {
        row.iter().map(|value| value.to_bits()).collect()
    }

    fn bits_of_words(words: &[String]) -> Vec<u64> {
        words.iter().map(|word| word.parse::<f64>().expect("a number").to_bits()).collect()
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
            after in "[ \t][ -~]{18}",
            decimals in 0..8_usize,
        ) {
            let all = format!("{before}{text}{after}");
            let (start, end) = (before.len(), before.len() + text.len());
            let usual = UsualDecimals::new(decimals).unwrap();
            if let Some((number, next)) = usual.number(&all.as_bytes()[start - BEFORE..]) {
                let found = all.len() - next.len() + BEFORE - 1;
                prop_assert_eq!((found, Some(value(&usual, number))), (end, slow(&text)));
            }
        }

        #[test]
        fn usual_number_of_any_bytes_equals_the_slow_path(
            bytes in prop::collection::vec(
                prop_oneof![4 => b'0'..=b'9', 1 => Just(b'.'), 1 => Just(b' '), 1 => any::<u8>()],
                0..30,
            ),
            decimals in 0..8_usize,
        ) {
            let usual = UsualDecimals::new(decimals).unwrap();
            if let Some((number, next)) = usual.number(&bytes) {
                let word = &bytes[BEFORE..bytes.len() - next.len() + BEFORE - 1];
                let word = std::str::from_utf8(word).unwrap();
                prop_assert_eq!(Some(value(&usual, number)), slow(word));
            }
        }

        #[test]
        fn usual_number_reads_numbers_of_its_shape(
            before in "[-0-9. ]{8}",
            whole in "-?[0-9]{1,7}|[0-9]{8}",
            decimals in "[0-9]{1,7}",
            blank in "[ \t]",
        ) {
            let text = format!("{whole}.{decimals}");
            let all = format!("{before}{text}{blank}2.34567890123456789");
            let usual = UsualDecimals::new(decimals.len()).unwrap();
            let found = usual.number(all.as_bytes());
            let found = found.map(|(number, next)| (value(&usual, number), all.len() - next.len()));
            prop_assert_eq!(found, slow(&text).map(|value| (value, text.len() + 1)));
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
            gap in "[ \t]|[ \t]{1,70}",
            indent in "[ \t]{0,3}",
        ) {
            let text = format!("{indent}{}\n", words.join(&gap));
            let mut row = vec![0.0; words.len()];
            let mut lines = Lines::default();
            // In the second pass the usual number of decimals is known.
            for _ in 0..2 {
                prop_assert_eq!(line(&mut lines, &text, &mut row), text.find('\n'));
                prop_assert_eq!(bits(&row), bits_of_words(&words));
            }
            let row = &mut vec![0.0; words.len() + 1];
            prop_assert_eq!(line(&mut Lines::default(), &text, row), None);
        }

        #[test]
        fn lines_without_zeros_at_the_end_equal_their_words(
            values in prop::collection::vec(-99_999_999..=99_999_999_i32, 40),
            decimals in 1..8_i32,
        ) {
            // Every fourth is rounded, so that one decimal less is frequent.
            let value = |(index, &value): (usize, &i32)| {
                let rounded = if index % 4 == 0 { value / 10 * 10 } else { value };
                (f64::from(rounded) / 10_f64.powi(decimals)).to_string()
            };
            let words: Vec<String> = values.iter().enumerate().map(value).collect();
            let text = format!("{}\n", words.join(" "));
            let (mut lines, mut row) = (Lines::default(), vec![0.0; words.len()]);
            for _ in 0..2 {
                prop_assert_eq!(line(&mut lines, &text, &mut row), text.find('\n'));
                prop_assert_eq!(bits(&row), bits_of_words(&words));
            }
        }
    }

    #[test]
    fn lines_at_the_ends_of_the_text_are_refused_or_read() {
        let mut row = [7.0, 8.0];
        assert_eq!(Lines::default().line(b"1.5 2.5\n", 0, &mut row), None);
        assert_eq!(Lines::default().line(b"        1.5 2.5\n", 8, &mut row), None);
        assert_eq!(row, [7.0, 8.0]);
        // Single digits need no bytes behind them.
        assert_eq!(Lines::default().line(b"        1 -2 \n", 8, &mut row), Some(13));
        assert_eq!(row, [1.0, -2.0]);
    }

    #[test]
    fn lines_with_anything_odd_are_refused() {
        let line = |text: &str, row: &mut [f64]| line(&mut Lines::default(), text, row);
        for second in
            ["nan", "1.#IND", "1,5", "2-3", "2x", "# 2", "\0", "\x0b2", "1e40", "-", ".", "--2", ""]
        {
            let mut row = [7.0, 8.0];
            assert_eq!(line(&format!("1 {second}\n"), &mut row), None, "{second}");
            assert_eq!(row, [7.0, 8.0], "{second}");
        }
        // Too many numbers, a comment, and other white space.
        for text in ["1 2 3\n", "1 2 # 3\n", "1 2\x0b\n", "1 2\0\n"] {
            assert_eq!(line(text, &mut [7.0, 8.0]), None, "{text}");
        }
    }
}
