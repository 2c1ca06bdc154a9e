//! The tree of elements on the page, and its changes from frame to frame.

use super::element::{Element, NewValue};
use super::elements::{Found, is_text};
use super::numbers::Numbers;
use eframe::egui::Event;
use eframe::egui::accesskit::{Node, NodeId, Role, TreeUpdate};
use serde::Serialize;
use std::collections::{HashMap, HashSet};

/// The elements on the page, and the reader's events on them.
#[derive(Default)]
pub(super) struct Tree {
    /// The reader's events that egui has not yet been given.
    pub(super) events: Vec<Event>,
    pub(super) is_enabled: bool,
    pub(super) has_keyboard: bool,
    pub(super) numbers: Numbers,
    pub(super) elements: HashMap<u32, Element>,
    /// The numbers of the outermost elements, in reading order.
    top: Vec<u32>,
    focus: Option<u32>,
    /// The nodes of the frame before.
    nodes: Vec<(NodeId, Node)>,
    /// Those of them that are labels of others.
    labels: HashSet<NodeId>,
    zoom: f64,
}

/// What the page is told of a frame.
#[derive(Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub(super) enum Changes {
    /// Elements differ in their values alone: so it is in nearly all frames while a motion plays.
    Values {
        values: Vec<NewValue>,
    },
    Elements(ElementChanges),
}

/// The differences from the frame before.
#[derive(Debug, Default, PartialEq, Serialize)]
pub(super) struct ElementChanges {
    /// Elements that are new, or not as they were.
    pub(super) elements: Vec<Element>,
    /// The numbers of those that are gone.
    pub(super) gone: Vec<u32>,
    /// The number of the element with the focus; 0 for none.
    pub(super) focus: u32,
    /// The numbers of the outermost elements, in reading order.
    pub(super) top: Vec<u32>,
    /// The text of the link that skips to the parameters.
    pub(super) skip: String,
}

impl Tree {
    /// Returns whether the page has been told of elements.
    pub(super) fn is_known(&self) -> bool {
        !self.nodes.is_empty()
    }

    /// Returns the changes for the page; `None` where it is up to date. `zoom` is the number of
    /// pixels of the page for a point, `skip` returns the text of the link to the parameters.
    pub(super) fn changes(
        &mut self,
        update: TreeUpdate,
        zoom: f64,
        skip: impl FnOnce() -> String,
    ) -> Option<Changes> {
        let with_values = self.new_values(&update.nodes, zoom);
        let only_values = with_values.is_some();
        let changes = if let Some(elements) = with_values {
            for element in &elements {
                self.elements.insert(element.number, element.clone());
            }
            ElementChanges { elements, ..ElementChanges::default() }
        } else {
            self.new_elements(&update, zoom)?
        };
        self.nodes = update.nodes;

        let focus = self.numbers.known(update.focus);
        let focus = focus.filter(|number| self.elements.contains_key(number));
        let keeps_focus = focus == self.focus;
        self.focus = focus;
        if changes.elements.is_empty() && changes.gone.is_empty() && keeps_focus {
            return None;
        }
        if only_values && keeps_focus {
            let values = changes.elements.into_iter().map(NewValue::from).collect();
            return Some(Changes::Values { values });
        }
        let (focus, top) = (focus.unwrap_or(0), self.top.clone());
        Some(Changes::Elements(ElementChanges { focus, top, skip: skip(), ..changes }))
    }

    /// Returns the elements that are not as they were, if none of them differs in more than its
    /// value; otherwise returns `None`.
    pub(super) fn new_values(&self, nodes: &[(NodeId, Node)], zoom: f64) -> Option<Vec<Element>> {
        if nodes.len() != self.nodes.len() || zoom.to_bits() != self.zoom.to_bits() {
            return None;
        }
        let mut elements = Vec::new();
        for ((id_before, before), (id, node)) in self.nodes.iter().zip(nodes) {
            if id != id_before {
                return None;
            }
            if node == before || node.role() == Role::TextRun && before.role() == Role::TextRun {
                continue;
            }
            // The name of another element.
            if self.labels.contains(id) && node.value() != before.value() {
                return None;
            }
            let element = self.elements.get(&self.numbers.known(*id)?)?;
            elements.push(with_value(element, before, node)?);
        }
        Some(elements)
    }

    /// Makes all elements anew, and returns the changes; `None` without a tree.
    fn new_elements(&mut self, update: &TreeUpdate, zoom: f64) -> Option<ElementChanges> {
        let root = update.tree.as_ref()?.root;
        self.zoom = zoom;
        self.labels =
            update.nodes.iter().flat_map(|(_, node)| node.labelled_by()).copied().collect();
        let all: HashMap<NodeId, &Node> =
            update.nodes.iter().map(|(id, node)| (*id, node)).collect();
        let mut found = Found { all: &all, zoom, elements: Vec::new(), numbers: &mut self.numbers };
        self.top = found.children_of(root, false);
        found.sort_parts(&mut self.top);
        let elements = found.elements;

        let mut changes = ElementChanges::default();
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
            self.numbers.forget(*number);
        }
        self.elements = now;
        Some(changes)
    }
}

/// Returns an element with the value of its node; `None` where more has changed.
fn with_value(element: &Element, before: &Node, now: &Node) -> Option<Element> {
    // The values before, and all else as it is now. A value that comes or goes is more than another
    // one.
    let mut others = now.clone();
    if let (Some(value), Some(_)) = (before.value(), now.value()) {
        others.set_value(value);
    }
    if let (Some(value), Some(_)) = (before.numeric_value(), now.numeric_value()) {
        others.set_numeric_value(value);
    }
    if others != *before {
        return None;
    }
    let mut element = element.clone();
    let value = now.value().unwrap_or_default();
    if is_text(now) {
        // A text may have been left out as empty, or its description as the same.
        if value.is_empty() || element.name.is_empty() || now.description().is_some() {
            return None;
        }
        value.clone_into(&mut element.name);
    } else {
        value.clone_into(&mut element.value);
    }
    if let (Some(range), Some(now)) = (&mut element.range, now.numeric_value()) {
        range.now = now;
    }
    Some(element)
}
