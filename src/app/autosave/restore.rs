//! Restoring of stored work, at the start and from other windows.

use super::{Autosave, Fingerprint, MAX_STARTUP_WAIT_MS, Phase};
use crate::platform::{LargeFileStore, StoredFiles, StoredWork};
use segue_session::{Saved, SavedEntry, Session};

impl Autosave {
    /// Begins the session without the stored work when that takes too long. Returns whether the
    /// session has begun in this call.
    pub(crate) fn begin_if_overdue(
        &mut self,
        session: &mut Session,
        large_files: &mut LargeFileStore,
        now_ms: f64,
    ) -> bool {
        let Phase::Waiting { since_ms } = self.phase else {
            return false;
        };
        if self.storage.is_some() && now_ms - since_ms < MAX_STARTUP_WAIT_MS {
            return false;
        }
        self.open(session, large_files, None);
        self.phase = if self.storage.is_some() {
            Phase::Late { baseline: Fingerprint::of(session), since_ms }
        } else {
            Phase::Ready
        };
        true
    }

    /// Takes the session's present work for the one that it begins with. Any later difference
    /// counts as a change by the user.
    pub(crate) fn set_baseline(&mut self, session: &Session) {
        if let Phase::Late { baseline, .. } = &mut self.phase {
            *baseline = Fingerprint::of(session);
        }
    }

    /// Restores the work that was read from storage; `None` where there is none. Returns whether
    /// the page's address leads to what is now shown.
    pub(crate) fn on_loaded(
        &mut self,
        session: &mut Session,
        large_files: &mut LargeFileStore,
        stored: Option<StoredWork>,
    ) -> bool {
        let nothing = stored.is_none();
        let stored = stored.map(|stored| LoadedWork::new(stored, session));
        if let Some(stored) = &stored {
            self.known.extend(stored.saved.entries.iter().map(|entry| entry.id.clone()));
        }
        match std::mem::replace(&mut self.phase, Phase::Ready) {
            Phase::Waiting { .. } => {
                self.open(session, large_files, stored);
                return nothing || !self.link.is_empty();
            }
            Phase::Late { baseline, .. } => {
                let Some(stored) = stored else { return false };
                let content_of = |key: &str| large_files.restore(&stored.files, key);
                if self.link.is_empty() && Fingerprint::of(session) == baseline {
                    session.restore(&stored.saved, content_of, None);
                    self.mark_stored(session);
                } else {
                    // The user's changes stay, and will be stored.
                    session.restore_late(&stored.saved, content_of);
                }
            }
            Phase::Ready => {}
        }
        false
    }

    /// Fetches clips that another window has announced as stored, except those that this window
    /// has, or had and removed.
    pub(crate) fn on_stored_elsewhere(&self, session: &Session, entries: Vec<SavedEntry>) {
        let is_new = |entry: &SavedEntry| {
            !self.known.contains(&entry.id) && session.library().get(&entry.id).is_none()
        };
        let new: Vec<SavedEntry> = entries.into_iter().filter(is_new).collect();
        if let Some(storage) = self.storage.as_ref().filter(|_| !new.is_empty()) {
            storage.fetch(new);
        }
    }

    /// Adds the fetched clips of another window to the library. They are stored already.
    pub(crate) fn on_fetched_elsewhere(
        &mut self,
        session: &mut Session,
        large_files: &mut LargeFileStore,
        stored: &StoredWork,
    ) {
        let was_stored = self.stored == Fingerprint::of(session);
        self.known.extend(stored.loose.iter().map(|entry| entry.id.clone()));
        session.add_stored(&stored.loose, |key| large_files.restore(&stored.files, key));
        if was_stored {
            self.mark_stored(session);
        }
    }

    /// Begins the session with the stored work and the page's link.
    fn open(
        &mut self,
        session: &mut Session,
        large_files: &mut LargeFileStore,
        stored: Option<LoadedWork>,
    ) {
        let link = (!self.link.is_empty()).then_some(self.link.as_str());
        match stored {
            Some(stored) => {
                session.restore(&stored.saved, |key| large_files.restore(&stored.files, key), link);
            }
            // Without a link there is nothing to restore: a new session shows what a first visitor
            // sees.
            None if link.is_some() => session.restore(&Saved::default(), |_| None, link),
            None => {}
        }
        self.mark_stored(session);
    }
}

/// Stored work whose record names all the clips that were read with it.
struct LoadedWork {
    saved: Saved,
    files: StoredFiles,
}

impl LoadedWork {
    /// Adds the loose clips to the record. Where there is no record, they join what the session
    /// shows now.
    fn new(stored: StoredWork, session: &Session) -> Self {
        let mut saved = stored.saved.unwrap_or_else(|| session.saved());
        for entry in stored.loose {
            if saved.entries.iter().all(|there| there.id != entry.id) {
                saved.entries.push(entry);
            }
        }
        Self { saved, files: stored.files }
    }
}
