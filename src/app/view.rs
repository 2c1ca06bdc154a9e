//! The window: what eframe draws.

use super::{Event, Shared};
use crate::platform;
use eframe::egui;
use std::cell::Cell;
use std::rc::Rc;

/// A window on a [`Segue`](super::Segue).
pub(crate) struct View {
    segue: Shared,
    /// Called with what there is to tell, after every frame.
    tell: Box<dyn Fn(Vec<Event>)>,
    /// Whether work goes on between frames.
    works: Rc<Cell<bool>>,
}

impl View {
    /// A window that begins to draw `segue`.
    pub(crate) fn new(
        segue: Shared,
        cc: &eframe::CreationContext<'_>,
        tell: impl Fn(Vec<Event>) + 'static,
    ) -> Self {
        segue.borrow_mut().attach(cc);
        Self { segue, tell: Box::new(tell), works: Rc::default() }
    }

    /// Has what a frame left over done before the next one, where the platform can: frames are far
    /// apart where pictures are drawn in software, and the processor waits for them.
    fn work_on(&self, ctx: &egui::Context) {
        if self.works.replace(true) {
            return;
        }
        let (segue, works, ctx) = (Rc::clone(&self.segue), Rc::clone(&self.works), ctx.clone());
        platform::between_frames(move || {
            // In use means that it is being worked on.
            let Ok(mut segue) = segue.try_borrow_mut() else {
                return true;
            };
            let before = segue.session.revision();
            let more = segue.pump();
            if !more || segue.session.revision() != before {
                ctx.request_repaint();
            }
            works.set(more);
            more
        });
    }
}

impl eframe::App for View {
    fn logic(&mut self, ctx: &egui::Context, _frame: &mut eframe::Frame) {
        // In use means: some call of the page's API is being answered. The next frame will do.
        let Ok(mut segue) = self.segue.try_borrow_mut() else {
            ctx.request_repaint();
            return;
        };
        if segue.logic(ctx) {
            self.work_on(ctx);
        }
        segue.schedule(ctx);
        let events = segue.take_events();
        drop(segue);
        (self.tell)(events);
    }

    fn ui(&mut self, ui: &mut egui::Ui, frame: &mut eframe::Frame) {
        if let Ok(mut segue) = self.segue.try_borrow_mut() {
            segue.ui(ui, frame);
        }
    }

    fn on_exit(&mut self) {
        if let Ok(mut segue) = self.segue.try_borrow_mut() {
            segue.leave();
        }
    }
}
