//! Autosave: the stored work is restored at the start, a file is stored as soon as it is read, and
//! everything else shortly after a change.

mod restore;
mod save;
#[cfg(test)]
mod tests;

use crate::platform::Storage;
use segue_session::Session;
use std::collections::BTreeSet;

/// The longest time for which the page shows nothing while storage is being read, milliseconds.
const MAX_STARTUP_WAIT_MS: f64 = 150.0;
/// The longest time for which calls of the page's API wait for storage, milliseconds. A locked
/// storage may never answer.
const MAX_STORAGE_WAIT_MS: f64 = 4000.0;
/// The time without a change after which the work is stored, milliseconds.
const SAVE_DELAY_MS: f64 = 600.0;
/// The longest time between a change and its storage while changes continue, milliseconds.
const MAX_SAVE_INTERVAL_MS: f64 = 2000.0;

/// A fingerprint of the work. Two different ones mean that there is something to store.
#[derive(Clone, Debug, Default, PartialEq)]
struct Fingerprint {
    library: u64,
    query: String,
}

impl Fingerprint {
    fn of(session: &Session) -> Self {
        Self { library: session.library_revision(), query: session.stored_query() }
    }
}

/// The progress of restoring the stored work.
#[derive(Debug)]
enum Phase {
    /// Storage is being read, and nothing is shown yet.
    Waiting { since_ms: f64 },
    /// Storage took longer than [`MAX_STARTUP_WAIT_MS`], so the session has begun without it.
    /// Nothing is stored in this phase, because that would replace the work that is still to come.
    Late {
        /// The work as the session began; a different fingerprint means that the user changed it.
        baseline: Fingerprint,
        since_ms: f64,
    },
    /// The stored work is restored, or there is none.
    Ready,
}

/// The connection between a session and its storage.
#[derive(Debug)]
pub(crate) struct Autosave {
    /// `None` where nothing is stored.
    storage: Option<Storage>,
    phase: Phase,
    /// The link that the page was opened with; empty for none.
    link: String,
    /// The work that is in storage.
    stored: Fingerprint,
    /// The ids of all clips that this window has read from storage or written to it. Other clips
    /// in storage belong to other windows.
    known: BTreeSet<String>,
    /// The work at the last update.
    seen: Fingerprint,
    /// The session's revision at which `seen` was computed.
    revision: u64,
    /// The changes that are not stored yet.
    changed: Option<ChangeTimes>,
}

/// The times of the first and the last change since the work was stored, milliseconds.
#[derive(Clone, Copy, Debug)]
struct ChangeTimes {
    first_ms: f64,
    last_ms: f64,
}

impl Autosave {
    /// Returns an autosave that waits for the work in `storage`; without one, nothing is stored.
    /// `link` is the one that the page was opened with, or empty.
    pub(crate) fn new(storage: Option<Storage>, link: String, now_ms: f64) -> Self {
        Self {
            storage,
            phase: Phase::Waiting { since_ms: now_ms },
            link,
            stored: Fingerprint::default(),
            known: BTreeSet::new(),
            seen: Fingerprint::default(),
            revision: 0,
            changed: None,
        }
    }

    /// Returns whether storage is being read and nothing can be shown yet.
    pub(crate) fn is_waiting(&self) -> bool {
        matches!(self.phase, Phase::Waiting { .. })
    }

    /// Returns whether the session has begun without the stored work, and calls of the page's API
    /// still wait for it.
    pub(crate) fn is_late(&self, now_ms: f64) -> bool {
        self.late_ms(now_ms).is_some_and(|late_ms| late_ms < MAX_STORAGE_WAIT_MS)
    }

    /// Returns the time for which the session has gone on without the stored work, milliseconds;
    /// `None` once that is there or will not come.
    pub(crate) fn late_ms(&self, now_ms: f64) -> Option<f64> {
        match self.phase {
            Phase::Late { since_ms, .. } => Some(now_ms - since_ms),
            Phase::Waiting { .. } | Phase::Ready => None,
        }
    }

    /// Records the session's present work as stored.
    fn mark_stored(&mut self, session: &Session) {
        self.stored = Fingerprint::of(session);
        self.seen.clone_from(&self.stored);
        self.changed = None;
    }
}
