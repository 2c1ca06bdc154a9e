//! What divides a panel: headings and hairlines.

use super::paint::{Run, full_width, line_of, put};
use crate::ui::theme::{Type, palette_of, theme_of};
use eframe::egui::{Align2, CollapsingHeader, Rect, RichText, Ui};

/// The heading of a section, set in quiet capitals. Returns the line it stands on, for a button at its right end.
pub(crate) fn section_header_ui(title: &str, ui: &mut Ui) -> Rect {
    let rect = full_width((24.0 * theme_of(ui).scale()).round(), ui);
    let capitals = title.to_uppercase();
    let galley = line_of(&[Run::new(&capitals, Type::Caps, palette_of(ui).muted)], rect.width(), ui);
    put(ui.painter(), rect.left_center(), Align2::LEFT_CENTER, galley);
    rect
}

/// A section that is folded until it is asked for. Whether its content was shown.
pub(crate) fn folded_ui(title: &str, ui: &mut Ui, content: impl FnOnce(&mut Ui)) -> bool {
    let words = RichText::new(title)
        .font(theme_of(ui).font(Type::Strong))
        .color(palette_of(ui).muted);
    let shown = CollapsingHeader::new(words).id_salt(title).show_unindented(ui, content);
    shown.body_response.is_some()
}
