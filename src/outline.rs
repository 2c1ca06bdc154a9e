//! The widgets as a tree of elements for screen readers and keyboards.
//!
//! egui describes each widget by an AccessKit node. On a desktop eframe hands the nodes to the
//! system. On the web it drops them: [`Outline`] takes each frame's nodes before, and tells the page
//! which of them have changed. `web/js/outline.js` keeps elements of the page in step, and
//! sends back what a reader does with them.

use crate::ui;
use eframe::egui::accesskit::{
    Action, ActionData, ActionRequest, HasPopup, Node, NodeId, Role, Toggled, TreeId, TreeUpdate,
};
use eframe::egui::{Context, Event, FullOutput, Key, Modifiers, Plugin, RawInput};
use serde::Serialize;
use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Landmarks whose upper edges are this near, points, are read from left to right.
const ROW: f64 = 24.0;

/// The tree of one window, shared by the window and the page. Clones are the same tree.
#[derive(Clone, Default)]
pub(crate) struct Outline(Arc<Mutex<Tree>>);

/// Something that a reader does with an element.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Deed {
    Click,
    Focus,
    SetValue(f64),
}

impl Outline {
    /// Begins to tell the page of the widgets of `ctx`. `show` hands it changes, as JSON.
    pub(crate) fn install(&self, ctx: &Context, show: fn(&str)) {
        // Labels are to be translated before they are told.
        ui::translate_labels(ctx);
        ctx.add_plugin(OutlinePlugin { outline: self.clone(), show });
    }

    /// Has the tree told from the next frame on: describing every widget costs time, and before
    /// this nobody listens.
    pub(crate) fn enable(&self) {
        self.tree().is_enabled = true;
    }

    fn tree(&self) -> MutexGuard<'_, Tree> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Does something with the element of this number in the next frame. An element that is gone
    /// is not there any more: nothing happens.
    pub(crate) fn request(&self, number: u32, deed: Deed) {
        let mut tree = self.tree();
        let Some(target_node) = tree.nodes.get(&number).copied() else {
            return;
        };
        let (action, data) = match deed {
            Deed::Click => (Action::Click, None),
            Deed::Focus => (Action::Focus, None),
            Deed::SetValue(value) => (Action::SetValue, Some(ActionData::NumericValue(value))),
        };
        let request = ActionRequest { action, target_tree: TreeId::ROOT, target_node, data };
        tree.events.push(Event::AccessKitActionRequest(request));
    }

    /// Passes a key on that was pressed or released on an element. `name` and `code` are those of
    /// the browser's event.
    pub(crate) fn press(&self, name: &str, code: &str, pressed: bool, modifiers: Modifiers) {
        let physical_key = key_of(code);
        let Some(key) = key_of(name).or(physical_key) else {
            return;
        };
        let event = Event::Key { key, physical_key, pressed, repeat: false, modifiers };
        self.tree().events.push(event);
    }

    /// Says whether an element of the tree has the keyboard. egui then counts as focused, although
    /// its canvas is not.
    pub(crate) fn set_has_keyboard(&self, has_keyboard: bool) {
        self.tree().has_keyboard = has_keyboard;
    }
}

/// Returns egui's name of a browser's key.
fn key_of(name: &str) -> Option<Key> {
    let plain = name.strip_prefix("Key").or_else(|| name.strip_prefix("Digit"));
    Key::from_name(match name {
        " " => "Space",
        _ => plain.unwrap_or(name),
    })
}

/// Takes each frame's nodes, and puts in what was done with the elements.
struct OutlinePlugin {
    outline: Outline,
    show: fn(&str),
}

impl Plugin for OutlinePlugin {
    fn debug_name(&self) -> &'static str {
        "segue outline"
    }

    fn input_hook(&mut self, ctx: &Context, input: &mut RawInput) {
        let mut tree = self.outline.tree();
        if tree.is_enabled {
            ctx.enable_accesskit();
        }
        if tree.has_keyboard {
            input.focused = true;
            input.events.retain(|event| !matches!(event, Event::WindowFocused(false)));
        }
        input.events.append(&mut tree.events);
    }

    fn output_hook(&mut self, ctx: &Context, output: &mut FullOutput) {
        let Some(update) = output.platform_output.accesskit_update.take() else {
            return;
        };
        let changes = self.outline.tree().changes(&update, f64::from(ctx.zoom_factor()));
        if let Some(changes) = changes
            && let Ok(text) = serde_json::to_string(&changes)
        {
            (self.show)(&text);
        }
    }
}

/// What the page has, by the numbers that it knows the nodes by.
#[derive(Default)]
struct Tree {
    /// Not yet given to egui.
    events: Vec<Event>,
    is_enabled: bool,
    has_keyboard: bool,
    numbers: HashMap<NodeId, u32>,
    nodes: HashMap<u32, NodeId>,
    elements: HashMap<u32, Element>,
    focus: Option<u32>,
    last_number: u32,
}

/// What differs from the frame before.
#[derive(Debug, Default, PartialEq, Serialize)]
struct Changes {
    /// Elements that are new, or not as they were.
    elements: Vec<Element>,
    /// The numbers of those that are gone.
    gone: Vec<u32>,
    /// The number of the element with the focus; 0 for none.
    focus: u32,
    /// The numbers of the outermost elements, in reading order.
    top: Vec<u32>,
}

/// An element of the page, in the terms of ARIA.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
struct Element {
    number: u32,
    /// An ARIA role, or `text` or `edit`.
    role: &'static str,
    #[serde(skip_serializing_if = "String::is_empty")]
    name: String,
    #[serde(skip_serializing_if = "String::is_empty")]
    description: String,
    /// What it says of its value, or the text that is edited.
    #[serde(skip_serializing_if = "String::is_empty")]
    value: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    range: Option<Range>,
    /// `true`, `false` or `mixed` for `aria-checked`, `aria-pressed` or `aria-selected`.
    #[serde(skip_serializing_if = "Option::is_none")]
    state: Option<(&'static str, &'static str)>,
    #[serde(skip_serializing_if = "Option::is_none")]
    expanded: Option<bool>,
    #[serde(skip_serializing_if = "Option::is_none")]
    popup: Option<&'static str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    level: Option<usize>,
    #[serde(skip_serializing_if = "is_false")]
    disabled: bool,
    #[serde(skip_serializing_if = "is_false")]
    focusable: bool,
    #[serde(skip_serializing_if = "is_false")]
    modal: bool,
    /// Left, top, width, height in pixels of the page.
    place: [i32; 4],
    #[serde(skip_serializing_if = "Vec::is_empty")]
    children: Vec<u32>,
}

/// The values of a slider, a meter or a progress bar.
#[derive(Clone, Debug, PartialEq, Serialize)]
struct Range {
    now: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    min: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    max: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    step: Option<f64>,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde asks for a reference")]
fn is_false(value: &bool) -> bool {
    !value
}

impl Tree {
    /// Returns what the page has to change, or nothing where it is in step. `zoom` is the number of
    /// pixels of the page for a point.
    fn changes(&mut self, update: &TreeUpdate, zoom: f64) -> Option<Changes> {
        let root = update.tree.as_ref()?.root;
        let all: HashMap<NodeId, &Node> =
            update.nodes.iter().map(|(id, node)| (*id, node)).collect();
        let mut found = Found { all: &all, zoom, elements: Vec::new() };
        let mut top = found.children_of(root, self);
        found.sort(&mut top);
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

    fn number_of(&mut self, id: NodeId) -> u32 {
        if let Some(&number) = self.numbers.get(&id) {
            return number;
        }
        self.last_number += 1;
        self.numbers.insert(id, self.last_number);
        self.nodes.insert(self.last_number, id);
        self.last_number
    }
}

/// The elements of a frame, children before their parents.
struct Found<'a> {
    all: &'a HashMap<NodeId, &'a Node>,
    zoom: f64,
    elements: Vec<Element>,
}

impl Found<'_> {
    /// Adds what lies in a node, and returns the numbers of the elements directly in it. Containers
    /// without a name give way to their contents.
    fn children_of(&mut self, id: NodeId, tree: &mut Tree) -> Vec<u32> {
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
            let inner = self.children_of(child_id, tree);
            match self.element(child, inner.clone()) {
                Some(element) => {
                    let number = tree.number_of(child_id);
                    self.elements.push(Element { number, ..element });
                    numbers.push(number);
                }
                None => numbers.extend(inner),
            }
        }
        numbers
    }

    /// Returns the element of a node, but for its number; none for a node that tells nothing.
    fn element(&self, node: &Node, children: Vec<u32>) -> Option<Element> {
        let is_text = node.role() == Role::Label;
        let name = if is_text { node.value().or(node.label()) } else { node.label() };
        let name = name.map_or_else(|| self.labels(node), str::to_owned);
        let role = aria_role(node, !name.is_empty())?;
        if (is_text || role == "group") && name.is_empty() && children.is_empty() {
            return None;
        }
        let range = node.numeric_value().map(|now| Range {
            now,
            min: node.min_numeric_value(),
            max: node.max_numeric_value(),
            step: node.numeric_value_step(),
        });
        let place = node.bounds().map_or([0; 4], |at| {
            [at.x0, at.y0, at.x1 - at.x0, at.y1 - at.y0]
                .map(|points| (points * self.zoom).round() as i32)
        });
        Some(Element {
            number: 0,
            role,
            name,
            description: node.description().unwrap_or_default().to_owned(),
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
                _ => "true",
            }),
            level: node.level(),
            disabled: node.is_disabled(),
            focusable: node.supports_action(Action::Focus) && !node.is_disabled(),
            modal: node.is_modal(),
            place,
            children,
        })
    }

    /// Returns the texts of the nodes that label this one.
    fn labels(&self, node: &Node) -> String {
        let labels = node.labelled_by().iter().filter_map(|id| self.all.get(id));
        let texts: Vec<&str> = labels.filter_map(|label| label.value().or(label.label())).collect();
        texts.join(" ")
    }

    /// Puts the outermost elements into reading order: row by row, from left to right, and what
    /// lies over the page last.
    fn sort(&self, numbers: &mut [u32]) {
        let of: HashMap<u32, &Element> =
            self.elements.iter().map(|element| (element.number, element)).collect();
        numbers.sort_by_key(|number| {
            let element = of[number];
            let is_over = matches!(element.role, "dialog" | "menu" | "tooltip" | "alert");
            let row = (f64::from(element.place[1]) / (ROW * self.zoom)).round() as i32;
            (is_over, row, element.place[0])
        });
    }
}

/// Returns the ARIA role of a node; none for a container that tells nothing of its contents.
fn aria_role(node: &Node, has_name: bool) -> Option<&'static str> {
    Some(match node.role() {
        Role::Label | Role::Paragraph => "text",
        Role::TextInput | Role::MultilineTextInput | Role::SearchInput | Role::NumberInput => {
            "edit"
        }
        Role::Button | Role::DefaultButton | Role::DisclosureTriangle => "button",
        Role::CheckBox => "checkbox",
        Role::Switch => "switch",
        Role::RadioButton => "radio",
        Role::RadioGroup => "radiogroup",
        Role::ComboBox => "combobox",
        Role::Slider => "slider",
        Role::SpinButton => "spinbutton",
        Role::ProgressIndicator => "progressbar",
        Role::Meter => "meter",
        Role::Link => "link",
        Role::Image | Role::Canvas => "img",
        Role::Heading => "heading",
        Role::Tab => "tab",
        Role::TabList => "tablist",
        Role::Menu => "menu",
        Role::MenuItem if node.toggled().is_some() => "menuitemradio",
        Role::MenuItem => "menuitem",
        Role::MenuItemRadio => "menuitemradio",
        Role::MenuItemCheckBox => "menuitemcheckbox",
        Role::List => "list",
        Role::ListItem => "listitem",
        Role::ListBox => "listbox",
        Role::ListBoxOption => "option",
        Role::Tree => "tree",
        Role::TreeItem => "treeitem",
        Role::Table => "table",
        Role::Row => "row",
        Role::Cell => "cell",
        Role::ColumnHeader => "columnheader",
        Role::Dialog => "dialog",
        Role::AlertDialog => "alertdialog",
        Role::Alert => "alert",
        Role::Status => "status",
        Role::Tooltip => "tooltip",
        Role::Toolbar => "toolbar",
        Role::Banner => "banner",
        Role::Navigation => "navigation",
        Role::Main => "main",
        Role::Complementary => "complementary",
        Role::Form => "form",
        Role::Article => "article",
        Role::Region => "region",
        // A thing that can be pressed is a button, whatever it is called.
        _ if node.supports_action(Action::Click) && has_name => "button",
        _ if has_name => "group",
        _ => return None,
    })
}

/// Returns the attribute that says whether an element is on, and its value.
fn state(node: &Node, role: &str) -> Option<(&'static str, &'static str)> {
    let value = match (node.toggled(), node.is_selected()) {
        (Some(Toggled::True), _) | (None, Some(true)) => "true",
        (Some(Toggled::False), _) | (None, Some(false)) => "false",
        (Some(Toggled::Mixed), _) => "mixed",
        (None, None) => return None,
    };
    let attribute = match role {
        "tab" | "option" | "treeitem" | "row" => "aria-selected",
        "checkbox" | "switch" | "radio" | "menuitemradio" | "menuitemcheckbox" => "aria-checked",
        "button" => "aria-pressed",
        _ => return None,
    };
    Some((attribute, value))
}
