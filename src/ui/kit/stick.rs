//! A joystick on the screen.

use super::assistive::describe;
use crate::ui::language::{Word, say};
use crate::ui::theme::{palette_of, theme_of};
use eframe::egui::{CursorIcon, Pos2, Rect, Role, Sense, Stroke, Ui, Vec2, WidgetInfo, vec2};

/// Radius of the ring, points at a desk.
const RADIUS: f32 = 46.0;
/// Radius of the knob.
const KNOB: f32 = 17.0;

/// Returns the width and height of the stick.
pub(crate) fn stick_size(ui: &Ui) -> f32 {
    (2.0 * RADIUS * theme_of(ui).scale()).round()
}

/// Draws the stick about `center`. While it is released, it is shown pushed by `shown`: each from
/// -1 to 1, to the right and up. Returns the push of the hand, of length 1 at most; `None` while it
/// is released.
pub(crate) fn stick_ui(label: Word, center: Pos2, shown: Vec2, ui: &mut Ui) -> Option<Vec2> {
    let (theme, palette) = (theme_of(ui), palette_of(ui));
    let radius = RADIUS * theme.scale();
    let rect = Rect::from_center_size(center, Vec2::splat(2.0 * radius));
    let response = ui
        .interact(rect, ui.make_persistent_id(label.english()), Sense::drag())
        .on_hover_cursor(CursorIcon::Grab);
    describe(&response, &WidgetInfo::labeled(Role::Image, true, say(label, ui)));
    let reach = radius - 0.5 * KNOB * theme.scale();
    let held = response.dragged() || response.is_pointer_button_down_on();
    let pushed = response.interact_pointer_pos().filter(|_| held).map(|pos| {
        let off = (pos - center) / reach;
        vec2(off.x, -off.y) / off.length().max(1.0)
    });
    let at = pushed.unwrap_or(shown);
    let painter = ui.painter();
    painter.circle(
        center,
        radius - 1.0,
        palette.panel.gamma_multiply(0.55),
        Stroke::new(theme.hairline().max(1.0), palette.line_strong),
    );
    for turn in 0..4_u8 {
        let way = Vec2::angled(f32::from(turn) * std::f32::consts::FRAC_PI_2);
        let mark = Stroke::new(1.5, palette.muted.gamma_multiply(0.7));
        painter.line_segment([center + way * (radius - 9.0), center + way * (radius - 5.0)], mark);
    }
    let knob = center + vec2(at.x, -at.y) * reach;
    let fill = if at == Vec2::ZERO { palette.handle.gamma_multiply(0.75) } else { palette.accent };
    painter.circle(knob, KNOB * theme.scale(), fill, Stroke::new(1.5, palette.panel));
    pushed
}
