//! Values as text: in links, in ids of kept results, in the page's API.

use super::param::{Choice, Kind, Param};
use super::value::{Value, ValueError};
use crate::compare::Compare;
use segue_text::Message;
use serde_json::Value as Json;

impl Param {
    /// Checks a value and brings it into its normal form: numbers are snapped to the step.
    ///
    /// # Errors
    /// [`ValueError`] names the key, what was found and what would do.
    pub fn check(&self, value: Value) -> Result<Value, ValueError> {
        match (self.kind, value) {
            (Kind::Number { min, max, step, .. }, Value::Number(number)) => {
                let snapped = snap(number, step);
                if snapped.is_finite() && snapped >= min && snapped <= max {
                    Ok(Value::Number(snapped))
                } else {
                    Err(ValueError::OutOfRange {
                        key: self.name,
                        found: number,
                        min,
                        max,
                        unit: self.unit,
                    })
                }
            }
            // Everything else has one normal form, the one that a link reads.
            (_, value) => self.parse(&self.format(&value)),
        }
    }

    fn not_a_choice(&self, found: &str, choices: &[Choice]) -> ValueError {
        let expected = choices.iter().map(|c| c.key).collect::<Vec<_>>().join(", ");
        ValueError::NotAChoice { key: self.name, found: found.to_owned(), expected }
    }

    /// Returns a value as it is said on screen.
    #[must_use]
    pub fn spoken(&self, value: &Value) -> Message {
        let word = self.format(value);
        match self.kind {
            Kind::Choice(choices) => choices
                .iter()
                .find(|choice| choice.key == word)
                .map_or_else(|| Message::data(word.clone()), |choice| choice.label.into()),
            _ => Message::data(word),
        }
    }

    /// Reads the value from a link.
    ///
    /// # Errors
    /// [`ValueError`] names the key, what was found and what would do.
    pub fn parse(&self, text: &str) -> Result<Value, ValueError> {
        match self.kind {
            Kind::Number { auto: true, .. } if text == "auto" => Ok(Value::Auto),
            Kind::Number { auto, .. } => match text.trim().parse::<f64>() {
                Ok(number) if number.is_finite() => self.check(Value::Number(number)),
                _ => Err(ValueError::NotANumber {
                    key: self.name,
                    found: text.to_owned(),
                    unit: self.unit,
                    auto,
                }),
            },
            Kind::Switch => match text {
                "on" | "1" | "true" | "yes" => Ok(Value::Switch(true)),
                "off" | "0" | "false" | "no" => Ok(Value::Switch(false)),
                _ => Err(ValueError::NotAChoice {
                    key: self.name,
                    found: text.to_owned(),
                    expected: "on or off".into(),
                }),
            },
            Kind::Choice(choices) => match choices.iter().find(|c| c.key == text) {
                Some(found) => Ok(Value::Choice(found.key)),
                None => Err(self.not_a_choice(text, choices)),
            },
            Kind::Clip | Kind::Text => Ok(Value::Text(text.to_owned())),
            Kind::Compare if text.is_empty() => Ok(Value::Text(String::new())),
            Kind::Compare => Ok(Value::Text(Compare::parse(text)?.to_string())),
        }
    }

    /// Writes the value as [`Param::parse`] reads it, as short as it goes.
    #[must_use]
    pub fn format(&self, value: &Value) -> String {
        match (value, self.kind) {
            (Value::Number(number), Kind::Number { step, .. }) => format_number(*number, step),
            (Value::Auto, _) => "auto".to_owned(),
            (Value::Number(number), _) => number.to_string(),
            (Value::Switch(on), _) => if *on { "on" } else { "off" }.to_owned(),
            (Value::Choice(word), _) => (*word).to_owned(),
            (Value::Text(text), _) => text.clone(),
        }
    }

    /// The value as JSON for the API: numbers, booleans and strings; `"auto"` where it is left to
    /// Segue.
    #[must_use]
    pub fn to_json(&self, value: &Value) -> Json {
        match value {
            Value::Number(number) => Json::from(*number),
            Value::Switch(on) => Json::from(*on),
            other => Json::from(self.format(other)),
        }
    }

    /// Reads a value that the API was given.
    ///
    /// # Errors
    /// As [`Param::parse`].
    pub fn from_json(&self, json: &Json) -> Result<Value, ValueError> {
        match json {
            Json::Number(number) => self.check(Value::Number(number.as_f64().unwrap_or(f64::NAN))),
            Json::Bool(on) => self.parse(if *on { "on" } else { "off" }),
            Json::String(text) => self.parse(text),
            other => self.parse(&other.to_string()),
        }
    }
}

fn snap(number: f64, step: f64) -> f64 {
    // Multiplying by 0.01 leaves 0.30000000000000004; dividing by 100 does not.
    let per_unit = (1.0 / step).round();
    if per_unit >= 1.0 && (per_unit * step - 1.0).abs() < 1e-9 {
        (number * per_unit).round() / per_unit
    } else {
        (number / step).round() * step
    }
}

/// `number` with the decimals that `step` calls for, trailing zeros dropped.
#[must_use]
pub fn format_number(number: f64, step: f64) -> String {
    let decimals = decimals_of(step);
    let text = format!("{number:.decimals$}");
    let text = if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    };
    if text == "-0" { "0".to_owned() } else { text }
}

/// How many decimals values of that step have.
#[must_use]
pub fn decimals_of(step: f64) -> usize {
    (0..6)
        .find(|&decimals| {
            ((step * 10f64.powi(decimals)).round() - step * 10f64.powi(decimals)).abs() < 1e-9
        })
        .unwrap_or(6) as usize
}
