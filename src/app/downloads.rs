//! Downloads of files and lessons. Files are handed on in the order of their requests, because the
//! first one becomes A and the second one B.

use crate::platform::{self, Fetch, FileBytes, Inbox, fetch, file_name_of};
use segue_session::lesson::Source;
use segue_text::Message;
use std::collections::VecDeque;

/// The bytes of a file, or the reason why it was not fetched.
pub(crate) type FetchResult = Result<FileBytes, Message>;

/// All downloads that are under way.
#[derive(Debug, Default)]
pub(crate) struct Downloads {
    files: VecDeque<Download>,
    lessons: Vec<(Source, Fetch)>,
}

/// A file that is being fetched, or waits for those before it.
#[derive(Debug)]
struct Download {
    address: String,
    done: u64,
    total: Option<u64>,
    /// Its name, where the address has another one.
    name: Option<String>,
    fetched: Option<FetchResult>,
    /// Dropping it stops the transfer.
    _fetch: Fetch,
}

impl Downloads {
    /// Starts to fetch a file, unless it is under way already.
    pub(crate) fn start(&mut self, address: String, inbox: &Inbox) {
        if self.files.iter().any(|download| download.address == address) {
            return;
        }
        let fetch = fetch(&address, inbox);
        self.files.push_back(Download {
            address,
            done: 0,
            total: None,
            name: None,
            fetched: None,
            _fetch: fetch,
        });
    }

    /// Starts to fetch the text of a lesson.
    pub(crate) fn start_lesson(&mut self, source: Source, inbox: &Inbox) {
        let fetch = platform::load_lesson(&source, inbox);
        self.lessons.push((source, fetch));
    }

    /// Removes a lesson whose text was fetched, or has failed.
    pub(crate) fn end_lesson(&mut self, source: &Source) {
        self.lessons.retain(|(own, _)| own != source);
    }

    /// Stops all lessons. Returns those that were under way.
    pub(crate) fn end_lessons(&mut self) -> Vec<Source> {
        self.lessons.drain(..).map(|(source, _)| source).collect()
    }

    /// Stops all files but those that `wanted` accepts by their address.
    pub(crate) fn keep_only(&mut self, mut wanted: impl FnMut(&str) -> bool) {
        self.files.retain(|download| wanted(&download.address));
    }

    /// Records the progress of a file. Returns its name and the share of it that was received,
    /// 0 to 1, where the size is known.
    pub(crate) fn progressed(
        &mut self,
        address: &str,
        done: u64,
        total: Option<u64>,
    ) -> Option<(String, Option<f64>)> {
        let download = self.find(address)?;
        (download.done, download.total) = (done, total);
        Some((file_name_of(address), download.progress()))
    }

    /// Records that a file was fetched, or has failed. `name` is that of the file, where the
    /// address has another one.
    pub(crate) fn finished(&mut self, address: &str, name: Option<String>, fetched: FetchResult) {
        if let Some(download) = self.find(address) {
            (download.name, download.fetched) = (name, Some(fetched));
        }
    }

    /// Takes out the next file in order, once it is complete. Returns its name and the outcome.
    pub(crate) fn next_ready(&mut self) -> Option<(String, FetchResult)> {
        self.files.front()?.fetched.as_ref()?;
        let download = self.files.pop_front()?;
        let name = download.name.unwrap_or_else(|| file_name_of(&download.address));
        Some((name, download.fetched?))
    }

    /// Returns the name and the progress of every file under way.
    pub(crate) fn under_way(&self) -> impl Iterator<Item = (String, Option<f64>)> {
        self.files.iter().map(|download| (file_name_of(&download.address), download.progress()))
    }

    /// Returns the file names of the lessons under way.
    pub(crate) fn lessons_under_way(&self) -> impl Iterator<Item = String> {
        self.lessons.iter().map(|(source, _)| lesson_file(source))
    }

    /// Returns whether no file is under way.
    pub(crate) fn is_empty(&self) -> bool {
        self.files.is_empty()
    }

    fn find(&mut self, address: &str) -> Option<&mut Download> {
        self.files.iter_mut().find(|download| download.address == address)
    }
}

/// Returns the name of a lesson's file.
pub(crate) fn lesson_file(source: &Source) -> String {
    match source {
        Source::BuiltIn(file) => file.rsplit('/').next().unwrap_or(file).to_owned(),
        Source::Web(address) => file_name_of(address),
    }
}

impl Download {
    fn progress(&self) -> Option<f64> {
        self.total.filter(|&total| total > 0).map(|total| self.done as f64 / total as f64)
    }
}
