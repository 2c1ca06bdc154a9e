//! Keeps the work: brings it back at the start, and stores it soon after it has changed.

use crate::platform::{Storage, Stored, StoredFiles, Vault, Work};
use segue::session::{Origin, Saved, Session};

/// The page does not wait longer than this for what is stored, milliseconds.
const PATIENCE_MS: f64 = 150.0;
/// Work that has not changed for so long is stored, milliseconds.
const QUIET_MS: f64 = 600.0;

/// What was stored, or is: when one of the two differs, there is something to store.
#[derive(Clone, Debug, Default, PartialEq)]
struct Mark {
    library: u64,
    query: String,
}

impl Mark {
    fn of(session: &Session) -> Self {
        Self {
            library: session.library_revision(),
            query: session.query(),
        }
    }
}

#[derive(Debug)]
enum Phase {
    /// Nothing is shown yet: what is stored may come any moment.
    Waiting { since_ms: f64 },
    /// It takes longer than anybody waits. The session has begun without it.
    Late { begun: Mark },
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
    seen: Mark,
    /// The session's revision at which `seen` was taken.
    revision: u64,
    changed_at_ms: Option<f64>,
}

impl Keeper {
    /// Waits for what `storage` holds; without one nothing is kept. `link` is what the page was opened with; empty for nothing.
    pub(crate) fn new(storage: Option<Storage>, link: String, now_ms: f64) -> Self {
        Self {
            storage,
            phase: Phase::Waiting { since_ms: now_ms },
            link,
            stored: Mark::default(),
            seen: Mark::default(),
            revision: 0,
            changed_at_ms: None,
        }
    }

    /// Whether nothing can be shown yet.
    pub(crate) fn is_waiting(&self) -> bool {
        matches!(self.phase, Phase::Waiting { .. })
    }

    /// Begins without what is stored when it takes too long. Says whether the session has begun just now.
    pub(crate) fn wait(&mut self, session: &mut Session, vault: &mut Vault, now_ms: f64) -> bool {
        let Phase::Waiting { since_ms } = self.phase else { return false };
        if self.storage.is_some() && now_ms - since_ms < PATIENCE_MS {
            return false;
        }
        self.open(session, vault, None);
        self.phase = if self.storage.is_some() {
            Phase::Late { begun: Mark::of(session) }
        } else {
            Phase::Ready
        };
        true
    }

    /// What is stored has come. Says whether the address that the page was opened with leads to what is now shown.
    pub(crate) fn arrived(&mut self, session: &mut Session, vault: &mut Vault, stored: Option<Stored>) -> bool {
        let nothing = stored.is_none();
        match std::mem::replace(&mut self.phase, Phase::Ready) {
            Phase::Waiting { .. } => {
                self.open(session, vault, stored);
                return nothing || !self.link.is_empty();
            }
            Phase::Late { begun } => {
                let now = Mark::of(session);
                if now.library != begun.library {
                    // The user's files are in the library by now; they stay, are yet to be stored, and what was stored gives way to them.
                    log::warn!("the stored work came too late");
                    return false;
                }
                if let Some(stored) = stored {
                    // Parameters that were touched meanwhile stay as they are.
                    let query = (now.query != begun.query || !self.link.is_empty()).then_some(now.query);
                    session.restore(&stored.saved, |key| vault.restore(&stored.files, key), query.as_deref());
                }
                self.mark(session);
            }
            Phase::Ready => {}
        }
        false
    }

    fn open(&mut self, session: &mut Session, vault: &mut Vault, stored: Option<Stored>) {
        let link = (!self.link.is_empty()).then_some(self.link.as_str());
        match stored {
            Some(stored) => session.restore(&stored.saved, |key| vault.restore(&stored.files, key), link),
            // Without a link there is nothing to bring about: a new session shows what a first visitor sees.
            None if link.is_some() => session.restore(&Saved::default(), |_| None, link),
            None => {}
        }
        self.mark(session);
    }

    fn mark(&mut self, session: &Session) {
        self.stored = Mark::of(session);
        self.seen.clone_from(&self.stored);
        self.changed_at_ms = None;
    }

    /// Stores the work when it has been quiet for a while. Returns in how many milliseconds to ask again.
    pub(crate) fn tend(&mut self, session: &Session, vault: &Vault, now_ms: f64) -> Option<f64> {
        if !matches!(self.phase, Phase::Ready) || self.storage.is_none() {
            return None;
        }
        if self.revision != session.revision() {
            self.revision = session.revision();
            let now = Mark::of(session);
            if now != self.seen {
                self.seen = now;
                self.changed_at_ms = Some(now_ms);
            }
        }
        let wait = self.changed_at_ms? + QUIET_MS - now_ms;
        if wait > 0.0 {
            return Some(wait);
        }
        self.save_now(session, vault);
        None
    }

    /// Stores the work at once, if there is anything new in it.
    pub(crate) fn save_now(&mut self, session: &Session, vault: &Vault) {
        let (Phase::Ready, Some(storage)) = (&self.phase, &self.storage) else {
            return;
        };
        self.changed_at_ms = None;
        let now = Mark::of(session);
        if now == self.stored {
            return;
        }
        match serde_json::to_string(&session.saved()) {
            Ok(record) => storage.save(Work {
                record,
                files: files_of(session, vault),
            }),
            Err(error) => log::error!("the work cannot be written down: {error}"),
        }
        self.stored.clone_from(&now);
        self.seen = now;
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
    use segue::session::{Command, Key, Value};

    fn stored(query: &str) -> Stored {
        let saved = Saved {
            query: query.into(),
            ..Session::new().saved()
        };
        Stored {
            saved,
            files: StoredFiles::new(),
        }
    }

    fn keeper(link: &str) -> (Keeper, Session) {
        (Keeper::new(Some(Storage::default()), link.into(), 1000.0), Session::new())
    }

    fn set_window(session: &mut Session, frames: f64) {
        session
            .apply(Command::Set(vec![(Key::BlendWindow, Value::Number(frames))]))
            .unwrap();
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
        assert!(keeper.arrived(&mut session, &mut Vault::default(), Some(stored("blend_window=24"))));
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
}
