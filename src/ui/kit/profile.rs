//! A small curve of one value along a path, filled down to zero.

use super::assistive::describe;
use super::paint::full_width;
use crate::ui::language::say;
use crate::ui::theme::{palette_of, radius, theme_of};
use eframe::egui::{Color32, Pos2, Role, Sense, Shape, Stroke, Ui, WidgetInfo, pos2};
use segue_text::Message;

/// The greatest number of points: a panel is not wider.
const COLUMNS: usize = 240;

/// Draws values (distance along the path, value) from 0 to `most`. `label` is the accessible name.
pub(crate) fn profile_ui(
    label: &Message,
    points: &[[f64; 2]],
    most: f64,
    color: Color32,
    ui: &mut Ui,
) {
    let (theme, palette) = (theme_of(ui), palette_of(ui));
    let rect = full_width((44.0 * theme.scale()).round(), ui);
    ui.painter().rect_filled(rect, radius::S, palette.panel_raised);
    let length = points.last().map_or(0.0, |point| point[0]).max(1e-9);
    let at = |point: [f64; 2]| -> Pos2 {
        let (x, y) = ((point[0] / length) as f32, (point[1] / most.max(1e-9)) as f32);
        pos2(
            rect.left() + x.clamp(0.0, 1.0) * rect.width(),
            rect.bottom() - 2.0 - y.clamp(0.0, 1.0) * (rect.height() - 6.0),
        )
    };
    // The largest value of each column: a peak must not be lost.
    let columns = points.chunks(points.len().div_ceil(COLUMNS).max(1));
    let largest =
        columns.filter_map(|column| column.iter().copied().max_by(|a, b| a[1].total_cmp(&b[1])));
    let line: Vec<Pos2> = largest.map(at).collect();
    let wash = color.gamma_multiply(0.18);
    for pair in line.windows(2) {
        let foot = |x: f32| pos2(x, rect.bottom() - 2.0);
        let corners = vec![pair[0], pair[1], foot(pair[1].x), foot(pair[0].x)];
        ui.painter().add(Shape::convex_polygon(corners, wash, Stroke::NONE));
    }
    ui.painter().add(Shape::line(line, Stroke::new(1.5 * theme.scale(), color)));
    let id = ui.make_persistent_id(label.to_string());
    let response = ui.interact(rect, id, Sense::hover());
    describe(&response, &WidgetInfo::labeled(Role::Image, true, say(label, ui)));
}
