//! The row of a clip in the library.

use super::assistive::describe;
use super::chip::{Part, paint_badge};
use super::icon::{Icon, paint_icon};
use super::paint::{Run, focus_ring, full_width, line_of, paragraph, put};
use crate::ui::language::{Text, Word, say};
use crate::ui::theme::{HIT, Type, palette_of, radius, space, theme_of};
use eframe::egui::{
    Align2, Color32, CursorIcon, Id, Rect, Response, Role, Sense, Stroke, Ui, Vec2, WidgetInfo,
    pos2, vec2,
};

/// A clip as its row shows it.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ClipRow<'a> {
    /// Its name.
    pub(crate) name: Text<'a>,
    /// Length, rate, joints: `3.9 s · 120 fps · 30 joints`. Wraps.
    pub(crate) detail: Text<'a>,
    /// Its part in the result.
    pub(crate) part: Part,
    /// The warnings about its file, for the hint of the sign; empty for none.
    pub(crate) warning: Text<'a>,
    /// Whether its details are open.
    pub(crate) selected: bool,
    /// The icons of its actions, shown while the pointer is on the row, with their names.
    pub(crate) actions: &'a [(Icon, Word)],
}

/// The user's input to a row of the library.
#[derive(Debug)]
pub(crate) struct ClipRowResponse {
    /// The row was chosen.
    pub(crate) clicked: bool,
    /// The one of [`ClipRow::actions`] that was pressed.
    pub(crate) action: Option<usize>,
    /// The letter was pressed: the clip gets another part.
    pub(crate) badge_clicked: bool,
    /// The row, which can be dragged; give it a payload with `dnd_set_drag_payload`.
    pub(crate) response: Response,
}

/// Draws the row of a clip: its letter, name and facts, a sign if there are warnings, and the
/// actions while the pointer is on it.
pub(crate) fn clip_row_ui(row: ClipRow<'_>, ui: &mut Ui) -> ClipRowResponse {
    let (theme, palette) = (theme_of(ui), palette_of(ui));
    let scale = theme.scale();
    let badge_side = (22.0 * scale).round();
    let pad = space::S;
    let width = ui.available_width();
    let text_left = pad + badge_side + space::M - 2.0;
    let warn = if row.warning.is_empty() { 0.0 } else { HIT };
    let text_width = width - text_left - pad - warn;
    let detail = paragraph(row.detail, Type::Small, palette.muted, text_width, ui);
    let name_height = (18.0 * scale).round();
    let height = (name_height + detail.size().y + 2.0 * pad).max(44.0 * scale).round();
    let rect = full_width(height, ui);
    let id = ui.make_persistent_id(("clip", row.name.english()));
    let response =
        ui.interact(rect, id, Sense::click_and_drag()).on_hover_cursor(CursorIcon::PointingHand);

    // The pointer may be on a button inside the row: the row is hovered then as well.
    let hovered = response.contains_pointer();
    let ground = match (row.selected, hovered) {
        (true, _) => palette.pressed,
        (false, true) => palette.hover,
        (false, false) => Color32::TRANSPARENT,
    };
    ui.painter().rect_filled(rect, radius::M, ground);
    let badge = Rect::from_min_size(
        pos2(rect.left() + pad, rect.top() + pad + 3.0),
        Vec2::splat(badge_side),
    );
    paint_badge(row.part, badge, ui);

    let show_actions = (hovered || response.has_focus()) && !row.actions.is_empty();
    let actions_width = if show_actions { row.actions.len() as f32 * HIT + 2.0 } else { 0.0 };
    let name =
        line_of(&[Run::new(row.name, Type::Strong, palette.text)], text_width - actions_width, ui);
    let middle = rect.top() + pad + name_height / 2.0;
    put(ui.painter(), pos2(rect.left() + text_left, middle), Align2::LEFT_CENTER, name);
    put(
        ui.painter(),
        pos2(rect.left() + text_left, rect.top() + pad + name_height),
        Align2::LEFT_TOP,
        detail,
    );
    focus_ring(rect.shrink(2.0), radius::M, &response, ui);
    let name = say(row.name, ui);
    let said = format!("{name}, {}", say(row.detail, ui));
    describe(&response, &WidgetInfo::selected(Role::Button, ui.is_enabled(), row.selected, said));

    let badge_hit = badge.expand((HIT - badge_side).max(0.0) / 2.0 + 4.0);
    let badge_response = ui
        .interact(badge_hit, id.with("badge"), Sense::click())
        .on_hover_cursor(CursorIcon::PointingHand);
    focus_ring(badge, radius::S, &badge_response, ui);
    let said = format!("{name}: {}", row.part.letter());
    describe(&badge_response, &WidgetInfo::labeled(Role::Button, ui.is_enabled(), said));
    if badge_response.hovered() {
        let ring = Stroke::new(1.5, palette.text);
        ui.painter().rect_stroke(
            badge.expand(2.0),
            radius::M,
            ring,
            eframe::egui::StrokeKind::Middle,
        );
    }

    let mut right = rect.right() - pad / 2.0;
    if !row.warning.is_empty() {
        let at = Rect::from_center_size(pos2(right - HIT / 2.0, middle), Vec2::splat(HIT));
        let sign = ui.interact(at, id.with("warning"), Sense::hover());
        paint_icon(Icon::Warning, at.shrink(4.5), palette.warning, ui.painter());
        describe(&sign, &WidgetInfo::labeled(Role::Label, true, say(row.warning, ui)));
        sign.on_hover_text(say(row.warning, ui));
        right -= HIT;
    }
    let mut action = None;
    if show_actions {
        for (index, &(icon, hint)) in row.actions.iter().enumerate().rev() {
            let at = Rect::from_center_size(pos2(right - HIT / 2.0, middle), Vec2::splat(HIT));
            if small_icon_ui(icon, hint, id.with(("action", index)), at, ground, ui).clicked() {
                action = Some(index);
            }
            right -= HIT;
        }
    }
    let badge_clicked = badge_response.clicked();
    ClipRowResponse {
        clicked: response.clicked() && action.is_none() && !badge_clicked,
        action,
        badge_clicked,
        response,
    }
}

/// Draws an icon inside another widget, as a button of its own.
pub(super) fn small_icon_ui(
    icon: Icon,
    name: Word,
    id: Id,
    rect: Rect,
    ground: Color32,
    ui: &Ui,
) -> Response {
    let palette = palette_of(ui);
    let response = ui.interact(rect, id, Sense::click()).on_hover_cursor(CursorIcon::PointingHand);
    let hot = response.hovered() || response.has_focus();
    if hot {
        ui.painter().rect_filled(rect.shrink(1.0), radius::S, palette.pressed);
    } else {
        // A name that is longer than the row shows through otherwise.
        ui.painter().rect_filled(rect.shrink(1.0), radius::S, ground);
    }
    paint_icon(
        icon,
        rect.shrink2(vec2(5.0, 5.0)),
        if hot { palette.text } else { palette.muted },
        ui.painter(),
    );
    focus_ring(rect, radius::S, &response, ui);
    describe(&response, &WidgetInfo::labeled(Role::Button, ui.is_enabled(), say(name, ui)));
    response.on_hover_text(say(name, ui))
}
