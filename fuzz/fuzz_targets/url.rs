//! Links: any query string is applied as far as it is valid, and the document's own link opens the
//! same document.

#![no_main]

use libfuzzer_sys::fuzz_target;
use segue_session::{Command, Session};
use std::cell::RefCell;

thread_local! {
    /// Created once, since making its clips takes longer than thousands of links; a link resets
    /// everything that it does not name.
    static SESSION: RefCell<Session> = RefCell::new(Session::new());
}

fuzz_target!(|query: &str| {
    SESSION.with_borrow_mut(|session| {
        let open = |session: &mut Session, query: &str| {
            let outcome = session.apply(Command::OpenLink(query.to_owned()));
            assert_eq!(outcome, Ok(()), "a link is never refused as a whole");
            session.take_requests();
            session.tick(1.0 / 60.0);
            session.apply(Command::OpenLink(query.to_owned())).expect("as before");
            session.query()
        };
        let written = open(session, query);
        assert_eq!(open(session, &written), written);
    });
});
