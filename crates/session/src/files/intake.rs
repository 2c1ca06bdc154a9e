//! The files that are being added to the library.

use super::arrivals::Arrivals;
use super::motion_uses::MotionUses;
use super::setup::setup_for_new;
use crate::bone_map::is_bone_map;
use crate::command::{CommandError, FileCommand, Request};
use crate::document::Document;
use crate::library::{Arrival, Library};
use crate::memory::{Memory, MemoryUse, PageMemory, expected_bytes, library_bytes, refusal};
use crate::notice::{Level, Notices};
use crate::outside;
use crate::reading::{Content, LARGE_BYTES, Product, ReadFunction, ReadSetup, ReadTask};
use crate::samples::Sample;
use segue_formats::ImportError;
use segue_text::{Message, msg};
use std::collections::BTreeMap;
use std::sync::Arc;

/// The greatest number of addresses of files in a link.
const MAX_SOURCES: usize = 16;

/// The content of a file that was read.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LoadedFile {
    /// The ids of its clips.
    pub ids: Vec<String>,
    /// The oddities in it, one sentence each.
    pub warnings: Vec<Message>,
}

/// A file that is being read elsewhere.
#[derive(Debug)]
pub(super) struct Reading {
    pub(super) task: ReadTask,
    /// The number of bytes that were read.
    pub(super) done: u64,
    pub(super) purpose: Purpose,
}

/// The purpose of reading a file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Purpose {
    /// Adding its clips to the library.
    New(Arrival),
    /// Replacing the motion of its clips, which are in the library. Those that waited for a
    /// skeleton, which has arrived in this way, are offered A and B.
    Again(Option<Arrival>),
    /// The motion of a bundled take.
    Sample(&'static Sample),
}

impl Reading {
    pub(super) fn is_small(&self) -> bool {
        self.task.size <= LARGE_BYTES || matches!(self.purpose, Purpose::Sample(_))
    }

    pub(super) fn is_new(&self) -> bool {
        matches!(self.purpose, Purpose::New(_))
    }

    /// Returns whether the user opened the file, in contrast to a link.
    pub(super) fn is_by_hand(&self) -> bool {
        matches!(
            self.purpose,
            Purpose::New(Arrival::ByHand(_)) | Purpose::Again(Some(Arrival::ByHand(_)))
        )
    }

    /// Returns the number of the selection that the file belongs to.
    fn batch(&self) -> Option<u32> {
        match self.purpose {
            Purpose::New(arrival) => arrival.batch(),
            Purpose::Again(_) | Purpose::Sample(_) => None,
        }
    }
}

/// The bundled takes that were requested and have not arrived.
#[derive(Debug, Default)]
pub(super) struct AwaitedSamples {
    pub(super) samples: Vec<&'static Sample>,
    /// The number that was requested since none was awaited.
    pub(super) asked: usize,
    /// Those that failed, and are not requested again before the next command.
    pub(super) failed: Vec<&'static Sample>,
}

/// A selection of files that were opened together.
#[derive(Clone, Copy, Debug)]
struct Batch {
    number: u32,
    /// The number of its files that have not arrived.
    left: usize,
}

/// The files that are being read, and the requests to the app for them.
#[derive(Debug)]
pub(crate) struct FileIntake {
    /// The function that reads small files at once; `None` where all files are read elsewhere.
    pub(super) reads: Option<ReadFunction>,
    /// By the numbers of their tasks.
    pub(super) reading: BTreeMap<u64, Reading>,
    /// The number of tasks so far.
    tasks: u64,
    pub(super) requests: Vec<Request>,
    pub(super) samples: AwaitedSamples,
    /// The page's memory, if it is limited.
    memory: Option<Memory>,
    /// The selection whose files are arriving.
    batch: Option<Batch>,
    /// The library revision at which motions were dropped last because memory was scarce.
    dropped_at: Option<u64>,
    pub(super) uses: MotionUses,
    pub(super) arrivals: Arrivals,
}

impl FileIntake {
    pub(crate) fn new(reads: Option<ReadFunction>) -> Self {
        Self {
            reads,
            reading: BTreeMap::new(),
            tasks: 0,
            requests: Vec::new(),
            samples: AwaitedSamples::default(),
            memory: None,
            batch: None,
            dropped_at: None,
            uses: MotionUses::default(),
            arrivals: Arrivals::default(),
        }
    }

    /// Returns the requests to the app since the last call.
    pub(crate) fn take_requests(&mut self) -> Vec<Request> {
        std::mem::take(&mut self.requests)
    }

    /// Carries out a command.
    ///
    /// # Errors
    /// [`CommandError`] with the reason; the document is then unchanged.
    pub(crate) fn apply(
        &mut self,
        command: FileCommand,
        document: &mut Document,
        notices: &mut Notices,
    ) -> Result<(), CommandError> {
        match command {
            FileCommand::LoadSamples(set) => self.load_samples(document, notices, set),
            FileCommand::SetRoles(id, changes) => self.set_roles(document, &id, &changes)?,
            FileCommand::ResetRoles(id) => self.reset_roles(document, &id)?,
            FileCommand::ApplyBoneMap(map) => self.apply_bone_map(document, notices, &map),
            FileCommand::Reimport(id, options) => self.reimport(document, &id, &options)?,
            FileCommand::Correct(notice) => self.correct(document, notices, notice),
            FileCommand::StopReading(task) => self.stop_reading(document, task),
            FileCommand::StopReadingNew => self.stop_reading_new(document),
            FileCommand::Read(id) => self.read_if_dropped(document, &id)?,
        }
        Ok(())
    }

    /// Requests the files at addresses that a link names. An address that cannot be fetched is
    /// refused by itself.
    pub(crate) fn fetch(&mut self, addresses: Vec<String>, notices: &mut Notices) {
        if addresses.len() > MAX_SOURCES {
            notices.say(
                Level::Warning,
                msg!(
                    "The link names {count} files; the first {MAX_SOURCES} are loaded.",
                    count = addresses.len()
                ),
            );
        }
        for address in addresses.into_iter().take(MAX_SOURCES) {
            if address.starts_with("https://") || address.starts_with("http://") {
                self.requests.push(Request::Fetch(address));
            } else {
                notices.say(
                    Level::Error,
                    msg!(
                        "src: found `{address}`, expected an address that starts with https://.",
                        address = outside::short(&address)
                    ),
                );
            }
        }
    }

    /// Reads a file and adds its clips to the library: at once, or by a task if it is large or all
    /// files are read elsewhere. Nothing is loaded yet then.
    ///
    /// # Errors
    /// [`ImportError`] if the file cannot be read; nothing already loaded changes.
    pub(crate) fn load(
        &mut self,
        document: &mut Document,
        notices: &mut Notices,
        name: &str,
        bytes: Arc<[u8]>,
        arrival: Arrival,
    ) -> Result<LoadedFile, ImportError> {
        if is_bone_map(&bytes) {
            return Ok(self.load_bone_map(document, notices, name, &bytes));
        }
        let (name, setup, size) =
            (&outside::file_name(name), setup_for_new(&document.library), bytes.len() as u64);
        let Some(read) = self.reads.filter(|_| size <= LARGE_BYTES) else {
            self.begin(name, Content::Here(bytes), size, setup, Purpose::New(arrival));
            return Ok(LoadedFile::default());
        };
        let report = read(name, &bytes, &setup, &mut |_| true).unwrap_or_default();
        self.admit(document, notices, report, &Content::Here(bytes), &setup, arrival)
    }

    /// Begins a selection of files, with a number that no clip of the library has. A file alone is
    /// no selection.
    pub(crate) fn open_together(&mut self, library: &Library, count: usize) {
        let known = library.entries().iter().filter_map(|entry| entry.batch);
        let read = self.reading.values().filter_map(Reading::batch);
        let number = known.chain(read).max().map_or(1, |last| last.saturating_add(1));
        self.batch = (count > 1).then_some(Batch { number, left: count });
    }

    /// Returns the arrival of the next file that the user opened.
    pub(crate) fn next_by_hand(&mut self) -> Arrival {
        let Some(batch) = self.batch.as_mut().filter(|batch| batch.left > 0) else {
            return Arrival::ByHand(None);
        };
        batch.left -= 1;
        Arrival::ByHand(Some(batch.number))
    }

    /// Requests that a file be read elsewhere and then added to the library. Returns the task's
    /// number.
    pub(crate) fn begin_reading(
        &mut self,
        library: &Library,
        name: &str,
        content: Content,
        size: u64,
        arrival: Arrival,
    ) -> u64 {
        self.begin(name, content, size, setup_for_new(library), Purpose::New(arrival))
    }

    /// Records the size of the page's memory. Once more than half of it is in use, drops the
    /// motions that nothing uses, and those that only steps of undo contain: they are read again
    /// when they are needed. Returns whether there were any.
    pub(crate) fn note_memory(&mut self, page: PageMemory, document: &mut Document) -> bool {
        let memory = Memory::follow(self.memory, page, library_bytes(&document.library));
        self.memory = Some(memory);
        // Once for every change, because there may be many steps with many clips.
        let revision = document.library_revision;
        if !memory.is_scarce() || self.dropped_at.replace(revision) == Some(revision) {
            return false;
        }
        let any_idle = self.uses.max_idle_bytes < u64::MAX && self.drop_idle_beyond(document, 0);
        document.drop_motions_of_steps() || any_idle
    }

    /// Returns the memory in use; `None` if it is unlimited.
    pub(crate) fn memory(&self) -> Option<MemoryUse> {
        self.memory.as_ref().map(Memory::in_use)
    }

    /// Returns the memory that a task's file is expected to need, bytes, if that is more than is
    /// left.
    pub(crate) fn memory_lacking_for(&self, task: &ReadTask) -> Option<u64> {
        let needed = expected_bytes(&task.name, task.size);
        self.memory().is_some_and(|memory| needed > memory.left()).then_some(needed)
    }

    /// Ends a task because there is no memory for the `needed` bytes of its clips. Returns `None`
    /// if the task was stopped already.
    pub(crate) fn refuse_for_memory(
        &mut self,
        document: &mut Document,
        notices: &mut Notices,
        task: u64,
        needed: u64,
    ) -> Option<Message> {
        let (name, size) = self.file_of_task(task)?;
        let memory = self.memory().unwrap_or(MemoryUse { used: 0, limit: 0 });
        let text = refusal(name, size, needed, memory, &document.library);
        self.fail_reading(document, notices, task, text.clone(), text)
    }

    /// Requests that a file be read elsewhere. Returns the task's number.
    pub(super) fn begin(
        &mut self,
        name: &str,
        content: Content,
        size: u64,
        setup: ReadSetup,
        purpose: Purpose,
    ) -> u64 {
        self.tasks += 1;
        let task = ReadTask {
            id: self.tasks,
            name: outside::file_name(name),
            content,
            size,
            setup,
            product: Product::Clips,
        };
        self.request(task, purpose);
        self.tasks
    }

    pub(super) fn request(&mut self, task: ReadTask, purpose: Purpose) {
        self.requests.push(Request::Read(task.clone()));
        let reading = Reading { task, done: 0, purpose };
        if reading.is_new() {
            let is_first = !self.is_reading_new();
            self.arrivals.add(reading.task.size, is_first);
        }
        self.reading.insert(reading.task.id, reading);
    }

    /// Returns the name and the size of the file that a task reads, bytes.
    pub(super) fn file_of_task(&self, task: u64) -> Option<(&str, u64)> {
        let reading = self.reading.get(&task)?;
        Some((&reading.task.name, reading.task.size))
    }
}
