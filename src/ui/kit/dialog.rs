//! A panel over the middle of the page, with a title and a button that closes it.

use crate::ui::language::{Word, say};
use crate::ui::theme::{Type, space, theme_of};
use eframe::egui::{Align2, RichText, ScrollArea, Ui, Window};

/// Draws a panel of this width (points), or as wide as the screen allows; contents that are higher
/// than the screen scroll. Returns whether it stays open.
pub(crate) fn dialog_ui(title: Word, width: f32, contents: impl FnOnce(&mut Ui), ui: &Ui) -> bool {
    let theme = theme_of(ui);
    let width = width.min(max_dialog_width(ui));
    let height = ui.ctx().content_rect().height() - 6.0 * space::L - theme.row_height();
    let mut open = true;
    Window::new(RichText::new(say(title, ui)).font(theme.font(Type::Title)))
        .anchor(Align2::CENTER_CENTER, [0.0, 0.0])
        .default_size([width, height])
        .collapsible(false)
        .resizable(false)
        .open(&mut open)
        .show(ui.ctx(), |ui| {
            ui.set_width(width);
            ScrollArea::vertical().max_height(height).auto_shrink([false, true]).show(ui, contents);
        });
    open
}

/// Returns the greatest width of a panel, points.
pub(crate) fn max_dialog_width(ui: &Ui) -> f32 {
    ui.ctx().content_rect().width() - 4.0 * space::L
}
