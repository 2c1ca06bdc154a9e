//! The texts that panels hand to widgets, told apart by type: the words of the program are
//! translated, data never is.

use segue_text::{Arg, Message, ToArg};
use std::borrow::Cow;

/// A word or sentence of the program, in English: the key of its translations.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Word(&'static str);

impl Word {
    /// Returns an English text as a word of the program. `tests/language.rs` asks for its
    /// translations.
    pub(crate) const fn new(english: &'static str) -> Self {
        Self(english)
    }

    /// Returns the English text.
    pub(crate) const fn english(self) -> &'static str {
        self.0
    }

    /// Returns whether there is nothing to show.
    pub(crate) const fn is_empty(self) -> bool {
        self.0.is_empty()
    }
}

impl From<Word> for Message {
    fn from(word: Word) -> Self {
        Self::word(word.0)
    }
}

impl ToArg for Word {
    fn to_arg(&self) -> Arg {
        self.0.to_arg()
    }
}

/// A text that a widget shows. A widget takes no bare `&str`: its caller says whether it is a word
/// or data.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Text<'a> {
    /// A word of the program, translated where it is drawn.
    Word(Word),
    /// A message, written in the language of the interface where it is drawn.
    Message(&'a Message),
    /// Data, such as the name of a file, a number, or a text that is written already: shown as it
    /// is.
    Data(&'a str),
}

impl<'a> Text<'a> {
    /// No text.
    pub(crate) const EMPTY: Self = Self::Word(Word::new(""));

    /// Returns whether there is nothing to show.
    pub(crate) fn is_empty(self) -> bool {
        match self {
            Self::Word(word) => word.is_empty(),
            Self::Message(message) => message.is_empty(),
            Self::Data(data) => data.is_empty(),
        }
    }

    /// Returns the text in English, but for the arguments of a message: it stays when a number in
    /// the text changes.
    pub(crate) fn template(self) -> &'a str {
        match self {
            Self::Word(word) => word.english(),
            Self::Message(message) => message.template(),
            Self::Data(data) => data,
        }
    }

    /// Returns the text as a message, to be a part of another one.
    pub(crate) fn to_message(self) -> Message {
        match self {
            Self::Word(word) => word.into(),
            Self::Message(message) => message.clone(),
            Self::Data(data) => Message::data(data),
        }
    }

    /// Returns the text in English, which tells widgets apart in every language.
    pub(crate) fn english(self) -> Cow<'a, str> {
        match self {
            Self::Word(word) => Cow::Borrowed(word.english()),
            Self::Message(message) => Cow::Owned(message.to_string()),
            Self::Data(data) => Cow::Borrowed(data),
        }
    }
}

impl Default for Text<'_> {
    fn default() -> Self {
        Self::EMPTY
    }
}

impl From<Word> for Text<'_> {
    fn from(word: Word) -> Self {
        Self::Word(word)
    }
}

impl<'a> From<&'a Message> for Text<'a> {
    fn from(message: &'a Message) -> Self {
        Self::Message(message)
    }
}
