//! The sections of a panel: headings, folded parts and notes.

use super::assistive::describe;
use super::icon::{Icon, paint_icon};
use super::paint::{Run, full_width, line_of, put};
use crate::ui::language::{Text, Word, say};
use crate::ui::theme::{Type, palette_of, space, theme_of};
use eframe::egui::{
    Align, Align2, CollapsingHeader, Color32, Label, Layout, Rect, RichText, Role, Sense, Ui,
    UiBuilder, WidgetInfo, vec2,
};

/// Draws the heading of a section, in quiet capitals. Returns its line, for a mark at the right
/// end.
pub(crate) fn section_header_ui(title: Word, ui: &mut Ui) -> Rect {
    heading_ui(title, 0.0, ui)
}

/// Draws a heading in whose line a button stands, as [`section_header_ui`] does.
pub(crate) fn section_header_with_button_ui(title: Word, ui: &mut Ui) -> Rect {
    heading_ui(title, theme_of(ui).row_height(), ui)
}

fn heading_ui(title: Word, least_height: f32, ui: &mut Ui) -> Rect {
    let rect = full_width((24.0 * theme_of(ui).scale()).round().max(least_height), ui);
    let capitals = say(title, ui).to_uppercase();
    let run = Run::new(Text::Data(&capitals), Type::Caps, palette_of(ui).muted);
    let galley = line_of(&[run], rect.width(), ui);
    put(ui.painter(), rect.left_center(), Align2::LEFT_CENTER, galley);
    let id = ui.make_persistent_id(("heading", title.english()));
    let response = ui.interact(rect, id, Sense::hover());
    describe(&response, &WidgetInfo::labeled(Role::Heading, true, say(title, ui)));
    rect
}

/// Returns the width of the words of a heading.
pub(crate) fn section_header_width(title: Word, ui: &Ui) -> f32 {
    let capitals = say(title, ui).to_uppercase();
    let run = Run::new(Text::Data(&capitals), Type::Caps, palette_of(ui).muted);
    line_of(&[run], f32::INFINITY, ui).size().x
}

/// Draws a quiet word at the right end of the line of a heading.
pub(crate) fn section_mark_ui(words: Word, header: Rect, ui: &mut Ui) {
    let at = header.shrink2(vec2(space::XS, 0.0));
    let mut ui =
        ui.new_child(UiBuilder::new().max_rect(at).layout(Layout::right_to_left(Align::Center)));
    let (font, muted) = (theme_of(&ui).font(Type::Small), palette_of(&ui).muted);
    ui.label(RichText::new(say(words, &ui)).font(font).color(muted));
}

/// Draws a section that is folded at first. Returns whether its content was shown.
pub(crate) fn folded_ui<'a>(
    title: impl Into<Text<'a>>,
    ui: &mut Ui,
    content: impl FnOnce(&mut Ui),
) -> bool {
    folded_unless_ui(false, title, ui, content)
}

/// Draws a section that is folded at first, as [`folded_ui`] does. With `is_asked_for` it unfolds
/// and is scrolled into sight.
pub(crate) fn folded_unless_ui<'a>(
    is_asked_for: bool,
    title: impl Into<Text<'a>>,
    ui: &mut Ui,
    content: impl FnOnce(&mut Ui),
) -> bool {
    let title = title.into();
    let words = RichText::new(say(title, ui))
        .font(theme_of(ui).font(Type::Strong))
        .color(palette_of(ui).muted);
    let header =
        CollapsingHeader::new(words).id_salt(title.template()).icon(|ui, openness, response| {
            let sign = if openness < 0.5 { Icon::ChevronRight } else { Icon::ChevronDown };
            let palette = palette_of(ui);
            let ink = if response.hovered() { palette.text } else { palette.muted };
            let side = (14.0 * theme_of(ui).scale()).round();
            let at = Rect::from_center_size(response.rect.center(), vec2(side, side));
            paint_icon(sign, at, ink, ui.painter());
        });
    let shown = header.open(is_asked_for.then_some(true)).show_unindented(ui, content);
    if is_asked_for {
        shown.header_response.scroll_to_me(Some(Align::Min));
    }
    shown.body_response.is_some()
}

/// Draws a sentence about the rows above or below it. It can be selected, with the numbers in it.
pub(crate) fn note_ui<'a>(words: impl Into<Text<'a>>, color: Color32, ui: &mut Ui) {
    let words = RichText::new(say(words, ui)).font(theme_of(ui).font(Type::Small)).color(color);
    ui.add(Label::new(words).selectable(true));
    ui.add_space(space::XS);
}
