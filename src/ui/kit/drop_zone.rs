//! The zone where files are dropped or opened.

use super::button::{Button, button_ui};
use super::paint::{paragraph, put};
use crate::ui::language::Word;
use crate::ui::theme::{Type, palette_of, radius, space, theme_of};
use eframe::egui::{Align, Align2, Layout, Rect, Shape, Stroke, Ui, UiBuilder, pos2, vec2};
use std::f32::consts::FRAC_PI_2;

/// A button of a drop zone.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DropButton {
    /// Its label.
    pub(crate) text: Word,
    /// Whether it is the main action in sight.
    pub(crate) is_main: bool,
    /// Whether it has something open.
    pub(crate) is_open: bool,
}

/// Draws a dashed field with rows of buttons, and a sentence below. `hot`: whether files are held
/// over the window. Returns the button that was pressed, counted over all rows.
pub(crate) fn drop_zone_ui(
    sentence: Word,
    rows: &[&[DropButton]],
    hot: bool,
    ui: &mut Ui,
) -> Option<usize> {
    let (theme, palette) = (theme_of(ui), palette_of(ui));
    let width = ui.available_width();
    let ink = if hot { palette.accent_ink } else { palette.muted };
    let text = paragraph(sentence, Type::Small, ink, width - 2.0 * space::M, ui);
    let row_height = theme.row_height();
    let step = row_height + space::S;
    let height = (text.size().y + rows.len() as f32 * step + 2.0 * space::M).round();
    let (_, rect) = ui.allocate_space(vec2(width, height));
    if hot {
        ui.painter().rect_filled(rect, radius::L, palette.accent_wash);
    }
    let line = if hot { palette.accent } else { palette.line_strong };
    dashed_rect(rect.shrink(0.5), f32::from(radius::L), Stroke::new(theme.hairline(), line), ui);
    let mut row = Rect::from_min_size(
        rect.min + vec2(space::M, space::M),
        vec2(width - 2.0 * space::M, row_height),
    );
    let (mut pressed, mut before) = (None, 0);
    for buttons in rows {
        let builder = UiBuilder::new()
            .id_salt((sentence.english(), before))
            .max_rect(row)
            .layout(Layout::left_to_right(Align::Center));
        // The buttons get a child of their own: the zone's space is already allocated.
        let mut inner = ui.new_child(builder);
        pressed = drop_buttons_ui(buttons, &mut inner).map(|index| before + index).or(pressed);
        before += buttons.len();
        row = row.translate(vec2(0.0, step));
    }
    put(ui.painter(), row.left_top(), Align2::LEFT_TOP, text);
    pressed
}

/// Draws the buttons of a drop zone in the row of `ui`. Returns the one that was pressed.
pub(crate) fn drop_buttons_ui(buttons: &[DropButton], ui: &mut Ui) -> Option<usize> {
    ui.spacing_mut().item_spacing.x = space::S;
    let mut pressed = None;
    for (index, &DropButton { text, is_main, is_open }) in buttons.iter().enumerate() {
        let button = Button::new(text).selected(is_open);
        let button = if is_main { button.primary() } else { button };
        if button_ui(button, ui).clicked() {
            pressed = Some(index);
        }
    }
    pressed
}

/// Draws the outline of a rectangle with round corners, in dashes.
fn dashed_rect(rect: Rect, corner: f32, stroke: Stroke, ui: &Ui) {
    let mut path = Vec::new();
    let corners = [
        (pos2(rect.right() - corner, rect.top() + corner), -FRAC_PI_2),
        (pos2(rect.right() - corner, rect.bottom() - corner), 0.0),
        (pos2(rect.left() + corner, rect.bottom() - corner), FRAC_PI_2),
        (pos2(rect.left() + corner, rect.top() + corner), 2.0 * FRAC_PI_2),
    ];
    for (center, from) in corners {
        for step in 0..=6_u8 {
            let angle = from + FRAC_PI_2 * f32::from(step) / 6.0;
            path.push(center + corner * vec2(angle.cos(), angle.sin()));
        }
    }
    path.extend(path.first().copied());
    ui.painter().extend(Shape::dashed_line(&path, stroke, 4.0, 4.0));
}
