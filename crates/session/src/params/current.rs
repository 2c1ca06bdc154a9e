//! The current value of every parameter.

use super::param::{Kind, Param};
use super::table::{Key, PARAMS};
use super::value::{Value, ValueError};
use crate::{LabId, Selected};
use std::fmt;

/// The current value of every parameter.
#[derive(Clone, PartialEq)]
pub struct Params(Vec<Value>);

impl Default for Params {
    fn default() -> Self {
        Self(PARAMS.iter().map(Param::default_value).collect())
    }
}

impl fmt::Debug for Params {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_map()
            .entries(self.changed().map(|(param, value)| (param.name, param.format(value))))
            .finish()
    }
}

impl Params {
    /// The value of a parameter.
    #[must_use]
    pub fn get(&self, key: Key) -> &Value {
        &self.0[key as usize]
    }

    /// Sets a value after checking it; says whether it was another before.
    ///
    /// # Errors
    /// [`ValueError`]; nothing is changed then.
    pub fn set(&mut self, key: Key, value: Value) -> Result<bool, ValueError> {
        let value = key.param().check(value)?;
        let slot = &mut self.0[key as usize];
        let changed = *slot != value;
        *slot = value;
        Ok(changed)
    }

    /// Takes one value over from another set.
    pub(crate) fn copy_from(&mut self, other: &Self, key: Key) {
        self.0[key as usize] = other.0[key as usize].clone();
    }

    /// A number; `None` where it is left to Segue.
    #[must_use]
    pub fn optional(&self, key: Key) -> Option<f64> {
        if let Value::Number(number) = self.get(key) { Some(*number) } else { None }
    }

    /// A number that is never `auto`. 0 for a parameter that is no number.
    #[must_use]
    pub fn number(&self, key: Key) -> f64 {
        self.optional(key).unwrap_or_default()
    }

    /// A switch. `false` for a parameter that is none.
    #[must_use]
    pub fn is_on(&self, key: Key) -> bool {
        *self.get(key) == Value::Switch(true)
    }

    /// Returns a clip's id or a text; the empty text for a parameter of another kind. Choices have
    /// types: [`Params::choice`].
    #[must_use]
    pub fn text(&self, key: Key) -> &str {
        debug_assert!(
            matches!(key.param().kind, Kind::Clip | Kind::Text | Kind::Compare),
            "{key:?} is no text"
        );
        match self.get(key) {
            Value::Text(text) => text,
            _ => "",
        }
    }

    /// Returns the word in the link of a choice whose type the caller does not know; the empty word
    /// for a parameter of another kind.
    #[must_use]
    pub fn word(&self, key: Key) -> &'static str {
        match self.get(key) {
            Value::Choice(word) => word,
            _ => "",
        }
    }

    /// Returns the value of a choice.
    #[must_use]
    pub fn choice<C: Selected>(&self) -> C {
        // A value is checked before it is set, so that it is always one of the choices.
        self.get(C::KEY).choice().unwrap_or(C::FIRST)
    }

    /// Returns the lab that is open.
    #[must_use]
    pub fn lab(&self) -> LabId {
        self.choice()
    }

    /// The parameters that differ from their default, in the order of the table.
    pub fn changed(&self) -> impl Iterator<Item = (&'static Param, &Value)> {
        PARAMS.iter().zip(&self.0).filter(|(param, value)| **value != param.default_value())
    }
}
