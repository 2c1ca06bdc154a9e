//! Reading of one number of a BVH file, in all spellings of people and programs.

use super::decimal::MAX_MAGNITUDE;
use crate::text::is_space;

/// The result of reading a number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Scan {
    /// A number that ends before `end`; `glued` when the next one follows without a space.
    Value { value: f64, end: usize, glued: bool },
    /// `nan`, `-nan(ind)`, `1.#IND`, `inf`, or a number out of range.
    NotFinite { end: usize, glued: bool },
    /// A decimal sign other than the one that the file has used so far.
    OtherDecimalSign,
    /// The beginning of a number at the very end of the file: it is truncated.
    Cut,
    /// Anything else.
    Bad,
}

/// Returns the end of the run of bytes without white space and braces that starts at `at`.
pub(super) fn token_end(text: &[u8], at: usize) -> usize {
    let rest = text.get(at..).unwrap_or_default();
    rest.iter()
        .position(|&b| is_space(b) || b == b'{' || b == b'}')
        .map_or(text.len(), |length| at + length)
}

/// Reads the number at `at`. With `commas`, numbers have a decimal comma, otherwise a point.
pub(crate) fn scan(text: &[u8], at: usize, commas: bool) -> Scan {
    let end = piece_end(text, at);
    let piece = text.get(at..end).unwrap_or_default();
    let glued = matches!(text.get(end), Some(b'+' | b'-'));
    if not_a_number(piece) {
        return Scan::NotFinite { end, glued };
    }
    let mut buffer = [0; 64];
    let digits = if has_decimal_comma(piece) {
        if !commas {
            return Scan::OtherDecimalSign;
        }
        let Some(copy) = buffer.get_mut(..piece.len()) else {
            return Scan::Bad;
        };
        copy.copy_from_slice(piece);
        copy.iter_mut().filter(|b| **b == b',').for_each(|b| *b = b'.');
        if not_a_number(copy) {
            return Scan::NotFinite { end, glued };
        }
        &*copy
    } else {
        piece
    };
    match fast_float2::parse::<f64, _>(digits) {
        Ok(_) if commas && !has_decimal_comma(piece) => Scan::OtherDecimalSign,
        Ok(value) if value.abs() <= MAX_MAGNITUDE => Scan::Value { value, end, glued },
        // The crate's own `nan` and `inf` end here as well.
        Ok(_) => Scan::NotFinite { end, glued },
        Err(_) if end == text.len() && is_cut(piece) => Scan::Cut,
        Err(_) => Scan::Bad,
    }
}

/// Returns the end of the number at `at`: of its token, or before a sign in it that does not belong
/// to an exponent. Looking no further keeps a long run of numbers without spaces linear.
fn piece_end(text: &[u8], at: usize) -> usize {
    let mut before = b'+';
    for (index, &b) in text.iter().enumerate().skip(at) {
        let splits = matches!(b, b'+' | b'-') && !matches!(before, b'e' | b'E' | b'+' | b'-');
        if splits || is_space(b) || b == b'{' || b == b'}' {
            return index;
        }
        before = b;
    }
    text.len()
}

fn without_sign(piece: &[u8]) -> &[u8] {
    piece.strip_prefix(b"-").or_else(|| piece.strip_prefix(b"+")).unwrap_or(piece)
}

/// Returns whether a piece is a spelling of NaN or infinity by C libraries: `nan`, `nan(ind)`,
/// `inf`, `infinity`, `1.#IND00`, `1.#QNAN`, `1.#INF`.
fn not_a_number(piece: &[u8]) -> bool {
    let starts = |text: &[u8], word: &[u8]| {
        text.get(..word.len()).is_some_and(|head| head.eq_ignore_ascii_case(word))
    };
    let word = without_sign(piece);
    if word.eq_ignore_ascii_case(b"inf")
        || word.eq_ignore_ascii_case(b"infinity")
        || word.eq_ignore_ascii_case(b"nan")
    {
        return true;
    }
    if starts(word, b"nan(") {
        return word.ends_with(b")");
    }
    word.strip_prefix(b"1.#").is_some_and(|kind| {
        [b"ind".as_slice(), b"inf", b"qnan", b"snan", b"nan"].iter().any(|w| starts(kind, w))
    })
}

/// Returns whether there is exactly one comma and no point, with digits around it. In `,5` and `1,`
/// the comma may as well separate numbers.
fn has_decimal_comma(piece: &[u8]) -> bool {
    let has_one_comma = piece.split(|b| *b == b',').count() == 2;
    let inside = without_sign(piece).first() != Some(&b',') && piece.last() != Some(&b',');
    has_one_comma && inside && !piece.contains(&b'.')
}

/// Returns whether bytes are the beginning of a number, but not yet one: `-`, `1e`, `1.5e-`, `.`.
fn is_cut(piece: &[u8]) -> bool {
    let body = without_sign(piece);
    let mantissa = match body {
        [head @ .., b'e' | b'E'] | [head @ .., b'e' | b'E', b'+' | b'-'] if !head.is_empty() => {
            head
        }
        _ => body,
    };
    mantissa.iter().all(|b| b.is_ascii_digit() || *b == b'.')
        && mantissa.split(|b| *b == b'.').count() <= 2
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(text: &str) -> f64 {
        match scan(text.as_bytes(), 0, false) {
            Scan::Value { value, end, glued: false } if end == text.len() => value,
            other => panic!("{text}: {other:?}"),
        }
    }

    #[test]
    fn scan_reads_every_usual_spelling() {
        let cases = [
            ("1", 1.0),
            ("+1", 1.0),
            ("-.5", -0.5),
            (".5", 0.5),
            ("5.", 5.0),
            ("1e-7", 1e-7),
            ("7.6e-016", 7.6e-16),
            ("1E+2", 100.0),
        ];
        for (text, expected) in cases {
            assert_eq!(value(text), expected, "{text}");
        }
        assert_eq!(value("4.9e-324"), f64::from_bits(1), "the smallest denormal");
        assert_eq!(value("1e-400"), 0.0);
    }

    #[test]
    fn scan_distinguishes_not_finite_from_bad() {
        for text in [
            "nan",
            "NaN",
            "-nan",
            "-nan(ind)",
            "nan(snan)",
            "1.#IND",
            "-1.#IND00",
            "1.#QNAN",
            "1.#INF",
            "inf",
            "-Infinity",
            "1e400",
            "1e31",
        ] {
            assert_eq!(
                scan(text.as_bytes(), 0, false),
                Scan::NotFinite { end: text.len(), glued: false },
                "{text}"
            );
        }
        for text in [
            "abc ", "1.2.3 ", "0x10 ", "1e ", "- ", "nanny ", "1.#XYZ ", "--1 ", "1,2,3 ", "1, ",
            ",5 ", "1.0,2 ",
        ] {
            assert_eq!(scan(text.as_bytes(), 0, false), Scan::Bad, "{text}");
        }
    }

    #[test]
    fn scan_splits_at_signs_outside_exponents() {
        assert_eq!(scan(b"0.0-7.5", 0, false), Scan::Value { value: 0.0, end: 3, glued: true });
        assert_eq!(scan(b"1e-3+2", 0, false), Scan::Value { value: 1e-3, end: 4, glued: true });
        assert_eq!(scan(b"-nan(ind)-2", 0, false), Scan::NotFinite { end: 9, glued: true });
        assert_eq!(scan(b"5}", 0, false), Scan::Value { value: 5.0, end: 1, glued: false });
    }

    #[test]
    fn scan_of_decimal_commas_depends_on_the_mode() {
        assert_eq!(scan(b"1,5", 0, false), Scan::OtherDecimalSign);
        assert_eq!(scan(b"1,5", 0, true), Scan::Value { value: 1.5, end: 3, glued: false });
        assert_eq!(
            scan(b"-1,5e-1-2,0", 0, true),
            Scan::Value { value: -0.15, end: 7, glued: true }
        );
        assert_eq!(scan(b"1.5", 0, true), Scan::OtherDecimalSign);
        assert_eq!(scan(b"1", 0, true), Scan::OtherDecimalSign);
        assert_eq!(scan(b"1,#IND", 0, true), Scan::NotFinite { end: 6, glued: false });
        assert_eq!(scan(&[b'1'; 200], 0, true), Scan::OtherDecimalSign);
    }

    #[test]
    fn scan_reports_truncation_at_the_end_only() {
        for text in ["-", "1e", "1.5e-", ".", "+."] {
            assert_eq!(scan(text.as_bytes(), 0, false), Scan::Cut, "{text}");
        }
        assert_eq!(scan(b"- ", 0, false), Scan::Bad);
        assert_eq!(scan(b"x", 0, false), Scan::Bad);
    }
}
