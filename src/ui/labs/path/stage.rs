//! The path on the stage: its control points under mouse, finger and keys.

use crate::ui::kit;
use crate::ui::labs::path::ground_line::View;
use crate::ui::labs::path::hand::{DraggedPoint, path_of, snapped};
use crate::ui::language::say;
use crate::ui::out::Out;
use crate::ui::stage::framing::framing;
use crate::ui::state::UiState;
use crate::ui::text;
use eframe::egui::{
    CursorIcon, EventFilter, Key as Keyboard, Modifiers, Rect, Response, Role, Sense, Ui, Vec2,
    WidgetInfo,
};
use glam::DVec2;
use segue_motion::path::{GroundSpline, PathEdit, SplineEnds};
use segue_session::LabId;
use segue_session::{Command, Group, Key, PathFacts, Session};
use segue_text::Message;

/// Side of the square in which a control point is taken hold of, points: fingers need more than the
/// standard's 24.
const GRIP: f32 = 30.0;
/// The distance within which the pointer is on the path, points.
const REACH: f32 = 12.0;
/// The step of an arrow key, metres; with Shift it is five times as far.
const KEY_STEP_M: f64 = 0.05;
/// The pitch of the camera when the lab opens, degrees.
const PITCH_DEG: f64 = 34.0;

/// Draws the control points of one pane, and handles the pointer on them and on the path.
pub(crate) fn handles_ui(
    session: &Session,
    pane: usize,
    rect: Rect,
    stage: &Response,
    state: &mut UiState,
    out: &mut Out,
    ui: &mut Ui,
) {
    let Some(path) = session.panes().get(pane).and_then(|pane| path_of(session, pane)) else {
        return;
    };
    let Some(camera) =
        state.cameras.get(pane).copied().flatten().filter(|_| state.drawing.is_none())
    else {
        return;
    };
    let view = View { camera: &camera, rect };
    let spline = path.curve.spline();
    let count = spline.points().len();
    state.labs.path.chosen = state.labs.path.chosen.filter(|&chosen| chosen < count);
    // Both ends of a loop are one point.
    let shown = if spline.is_closed() { count - 1 } else { count };
    for (index, &point) in spline.points().iter().enumerate().take(shown) {
        let Some(at) = view.on_page(point).filter(|at| rect.contains(*at)) else {
            continue;
        };
        let id = ui.make_persistent_id(("control point", pane, index));
        let hit = Rect::from_center_size(at, Vec2::splat(GRIP)).intersect(rect);
        let response = ui.interact(hit, id, Sense::click_and_drag());
        let chosen = state.labs.path.chosen == Some(index);
        let said = say(&text::control_point(index, shown, point), ui);
        kit::describe(&response, &WidgetInfo::selected(Role::Button, true, chosen, said));
        let handle = Handle { index, pane, point, view: &view, path, response: &response };
        handle.input(session, state, out, ui);
    }
    if state.labs.path.held.is_none() && state.labs.path.hovered.is_none() {
        place_input(spline, &view, stage, session, state, out, ui);
    }
}

/// A control point on the page.
struct Handle<'a> {
    index: usize,
    pane: usize,
    point: DVec2,
    view: &'a View<'a>,
    path: &'a PathFacts,
    response: &'a Response,
}

impl Handle<'_> {
    fn input(&self, session: &Session, state: &mut UiState, out: &mut Out, ui: &Ui) {
        let Self { index, pane, point, view, path, response } = *self;
        let hand = &mut state.labs.path;
        if response.hovered() || response.dragged() {
            hand.hovered = Some(index);
            let icon = if response.dragged() { CursorIcon::Grabbing } else { CursorIcon::Grab };
            ui.ctx().set_cursor_icon(icon);
        }
        if response.clicked() || response.drag_started() {
            hand.chosen = Some(index);
            response.request_focus();
        }
        if response.drag_started() {
            let pressed =
                ui.input(|input| input.pointer.press_origin()).and_then(|pos| view.on_ground(pos));
            hand.held = Some(DraggedPoint {
                index,
                pane,
                start: path.curve.spline().clone(),
                grip: pressed.map_or(DVec2::ZERO, |pressed| point - pressed),
            });
        }
        let held = hand.held.clone().filter(|held| held.index == index && held.pane == pane);
        if let Some(held) = held {
            let to = response.interact_pointer_pos().and_then(|pos| view.on_ground(pos));
            if let Some(to) =
                to.filter(|_| response.dragged() && response.drag_delta() != Vec2::ZERO)
            {
                let to = snapped(to + held.grip, session);
                hand.edit(&held.start, &PathEdit::Move { index, to }, session, out);
            }
            if response.drag_stopped() {
                hand.held = None;
                out.commands.push(Command::Settle);
            }
        }
        if response.has_focus() {
            hand.chosen = Some(index);
            self.keys(session, state, out, ui);
        }
    }

    /// Moves the point with arrows, as seen by the camera, and removes it with Delete.
    fn keys(&self, session: &Session, state: &mut UiState, out: &mut Out, ui: &Ui) {
        let Self { index, point, view, path, response, .. } = *self;
        let filter = EventFilter {
            horizontal_arrows: true,
            vertical_arrows: true,
            ..EventFilter::default()
        };
        ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, filter));
        let pressed = |modifiers: Modifiers, key: Keyboard| {
            ui.input_mut(|input| input.count_and_consume_key(modifiers, key)) as f64
        };
        let moved = |modifiers: Modifiers| {
            let across =
                pressed(modifiers, Keyboard::ArrowRight) - pressed(modifiers, Keyboard::ArrowLeft);
            let ahead =
                pressed(modifiers, Keyboard::ArrowUp) - pressed(modifiers, Keyboard::ArrowDown);
            DVec2::new(across, ahead)
        };
        let steps = moved(Modifiers::SHIFT) * 5.0 + moved(Modifiers::NONE);
        if steps != DVec2::ZERO {
            let grid = session.params().number(Key::PathGrid);
            let step = if grid > 0.0 { grid } else { KEY_STEP_M };
            // The point moves along the axis of the ground that is nearest to the key's direction
            // on the screen, so that a key and its opposite undo each other.
            let quarter = std::f64::consts::FRAC_PI_2;
            let yaw = (f64::from(view.camera.yaw) / quarter).round() * quarter;
            let (sin, cos) = yaw.sin_cos();
            let by = DVec2::new(cos, -sin) * steps.x - DVec2::new(sin, cos) * steps.y;
            let to = snapped(point + by * step, session);
            let spline = path.curve.spline();
            state.labs.path.edit_once(spline, &PathEdit::Move { index, to }, session, out);
        }
        if pressed(Modifiers::NONE, Keyboard::Delete)
            + pressed(Modifiers::NONE, Keyboard::Backspace)
            > 0.0
        {
            state.labs.path.chosen = Some(index);
            state.labs.path.remove_point(path, session, out);
        }
    }
}

/// Shows where a point would be added, and adds it at a double click.
fn place_input(
    spline: &GroundSpline,
    view: &View<'_>,
    stage: &Response,
    session: &Session,
    state: &mut UiState,
    out: &mut Out,
    ui: &Ui,
) {
    let pos = stage.interact_pointer_pos().or(stage.hover_pos());
    let Some(pos) = pos.filter(|pos| view.rect.contains(*pos) && !stage.dragged()) else {
        return;
    };
    let steps = 16 * spline.points().len();
    let places = (0..=steps).filter_map(|step| {
        let parameter = step as f64 / steps as f64;
        let place = spline.position(parameter);
        Some((view.on_page(place)?.distance(pos), place, parameter))
    });
    let nearest = places.min_by(|one, other| one.0.total_cmp(&other.0));
    let Some((_, place, parameter)) = nearest.filter(|nearest| nearest.0 < REACH) else {
        return;
    };
    state.labs.path.place = Some((place, parameter));
    ui.ctx().set_cursor_icon(CursorIcon::Copy);
    if stage.double_clicked()
        && state.labs.path.edit_once(spline, &PathEdit::Insert { at: parameter }, session, out)
    {
        let before = spline
            .with_ends(SplineEnds::Clamped)
            .greville()
            .iter()
            .filter(|&&at| at < parameter)
            .count();
        state.labs.path.chosen = Some(before);
    }
}

/// Returns why the last edit was not made, or how to draw.
pub(crate) fn note(state: &UiState) -> Option<Message> {
    let draws = || state.drawing.is_some().then(|| text::DRAW_HINT.into());
    state.labs.path.said.clone().or_else(draws)
}

/// Brings the whole path into sight when the lab opens, unless the camera was moved before, and
/// restores the camera when the lab is left.
pub(crate) fn frame_once(session: &Session, state: &mut UiState, out: &mut Out) {
    let params = session.params();
    // What the camera follows does not count: undo and redo restore it without the rest of the
    // camera, whoever moved that.
    let is_place = |key: Key| key.param().group == Group::Camera && key != Key::Follow;
    match (params.lab() == LabId::Path, &state.labs.path.framed) {
        (true, None) if params.changed().any(|(param, _)| is_place(param.key)) => {
            state.labs.path.framed = Some(Vec::new());
        }
        (true, None) => {
            if session.main_outcome().is_some_and(|outcome| outcome.path().is_some())
                && let Some(values) = framing(session, state, Some(PITCH_DEG))
            {
                state.labs.path.framed = Some(values.clone());
                out.commands.push(Command::Frame(values));
            }
        }
        (false, Some(values)) => {
            let is_as_framed = values.iter().all(|(key, value)| {
                let value = key.param().check(value.clone());
                !is_place(*key) || value.as_ref() == Ok(params.get(*key))
            });
            if is_as_framed && !values.is_empty() {
                let defaults = values.iter().map(|(key, _)| (*key, key.param().default_value()));
                out.commands.push(Command::Frame(defaults.collect()));
            }
            state.labs.path.framed = None;
            state.labs.path.said = None;
        }
        _ => {}
    }
}
