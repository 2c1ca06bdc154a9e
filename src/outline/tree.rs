//! The tree of elements that the page has, and its changes from frame to frame.

use super::elements::Found;
use eframe::egui::Event;
use eframe::egui::accesskit::{Node, NodeId, TreeUpdate};
use serde::Serialize;
use std::collections::HashMap;

/// The elements that the page has, and what was done with them.
#[derive(Default)]
pub(super) struct Tree {
    /// The reader's events that egui has not yet been given.
    pub(super) events: Vec<Event>,
    pub(super) is_enabled: bool,
    pub(super) has_keyboard: bool,
    pub(super) numbers: HashMap<NodeId, u32>,
    pub(super) nodes: HashMap<u32, NodeId>,
    pub(super) elements: HashMap<u32, Element>,
    pub(super) focus: Option<u32>,
    pub(super) last_number: u32,
}

/// The differences from the frame before.
#[derive(Debug, Default, PartialEq, Serialize)]
pub(super) struct Changes {
    /// Elements that are new, or not as they were.
    pub(super) elements: Vec<Element>,
    /// The numbers of those that are gone.
    pub(super) gone: Vec<u32>,
    /// The number of the element with the focus; 0 for none.
    pub(super) focus: u32,
    /// The numbers of the outermost elements, in reading order.
    pub(super) top: Vec<u32>,
    /// The words of the link that goes past the other parts to the parameters.
    pub(super) skip: String,
}

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
    /// Left, top, width, height in pixels of the page.
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

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde asks for a reference")]
fn is_false(value: &bool) -> bool {
    !value
}

impl Tree {
    /// Returns what the page has to change, or nothing where it is in step. `zoom` is the number of
    /// pixels of the page for a point.
    pub(super) fn changes(&mut self, update: &TreeUpdate, zoom: f64) -> Option<Changes> {
        let root = update.tree.as_ref()?.root;
        let all: HashMap<NodeId, &Node> =
            update.nodes.iter().map(|(id, node)| (*id, node)).collect();
        let mut found = Found { all: &all, zoom, elements: Vec::new() };
        let mut top = found.children_of(root, false, self);
        found.sort_parts(&mut top);
        let elements = found.elements;

        let mut changes = Changes { top, ..Changes::default() };
        let mut now = HashMap::with_capacity(elements.len());
        for element in elements {
            if self.elements.get(&element.number) != Some(&element) {
                changes.elements.push(element.clone());
            }
            now.insert(element.number, element);
        }
        changes.gone =
            self.elements.keys().filter(|number| !now.contains_key(number)).copied().collect();
        changes.gone.sort_unstable();
        for number in &changes.gone {
            if let Some(id) = self.nodes.remove(number) {
                self.numbers.remove(&id);
            }
        }
        let focus =
            self.numbers.get(&update.focus).copied().filter(|number| now.contains_key(number));
        changes.focus = focus.unwrap_or(0);
        let is_same = changes.elements.is_empty() && changes.gone.is_empty() && focus == self.focus;
        self.elements = now;
        self.focus = focus;
        (!is_same).then_some(changes)
    }

    pub(super) fn number_of(&mut self, id: NodeId) -> u32 {
        if let Some(&number) = self.numbers.get(&id) {
            return number;
        }
        self.last_number += 1;
        self.numbers.insert(id, self.last_number);
        self.nodes.insert(self.last_number, id);
        self.last_number
    }
}
