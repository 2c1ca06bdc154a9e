//! Keeps the page's address in step with the state.

use crate::platform;
use segue_session::{Key, Session};

/// The shortest time between two changes of the address, milliseconds. Browsers refuse more than
/// about three changes a second.
const MIN_GAP_MS: f64 = 350.0;

/// The page's address and the state that it stands for.
#[derive(Debug, Default)]
pub(crate) struct AddressBar {
    /// The query of the address as the browser last returned it.
    address: String,
    /// The query of the state that the address stands for.
    query: String,
    /// The session's revision at which `query` was computed.
    revision: u64,
    written_at_ms: Option<f64>,
}

/// Returns the query of a link to this state. It is never empty, because a link without a query
/// shows what a first visitor sees.
pub(crate) fn link_query(session: &Session) -> String {
    never_empty(session.query(), session)
}

/// Returns the query of a link to this state for others; see [`Session::query_for_others`].
pub(crate) fn link_query_for_others(session: &Session) -> String {
    never_empty(session.query_for_others(), session)
}

fn never_empty(query: String, session: &Session) -> String {
    if query.is_empty() {
        format!("{}={}", Key::Lab.param().name, session.params().lab().word())
    } else {
        query
    }
}

impl AddressBar {
    /// Takes the address for one that leads to the session's present state, such as after opening
    /// the session with it.
    pub(crate) fn sync_from_session(&mut self, session: &Session) {
        self.address = platform::location_query();
        self.query = link_query(session);
        self.revision = session.revision();
    }

    /// Returns whether the user has navigated to another query. A change of the fragment does not
    /// count.
    pub(crate) fn has_changed(&self, address: &str) -> bool {
        address != self.address
    }

    /// Writes the address when the state has changed, except during a drag. Returns the time until
    /// the next call is due, milliseconds.
    pub(crate) fn update(&mut self, session: &Session, dragging: bool, now_ms: f64) -> Option<f64> {
        if session.revision() == self.revision || dragging {
            return None;
        }
        let query = link_query(session);
        if query != self.query {
            let wait = self.written_at_ms.map_or(0.0, |at| at + MIN_GAP_MS - now_ms);
            if wait > 0.0 {
                return Some(wait);
            }
            platform::replace_query(&query);
            self.written_at_ms = Some(now_ms);
            // Read back, because a browser may escape more characters.
            self.address = platform::location_query();
            self.query = query;
        }
        self.revision = session.revision();
        None
    }
}
