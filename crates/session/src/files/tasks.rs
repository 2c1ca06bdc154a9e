//! Files that are read elsewhere: progress, end and cancellation.

use super::admission::refill;
use super::arrivals::Arrivals;
use super::intake::{FileIntake, LoadedFile, Purpose, Reading};
use super::messages::notify_unread;
use super::setup::{lacks_skeleton, setup_for_new, setup_of};
use super::skeletons::{drop_used_skeletons, offer_moving};
use crate::command::Request;
use crate::document::Document;
use crate::labs::JobKind;
use crate::library::{Arrival, Library, SourceFile};
use crate::notice::{Level, Notices};
use crate::reading::{Content, ReadReport, ReadTask};
use segue_text::{Message, ToMessage, msg};

/// Work that takes longer than a frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Job {
    /// The number by which it can be stopped; `None` for a computation, and for many files at once
    /// ([`StopReadingNew`](crate::FileCommand::StopReadingNew)).
    pub task: Option<u64>,
    /// Its kind.
    pub kind: JobKind,
    /// The progress, 0 to 1.
    pub progress: f64,
    /// The size of the file or files, bytes; `None` for a computation.
    pub size: Option<u64>,
}

impl Job {
    /// Returns whether it is a computation, and reads no files.
    #[must_use]
    pub fn is_computed(&self) -> bool {
        self.size.is_none()
    }
}

impl FileIntake {
    /// Requests that a file of the library be read again elsewhere, as its entries say, unless this
    /// is in progress. `arrival` is that of [`Purpose::Again`].
    pub(crate) fn read_again(
        &mut self,
        document: &mut Document,
        file: SourceFile,
        arrival: Option<Arrival>,
    ) {
        let setup = setup_of(&document.library, &file);
        let same = |reading: &Reading| {
            reading.task.setup == setup
                && reading.task.name == file.name
                && reading.task.content == file.content
        };
        if !self.reading.values().any(same) {
            mark_unread(&mut document.library, &file.sha256, None);
            self.begin(&file.name, file.content, file.size, setup, Purpose::Again(arrival));
        }
    }

    /// Returns whether a file of the library is being read again.
    pub(crate) fn is_read_again(&self, file: &SourceFile) -> bool {
        let sha256 = Some(file.sha256.as_str());
        self.reading.values().any(|reading| reading.task.setup.sha256.as_deref() == sha256)
    }

    /// Records the number of bytes of a task's file that were read.
    pub(crate) fn progress_reading(&mut self, task: u64, done: u64) {
        if let Some(reading) = self.reading.get_mut(&task) {
            reading.done = done;
        }
    }

    /// Returns the key of the file that a task reads, if its bytes are outside the document.
    pub(crate) fn reading_key(&self, task: u64) -> Option<&str> {
        let reading = self.reading.get(&task)?;
        match &reading.task.content {
            Content::Outside(key) => Some(key),
            Content::Here(_) => None,
        }
    }

    /// Processes the report on a file, or the reason why there is none. Returns `None` if the task
    /// was stopped, or if the file has to be read again.
    pub(crate) fn finish_reading(
        &mut self,
        document: &mut Document,
        notices: &mut Notices,
        task: u64,
        report: Result<ReadReport, Message>,
    ) -> Option<Result<LoadedFile, Message>> {
        let report = match report {
            Ok(report) => report,
            Err(reason) => {
                let (name, _) = self.file_of_task(task)?;
                let name = name.to_owned();
                let text = msg!("{name} could not be read: {reason}.");
                return self.fail_reading(document, notices, task, reason, text).map(Err);
            }
        };
        let Reading { task, purpose, .. } = self.end_task(task)?;
        // From now on, a file outside the document is known by its content.
        let content = match (task.content.clone(), report.files.as_slice()) {
            (Content::Outside(_), [file]) if report.is_one_file() => {
                Content::Outside(file.sha256.clone())
            }
            (content, _) => content,
        };
        let loaded = match purpose {
            Purpose::Again(arrival) => {
                let waiting: Vec<String> = (document.library.entries().iter())
                    .filter(|entry| entry.awaits_skeleton())
                    .map(|entry| entry.id.clone())
                    .collect();
                let refilled = refill(document, report, &task.setup.options);
                if let Err(error) = &refilled {
                    mark_unread(
                        &mut document.library,
                        task.setup.sha256.as_deref().unwrap_or_default(),
                        Some(&error.to_message()),
                    );
                    notify_unread(notices, error);
                }
                if let Some(arrival) = arrival {
                    for id in &waiting {
                        offer_moving(document, id, arrival);
                    }
                }
                drop_used_skeletons(&mut document.library);
                refilled
            }
            // Its skeleton was dropped with it, and has arrived meanwhile. A file from an archive
            // is read again from there.
            Purpose::New(_)
                if report.is_one_file()
                    && lacks_skeleton(&document.library, &report, &task.setup) =>
            {
                let setup = setup_for_new(&document.library);
                self.arrivals.take_back(task.size);
                self.request(ReadTask { content, setup, ..task }, purpose);
                return None;
            }
            Purpose::New(arrival) => {
                self.admit(document, notices, report, &content, &task.setup, arrival)
            }
            Purpose::Sample(sample) => {
                self.take_sample(document, notices, sample, report).map(|()| LoadedFile::default())
            }
        };
        for id in loaded.iter().flat_map(|loaded| &loaded.ids) {
            self.note_use(id);
        }
        Some(loaded.map_err(|error| error.to_message()))
    }

    /// Ends a task without a report, and returns the reason; `text` is the notice. Returns `None`
    /// if the task was stopped already.
    pub(crate) fn fail_reading(
        &mut self,
        document: &mut Document,
        notices: &mut Notices,
        task: u64,
        reason: Message,
        text: Message,
    ) -> Option<Message> {
        let Reading { task, purpose, .. } = self.end_task(task)?;
        if let Purpose::Sample(sample) = purpose {
            // Requested at once, it would fail again and again: the next command requests it.
            self.fail_sample(document, notices, sample, reason.clone());
            return Some(reason);
        }
        if let Purpose::Again(_) = purpose {
            mark_unread(
                &mut document.library,
                task.setup.sha256.as_deref().unwrap_or_default(),
                Some(&text),
            );
        }
        notices.say_of(Level::Error, &task.name, text);
        Some(reason)
    }

    fn end_task(&mut self, task: u64) -> Option<Reading> {
        self.reading.remove(&task)
    }

    /// Returns whether a task is in progress.
    pub(crate) fn is_reading(&self, task: u64) -> bool {
        self.reading.contains_key(&task)
    }

    /// Returns whether files are being read that are not in the library yet.
    pub(crate) fn is_reading_new(&self) -> bool {
        self.reading.values().any(Reading::is_new)
    }

    /// Returns whether a task reads a file that is not in the library yet.
    pub(crate) fn brings_clips(&self, task: u64) -> bool {
        self.reading.get(&task).is_some_and(Reading::is_new)
    }

    /// Returns whether a file is being read that takes only a moment, and so has no progress bar.
    pub(crate) fn is_reading_small(&self) -> bool {
        let together = self.are_read_together();
        let counts = |reading: &Reading| !(together && reading.is_new() && reading.is_by_hand());
        self.reading.values().any(|reading| reading.is_small() && counts(reading))
    }

    /// Returns whether so many files are to join the library that they are one job.
    fn are_read_together(&self) -> bool {
        self.arrivals.files >= MIN_TOGETHER && self.is_reading_new()
    }

    /// Returns whether any file is being read.
    pub(crate) fn is_reading_any(&self) -> bool {
        !self.reading.is_empty()
    }

    /// Stops a task.
    pub(crate) fn stop_reading(&mut self, document: &mut Document, task: u64) {
        let forget = self.reading_key(task).map(str::to_owned);
        let Some(Reading { task, purpose, .. }) = self.reading.remove(&task) else {
            return;
        };
        let again = matches!(purpose, Purpose::Again(_));
        if again {
            let text = msg!("Reading {name} was stopped: drop the file again.", name = task.name);
            mark_unread(
                &mut document.library,
                task.setup.sha256.as_deref().unwrap_or_default(),
                Some(&text),
            );
        }
        self.requests
            .push(Request::StopReading { task: task.id, forget: forget.filter(|_| !again) });
    }

    /// Returns the task that reads a file of that name.
    pub(crate) fn task_of(&self, name: &str) -> Option<u64> {
        let mut tasks = self.reading.values().map(|reading| &reading.task);
        tasks.find(|task| task.name == name).map(|task| task.id)
    }

    /// Stops all tasks whose files are to join the library.
    pub(crate) fn stop_reading_new(&mut self, document: &mut Document) {
        let new = self.reading.iter().filter(|(_, reading)| reading.is_new());
        for task in new.map(|(task, _)| *task).collect::<Vec<_>>() {
            self.stop_reading(document, task);
        }
    }

    /// Returns the large files that are being read; many files that are to join the library are one
    /// job.
    pub(crate) fn jobs(&self) -> impl Iterator<Item = Job> + '_ {
        let together = self.are_read_together();
        let files = (self.reading.values())
            .filter(move |reading| !(reading.is_small() || together && reading.is_new()));
        let alone = files.map(|Reading { task, done, .. }| Job {
            task: Some(task.id),
            kind: JobKind::Reading(task.name.clone()),
            progress: *done as f64 / task.size.max(1) as f64,
            size: Some(task.size),
        });
        together.then(|| self.arrivals_job()).into_iter().chain(alone)
    }

    /// Returns the job of the files that are to join the library.
    fn arrivals_job(&self) -> Job {
        let Arrivals { files, bytes } = self.arrivals;
        let (mut waiting, mut left) = (0, 0_u64);
        for reading in self.reading.values().filter(|reading| reading.is_new()) {
            waiting += 1;
            left = left.saturating_add(reading.task.size.saturating_sub(reading.done));
        }
        Job {
            task: None,
            kind: JobKind::ReadingFiles { done: files.saturating_sub(waiting), all: files },
            progress: 1.0 - left as f64 / bytes.max(1) as f64,
            size: Some(bytes),
        }
    }
}

/// The number of files to join the library from which on they are one job.
const MIN_TOGETHER: usize = 5;

/// Records in the clips of a file why they have no motion, so that it is not read over and over.
fn mark_unread(library: &mut Library, sha256: &str, why: Option<&Message>) {
    let entries = library.entries().to_vec();
    for entry in entries.iter().filter(|entry| entry.sha256() == Some(sha256)) {
        library.change(&entry.id, |entry| entry.unread = why.cloned());
    }
}
