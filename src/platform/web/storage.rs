//! The work in the browser's IndexedDB: one record, and the files' bytes by their SHA-256.

use super::reader::LargeFile;
use crate::platform::{FileBytes, Inbox, Incoming, Stored, StoredFiles, Work};
use idb::{Database, DatabaseEvent as _, Error, Factory, ObjectStoreParams, TransactionMode, TransactionResult};
use js_sys::Uint8Array;
use std::cell::RefCell;
use std::collections::BTreeSet;
use std::rc::Rc;
use std::sync::Arc;
use wasm_bindgen::{JsCast as _, JsValue};
use wasm_bindgen_futures::spawn_local;
use web_sys::Blob;

const DATABASE: &str = "segue";
const VERSION: u32 = 1;
const WORK: &str = "work";
const FILES: &str = "files";
/// The key of the one record in [`WORK`].
const LATEST: &str = "latest";

/// The browser's storage. Clones are the same one.
#[derive(Clone, Debug)]
pub(crate) struct Storage {
    state: Rc<RefCell<State>>,
    inbox: Inbox,
}

#[derive(Debug, Default)]
struct State {
    database: Option<Rc<Database>>,
    /// What is to be written when what is being written is done. Older work is of no interest.
    next: Option<Work>,
    writing: bool,
}

impl Storage {
    /// Opens the storage and reads it; [`Incoming::Stored`] brings what is in it.
    pub(crate) fn open(inbox: &Inbox) -> Self {
        let storage = Self {
            state: Rc::default(),
            inbox: inbox.clone(),
        };
        let this = storage.clone();
        spawn_local(async move {
            let stored = match this.read().await {
                Ok(stored) => stored,
                Err(error) => {
                    // A private window, or storage that the user switched off: Segue works, and promises nothing.
                    log::warn!("no storage in this browser: {error}");
                    None
                }
            };
            this.inbox.push(Incoming::Stored(stored.map(Box::new)));
        });
        storage
    }

    async fn read(&self) -> Result<Option<Stored>, Error> {
        let database = Rc::new(open_database().await?);
        let transaction = database.transaction(&[WORK, FILES], TransactionMode::ReadOnly)?;
        let files = transaction.object_store(FILES)?;
        let record = transaction.object_store(WORK)?.get(JsValue::from(LATEST))?;
        let (keys, values) = (files.get_all_keys(None, None)?, files.get_all(None, None)?);
        // All asked at once; the answers come in this order.
        let record = record.await?.and_then(|record| record.as_string());
        let (keys, values) = (keys.await?, values.await?);
        let files: StoredFiles = (keys.iter().zip(values))
            .filter_map(|(key, value)| Some((key.as_string()?, file_bytes(value)?)))
            .collect();
        self.state.borrow_mut().database = Some(database);
        let Some(record) = record else { return Ok(None) };
        match serde_json::from_str(&record) {
            Ok(saved) => Ok(Some(Stored { saved, files })),
            Err(error) => {
                log::warn!("the stored work is of another version: {error}");
                Ok(None)
            }
        }
    }

    /// Writes the work, the newest one last. What nobody needs any longer is deleted.
    pub(crate) fn save(&self, work: Work) {
        let mut state = self.state.borrow_mut();
        if state.database.is_none() {
            return;
        }
        state.next = Some(work);
        if !std::mem::replace(&mut state.writing, true) {
            spawn_local(self.clone().write_all());
        }
    }

    async fn write_all(self) {
        loop {
            let (database, work) = {
                let mut state = self.state.borrow_mut();
                let (Some(database), Some(work)) = (state.database.clone(), state.next.take()) else {
                    state.writing = false;
                    return;
                };
                (database, work)
            };
            if let Err(reason) = self.write(&database, &work).await {
                self.inbox.push(Incoming::Failed { reason });
            }
        }
    }

    async fn write(&self, database: &Database, work: &Work) -> Result<(), String> {
        let unclear = |error: Error| format!("The work could not be stored in this browser: {error}.");
        let transaction = database.transaction(&[WORK, FILES], TransactionMode::ReadWrite).map_err(unclear)?;
        let files = transaction.object_store(FILES).map_err(unclear)?;
        // A second wrapper of the same transaction, for asking what went wrong once the first is used up.
        let watched = files.transaction();
        let written = async {
            let works = transaction.object_store(WORK)?;
            // Another tab of Segue may have written meanwhile: what is there is asked, not remembered. Until this transaction ends, no other begins.
            let (record, keys) = (works.get(JsValue::from(LATEST))?, files.get_all_keys(None, None)?);
            let record = record.await?.and_then(|record| record.as_string());
            let there: BTreeSet<String> = keys.await?.iter().filter_map(JsValue::as_string).collect();
            let (record, needed) = match work.over(record.as_deref()) {
                Ok(all) => all,
                Err(error) => {
                    log::error!("the work cannot be written down: {error}");
                    return transaction.abort()?.await;
                }
            };
            works.put(&JsValue::from(record), Some(&JsValue::from(LATEST)))?;
            for key in there.iter().filter(|key| !needed.contains(*key)) {
                files.delete(JsValue::from(key))?;
            }
            for (key, bytes) in work.files.iter().filter(|(key, _)| !there.contains(*key)) {
                let value: JsValue = match bytes {
                    FileBytes::Here(bytes) => Uint8Array::from(&bytes[..]).into(),
                    FileBytes::Large(file) => file.blob().into(),
                };
                files.put(&value, Some(&JsValue::from(key)))?;
            }
            transaction.commit()?.await
        };
        match written.await {
            Ok(TransactionResult::Committed) => Ok(()),
            other => {
                let megabytes = work.files.values().map(FileBytes::len).sum::<u64>() as f64 / 1e6;
                let name = watched.error().map(|error| error.name()).unwrap_or_default();
                Err(if name == "QuotaExceededError" || format!("{other:?}").contains("Quota") {
                    format!(
                        "This browser's storage is full, so your {megabytes:.0} MB of files will not be here on the next visit. \
                         Remove clips from the library that you do not need."
                    )
                } else {
                    let error = other.err().map_or(name, |error| error.to_string());
                    format!("The work could not be stored in this browser: {error}.")
                })
            }
        }
    }
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
