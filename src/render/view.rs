//! A stage on the device: its targets, its buffers, and the frame that they hold.

use super::buffers::GrowingBuffer;
use super::frame::Frame;
use super::skins::JointTexture;
use super::targets::Targets;
use eframe::wgpu;

/// The resources of one stage.
pub(super) struct View {
    pub(super) targets: Targets,
    /// The targets of a smaller picture, for stages that change on a machine that draws in
    /// software.
    pub(super) coarse: Option<Targets>,
    pub(super) drawn: Frame,
    pub(super) shown: PictureState,
    /// The time of its last change, seconds.
    pub(super) changed_secs: f64,
    /// Whether every part of the frame was drawn.
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
    /// The number of frames since it was last drawn.
    pub(super) idle: u32,
}

/// The picture in the targets of a stage.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PictureState {
    Nothing,
    /// The frame last drawn, in the smaller target.
    Coarse,
    /// The frame last drawn, pixel by pixel.
    Fine,
}

impl View {
    /// Returns the targets of the shown picture.
    pub(super) fn current(&self) -> &Targets {
        match &self.coarse {
            Some(coarse) if self.shown == PictureState::Coarse => coarse,
            _ => &self.targets,
        }
    }

    pub(super) fn new(targets: Targets) -> Self {
        let (vertex, uniform) = (wgpu::BufferUsages::VERTEX, wgpu::BufferUsages::UNIFORM);
        Self {
            targets,
            coarse: None,
            drawn: Frame::default(),
            shown: PictureState::Nothing,
            changed_secs: 0.0,
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
