//! The drawing commands of a stage.

use super::frame::{FigureDraw, PaneDraw, SkinDraw};
use super::layout::ViewUniform;
use super::light::LightMap;
use super::mesh::ConeBuffers;
use super::pipelines::{Brush, Pipelines};
use super::skins::SkinStore;
use super::view::View;
use eframe::wgpu;
use std::cell::Cell;

/// Writes the drawing commands of one stage, whose buffers are filled.
pub(super) struct StageEncoder<'a> {
    pub(super) pipelines: &'a Pipelines,
    pub(super) fine: &'a ConeBuffers,
    pub(super) coarse: &'a ConeBuffers,
    /// Takes the place of the light map where there is none.
    pub(super) unlit: &'a LightMap,
    pub(super) light: Option<&'a LightMap>,
    pub(super) skins: &'a SkinStore,
    /// Distance between the uniform blocks of panes, bytes.
    pub(super) view_stride: usize,
    /// Distance between the uniform blocks of figures, bytes.
    pub(super) figure_stride: usize,
    pub(super) view: &'a View,
}

impl StageEncoder<'_> {
    /// Draws what the main light sees. Returns `false` where something is left out because its
    /// pipeline is yet to be made.
    fn encode_light(&self, light: &LightMap, encoder: &mut wgpu::CommandEncoder) -> bool {
        let view = self.view;
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("light map"),
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &light.depths,
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(1.0),
                    store: wgpu::StoreOp::Store,
                }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        // The map itself is being drawn.
        pass.set_bind_group(1, &self.unlit.bound, &[]);
        let mut complete = true;
        for (index, pane) in view.drawn.panes.iter().enumerate() {
            let Some(tile) = pane.lit else { continue };
            pass.set_viewport(
                tile.x as f32,
                tile.y as f32,
                tile.width as f32,
                tile.height as f32,
                0.0,
                1.0,
            );
            pass.set_bind_group(0, view.views_bound.as_ref(), &[(index * self.view_stride) as u32]);
            let figures = view.drawn.figures.get(pane.figures.clone()).unwrap_or_default();
            let solid_skins =
                view.drawn.solid_skins.get(pane.solid_skins.clone()).unwrap_or_default();
            let glass = figures
                .iter()
                .filter(|figure| figure.in_light)
                .filter_map(|figure| figure.skin.as_ref());
            if let (Some(limbs), Some(pipeline)) = (
                view.limbs
                    .buffer
                    .as_ref()
                    .filter(|_| figures.iter().any(|figure| !figure.limbs().is_empty())),
                self.pipelines.get(Brush::Cast),
            ) {
                pass.set_pipeline(pipeline);
                pass.set_vertex_buffer(0, self.coarse.vertices.slice(..));
                pass.set_vertex_buffer(1, limbs.slice(..));
                pass.set_index_buffer(self.coarse.indices.slice(..), wgpu::IndexFormat::Uint16);
                for figure in
                    figures.iter().filter(|figure| figure.in_light && !figure.limbs().is_empty())
                {
                    pass.draw_indexed(0..self.coarse.index_count, 0, figure.limbs());
                }
            }
            let mut skins = solid_skins.iter().chain(glass).peekable();
            if skins.peek().is_some() {
                let pipeline = self.pipelines.get(Brush::SkinCast);
                complete &= pipeline.is_some();
                if let Some(pipeline) = pipeline {
                    pass.set_pipeline(pipeline);
                    skins.for_each(|skin| self.draw_skin(&mut pass, skin));
                }
            }
        }
        complete
    }

    /// Draws all panes. Returns `false` where something is left out because its pipeline is yet to
    /// be made.
    pub(super) fn encode(&self, encoder: &mut wgpu::CommandEncoder) -> bool {
        let view = self.view;
        let is_lit = view.drawn.panes.iter().any(|pane| pane.lit.is_some());
        let light = self.light.filter(|_| is_lit);
        let mut complete = light.is_none_or(|light| self.encode_light(light, encoder));
        let targets = view.current();
        let clear = view.drawn.clear.map(f64::from);
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("stage"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: targets.samples.as_ref().unwrap_or(&targets.color_view),
                depth_slice: None,
                resolve_target: targets.samples.as_ref().map(|_| &targets.color_view),
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color {
                        r: clear[0],
                        g: clear[1],
                        b: clear[2],
                        a: 1.0,
                    }),
                    // The samples are done with once they are resolved.
                    store: if targets.samples.is_some() {
                        wgpu::StoreOp::Discard
                    } else {
                        wgpu::StoreOp::Store
                    },
                },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &targets.depth,
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(1.0),
                    store: wgpu::StoreOp::Discard,
                }),
                stencil_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(0),
                    store: wgpu::StoreOp::Discard,
                }),
            }),
            ..Default::default()
        });
        pass.set_bind_group(1, &light.unwrap_or(self.unlit).bound, &[]);
        for (index, pane) in view.drawn.panes.iter().enumerate() {
            let [x, y, width, height] =
                [pane.viewport.x, pane.viewport.y, pane.viewport.width, pane.viewport.height];
            pass.set_viewport(x as f32, y as f32, width as f32, height as f32, 0.0, 1.0);
            pass.set_scissor_rect(x, y, width, height);
            pass.set_bind_group(0, view.views_bound.as_ref(), &[(index * self.view_stride) as u32]);
            complete &= self.encode_pane(&mut pass, pane);
        }
        // WebGL resolves the samples at the end of the pass by a copy that the last pane's scissor
        // would cut.
        let [width, height] = targets.size;
        pass.set_scissor_rect(0, 0, width, height);
        complete
    }

    /// Draws one pane. Returns `false` where something is left out because its pipeline is yet to
    /// be made.
    fn encode_pane(&self, pass: &mut wgpu::RenderPass<'_>, pane: &PaneDraw) -> bool {
        let view = self.view;
        let (Some(limbs), Some(strokes), Some(rings)) =
            (&view.limbs.buffer, &view.strokes.buffer, &view.rings.buffer)
        else {
            return true;
        };
        let complete = Cell::new(true);
        let take = |pass: &mut wgpu::RenderPass<'_>, brush| {
            let pipeline = self.pipelines.get(brush);
            if let Some(pipeline) = pipeline {
                pass.set_pipeline(pipeline);
            }
            if pipeline.is_none() {
                complete.set(false);
            }
            pipeline.is_some()
        };
        let figures = || view.drawn.figures.get(pane.figures.clone()).unwrap_or_default().iter();
        let set_figure = |pass: &mut wgpu::RenderPass<'_>, figure: &FigureDraw| {
            pass.set_bind_group(
                2,
                view.figures_bound.as_ref(),
                &[(figure.uniform * self.figure_stride) as u32],
            );
        };

        // The ground, and what lies on it. Bodies stand above it: nothing of it can hide them.
        if take(pass, Brush::Ground) {
            pass.draw(0..3, 0..1);
        }
        let casts = figures().any(|figure| !figure.casting.is_empty());
        if casts && take(pass, Brush::Shadow) {
            pass.set_vertex_buffer(0, limbs.slice(..));
            // Limbs that follow each other in the buffer are drawn at once.
            let mut waiting = 0..0;
            for FigureDraw { casting, .. } in figures().filter(|figure| !figure.casting.is_empty())
            {
                if casting.start == waiting.end {
                    waiting.end = casting.end;
                } else {
                    pass.draw(0..4, std::mem::replace(&mut waiting, casting.clone()));
                }
            }
            pass.draw(0..4, waiting);
        }
        if pane.lit.is_some() && take(pass, Brush::KeyShadow) {
            pass.draw(0..4, 0..1);
        }
        if (casts || pane.lit.is_some()) && take(pass, Brush::Shade) {
            pass.draw(0..3, 0..1);
        }
        let quads = |pass: &mut wgpu::RenderPass<'_>,
                     brush,
                     buffer: &wgpu::Buffer,
                     range: &std::ops::Range<u32>| {
            if !range.is_empty() && take(pass, brush) {
                pass.set_vertex_buffer(0, buffer.slice(..));
                pass.draw(0..4, range.clone());
            }
        };
        quads(pass, Brush::FlatLine, strokes, &pane.strokes[0]);
        quads(pass, Brush::Ring, rings, &pane.rings);

        let has_edges = view.drawn.views.first().is_some_and(ViewUniform::has_edges);
        let solids = || figures().filter(|figure| !figure.ghost && !figure.limbs().is_empty());
        // Fronts first: what is hidden need not be lit, and bodies are mostly limbs within limbs.
        for (brush, wanted) in
            [(Brush::Front, true), (Brush::Solid, true), (Brush::Edge, has_edges)]
        {
            if wanted && solids().next().is_some() && take(pass, brush) {
                pass.set_vertex_buffer(1, limbs.slice(..));
                for figure in solids() {
                    set_figure(pass, figure);
                    self.draw_limbs(pass, figure);
                }
            }
        }
        let solid_skins = view.drawn.solid_skins.get(pane.solid_skins.clone()).unwrap_or_default();
        for (brush, wanted) in [(Brush::Skin, true), (Brush::SkinEdge, has_edges)] {
            if wanted && !solid_skins.is_empty() && take(pass, brush) {
                for skin in solid_skins {
                    self.draw_skin(pass, skin);
                }
            }
        }
        quads(pass, Brush::SpaceLine, strokes, &pane.strokes[1]);
        // Each ghost first finds its front, then colours it: far ones first.
        for (number, figure) in figures().filter(|figure| figure.ghost).enumerate() {
            pass.set_stencil_reference(number as u32 % 255 + 1);
            if let Some(skin) = &figure.skin {
                // Glass has an outline, too.
                for (brush, wanted) in [
                    (Brush::SkinFront, true),
                    (Brush::SkinGhost, true),
                    (Brush::SkinEdge, figure.in_light && has_edges),
                ] {
                    if wanted && take(pass, brush) {
                        self.draw_skin(pass, skin);
                    }
                }
            } else {
                for brush in [Brush::Front, Brush::Ghost] {
                    if take(pass, brush) {
                        pass.set_vertex_buffer(1, limbs.slice(..));
                        set_figure(pass, figure);
                        self.draw_limbs(pass, figure);
                    }
                }
            }
        }
        quads(pass, Brush::FlatLine, strokes, &pane.strokes[2]);
        complete.get()
    }

    /// Draws figures in their skin with the pipeline that is set.
    fn draw_skin(&self, pass: &mut wgpu::RenderPass<'_>, skin: &SkinDraw) {
        let view = self.view;
        let mesh = view.drawn.meshes.get(skin.mesh).and_then(|mesh| self.skins.get(&mesh.0));
        if let (Some(mesh), Some(instances)) = (mesh, &view.skins.buffer) {
            pass.set_bind_group(2, view.joints.bound.as_ref(), &[]);
            pass.set_vertex_buffer(0, mesh.vertices.slice(..));
            pass.set_vertex_buffer(1, instances.slice(..));
            pass.set_index_buffer(mesh.indices.slice(..), wgpu::IndexFormat::Uint32);
            pass.draw_indexed(0..mesh.index_count, 0, skin.instances.clone());
        }
    }

    /// Draws the limbs of a figure with the pipeline that is set.
    fn draw_limbs(&self, pass: &mut wgpu::RenderPass<'_>, figure: &FigureDraw) {
        for (mesh, range) in [(self.fine, &figure.fine), (self.coarse, &figure.coarse)] {
            if !range.is_empty() {
                pass.set_vertex_buffer(0, mesh.vertices.slice(..));
                pass.set_index_buffer(mesh.indices.slice(..), wgpu::IndexFormat::Uint16);
                pass.draw_indexed(0..mesh.index_count, 0, range.clone());
            }
        }
    }
}
