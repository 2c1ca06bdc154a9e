//! Clips that a mouse drags out of the library, and the places that take them.

use super::kit;
use super::language::{Text, say};
use super::out::Out;
use super::text;
use super::theme::{Type, palette_of, radius, space, theme_of};
use eframe::egui::{
    self, Align2, DragAndDrop, Id, LayerId, Order, Rect, Stroke, StrokeKind, Ui, vec2,
};
use segue_session::{Command, Compare, Key, Kind, Session, Slot, Value};
use segue_text::Message;

/// A clip that is dragged, by its id.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct ClipDrag {
    /// The id.
    pub(crate) id: String,
}

/// Returns the values by which the clips in A and B change places.
pub(crate) fn swap_values(session: &Session) -> Vec<(Key, Value)> {
    let [a, b] = [Key::A, Key::B].map(|key| session.params().get(key).clone());
    vec![(Key::A, b), (Key::B, a)]
}

/// Returns the id of the clip that was dropped on a place. While one is held over it, the place has
/// an outline, and `what` of the clip's name says beside the pointer what the drop does.
pub(crate) fn clip_dropped_on(
    place: Rect,
    session: &Session,
    what: impl Fn(Message) -> Message,
    ui: &Ui,
) -> Option<String> {
    let drag = DragAndDrop::payload::<ClipDrag>(ui.ctx())?;
    let place = place.intersect(ui.clip_rect());
    let pointer = ui.input(|input| input.pointer.interact_pos())?;
    let palette = palette_of(ui);
    if !place.contains(pointer)
        || ui.ctx().layer_id_at(pointer).is_some_and(|layer| layer != ui.layer_id())
    {
        let quiet = Stroke::new(theme_of(ui).hairline(), palette.accent.gamma_multiply(0.6));
        ui.painter().rect_stroke(place, radius::M, quiet, StrokeKind::Inside);
        return None;
    }
    if ui.input(|input| input.pointer.any_released()) {
        DragAndDrop::clear_payload(ui.ctx());
        return Some(drag.id.clone());
    }
    ui.painter().rect_filled(place, radius::M, palette.accent_wash.gamma_multiply(0.6));
    let line = Stroke::new(2.0, palette.accent);
    ui.painter().rect_stroke(place, radius::M, line, StrokeKind::Inside);
    let title = session.library().get(&drag.id).map(|entry| entry.title()).unwrap_or_default();
    ui.data_mut(|data| data.insert_temp(label_id(), what(title)));
    None
}

fn label_id() -> Id {
    Id::unique("label of the dragged clip")
}

/// Draws the name of the dragged clip beside the pointer, or what a drop here does.
pub(crate) fn dragged_clip_ui(session: &Session, ui: &Ui) {
    let told: Option<Message> = ui.data_mut(|data| data.remove_temp(label_id()));
    let (Some(drag), Some(pointer)) = (
        DragAndDrop::payload::<ClipDrag>(ui.ctx()),
        ui.input(|input| input.pointer.interact_pos()),
    ) else {
        return;
    };
    let title = session.library().get(&drag.id).map(|entry| entry.title());
    let Some(words) = told.or(title) else {
        return;
    };
    ui.ctx().set_cursor_icon(egui::CursorIcon::Grabbing);
    let (theme, palette) = (theme_of(ui), palette_of(ui));
    let painter = ui.ctx().layer_painter(LayerId::new(Order::Tooltip, Id::unique("dragged clip")));
    let galley = kit::paint::line_of(
        &[kit::paint::Run::new(Text::Data(&say(&words, ui)), Type::Body, palette.text)],
        320.0 * theme.scale(),
        ui,
    );
    let size = galley.size() + vec2(2.0 * space::S, 2.0 * space::XS);
    let at = Align2::LEFT_TOP.anchor_size(pointer + vec2(14.0, 10.0), size);
    let stroke = Stroke::new(theme.hairline(), palette.line);
    painter.rect(at, radius::M, palette.panel_raised, stroke, StrokeKind::Inside);
    kit::paint::put(&painter, at.center(), Align2::CENTER_CENTER, galley);
}

/// Takes a clip that was dropped on the place of a slot.
pub(crate) fn take_drop_on_slot(
    slot: Slot,
    place: Rect,
    session: &Session,
    out: &mut Out,
    ui: &Ui,
) {
    if let Some(id) = clip_dropped_on(place, session, |clip| text::use_as(clip, slot), ui) {
        out.commands.push(Command::Assign(slot, id));
    }
}

/// Takes a clip that was dropped on a pane of the stage: among compared clips it takes the pane's
/// place, otherwise it becomes A.
pub(crate) fn take_drop_on_pane(
    pane: usize,
    place: Rect,
    session: &Session,
    out: &mut Out,
    ui: &Ui,
) {
    let compared = session
        .compare()
        .filter(|compare| matches!(compare.key.param().kind, Kind::Clip))
        .filter(|compare| pane < compare.values.len());
    if compared.is_none() && !session.uses(Slot::A) {
        return;
    }
    let what = |clip| match compared {
        Some(_) => text::compare_here(clip),
        None => text::use_as(clip, Slot::A),
    };
    let Some(id) = clip_dropped_on(place, session, what, ui) else {
        return;
    };
    match compared {
        Some(compare) => {
            let mut values = compare.values.clone();
            if let Some(value) = values.get_mut(pane) {
                *value = Value::Text(id);
            }
            out.compare(Some(Compare { values, ..compare.clone() }));
        }
        None => out.commands.push(Command::Assign(Slot::A, id)),
    }
}
