//! The picture of the stage: the connection of the panels' layout and the renderer.

use crate::platform::now_ms;
use crate::render::{self, Refinement};
use crate::ui::theme::Palette;
use eframe::egui::layers::ShapeIdx;
use eframe::egui::{Color32, Painter, Rect, Shape, Ui};
use glam::Vec3;
use segue_scene::{Camera, Color, Colors, Director, Highlights, Look, StageOptions, Viewport};
use segue_session::Session;

/// The id of the page's only stage.
const STAGE: u64 = 0;
/// The longest step of a camera, seconds, so that it does not jump after a pause. Slow machines
/// need a second for a frame of many bodies.
const MAX_STEP_SECS: f64 = 1.0;

/// The state of the picture between frames.
#[derive(Debug, Default)]
pub(crate) struct Picture {
    director: Director,
    drawn_at_ms: f64,
    /// The stage's rectangle on the page, points.
    stage: Option<Rect>,
}

/// A slot in the shapes of a frame that receives the picture after the panels are drawn.
#[derive(Default)]
pub(crate) struct StageSlot(Option<Reservation>);

struct Reservation {
    stage: Rect,
    /// The panes that are shown: index in the session, and rectangle on the page.
    panes: Vec<(usize, Rect)>,
    painter: Painter,
    index: ShapeIdx,
}

impl StageSlot {
    /// Reserves the slot behind everything that the panels draw from here on.
    pub(crate) fn reserve(&mut self, stage: Rect, panes: &[(usize, Rect)], ui: &Ui) {
        let painter = ui.painter().clone();
        let index = painter.add(Shape::Noop);
        self.0 = Some(Reservation { stage, panes: panes.to_vec(), painter, index });
    }
}

impl Picture {
    /// Returns the cameras of the first `panes` panes, as last drawn.
    pub(crate) fn cameras(&self, panes: usize) -> Vec<Option<Camera>> {
        (0..panes).map(|pane| self.director.camera(pane).copied()).collect()
    }

    /// Returns the joints of the figures in the first `panes` panes, as last drawn.
    pub(crate) fn figures(&self, panes: usize) -> Vec<Vec<Vec3>> {
        (0..panes).map(|pane| self.director.figure(pane).to_vec()).collect()
    }

    /// Draws the session's present state into the reserved slot. `fine`: finely, also where it
    /// changes and is drawn in software.
    pub(crate) fn finish(
        &mut self,
        slot: StageSlot,
        session: &Session,
        (palette, look): (&Palette, Look),
        highlights: Highlights,
        is_taken: bool,
        ui: &Ui,
    ) {
        let now_ms = now_ms();
        let dt_secs = ((now_ms - self.drawn_at_ms) / 1e3).clamp(0.0, MAX_STEP_SECS) as f32;
        self.drawn_at_ms = now_ms;
        self.stage = slot.0.as_ref().map(|reserved| reserved.stage);
        let Some(Reservation { stage: rect, panes, painter, index }) = slot.0 else {
            return;
        };
        let scale = ui.ctx().pixels_per_point();
        let size = render::stage_pixels(ui.ctx(), rect);
        let panes: Vec<(usize, Viewport)> =
            panes.into_iter().map(|(pane, part)| (pane, within(rect, part, size, scale))).collect();
        let colors = colors_of(palette);
        let options =
            StageOptions { panes: &panes, pixels_per_point: scale, look, colors, highlights };
        let stage = self.director.stage(session, &options, dt_secs);
        let refinement = match (is_taken, self.director.is_at_work()) {
            (true, _) => Refinement::Now,
            (false, true) => Refinement::Later,
            (false, false) => Refinement::AtRest,
        };
        painter.set(index, render::paint_callback(STAGE, rect, stage, refinement, ui.ctx()));
    }

    /// Prepares what will be drawn, for a millisecond or two. Returns whether there is more to do.
    pub(crate) fn work(&mut self) -> bool {
        self.director.work()
    }

    /// Returns whether something that will be drawn is being prepared.
    pub(crate) fn is_at_work(&self) -> bool {
        self.director.is_at_work()
    }

    /// Returns whether a camera is moving.
    pub(crate) fn is_moving(&self) -> bool {
        self.director.is_moving()
    }

    /// Returns the stage's rectangle on the page, points; `None` before it was drawn.
    pub(crate) fn stage_rect(&self) -> Option<Rect> {
        self.stage
    }
}

/// Returns a part of a stage in the pixels of its target.
fn within(stage: Rect, part: Rect, size: [u32; 2], scale: f32) -> Viewport {
    let pixel = |points: f32, max: u32| (points * scale).round().clamp(0.0, max as f32) as u32;
    let (left, right) =
        (pixel(part.left() - stage.left(), size[0]), pixel(part.right() - stage.left(), size[0]));
    let (top, bottom) =
        (pixel(part.top() - stage.top(), size[1]), pixel(part.bottom() - stage.top(), size[1]));
    Viewport {
        x: left,
        y: top,
        width: right.saturating_sub(left),
        height: bottom.saturating_sub(top),
    }
}

fn colors_of(palette: &Palette) -> Colors {
    let color = |color: Color32| -> Color {
        color.to_srgba_unmultiplied().map(|part| f32::from(part) / 255.0)
    };
    Colors {
        a: color(palette.a),
        b: color(palette.b),
        result: color(palette.accent),
        bad: color(palette.bad),
        warning: color(palette.warning),
        others: palette.others.map(color),
        ghost_alpha: palette.ghost_alpha,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use eframe::egui::{pos2, vec2};

    #[test]
    fn panes_fill_the_target_without_gaps() {
        let stage = Rect::from_min_size(pos2(10.0, 48.0), vec2(1001.0, 400.0));
        let middle = pos2(343.0, 48.0);
        let (left, right) = (
            Rect::from_min_max(stage.min, pos2(middle.x, 448.0)),
            Rect::from_min_max(middle, stage.max),
        );
        for scale in [1.0, 1.25, 1.5, 2.0] {
            let size = [(1001.0 * scale) as u32, (400.0 * scale) as u32];
            let (a, b) = (within(stage, left, size, scale), within(stage, right, size, scale));
            assert_eq!((a.x, a.x + a.width), (0, b.x));
            assert_eq!((b.x + b.width, b.height), (size[0], size[1]));
        }
    }
}
