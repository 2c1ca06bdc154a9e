//! A line drawn by hand on the ground: a path for the Path lab, or for a walk of the Graph lab.

use crate::ui::state::UiState;
use eframe::egui::{CursorIcon, InputState, PointerButton, Pos2, Rect, Response, Ui, vec2};
use glam::DVec2;
use segue_scene::Camera;

/// The least distance between drawn points, metres.
const STEP_M: f64 = 0.02;
/// The greatest distance of drawn points from the target, in distances of the camera from it: near
/// the horizon, a pixel is very long.
const FARTHEST: f32 = 6.0;

/// A pane with its camera.
pub(crate) struct View<'a> {
    pub(crate) camera: &'a Camera,
    pub(crate) rect: Rect,
}

impl View<'_> {
    fn size(&self) -> glam::Vec2 {
        glam::Vec2::new(self.rect.width(), self.rect.height())
    }

    /// Returns the place of a point of the ground on the page.
    pub(crate) fn on_page(&self, point: DVec2) -> Option<Pos2> {
        let world = glam::Vec3::new(point.x as f32, 0.0, point.y as f32);
        let at = self.camera.project(world, self.size())?;
        Some(self.rect.min + vec2(at.x, at.y))
    }

    /// Returns the place on the ground under a point of the page.
    pub(crate) fn on_ground(&self, pos: Pos2) -> Option<DVec2> {
        let pixel = pos - self.rect.min;
        let hit = self.camera.ray(glam::Vec2::new(pixel.x, pixel.y), self.size()).ground_hit()?;
        let near = hit.distance(self.camera.target) < FARTHEST * self.camera.distance;
        near.then(|| DVec2::new(f64::from(hit.x), f64::from(hit.z)))
    }
}

/// The meaning of a drag over the stage.
pub(crate) enum GroundLine {
    /// It moves the camera.
    None,
    /// It draws a line, which may not have begun.
    Drawing,
    /// It has finished a line: (x, z) in metres.
    Done(Vec<DVec2>),
}

/// Continues the line that is being drawn, if there is one.
pub(crate) fn ground_line(
    shown: &[(usize, Rect)],
    response: &Response,
    state: &mut UiState,
    ui: &Ui,
) -> GroundLine {
    let Some(drawn) = &mut state.drawing else {
        return GroundLine::None;
    };
    if response.hovered() {
        ui.ctx().set_cursor_icon(CursorIcon::Crosshair);
    }
    if ui.input(InputState::multi_touch).is_some() {
        // Two fingers move the camera.
        drawn.clear();
        return GroundLine::None;
    }
    let started = ui.input(|input| input.pointer.press_origin());
    let pos =
        response.interact_pointer_pos().filter(|_| response.dragged_by(PointerButton::Primary));
    if let (Some(origin), Some(pos)) = (started, pos) {
        let pane = shown.iter().find(|(_, rect)| rect.contains(origin));
        let view = pane.and_then(|&(index, rect)| {
            let camera = state.cameras.get(index)?.as_ref()?;
            Some(View { camera, rect })
        });
        // A drag is recognised only after some points: its origin is part of the line.
        let from = Some(origin).filter(|_| drawn.is_empty());
        let places = from.into_iter().chain([pos]).filter_map(|pos| view.as_ref()?.on_ground(pos));
        for place in places {
            if drawn.last().is_none_or(|last| last.distance(place) > STEP_M) {
                drawn.push(place);
            }
        }
    }
    if response.drag_stopped() {
        return GroundLine::Done(state.drawing.take().unwrap_or_default());
    }
    GroundLine::Drawing
}
