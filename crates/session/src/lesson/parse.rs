//! Parsing of Markdown into pages. A file can do no more than be shown: its size is limited, HTML
//! and images are removed, and a link to neither a state nor the web is text.

use super::blocks::{Marker, RawBlock, parts_of};
use super::inline::spans_of;
use super::page::{Block, Page, Try};

/// The greatest size of a lesson, bytes.
pub const MAX_BYTES: usize = 256 * 1024;
/// The greatest number of pages in a file; further ones are left out.
const MAX_PAGES: usize = 200;
/// The greatest number of blocks on a page; further ones are left out.
const MAX_BLOCKS: usize = 400;
/// The greatest nesting of lists that is shown.
const MAX_DEPTH: usize = 3;

/// The headings of sections, in every language of the lessons.
const SECTIONS: [(Section, &[&str]); 3] = [
    (Section::Try, &["try", "try it", "試試看"]),
    (Section::Question, &["question", "想一想"]),
    (Section::Answer, &["answer", "解答"]),
];

/// The reason why a file is not a lesson.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error, segue_text::ToMessage)]
pub enum LessonError {
    /// A file that is too large.
    #[error("it has {found} bytes, a lesson has at most {MAX_BYTES}")]
    TooLarge {
        /// Its size, bytes.
        found: usize,
    },
    /// A file that is not UTF-8.
    #[error("it is not a text in UTF-8")]
    NotText,
    /// A file without a page.
    #[error("no line in it begins with `# `: a page begins with its title")]
    NoTitle,
}

/// Reads the pages of a lesson: each begins with a heading of the first level. Text before the
/// first is left out.
///
/// # Errors
/// [`LessonError`] about the file; Markdown itself is never invalid.
pub fn parse(bytes: &[u8]) -> Result<Vec<Page>, LessonError> {
    if bytes.len() > MAX_BYTES {
        return Err(LessonError::TooLarge { found: bytes.len() });
    }
    let text = std::str::from_utf8(bytes).map_err(|_| LessonError::NotText)?;
    let mut reader = Reader::default();
    for part in parts_of(text.trim_start_matches('\u{feff}')) {
        reader.take(part);
        if reader.pages.len() > MAX_PAGES {
            break;
        }
    }
    reader.end_page();
    reader.pages.truncate(MAX_PAGES);
    if reader.pages.is_empty() {
        return Err(LessonError::NoTitle);
    }
    Ok(reader.pages)
}

/// The section of a page that is being read.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Section {
    #[default]
    Body,
    Try,
    Question,
    Answer,
}

/// The state of the parser.
#[derive(Debug, Default)]
struct Reader {
    pages: Vec<Page>,
    page: Option<Page>,
    section: Section,
}

impl Reader {
    fn take(&mut self, part: RawBlock) {
        match part {
            RawBlock::Heading(level, words) => self.heading(level, &words),
            RawBlock::Text(marker, text) => self.text(marker, &text),
            RawBlock::Code(code) => self.push(Block::Code(code.trim_end().to_owned())),
        }
    }

    /// Adds a text to the section where it belongs.
    fn text(&mut self, marker: Option<Marker>, text: &str) {
        let Some(page) = &mut self.page else { return };
        let spans = spans_of(text);
        if spans.iter().all(|span| span.text.trim().is_empty()) {
            return;
        }
        let begins = page.body.is_empty()
            && page.state.is_none()
            && self.section == Section::Body
            && marker.is_none();
        let link = Try::of(&spans);
        match (link, marker) {
            (Some(link), None) if begins && link.about.is_empty() => page.state = Some(link),
            (Some(link), Some(_)) if self.section == Section::Try => {
                if page.tries.len() < MAX_BLOCKS {
                    page.tries.push(link);
                }
            }
            (_, Some(Marker { depth, number })) => {
                self.push(Block::Item { depth: depth.min(MAX_DEPTH), number, spans });
            }
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
        if blocks.len() < MAX_BLOCKS {
            blocks.push(block);
        }
    }

    fn heading(&mut self, level: usize, words: &str) {
        let words: String = spans_of(words).iter().map(|span| span.text.as_str()).collect();
        let words = words.trim();
        if level == 1 {
            self.end_page();
            self.section = Section::Body;
            self.page = Some(Page { title: words.to_owned(), ..Page::default() });
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
        self.pages.extend(self.page.take());
    }
}
