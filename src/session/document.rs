use super::command::{Command, CommandError, Request};
use super::compare::Compare;
use super::library::{Entry, Library, Origin, Sample, SourceFile, file_id, split_reference};
use super::motion::Motion;
use super::notice::{Level, Notices};
use super::params::{Group, Key, Params, Value};
use super::recipe::{
    BlendInputs, Blender, Outcome, Slot, made_id, made_motion, made_params, preset_motion,
    synth_action,
};
use super::saved::{Saved, SavedEntry};
use super::transport::Span;
use super::undo::History;
use super::{MAX_PANES, link};
use crate::formats::{self, ImportError, ImportOptions, Imported, import};
use crate::skeleton::Roles;
use crate::synth;
use sha2::{Digest as _, Sha256};
use std::sync::Arc;

/// The bundled takes.
static SAMPLES: [Sample; 4] = [
    Sample {
        id: "cmu_jump",
        label: "CMU 01_01 · forward jumps",
        file: "01_01.bvh.gz",
    },
    Sample {
        id: "cmu_climb",
        label: "CMU 01_03 · climb",
        file: "01_03.bvh.gz",
    },
    Sample {
        id: "cmu_run",
        label: "CMU · run",
        file: "run.bvh.gz",
    },
    Sample {
        id: "cmu_pirouette",
        label: "CMU · pirouette",
        file: "pirouette.bvh.gz",
    },
];

/// What the first visitor sees: the experiment of the course, running.
const WELCOME: &str = "compare=blend_window:30,15,10";

/// A link with this many clips to load is an accident.
const MOST_SOURCES: usize = 16;

/// One pane of the stage: a result under one value of the compared parameter.
#[derive(Clone, Debug)]
pub struct Pane {
    /// The compared parameter and this pane's value; `None` when there is nothing to compare.
    pub variant: Option<(Key, f64)>,
    /// The last good result.
    pub outcome: Option<Arc<Outcome>>,
    /// Why there is no newer one: what is missing and what to do.
    pub problem: Option<String>,
    inputs: Option<Inputs>,
}

/// What a result depends on. Equal inputs, equal result: nothing is computed again.
#[derive(Clone, Debug)]
enum Inputs {
    View(Arc<Motion>),
    Make(String),
    Blend(BlendInputs),
}

impl PartialEq for Inputs {
    fn eq(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::View(a), Self::View(b)) => Arc::ptr_eq(a, b),
            (Self::Make(a), Self::Make(b)) => a == b,
            (Self::Blend(a), Self::Blend(b)) => a == b,
            _ => false,
        }
    }
}

/// What a file gave.
#[derive(Clone, Debug, PartialEq)]
pub struct Loaded {
    /// The ids of its clips.
    pub ids: Vec<String>,
    /// What was odd in it, one sentence each.
    pub warnings: Vec<String>,
}

/// A clip as the page's API tells of it.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct ClipInfo {
    /// What links call it.
    pub id: String,
    /// What a person calls it.
    pub name: String,
    /// `bvh` or `synth`.
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
    params: Params,
    library: Library,
    history: History,
    notices: Notices,
    panes: Vec<Pane>,
    blender: Blender,
    requests: Vec<Request>,
    library_revision: u64,
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
        let mut session = Self {
            params: Params::default(),
            library: built_in_library(),
            history: History::default(),
            notices: Notices::default(),
            panes: Vec::new(),
            blender: Blender::default(),
            requests: Vec::new(),
            library_revision: 0,
            revision: 0,
        };
        session.open_link(WELCOME);
        session.refresh();
        session
    }

    /// The parameters.
    #[must_use]
    pub fn params(&self) -> &Params {
        &self.params
    }

    /// The library.
    #[must_use]
    pub fn library(&self) -> &Library {
        &self.library
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

    /// The bundled takes.
    #[must_use]
    pub fn samples() -> &'static [Sample] {
        &SAMPLES
    }

    /// Grows with every change of library content; tells storage when to save.
    #[must_use]
    pub fn library_revision(&self) -> u64 {
        self.library_revision
    }

    /// Grows with every change that anybody could see, except the playhead's.
    #[must_use]
    pub fn revision(&self) -> u64 {
        self.revision
    }

    /// Whether there is a step to take back.
    #[must_use]
    pub fn can_undo(&self) -> bool {
        self.history.can_undo()
    }

    /// Whether there is a step to do again.
    #[must_use]
    pub fn can_redo(&self) -> bool {
        self.history.can_redo()
    }

    /// What is asked of the outside since the last call.
    pub fn take_requests(&mut self) -> Vec<Request> {
        std::mem::take(&mut self.requests)
    }

    /// The query string that restores this state, without `?`.
    #[must_use]
    pub fn query(&self) -> String {
        link::write(&self.params)
    }

    /// The comparison that is open.
    #[must_use]
    pub fn compare(&self) -> Option<Compare> {
        Compare::parse(self.params.text(Key::Compare)).ok()
    }

    /// The pane that stands for all where only one can: the first.
    #[must_use]
    pub fn main_outcome(&self) -> Option<&Arc<Outcome>> {
        self.panes.first().and_then(|pane| pane.outcome.as_ref())
    }

    /// The longest result's duration, seconds.
    #[must_use]
    pub fn duration_secs(&self) -> f64 {
        self.panes
            .iter()
            .filter_map(|pane| pane.outcome.as_ref())
            .map(|outcome| outcome.duration_secs())
            .fold(0.0, f64::max)
    }

    /// The playhead, seconds.
    #[must_use]
    pub fn now_secs(&self) -> f64 {
        self.params.number(Key::Time).min(self.duration_secs())
    }

    /// The part that plays.
    #[must_use]
    pub fn span(&self) -> Span {
        Span::between(
            self.params.optional(Key::In),
            self.params.optional(Key::Out),
            self.duration_secs(),
        )
    }

    /// The clip in a slot.
    #[must_use]
    pub fn slot(&self, slot: Slot) -> Option<&Arc<Entry>> {
        self.library.find(self.params.text(slot_key(slot)))
    }

    /// Says something to the user.
    pub fn say(&mut self, level: Level, text: impl Into<String>) {
        self.notices.say(level, text);
        self.revision += 1;
    }

    /// Lets time pass: moves the playhead while playing. Says whether anything moved.
    pub fn tick(&mut self, dt_secs: f64) -> bool {
        let mut changed = self.notices.tick(dt_secs);
        if self.params.is_on(Key::Play) {
            let (now, moving) = self.span().advance(
                self.now_secs(),
                dt_secs,
                self.params.number(Key::Speed),
                self.params.is_on(Key::Loop),
            );
            self.set_unchecked(Key::Time, Value::Number(now));
            if !moving {
                self.set_unchecked(Key::Play, Value::Switch(false));
                self.revision += 1;
            }
            changed = true;
        }
        changed
    }

    /// Sets a value that is known to fit.
    fn set_unchecked(&mut self, key: Key, value: Value) {
        let result = self.params.set(key, value);
        debug_assert!(result.is_ok(), "{result:?}");
    }

    /// Carries a command out and recomputes what depends on it.
    ///
    /// # Errors
    /// [`CommandError`] says what does not fit; the document is then as it was.
    pub fn apply(&mut self, command: Command) -> Result<(), CommandError> {
        match command {
            Command::Set(values) => self.set(values)?,
            Command::Reset(key) => {
                self.set(vec![(key, key.param().default_value())])?;
                self.history.settle();
            }
            Command::Settle => self.history.settle(),
            Command::OpenLink(query) => {
                self.remember(None);
                self.open_link(&query);
            }
            Command::Assign(slot, id) => {
                let id = self
                    .library
                    .find(&id)
                    .ok_or(CommandError::NoClip(id))?
                    .id
                    .clone();
                self.set(vec![(slot_key(slot), Value::Text(id))])?;
                self.history.settle();
            }
            Command::Remove(id) => self.remove(&id)?,
            Command::Rename(id, name) => {
                let name = name.trim().to_owned();
                if name.is_empty() {
                    return Err(CommandError::NotPossible("a clip needs a name"));
                }
                self.change_entry(&id, |entry| entry.name = name)?;
            }
            Command::CorrectRole(id, role, joint) => self.correct_role(&id, role, joint)?,
            Command::Reimport(id, options) => self.reimport(&id, &options)?,
            Command::KeepMade => self.keep_made()?,
            Command::Seek(secs) => {
                let to = if secs.is_finite() {
                    secs.clamp(0.0, self.duration_secs())
                } else {
                    0.0
                };
                self.set_unchecked(Key::Time, Value::Number(to));
            }
            Command::Step(frames) => self.step(frames),
            Command::TogglePlay => {
                let playing = self.params.is_on(Key::Play);
                if !playing && !self.params.is_on(Key::Loop) && self.now_secs() >= self.span().end {
                    self.set_unchecked(Key::Time, Value::Number(self.span().start));
                }
                self.set_unchecked(Key::Play, Value::Switch(!playing));
            }
            Command::CompareThirds(key) => {
                let full = self
                    .params
                    .optional(key)
                    .or_else(|| self.automatic_value(key))
                    .unwrap_or_default();
                let compare = Compare::full_half_third(key, full).ok_or(
                    CommandError::NotPossible("only a number of the lab can be compared"),
                )?;
                self.set(vec![(Key::Compare, Value::Text(compare.to_string()))])?;
                self.history.settle();
            }
            Command::Undo => {
                if self.history.undo(&mut self.params, &mut self.library) {
                    self.library_revision += 1;
                }
            }
            Command::Redo => {
                if self.history.redo(&mut self.params, &mut self.library) {
                    self.library_revision += 1;
                }
            }
            Command::Dismiss(id) => self.notices.dismiss(id),
        }
        self.refresh();
        Ok(())
    }

    /// The value that Segue chose for a parameter that is left to it.
    #[must_use]
    pub fn automatic_value(&self, key: Key) -> Option<f64> {
        let transition = self.main_outcome()?.transition;
        match key {
            Key::LeaveA => transition.map(|t| t.leave_a_secs),
            Key::EnterB => transition.map(|t| t.enter_b_secs),
            Key::GaitSpeed => Some(f64::from(
                synth::Params::new(synth_action(&self.params)).speed_mps,
            )),
            Key::In => Some(0.0),
            Key::Out => Some(self.duration_secs()),
            _ => None,
        }
    }

    fn remember(&mut self, key: Option<Key>) {
        self.history.before_change(&self.params, &self.library, key);
    }

    fn set(&mut self, values: Vec<(Key, Value)>) -> Result<(), CommandError> {
        let mut params = self.params.clone();
        let mut changed = Vec::new();
        for (key, value) in values {
            if params.set(key, value)? {
                changed.push(key);
            }
        }
        let mut undoable = changed
            .iter()
            .copied()
            .filter(|key| key.param().group.is_undoable());
        if let Some(first) = undoable.next() {
            // A slider that is dragged changes one parameter again and again: one step.
            let alone = undoable.next().is_none();
            self.remember(alone.then_some(first));
        }
        self.params = params;
        if changed.contains(&Key::Src) {
            self.fetch_sources();
        }
        if changed.iter().any(|key| matches!(key, Key::A | Key::B)) {
            self.library_revision += 1;
        }
        Ok(())
    }

    fn open_link(&mut self, query: &str) {
        let link = link::read(query);
        let mut params = Params::default();
        for (key, value) in link.values {
            let result = params.set(key, value);
            debug_assert!(result.is_ok(), "links hold checked values: {result:?}");
        }
        let sources_changed = params.text(Key::Src) != self.params.text(Key::Src);
        self.params = params;
        if !link.problems.is_empty() {
            self.say(
                Level::Warning,
                format!(
                    "The link was used, but for this: {}.",
                    link.problems.join("; ")
                ),
            );
        }
        if sources_changed {
            self.fetch_sources();
        }
        for slot in [Slot::A, Slot::B] {
            if let Some(text) = self.missing(slot) {
                self.say(Level::Warning, text);
            }
        }
    }

    fn fetch_sources(&mut self) {
        let addresses: Vec<String> = self
            .params
            .text(Key::Src)
            .split_whitespace()
            .map(str::to_owned)
            .collect();
        if addresses.len() > MOST_SOURCES {
            self.say(
                Level::Warning,
                format!(
                    "The link names {} files; the first {MOST_SOURCES} are loaded.",
                    addresses.len()
                ),
            );
        }
        for address in addresses.into_iter().take(MOST_SOURCES) {
            if address.starts_with("https://") || address.starts_with("http://") {
                self.requests.push(Request::Fetch(address));
            } else {
                self.say(
                    Level::Error,
                    format!(
                        "src: found `{address}`, expected an address that starts with https://."
                    ),
                );
            }
        }
    }

    /// What to tell who opened a link to a clip that is not here; `None` when it is, or when Segue can bring it.
    fn missing(&mut self, slot: Slot) -> Option<String> {
        let reference = self.params.text(slot_key(slot)).to_owned();
        if reference.is_empty() || self.bring(&reference) {
            return None;
        }
        let (name, sha, _) = split_reference(&reference);
        Some(if sha.is_empty() {
            format!(
                "{} is `{name}`, which is not here: drop that file, or choose another clip.",
                slot.label()
            )
        } else {
            format!(
                "{} is `{name}` (SHA-256 {sha}…), which is not here: drop that file to complete the link.",
                slot.label()
            )
        })
    }

    /// Whether the clip is in the library, or can be made from its id.
    fn bring(&mut self, reference: &str) -> bool {
        if self.library.find(reference).is_some() {
            return true;
        }
        let made = made_params(reference).is_some();
        if made {
            self.library.put(Entry {
                id: reference.to_owned(),
                name: reference.to_owned(),
                origin: Origin::Made,
                motion: None,
                warnings: Vec::new(),
                roles_by_hand: None,
            });
            self.library_revision += 1;
        }
        made
    }

    fn change_entry(
        &mut self,
        id: &str,
        change: impl FnOnce(&mut Entry),
    ) -> Result<(), CommandError> {
        if self.library.find(id).is_none() {
            return Err(CommandError::NoClip(id.to_owned()));
        }
        self.remember(None);
        self.library.change(id, change);
        self.library_revision += 1;
        Ok(())
    }

    fn remove(&mut self, id: &str) -> Result<(), CommandError> {
        let entry = Arc::clone(
            self.library
                .find(id)
                .ok_or_else(|| CommandError::NoClip(id.to_owned()))?,
        );
        self.remember(None);
        self.library.remove(&entry.id);
        self.library_revision += 1;
        // A slot that held the clip takes the first one that the other slot does not hold.
        for slot in [Slot::A, Slot::B] {
            let key = slot_key(slot);
            if self.params.text(key) != entry.id {
                continue;
            }
            let other = self
                .params
                .text(if slot == Slot::A { Key::B } else { Key::A })
                .to_owned();
            let entries = self.library.entries();
            let next = entries
                .iter()
                .find(|e| e.id != other && e.motion.is_some())
                .or_else(|| entries.first());
            let next = next.map(|e| e.id.clone()).unwrap_or_default();
            self.set_unchecked(key, Value::Text(next));
        }
        self.say(
            Level::Info,
            format!("{} was removed; undo brings it back.", entry.name),
        );
        Ok(())
    }

    fn correct_role(
        &mut self,
        id: &str,
        role: crate::skeleton::Role,
        joint: Option<usize>,
    ) -> Result<(), CommandError> {
        let entry = self
            .library
            .find(id)
            .ok_or_else(|| CommandError::NoClip(id.to_owned()))?;
        let motion = entry
            .motion
            .as_ref()
            .ok_or(CommandError::NotPossible("the clip is not loaded yet"))?;
        if joint.is_some_and(|joint| joint >= motion.clip.skeleton().len()) {
            return Err(CommandError::NotPossible("the skeleton has no such joint"));
        }
        let mut roles = motion.roles.clone();
        roles.set(role, joint);
        let corrected = Arc::new(Motion::analyze((*motion.clip).clone(), Some(roles.clone())));
        self.change_entry(id, |entry| {
            entry.motion = Some(corrected);
            entry.roles_by_hand = Some(roles);
        })
    }

    fn reimport(&mut self, id: &str, options: &ImportOptions) -> Result<(), CommandError> {
        let entry = Arc::clone(
            self.library
                .find(id)
                .ok_or_else(|| CommandError::NoClip(id.to_owned()))?,
        );
        let Origin::File(file) = &entry.origin else {
            return Err(CommandError::NotPossible(
                "only a clip that came from a file can be read again",
            ));
        };
        let imported = import(&file.name, &file.bytes, options)?;
        let warnings = imported.warnings.iter().map(ToString::to_string).collect();
        let clip = imported
            .clips
            .into_iter()
            .nth(file.index)
            .ok_or(CommandError::NotPossible("the file has no such character"))?;
        let motion = Arc::new(Motion::analyze(clip.clip, entry.roles_by_hand.clone()));
        let file = SourceFile {
            options: options.clone(),
            ..file.clone()
        };
        self.change_entry(id, |entry| {
            entry.origin = Origin::File(file);
            entry.motion = Some(motion);
            entry.warnings = warnings;
        })
    }

    fn keep_made(&mut self) -> Result<(), CommandError> {
        let id = made_id(&self.params);
        if self.library.find(&id).is_some() {
            return Err(CommandError::NotPossible(
                "this clip is in the library already",
            ));
        }
        let motion = made_motion(&self.params)
            .map_err(|_| CommandError::NotPossible("there is no clip to keep"))?;
        self.remember(None);
        self.library.put(Entry {
            name: id.clone(),
            id,
            origin: Origin::Made,
            motion: Some(Arc::new(motion)),
            warnings: Vec::new(),
            roles_by_hand: None,
        });
        self.library_revision += 1;
        Ok(())
    }

    fn step(&mut self, frames: i64) {
        let Some(fps) = self.main_outcome().map(|outcome| outcome.motion.clip.fps()) else {
            return;
        };
        let frame = (self.now_secs() * fps).round() + frames as f64;
        self.set_unchecked(Key::Play, Value::Switch(false));
        let to = (frame / fps).clamp(0.0, self.duration_secs());
        self.set_unchecked(Key::Time, Value::Number(to));
    }

    /// Reads one file, exactly as if it were dropped on the page: its clips join the library, and the first ones take the places of
    /// built-in clips in A and B.
    ///
    /// # Errors
    /// [`ImportError`] with name, line, column, found and expected; nothing already loaded changes.
    pub fn load(&mut self, name: &str, bytes: Arc<[u8]>) -> Result<Loaded, ImportError> {
        let options = ImportOptions::default();
        let imported = match import(name, &bytes, &options) {
            Ok(imported) => imported,
            Err(error) => {
                self.say(Level::Error, error.to_string());
                return Err(error);
            }
        };
        self.remember(None);
        let sha256 = sha256_hex(&bytes);
        let (entries, warnings) = file_entries(name, &sha256, &bytes, &options, imported, None);
        let mut ids = Vec::new();
        for entry in entries {
            let id = entry.id.clone();
            let awaited = [Slot::A, Slot::B]
                .into_iter()
                .any(|slot| self.slot(slot).is_none());
            self.library.put(entry);
            if !(awaited
                && [Slot::A, Slot::B]
                    .into_iter()
                    .any(|slot| self.slot(slot).is_some_and(|entry| entry.id == id)))
            {
                self.offer(&id);
            }
            ids.push(id);
        }
        self.history.settle();
        self.library_revision += 1;
        let what = if warnings.is_empty() {
            String::new()
        } else {
            format!(" {}", warnings.join(" "))
        };
        self.say(
            if warnings.is_empty() {
                Level::Info
            } else {
                Level::Warning
            },
            format!("{name} is in the library.{what}"),
        );
        self.refresh();
        Ok(Loaded { ids, warnings })
    }

    /// Puts a clip that just came into the slot where a user expects it: what is looked at in View; else A, then B, as long as
    /// they hold clips that nobody brought.
    fn offer(&mut self, id: &str) {
        let brought = |session: &Self, slot| {
            session
                .slot(slot)
                .is_some_and(|entry| matches!(entry.origin, Origin::File(_)) && entry.id != id)
        };
        let slot = if self.params.text(Key::Lab) == "view" || !brought(self, Slot::A) {
            Slot::A
        } else if !brought(self, Slot::B) {
            Slot::B
        } else {
            return;
        };
        if self.slot(Slot::A).is_some_and(|entry| entry.id == id)
            || self.slot(Slot::B).is_some_and(|entry| entry.id == id)
        {
            return;
        }
        self.set_unchecked(slot_key(slot), Value::Text(id.to_owned()));
        // Times of the clip that was there mean nothing in this one.
        for key in [Key::LeaveA, Key::EnterB, Key::In, Key::Out] {
            self.set_unchecked(key, Value::Auto);
        }
    }

    /// Takes a bundled take that was asked for with [`Request::Sample`]; `packed` is its gzip file.
    ///
    /// # Errors
    /// [`ImportError`] when it is damaged.
    pub fn load_sample(
        &mut self,
        sample: &'static Sample,
        packed: &[u8],
    ) -> Result<(), ImportError> {
        let bytes = formats::unpack_gzip(sample.file, packed)?;
        let imported = import(
            sample.file.trim_end_matches(".gz"),
            &bytes,
            &ImportOptions::default(),
        )?;
        let warnings: Vec<String> = imported.warnings.iter().map(ToString::to_string).collect();
        if let Some(clip) = imported.clips.into_iter().next() {
            let motion = Arc::new(Motion::analyze(clip.clip, None));
            self.library.change(sample.id, |entry| {
                entry.motion = Some(motion);
                entry.warnings = warnings;
            });
        }
        self.refresh();
        Ok(())
    }

    /// What is stored of the work.
    #[must_use]
    pub fn saved(&self) -> Saved {
        Saved {
            query: self.query(),
            entries: self
                .library
                .entries()
                .iter()
                .map(|entry| SavedEntry::from(&**entry))
                .collect(),
        }
    }

    /// Brings stored work back; `bytes_of` gives a file's bytes by its SHA-256. Files that are gone or no longer read are named in a notice.
    /// The parameters come from `query` when there is one (a link was opened), else from what was stored.
    pub fn restore(
        &mut self,
        saved: &Saved,
        bytes_of: impl Fn(&str) -> Option<Arc<[u8]>>,
        query: Option<&str>,
    ) {
        let mut lost = Vec::new();
        let mut library = Library::default();
        for stored in &saved.entries {
            match &stored.file {
                None => {
                    if let Some(entry) = self.library.find(&stored.id) {
                        library.put(Entry {
                            name: stored.name.clone(),
                            ..(**entry).clone()
                        });
                    } else if made_params(&stored.id).is_some() {
                        library.put(Entry {
                            id: stored.id.clone(),
                            name: stored.name.clone(),
                            origin: Origin::Made,
                            motion: None,
                            warnings: Vec::new(),
                            roles_by_hand: None,
                        });
                    }
                }
                Some(file) => {
                    let imported = bytes_of(&file.sha256)
                        .map(|bytes| (import(&file.name, &bytes, &file.options), bytes));
                    let Some((Ok(imported), bytes)) = imported else {
                        lost.push(file.name.clone());
                        continue;
                    };
                    let (entries, _) = file_entries(
                        &file.name,
                        &file.sha256,
                        &bytes,
                        &file.options,
                        imported,
                        stored.roles.as_ref(),
                    );
                    for entry in entries.into_iter().filter(|entry| entry.id == stored.id) {
                        library.put(Entry {
                            name: stored.name.clone(),
                            ..entry
                        });
                    }
                }
            }
        }
        if !library.entries().is_empty() {
            self.library = library;
        }
        if !lost.is_empty() {
            self.say(
                Level::Warning,
                format!(
                    "Not found in this browser's storage any more: {}. Drop them again.",
                    lost.join(", ")
                ),
            );
        }
        self.open_link(query.unwrap_or(&saved.query));
        self.history = History::default();
        self.refresh();
    }

    /// Everything that the API tells of the clips.
    #[must_use]
    pub fn clip_infos(&self) -> Vec<ClipInfo> {
        self.library
            .entries()
            .iter()
            .map(|entry| clip_info(entry))
            .collect()
    }

    /// One slice of the work that is left over when a change would take longer than a frame. `true` while there is more.
    pub fn work(&mut self) -> bool {
        if self.blender.work() {
            if !self.blender.is_searching() {
                self.refresh();
            }
            return true;
        }
        // Presets are made ahead, one a slice, so that the library can tell what they are.
        let next = self.library.entries().iter().find(|entry| {
            entry.motion.is_none() && matches!(entry.origin, Origin::Preset | Origin::Made)
        });
        let Some(id) = next.map(|entry| entry.id.clone()) else {
            return false;
        };
        self.motion_of(&id).is_ok()
    }

    /// What is under way, by name, with its progress from 0 to 1.
    #[must_use]
    pub fn jobs(&self) -> Vec<(&'static str, f32)> {
        self.blender
            .progress()
            .map(|progress| ("matching", progress))
            .into_iter()
            .collect()
    }

    /// The motion of a clip: made or asked for when it is not there yet.
    fn motion_of(&mut self, reference: &str) -> Result<Arc<Motion>, String> {
        let Some(entry) = self.library.find(reference) else {
            return Err(format!(
                "`{}` is not here: drop its file, or choose another clip.",
                split_reference(reference).0
            ));
        };
        if let Some(motion) = &entry.motion {
            return Ok(Arc::clone(motion));
        }
        let id = entry.id.clone();
        let motion = match &entry.origin {
            Origin::Sample(sample) => {
                let request = Request::Sample(sample);
                if !self.requests.contains(&request) {
                    self.requests.push(request);
                }
                return Err(format!("{} is being loaded.", sample.label));
            }
            Origin::Preset => Arc::new(preset_motion(&id)?),
            Origin::Made => {
                let params = made_params(&id).ok_or_else(|| format!("`{id}` names no motion."))?;
                Arc::new(made_motion(&params)?)
            }
            Origin::File(_) => return Err(format!("`{id}` could not be read.")),
        };
        self.library
            .change(&id, |entry| entry.motion = Some(Arc::clone(&motion)));
        self.revision += 1;
        Ok(motion)
    }

    /// Recomputes the panes whose inputs have changed.
    fn refresh(&mut self) {
        self.revision += 1;
        let compare = self
            .compare()
            .filter(|compare| lab_of(&self.params) == Some(compare.key.param().group));
        let variants: Vec<Option<(Key, f64)>> = match &compare {
            Some(compare) => compare
                .values
                .iter()
                .take(MAX_PANES)
                .map(|&value| Some((compare.key, value)))
                .collect(),
            None => vec![None],
        };
        let mut old = std::mem::take(&mut self.panes).into_iter();
        let match_window = widest_window(&self.params, compare.as_ref());
        for variant in variants {
            let mut pane = old.next().unwrap_or(Pane {
                variant,
                outcome: None,
                problem: None,
                inputs: None,
            });
            pane.variant = variant;
            let mut params = self.params.clone();
            if let Some((key, value)) = variant {
                let result = params.set(key, Value::Number(value));
                debug_assert!(result.is_ok(), "compare holds checked values: {result:?}");
            }
            self.refresh_pane(&mut pane, &params, match_window);
            self.panes.push(pane);
        }
    }

    fn refresh_pane(&mut self, pane: &mut Pane, params: &Params, match_window: usize) {
        let inputs = match params.text(Key::Lab) {
            "view" => self.motion_of(params.text(Key::A)).map(Inputs::View),
            "make" => Ok(Inputs::Make(made_id(params))),
            _ => self.motion_of(params.text(Key::A)).and_then(|a| {
                let b = self.motion_of(params.text(Key::B))?;
                Ok(Inputs::Blend(BlendInputs::new(a, b, params, match_window)))
            }),
        };
        match inputs {
            Ok(inputs) if pane.inputs.as_ref() == Some(&inputs) && !self.blender.has_news() => {}
            Ok(inputs) => {
                let outcome = match &inputs {
                    Inputs::View(motion) => Ok(Outcome::plain(Arc::clone(motion))),
                    Inputs::Make(_) => {
                        made_motion(params).map(|motion| Outcome::plain(Arc::new(motion)))
                    }
                    Inputs::Blend(blend) => self.blender.run(blend),
                };
                match outcome {
                    Ok(outcome) => {
                        pane.outcome = Some(Arc::new(outcome));
                        pane.problem = None;
                        pane.inputs = Some(inputs);
                    }
                    Err(problem) => {
                        pane.problem = Some(problem);
                        pane.inputs = None;
                    }
                }
            }
            Err(problem) => {
                pane.problem = Some(problem);
                pane.inputs = None;
            }
        }
    }
}

/// The key that says what a slot holds.
fn slot_key(slot: Slot) -> Key {
    match slot {
        Slot::A => Key::A,
        Slot::B => Key::B,
    }
}

/// The group of parameters of the lab that is open.
fn lab_of(params: &Params) -> Option<Group> {
    match params.text(Key::Lab) {
        "view" => Some(Group::View),
        "make" => Some(Group::Make),
        "blend" => Some(Group::Blend),
        _ => None,
    }
}

/// The window that the automatic match uses: one for all panes, so that they differ in the compared value alone.
fn widest_window(params: &Params, compare: Option<&Compare>) -> usize {
    let windows = compare
        .filter(|compare| compare.key == Key::BlendWindow)
        .map(|compare| compare.values.as_slice());
    let widest = windows.unwrap_or(&[]).iter().copied().fold(0.0, f64::max);
    if widest > 0.0 {
        widest as usize
    } else {
        params.number(Key::BlendWindow) as usize
    }
}

fn built_in_library() -> Library {
    let mut library = Library::default();
    let presets = synth::presets().into_iter().map(|preset| {
        (
            preset.id.to_owned(),
            preset.title.to_owned(),
            Origin::Preset,
        )
    });
    let samples = SAMPLES.iter().map(|sample| {
        (
            sample.id.to_owned(),
            sample.label.to_owned(),
            Origin::Sample(sample),
        )
    });
    for (id, name, origin) in presets.chain(samples) {
        library.put(Entry {
            id,
            name,
            origin,
            motion: None,
            warnings: Vec::new(),
            roles_by_hand: None,
        });
    }
    library
}

/// An entry for every clip of a file, and the file's warnings.
fn file_entries(
    name: &str,
    sha256: &str,
    bytes: &Arc<[u8]>,
    options: &ImportOptions,
    imported: Imported,
    roles: Option<&Roles>,
) -> (Vec<Entry>, Vec<String>) {
    let warnings: Vec<String> = imported.warnings.iter().map(ToString::to_string).collect();
    let entry = |(index, clip): (usize, crate::formats::ImportedClip)| Entry {
        id: file_id(name, sha256, index),
        name: clip.clip.name().to_owned(),
        origin: Origin::File(SourceFile {
            name: name.to_owned(),
            sha256: sha256.to_owned(),
            bytes: Arc::clone(bytes),
            index,
            options: options.clone(),
        }),
        motion: Some(Arc::new(Motion::analyze(clip.clip, roles.cloned()))),
        warnings: warnings.clone(),
        roles_by_hand: roles.cloned(),
    };
    (
        imported.clips.into_iter().enumerate().map(entry).collect(),
        warnings,
    )
}

fn clip_info(entry: &Entry) -> ClipInfo {
    let motion = entry.motion.as_deref();
    let clip = motion.map(|motion| &motion.clip);
    ClipInfo {
        id: entry.id.clone(),
        name: entry.name.clone(),
        format: entry.format(),
        joints: clip.map_or(0, |clip| clip.skeleton().len()),
        frames: clip.map_or(0, |clip| clip.frames()),
        fps: clip.map_or(0.0, |clip| clip.fps()),
        duration: clip.map_or(0.0, |clip| clip.duration_secs()),
        height: motion.map_or(0.0, |motion| {
            motion.roles.body_height(motion.clip.skeleton())
        }),
        sha256: entry.sha256().map(str::to_owned),
    }
}

fn sha256_hex(bytes: &[u8]) -> String {
    use std::fmt::Write as _;
    Sha256::digest(bytes)
        .iter()
        .fold(String::with_capacity(64), |mut hex, byte| {
            // Writing to a string cannot fail.
            write!(hex, "{byte:02x}").ok();
            hex
        })
}
