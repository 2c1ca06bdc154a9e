//! Pacing of frames that are drawn in software.

use super::page::sleep;
use crate::platform::now_ms;
use eframe::{egui, wgpu};
use std::cell::Cell;
use std::rc::Rc;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use wasm_bindgen_futures::spawn_local;

/// A pacer that requests the next frame once the last one is drawn. Without a graphics card, the
/// processor computes and draws: a frame that begins while the last one is still being drawn slows
/// both down, and the panels with them.
#[derive(Debug)]
pub(crate) struct FramePacer {
    device: wgpu::Device,
    queue: wgpu::Queue,
    is_requested: Rc<Cell<bool>>,
}

/// The time between two polls of the device, milliseconds.
const POLL_INTERVAL_MS: i32 = 4;
/// The longest wait for a device, milliseconds. A device that never reports the end of its work
/// must not stop the picture.
const MAX_WAIT_MS: f64 = 2000.0;

impl FramePacer {
    /// Returns a pacer for a device.
    pub(crate) fn new(device: &wgpu::Device, queue: &wgpu::Queue) -> Self {
        Self { device: device.clone(), queue: queue.clone(), is_requested: Rc::default() }
    }

    /// Requests the next frame for the time at which the device has drawn this one, and `min_ms`
    /// after the beginning of this one at the earliest.
    pub(crate) fn next_frame(&self, ctx: &egui::Context, began_ms: f64, min_ms: f64) {
        if self.is_requested.replace(true) {
            return;
        }
        let (device, queue, is_requested, ctx) =
            (self.device.clone(), self.queue.clone(), Rc::clone(&self.is_requested), ctx.clone());
        spawn_local(async move {
            // The commands of this frame reach the device only at its end.
            sleep(0).await;
            let done = Arc::new(AtomicBool::new(false));
            let is_done = Arc::clone(&done);
            queue.on_submitted_work_done(move || is_done.store(true, Ordering::Relaxed));
            while !done.load(Ordering::Relaxed) && now_ms() - began_ms < MAX_WAIT_MS {
                sleep(POLL_INTERVAL_MS).await;
                // WebGL reports only when polled. An error means a lost device, which the callback
                // of the window handles.
                device.poll(wgpu::PollType::Poll).ok();
            }
            let rest = (began_ms + min_ms - now_ms()).max(0.0);
            if rest >= 1.0 {
                sleep(rest as i32).await;
            }
            is_requested.set(false);
            ctx.request_repaint();
        });
    }
}
