//! The work in the browser's IndexedDB: the records of it (see
//! [`records`](crate::platform::records)), and the files' bytes by their SHA-256.
//!
//! What has just come is put there in a transaction that asks nothing first and is committed in the
//! same breath: such a one is carried out though the page goes meanwhile. The record of all work
//! joins what other windows have stored, so it has to read first, and may be late.

use super::reader::LargeFile;
use crate::platform::records::{
    LATEST, Left, Records, Row, is_left, is_unread, left_key, row_id, row_key, unread_key,
};
use crate::platform::{Arrival, FileBytes, Inbox, Incoming, Stored, StoredFiles, Work, in_short};
use idb::{
    Database, DatabaseEvent as _, Error, Factory, ObjectStoreParams, Transaction, TransactionMode,
    TransactionResult,
};
use js_sys::{Date, Math, Uint8Array};
use segue_session::{SavedEntry, StorageState};
use segue_text::{Message, msg};
use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};
use std::rc::Rc;
use std::sync::Arc;
use wasm_bindgen::prelude::{Closure, wasm_bindgen};
use wasm_bindgen::{JsCast as _, JsValue};
use wasm_bindgen_futures::spawn_local;
use web_sys::{Blob, MessageEvent};

const DATABASE: &str = "segue";
const VERSION: u32 = 1;
const WORK: &str = "work";
const FILES: &str = "files";

#[wasm_bindgen]
extern "C" {
    /// How the windows of one origin speak to each other.
    #[derive(Clone, Debug)]
    type BroadcastChannel;

    #[wasm_bindgen(constructor, catch)]
    fn new(name: &str) -> Result<BroadcastChannel, JsValue>;

    #[wasm_bindgen(method, catch, js_name = postMessage)]
    fn post_message(this: &BroadcastChannel, message: &JsValue) -> Result<(), JsValue>;

    #[wasm_bindgen(method, setter)]
    fn set_onmessage(this: &BroadcastChannel, listener: &JsValue);
}

/// The browser's storage. Clones are the same one.
#[derive(Clone, Debug)]
pub(crate) struct Storage {
    state: Rc<RefCell<State>>,
    inbox: Inbox,
}

#[derive(Debug, Default)]
struct State {
    /// None before it is open, and where there is none.
    database: Option<Rc<Database>>,
    /// There is no storage.
    is_closed: bool,
    /// Clips that are to be written next.
    queue: Vec<Arrival>,
    /// Clips that are being written.
    in_flight: Rc<Vec<Arrival>>,
    /// What is to be written when what is being written is done. Older work is of no interest.
    next: Option<Work>,
    writing: bool,
    /// The names of files that there was no room for, by their SHA-256.
    refused: BTreeMap<String, String>,
    /// The ids of clips that other windows were told of, or know from where this one does.
    announced: BTreeSet<String>,
    channel: Option<BroadcastChannel>,
    /// A name for this window.
    window: String,
}

/// Why something was not written.
#[derive(Clone, Debug)]
enum Failure {
    /// There is no room for it.
    Full,
    /// What the browser says.
    Other(String),
}

impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        Self::Other(error.to_string())
    }
}

impl Storage {
    /// Opens the storage and reads it; [`Incoming::Stored`] brings what is in it.
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
                if name_of(&error).is_some_and(|name| name == "VersionError") {
                    let reason = "A newer Segue has stored its work in this browser, and this page cannot read it: nothing is stored until you reload the page.";
                    (None, Some(Message::word(reason)))
                } else {
                    // A private window, or storage that the user switched off: Segue works, and
                    // promises nothing.
                    log::warn!("no storage in this browser: {error}");
                    (None, None)
                }
            });
            this.inbox.push(Incoming::Stored(stored.map(Box::new)));
            if let Some(reason) = reason {
                this.inbox.push(Incoming::Failed { reason });
            }
            this.go_on();
        });
        storage
    }

    /// What is stored, and what is to be said of it.
    async fn open_and_read(&self) -> Result<(Option<Stored>, Option<Message>), Error> {
        let database = Rc::new(open_database().await?);
        self.state.borrow_mut().database = Some(Rc::clone(&database));
        let transaction = database.transaction(&[WORK, FILES], TransactionMode::ReadOnly)?;
        let (works, files) = (transaction.object_store(WORK)?, transaction.object_store(FILES)?);
        let (work_keys, texts) = (works.get_all_keys(None, None)?, works.get_all(None, None)?);
        let (keys, values) = (files.get_all_keys(None, None)?, files.get_all(None, None)?);
        // All asked at once; the answers come in this order.
        let (work_keys, texts) = (work_keys.await?, texts.await?);
        let (keys, values) = (keys.await?, values.await?);
        let texts: Vec<(String, String)> = (work_keys.iter().zip(&texts))
            .filter_map(|(key, text)| Some((key.as_string()?, text.as_string()?)))
            .collect();
        let records = Records::read(texts.iter().map(|(key, text)| (key.as_str(), text.as_str())));
        let files: StoredFiles = (keys.iter().zip(values))
            .filter_map(|(key, value)| Some((key.as_string()?, file_bytes(value)?)))
            .collect();
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
        let stored = Stored { saved: records.saved, loose: records.loose, files };
        Ok((Some(stored), problem))
    }

    /// Writes clips that have just come, with their files.
    pub(crate) fn store(&self, arrivals: Vec<Arrival>) {
        let mut state = self.state.borrow_mut();
        if !state.is_closed {
            state.queue.extend(arrivals);
            drop(state);
            self.go_on();
        }
    }

    /// Writes the work, the newest one last. What nobody needs any longer is deleted.
    pub(crate) fn save(&self, work: Work) {
        self.state.borrow_mut().next = Some(work);
        self.go_on();
    }

    /// Writes the work before the page goes, which may be any moment: with nothing read first, and
    /// with all clips that are not written yet.
    pub(crate) fn leave(&self, work: Work) {
        let (database, arrivals, left) = {
            let mut state = self.state.borrow_mut();
            let Some(database) = state.database.clone() else {
                return;
            };
            // It is older.
            state.next = None;
            let arrivals: Vec<Arrival> =
                state.in_flight.iter().chain(&state.queue).cloned().collect();
            let mut saved = work.saved;
            (saved.entries).retain(|entry| {
                entry.file.as_ref().is_none_or(|file| !state.refused.contains_key(&file.sha256))
            });
            let left = Left { at_ms: Date::now(), known: work.known, saved };
            (database, arrivals, (left_key(&state.window), left))
        };
        let (key, left) = left;
        let begun =
            text_of(&left).and_then(|text| begin_put(&database, &arrivals, Some((&key, &text))));
        let inbox = self.inbox.clone();
        spawn_local(async move {
            let put = match begun {
                Ok(begun) => finished(begun).await,
                Err(failure) => Err(failure),
            };
            if let Err(failure) = put {
                inbox.push(Incoming::Failed { reason: failure.of_work() });
            }
        });
    }

    /// Asks for clips that another window has stored: [`Incoming::Joined`] brings them.
    pub(crate) fn fetch(&self, entries: Vec<SavedEntry>) {
        let Some(database) = self.state.borrow().database.clone() else {
            return;
        };
        let this = self.clone();
        spawn_local(async move {
            match read_files(&database, &entries).await {
                Ok(files) => {
                    let has_file = |entry: &SavedEntry| {
                        entry.file.as_ref().is_none_or(|file| files.contains_key(&file.sha256))
                    };
                    let loose: Vec<SavedEntry> = entries.into_iter().filter(has_file).collect();
                    let ids = loose.iter().map(|entry| entry.id.clone());
                    this.state.borrow_mut().announced.extend(ids);
                    let saved = None;
                    this.inbox.push(Incoming::Joined(Box::new(Stored { saved, loose, files })));
                }
                Err(error) => log::warn!("clips of another window: {error}"),
            }
        });
    }

    /// Whether the file of that SHA-256 is being written.
    pub(crate) fn is_writing(&self, sha256: &str) -> bool {
        let state = self.state.borrow();
        // Nobody waits for a storage that does not open.
        let mut arrivals = state.in_flight.iter().chain(&state.queue);
        state.database.is_some() && arrivals.any(|arrival| arrival.sha256 == sha256)
    }

    /// How far storing is; `None` where nothing is stored.
    pub(crate) fn progress(&self) -> Option<StorageState> {
        let state = self.state.borrow();
        state.database.as_ref()?;
        Some(if state.writing {
            StorageState::UnderWay
        } else if state.refused.is_empty() {
            StorageState::Done
        } else {
            StorageState::Incomplete
        })
    }

    fn go_on(&self) {
        let mut state = self.state.borrow_mut();
        if state.database.is_some() && !std::mem::replace(&mut state.writing, true) {
            spawn_local(self.clone().write_all());
        }
    }

    async fn write_all(self) {
        loop {
            let (database, arrivals, work) = {
                let mut state = self.state.borrow_mut();
                let arrivals = Rc::new(std::mem::take(&mut state.queue));
                state.in_flight = Rc::clone(&arrivals);
                let work = if arrivals.is_empty() { state.next.take() } else { None };
                let database =
                    state.database.clone().filter(|_| !arrivals.is_empty() || work.is_some());
                let Some(database) = database else {
                    state.writing = false;
                    drop(state);
                    // "Saved" can be shown.
                    self.inbox.wake();
                    return;
                };
                (database, arrivals, work)
            };
            self.write_arrivals(&database, &arrivals).await;
            if let Some(work) = work
                && let Err(failure) = self.write(&database, &work).await
            {
                self.inbox.push(Incoming::Failed { reason: failure.of_work() });
            }
        }
    }

    /// Writes clips with their files, all at once, or one by one where there is no room for all:
    /// what has room is kept.
    async fn write_arrivals(&self, database: &Database, arrivals: &[Arrival]) {
        if arrivals.is_empty() {
            return;
        }
        if put(database, arrivals).await.is_ok() {
            self.announce(arrivals.iter().map(|arrival| &arrival.entry));
            return;
        }
        let (mut full, mut other): (Vec<String>, Option<(String, String)>) = (Vec::new(), None);
        for arrival in arrivals {
            let name = arrival.entry.file.as_ref().map_or(&arrival.entry.name, |file| &file.name);
            match put(database, std::slice::from_ref(arrival)).await {
                Ok(()) => {
                    self.state.borrow_mut().refused.remove(&arrival.sha256);
                    self.announce([&arrival.entry]);
                    continue;
                }
                Err(Failure::Full) => full.push(name.clone()),
                Err(Failure::Other(reason)) => other = Some((name.clone(), reason)),
            }
            self.state.borrow_mut().refused.insert(arrival.sha256.clone(), name.clone());
        }
        full.dedup();
        if !full.is_empty() {
            let reason = msg!(
                "This browser's storage is full: {names} will not be here on the next visit. Remove clips from the library that you do not need.",
                names = in_short(&full)
            );
            self.inbox.push(Incoming::Failed { reason });
        }
        if let Some((name, reason)) = other {
            let reason =
                msg!("{name} could not be stored in this browser: {reason}.", name, reason);
            self.inbox.push(Incoming::Failed { reason });
        }
    }

    async fn write(&self, database: &Database, work: &Work) -> Result<(), Failure> {
        let asked = database.transaction(&[FILES], TransactionMode::ReadOnly)?;
        let held = keys_of(asked.object_store(FILES)?.get_all_keys(None, None)?.await?);
        let missing = {
            let mut state = self.state.borrow_mut();
            state.refused.retain(|sha256, _| work.files.contains_key(sha256));
            work.missing(|sha256| held.contains(sha256) || state.refused.contains_key(sha256))
        };
        self.write_arrivals(database, &missing).await;
        let freed = self.write_record(database, work).await?;
        self.announce(&work.saved.entries);
        if freed {
            let refused = std::mem::take(&mut self.state.borrow_mut().refused);
            let again = work.missing(|sha256| !refused.contains_key(sha256));
            self.write_arrivals(database, &again).await;
        }
        Ok(())
    }

    /// Writes the record of all work, and deletes what nobody needs. Says whether that made room.
    async fn write_record(&self, database: &Database, work: &Work) -> Result<bool, Failure> {
        let transaction = database.transaction(&[WORK, FILES], TransactionMode::ReadWrite)?;
        let watched = transaction.object_store(WORK)?.transaction();
        let (works, files) = (transaction.object_store(WORK)?, transaction.object_store(FILES)?);
        // Other windows may have written meanwhile: what is there is asked, not remembered. Until
        // this transaction ends, no other begins.
        let (latest, work_keys) =
            (works.get(JsValue::from(LATEST))?, works.get_all_keys(None, None)?);
        let held = files.get_all_keys(None, None)?;
        let latest = latest.await?.and_then(|text| text.as_string());
        let (work_keys, held) = (keys_of(work_keys.await?), keys_of(held.await?));
        let mut texts: Vec<(&str, String)> =
            latest.map(|text| (LATEST, text)).into_iter().collect();
        for key in &work_keys {
            let is_of_others =
                row_id(key).is_some_and(|id| !work.known.contains(id)) || is_left(key);
            if is_of_others
                && let Some(text) =
                    works.get(JsValue::from(key))?.await?.and_then(|text| text.as_string())
            {
                texts.push((key, text));
            }
        }
        let records = Records::read(texts.iter().map(|(key, text)| (*key, text.as_str())));
        let mut some_are_unread = work_keys.iter().any(|key| is_unread(key));
        if let (Some(problem), Some((_, text))) = (&records.problem, texts.first()) {
            log::warn!("the stored work cannot be read and is kept: {problem}");
            works.put(&JsValue::from(text), Some(&JsValue::from(unread_key(Date::now()))))?;
            some_are_unread = true;
        }
        let there = records.all();
        let all = work.over(&there, |sha256| held.contains(sha256));
        works.put(&JsValue::from(text_of(&all)?), Some(&JsValue::from(LATEST)))?;
        let rows: BTreeMap<String, &SavedEntry> =
            (all.entries.iter().filter(|entry| entry.file.is_some()))
                .map(|entry| (row_key(&entry.id), entry))
                .collect();
        for key in work_keys
            .iter()
            .filter(|key| is_left(key) || (row_id(key).is_some() && !rows.contains_key(*key)))
        {
            works.delete(JsValue::from(key))?;
        }
        for (key, entry) in rows.iter().filter(|(key, _)| !work_keys.contains(*key)) {
            works.put(&JsValue::from(row_text(entry)?), Some(&JsValue::from(key)))?;
        }
        // A record that cannot be read may need any file but those that others named, too.
        let (needed, named) = (all.files(), there.files());
        let is_free = |key: &&String| {
            !needed.contains(key.as_str()) && (!some_are_unread || named.contains(key.as_str()))
        };
        let mut freed = false;
        for key in held.iter().filter(is_free) {
            files.delete(JsValue::from(key))?;
            freed = true;
        }
        finished((transaction.commit()?, watched)).await?;
        Ok(freed)
    }

    /// Tells other windows of clips that are stored by now.
    fn announce<'a>(&self, entries: impl IntoIterator<Item = &'a SavedEntry>) {
        let mut state = self.state.borrow_mut();
        let new: Vec<&SavedEntry> = (entries.into_iter())
            .filter(|entry| state.announced.insert(entry.id.clone()))
            .collect();
        let Some(channel) = state.channel.as_ref().filter(|_| !new.is_empty()) else {
            return;
        };
        let told = text_of(&new).map(|text| channel.post_message(&JsValue::from(text)));
        if !matches!(told, Ok(Ok(()))) {
            log::warn!("other windows were not told of {} clips", new.len());
        }
    }
}

impl Failure {
    /// What is said where the work as a whole was not written.
    fn of_work(&self) -> Message {
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

/// Hears what other windows have stored.
fn open_channel(inbox: &Inbox) -> Option<BroadcastChannel> {
    let channel = BroadcastChannel::new(DATABASE).ok()?;
    let inbox = inbox.clone();
    let listener = Closure::<dyn FnMut(MessageEvent)>::new(move |event: MessageEvent| {
        let text = event.data().as_string().unwrap_or_default();
        match serde_json::from_str(&text) {
            Ok(entries) => inbox.push(Incoming::StoredElsewhere(entries)),
            Err(error) => log::warn!("another window said what is not understood: {error}"),
        }
    });
    channel.set_onmessage(listener.as_ref());
    listener.forget();
    Some(channel)
}

fn text_of(value: &impl serde::Serialize) -> Result<String, Failure> {
    serde_json::to_string(value).map_err(|error| Failure::Other(error.to_string()))
}

fn row_text(entry: &SavedEntry) -> Result<String, Failure> {
    text_of(&Row { at_ms: Date::now(), entry: entry.clone() })
}

fn keys_of(keys: Vec<JsValue>) -> BTreeSet<String> {
    keys.into_iter().filter_map(|key| key.as_string()).collect()
}

/// A transaction, and a second wrapper of it for asking what went wrong once the first is used up.
type Begun = (Transaction, Transaction);

/// Begins to write clips with their files, and one more record, and commits that at once.
fn begin_put(
    database: &Database,
    arrivals: &[Arrival],
    record: Option<(&str, &str)>,
) -> Result<Begun, Failure> {
    let transaction = database.transaction(&[WORK, FILES], TransactionMode::ReadWrite)?;
    let (works, files) = (transaction.object_store(WORK)?, transaction.object_store(FILES)?);
    let mut written = BTreeSet::new();
    for arrival in arrivals {
        if written.insert(arrival.sha256.as_str()) {
            let value: JsValue = match &arrival.bytes {
                FileBytes::Here(bytes) => Uint8Array::from(&bytes[..]).into(),
                FileBytes::Large(file) => file.blob().into(),
            };
            files.put(&value, Some(&JsValue::from(&arrival.sha256)))?;
        }
        let key = row_key(&arrival.entry.id);
        works.put(&JsValue::from(row_text(&arrival.entry)?), Some(&JsValue::from(key)))?;
    }
    if let Some((key, text)) = record {
        works.put(&JsValue::from(text), Some(&JsValue::from(key)))?;
    }
    let watched = works.transaction();
    Ok((transaction.commit()?, watched))
}

/// Waits until a transaction is carried out.
async fn finished((transaction, watched): Begun) -> Result<(), Failure> {
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

async fn put(database: &Database, arrivals: &[Arrival]) -> Result<(), Failure> {
    finished(begin_put(database, arrivals, None)?).await
}

async fn read_files(database: &Database, entries: &[SavedEntry]) -> Result<StoredFiles, Error> {
    let transaction = database.transaction(&[FILES], TransactionMode::ReadOnly)?;
    let store = transaction.object_store(FILES)?;
    let keys: BTreeSet<&str> =
        entries.iter().filter_map(|entry| Some(entry.file.as_ref()?.sha256.as_str())).collect();
    let mut files = StoredFiles::new();
    for key in keys {
        if let Some(bytes) = store.get(JsValue::from(key))?.await?.and_then(file_bytes) {
            files.insert(key.to_owned(), bytes);
        }
    }
    Ok(files)
}

/// What a browser calls an error.
fn name_of(error: &Error) -> Option<String> {
    if let Error::DomException(exception) = error { Some(exception.name()) } else { None }
}

/// A stored file: small ones as their bytes, large ones as the browser's handle.
fn file_bytes(value: JsValue) -> Option<FileBytes> {
    match value.dyn_into::<Uint8Array>() {
        Ok(bytes) => Some(FileBytes::Here(Arc::from(bytes.to_vec()))),
        Err(value) => Some(FileBytes::Large(LargeFile::new(value.dyn_into::<Blob>().ok()?))),
    }
}

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
