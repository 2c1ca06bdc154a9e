//! Files and lessons that come over the network. Files are handed on in the order in which they
//! were asked for: the first one is A, the second B.

use crate::platform::{self, Fetch, FileBytes, Inbox, fetch, file_name_of};
use segue_session::lesson::Source;
use segue_text::Message;
use std::collections::VecDeque;

/// Bytes, or why there are none.
pub(crate) type Fetched = Result<FileBytes, Message>;

/// Everything under way.
#[derive(Debug, Default)]
pub(crate) struct Downloads {
    files: VecDeque<Download>,
    lessons: Vec<(Source, Fetch)>,
}

#[derive(Debug)]
struct Download {
    address: String,
    done: u64,
    total: Option<u64>,
    fetched: Option<Fetched>,
    _fetch: Fetch,
}

impl Downloads {
    /// Asks for a file, unless it is under way already.
    pub(crate) fn start(&mut self, address: String, inbox: &Inbox) {
        if self.files.iter().any(|download| download.address == address) {
            return;
        }
        let fetch = fetch(&address, inbox);
        self.files.push_back(Download {
            address,
            done: 0,
            total: None,
            fetched: None,
            _fetch: fetch,
        });
    }

    /// Asks for the text of a lesson.
    pub(crate) fn start_lesson(&mut self, source: Source, inbox: &Inbox) {
        let fetch = platform::load_lesson(&source, inbox);
        self.lessons.push((source, fetch));
    }

    /// The text of a lesson has come, or will not come.
    pub(crate) fn end_lesson(&mut self, source: &Source) {
        self.lessons.retain(|(own, _)| own != source);
    }

    /// Stops all lessons. Returns which there were.
    pub(crate) fn end_lessons(&mut self) -> Vec<Source> {
        self.lessons.drain(..).map(|(source, _)| source).collect()
    }

    /// Stops files that are not asked for any more.
    pub(crate) fn keep_only(&mut self, mut wanted: impl FnMut(&str) -> bool) {
        self.files.retain(|download| wanted(&download.address));
    }

    /// A part has come. Returns the file's name and how much of it there is, 0 to 1, where that is
    /// known.
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

    /// A file has come, or will not come.
    pub(crate) fn finished(&mut self, address: &str, fetched: Fetched) {
        if let Some(download) = self.find(address) {
            download.fetched = Some(fetched);
        }
    }

    /// The name and the outcome of the next file in order, once it is there.
    pub(crate) fn next_ready(&mut self) -> Option<(String, Fetched)> {
        self.files.front()?.fetched.as_ref()?;
        let download = self.files.pop_front()?;
        Some((file_name_of(&download.address), download.fetched?))
    }

    /// Name and progress of every file under way.
    pub(crate) fn under_way(&self) -> impl Iterator<Item = (String, Option<f64>)> {
        self.files.iter().map(|download| (file_name_of(&download.address), download.progress()))
    }

    /// The files in which the lessons under way stand.
    pub(crate) fn lessons_under_way(&self) -> impl Iterator<Item = String> {
        self.lessons.iter().map(|(source, _)| lesson_file(source))
    }

    /// Whether no file is under way.
    pub(crate) fn is_empty(&self) -> bool {
        self.files.is_empty()
    }

    fn find(&mut self, address: &str) -> Option<&mut Download> {
        self.files.iter_mut().find(|download| download.address == address)
    }
}

/// The name of the file in which a lesson stands.
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
