//! Folders that are dropped on the page. eframe handles only files.

use super::corpora::show_corpus_folder;
use super::files::read;
use super::js_error_text;
use super::page::{listen_first, window};
use crate::platform::bundle::{is_in_folder, is_read_in_folder, leave_out_lone_images};
use crate::platform::motion_files::no_motion_in;
use crate::platform::{Inbox, Incoming};
use js_sys::{Array, Promise};
use segue_text::msg;
use wasm_bindgen::{JsCast as _, JsValue};
use wasm_bindgen_futures::{JsFuture, spawn_local};
use web_sys::{
    Blob, DragEvent, File, FileSystemDirectoryEntry, FileSystemEntry, FileSystemFileEntry,
};

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
        spawn_local(read_entries(entries, inbox));
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

/// Reads files, and the motion files of folders in the order of their paths. A folder that is a
/// corpus is shown.
async fn read_entries(entries: Vec<FileSystemEntry>, inbox: Inbox) {
    let refused = |reason| inbox.push(Incoming::Failed { reason });
    let (mut files, mut folders) = (Vec::new(), Vec::new());
    for entry in entries {
        let name = entry.name();
        let found = if entry.is_directory() {
            motion_files(entry.clone()).await
        } else {
            let path = path_of(&entry);
            file_of(entry.clone()).await.map(|file| Some(vec![(path, file.into())]))
        };
        match found {
            Ok(Some(found)) => {
                files.extend(found);
                folders.extend(entry.is_directory().then_some(name));
            }
            Ok(None) => show_corpus_folder(&entry, &inbox),
            Err(error) => {
                refused(msg!(
                    "{name} cannot be read: {error}.",
                    name,
                    error = js_error_text(&error)
                ));
            }
        }
    }
    leave_out_lone_images(&mut files, |file: &Blob| file.size() as u64);
    folders.retain(|folder| !files.iter().any(|(path, _)| is_in_folder(path, folder)));
    for folder in &folders {
        refused(no_motion_in(folder));
    }
    if !files.is_empty() {
        read(files, inbox).await;
    }
}

/// Returns the motion files in and below a folder with their paths, and what models refer to;
/// `None` if the folder is a corpus.
async fn motion_files(folder: FileSystemEntry) -> Result<Option<Vec<(String, Blob)>>, JsValue> {
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
        } else if is_read_in_folder(&entry.name()) {
            files.push((path_of(&entry), file_of(entry).await?.into()));
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
