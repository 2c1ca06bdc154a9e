//! Markdown into pages. Nothing that a file holds can do more than be shown: its size is limited, HTML and pictures are left out, and a link that
//! leads neither to a state nor to the web is text.

use super::page::{Block, Page, Span, Target, Try};
use super::shelf::lesson_of_file;
use pulldown_cmark::{Event, HeadingLevel, Options, Parser, Tag, TagEnd};

/// A lesson with more bytes than that is none.
pub const MOST_BYTES: usize = 256 * 1024;
/// What lies beyond so many pages of one file is left out.
const MOST_PAGES: usize = 200;
/// Likewise of the blocks of one page.
const MOST_BLOCKS: usize = 400;
/// Lists inside of lists are set in no further than that.
const DEEPEST: usize = 3;

/// The words under which a section is known, in every language that lessons come in.
const SECTIONS: [(Section, &[&str]); 3] = [
    (Section::Try, &["try", "try it", "試試看"]),
    (Section::Question, &["question", "想一想"]),
    (Section::Answer, &["answer", "解答"]),
];

/// Why a file is no lesson.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum LessonError {
    /// Too large.
    #[error("it has {found} bytes, a lesson has at most {MOST_BYTES}")]
    TooLarge {
        /// Its size.
        found: usize,
    },
    /// Not a text.
    #[error("it is not a text in UTF-8")]
    NotText,
    /// No page begins.
    #[error("no line in it begins with `# `: a page begins with its title")]
    NoTitle,
}

/// Reads the pages of a lesson: each begins with a heading of the first level. What stands before the first is left out.
///
/// # Errors
/// [`LessonError`]; Markdown itself is never wrong.
pub fn parse(bytes: &[u8]) -> Result<Vec<Page>, LessonError> {
    if bytes.len() > MOST_BYTES {
        return Err(LessonError::TooLarge { found: bytes.len() });
    }
    let text = std::str::from_utf8(bytes).map_err(|_| LessonError::NotText)?;
    let mut reader = Reader::default();
    for event in Parser::new_ext(text.trim_start_matches('\u{feff}'), Options::empty()) {
        reader.take(event);
        if reader.pages.len() > MOST_PAGES {
            break;
        }
    }
    reader.end_page();
    reader.pages.truncate(MOST_PAGES);
    if reader.pages.is_empty() {
        return Err(LessonError::NoTitle);
    }
    Ok(reader.pages)
}

/// What part of a page is being read.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Section {
    #[default]
    Body,
    Try,
    Question,
    Answer,
}

/// An item of a list whose text was not yet read.
#[derive(Clone, Copy, Debug)]
struct Marker {
    depth: usize,
    number: Option<u64>,
}

/// Where the reading has got to.
#[derive(Debug, Default)]
struct Reader {
    pages: Vec<Page>,
    page: Option<Page>,
    section: Section,
    /// The text of the block so far.
    spans: Vec<Span>,
    /// How many marks of each kind are open.
    strong: usize,
    emphasis: usize,
    /// The link that is open: where it leads, or the address that is shown in its place.
    link: Option<Result<Target, String>>,
    /// A line ended: a space, unless it stands between signs that take none.
    line_ended: bool,
    /// For every list that is open, the number of its next item.
    lists: Vec<Option<u64>>,
    marker: Option<Marker>,
    code: Option<String>,
}

impl Reader {
    fn take(&mut self, event: Event<'_>) {
        match event {
            Event::Start(tag) => self.start(tag),
            Event::End(tag) => self.end(tag),
            Event::Text(text) => match &mut self.code {
                Some(code) => code.push_str(&text),
                None => self.text(&text, false),
            },
            Event::Code(text) => self.text(&text, true),
            Event::SoftBreak => self.line_ended = true,
            Event::HardBreak => self.text("\n", false),
            _ => {}
        }
    }

    fn start(&mut self, tag: Tag<'_>) {
        match tag {
            Tag::Heading { .. } | Tag::Paragraph => self.end_block(),
            Tag::List(number) => {
                self.end_block();
                self.lists.push(number);
            }
            Tag::Item => {
                self.end_block();
                let depth = self.lists.len().saturating_sub(1).min(DEEPEST);
                let number = self.lists.last_mut().and_then(Option::as_mut).map(|next| {
                    let number = *next;
                    *next = next.saturating_add(1);
                    number
                });
                self.marker = Some(Marker { depth, number });
            }
            Tag::CodeBlock(_) => {
                self.end_block();
                self.code = Some(String::new());
            }
            Tag::Strong => self.strong += 1,
            Tag::Emphasis => self.emphasis += 1,
            Tag::Link { dest_url, .. } => self.link = Some(target_of(&dest_url)),
            _ => {}
        }
    }

    fn end(&mut self, tag: TagEnd) {
        match tag {
            TagEnd::Heading(level) => self.end_heading(level),
            TagEnd::Paragraph | TagEnd::Item => {
                self.end_block();
                if tag == TagEnd::Item {
                    self.marker = None;
                }
            }
            TagEnd::List(_) => {
                self.end_block();
                self.lists.pop();
            }
            TagEnd::CodeBlock => {
                let code = self.code.take().unwrap_or_default();
                self.push(Block::Code(code.trim_end().to_owned()));
            }
            TagEnd::Strong => self.strong = self.strong.saturating_sub(1),
            TagEnd::Emphasis => self.emphasis = self.emphasis.saturating_sub(1),
            TagEnd::Link => {
                if let Some(Err(address)) = self.link.take() {
                    self.text(&format!(" ({address})"), false);
                }
            }
            _ => {}
        }
    }

    fn text(&mut self, text: &str, code: bool) {
        let text: String = text.chars().filter(|&letter| letter == '\n' || !letter.is_control()).collect();
        let mut text = with_units_held(&text);
        if std::mem::take(&mut self.line_ended) {
            let before = self.spans.last().and_then(|span| span.text.chars().next_back());
            let around = [before, text.chars().next()];
            if !around.into_iter().flatten().any(is_unspaced) {
                text.insert(0, ' ');
            }
        }
        let span = Span {
            text,
            strong: self.strong > 0,
            emphasis: self.emphasis > 0,
            code,
            target: self.link.as_ref().and_then(|link| link.as_ref().ok()).cloned(),
        };
        match self.spans.last_mut() {
            Some(last) if is_alike(last, &span) => last.text.push_str(&span.text),
            _ => self.spans.push(span),
        }
    }

    /// Puts what was read so far where it belongs.
    fn end_block(&mut self) {
        self.line_ended = false;
        let spans = std::mem::take(&mut self.spans);
        if spans.iter().all(|span| span.text.trim().is_empty()) {
            return;
        }
        let marker = self.marker.take();
        let Some(page) = &mut self.page else { return };
        let begins = page.body.is_empty() && page.state.is_none() && self.section == Section::Body && marker.is_none();
        let link = Try::of(&spans);
        match (link, marker) {
            (Some(link), None) if begins && link.about.is_empty() => page.state = Some(link),
            (Some(link), Some(_)) if self.section == Section::Try => {
                if page.tries.len() < MOST_BLOCKS {
                    page.tries.push(link);
                }
            }
            (_, Some(Marker { depth, number })) => self.push(Block::Item { depth, number, spans }),
            (_, None) => self.push(Block::Paragraph(spans)),
        }
    }

    fn push(&mut self, block: Block) {
        let Some(page) = &mut self.page else { return };
        let blocks = match self.section {
            Section::Body | Section::Try => &mut page.body,
            Section::Question => &mut page.question,
            Section::Answer => &mut page.answer,
        };
        if blocks.len() < MOST_BLOCKS {
            blocks.push(block);
        }
    }

    fn end_heading(&mut self, level: HeadingLevel) {
        let words: String = std::mem::take(&mut self.spans).iter().map(|span| span.text.as_str()).collect();
        let words = words.trim();
        self.line_ended = false;
        if level == HeadingLevel::H1 {
            self.end_page();
            self.section = Section::Body;
            self.page = Some(Page {
                title: words.to_owned(),
                ..Page::default()
            });
            return;
        }
        let lower = words.to_lowercase();
        let known = SECTIONS.iter().find(|(_, names)| names.contains(&lower.as_str()));
        match known {
            Some((section, _)) => self.section = *section,
            None if words.is_empty() => {}
            None => {
                self.section = Section::Body;
                self.push(Block::Heading(words.to_owned()));
            }
        }
    }

    fn end_page(&mut self) {
        self.end_block();
        self.pages.extend(self.page.take());
    }
}

/// Whether two runs of text look and lead alike.
fn is_alike(a: &Span, b: &Span) -> bool {
    (a.strong, a.emphasis, a.code, &a.target) == (b.strong, b.emphasis, b.code, &b.target)
}

/// Where an address leads; an address that may not be opened is given back.
fn target_of(address: &str) -> Result<Target, String> {
    if let Some(query) = address.strip_prefix('?') {
        Ok(Target::State(query.to_owned()))
    } else if let Some(name) = lesson_of_file(address) {
        Ok(Target::State(format!("lesson={name}")))
    } else if address.starts_with("https://") || address.starts_with("http://") {
        Ok(Target::Web(address.to_owned()))
    } else {
        Err(address.to_owned())
    }
}

/// Whether no space is set about a sign: Chinese and Japanese letters, and full-width punctuation.
fn is_unspaced(letter: char) -> bool {
    matches!(letter, '\u{2e80}'..='\u{9fff}' | '\u{f900}'..='\u{faff}' | '\u{ff00}'..='\u{ffef}' | '\u{20000}'..='\u{3ffff}')
}

/// A text whose numbers are not torn from their units at the end of a line.
fn with_units_held(text: &str) -> String {
    const UNITS: [&str; 7] = ["%", "°", "cm", "mm", "m", "s", "ms"];
    let mut held = String::with_capacity(text.len());
    let mut pieces = text.split(' ').peekable();
    while let Some(piece) = pieces.next() {
        held.push_str(piece);
        if let Some(next) = pieces.peek() {
            let unit = next.trim_end_matches(|letter: char| letter.is_ascii_punctuation() && letter != '%');
            let is_unit = UNITS.contains(&unit) || next.starts_with('°') || next.starts_with('%');
            let after_number = piece.ends_with(|letter: char| letter.is_ascii_digit());
            held.push(if after_number && is_unit { '\u{a0}' } else { ' ' });
        }
    }
    held
}
