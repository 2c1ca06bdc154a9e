//! The widgets as a tree of elements for screen readers and keyboards.
//!
//! egui describes each widget by an AccessKit node. On a desktop eframe hands the nodes to the
//! system. On the web it drops them: [`Outline`] takes each frame's nodes before, and tells the
//! page which of them have changed. `web/js/outline.js` keeps elements of the page in step, and
//! sends back what a reader does with them.

use crate::ui;
use eframe::egui::accesskit::{
    Action, ActionData, ActionRequest, HasPopup, Node, NodeId, Role, Toggled, TreeId, TreeUpdate,
};
use eframe::egui::{Context, Event, FullOutput, Key, Modifiers, Plugin, RawInput};
use serde::Serialize;
use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// The tree of one window, shared by the window and the page. Clones are the same tree.
#[derive(Clone, Default)]
pub(crate) struct Outline(Arc<Mutex<Tree>>);

/// Something that a reader does with an element.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Deed {
    Click,
    Focus,
    SetValue(f64),
}

impl Outline {
    /// Begins to tell the page of the widgets of `ctx`. `show` hands it changes, as JSON.
    pub(crate) fn install(&self, ctx: &Context, show: fn(&str)) {
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
        let mut tree = self.tree();
        tree.events.push(Event::Key { key, physical_key, pressed, repeat: false, modifiers });
        // A field may have taken the focus in the meantime: what is typed is text to it.
        let is_text = name.chars().count() == 1 && !modifiers.command && !modifiers.alt;
        if pressed && is_text {
            tree.events.push(Event::Text(name.to_owned()));
        }
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
        let changes = changes.map(|changes| Changes { skip: ui::skip_words(ctx), ..changes });
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
    /// The words of the link that goes past the other parts to the parameters.
    skip: String,
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
    /// Adds the elements in a node, and returns the numbers of those directly in it. Containers
    /// without a name give way to their contents.
    fn children_of(&mut self, id: NodeId, is_in_menu: bool, tree: &mut Tree) -> Vec<u32> {
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
            let inner = self.children_of(child_id, is_in_menu, tree);
            if let Some(mut element) = self.element(child, inner.clone()) {
                element.number = tree.number_of(child_id);
                if !is_in_menu && element.role.starts_with("menuitem") {
                    // The items of a list that always stands open.
                    element.role = "button";
                    element.state = element.state.map(|(_, value)| ("aria-pressed", value));
                }
                if element.role == "banner" {
                    self.sort_line(&mut element.children);
                }
                numbers.push(element.number);
                self.elements.push(element);
            } else {
                self.describe(&inner, child.description());
                numbers.extend(inner);
            }
        }
        numbers
    }

    /// Returns the element of a node, but for its number; none for a node that tells nothing.
    fn element(&self, node: &Node, children: Vec<u32>) -> Option<Element> {
        let is_text = matches!(node.role(), Role::Label | Role::Heading);
        let name = if is_text { node.value().or(node.label()) } else { node.label() };
        let name = name.map_or_else(|| self.labels(node), str::to_owned);
        // A container that has nothing but a hint stands for what lies in it.
        let is_hint = node.description() == Some(&name) && node.role() == Role::GenericContainer;
        let mut role = aria_role(node, !name.is_empty() && !is_hint)?;
        if role == "button" && !children.is_empty() {
            // A window that comes to the front when it is pressed.
            role = "group";
        }
        if (is_text || role == "group") && name.is_empty() && children.is_empty() {
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

    /// Gives the hint of a container to the first thing in it that can be worked, where that has
    /// none of its own.
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

    /// Returns the place of the smallest rectangle around some elements.
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

    /// Puts the parts of the page into the order in which they are read: from the bar at the top to
    /// the timeline, and what lies over the page last.
    fn sort_parts(&self, numbers: &mut [u32]) {
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

    /// Puts the elements of a line in order, from left to right.
    fn sort_line(&self, numbers: &mut [u32]) {
        let of = self.by_number();
        numbers.sort_by_key(|number| of[number].place[0]);
    }

    fn by_number(&self) -> HashMap<u32, &Element> {
        self.elements.iter().map(|element| (element.number, element)).collect()
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
        Role::MenuItem if node.toggled().is_none() => "menuitem",
        Role::MenuItem | Role::MenuItemRadio => "menuitemradio",
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
        Role::Dialog | Role::Window => "dialog",
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

#[cfg(test)]
mod tests {
    use super::*;
    use eframe::egui::{self, Modifiers, RawInput, Ui};
    use std::cell::RefCell;

    thread_local! {
        /// The changes that the page was told, as JSON.
        static TOLD: RefCell<Vec<serde_json::Value>> = const { RefCell::new(Vec::new()) };
    }

    fn tell(changes: &str) {
        let changes = serde_json::from_str(changes).expect("JSON");
        TOLD.with_borrow_mut(|told| told.push(changes));
    }

    /// Runs a frame, and returns what the page was told of it.
    fn frame(ctx: &Context, mut show: impl FnMut(&mut Ui)) -> Option<serde_json::Value> {
        let mut output = ctx.run_ui(RawInput::default(), &mut show);
        output.textures_delta.clear();
        TOLD.with_borrow_mut(Vec::pop)
    }

    fn told_outline() -> (Context, Outline) {
        let (ctx, outline) = (Context::default(), Outline::default());
        outline.install(&ctx, tell);
        outline.enable();
        (ctx, outline)
    }

    /// Returns the element of a role and name among some changes.
    fn find<'a>(
        changes: &'a serde_json::Value,
        role: &str,
        name: &str,
    ) -> Option<&'a serde_json::Value> {
        let elements = changes["elements"].as_array()?;
        elements.iter().find(|element| element["role"] == role && element["name"] == name)
    }

    fn number_of(changes: &serde_json::Value, role: &str, name: &str) -> u32 {
        let element = find(changes, role, name).expect("an element of this role and name");
        element["number"].as_u64().and_then(|number| number.try_into().ok()).expect("a number")
    }

    #[test]
    fn disabled_outline_tells_nothing() {
        let (ctx, outline) = (Context::default(), Outline::default());
        outline.install(&ctx, tell);
        assert_eq!(frame(&ctx, |ui| drop(ui.button("Play"))), None);
    }

    #[test]
    fn widgets_are_told_once_and_then_their_changes() {
        let (ctx, _outline) = told_outline();
        let show = |value: f64, is_on: bool, ui: &mut Ui| {
            let mut value = value;
            let mut on = is_on;
            ui.checkbox(&mut on, "Foot lock");
            ui.add(egui::Slider::new(&mut value, 0.0..=10.0).text("Blend window"));
            ui.label("12 frames");
        };
        let first = frame(&ctx, |ui| show(3.0, false, ui)).expect("all elements");
        assert_eq!(find(&first, "checkbox", "Foot lock").unwrap()["state"][1], "false");
        assert!(find(&first, "text", "12 frames").is_some());
        let slider = first["elements"].as_array().unwrap().iter();
        let slider = slider.into_iter().find(|element| element["role"] == "slider").unwrap();
        assert_eq!((&slider["range"]["now"], &slider["range"]["max"]), (&3.0.into(), &10.0.into()));
        // egui's own widgets settle in their second frame.
        frame(&ctx, |ui| show(3.0, false, ui));
        assert_eq!(frame(&ctx, |ui| show(3.0, false, ui)), None);
        let second = frame(&ctx, |ui| show(3.0, true, ui)).expect("one element");
        assert_eq!(second["elements"].as_array().unwrap().len(), 1);
        assert_eq!(second["elements"][0]["state"][1], "true");
        let number = number_of(&first, "checkbox", "Foot lock");
        assert_eq!(second["elements"][0]["number"], number);
    }

    #[test]
    fn widget_that_leaves_is_gone() {
        let (ctx, _outline) = told_outline();
        let first = frame(&ctx, |ui| drop(ui.button("Play"))).expect("all elements");
        let number = number_of(&first, "button", "Play");
        let second = frame(&ctx, |_| {}).expect("one element less");
        assert_eq!(second["gone"], serde_json::json!([number]));
        assert_eq!(second["top"], serde_json::json!([]));
    }

    #[test]
    fn parts_are_in_reading_order_whatever_is_drawn_first() {
        let (ctx, _outline) = told_outline();
        let part = |role: Role, name: &str, ui: &mut Ui| {
            ui.push_id(name, |ui| {
                ui.ctx().accesskit_node_builder(ui.unique_id(), |node| {
                    node.set_role(role);
                    node.set_label(name);
                });
                ui.label("text");
            });
        };
        let changes = frame(&ctx, |ui| {
            part(Role::Region, "Timeline", ui);
            part(Role::Main, "Stage", ui);
            part(Role::Banner, "Top bar", ui);
        });
        let changes = changes.expect("all elements");
        let order = [("banner", "Top bar"), ("main", "Stage"), ("region", "Timeline")];
        let order = order.map(|(role, name)| number_of(&changes, role, name));
        assert_eq!(changes["top"], serde_json::json!(order));
    }

    #[test]
    fn container_with_a_hint_gives_it_to_its_control() {
        let (ctx, _outline) = told_outline();
        let changes = frame(&ctx, |ui| {
            let row = ui.scope(|ui| drop(ui.checkbox(&mut false, "Foot lock")));
            let hint = "Holds planted feet in place.";
            ui.ctx().accesskit_node_builder(row.response.id, |node| {
                node.set_label(hint);
                node.set_description(hint);
            });
        });
        let changes = changes.expect("all elements");
        assert_eq!(changes["elements"].as_array().unwrap().len(), 1, "{changes}");
        assert_eq!(changes["elements"][0]["description"], "Holds planted feet in place.");
    }

    #[test]
    fn container_that_can_be_pressed_is_no_button() {
        let (ctx, _outline) = told_outline();
        let changes = frame(&ctx, |ui| {
            let row = ui.scope(|ui| drop(ui.button("Walk")));
            ui.ctx().accesskit_node_builder(row.response.id, |node| {
                node.set_label("Clips");
                node.add_action(Action::Click);
            });
        });
        let changes = changes.expect("all elements");
        assert!(find(&changes, "group", "Clips").is_some(), "{changes}");
    }

    #[test]
    fn items_are_buttons_outside_of_menus() {
        let (ctx, _outline) = told_outline();
        let item = |role: Role, ui: &mut Ui| {
            ui.push_id(role as u8, |ui| {
                ui.ctx().accesskit_node_builder(ui.unique_id(), |node| node.set_role(role));
                let response = ui.button("Walk");
                ui.ctx().accesskit_node_builder(response.id, |node| node.set_role(Role::MenuItem));
            });
        };
        let changes = frame(&ctx, |ui| {
            item(Role::Menu, ui);
            item(Role::GenericContainer, ui);
        });
        let changes = changes.expect("all elements");
        assert!(find(&changes, "menuitem", "Walk").is_some(), "{changes}");
        assert!(find(&changes, "button", "Walk").is_some(), "{changes}");
    }

    #[test]
    fn click_and_value_of_an_element_reach_its_widget() {
        let (ctx, outline) = told_outline();
        let (mut clicks, mut value) = (0, 3.0);
        let show = |clicks: &mut i32, value: &mut f64, ui: &mut Ui| {
            *clicks += i32::from(ui.button("Play").clicked());
            ui.add(egui::Slider::new(value, 0.0..=10.0).text("Blend window"));
        };
        let first = frame(&ctx, |ui| show(&mut clicks, &mut value, ui)).expect("all elements");
        outline.request(number_of(&first, "button", "Play"), Deed::Click);
        let slider = first["elements"].as_array().unwrap().iter();
        let slider = slider.into_iter().find(|element| element["role"] == "slider").unwrap();
        let slider = slider["number"].as_u64().and_then(|number| number.try_into().ok()).unwrap();
        outline.request(slider, Deed::SetValue(7.0));
        outline.request(9999, Deed::Click);
        frame(&ctx, |ui| show(&mut clicks, &mut value, ui));
        assert_eq!((clicks, value), (1, 7.0));
    }

    #[test]
    fn focus_and_keys_of_an_element_reach_its_widget() {
        let (ctx, outline) = told_outline();
        let mut clicks = 0;
        let mut show = |ui: &mut Ui| clicks += i32::from(ui.button("Play").clicked());
        let first = frame(&ctx, &mut show).expect("all elements");
        let play = number_of(&first, "button", "Play");
        outline.set_has_keyboard(true);
        outline.request(play, Deed::Focus);
        let second = frame(&ctx, &mut show).expect("the focus");
        assert_eq!(second["focus"], play);
        for pressed in [true, false] {
            outline.press("Enter", "Enter", pressed, Modifiers::NONE);
        }
        outline.press("Dead", "Nowhere", true, Modifiers::NONE);
        frame(&ctx, &mut show);
        assert_eq!(clicks, 1);
    }

    #[test]
    fn letters_of_an_element_are_text_unless_they_are_a_command() {
        let outline = Outline::default();
        outline.press("7", "Digit7", true, Modifiers::NONE);
        outline.press("7", "Digit7", false, Modifiers::NONE);
        outline.press("c", "KeyC", true, Modifiers::COMMAND);
        let texts = |event: &&Event| matches!(event, Event::Text(_));
        let texts: Vec<Event> = outline.tree().events.iter().filter(texts).cloned().collect();
        assert_eq!(texts, [Event::Text("7".into())]);
    }

    #[test]
    fn keys_have_the_names_of_the_browser() {
        assert_eq!(key_of("ArrowLeft"), Some(Key::ArrowLeft));
        assert_eq!(key_of(" "), Some(Key::Space));
        assert_eq!(key_of("KeyA"), Some(Key::A));
        assert_eq!(key_of("Digit7"), Some(Key::Num7));
        assert_eq!(key_of("Unidentified"), None);
    }
}
