//! The drawing commands of a stage.

use super::frame::{FigureDraw, PaneDraw, SkinDraw};
use super::layout::ViewUniform;
use super::light::LightMap;
use super::mesh::ConeBuffers;
use super::pipelines::{PipelineKind, Pipelines};
use super::skins::{SkinBuffers, SkinStore, Triangles};
use super::view::{PictureState, View};
use eframe::wgpu;
use std::cell::Cell;

/// An encoder of the drawing commands of one stage, whose buffers are filled.
pub(super) struct StageEncoder<'a> {
    pub(super) pipelines: &'a Pipelines,
    pub(super) fine: &'a ConeBuffers,
    pub(super) coarse: &'a ConeBuffers,
    /// The map that is bound where there is no light map.
    pub(super) unlit: &'a LightMap,
    pub(super) light: Option<&'a LightMap>,
    pub(super) skins: &'a SkinStore,
    /// The distance between the uniform blocks of panes, bytes.
    pub(super) view_stride: usize,
    /// The distance between the uniform blocks of figures, bytes.
    pub(super) figure_stride: usize,
    pub(super) view: &'a View,
}

impl StageEncoder<'_> {
    /// Draws the light map, in which parts that are cut out are whole. Returns `false` where
    /// something is left out because its pipeline is not made yet.
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
        // The map cannot be bound while it is drawn into.
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
                .filter(|figure| figure.casts_key_shadow)
                .filter_map(|figure| figure.skin.as_ref());
            if let (Some(limbs), Some(pipeline)) = (
                view.limbs
                    .buffer
                    .as_ref()
                    .filter(|_| figures.iter().any(|figure| !figure.limbs().is_empty())),
                self.pipelines.get(PipelineKind::Cast),
            ) {
                pass.set_pipeline(pipeline);
                pass.set_vertex_buffer(0, self.coarse.vertices.slice(..));
                pass.set_vertex_buffer(1, limbs.slice(..));
                pass.set_index_buffer(self.coarse.indices.slice(..), wgpu::IndexFormat::Uint16);
                for figure in figures
                    .iter()
                    .filter(|figure| figure.casts_key_shadow && !figure.limbs().is_empty())
                {
                    pass.draw_indexed(0..self.coarse.index_count, 0, figure.limbs());
                }
            }
            let mut skins = solid_skins.iter().chain(glass).peekable();
            if skins.peek().is_some() {
                let pipeline = self.pipelines.get(PipelineKind::SkinCast);
                complete &= pipeline.is_some();
                if let Some(pipeline) = pipeline {
                    pass.set_pipeline(pipeline);
                    self.set_white(&mut pass);
                    skins.for_each(|skin| self.draw_skin(&mut pass, skin));
                }
            }
        }
        complete
    }

    /// Draws all panes. Returns `false` where something is missing because its pipeline is not made
    /// yet, or its texture not decoded.
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
                    // The samples are not needed once they are resolved.
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

    /// Draws one pane. Returns `false` where something is missing because its pipeline is not made
    /// yet, or its texture not decoded.
    fn encode_pane(&self, pass: &mut wgpu::RenderPass<'_>, pane: &PaneDraw) -> bool {
        let view = self.view;
        let (Some(limbs), Some(strokes), Some(rings)) =
            (&view.limbs.buffer, &view.strokes.buffer, &view.rings.buffer)
        else {
            return true;
        };
        let complete = Cell::new(true);
        let set = |pass: &mut wgpu::RenderPass<'_>, kind| {
            let pipeline = self.pipelines.get(kind);
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

        // The ground and what lies on it, without depth: it cannot hide the bodies above it.
        if set(pass, PipelineKind::Ground) {
            pass.draw(0..3, 0..1);
        }
        let casts = figures().any(|figure| !figure.casting.is_empty());
        if casts && set(pass, PipelineKind::Shadow) {
            pass.set_vertex_buffer(0, limbs.slice(..));
            // Limbs that are adjacent in the buffer are drawn at once.
            let mut adjacent = 0..0;
            for FigureDraw { casting, .. } in figures().filter(|figure| !figure.casting.is_empty())
            {
                if casting.start == adjacent.end {
                    adjacent.end = casting.end;
                } else {
                    pass.draw(0..4, std::mem::replace(&mut adjacent, casting.clone()));
                }
            }
            pass.draw(0..4, adjacent);
        }
        if pane.lit.is_some() && set(pass, PipelineKind::KeyShadow) {
            pass.draw(0..4, 0..1);
        }
        if (casts || pane.lit.is_some()) && set(pass, PipelineKind::Shade) {
            pass.draw(0..3, 0..1);
        }
        let quads = |pass: &mut wgpu::RenderPass<'_>,
                     kind,
                     buffer: &wgpu::Buffer,
                     range: &std::ops::Range<u32>| {
            if !range.is_empty() && set(pass, kind) {
                pass.set_vertex_buffer(0, buffer.slice(..));
                pass.draw(0..4, range.clone());
            }
        };
        quads(pass, PipelineKind::FlatLine, strokes, &pane.strokes[0]);
        quads(pass, PipelineKind::Ring, rings, &pane.rings);

        let has_edges = view.drawn.views.first().is_some_and(ViewUniform::has_edges);
        let solids = || figures().filter(|figure| !figure.ghost && !figure.limbs().is_empty());
        // The depths of fronts come first, so that hidden surfaces are not lit: most limbs are
        // inside others.
        for (kind, wanted) in [
            (PipelineKind::Front, true),
            (PipelineKind::Solid, true),
            (PipelineKind::Edge, has_edges),
        ] {
            if wanted && solids().next().is_some() && set(pass, kind) {
                pass.set_vertex_buffer(1, limbs.slice(..));
                for figure in solids() {
                    set_figure(pass, figure);
                    self.draw_limbs(pass, figure);
                }
            }
        }
        let solid_skins = view.drawn.solid_skins.get(pane.solid_skins.clone()).unwrap_or_default();
        for (kind, cuts_out, wanted) in [
            (PipelineKind::Skin, false, true),
            (PipelineKind::SkinCutOut, true, true),
            (PipelineKind::SkinEdge, false, has_edges),
            (PipelineKind::SkinEdgeCutOut, true, has_edges),
        ] {
            let has_any = || {
                let mut meshes = solid_skins.iter().filter_map(|skin| self.mesh(skin));
                meshes.any(|mesh| mesh.surfaces.iter().any(|surface| surface.cuts_out == cuts_out))
            };
            if wanted && has_any() && set(pass, kind) {
                for skin in solid_skins {
                    complete.set(complete.get() & self.draw_surfaces(pass, skin, cuts_out));
                }
            }
        }
        quads(pass, PipelineKind::SpaceLine, strokes, &pane.strokes[1]);
        // The depths of a ghost's front are drawn before its colours. Far ghosts come first.
        self.set_white(pass);
        for (number, figure) in figures().filter(|figure| figure.ghost).enumerate() {
            pass.set_stencil_reference(number as u32 % 255 + 1);
            if let Some(skin) = &figure.skin {
                // A skin of glass also has an outline.
                for (kind, wanted) in [
                    (PipelineKind::SkinFront, true),
                    (PipelineKind::SkinGhost, true),
                    (PipelineKind::SkinEdge, figure.casts_key_shadow && has_edges),
                ] {
                    if wanted && set(pass, kind) {
                        self.draw_skin(pass, skin);
                    }
                }
            } else {
                for kind in [PipelineKind::Front, PipelineKind::Ghost] {
                    if set(pass, kind) {
                        pass.set_vertex_buffer(1, limbs.slice(..));
                        set_figure(pass, figure);
                        self.draw_limbs(pass, figure);
                    }
                }
            }
        }
        quads(pass, PipelineKind::FlatLine, strokes, &pane.strokes[2]);
        complete.get()
    }

    /// Returns the mesh of figures in a skin.
    fn mesh(&self, skin: &SkinDraw) -> Option<&SkinBuffers> {
        let mesh = self.view.drawn.meshes.get(skin.mesh)?;
        self.skins.get(&mesh.0)
    }

    /// Sets the texture of everything without one.
    fn set_white(&self, pass: &mut wgpu::RenderPass<'_>) {
        if let Some(white) = self.skins.textures.white() {
            pass.set_bind_group(3, white, &[]);
        }
    }

    /// Prepares the drawing of a mesh, and returns its triangles.
    fn set_mesh<'a>(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        mesh: &'a SkinBuffers,
    ) -> Option<&'a Triangles> {
        let view = self.view;
        let instances = view.skins.buffer.as_ref()?;
        pass.set_bind_group(2, view.joints.bound.as_ref(), &[]);
        pass.set_vertex_buffer(0, mesh.vertices.slice(..));
        pass.set_vertex_buffer(1, instances.slice(..));
        let coarse = mesh.coarse.as_ref().filter(|_| view.shown == PictureState::Coarse);
        let triangles = coarse.unwrap_or(&mesh.fine);
        pass.set_index_buffer(triangles.indices.slice(..), wgpu::IndexFormat::Uint32);
        Some(triangles)
    }

    /// Draws figures in a skin with the current pipeline, and with the current texture all over.
    fn draw_skin(&self, pass: &mut wgpu::RenderPass<'_>, skin: &SkinDraw) {
        let triangles = self.mesh(skin).and_then(|mesh| self.set_mesh(pass, mesh));
        if let Some(triangles) = triangles {
            pass.draw_indexed(triangles.all(), 0, skin.instances.clone());
        }
    }

    /// Draws the parts of figures in a skin that are cut out, or those that are not, with their
    /// textures and the current pipeline. Returns `false` where a texture is not decoded yet.
    fn draw_surfaces(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        skin: &SkinDraw,
        cuts_out: bool,
    ) -> bool {
        let mut complete = true;
        let Some(mesh) = self.mesh(skin) else { return complete };
        let Some(triangles) = self.set_mesh(pass, mesh) else { return complete };
        for (surface, part) in mesh.surfaces.iter().zip(&triangles.parts) {
            if surface.cuts_out != cuts_out || part.is_empty() {
                continue;
            }
            let is_waiting = surface.texture.as_ref().is_some_and(|own| own.get().is_none());
            complete &= !is_waiting;
            if is_waiting && cuts_out {
                continue;
            }
            match surface.texture.as_ref().and_then(|own| own.get()) {
                Some(bound) => pass.set_bind_group(3, bound, &[]),
                None => self.set_white(pass),
            }
            pass.draw_indexed(part.clone(), 0, skin.instances.clone());
        }
        complete
    }

    /// Draws the limbs of a figure with the current pipeline.
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
