//! Files that are added to the library, and the memory that they need.

use super::Session;
use crate::files::{LoadedFile, setup_for_new};
use crate::library::{Arrival, Origin};
use crate::memory::{MemoryUse, PageMemory};
use crate::reading::{Content, ReadReport, ReadSetup, ReadTask};
use crate::samples::{SETS, SINGLES, Sample, SampleSet};
use segue_formats::ImportError;
use segue_text::Message;
use std::sync::Arc;

impl Session {
    /// Announces that the next `count` files were opened or dropped together: the library shows
    /// them as a group.
    pub fn open_together(&mut self, count: usize) {
        self.files.open_together(&self.document.library, count);
    }

    /// Reads one file, exactly as if it were dropped on the page: its clips join the library, and
    /// the first ones take the slots of built-in clips in A and B. It is read at once, unless it is
    /// larger than [`LARGE_BYTES`](crate::reading::LARGE_BYTES) or the session reads all files
    /// elsewhere: then it is requested with [`Request::Read`](crate::Request::Read), nothing is
    /// loaded yet, and an error is reported after reading.
    ///
    /// # Errors
    /// [`ImportError`] with name, line, column, found and expected; nothing already loaded changes.
    pub fn load(&mut self, name: &str, bytes: Arc<[u8]>) -> Result<LoadedFile, ImportError> {
        let arrival = self.files.next_by_hand();
        self.load_arriving(name, bytes, arrival)
    }

    /// Reads a file that was fetched from an address in the link: like [`Session::load`], but a
    /// clip that the link names for a slot stays, and a file that is in the library already takes
    /// no slot.
    ///
    /// # Errors
    /// Those of [`Session::load`].
    pub fn load_fetched(
        &mut self,
        name: &str,
        bytes: Arc<[u8]>,
    ) -> Result<LoadedFile, ImportError> {
        self.load_arriving(name, bytes, Arrival::ByLink)
    }

    fn load_arriving(
        &mut self,
        name: &str,
        bytes: Arc<[u8]>,
        arrival: Arrival,
    ) -> Result<LoadedFile, ImportError> {
        let (document, notices) = (&mut self.document, &mut self.notices);
        let loaded = self.files.load(document, notices, name, bytes, arrival);
        self.refresh();
        loaded
    }

    /// Returns the setup for reading a file in order to convert it, with the skeleton files that
    /// the library knows.
    #[must_use]
    pub fn setup_for_conversion(&self) -> ReadSetup {
        setup_for_new(&self.document.library)
    }

    /// Requests a file to be read elsewhere ([`Request::Read`](crate::Request::Read)) and then
    /// added to the library, as by [`Session::load`]. Returns the task's number.
    pub fn begin_reading(&mut self, name: &str, content: Content, size: u64) -> u64 {
        self.revision += 1;
        let arrival = self.files.next_by_hand();
        self.files.begin_reading(&self.document.library, name, content, size, arrival)
    }

    /// Requests a file as [`Session::begin_reading`] does, for one that was fetched: its clips join
    /// the library as by [`Session::load_fetched`].
    pub fn begin_reading_fetched(&mut self, name: &str, content: Content, size: u64) -> u64 {
        self.revision += 1;
        self.files.begin_reading(&self.document.library, name, content, size, Arrival::ByLink)
    }

    /// Records the number of bytes of a task's file that were read.
    pub fn progress_reading(&mut self, task: u64, done: u64) {
        self.files.progress_reading(task, done);
        self.revision += 1;
    }

    /// Returns the key of the file that a task reads, if its bytes are outside the document.
    #[must_use]
    pub fn reading_key(&self, task: u64) -> Option<&str> {
        self.files.reading_key(task)
    }

    /// Processes the report on a file, or the reason why there is none. Returns `None` if the task
    /// was stopped, or if the file has to be read again.
    pub fn finish_reading(
        &mut self,
        task: u64,
        report: Result<ReadReport, Message>,
    ) -> Option<Result<LoadedFile, Message>> {
        let (document, notices) = (&mut self.document, &mut self.notices);
        let finished = self.files.finish_reading(document, notices, task, report);
        self.refresh();
        finished
    }

    /// Returns whether the file of a clip is being read again.
    #[must_use]
    pub fn is_reading_clip(&self, reference: &str) -> bool {
        let entry = self.document.library.find(reference);
        entry.is_some_and(|entry| match &entry.origin {
            Origin::File(file) => self.files.is_read_again(file),
            _ => false,
        })
    }

    /// Returns the task that reads a file of that name; `None` if none does.
    #[must_use]
    pub fn task_of(&self, name: &str) -> Option<u64> {
        self.files.task_of(name)
    }

    /// Moves the bytes of the files of these clips out of the document: it refers to them by their
    /// SHA-256 from now on, by which the app has to keep what is returned.
    pub fn move_bytes_outside(&mut self, ids: &[String]) -> Vec<(String, Arc<[u8]>)> {
        self.document.library.move_bytes_outside(ids)
    }

    /// Sets the most memory of motions that nothing uses, bytes. Beyond it, the least recently used
    /// are dropped, and read again from their files when they are needed. Without a limit, all
    /// stay.
    pub fn limit_idle_motions(&mut self, bytes: u64) {
        self.files.limit_idle_motions(bytes);
    }

    /// Returns whether a task is in progress.
    #[must_use]
    pub fn is_reading(&self, task: u64) -> bool {
        self.files.is_reading(task)
    }

    /// Returns whether files are being read that are not in the library yet.
    #[must_use]
    pub fn is_reading_new(&self) -> bool {
        self.files.is_reading_new()
    }

    /// Returns whether a task reads a file that is not in the library yet.
    #[must_use]
    pub fn brings_clips(&self, task: u64) -> bool {
        self.files.brings_clips(task)
    }

    /// Returns whether a file is being read that takes only a moment, and so has no progress bar.
    #[must_use]
    pub fn is_reading_small(&self) -> bool {
        self.files.is_reading_small()
    }

    /// Returns whether any file is being read.
    #[must_use]
    pub fn is_reading_any(&self) -> bool {
        self.files.is_reading_any()
    }

    /// Returns the bundled takes that belong to no set.
    #[must_use]
    pub fn samples() -> &'static [Sample] {
        &SINGLES
    }

    /// Returns the sets of bundled takes.
    #[must_use]
    pub fn sample_sets() -> &'static [SampleSet] {
        &SETS
    }

    /// Returns the bundled takes that were requested and have not arrived.
    #[must_use]
    pub fn awaited_samples(&self) -> &[&'static Sample] {
        self.files.awaited_samples()
    }

    /// Returns how many of the takes that were requested together have arrived, and their number;
    /// `None` while none is awaited.
    #[must_use]
    pub fn samples_progress(&self) -> Option<(usize, usize)> {
        self.files.samples_progress()
    }

    /// Loads a bundled take that was requested with [`Request::Sample`](crate::Request::Sample);
    /// `packed` is its gzip file. If files are read elsewhere, this only begins to read it.
    ///
    /// # Errors
    /// [`ImportError`] if it is damaged. If it is read elsewhere, that is reported after reading.
    pub fn load_sample(
        &mut self,
        sample: &'static Sample,
        packed: &[u8],
    ) -> Result<(), ImportError> {
        let (document, notices) = (&mut self.document, &mut self.notices);
        let loaded = self.files.load_sample(document, notices, sample, packed);
        self.refresh();
        loaded
    }

    /// Reports why a requested take has not arrived. The next command that needs it requests it
    /// again.
    pub fn fail_sample(&mut self, sample: &'static Sample, reason: impl Into<Message>) {
        self.files.fail_sample(&mut self.document, &mut self.notices, sample, reason);
        self.refresh();
    }

    /// Records the size of the page's memory. Once more than half of it is in use, drops the
    /// motions that nothing uses, and those that only steps of undo contain: they are read again
    /// when they are needed.
    pub fn note_memory(&mut self, page: PageMemory) {
        if self.files.note_memory(page, &mut self.document) {
            self.labs.feet.forget_dropped();
        }
    }

    /// Returns the memory in use; `None` if it is unlimited.
    #[must_use]
    pub fn memory(&self) -> Option<MemoryUse> {
        self.files.memory()
    }

    /// Returns the memory that a task's file is expected to need, bytes, if that is more than is
    /// left.
    #[must_use]
    pub fn memory_lacking_for(&self, task: &ReadTask) -> Option<u64> {
        self.files.memory_lacking_for(task)
    }

    /// Ends a task because there is no memory for the `needed` bytes of its clips. Returns `None`
    /// if the task was stopped already.
    pub fn refuse_for_memory(
        &mut self,
        task: u64,
        needed: u64,
    ) -> Option<Result<LoadedFile, Message>> {
        let (document, notices) = (&mut self.document, &mut self.notices);
        let reason = self.files.refuse_for_memory(document, notices, task, needed)?;
        self.refresh();
        Some(Err(reason))
    }
}
