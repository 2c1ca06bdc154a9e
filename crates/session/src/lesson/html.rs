//! HTML in a lesson, so that it can be left out.

/// What such an element holds is no text, whatever blank lines are in it.
const OPAQUE: [&str; 4] = ["script", "style", "pre", "textarea"];
/// Where such an element begins a line, all is left out up to the next blank line.
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

/// Lines of HTML.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Html {
    /// What the last of them holds, in small letters; `None` where they go on up to a blank line.
    until: Option<String>,
    /// Whether they end a paragraph.
    pub(super) interrupts: bool,
}

impl Html {
    /// What begins with this line; `None` where it is text.
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

    /// Whether a line is the last. The first may be that too.
    pub(super) fn ends(&self, line: &str) -> bool {
        self.until.as_ref().is_some_and(|end| line.to_ascii_lowercase().contains(end.as_str()))
    }

    /// Whether a blank line ends them.
    pub(super) fn ends_when_blank(&self) -> bool {
        self.until.is_none()
    }
}

/// What is no element: how it goes on after `<`, and how it ends.
const SPECIAL: [(&str, &str); 3] = [("!--", "-->"), ("?", "?>"), ("!", ">")];

/// How many bytes the tag has that a text begins with. What lies between `<` and `>` holds no other
/// `<`, so that no text is searched twice.
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
