//! The app that eframe runs: a view of a [`Segue`](super::Segue).

use super::{Event, Shared};
use crate::platform;
use eframe::egui;
use std::cell::Cell;
use std::rc::Rc;

/// A view of a [`Segue`](super::Segue) in a window.
pub(crate) struct View {
    segue: Shared,
    /// The receiver of the events of every frame.
    on_events: Box<dyn Fn(Vec<Event>)>,
    /// Whether work goes on between frames.
    is_working: Rc<Cell<bool>>,
}

impl View {
    /// Returns a view that draws `segue` in a new window, and attaches it.
    pub(crate) fn new(
        segue: Shared,
        cc: &eframe::CreationContext<'_>,
        on_events: impl Fn(Vec<Event>) + 'static,
    ) -> Self {
        segue.borrow_mut().attach(cc);
        let is_working: Rc<Cell<bool>> = Rc::default();
        let (weak, working, ctx) =
            (Rc::downgrade(&segue), Rc::clone(&is_working), cc.egui_ctx.clone());
        platform::set_answer_listener(move || {
            if let Some(segue) = weak.upgrade() {
                work_between_frames(&segue, &working, &ctx);
            }
        });
        Self { segue, on_events: Box::new(on_events), is_working }
    }
}

/// Continues the work that a frame left over, where the platform can run it between frames. Frames
/// that are drawn in software are far apart, and the processor would be idle.
fn work_between_frames(segue: &Shared, is_working: &Rc<Cell<bool>>, ctx: &egui::Context) {
    if !platform::WORKS_BETWEEN_FRAMES || is_working.replace(true) {
        return;
    }
    let (segue, is_working, ctx) = (Rc::clone(segue), Rc::clone(is_working), ctx.clone());
    platform::between_frames(move || {
        // A borrowed app is at work already.
        let Ok(mut segue) = segue.try_borrow_mut() else {
            return true;
        };
        let before = (segue.session.revision(), segue.refinements());
        let has_work = segue.poll();
        let more = segue.refine(has_work) || has_work;
        let is_changed = (segue.session.revision(), segue.refinements()) != before;
        if !more || is_changed {
            segue.request_frame(is_changed, &ctx);
        }
        is_working.set(more);
        more
    });
}

impl eframe::App for View {
    fn raw_input_hook(&mut self, ctx: &egui::Context, raw_input: &mut egui::RawInput) {
        if let Ok(mut segue) = self.segue.try_borrow_mut()
            && segue.held_input.pass(raw_input)
        {
            ctx.request_repaint();
        }
    }

    fn logic(&mut self, ctx: &egui::Context, _frame: &mut eframe::Frame) {
        // A call of the page's API is being answered; the next frame catches up.
        let Ok(mut segue) = self.segue.try_borrow_mut() else {
            ctx.request_repaint();
            return;
        };
        if segue.logic(ctx, self.is_working.get()) {
            work_between_frames(&self.segue, &self.is_working, ctx);
        }
        segue.schedule(ctx);
        let events = segue.take_events();
        drop(segue);
        (self.on_events)(events);
    }

    fn ui(&mut self, ui: &mut egui::Ui, frame: &mut eframe::Frame) {
        let Ok(mut segue) = self.segue.try_borrow_mut() else { return };
        if segue.ui(ui, frame) {
            work_between_frames(&self.segue, &self.is_working, ui.ctx());
        }
    }

    fn clear_color(&self, visuals: &egui::Visuals) -> [f32; 4] {
        // The colour of panels, which then need not be filled: in software, a pixel that egui fills
        // takes a tenth of a microsecond.
        visuals.panel_fill.to_normalized_gamma_f32()
    }

    fn on_exit(&mut self) {
        if let Ok(mut segue) = self.segue.try_borrow_mut() {
            segue.save_on_exit();
        }
    }
}
