//! Tokens of the HIERARCHY section of a BVH file.

use super::number::{Scan, scan, token_end};
use crate::error::Fault;
use crate::text::is_space;
use crate::warning::{Tally, WarningKind};
use segue_text::Message;

/// The reason why reading stopped before the end.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Stop {
    /// The file cannot be read.
    Fault(Fault),
    /// A number has another decimal sign than those before it; the fault says so.
    OtherDecimalSign(Fault),
    /// The caller asked to stop.
    Cancelled,
}

impl From<Fault> for Stop {
    fn from(fault: Fault) -> Self {
        Self::Fault(fault)
    }
}

/// A place in a file, and the oddities up to there. It borrows the bytes: only names are copied.
#[derive(Debug)]
pub(super) struct Lexer<'a> {
    pub(super) text: &'a [u8],
    pub(super) at: usize,
    /// Numbers have decimal commas.
    pub(super) commas: bool,
    pub(super) tally: Tally,
}

impl<'a> Lexer<'a> {
    pub(super) fn new(text: &'a [u8], commas: bool) -> Self {
        Self { text, at: 0, commas, tally: Tally::default() }
    }

    /// Skips white space, and comments: `#` and `//` to the end of the line.
    pub(super) fn skip_blank(&mut self) {
        while let Some(&b) = self.text.get(self.at) {
            if is_space(b) {
                self.at += 1;
            } else if self.at_comment() {
                self.at = self.line_end();
            } else {
                break;
            }
        }
    }

    pub(super) fn at_comment(&self) -> bool {
        let rest = self.text.get(self.at..).unwrap_or_default();
        matches!(rest, [b'#', ..] | [b'/', b'/', ..])
    }

    /// Returns the offset of the next line end, or of the end of the file.
    pub(super) fn line_end(&self) -> usize {
        let rest = self.text.get(self.at..).unwrap_or_default();
        rest.iter()
            .position(|b| matches!(b, b'\n' | b'\r'))
            .map_or(self.text.len(), |length| self.at + length)
    }

    /// Returns the next token without consuming it. A brace is a token. Empty at the end of the
    /// file.
    pub(super) fn peek(&mut self) -> &'a [u8] {
        self.skip_blank();
        let end = match self.text.get(self.at) {
            Some(b'{' | b'}') => self.at + 1,
            _ => token_end(self.text, self.at),
        };
        self.text.get(self.at..end).unwrap_or_default()
    }

    /// Returns the rest of the line up to an opening brace, without surrounding white space. The
    /// brace or line end is not consumed.
    pub(super) fn rest_of_line(&mut self) -> &'a [u8] {
        let rest = self.text.get(self.at..).unwrap_or_default();
        // The brace and the line end are searched together: a whole file may be one line.
        let line = rest
            .iter()
            .position(|b| matches!(b, b'{' | b'\n' | b'\r'))
            .map_or(rest, |end| &rest[..end]);
        self.at += line.len();
        let start = line.iter().position(|b| !is_space(*b)).unwrap_or(line.len());
        let end = line.iter().rposition(|b| !is_space(*b)).map_or(start, |last| last + 1);
        line.get(start..end).unwrap_or_default()
    }

    /// Reads one number of the HIERARCHY section.
    pub(super) fn number(&mut self) -> Result<f64, Stop> {
        self.skip_blank();
        match scan(self.text, self.at, self.commas) {
            Scan::Value { value, end, glued } => {
                if glued {
                    self.tally.add(WarningKind::MissingSpaces, Some(end));
                }
                self.at = end;
                Ok(value)
            }
            Scan::OtherDecimalSign => Err(self.other_decimal_sign()),
            Scan::NotFinite { .. } | Scan::Cut | Scan::Bad => {
                Err(self.unexpected("a number").into())
            }
        }
    }

    pub(super) fn other_decimal_sign(&mut self) -> Stop {
        let expected = if self.commas {
            "a number with a decimal comma"
        } else {
            "a number with a decimal point"
        };
        Stop::OtherDecimalSign(
            self.unexpected(expected)
                .with_hint("decimal commas are read where every number of the file has one"),
        )
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
    fn peek_ends_at_white_space_and_braces() {
        let mut lexer = Lexer::new(b"# a\n  ROOT\tHips{ // b\r}x", false);
        let mut take = |expected: &[u8], at: usize| {
            assert_eq!((lexer.peek(), lexer.at), (expected, at));
            lexer.at += expected.len();
        };
        take(b"ROOT", 6);
        take(b"Hips", 11);
        take(b"{", 15);
        take(b"}", 22);
        take(b"x", 23);
        take(b"", 24);
        lexer.at = 10;
        assert_eq!((lexer.rest_of_line(), lexer.at), (b"Hips".as_slice(), 15));
        lexer.at = 24;
        assert_eq!(lexer.unexpected("y").found.to_string(), "the end of the file");
    }
}
