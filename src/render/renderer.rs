use super::frame::{FigureDraw, FigureUniform, Frame, PaneDraw, SkinDraw, ViewUniform};
use super::light::{LightMap, MAP_SIZE};
use super::mesh::ConeMesh;
use super::pipelines::{Brush, Pipelines};
use super::skins::{JointTexture, SkinStore};
use super::targets::{COLOR_FORMAT, DEPTH_FORMAT, Targets};
use eframe::wgpu;
use segue_scene::Stage;
use std::borrow::Cow;
use std::cell::Cell;

/// How much light is worth its time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Quality {
    /// Limbs melt into each other and shade each other.
    Full,
    /// Every limb is lit on its own: for machines without a graphics card.
    Plain,
}

/// Draws stages. One per device; every stage on the page has an id of its own.
pub(crate) struct StageRenderer {
    pipelines: Pipelines,
    fine: Mesh,
    coarse: Mesh,
    /// Distance between uniform blocks in their buffers.
    alignment: usize,
    largest_side: u32,
    quality: Quality,
    unlit: LightMap,
    /// Made for the first body that casts a shadow.
    light: Option<LightMap>,
    skins: SkinStore,
    views: Vec<(u64, View)>,
    /// The frame in the making; it takes turns with the one last drawn.
    scratch: Frame,
    bytes: Vec<u8>,
}

struct Mesh {
    vertices: wgpu::Buffer,
    indices: wgpu::Buffer,
    index_count: u32,
}

/// What belongs to one stage.
pub(super) struct View {
    pub(super) targets: Targets,
    /// A smaller picture, for what moves on a machine that draws in software.
    coarse: Option<Targets>,
    drawn: Frame,
    shown: Shown,
    /// Whether nothing was left out of it.
    complete: bool,
    limbs: GrowingBuffer,
    skins: GrowingBuffer,
    joints: JointTexture,
    strokes: GrowingBuffer,
    rings: GrowingBuffer,
    pane_uniforms: GrowingBuffer,
    figure_uniforms: GrowingBuffer,
    views_bound: Option<wgpu::BindGroup>,
    figures_bound: Option<wgpu::BindGroup>,
    /// Frames since it was last asked for.
    idle: u32,
}

/// What stands in the targets of a stage.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Shown {
    Nothing,
    /// The frame last drawn, in the smaller target.
    Coarse,
    /// The frame last drawn, pixel by pixel.
    Fine,
}

/// What [`StageRenderer::prepare`] did.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Prepared {
    /// Whether anything was drawn.
    pub(crate) drawn: bool,
    /// Whether nothing of it was left out; else it is to be drawn once more at once.
    pub(crate) complete: bool,
    /// Whether the picture is to be drawn once more, finer, when nothing moves any longer.
    pub(crate) to_be_refined: bool,
}

/// So many pixels of what moves are drawn without a graphics card: about what keeps it moving.
const PLAIN_PIXELS: f32 = 180_000.0;

/// A stage that was not asked for in so many frames of others gives its memory back.
const FORGET_AFTER: u32 = 240;

/// A buffer that is made anew only to become larger.
struct GrowingBuffer {
    label: &'static str,
    usage: wgpu::BufferUsages,
    buffer: Option<wgpu::Buffer>,
}

/// Makes a buffer that holds `contents`.
///
/// It is never mapped: where a device is dying a browser refuses that by an exception, which wgpu
/// takes for a reason to stop.
pub(super) fn filled_buffer(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    label: &str,
    contents: &[u8],
    usage: wgpu::BufferUsages,
) -> wgpu::Buffer {
    let mut contents = Cow::Borrowed(contents);
    let size = contents.len().next_multiple_of(wgpu::COPY_BUFFER_ALIGNMENT as usize);
    if contents.len() < size {
        contents.to_mut().resize(size, 0);
    }
    let buffer = device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size: size as u64,
        usage: usage | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    if size > 0 {
        queue.write_buffer(&buffer, 0, &contents);
    }
    buffer
}

impl GrowingBuffer {
    fn new(label: &'static str, usage: wgpu::BufferUsages) -> Self {
        Self { label, usage: usage | wgpu::BufferUsages::COPY_DST, buffer: None }
    }

    /// Writes `bytes`; `true` where the buffer was made anew.
    fn write(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, bytes: &[u8]) -> bool {
        let needed = bytes.len().max(256) as u64;
        let grown = self.buffer.as_ref().is_none_or(|b| b.size() < needed);
        if grown {
            self.buffer = Some(device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(self.label),
                size: needed.next_power_of_two(),
                usage: self.usage,
                mapped_at_creation: false,
            }));
        }
        if let Some(buffer) = &self.buffer
            && !bytes.is_empty()
        {
            queue.write_buffer(buffer, 0, bytes);
        }
        grown
    }
}

impl View {
    /// The targets that hold, or are to hold, the picture that is shown.
    fn current(&self) -> &Targets {
        match &self.coarse {
            Some(coarse) if self.shown == Shown::Coarse => coarse,
            _ => &self.targets,
        }
    }

    fn new(targets: Targets) -> Self {
        let (vertex, uniform) = (wgpu::BufferUsages::VERTEX, wgpu::BufferUsages::UNIFORM);
        Self {
            targets,
            coarse: None,
            drawn: Frame::default(),
            shown: Shown::Nothing,
            complete: false,
            limbs: GrowingBuffer::new("limbs", vertex),
            skins: GrowingBuffer::new("skins", vertex),
            joints: JointTexture::default(),
            strokes: GrowingBuffer::new("strokes", vertex),
            rings: GrowingBuffer::new("rings", vertex),
            pane_uniforms: GrowingBuffer::new("views", uniform),
            figure_uniforms: GrowingBuffer::new("figures", uniform),
            views_bound: None,
            figures_bound: None,
            idle: 0,
        }
    }
}

/// `blocks` one after the other, each at a multiple of `stride`, and one block of zeros more so
/// that no window reaches past the end.
fn spaced<T: bytemuck::Pod>(blocks: &[T], stride: usize, out: &mut Vec<u8>) {
    out.clear();
    out.resize(stride * (blocks.len() + 1), 0);
    for (slot, block) in out.chunks_exact_mut(stride).zip(blocks) {
        slot[..size_of::<T>()].copy_from_slice(bytemuck::bytes_of(block));
    }
}

fn uniform_group(
    device: &wgpu::Device,
    layout: &wgpu::BindGroupLayout,
    buffer: &GrowingBuffer,
    size: usize,
) -> Option<wgpu::BindGroup> {
    let buffer = buffer.buffer.as_ref()?;
    Some(device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some(if size == size_of::<ViewUniform>() { "stage view" } else { "stage figure" }),
        layout,
        entries: &[wgpu::BindGroupEntry {
            binding: 0,
            resource: wgpu::BindingResource::Buffer(wgpu::BufferBinding {
                buffer,
                offset: 0,
                size: wgpu::BufferSize::new(size as u64),
            }),
        }],
    }))
}

impl StageRenderer {
    /// Makes what all stages share. `output_format` is the format of the page's target.
    pub(crate) fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        adapter: &wgpu::Adapter,
        output_format: wgpu::TextureFormat,
    ) -> Self {
        let smooth = [COLOR_FORMAT, DEPTH_FORMAT].iter().all(|&format| {
            adapter.get_texture_format_features(format).flags.sample_count_supported(4)
        });
        let mesh = |sides, rings| {
            let mesh = ConeMesh::new(sides, rings);
            let buffer =
                |contents: &[u8], usage| filled_buffer(device, queue, "cone", contents, usage);
            Mesh {
                vertices: buffer(bytemuck::cast_slice(&mesh.vertices), wgpu::BufferUsages::VERTEX),
                indices: buffer(bytemuck::cast_slice(&mesh.indices), wgpu::BufferUsages::INDEX),
                index_count: mesh.indices.len() as u32,
            }
        };
        let limits = device.limits();
        let pipelines = Pipelines::new(device, output_format, if smooth { 4 } else { 1 });
        Self {
            // Where there is no light map, one texel takes its place.
            unlit: LightMap::new(device, &pipelines, 1),
            light: None,
            skins: SkinStore::default(),
            pipelines,
            fine: mesh(40, 8),
            coarse: mesh(16, 4),
            alignment: limits.min_uniform_buffer_offset_alignment.max(16) as usize,
            largest_side: limits.max_texture_dimension_2d,
            quality: if adapter.get_info().device_type == wgpu::DeviceType::Cpu {
                Quality::Plain
            } else {
                Quality::Full
            },
            views: Vec::new(),
            scratch: Frame::default(),
            bytes: Vec::new(),
        }
    }

    /// Chooses the light; by default that of the machine.
    #[cfg(test)]
    pub(crate) fn set_quality(&mut self, quality: Quality) {
        self.quality = quality;
    }

    /// The view of that id.
    pub(super) fn view(&self, id: u64) -> Option<&View> {
        self.views.iter().find(|(key, _)| *key == id).map(|(_, view)| view)
    }

    /// Forgets a stage and gives its memory back.
    #[cfg(test)]
    pub(super) fn forget(&mut self, id: u64) {
        self.views.retain(|(key, _)| *key != id);
    }

    /// Draws `stage` into its own target of `size` pixels, unless nothing changed.
    ///
    /// Where every pixel costs ([`Quality::Plain`]), what changes is drawn smaller and stretched;
    /// asked for again unchanged, it is drawn finely.
    pub(crate) fn prepare(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        encoder: &mut wgpu::CommandEncoder,
        id: u64,
        stage: &Stage,
        size: [u32; 2],
    ) -> Prepared {
        if size.contains(&0) {
            return Prepared { drawn: false, complete: true, to_be_refined: false };
        }
        let size = size.map(|side| side.min(self.largest_side));
        for (_, view) in &mut self.views {
            view.idle += 1;
        }
        self.views.retain(|(key, view)| *key == id || view.idle < FORGET_AFTER);
        let mut view = match self.views.iter().position(|(key, _)| *key == id) {
            Some(index) => self.views.swap_remove(index).1,
            None => View::new(self.targets(device, size)),
        };
        view.idle = 0;
        if view.targets.size != size {
            view.targets = self.targets(device, size);
            view.coarse = None;
            view.shown = Shown::Nothing;
            view.complete = false;
        }
        let small = self.coarse_size(size);
        self.scratch.build(stage, size, small.unwrap_or(size), self.quality);
        if view.shown != Shown::Nothing {
            self.pipelines.make_next();
        }
        let changed = !view.complete || view.drawn != self.scratch;
        let draw = match (changed, small) {
            (true, Some(small)) => {
                let fits = view.coarse.as_ref().is_some_and(|targets| targets.size == small);
                if !fits {
                    view.coarse = Some(self.targets(device, small));
                }
                Some(Shown::Coarse)
            }
            (true, None) => Some(Shown::Fine),
            (false, _) if view.shown == Shown::Coarse => Some(Shown::Fine),
            (false, _) => None,
        };
        if let Some(shown) = draw {
            std::mem::swap(&mut view.drawn, &mut self.scratch);
            view.shown = shown;
            if shown == Shown::Fine && small.is_some() {
                // What is compared with the next stage stays the smaller one.
                self.scratch.build(stage, size, size, self.quality);
                std::mem::swap(&mut view.drawn, &mut self.scratch);
                self.upload(device, queue, &mut view);
                view.complete = self.encode(encoder, &view);
                std::mem::swap(&mut view.drawn, &mut self.scratch);
            } else {
                self.upload(device, queue, &mut view);
                view.complete = self.encode(encoder, &view);
            }
        }
        let prepared = Prepared {
            drawn: draw.is_some(),
            complete: view.complete,
            to_be_refined: view.shown == Shown::Coarse,
        };
        self.views.push((id, view));
        prepared
    }

    fn targets(&self, device: &wgpu::Device, size: [u32; 2]) -> Targets {
        Targets::new(device, &self.pipelines, size)
    }

    /// The size of the smaller picture of a stage; `None` where there is no need of one.
    fn coarse_size(&self, [width, height]: [u32; 2]) -> Option<[u32; 2]> {
        let pixels = width as f32 * height as f32;
        if self.quality == Quality::Full || pixels <= PLAIN_PIXELS {
            return None;
        }
        let scale = (PLAIN_PIXELS / pixels).sqrt();
        Some([width, height].map(|side| ((side as f32 * scale) as u32).max(1)))
    }

    fn view_stride(&self) -> usize {
        size_of::<ViewUniform>().next_multiple_of(self.alignment)
    }

    fn figure_stride(&self) -> usize {
        size_of::<FigureUniform>().next_multiple_of(self.alignment)
    }

    fn upload(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, view: &mut View) {
        let (view_stride, figure_stride) = (self.view_stride(), self.figure_stride());
        if view.drawn.panes.iter().any(|pane| pane.lit.is_some()) && self.light.is_none() {
            self.light = Some(LightMap::new(device, &self.pipelines, MAP_SIZE));
        }
        let View {
            drawn,
            limbs,
            skins,
            joints,
            strokes,
            rings,
            pane_uniforms,
            figure_uniforms,
            views_bound,
            figures_bound,
            ..
        } = view;
        self.skins.load(device, queue, &drawn.meshes);
        if !drawn.skins.is_empty() {
            joints.write(device, queue, &self.pipelines, &drawn.joints);
        }
        skins.write(device, queue, bytemuck::cast_slice(&drawn.skins));
        limbs.write(device, queue, bytemuck::cast_slice(&drawn.limbs));
        strokes.write(device, queue, bytemuck::cast_slice(&drawn.strokes));
        rings.write(device, queue, bytemuck::cast_slice(&drawn.rings));
        spaced(&drawn.views, view_stride, &mut self.bytes);
        if pane_uniforms.write(device, queue, &self.bytes) {
            *views_bound = uniform_group(
                device,
                &self.pipelines.view_layout,
                pane_uniforms,
                size_of::<ViewUniform>(),
            );
        }
        spaced(&drawn.figure_uniforms, figure_stride, &mut self.bytes);
        if figure_uniforms.write(device, queue, &self.bytes) {
            *figures_bound = uniform_group(
                device,
                &self.pipelines.figure_layout,
                figure_uniforms,
                size_of::<FigureUniform>(),
            );
        }
    }

    /// Draws what the main light sees. `false` where something is left out because its pipeline is
    /// yet to be made.
    fn encode_light(
        &self,
        light: &LightMap,
        encoder: &mut wgpu::CommandEncoder,
        view: &View,
    ) -> bool {
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
            pass.set_bind_group(
                0,
                view.views_bound.as_ref(),
                &[(index * self.view_stride()) as u32],
            );
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
                    skins.for_each(|skin| self.draw_skin(&mut pass, view, skin));
                }
            }
        }
        complete
    }

    /// Draws all panes. `false` where something is left out because its pipeline is yet to be made.
    fn encode(&self, encoder: &mut wgpu::CommandEncoder, view: &View) -> bool {
        let is_lit = view.drawn.panes.iter().any(|pane| pane.lit.is_some());
        let light = self.light.as_ref().filter(|_| is_lit);
        let mut complete = light.is_none_or(|light| self.encode_light(light, encoder, view));
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
        pass.set_bind_group(1, &light.unwrap_or(&self.unlit).bound, &[]);
        for (index, pane) in view.drawn.panes.iter().enumerate() {
            let [x, y, width, height] =
                [pane.viewport.x, pane.viewport.y, pane.viewport.width, pane.viewport.height];
            pass.set_viewport(x as f32, y as f32, width as f32, height as f32, 0.0, 1.0);
            pass.set_scissor_rect(x, y, width, height);
            pass.set_bind_group(
                0,
                view.views_bound.as_ref(),
                &[(index * self.view_stride()) as u32],
            );
            complete &= self.encode_pane(&mut pass, view, pane);
        }
        // WebGL resolves the samples at the end of the pass by a copy that the last pane's scissor
        // would cut.
        let [width, height] = targets.size;
        pass.set_scissor_rect(0, 0, width, height);
        complete
    }

    /// Draws one pane. `false` where something is left out because its pipeline is yet to be made.
    fn encode_pane(&self, pass: &mut wgpu::RenderPass<'_>, view: &View, pane: &PaneDraw) -> bool {
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
                &[(figure.uniform * self.figure_stride()) as u32],
            );
        };

        // The ground, and what lies on it. Bodies stand above it: nothing of it can hide them.
        if take(pass, Brush::Ground) {
            pass.draw(0..3, 0..1);
        }
        let casts = figures().any(|figure| !figure.casting.is_empty());
        if casts && take(pass, Brush::Shadow) {
            pass.set_vertex_buffer(0, limbs.slice(..));
            // Those that follow each other in the buffer at once.
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
                    self.draw_skin(pass, view, skin);
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
                        self.draw_skin(pass, view, skin);
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
    fn draw_skin(&self, pass: &mut wgpu::RenderPass<'_>, view: &View, skin: &SkinDraw) {
        let mesh = view.drawn.meshes.get(skin.mesh).and_then(|mesh| self.skins.get(&mesh.0));
        if let (Some(mesh), Some(instances)) = (mesh, &view.skins.buffer) {
            pass.set_bind_group(2, view.joints.bound.as_ref(), &[]);
            pass.set_vertex_buffer(0, mesh.vertices.slice(..));
            pass.set_vertex_buffer(1, instances.slice(..));
            pass.set_index_buffer(mesh.indices.slice(..), wgpu::IndexFormat::Uint32);
            pass.draw_indexed(0..mesh.index_count, 0, skin.instances.clone());
        }
    }

    fn draw_limbs(&self, pass: &mut wgpu::RenderPass<'_>, figure: &FigureDraw) {
        for (mesh, range) in [(&self.fine, &figure.fine), (&self.coarse, &figure.coarse)] {
            if !range.is_empty() {
                pass.set_vertex_buffer(0, mesh.vertices.slice(..));
                pass.set_index_buffer(mesh.indices.slice(..), wgpu::IndexFormat::Uint16);
                pass.draw_indexed(0..mesh.index_count, 0, range.clone());
            }
        }
    }

    /// Copies the finished stage into the page; the pass' viewport is where it goes.
    pub(crate) fn paint(&self, pass: &mut wgpu::RenderPass<'_>, id: u64) {
        if let Some(view) = self.view(id)
            && view.shown != Shown::Nothing
        {
            pass.set_pipeline(&self.pipelines.composite);
            pass.set_bind_group(0, &view.current().composite, &[]);
            pass.draw(0..3, 0..1);
        }
    }
}
