//! Text files as UTF-8, and places in them.

use std::borrow::Cow;

/// Returns the text of a file without byte order mark and without padding after its end; UTF-16 is
/// converted to UTF-8.
///
/// Bytes that are not UTF-8 are kept: only names may contain them, and [`name`] converts those.
pub(super) fn decode(bytes: &[u8]) -> Cow<'_, [u8]> {
    if let Some(rest) = bytes.strip_prefix(&[0xef, 0xbb, 0xbf]) {
        return Cow::Borrowed(without_padding(rest));
    }
    let utf16 = match bytes {
        [0xff, 0xfe, rest @ ..] => Some((rest, false)),
        [0xfe, 0xff, rest @ ..] => Some((rest, true)),
        // Without a mark, four bytes decide: ASCII text in UTF-16 has a NUL in every other one.
        [a, 0, b, 0, ..] if *a != 0 && *b != 0 => Some((bytes, false)),
        [0, a, 0, b, ..] if *a != 0 && *b != 0 => Some((bytes, true)),
        _ => None,
    };
    let Some((rest, big_endian)) = utf16 else {
        return Cow::Borrowed(without_padding(bytes));
    };
    let units = rest.chunks_exact(2).filter_map(|pair| {
        let pair: [u8; 2] = pair.try_into().ok()?;
        Some(if big_endian { u16::from_be_bytes(pair) } else { u16::from_le_bytes(pair) })
    });
    let text: String =
        char::decode_utf16(units).map(|unit| unit.unwrap_or(char::REPLACEMENT_CHARACTER)).collect();
    let length = without_padding(text.as_bytes()).len();
    let mut text = text.into_bytes();
    text.truncate(length);
    Cow::Owned(text)
}

/// Removes NUL bytes and the old end-of-file mark (Ctrl-Z) after the data, with the white space
/// between them.
fn without_padding(text: &[u8]) -> &[u8] {
    let is_padding = |b: &u8| matches!(b, 0 | 0x1a);
    let end = text.iter().rposition(|b| !is_padding(b) && !is_space(*b)).map_or(0, |last| last + 1);
    let (data, tail) = text.split_at(end);
    if tail.iter().any(is_padding) { data } else { text }
}

/// Returns whether a byte is white space, including line ends.
#[inline]
pub(super) fn is_space(b: u8) -> bool {
    matches!(b, b' ' | b'\t' | b'\n' | b'\r' | 0x0b | 0x0c)
}

/// Returns line and column (in characters) of a byte offset, both from 1.
pub(super) fn position(text: &[u8], at: usize) -> (usize, usize) {
    let before = &text[..at.min(text.len())];
    // CRLF is counted at its LF.
    let ends_line =
        |&index: &usize| text.get(index) == Some(&b'\n') || text.get(index + 1) != Some(&b'\n');
    let line = 1 + memchr::memchr2_iter(b'\n', b'\r', before).filter(ends_line).count();
    let start =
        memchr::memrchr2_iter(b'\n', b'\r', before).find(ends_line).map_or(0, |end| end + 1);
    // Continuation bytes of UTF-8 are not characters.
    let column = before[start..].iter().filter(|&&b| b & 0xc0 != 0x80).count() + 1;
    (line, column)
}

/// Returns a name as text, and whether it was UTF-8. Otherwise every byte is read as Latin-1, so
/// that nothing is lost.
pub(super) fn name(bytes: &[u8]) -> (String, bool) {
    match std::str::from_utf8(bytes) {
        Ok(name) => (name.to_owned(), true),
        Err(_) => (bytes.iter().map(|&b| char::from(b)).collect(), false),
    }
}

/// Returns a quotation from a file for a message: short, on one line, without control characters.
pub(super) fn short(bytes: &[u8]) -> String {
    const MAX_BYTES: usize = 40;
    let head = &bytes[..bytes.len().min(4 * MAX_BYTES)];
    let text = match std::str::from_utf8(head) {
        // The cut went through a character: none is longer than four bytes.
        Err(error) if head.len() < bytes.len() && error.valid_up_to() + 4 > head.len() => {
            name(&head[..error.valid_up_to()]).0
        }
        _ => name(head).0,
    };
    let mut short = String::new();
    for c in text.chars().take(MAX_BYTES) {
        if c.is_control() {
            short.extend(c.escape_default());
        } else {
            short.push(c);
        }
    }
    if text.chars().nth(MAX_BYTES).is_some() {
        short.push('…');
    }
    short
}

/// Returns [`short`] in quotation marks.
pub(super) fn quoted(bytes: &[u8]) -> String {
    format!("`{}`", short(bytes))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decode_of_every_encoding_gives_the_same_text() {
        let text = "HIERARCHY\nROOT Säule\n";
        let little: Vec<u8> = text.encode_utf16().flat_map(u16::to_le_bytes).collect();
        let big: Vec<u8> = text.encode_utf16().flat_map(u16::to_be_bytes).collect();
        let with = |mark: &[u8], body: &[u8]| [mark, body].concat();
        for bytes in [
            text.as_bytes().to_vec(),
            with(&[0xef, 0xbb, 0xbf], text.as_bytes()),
            with(&[0xff, 0xfe], &little),
            with(&[0xfe, 0xff], &big),
            little.clone(),
            big.clone(),
        ] {
            assert_eq!(decode(&bytes).as_ref(), text.as_bytes());
        }
    }

    #[test]
    fn decode_removes_padding_and_keeps_white_space() {
        assert_eq!(decode(b"1 2\n\0\0\n\0").as_ref(), b"1 2");
        assert_eq!(decode(b"1 2\n\x1a").as_ref(), b"1 2");
        assert_eq!(decode(b"1 2\n\n").as_ref(), b"1 2\n\n");
        assert_eq!(decode(b"\0\0\0").as_ref(), b"");
    }

    #[test]
    fn short_is_short_and_on_one_line() {
        assert_eq!(quoted(b"a\nb"), "`a\\nb`");
        assert_eq!(quoted(b"S\xe4ule"), "`Säule`");
        assert_eq!(quoted(&[b'x'; 500]).chars().count(), 43);
        assert_eq!(quoted("目".repeat(100).as_bytes()), format!("`{}…`", "目".repeat(40)));
    }
}
