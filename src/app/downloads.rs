//! Files that come over the network, handed on in the order in which they were asked for: the first one is A, the second B.

use crate::platform::{Fetch, Inbox, fetch, file_name_of};
use std::collections::VecDeque;
use std::sync::Arc;

/// A name and bytes, or why there are none.
pub(crate) type Fetched = Result<(String, Arc<[u8]>), String>;

/// Everything under way.
#[derive(Debug, Default)]
pub(crate) struct Downloads(VecDeque<Download>);

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
        if self.0.iter().any(|download| download.address == address) {
            return;
        }
        let fetch = fetch(&address, inbox);
        self.0.push_back(Download {
            address,
            done: 0,
            total: None,
            fetched: None,
            _fetch: fetch,
        });
    }

    /// Stops what is not asked for any more.
    pub(crate) fn keep_only(&mut self, mut wanted: impl FnMut(&str) -> bool) {
        self.0.retain(|download| wanted(&download.address));
    }

    /// A part has come. Returns the file's name and how much of it there is, 0 to 1, where that is known.
    pub(crate) fn progressed(&mut self, address: &str, done: u64, total: Option<u64>) -> Option<(String, Option<f64>)> {
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

    /// The next file in order, once it is there.
    pub(crate) fn next_ready(&mut self) -> Option<Fetched> {
        self.0.front()?.fetched.as_ref()?;
        self.0.pop_front()?.fetched
    }

    /// Name and progress of everything under way.
    pub(crate) fn under_way(&self) -> impl Iterator<Item = (String, Option<f64>)> {
        self.0.iter().map(|download| (file_name_of(&download.address), download.progress()))
    }

    /// Whether nothing is under way.
    pub(crate) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    fn find(&mut self, address: &str) -> Option<&mut Download> {
        self.0.iter_mut().find(|download| download.address == address)
    }
}

impl Download {
    fn progress(&self) -> Option<f64> {
        self.total.filter(|&total| total > 0).map(|total| self.done as f64 / total as f64)
    }
}
