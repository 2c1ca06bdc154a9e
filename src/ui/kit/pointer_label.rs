//! A short text beside the pointer.

use super::assistive::readable_ui;
use super::paint::{Run, line_of, put};
use crate::ui::language::{Text, say};
use crate::ui::theme::{Type, palette_of, radius, space, theme_of};
use eframe::egui::{Align2, Pos2, Rect, Stroke, StrokeKind, Ui, vec2};

/// The distance from the pointer, points.
const ASIDE: f32 = 14.0;

/// Draws a text beside the pointer, on the side that has room within `place`.
pub(crate) fn pointer_label_ui(text: Text<'_>, pointer: Pos2, place: Rect, ui: &Ui) {
    let (theme, palette) = (theme_of(ui), palette_of(ui));
    let galley = line_of(&[Run::new(text, Type::Body, palette.text)], place.width(), ui);
    let size = galley.size() + vec2(2.0 * space::S, space::S);
    let right = pointer.x + ASIDE + size.x <= place.right();
    let below = pointer.y + ASIDE + size.y <= place.bottom();
    let corner =
        pointer + vec2(if right { ASIDE } else { -ASIDE }, if below { ASIDE } else { -ASIDE });
    let anchor = match (right, below) {
        (true, true) => Align2::LEFT_TOP,
        (true, false) => Align2::LEFT_BOTTOM,
        (false, true) => Align2::RIGHT_TOP,
        (false, false) => Align2::RIGHT_BOTTOM,
    };
    let rect = anchor.anchor_size(corner, size);
    let line = Stroke::new(theme.hairline(), palette.line);
    ui.painter().rect(rect, radius::M, palette.panel_raised, line, StrokeKind::Inside);
    put(ui.painter(), rect.center(), Align2::CENTER_CENTER, galley);
    readable_ui(&say(text, ui), rect, ui.scope_id().with("pointer-label"), ui);
}
