//! Lines through many points, whose triangles are kept from frame to frame: under a playhead that
//! moves, the curves stay as they are.

use eframe::egui::cache::{ComputerMut, FrameCache};
use eframe::egui::epaint::{PathShape, TessellationOptions, Tessellator};
use eframe::egui::{Mesh, Painter, Pos2, Shape, Stroke};
use std::hash::{Hash, Hasher};
use std::sync::Arc;

/// Draws a line through points.
pub(super) fn paint_long_line(points: &[Pos2], stroke: Stroke, painter: &Painter) {
    let ctx = painter.ctx();
    let options = ctx.tessellation_options(|options| *options);
    let line = LongLine { points, stroke, options, pixels_per_point: ctx.pixels_per_point() };
    let mesh = ctx.memory_mut(|memory| Arc::clone(memory.caches.cache::<Meshes>().get(line)));
    painter.add(Shape::Mesh(mesh));
}

/// All that the triangles of a line depend on.
#[derive(Clone, Copy)]
struct LongLine<'a> {
    points: &'a [Pos2],
    stroke: Stroke,
    options: TessellationOptions,
    pixels_per_point: f32,
}

impl Hash for LongLine<'_> {
    fn hash<H: Hasher>(&self, state: &mut H) {
        for point in self.points {
            state.write_u64(u64::from(point.x.to_bits()) << 32 | u64::from(point.y.to_bits()));
        }
        self.stroke.hash(state);
        self.options.feathering.hash(state);
        state.write_u32(self.options.feathering_size_in_pixels.to_bits());
        state.write_u32(self.pixels_per_point.to_bits());
    }
}

type Meshes = FrameCache<Arc<Mesh>, MeshOfLine>;

#[derive(Default)]
struct MeshOfLine;

impl ComputerMut<LongLine<'_>, Arc<Mesh>> for MeshOfLine {
    fn compute(&mut self, line: LongLine<'_>) -> Arc<Mesh> {
        // No text and no discs are drawn: their textures do not matter.
        let mut tessellator =
            Tessellator::new(line.pixels_per_point, line.options, [1, 1], Vec::new());
        let mut mesh = Mesh::default();
        tessellator.tessellate_path(&PathShape::line(line.points.to_vec(), line.stroke), &mut mesh);
        Arc::new(mesh)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use eframe::egui::{Color32, Context, LayerId, RawInput, Rect, pos2};

    fn drawn(ctx: &Context, points: &[Pos2], stroke: Stroke) -> Arc<Mesh> {
        let mut mesh = None;
        let mut output = ctx.run_ui(RawInput::default(), |ui| {
            let painter = Painter::new(ui.ctx().clone(), LayerId::background(), Rect::EVERYTHING);
            paint_long_line(points, stroke, &painter);
        });
        output.textures_delta.clear(); // nothing is shown
        for clipped in output.shapes {
            if let Shape::Mesh(found) = clipped.shape {
                mesh = Some(found);
            }
        }
        mesh.expect("a mesh")
    }

    #[test]
    fn line_is_made_once_and_again_where_it_is_another() {
        let ctx = Context::default();
        let points = [pos2(0.0, 0.0), pos2(10.0, 5.0), pos2(20.0, 0.0)];
        let stroke = Stroke::new(2.0, Color32::WHITE);
        let first = drawn(&ctx, &points, stroke);
        assert!(!first.indices.is_empty());
        assert!(Arc::ptr_eq(&first, &drawn(&ctx, &points, stroke)));

        let other = [pos2(0.0, 0.0), pos2(10.0, 5.1), pos2(20.0, 0.0)];
        let moved = drawn(&ctx, &other, stroke);
        assert_ne!(first.vertices, moved.vertices);
        let thin = drawn(&ctx, &other, Stroke::new(1.0, Color32::WHITE));
        assert_ne!(moved.vertices, thin.vertices);
    }
}
