//! Motions of files that nothing needs: the least recently used are dropped when they take too
//! much memory, and read again from their files when they are needed.

use super::intake::FileIntake;
use crate::command::CommandError;
use crate::document::Document;
use crate::library::{Entry, Origin};
use crate::memory::MeshesOnce;
use segue_motion::math::sort::sort_by_key;
use std::collections::BTreeMap;
use std::sync::Arc;

/// The share of the memory for idle motions that is used after some were dropped: the next ones
/// then have room for a while.
const LEFT_OVER: f64 = 0.75;

impl FileIntake {
    /// Begins a round of use: clips that are not used before the next one are idle.
    pub(crate) fn begin_uses(&mut self) {
        self.uses.round += 1;
    }

    /// Records that a clip of a file is used in this round.
    pub(crate) fn note_use(&mut self, id: &str) {
        match self.uses.last.get_mut(id) {
            Some(last) => *last = self.uses.round,
            None => {
                self.uses.last.insert(id.to_owned(), self.uses.round);
            }
        }
    }

    /// Sets the most memory of motions that are not used, bytes.
    pub(crate) fn limit_idle_motions(&mut self, bytes: u64) {
        self.uses.max_idle_bytes = bytes;
    }

    /// Drops motions that are not used, the least recently used first, if they take more than their
    /// memory; also from steps of undo. Returns whether there were any.
    pub(crate) fn drop_idle_motions(&mut self, document: &mut Document) -> bool {
        self.drop_idle_beyond(document, self.uses.max_idle_bytes)
    }

    /// Drops motions as [`FileIntake::drop_idle_motions`] does, for this much memory, bytes.
    pub(super) fn drop_idle_beyond(&self, document: &mut Document, max_bytes: u64) -> bool {
        if max_bytes == u64::MAX {
            return false;
        }
        let last = |entry: &Entry| self.uses.last.get(&entry.id).copied().unwrap_or(0);
        let mut idle: Vec<(u64, u64, &Arc<Entry>)> = Vec::new();
        for entry in document.library.entries() {
            let (true, Some(facts)) = (entry.motion.is_some(), &entry.facts) else { continue };
            let used = last(entry);
            if matches!(entry.origin, Origin::File(_)) && used < self.uses.round {
                idle.push((used, facts.motion_bytes(), entry));
            }
        }
        sort_by_key(&mut idle, |(used, ..)| *used);
        // The last clip with a mesh is the one whose end frees it.
        let mut meshes = MeshesOnce::default();
        for (_, bytes, entry) in idle.iter_mut().rev() {
            *bytes += meshes.bytes(entry);
        }
        let mut held: u64 = idle.iter().map(|(_, bytes, _)| bytes).sum();
        if held <= max_bytes {
            return false;
        }
        let left = (max_bytes as f64 * LEFT_OVER) as u64;
        let mut newer = BTreeMap::new();
        for (_, bytes, entry) in idle {
            if held <= left {
                break;
            }
            let mut own = Entry::clone(entry);
            own.drop_motion();
            newer.insert(Arc::as_ptr(entry), Arc::new(own));
            held -= bytes;
        }
        document.replace_entries(&newer);
        document.drop_motions_of_steps();
        true
    }

    /// Reads the motion of a clip of a file again if it is not here, for uses outside of labs.
    ///
    /// # Errors
    /// [`CommandError`] if there is no such clip, or its file cannot be read.
    pub(super) fn read_if_dropped(
        &mut self,
        document: &mut Document,
        reference: &str,
    ) -> Result<(), CommandError> {
        let entry = Arc::clone(document.clip(reference)?);
        let Origin::File(file) = &entry.origin else { return Ok(()) };
        self.note_use(&entry.id);
        if entry.motion.is_none() && !entry.awaits_skeleton() {
            self.read_anew(document, file, None)?;
        }
        Ok(())
    }
}
