//! Panes one at a time, where there is room for one: the finger's swipe from one to the next, and
//! the row with a dot for each.

use crate::ui::kit::{self, Icon};
use crate::ui::language::{Text, say};
use crate::ui::state::{Swipe, UiState};
use crate::ui::text;
use crate::ui::theme::{palette_of, space, theme_of};
use eframe::egui::{
    InputState, Rect, Response, Role, Sense, Ui, UiBuilder, WidgetInfo, pos2, vec2,
};
use segue_session::Session;

/// The way of a swipe, points.
const WAY: f32 = 36.0;
/// The time within which a finger goes that far, seconds. A slower one turns the camera.
const SECS: f64 = 0.15;
/// The frames that it may take where they are longer.
const FRAMES: f64 = 3.5;

/// Shows another pane when a finger swipes over the stage. Returns whether the drag is not the
/// camera's.
pub(super) fn takes_drag(count: usize, response: &Response, state: &mut UiState, ui: &Ui) -> bool {
    if count < 2 || ui.input(InputState::multi_touch).is_some() {
        state.swipe = None;
        return false;
    }
    let now = ui.input(|input| input.time);
    if response.drag_started() {
        let origin = ui.input(|input| input.pointer.press_origin());
        let began = ui.input(|input| input.pointer.press_start_time()).unwrap_or(now);
        state.swipe = origin.map(|from| Swipe { from, began, turns_page: None });
    }
    let Some(mut swipe) = state.swipe else {
        return false;
    };
    if !response.dragged() && !response.drag_stopped() {
        state.swipe = None;
        return false;
    }
    let moved = response.interact_pointer_pos().map_or(vec2(0.0, 0.0), |at| at - swipe.from);
    if swipe.turns_page.is_none() {
        let frame_secs = f64::from(ui.input(|input| input.stable_dt));
        if now - swipe.began > SECS.max(FRAMES * frame_secs) || moved.y.abs() > WAY {
            swipe.turns_page = Some(false);
        } else if moved.x.abs() >= WAY && moved.x.abs() > 1.5 * moved.y.abs() {
            swipe.turns_page = Some(true);
            go(moved.x < 0.0, count, state);
        }
    }
    state.swipe = (!response.drag_stopped()).then_some(swipe);
    swipe.turns_page != Some(false)
}

/// Shows the next pane, or the previous one, as far as there are any.
fn go(forward: bool, count: usize, state: &mut UiState) {
    let pane = state.shown_pane;
    state.shown_pane =
        if forward { (pane + 1).min(count.saturating_sub(1)) } else { pane.saturating_sub(1) };
}

/// Returns the height of the row with the names of the panes.
pub(super) fn switch_height(ui: &Ui) -> f32 {
    44.0 * theme_of(ui).scale()
}

/// Draws the row that tells which of several panes is shown, at the bottom of `place`, below the
/// figure: a dot for each, and a button to either side.
pub(super) fn pane_switch_ui(session: &Session, place: Rect, state: &mut UiState, ui: &mut Ui) {
    let (theme, palette) = (theme_of(ui), palette_of(ui));
    let panes = session.panes();
    let count = panes.len();
    let row = place.with_min_y(place.bottom() - switch_height(ui));
    let side = theme.row_height().max(theme.hit());
    let ways = [
        (false, Icon::ChevronLeft, text::PREVIOUS_PANE, row.left() + space::XS),
        (true, Icon::ChevronRight, text::NEXT_PANE, row.right() - space::XS - side),
    ];
    for (forward, icon, name, left) in ways {
        let at = pos2(left, row.center().y - 0.5 * side);
        let builder = UiBuilder::new().max_rect(Rect::from_min_size(at, vec2(side, side)));
        let ends = if forward { count.saturating_sub(1) } else { 0 };
        let pressed = ui.scope_builder(builder.id_salt(("pane", forward)), |ui| {
            ui.add_enabled_ui(state.shown_pane != ends, |ui| {
                kit::icon_button_ui(icon, name, ui).clicked()
            })
        });
        if pressed.inner.inner {
            go(forward, count, state);
        }
    }
    let (gap, radius) = (14.0 * theme.scale(), 3.5 * theme.scale());
    let first = row.center().x - 0.5 * gap * count.saturating_sub(1) as f32;
    for index in 0..count {
        let at = pos2(first + gap * index as f32, row.center().y);
        let is_shown = index == state.shown_pane;
        let color = if is_shown { palette.accent } else { palette.line_strong };
        ui.painter().circle_filled(at, if is_shown { radius + 1.0 } else { radius }, color);
    }
    // The title of the pane shows the name.
    let name = panes.get(state.shown_pane).and_then(|pane| session.variant_name(pane));
    let words = text::pane_of(name.unwrap_or_default(), state.shown_pane + 1, count);
    let dots = vec2(gap * count as f32, 0.6 * row.height());
    let rect = Rect::from_center_size(row.center(), dots);
    let response = ui.interact(rect, ui.make_persistent_id("pane_name"), Sense::hover());
    let said = say(Text::Message(&words), ui);
    kit::describe(&response, &WidgetInfo::labeled(Role::Label, true, said));
}
