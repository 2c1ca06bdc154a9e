//! The 3D picture between the panels that leave room for it and the renderer that draws it.

use crate::platform::now_ms;
use crate::render;
use crate::ui::theme::Palette;
use eframe::egui::layers::ShapeIdx;
use eframe::egui::{Color32, Painter, Rect, Shape, Ui};
use segue_scene::{Camera, Color, Colors, Director, Highlights, Look, StageOptions, Viewport};
use segue_session::Session;

/// The one stage of the page.
const STAGE: u64 = 0;
/// A camera does not leap over the time that nothing was drawn in, seconds. Slow machines need a
/// second for a frame of many bodies.
const LONGEST_STEP_SECS: f64 = 1.0;

/// What goes on from frame to frame.
#[derive(Debug, Default)]
pub(crate) struct Picture {
    director: Director,
    drawn_at_ms: f64,
    /// Where the stage is on the page, points.
    place: Option<Rect>,
}

/// The place in a frame that the picture is put into once the panels are through.
#[derive(Default)]
pub(crate) struct Place(Option<Reserved>);

struct Reserved {
    stage: Rect,
    /// The panes that are shown: index in the session, and place.
    panes: Vec<(usize, Rect)>,
    painter: Painter,
    index: ShapeIdx,
}

impl Place {
    /// Keeps a place behind everything that the panels draw from here on.
    pub(crate) fn reserve(&mut self, stage: Rect, panes: &[(usize, Rect)], ui: &Ui) {
        let painter = ui.painter().clone();
        let index = painter.add(Shape::Noop);
        self.0 = Some(Reserved { stage, panes: panes.to_vec(), painter, index });
    }
}

impl Picture {
    /// The cameras of so many panes, as they were drawn last.
    pub(crate) fn cameras(&self, panes: usize) -> Vec<Option<Camera>> {
        (0..panes).map(|pane| self.director.camera(pane).copied()).collect()
    }

    /// Draws the session's present state into the place that was kept.
    pub(crate) fn finish(
        &mut self,
        place: Place,
        session: &Session,
        (palette, look): (&Palette, Look),
        highlights: Highlights,
        ui: &Ui,
    ) {
        let now_ms = now_ms();
        let dt_secs = ((now_ms - self.drawn_at_ms) / 1e3).clamp(0.0, LONGEST_STEP_SECS) as f32;
        self.drawn_at_ms = now_ms;
        self.place = place.0.as_ref().map(|reserved| reserved.stage);
        let Some(Reserved { stage: rect, panes, painter, index }) = place.0 else {
            return;
        };
        let scale = ui.ctx().pixels_per_point();
        let size = render::stage_pixels(ui.ctx(), rect);
        let panes: Vec<(usize, Viewport)> = panes
            .into_iter()
            .map(|(pane, place)| (pane, within(rect, place, size, scale)))
            .collect();
        let colors = colors_of(palette);
        let options =
            StageOptions { panes: &panes, pixels_per_point: scale, look, colors, highlights };
        let stage = self.director.stage(session, &options, dt_secs);
        painter.set(index, render::paint_callback(STAGE, rect, stage, ui.ctx()));
    }

    /// Works on what will be seen, a millisecond or two; `true` while there is more to do.
    pub(crate) fn work(&mut self) -> bool {
        self.director.work()
    }

    /// Whether something is in the making that will be seen.
    pub(crate) fn is_at_work(&self) -> bool {
        self.director.is_at_work()
    }

    /// Whether a camera is still on its way.
    pub(crate) fn is_moving(&self) -> bool {
        self.director.is_moving()
    }

    /// Where the stage is on the page, points; none before it was drawn.
    pub(crate) fn place(&self) -> Option<Rect> {
        self.place
    }
}

/// A part of a stage in the pixels of its target.
fn within(stage: Rect, part: Rect, size: [u32; 2], scale: f32) -> Viewport {
    let pixel = |points: f32, most: u32| (points * scale).round().clamp(0.0, most as f32) as u32;
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
