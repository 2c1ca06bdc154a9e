//! The camera under pointer, fingers and keys.

use crate::ui::out::Out;
use eframe::egui::{self, Rect, Response, Ui, Vec2, vec2};
use segue_scene::camera_of;
use segue_session::choices;
use segue_session::{Key, Session, Value};

/// Degrees that the camera turns when the pointer moves by a point.
const TURN_PER_POINT: f64 = 0.35;

/// Turns, moves and zooms the camera: drag; Shift or another button, or two fingers; wheel or
/// pinch.
pub(super) fn camera_input(
    session: &Session,
    response: &Response,
    draws: bool,
    out: &mut Out,
    ui: &Ui,
) {
    let params = session.params();
    let mut values = Vec::new();
    let (mut drag, mut panning) = if draws { (Vec2::ZERO, false) } else { drag_of(response, ui) };
    let mut nearer = 1.0;
    if !session.is_driven() {
        let keys = camera_keys(ui);
        (drag, panning) =
            if keys.drag == Vec2::ZERO { (drag, panning) } else { (keys.drag, keys.panning) };
        nearer = keys.nearer;
    }
    let from_above = params.choice::<choices::Camera>() == choices::Camera::Top;
    if drag != Vec2::ZERO && (panning || from_above) {
        values.extend(pan(session, drag, response.rect));
    } else if drag != Vec2::ZERO {
        let yaw = params.number(Key::CameraYaw) - f64::from(drag.x) * TURN_PER_POINT;
        let pitch = params.number(Key::CameraPitch) + f64::from(drag.y) * TURN_PER_POINT;
        values.push((Key::CameraYaw, Value::Number((yaw + 180.0).rem_euclid(360.0) - 180.0)));
        values.push((Key::CameraPitch, Value::Number(pitch.clamp(-10.0, 89.0))));
    }
    if response.contains_pointer() {
        let (scroll, pinch) = ui.input(|input| (input.smooth_scroll_delta().y, input.zoom_delta()));
        nearer *= f64::from(pinch) * f64::from(scroll * 0.002).exp();
    }
    if (nearer - 1.0).abs() > 1e-4 {
        let distance = (params.number(Key::CameraDistance) / nearer).clamp(0.5, 60.0);
        values.push((Key::CameraDistance, Value::Number(distance)));
    }
    if !values.is_empty() {
        out.commands.push(segue_session::Command::Set(values));
    }
}

/// The keys' input to the camera: a drag in points, whether it moves the camera, and the factor of
/// the zoom.
struct CameraKeys {
    drag: Vec2,
    panning: bool,
    nearer: f64,
}

/// Points of a drag for each press of a key, or its repetition.
const POINTS_PER_KEY: f32 = 16.0;

/// Reads the keys of the camera: W, A, S, D turn it (with Shift they move it), the page keys zoom.
/// A widget with the focus keeps its keys.
fn camera_keys(ui: &Ui) -> CameraKeys {
    let mut keys = CameraKeys { drag: Vec2::ZERO, panning: false, nearer: 1.0 };
    if ui.ctx().memory(|memory| memory.focused().is_some()) {
        return keys;
    }
    let ways = [
        (egui::Key::A, vec2(1.0, 0.0)),
        (egui::Key::D, vec2(-1.0, 0.0)),
        (egui::Key::W, vec2(0.0, 1.0)),
        (egui::Key::S, vec2(0.0, -1.0)),
    ];
    ui.input_mut(|input| {
        for (modifiers, panning) in [(egui::Modifiers::SHIFT, true), (egui::Modifiers::NONE, false)]
        {
            for (key, way) in ways {
                let times = input.count_and_consume_key(modifiers, key) as f32;
                keys.drag += way * times * POINTS_PER_KEY;
                keys.panning |= panning && times > 0.0;
            }
        }
        let [nearer, farther] = [egui::Key::PageUp, egui::Key::PageDown]
            .map(|key| input.count_and_consume_key(egui::Modifiers::NONE, key) as i32);
        keys.nearer = 1.1_f64.powi(nearer - farther);
    });
    keys
}

/// Returns how far the pointer, or two fingers, moved, and whether that moves the camera instead of
/// turning it.
fn drag_of(response: &Response, ui: &Ui) -> (Vec2, bool) {
    if let Some(touch) = ui.input(egui::InputState::multi_touch)
        && response.rect.contains(touch.center_pos)
    {
        return (touch.translation_delta, true);
    }
    let other_button = response.dragged_by(egui::PointerButton::Secondary)
        || response.dragged_by(egui::PointerButton::Middle);
    if response.dragged() {
        (response.drag_delta(), other_button || ui.input(|input| input.modifiers.shift))
    } else {
        (Vec2::ZERO, false)
    }
}

/// Returns the values that move the camera by a drag.
fn pan(session: &Session, drag: Vec2, stage: Rect) -> Vec<(Key, Value)> {
    let params = session.params();
    // The pan follows the pointer, whatever the shown size of the character.
    let mut camera = camera_of(session.params(), 1.0);
    let before = camera.target;
    camera.pan(glam_vec2(drag), stage.height());
    let moved = camera.target - before;
    [(Key::PanX, moved.x), (Key::PanY, moved.y), (Key::PanZ, moved.z)]
        .map(|(key, by)| {
            (key, Value::Number((params.number(key) + f64::from(by)).clamp(-100.0, 100.0)))
        })
        .to_vec()
}

fn glam_vec2(v: Vec2) -> glam::Vec2 {
    glam::Vec2::new(v.x, v.y)
}
