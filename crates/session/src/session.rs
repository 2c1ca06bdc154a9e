//! The session: its parts, and the commands that change them.

mod drive;
mod files;
mod graph;
mod jobs;
mod keep;
mod lessons;
mod queries;
mod storage;

use crate::clip_resolver::ClipResolver;
use crate::command::{Command, CommandError, DriveCommand, PlaybackCommand, Request};
use crate::contact_edits::keep_edits_of_files;
use crate::document::Document;
use crate::extra_characters::{self, ExtraCharacter, ExtraCharacters};
use crate::files::{FileIntake, Job};
use crate::labs::{LabSet, LiveDrive, Outcome};
use crate::lesson::{LessonState, NewParams};
use crate::library::Library;
use crate::link;
use crate::missing::{dismiss_found, look_for_clips};
use crate::notice::{Level, Notices};
use crate::pane::{NoResult, Pane, PaneResult};
use crate::panes::{Panes, is_driven_by_user};
use crate::params::choices::Look;
use crate::params::{Compare, Key, Params, Value};
use crate::playback::{self, PlaybackState, Span, Timeline};
use crate::reading::{ReadFunction, read};
use segue_text::{Message, msg};
use std::sync::Arc;

/// The link of the first visit: a blend with three windows side by side.
const WELCOME: &str = "compare=blend_window:30,15,10";

/// The greatest number of problems of a link that are named; further ones are counted.
const MAX_PROBLEMS: usize = 6;

/// The document, and everything that is made from it. [`Session::apply`] changes it.
#[derive(Debug)]
pub struct Session {
    pub(crate) document: Document,
    labs: LabSet,
    panes: Panes,
    files: FileIntake,
    drive: LiveDrive,
    extra_characters: ExtraCharacters,
    lessons: LessonState,
    notices: Notices,
    revision: u64,
    /// Whether changes wait for [`Session::release`].
    is_held: bool,
    /// Whether there were any.
    is_stale: bool,
}

impl Default for Session {
    fn default() -> Self {
        Self::new()
    }
}

impl Session {
    /// Returns a session with the built-in clips that shows what a first visitor sees.
    #[must_use]
    pub fn new() -> Self {
        Self::with_reader(Some(read))
    }

    /// Returns a session that requests every file to be read elsewhere ([`Request::Read`]), however
    /// small. A page that only has such a session needs no code that reads files.
    #[must_use]
    pub fn with_external_reader() -> Self {
        Self::with_reader(None)
    }

    fn with_reader(reads: Option<ReadFunction>) -> Self {
        let mut session = Self {
            document: Document::default(),
            labs: LabSet::default(),
            panes: Panes::default(),
            files: FileIntake::new(reads),
            drive: LiveDrive::default(),
            extra_characters: ExtraCharacters::default(),
            lessons: LessonState::default(),
            notices: Notices::default(),
            revision: 0,
            is_held: false,
            is_stale: false,
        };
        session.open_link(WELCOME);
        session.refresh();
        session
    }

    /// Returns the parameters.
    #[must_use]
    pub fn params(&self) -> &Params {
        &self.document.params
    }

    /// Returns the library.
    #[must_use]
    pub fn library(&self) -> &Library {
        &self.document.library
    }

    /// Returns the notices to the user.
    #[must_use]
    pub fn notices(&self) -> &Notices {
        &self.notices
    }

    /// Returns the panes, left to right; at least one.
    #[must_use]
    pub fn panes(&self) -> &[Pane] {
        &self.panes.list
    }

    /// Returns the clips that play beside the result, in the order of the list; none in labs
    /// without such clips.
    #[must_use]
    pub fn extra_characters(&self) -> &[ExtraCharacter] {
        &self.extra_characters.list
    }

    /// Returns the first result, for descriptions of all panes at once.
    ///
    /// # Errors
    /// [`NoResult`] if no pane has one, and while one of them is computed.
    pub fn first_result(&self) -> Result<PaneResult<'_>, NoResult> {
        self.panes.first_result()
    }

    /// Returns the outcome on the stage in the first pane, for uses that need a single one. Like
    /// [`Pane::outcome`], it may have earlier parameters.
    #[must_use]
    pub fn main_outcome(&self) -> Option<&Arc<Outcome>> {
        self.panes.main_outcome()
    }

    /// Returns a number that grows with every change of library content, so that storage knows when
    /// to save.
    #[must_use]
    pub fn library_revision(&self) -> u64 {
        self.document.library_revision
    }

    /// Returns a number that grows with every visible change, except the playhead's.
    #[must_use]
    pub fn revision(&self) -> u64 {
        self.revision
    }

    /// Begins or ends several changes that are one step of undo, also if time passes between them.
    pub fn join_steps(&mut self, begins: bool) {
        self.document.join_steps(begins);
    }

    /// Returns whether there is a step to take back.
    #[must_use]
    pub fn can_undo(&self) -> bool {
        self.document.can_undo()
    }

    /// Returns whether there is a step to make again.
    #[must_use]
    pub fn can_redo(&self) -> bool {
        self.document.can_redo()
    }

    /// Returns the requests to the app since the last call.
    pub fn take_requests(&mut self) -> Vec<Request> {
        let lessons = self.lessons.take_requests().into_iter().map(Request::Lesson);
        self.files.take_requests().into_iter().chain(lessons).collect()
    }

    /// Returns the duration of the content of the stage, seconds: of the longest result, of the
    /// clips that replace one that cannot be made, or of an extra character.
    #[must_use]
    pub fn duration_secs(&self) -> f64 {
        self.panes.duration_secs().max(self.extra_characters.duration_secs())
    }

    /// Returns the position of the playhead, seconds.
    #[must_use]
    pub fn now_secs(&self) -> f64 {
        self.timeline().now_secs(&self.document.params)
    }

    /// Returns the part that plays.
    #[must_use]
    pub fn span(&self) -> Span {
        self.timeline().span(&self.document.params)
    }

    /// Returns whether the playhead or a driven character moves. An empty stage keeps playing, so
    /// that a result plays when it arrives.
    #[must_use]
    pub fn is_playing(&self) -> bool {
        self.document.params.is_on(Key::Play) && (self.is_driven() || self.duration_secs() > 0.0)
    }

    fn timeline(&self) -> Timeline {
        Timeline {
            duration_secs: self.duration_secs(),
            driven_secs: self.drive.shown_secs().filter(|_| self.is_driven()),
            fps: self.main_outcome().map(|outcome| outcome.motion.clip().fps()),
        }
    }

    /// Adds a notice.
    pub fn say(&mut self, level: Level, text: impl Into<Message>) {
        self.notices.say(level, text);
        self.revision += 1;
    }

    /// Adds a notice about a file or key.
    pub fn say_of(&mut self, level: Level, about: &str, text: impl Into<Message>) {
        self.notices.say_of(level, about, text);
        self.revision += 1;
    }

    /// Advances the time: moves the playhead during playback. Returns whether anything moved.
    pub fn tick(&mut self, dt_secs: f64) -> bool {
        let mut is_changed = self.notices.tick(dt_secs);
        let played_secs = dt_secs * self.document.params.number(Key::Rate);
        if self.document.params.is_on(Key::Play) && self.is_driven() {
            self.advance_drive(played_secs);
            is_changed = true;
        } else if self.is_playing() && !is_driven_by_user(&self.document.params) {
            let (timeline, params) = (self.timeline(), &mut self.document.params);
            if !timeline.advance(params, &mut self.panes.list, dt_secs) {
                self.revision += 1;
            }
            is_changed = true;
        }
        let (timeline, panes) = (self.timeline(), &mut self.panes.list);
        playback::advance_ramps(&timeline, &self.document.params, panes, played_secs) || is_changed
    }

    /// Carries out a command, and recomputes what depends on it.
    ///
    /// # Errors
    /// [`CommandError`] with the reason; the document is then unchanged.
    pub fn apply(&mut self, command: Command) -> Result<(), CommandError> {
        if let Command::Drive(DriveCommand::Steer(control)) = command {
            // Nothing that is shown depends on it until time advances.
            self.steer(control);
            return Ok(());
        }
        let before = self.playback_state();
        let is_link = matches!(command, Command::OpenLink(_));
        self.files.forget_failed_samples();
        self.route(command)?;
        self.refresh();
        if is_link {
            playback::restart(&mut self.panes.list);
        } else {
            self.resume(&before);
        }
        Ok(())
    }

    /// Passes a command to the part that carries it out.
    fn route(&mut self, command: Command) -> Result<(), CommandError> {
        match command {
            Command::Set(values) => self.set(values)?,
            Command::Frame(values) => self.document.frame(values)?,
            Command::Reset(key) => self.set_as_step(vec![(key, key.param().default_value())])?,
            Command::Settle => self.document.settle(),
            Command::OpenLink(query) => {
                self.document.remember(None);
                self.open_link(&query);
            }
            Command::Assign(slot, id) => {
                let id = self.document.assignable(id)?;
                self.set_as_step(vec![(slot.key(), Value::Text(id))])?;
            }
            Command::Remove(id) => {
                let name = self.document.remove(&id)?;
                self.say(Level::Info, msg!("{name} was removed; undo brings it back."));
            }
            Command::Discard(id) => self.document.discard(&id)?,
            Command::RemoveAll(ids) => {
                let count = self.document.remove_all(&ids)?;
                if count > 0 {
                    self.say(
                        Level::Info,
                        msg!("{count, plural, one {# clip was} other {# clips were}} removed; undo brings them back."),
                    );
                }
            }
            Command::Rename(id, name) => self.document.rename(&id, &name)?,
            Command::Keep(pane) => self.keep(pane)?,
            Command::Edit(id, edit, slot) => self.keep_edited(&id, edit, slot)?,
            Command::Compare(key) => {
                let compare = Some(self.comparison(key)?);
                self.set_as_step(vec![(Key::Compare, Value::Compare(compare))])?;
            }
            Command::Try(query) => self.try_link(&query)?,
            Command::File(command) => {
                self.files.apply(command, &mut self.document, &mut self.notices)?;
            }
            Command::Playback(command) => self.apply_playback(command),
            Command::Drive(command) => self.apply_drive(command)?,
            Command::ExtraCharacters(command) => {
                extra_characters::apply(command, &mut self.document, &self.panes)?;
            }
            Command::StopGraph(stop) => self.labs.graphs.stop(stop),
            Command::Undo => self.take_step(Document::undo),
            Command::Redo => self.take_step(Document::redo),
            Command::Dismiss(id) => self.notices.dismiss(id),
        }
        Ok(())
    }

    /// Takes back a step or makes it again, and reads the files that it restores.
    fn take_step(&mut self, step: fn(&mut Document) -> bool) {
        if step(&mut self.document) {
            self.files.read_stored(&mut self.document, &mut self.notices, Vec::new());
        }
    }

    fn apply_playback(&mut self, command: PlaybackCommand) {
        self.timeline().apply(command, &mut self.document.params);
        if let (PlaybackCommand::Step(frames), true) = (command, self.is_driven()) {
            self.step_drive(frames);
        }
    }

    fn playback_state(&self) -> PlaybackState {
        PlaybackState::of(&self.timeline(), &self.document.params, &self.panes.list)
    }

    fn resume(&mut self, before: &PlaybackState) {
        before.resume(&self.timeline(), &mut self.document.params, &mut self.panes.list);
    }

    fn set(&mut self, values: Vec<(Key, Value)>) -> Result<(), CommandError> {
        let named: Vec<Key> = values.iter().map(|(key, _)| *key).collect();
        let changes = self.document.set(values)?;
        self.files.fetch(changes.new_sources, &mut self.notices);
        if changes.keys.iter().any(|key| key.param().group.is_of_lab()) {
            self.labs.graphs.stop(false);
        }
        if changes.keys.contains(&Key::Lesson) {
            self.note_lesson(&named);
        }
        Ok(())
    }

    /// Sets values as a step for undo of its own.
    fn set_as_step(&mut self, values: Vec<(Key, Value)>) -> Result<(), CommandError> {
        self.set(values)?;
        self.document.settle();
        Ok(())
    }

    fn open_link(&mut self, query: &str) {
        let link = link::read(query);
        let mut params = Params::default();
        let named: Vec<Key> = link.values.iter().map(|(key, _)| *key).collect();
        // The language stays the reader's own until a link names another one.
        params.copy_from(&self.document.params, Key::Lang);
        for (key, value) in link.values {
            let result = params.set(key, value);
            debug_assert!(result.is_ok(), "links hold checked values: {result:?}");
        }
        self.files.correct_as_linked(&mut self.document, &link.bone_maps);
        self.document.maps_of_link = link.bone_maps;
        self.document.note_link(&named);
        self.replace_params(NewParams { params, named: named.clone(), problems: link.problems });
        self.note_lesson(&named);
    }

    /// Replaces all parameters by those of a link. Reports its problems and the missing clips.
    fn replace_params(&mut self, new: NewParams) {
        let NewParams { mut params, named, problems } = new;
        keep_edits_of_files(&self.document.library, &self.document.params, &mut params);
        let new_sources = self.document.replace_params(params, &named);
        match problems.get(MAX_PROBLEMS..).map_or(0, <[_]>::len) {
            _ if problems.is_empty() => {}
            0 => self.say(
                Level::Warning,
                msg!(
                    "The link was opened, except for: {problems}.",
                    problems = Message::joined(problems, "; ")
                ),
            ),
            more => {
                let first = problems.get(..MAX_PROBLEMS).unwrap_or(&problems);
                self.say(
                    Level::Warning,
                    msg!(
                        "The link was opened, except for: {first}; and {more} similar problems.",
                        first = Message::joined(first.to_vec(), "; ")
                    ),
                );
            }
        }
        self.files.fetch(new_sources, &mut self.notices);
        look_for_clips(&mut self.document, &mut self.notices);
        self.labs.graphs.stop(false);
    }

    pub(crate) fn clips(&mut self) -> ClipResolver<'_> {
        ClipResolver { document: &mut self.document, files: &mut self.files, labs: &mut self.labs }
    }

    /// Recomputes everything that depends on the document and whose inputs have changed.
    fn refresh(&mut self) {
        self.revision += 1;
        if self.is_held {
            self.is_stale = true;
            return;
        }
        self.files.begin_uses();
        self.lessons.request_text(&self.document.params);
        for clip in self.document.compared_clips() {
            self.document.ensure_clip(&clip);
        }
        dismiss_found(&self.document, &mut self.notices);
        let mut clips = ClipResolver {
            document: &mut self.document,
            files: &mut self.files,
            labs: &mut self.labs,
        };
        self.panes.refresh(&mut clips);
        self.panes.refresh_driven(&mut self.drive, &mut clips);
        self.panes.show_sources(&mut clips);
        self.extra_characters.refresh(&mut clips);
        clips.keep_slots_and_character();
        self.request_on_character();
        if self.files.drop_idle_motions(&mut self.document) {
            self.labs.feet.forget_dropped();
        }
    }

    /// Puts off what follows from changes of the library, so that several changes have one
    /// recomputation: until [`Session::release`].
    pub fn hold(&mut self) {
        self.is_held = true;
    }

    /// Recomputes what depends on the changes since [`Session::hold`].
    pub fn release(&mut self) {
        self.is_held = false;
        if std::mem::take(&mut self.is_stale) {
            self.refresh();
        }
    }

    /// Requests what the stage shows on the skeleton of the character, except for characters that
    /// the user drives.
    fn request_on_character(&mut self) {
        let is_shown = self.document.params.choice::<Look>() != Look::Limbs;
        let character = self.character().filter(|_| is_shown);
        let characters = &mut self.labs.characters;
        characters.set_character(character);
        if !is_driven_by_user(&self.document.params) {
            for pane in &self.panes.list {
                let Some(outcome) = &pane.outcome else { continue };
                characters.request(&outcome.motion, pane.result().is_ok());
                for source in &outcome.sources {
                    characters.request(&source.motion, pane.result().is_ok());
                }
            }
        }
        for beside in &self.extra_characters.list {
            if let Ok(motion) = &beside.motion {
                characters.request(motion, true);
            }
        }
    }

    /// Does one slice of the work that would take longer than a frame. Returns `true` while there
    /// is more.
    pub fn work(&mut self) -> bool {
        if self.labs.work(self.document.params.number(Key::Time)) {
            return true;
        }
        if self.labs.is_ready() {
            let before = self.playback_state();
            self.refresh();
            self.resume(&before);
            return true;
        }
        self.make_next()
    }

    /// Makes one built-in clip that was not needed yet. Returns `false` if all are made.
    fn make_next(&mut self) -> bool {
        let is_made = self.clips().make_next();
        self.revision += u64::from(is_made);
        is_made
    }

    /// Makes the built-in clips that were not needed yet: about 2 ms a clip.
    pub fn make_all(&mut self) {
        while self.make_next() {}
    }

    /// Returns the work in progress.
    #[must_use]
    pub fn jobs(&self) -> Vec<Job> {
        let computed = self.labs.progress().into_iter().map(|(kind, progress)| Job {
            task: None,
            kind,
            progress,
            size: None,
        });
        self.files.jobs().chain(computed).collect()
    }

    /// Returns the comparison that a parameter begins with.
    fn comparison(&self, key: Key) -> Result<Compare, CommandError> {
        let params = &self.document.params;
        let full = params.optional(key).or_else(|| self.automatic_value(key)).unwrap_or_default();
        Compare::full_half_third(key, full, self.range_of(key))
            .or_else(|| Compare::choices(key, params.get(key)))
            .ok_or(CommandError::NotPossible(
                "only a number or a choice of the lab can be compared",
            ))
    }
}

#[cfg(test)]
mod keep_tests;
#[cfg(test)]
mod metric_tests;
#[cfg(test)]
mod refusal_tests;
#[cfg(test)]
mod tests;
