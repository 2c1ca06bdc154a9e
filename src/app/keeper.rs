//! Keeps the work: brings it back at the start, stores a file as soon as it is read, and everything
//! else soon after it has changed.

use crate::platform::{Arrival, Storage, Stored, StoredFiles, Vault, Work};
use segue_session::{Origin, Saved, SavedEntry, Session, StorageState};
use std::collections::BTreeSet;

/// The page does not wait longer than this for what is stored, milliseconds.
const PATIENCE_MS: f64 = 150.0;
/// Nor does the page's API, milliseconds: a storage that is locked may never answer.
const LATEST_MS: f64 = 4000.0;
/// Work that has not changed for so long is stored, milliseconds.
const QUIET_MS: f64 = 600.0;
/// Work that changes all the time is stored so often, milliseconds.
const AT_LEAST_EVERY_MS: f64 = 2000.0;

/// What was stored, or is: when one of the two differs, there is something to store.
#[derive(Clone, Debug, Default, PartialEq)]
struct Mark {
    library: u64,
    query: String,
}

impl Mark {
    fn of(session: &Session) -> Self {
        Self { library: session.library_revision(), query: session.query() }
    }
}

#[derive(Debug)]
enum Phase {
    /// Nothing is shown yet: what is stored may come any moment.
    Waiting { since_ms: f64 },
    /// It takes longer than anybody waits. The session has begun without it, and nothing is stored
    /// before it has come: that would be in its place.
    Late { begun: Mark, since_ms: f64 },
    /// What was stored is here, or there is nothing.
    Ready,
}

/// See the module.
#[derive(Debug)]
pub(crate) struct Keeper {
    storage: Option<Storage>,
    phase: Phase,
    /// The link that the page was opened with; empty for none.
    link: String,
    stored: Mark,
    /// The ids of all clips that were read from storage or written to it here. Others that are
    /// found there are another window's.
    known: BTreeSet<String>,
    seen: Mark,
    /// The session's revision at which `seen` was taken.
    revision: u64,
    changed: Option<Changed>,
}

/// When the work changed since it was stored last, milliseconds.
#[derive(Clone, Copy, Debug)]
struct Changed {
    first_ms: f64,
    last_ms: f64,
}

impl Keeper {
    /// Waits for what `storage` holds; without one nothing is kept. `link` is what the page was
    /// opened with; empty for nothing.
    pub(crate) fn new(storage: Option<Storage>, link: String, now_ms: f64) -> Self {
        Self {
            storage,
            phase: Phase::Waiting { since_ms: now_ms },
            link,
            stored: Mark::default(),
            known: BTreeSet::new(),
            seen: Mark::default(),
            revision: 0,
            changed: None,
        }
    }

    /// Whether nothing can be shown yet.
    pub(crate) fn is_waiting(&self) -> bool {
        matches!(self.phase, Phase::Waiting { .. })
    }

    /// Whether what is stored is still to be expected soon, though something is shown by now.
    pub(crate) fn is_late(&self, now_ms: f64) -> bool {
        matches!(self.phase, Phase::Late { since_ms, .. } if now_ms - since_ms < LATEST_MS)
    }

    /// Begins without what is stored when it takes too long. Says whether the session has begun
    /// just now.
    pub(crate) fn wait(&mut self, session: &mut Session, vault: &mut Vault, now_ms: f64) -> bool {
        let Phase::Waiting { since_ms } = self.phase else {
            return false;
        };
        if self.storage.is_some() && now_ms - since_ms < PATIENCE_MS {
            return false;
        }
        self.open(session, vault, None);
        self.phase = if self.storage.is_some() {
            Phase::Late { begun: Mark::of(session), since_ms }
        } else {
            Phase::Ready
        };
        true
    }

    /// The session is now as it begins: what differs from it later was touched by somebody.
    pub(crate) fn has_begun(&mut self, session: &Session) {
        if let Phase::Late { begun, .. } = &mut self.phase {
            *begun = Mark::of(session);
        }
    }

    /// What is stored has come. Says whether the address that the page was opened with leads to
    /// what is now shown.
    pub(crate) fn arrived(
        &mut self,
        session: &mut Session,
        vault: &mut Vault,
        stored: Option<Stored>,
    ) -> bool {
        let nothing = stored.is_none();
        let stored = stored.map(|stored| Found::of(stored, session));
        if let Some(stored) = &stored {
            self.known.extend(stored.saved.entries.iter().map(|entry| entry.id.clone()));
        }
        match std::mem::replace(&mut self.phase, Phase::Ready) {
            Phase::Waiting { .. } => {
                self.open(session, vault, stored);
                return nothing || !self.link.is_empty();
            }
            Phase::Late { begun, .. } => {
                let Some(stored) = stored else { return false };
                let content_of = |key: &str| vault.restore(&stored.files, key);
                if self.link.is_empty() && Mark::of(session) == begun {
                    session.restore(&stored.saved, content_of, None);
                    self.mark(session);
                } else {
                    // What was opened or touched meanwhile stays as it is, and is yet to be stored.
                    session.restore_late(&stored.saved, content_of);
                }
            }
            Phase::Ready => {}
        }
        false
    }

    /// Another window has stored these clips. Those that were never here are asked for.
    pub(crate) fn hear_of(&self, session: &Session, entries: Vec<SavedEntry>) {
        let is_new = |entry: &SavedEntry| {
            !self.known.contains(&entry.id) && session.library().get(&entry.id).is_none()
        };
        let new: Vec<SavedEntry> = entries.into_iter().filter(is_new).collect();
        if let Some(storage) = self.storage.as_ref().filter(|_| !new.is_empty()) {
            storage.fetch(new);
        }
    }

    /// Clips of another window join the library. They are stored already.
    pub(crate) fn join(&mut self, session: &mut Session, vault: &mut Vault, stored: &Stored) {
        let was_stored = self.stored == Mark::of(session);
        self.known.extend(stored.loose.iter().map(|entry| entry.id.clone()));
        session.add_stored(&stored.loose, |key| vault.restore(&stored.files, key));
        if was_stored {
            self.mark(session);
        }
    }

    /// Clips have come from a file: they are stored at once, whatever else is to be stored.
    pub(crate) fn store_clips(&mut self, session: &Session, vault: &Vault, ids: &[String]) {
        let Some(storage) = &self.storage else { return };
        let mut arrivals = Vec::new();
        for entry in ids.iter().filter_map(|id| session.library().get(id)) {
            let Origin::File(file) = &entry.origin else {
                continue;
            };
            let Some(bytes) = vault.bytes_of(&file.content) else {
                continue;
            };
            self.known.insert(entry.id.clone());
            arrivals.push(Arrival {
                entry: SavedEntry::from(&**entry),
                sha256: file.sha256.clone(),
                bytes,
            });
        }
        if !arrivals.is_empty() {
            storage.store(arrivals);
        }
    }

    /// Whether files with one of these SHA-256 are being written.
    #[cfg(target_arch = "wasm32")]
    pub(crate) fn is_storing(&self, files: &[String]) -> bool {
        let storage = self.storage.as_ref();
        storage.is_some_and(|storage| files.iter().any(|sha256| storage.is_writing(sha256)))
    }

    /// How far the files are stored that have come; `None` where nothing is stored.
    pub(crate) fn files_stored(&self) -> Option<StorageState> {
        self.storage.as_ref()?.progress()
    }

    /// How far the work is stored; `None` where nothing is.
    pub(crate) fn progress(&self) -> Option<StorageState> {
        let is_due = self.changed.is_some() || !matches!(self.phase, Phase::Ready);
        Some(match self.files_stored()? {
            StorageState::Done if is_due => StorageState::UnderWay,
            other => other,
        })
    }

    fn open(&mut self, session: &mut Session, vault: &mut Vault, stored: Option<Found>) {
        let link = (!self.link.is_empty()).then_some(self.link.as_str());
        match stored {
            Some(stored) => {
                session.restore(&stored.saved, |key| vault.restore(&stored.files, key), link);
            }
            // Without a link there is nothing to bring about: a new session shows what a first
            // visitor sees.
            None if link.is_some() => session.restore(&Saved::default(), |_| None, link),
            None => {}
        }
        self.mark(session);
    }

    fn mark(&mut self, session: &Session) {
        self.stored = Mark::of(session);
        self.seen.clone_from(&self.stored);
        self.changed = None;
    }

    /// Stores the work when it has been quiet for a while. Returns in how many milliseconds to ask
    /// again.
    pub(crate) fn tend(&mut self, session: &Session, vault: &Vault, now_ms: f64) -> Option<f64> {
        if !matches!(self.phase, Phase::Ready) || self.storage.is_none() {
            return None;
        }
        if self.revision != session.revision() {
            self.revision = session.revision();
            let now = Mark::of(session);
            if now != self.seen {
                self.seen = now;
                let first_ms = self.changed.map_or(now_ms, |changed| changed.first_ms);
                self.changed = Some(Changed { first_ms, last_ms: now_ms });
            }
        }
        let changed = self.changed?;
        let wait = (changed.last_ms + QUIET_MS).min(changed.first_ms + AT_LEAST_EVERY_MS) - now_ms;
        if wait > 0.0 {
            return Some(wait);
        }
        self.save_now(session, vault);
        None
    }

    /// Stores the work at once, if there is anything new in it.
    pub(crate) fn save_now(&mut self, session: &Session, vault: &Vault) {
        if let Some((storage, work)) = self.unsaved_work(session, vault) {
            storage.save(work);
        }
    }

    /// Stores the work before the page goes, which may be any moment.
    pub(crate) fn leave(&mut self, session: &Session, vault: &Vault) {
        if let Some((storage, work)) = self.unsaved_work(session, vault) {
            storage.leave(work);
        }
    }

    /// What is to be stored; it counts as stored from now on.
    fn unsaved_work(&mut self, session: &Session, vault: &Vault) -> Option<(&Storage, Work)> {
        let (Phase::Ready, Some(storage)) = (&self.phase, &self.storage) else {
            return None;
        };
        self.changed = None;
        let now = Mark::of(session);
        if now == self.stored {
            return None;
        }
        let saved = session.saved();
        self.known.extend(saved.entries.iter().map(|entry| entry.id.clone()));
        self.stored.clone_from(&now);
        self.seen = now;
        let work = Work { saved, known: self.known.clone(), files: files_of(session, vault) };
        Some((storage, work))
    }
}

/// Stored work with all the clips that were found with it.
struct Found {
    saved: Saved,
    files: StoredFiles,
}

impl Found {
    /// Without a record, what the session shows now is what the clips join.
    fn of(stored: Stored, session: &Session) -> Self {
        let mut saved = stored.saved.unwrap_or_else(|| session.saved());
        for entry in stored.loose {
            if saved.entries.iter().all(|there| there.id != entry.id) {
                saved.entries.push(entry);
            }
        }
        Self { saved, files: stored.files }
    }
}

fn files_of(session: &Session, vault: &Vault) -> StoredFiles {
    let origins = session.library().entries().iter().map(|entry| &entry.origin);
    origins
        .filter_map(|origin| match origin {
            Origin::File(file) => Some((file.sha256.clone(), vault.bytes_of(&file.content)?)),
            Origin::Preset | Origin::Sample(_) | Origin::Made => None,
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::platform::FileBytes;
    use segue_session::{Command, Key, PlaybackCommand, Slot, Value};
    use std::sync::Arc;

    const STANDING: &str = "HIERARCHY ROOT Hips { OFFSET 0 1 0 CHANNELS 1 Yrotation End Site { OFFSET 0 0.7 0 } } MOTION Frames: 2 Frame Time: .1\n1\n2";

    fn stored(query: &str) -> Stored {
        let saved = Saved { query: query.into(), ..Session::new().saved() };
        Stored { saved: Some(saved), ..Stored::default() }
    }

    fn keeper(link: &str) -> (Keeper, Session) {
        (Keeper::new(Some(Storage::default()), link.into(), 1000.0), Session::new())
    }

    fn set_window(session: &mut Session, frames: f64) {
        session.apply(Command::Set(vec![(Key::BlendWindow, Value::Number(frames))])).unwrap();
    }

    #[test]
    fn what_is_stored_comes_before_the_first_frame() {
        let (mut keeper, mut session) = keeper("");
        assert!(!keeper.wait(&mut session, &mut Vault::default(), 1100.0) && keeper.is_waiting());
        assert!(
            !keeper.arrived(&mut session, &mut Vault::default(), Some(stored("blend_window=24"))),
            "the address does not say what is shown"
        );
        assert!(!keeper.is_waiting());
        assert_eq!(session.query(), "blend_window=24");
    }

    #[test]
    fn a_link_goes_before_stored_parameters() {
        let (mut keeper, mut session) = keeper("blend_window=12");
        assert!(keeper.arrived(
            &mut session,
            &mut Vault::default(),
            Some(stored("blend_window=24"))
        ));
        assert_eq!(session.query(), "blend_window=12");
    }

    #[test]
    fn a_slow_storage_does_not_hold_the_page_up() {
        let (mut keeper, mut session) = keeper("");
        let welcome = session.query();
        assert!(keeper.wait(&mut session, &mut Vault::default(), 1151.0) && !keeper.is_waiting());
        assert_eq!(session.query(), welcome);
        assert_eq!(
            keeper.tend(&session, &Vault::default(), 9000.0),
            None,
            "nothing is stored over what has not been read yet"
        );
        keeper.arrived(&mut session, &mut Vault::default(), Some(stored("blend_window=24")));
        assert_eq!(session.query(), "blend_window=24");
    }

    #[test]
    fn who_wants_little_motion_gets_the_work_back_from_a_slow_storage() {
        let (mut keeper, mut session) = keeper("");
        keeper.wait(&mut session, &mut Vault::default(), 1151.0);
        session.apply(Command::Playback(PlaybackCommand::TogglePlay)).unwrap();
        keeper.has_begun(&session);
        keeper.arrived(&mut session, &mut Vault::default(), Some(stored("blend_window=24")));
        assert_eq!(session.query(), "blend_window=24");
    }

    #[test]
    fn what_was_touched_meanwhile_stays() {
        let (mut keeper, mut session) = keeper("blend_window=12");
        keeper.wait(&mut session, &mut Vault::default(), 1151.0);
        set_window(&mut session, 60.0);
        keeper.arrived(&mut session, &mut Vault::default(), Some(stored("blend_window=24")));
        assert_eq!(session.query(), "blend_window=60");
    }

    #[test]
    fn what_came_before_a_slow_storage_is_stored_too() {
        let (mut keeper, mut session) = keeper("");
        keeper.wait(&mut session, &mut Vault::default(), 1151.0);
        session.apply(Command::OpenLink("lab=make&gait=run".into())).unwrap();
        session.apply(Command::Keep(0)).unwrap();
        keeper.arrived(&mut session, &mut Vault::default(), Some(stored("blend_window=24")));
        assert_eq!(keeper.tend(&session, &Vault::default(), 2000.0), Some(QUIET_MS));
    }

    #[test]
    fn late_work_joins_what_came_meanwhile() {
        let file = |add: &str| -> Arc<[u8]> { [STANDING, add].concat().into_bytes().into() };
        let mut before = Session::new();
        let stored_id = before.load("stored.bvh", file("")).unwrap().ids.remove(0);
        before.apply(Command::Rename(stored_id.clone(), "mine".into())).unwrap();
        before.apply(Command::Remove("idle".into())).unwrap();
        let Origin::File(source) = before.library().get(&stored_id).unwrap().origin.clone() else {
            panic!()
        };
        let late = Stored {
            saved: Some(before.saved()),
            files: [(source.sha256, FileBytes::Here(file("")))].into(),
            ..Stored::default()
        };
        let (mut keeper, mut session) = keeper("");
        let vault = &mut Vault::default();
        keeper.wait(&mut session, vault, 1151.0);
        let dropped = session.load("dropped.bvh", file(" ")).unwrap().ids.remove(0);
        keeper.save_now(&session, vault);
        assert_eq!(keeper.known.len(), 0, "nothing is stored over what has not been read yet");
        keeper.arrived(&mut session, vault, Some(late));
        let has = |session: &Session, id: &str| {
            session.library().get(id).is_some_and(|entry| entry.motion.is_some())
        };
        assert!(has(&session, &stored_id) && has(&session, &dropped));
        assert_eq!(session.library().get(&stored_id).unwrap().name, "mine");
        assert!(session.library().get("idle").is_none());
        assert_eq!(session.params().text(Key::A), dropped, "the parameters stay");
        assert_eq!(
            keeper.tend(&session, vault, 2000.0),
            Some(QUIET_MS),
            "both are yet to be stored"
        );
        // The way back leads past the drop, and not past what was stored.
        session.apply(Command::Undo).unwrap();
        assert!(has(&session, &stored_id) && session.library().get(&dropped).is_none());
    }

    #[test]
    fn another_a_is_no_other_library() {
        let (mut keeper, mut session) = keeper("");
        keeper.wait(&mut session, &mut Vault::default(), 1151.0);
        let begun = Mark::of(&session);
        session.apply(Command::Assign(Slot::A, "idle".into())).unwrap();
        assert_eq!(Mark::of(&session).library, begun.library);
        assert_ne!(Mark::of(&session), begun, "it is stored all the same");
    }

    #[test]
    fn what_never_comes_is_not_waited_for() {
        let (mut keeper, mut session) = keeper("");
        keeper.wait(&mut session, &mut Vault::default(), 1151.0);
        assert!(keeper.is_late(1200.0) && !keeper.is_late(1000.0 + LATEST_MS));
        set_window(&mut session, 60.0);
        // It has failed: from now on what there is is stored.
        keeper.arrived(&mut session, &mut Vault::default(), None);
        assert!(!keeper.is_late(1200.0));
        assert_eq!(keeper.tend(&session, &Vault::default(), 2000.0), Some(QUIET_MS));
    }

    #[test]
    fn work_is_stored_once_it_is_quiet() {
        let (mut keeper, mut session) = keeper("");
        keeper.arrived(&mut session, &mut Vault::default(), None);
        assert_eq!(keeper.tend(&session, &Vault::default(), 2000.0), None);
        set_window(&mut session, 60.0);
        assert_eq!(keeper.tend(&session, &Vault::default(), 2100.0), Some(QUIET_MS));
        set_window(&mut session, 61.0);
        assert_eq!(keeper.tend(&session, &Vault::default(), 2500.0), Some(QUIET_MS));
        assert_eq!(keeper.tend(&session, &Vault::default(), 2600.0), Some(QUIET_MS - 100.0));
        assert_eq!(keeper.tend(&session, &Vault::default(), 2500.0 + QUIET_MS), None);
        assert_eq!(keeper.stored, Mark::of(&session));
    }

    #[test]
    fn work_that_changes_all_the_time_is_stored_all_the_same() {
        let (mut keeper, mut session) = keeper("");
        keeper.arrived(&mut session, &mut Vault::default(), None);
        let vault = Vault::default();
        let mut longest: f64 = 0.0;
        let mut stored_at = None;
        for step in 0..100 {
            set_window(&mut session, 20.0 + f64::from(step % 50));
            let now_ms = 2000.0 + 100.0 * f64::from(step);
            keeper.tend(&session, &vault, now_ms);
            if keeper.stored == Mark::of(&session) {
                longest = longest.max(now_ms - stored_at.replace(now_ms).unwrap_or(2000.0));
            }
        }
        assert!(longest > 0.0 && longest <= AT_LEAST_EVERY_MS + 200.0, "{longest} ms");
    }

    #[test]
    fn clips_that_no_record_names_join_what_a_first_visitor_sees() {
        let mut session = Session::new();
        let bytes: Arc<[u8]> = Arc::from(STANDING.as_bytes());
        let id = session.load("came.bvh", bytes.clone()).unwrap().ids.remove(0);
        let entry = SavedEntry::from(&**session.library().get(&id).unwrap());
        let sha256 = entry.file.as_ref().unwrap().sha256.clone();
        for wait_ms in [0.0, 500.0] {
            let stored = Stored {
                saved: None,
                loose: vec![entry.clone()],
                files: [(sha256.clone(), FileBytes::Here(bytes.clone()))].into(),
            };
            let (mut keeper, mut session) = keeper("");
            let built_in = session.library().entries().len();
            keeper.wait(&mut session, &mut Vault::default(), 1000.0 + wait_ms);
            keeper.arrived(&mut session, &mut Vault::default(), Some(stored));
            assert_eq!(session.library().entries().len(), built_in + 1, "after {wait_ms} ms");
            assert!(session.library().get(&id).is_some_and(|entry| entry.motion.is_some()));
        }
    }

    #[test]
    fn clips_of_another_window_join_and_are_not_stored_again() {
        let mut session = Session::new();
        let bytes: Arc<[u8]> = Arc::from(STANDING.as_bytes());
        let id = session.load("came.bvh", bytes.clone()).unwrap().ids.remove(0);
        let entry = SavedEntry::from(&**session.library().get(&id).unwrap());
        let joined = Stored {
            saved: None,
            files: [(entry.file.as_ref().unwrap().sha256.clone(), FileBytes::Here(bytes))].into(),
            loose: vec![entry],
        };
        let (mut keeper, mut session) = keeper("");
        let vault = &mut Vault::default();
        keeper.arrived(&mut session, vault, None);
        let (shown, built_in) = (session.query(), session.library().entries().len());
        keeper.join(&mut session, vault, &joined);
        assert_eq!((session.query(), session.library().entries().len()), (shown, built_in + 1));
        assert_eq!(keeper.tend(&session, vault, 2000.0), None, "the other window has stored it");
        // What was removed here does not come again.
        session.apply(Command::Remove(id.clone())).unwrap();
        assert_eq!(keeper.tend(&session, vault, 2000.0), Some(QUIET_MS));
        assert!(keeper.known.contains(&id));
    }
}
