//! The widgets as a tree of elements for screen readers and keyboards.
//!
//! egui describes each widget by an AccessKit node. On a desktop eframe hands the nodes to the
//! system. On the web it drops them: [`Outline`] takes each frame's nodes before, and tells the
//! page which of them have changed. `web/js/outline.js` keeps elements of the page in step, and
//! sends back what a reader does with them.

mod aria;
mod element;
mod elements;
mod numbers;
#[cfg(test)]
mod tests;
mod tree;

use self::tree::Tree;
use crate::ui;
use eframe::egui::accesskit::{Action, ActionData, ActionRequest, TreeId};
use eframe::egui::{Context, Event, FullOutput, Key, Modifiers, Plugin, RawInput};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// The tree of one window, shared by the window and the page. Clones are the same tree.
#[derive(Clone, Default)]
pub(crate) struct Outline(Arc<Mutex<Tree>>);

/// An action of a screen reader's user on an element.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Deed {
    Click,
    Focus,
    SetValue(f64),
}

impl Outline {
    /// Reports changes of the widgets of `ctx` to the page from now on: calls `show` with JSON.
    pub(crate) fn install(&self, ctx: &Context, show: fn(&str)) {
        ctx.add_plugin(OutlinePlugin { outline: self.clone(), show });
    }

    /// Starts the reports with the next frame. They are off at first, because describing every
    /// widget costs time.
    pub(crate) fn enable(&self) {
        self.tree().is_enabled = true;
    }

    fn tree(&self) -> MutexGuard<'_, Tree> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Performs an action on the element of this number in the next frame; nothing happens if the
    /// element is gone.
    pub(crate) fn request(&self, number: u32, deed: Deed) {
        let mut tree = self.tree();
        let Some(target_node) = tree.numbers.node(number) else {
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

    /// Forwards a key press or release on an element. `name` and `code` are those of the browser's
    /// event.
    pub(crate) fn press(&self, name: &str, code: &str, pressed: bool, modifiers: Modifiers) {
        let physical_key = key_of(code);
        let Some(key) = key_of(name).or(physical_key) else {
            return;
        };
        let mut tree = self.tree();
        tree.events.push(Event::Key { key, physical_key, pressed, repeat: false, modifiers });
        // A field may have taken the focus in the meantime, and needs the typed text.
        let is_text = name.chars().count() == 1 && !modifiers.command && !modifiers.alt;
        if pressed && is_text {
            tree.events.push(Event::Text(name.to_owned()));
        }
    }

    /// Sets whether an element of the tree has the keyboard focus. egui then counts as focused,
    /// although its canvas is not.
    pub(crate) fn set_has_keyboard(&self, has_keyboard: bool) {
        self.tree().has_keyboard = has_keyboard;
    }
}

/// Returns egui's key for the key name of a browser event.
fn key_of(name: &str) -> Option<Key> {
    let plain = name.strip_prefix("Key").or_else(|| name.strip_prefix("Digit"));
    Key::from_name(match name {
        " " => "Space",
        _ => plain.unwrap_or(name),
    })
}

/// The plugin that takes each frame's nodes, and adds the reader's events to egui's input.
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
        if tree.has_keyboard {
            input.focused = true;
            input.events.retain(|event| !matches!(event, Event::WindowFocused(false)));
        }
        input.events.append(&mut tree.events);
        // Panels that stand still describe nothing, and describing the rest alone would end them
        // for the page.
        let is_still = input.events.is_empty() && ui::still::is_expected(ctx);
        if is_still && tree.is_known() {
            ctx.disable_accesskit();
        } else if tree.is_enabled {
            ctx.enable_accesskit();
        }
    }

    fn output_hook(&mut self, ctx: &Context, output: &mut FullOutput) {
        let Some(update) = output.platform_output.accesskit_update.take() else {
            return;
        };
        let zoom = f64::from(ctx.zoom_factor());
        let changes = self.outline.tree().changes(update, zoom, || ui::skip_words(ctx));
        if let Some(changes) = changes
            && let Ok(text) = serde_json::to_string(&changes)
        {
            (self.show)(&text);
        }
    }
}
