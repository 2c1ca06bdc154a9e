//! Loading of the bundled takes into a session, as the page does it.

#![expect(clippy::unwrap_used, reason = "helpers of tests: what fails here fails the test")]
#![allow(dead_code, reason = "every test binary uses a part of it")]
#![allow(unreachable_pub, reason = "a module of several test binaries")]

use segue_session::{Request, Session};
use std::path::{Path, PathBuf};

/// Returns the folder of the takes.
pub fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/samples")
}

/// Loads every requested take, and does all work. Returns the ids of the takes.
pub fn settle(session: &mut Session) -> Vec<&'static str> {
    let mut handed = Vec::new();
    loop {
        while session.work() {}
        let asked = session.take_requests().into_iter().filter_map(|request| match request {
            Request::Sample(sample) => Some(sample),
            _ => None,
        });
        let before = handed.len();
        for sample in asked {
            let packed = std::fs::read(folder().join(sample.file)).unwrap();
            session.load_sample(sample, &packed).unwrap();
            handed.push(sample.id);
        }
        if handed.len() == before {
            return handed;
        }
    }
}
