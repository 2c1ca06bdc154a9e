//! The work in a folder of the user's: one record, and the files' bytes by their SHA-256.

use super::LargeFile;
use crate::platform::records::{LATEST, Records};
use crate::platform::{Arrival, FileBytes, Inbox, Incoming, Stored, StoredFiles, Work};
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
/// A record that could not be read, which is kept.
const UNREAD: &str = "work-unread.json";

/// The folder, and the thread that writes into it; by default there is none. Clones are the same
/// one.
#[derive(Clone, Debug, Default)]
pub(crate) struct Storage(Option<Arc<Mutex<Writer>>>);

#[derive(Debug)]
struct Writer {
    /// None once the app has ended.
    queue: Option<Sender<Job>>,
    /// How many jobs were queued that are not done.
    waiting: Arc<AtomicUsize>,
    /// The last of them could not be done.
    has_failed: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

#[derive(Debug)]
enum Job {
    Store(Vec<Arrival>),
    Save(Work),
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
                        (Some(Job::Store(arrivals)), Job::Store(more)) => arrivals.extend(more),
                        // Older work is of no interest.
                        (Some(Job::Save(work)), Job::Save(newer)) => *work = newer,
                        (_, job) => due.push(job),
                    }
                }
                let done = due.iter().try_for_each(|job| match job {
                    Job::Store(arrivals) => store(&folder, arrivals),
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

    /// Writes clips that have just come, with their files. Work that was read before stays.
    pub(crate) fn store(&self, arrivals: Vec<Arrival>) {
        self.queue(Job::Store(arrivals));
    }

    /// Writes the work, the newest one last. What it no longer needs is deleted.
    pub(crate) fn save(&self, work: Work) {
        self.queue(Job::Save(work));
    }

    /// As [`Storage::save`]: a program waits until everything is written.
    pub(crate) fn leave(&self, work: Work) {
        self.save(work);
    }

    /// A folder is read again when the program starts: nobody tells of other windows.
    #[expect(clippy::unused_self, reason = "a page asks its storage")]
    pub(crate) fn fetch(&self, _entries: Vec<SavedEntry>) {}

    /// How far storing is; `None` where nothing is stored.
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

/// What is stored, and what is to be said of it.
fn read(folder: &Path) -> (Option<Stored>, Option<Message>) {
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
    let stored = Stored { saved: Some(saved), loose: Vec::new(), files };
    (Some(stored), None)
}

/// The record as it is at present. One that cannot be read is moved out of the way.
fn record_of(folder: &Path) -> io::Result<Option<Saved>> {
    let path = folder.join(RECORD);
    let record = fs::read_to_string(&path).ok();
    let records = Records::read(record.as_deref().map(|record| (LATEST, record)));
    if records.problem.is_some() {
        fs::rename(&path, folder.join(UNREAD))?;
    }
    Ok(records.saved)
}

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

fn store(folder: &Path, arrivals: &[Arrival]) -> io::Result<()> {
    write_files(folder, arrivals.iter().map(|arrival| (&arrival.sha256, &arrival.bytes)))?;
    // On a first visit the built-in clips are there, too.
    let mut saved = record_of(folder)?.unwrap_or_else(|| Session::new().saved());
    let new = arrivals
        .iter()
        .filter(|arrival| saved.entries.iter().all(|there| there.id != arrival.entry.id));
    let new: Vec<SavedEntry> = new.map(|arrival| arrival.entry.clone()).collect();
    saved.entries.extend(new);
    write_whole(&folder.join(RECORD), serde_json::to_string(&saved)?.as_bytes())
}

fn write(folder: &Path, work: &Work) -> io::Result<()> {
    write_files(folder, &work.files)?;
    let files = folder.join(FILES);
    let all =
        work.over(&record_of(folder)?.unwrap_or_default(), |sha256| files.join(sha256).exists());
    write_whole(&folder.join(RECORD), serde_json::to_string(&all)?.as_bytes())?;
    if folder.join(UNREAD).exists() {
        // It may need any of them.
        return Ok(());
    }
    // Last: until the record is replaced, the old one needs its files.
    let needed = all.files();
    for entry in fs::read_dir(&files)?.flatten() {
        if entry.file_name().to_str().is_none_or(|key| !needed.contains(key)) {
            fs::remove_file(entry.path())?;
        }
    }
    Ok(())
}

/// Writes beside the file and then in its place: whoever reads it finds the old one or the new one,
/// never half of one.
fn write_whole(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let beside = path.with_extension("part");
    fs::write(&beside, bytes)?;
    fs::rename(beside, path)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::platform::clip_of;

    fn stored_of(inbox: &Inbox) -> Option<Stored> {
        match inbox.take().pop_front() {
            Some(Incoming::Stored(stored)) => stored.map(|stored| *stored),
            other => panic!("expected what is stored, found {other:?}"),
        }
    }

    /// Work with clips from files of these keys, by somebody who knows of these and `removed` ones.
    fn work_of(query: &str, files: &[&str], removed: &[&str]) -> Work {
        Work {
            saved: Saved {
                query: query.to_owned(),
                entries: files.iter().map(|key| clip_of(&format!("{key}~{key}"))).collect(),
            },
            known: files.iter().chain(removed).map(|key| format!("{key}~{key}")).collect(),
            files: files
                .iter()
                .map(|&key| (key.to_owned(), FileBytes::Here(Arc::from(key.as_bytes()))))
                .collect(),
        }
    }

    fn arrival(key: &str) -> Arrival {
        Arrival {
            entry: clip_of(&format!("{key}~{key}")),
            sha256: key.to_owned(),
            bytes: FileBytes::Here(Arc::from(key.as_bytes())),
        }
    }

    fn emptied(name: &str) -> PathBuf {
        let folder =
            std::env::temp_dir().join(format!("segue-storage-{name}-{}", std::process::id()));
        fs::remove_dir_all(&folder).ok();
        folder
    }

    #[test]
    fn a_clip_that_has_come_is_stored_before_the_work_is() {
        let folder = emptied("arrival");
        let inbox = Inbox::default();
        let storage = Storage::open_in(folder.clone(), &inbox);
        storage.save(work_of("t=1", &["aa"], &[]));
        storage.store(vec![arrival("bb")]);
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
    fn a_record_that_cannot_be_read_is_told_and_kept_with_its_files() {
        let folder = emptied("unread");
        write(&folder, &work_of("t=1", &["aa"], &[])).unwrap();
        fs::write(folder.join(RECORD), "{\"garbage\":").unwrap();
        let inbox = Inbox::default();
        let storage = Storage::open_in(folder.clone(), &inbox);
        let told: Vec<Incoming> = inbox.take().into();
        assert!(
            matches!(&told[..], [Incoming::Stored(None), Incoming::Failed { reason }] if reason.to_string().contains(UNREAD)),
            "{told:?}"
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
    fn what_is_saved_last_is_there_again_and_nothing_else() {
        let folder = emptied("last");
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
    fn what_another_window_added_stays() {
        let folder = emptied("windows");
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
