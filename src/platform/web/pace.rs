//! One picture at a time, where the processor draws it.

use super::page::sleep;
use crate::platform::now_ms;
use eframe::{egui, wgpu};
use std::cell::Cell;
use std::rc::Rc;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use wasm_bindgen_futures::spawn_local;

/// Asks for the next picture once the last one is drawn. On a machine without a graphics card both
/// are the same processor's work: a picture that is begun while the last is still being drawn makes
/// both slow, and the panels with them.
#[derive(Debug)]
pub(crate) struct Pace {
    device: wgpu::Device,
    queue: wgpu::Queue,
    asked: Rc<Cell<bool>>,
}

/// How often the device is asked whether it is done, milliseconds.
const ASK_EVERY_MS: i32 = 4;
/// A device that never says that it is done does not stop the picture for longer, milliseconds.
const PATIENCE_MS: f64 = 2000.0;

impl Pace {
    /// For this device.
    pub(crate) fn new(device: &wgpu::Device, queue: &wgpu::Queue) -> Self {
        Self { device: device.clone(), queue: queue.clone(), asked: Rc::default() }
    }

    /// Has the next frame computed when the device has drawn everything up to this one, and not
    /// sooner than `least_ms` after it began.
    pub(crate) fn next_frame(&self, ctx: &egui::Context, began_ms: f64, least_ms: f64) {
        if self.asked.replace(true) {
            return;
        }
        let (device, queue, asked, ctx) =
            (self.device.clone(), self.queue.clone(), Rc::clone(&self.asked), ctx.clone());
        spawn_local(async move {
            // What this frame gives the device is there only when the frame is over.
            sleep(0).await;
            let done = Arc::new(AtomicBool::new(false));
            let told = Arc::clone(&done);
            queue.on_submitted_work_done(move || told.store(true, Ordering::Relaxed));
            while !done.load(Ordering::Relaxed) && now_ms() - began_ms < PATIENCE_MS {
                sleep(ASK_EVERY_MS).await;
                // WebGL tells nothing of itself. An error is a lost device: others see to that.
                device.poll(wgpu::PollType::Poll).ok();
            }
            let rest = (began_ms + least_ms - now_ms()).max(0.0);
            if rest >= 1.0 {
                sleep(rest as i32).await;
            }
            asked.set(false);
            ctx.request_repaint();
        });
    }
}
