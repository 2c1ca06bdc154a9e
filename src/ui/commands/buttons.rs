//! Commands as buttons and menu items.

use super::keys::keys_of;
use super::{Target, UiCommand};
use crate::ui::kit::{self, Button, MenuItem};
use crate::ui::language::{Text, say};
use crate::ui::out::Out;
use crate::ui::state::UiState;
use eframe::egui::Ui;
use segue_session::Session;

/// Shows the icon of a command as a button.
pub(crate) fn command_icon_ui(
    command: UiCommand,
    session: &Session,
    state: &mut UiState,
    out: &mut Out,
    ui: &mut Ui,
) {
    let row = command.row();
    let button = match row.icon {
        Some(icon) => Button::icon_only(icon, command.name(state)),
        None => Button::new(row.text).quiet(),
    };
    command_button_ui(command, button, session, state, out, ui);
}

/// Shows a button of a command, with a tooltip about its effect and its shortcuts.
pub(crate) fn command_button_ui(
    command: UiCommand,
    button: Button<'_>,
    session: &Session,
    state: &mut UiState,
    out: &mut Out,
    ui: &mut Ui,
) {
    let row = command.row();
    let name = command.name(state);
    let button = button.name(name).hint(Text::EMPTY).selected(command.is_on(session));
    let enabled = command.is_enabled(session, state);
    let response = ui.add_enabled_ui(enabled, |ui| kit::button_ui(button, ui)).inner;
    // Build the tooltip only while the pointer is over the button.
    let response = response.on_hover_ui(|ui| {
        let what = say(if row.tooltip.is_empty() { name } else { row.tooltip }, ui);
        let keys = keys_of(&[command]);
        ui.label(if keys.is_empty() { what } else { format!("{what} ({})", say(&keys, ui)) });
    });
    if response.clicked() {
        command.run(&mut Target { session, state, out, ui });
    }
}

/// Shows a menu item of a command.
pub(crate) fn command_item_ui(
    command: UiCommand,
    session: &Session,
    state: &mut UiState,
    out: &mut Out,
    ui: &mut Ui,
) {
    let shortcut = keys_of(&[command]);
    let (text, icon) = (command.name(state), command.row().icon);
    let item = MenuItem { text: text.into(), icon, shortcut: (&shortcut).into(), chosen: None };
    let enabled = command.is_enabled(session, state);
    if ui.add_enabled_ui(enabled, |ui| kit::menu_item_ui(item, ui)).inner.clicked() {
        command.run(&mut Target { session, state, out, ui });
    }
}
