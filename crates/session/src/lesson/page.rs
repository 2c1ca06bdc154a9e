//! Pages of lessons, as data.

/// One page of a lesson.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Page {
    /// Its heading.
    pub title: String,
    /// The state that the page sets, with its name; `None` if the page is about the current state.
    pub state: Option<Try>,
    /// The text.
    pub body: Vec<Block>,
    /// The things to try.
    pub tries: Vec<Try>,
    /// The question at the end; empty where there is none.
    pub question: Vec<Block>,
    /// Its answer, hidden at first; empty where there is none.
    pub answer: Vec<Block>,
}

/// A link that sets a state, with a description of what to see.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Try {
    /// Its name, a few words.
    pub label: String,
    /// The query, without its question mark.
    pub query: String,
    /// The description, a sentence or two.
    pub about: Vec<Span>,
}

/// A part of the text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Block {
    /// A heading inside the page.
    Heading(String),
    /// A paragraph.
    Paragraph(Vec<Span>),
    /// An item of a list.
    Item {
        /// The number of lists around the item's own.
        depth: usize,
        /// Its number, in an ordered list.
        number: Option<u64>,
        /// Its text.
        spans: Vec<Span>,
    },
    /// Lines that are shown unchanged, such as a formula.
    Code(String),
}

/// A run of text of one style.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Span {
    /// Its text.
    pub text: String,
    /// Whether it is bold.
    pub strong: bool,
    /// Whether it is italic.
    pub emphasis: bool,
    /// Whether it is a formula, a value or a key.
    pub code: bool,
    /// The target of its link; `None` for plain text.
    pub target: Option<Target>,
}

/// The target of a link.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Target {
    /// A state of the document: a query without its question mark.
    State(String),
    /// A web page: an address that starts with `https://` or `http://`.
    Web(String),
}

impl Span {
    /// Returns plain text.
    pub fn plain(text: impl Into<String>) -> Self {
        Self { text: text.into(), ..Self::default() }
    }
}

impl Page {
    /// Returns the entries of a page that lists lessons: the query, the name and the line about
    /// each.
    pub fn entries(&self) -> impl Iterator<Item = Try> + '_ {
        self.body.iter().filter_map(|block| match block {
            Block::Item { spans, .. } => Try::of(spans),
            _ => None,
        })
    }
}

impl Try {
    /// Returns the entry of a line that begins with a link to a state; `None` for any other line.
    pub(super) fn of(spans: &[Span]) -> Option<Self> {
        let target = spans.first()?.target.as_ref()?;
        let Target::State(query) = target else {
            return None;
        };
        let in_link = spans.iter().take_while(|span| span.target.as_ref() == Some(target)).count();
        let (link, rest) = spans.split_at_checked(in_link)?;
        let mut about = rest.to_vec();
        if let Some(first) = about.first_mut() {
            first.text = first.text.trim_start_matches([' ', ':', '：', '–', '—', '\n']).to_owned();
        }
        about.retain(|span| !span.text.is_empty());
        Some(Self {
            label: link.iter().map(|span| span.text.as_str()).collect(),
            query: query.clone(),
            about,
        })
    }
}
