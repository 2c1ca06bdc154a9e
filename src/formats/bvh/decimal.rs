//! Lines of plain decimal numbers, fast: what almost all of a motion file is.
//!
//! Eight bytes at a time in one 64-bit word, the first one lowest: whether they are digits, and what number they make, takes a handful of
//! operations without a branch (D. Lemire, "Number parsing at a gigabyte per second", Software: Practice and Experience 51, 2021; the search for
//! blanks after G. Langdale and D. Lemire, "Parsing gigabytes of JSON per second", VLDB Journal 28, 2019). Where the numbers start and end is
//! found first, so that no number waits for the length of the one before.
//!
//! Whatever is not plain is left to [`super::number`], which reads the same numbers slowly.

/// A byte in all places of a word.
const fn all(byte: u8) -> u64 {
    u64::from_le_bytes([byte; 8])
}

/// Powers of ten for up to 7 digits behind the point.
const TENS: [f64; 8] = [1.0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7];

/// Larger magnitudes are overflows, not measures: they would not survive being scaled in `f32`.
pub(super) const LARGEST: f64 = 1e30;

/// Any number between two offsets. `None` where there is none, or one too large to be a measure.
#[cold]
fn long_number(text: &[u8], start: usize, end: usize) -> Option<f64> {
    let value = fast_float2::parse::<f64, _>(text.get(start..end)?).ok()?;
    (value.abs() <= LARGEST).then_some(value)
}

/// The place of the point in a number of at most 8 digits.
#[derive(Clone, Copy, Debug)]
struct Point {
    /// Digits behind it.
    decimals: usize,
    /// 1, or 0 where there is no point.
    length: usize,
    /// What stays where it is when the point is taken out of the last eight bytes: those behind it.
    kept: u64,
    /// The power of ten that all digits are to be divided by.
    divisor: f64,
}

impl Default for Point {
    fn default() -> Self {
        Self {
            decimals: 0,
            length: 0,
            kept: !0,
            divisor: 1.0,
        }
    }
}

impl Point {
    /// The last point in the last eight bytes of a number of so many.
    fn find(last: u64, length: usize) -> Self {
        let point = last ^ all(b'.');
        let points = !((point & all(0x7f)).wrapping_add(all(0x7f)) | point) & all(0x80);
        let decimals = (points.leading_zeros() / 8) as usize;
        match TENS.get(decimals) {
            Some(&divisor) if decimals < length => Self {
                decimals,
                length: 1,
                // Two shifts, since one by 64 is none.
                kept: !0 << 8 << (56 - 8 * decimals),
                divisor,
            },
            _ => Self::default(),
        }
    }
}

/// A number between two offsets that is made of a minus sign or none and at most 8 digits, among them perhaps a point: all of its digits, to be
/// divided by the divisor of `point`. Both are exact, so that the quotient is the double next to the number (W. Clinger, "How to read floating
/// point numbers accurately", 1990). `point` comes as that of the number before, since most files write all numbers alike.
#[inline]
fn short_number(text: &[u8], start: usize, end: usize, point: &mut Point) -> Option<f64> {
    let bytes: &[u8; 9] = text.get(end.checked_sub(9)?..end)?.first_chunk()?;
    let [_, last @ ..] = bytes;
    let (last, before) = (u64::from_le_bytes(*last), u64::from_le_bytes(*bytes.first_chunk()?));
    let length = end.wrapping_sub(start);
    let negative = usize::from(*text.get(start)? == b'-');

    if point.length == 0 || length <= point.decimals || bytes.get(8 - point.decimals) != Some(&b'.') {
        *point = Point::find(last, length);
    }
    // What is before the point moves up by one.
    let digits = last & point.kept | before & !point.kept;

    let count = length.wrapping_sub(negative).wrapping_sub(point.length);
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
    let digits = f64::from((low.wrapping_add(high) >> 32) as u32);
    Some(f64::from_bits(digits.to_bits() | (negative as u64) << 63))
}

/// Reads lines of plain numbers.
#[derive(Debug, Default)]
pub(super) struct Lines {
    /// Where the numbers of a line start and end, one after the other.
    bounds: Vec<usize>,
    /// What the digits of each number are to be divided by: all at once, since one division takes as long as the rest of a number.
    divisors: Vec<f64>,
    /// That of the last number.
    point: Point,
}

impl Lines {
    /// Reads a line of `row.len()` plain numbers with blanks between them into `row`, and returns the offset of the line's end.
    ///
    /// `None` when there is anything else in it: what stands in `row` for the numbers before that is then of no use, and the rest is as it was.
    pub(super) fn line(&mut self, text: &[u8], at: usize, row: &mut [f64]) -> Option<usize> {
        let rest = text.get(at..)?;
        let length = memchr::memchr2(b'\n', b'\r', rest)?;
        let line = rest.get(..length)?;
        // Counted rather than looked for, since that makes vectors.
        if line.iter().filter(|&&b| b < b' ' && b != b'\t').count() > 0 {
            return None;
        }
        self.find(line, at, 2 * row.len());
        if self.bounds.len() != 2 * row.len() {
            return None;
        }
        self.divisors.resize(row.len(), 1.0);
        let (bounds, _) = self.bounds.as_chunks();
        let mut point = self.point;
        for ((digits, divisor), &[start, end]) in row.iter_mut().zip(&mut self.divisors).zip(bounds) {
            (*digits, *divisor) = match short_number(text, start, end, &mut point) {
                Some(digits) => (digits, point.divisor),
                None => (long_number(text, start, end)?, 1.0),
            };
        }
        self.point = point;
        row.iter_mut().zip(&self.divisors).for_each(|(digits, divisor)| *digits /= divisor);
        Some(at + length)
    }

    /// Finds where blanks and other bytes meet, and stops soon after there are more than `most` of these. `at` is where the line starts.
    fn find(&mut self, line: &[u8], at: usize, most: usize) {
        self.bounds.clear();
        // Whether the byte before the block is a blank.
        let mut blank_before = 1;
        let (blocks, rest) = line.as_chunks::<64>();
        let mut last = [b' '; 64];
        if let Some(head) = last.get_mut(..rest.len()) {
            head.copy_from_slice(rest);
        }
        for (block, at) in blocks.iter().chain(std::iter::once(&last)).zip((at..).step_by(64)) {
            let blanks = blanks(block);
            let mut bounds = blanks ^ (blanks << 1 | blank_before);
            blank_before = blanks >> 63;
            self.bounds.reserve(64);
            while bounds != 0 {
                self.bounds.push(at + bounds.trailing_zeros() as usize);
                bounds &= bounds - 1;
            }
            if self.bounds.len() > most {
                break;
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

    fn short(text: &str, start: usize, end: usize, mut point: Point) -> Option<f64> {
        let digits = short_number(text.as_bytes(), start, end, &mut point)?;
        Some(digits / point.divisor)
    }

    /// Where the point of any number before may have been.
    fn any_point() -> impl Strategy<Value = Point> {
        "0000(0000|[0-9]{0,7}\\.[0-9]{0,7})".prop_map(|text| Point::find(word(&format!("0000{text}")), text.len()))
    }

    /// The last eight bytes.
    fn word(text: &str) -> u64 {
        u64::from_le_bytes(*text.as_bytes().last_chunk().unwrap())
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
            point in any_point(),
        ) {
            let all = format!("{before}{text}{after}");
            let (start, end) = (before.len(), before.len() + text.len());
            let found = short(&all, start, end, point).or_else(|| long_number(all.as_bytes(), start, end));
            prop_assert_eq!(found.map(f64::to_bits), slow(&text));
        }

        #[test]
        fn usual_numbers_are_short(before in "[-0-9. ]{10}", text in "-?([0-9]{1,8}|[0-9]{0,4}\\.[0-9]{1,4}|[0-9]{0,2}\\.[0-9]{6}|[0-9]{1,8}\\.)", point in any_point()) {
            let all = format!("{before}{text}");
            let found = short(&all, before.len(), all.len(), point);
            prop_assert_eq!(found.map(f64::to_bits), slow(&text));
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
            let end = Lines::default().line(text.as_bytes(), 0, &mut row);
            prop_assert_eq!(end, text.find('\n'));
            prop_assert_eq!(row, words.iter().map(|word| word.parse::<f64>().unwrap()).collect::<Vec<_>>());
            prop_assert_eq!(Lines::default().line(text.as_bytes(), 0, &mut vec![0.0; words.len() + 1]), None);
        }
    }

    #[test]
    fn what_is_odd_is_left_to_the_slow_way() {
        for line in [
            "1 2", "1 2 3", "1 nan", "1 1.#IND", "1 1,5", "1-2", "1 2x", "1 # 2", "1 \0", "1\x0b2", "1 1e40", "1 -", "1 .", "1 --2",
        ] {
            let text = format!("{line}{}", if line == "1 2" { "" } else { "\n         " });
            let mut row = [7.0, 8.0];
            assert_eq!(Lines::default().line(text.as_bytes(), 0, &mut row), None, "{line}");
            assert_eq!(row[1], 8.0, "{line}");
        }
    }
}
