//! A weight over time, as a curve through keys that can be dragged.

use super::assistive::describe;
use super::keys::keys_pressed;
use super::paint::{Run, focus_ring, line_of, put};
use crate::ui::language::{Word, say};
use crate::ui::theme::{Type, palette_of, radius, theme_of};
use eframe::egui::{
    Align2, CursorIcon, Id, Key, Mesh, Pos2, Rect, Role, Sense, Shape, Stroke, StrokeKind, Ui,
    WidgetInfo, pos2, vec2,
};
use segue_text::msg;

/// A key: per cent of the time and per cent of the weight.
type CurveKey = (usize, usize);

/// The content of the row.
#[derive(Clone, Debug)]
pub(crate) struct WeightCurveRow<'a> {
    /// The accessible name.
    pub(crate) label: Word,
    /// The keys, in the order of time.
    pub(crate) keys: &'a [CurveKey],
    /// The curve through them: weights at equal intervals, 0 to 1.
    pub(crate) curve: &'a [f64],
    /// The playhead as a share of the time, 0 to 1.
    pub(crate) now: Option<f64>,
    /// The labels of the ends of the weight: 1, and 0.
    pub(crate) ends: [Word; 2],
}

/// The user's input to the curve.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum WeightCurveEvent {
    /// The new keys.
    Keys(Vec<CurveKey>),
    /// The key was released: the changes since it was taken are one step of undo.
    Settled,
}

const HEIGHT: f32 = 96.0;
/// The distance within which a key is taken hold of, points: a target of 24 points.
const REACH: f32 = 12.0;

/// Draws the curve as wide as there is room. Drag a key to move it, double-click to add or remove
/// one. With the keyboard, Tab goes from key to key, arrows move the one that has the focus (with
/// Shift by ten), Delete removes it.
pub(crate) fn weight_curve_ui(row: &WeightCurveRow<'_>, ui: &mut Ui) -> Vec<WeightCurveEvent> {
    let (theme, palette) = (theme_of(ui), palette_of(ui));
    let scale = theme.scale();
    let (_, whole) = ui.allocate_space(vec2(ui.available_width(), (HEIGHT * scale).round()));
    // The margin keeps keys at the ends whole.
    let field = whole.shrink((REACH * 0.5 * scale).round());
    let id = ui.make_persistent_id(row.label.english());
    let ground = ui.interact(whole, id, Sense::click_and_drag());
    describe(&ground, &WidgetInfo::labeled(Role::Image, true, say(row.label, ui)));
    let place = |key: CurveKey| {
        let share = |per_cent: usize| per_cent as f32 / 100.0;
        pos2(
            field.left() + share(key.0) * field.width(),
            field.bottom() - share(key.1) * field.height(),
        )
    };
    let key_at = |pos: Pos2| {
        let per_cent = |share: f32| (share.clamp(0.0, 1.0) * 100.0).round() as usize;
        (
            per_cent((pos.x - field.left()) / field.width().max(1.0)),
            per_cent((field.bottom() - pos.y) / field.height().max(1.0)),
        )
    };
    let mut events = Vec::new();
    let near = |pos: Pos2| {
        let off = |index: usize| place(row.keys[index]).distance(pos);
        let nearest = (0..row.keys.len()).min_by(|&x, &y| off(x).total_cmp(&off(y)));
        nearest.filter(|&index| off(index) <= REACH * scale)
    };
    let held_id: Id = id.with("held");
    if ground.drag_started() {
        let origin =
            ui.input(|input| input.pointer.press_origin()).or(ground.interact_pointer_pos());
        ui.data_mut(|data| data.insert_temp(held_id, origin.and_then(near)));
    }
    if let (true, Some(pos)) = (ground.dragged(), ground.interact_pointer_pos())
        && let Some(Some(index)) = ui.data(|data| data.get_temp::<Option<usize>>(held_id))
    {
        events.extend(moved(row.keys, index, key_at(pos)));
    }
    if ground.drag_stopped() {
        events.push(WeightCurveEvent::Settled);
    }
    if let (true, Some(pos)) = (ground.double_clicked(), ground.interact_pointer_pos()) {
        let changed = match near(pos) {
            Some(index) => without(row.keys, index),
            None => Some(with(row.keys, key_at(pos))),
        };
        events.extend(changed.map(WeightCurveEvent::Keys));
        events.push(WeightCurveEvent::Settled);
    }
    if ground.hover_pos().and_then(near).is_some() {
        ui.ctx().set_cursor_icon(CursorIcon::Grab);
    }

    let painter = ui.painter_at(whole);
    painter.rect_filled(field, 0.0, palette.ground);
    let line = Stroke::new(theme.hairline(), palette.line);
    for share in [0.0, 0.5, 1.0] {
        painter.hline(field.x_range(), field.bottom() - share * field.height(), line);
    }
    let last = row.curve.len().saturating_sub(1).max(1) as f32;
    let points: Vec<Pos2> = (row.curve.iter().enumerate())
        .map(|(index, weight)| {
            pos2(
                field.left() + index as f32 / last * field.width(),
                field.bottom() - *weight as f32 * field.height(),
            )
        })
        .collect();
    // One mesh: the soft edges of single columns would show as stripes.
    let mut below = Mesh::default();
    for &point in &points {
        below.colored_vertex(point, palette.b.gamma_multiply(0.18));
        below.colored_vertex(pos2(point.x, field.bottom()), palette.b.gamma_multiply(0.18));
    }
    for left in (0..below.vertices.len().saturating_sub(2) as u32).step_by(2) {
        below.add_triangle(left, left + 1, left + 2);
        below.add_triangle(left + 1, left + 2, left + 3);
    }
    painter.add(below);
    painter.add(Shape::line(points, Stroke::new(2.0 * scale, palette.b)));
    for (words, anchor, at) in [
        (row.ends[0], Align2::LEFT_TOP, field.left_top() + vec2(8.0, 3.0)),
        (row.ends[1], Align2::LEFT_BOTTOM, field.left_bottom() + vec2(8.0, -3.0)),
    ] {
        let galley = line_of(&[Run::new(words, Type::Small, palette.muted)], field.width(), ui);
        put(&painter, at, anchor, galley);
    }
    if let Some(now) = row.now {
        let x = field.left() + now.clamp(0.0, 1.0) as f32 * field.width();
        painter.vline(
            x,
            field.y_range(),
            Stroke::new(theme.hairline(), palette.handle.gamma_multiply(0.6)),
        );
    }
    painter.rect_stroke(
        field,
        0.0,
        Stroke::new(theme.hairline(), palette.line_strong),
        StrokeKind::Outside,
    );
    for (index, &key) in row.keys.iter().enumerate() {
        let at = place(key);
        let handle = Rect::from_center_size(at, vec2(2.0, 2.0) * REACH * scale);
        let response = ui.interact(handle, id.with(index), Sense::focusable_noninteractive());
        let name = msg!(
            "{label}: {weight} % at {time} %",
            label = row.label,
            weight = key.1,
            time = key.0
        );
        describe(&response, &WidgetInfo::labeled(Role::Slider, true, say(&name, ui)));
        if let Some(changed) = response.has_focus().then(|| worked(row.keys, index, ui)).flatten() {
            events.extend([changed, WeightCurveEvent::Settled]);
        }
        painter.circle(
            at,
            5.0 * scale,
            palette.handle,
            Stroke::new(1.5 * scale, palette.on_handle),
        );
        focus_ring(handle, radius::S, &response, ui);
    }
    events
}

/// Returns the change that the keyboard makes to a key.
fn worked(keys: &[CurveKey], index: usize, ui: &Ui) -> Option<WeightCurveEvent> {
    ui.memory_mut(|memory| {
        if let Some(id) = memory.focused() {
            let filter = eframe::egui::EventFilter {
                horizontal_arrows: true,
                vertical_arrows: true,
                ..Default::default()
            };
            memory.set_focus_lock_filter(id, filter);
        }
    });
    let (mut at, mut weight) = keys[index];
    for (key, modifiers) in keys_pressed(ui) {
        let step = if modifiers.shift { 10 } else { 1 };
        match key {
            Key::ArrowLeft => at = at.saturating_sub(step),
            Key::ArrowRight => at = (at + step).min(100),
            Key::ArrowDown => weight = weight.saturating_sub(step),
            Key::ArrowUp => weight = (weight + step).min(100),
            Key::Delete | Key::Backspace => {
                return without(keys, index).map(WeightCurveEvent::Keys);
            }
            _ => {}
        }
    }
    moved(keys, index, (at, weight))
}

/// Returns the keys with one of them moved, between its neighbours, so that the order stays. `None`
/// where nothing changes.
fn moved(keys: &[CurveKey], index: usize, to: CurveKey) -> Option<WeightCurveEvent> {
    let least = index.checked_sub(1).map_or(0, |before| keys[before].0 + 1);
    let most = keys.get(index + 1).map_or(100, |after| after.0.saturating_sub(1));
    let to = (to.0.clamp(least.min(most), most), to.1);
    let mut keys = keys.to_vec();
    (std::mem::replace(&mut keys[index], to) != to).then_some(WeightCurveEvent::Keys(keys))
}

/// Returns the keys without one of them; `None` for the last one, which stays.
fn without(keys: &[CurveKey], index: usize) -> Option<Vec<CurveKey>> {
    let mut keys = keys.to_vec();
    (keys.len() > 1).then(|| {
        keys.remove(index);
        keys
    })
}

/// Returns the keys with one more, which replaces one at the same time.
fn with(keys: &[CurveKey], key: CurveKey) -> Vec<CurveKey> {
    let mut keys: Vec<CurveKey> = keys.iter().copied().filter(|other| other.0 != key.0).collect();
    keys.push(key);
    keys.sort_unstable();
    keys
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn key_moves_between_its_neighbours() {
        let keys = [(0, 0), (50, 100), (100, 0)];
        let to = |index, key| match moved(&keys, index, key) {
            Some(WeightCurveEvent::Keys(keys)) => keys[index],
            _ => keys[index],
        };
        assert_eq!(to(1, (20, 80)), (20, 80));
        assert_eq!(to(1, (0, 80)), (1, 80));
        assert_eq!(to(2, (30, 10)), (51, 10));
        assert_eq!(moved(&keys, 0, (0, 0)), None);
        assert_eq!(without(&keys[..1], 0), None);
        assert_eq!(with(&keys, (50, 7)), [(0, 0), (50, 7), (100, 0)]);
    }
}
