//! Values as text: in links, in ids of kept results, in the page's API.

use super::choices::Choice;
use super::grammar::{parts, read_id, write_ids};
use super::key::Key;
use super::param::{Kind, Param};
use super::value::{Compare, MAX_PANES, Value, ValueError};
use crate::outside::short;
use segue_text::{Message, msg};
use serde_json::Value as Json;
use std::fmt;

impl Param {
    /// Checks a value and converts it to its normal form: numbers are rounded to the step.
    ///
    /// # Errors
    /// [`ValueError`] names the key, the value found and the values expected.
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
            // All other values have one normal form, the one that a link reads.
            (_, value) => self.parse(&self.format(&value)),
        }
    }

    fn not_a_choice(&self, found: &str, choices: &[Choice]) -> ValueError {
        let expected = choices.iter().map(|c| c.key).collect::<Vec<_>>().join(", ");
        ValueError::NotAChoice { key: self.name, found: found.to_owned(), expected }
    }

    /// Returns a value as it is shown on screen.
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
    /// [`ValueError`] names the key, the value found and the values expected.
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
            Kind::Clip | Kind::Joint | Kind::Character | Kind::Text => {
                Ok(Value::Text(text.to_owned()))
            }
            Kind::List(kind) => match kind.read(text) {
                Ok(list) => Ok(Value::List(list)),
                Err(error) => Err(ValueError::Misread { key: self.name, error }),
            },
            Kind::Compare if text.is_empty() => Ok(Value::Compare(None)),
            Kind::Compare => Ok(Value::Compare(Some(Compare::parse(text)?))),
        }
    }

    /// Writes the value as [`Param::parse`] reads it, in its shortest form.
    #[must_use]
    pub fn format(&self, value: &Value) -> String {
        match (value, self.kind) {
            (Value::Number(number), Kind::Number { step, .. }) => format_number(*number, step),
            (Value::Auto, _) => "auto".to_owned(),
            (Value::Number(number), _) => number.to_string(),
            (Value::Switch(on), _) => if *on { "on" } else { "off" }.to_owned(),
            (Value::Choice(word), _) => (*word).to_owned(),
            (Value::Text(text), _) => text.clone(),
            (Value::List(list), _) => list.write(),
            (Value::Compare(compare), _) => {
                compare.as_ref().map_or_else(String::new, Compare::to_string)
            }
        }
    }

    /// Returns the value as JSON for the API: numbers, booleans and strings; `"auto"` if it is left
    /// to Segue.
    #[must_use]
    pub fn to_json(&self, value: &Value) -> Json {
        match value {
            Value::Number(number) => Json::from(*number),
            Value::Switch(on) => Json::from(*on),
            other => Json::from(self.format(other)),
        }
    }

    /// Reads a value from the API.
    ///
    /// # Errors
    /// Those of [`Param::parse`].
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

/// Writes a number with the decimals of `step`, without trailing zeros.
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

/// Returns the number of decimals of values with that step.
#[must_use]
pub fn decimals_of(step: f64) -> usize {
    (0..6)
        .find(|&decimals| {
            ((step * 10f64.powi(decimals)).round() - step * 10f64.powi(decimals)).abs() < 1e-9
        })
        .unwrap_or(6) as usize
}

/// A comparison and its values have one grammar: each value is one of the compared parameter.
impl Compare {
    /// Reads `key:value,value,…`.
    ///
    /// # Errors
    /// [`ValueError`] when the key cannot be compared, a value does not fit it, or there are not
    /// two to four values.
    pub fn parse(text: &str) -> Result<Self, ValueError> {
        let refuse =
            |expected: Message| ValueError::NotAComparison { found: text.to_owned(), expected };
        let (name, list) = text
            .split_once(':')
            .ok_or_else(|| refuse("`key:value,value`, as in blend_window:30,15,10".into()))?;
        let key = Key::from_name(name.trim())
            .filter(|key| key.param().is_comparable())
            .ok_or_else(|| {
                refuse(msg!(
                    "a number or a choice of a lab, or a clip, before the colon, not `{found}`",
                    found = short(name)
                ))
            })?;
        let is_clip = matches!(key.param().kind, Kind::Clip);
        let words = if is_clip {
            let parts = parts(list)
                .ok_or_else(|| refuse("ids whose brackets close, separated by commas".into()))?;
            parts.into_iter().map(read_id).collect::<Vec<String>>()
        } else {
            list.split(',').map(|word| word.trim().to_owned()).collect()
        };
        let values = words
            .iter()
            .map(|word| match key.param().parse(word)? {
                Value::Auto => {
                    Err(refuse(msg!("a value for each pane, not `{found}`", found = short(word))))
                }
                value => Ok(value),
            })
            .collect::<Result<Vec<Value>, ValueError>>()?;
        if !(2..=MAX_PANES).contains(&values.len()) {
            return Err(refuse(msg!(
                "2 to {most} values, not {count}",
                most = MAX_PANES,
                count = values.len()
            )));
        }
        Ok(Self { key, values })
    }
}

impl fmt::Display for Compare {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let param = self.key.param();
        let values: Vec<String> = self.values.iter().map(|value| param.format(value)).collect();
        let values = match param.kind {
            Kind::Clip => write_ids(&values),
            _ => values.join(","),
        };
        write!(f, "{}:{values}", param.name)
    }
}
