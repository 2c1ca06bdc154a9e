//! Conversion of text to spans: lines are joined, and neighbours with the same style and target are
//! merged.

use super::page::{Span, Target};
use super::sources::lesson_of_file;

/// The greatest number of spans in a link; the rest of a longer one has a single style. Each span
/// contains the address, so that a long address with many spans would fill the memory.
const MAX_SPANS_OF_A_LINK: usize = 64;

/// A block of text under construction.
#[derive(Debug, Default)]
pub(super) struct Prose {
    spans: Vec<Span>,
    /// The numbers of open marks of each kind.
    pub(super) strong: usize,
    pub(super) emphasis: usize,
    /// The open link.
    link: Option<Link>,
    /// The number of spans before it.
    link_from: usize,
    /// Whether a line ended: a space follows, unless the characters on both sides take none.
    line_ended: bool,
}

/// A link of a lesson.
#[derive(Debug)]
enum Link {
    /// A link that may be opened.
    Target(Target),
    /// A link with an address that may not be opened, which is shown after the text.
    Text(String),
}

impl Link {
    /// Returns the link of an address.
    fn of(address: &str) -> Self {
        if let Some(query) = address.strip_prefix('?') {
            Self::Target(Target::State(query.to_owned()))
        } else if let Some(name) = lesson_of_file(address) {
            Self::Target(Target::State(format!("lesson={name}")))
        } else if address.starts_with("https://") || address.starts_with("http://") {
            Self::Target(Target::Web(address.to_owned()))
        } else {
            Self::Text(address.to_owned())
        }
    }

    /// Returns the target, if the link may be opened.
    fn target(&self) -> Option<&Target> {
        match self {
            Self::Target(target) => Some(target),
            Self::Text(_) => None,
        }
    }
}

impl Prose {
    pub(super) fn line_end(&mut self) {
        self.line_ended = true;
    }

    pub(super) fn begin_link(&mut self, address: &str) {
        self.link = Some(Link::of(address));
        self.link_from = self.spans.len();
    }

    pub(super) fn end_link(&mut self) {
        if let Some(Link::Text(address)) = self.link.take() {
            self.text(&format!(" ({address})"), false);
        }
    }

    pub(super) fn text(&mut self, text: &str, code: bool) {
        let mut text: String =
            text.chars().filter(|&letter| letter == '\n' || !letter.is_control()).collect();
        if text.is_empty() {
            return;
        }
        if std::mem::take(&mut self.line_ended) {
            let before = self.spans.last().and_then(|span| span.text.chars().next_back());
            let around = [before, text.chars().next()];
            if !around.into_iter().flatten().any(is_unspaced) {
                text.insert(0, ' ');
            }
        }
        let target = self.link.as_ref().and_then(Link::target);
        let is_long = target.is_some() && self.spans.len() >= self.link_from + MAX_SPANS_OF_A_LINK;
        let look = (self.strong > 0, self.emphasis > 0, code, target);
        match self.spans.last_mut() {
            Some(last)
                if is_long
                    || (last.strong, last.emphasis, last.code, last.target.as_ref()) == look =>
            {
                last.text.push_str(&text);
            }
            _ => self.spans.push(Span {
                text,
                strong: self.strong > 0,
                emphasis: self.emphasis > 0,
                code,
                target: target.cloned(),
            }),
        }
    }

    pub(super) fn end(mut self) -> Vec<Span> {
        for span in &mut self.spans {
            span.text = with_units_held(&span.text);
        }
        self.spans
    }
}

/// Returns whether a character takes no space beside it: Chinese and Japanese letters, and
/// full-width punctuation.
fn is_unspaced(letter: char) -> bool {
    matches!(letter, '\u{2e80}'..='\u{9fff}' | '\u{f900}'..='\u{faff}' | '\u{ff00}'..='\u{ffef}' | '\u{20000}'..='\u{3ffff}')
}

/// Returns a text with non-breaking spaces between numbers and units.
fn with_units_held(text: &str) -> String {
    const UNITS: [&str; 7] = ["%", "°", "cm", "mm", "m", "s", "ms"];
    let mut held = String::with_capacity(text.len());
    let mut pieces = text.split(' ').peekable();
    while let Some(piece) = pieces.next() {
        held.push_str(piece);
        if let Some(next) = pieces.peek() {
            let unit = next
                .trim_end_matches(|letter: char| letter.is_ascii_punctuation() && letter != '%');
            let is_unit = UNITS.contains(&unit) || next.starts_with('°') || next.starts_with('%');
            let after_number = piece.ends_with(|letter: char| letter.is_ascii_digit());
            held.push(if after_number && is_unit { '\u{a0}' } else { ' ' });
        }
    }
    held
}
