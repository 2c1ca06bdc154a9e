//! Parsing of a lesson's lines into headings, paragraphs, list items, and code, in one pass and
//! linear time.
//!
//! Lines are classified by `CommonMark` (spec 0.31, sections 4 and 5), restricted to the features
//! in `docs/lessons.md`.

use super::html::Html;

/// The greatest nesting of lists; a deeper marker is text.
const MAX_LEVELS: usize = 16;
/// The indentation from which on a line is code, columns.
const CODE_INDENT: usize = 4;

/// A block of a file, whose text still contains inline marks.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum RawBlock {
    /// A heading: the number of `#`, 1 to 6, and its text.
    Heading(usize, String),
    /// A paragraph, or the first one of a list item. Lines end with `
    /// `.
    Text(Option<Marker>, String),
    /// Lines that are shown unchanged.
    Code(String),
}

/// The marker of a list item.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Marker {
    /// The number of lists around the item's own.
    pub(super) depth: usize,
    /// Its number, in an ordered list.
    pub(super) number: Option<u64>,
}

/// Returns the blocks of a text, in order.
pub(super) fn parts_of(text: &str) -> Vec<RawBlock> {
    let mut lines = Lines::default();
    for line in text.split('\n') {
        lines.take(line.strip_suffix('\r').unwrap_or(line));
    }
    lines.close();
    lines.parts
}

/// A list that is open.
#[derive(Clone, Copy, Debug)]
struct Level {
    /// The character that begins all its items, or follows their numbers.
    sign: char,
    /// The number of the next item.
    next: Option<u64>,
    /// The least column of lines that belong to the open item.
    content: usize,
}

/// The block that the next line may continue.
#[derive(Debug, Default)]
enum Open {
    #[default]
    Nothing,
    Paragraph(String),
    Fence(Fence, String),
    Indented(String),
    Html(Html),
}

/// The opening line of a code block.
#[derive(Clone, Copy, Debug)]
struct Fence {
    sign: char,
    len: usize,
    /// The number of columns that are removed from each line.
    column: usize,
}

#[derive(Debug, Default)]
struct Lines {
    parts: Vec<RawBlock>,
    levels: Vec<Level>,
    /// The marker of an item whose first paragraph is yet to come.
    marker: Option<Marker>,
    open: Open,
    /// Whether the line before was in a quotation.
    quoted: bool,
}

impl Lines {
    fn take(&mut self, line: &str) {
        let start = Start::of(line);
        if start.rest.is_empty() {
            return self.take_blank();
        }
        let reach = self.levels.iter().take_while(|level| start.column >= level.content).count();
        let left_item = reach < self.levels.len();
        if start.quoted != self.quoted {
            // A paragraph continues after a quotation, as in mails whose lines were broken.
            if start.quoted || !matches!(self.open, Open::Paragraph(_)) {
                self.close();
            }
            self.quoted = start.quoted;
        }
        match &mut self.open {
            Open::Fence(fence, code) if !left_item => {
                if fence.is_closed_by(start) {
                    self.close();
                } else {
                    code.extend([start.after_column(line, fence.column), "\n"]);
                }
            }
            Open::Html(html) if !left_item => {
                if html.ends(start.rest) {
                    self.open = Open::Nothing;
                }
            }
            Open::Indented(code) if !left_item && start.is_code(base_of(&self.levels)) => {
                let column = base_of(&self.levels).max(start.base) + CODE_INDENT;
                code.extend([start.after_column(line, column), "\n"]);
            }
            Open::Paragraph(_) | Open::Nothing => self.begin(line, start, reach),
            _ => {
                self.close();
                self.begin(line, start, reach);
            }
        }
    }

    fn take_blank(&mut self) {
        match &mut self.open {
            Open::Fence(_, code) | Open::Indented(code) => code.push('\n'),
            Open::Html(html) if !html.ends_when_blank() => {}
            _ => self.close(),
        }
    }

    /// Reads a line that continues a paragraph or begins a block, inside the first `reach` lists.
    fn begin(&mut self, line: &str, mut start: Start<'_>, mut reach: usize) {
        loop {
            let in_paragraph = matches!(self.open, Open::Paragraph(_));
            let base = base_of(self.levels.get(..reach).unwrap_or_default());
            if start.is_code(base) {
                if in_paragraph {
                    return self.paragraph(start.rest, reach);
                }
                self.leave(reach);
                let column = base.max(start.base) + CODE_INDENT;
                self.open = Open::Indented(format!("{}\n", start.after_column(line, column)));
                return;
            }
            if is_rule(start.rest) {
                return self.leave(reach);
            }
            if let Some(item) = Item::of(start).filter(|item| {
                reach < MAX_LEVELS
                    && (!in_paragraph || reach < self.levels.len() || item.interrupts())
            }) {
                self.item(item, reach);
                start = item.start;
                self.quoted = start.quoted;
                reach = self.levels.len();
                if start.rest.is_empty() {
                    return;
                }
                continue;
            }
            if let Some((level, words)) = heading(start.rest) {
                self.leave(reach);
                self.parts.push(RawBlock::Heading(level, words.to_owned()));
                return;
            }
            if let Some(fence) = Fence::of(start) {
                self.leave(reach);
                self.open = Open::Fence(fence, String::new());
                return;
            }
            if let Some(html) =
                Html::begins(start.rest).filter(|html| !in_paragraph || html.interrupts)
            {
                self.leave(reach);
                if !html.ends(start.rest) {
                    self.open = Open::Html(html);
                }
                return;
            }
            return self.paragraph(start.rest, reach);
        }
    }

    /// Reads a line of text, which continues an open paragraph at any indentation.
    fn paragraph(&mut self, line: &str, reach: usize) {
        if let Open::Paragraph(text) = &mut self.open {
            text.extend(["\n", line]);
        } else {
            self.leave(reach);
            self.open = Open::Paragraph(line.to_owned());
        }
    }

    fn item(&mut self, item: Item<'_>, reach: usize) {
        self.close();
        self.levels.truncate(reach + 1);
        if self.levels.get(reach).is_none_or(|level| level.sign != item.sign) {
            self.levels.truncate(reach);
            self.levels.push(Level { sign: item.sign, next: item.number, content: item.content });
        }
        if let Some(level) = self.levels.last_mut() {
            level.content = item.content;
            let number = level.next;
            level.next = number.map(|number| number.saturating_add(1));
            self.marker = Some(Marker { depth: reach, number });
        }
    }

    /// Closes the open block, and all lists but the first `reach`.
    fn leave(&mut self, reach: usize) {
        self.close();
        if reach < self.levels.len() {
            self.levels.truncate(reach);
            self.marker = None;
        }
    }

    fn close(&mut self) {
        match std::mem::take(&mut self.open) {
            Open::Paragraph(text) => self.parts.push(RawBlock::Text(self.marker.take(), text)),
            Open::Fence(_, code) | Open::Indented(code) => self.parts.push(RawBlock::Code(code)),
            Open::Nothing | Open::Html(_) => {}
        }
    }
}

/// The beginning of a line's text.
#[derive(Clone, Copy, Debug)]
struct Start<'a> {
    /// The column of the text; tabs advance to multiples of four.
    column: usize,
    /// The text, without leading spaces.
    rest: &'a str,
    /// Whether `>` precedes it.
    quoted: bool,
    /// The column from which spaces are counted.
    base: usize,
}

impl<'a> Start<'a> {
    fn of(line: &'a str) -> Self {
        let mut start = Self { column: 0, rest: line, quoted: false, base: 0 };
        start.skip_spaces();
        start.skip_quotes();
        start
    }

    fn skip_quotes(&mut self) {
        while let Some(rest) = self.rest.strip_prefix('>').filter(|_| !self.is_code(0)) {
            self.quoted = true;
            self.column += 1;
            self.base = self.column + usize::from(rest.starts_with([' ', '\t']));
            self.rest = rest;
            self.skip_spaces();
        }
    }

    fn skip_spaces(&mut self) {
        let rest = self.rest.trim_start_matches([' ', '\t']);
        let spaces = self.rest.len() - rest.len();
        for space in self.rest.bytes().take(spaces) {
            self.column = if space == b'\t' { (self.column / 4 + 1) * 4 } else { self.column + 1 };
        }
        self.rest = rest;
    }

    fn is_code(self, base: usize) -> bool {
        self.column >= base.max(self.base) + CODE_INDENT
    }

    /// Returns the line from a column on, or from the beginning of its text if that is earlier.
    fn after_column(self, line: &'a str, column: usize) -> &'a str {
        let mut rest = line;
        let mut at = 0;
        while at < column && rest.len() > self.rest.len() {
            let mut letters = rest.chars();
            at = match letters.next() {
                Some('\t') => (at / 4 + 1) * 4,
                _ => at + 1,
            };
            rest = letters.as_str();
        }
        rest
    }
}

/// The beginning of a list item.
#[derive(Clone, Copy, Debug)]
struct Item<'a> {
    sign: char,
    number: Option<u64>,
    content: usize,
    start: Start<'a>,
}

impl<'a> Item<'a> {
    fn of(start: Start<'a>) -> Option<Self> {
        let digits = start.rest.bytes().take_while(u8::is_ascii_digit).count();
        let (number, rest) = start.rest.split_at_checked(digits)?;
        let signs: &[char] = if digits == 0 { &['-', '*', '+'] } else { &['.', ')'] };
        let sign = rest.chars().next().filter(|sign| signs.contains(sign))?;
        let rest = rest.strip_prefix(sign)?;
        if digits > 9 || !(rest.is_empty() || rest.starts_with([' ', '\t'])) {
            return None;
        }
        let mark_ends = start.column + digits + 1;
        let mut inner = Start { column: mark_ends, rest, quoted: start.quoted, base: 0 };
        inner.skip_spaces();
        let is_far = inner.column > mark_ends + CODE_INDENT;
        let content = if is_far || inner.rest.is_empty() { mark_ends + 1 } else { inner.column };
        inner.base = content;
        inner.skip_quotes();
        Some(Self { sign, number: number.parse().ok(), content, start: inner })
    }

    /// Returns whether the item may directly follow a line of text. A number at the beginning of a
    /// line is seldom a list item, unless it is 1.
    fn interrupts(self) -> bool {
        !self.start.rest.is_empty() && self.number.is_none_or(|number| number == 1)
    }
}

impl Fence {
    fn of(start: Start<'_>) -> Option<Self> {
        let sign = start.rest.chars().next().filter(|sign| ['`', '~'].contains(sign))?;
        let after = start.rest.trim_start_matches(sign);
        let len = start.rest.len() - after.len();
        (len >= 3 && !(sign == '`' && after.contains('`'))).then_some(Self {
            sign,
            len,
            column: start.column,
        })
    }

    fn is_closed_by(self, start: Start<'_>) -> bool {
        let line = start.rest.trim_ascii_end();
        line.len() >= self.len
            && line.chars().all(|letter| letter == self.sign)
            && start.column < self.column + CODE_INDENT
    }
}

/// Returns the column at which lines inside all these lists begin.
fn base_of(levels: &[Level]) -> usize {
    levels.last().map_or(0, |level| level.content)
}

/// Returns the number of `#` at the beginning of a line, and the text after them.
fn heading(line: &str) -> Option<(usize, &str)> {
    let words = line.trim_start_matches('#');
    let level = line.len() - words.len();
    if !(1..=6).contains(&level) || !(words.is_empty() || words.starts_with([' ', '\t'])) {
        return None;
    }
    let words = words.trim();
    // A closing `#`, as in `## Try ##`, is decoration.
    let bare = words.trim_end_matches('#');
    let is_closed = bare.is_empty() || bare.ends_with([' ', '\t']);
    Some((level, if is_closed { bare.trim_end() } else { words }))
}

/// Returns whether a line is a rule between paragraphs, such as `---`.
fn is_rule(line: &str) -> bool {
    let Some(sign) = line.chars().next().filter(|sign| ['-', '*', '_'].contains(sign)) else {
        return false;
    };
    line.chars().all(|letter| letter == sign || letter == ' ' || letter == '\t')
        && line.matches(sign).count() >= 3
}
