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
    /// How long the device drew the last frame, milliseconds.
    drawn_ms: Rc<Cell<f64>>,
}

/// The time between two polls of the device, milliseconds. Each takes a tenth of a millisecond from
/// a processor that draws meanwhile.
const POLL_INTERVAL_MS: f64 = 4.0;
/// The part of the time of the last frame after which the device is polled for the first time.
const FIRST_POLL: f64 = 0.8;
/// The longest wait for a device, milliseconds. A device that never reports the end of its work
/// must not stop the picture.
const MAX_WAIT_MS: f64 = 2000.0;

impl FramePacer {
    /// Returns a pacer for a device.
    pub(crate) fn new(device: &wgpu::Device, queue: &wgpu::Queue) -> Self {
        Self {
            device: device.clone(),
            queue: queue.clone(),
            is_requested: Rc::default(),
            drawn_ms: Rc::default(),
        }
    }

    /// Requests the next frame for the time at which the device has drawn this one, and `min_ms`
    /// after the beginning of this one at the earliest.
    pub(crate) fn next_frame(&self, ctx: &egui::Context, began_ms: f64, min_ms: f64) {
        if self.is_requested.replace(true) {
            return;
        }
        let (device, queue, ctx) = (self.device.clone(), self.queue.clone(), ctx.clone());
        let (is_requested, drawn_ms) = (Rc::clone(&self.is_requested), Rc::clone(&self.drawn_ms));
        spawn_local(async move {
            // The commands of this frame reach the device only at its end.
            sleep(0).await;
            let done = Arc::new(AtomicBool::new(false));
            let is_done = Arc::clone(&done);
            queue.on_submitted_work_done(move || is_done.store(true, Ordering::Relaxed));
            let (drawing_ms, mut polls) = (now_ms(), 0);
            let mut wait = (FIRST_POLL * drawn_ms.get()).max(POLL_INTERVAL_MS);
            while !done.load(Ordering::Relaxed) && now_ms() - began_ms < MAX_WAIT_MS {
                sleep(wait as i32).await;
                wait = POLL_INTERVAL_MS;
                polls += 1;
                // WebGL reports only when polled. An error means a lost device, which the callback
                // of the window handles.
                device.poll(wgpu::PollType::Poll).ok();
            }
            // A frame that was drawn by the first poll may have taken much less than the last one.
            let drawn = now_ms() - drawing_ms;
            drawn_ms.set(if polls > 1 { drawn } else { drawn / 2.0 });
            let rest = (began_ms + min_ms - now_ms()).max(0.0);
            if rest >= 1.0 {
                sleep(rest as i32).await;
            }
            is_requested.set(false);
            ctx.request_repaint();
        });
    }
}
