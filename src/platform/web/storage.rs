//! Storage of the work in the browser's IndexedDB: its records (see
//! [`records`](crate::platform::records)), and the files' bytes by their SHA-256.
//!
//! New clips are written in a transaction that reads nothing and is committed at once. The browser
//! completes such a transaction even if the page is closed meanwhile. The record of all work merges
//! what other windows have stored; its transaction has to read first, and may be too late.

use super::reader::LargeFile;
use super::stored_place::{DATABASE, FILES};
use crate::platform::motion_files::abbreviated;
use crate::platform::records::{
    ClipRecord, ExitRecord, LATEST, Records, clip_id, clip_key, exit_key, is_exit_key,
    is_unread_key, unread_key,
};
use crate::platform::{FileBytes, Inbox, Incoming, NewClip, StoredFiles, StoredWork, Work};
use idb::{
    Database, DatabaseEvent as _, Error, Factory, ObjectStoreParams, Transaction, TransactionMode,
    TransactionResult,
};
use js_sys::{Date, Math, Uint8Array};
use segue_session::{Saved, SavedEntry, StorageState};
use segue_text::{Message, msg};
use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};
use std::rc::Rc;
use wasm_bindgen::JsValue;
use wasm_bindgen::prelude::{Closure, wasm_bindgen};
use wasm_bindgen_futures::spawn_local;
use web_sys::MessageEvent;

const VERSION: u32 = 1;
const WORK: &str = "work";
/// The most clips that one transaction writes.
const MAX_WRITTEN_AT_ONCE: usize = 32;

#[wasm_bindgen]
extern "C" {
    /// A channel between the windows of one origin.
    #[derive(Clone, Debug)]
    type BroadcastChannel;

    #[wasm_bindgen(constructor, catch)]
    fn new(name: &str) -> Result<BroadcastChannel, JsValue>;

    #[wasm_bindgen(method, catch, js_name = postMessage)]
    fn post_message(this: &BroadcastChannel, message: &JsValue) -> Result<(), JsValue>;

    #[wasm_bindgen(method, setter)]
    fn set_onmessage(this: &BroadcastChannel, listener: &JsValue);
}

/// The browser's storage. Clones share it.
#[derive(Clone, Debug)]
pub(crate) struct Storage {
    state: Rc<RefCell<State>>,
    inbox: Inbox,
}

/// The shared state of a storage and its clones.
#[derive(Debug, Default)]
struct State {
    /// The database; `None` before it is open, and where there is none.
    database: Option<Rc<Database>>,
    /// Whether there is no storage.
    is_closed: bool,
    /// The clips to write next.
    queue: Vec<NewClip>,
    /// The clips that are being written.
    in_flight: Rc<Vec<NewClip>>,
    /// The work to write after the clips. Newer work replaces it.
    next: Option<Work>,
    is_writing: bool,
    /// The names of the files that were not written, by their SHA-256.
    refused: BTreeMap<String, String>,
    /// The ids of the clips that were announced to other windows, or read from the storage.
    announced: BTreeSet<String>,
    /// The channel to other windows; `None` where the browser has none.
    channel: Option<BroadcastChannel>,
    /// The random name of this window.
    window: String,
    /// The record of all work as this window wrote it last, with its text: while it is the stored
    /// one, it need not be read.
    written: Option<(String, Saved)>,
}

/// The reason why something was not written.
#[derive(Clone, Debug)]
enum Failure {
    /// The storage is full.
    Full,
    /// Another reason, in the browser's words.
    Other(String),
}

impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        Self::Other(error.to_string())
    }
}

impl Storage {
    /// Opens the storage and reads it. The answer is [`Incoming::Stored`].
    pub(crate) fn open(inbox: &Inbox) -> Self {
        let storage = Self {
            state: Rc::new(RefCell::new(State {
                channel: open_channel(inbox),
                window: format!("{:.0}", Math::random() * 1e15),
                ..State::default()
            })),
            inbox: inbox.clone(),
        };
        let this = storage.clone();
        spawn_local(async move {
            let stored = this.open_and_read().await;
            let (stored, reason) = stored.unwrap_or_else(|error| {
                let mut state = this.state.borrow_mut();
                state.is_closed = state.database.is_none();
                state.queue.clear();
                if exception_name(&error).is_some_and(|name| name == "VersionError") {
                    let reason = "A newer Segue has stored its work in this browser, and this page cannot read it: nothing is stored until you reload the page.";
                    (None, Some(Message::word(reason)))
                } else {
                    // A private window, or storage that the user switched off. Segue works without
                    // it, and shows no progress of storing.
                    log::warn!("no storage in this browser: {error}");
                    (None, None)
                }
            });
            this.inbox.push(Incoming::Stored(stored.map(Box::new)));
            if let Some(reason) = reason {
                this.inbox.push(Incoming::Failed { reason });
            }
            this.write_pending();
        });
        storage
    }

    /// Opens the database. Returns the stored work, and a notice about a damaged record.
    async fn open_and_read(&self) -> Result<(Option<StoredWork>, Option<Message>), Error> {
        let database = Rc::new(open_database().await?);
        self.state.borrow_mut().database = Some(Rc::clone(&database));
        let transaction = database.transaction(&[WORK, FILES], TransactionMode::ReadOnly)?;
        let (works, files) = (transaction.object_store(WORK)?, transaction.object_store(FILES)?);
        let (work_keys, texts) = (works.get_all_keys(None, None)?, works.get_all(None, None)?);
        // Files are read when they are needed.
        let keys = files.get_all_keys(None, None)?;
        // All requests are sent at once; the answers come in this order.
        let (work_keys, texts, keys) = (work_keys.await?, texts.await?, keys_of(keys.await?));
        let texts: Vec<(String, String)> = (work_keys.iter().zip(&texts))
            .filter_map(|(key, text)| Some((key.as_string()?, text.as_string()?)))
            .collect();
        let records = Records::read(texts.iter().map(|(key, text)| (key.as_str(), text.as_str())));
        let files: StoredFiles = keys.into_iter().map(stored_file).collect();
        let problem = records.problem.map(|problem| {
            msg!(
                "The list of your work in this browser's storage cannot be read ({problem}). It is kept, and no file is deleted: your clips are here, what you set and corrected is not.",
                problem = problem.to_string()
            )
        });
        if records.saved.is_none() && records.loose.is_empty() {
            return Ok((None, problem));
        }
        let entries = records.saved.iter().flat_map(|saved| &saved.entries).chain(&records.loose);
        self.state.borrow_mut().announced.extend(entries.map(|entry| entry.id.clone()));
        let stored = StoredWork { saved: records.saved, loose: records.loose, files };
        Ok((Some(stored), problem))
    }

    /// Writes new clips with their files.
    pub(crate) fn store(&self, clips: Vec<NewClip>) {
        let mut state = self.state.borrow_mut();
        if !state.is_closed {
            state.queue.extend(clips);
            drop(state);
            self.write_pending();
        }
    }

    /// Writes the work, and deletes what it no longer needs. Of several calls, the last one counts.
    pub(crate) fn save(&self, work: Work) {
        self.state.borrow_mut().next = Some(work);
        self.write_pending();
    }

    /// Writes the work when the page may end at any moment: without reading first, and with all
    /// clips that are not written yet.
    pub(crate) fn save_on_exit(&self, work: Work) {
        let (database, clips, (key, record)) = {
            let mut state = self.state.borrow_mut();
            let Some(database) = state.database.clone() else {
                return;
            };
            // The queued work is older.
            state.next = None;
            let clips: Vec<NewClip> = state.in_flight.iter().chain(&state.queue).cloned().collect();
            let mut saved = work.saved;
            (saved.entries).retain(|entry| {
                entry.file.as_ref().is_none_or(|file| !state.refused.contains_key(&file.sha256))
            });
            let record = ExitRecord { at_ms: Date::now(), known: work.known, saved };
            (database, clips, (exit_key(&state.window), record))
        };
        let pending =
            text_of(&record).and_then(|text| begin_put(&database, &clips, Some((&key, &text))));
        let inbox = self.inbox.clone();
        spawn_local(async move {
            let put = match pending {
                Ok(pending) => committed(pending).await,
                Err(failure) => Err(failure),
            };
            if let Err(failure) = put {
                inbox.push(Incoming::Failed { reason: failure.work_notice() });
            }
        });
    }

    /// Reads clips that another window has stored. The answer is [`Incoming::FetchedElsewhere`].
    pub(crate) fn fetch(&self, entries: Vec<SavedEntry>) {
        let Some(database) = self.state.borrow().database.clone() else {
            return;
        };
        let this = self.clone();
        spawn_local(async move {
            match held_files(&database).await {
                Ok(held) => {
                    let files: StoredFiles = held.into_iter().map(stored_file).collect();
                    let has_file = |entry: &SavedEntry| {
                        entry.file.as_ref().is_none_or(|file| files.contains_key(&file.sha256))
                    };
                    let loose: Vec<SavedEntry> = entries.into_iter().filter(has_file).collect();
                    let ids = loose.iter().map(|entry| entry.id.clone());
                    this.state.borrow_mut().announced.extend(ids);
                    let saved = None;
                    this.inbox.push(Incoming::FetchedElsewhere(Box::new(StoredWork {
                        saved,
                        loose,
                        files,
                    })));
                }
                Err(error) => log::warn!("clips of another window: {error}"),
            }
        });
    }

    /// Returns whether the file of that SHA-256 is queued or being written.
    pub(crate) fn is_writing(&self, sha256: &str) -> bool {
        let state = self.state.borrow();
        // A storage that does not open never writes the queued files.
        let mut clips = state.in_flight.iter().chain(&state.queue);
        state.database.is_some() && clips.any(|clip| clip.sha256 == sha256)
    }

    /// Returns the progress of storing; `None` where nothing is stored.
    pub(crate) fn progress(&self) -> Option<StorageState> {
        let state = self.state.borrow();
        state.database.as_ref()?;
        Some(if state.is_writing {
            StorageState::UnderWay
        } else if state.refused.is_empty() {
            StorageState::Done
        } else {
            StorageState::Incomplete
        })
    }

    /// Starts to write what is queued, unless writing is under way.
    fn write_pending(&self) {
        let mut state = self.state.borrow_mut();
        if state.database.is_some() && !std::mem::replace(&mut state.is_writing, true) {
            spawn_local(self.clone().write_all());
        }
    }

    /// Writes the queued clips and the work until nothing is left.
    async fn write_all(self) {
        loop {
            let (database, clips, work) = {
                let mut state = self.state.borrow_mut();
                // A few at a time: what is written at once is copied at once.
                let due = state.queue.len().min(MAX_WRITTEN_AT_ONCE);
                let clips = Rc::new(state.queue.drain(..due).collect::<Vec<_>>());
                state.in_flight = Rc::clone(&clips);
                let work = if clips.is_empty() { state.next.take() } else { None };
                let database =
                    state.database.clone().filter(|_| !clips.is_empty() || work.is_some());
                let Some(database) = database else {
                    state.is_writing = false;
                    drop(state);
                    // The panels can show that everything is stored.
                    self.inbox.wake();
                    return;
                };
                (database, clips, work)
            };
            self.write_clips(&database, &clips).await;
            if let Some(work) = work
                && let Err(failure) = self.write(&database, &work).await
            {
                self.inbox.push(Incoming::Failed { reason: failure.work_notice() });
            }
        }
    }

    /// Writes clips with their files, all at once, or one by one where there is no room for all, so
    /// that as many as possible are stored.
    async fn write_clips(&self, database: &Database, clips: &[NewClip]) {
        if clips.is_empty() {
            return;
        }
        if put(database, clips).await.is_ok() {
            self.announce(clips.iter().map(|clip| &clip.entry));
            return;
        }
        let (mut full, mut other): (Vec<String>, Option<(String, String)>) = (Vec::new(), None);
        for clip in clips {
            let name = clip.entry.file.as_ref().map_or(&clip.entry.name, |file| &file.name);
            match put(database, std::slice::from_ref(clip)).await {
                Ok(()) => {
                    self.state.borrow_mut().refused.remove(&clip.sha256);
                    self.announce([&clip.entry]);
                    continue;
                }
                Err(Failure::Full) => full.push(name.clone()),
                Err(Failure::Other(reason)) => other = Some((name.clone(), reason)),
            }
            self.state.borrow_mut().refused.insert(clip.sha256.clone(), name.clone());
        }
        full.dedup();
        if !full.is_empty() {
            let reason = msg!(
                "This browser's storage is full: {names} will not be here on the next visit. Remove clips from the library that you do not need.",
                names = abbreviated(&full)
            );
            self.inbox.push(Incoming::Failed { reason });
        }
        if let Some((name, reason)) = other {
            let reason =
                msg!("{name} could not be stored in this browser: {reason}.", name, reason);
            self.inbox.push(Incoming::Failed { reason });
        }
    }

    /// Writes the missing clips and the record of all work.
    async fn write(&self, database: &Database, work: &Work) -> Result<(), Failure> {
        let held = held_files(database).await?;
        let missing = {
            let mut state = self.state.borrow_mut();
            state.refused.retain(|sha256, _| work.files.contains_key(sha256));
            work.missing(|sha256| held.contains(sha256) || state.refused.contains_key(sha256))
        };
        self.write_clips(database, &missing).await;
        let freed = self.write_record(database, work).await?;
        self.announce(&work.saved.entries);
        if freed {
            let refused = std::mem::take(&mut self.state.borrow_mut().refused);
            let again = work.missing(|sha256| !refused.contains_key(sha256));
            self.write_clips(database, &again).await;
        }
        Ok(())
    }

    /// Writes the record of all work, and deletes what it does not need. Returns whether that made
    /// room.
    async fn write_record(&self, database: &Database, work: &Work) -> Result<bool, Failure> {
        let transaction = database.transaction(&[WORK, FILES], TransactionMode::ReadWrite)?;
        let watched = transaction.object_store(WORK)?.transaction();
        let (works, files) = (transaction.object_store(WORK)?, transaction.object_store(FILES)?);
        // Other windows may have written meanwhile, so the records are read again. No other
        // transaction begins before this one ends.
        let (latest, work_keys) =
            (works.get(JsValue::from(LATEST))?, works.get_all_keys(None, None)?);
        let held = files.get_all_keys(None, None)?;
        let latest = latest.await?.and_then(|text| text.as_string());
        let written = self.state.borrow_mut().written.take();
        let known = written.filter(|(text, _)| Some(text) == latest.as_ref());
        let known = known.map(|(_, saved)| saved);
        let latest = latest.filter(|_| known.is_none());
        let (work_keys, held) = (keys_of(work_keys.await?), keys_of(held.await?));
        let mut texts: Vec<(&str, String)> =
            latest.map(|text| (LATEST, text)).into_iter().collect();
        for key in &work_keys {
            let is_of_others =
                clip_id(key).is_some_and(|id| !work.known.contains(id)) || is_exit_key(key);
            if is_of_others
                && let Some(text) =
                    works.get(JsValue::from(key))?.await?.and_then(|text| text.as_string())
            {
                texts.push((key, text));
            }
        }
        let texts_by_key = texts.iter().map(|(key, text)| (*key, text.as_str()));
        let records = Records::read_over(known, texts_by_key);
        let mut some_are_unread = work_keys.iter().any(|key| is_unread_key(key));
        if let (Some(problem), Some((_, text))) = (&records.problem, texts.first()) {
            log::warn!("the stored work cannot be read and is kept: {problem}");
            works.put(&JsValue::from(text), Some(&JsValue::from(unread_key(Date::now()))))?;
            some_are_unread = true;
        }
        let there = records.all();
        let all = work.over(&there, |sha256| held.contains(sha256));
        let text = text_of(&all)?;
        works.put(&JsValue::from(&text), Some(&JsValue::from(LATEST)))?;
        let clip_records: BTreeMap<String, &SavedEntry> =
            (all.entries.iter().filter(|entry| entry.file.is_some()))
                .map(|entry| (clip_key(&entry.id), entry))
                .collect();
        for key in work_keys.iter().filter(|key| {
            is_exit_key(key) || (clip_id(key).is_some() && !clip_records.contains_key(*key))
        }) {
            works.delete(JsValue::from(key))?;
        }
        for (key, entry) in clip_records.iter().filter(|(key, _)| !work_keys.contains(*key)) {
            works.put(&JsValue::from(clip_record_text(entry)?), Some(&JsValue::from(key)))?;
        }
        // A damaged record may need any file, except those that the readable records name as well.
        let (needed, named) = (all.files(), there.files());
        let is_free = |key: &&String| {
            !needed.contains(key.as_str())
                && !work.kept.contains(key.as_str())
                && (!some_are_unread || named.contains(key.as_str()))
        };
        let mut freed = false;
        for key in held.iter().filter(is_free) {
            files.delete(JsValue::from(key))?;
            freed = true;
        }
        committed((transaction.commit()?, watched)).await?;
        self.state.borrow_mut().written = Some((text, all));
        Ok(freed)
    }

    /// Announces newly stored clips to other windows.
    fn announce<'a>(&self, entries: impl IntoIterator<Item = &'a SavedEntry>) {
        let mut state = self.state.borrow_mut();
        let new: Vec<&SavedEntry> = (entries.into_iter())
            .filter(|entry| state.announced.insert(entry.id.clone()))
            .collect();
        let Some(channel) = state.channel.as_ref().filter(|_| !new.is_empty()) else {
            return;
        };
        let posted = text_of(&new).map(|text| channel.post_message(&JsValue::from(text)));
        if !matches!(posted, Ok(Ok(()))) {
            log::warn!("{} clips were not announced to other windows", new.len());
        }
    }
}

impl Failure {
    /// Returns the notice about work that was not written as a whole.
    fn work_notice(&self) -> Message {
        match self {
            Self::Full => {
                "This browser's storage is full: the library and the parameters are not stored. Remove clips that you do not need."
                    .into()
            }
            Self::Other(reason) => msg!(
                "The work could not be stored in this browser: {reason}.",
                reason = reason.clone()
            ),
        }
    }
}

/// Opens the channel to other windows, and forwards their announcements to `inbox`.
fn open_channel(inbox: &Inbox) -> Option<BroadcastChannel> {
    let channel = BroadcastChannel::new(DATABASE).ok()?;
    let inbox = inbox.clone();
    let listener = Closure::<dyn FnMut(MessageEvent)>::new(move |event: MessageEvent| {
        let text = event.data().as_string().unwrap_or_default();
        match serde_json::from_str(&text) {
            Ok(entries) => inbox.push(Incoming::StoredElsewhere(entries)),
            Err(error) => log::warn!("a message of another window cannot be read: {error}"),
        }
    });
    channel.set_onmessage(listener.as_ref());
    listener.forget();
    Some(channel)
}

/// Returns a value as JSON.
fn text_of(value: &impl serde::Serialize) -> Result<String, Failure> {
    serde_json::to_string(value).map_err(|error| Failure::Other(error.to_string()))
}

/// Returns the record of a clip as JSON.
fn clip_record_text(entry: &SavedEntry) -> Result<String, Failure> {
    text_of(&ClipRecord { at_ms: Date::now(), entry: entry.clone() })
}

/// Returns the keys that are strings.
fn keys_of(keys: Vec<JsValue>) -> BTreeSet<String> {
    keys.into_iter().filter_map(|key| key.as_string()).collect()
}

/// A transaction that is being committed, and a second handle for its error, because waiting
/// consumes the first.
type PendingCommit = (Transaction, Transaction);

/// Starts to write clips with their files, and one more record, in a transaction that is committed
/// at once.
fn begin_put(
    database: &Database,
    clips: &[NewClip],
    record: Option<(&str, &str)>,
) -> Result<PendingCommit, Failure> {
    let transaction = database.transaction(&[WORK, FILES], TransactionMode::ReadWrite)?;
    let (works, files) = (transaction.object_store(WORK)?, transaction.object_store(FILES)?);
    let mut written = BTreeSet::new();
    for clip in clips {
        if written.insert(clip.sha256.as_str()) {
            let value: Option<JsValue> = match &clip.bytes {
                FileBytes::Here(bytes) => Some(Uint8Array::from(&bytes[..]).into()),
                FileBytes::Large(file) => file.value().cloned(),
            };
            if let Some(value) = value {
                files.put(&value, Some(&JsValue::from(&clip.sha256)))?;
            }
        }
        let key = clip_key(&clip.entry.id);
        works.put(&JsValue::from(clip_record_text(&clip.entry)?), Some(&JsValue::from(key)))?;
    }
    if let Some((key, text)) = record {
        works.put(&JsValue::from(text), Some(&JsValue::from(key)))?;
    }
    let watched = works.transaction();
    Ok((transaction.commit()?, watched))
}

/// Waits until a transaction is committed.
async fn committed((transaction, watched): PendingCommit) -> Result<(), Failure> {
    let ended = transaction.await;
    if matches!(ended, Ok(TransactionResult::Committed)) {
        return Ok(());
    }
    let name = watched.error().map(|error| error.name()).unwrap_or_default();
    Err(if name == "QuotaExceededError" || format!("{ended:?}").contains("Quota") {
        Failure::Full
    } else {
        Failure::Other(ended.err().map_or(name, |error| error.to_string()))
    })
}

/// Writes clips with their files in one transaction.
async fn put(database: &Database, clips: &[NewClip]) -> Result<(), Failure> {
    committed(begin_put(database, clips, None)?).await
}

/// Returns the SHA-256 of the files in the storage.
async fn held_files(database: &Database) -> Result<BTreeSet<String>, Error> {
    let transaction = database.transaction(&[FILES], TransactionMode::ReadOnly)?;
    let held = transaction.object_store(FILES)?.get_all_keys(None, None)?;
    Ok(keys_of(held.await?))
}

/// Returns the name of a DOM exception; `None` for other errors.
fn exception_name(error: &Error) -> Option<String> {
    if let Error::DomException(exception) = error { Some(exception.name()) } else { None }
}

/// Returns a file in the storage with its key.
fn stored_file(sha256: String) -> (String, FileBytes) {
    let file = LargeFile::stored(&sha256);
    (sha256, FileBytes::Large(file))
}

/// Opens the database, and creates its stores on the first visit.
async fn open_database() -> Result<Database, Error> {
    let mut request = Factory::new()?.open(DATABASE, Some(VERSION))?;
    request.on_upgrade_needed(|event| {
        let made = event.database().and_then(|database| {
            database.create_object_store(WORK, ObjectStoreParams::new())?;
            database.create_object_store(FILES, ObjectStoreParams::new())
        });
        if let Err(error) = made {
            log::error!("no stores in the database: {error}");
        }
    });
    request.await
}
