//! Storage of the work in a folder of the user: one record, and the files' bytes by their SHA-256.

use super::LargeFile;
use crate::platform::records::{LATEST, Records};
use crate::platform::{FileBytes, Inbox, Incoming, NewClip, StoredFiles, StoredWork, Work};
use segue_session::reading::LARGE_BYTES;
use segue_session::{Saved, SavedEntry, Session, StorageState};
use segue_text::{Message, msg};
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;

const RECORD: &str = "work.json";
const FILES: &str = "files";
/// The name of a damaged record, which is kept.
const UNREAD: &str = "work-unread.json";

/// A storage in a folder, with the thread that writes into it. Clones share both; the default has
/// neither.
#[derive(Clone, Debug, Default)]
pub(crate) struct Storage(Option<Arc<Mutex<Writer>>>);

/// The connection to the thread that writes.
#[derive(Debug)]
struct Writer {
    /// The queue of jobs; `None` once the app has ended.
    queue: Option<Sender<Job>>,
    /// The number of queued jobs that are not done.
    waiting: Arc<AtomicUsize>,
    /// Whether the last job has failed.
    has_failed: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

/// A job of the thread that writes.
#[derive(Debug)]
enum Job {
    Store(Vec<NewClip>),
    Save(Work),
}

impl Drop for Writer {
    /// Waits until everything is written, because the program may end afterwards.
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
    /// Opens the storage and reads it. The answer is [`Incoming::Stored`].
    pub(crate) fn open(inbox: &Inbox) -> Self {
        let Some(folder) = folder() else {
            inbox.push(Incoming::Stored(None));
            return Self(None);
        };
        Self::open_in(folder, inbox)
    }

    fn open_in(folder: PathBuf, inbox: &Inbox) -> Self {
        let (stored, problem) = read(&folder);
        inbox.push(Incoming::Stored(stored.map(Box::new)));
        if let Some(reason) = problem {
            inbox.push(Incoming::Failed { reason });
        }
        let (queue, jobs) = channel::<Job>();
        let (waiting, has_failed) =
            (Arc::new(AtomicUsize::new(0)), Arc::new(AtomicBool::new(false)));
        let (inbox, still_waiting, failed) =
            (inbox.clone(), Arc::clone(&waiting), Arc::clone(&has_failed));
        let thread = std::thread::spawn(move || {
            while let Ok(first) = jobs.recv() {
                let (mut due, mut taken) = (Vec::new(), 0);
                for job in std::iter::once(first).chain(jobs.try_iter()) {
                    taken += 1;
                    match (due.last_mut(), job) {
                        (Some(Job::Store(new_clips)), Job::Store(more)) => new_clips.extend(more),
                        // The newer work replaces the older one.
                        (Some(Job::Save(work)), Job::Save(newer)) => *work = newer,
                        (_, job) => due.push(job),
                    }
                }
                let done = due.iter().try_for_each(|job| match job {
                    Job::Store(new_clips) => store(&folder, new_clips),
                    Job::Save(work) => write(&folder, work),
                });
                failed.store(done.is_err(), Ordering::Relaxed);
                if let Err(error) = done {
                    let reason = msg!(
                        "The work could not be stored in {folder}: {error}.",
                        folder = folder.display().to_string(),
                        error = error.to_string()
                    );
                    inbox.push(Incoming::Failed { reason });
                }
                still_waiting.fetch_sub(taken, Ordering::Relaxed);
                inbox.wake();
            }
        });
        Self(Some(Arc::new(Mutex::new(Writer {
            queue: Some(queue),
            waiting,
            has_failed,
            thread: Some(thread),
        }))))
    }

    /// Writes new clips with their files. The stored work stays.
    pub(crate) fn store(&self, new_clips: Vec<NewClip>) {
        self.queue(Job::Store(new_clips));
    }

    /// Writes the work, and deletes the files that it no longer needs. Of several calls, the last
    /// one counts.
    pub(crate) fn save(&self, work: Work) {
        self.queue(Job::Save(work));
    }

    /// Writes the work like [`Storage::save`], because the program waits until everything is
    /// written.
    pub(crate) fn save_on_exit(&self, work: Work) {
        self.save(work);
    }

    /// Does nothing, because the windows of a program do not announce their clips; the folder is
    /// read again when the program starts.
    #[expect(clippy::unused_self, reason = "a page reads its storage")]
    pub(crate) fn fetch(&self, _entries: Vec<SavedEntry>) {}

    /// Returns the progress of storing; `None` where nothing is stored.
    pub(crate) fn progress(&self) -> Option<StorageState> {
        let writer = self.0.as_ref()?.lock().unwrap_or_else(PoisonError::into_inner);
        Some(if writer.waiting.load(Ordering::Relaxed) > 0 {
            StorageState::UnderWay
        } else if writer.has_failed.load(Ordering::Relaxed) {
            StorageState::Incomplete
        } else {
            StorageState::Done
        })
    }

    /// Hands a job to the thread that writes.
    fn queue(&self, job: Job) {
        let Some(writer) = &self.0 else { return };
        let writer = writer.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(queue) = &writer.queue {
            writer.waiting.fetch_add(1, Ordering::Relaxed);
            if queue.send(job).is_err() {
                log::error!("the thread that stores the work has ended");
            }
        }
    }
}

/// Returns the folder for the data of the program; `None` where the system names none. Nothing is
/// stored then.
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

/// Returns the stored work, and a notice about a damaged record.
fn read(folder: &Path) -> (Option<StoredWork>, Option<Message>) {
    let record = fs::read_to_string(folder.join(RECORD)).ok();
    let records = Records::read(record.as_deref().map(|record| (LATEST, record)));
    if let Some(problem) = records.problem {
        let reason = msg!(
            "The list of what is stored in {folder} cannot be read ({problem}). It is kept there as {file}, and so are all files.",
            folder = folder.display().to_string(),
            problem = problem.to_string(),
            file = UNREAD.to_owned()
        );
        return (None, Some(reason));
    }
    let Some(saved) = records.saved else {
        return (None, None);
    };
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
    let stored = StoredWork { saved: Some(saved), loose: Vec::new(), files };
    (Some(stored), None)
}

/// Reads the present record. A damaged one is renamed, so that it is kept.
fn record_of(folder: &Path) -> io::Result<Option<Saved>> {
    let path = folder.join(RECORD);
    let record = fs::read_to_string(&path).ok();
    let records = Records::read(record.as_deref().map(|record| (LATEST, record)));
    if records.problem.is_some() {
        fs::rename(&path, folder.join(UNREAD))?;
    }
    Ok(records.saved)
}

/// Writes files that are not in the folder yet.
fn write_files<'a>(
    folder: &Path,
    files: impl IntoIterator<Item = (&'a String, &'a FileBytes)>,
) -> io::Result<()> {
    let folder = folder.join(FILES);
    fs::create_dir_all(&folder)?;
    for (key, bytes) in files {
        let path = folder.join(key);
        if !path.exists() {
            match bytes {
                FileBytes::Here(bytes) => write_whole(&path, bytes)?,
                FileBytes::Large(file) => write_whole(&path, file.bytes())?,
            }
        }
    }
    Ok(())
}

/// Adds new clips to the record, and writes their files.
fn store(folder: &Path, new_clips: &[NewClip]) -> io::Result<()> {
    write_files(folder, new_clips.iter().map(|new_clip| (&new_clip.sha256, &new_clip.bytes)))?;
    // On a first visit, the record begins with the built-in clips.
    let mut saved = record_of(folder)?.unwrap_or_else(|| Session::new().saved());
    let new = new_clips
        .iter()
        .filter(|new_clip| saved.entries.iter().all(|there| there.id != new_clip.entry.id));
    let new: Vec<SavedEntry> = new.map(|new_clip| new_clip.entry.clone()).collect();
    saved.entries.extend(new);
    write_whole(&folder.join(RECORD), serde_json::to_string(&saved)?.as_bytes())
}

/// Replaces the record by the work, and deletes the files that it no longer needs.
fn write(folder: &Path, work: &Work) -> io::Result<()> {
    write_files(folder, &work.files)?;
    let files = folder.join(FILES);
    let all =
        work.over(&record_of(folder)?.unwrap_or_default(), |sha256| files.join(sha256).exists());
    write_whole(&folder.join(RECORD), serde_json::to_string(&all)?.as_bytes())?;
    if folder.join(UNREAD).exists() {
        // The damaged record may need any file.
        return Ok(());
    }
    // Files are deleted after the record is replaced, because the old record needs them.
    let needed = all.files();
    for entry in fs::read_dir(&files)?.flatten() {
        if entry.file_name().to_str().is_none_or(|key| !needed.contains(key)) {
            fs::remove_file(entry.path())?;
        }
    }
    Ok(())
}

/// Writes a file beside the old one, and renames it. A reader finds either the old file or the new
/// one, and never a part of one.
fn write_whole(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let beside = path.with_extension("part");
    fs::write(&beside, bytes)?;
    fs::rename(beside, path)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::platform::work::clip_of;

    fn stored_of(inbox: &Inbox) -> Option<StoredWork> {
        match inbox.take().pop_front() {
            Some(Incoming::Stored(stored)) => stored.map(|stored| *stored),
            other => panic!("expected what is stored, found {other:?}"),
        }
    }

    /// Returns work with a clip of each of these files, by a window that had also `removed` ones.
    fn work_of(query: &str, files: &[&str], removed: &[&str]) -> Work {
        Work {
            saved: Saved {
                query: query.to_owned(),
                entries: files.iter().map(|key| clip_of(&format!("{key}~{key}"))).collect(),
                ..Saved::default()
            },
            known: files.iter().chain(removed).map(|key| format!("{key}~{key}")).collect(),
            files: files
                .iter()
                .map(|&key| (key.to_owned(), FileBytes::Here(Arc::from(key.as_bytes()))))
                .collect(),
            ..Work::default()
        }
    }

    fn new_clip(key: &str) -> NewClip {
        NewClip {
            entry: clip_of(&format!("{key}~{key}")),
            sha256: key.to_owned(),
            bytes: FileBytes::Here(Arc::from(key.as_bytes())),
        }
    }

    fn empty_folder(name: &str) -> PathBuf {
        let folder =
            std::env::temp_dir().join(format!("segue-storage-{name}-{}", std::process::id()));
        fs::remove_dir_all(&folder).ok();
        folder
    }

    #[test]
    fn new_clip_is_added_to_the_stored_work() {
        let folder = empty_folder("new_clip");
        let inbox = Inbox::default();
        let storage = Storage::open_in(folder.clone(), &inbox);
        storage.save(work_of("t=1", &["aa"], &[]));
        storage.store(vec![new_clip("bb")]);
        drop(storage);
        let stored = read(&folder).0.unwrap();
        let saved = stored.saved.unwrap();
        assert_eq!(saved.query, "t=1");
        assert_eq!(
            saved.entries.iter().map(|entry| entry.id.as_str()).collect::<Vec<_>>(),
            ["aa~aa", "bb~bb"]
        );
        assert_eq!(stored.files.keys().collect::<Vec<_>>(), ["aa", "bb"]);
        fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn damaged_record_is_reported_and_kept_with_its_files() {
        let folder = empty_folder("unread");
        write(&folder, &work_of("t=1", &["aa"], &[])).unwrap();
        fs::write(folder.join(RECORD), "{\"garbage\":").unwrap();
        let inbox = Inbox::default();
        let storage = Storage::open_in(folder.clone(), &inbox);
        let answers: Vec<Incoming> = inbox.take().into();
        assert!(
            matches!(&answers[..], [Incoming::Stored(None), Incoming::Failed { reason }] if reason.to_string().contains(UNREAD)),
            "{answers:?}"
        );
        storage.save(work_of("t=2", &["bb"], &[]));
        storage.save(work_of("t=3", &[], &["bb"]));
        drop(storage);
        assert_eq!(fs::read_to_string(folder.join(UNREAD)).unwrap(), "{\"garbage\":");
        assert!(folder.join(FILES).join("aa").exists());
        assert_eq!(read(&folder).0.unwrap().saved.unwrap().query, "t=3");
        fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn work_saved_last_replaces_the_earlier_one() {
        let folder = empty_folder("last");
        let inbox = Inbox::default();
        let storage = Storage::open_in(folder.clone(), &inbox);
        assert_eq!(stored_of(&inbox), None);
        storage.save(work_of("t=1", &["aa", "bb"], &[]));
        storage.save(work_of("t=2", &["bb", "cc"], &["aa"]));
        drop(storage);

        let storage = Storage::open_in(folder.clone(), &inbox);
        let stored = stored_of(&inbox).unwrap();
        assert_eq!(stored.saved.unwrap().query, "t=2");
        assert_eq!(stored.files.keys().collect::<Vec<_>>(), ["bb", "cc"]);
        assert_eq!(stored.files["cc"], FileBytes::Here(Arc::from(&b"cc"[..])));
        drop(storage);
        fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn clips_of_another_window_stay_in_the_record() {
        let folder = empty_folder("windows");
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
        let stored = read(&folder).0.unwrap();
        let saved = stored.saved.unwrap();
        assert_eq!(saved.query, "t=3");
        assert_eq!(stored.files.keys().collect::<Vec<_>>(), ["bb"]);
        assert_eq!(saved.entries[0].id, "bb~bb");
        fs::remove_dir_all(&folder).unwrap();
    }
}
