//! Keeps the page's address in step with the state.

use crate::platform;
use segue_session::{Key, Session};

/// Browsers refuse an address that changes more often than about three times a second.
const LEAST_GAP_MS: f64 = 350.0;

/// See the module.
#[derive(Debug, Default)]
pub(crate) struct AddressBar {
    /// The query as it was last read from the address.
    address: String,
    /// The state that the address stands for.
    query: String,
    /// The revision at which that was found.
    revision: u64,
    written_at_ms: Option<f64>,
}

/// The query of a link to this state. A link without any would show what a first visitor sees, so
/// it always names something.
pub(crate) fn link_query(session: &Session) -> String {
    let query = session.query();
    if query.is_empty() {
        format!("{}={}", Key::Lab.param().name, session.params().lab().word())
    } else {
        query
    }
}

impl AddressBar {
    /// Takes the address, whatever it says, for one that leads to the present state: the session
    /// was just opened with it.
    pub(crate) fn is_right(&mut self, session: &Session) {
        self.address = platform::location_query();
        self.query = link_query(session);
        self.revision = session.revision();
    }

    /// Whether the user went to another query than the one that is known. A change behind the `#`
    /// is none.
    pub(crate) fn is_news(&self, address: &str) -> bool {
        address != self.address
    }

    /// Writes the address when the state is another, but not in the middle of a drag. Returns in
    /// how many milliseconds to ask again.
    pub(crate) fn tend(&mut self, session: &Session, dragging: bool, now_ms: f64) -> Option<f64> {
        if session.revision() == self.revision || dragging {
            return None;
        }
        let query = link_query(session);
        if query != self.query {
            let wait = self.written_at_ms.map_or(0.0, |at| at + LEAST_GAP_MS - now_ms);
            if wait > 0.0 {
                return Some(wait);
            }
            platform::replace_query(&query);
            self.written_at_ms = Some(now_ms);
            // Read back, for a browser may escape more than was asked.
            self.address = platform::location_query();
            self.query = query;
        }
        self.revision = session.revision();
        None
    }
}
