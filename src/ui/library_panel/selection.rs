//! The bar of the selected clips.

use super::arrange::arrange;
use crate::ui::kit::{self, Button, Icon};
use crate::ui::language::say;
use crate::ui::out::{Action, ConvertAction, Out};
use crate::ui::state::UiState;
use crate::ui::text;
use crate::ui::theme::{Type, palette_of, space, theme_of};
use eframe::egui::{Align, Layout as Flow, RichText, Ui, UiBuilder, vec2};
use segue_session::export::ExportFormat;
use segue_session::{Command, Session};

/// Draws the number of the selected clips, and what can be done with them; nothing without any.
pub(super) fn selection_ui(session: &Session, state: &mut UiState, out: &mut Out, ui: &mut Ui) {
    if state.library.picked.is_empty() {
        return;
    }
    let (theme, palette) = (theme_of(ui), palette_of(ui));
    // In the order of the list, whatever of it is in sight.
    let sections = arrange(session.library().entries(), state.library.order, "", |entry| {
        say(&entry.title(), ui)
    });
    let ids: Vec<String> = sections
        .iter()
        .flat_map(|section| &section.entries)
        .filter_map(|&index| session.library().entries().get(index))
        .filter(|entry| state.library.picked.contains(&entry.id))
        .map(|entry| entry.id.clone())
        .collect();
    let words = RichText::new(say(&text::selected(ids.len()), ui));
    let words = words.font(theme.font(Type::Strong)).color(palette.text);
    let row = kit::paint::full_width(theme.row_height(), ui);
    let builder = |flow| UiBuilder::new().max_rect(row).layout(flow);
    ui.new_child(builder(Flow::left_to_right(Align::Center))).label(words);
    let mut end = ui.new_child(builder(Flow::right_to_left(Align::Center)));
    if kit::icon_button_ui(Icon::Close, text::CLEAR_SELECTION, &mut end).clicked() {
        state.library.picked.clear();
    }
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = vec2(space::XS, space::XS);
        if let Some(values) = session.with_clips(&ids)
            && kit::button_ui(Button::new(text::USE_THESE).primary(), ui).clicked()
        {
            out.commands.push(Command::Set(values));
            out.commands.push(Command::Settle);
            state.library.picked.clear();
        }
        let together =
            ids.len() > 1 && kit::button_ui(Button::new(text::SAVE_TOGETHER), ui).clicked();
        let apart = kit::button_ui(Button::new(text::CONVERT_CLIPS), ui).clicked();
        if together || apart {
            out.actions.push(Action::Convert(ConvertAction::AddClips(ids.clone())));
            state.convert.is_open = true;
            state.convert.in_one_file = together;
            if together && !state.convert.export.format.holds_several() {
                state.convert.export.format = ExportFormat::Glb;
            }
            state.library.picked.clear();
        }
        if kit::button_ui(Button::new(text::REMOVE), ui).clicked() {
            out.commands.push(Command::RemoveAll(ids));
            state.library.picked.clear();
        }
    });
    ui.add_space(space::S);
}
