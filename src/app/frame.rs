//! A frame of the window: the panels, their commands, the picture, and the time of the next frame.

use super::window::Shown;
use super::{Segue, WORK_MS, picture};
use crate::platform;
use crate::ui::{self, Filming};
use eframe::egui;
use std::time::Duration;

/// The time between two frames that show the progress of work.
const SHOW_PROGRESS: Duration = Duration::from_millis(200);
/// The time between two frames while workers compute and nothing else happens.
const WATCH_WORKERS: Duration = Duration::from_secs(1);
/// The time between two frames that are drawn without a graphics card, milliseconds.
const SOFTWARE_FRAME_MS: f64 = 33.0;

impl Segue {
    /// Advances the app before a frame, and now and then while the page is hidden. Draws nothing.
    /// Returns whether there is work left. `is_working` tells whether work goes on between frames:
    /// this frame then does none, because the panels are laid out in the same task of the page's
    /// thread.
    pub(super) fn logic(&mut self, ctx: &egui::Context, is_working: bool) -> bool {
        self.clock.frame_began = platform::now_ms();
        self.receive_all();
        let mut max_ms = if is_working { 0.0 } else { WORK_MS };
        if platform::WORKS_BETWEEN_FRAMES {
            // Receiving counts towards the limit; what is left is done between frames.
            max_ms -= platform::now_ms() - self.clock.frame_began;
        }
        let mut more = self.work_for(max_ms);
        // In a page, `work_between_frames` refines.
        if !platform::WORKS_BETWEEN_FRAMES {
            more = self.refine(more) || more;
        }
        let ticked = self.tick();
        if ticked {
            self.animate(ctx);
        } else if more {
            // Work that goes on between frames changes nothing in the picture but its progress.
            let soon = if platform::WORKS_BETWEEN_FRAMES { SHOW_PROGRESS } else { Duration::ZERO };
            ctx.request_repaint_after(soon);
        } else if self.pool.is_busy() {
            // Answers wake the app. This frame finds out where none comes.
            ctx.request_repaint_after(WATCH_WORKERS);
        }
        more && !self.autosave.is_waiting()
    }

    /// Requests a frame after work between frames: the next one, or, where workers compute and only
    /// their progress has changed, one in time to show that.
    pub(super) fn request_frame(&self, is_changed: bool, ctx: &egui::Context) {
        if !is_changed && self.pool.is_busy() {
            ctx.request_repaint_after(SHOW_PROGRESS);
        } else {
            ctx.request_repaint();
        }
    }

    /// Returns whether panels show less than there is to see: the curves under the timeline, or the
    /// transitions of a graph.
    fn is_coarse(&self) -> bool {
        self.curves.is_coarse() || self.panels.labs.graph.drawing.is_incomplete()
    }

    /// Refines what the panels show: for [`WORK_MS`], or, while there is other work to do, by one
    /// slice of the drawing of a graph, which would otherwise wait for the walk. Returns whether
    /// there is more.
    pub(super) fn refine(&mut self, has_work: bool) -> bool {
        let until_ms = platform::now_ms() + WORK_MS;
        while self.is_coarse() && platform::now_ms() < until_ms {
            let is_left = self.panels.labs.graph.drawing.work();
            if has_work {
                break;
            }
            if !is_left {
                self.curves.work();
            }
        }
        self.is_coarse()
    }

    /// Returns the number of refinements so far: when it changes, panels have to be drawn again.
    pub(super) fn refinements(&self) -> u64 {
        self.curves.refinements() + self.panels.labs.graph.drawing.drawings_made()
    }

    /// Shows the panels, carries out their commands and draws the picture. Returns whether there
    /// may be work to do before the next frame.
    pub(super) fn ui(&mut self, ui: &mut egui::Ui, frame: &eframe::Frame) -> bool {
        let dropped = ui.input_mut(|input| std::mem::take(&mut input.raw.dropped_files));
        if !dropped.is_empty() || ui.input(|input| !input.raw.hovered_files.is_empty()) {
            self.warn_of_host();
        }
        if !dropped.is_empty() {
            platform::read_dropped(&dropped, &self.inbox);
        }
        if self.autosave.is_waiting() {
            return false;
        }
        self.note_frame_time(ui.ctx(), frame);
        self.apply_theme(ui.ctx());
        let before = self.session.revision();
        self.update_panels(ui.ctx());
        let is_quiet = self.is_quiet(ui.ctx());
        self.panels.stillness.begin(is_quiet, ui.ctx());
        let mut slot = picture::StageSlot::default();
        let mut reserve = |stage: egui::Rect, panes: &[(usize, egui::Rect)], ui: &mut egui::Ui| {
            slot.reserve(stage, panes, ui);
        };
        let out = ui::show(&self.session, &mut self.panels, &mut self.curves, &mut reserve, ui);
        for command in out.commands {
            self.dispatch(command);
        }
        for action in out.actions {
            self.run_action(&action, ui.ctx());
        }
        // After the commands, so that this frame's picture shows what a slider has just changed.
        let theme = ui::stage_theme(&self.session, ui::theme::theme_of(ui));
        let look = ui::stage_look(&self.session, theme);
        let highlights = ui::highlights(&self.session, &self.panels);
        let is_taken = self.inbox.take_for_picture();
        self.picture.finish(slot, &self.session, (theme.palette(), look), highlights, is_taken, ui);
        let is_changed = self.session.revision() != before;
        // In a page, `work_between_frames` requests the frame that shows what it has refined.
        if is_changed || (self.is_coarse() && !platform::WORKS_BETWEEN_FRAMES) {
            ui.ctx().request_repaint();
        }
        if self.picture.is_moving() {
            self.animate(ui.ctx());
        }
        self.frame_stats.begin();
        self.clock.frame_took = platform::now_ms() - self.clock.frame_began;
        is_changed || self.is_coarse()
    }

    /// Hands the panels what they show and the session does not have.
    fn update_panels(&mut self, ctx: &egui::Context) {
        self.panels.cameras = self.picture.cameras(self.session.panes().len());
        self.panels.figures = self.picture.figures(self.session.panes().len());
        self.panels.language =
            self.languages.update(&self.session, &mut self.window.language, &self.inbox, ctx);
        self.session.set_lesson_language(self.panels.language.tag());
        if self.panels.presenter.is_on {
            self.panels.presenter.note_fullscreen(platform::is_fullscreen(ctx));
        }
        let written = self.exports.under_way().map(|name| (name.to_owned(), None));
        self.panels.fetching = self.downloads.under_way().chain(written).collect();
        self.panels.convert.shown = self.converter.shown();
        self.panels.stored = self.autosave.progress();
        self.panels.shows_corpora = platform::SHOWS_CORPORA;
        if self.session.is_driven() {
            self.panels.gamepad = platform::gamepad().map(|pad| ui::Gamepad {
                walk: pad.left,
                look: pad.right,
                run: pad.run,
                strafe: pad.strafe,
            });
        }
        self.panels.filming = Filming {
            pictures: platform::can_take_pictures(),
            films: platform::can_film(),
            secs: self.film.as_ref().map(platform::Film::secs),
        };
    }

    /// Returns whether nothing has happened since the last frame but that the motion played.
    fn is_quiet(&mut self, ctx: &egui::Context) -> bool {
        let shown = Shown {
            revision: self.session.revision(),
            refinements: self.refinements(),
            stored: self.panels.stored,
            theme: self.window.theme,
            page: ctx.content_rect(),
            has_focus: ctx.input(|input| input.focused),
        };
        let is_same = self.window.shown.replace(shown) == Some(shown);
        let is_at_work = self.clock.left_work.is_some()
            || self.pool.is_busy()
            || self.film.is_some()
            || !self.panels.fetching.is_empty()
            || self.panels.convert.shown.progress.is_some();
        let is_playing = self.session.is_playing() && !self.session.is_driven();
        is_same && is_playing && !is_at_work && self.session.notices().next_change_secs().is_none()
    }

    /// Records the duration of the last frame. eframe measures all of it, up to the commands for
    /// the graphics device, but only where the frame began with the screen's refresh; for a frame
    /// that was computed inside an input event, the time measured by [`Self::ui`] stands in.
    fn note_frame_time(&mut self, ctx: &egui::Context, frame: &eframe::Frame) {
        let measured_ms = frame.info().cpu_usage.map(|secs| secs * 1e3);
        let total_ms = if self.window.within_event { None } else { measured_ms }
            .unwrap_or(self.clock.frame_took as f32);
        if self.frame_stats.count() > 0 {
            self.frame_stats.record(self.clock.frame_took as f32, total_ms);
        }
        self.window.within_event = ctx.input(|input| {
            let computed_at_once = |event: &egui::Event| {
                matches!(
                    event,
                    egui::Event::PointerButton { .. }
                        | egui::Event::Copy
                        | egui::Event::Cut
                        | egui::Event::Paste(_)
                )
            };
            input.events.iter().any(computed_at_once)
        });
    }

    /// Requests the next frame for the time at which there will be something new to see or to do.
    pub(super) fn schedule(&mut self, ctx: &egui::Context) {
        let now_ms = platform::now_ms();
        let dragging = ctx.input(|input| input.pointer.any_down());
        // The address stands for the stored work until that is there.
        let address = (!self.autosave.is_waiting())
            .then(|| self.address.update(&self.session, dragging, now_ms));
        // Without input there is no work of the user to save. Playback alone may have been paused,
        // for users who prefer reduced motion.
        let save = (!self.held_input.is_holding())
            .then(|| self.autosave.update(&self.session, &self.large_files, now_ms));
        let waits = [
            address.flatten(),
            save.flatten(),
            self.session.notices().next_change_secs().map(|secs| secs * 1e3),
            // The next second of a film.
            self.film.as_ref().map(|film| (1.0 - film.secs().fract()) * 1e3),
        ];
        if let Some(wait) = waits.into_iter().flatten().min_by(f64::total_cmp) {
            ctx.request_repaint_after(Duration::from_secs_f64((wait / 1e3).max(0.0)));
        }
        if self.autosave.is_waiting() {
            ctx.request_repaint();
        }
        if self.session.is_playing() {
            self.animate(ctx);
        }
    }

    /// Requests the next frame of an animation: at the screen's next refresh, or, where frames are
    /// drawn in software, late enough to leave the processor time for everything else.
    fn animate(&self, ctx: &egui::Context) {
        match &self.window.pacer {
            Some(pacer) => pacer.next_frame(ctx, self.clock.frame_began, SOFTWARE_FRAME_MS),
            None => ctx.request_repaint(),
        }
    }
}
