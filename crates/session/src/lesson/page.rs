/// One page of a lesson.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Page {
    /// Its heading.
    pub title: String,
    /// What sets the page up, and what that is called; `None` where the page is about whatever is
    /// open.
    pub state: Option<Try>,
    /// The text.
    pub body: Vec<Block>,
    /// What there is to try.
    pub tries: Vec<Try>,
    /// The question at the end; empty where there is none.
    pub question: Vec<Block>,
    /// Its answer, not to be seen at once.
    pub answer: Vec<Block>,
}

/// A link that sets the state, and what is to be seen then.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Try {
    /// A few words.
    pub label: String,
    /// The query, without its question mark.
    pub query: String,
    /// A sentence or two.
    pub about: Vec<Span>,
}

/// A part of the text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Block {
    /// A heading inside of the page.
    Heading(String),
    /// A paragraph.
    Paragraph(Vec<Span>),
    /// An item of a list.
    Item {
        /// How many lists it stands inside of, without its own.
        depth: usize,
        /// Its number, in a list that counts.
        number: Option<u64>,
        /// What it says.
        spans: Vec<Span>,
    },
    /// Lines to be shown as they are, such as a formula.
    Code(String),
}

/// A run of text that looks the same.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Span {
    /// What it says.
    pub text: String,
    /// Set bold.
    pub strong: bool,
    /// Set italic.
    pub emphasis: bool,
    /// A formula, a value or a key.
    pub code: bool,
    /// Where it leads.
    pub target: Option<Target>,
}

/// Where a link leads.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Target {
    /// To a state of the document: a query without its question mark.
    State(String),
    /// To a page of the web: an address that starts with `https://` or `http://`.
    Web(String),
}

impl Span {
    /// Plain text.
    pub fn plain(text: impl Into<String>) -> Self {
        Self { text: text.into(), ..Self::default() }
    }
}

impl Page {
    /// Of a page that lists lessons: the query, the name and the line about each.
    pub fn entries(&self) -> impl Iterator<Item = Try> + '_ {
        self.body.iter().filter_map(|block| match block {
            Block::Item { spans, .. } => Try::of(spans),
            _ => None,
        })
    }
}

impl Try {
    /// What a line says that begins with a link to a state; `None` for any other.
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
