//! The elements of one frame, made from the nodes of its widgets.

use super::aria::{aria_role, state};
use super::element::{Element, Range};
use super::numbers::Numbers;
use eframe::egui::accesskit::{Action, HasPopup, Node, NodeId, Role};
use std::collections::HashMap;

/// The elements of a frame, children before their parents.
pub(super) struct Found<'a> {
    pub(super) all: &'a HashMap<NodeId, &'a Node>,
    pub(super) zoom: f64,
    pub(super) elements: Vec<Element>,
    pub(super) numbers: &'a mut Numbers,
}

/// Returns whether the value of a node is its name.
pub(super) fn is_text(node: &Node) -> bool {
    matches!(node.role(), Role::Label | Role::Heading)
}

impl Found<'_> {
    /// Adds the elements in a node, and returns the numbers of its direct children. Containers
    /// without a name are replaced by their contents.
    pub(super) fn children_of(&mut self, id: NodeId, is_in_menu: bool) -> Vec<u32> {
        let Some(&node) = self.all.get(&id) else {
            return Vec::new();
        };
        let mut numbers = Vec::new();
        for &child_id in node.children() {
            let Some(&child) = self.all.get(&child_id) else {
                continue;
            };
            if child.is_hidden() || child.role() == Role::TextRun {
                continue;
            }
            let is_in_menu = is_in_menu || child.role() == Role::Menu;
            let inner = self.children_of(child_id, is_in_menu);
            if let Some(mut element) = self.element(child, inner.clone()) {
                element.number = self.numbers.number_of(child_id);
                if !is_in_menu && element.role.starts_with("menuitem") {
                    // The items of a list that is always open.
                    element.role = "button";
                    element.state = element.state.map(|(_, value)| ("aria-pressed", value));
                }
                if element.role == "banner" {
                    self.sort_line(&mut element.children);
                }
                numbers.push(element.number);
                if child.role() == Role::Button {
                    // A button has no contents: what it opens stands after it, and the button
                    // stays what it is, with the focus.
                    numbers.append(&mut element.children);
                }
                self.elements.push(element);
            } else {
                self.describe(&inner, child.description());
                numbers.extend(inner);
            }
        }
        numbers
    }

    /// Returns the element of a node, without its number; `None` for a node without information.
    fn element(&self, node: &Node, children: Vec<u32>) -> Option<Element> {
        let is_text = is_text(node);
        let name = if is_text { node.value().or(node.label()) } else { node.label() };
        let name = name.map_or_else(|| self.labels(node), str::to_owned);
        // A container with nothing but a hint is replaced by its contents.
        let is_hint = node.description() == Some(&name) && node.role() == Role::GenericContainer;
        let mut role = aria_role(node, !name.is_empty() && !is_hint)?;
        if role == "button" && node.role() != Role::Button && !children.is_empty() {
            // A window that is raised by a press.
            role = "group";
        }
        if (is_text || role == "group") && name.is_empty() && children.is_empty() {
            return None;
        }
        // The frame around a window that says what it is.
        if role == "dialog" && name.is_empty() {
            return None;
        }
        let range = node.numeric_value().map(|now| Range {
            now,
            min: node.min_numeric_value(),
            max: node.max_numeric_value(),
            step: node.numeric_value_step(),
        });
        let place = node.bounds().filter(|at| at.width() > 0.0 && at.height() > 0.0).map_or_else(
            || self.around(&children),
            |at| {
                [at.x0, at.y0, at.width(), at.height()]
                    .map(|points| (points * self.zoom).round() as i32)
            },
        );
        let description = node.description().filter(|&description| description != name);
        Some(Element {
            number: 0,
            role,
            name,
            description: description.unwrap_or_default().to_owned(),
            value: if is_text { "" } else { node.value().unwrap_or_default() }.to_owned(),
            range,
            state: state(node, role),
            expanded: node.is_expanded(),
            popup: node.has_popup().map(|popup| match popup {
                HasPopup::Menu => "menu",
                HasPopup::Listbox => "listbox",
                HasPopup::Tree => "tree",
                HasPopup::Grid => "grid",
                HasPopup::Dialog => "dialog",
            }),
            level: node.level(),
            disabled: node.is_disabled(),
            focusable: node.supports_action(Action::Focus) && !node.is_disabled(),
            modal: node.is_modal(),
            place,
            children,
        })
    }

    /// Gives the hint of a container to the first control in it, unless that has one of its own.
    fn describe(&mut self, inner: &[u32], hint: Option<&str>) {
        let Some(hint) = hint else {
            return;
        };
        let takes_hint = |element: &&mut Element| {
            let is_worked = element.focusable || element.role == "radiogroup";
            is_worked && inner.contains(&element.number)
        };
        if let Some(element) = self.elements.iter_mut().find(takes_hint)
            && element.description.is_empty()
        {
            hint.clone_into(&mut element.description);
        }
    }

    /// Returns the bounding rectangle of some elements.
    fn around(&self, numbers: &[u32]) -> [i32; 4] {
        let within = self.elements.iter().filter(|element| numbers.contains(&element.number));
        let corners = within.map(|element| element.place).filter(|place| place[2] > 0);
        let corners = corners.map(|[x, y, width, height]| [x, y, x + width, y + height]);
        let around =
            corners.reduce(|a, b| [a[0].min(b[0]), a[1].min(b[1]), a[2].max(b[2]), a[3].max(b[3])]);
        around.map_or([0; 4], |[x0, y0, x1, y1]| [x0, y0, x1 - x0, y1 - y0])
    }

    /// Returns the texts of the nodes that label this one.
    fn labels(&self, node: &Node) -> String {
        let labels = node.labelled_by().iter().filter_map(|id| self.all.get(id));
        let texts: Vec<&str> = labels.filter_map(|label| label.value().or(label.label())).collect();
        texts.join(" ")
    }

    /// Sorts the parts of the page in reading order: from the bar at the top to the timeline,
    /// overlays last.
    pub(super) fn sort_parts(&self, numbers: &mut [u32]) {
        let of = self.by_number();
        numbers.sort_by_key(|number| {
            let element = of[number];
            let rank = match element.role {
                "banner" => 0,
                "complementary" => 1,
                "main" => 2,
                "form" => 3,
                "region" => 4,
                "dialog" | "menu" | "tooltip" | "alert" => 6,
                _ => 5,
            };
            (rank, element.place[1], element.place[0])
        });
    }

    /// Sorts the elements of a line from left to right.
    fn sort_line(&self, numbers: &mut [u32]) {
        let of = self.by_number();
        numbers.sort_by_key(|number| of[number].place[0]);
    }

    fn by_number(&self) -> HashMap<u32, &Element> {
        self.elements.iter().map(|element| (element.number, element)).collect()
    }
}
