//! Parsing of inline marks: code, bold, italic, links. One pass, and one over the stars of each
//! link, so that no text is searched twice.
//!
//! Marks follow `CommonMark` (spec 0.31, section 6) with three differences: `_` is a letter; a
//! single star between two letters or digits, as in `2*3`, is a multiplication sign; and full-width
//! punctuation counts as a letter, since `**「腳」**` would otherwise not be bold inside a sentence.

use super::address::{address, bare_address, entity};
use super::html::tag_len;
use super::page::Span;
use super::prose::Prose;
use std::collections::BTreeMap;

/// Returns the spans of a text, without marks. Lines begin without spaces.
pub(super) fn spans_of(text: &str) -> Vec<Span> {
    let mut marks = Marks::new(text.trim_end());
    while let Some(letter) = marks.next() {
        marks.take(letter);
    }
    marks.flush();
    marks.pair(0);
    let mut prose = Prose::default();
    for piece in marks.pieces {
        match piece {
            Piece::Text(text) => prose.text(&text, false),
            Piece::Code(code) => prose.text(&code, true),
            Piece::LineEnd => prose.line_end(),
            Piece::Link(address) => prose.begin_link(&address),
            Piece::LinkEnd => prose.end_link(),
            Piece::Stars(stars) => {
                prose.strong = prose.strong.saturating_sub(stars.ends_strong);
                prose.emphasis = prose.emphasis.saturating_sub(stars.ends_emphasis);
                prose.text(&"*".repeat(stars.left), false);
                prose.strong += stars.begins_strong;
                prose.emphasis += stars.begins_emphasis;
            }
        }
    }
    prose.end()
}

/// A parsed part of a text.
#[derive(Debug)]
enum Piece {
    Text(String),
    Code(String),
    LineEnd,
    Link(String),
    LinkEnd,
    Stars(Stars),
}

/// The marks that a run of stars stands for, and the number of its stars that stay text.
#[derive(Debug, Default)]
struct Stars {
    ends_strong: usize,
    ends_emphasis: usize,
    left: usize,
    begins_strong: usize,
    begins_emphasis: usize,
}

/// A run of stars that may have a counterpart.
#[derive(Clone, Copy, Debug)]
struct Run {
    piece: usize,
    len: usize,
    left: usize,
    begins: bool,
    ends: bool,
}

impl Run {
    /// Returns whether two runs may match, by the rule of three: `*a**b*` is one run of italics,
    /// not two.
    fn fits(self, end: Self) -> bool {
        let is_either = self.ends || end.begins;
        !is_either
            || !(self.len + end.len).is_multiple_of(3)
            || (self.len.is_multiple_of(3) && end.len.is_multiple_of(3))
    }

    /// Returns the class of a closing run: all of one class match the same opening runs.
    fn class(self) -> usize {
        self.len % 3 + if self.begins { 3 } else { 0 }
    }
}

/// A `[` or `![` that may begin a link or an image.
#[derive(Clone, Copy, Debug)]
struct Bracket {
    piece: usize,
    /// The number of runs of stars before it.
    runs: usize,
    is_picture: bool,
}

/// The state of the parser.
struct Marks<'a> {
    text: &'a str,
    rest: &'a str,
    /// Text since the last piece.
    plain: String,
    pieces: Vec<Piece>,
    runs: Vec<Run>,
    brackets: Vec<Bracket>,
    /// The number of brackets that enclose a link and can therefore not begin another: links do not
    /// nest.
    links_from: usize,
    /// The positions of runs of backticks, by length.
    backticks: BTreeMap<usize, Vec<usize>>,
    /// The end of the last comment in the text.
    last_comment_end: usize,
}

impl<'a> Marks<'a> {
    fn new(text: &'a str) -> Self {
        let mut backticks: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        let mut at = 0;
        for between in text.split_inclusive(|letter| letter != '`') {
            let ticks = between.bytes().take_while(|&byte| byte == b'`').count();
            if ticks > 0 {
                backticks.entry(ticks).or_default().push(at);
            }
            at += between.len();
        }
        Self {
            text,
            rest: text,
            plain: String::new(),
            pieces: Vec::new(),
            runs: Vec::new(),
            brackets: Vec::new(),
            links_from: 0,
            backticks,
            last_comment_end: text.rfind("-->").unwrap_or_default(),
        }
    }

    /// Skips to the next character that may be a mark.
    fn next(&mut self) -> Option<char> {
        let end = self.rest.find(['\\', '`', '*', '[', ']', '!', '<', '&', '\n']);
        let (plain, rest) = self.rest.split_at_checked(end.unwrap_or(self.rest.len()))?;
        self.plain.push_str(plain);
        self.rest = rest;
        rest.chars().next()
    }

    fn at(&self) -> usize {
        self.text.len() - self.rest.len()
    }

    /// Consumes and returns the next `len` bytes.
    fn eat(&mut self, len: usize) -> &'a str {
        let (eaten, rest) = self.rest.split_at_checked(len).unwrap_or((self.rest, ""));
        self.rest = rest;
        eaten
    }

    fn take(&mut self, mark: char) {
        match mark {
            '\\' => self.backslash(),
            '`' => self.code(),
            '*' => self.stars(),
            '[' => self.bracket(1),
            '!' if self.rest.starts_with("![") => self.bracket(2),
            ']' => self.close_bracket(),
            '<' => self.angle(),
            '&' => match entity(self.rest) {
                Some((letter, len)) => {
                    self.plain.push(letter);
                    self.eat(len);
                }
                None => self.literal(1),
            },
            '\n' => {
                let line = self.plain.trim_end_matches(' ').len();
                let is_break = self.plain.len() >= line + 2;
                self.plain.truncate(line);
                self.end_line(is_break);
            }
            _ => self.literal(1),
        }
    }

    /// Consumes characters as text.
    fn literal(&mut self, len: usize) {
        let eaten = self.eat(len);
        self.plain.push_str(eaten);
    }

    fn flush(&mut self) {
        if !self.plain.is_empty() {
            self.pieces.push(Piece::Text(std::mem::take(&mut self.plain)));
        }
    }

    fn push(&mut self, piece: Piece) {
        self.flush();
        self.pieces.push(piece);
    }

    fn end_line(&mut self, is_break: bool) {
        self.eat(1);
        if is_break {
            self.plain.push('\n');
        } else {
            self.push(Piece::LineEnd);
        }
    }

    fn backslash(&mut self) {
        self.eat(1);
        match self.rest.chars().next() {
            Some('\n') => self.end_line(true),
            Some(letter) if letter.is_ascii_punctuation() => self.literal(1),
            _ => self.plain.push('\\'),
        }
    }

    fn code(&mut self) {
        let ticks = run_len(self.rest, '`');
        let from = self.at() + ticks;
        let ends = self.backticks.get(&ticks).map(Vec::as_slice).unwrap_or_default();
        let end = ends.get(ends.partition_point(|&end| end < from)).copied();
        let Some(code) = end.and_then(|end| self.text.get(from..end)) else {
            return self.literal(ticks);
        };
        self.eat(code.len() + 2 * ticks);
        let line = code.replace('\n', " ");
        let inner = line.strip_prefix(' ').and_then(|line| line.strip_suffix(' '));
        let inner = inner.filter(|inner| !inner.trim_matches(' ').is_empty()).map(str::to_owned);
        self.push(Piece::Code(inner.unwrap_or(line)));
    }

    fn stars(&mut self) {
        let before = self.text.get(..self.at()).and_then(|text| text.chars().next_back());
        let len = run_len(self.rest, '*');
        let stars = self.eat(len);
        let after = self.rest.chars().next();
        let is_word =
            |letter: Option<char>| letter.is_some_and(|letter| letter.is_ascii_alphanumeric());
        if len == 1 && is_word(before) && is_word(after) {
            self.plain.push_str(stars);
            return;
        }
        let is_space = |letter: Option<char>| letter.is_none_or(char::is_whitespace);
        let is_sign = |letter: Option<char>| letter.is_some_and(is_punctuation);
        let begins = !is_space(after) && (!is_sign(after) || is_space(before) || is_sign(before));
        let ends = !is_space(before) && (!is_sign(before) || is_space(after) || is_sign(after));
        self.flush();
        self.runs.push(Run { piece: self.pieces.len(), len, left: len, begins, ends });
        self.pieces.push(Piece::Stars(Stars { left: len, ..Stars::default() }));
    }

    /// Pairs all runs of stars from one on; none of them matches a run outside.
    fn pair(&mut self, from: usize) {
        let mut begun: Vec<Run> = Vec::new();
        // For each class of closing runs, the first run that may still match; without this, stars
        // without counterparts would take quadratic time.
        let mut searched = [0; 6];
        for mut end in self.runs.split_off(from.min(self.runs.len())) {
            while end.ends && end.left > 0 {
                let searched_to = searched.get(end.class()).copied().unwrap_or_default();
                let fitting =
                    begun.iter().enumerate().skip(searched_to).rfind(|(_, run)| run.fits(end));
                let Some(at) = fitting.map(|(at, _)| at) else {
                    if let Some(to) = searched.get_mut(end.class()) {
                        *to = begun.len();
                    }
                    break;
                };
                begun.truncate(at + 1);
                let Some(begin) = begun.last_mut() else { break };
                let used = if begin.left >= 2 && end.left >= 2 { 2 } else { 1 };
                begin.left -= used;
                end.left -= used;
                let is_used_up = begin.left == 0;
                if let Some(Piece::Stars(stars)) = self.pieces.get_mut(begin.piece) {
                    stars.left -= used;
                    stars.begins_strong += used - 1;
                    stars.begins_emphasis += 2 - used;
                }
                if let Some(Piece::Stars(stars)) = self.pieces.get_mut(end.piece) {
                    stars.left -= used;
                    stars.ends_strong += used - 1;
                    stars.ends_emphasis += 2 - used;
                }
                if is_used_up {
                    begun.pop();
                }
                searched = searched.map(|to| to.min(begun.len()));
            }
            if end.begins && end.left > 0 {
                begun.push(end);
            }
        }
    }

    fn bracket(&mut self, len: usize) {
        let bracket = self.eat(len);
        self.flush();
        self.brackets.push(Bracket {
            piece: self.pieces.len(),
            runs: self.runs.len(),
            is_picture: len == 2,
        });
        self.pieces.push(Piece::Text(bracket.to_owned()));
    }

    fn close_bracket(&mut self) {
        let Some(bracket) = self.brackets.pop() else {
            return self.literal(1);
        };
        let may_begin = bracket.is_picture || self.brackets.len() >= self.links_from;
        self.links_from = self.links_from.min(self.brackets.len());
        let after = self.rest.strip_prefix("](");
        let Some((address, left)) = after.filter(|_| may_begin).and_then(address) else {
            return self.literal(1);
        };
        self.rest = left;
        self.flush();
        self.pair(bracket.runs);
        let Some(piece) = self.pieces.get_mut(bracket.piece) else {
            return;
        };
        // Only the alternative text of an image is kept.
        if bracket.is_picture {
            *piece = Piece::Text(String::new());
        } else {
            *piece = Piece::Link(address);
            self.pieces.push(Piece::LinkEnd);
            self.links_from = self.brackets.len();
        }
    }

    /// Reads an address, or HTML, which is removed.
    fn angle(&mut self) {
        if let Some(address) = bare_address(self.rest) {
            self.push(Piece::Link(address.to_owned()));
            self.pieces.push(Piece::Text(address.to_owned()));
            self.pieces.push(Piece::LinkEnd);
            self.eat(address.len() + 2);
        } else if self.rest.starts_with("<!--") && self.at() + 4 <= self.last_comment_end {
            let len = self.rest.find("-->").map_or(4, |end| end + 3);
            self.eat(len);
        } else if let Some(len) = tag_len(self.rest) {
            self.eat(len);
        } else {
            self.literal(1);
        }
    }
}

fn run_len(text: &str, sign: char) -> usize {
    text.len() - text.trim_start_matches(sign).len()
}

/// Returns whether a character beside stars decides what they begin or end.
fn is_punctuation(letter: char) -> bool {
    letter.is_ascii_punctuation()
        || matches!(letter, '\u{a1}'..='\u{bf}' | '×' | '÷' | '\u{2010}'..='\u{2bff}')
}
