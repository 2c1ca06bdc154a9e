//! The app: the document and what surrounds it, frame by frame.
//!
//! [`Segue`] outlives the window that draws it: when the graphics device is lost, a new one draws
//! the same [`Segue`] on.

mod actions;
mod address_bar;
pub(crate) mod api;
mod downloads;
mod events;
mod frames;
mod intake;
mod keeper;
mod language;
mod picture;
mod view;

pub(crate) use address_bar::link_query;
pub(crate) use events::Event;
pub(crate) use view::View;

use crate::platform::{self, Inbox, Incoming, Pace, Reader, Storage, Vault};
use crate::ui::theme::Theme;
use crate::ui::{self, CurveCache, Filming, UiState};
use address_bar::AddressBar;
use downloads::Downloads;
use eframe::{egui, wgpu};
use frames::Frames;
use keeper::Keeper;
use language::{LanguageLoader, WindowLanguage};
use picture::Picture;
#[cfg(target_arch = "wasm32")]
use segue_session::StorageState;
use segue_session::{
    Command, CommandError, Key, Lesson, Level, PlaybackCommand, Session, Value, link,
};
use segue_text::ToMessage;
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::rc::Rc;
use std::time::Duration;

/// How much of a frame may go into work that is left over, milliseconds.
const WORK_MS: f64 = 5.0;
/// Where frames take long, as without a graphics card, work may take this share of them, up to so
/// many milliseconds: it would hardly go on otherwise.
const WORK_SHARE: f64 = 0.25;
/// See [`WORK_SHARE`].
const MOST_WORK_MS: f64 = 60.0;
/// How often it is shown how far work has come.
const SHOW_PROGRESS: Duration = Duration::from_millis(200);
/// Time that the playhead skips over when a frame took longer than that, seconds: a page that was
/// in the background does not leap on.
const LONGEST_STEP_SECS: f64 = 0.25;

/// Without a graphics card a picture every so many milliseconds is enough.
const SOFTWARE_FRAME_MS: f64 = 33.0;

/// The document, the panels' state, and what connects them to the world outside.
#[derive(Debug)]
pub(crate) struct Segue {
    session: Session,
    inbox: Inbox,
    keeper: Keeper,
    address: AddressBar,
    downloads: Downloads,
    reader: Reader,
    vault: Vault,
    /// What the tasks gave that the page's API began.
    read: BTreeMap<u64, Option<Result<api::LoadedClips, String>>>,
    frames: Frames,
    events: Vec<Event>,
    told: Told,
    clock: Clock,
    window: Window,
    panels: UiState,
    curves: CurveCache,
    picture: Picture,
    /// What is said when the clipboard has taken what it was given.
    copied: &'static str,
    /// Whether the work and the link were here once.
    has_begun: bool,
    languages: LanguageLoader,
    /// The film that is being made of the page.
    film: Option<platform::Film>,
    /// Whether the link at the start said that the page is embedded: then nothing is stored, and
    /// the page around this one may drive it.
    embedded: bool,
    /// Whether it was told that the page around this one can use it.
    has_told_of_host: bool,
}

/// Returns whether a link says that the page is embedded. Said once is enough, whatever a second
/// value says.
fn is_embedded(link: &str) -> bool {
    link::read(link).values.contains(&(Key::Embed, Value::Switch(true)))
}

/// What listeners know already.
#[derive(Debug, Default)]
struct Told {
    revision: u64,
    next_notice: u64,
}

/// What was done when, in milliseconds of [`platform::now_ms`].
#[derive(Debug)]
struct Clock {
    ticked: f64,
    /// When a frame last left work over; none where the last one did not.
    left_work: Option<f64>,
    frame_began: f64,
    /// How long the input, the panels and the scene of the last frame took.
    frame_took: f64,
}

/// The window that draws at present.
#[derive(Debug, Default)]
struct Window {
    /// Counted from the app's start.
    generation: u64,
    /// As the API calls it; empty before there is one.
    backend: &'static str,
    /// Where there is no graphics card: what sees to it that drawing leaves room for everything
    /// else.
    pace: Option<Pace>,
    /// How it looks; none before its first frame.
    theme: Option<Theme>,
    /// What it speaks.
    language: WindowLanguage,
    /// Whether the last frame was computed inside of an input event, which eframe's own clock does
    /// not see.
    within_event: bool,
}

/// A [`Segue`] that several hold on to: the window that draws it, and the page's API.
pub(crate) type Shared = Rc<RefCell<Segue>>;

impl Segue {
    /// Starts with the link in the address, and asks for what is stored.
    ///
    /// A page inside of another page stores nothing: it would show, and overwrite, what the reader
    /// works on elsewhere.
    pub(crate) fn start(inbox: Inbox) -> Shared {
        platform::watch_navigation(&inbox);
        let mut segue = Self::start_on(inbox, platform::location_query(), Storage::open);
        segue.panels.host_reads = segue.embedded && platform::is_framed();
        Rc::new(RefCell::new(segue))
    }

    /// As [`Self::start`], with a link and a storage to open.
    fn start_on(inbox: Inbox, link: String, open: impl FnOnce(&Inbox) -> Storage) -> Self {
        let embedded = is_embedded(&link);
        let storage = (!embedded).then(|| open(&inbox));
        Self { embedded, ..Self::new(inbox, storage, link) }
    }

    fn new(inbox: Inbox, storage: Option<Storage>, link: String) -> Self {
        let now_ms = platform::now_ms();
        Self {
            session: if platform::READS_ELSEWHERE {
                Session::with_external_reader()
            } else {
                Session::new()
            },
            keeper: Keeper::new(storage, link, now_ms),
            reader: Reader::new(&inbox),
            vault: Vault::default(),
            read: BTreeMap::new(),
            inbox,
            address: AddressBar::default(),
            downloads: Downloads::default(),
            frames: Frames::default(),
            events: Vec::new(),
            told: Told::default(),
            clock: Clock { ticked: now_ms, left_work: None, frame_took: 0.0, frame_began: now_ms },
            window: Window::default(),
            panels: UiState::default(),
            curves: CurveCache::default(),
            picture: Picture::default(),
            film: None,
            embedded: false,
            has_told_of_host: false,
            copied: ui::LINK_COPIED,
            has_begun: false,
            languages: LanguageLoader::new(),
        }
    }

    /// Takes a new window, with all that belongs to its graphics device.
    fn attach(&mut self, cc: &eframe::CreationContext<'_>) {
        self.inbox.wakes(&cc.egui_ctx);
        self.window = Window { generation: self.window.generation + 1, ..Window::default() };
        // Fonts take effect with the next frame: this way it is the first one, and the work is done
        // while the storage opens.
        self.dress(&cc.egui_ctx);
        let Some(state) = &cc.wgpu_render_state else {
            return;
        };
        let adapter = state.adapter.get_info();
        self.window.backend = api::backend_name(adapter.backend);
        let in_software = adapter.device_type == wgpu::DeviceType::Cpu;
        self.window.pace = in_software.then(|| Pace::new(&state.device, &state.queue));
        crate::render::install(state);
        let (inbox, generation) = (self.inbox.clone(), self.window.generation);
        state.device.set_device_lost_callback(move |_, reason| {
            inbox.push(Incoming::DeviceLost { generation, reason });
        });
        // Without this, wgpu panics at the first complaint of a driver, and a panic is the end of
        // everything.
        state
            .device
            .on_uncaptured_error(std::sync::Arc::new(|error| log::error!("graphics: {error}")));
    }

    /// Lets go of the window: what becomes of its device is no news.
    pub(crate) fn detach(&mut self) {
        self.window.generation += 1;
    }

    /// What draws at present, or did last, as the API calls it; empty before the first window.
    #[cfg(target_arch = "wasm32")]
    pub(crate) fn backend(&self) -> &'static str {
        self.window.backend
    }

    /// Says what has happened to the platform.
    #[cfg(target_arch = "wasm32")]
    pub(crate) fn complain(&mut self, text: &str) {
        self.session.say(Level::Error, text.to_owned());
    }

    /// Carries out a command that the user or the page's API gave.
    pub(crate) fn apply(&mut self, command: Command) -> Result<(), CommandError> {
        // Time that has passed belongs to the state as it was.
        self.tick();
        self.session.apply(command)
    }

    /// What happens once, when the work and the link are here: who wants little motion starts it by
    /// hand.
    fn begin(&mut self) {
        if platform::prefers_stillness() && self.session.params().is_on(Key::Play) {
            self.obey(Command::Playback(PlaybackCommand::TogglePlay));
        }
    }

    fn tick(&mut self) -> bool {
        let now_ms = platform::now_ms();
        let passed = (now_ms - self.clock.ticked).max(0.0) / 1e3;
        self.clock.ticked = now_ms;
        let playing = self.session.params().is_on(Key::Play);
        let ticked =
            self.session.tick(if playing { passed.min(LONGEST_STEP_SECS) } else { passed });
        if self.session.is_driven() {
            self.session.tick_took((platform::now_ms() - now_ms) / 1e3);
        }
        ticked
    }

    /// Takes what has come in, sends what is asked for, and works on what is left over for a while.
    /// `true` while there is more to do.
    pub(crate) fn pump(&mut self) -> bool {
        platform::follow_memory(&mut self.reader, &mut self.session);
        for incoming in self.inbox.take() {
            self.receive(incoming);
        }
        let now_ms = platform::now_ms();
        if self.keeper.wait(&mut self.session, &mut self.vault, now_ms) {
            self.address.is_right(&self.session);
        }
        if self.keeper.is_waiting() {
            return true;
        }
        if !std::mem::replace(&mut self.has_begun, true) {
            self.begin();
            self.keeper.has_begun(&self.session);
        }
        self.send_requests();
        let passed_ms = self.clock.left_work.map_or(0.0, |left_ms| now_ms - left_ms);
        let most_ms = (WORK_SHARE * passed_ms).clamp(WORK_MS, MOST_WORK_MS);
        let mut more = true;
        while more && platform::now_ms() - now_ms < most_ms {
            let began_ms = platform::now_ms();
            more = self.session.work();
            self.session.work_took((platform::now_ms() - began_ms) / 1e3);
            more = more || self.picture.work();
        }
        self.clock.left_work = more.then_some(now_ms);
        // A piece of work may have found out that it needs something.
        self.send_requests();
        more
    }

    /// Whether something is under way that soon changes what is shown. A large file that is read
    /// elsewhere takes its time.
    pub(crate) fn is_busy(&self) -> bool {
        let soon = self.session.jobs().iter().any(|job| job.task.is_none())
            || matches!(self.session.lesson(), Some(Lesson::Waiting));
        self.keeper.is_waiting()
            || !self.downloads.is_empty()
            || !self.session.awaited_samples().is_empty()
            || self.session.is_reading_small()
            || self.picture.is_at_work()
            || soon
    }

    /// Whether what is stored is still waited for.
    pub(crate) fn is_waiting(&mut self) -> bool {
        self.pump();
        self.keeper.is_waiting()
    }

    /// Whether what is stored is to be expected any moment, or is being read, though something is
    /// shown already.
    pub(crate) fn awaits_work(&mut self) -> bool {
        self.is_waiting()
            || self.keeper.is_late(platform::now_ms())
            || self.session.is_reading_small()
    }

    /// Carries out a command of the user's. What cannot be done is said.
    fn obey(&mut self, command: Command) {
        if let Err(error) = self.apply(command) {
            self.session.say(Level::Warning, error.to_message());
        }
    }

    /// What happens in every frame, and now and then while the page is hidden. No drawing. `true`
    /// while there is work left over.
    fn logic(&mut self, ctx: &egui::Context) -> bool {
        self.clock.frame_began = platform::now_ms();
        let more = self.pump();
        let ticked = self.tick();
        if ticked {
            self.animate(ctx);
        } else if more {
            // Between frames work goes on without a new picture: all there is to see is how far it
            // is.
            let soon = if platform::WORKS_BETWEEN_FRAMES { SHOW_PROGRESS } else { Duration::ZERO };
            ctx.request_repaint_after(soon);
        }
        more && !self.keeper.is_waiting()
    }

    /// One frame of the window.
    fn ui(&mut self, ui: &mut egui::Ui, frame: &eframe::Frame) {
        let dropped = ui.input_mut(|input| std::mem::take(&mut input.raw.dropped_files));
        if !dropped.is_empty() || ui.input(|input| !input.raw.hovered_files.is_empty()) {
            self.tell_of_host();
        }
        if !dropped.is_empty() {
            platform::read_dropped(dropped, &self.inbox);
        }
        if self.keeper.is_waiting() {
            return;
        }
        self.note_frame_time(ui.ctx(), frame);
        self.dress(ui.ctx());
        let before = self.session.revision();
        let mut frame = picture::Place::default();
        let mut reserve = |stage: egui::Rect, panes: &[(usize, egui::Rect)], ui: &mut egui::Ui| {
            frame.reserve(stage, panes, ui);
        };
        self.panels.cameras = self.picture.cameras(self.session.panes().len());
        self.panels.language =
            self.languages.update(&self.session, &mut self.window.language, &self.inbox, ui.ctx());
        self.session.set_lesson_language(self.panels.language.tag());
        self.panels.fetching = self.downloads.under_way().collect();
        self.panels.stored = self.keeper.progress();
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
        let out = ui::show(&self.session, &mut self.panels, &mut self.curves, &mut reserve, ui);
        for command in out.commands {
            self.obey(command);
        }
        for action in out.actions {
            self.act(&action, ui.ctx());
        }
        // Only now: what a slider has just changed is in this picture, not in the next.
        let theme = ui::stage_theme(&self.session, ui::theme::theme_of(ui));
        let look = ui::stage_look(&self.session, theme);
        let highlights = ui::highlights(&self.session, &self.panels);
        self.picture.finish(frame, &self.session, (theme.palette(), look), highlights, ui);
        if self.session.revision() != before {
            ui.ctx().request_repaint();
        }
        if self.picture.is_moving() {
            self.animate(ui.ctx());
        }
        self.frames.begin();
        self.clock.frame_took = platform::now_ms() - self.clock.frame_began;
    }

    /// Gives the window the theme that the parameters ask for.
    fn dress(&mut self, ctx: &egui::Context) {
        let system_dark = ctx.input(|input| input.raw.system_theme) != Some(egui::Theme::Light);
        let theme = ui::theme(&self.session, system_dark);
        if self.window.theme != Some(theme) {
            theme.install(ctx);
            if platform::prefers_stillness() {
                ctx.all_styles_mut(|style| style.animation_time = 0.0);
            }
            ui::kit::ENGLISH.install(ctx);
            self.window.theme = Some(theme);
        }
    }

    /// Remembers how long the last frame took. eframe measures all of it, up to the commands for
    /// the graphics device, but only when it began with the screen's beat; a frame that was
    /// computed inside of an input event is counted with what was measured here.
    fn note_frame_time(&mut self, ctx: &egui::Context, frame: &eframe::Frame) {
        let whole_ms = frame.info().cpu_usage.map(|secs| secs * 1e3);
        let millis = if self.window.within_event { None } else { whole_ms }
            .unwrap_or(self.clock.frame_took as f32);
        if self.frames.count() > 0 {
            self.frames.took(self.clock.frame_took as f32, millis);
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

    /// Has the next frame drawn when there will be something new to see or to do, and only then.
    fn schedule(&mut self, ctx: &egui::Context) {
        let now_ms = platform::now_ms();
        let dragging = ctx.input(|input| input.pointer.any_down());
        let waits = [
            self.address.tend(&self.session, dragging, now_ms),
            self.keeper.tend(&self.session, &self.vault, now_ms),
            self.session.notices().next_change_secs().map(|secs| secs * 1e3),
            // The next second of a film.
            self.film.as_ref().map(|film| (1.0 - film.secs().fract()) * 1e3),
        ];
        if let Some(wait) = waits.into_iter().flatten().min_by(f64::total_cmp) {
            ctx.request_repaint_after(Duration::from_secs_f64((wait / 1e3).max(0.0)));
        }
        if self.keeper.is_waiting() {
            ctx.request_repaint();
        }
        if self.session.is_playing() {
            self.animate(ctx);
        }
    }

    /// Something moves by itself: the next picture comes with the screen's next beat, or, where
    /// pictures are drawn in software, in time to leave the processor free for everything else.
    fn animate(&self, ctx: &egui::Context) {
        match &self.window.pace {
            Some(pace) => pace.next_frame(ctx, self.clock.frame_began, SOFTWARE_FRAME_MS),
            None => ctx.request_repaint(),
        }
    }

    /// Stores the work at once: the page may be about to go.
    pub(crate) fn leave(&mut self) {
        self.keeper.leave(&self.session, &self.vault);
    }

    /// Whether a file that has come would be gone if the page went now.
    #[cfg(target_arch = "wasm32")]
    pub(crate) fn has_unstored_files(&self) -> bool {
        let progress = self.keeper.files_stored();
        progress
            .is_some_and(|progress| progress != StorageState::Done || self.session.is_reading_new())
    }

    /// Whether files with one of these SHA-256 are being stored.
    #[cfg(target_arch = "wasm32")]
    pub(crate) fn is_storing(&self, files: &[String]) -> bool {
        self.keeper.is_storing(files)
    }

    /// What there is to tell listeners since the last call.
    pub(crate) fn take_events(&mut self) -> Vec<Event> {
        let mut events = std::mem::take(&mut self.events);
        for notice in self.session.notices().errors_since(self.told.next_notice) {
            self.told.next_notice = notice.id + 1;
            events.push(Event::Error { message: notice.text.to_string() });
        }
        for job in self.session.jobs() {
            events.push(Event::Progress {
                name: job.kind.name().to_owned(),
                progress: Some(job.progress),
            });
        }
        if self.session.revision() != self.told.revision && !self.keeper.is_waiting() {
            self.told.revision = self.session.revision();
            events.push(Event::Change { query: link_query(&self.session) });
        }
        events
    }
}
