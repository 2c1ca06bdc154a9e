//! A row with a switch: a label, the state as a word, and the switch.

use super::assistive::describe;
use super::help::Help;
use super::paint::{Run, faded, focus_ring, full_width, line_of, put};
use super::words;
use crate::ui::language::{Text, Word, say};
use crate::ui::theme::{Type, palette_of, space, theme_of};
use eframe::egui::{Align2, Rect, Role, Sense, Stroke, StrokeKind, Ui, WidgetInfo, pos2, vec2};

/// Draws a row with a switch that a click anywhere on the row turns. Returns the new state when it
/// was turned.
pub(crate) fn switch_row_ui(label: Word, on: bool, ui: &mut Ui) -> Option<bool> {
    helped_switch_row_ui(label, Text::EMPTY, on, ui)
}

/// Draws a row with a switch as [`switch_row_ui`] does, with a help text.
pub(crate) fn helped_switch_row_ui(
    label: Word,
    help: Text<'_>,
    on: bool,
    ui: &mut Ui,
) -> Option<bool> {
    let (theme, palette) = (theme_of(ui), palette_of(ui));
    let enabled = ui.is_enabled();
    let scale = theme.scale();
    let id = ui.make_persistent_id(label.english());
    let help = Help { label: label.into(), text: help, id };
    let row = full_width(theme.row_height(), ui);
    let response = ui.interact(row, id, Sense::click());
    let switched = response.clicked().then_some(!on);
    let shown = switched.unwrap_or(on);

    let size = (vec2(30.0, 18.0) * scale).round();
    let track =
        Rect::from_min_size(pos2(row.right() - size.x, row.center().y - size.y / 2.0), size);
    let t = ui.ctx().animate_bool_responsive(id, shown);
    let empty = if response.hovered() { palette.pressed } else { palette.track };
    let fill = faded(empty.lerp_to_gamma(palette.accent_fill, t), enabled);
    ui.painter().rect_filled(track, size.y / 2.0, fill);
    if t < 1.0 {
        let outline = Stroke::new(theme.hairline(), palette.line_strong.gamma_multiply(1.0 - t));
        ui.painter().rect_stroke(track, size.y / 2.0, outline, StrokeKind::Inside);
    }
    let knob = size.y / 2.0 - 3.0 * scale;
    let travel = size.x - size.y;
    let at = pos2(track.left() + size.y / 2.0 + t * travel, track.center().y);
    let off_tone = palette.muted;
    ui.painter().circle_filled(
        at,
        knob,
        faded(off_tone.lerp_to_gamma(palette.accent_text, t), enabled),
    );

    let (word, tone) = if shown { (words::ON, palette.text) } else { (words::OFF, palette.muted) };
    let word = line_of(
        &[Run::new(word, if shown { Type::Strong } else { Type::Label }, faded(tone, enabled))],
        f32::INFINITY,
        ui,
    );
    let word = put(
        ui.painter(),
        pos2(track.left() - space::S, row.center().y),
        Align2::RIGHT_CENTER,
        word,
    );
    let label_galley = line_of(
        &[Run::new(label, Type::Label, faded(palette.text, enabled))],
        word.left() - row.left() - space::S - help.sign_width(ui),
        ui,
    );
    let label_rect = put(ui.painter(), row.left_center(), Align2::LEFT_CENTER, label_galley);
    focus_ring(track, 10, &response, ui);
    describe(&response, &WidgetInfo::selected(Role::Switch, enabled, shown, say(label, ui)));
    help.describe(response.id, ui);
    response.on_hover_ui(|ui| help.tip_ui(ui));
    help.sign_ui(label_rect.right_center(), ui);
    help.line_ui(ui);
    switched
}
