//! The window that draws the app, and what belongs to its graphics device.

use super::language::WindowLanguage;
use super::{Segue, api};
use crate::platform::{self, FramePacer, Incoming};
use crate::ui;
use crate::ui::theme::Theme;
use eframe::{egui, wgpu};
use segue_session::StorageState;

/// The window that draws at present.
#[derive(Debug, Default)]
pub(super) struct Window {
    /// The number of the window since the app's start.
    pub(super) generation: u64,
    /// The name of the graphics backend in the API; empty before the first window.
    pub(super) backend: &'static str,
    /// The pacer of frames that are drawn in software; `None` with a graphics card.
    pub(super) pacer: Option<FramePacer>,
    /// The installed theme; `None` before the first frame.
    pub(super) theme: Option<Theme>,
    /// The state that the panels of the last frame showed.
    pub(super) shown: Option<Shown>,
    /// Whether a finger is the main pointer, and the size of the window for which this was asked.
    has_coarse_pointer: bool,
    pointer_of: Option<egui::Vec2>,
    /// The language of the panels.
    pub(super) language: WindowLanguage,
    /// Whether the last frame was computed inside an input event, which eframe's clock does not
    /// measure.
    pub(super) within_event: bool,
}

/// The part of the state in the panels that may change without an event of the user.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Shown {
    pub(super) revision: u64,
    pub(super) refinements: u64,
    pub(super) stored: Option<StorageState>,
    pub(super) theme: Option<Theme>,
    pub(super) page: egui::Rect,
    pub(super) has_focus: bool,
}

impl Segue {
    /// Attaches a new window, with all that belongs to its graphics device.
    pub(super) fn attach(&mut self, cc: &eframe::CreationContext<'_>) {
        self.inbox.set_context(&cc.egui_ctx);
        self.window = Window { generation: self.window.generation + 1, ..Window::default() };
        self.panels.stillness = ui::still::Stillness::default();
        cc.egui_ctx.add_plugin(ui::Pacing::default());
        // Fonts take effect with the next frame. Installed here, that is the first one, and the
        // work is done while the storage opens.
        self.apply_theme(&cc.egui_ctx);
        let Some(state) = &cc.wgpu_render_state else {
            return;
        };
        let adapter = state.adapter.get_info();
        self.window.backend = api::backend_name(adapter.backend);
        let in_software = adapter.device_type == wgpu::DeviceType::Cpu;
        self.window.pacer = in_software.then(|| FramePacer::new(&state.device, &state.queue));
        crate::render::install(state);
        let (inbox, generation) = (self.inbox.clone(), self.window.generation);
        state.device.set_device_lost_callback(move |_, reason| {
            inbox.push(Incoming::DeviceLost { generation, reason });
        });
        // Without a handler, wgpu panics at the first error of a driver, and the app ends.
        state
            .device
            .on_uncaptured_error(std::sync::Arc::new(|error| log::error!("graphics: {error}")));
    }

    /// Detaches the window. Its device-lost callback is ignored from now on.
    pub(crate) fn detach(&mut self) {
        self.window.generation += 1;
    }

    /// Returns the name of the present or last graphics backend in the API; empty before the
    /// first window.
    #[cfg(target_arch = "wasm32")]
    pub(crate) fn backend(&self) -> &'static str {
        self.window.backend
    }

    /// Installs the theme that the parameters select, where the window has another one.
    pub(super) fn apply_theme(&mut self, ctx: &egui::Context) {
        let system_dark = ctx.input(|input| input.raw.system_theme) != Some(egui::Theme::Light);
        // Another pointer comes with another window: a tablet that is turned or docked, or the
        // emulation of a phone.
        let size = ctx.content_rect().size();
        if self.window.pointer_of != Some(size) {
            self.window.pointer_of = Some(size);
            self.window.has_coarse_pointer = platform::has_coarse_pointer();
        }
        let touch = self.window.has_coarse_pointer;
        let theme = ui::theme(&self.session, system_dark, touch);
        if self.window.theme != Some(theme) {
            theme.install(ctx);
            if platform::prefers_reduced_motion() {
                ctx.all_styles_mut(|style| style.animation_time = 0.0);
            }
            self.window.theme = Some(theme);
        }
    }
}
