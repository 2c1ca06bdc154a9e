//! Values of parameters, and the reasons why one does not fit.

use super::choices::Selected;
use super::grammar::{List, Misread};
use super::key::Key;
use crate::outside::short;
use segue_text::{Message, msg};

/// The value of a parameter.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// Left to Segue.
    Auto,
    /// A number.
    Number(f64),
    /// A switch.
    Switch(bool),
    /// The key of a choice.
    Choice(&'static str),
    /// A clip's id or free text.
    Text(String),
    /// A list.
    List(List),
    /// Several values of a parameter; `None` for one pane.
    Compare(Option<Compare>),
}

/// Two to four values of one parameter, each in a pane of its own: `blend_window:30,15,10`,
/// `method:inertialize,smooth`, `a:walk,run`.
#[derive(Clone, Debug, PartialEq)]
pub struct Compare {
    /// The parameter in which the panes differ.
    pub key: Key,
    /// Its value in each pane, in order.
    pub values: Vec<Value>,
}

/// The greatest number of panes side by side.
pub const MAX_PANES: usize = 4;

impl Value {
    /// Returns a choice as its type; `None` for anything else.
    #[must_use]
    pub fn choice<C: Selected>(&self) -> Option<C> {
        match self {
            Self::Choice(word) => C::from_word(word),
            _ => None,
        }
    }
}

impl From<List> for Value {
    fn from(list: List) -> Self {
        Self::List(list)
    }
}

impl<C: Selected> From<C> for Value {
    fn from(choice: C) -> Self {
        Self::Choice(choice.word())
    }
}

/// The reason why a value does not fit its parameter.
#[derive(Clone, Debug, PartialEq, thiserror::Error, segue_text::ToMessage)]
pub enum ValueError {
    /// Not a number.
    #[error(
        "{key}: found `{found}`, expected a number{unit}{auto}",
        found = short(.found), unit = of_unit(.unit), auto = or_auto(*.auto)
    )]
    NotANumber {
        /// The parameter.
        key: &'static str,
        /// The value found.
        found: String,
        /// The unit of the parameter.
        unit: &'static str,
        /// Whether `auto` is valid.
        auto: bool,
    },
    /// A number outside the range.
    #[error("{key}: found {found}, expected {min} to {max}{unit}", unit = unit_suffix(.unit))]
    OutOfRange {
        /// The parameter.
        key: &'static str,
        /// The value found.
        found: f64,
        /// Smallest value.
        min: f64,
        /// Largest value.
        max: f64,
        /// The unit of the parameter.
        unit: &'static str,
    },
    /// A word that is not one of the choices.
    #[error("{key}: found `{found}`, expected {expected}", found = short(.found))]
    NotAChoice {
        /// The parameter.
        key: &'static str,
        /// The word found.
        found: String,
        /// The valid words.
        expected: String,
    },
    /// A list that cannot be read.
    #[error("{key}: {error}")]
    Misread {
        /// The parameter.
        key: &'static str,
        /// The reason, with its place.
        error: Misread,
    },
    /// A text that is not a comparison.
    #[error("compare: found `{found}`, expected {expected}", found = short(.found))]
    NotAComparison {
        /// The text found.
        found: String,
        /// A description of a valid text.
        expected: Message,
    },
}

fn of_unit(unit: &'static str) -> Message {
    if unit.is_empty() { Message::default() } else { msg!(" of {unit}") }
}

fn or_auto(auto: bool) -> Message {
    if auto { Message::word(" or `auto`") } else { Message::default() }
}

fn unit_suffix(unit: &'static str) -> Message {
    if unit.is_empty() { Message::default() } else { msg!(" {unit}") }
}
