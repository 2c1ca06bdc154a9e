//! The app: the session, its panels, and their connection to the platform.
//!
//! [`Segue`] outlives the window that draws it: when the graphics device is lost, a new window
//! continues with the same [`Segue`].

mod actions;
mod address_bar;
pub(crate) mod api;
mod autosave;
mod converter;
mod downloads;
mod events;
mod exports;
mod frame;
mod frame_stats;
mod held_input;
mod intake;
mod language;
mod picture;
mod view;
mod window;

#[cfg(target_arch = "wasm32")]
pub(crate) use crate::render::is_stage_complete;
pub(crate) use address_bar::{link_query, link_query_for_others};
pub(crate) use events::Event;
#[cfg(target_arch = "wasm32")]
pub(crate) use exports::BegunExport;
pub(crate) use view::View;

use crate::platform::{self, Inbox, Incoming, LargeFile, LargeFileStore, Pool, Reader, Storage};
use crate::ui::{self, CurveCache, UiState};
use address_bar::AddressBar;
use api::{ApiError, LoadedClips};
use autosave::Autosave;
use converter::Converter;
use downloads::Downloads;
use exports::Exports;
use frame_stats::FrameStats;
use held_input::HeldInput;
use language::LanguageLoader;
use picture::Picture;
#[cfg(target_arch = "wasm32")]
use segue_session::StorageState;
use segue_session::{
    Command, CommandError, Job, Key, Lesson, Level, PlaybackCommand, Session, Value, link,
};
use segue_text::ToMessage;
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::rc::Rc;
use window::Window;

/// The time limit for sliced work in one call, milliseconds.
const WORK_MS: f64 = 5.0;
/// The shortest and the longest time limit for sending clips to workers in one call, milliseconds.
const MIN_SEND_MS: f64 = 1.0;
const MAX_SEND_MS: f64 = 3.0;
/// The share of the time since the last frame that sliced work may take where there is none between
/// frames. It matters where frames take long, as without a graphics card: work would hardly advance
/// in [`WORK_MS`].
const WORK_SHARE: f64 = 0.25;
/// The longest time limit for sliced work where there is none between frames, milliseconds.
const MAX_WORK_MS: f64 = 60.0;
/// The time limit for taking in files that were read in a frame, milliseconds.
const MAX_RECEIVING_MS: f64 = 8.0;
/// The most memory of motions that nothing uses, bytes: about 20 minutes at 120 frames a second.
const MAX_IDLE_BYTES: u64 = 128_000_000;
/// The longest step of the playhead, seconds. After a longer pause, such as that of a page in the
/// background, the playhead does not jump ahead.
const MAX_STEP_SECS: f64 = 0.25;

/// The session, the state of the panels, and their connection to the platform.
#[derive(Debug)]
pub(crate) struct Segue {
    session: Session,
    inbox: Inbox,
    autosave: Autosave,
    address: AddressBar,
    converter: Converter,
    downloads: Downloads,
    exports: Exports,
    reader: Reader,
    pool: Pool,
    large_files: LargeFileStore,
    /// The bytes of the file that was read last, by its task, if they are to be stored instead of
    /// the browser's handle.
    unstored: Option<(u64, LargeFile)>,
    /// The results of the files that the page's API has loaded, by task; `None` while a file is
    /// being read.
    read: BTreeMap<u64, Option<Result<LoadedClips, ApiError>>>,
    frame_stats: FrameStats,
    held_input: HeldInput,
    events: Vec<Event>,
    reported: ReportedState,
    clock: Clock,
    window: Window,
    panels: UiState,
    curves: CurveCache,
    picture: Picture,
    /// The notice to show when the text is in the clipboard.
    copied: ui::Word,
    /// Whether the session has begun, with the stored work and the link or without them.
    has_begun: bool,
    languages: LanguageLoader,
    /// The address of the corpus that the page was last told to show.
    corpus: String,
    /// The recording of the page that is under way.
    film: Option<platform::Film>,
    /// Whether the link at the start says that the page is embedded. Then nothing is stored, and
    /// the page around this one may drive it.
    embedded: bool,
    /// Whether the user was warned that the page around this one can read the files.
    has_warned_of_host: bool,
}

/// Returns whether a link says that the page is embedded. One such value is enough, even where the
/// link repeats the key with another one.
fn is_embedded(link: &str) -> bool {
    link::read(link).values.contains(&(Key::Embed, Value::Switch(true)))
}

/// The state that was last reported to the listeners of the page's API.
#[derive(Debug, Default)]
struct ReportedState {
    revision: u64,
    next_notice: u64,
}

/// Times of the last frame and of the last step, in milliseconds of [`platform::now_ms`].
#[derive(Debug)]
struct Clock {
    ticked: f64,
    /// The time of the last frame that left work over; `None` where the last frame left none.
    left_work: Option<f64>,
    frame_began: f64,
    /// The duration of the last frame's input, panels and scene.
    frame_took: f64,
}

/// A [`Segue`] that the window and the page's API share.
pub(crate) type Shared = Rc<RefCell<Segue>>;

impl Segue {
    /// Starts the app with the link in the address, and begins to read the storage.
    ///
    /// An embedded page stores nothing: it would show, and overwrite, the work of the same user in
    /// other windows.
    pub(crate) fn start(inbox: Inbox) -> Shared {
        platform::watch_navigation(&inbox);
        let mut segue = Self::start_on(inbox, platform::location_query(), Storage::open);
        segue.panels.host_reads = segue.embedded && platform::is_framed();
        Rc::new(RefCell::new(segue))
    }

    /// Starts the app like [`Self::start`], with the given link and storage.
    fn start_on(inbox: Inbox, link: String, open: impl FnOnce(&Inbox) -> Storage) -> Self {
        let embedded = is_embedded(&link);
        let storage = (!embedded).then(|| open(&inbox));
        Self { embedded, ..Self::new(inbox, storage, link) }
    }

    fn new(inbox: Inbox, storage: Option<Storage>, link: String) -> Self {
        let now_ms = platform::now_ms();
        let pool = Pool::new(&inbox);
        let mut session = if platform::READS_IN_BACKGROUND {
            Session::with_external_reader()
        } else {
            Session::new()
        };
        session.limit_idle_motions(MAX_IDLE_BYTES);
        session.set_workers(pool.size());
        Self {
            session,
            pool,
            autosave: Autosave::new(storage, link, now_ms),
            reader: Reader::new(&inbox),
            large_files: LargeFileStore::default(),
            unstored: None,
            read: BTreeMap::new(),
            inbox,
            address: AddressBar::default(),
            converter: Converter::default(),
            downloads: Downloads::default(),
            exports: Exports::default(),
            frame_stats: FrameStats::default(),
            held_input: HeldInput::default(),
            events: Vec::new(),
            reported: ReportedState::default(),
            clock: Clock { ticked: now_ms, left_work: None, frame_took: 0.0, frame_began: now_ms },
            window: Window::default(),
            panels: UiState::default(),
            curves: CurveCache::default(),
            picture: Picture::default(),
            film: None,
            embedded: false,
            has_warned_of_host: false,
            copied: ui::LINK_COPIED,
            has_begun: false,
            languages: LanguageLoader::new(),
            corpus: String::new(),
        }
    }

    /// Holds input back until the whole program is there.
    #[cfg(target_arch = "wasm32")]
    pub(crate) fn hold_input(&mut self) {
        self.held_input.begin();
    }

    /// Returns whether input is held back.
    #[cfg(target_arch = "wasm32")]
    pub(crate) fn is_holding_input(&self) -> bool {
        self.held_input.is_holding()
    }

    /// Lets the next frames have the input that was held back.
    #[cfg(target_arch = "wasm32")]
    pub(crate) fn release_input(&mut self) {
        self.held_input.end();
        self.inbox.wake();
    }

    /// Shows an error of the platform as a notice.
    #[cfg(target_arch = "wasm32")]
    pub(crate) fn show_error(&mut self, text: &str) {
        self.session.say(Level::Error, text.to_owned());
    }

    /// Carries out a command of the user or of the page's API.
    pub(crate) fn apply(&mut self, command: Command) -> Result<(), CommandError> {
        // The time that has passed belongs to the state before the command.
        self.tick();
        self.session.apply(command)
    }

    /// Pauses playback at the start of the session for users who prefer reduced motion.
    fn begin(&mut self) {
        if platform::prefers_reduced_motion() && self.session.params().is_on(Key::Play) {
            self.dispatch(Command::Playback(PlaybackCommand::TogglePlay));
        }
    }

    /// Advances the session to the present time. Returns whether anything moved.
    fn tick(&mut self) -> bool {
        let now_ms = platform::now_ms();
        let passed = (now_ms - self.clock.ticked).max(0.0) / 1e3;
        self.clock.ticked = now_ms;
        let playing = self.session.params().is_on(Key::Play);
        let ticked = self.session.tick(if playing { passed.min(MAX_STEP_SECS) } else { passed });
        if self.session.is_driven() {
            self.session.tick_took((platform::now_ms() - now_ms) / 1e3);
        }
        ticked
    }

    /// Receives answers of the platform, sends the session's requests, and does sliced work for a
    /// limited time. Returns whether there is more to do.
    pub(crate) fn poll(&mut self) -> bool {
        self.receive_all();
        self.work_for(WORK_MS)
    }

    /// Sends the session's requests, and does sliced work for `max_ms` milliseconds; where no work
    /// is done between frames, for [`WORK_SHARE`] of the time since the last frame if that is
    /// longer. Returns whether there is more to do.
    fn work_for(&mut self, mut max_ms: f64) -> bool {
        let now_ms = platform::now_ms();
        if self.autosave.begin_if_overdue(&mut self.session, &mut self.large_files, now_ms) {
            self.address.sync_from_session(&self.session);
        }
        if self.autosave.is_waiting() {
            return true;
        }
        if !std::mem::replace(&mut self.has_begun, true) {
            self.begin();
            self.autosave.set_baseline(&self.session);
        }
        self.send_requests();
        let is_converting = self.advance_conversion();
        // Before the work that takes the answers in: no frame may follow that would do it.
        self.pool.receive(&mut self.session);
        if let Some(left_ms) = self.clock.left_work
            && !platform::WORKS_BETWEEN_FRAMES
        {
            max_ms = (WORK_SHARE * (now_ms - left_ms)).clamp(max_ms, MAX_WORK_MS);
        }
        let mut more = true;
        while more && platform::now_ms() - now_ms < max_ms {
            let began_ms = platform::now_ms();
            more = self.session.work();
            self.session.work_took((platform::now_ms() - began_ms) / 1e3);
            more = more || self.picture.work();
        }
        let has_begun = self.frame_stats.count() > 0;
        // Workers wait for their clips while the page works itself.
        let until_ms = platform::now_ms() + max_ms.clamp(MIN_SEND_MS, MAX_SEND_MS);
        more = self.pool.send(&mut self.session, has_begun, until_ms) || more;
        more = more || is_converting || !self.inbox.is_empty();
        self.clock.left_work = more.then_some(now_ms);
        // The work may have made new requests.
        self.send_requests();
        self.show_corpus();
        more
    }

    /// Has the platform show the corpus that the parameters name, if it is another one now. A frame
    /// of another page has the stage alone.
    fn show_corpus(&mut self) {
        let params = self.session.params();
        let address = if params.is_on(Key::Embed) { "" } else { params.text(Key::Corpus) };
        if address != self.corpus {
            self.corpus = address.to_owned();
            platform::show_corpus(address, &self.inbox);
        }
    }

    /// Takes in the answers of the platform. Those of files wait for the next frame once that has
    /// taken [`MAX_RECEIVING_MS`].
    fn receive_all(&mut self) {
        platform::update_memory(&mut self.reader, &mut self.session);
        let began_ms = platform::now_ms();
        while let Some(incoming) = self.inbox.pop() {
            // The consequences of several files are computed once.
            let is_of_file = matches!(incoming, Incoming::Reading { .. } | Incoming::Large { .. });
            if is_of_file {
                self.session.hold();
            } else {
                self.session.release();
            }
            self.receive(incoming);
            if is_of_file && platform::now_ms() - began_ms > MAX_RECEIVING_MS {
                self.inbox.wake();
                break;
            }
        }
        self.session.release();
    }

    /// Returns whether something is under way that soon changes what is shown. A large file that a
    /// worker reads does not count.
    pub(crate) fn is_busy(&self) -> bool {
        let soon = self.session.jobs().iter().any(Job::is_computed)
            || matches!(self.session.lesson(), Some(Lesson::Waiting));
        self.autosave.is_waiting()
            || !self.downloads.is_empty()
            || !self.session.awaited_samples().is_empty()
            || self.session.is_reading_small()
            || self.picture.is_at_work()
            || soon
    }

    /// Receives what has come, and returns whether stored work may still come, even if the session
    /// has begun without it.
    pub(crate) fn is_restoring(&mut self) -> bool {
        self.receive_all();
        if !self.has_begun || self.autosave.is_waiting() {
            self.poll();
        }
        self.autosave.is_waiting()
            || self.autosave.is_late(platform::now_ms())
            || self.session.is_reading_small()
    }

    /// Carries out a command of the user. A refusal becomes a notice.
    fn dispatch(&mut self, command: Command) {
        if let Err(error) = self.apply(command) {
            self.session.say(Level::Warning, error.to_message());
        }
    }

    /// Stores the work at once, because the page may end at any moment.
    pub(crate) fn save_on_exit(&mut self) {
        self.autosave.save_on_exit(&self.session, &self.large_files);
    }

    /// Returns whether closing the page now would lose a file.
    #[cfg(target_arch = "wasm32")]
    pub(crate) fn has_unstored_files(&self) -> bool {
        let progress = self.autosave.files_stored();
        progress
            .is_some_and(|progress| progress != StorageState::Done || self.session.is_reading_new())
    }

    /// Returns whether all files are stored; `None` without a storage.
    #[cfg(target_arch = "wasm32")]
    pub(crate) fn is_stored(&self) -> Option<bool> {
        self.autosave.files_stored().map(|_| !self.has_unstored_files())
    }

    /// Returns whether files with one of these SHA-256 are being stored.
    #[cfg(target_arch = "wasm32")]
    pub(crate) fn is_storing(&self, files: &[String]) -> bool {
        self.autosave.is_storing(files)
    }

    /// Returns the events for listeners since the last call.
    pub(crate) fn take_events(&mut self) -> Vec<Event> {
        let mut events = std::mem::take(&mut self.events);
        for notice in self.session.notices().errors_since(self.reported.next_notice) {
            self.reported.next_notice = notice.id + 1;
            events.push(Event::Error { message: notice.text.to_string() });
        }
        for job in self.session.jobs() {
            events.push(Event::Progress {
                name: job.kind.name().to_owned(),
                progress: Some(job.progress),
            });
        }
        if self.session.revision() != self.reported.revision && !self.autosave.is_waiting() {
            self.reported.revision = self.session.revision();
            events.push(Event::Change { query: link_query(&self.session) });
        }
        events
    }
}
