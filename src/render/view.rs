//! One stage on the device: its targets, its buffers, and the frame that they hold.

use super::buffers::GrowingBuffer;
use super::frame::Frame;
use super::skins::JointTexture;
use super::targets::Targets;
use eframe::wgpu;

/// What the renderer keeps of one stage.
pub(super) struct View {
    pub(super) targets: Targets,
    /// A smaller picture, for what moves on a machine that draws in software.
    pub(super) coarse: Option<Targets>,
    pub(super) drawn: Frame,
    pub(super) shown: Shown,
    /// Whether nothing was left out of it.
    pub(super) complete: bool,
    pub(super) limbs: GrowingBuffer,
    pub(super) skins: GrowingBuffer,
    pub(super) joints: JointTexture,
    pub(super) strokes: GrowingBuffer,
    pub(super) rings: GrowingBuffer,
    pub(super) pane_uniforms: GrowingBuffer,
    pub(super) figure_uniforms: GrowingBuffer,
    pub(super) views_bound: Option<wgpu::BindGroup>,
    pub(super) figures_bound: Option<wgpu::BindGroup>,
    /// Frames since it was last asked for.
    pub(super) idle: u32,
}

/// The picture in the targets of a stage.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Shown {
    Nothing,
    /// The frame last drawn, in the smaller target.
    Coarse,
    /// The frame last drawn, pixel by pixel.
    Fine,
}

impl View {
    /// Returns the targets that hold, or are to hold, the picture that is shown.
    pub(super) fn current(&self) -> &Targets {
        match &self.coarse {
            Some(coarse) if self.shown == Shown::Coarse => coarse,
            _ => &self.targets,
        }
    }

    pub(super) fn new(targets: Targets) -> Self {
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
