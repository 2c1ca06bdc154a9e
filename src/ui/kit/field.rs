//! Text fields, and rows of values that cannot be changed.

use super::assistive::describe;
use super::clip_row::small_icon_ui;
use super::icon::Icon;
use super::paint::{Run, faded, full_width, line_of, put};
use super::words;
use crate::ui::language::{Text, Word, say};
use crate::ui::theme::{Type, palette_of, space, theme_of};
use eframe::egui::{
    Align2, Color32, Key, Margin, Response, Role, Sense, TextEdit, Ui, WidgetInfo, pos2, vec2,
};

/// The user's input to a text field.
#[derive(Debug)]
pub(crate) struct FieldResponse {
    /// The text is finished: by Enter, or because the focus went elsewhere. Esc does not finish it.
    pub(crate) committed: bool,
    /// The field.
    pub(crate) response: Response,
}

/// Draws a text field of one line, as wide as the panel. `name` is its accessible name; `hint` is
/// shown in it while it is empty.
pub(crate) fn text_field_ui<'a>(
    name: Word,
    hint: impl Into<Text<'a>>,
    text: &mut String,
    ui: &mut Ui,
) -> FieldResponse {
    let theme = theme_of(ui);
    let size = vec2(ui.available_width(), theme.row_height());
    let edit = TextEdit::singleline(text)
        .hint_text(say(hint, ui))
        .font(theme.font(Type::Body))
        .margin(Margin::symmetric(8, 5))
        .align(Align2::LEFT_CENTER)
        .desired_width(size.x);
    let response = ui.add_sized(size, edit).accessible_name(say(name, ui));
    // egui may report the loss of the focus in two frames; the text is finished once.
    let typing_id = response.id.with("typing");
    let was_typing = ui.data(|data| data.get_temp(typing_id)).unwrap_or(false);
    let typing = response.has_focus();
    ui.data_mut(|data| data.insert_temp(typing_id, typing));
    let escaped = ui.input(|input| input.key_pressed(Key::Escape));
    FieldResponse { committed: was_typing && !typing && !escaped, response }
}

/// Draws the field of a search over a list, as wide as the panel, with a button that empties it.
pub(crate) fn search_field_ui(name: Word, text: &mut String, ui: &mut Ui) -> Response {
    let theme = theme_of(ui);
    let size = vec2(ui.available_width(), theme.row_height());
    let room = theme.hit() as i8;
    let edit = TextEdit::singleline(text)
        .hint_text(say(name, ui))
        .font(theme.font(Type::Body))
        .margin(Margin { left: 8, right: room, top: 5, bottom: 5 })
        .align(Align2::LEFT_CENTER)
        .desired_width(size.x);
    let response = ui.add_sized(size, edit).accessible_name(say(name, ui));
    if !text.is_empty() {
        let side = vec2(theme.hit(), response.rect.height());
        let at = Align2::RIGHT_CENTER.anchor_size(response.rect.right_center(), side);
        let id = response.id.with("clear");
        let ground = Color32::TRANSPARENT;
        if small_icon_ui(Icon::Close, words::CLEAR_SEARCH, id, at, ground, ui).clicked() {
            text.clear();
        }
    }
    response
}

/// Draws a value that cannot be changed: the label at the left, the number and its unit at the
/// right, as in the row of a slider.
pub(crate) fn value_row_ui(label: Word, value: &str, unit: Word, ui: &mut Ui) -> Response {
    let (theme, palette) = (theme_of(ui), palette_of(ui));
    let enabled = ui.is_enabled();
    let row = full_width((22.0 * theme.scale()).round(), ui);
    let mut runs = vec![Run::new(Text::Data(value), Type::Number, faded(palette.text, enabled))];
    if !unit.is_empty() {
        runs.push(Run::new(unit, Type::Label, faded(palette.muted, enabled)).after(space::XS));
    }
    let number = line_of(&runs, row.width() * 0.6, ui);
    let at = put(ui.painter(), row.right_center(), Align2::RIGHT_CENTER, number);
    let label_galley = line_of(
        &[Run::new(label, Type::Label, faded(palette.text, enabled))],
        at.left() - row.left() - space::S,
        ui,
    );
    put(ui.painter(), pos2(row.left(), row.center().y), Align2::LEFT_CENTER, label_galley);
    let response =
        ui.interact(row, ui.make_persistent_id(("value", label.english())), Sense::hover());
    let said = format!("{}: {value} {}", say(label, ui), say(unit, ui));
    describe(&response, &WidgetInfo::labeled(Role::Label, enabled, said));
    response
}
