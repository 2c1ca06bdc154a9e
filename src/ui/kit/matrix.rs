//! A large square matrix as a picture that can be zoomed: tiles that are made when they are in
//! sight, marks on them, and the names of its parts along both sides.
//!
//! As on a heat map of two clips, what is left runs to the right and what is entered upwards: the
//! rows of the matrix lie from left to right, its columns from the bottom to the top.

use super::assistive::describe;
use super::paint::{Run, focus_ring, line_of, put};
use crate::ui::language::{Word, say};
use crate::ui::theme::{Type, palette_of, radius, theme_of};
use eframe::egui::{
    Align2, Color32, CursorIcon, EventFilter, Id, Key, Mesh, Pos2, Rect, Role, Sense, Shape,
    Stroke, StrokeKind, TextureId, Ui, Vec2, WidgetInfo, pos2, vec2,
};
use eframe::epaint::Vertex;
use segue_text::Message;

/// Texels along a side of a tile.
pub(crate) const TILE: usize = 256;
/// The distance within which the pointer reaches a mark, points.
const REACH: f32 = 9.0;
/// The greatest number of marks in view: more could not be told apart.
const MAX_MARKS: usize = 2_500;

/// A tile of the picture. A texel is a square of cells, `factor` to a side.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Tile {
    /// Cells along a side of a texel.
    pub(crate) factor: usize,
    /// The tile of rows, from the left of the picture.
    pub(crate) row: usize,
    /// The tile of columns, from the bottom of the picture.
    pub(crate) column: usize,
}

/// A marked cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct MatrixMark {
    /// Row and column.
    pub(crate) at: [f32; 2],
    /// Whether it is out of use.
    pub(crate) faint: bool,
}

/// The content of the matrix.
pub(crate) struct Matrix<'a> {
    /// The accessible name.
    pub(crate) label: Word,
    /// The number of rows, and of columns.
    pub(crate) size: usize,
    /// The least `factor`, a power of two, for which tiles are made quickly; finer ones take long.
    pub(crate) known: usize,
    /// The names of the parts, each with the row at which it begins.
    pub(crate) parts: &'a [(usize, Message)],
    /// The marks, the most important one first.
    pub(crate) marks: &'a [MatrixMark],
    /// The highlighted mark.
    pub(crate) lit: Option<usize>,
    /// The row and column of the playhead.
    pub(crate) now: Option<f32>,
}

/// The user's input to the matrix.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct MatrixResponse {
    /// The mark under the pointer.
    pub(crate) hovered: Option<usize>,
    /// The row and column under the pointer.
    pub(crate) at: Option<[f32; 2]>,
    /// The mark that was clicked.
    pub(crate) clicked: Option<usize>,
}

/// The visible part: its upper left corner in cells from that of the picture, and cells per point.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Window {
    corner: Vec2,
    cells: f32,
}

impl Window {
    fn whole(size: f32, side: f32) -> Self {
        Self { corner: Vec2::ZERO, cells: size / side.max(1.0) }
    }

    /// Returns the same part on a field of another size.
    fn on(self, before: f32, side: f32) -> Self {
        Self { cells: self.cells * before / side, ..self }
    }

    /// Returns the window moved into the picture, and zoomed out until a cell is no larger than a
    /// fingertip.
    fn bounded(self, size: f32, side: f32) -> Self {
        let cells = self.cells.clamp((1.0_f32 / 24.0).min(size / side), size / side);
        let last = (size - cells * side).max(0.0);
        Self { corner: self.corner.clamp(Vec2::ZERO, Vec2::splat(last)), cells }
    }

    /// Returns the window zoomed in by a factor about a point of the field.
    fn zoomed(self, factor: f32, at: Vec2) -> Self {
        let cells = self.cells / factor;
        Self { corner: self.corner + at * (self.cells - cells), cells }
    }
}

/// Draws the matrix as a square of at most `side` points. Wheel or pinch zooms, dragging moves, a
/// double click shows all of it; the keys +, − and 0 do the same. `tile` returns the texture of a
/// tile, or `None` while it is not made yet.
pub(crate) fn matrix_ui(
    matrix: &Matrix<'_>,
    side: f32,
    tile: &mut dyn FnMut(Tile) -> Option<TextureId>,
    ui: &mut Ui,
) -> MatrixResponse {
    let (theme, palette) = (theme_of(ui), palette_of(ui));
    let margin = (16.0 * theme.scale()).round();
    let side = (side.min(ui.available_width()) - margin).max(60.0).floor();
    let (_, whole) = ui.allocate_space(Vec2::splat(side + margin));
    let field = Rect::from_min_size(whole.min + vec2(margin, 0.0), Vec2::splat(side));
    let id = ui.make_persistent_id(matrix.label.english());
    let size = matrix.size.max(1) as f32;
    let kept: Option<(usize, f32, Window)> = ui.data(|data| data.get_temp(id));
    let mut window = kept
        .filter(|(of, ..)| *of == matrix.size)
        .map_or(Window::whole(size, side), |(_, before, window)| window.on(before, side))
        .bounded(size, side);
    // The whole picture cannot be dragged: a finger on it moves the panel.
    let is_whole = window.cells >= 0.999 * size / side;
    let sense = if is_whole { Sense::click() } else { Sense::click_and_drag() };
    let response = ui.interact(field, id, sense);
    describe(&response, &WidgetInfo::labeled(Role::Image, true, say(matrix.label, ui)));
    window = moved(window, (size, side), field, &response, ui);
    ui.data_mut(|data| data.insert_temp::<(usize, f32, Window)>(id, (matrix.size, side, window)));
    let place = |row: f32, column: f32| {
        field.min + (vec2(row, size - column) - window.corner) / window.cells
    };

    let painter = ui.painter_at(field.expand(1.0));
    painter.rect_filled(field, 0.0, palette.ground);
    let pixels = ui.ctx().pixels_per_point();
    let coarse = factor_for(size / side / pixels);
    let fine = factor_for(window.cells / pixels).min(coarse);
    // Tiles that are made quickly lie below finer ones that may not be made yet.
    let mut factors = vec![coarse, matrix.known.clamp(fine, coarse), fine];
    factors.dedup();
    for factor in factors {
        let cells = (TILE * factor) as f32;
        let range = |corner: f32| {
            let corner = corner.max(0.0);
            let first = (corner / cells).floor() as usize;
            let last = ((corner + window.cells * side).min(size) / cells).ceil() as usize;
            first..last.max(first + 1)
        };
        for row in range(window.corner.x) {
            for column in range(size - window.corner.y - window.cells * side) {
                let Some(texture) = tile(Tile { factor, row, column }) else {
                    continue;
                };
                let from = [row as f32 * cells, column as f32 * cells];
                let to = [(from[0] + cells).min(size), (from[1] + cells).min(size)];
                let texels = |from: f32, to: f32| {
                    ((to - from) / factor as f32).ceil().max(1.0) * factor as f32
                };
                // A texel at the edge may stand for less than its cells.
                let to = [0, 1].map(|axis: usize| from[axis] + texels(from[axis], to[axis]));
                // A texture has its rows from top to bottom.
                let mut mesh = Mesh::with_texture(texture);
                for [row, column] in [[0, 0], [1, 0], [0, 1], [1, 1]] {
                    mesh.vertices.push(Vertex {
                        pos: place([from[0], to[0]][row], [from[1], to[1]][column]),
                        uv: pos2(column as f32, row as f32),
                        color: Color32::WHITE,
                    });
                }
                mesh.add_triangle(0, 1, 2);
                mesh.add_triangle(2, 1, 3);
                painter.add(Shape::mesh(mesh));
            }
        }
    }
    let line = Stroke::new(theme.hairline(), palette.line_strong);
    for (start, _) in matrix.parts.iter().skip(1) {
        let at = place(*start as f32, *start as f32);
        painter.vline(at.x, field.y_range(), line);
        painter.hline(field.x_range(), at.y, line);
    }
    let seen = seen_marks(matrix, &window, side);
    let hovered = response.hover_pos().and_then(|pos| {
        let off = |mark: &MatrixMark| place(mark.at[0] + 0.5, mark.at[1] + 0.5).distance(pos);
        let marks = seen.iter().map(|&(index, mark)| (index, off(mark)));
        let nearest = marks.min_by(|a, b| a.1.total_cmp(&b.1));
        nearest.filter(|(_, off)| *off <= REACH).map(|(index, _)| index)
    });
    // Marks are small where there are many, and grow with the zoom.
    let radius_of_mark =
        ((side / 190.0).clamp(1.4, 2.6) * theme.scale() * (size / side / window.cells).powf(0.4))
            .min(6.5);
    for &(index, mark) in seen.iter().rev() {
        let at = place(mark.at[0] + 0.5, mark.at[1] + 0.5);
        let color = if mark.faint { palette.muted.gamma_multiply(0.6) } else { palette.text };
        let (radius, stroke) = if Some(index) == matrix.lit {
            (radius_of_mark + 3.0, Stroke::new(2.5, palette.accent))
        } else if Some(index) == hovered {
            (radius_of_mark + 2.0, Stroke::new(2.0, palette.text))
        } else {
            (radius_of_mark, Stroke::new(1.0, color))
        };
        painter.circle_stroke(at, radius, stroke);
    }
    if let Some(now) = matrix.now {
        let at = place(now + 0.5, now + 0.5);
        let hair = Stroke::new(theme.hairline(), palette.accent.gamma_multiply(0.8));
        painter.vline(at.x, field.y_range(), hair);
        painter.hline(field.x_range(), at.y, hair);
    }
    ui.painter().rect_stroke(field, 0.0, line, StrokeKind::Outside);
    names_ui(matrix, (field, margin), &place, ui);
    focus_ring(field, radius::S, &response, ui);
    if response.hovered() {
        let icon = if hovered.is_some() { CursorIcon::PointingHand } else { CursorIcon::Crosshair };
        ui.ctx().set_cursor_icon(icon);
    }
    let at = response.hover_pos().map(|pos| {
        let cell = (pos - field.min) * window.cells + window.corner;
        [cell.x, size - cell.y]
    });
    MatrixResponse { hovered, at, clicked: hovered.filter(|_| response.clicked()) }
}

/// Returns the marks in view with their indices: the highlighted one first, then the most important
/// ones. With the zoom, more of the others are among them.
fn seen_marks<'a>(matrix: &Matrix<'a>, window: &Window, side: f32) -> Vec<(usize, &'a MatrixMark)> {
    // A ring at the edge is partly in view.
    let (margin, cells) = (4.0 * window.cells, window.cells * side);
    let within =
        |at: f32, corner: f32| (corner - margin..=corner + cells + margin).contains(&(at + 0.5));
    let last = matrix.size.max(1) as f32 - 1.0;
    let is_seen = |mark: &MatrixMark| {
        within(mark.at[0], window.corner.x) && within(last - mark.at[1], window.corner.y)
    };
    let mut seen: Vec<_> =
        matrix.marks.iter().enumerate().filter(|(_, mark)| is_seen(mark)).take(MAX_MARKS).collect();
    let lit = matrix.lit.filter(|lit| seen.binary_search_by_key(lit, |(index, _)| *index).is_err());
    let lit = lit.and_then(|lit| Some((lit, matrix.marks.get(lit)?)));
    // The first one is drawn last, above all others.
    seen.splice(0..0, lit.filter(|(_, mark)| is_seen(mark)));
    seen
}

/// Returns the cells along a side of a texel, a power of two, for which a texel is about as large
/// as a pixel.
fn factor_for(cells_per_pixel: f32) -> usize {
    let power = cells_per_pixel.max(1.0).log2().floor() as u32;
    1 << power.min(16)
}

fn moved(
    window: Window,
    (size, side): (f32, f32),
    field: Rect,
    response: &eframe::egui::Response,
    ui: &Ui,
) -> Window {
    let mut window = window;
    if response.dragged() {
        window.corner -= response.drag_delta() * window.cells;
    }
    if let Some(pos) = response.hover_pos() {
        let (scroll, pinch) = ui.input(|input| (input.smooth_scroll_delta().y, input.zoom_delta()));
        let factor = pinch * (scroll * 0.004).exp();
        if (factor - 1.0).abs() > 1e-4 {
            window = window.zoomed(factor, pos - field.min);
            // The panel around it does not scroll.
            ui.ctx().input_mut(|input| input.smooth_scroll_delta = Vec2::ZERO);
        }
    }
    if response.has_focus() {
        let filter = EventFilter {
            horizontal_arrows: true,
            vertical_arrows: true,
            ..EventFilter::default()
        };
        ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, filter));
        let pressed = |key: Key| ui.input(|input| input.key_pressed(key));
        let middle = Vec2::splat(0.5 * side);
        if pressed(Key::Plus) || pressed(Key::Equals) {
            window = window.zoomed(1.5, middle);
        }
        if pressed(Key::Minus) {
            window = window.zoomed(1.0 / 1.5, middle);
        }
        if pressed(Key::Num0) {
            window = Window::whole(size, side);
        }
        let along =
            |more: Key, less: Key| f32::from(i8::from(pressed(more)) - i8::from(pressed(less)));
        let step =
            vec2(along(Key::ArrowRight, Key::ArrowLeft), along(Key::ArrowDown, Key::ArrowUp));
        window.corner += step * (0.1 * side * window.cells);
    }
    if response.double_clicked() {
        window = Window::whole(size, side);
    }
    window.bounded(size, side)
}

/// Draws the names of the parts: those of the rows below, those of the columns at the left, turned.
fn names_ui(
    matrix: &Matrix<'_>,
    (field, margin): (Rect, f32),
    place: &dyn Fn(f32, f32) -> Pos2,
    ui: &Ui,
) {
    let palette = palette_of(ui);
    for (index, (start, name)) in matrix.parts.iter().enumerate() {
        let end = matrix.parts.get(index + 1).map_or(matrix.size, |next| next.0);
        let (from, to) = (place(*start as f32, *start as f32), place(end as f32, end as f32));
        for vertical in [false, true] {
            let (low, high) = if vertical {
                (to.y.max(field.top()), from.y.min(field.bottom()))
            } else {
                (from.x.max(field.left()), to.x.min(field.right()))
            };
            let room = high - low - 4.0;
            if room < 18.0 {
                continue;
            }
            let galley = line_of(&[Run::new(name, Type::Small, palette.muted)], room, ui);
            let middle = 0.5 * (low + high);
            if vertical {
                let at = pos2(field.left() - margin, middle + 0.5 * galley.size().x);
                let shape = eframe::egui::epaint::TextShape::new(at, galley, palette.muted)
                    .with_angle(-std::f32::consts::FRAC_PI_2);
                ui.painter().add(shape);
            } else {
                let below = pos2(middle, field.bottom() + margin);
                put(ui.painter(), below, Align2::CENTER_BOTTOM, galley);
            }
        }
    }
}

/// Returns the id under which the tiles are stored.
pub(crate) fn tiles_id() -> Id {
    Id::unique("matrix tiles")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn window_of_the_whole_stays_whole_on_another_size() {
        for side in [120.0, 317.0, 640.0] {
            let whole = Window::whole(1000.0, side);
            assert_eq!(Window::whole(1000.0, 500.0).on(500.0, side).bounded(1000.0, side), whole);
            let near = Window::whole(1000.0, 500.0).zoomed(4.0, vec2(250.0, 100.0));
            let seen = near.on(500.0, side).bounded(1000.0, side);
            assert!(
                seen.corner == near.corner && (seen.cells * side - near.cells * 500.0).abs() < 1e-3
            );
        }
    }

    #[test]
    fn marks_in_view_grow_in_number_with_the_zoom() {
        // A hundred to a side, in falling importance from left to right.
        let marks: Vec<MatrixMark> = (0..10_000)
            .map(|index| MatrixMark {
                at: [(index / 100) as f32 * 10.0, (index % 100) as f32 * 10.0],
                faint: false,
            })
            .collect();
        let matrix = Matrix {
            label: Word::default(),
            size: 1000,
            known: 1,
            parts: &[],
            marks: &marks,
            lit: Some(9_999),
            now: None,
        };
        let whole = Window::whole(1000.0, 500.0);
        let seen = seen_marks(&matrix, &whole, 500.0);
        assert_eq!(
            (seen.len(), seen[0].0, seen[1].0, seen[MAX_MARKS].0),
            (MAX_MARKS + 1, 9_999, 0, MAX_MARKS - 1)
        );
        // The upper right corner, where only the highlighted mark was shown.
        let near = whole.zoomed(4.0, vec2(500.0, 0.0));
        let seen: Vec<usize> =
            seen_marks(&matrix, &near, 500.0).iter().map(|(index, _)| *index).collect();
        let wanted = (0..10_000).filter(|index| index / 100 >= 75 && index % 100 >= 75);
        assert_eq!(seen, wanted.collect::<Vec<_>>());
        // Out of view, it is not drawn.
        let away = whole.zoomed(4.0, vec2(0.0, 500.0));
        assert!(
            seen_marks(&matrix, &away, 500.0)
                .iter()
                .all(|(index, _)| index / 100 < 26 && index % 100 < 26)
        );
    }

    #[test]
    fn zoom_keeps_the_point_under_the_pointer_and_the_bounds() {
        let window = Window::whole(1000.0, 500.0);
        let at = vec2(100.0, 400.0);
        let near = window.zoomed(4.0, at);
        assert!((near.corner + at * near.cells - at * window.cells).length() < 1e-3);
        assert_eq!(near.bounded(1000.0, 500.0), near);
        assert_eq!(window.zoomed(0.1, at).bounded(1000.0, 500.0), window);
        assert_eq!([0.3, 1.0, 2.1, 3.9, 4.0].map(factor_for), [1, 1, 2, 2, 4]);
    }
}
