//! The document itself: what it holds, and what commands do to it.

mod bundled;
mod company;
mod driving;
mod going_round;
mod graphing;
mod loading;
mod memory;
mod panes;
mod storing;
mod teaching;

use crate::Selected;
use crate::labs::lab::{self, Beside};
pub use company::Companion;
pub use loading::Loaded;
use loading::Reading;
pub use panes::Job;
pub use panes::{Made, NoResult, Pane, Shown};
pub use teaching::{Lesson, LessonPage};

use crate::command::{Command, CommandError, Request};
use crate::compare::Compare;
use crate::document::Document;
use crate::labs::{CycleMade, DistanceMap, LabSet, Outcome, Slot, read_pins, read_weights};
use crate::labs::{
    is_as_it_is, made_motion_has, middle_mps, range_of, recipe_id, recipe_name, recipe_params,
    synth_action,
};
use crate::lesson::Shelf;
use crate::library::{Entry, Library, Origin};
use crate::link;
use crate::memory::Memory;
use crate::motion::FeetReader;
use crate::notice::{Level, Notices};
use crate::outside;
use crate::params::{Key, Params, Value};
use crate::reading::{Reads, read};
use crate::transport::Span;
use segue_motion::clip::Motion;
use segue_motion::skin::Character;
use segue_motion::synth;
use segue_text::{Message, msg};
use std::sync::Arc;

/// What the first visitor sees: the experiment of the course, running.
const WELCOME: &str = "compare=blend_window:30,15,10";

/// A link with this many clips to load is an accident.
const MOST_SOURCES: usize = 16;

/// A clip as the page's API tells of it.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct ClipInfo {
    /// What links call it.
    pub id: String,
    /// What a person calls it.
    pub name: String,
    /// `bvh`, `amc`, `asf`, `gltf` or `synth`.
    pub format: &'static str,
    /// Number of joints; 0 while it is not loaded.
    pub joints: usize,
    /// Number of frames.
    pub frames: usize,
    /// Frames per second.
    pub fps: f64,
    /// Seconds.
    pub duration: f64,
    /// Standing height in metres.
    pub height: f32,
    /// SHA-256 of the file, hexadecimal; `null` for what no file gave.
    pub sha256: Option<String>,
}

/// The document. See the module.
#[derive(Debug)]
pub struct Session {
    pub(crate) document: Document,
    notices: Notices,
    panes: Vec<Pane>,
    /// Clips whose feet are read otherwise than usual.
    feet: FeetReader,
    labs: LabSet,
    company: Vec<Companion>,
    driving: driving::Driving,
    shelf: Shelf,
    requests: Vec<Request>,
    awaited: bundled::AwaitedSamples,
    /// What reads small files at once; none where all reading is done elsewhere.
    reads: Option<Reads>,
    reading: Vec<Reading>,
    tasks: u64,
    /// The page's memory, where that has an end.
    memory: Option<Memory>,
    /// The library revision at which motion outside of the library was let go last.
    let_go_at: Option<u64>,
    revision: u64,
}

impl Default for Session {
    fn default() -> Self {
        Self::new()
    }
}

impl Session {
    /// A new document with the built-in clips, showing what a first visitor sees.
    #[must_use]
    pub fn new() -> Self {
        Self::that_reads(Some(read))
    }

    /// One that asks for every file to be read elsewhere ([`Request::Read`]), however small. A page
    /// that only has this one needs no code that reads files.
    #[must_use]
    pub fn that_has_files_read() -> Self {
        Self::that_reads(None)
    }

    fn that_reads(reads: Option<Reads>) -> Self {
        let mut session = Self {
            reads,
            document: Document::default(),
            notices: Notices::default(),
            panes: Vec::new(),
            feet: FeetReader::default(),
            labs: LabSet::default(),
            company: Vec::new(),
            driving: driving::Driving::default(),
            shelf: Shelf::default(),
            requests: Vec::new(),
            awaited: bundled::AwaitedSamples::default(),
            reading: Vec::new(),
            tasks: 0,
            memory: None,
            let_go_at: None,
            revision: 0,
        };
        session.open_link(WELCOME);
        session.refresh();
        session
    }

    /// The parameters.
    #[must_use]
    pub fn params(&self) -> &Params {
        &self.document.params
    }

    /// The library.
    #[must_use]
    pub fn library(&self) -> &Library {
        &self.document.library
    }

    /// What there is to say.
    #[must_use]
    pub fn notices(&self) -> &Notices {
        &self.notices
    }

    /// The panes, left to right; at least one.
    #[must_use]
    pub fn panes(&self) -> &[Pane] {
        &self.panes
    }

    /// The first result that there is, for what tells of all panes at once.
    ///
    /// # Errors
    /// [`NoResult`] where no pane has one, and while one of them is computed.
    pub fn first_result(&self) -> Result<Made<'_>, NoResult> {
        let (mut found, mut refused) = (None, None);
        for result in self.panes.iter().map(Pane::result) {
            match result {
                Ok(made) => found = found.or(Some(made)),
                Err(NoResult::Awaited) => return Err(NoResult::Awaited),
                Err(problem) => refused = refused.or(Some(problem)),
            }
        }
        found.ok_or(refused.unwrap_or(NoResult::Awaited))
    }

    /// A pane by its number, counted from 0.
    pub(crate) fn pane(&self, index: usize) -> Result<&Pane, CommandError> {
        self.panes.get(index).ok_or(CommandError::NotPossible("there is no such pane"))
    }

    /// Grows with every change of library content; tells storage when to save.
    #[must_use]
    pub fn library_revision(&self) -> u64 {
        self.document.library_revision
    }

    /// Grows with every change that anybody could see, except the playhead's.
    #[must_use]
    pub fn revision(&self) -> u64 {
        self.revision
    }

    /// Whether there is a step to take back.
    #[must_use]
    pub fn can_undo(&self) -> bool {
        self.document.history.can_undo()
    }

    /// Whether there is a step to do again.
    #[must_use]
    pub fn can_redo(&self) -> bool {
        self.document.history.can_redo()
    }

    /// What is asked of the outside since the last call.
    pub fn take_requests(&mut self) -> Vec<Request> {
        std::mem::take(&mut self.requests)
    }

    /// The query string that restores this state, without `?`.
    #[must_use]
    pub fn query(&self) -> String {
        let query = link::write(&self.document.params);
        if self.would_set_up() {
            // The lab, which is named only where it is not the first one, says that there is a
            // state besides.
            format!("{query}&{}={}", Key::Lab.param().name, self.document.params.lab().word())
        } else {
            query
        }
    }

    /// Returns what the panes have of a choice: the values that are compared, or the one that is
    /// set.
    #[must_use]
    pub fn choices<C: Selected>(&self) -> Vec<C> {
        match self.compare().filter(|compare| compare.key == C::KEY) {
            Some(compare) => compare.values.iter().filter_map(Value::choice).collect(),
            None => vec![self.document.params.choice()],
        }
    }

    /// The comparison that is open.
    #[must_use]
    pub fn compare(&self) -> Option<Compare> {
        self.document.compare()
    }

    /// What is on the stage in the pane that stands for all where only one can: the first. As
    /// [`Pane::outcome`], it may be of earlier parameters.
    #[must_use]
    pub fn main_outcome(&self) -> Option<&Arc<Outcome>> {
        self.panes.first().and_then(|pane| pane.outcome.as_ref())
    }

    /// The duration of the longest result, of the clips that stand in for one that cannot be made,
    /// or of who plays along, seconds.
    #[must_use]
    pub fn duration_secs(&self) -> f64 {
        let results = self.panes.iter().filter_map(|pane| pane.outcome.as_ref());
        let sources = self.panes.iter().flat_map(|pane| &pane.sources);
        results
            .map(|outcome| outcome.duration_secs())
            .chain(sources.map(|source| source.motion.clip().duration_secs()))
            .chain(self.company.iter().filter_map(Companion::duration_secs))
            .fold(0.0, f64::max)
    }

    /// The playhead, seconds.
    #[must_use]
    pub fn now_secs(&self) -> f64 {
        self.driven_secs()
            .unwrap_or_else(|| self.document.params.number(Key::Time).min(self.duration_secs()))
    }

    /// The part that plays.
    #[must_use]
    pub fn span(&self) -> Span {
        Span::between(
            self.document.params.optional(Key::In),
            self.document.params.optional(Key::Out),
            self.duration_secs(),
        )
    }

    /// The character that is moved in place of bodies made around bones: the one of the clip that
    /// the parameter `character` names.
    #[must_use]
    pub fn character(&self) -> Option<Character> {
        self.document.library.find(self.document.params.text(Key::Character))?.character()
    }

    /// Why the chosen character is not to be seen, in a sentence: what is on the stage cannot move
    /// it. `None` where it can, or none is chosen.
    #[must_use]
    pub fn character_note(&self) -> Option<String> {
        let entry = self.document.library.find(self.document.params.text(Key::Character))?;
        let character = entry.character()?;
        let shown = self.panes.iter().filter_map(|pane| pane.outcome.as_ref());
        let mut motions = shown.map(|outcome| &outcome.motion);
        let moves =
            |motion: &Arc<Motion>| character.is_moved_by(motion.clip().skeleton(), motion.roles());
        let is_left_out = motions.any(|motion| !moves(motion));
        is_left_out.then(|| {
            format!(
                "{} cannot be moved by this clip: they have no limbs in common. The clip has a body of its own.",
                entry.name
            )
        })
    }

    /// The clip in a slot.
    #[must_use]
    pub fn slot(&self, slot: Slot) -> Option<&Arc<Entry>> {
        self.document.slot(slot)
    }

    /// Says something to the user.
    pub fn say(&mut self, level: Level, text: impl Into<Message>) {
        self.notices.say(level, text);
        self.revision += 1;
    }

    /// Tells the user something of a file or key.
    pub fn say_of(&mut self, level: Level, about: &str, text: impl Into<Message>) {
        self.notices.say_of(level, about, text);
        self.revision += 1;
    }

    /// Lets time pass: moves the playhead while playing. Says whether anything moved.
    pub fn tick(&mut self, dt_secs: f64) -> bool {
        let mut changed = self.notices.tick(dt_secs);
        if self.document.params.is_on(Key::Play)
            && self.drive_on(dt_secs * self.document.params.number(Key::Rate))
        {
            changed = true;
        } else if self.is_playing() && !self.is_own_drive() {
            let (span, before, rate) =
                (self.span(), self.now_secs(), self.document.params.number(Key::Rate));
            let (now, moving) =
                span.advance(before, dt_secs, rate, self.document.params.is_on(Key::Loop));
            let rounds = span.rounds(before, dt_secs, rate);
            if moving && rounds > 0 {
                self.come_round(rounds);
            }
            self.document.set_unchecked(Key::Time, Value::Number(now));
            if !moving {
                self.document.set_unchecked(Key::Play, Value::Switch(false));
                self.revision += 1;
            }
            changed = true;
        }
        let gait_secs = dt_secs * self.document.params.number(Key::Rate);
        self.glide(gait_secs) || changed
    }

    /// Whether time moves anything. Where nothing is there yet, playing is not over: what comes
    /// then plays.
    #[must_use]
    pub fn is_playing(&self) -> bool {
        self.document.params.is_on(Key::Play) && (self.is_driven() || self.duration_secs() > 0.0)
    }

    /// Carries a command out and recomputes what depends on it.
    ///
    /// # Errors
    /// [`CommandError`] says what does not fit; the document is then as it was.
    pub fn apply(&mut self, command: Command) -> Result<(), CommandError> {
        if let Command::Steer(control) = command {
            // Nothing that is shown depends on it until time passes.
            self.steer(control);
            return Ok(());
        }
        let mut held = Some(self.held());
        self.forget_failed_samples();
        match command {
            Command::Set(values) => self.set(values)?,
            Command::Reset(key) => {
                self.set(vec![(key, key.param().default_value())])?;
                self.document.settle();
            }
            Command::Settle => self.document.settle(),
            Command::OpenLink(query) => {
                self.document.remember(None);
                self.open_link(&query);
                held = None;
            }
            Command::Assign(slot, id) => {
                let id = self.document.assignable(id)?;
                self.set(vec![(slot.key(), Value::Text(id))])?;
                self.document.settle();
            }
            Command::LoadSamples(set) => self.load_samples(set),
            Command::Remove(id) => self.remove(&id)?,
            Command::Rename(id, name) => {
                self.document.rename(&id, &name)?;
            }
            Command::CorrectRole(id, role, joint) => self.correct_role(&id, role, joint)?,
            Command::Reimport(id, options) => self.reimport(&id, &options)?,
            Command::Keep(pane) => self.keep(pane)?,
            Command::Company(change) => self.change_company(change)?,
            Command::Steer(control) => self.steer(control),
            Command::RestartDrive => self.restart_driving(),
            Command::ReplayDrive => self.replay_driving()?,
            Command::Seek(_) if self.is_driven() => {}
            Command::Seek(secs) => {
                let to = if secs.is_finite() { secs.clamp(0.0, self.duration_secs()) } else { 0.0 };
                self.document.set_unchecked(Key::Time, Value::Number(to));
            }
            Command::Step(frames) => self.step(frames),
            Command::TogglePlay => {
                let playing = self.document.params.is_on(Key::Play);
                if !playing
                    && !self.document.params.is_on(Key::Loop)
                    && self.now_secs() >= self.span().end
                {
                    self.document.set_unchecked(Key::Time, Value::Number(self.span().start));
                }
                self.document.set_unchecked(Key::Play, Value::Switch(!playing));
            }
            Command::Compare(key) => {
                let full = self
                    .document
                    .params
                    .optional(key)
                    .or_else(|| self.automatic_value(key))
                    .unwrap_or_default();
                let compare = Compare::full_half_third(key, full, self.range_of(key))
                    .or_else(|| Compare::choices(key, self.document.params.get(key)))
                    .ok_or(CommandError::NotPossible(
                        "only a number or a choice of the lab can be compared",
                    ))?;
                self.set(vec![(Key::Compare, Value::Text(compare.to_string()))])?;
                self.document.settle();
            }
            Command::Try(query) => self.try_out(&query)?,
            Command::StopGraph(stop) => self.labs.grapher.stop(stop),
            Command::Undo | Command::Redo => {
                let undoes = matches!(command, Command::Undo);
                if if undoes { self.document.undo() } else { self.document.redo() } {
                    // What had not been read by then.
                    self.read_stored(Vec::new());
                }
            }
            Command::Dismiss(id) => self.notices.dismiss(id),
            Command::Mend(id) => self.mend(id),
            Command::StopReading(id) => self.stop_reading(id),
        }
        self.refresh();
        match held {
            Some(held) => self.go_on_from(&held),
            None => self.begin_anew(),
        }
        Ok(())
    }

    /// The value that Segue chose for a parameter that is left to it.
    #[must_use]
    pub fn automatic_value(&self, key: Key) -> Option<f64> {
        let outcome = self.main_outcome()?;
        let (transition, made) = (outcome.transition, outcome.cycle.map(|cycle| cycle.made));
        match (key, made) {
            (Key::Speed, Some(CycleMade::Gait { clips_mps, .. })) => {
                return Some(middle_mps(clips_mps));
            }
            (Key::LoopFrom, Some(CycleMade::Cut { from_secs, .. })) => return Some(from_secs),
            (Key::LoopTo, Some(CycleMade::Cut { to_secs, .. })) => return Some(to_secs),
            _ => {}
        }
        match key {
            Key::LeaveA => transition.map(|t| t.leave_a_secs),
            Key::EnterB => transition.map(|t| t.enter_b_secs),
            Key::MixFrameA => self.frame_in(Slot::A, transition?.leave_a_secs),
            Key::MixFrameB => self.frame_in(Slot::B, transition?.enter_b_secs),
            Key::GaitSpeed => {
                Some(f64::from(synth::Params::new(synth_action(&self.document.params)).speed_mps))
            }
            Key::WarpFrom => Some(outcome.registered()?.part_secs[0]),
            Key::WarpTo => Some(outcome.registered()?.part_secs[1]),
            Key::WarpSmoothing => Some((0.1 * outcome.motion.clip().fps()).round()),
            Key::Ground => Some(f64::from(outcome.motion.ground_m()) * 100.0),
            Key::PlaceX => Some(to_step(outcome.motion.standing_at(0.0).shift.x, 0.01)),
            Key::PlaceZ => Some(to_step(outcome.motion.standing_at(0.0).shift.y, 0.01)),
            Key::PlaceHeading => {
                Some(to_step(outcome.motion.standing_at(0.0).yaw.to_degrees(), 0.1))
            }
            Key::In => Some(0.0),
            Key::Out => Some(self.duration_secs()),
            _ => None,
        }
    }

    /// Whether the View lab shows its clip otherwise than it is: with its feet held, moved, or in
    /// place.
    #[must_use]
    pub fn view_is_changed(&self) -> bool {
        lab::of(self.document.params.lab()).shows_clip() && !is_as_it_is(&self.document.params)
    }

    /// The distances that the Register lab looks at: those of the first pane, newer ones where it
    /// has no result for them.
    #[must_use]
    pub fn distance_map(&self) -> Option<&Arc<DistanceMap>> {
        if !lab::of(self.document.params.lab()).has(Beside::DistanceMap) {
            return None;
        }
        let pane = self.panes.first()?;
        let shown = pane.outcome.as_ref().and_then(|outcome| outcome.registered());
        let shown = shown.map(|registered| &registered.map);
        shown.or_else(|| self.labs.registrars.last_map())
    }

    /// Pairs of frames of A and B, at A's rate, that must meet; none where they cannot be read.
    #[must_use]
    pub fn pins(&self) -> Vec<(usize, usize)> {
        read_pins(self.document.params.text(Key::Pins)).unwrap_or_default()
    }

    /// The weight of B over the course of a registered blend, in per cent of both; empty where it
    /// stays the same, or cannot be read.
    #[must_use]
    pub fn weight_keys(&self) -> Vec<(usize, usize)> {
        read_weights(self.document.params.text(Key::WarpCurve)).unwrap_or_default()
    }

    /// The further clips of a registered blend, with their weights; none where they cannot be read.
    #[must_use]
    pub fn also_blended(&self) -> Vec<(String, f64)> {
        self.document.also_blended()
    }

    /// The frame of a slot's clip at a time, at its own rate.
    fn frame_in(&self, slot: Slot, secs: f64) -> Option<f64> {
        let motion = self.slot(slot)?.motion.as_ref()?;
        Some((secs * motion.clip().fps()).round())
    }

    fn set(&mut self, values: Vec<(Key, Value)>) -> Result<(), CommandError> {
        let named: Vec<Key> = values.iter().map(|(key, _)| *key).collect();
        let changes = self.document.set(values)?;
        self.fetch(changes.new_sources);
        if changes.keys.iter().any(|key| key.param().group.is_of_lab()) {
            self.labs.grapher.stop(false);
        }
        if changes.keys.contains(&Key::Lesson) {
            self.lesson_was_set(named);
        }
        Ok(())
    }

    fn open_link(&mut self, query: &str) {
        let link = link::read(query);
        let mut params = Params::default();
        let named: Vec<Key> = link.values.iter().map(|(key, _)| *key).collect();
        // A language is the reader's own until a link names another one.
        params.copy_from(&self.document.params, Key::Lang);
        for (key, value) in link.values {
            let result = params.set(key, value);
            debug_assert!(result.is_ok(), "links hold checked values: {result:?}");
        }
        self.document.note_link(&named);
        self.take_over(params, &link.problems, &named);
        self.lesson_was_set(named);
    }

    /// Whether the link that was opened names this parameter, be it with its default.
    #[must_use]
    pub fn names(&self, key: Key) -> bool {
        self.document.link_names(key)
    }

    /// Whether the motion that Make is set to has that parameter: nobody who stands has a speed.
    #[must_use]
    pub fn made_motion_has(&self, key: Key) -> bool {
        made_motion_has(&self.document.params, key)
    }

    /// What of a number's range makes sense now, where that is less than the table says: the speeds
    /// and lengths of a made motion.
    #[must_use]
    pub fn range_of(&self, key: Key) -> Option<(f64, f64)> {
        range_of(&self.document.params, key)
    }

    fn fetch(&mut self, addresses: Vec<String>) {
        if addresses.len() > MOST_SOURCES {
            self.say(
                Level::Warning,
                msg!(
                    "The link names {count} files; the first {MOST_SOURCES} are loaded.",
                    count = addresses.len()
                ),
            );
        }
        for address in addresses.into_iter().take(MOST_SOURCES) {
            if address.starts_with("https://") || address.starts_with("http://") {
                self.requests.push(Request::Fetch(address));
            } else {
                self.say(
                    Level::Error,
                    msg!(
                        "src: found `{address}`, expected an address that starts with https://.",
                        address = outside::short(&address)
                    ),
                );
            }
        }
    }

    fn remove(&mut self, id: &str) -> Result<(), CommandError> {
        let name = self.document.remove(id)?;
        self.say(Level::Info, msg!("{name} was removed; undo brings it back."));
        Ok(())
    }

    fn correct_role(
        &mut self,
        id: &str,
        role: segue_motion::skeleton::Role,
        joint: Option<usize>,
    ) -> Result<(), CommandError> {
        let entry =
            self.document.library.find(id).ok_or_else(|| CommandError::NoClip(id.to_owned()))?;
        let motion =
            entry.motion.as_ref().ok_or(CommandError::NotPossible("the clip is not loaded yet"))?;
        if joint.is_some_and(|joint| joint >= motion.clip().skeleton().len()) {
            return Err(CommandError::NotPossible("the skeleton has no such joint"));
        }
        let mut roles = motion.roles().clone();
        roles.set(role, joint);
        let file = match &entry.origin {
            Origin::File(file) if file.is_large() || self.is_read_again(file) => Some(file.clone()),
            _ => None,
        };
        if let Some(file) = file {
            self.document.change_entry(id, |entry| entry.roles_by_hand = Some(roles))?;
            self.read_again(file, None);
            return Ok(());
        }
        let corrected = Arc::new(Motion::clone(motion).with_corrected_roles(&roles));
        self.document.change_entry(id, |entry| {
            entry.motion = Some(corrected);
            entry.roles_by_hand = Some(roles);
        })
    }

    /// Puts a pane's result into the library.
    fn keep(&mut self, pane: usize) -> Result<(), CommandError> {
        let made = self.pane(pane)?.recipe()?;
        let (params, outcome) =
            (self.with_recording(made.params.clone()), Arc::clone(made.outcome));
        if outcome.walk().is_some_and(|walk| walk.is_guided) {
            return Err(CommandError::NotPossible(
                "this walk goes like the one in the first pane: open it alone to keep it",
            ));
        }
        let is_whole = !outcome.awaits_feet() && !self.is_driven();
        let fps = [Slot::A, Slot::B].map(|slot| {
            let motion = self.slot(slot).and_then(|entry| entry.motion.as_ref());
            motion.map_or(1.0, |motion| motion.clip().fps())
        });
        let known = CommandError::NotPossible("this clip is in the library already");
        if lab::of(params.lab()).shows_clip() && is_as_it_is(&params) {
            return Err(known);
        }
        let id = recipe_id(&params, &outcome, fps).ok_or(CommandError::NotPossible(
            "what was found lies beyond what a link can say: use shorter clips",
        ))?;
        if self.document.library.find(&id).is_some() {
            return Err(known);
        }
        let recipe = recipe_params(&id).ok_or(CommandError::NotPossible(
            "it is made of results of results, more than a link can hold: save it as a file, and open that",
        ))?;
        let name = recipe_name(&recipe);
        let said = msg!("{name} is in the library now: choose it as A or B.");
        self.document.add(Entry {
            motion: is_whole.then(|| Arc::clone(&outcome.motion)),
            ..Entry::new(id, name, Origin::Made)
        });
        self.say(Level::Info, said);
        Ok(())
    }

    fn step(&mut self, frames: i64) {
        let Some(fps) = self.main_outcome().map(|outcome| outcome.motion.clip().fps()) else {
            return;
        };
        self.document.set_unchecked(Key::Play, Value::Switch(false));
        if self.is_driven() {
            // What was not yet asked for cannot be stepped back to.
            self.drive_ticks(frames.clamp(0, 60) as usize);
            return;
        }
        let frame = (self.now_secs() * fps).round() + frames as f64;
        let to = (frame / fps).clamp(0.0, self.duration_secs());
        self.document.set_unchecked(Key::Time, Value::Number(to));
    }

    /// Makes what is built in and was not needed yet: about 2 ms a clip.
    pub fn make_all(&mut self) {
        while self.make_next() {}
    }

    /// Everything that the API tells of the clips. What was not made or loaded yet has no frames.
    #[must_use]
    pub fn clip_infos(&self) -> Vec<ClipInfo> {
        self.document.library.entries().iter().map(|entry| clip_info(entry)).collect()
    }
}

/// A value in whole steps; never the zero below zero.
fn to_step(value: f64, step: f64) -> f64 {
    (value / step).round() * step + 0.0
}

fn clip_info(entry: &Entry) -> ClipInfo {
    let motion = entry.motion.as_deref();
    let clip = motion.map(segue_motion::clip::Motion::clip);
    ClipInfo {
        id: entry.id.clone(),
        name: entry.name.clone(),
        format: entry.format(),
        joints: clip.map_or(0, |clip| clip.skeleton().len()),
        frames: clip.map_or(0, |clip| clip.frames()),
        fps: clip.map_or(0.0, |clip| clip.fps()),
        duration: clip.map_or(0.0, |clip| clip.duration_secs()),
        height: motion.map_or(0.0, |motion| motion.roles().body_height(motion.clip().skeleton())),
        sha256: entry.sha256().map(str::to_owned),
    }
}

#[cfg(test)]
mod bundled_tests;
#[cfg(test)]
mod going_round_tests;
#[cfg(test)]
mod keep_tests;
#[cfg(test)]
mod loading_tests;
#[cfg(test)]
mod memory_tests;
#[cfg(test)]
mod metric_tests;
#[cfg(test)]
mod refusal_tests;
#[cfg(test)]
mod storing_tests;
#[cfg(test)]
mod teaching_tests;
#[cfg(test)]
mod tests;
