//! An element of the page.

use serde::Serialize;

/// An element of the page, in the terms of ARIA.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub(super) struct Element {
    pub(super) number: u32,
    /// An ARIA role, or `text` or `edit`.
    pub(super) role: &'static str,
    #[serde(skip_serializing_if = "String::is_empty")]
    pub(super) name: String,
    #[serde(skip_serializing_if = "String::is_empty")]
    pub(super) description: String,
    /// The value in words, or the text that is edited.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub(super) value: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) range: Option<Range>,
    /// `true`, `false` or `mixed` for `aria-checked`, `aria-pressed` or `aria-selected`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) state: Option<(&'static str, &'static str)>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) expanded: Option<bool>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) popup: Option<&'static str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) level: Option<usize>,
    #[serde(skip_serializing_if = "is_false")]
    pub(super) disabled: bool,
    #[serde(skip_serializing_if = "is_false")]
    pub(super) focusable: bool,
    #[serde(skip_serializing_if = "is_false")]
    pub(super) modal: bool,
    /// Left, top, width and height, pixels of the page.
    pub(super) place: [i32; 4],
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(super) children: Vec<u32>,
}

/// The values of a slider, a meter or a progress bar.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct Range {
    pub(super) now: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) min: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) max: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) step: Option<f64>,
}

/// The new value of an element, which changes while all else stays as it is.
#[derive(Debug, PartialEq, Serialize)]
pub(super) struct NewValue {
    number: u32,
    /// The text of an element that is one, or else its name, which has not changed.
    name: String,
    /// As in [`Element`].
    #[serde(skip_serializing_if = "String::is_empty")]
    value: String,
    /// As in [`Range`].
    #[serde(skip_serializing_if = "Option::is_none")]
    now: Option<f64>,
}

impl From<Element> for NewValue {
    fn from(Element { number, name, value, range, .. }: Element) -> Self {
        Self { number, name, value, now: range.map(|range| range.now) }
    }
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde asks for a reference")]
fn is_false(value: &bool) -> bool {
    !value
}
