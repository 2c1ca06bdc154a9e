//! The renderer of all stages of a device.

use super::buffers::{spaced, uniform_group};
use super::encode::StageEncoder;
use super::frame::Frame;
use super::layout::{COLOR_FORMAT, DEPTH_FORMAT, FigureUniform, ViewUniform};
use super::light::{LightMap, MAP_SIZE};
use super::mesh::{ConeBuffers, ConeMesh};
use super::pipelines::Pipelines;
use super::quality::{Quality, Refinement};
use super::skins::SkinStore;
use super::targets::Targets;
use super::view::{PictureState, View};
use eframe::wgpu;
use segue_scene::Stage;
use std::time::Duration;

/// A renderer of stages, one per device. Every stage on the page has an id of its own.
pub(crate) struct StageRenderer {
    pipelines: Pipelines,
    fine: ConeBuffers,
    coarse: ConeBuffers,
    /// The alignment of uniform blocks in their buffers, bytes.
    alignment: usize,
    max_side: u32,
    quality: Quality,
    unlit: LightMap,
    /// The light map, which is made for the first body that casts a shadow.
    light: Option<LightMap>,
    skins: SkinStore,
    views: Vec<(u64, View)>,
    /// The time of the present frame, seconds.
    now_secs: f64,
    refinement: Refinement,
    /// The frame under construction. It is swapped with the one last drawn.
    scratch: Frame,
    bytes: Vec<u8>,
}

/// The result of [`StageRenderer::prepare`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct PrepareOutcome {
    /// Whether anything was drawn.
    pub(crate) drawn: bool,
    /// Whether every part was drawn. If not, the stage has to be drawn again at once.
    pub(crate) complete: bool,
    /// Whether the picture has to be drawn again, finely, when the stage no longer changes.
    pub(crate) to_be_refined: bool,
}

/// The greatest number of pixels of a changing picture without a graphics card. More would make the
/// motion stutter.
const MAX_PLAIN_PIXELS: f32 = 180_000.0;

/// The time without a change after which a coarsely drawn stage is drawn finely. The fine picture
/// takes longer than two coarse ones, and would delay the next step of a drag.
pub(super) const REFINE_AFTER: Duration = Duration::from_millis(400);

/// The number of frames of other stages after which the memory of a stage is freed.
const FORGET_AFTER: u32 = 240;

impl StageRenderer {
    /// Makes the resources that all stages share. `output_format` is the format of the page's
    /// target.
    pub(crate) fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        adapter: &wgpu::Adapter,
        output_format: wgpu::TextureFormat,
    ) -> Self {
        let smooth = [COLOR_FORMAT, DEPTH_FORMAT].iter().all(|&format| {
            adapter.get_texture_format_features(format).flags.sample_count_supported(4)
        });
        let mesh = |sides, rings| ConeBuffers::new(device, queue, &ConeMesh::new(sides, rings));
        let limits = device.limits();
        let pipelines = Pipelines::new(device, output_format, if smooth { 4 } else { 1 });
        Self {
            // One texel stands in for a missing light map.
            unlit: LightMap::new(device, &pipelines, 1),
            light: None,
            skins: SkinStore::default(),
            pipelines,
            fine: mesh(40, 8),
            coarse: mesh(16, 4),
            alignment: limits.min_uniform_buffer_offset_alignment.max(16) as usize,
            max_side: limits.max_texture_dimension_2d,
            quality: if adapter.get_info().device_type == wgpu::DeviceType::Cpu {
                Quality::Plain
            } else {
                Quality::Full
            },
            views: Vec::new(),
            now_secs: 0.0,
            refinement: Refinement::default(),
            scratch: Frame::default(),
            bytes: Vec::new(),
        }
    }

    /// Sets the quality, which by default depends on the device.
    #[cfg(test)]
    pub(crate) fn set_quality(&mut self, quality: Quality) {
        self.quality = quality;
    }

    /// Begins the frame that is prepared next, at a time in seconds.
    pub(super) fn begin_frame(&mut self, now_secs: f64, refinement: Refinement) {
        (self.now_secs, self.refinement) = (now_secs, refinement);
    }

    /// Returns the resources of the stage of that id.
    pub(super) fn view(&self, id: u64) -> Option<&View> {
        self.views.iter().find(|(key, _)| *key == id).map(|(_, view)| view)
    }

    /// Drops a stage and frees its memory.
    #[cfg(test)]
    pub(super) fn forget(&mut self, id: u64) {
        self.views.retain(|(key, _)| *key != id);
    }

    /// Draws `stage` into its own target of `size` pixels, unless nothing has changed.
    ///
    /// With [`Quality::Plain`], a changed stage is drawn with fewer triangles, and where it is
    /// large, smaller and stretched. When it is prepared again after some time without a change, it
    /// is drawn finely; see [`Refinement`].
    pub(crate) fn prepare(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        encoder: &mut wgpu::CommandEncoder,
        id: u64,
        stage: &Stage,
        size: [u32; 2],
    ) -> PrepareOutcome {
        if size.contains(&0) {
            return PrepareOutcome { drawn: false, complete: true, to_be_refined: false };
        }
        let size = size.map(|side| side.min(self.max_side));
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
            view.shown = PictureState::Nothing;
            view.complete = false;
        }
        let small = self.coarse_size(size);
        self.scratch.build(stage, size, small.unwrap_or(size), self.quality);
        if view.shown != PictureState::Nothing {
            while self.pipelines.make_next() && self.quality == Quality::Plain {}
        }
        let changed = !view.complete || view.drawn != self.scratch;
        if changed {
            view.changed_secs = self.now_secs;
        }
        // A frame that was asked for at that time may come a little early.
        let rests = match self.refinement {
            Refinement::Now => true,
            Refinement::AtRest => {
                self.now_secs - view.changed_secs >= 0.9 * REFINE_AFTER.as_secs_f64()
            }
            Refinement::Later => false,
        };
        let draw = match (changed, small) {
            (true, Some(small)) if self.refinement != Refinement::Now => {
                let fits = view.coarse.as_ref().is_some_and(|targets| targets.size == small);
                if !fits {
                    view.coarse = Some(self.targets(device, small));
                }
                Some(PictureState::Coarse)
            }
            (true, _) => Some(PictureState::Fine),
            (false, _) if view.shown == PictureState::Coarse && rests => Some(PictureState::Fine),
            (false, _) => None,
        };
        if let Some(shown) = draw {
            std::mem::swap(&mut view.drawn, &mut self.scratch);
            view.shown = shown;
            if shown == PictureState::Fine && small.is_some() {
                // The next stage is compared with the smaller frame, so that one is kept.
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
        let prepared = PrepareOutcome {
            drawn: draw.is_some(),
            complete: view.complete,
            to_be_refined: view.shown == PictureState::Coarse,
        };
        self.views.push((id, view));
        prepared
    }

    fn targets(&self, device: &wgpu::Device, size: [u32; 2]) -> Targets {
        Targets::new(device, &self.pipelines, size)
    }

    /// Returns the size of the picture of a stage in motion; `None` where it is that of a stage at
    /// rest.
    fn coarse_size(&self, [width, height]: [u32; 2]) -> Option<[u32; 2]> {
        if self.quality == Quality::Full {
            return None;
        }
        let pixels = width as f32 * height as f32;
        let scale = (MAX_PLAIN_PIXELS / pixels).sqrt().min(1.0);
        Some([width, height].map(|side| ((side as f32 * scale) as u32).max(1)))
    }

    fn view_stride(&self) -> usize {
        size_of::<ViewUniform>().next_multiple_of(self.alignment)
    }

    fn figure_stride(&self) -> usize {
        size_of::<FigureUniform>().next_multiple_of(self.alignment)
    }

    /// Uploads the frame of a stage to the device.
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
        self.skins.load(device, queue, &self.pipelines, &drawn.meshes, self.quality);
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
                "stage view",
                pane_uniforms,
                size_of::<ViewUniform>(),
            );
        }
        spaced(&drawn.figure_uniforms, figure_stride, &mut self.bytes);
        if figure_uniforms.write(device, queue, &self.bytes) {
            *figures_bound = uniform_group(
                device,
                &self.pipelines.figure_layout,
                "stage figure",
                figure_uniforms,
                size_of::<FigureUniform>(),
            );
        }
    }

    /// Draws a stage whose buffers are filled. Returns `false` where something is missing because
    /// its pipeline is not made yet, or its texture not decoded.
    fn encode(&self, encoder: &mut wgpu::CommandEncoder, view: &View) -> bool {
        let stage = StageEncoder {
            pipelines: &self.pipelines,
            fine: &self.fine,
            coarse: &self.coarse,
            unlit: &self.unlit,
            light: self.light.as_ref(),
            skins: &self.skins,
            view_stride: self.view_stride(),
            figure_stride: self.figure_stride(),
            view,
        };
        stage.encode(encoder)
    }

    /// Copies the finished stage into the page, to the viewport of the pass.
    pub(crate) fn paint(&self, pass: &mut wgpu::RenderPass<'_>, id: u64) {
        if let Some(view) = self.view(id)
            && view.shown != PictureState::Nothing
        {
            pass.set_pipeline(&self.pipelines.composite);
            pass.set_bind_group(0, &view.current().composite, &[]);
            pass.draw(0..3, 0..1);
        }
    }
}
