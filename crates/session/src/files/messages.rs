//! Notices about files that were read, and about those that were not.

use crate::notice::{Level, Notices};
use segue_formats::ImportError;
use segue_text::{ToMessage, msg};

/// The greatest number of files that one notice names.
pub(crate) const MAX_NAMED: usize = 3;

/// Adds a notice that says why a file was not read.
pub(super) fn notify_unread(notices: &mut Notices, error: &ImportError) {
    notices.say_of(Level::Error, &error.file, error.to_message());
}

/// Adds a notice that says why the files of an archive were not read: the reason of each of the
/// first ones, and the number of the others.
pub(super) fn notify_all_unread(notices: &mut Notices, errors: &[ImportError]) {
    let (first, rest) = errors.split_at_checked(MAX_NAMED).unwrap_or((errors, &[]));
    for error in first {
        notify_unread(notices, error);
    }
    if !rest.is_empty() {
        let mut named: Vec<String> =
            rest.iter().take(MAX_NAMED).map(|error| error.file.clone()).collect();
        if rest.len() > named.len() {
            named.push("…".to_owned());
        }
        notices.say(Level::Error, msg!("{count} more failed: {named}.", count = rest.len()));
    }
}
