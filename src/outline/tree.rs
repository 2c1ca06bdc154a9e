//! The tree of elements on the page, and its changes from frame to frame.

use super::element::Element;
use super::elements::Found;
use super::numbers::Numbers;
use eframe::egui::Event;
use eframe::egui::accesskit::{Node, NodeId, TreeUpdate};
use serde::Serialize;
use std::collections::HashMap;

/// The elements on the page, and the reader's events on them.
#[derive(Default)]
pub(super) struct Tree {
    /// The reader's events that egui has not yet been given.
    pub(super) events: Vec<Event>,
    pub(super) is_enabled: bool,
    pub(super) has_keyboard: bool,
    pub(super) numbers: Numbers,
    elements: HashMap<u32, Element>,
    focus: Option<u32>,
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
    /// The text of the link that skips to the parameters.
    pub(super) skip: String,
}

impl Tree {
    /// Returns the changes for the page; `None` where it is up to date. `zoom` is the number of
    /// pixels of the page for a point.
    pub(super) fn changes(&mut self, update: &TreeUpdate, zoom: f64) -> Option<Changes> {
        let root = update.tree.as_ref()?.root;
        let all: HashMap<NodeId, &Node> =
            update.nodes.iter().map(|(id, node)| (*id, node)).collect();
        let mut found = Found { all: &all, zoom, elements: Vec::new(), numbers: &mut self.numbers };
        let mut top = found.children_of(root, false);
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
            self.numbers.forget(*number);
        }
        let focus = self.numbers.known(update.focus).filter(|number| now.contains_key(number));
        changes.focus = focus.unwrap_or(0);
        let is_same = changes.elements.is_empty() && changes.gone.is_empty() && focus == self.focus;
        self.elements = now;
        self.focus = focus;
        (!is_same).then_some(changes)
    }
}
