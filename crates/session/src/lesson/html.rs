//! Recognition of HTML in a lesson, to remove it.

/// Elements whose content is no text, even across blank lines.
const OPAQUE: [&str; 4] = ["script", "style", "pre", "textarea"];
/// Elements that remove all lines up to the next blank line.
const BLOCKS: [&str; 44] = [
    "address",
    "article",
    "aside",
    "blockquote",
    "body",
    "caption",
    "center",
    "col",
    "dd",
    "details",
    "dialog",
    "div",
    "dl",
    "dt",
    "fieldset",
    "figcaption",
    "figure",
    "footer",
    "form",
    "frame",
    "h1",
    "h2",
    "h3",
    "h4",
    "h5",
    "h6",
    "head",
    "header",
    "hr",
    "html",
    "iframe",
    "li",
    "link",
    "main",
    "nav",
    "ol",
    "p",
    "section",
    "summary",
    "table",
    "td",
    "th",
    "tr",
    "ul",
];

/// A block of HTML lines.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Html {
    /// The text that ends the block, in lower case; `None` if a blank line does.
    until: Option<String>,
    /// Whether the block ends a paragraph.
    pub(super) interrupts: bool,
}

impl Html {
    /// Returns the block that begins with this line; `None` if the line is text.
    pub(super) fn begins(line: &str) -> Option<Self> {
        let until = |end: &str| Some(Self { until: Some(end.to_owned()), interrupts: true });
        let inner = line.strip_prefix('<')?;
        if let Some((_, end)) = SPECIAL.into_iter().find(|(start, _)| inner.starts_with(start)) {
            return until(end);
        }
        let inner = inner.strip_prefix('/').unwrap_or(inner);
        let (name, after) = inner.split_at_checked(name_len(inner)?)?;
        if !after.is_empty() && !after.starts_with([' ', '\t', '>', '/']) {
            return None;
        }
        let name = name.to_ascii_lowercase();
        if OPAQUE.contains(&name.as_str()) {
            return until(&format!("</{name}>"));
        }
        let interrupts = BLOCKS.contains(&name.as_str());
        let alone = tag_len(line) == Some(line.trim_end().len());
        (interrupts || alone).then_some(Self { until: None, interrupts })
    }

    /// Returns whether a line is the last of the block; the first line may be.
    pub(super) fn ends(&self, line: &str) -> bool {
        self.until.as_ref().is_some_and(|end| line.to_ascii_lowercase().contains(end.as_str()))
    }

    /// Returns whether a blank line ends the block.
    pub(super) fn ends_when_blank(&self) -> bool {
        self.until.is_none()
    }
}

/// Constructs other than elements: their text after `<`, and their end.
const SPECIAL: [(&str, &str); 3] = [("!--", "-->"), ("?", "?>"), ("!", ">")];

/// Returns the length in bytes of the tag at the beginning of a text. A tag contains no `<` inside
/// it, so that no text is searched twice.
pub(super) fn tag_len(text: &str) -> Option<usize> {
    let inner = text.strip_prefix('<')?;
    let inner = inner.strip_prefix(['/', '!', '?']).unwrap_or(inner);
    let (_, after) = inner.split_at_checked(name_len(inner)?)?;
    if !after.starts_with([' ', '\t', '\n', '>', '/']) {
        return None;
    }
    let mut quote = None;
    for (at, letter) in after.char_indices() {
        match letter {
            '<' => return None,
            '>' if quote.is_none() => return Some(text.len() - after.len() + at + 1),
            '"' | '\'' if quote.is_none() => quote = Some(letter),
            _ if quote == Some(letter) => quote = None,
            _ => {}
        }
    }
    None
}

fn name_len(text: &str) -> Option<usize> {
    let end = text.find(|letter: char| !letter.is_ascii_alphanumeric() && letter != '-');
    let len = end.unwrap_or(text.len());
    text.starts_with(|letter: char| letter.is_ascii_alphabetic()).then_some(len)
}
