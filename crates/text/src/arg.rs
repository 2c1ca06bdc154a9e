//! The arguments of messages.

use crate::{Message, ToMessage};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::sync::Arc;

/// An argument of a [`Message`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Arg {
    /// Data from outside or by the user, such as the name of a file.
    Text(String),
    /// A number of things, or any other whole number.
    Count(i64),
    /// A number.
    Number(f64),
    /// A message, translated in turn.
    Message(Message),
    /// Several arguments, with a comma, a semicolon or a space between them.
    Joined(Vec<Arg>, Cow<'static, str>),
    /// A note, `the rest pose was taken`, as a sentence.
    Note(Message),
}

impl Arg {
    pub(crate) fn collect_templates<'a>(&'a self, found: &mut Vec<&'a str>) {
        match self {
            Self::Text(_) | Self::Count(_) | Self::Number(_) => {}
            Self::Message(message) | Self::Note(message) => found.extend(message.templates()),
            Self::Joined(parts, between) => {
                for part in parts {
                    part.collect_templates(found);
                }
                found.push(between);
            }
        }
    }
}

/// A type whose values can be arguments of a [`Message`].
pub trait ToArg {
    /// Returns the argument.
    fn to_arg(&self) -> Arg;
}

impl ToArg for &'static str {
    fn to_arg(&self) -> Arg {
        Arg::Message(Message::word(self))
    }
}

impl ToArg for String {
    fn to_arg(&self) -> Arg {
        Arg::Text(self.clone())
    }
}

impl ToArg for Arc<str> {
    fn to_arg(&self) -> Arg {
        Arg::Text(self.to_string())
    }
}

impl ToArg for char {
    fn to_arg(&self) -> Arg {
        Arg::Text(self.to_string())
    }
}

impl ToArg for f64 {
    fn to_arg(&self) -> Arg {
        Arg::Number(*self)
    }
}

impl ToArg for f32 {
    /// Uses the shortest number that reads as this one: 0.1 stays 0.1.
    fn to_arg(&self) -> Arg {
        Arg::Number(self.to_string().parse().unwrap_or(f64::from(*self)))
    }
}

macro_rules! whole_numbers {
    ($($number:ty)*) => {$(
        impl ToArg for $number {
            fn to_arg(&self) -> Arg {
                Arg::Count(i64::try_from(*self).unwrap_or(i64::MAX))
            }
        }
    )*};
}

whole_numbers!(u8 u16 u32 u64 usize i32 i64);

impl ToArg for Message {
    fn to_arg(&self) -> Arg {
        Arg::Message(self.clone())
    }
}

impl<T: ToArg> ToArg for Vec<T> {
    fn to_arg(&self) -> Arg {
        Arg::Joined(self.iter().map(ToArg::to_arg).collect(), Cow::Borrowed(", "))
    }
}

impl<T: ToMessage> ToMessage for Box<T> {
    fn to_message(&self) -> Message {
        self.as_ref().to_message()
    }
}
