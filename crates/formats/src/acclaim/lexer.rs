//! Tokens and numbers of ASF and AMC files.

use crate::bvh::{Scan, scan};
use crate::error::Fault;
use crate::text::is_space;
use crate::warning::{Tally, WarningKind};
use segue_text::Message;

/// White space of these files: commas and parentheses are some.
#[inline]
pub(super) fn is_blank(b: u8) -> bool {
    is_space(b) || matches!(b, b',' | b'(' | b')')
}

/// What stands where a number should.
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

/// Where the token that starts at `at` ends. A `#` inside of a token (`1.#IND`) is no comment.
pub(super) fn token_end(text: &[u8], at: usize) -> usize {
    let rest = text.get(at..).unwrap_or_default();
    rest.iter().position(|&b| is_blank(b)).map_or(text.len(), |length| at + length)
}

/// The end of the line that `at` is on.
pub(super) fn line_end(text: &[u8], at: usize) -> usize {
    let rest = text.get(at..).unwrap_or_default();
    rest.iter().position(|b| matches!(b, b'\n' | b'\r')).map_or(text.len(), |length| at + length)
}

/// Goes past white space, and past comments from `#` to the end of the line.
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

/// [`skip_blank`] that stays on the line.
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

/// The number at `at`, however it is spelled.
pub(super) fn number(text: &[u8], at: usize) -> Number {
    let end = number_end(text, at);
    match scan(text.get(..end).unwrap_or_default(), at, false) {
        Scan::Value { value, end, glued } => Number::Value { value, end, glued },
        Scan::NotFinite { end, glued } => Number::NotFinite { end, glued },
        Scan::Cut if end == text.len() => Number::Cut,
        // Commas end tokens, so that decimal commas never get here.
        Scan::Cut | Scan::Bad | Scan::OtherDecimalSign => Number::None,
    }
}

/// The end of the token at `at`, or the end of the sign with which another number begins in it: no
/// further, so that a long run of numbers without spaces takes no longer than one with.
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

/// Whether a token consists of digits only, as frame numbers do.
pub(super) fn is_digits(token: &[u8]) -> bool {
    !token.is_empty() && token.iter().all(u8::is_ascii_digit)
}

/// A place in a skeleton file, and what was odd up to there.
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

    /// The next token, which stays where it is. Empty at the end of the file.
    pub(super) fn peek(&mut self) -> &'a [u8] {
        self.at = skip_blank(self.text, self.at);
        self.here()
    }

    /// The next token of this line, which stays where it is. Empty at the end of the line.
    pub(super) fn peek_in_line(&mut self) -> &'a [u8] {
        self.at = skip_blank_in_line(self.text, self.at);
        self.here()
    }

    fn here(&self) -> &'a [u8] {
        self.text.get(self.at..token_end(self.text, self.at)).unwrap_or_default()
    }

    /// The next token, and goes past it.
    pub(super) fn take(&mut self) -> &'a [u8] {
        let token = self.peek();
        self.at += token.len();
        token
    }

    pub(super) fn skip_line(&mut self) {
        self.at = line_end(self.text, self.at);
    }

    /// Goes to the next line that begins with a colon, or to the end of the file.
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

    /// An error at the next token.
    pub(super) fn unexpected(&mut self, expected: impl Into<Message>) -> Fault {
        let token = self.peek();
        Fault::at_token(self.at, token, expected)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commas_and_parentheses_are_white_space() {
        let mut lexer = Lexer::new(b"# a\n limits (-1.5,inf) # b\r(2 3)\n:end");
        for expected in ["limits", "-1.5", "inf", "2", "3", ":end", ""] {
            assert_eq!(lexer.take(), expected.as_bytes());
        }
        assert_eq!(lexer.unexpected("x").found.to_string(), "the end of the file");
    }

    #[test]
    fn a_section_begins_with_a_colon_on_a_line_of_its_own() {
        let mut lexer = Lexer::new(b":documentation a :b\n c :d\n  :root\n");
        lexer.skip_to_section();
        assert_eq!(lexer.peek(), b":root");
        lexer.skip_to_section();
        assert_eq!(lexer.peek(), b"");
    }

    #[test]
    fn numbers_end_at_commas_and_signs() {
        assert_eq!(number(b"1.5,2", 0), Number::Value { value: 1.5, end: 3, glued: false });
        assert_eq!(number(b"1.5-2)", 0), Number::Value { value: 1.5, end: 3, glued: true });
        assert_eq!(number(b"-1.#IND ", 0), Number::NotFinite { end: 7, glued: false });
        assert_eq!(
            (number(b"1e", 0), number(b"1e ", 0), number(b"rx", 0)),
            (Number::Cut, Number::None, Number::None)
        );
    }
}
