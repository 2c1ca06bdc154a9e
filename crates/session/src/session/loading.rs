//! Files into the library.

use super::{Job, Session};
use crate::command::{CommandError, Request};
use crate::document::Arrival;
use crate::labs::JobKind;
use crate::library::{Entry, Origin, SourceFile, file_id, file_stem};
use crate::notice::Level;
use crate::outside;
use crate::params::{Key, Value};
use crate::reading::{Companion, Content, LARGE_BYTES, ReadFile, ReadReport, ReadSetup, ReadTask};
use crate::samples::Sample;
use segue_formats::{FileKind, ImportError, ImportOptions, acclaim};
use segue_text::{Message, ToMessage, msg};
use std::collections::BTreeMap;
use std::sync::Arc;

/// What a file gave.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Loaded {
    /// The ids of its clips.
    pub ids: Vec<String>,
    /// What was odd in it, one sentence each.
    pub warnings: Vec<Message>,
}

/// Of the files of an archive that are not read, so many are told one by one.
pub(super) const MOST_FAILURES: usize = 3;
/// Of what was odd in files, so much is told when they come.
const MOST_REMARKS: usize = 6;

/// A file that is being read elsewhere.
#[derive(Debug)]
pub(super) struct Reading {
    task: ReadTask,
    done: u64,
    purpose: Purpose,
}

/// What becomes of what a file gave.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Purpose {
    /// Its clips join the library.
    New(Arrival),
    /// Its clips are there already, and only want their motion. Those that waited for a skeleton,
    /// which has come so, are offered A and B.
    Again(Option<Arrival>),
    /// It is the motion of a bundled take.
    Sample(&'static Sample),
}

impl Reading {
    fn is_small(&self) -> bool {
        self.task.size <= LARGE_BYTES || matches!(self.purpose, Purpose::Sample(_))
    }

    fn is_new(&self) -> bool {
        matches!(self.purpose, Purpose::New(_))
    }
}

impl Session {
    /// Reads one file, exactly as if it were dropped on the page: its clips join the library, and
    /// the first ones take the places of built-in clips in A and B. It is read at once, unless it
    /// is larger than [`LARGE_BYTES`] or the session has all files read elsewhere: then it is asked
    /// for with [`Request::Read`], nothing is loaded yet, and what is wrong with it is told when it
    /// was read.
    ///
    /// # Errors
    /// [`ImportError`] with name, line, column, found and expected; nothing already loaded changes.
    pub fn load(&mut self, name: &str, bytes: Arc<[u8]>) -> Result<Loaded, ImportError> {
        self.load_that_came(name, bytes, Arrival::ByHand)
    }

    /// Reads a file that was fetched from an address in the link: as [`Session::load`], but where
    /// the link names a clip for a slot, that one stays, and a file that is in the library already
    /// takes no slot.
    ///
    /// # Errors
    /// As [`Session::load`].
    pub fn load_fetched(&mut self, name: &str, bytes: Arc<[u8]>) -> Result<Loaded, ImportError> {
        self.load_that_came(name, bytes, Arrival::ByLink)
    }

    fn load_that_came(
        &mut self,
        name: &str,
        bytes: Arc<[u8]>,
        came: Arrival,
    ) -> Result<Loaded, ImportError> {
        let (name, setup, size) =
            (&outside::file_name(name), self.setup_for_new(), bytes.len() as u64);
        let Some(read) = self.reads.filter(|_| size <= LARGE_BYTES) else {
            self.begin(name, Content::Here(bytes), size, setup, Purpose::New(came));
            return Ok(Loaded::default());
        };
        let report = read(name, &bytes, &setup, &mut |_| true).unwrap_or_default();
        self.admit(report, &Content::Here(bytes), &setup, came)
    }

    /// Asks for a file to be read elsewhere ([`Request::Read`]) and joined to the library then, as
    /// by [`Session::load`]. Returns the task's number.
    pub fn begin_reading(&mut self, name: &str, content: Content, size: u64) -> u64 {
        let setup = self.setup_for_new();
        self.begin(name, content, size, setup, Purpose::New(Arrival::ByHand))
    }

    /// As [`Session::begin_reading`], for a file that was fetched: its clips join the library as by
    /// [`Session::load_fetched`].
    pub fn begin_reading_fetched(&mut self, name: &str, content: Content, size: u64) -> u64 {
        let setup = self.setup_for_new();
        self.begin(name, content, size, setup, Purpose::New(Arrival::ByLink))
    }

    pub(super) fn begin(
        &mut self,
        name: &str,
        content: Content,
        size: u64,
        setup: ReadSetup,
        purpose: Purpose,
    ) -> u64 {
        self.tasks += 1;
        let task =
            ReadTask { id: self.tasks, name: outside::file_name(name), content, size, setup };
        self.ask(task, purpose);
        self.tasks
    }

    fn ask(&mut self, task: ReadTask, purpose: Purpose) {
        self.requests.push(Request::Read(task.clone()));
        self.reading.push(Reading { task, done: 0, purpose });
        self.revision += 1;
    }

    /// Has a file of the library read anew elsewhere, as its entries say, unless that is under way.
    /// `came`: see [`Purpose::Again`].
    pub(super) fn read_again(&mut self, file: SourceFile, came: Option<Arrival>) {
        let setup = self.setup_of(&file);
        let same = |reading: &Reading| {
            reading.task.setup == setup
                && reading.task.name == file.name
                && reading.task.content == file.content
        };
        if !self.reading.iter().any(same) {
            self.mark_unread(&file.sha256, None);
            self.begin(&file.name, file.content, file.size, setup, Purpose::Again(came));
        }
    }

    /// Whether it is being read with what was said of it before.
    pub(super) fn is_read_again(&self, file: &SourceFile) -> bool {
        let sha256 = Some(file.sha256.as_str());
        self.reading.iter().any(|reading| reading.task.setup.sha256.as_deref() == sha256)
    }

    fn roles_by_hand(&self, file: &SourceFile) -> BTreeMap<usize, segue_motion::skeleton::Roles> {
        let entries =
            self.document.library.entries().iter().filter_map(|entry| match &entry.origin {
                Origin::File(own) if own.sha256 == file.sha256 => {
                    Some((own.index, entry.roles_by_hand.clone()?))
                }
                _ => None,
            });
        entries.collect()
    }

    /// So many bytes of a task's file are read.
    pub fn progress_reading(&mut self, task: u64, done: u64) {
        if let Some(reading) = self.reading.iter_mut().find(|reading| reading.task.id == task) {
            reading.done = done;
            self.revision += 1;
        }
    }

    /// The key of the file that a task reads, where its bytes lie outside.
    #[must_use]
    pub fn reading_key(&self, task: u64) -> Option<&str> {
        let reading = self.reading.iter().find(|reading| reading.task.id == task)?;
        match &reading.task.content {
            Content::Outside(key) => Some(key),
            Content::Here(_) => None,
        }
    }

    /// Takes what reading a file gave, or why it could not be read at all. `None` where nobody
    /// waits for it any longer.
    pub fn finish_reading(
        &mut self,
        task: u64,
        report: Result<ReadReport, Message>,
    ) -> Option<Result<Loaded, Message>> {
        let report = match report {
            Ok(report) => report,
            Err(reason) => {
                let (name, _) = self.file_of_task(task)?;
                let name = name.to_owned();
                let text = msg!("{name} could not be read: {reason}.");
                return self.fail_reading(task, reason, text);
            }
        };
        let Reading { task, purpose, .. } = self.end_task(task)?;
        // What lies outside is from now on known by what it holds.
        let content = match (task.content.clone(), report.files.as_slice()) {
            (Content::Outside(_), [file]) if report.is_one_file() => {
                Content::Outside(file.sha256.clone())
            }
            (content, _) => content,
        };
        let loaded = match purpose {
            Purpose::Again(came) => {
                let waiting: Vec<String> = (self.document.library.entries().iter())
                    .filter(|entry| entry.awaits_skeleton())
                    .map(|entry| entry.id.clone())
                    .collect();
                let refilled = self.refill(report, &task.setup.options);
                if let Err(error) = &refilled {
                    self.mark_unread(
                        task.setup.sha256.as_deref().unwrap_or_default(),
                        Some(&error.to_message()),
                    );
                    self.tell_unread(error);
                }
                if let Some(came) = came {
                    for id in &waiting {
                        self.offer_moving(id, came);
                    }
                }
                self.drop_used_skeletons();
                self.refresh();
                refilled
            }
            // Its skeleton was dropped with it, and has come meanwhile. What came out of an archive
            // is read again from there.
            Purpose::New(_)
                if report.is_one_file() && self.misses_skeleton(&report, &task.setup) =>
            {
                let setup = self.setup_for_new();
                self.ask(ReadTask { content, setup, ..task }, purpose);
                return None;
            }
            Purpose::New(came) => self.admit(report, &content, &task.setup, came),
            Purpose::Sample(sample) => self.take_sample(sample, report).map(|()| Loaded::default()),
        };
        Some(loaded.map_err(|error| error.to_message()))
    }

    /// Ends a task whose file is not read, for that reason; `text` is what is said of it.
    pub(super) fn fail_reading(
        &mut self,
        task: u64,
        reason: Message,
        text: Message,
    ) -> Option<Result<Loaded, Message>> {
        let Reading { task, purpose, .. } = self.end_task(task)?;
        if let Purpose::Sample(sample) = purpose {
            // It would be asked for at once, and so on for ever: the next thing that is done asks
            // for it.
            self.fail_sample(sample, reason.clone());
            return Some(Err(reason));
        }
        if let Purpose::Again(_) = purpose {
            self.mark_unread(task.setup.sha256.as_deref().unwrap_or_default(), Some(&text));
        }
        self.notices.say_of(Level::Error, &task.name, text);
        self.refresh();
        Some(Err(reason))
    }

    fn end_task(&mut self, task: u64) -> Option<Reading> {
        let at = self.reading.iter().position(|reading| reading.task.id == task)?;
        self.revision += 1;
        Some(self.reading.remove(at))
    }

    /// The name and the size of the file that a task reads, bytes.
    pub(super) fn file_of_task(&self, task: u64) -> Option<(&str, u64)> {
        let reading = self.reading.iter().find(|reading| reading.task.id == task)?;
        Some((&reading.task.name, reading.task.size))
    }

    /// Whether that task is under way.
    #[must_use]
    pub fn is_reading(&self, task: u64) -> bool {
        self.reading.iter().any(|reading| reading.task.id == task)
    }

    /// Whether files are being read that are not in the library yet.
    #[must_use]
    pub fn is_reading_new(&self) -> bool {
        self.reading.iter().any(Reading::is_new)
    }

    /// Whether that task reads a file that is not in the library yet.
    #[must_use]
    pub fn brings_clips(&self, task: u64) -> bool {
        self.reading.iter().any(|reading| reading.task.id == task && reading.is_new())
    }

    /// Whether something is being read that is there in a moment: nobody is told how far that is.
    #[must_use]
    pub fn is_reading_small(&self) -> bool {
        self.reading.iter().any(Reading::is_small)
    }

    /// Whether any file is being read.
    #[must_use]
    pub fn is_reading_any(&self) -> bool {
        !self.reading.is_empty()
    }

    /// Gives up a task.
    pub(super) fn stop_reading(&mut self, task: u64) {
        let forget = self.reading_key(task).map(str::to_owned);
        let Some(at) = self.reading.iter().position(|reading| reading.task.id == task) else {
            return;
        };
        let Reading { task, purpose, .. } = self.reading.remove(at);
        let again = matches!(purpose, Purpose::Again(_));
        if again {
            let text = msg!("Reading {name} was stopped: drop the file again.", name = task.name);
            self.mark_unread(task.setup.sha256.as_deref().unwrap_or_default(), Some(&text));
        }
        self.requests
            .push(Request::StopReading { task: task.id, forget: forget.filter(|_| !again) });
    }

    /// Notes with the clips of a file why they have no motion, so that it is not read over and
    /// over.
    fn mark_unread(&mut self, sha256: &str, why: Option<&Message>) {
        let entries = self.document.library.entries().to_vec();
        for entry in entries.iter().filter(|entry| entry.sha256() == Some(sha256)) {
            self.document.library.change(&entry.id, |entry| entry.unread = why.cloned());
        }
    }

    pub(super) fn reading_jobs(&self) -> impl Iterator<Item = Job> + '_ {
        let files = self.reading.iter().filter(|reading| !reading.is_small());
        files.map(|Reading { task, done, .. }| Job {
            task: Some(task.id),
            kind: JobKind::Reading(task.name.clone()),
            progress: *done as f64 / task.size.max(1) as f64,
            size: Some(task.size),
        })
    }

    /// Brings the clips of a report into the library.
    fn admit(
        &mut self,
        report: ReadReport,
        content: &Content,
        setup: &ReadSetup,
        came: Arrival,
    ) -> Result<Loaded, ImportError> {
        // Of several files some may be good; one alone fails as a whole.
        if let [ReadFile { result: Err(error), .. }] = report.files.as_slice() {
            let error = error.clone();
            self.tell_unread(&error);
            return Err(error);
        }
        self.document.remember(None);
        let mut loaded = Loaded::default();
        let (mut names, mut t_poses, mut failures) = (Vec::new(), 0, Vec::new());
        let brings_skeleton = |file: &ReadFile| {
            file.kind == FileKind::Asf
                || file.result.as_ref().is_ok_and(|read| read.companion.is_some())
        };
        let skeleton_came =
            report.files.iter().any(brings_skeleton) || self.misses_skeleton(&report, setup);
        for file in report.files {
            let name = file.name.clone();
            match file_entries(file, content, &setup.options) {
                Ok((entries, warnings)) => {
                    names.push(name);
                    let has_t_pose = |entry: &Entry| {
                        entry.about.as_ref().is_some_and(|about| about.t_pose_first_row)
                    };
                    t_poses += usize::from(entries.iter().any(has_t_pose));
                    loaded.warnings.extend(warnings);
                    let first = entries.iter().find(|entry| entry.mesh.is_some());
                    if first
                        .and_then(Entry::character)
                        .is_some_and(|character| !character.has_limbs())
                    {
                        loaded.warnings.push(
                            "its figure has no limbs that are known: only its own clips move it"
                                .into(),
                        );
                    }
                    if let Some(first) = first.filter(|entry| self.takes_character(entry, came)) {
                        self.document.set_unchecked(Key::Character, Value::Text(first.id.clone()));
                    }
                    for entry in entries {
                        loaded.ids.push(entry.id.clone());
                        self.join(entry, came);
                    }
                }
                Err(error) => failures.push(error),
            }
        }
        loaded.warnings.extend(report.notes);
        self.tell_all_unread(&failures);
        if skeleton_came {
            self.read_waiting(came);
            self.drop_used_skeletons();
        }
        self.document.settle();
        self.document.library_revision += 1;
        if !names.is_empty() {
            let mut told: Vec<Message> = in_the_library(&names).into_iter().collect();
            let mut more = 0;
            for warning in loaded.warnings.iter().map(ToMessage::to_sentence) {
                if told.contains(&warning) {
                    continue;
                }
                if told.len() > MOST_REMARKS {
                    more += 1;
                } else {
                    told.push(warning);
                }
            }
            if more > 0 {
                told.push(msg!("{more} more remarks stand with the clips."));
            }
            let text = Message::joined(told, " ");
            // A T-pose in front is how the takes of whole databases come: good to know, and nothing
            // to do about it.
            let is_odd = loaded.warnings.len() > t_poses;
            let mends: Vec<String> =
                loaded.ids.iter().filter(|id| self.mend_of(id).is_some()).cloned().collect();
            match loaded.ids.as_slice() {
                // Until its other half comes.
                [id] if is_odd && self.document.is_half(id) => self.notices.miss(id, text),
                // A skeleton that was waited for: it has its motion.
                [id] if self.document.library.get(id).is_none() => {
                    if let Some(text) = in_the_library(&names) {
                        self.say(Level::Info, text);
                    }
                }
                _ if !mends.is_empty() => self.offer_mends(text, mends),
                _ => self.say(if is_odd { Level::Warning } else { Level::Info }, text),
            }
        } else if !loaded.warnings.is_empty() {
            // What holds for the archive holds though nothing in it can be read.
            let told: Vec<Message> = loaded.warnings.iter().map(ToMessage::to_sentence).collect();
            self.say(Level::Warning, Message::joined(told, " "));
        }
        // Listeners are told of each.
        loaded.warnings.extend(failures.iter().map(ToMessage::to_message));
        self.refresh();
        Ok(loaded)
    }

    /// Warns of clips that can be read better; with those of an earlier warning, as one.
    fn offer_mends(&mut self, text: Message, clips: Vec<String>) {
        let mut all = self.notices.take_offer();
        all.retain(|id| !clips.contains(id));
        let is_alone = all.is_empty();
        all.extend(clips);
        let text = if is_alone {
            text
        } else {
            let names =
                all.iter().filter_map(|id| Some(self.document.library.get(id)?.name.as_str()));
            let mut named: Vec<String> = names.take(MOST_FAILURES).map(outside::short).collect();
            if all.len() > named.len() {
                named.push("…".to_owned());
            }
            msg!(
                "{count} clips are of a size or at a place that cannot be right: {named}.",
                count = all.len()
            )
        };
        self.notices.offer(text, all);
        self.revision += 1;
    }

    /// Reads the clips better that a message offers to mend, as one step for undo. What cannot be
    /// read stays as it is, and is told.
    pub(super) fn mend(&mut self, notice: u64) {
        let found = self.notices.list().iter().find(|found| found.id == notice);
        let clips = found.map(|found| found.mends.clone()).unwrap_or_default();
        let library = self.document.library.clone();
        for (id, options) in
            clips.iter().filter_map(|id| Some((id, self.mend_of(id)?))).collect::<Vec<_>>()
        {
            if let Err(error) = self.reread(id, &options) {
                self.say(Level::Error, error.to_message());
            }
        }
        self.document.remember_library(&library);
        self.notices.dismiss(notice);
    }

    /// How a clip could be read better, where that is safe.
    fn mend_of(&self, id: &str) -> Option<ImportOptions> {
        let entry = self.document.library.get(id)?;
        let (Origin::File(file), Some(about)) = (&entry.origin, &entry.about) else {
            return None;
        };
        let options = ImportOptions {
            metres_per_unit: about.fitting_unit.or(file.options.metres_per_unit),
            even_wild_rows: about.wild_rows || file.options.even_wild_rows,
            ..file.options
        };
        (options != file.options).then_some(options)
    }

    /// Says why a file was not read.
    fn tell_unread(&mut self, error: &ImportError) {
        self.notices.say_of(Level::Error, &error.file, error.to_message());
        self.revision += 1;
    }

    /// Says why the files of an archive were not read: of the first ones each, and how many there
    /// are besides.
    fn tell_all_unread(&mut self, errors: &[ImportError]) {
        let (first, rest) = errors.split_at_checked(MOST_FAILURES).unwrap_or((errors, &[]));
        for error in first {
            self.tell_unread(error);
        }
        if !rest.is_empty() {
            let mut named: Vec<String> =
                rest.iter().take(MOST_FAILURES).map(|error| error.file.clone()).collect();
            if rest.len() > named.len() {
                named.push("…".to_owned());
            }
            self.say(Level::Error, msg!("{count} more did not work: {named}.", count = rest.len()));
        }
    }

    /// Adds a clip. What the library has of the same one stays as it was said by hand.
    fn join(&mut self, entry: Entry, came: Arrival) {
        let id = entry.id.clone();
        let known = self.document.library.get(&id).cloned();
        match &known {
            Some(known) => self.join_again(known, entry),
            None => self.document.library.put(entry),
        }
        // A skeleton alone plays nothing, nor does a character that comes without a motion of its
        // own; a motion that waits for one may come into its place when it can be read.
        let plays = self.document.library.get(&id).is_some_and(|entry| {
            entry
                .motion
                .as_ref()
                .is_some_and(|motion| motion.clip().frames() > usize::from(entry.mesh.is_some()))
        });
        // What the link fetches once more, after a reload, has the place that it was given then, or
        // none.
        if plays && (known.is_none() || came == Arrival::ByHand) {
            self.document.offer(&id, came);
        }
    }

    /// The same clip has come once more.
    fn join_again(&mut self, known: &Entry, entry: Entry) {
        let (Origin::File(had), Origin::File(has)) = (&known.origin, &entry.origin) else {
            return;
        };
        if known.motion.is_some() && (has.companion.is_none() || has.companion == had.companion) {
            return;
        }
        let is_read_as_said = had.options == has.options && known.roles_by_hand.is_none();
        let file = SourceFile { options: had.options, ..has.clone() };
        self.document.library.put(Entry {
            name: known.name.clone(),
            roles_by_hand: known.roles_by_hand.clone(),
            origin: Origin::File(file.clone()),
            ..entry
        });
        if is_read_as_said {
            return;
        }
        if let Err(error) = self.read_anew(&file, None) {
            self.tell_unread(&error);
        }
    }

    /// Whether a file with a skin becomes the character. One that the link fetches does not when it
    /// was here before, or the link names another.
    fn takes_character(&self, entry: &Entry, came: Arrival) -> bool {
        let is_free = self.document.params.text(Key::Character).is_empty();
        // One that only its own clips move is no character for all the others.
        let replaces = entry.character().is_some_and(|character| character.has_limbs());
        match came {
            Arrival::ByHand => is_free || replaces,
            Arrival::ByLink => is_free && self.document.library.get(&entry.id).is_none(),
        }
    }

    /// Gives the clips that are in the library what was read anew. One that is to be read otherwise
    /// by now waits for that.
    fn refill(
        &mut self,
        report: ReadReport,
        options: &ImportOptions,
    ) -> Result<Loaded, ImportError> {
        let mut loaded = Loaded::default();
        for file in report.files {
            // Where the bytes are is known: the entries say it.
            let (entries, warnings) = file_entries(file, &Content::Here(Arc::from([])), options)?;
            loaded.warnings.extend(warnings);
            for new in entries {
                self.document.library.change(&new.id, |entry| {
                    let (Origin::File(file), Origin::File(new_file)) =
                        (&mut entry.origin, new.origin)
                    else {
                        return;
                    };
                    if file.options != *options {
                        return;
                    }
                    file.companion = new_file.companion;
                    // A motion whose skeleton was not found keeps waiting.
                    entry.motion = new.motion;
                    entry.mesh = new.mesh;
                    entry.about = new.about;
                    entry.warnings = new.warnings;
                });
                loaded.ids.push(new.id);
            }
        }
        self.document.library_revision += 1;
        Ok(loaded)
    }

    /// Reads a file of the library anew, as its entries say: at once, or asked for. Says whether it
    /// was read. An error changes nothing.
    pub(super) fn read_anew(
        &mut self,
        file: &SourceFile,
        came: Option<Arrival>,
    ) -> Result<bool, ImportError> {
        let (Content::Here(bytes), Some(read)) =
            (&file.content, self.reads.filter(|_| !file.is_large()))
        else {
            self.read_again(file.clone(), came);
            return Ok(false);
        };
        let setup = self.setup_of(file);
        let report = read(&file.name, bytes, &setup, &mut |_| true).unwrap_or_default();
        self.refill(report, &file.options).map(|_| true)
    }

    fn setup_of(&self, file: &SourceFile) -> ReadSetup {
        ReadSetup {
            options: file.options,
            roles: self.roles_by_hand(file),
            companions: match &file.companion {
                Some(companion) => vec![companion.clone()],
                None if file.kind == FileKind::Amc => self.companions(),
                None => Vec::new(),
            },
            sha256: Some(file.sha256.clone()),
        }
    }

    fn setup_for_new(&self) -> ReadSetup {
        ReadSetup { companions: self.companions(), ..ReadSetup::default() }
    }

    /// The skeleton files that there are: those that lie in the library, and those that its motions
    /// were read with.
    fn companions(&self) -> Vec<Companion> {
        let mut all: Vec<Companion> = Vec::new();
        for entry in self.document.library.entries() {
            let Origin::File(file) = &entry.origin else {
                continue;
            };
            let found = match (&file.companion, &file.content) {
                (Some(companion), _) => companion.clone(),
                (None, Content::Here(bytes)) if file.kind == FileKind::Asf => Companion {
                    name: file.name.clone(),
                    sha256: file.sha256.clone(),
                    bytes: Arc::clone(bytes),
                },
                _ => continue,
            };
            if all.iter().all(|known| known.sha256 != found.sha256) {
                all.push(found);
            }
        }
        all
    }

    /// Whether a motion leans on a skeleton, and one has come since it was read.
    fn misses_skeleton(&self, report: &ReadReport, setup: &ReadSetup) -> bool {
        let leans_on_one = |file: &ReadFile| file.kind == FileKind::Amc;
        report.files.iter().any(leans_on_one) && self.companions() != setup.companions
    }

    /// A skeleton has come: motions that waited for it are read.
    fn read_waiting(&mut self, came: Arrival) {
        let (entries, skeletons) = (self.document.library.entries().to_vec(), self.companions());
        let is_named = |file: &SourceFile, skeleton: &Companion| {
            acclaim::goes_by_name(&file.name, &skeleton.name)
        };
        for entry in &entries {
            let Origin::File(file) = &entry.origin else {
                continue;
            };
            let awaits = entry.awaits_skeleton();
            // One that had to make do with another subject's skeleton has its own now.
            let made_do = (file.companion.as_ref()).is_some_and(|had| {
                !is_named(file, had) && skeletons.iter().any(|skeleton| is_named(file, skeleton))
            });
            if !(awaits || made_do) {
                continue;
            }
            let file = SourceFile { companion: None, ..file.clone() };
            match self.read_anew(&file, awaits.then_some(came)) {
                Ok(true) if awaits => {
                    self.offer_moving(&entry.id, came);
                    self.tell_misfit(&entry.id);
                }
                Ok(_) => {}
                Err(error) => self.tell_unread(&error),
            }
        }
    }

    /// Says why a motion still waits though a skeleton has come.
    fn tell_misfit(&mut self, id: &str) {
        if let Some(entry) = self.document.library.get(id).filter(|entry| entry.awaits_skeleton()) {
            let told: Vec<Message> = entry.warnings.iter().map(ToMessage::to_sentence).collect();
            self.notices.miss(id, Message::joined(told, " "));
        }
    }

    /// Offers a clip that waited, if it moves by now.
    fn offer_moving(&mut self, id: &str, came: Arrival) {
        if self.document.library.find(id).is_some_and(|entry| entry.motion.is_some()) {
            self.document.offer(id, came);
        }
    }

    /// Skeletons that have a motion by now need no row of their own.
    fn drop_used_skeletons(&mut self) {
        let entries = self.document.library.entries().to_vec();
        let used = |sha256: &str| {
            entries.iter().any(|entry| match &entry.origin {
                Origin::File(file) => {
                    file.companion.as_ref().is_some_and(|companion| companion.sha256 == sha256)
                }
                _ => false,
            })
        };
        for entry in &entries {
            if matches!(&entry.origin, Origin::File(file) if file.kind == FileKind::Asf && used(&file.sha256))
            {
                self.document.library.remove(&entry.id);
            }
        }
    }

    pub(super) fn reimport(
        &mut self,
        id: &str,
        options: &ImportOptions,
    ) -> Result<(), CommandError> {
        let library = self.document.library.clone();
        self.reread(id, options)?;
        self.document.remember_library(&library);
        Ok(())
    }

    /// Reads a clip's file again with other options. An error changes nothing.
    fn reread(&mut self, id: &str, options: &ImportOptions) -> Result<(), CommandError> {
        let entry = Arc::clone(
            self.document.library.find(id).ok_or_else(|| CommandError::NoClip(id.to_owned()))?,
        );
        let Origin::File(file) = &entry.origin else {
            return Err(CommandError::NotPossible(
                "only a clip that came from a file can be read again",
            ));
        };
        let file = SourceFile { options: *options, ..file.clone() };
        let library = self.document.library.clone();
        // At once, wherever it is read: what is chosen meanwhile adds to it, and taking it back
        // stops it from coming.
        for entry in library.entries().iter().filter(|entry| entry.sha256() == Some(&file.sha256)) {
            self.document.library.change(&entry.id, |entry| {
                if let Origin::File(file) = &mut entry.origin {
                    file.options = *options;
                }
            });
        }
        if let Err(error) = self.read_anew(&file, None) {
            self.document.library = library;
            return Err(error.into());
        }
        Ok(())
    }
}

/// `walk.bvh is in the library.`
fn in_the_library(names: &[String]) -> Option<Message> {
    match names {
        [] => None,
        [name] => Some(msg!("{name} is in the library.")),
        several => Some(msg!("{count} files are in the library.", count = several.len())),
    }
}

/// An entry for every clip of a file, and the file's warnings. `content` is the file's, unless it
/// came out of an archive.
fn file_entries(
    file: ReadFile,
    content: &Content,
    options: &ImportOptions,
) -> Result<(Vec<Entry>, Vec<Message>), ImportError> {
    let read = file.result?;
    let source = SourceFile {
        name: file.name,
        sha256: file.sha256,
        size: file.size,
        kind: file.kind,
        content: file
            .unpacked
            .map_or_else(|| content.clone(), |bytes| Content::Here(Arc::from(bytes))),
        companion: read.companion,
        index: 0,
        options: *options,
    };
    let mut warnings = read.warnings;
    if read.awaits_skeleton {
        warnings.push(msg!(
            "{name} waits for its skeleton: drop the .asf file that belongs to it.",
            name = source.name
        ));
        let id = file_id(&source.name, &source.sha256, 0);
        let entry = Entry {
            warnings: warnings.clone(),
            ..Entry::new(id, outside::clip_name(file_stem(&source.name)), Origin::File(source))
        };
        return Ok((vec![entry], warnings));
    }
    let entries = read.clips.into_iter().enumerate().map(|(index, clip)| {
        let source = SourceFile { index, ..source.clone() };
        Entry {
            motion: Some(Arc::new(clip.motion)),
            mesh: clip.mesh,
            about: Some(clip.about),
            warnings: warnings.clone(),
            ..Entry::new(
                file_id(&source.name, &source.sha256, index),
                String::new(),
                Origin::File(source),
            )
        }
    });
    let named = entries.map(|mut entry| {
        entry.name = entry
            .motion
            .as_ref()
            .map_or_else(String::new, |motion| outside::clip_name(motion.clip().name()));
        entry
    });
    Ok((named.collect(), warnings))
}
