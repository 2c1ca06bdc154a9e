//! The row of a clip: its letters, its actions, its menu and its details.

use crate::ui::clip_drag::{ClipDrag, swap_values};
use crate::ui::clip_panel::clip_panel_ui;
use crate::ui::kit::{self, ClipRow, ClipRowEvent, Icon, MenuItem, Part, SlotLetter};
use crate::ui::labs::{compare_clips, edit_items_ui};
use crate::ui::language::{Text, Word, say};
use crate::ui::out::{Action, Out};
use crate::ui::state::{HeldKeys, Typing, UiState};
use crate::ui::text;
use crate::ui::theme::space;
use eframe::egui::{
    Frame, Key as Keyboard, Margin, Modifiers, Popup, RectAlign, Response, SetOpenCommand, Ui,
};
use segue_session::export::{ExportFormat, ExportOptions};
use segue_session::{Command, Entry, Key, Session, Slot, Value};
use segue_text::{Message, msg};

/// An action of the buttons and keys of a row on its clip.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum RowAction {
    Details,
    Rename,
    Remove,
}

const ACTIONS: [(Icon, Word, RowAction); 3] = [
    (Icon::Sliders, text::DETAILS, RowAction::Details),
    (Icon::Pencil, text::RENAME, RowAction::Rename),
    (Icon::Trash, text::REMOVE, RowAction::Remove),
];

/// Draws the row of a clip, and below it its details where they are open. `shown` are the ids of
/// the clips in the list, in order.
pub(super) fn entry_ui(
    entry: &Entry,
    shown: &[&str],
    session: &Session,
    state: &mut UiState,
    out: &mut Out,
    ui: &mut Ui,
) {
    if is_renamed(entry, state, out, ui) {
        return;
    }
    let warnings: Vec<String> = entry.warnings.iter().map(|warning| say(warning, ui)).collect();
    let warning = warnings.join("\n");
    let slots: Vec<Slot> =
        [Slot::A, Slot::B].into_iter().filter(|slot| session.uses(*slot)).collect();
    let names = slots.iter().map(|slot| text::held_as(entry.title(), *slot));
    let names: Vec<Message> = names.collect();
    let letters: Vec<SlotLetter<'_>> = slots
        .iter()
        .zip(&names)
        .map(|(slot, name)| SlotLetter {
            part: part_of(*slot),
            held: holds(*slot, entry, session),
            name: name.into(),
        })
        .collect();
    let (name, facts, joints) = (entry.title(), text::facts(entry), text::joints_of(entry));
    let open = state.details.as_ref() == Some(&entry.id);
    let row = ClipRow {
        name: (&name).into(),
        detail: (&facts).into(),
        more: (&joints).into(),
        letters: &letters,
        warning: Text::Data(&warning),
        open,
        picked: state.library.picked.contains(&entry.id),
        actions: &ACTIONS.map(|(icon, words, _)| (icon, words)),
    };
    let row = kit::clip_row_ui(row, ui);
    if row.has_focus {
        state.library.focused = Some(entry.id.clone());
    } else if state.library.focused.as_ref() == Some(&entry.id) {
        state.library.focused = None;
    }
    row.response.dnd_set_drag_payload(ClipDrag { id: entry.id.clone() });
    match row.event {
        Some(ClipRowEvent::Chosen) => {
            let held = ui.input(|input| HeldKeys {
                shift: input.modifiers.shift,
                command: input.modifiers.command,
            });
            if !state.library.take_click(&entry.id, shown, held) {
                match slots.first() {
                    Some(&slot) => assign(slot, entry, session, out),
                    None => act(RowAction::Details, entry, state, out),
                }
            }
        }
        Some(ClipRowEvent::Letter(index)) => {
            if let Some(&slot) = slots.get(index) {
                assign(slot, entry, session, out);
            }
        }
        Some(ClipRowEvent::Action(index)) => {
            if let Some(&(_, _, action)) = ACTIONS.get(index) {
                act(action, entry, state, out);
            }
        }
        Some(ClipRowEvent::Held) => state.library.toggle(&entry.id),
        Some(ClipRowEvent::Menu { .. }) | None => {}
    }
    if let Some(action) = key_action(&row.response, ui) {
        act(action, entry, state, out);
    }
    menu_ui(entry, &row.response, row.event, &slots, session, state, out, ui);
    if state.details.as_ref() == Some(&entry.id) {
        let card = Frame::new().inner_margin(Margin { left: 10, right: 4, top: 6, bottom: 10 });
        card.show(ui, |ui| {
            ui.spacing_mut().item_spacing.y = space::XS;
            clip_panel_ui(entry, Some(&entry.id), session, state, out, ui);
        });
    }
}

/// Draws the field for the name of a clip that is being renamed. Returns whether it is.
fn is_renamed(entry: &Entry, state: &mut UiState, out: &mut Out, ui: &mut Ui) -> bool {
    let Some(renaming) = state.renaming.as_mut().filter(|renaming| renaming.id == entry.id) else {
        return false;
    };
    let field = kit::text_field_ui(text::RENAME, Text::Data(&entry.name), &mut renaming.text, ui);
    field.response.request_focus();
    if field.committed {
        out.commands.push(Command::Rename(entry.id.clone(), renaming.text.clone()));
    }
    if field.committed || ui.input(|input| input.key_pressed(Keyboard::Escape)) {
        state.renaming = None;
    }
    true
}

fn part_of(slot: Slot) -> Part {
    match slot {
        Slot::A => Part::A,
        Slot::B => Part::B,
    }
}

fn holds(slot: Slot, entry: &Entry, session: &Session) -> bool {
    session.slot(slot).is_some_and(|held| held.id == entry.id)
}

/// Puts a clip into a slot. If it is in the other slot, both clips change places.
fn assign(slot: Slot, entry: &Entry, session: &Session, out: &mut Out) {
    if holds(slot, entry, session) {
        return;
    }
    let other = if slot == Slot::A { Slot::B } else { Slot::A };
    if session.uses(other) && holds(other, entry, session) {
        out.commands.push(Command::Set(swap_values(session)));
        out.commands.push(Command::Settle);
    } else {
        out.commands.push(Command::Assign(slot, entry.id.clone()));
    }
}

fn act(action: RowAction, entry: &Entry, state: &mut UiState, out: &mut Out) {
    match action {
        RowAction::Details => {
            let is_open = state.details.as_ref() == Some(&entry.id);
            state.details = (!is_open).then(|| entry.id.clone());
        }
        RowAction::Rename => {
            state.renaming = Some(Typing { id: entry.id.clone(), text: entry.name.clone() });
        }
        RowAction::Remove => out.commands.push(Command::Remove(entry.id.clone())),
    }
}

/// Returns the action whose key was pressed while the row has the focus.
fn key_action(row: &Response, ui: &Ui) -> Option<RowAction> {
    if !row.has_focus() {
        return None;
    }
    let keys = [(Keyboard::F2, RowAction::Rename), (Keyboard::Delete, RowAction::Remove)];
    let pressed = |key| ui.input_mut(|input| input.consume_key(Modifiers::NONE, key));
    keys.into_iter().find(|(key, _)| pressed(*key)).map(|(_, action)| action)
}

/// Shows the menu of the row, once it was asked for.
#[expect(clippy::too_many_arguments, reason = "a menu of everything that can be done with a clip")]
fn menu_ui(
    entry: &Entry,
    row: &Response,
    event: Option<ClipRowEvent>,
    slots: &[Slot],
    session: &Session,
    state: &mut UiState,
    out: &mut Out,
    ui: &Ui,
) {
    let opens = match event {
        Some(ClipRowEvent::Menu { .. }) => Some(SetOpenCommand::Bool(true)),
        Some(_) => Some(SetOpenCommand::Bool(false)),
        None => None,
    };
    // A menu that the keyboard has opened stands at the row, and its first line has the focus.
    let at_pointer_id = row.id.with("at_pointer");
    let focus_id = row.id.with("focus_first");
    if let Some(ClipRowEvent::Menu { by_pointer }) = event {
        ui.data_mut(|data| {
            data.insert_temp(at_pointer_id, by_pointer);
            data.insert_temp(focus_id, !by_pointer);
        });
    }
    let at_pointer = ui.data(|data| data.get_temp(at_pointer_id)).unwrap_or(false);
    let menu = Popup::menu(row).align(RectAlign::BOTTOM_END).open_memory(opens);
    let menu = if at_pointer { menu.at_pointer_fixed() } else { menu };
    let lines = |ui: &mut Ui| {
        let needs_focus = !ui.is_sizing_pass()
            && ui.data_mut(|data| std::mem::take(data.get_temp_mut_or_default::<bool>(focus_id)));
        let mut first = needs_focus;
        let mut line_ui = |item: MenuItem<'_>, ui: &mut Ui| {
            let line = kit::menu_item_ui(item, ui);
            if std::mem::take(&mut first) {
                line.request_focus();
            }
            line.clicked()
        };
        for &slot in slots {
            let words = if slot == Slot::A { text::USE_AS_A } else { text::USE_AS_B };
            let item = MenuItem { text: words.into(), ..MenuItem::default() };
            if line_ui(item, ui) {
                assign(slot, entry, session, out);
            }
        }
        if !holds(Slot::A, entry, session) {
            let item = MenuItem {
                text: text::COMPARE_WITH_A.into(),
                icon: Some(Icon::Swap),
                ..MenuItem::default()
            };
            if line_ui(item, ui) {
                compare_clips(session.params().text(Key::A), &entry.id, out);
            }
        }
        if entry.has_mesh() && session.params().text(Key::Character) != entry.id {
            let item = MenuItem { text: text::USE_AS_CHARACTER.into(), ..MenuItem::default() };
            if line_ui(item, ui) {
                out.set_once(Key::Character, Value::Text(entry.id.clone()));
            }
        }
        edit_items_ui(&entry.id, out, ui);
        for (icon, words, action) in ACTIONS {
            let item = MenuItem { text: words.into(), icon: Some(icon), ..MenuItem::default() };
            if line_ui(item, ui) {
                act(action, entry, state, out);
            }
        }
        let is_picked = state.library.picked.contains(&entry.id);
        let item =
            MenuItem { text: text::SELECT.into(), chosen: Some(is_picked), ..MenuItem::default() };
        if line_ui(item, ui) {
            state.library.toggle(&entry.id);
        }
        for format in ExportFormat::ALL {
            let words = msg!("Save as {format}", format = text::format(format));
            let item = MenuItem {
                text: Text::from(&words),
                icon: Some(Icon::Download),
                ..MenuItem::default()
            };
            if line_ui(item, ui) {
                let how = ExportOptions { format, ..state.export };
                out.actions.push(Action::Save { which: entry.id.clone(), how });
            }
        }
    };
    menu.show(|ui| kit::until_choice(lines, ui));
}
