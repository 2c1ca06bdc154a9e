//! Pacing of frames that are drawn in software.

use crate::platform::now_ms;
use eframe::{egui, wgpu};
use std::time::Duration;

/// A pacer of frames. It does not wait for the device, because presenting a window's frame does.
#[derive(Debug)]
pub(crate) struct FramePacer;

impl FramePacer {
    /// Returns a pacer for a device.
    pub(crate) fn new(_device: &wgpu::Device, _queue: &wgpu::Queue) -> Self {
        Self
    }

    /// Requests the next frame for `min_ms` after the beginning of the present one.
    #[expect(clippy::unused_self, reason = "the page's pacer has a state")]
    pub(crate) fn next_frame(&self, ctx: &egui::Context, began_ms: f64, min_ms: f64) {
        let rest_ms = (began_ms + min_ms - now_ms()).max(0.0);
        ctx.request_repaint_after(Duration::from_secs_f64(rest_ms / 1e3));
    }
}
