//! Storage of changed work and of new clips.

use super::{Autosave, ChangeTimes, Fingerprint, MAX_SAVE_INTERVAL_MS, Phase, SAVE_DELAY_MS};
use crate::platform::{FileBytes, LargeFileStore, NewClip, Storage, StoredFiles, Work};
use segue_session::{Origin, SavedEntry, Session, StorageState};

impl Autosave {
    /// Stores clips that have just been read from a file. They do not wait for [`Self::update`].
    /// `bytes` are those of the file, where they are at hand.
    pub(crate) fn store_clips(
        &mut self,
        session: &Session,
        large_files: &LargeFileStore,
        ids: &[String],
        bytes: Option<&FileBytes>,
    ) {
        let Some(storage) = &self.storage else { return };
        let mut clips = Vec::new();
        for entry in ids.iter().filter_map(|id| session.library().get(id)) {
            let Origin::File(file) = &entry.origin else {
                continue;
            };
            let own = || large_files.bytes_of(&file.content).filter(|bytes| !bytes.is_stored());
            let Some(bytes) = bytes.cloned().or_else(own) else {
                continue;
            };
            self.known.insert(entry.id.clone());
            clips.push(NewClip {
                entry: SavedEntry::from(&**entry),
                sha256: file.sha256.clone(),
                bytes,
            });
        }
        if !clips.is_empty() {
            storage.store(clips);
        }
    }

    /// Returns whether files with one of these SHA-256 are being written.
    #[cfg(target_arch = "wasm32")]
    pub(crate) fn is_storing(&self, files: &[String]) -> bool {
        let storage = self.storage.as_ref();
        storage.is_some_and(|storage| files.iter().any(|sha256| storage.is_writing(sha256)))
    }

    /// Returns the progress of storing the files that were read; `None` where nothing is stored.
    pub(crate) fn files_stored(&self) -> Option<StorageState> {
        self.storage.as_ref()?.progress()
    }

    /// Returns the progress of storing the work; `None` where nothing is stored.
    pub(crate) fn progress(&self) -> Option<StorageState> {
        let is_due = self.changed.is_some() || !matches!(self.phase, Phase::Ready);
        Some(match self.files_stored()? {
            StorageState::Done if is_due => StorageState::UnderWay,
            other => other,
        })
    }

    /// Stores the work [`SAVE_DELAY_MS`] after its last change, or [`MAX_SAVE_INTERVAL_MS`] after
    /// the first one. Returns the time until the next call is due, milliseconds.
    pub(crate) fn update(
        &mut self,
        session: &Session,
        large_files: &LargeFileStore,
        now_ms: f64,
    ) -> Option<f64> {
        if !matches!(self.phase, Phase::Ready) || self.storage.is_none() {
            return None;
        }
        if self.revision != session.revision() {
            self.revision = session.revision();
            let now = Fingerprint::of(session);
            if now != self.seen {
                self.seen = now;
                let first_ms = self.changed.map_or(now_ms, |changed| changed.first_ms);
                self.changed = Some(ChangeTimes { first_ms, last_ms: now_ms });
            }
        }
        let changed = self.changed?;
        let due_ms = (changed.last_ms + SAVE_DELAY_MS).min(changed.first_ms + MAX_SAVE_INTERVAL_MS);
        let wait_ms = due_ms - now_ms;
        if wait_ms > 0.0 {
            return Some(wait_ms);
        }
        self.save_now(session, large_files);
        None
    }

    /// Stores the work at once, if it has changed.
    pub(crate) fn save_now(&mut self, session: &Session, large_files: &LargeFileStore) {
        if let Some((storage, work)) = self.unsaved_work(session, large_files) {
            storage.save(work);
        }
    }

    /// Stores the work when the page may end at any moment.
    pub(crate) fn save_on_exit(&mut self, session: &Session, large_files: &LargeFileStore) {
        if let Some((storage, work)) = self.unsaved_work(session, large_files) {
            storage.save_on_exit(work);
        }
    }

    /// Returns the work where it differs from the stored one, and records it as stored.
    fn unsaved_work(
        &mut self,
        session: &Session,
        large_files: &LargeFileStore,
    ) -> Option<(&Storage, Work)> {
        let (Phase::Ready, Some(storage)) = (&self.phase, &self.storage) else {
            return None;
        };
        self.changed = None;
        let now = Fingerprint::of(session);
        if now == self.stored {
            return None;
        }
        let saved = session.saved();
        self.known.extend(saved.entries.iter().map(|entry| entry.id.clone()));
        self.stored.clone_from(&now);
        self.seen = now;
        let work = Work {
            saved,
            known: self.known.clone(),
            files: files_of(session, large_files),
            kept: session.files_of_steps(),
        };
        Some((storage, work))
    }
}

/// Returns the bytes of all files in the library, by their SHA-256, except those that are only in
/// the storage.
fn files_of(session: &Session, large_files: &LargeFileStore) -> StoredFiles {
    let origins = session.library().entries().iter().map(|entry| &entry.origin);
    origins
        .filter_map(|origin| match origin {
            Origin::File(file) => {
                let bytes = large_files.bytes_of(&file.content)?;
                (!bytes.is_stored()).then(|| (file.sha256.clone(), bytes))
            }
            Origin::Preset | Origin::Sample(_) | Origin::Made => None,
        })
        .collect()
}
