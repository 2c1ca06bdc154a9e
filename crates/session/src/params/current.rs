//! The current value of every parameter.

use super::choices::{LabId, Selected};
use super::key::Key;
use super::param::{Kind, Param, Start};
use super::rows::PARAMS;
use super::value::{Compare, Value, ValueError};
use std::fmt;
use std::sync::LazyLock;

/// The current value of every parameter.
#[derive(Clone, PartialEq)]
pub struct Params(Vec<Value>);

/// The values in a new document.
static DEFAULTS: LazyLock<Params> =
    LazyLock::new(|| Params(PARAMS.iter().map(start_value).collect()));

fn start_value(param: &Param) -> Value {
    match param.default {
        Start::Auto => Value::Auto,
        Start::Number(number) => Value::Number(number),
        Start::Switch(on) => Value::Switch(on),
        Start::Choice(word) => Value::Choice(word),
        Start::Text(text) => {
            let value = param.parse(text);
            debug_assert!(value.is_ok(), "{value:?}");
            value.unwrap_or_else(|_| Value::Text(text.to_owned()))
        }
    }
}

impl Default for Params {
    fn default() -> Self {
        DEFAULTS.clone()
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
    /// Returns the value of a parameter.
    #[must_use]
    pub fn get(&self, key: Key) -> &Value {
        &self.0[key as usize]
    }

    /// Sets a value after checking it; returns whether it changed.
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

    /// Copies one value from another set.
    pub(crate) fn copy_from(&mut self, other: &Self, key: Key) {
        self.0[key as usize] = other.0[key as usize].clone();
    }

    /// Returns a number; `None` if it is left to Segue.
    #[must_use]
    pub fn optional(&self, key: Key) -> Option<f64> {
        if let Value::Number(number) = self.get(key) { Some(*number) } else { None }
    }

    /// Returns a number that is never `auto`; 0 for a parameter that is not a number.
    #[must_use]
    pub fn number(&self, key: Key) -> f64 {
        self.optional(key).unwrap_or_default()
    }

    /// Returns the state of a switch; `false` for a parameter that is not a switch.
    #[must_use]
    pub fn is_on(&self, key: Key) -> bool {
        *self.get(key) == Value::Switch(true)
    }

    /// Returns a clip's id or a text; the empty text for a parameter of another kind. Choices and
    /// lists have types of their own: [`Params::choice`], [`Params::pins`] and others.
    #[must_use]
    pub fn text(&self, key: Key) -> &str {
        debug_assert!(
            matches!(key.param().kind, Kind::Clip | Kind::Joint | Kind::Character | Kind::Text),
            "{key:?} is no text"
        );
        match self.get(key) {
            Value::Text(text) => text,
            _ => "",
        }
    }

    /// Returns the word in links of a choice whose type the caller does not know; the empty word
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

    /// Returns the comparison that is open; `None` for one pane.
    #[must_use]
    pub fn compare(&self) -> Option<&Compare> {
        match self.get(Key::Compare) {
            Value::Compare(compare) => compare.as_ref(),
            _ => None,
        }
    }

    /// Returns whether a parameter differs from its default.
    #[must_use]
    pub fn is_changed(&self, key: Key) -> bool {
        self.get(key) != DEFAULTS.get(key)
    }

    /// Returns the parameters that differ from their default, in the order of the table.
    pub fn changed(&self) -> impl Iterator<Item = (&'static Param, &Value)> {
        PARAMS.iter().zip(&self.0).filter(|(param, _)| self.is_changed(param.key))
    }
}

impl Param {
    /// Returns the value that the parameter has in a new document.
    #[must_use]
    pub fn default_value(&self) -> Value {
        DEFAULTS.get(self.key).clone()
    }
}
