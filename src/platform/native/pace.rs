//! One picture at a time, where the processor draws it.

use crate::platform::now_ms;
use eframe::{egui, wgpu};
use std::time::Duration;

/// Asks for the next picture. A window's own present waits for the last one.
#[derive(Debug)]
pub(crate) struct Pace;

impl Pace {
    /// For this device.
    pub(crate) fn new(_device: &wgpu::Device, _queue: &wgpu::Queue) -> Self {
        Self
    }

    /// Has the next frame computed, not sooner than `least_ms` after the present one began.
    #[expect(clippy::unused_self, reason = "the page's has something to remember")]
    pub(crate) fn next_frame(&self, ctx: &egui::Context, began_ms: f64, least_ms: f64) {
        let rest_ms = (began_ms + least_ms - now_ms()).max(0.0);
        ctx.request_repaint_after(Duration::from_secs_f64(rest_ms / 1e3));
    }
}
