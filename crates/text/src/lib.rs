//! Messages as data: a template with named arguments, written out in a language when it is shown.
//!
//! # The idea
//!
//! A text of the program is a [`Message`]: an English template and its arguments, each with its
//! type. The [`Table`] of a language has its own template for it, with its own order, plural forms
//! and digits. The English template is the key, as with gettext: a message without a translation is
//! still an English sentence.
//!
//! # Templates
//!
//! | | inserted text |
//! |---|---|
//! | `{name}` | the argument |
//! | `{cm:.1}` | a number, rounded to this many decimals |
//! | `{secs:02}` | a number with leading zeros, with this many digits |
//! | `{n, plural, one {# bone} other {# bones}}` | a form by a count: `=0` and the like for one number, `one` for 1, `other` for the rest; `#` is the count |
//! | `{side, select, left {…} other {…}}` | a form by a word |
//! | `{{`, `}}` | a brace |
//!
//! # Arguments
//!
//! | type | meaning |
//! |---|---|
//! | `String`, `Arc<str>` | data, such as the name of a file: shown as it is |
//! | `&'static str` | a word of the program: a message of its own |
//! | numbers | written by the template |
//! | [`Message`], errors with [`ToMessage`] | translated in turn |
//! | `Vec` of these | a list, with the comma of the language |
//!
//! # Example
//!
//! The text and the fields of an error are written once: `thiserror` and [`ToMessage`] read the
//! same attribute.
//!
//! ```
//! use segue_text::{Table, ToMessage, msg};
//!
//! #[derive(Debug, thiserror::Error, ToMessage)]
//! enum WindowError {
//!     #[error("a window of {frames} frames does not fit: lower it to {most}", most = .clip - 1)]
//!     TooLong { frames: usize, clip: usize },
//! }
//!
//! let error = WindowError::TooLong { frames: 40, clip: 31 };
//! let message = msg!("No transition: {error}.", error);
//! assert_eq!(
//!     message.to_string(),
//!     "No transition: a window of 40 frames does not fit: lower it to 30."
//! );
//! let table = Table::new([
//!     ("No transition: {error}.", "沒有轉場：{error}。"),
//!     (
//!         "a window of {frames} frames does not fit: lower it to {most}",
//!         "視窗最多 {most} 個影格，{frames} 個放不下",
//!     ),
//! ]);
//! assert_eq!(table.write(&message), "沒有轉場：視窗最多 30 個影格，40 個放不下。");
//! ```
//!
//! # What it does not do
//!
//! Plurals have the English forms `one` and `other`; a language with more forms needs its rule in
//! this crate. Dates, currencies and right-to-left text are not supported.

mod arg;
mod table;
mod template;

pub use arg::{Arg, ToArg};
pub use segue_text_derive::{ToMessage, msg};
pub use table::{Table, TemplateError};
pub use template::text_of_template;

// The macros' paths must also hold in this crate's own tests.
extern crate self as segue_text;

use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::fmt;

/// A text of the program that is not written out yet.
///
/// Its `Display` is the English text.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Message {
    template: Cow<'static, str>,
    args: Vec<(Cow<'static, str>, Arg)>,
}

impl Message {
    /// Returns a message of a template and its arguments. [`msg!`] checks that they fit.
    #[must_use]
    pub fn new(template: &'static str, args: Vec<(Cow<'static, str>, Arg)>) -> Self {
        Self { template: Cow::Borrowed(template), args }
    }

    /// Returns a message without arguments.
    #[must_use]
    pub const fn word(text: &'static str) -> Self {
        Self { template: Cow::Borrowed(text), args: Vec::new() }
    }

    /// Returns data as a message, such as the name of a clip. It reads the same in every language.
    #[must_use]
    pub fn data(text: impl Into<String>) -> Self {
        Self::new("{text}", vec![(Cow::Borrowed("text"), Arg::Text(text.into()))])
    }

    /// Returns several messages as one, with a comma, a semicolon or a space between them.
    #[must_use]
    pub fn joined(parts: Vec<Self>, between: &'static str) -> Self {
        let parts = parts.into_iter().map(Arg::Message).collect();
        let joined = Arg::Joined(parts, Cow::Borrowed(between));
        Self::new("{parts}", vec![(Cow::Borrowed("parts"), joined)])
    }

    /// Returns the first data in the message, such as the name of a file.
    #[must_use]
    pub fn subject(&self) -> Option<&str> {
        self.args.iter().find_map(|(_, arg)| match arg {
            Arg::Text(text) => Some(text.as_str()),
            Arg::Message(message) | Arg::Note(message) => message.subject(),
            Arg::Count(_) | Arg::Number(_) | Arg::Joined(..) => None,
        })
    }

    /// Returns a note, `the rest pose was taken`, as a sentence: `The rest pose was taken.`
    #[must_use]
    pub fn sentence(self) -> Self {
        Self::new("{note}", vec![(Cow::Borrowed("note"), Arg::Note(self))])
    }

    /// Returns whether the message has no text.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.template.is_empty()
    }

    /// Returns the template, which is the key of its translations.
    #[must_use]
    pub fn template(&self) -> &str {
        &self.template
    }

    /// Returns all templates of the message: its own, and those of its arguments.
    #[must_use]
    pub fn templates(&self) -> Vec<&str> {
        let mut found = vec![self.template()];
        for (_, arg) in &self.args {
            arg.collect_templates(&mut found);
        }
        found
    }

    fn arg(&self, name: &str) -> Option<&Arg> {
        self.args.iter().find(|(known, _)| known == name).map(|(_, arg)| arg)
    }
}

impl From<&'static str> for Message {
    fn from(word: &'static str) -> Self {
        Self::word(word)
    }
}

impl From<String> for Message {
    fn from(data: String) -> Self {
        Self::data(data)
    }
}

impl fmt::Display for Message {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        table::write_english(self, formatter)
    }
}

/// A type that can be written as a [`Message`]. Errors derive it.
pub trait ToMessage {
    /// Returns the message.
    fn to_message(&self) -> Message;

    /// Returns the message as a sentence of its own.
    fn to_sentence(&self) -> Message {
        self.to_message().sentence()
    }
}

impl ToMessage for Message {
    fn to_message(&self) -> Message {
        self.clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;

    #[derive(Debug, thiserror::Error, ToMessage)]
    enum Inner {
        #[error("joint {0} is missing")]
        Joint(usize),
        #[error("a {what} of {value:.1} is more than {MAX}")]
        Value { what: &'static str, value: f32 },
    }

    const MAX: u8 = 9;

    #[derive(Debug, thiserror::Error, ToMessage)]
    enum Outer {
        #[error(transparent)]
        Inner(#[from] Inner),
        #[error("`{name}`: {error}")]
        Named { name: String, error: Inner },
        #[error("frames {first} and {twice}", first = .0.len(), twice = double(.1))]
        Computed(Vec<u8>, usize),
        #[error("nothing")]
        Unit,
    }

    #[expect(clippy::trivially_copy_pass_by_ref, reason = "an attribute hands over references")]
    fn double(count: &usize) -> usize {
        2 * count
    }

    #[test]
    fn message_of_an_error_reads_as_its_display() {
        let inner = || Inner::Value { what: "half-life", value: 9.25 };
        for error in [
            Outer::Inner(Inner::Joint(3)),
            Outer::Named { name: "walk.bvh".to_owned(), error: inner() },
            Outer::Computed(vec![1, 2, 3], 4),
            Outer::Unit,
        ] {
            assert_eq!(error.to_message().to_string(), error.to_string(), "{error:?}");
        }
        let error = Outer::Named { name: "x".to_owned(), error: inner() };
        let table = Table::new([
            ("a {what} of {value:.1} is more than {MAX}", "{what}不能超過 {MAX}：{value:.2}"),
            ("half-life", "半衰期"),
        ]);
        assert_eq!(table.write(&error.to_message()), "`x`: 半衰期不能超過 9：9.25");
    }

    #[test]
    fn message_takes_variables_values_and_shared_text() {
        let name: Arc<str> = Arc::from("walk");
        let secs = 1.25_f64;
        let message = msg!("{name}: {secs:.1} s, {count}", count = 2 + 1);
        assert_eq!(message.to_string(), "walk: 1.2 s, 3");
        assert_eq!(message, msg!("{name}: {secs:.1} s, {count}", name, secs, count = 3));
    }

    #[test]
    fn message_of_data_is_never_translated() {
        let table = Table::new([("Walk", "走"), ("{name} is here.", "{name} 在這裡。")]);
        let told = |message: &Message| table.write(message);
        assert_eq!(told(&Message::data("Walk")), "Walk");
        assert_eq!(told(&Message::word("Walk")), "走");
        assert_eq!(told(&msg!("{name} is here.", name = "Walk".to_owned())), "Walk 在這裡。");
        assert_eq!(told(&msg!("{name} is here.", name = "Walk")), "走 在這裡。");
    }

    #[test]
    fn message_reads_back_from_json() {
        let inner = Inner::Joint(3);
        let message = msg!("{name}: {inner}, {cm:.2}", name = "a".to_owned(), cm = 0.5, inner);
        let json = serde_json::to_string(&message).expect("a message is JSON");
        assert_eq!(serde_json::from_str::<Message>(&json).expect("it is a message"), message);
    }

    #[test]
    fn sentences_are_joined_by_the_rule_of_the_language() {
        let message = Message::joined(vec!["It is so.".into(), "It is not.".into()], " ");
        assert_eq!(message.to_string(), "It is so. It is not.");
        let table = Table::new([("It is so.", "是。"), ("It is not.", "不是。"), (" ", "")]);
        assert_eq!(table.write(&message), "是。不是。");
    }
}
