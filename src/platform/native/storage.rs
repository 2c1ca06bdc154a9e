//! The work in a folder of the user's: one record, and the files' bytes by their SHA-256.

use super::LargeFile;
use crate::platform::{FileBytes, Inbox, Incoming, Stored, StoredFiles, Work};
use segue::session::reading::LARGE_BYTES;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;

const RECORD: &str = "work.json";
const FILES: &str = "files";

/// The folder, and the thread that writes into it; by default there is none. Clones are the same one.
#[derive(Clone, Debug, Default)]
pub(crate) struct Storage(Option<Arc<Mutex<Writer>>>);

#[derive(Debug)]
struct Writer {
    /// None once the app has ended.
    queue: Option<Sender<Work>>,
    thread: Option<JoinHandle<()>>,
}

impl Drop for Writer {
    /// Waits until everything is written: the program ends behind this.
    fn drop(&mut self) {
        self.queue = None;
        if let Some(thread) = self.thread.take()
            && thread.join().is_err()
        {
            log::error!("the thread that stores the work has panicked");
        }
    }
}

impl Storage {
    /// Opens the storage and reads it; [`Incoming::Stored`] brings what is in it.
    pub(crate) fn open(inbox: &Inbox) -> Self {
        let Some(folder) = folder() else {
            inbox.push(Incoming::Stored(None));
            return Self(None);
        };
        Self::open_in(folder, inbox)
    }

    fn open_in(folder: PathBuf, inbox: &Inbox) -> Self {
        inbox.push(Incoming::Stored(read(&folder).map(Box::new)));
        let (queue, works) = channel::<Work>();
        let inbox = inbox.clone();
        let thread = std::thread::spawn(move || {
            while let Ok(mut work) = works.recv() {
                // Older work is of no interest.
                while let Ok(newer) = works.try_recv() {
                    work = newer;
                }
                if let Err(error) = write(&folder, &work) {
                    let reason = format!("The work could not be stored in {}: {error}.", folder.display());
                    inbox.push(Incoming::Failed { reason });
                }
            }
        });
        Self(Some(Arc::new(Mutex::new(Writer {
            queue: Some(queue),
            thread: Some(thread),
        }))))
    }

    /// Writes the work, the newest one last. What it no longer needs is deleted.
    pub(crate) fn save(&self, work: Work) {
        let Some(writer) = &self.0 else { return };
        let writer = writer.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(queue) = &writer.queue
            && queue.send(work).is_err()
        {
            log::error!("the thread that stores the work has ended");
        }
    }
}

/// Where programs keep such things; `None` where that is not known, and then nothing is kept.
fn folder() -> Option<PathBuf> {
    let path = |key| std::env::var_os(key).map(PathBuf::from).filter(|path| path.is_absolute());
    let folder = if cfg!(windows) {
        path("APPDATA")
    } else if cfg!(target_os = "macos") {
        path("HOME").map(|home| home.join("Library/Application Support"))
    } else {
        path("XDG_DATA_HOME").or_else(|| Some(path("HOME")?.join(".local/share")))
    };
    Some(folder?.join("segue"))
}

fn read(folder: &Path) -> Option<Stored> {
    let record = fs::read(folder.join(RECORD)).ok()?;
    let saved = serde_json::from_slice(&record)
        .map_err(|error| log::warn!("the stored work is of another version: {error}"))
        .ok()?;
    let mut files = StoredFiles::new();
    for entry in fs::read_dir(folder.join(FILES)).ok().into_iter().flatten().flatten() {
        if let (Some(key), Ok(bytes)) = (entry.file_name().to_str(), fs::read(entry.path())) {
            let bytes: Arc<[u8]> = Arc::from(bytes);
            let large = bytes.len() as u64 > LARGE_BYTES;
            let bytes = if large {
                FileBytes::Large(LargeFile::new(bytes))
            } else {
                FileBytes::Here(bytes)
            };
            files.insert(key.to_owned(), bytes);
        }
    }
    Some(Stored { saved, files })
}

fn write(folder: &Path, work: &Work) -> io::Result<()> {
    let files = folder.join(FILES);
    fs::create_dir_all(&files)?;
    for (key, bytes) in &work.files {
        let path = files.join(key);
        if !path.exists() {
            match bytes {
                FileBytes::Here(bytes) => write_whole(&path, bytes)?,
                FileBytes::Large(file) => write_whole(&path, file.bytes())?,
            }
        }
    }
    let path = folder.join(RECORD);
    let (record, needed) = work.over(fs::read_to_string(&path).ok().as_deref())?;
    write_whole(&path, record.as_bytes())?;
    // Last: until the record is replaced, the old one needs its files.
    for entry in fs::read_dir(&files)?.flatten() {
        if entry.file_name().to_str().is_none_or(|key| !needed.contains(key)) {
            fs::remove_file(entry.path())?;
        }
    }
    Ok(())
}

/// Writes beside the file and then in its place: whoever reads it finds the old one or the new one, never half of one.
fn write_whole(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let beside = path.with_extension("part");
    fs::write(&beside, bytes)?;
    fs::rename(beside, path)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stored_of(inbox: &Inbox) -> Option<Stored> {
        match inbox.take().pop_front() {
            Some(Incoming::Stored(stored)) => stored.map(|stored| *stored),
            other => panic!("expected what is stored, found {other:?}"),
        }
    }

    /// Work with clips from files of these keys, by somebody who knows of these and `removed` ones.
    fn work_of(query: &str, files: &[&str], removed: &[&str]) -> Work {
        let entries: Vec<_> = files
            .iter()
            .map(|key| {
                serde_json::json!({ "id": key, "name": key, "file": { "name": key, "sha256": key, "index": 0,
            "options": segue::formats::ImportOptions::default() }, "roles": null })
            })
            .collect();
        Work {
            saved: serde_json::from_value(serde_json::json!({ "query": query, "entries": entries })).unwrap(),
            known: files.iter().chain(removed).map(|&key| key.to_owned()).collect(),
            files: files
                .iter()
                .map(|&key| (key.to_owned(), FileBytes::Here(Arc::from(key.as_bytes()))))
                .collect(),
        }
    }

    #[test]
    fn what_is_saved_last_is_there_again_and_nothing_else() {
        let folder = std::env::temp_dir().join(format!("segue-storage-test-{}", std::process::id()));
        fs::remove_dir_all(&folder).ok();
        let inbox = Inbox::default();
        let storage = Storage::open_in(folder.clone(), &inbox);
        assert_eq!(stored_of(&inbox), None);
        storage.save(work_of("t=1", &["aa", "bb"], &[]));
        storage.save(work_of("t=2", &["bb", "cc"], &["aa"]));
        drop(storage);

        let storage = Storage::open_in(folder.clone(), &inbox);
        let stored = stored_of(&inbox).unwrap();
        assert_eq!(stored.saved.query, "t=2");
        assert_eq!(stored.files.keys().collect::<Vec<_>>(), ["bb", "cc"]);
        assert_eq!(stored.files["cc"], FileBytes::Here(Arc::from(&b"cc"[..])));
        drop(storage);
        fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn what_another_window_added_stays() {
        let folder = std::env::temp_dir().join(format!("segue-storage-windows-{}", std::process::id()));
        fs::remove_dir_all(&folder).ok();
        let inbox = Inbox::default();
        let windows = [
            work_of("t=1", &["aa"], &[]),
            work_of("t=2", &["bb"], &[]),
            work_of("t=3", &[], &["aa"]),
        ];
        for work in windows {
            let storage = Storage::open_in(folder.clone(), &inbox);
            inbox.take();
            storage.save(work);
        }
        let stored = read(&folder).unwrap();
        assert_eq!(stored.saved.query, "t=3");
        assert_eq!(stored.files.keys().collect::<Vec<_>>(), ["bb"]);
        assert_eq!(stored.saved.entries[0].id, "bb");
        fs::remove_dir_all(&folder).unwrap();
    }
}
