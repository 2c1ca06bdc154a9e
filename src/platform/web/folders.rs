//! Folders that are dropped on the page. eframe handles only files.

use super::corpora::show_corpus_folder;
use super::files::read;
use super::js_error_text;
use super::page::{listen_first, window};
use crate::platform::motion_files::{is_motion_file, no_motion_in};
use crate::platform::{Inbox, Incoming};
use js_sys::{Array, Promise};
use segue_text::msg;
use wasm_bindgen::{JsCast as _, JsValue};
use wasm_bindgen_futures::{JsFuture, spawn_local};
use web_sys::{DragEvent, File, FileSystemDirectoryEntry, FileSystemEntry, FileSystemFileEntry};

/// Starts to handle every drop that contains a folder, with its folders and files. eframe handles
/// the others.
pub(crate) fn watch_folders(inbox: &Inbox) {
    let inbox = inbox.clone();
    listen_first(window(), "drop", move |event| {
        let entries = entries_of(event.unchecked_ref());
        if !entries.iter().any(FileSystemEntry::is_directory) {
            return;
        }
        event.prevent_default();
        event.stop_propagation();
        // eframe has seen the drag and does not see the drop, so the drag is ended for it.
        let left = event.target().and_then(|target| {
            Some(target.dispatch_event(DragEvent::new("dragleave").ok()?.as_ref()))
        });
        if let Some(Err(error)) = left {
            log::warn!("the drop was not ended: {}", js_error_text(&error));
        }
        let inbox = inbox.clone();
        spawn_local(async move {
            for entry in entries {
                read_entry(entry, &inbox).await;
            }
        });
    });
}

/// Returns the dropped files and folders. Browsers have them only during the event.
fn entries_of(event: &DragEvent) -> Vec<FileSystemEntry> {
    let Some(items) = event.data_transfer().map(|transfer| transfer.items()) else {
        return Vec::new();
    };
    let items = (0..items.length()).filter_map(|index| items.get(index));
    items.filter_map(|item| item.webkit_get_as_entry().ok().flatten()).collect()
}

/// Reads a file, or the motion files of a folder in the order of their paths. A folder that is a
/// corpus is shown.
async fn read_entry(entry: FileSystemEntry, inbox: &Inbox) {
    let is_folder = entry.is_directory();
    let name = entry.name();
    let files = if is_folder {
        match motion_files(entry.clone()).await {
            Ok(Some(files)) => Ok(files),
            Ok(None) => return show_corpus_folder(&entry, inbox),
            Err(error) => Err(error),
        }
    } else {
        let path = path_of(&entry);
        file_of(entry).await.map(|file| vec![(path, file)])
    };
    match files {
        Ok(files) if files.is_empty() => {
            inbox.push(Incoming::Failed { reason: no_motion_in(&name) });
        }
        Ok(files) => read(files, inbox.clone()).await,
        Err(error) => inbox.push(Incoming::Failed {
            reason: msg!("{name} cannot be read: {error}.", name, error = js_error_text(&error)),
        }),
    }
}

/// Returns the motion files in and below a folder with their paths; `None` if the folder is a
/// corpus.
async fn motion_files(folder: FileSystemEntry) -> Result<Option<Vec<(String, File)>>, JsValue> {
    let mut files = Vec::new();
    // A stack of the entries to visit.
    let mut waiting = vec![folder];
    let mut is_first = true;
    while let Some(entry) = waiting.pop() {
        if entry.is_directory() {
            let mut children = children_of(entry.unchecked_ref()).await?;
            let is_manifest =
                |child: &FileSystemEntry| child.is_file() && child.name() == "corpus.json";
            if std::mem::take(&mut is_first) && children.iter().any(is_manifest) {
                return Ok(None);
            }
            children.sort_by_cached_key(FileSystemEntry::name);
            waiting.extend(children.into_iter().rev());
        } else if is_motion_file(&entry.name()) {
            files.push((path_of(&entry), file_of(entry).await?));
        }
    }
    Ok(Some(files))
}

/// Returns the entries of a folder. Browsers list them in parts, of which the last is empty.
async fn children_of(folder: &FileSystemDirectoryEntry) -> Result<Vec<FileSystemEntry>, JsValue> {
    let reader = folder.create_reader();
    let mut children = Vec::new();
    loop {
        let part = Promise::new(&mut |resolve, reject| {
            if let Err(error) = reader.read_entries_with_callback_and_callback(&resolve, &reject) {
                reject.call1(&JsValue::NULL, &error).ok();
            }
        });
        let part: Array = JsFuture::from(part).await?.unchecked_into();
        if part.length() == 0 {
            return Ok(children);
        }
        children.extend(part.iter().map(JsValue::unchecked_into::<FileSystemEntry>));
    }
}

/// Returns the file of an entry.
async fn file_of(entry: FileSystemEntry) -> Result<File, JsValue> {
    let entry: FileSystemFileEntry = entry.unchecked_into();
    let file = Promise::new(&mut |resolve, reject| {
        entry.file_with_callback_and_callback(&resolve, &reject);
    });
    Ok(JsFuture::from(file).await?.unchecked_into())
}

/// Returns the path of an entry, such as `takes/day 1/walk.bvh`.
fn path_of(entry: &FileSystemEntry) -> String {
    entry.full_path().trim_start_matches('/').to_owned()
}
