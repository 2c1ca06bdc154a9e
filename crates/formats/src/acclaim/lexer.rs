//! Tokens and numbers of ASF and AMC files.

use crate::bvh::{Scan, scan};
use crate::error::Fault;
use crate::text::is_space;
use crate::warning::{Tally, WarningKind};
use segue_text::Message;

/// Returns whether a byte is white space of these files, which includes commas and parentheses.
#[inline]
pub(super) fn is_blank(b: u8) -> bool {
    is_space(b) || matches!(b, b',' | b'(' | b')')
}

/// The result of reading a number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Number {
    /// A number that ends before `end`; `glued` when the next one follows without a space.
    Value { value: f64, end: usize, glued: bool },
    /// `nan`, `inf` and the like.
    NotFinite { end: usize, glued: bool },
    /// The beginning of a number at the very end of the file.
    Cut,
    /// Anything else.
    None,
}

/// Returns the end of the token that starts at `at`. A `#` inside a token (`1.#IND`) is not a
/// comment.
pub(super) fn token_end(text: &[u8], at: usize) -> usize {
    let rest = text.get(at..).unwrap_or_default();
    rest.iter().position(|&b| is_blank(b)).map_or(text.len(), |length| at + length)
}

/// Returns the end of the line that contains `at`.
pub(super) fn line_end(text: &[u8], at: usize) -> usize {
    let rest = text.get(at..).unwrap_or_default();
    rest.iter().position(|b| matches!(b, b'\n' | b'\r')).map_or(text.len(), |length| at + length)
}

/// Skips white space, and comments from `#` to the end of the line.
#[inline]
pub(super) fn skip_blank(text: &[u8], mut at: usize) -> usize {
    while let Some(&b) = text.get(at) {
        if is_blank(b) {
            at += 1;
        } else if b == b'#' {
            at = line_end(text, at);
        } else {
            break;
        }
    }
    at
}

/// Skips white space and comments as [`skip_blank`] does, but stays on the line.
#[inline]
pub(super) fn skip_blank_in_line(text: &[u8], mut at: usize) -> usize {
    while let Some(&b) = text.get(at) {
        if matches!(b, b'\n' | b'\r') {
            break;
        } else if is_blank(b) {
            at += 1;
        } else if b == b'#' {
            at = line_end(text, at);
        } else {
            break;
        }
    }
    at
}

/// Reads the number at `at`, in any spelling.
pub(super) fn number(text: &[u8], at: usize) -> Number {
    let end = number_end(text, at);
    match scan(text.get(..end).unwrap_or_default(), at, false) {
        Scan::Value { value, end, glued } => Number::Value { value, end, glued },
        Scan::NotFinite { end, glued } => Number::NotFinite { end, glued },
        Scan::Cut if end == text.len() => Number::Cut,
        // Commas end tokens, so decimal commas do not occur here.
        Scan::Cut | Scan::Bad | Scan::OtherDecimalSign => Number::None,
    }
}

/// Returns the end of the token at `at`, or of the sign with which another number begins in it.
/// Looking no further keeps a long run of numbers without spaces linear.
fn number_end(text: &[u8], at: usize) -> usize {
    let mut before = b'+';
    for (index, &b) in text.iter().enumerate().skip(at) {
        if is_blank(b) {
            return index;
        }
        if matches!(b, b'+' | b'-') && !matches!(before, b'e' | b'E' | b'+' | b'-') {
            return index + 1;
        }
        before = b;
    }
    text.len()
}

/// Returns whether a token consists of digits only, as frame numbers do.
pub(super) fn is_digits(token: &[u8]) -> bool {
    !token.is_empty() && token.iter().all(u8::is_ascii_digit)
}

/// A position in a skeleton file, and the oddities up to there.
#[derive(Debug)]
pub(super) struct Lexer<'a> {
    pub(super) text: &'a [u8],
    pub(super) at: usize,
    pub(super) tally: Tally,
}

impl<'a> Lexer<'a> {
    pub(super) fn new(text: &'a [u8]) -> Self {
        Self { text, at: 0, tally: Tally::default() }
    }

    /// Returns the next token without consuming it. Empty at the end of the file.
    pub(super) fn peek(&mut self) -> &'a [u8] {
        self.at = skip_blank(self.text, self.at);
        self.here()
    }

    /// Returns the next token of this line without consuming it. Empty at the end of the line.
    pub(super) fn peek_in_line(&mut self) -> &'a [u8] {
        self.at = skip_blank_in_line(self.text, self.at);
        self.here()
    }

    fn here(&self) -> &'a [u8] {
        self.text.get(self.at..token_end(self.text, self.at)).unwrap_or_default()
    }

    /// Consumes and returns the next token.
    pub(super) fn take(&mut self) -> &'a [u8] {
        let token = self.peek();
        self.at += token.len();
        token
    }

    pub(super) fn skip_line(&mut self) {
        self.at = line_end(self.text, self.at);
    }

    /// Skips to the next line that begins with a colon, or to the end of the file.
    pub(super) fn skip_to_section(&mut self) {
        loop {
            self.skip_line();
            let rest = self.text.get(self.at..).unwrap_or_default();
            self.at += rest.iter().position(|&b| !is_space(b)).unwrap_or(rest.len());
            if matches!(self.text.get(self.at), None | Some(b':')) {
                return;
            }
        }
    }

    pub(super) fn number(&mut self) -> Result<f64, Fault> {
        self.at = skip_blank(self.text, self.at);
        match number(self.text, self.at) {
            Number::Value { value, end, glued } => {
                if glued {
                    self.tally.add(WarningKind::MissingSpaces, Some(end));
                }
                self.at = end;
                Ok(value)
            }
            Number::NotFinite { .. } | Number::Cut | Number::None => {
                Err(self.unexpected("a number"))
            }
        }
    }

    pub(super) fn three_numbers(&mut self) -> Result<[f64; 3], Fault> {
        Ok([self.number()?, self.number()?, self.number()?])
    }

    /// Returns an error at the next token.
    pub(super) fn unexpected(&mut self, expected: impl Into<Message>) -> Fault {
        let token = self.peek();
        Fault::at_token(self.at, token, expected)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tokens_end_at_commas_and_parentheses() {
        let mut lexer = Lexer::new(b"# a\n limits (-1.5,inf) # b\r(2 3)\n:end");
        for expected in ["limits", "-1.5", "inf", "2", "3", ":end", ""] {
            assert_eq!(lexer.take(), expected.as_bytes());
        }
        assert_eq!(lexer.unexpected("x").found.to_string(), "the end of the file");
    }

    #[test]
    fn skip_to_section_stops_at_a_colon_on_a_new_line() {
        let mut lexer = Lexer::new(b":documentation a :b\n c :d\n  :root\n");
        lexer.skip_to_section();
        assert_eq!(lexer.peek(), b":root");
        lexer.skip_to_section();
        assert_eq!(lexer.peek(), b"");
    }

    #[test]
    fn number_ends_at_commas_and_signs() {
        assert_eq!(number(b"1.5,2", 0), Number::Value { value: 1.5, end: 3, glued: false });
        assert_eq!(number(b"1.5-2)", 0), Number::Value { value: 1.5, end: 3, glued: true });
        assert_eq!(number(b"-1.#IND ", 0), Number::NotFinite { end: 7, glued: false });
        assert_eq!(
            (number(b"1e", 0), number(b"1e ", 0), number(b"rx", 0)),
            (Number::Cut, Number::None, Number::None)
        );
    }
}
