//! The rows of the table of parameters as values.

#[cfg_attr(
    not(test),
    expect(clippy::wildcard_imports, reason = "the rows name the types of nearly all choices")
)]
use super::choices::*;
use super::grammar::ListKind;
use super::key::Key;
use super::param::{Group, Kind, Mark, Param, Start};
use super::table::parameters;

/// Expands to the labs after `in` in a row.
macro_rules! labs {
    () => { &[] };
    ([$($lab:ident),*]) => { &[$(LabId::$lab),*] };
    ($labs:ident) => { $labs };
}

macro_rules! rows {
    ($($key:ident $name:literal $label:literal $group:ident$(($lab:ident))?, $kind:expr, $default:expr, $unit:literal, $help:literal $([$($mark:ident),*])? $(in $labs:tt)?;)*) => {
        /// Every parameter, in the order of links and panels.
        pub static PARAMS: &[Param] = &[$(Param {
            key: Key::$key, name: $name, label: $label, kind: $kind, unit: $unit, group: Group::$group$((LabId::$lab))?, help: $help, marks: &[$($(Mark::$mark),*)?], shared_with: labs!($($labs)?), default: $default,
        }),*];
    };
}

const fn number(min: f64, max: f64, step: f64) -> Kind {
    Kind::Number { min, max, step, auto: false, logarithmic: false }
}
const fn auto(min: f64, max: f64, step: f64) -> Kind {
    Kind::Number { min, max, step, auto: true, logarithmic: false }
}
const fn logarithmic(min: f64, max: f64, step: f64) -> Kind {
    Kind::Number { min, max, step, auto: false, logarithmic: true }
}

parameters!(rows);

impl Key {
    /// Returns the row of this parameter.
    #[must_use]
    pub fn param(self) -> &'static Param {
        &PARAMS[self as usize]
    }

    /// Returns the parameter with that name in links.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        PARAMS.iter().find(|param| param.name == name).map(|param| param.key)
    }
}
