//! The line above the track: the label, whether the value is automatic, the value and its unit, and
//! the field to type one.

use super::super::assistive::describe;
use super::super::help::Help;
use super::super::paint::{Run, faded, focus_ring, line_of, put};
use super::super::words;
use super::row::{SliderResponse, SliderRow, Source};
use crate::ui::language::{Text, say};
use crate::ui::theme::{self, Type, palette_of, space, theme_of};
use eframe::egui::{
    self, Align2, CursorIcon, Id, Key, Pos2, Rect, Response, RichText, Role, Sense, Stroke,
    StrokeKind, Ui, WidgetInfo, pos2, vec2,
};

/// Draws the line with label and value. Returns the label, which may be double-clicked.
pub(super) fn head_ui(
    value: f64,
    row: &SliderRow<'_>,
    help: Help<'_>,
    head: Rect,
    id: Id,
    out: &mut SliderResponse,
    ui: &mut Ui,
) -> Response {
    let (theme, palette) = (theme_of(ui), palette_of(ui));
    let enabled = ui.is_enabled();
    let (text, muted) = (faded(palette.text, enabled), faded(palette.muted, enabled));
    let shown = out.changed.unwrap_or(value);

    let written = row.written(shown);
    let number = line_of(&[Run::new(Text::Data(&written), Type::Number, text)], f32::INFINITY, ui);
    let mut tail = Vec::new();
    if !row.unit.is_empty() {
        tail.push(Run::new(row.unit, Type::Label, muted).after(space::XS));
    }
    if !row.secondary.is_empty() {
        tail.push(Run::new(Text::Data("·"), Type::Label, muted).after(space::XS));
        tail.push(Run::new(Text::Data(row.secondary), Type::Label, muted).after(space::XS));
    }
    let tail = line_of(&tail, f32::INFINITY, ui);
    let mut right = head.right();
    put(ui.painter(), pos2(right, head.center().y), Align2::RIGHT_CENTER, tail.clone());
    right -= tail.size().x;

    let pad = space::XS;
    let number_rect = Align2::RIGHT_CENTER
        .anchor_size(pos2(right, head.center().y), number.size())
        .expand2(vec2(pad, 2.0));
    let edit_id = id.with("typed");
    let typed = ui.data(|data| data.get_temp::<String>(edit_id));
    if let Some(mut typed) = typed {
        let wide = number_rect.width().max(64.0 * theme.scale());
        let field = Rect::from_min_max(
            pos2(number_rect.right() - wide, head.top() - 1.0),
            pos2(number_rect.right(), head.bottom() + 1.0),
        );
        edit_ui(&mut typed, edit_id, field, row, out, ui);
        right = field.left();
    } else {
        let mut value_hit = number_rect;
        value_hit.set_left(value_hit.left().min(value_hit.right() - theme::HIT));
        let number_response = ui
            .interact(value_hit, id.with("value"), Sense::click())
            .on_hover_cursor(CursorIcon::Text);
        if number_response.hovered() && enabled {
            ui.painter().rect_filled(number_rect, theme::radius::S, palette.hover);
        }
        put(ui.painter(), number_rect.center(), Align2::CENTER_CENTER, number);
        focus_ring(number_rect, theme::radius::S, &number_response, ui);
        let said = format!("{}: {}", say(row.label, ui), say(words::TYPE_VALUE, ui));
        describe(&number_response, &WidgetInfo::labeled(Role::Button, enabled, said));
        if number_response.clicked() {
            let start = row.written(value).replace('−', "-");
            ui.data_mut(|data| data.insert_temp(edit_id, start));
            ui.data_mut(|data| data.insert_temp(edit_id.with("fresh"), true));
        }
        number_response.on_hover_text(say(words::TYPE_VALUE, ui));
        right = value_hit.left();
    }

    if row.source != Source::Manual {
        right = auto_tag_ui(row, pos2(right - space::XS, head.center().y), id, out, ui).left();
    }

    let room = right - head.left() - space::S - help.sign_width(ui);
    let label = line_of(&[Run::new(row.label, Type::Label, text)], room, ui);
    let rect = put(ui.painter(), head.left_center(), Align2::LEFT_CENTER, label);
    help.sign_ui(rect.right_center(), ui);
    ui.interact(rect, id.with("label"), Sense::CLICK).on_hover_ui(|ui| {
        help.tip_ui(ui);
        ui.label(RichText::new(say(words::RESET_HINT, ui)).color(palette.muted));
    })
}

/// Draws the word `auto`: filled while the value is automatic, an outlined button while it could
/// be.
fn auto_tag_ui(
    row: &SliderRow<'_>,
    right_center: Pos2,
    id: Id,
    out: &mut SliderResponse,
    ui: &Ui,
) -> Rect {
    let (theme, palette) = (theme_of(ui), palette_of(ui));
    let auto = row.source == Source::Auto;
    let hit_id = id.with("auto");
    let hot = !auto
        && ui
            .ctx()
            .read_response(hit_id)
            .is_some_and(|response| response.hovered() || response.has_focus());
    let ink = if auto || hot { palette.accent_ink } else { palette.muted };
    let tag = line_of(&[Run::new(words::AUTO, Type::SmallStrong, ink)], f32::INFINITY, ui);
    let at = Align2::RIGHT_CENTER.anchor_size(right_center, tag.size() + vec2(12.0, 4.0));
    let corner = at.height() / 2.0;
    if auto || hot {
        ui.painter().rect_filled(at, corner, palette.accent_wash);
    } else {
        let line = Stroke::new(theme.hairline(), palette.line_strong);
        ui.painter().rect_stroke(at, corner, line, StrokeKind::Inside);
    }
    put(ui.painter(), at.center(), Align2::CENTER_CENTER, tag);
    if !auto {
        let hit = Rect::from_center_size(at.center(), at.size().max(vec2(theme::HIT, theme::HIT)));
        let response =
            ui.interact(hit, hit_id, Sense::click()).on_hover_cursor(CursorIcon::PointingHand);
        focus_ring(at, 8, &response, ui);
        let name = format!("{}: {}", say(row.label, ui), say(words::AUTO, ui));
        describe(&response, &WidgetInfo::labeled(Role::Button, ui.is_enabled(), name));
        out.reset |= response.clicked();
    }
    at
}

fn edit_ui(
    typed: &mut String,
    edit_id: Id,
    field: Rect,
    row: &SliderRow<'_>,
    out: &mut SliderResponse,
    ui: &mut Ui,
) {
    let fresh_id = edit_id.with("fresh");
    let fresh = ui.data_mut(|data| data.remove_temp::<bool>(fresh_id)).unwrap_or(false);
    let font = theme_of(ui).font(Type::Number);
    // Read before the field sees the keys: Esc also takes the focus away, and must not commit.
    let escape = ui.input(|input| input.key_pressed(Key::Escape));
    let edit = egui::TextEdit::singleline(typed)
        .id(edit_id.with("field"))
        .font(font)
        .align(egui::Align2::RIGHT_CENTER);
    let edit = edit.desired_width(field.width()).margin(egui::Margin::symmetric(4, 1));
    let response = ui.put(field, edit).accessible_name(say(row.label, ui));
    if fresh {
        response.request_focus();
        if let Some(mut state) = egui::TextEdit::load_state(ui.ctx(), response.id) {
            let all = egui::text::CCursorRange::two(
                egui::text::CCursor::default(),
                egui::text::CCursor { index: typed.chars().count().into(), ..Default::default() },
            );
            state.cursor.set_char_range(Some(all));
            state.store(ui.ctx(), response.id);
        }
    }
    if response.lost_focus() || (escape && !fresh) {
        if !escape && let Some(value) = parsed(typed) {
            out.changed = Some(value.clamp(*row.range.start(), *row.range.end()));
        }
        ui.data_mut(|data| data.remove::<String>(edit_id));
        out.response.request_focus();
    } else {
        ui.data_mut(|data| data.insert_temp(edit_id, typed.clone()));
    }
}

/// Returns the number in a typed text. A decimal comma, a true minus sign and a unit behind it are
/// accepted.
fn parsed(typed: &str) -> Option<f64> {
    let plain = typed.trim().replace(',', ".").replace('−', "-");
    let end = plain
        .find(|c: char| !(c.is_ascii_digit() || matches!(c, '.' | '-' | '+')))
        .unwrap_or(plain.len());
    plain.get(..end)?.parse::<f64>().ok().filter(|value| value.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn typed_number_may_have_a_unit_and_a_comma() {
        assert_eq!(parsed(" 30 frames"), Some(30.0));
        assert_eq!(parsed("0,25 s"), Some(0.25));
        assert_eq!(parsed("−12.5°"), Some(-12.5));
        assert_eq!(parsed("frames"), None);
        assert_eq!(parsed(""), None);
        assert_eq!(parsed("inf"), None);
    }
}
