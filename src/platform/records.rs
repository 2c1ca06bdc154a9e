//! What is stored of the work, as texts by their keys: the record of all of it, a row for every
//! clip that came from a file, and what windows wrote as they went.
//!
//! A clip's row is stored together with the bytes of its file, as soon as the file is read; the
//! record follows when there is time for it. So a clip that no record names is one that came since,
//! or one whose record cannot be read any more: it is found by its row. A window that goes has no
//! time to ask what others have stored: it leaves a record of its own, which is joined to the
//! others' when the work is read or stored next.

use segue_session::{Saved, SavedEntry};
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;

/// The key of the record of all work.
pub(crate) const LATEST: &str = "latest";
const ROW: &str = "clip ";
const LEFT: &str = "left ";
const UNREAD: &str = "unread ";

/// The key of a clip's row, by its id.
pub(crate) fn row_key(id: &str) -> String {
    format!("{ROW}{id}")
}

/// The id of the clip whose row has that key.
pub(crate) fn row_id(key: &str) -> Option<&str> {
    key.strip_prefix(ROW)
}

/// The key of what a window leaves when it goes.
pub(crate) fn left_key(window: &str) -> String {
    format!("{LEFT}{window}")
}

/// Whether that is the key of what a window has left.
pub(crate) fn is_left(key: &str) -> bool {
    key.starts_with(LEFT)
}

/// The key of a record that could not be read, which is kept.
pub(crate) fn unread_key(at_ms: f64) -> String {
    format!("{UNREAD}{at_ms:.0}")
}

/// Whether that is the key of a record that could not be read.
pub(crate) fn is_unread(key: &str) -> bool {
    key.starts_with(UNREAD)
}

/// A clip that came from a file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Row {
    /// When it came, milliseconds since 1970.
    pub(crate) at_ms: f64,
    /// The clip.
    pub(crate) entry: SavedEntry,
}

/// What a window left when it went.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Left {
    /// When, milliseconds since 1970.
    pub(crate) at_ms: f64,
    /// See [`Saved::with_others_of`].
    pub(crate) known: BTreeSet<String>,
    /// Its work.
    pub(crate) saved: Saved,
}

/// Texts that were read together.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Records {
    /// The work; `None` where there is no record that can be read.
    pub(crate) saved: Option<Saved>,
    /// Clips that came from files, where no record can be read, in the order in which they came.
    pub(crate) loose: Vec<SavedEntry>,
    /// Why the record of all work cannot be read.
    pub(crate) problem: Option<String>,
}

enum Since {
    Came(Box<SavedEntry>),
    Left(BTreeSet<String>, Saved),
}

impl Records {
    /// Reads texts, each with its key. Of the rows, those are enough whose clips the record does
    /// not name.
    pub(crate) fn read<'a>(texts: impl IntoIterator<Item = (&'a str, &'a str)>) -> Self {
        let (mut records, mut since) = (Self::default(), Vec::new());
        for (key, text) in texts {
            let read = if key == LATEST {
                serde_json::from_str(text).map(|saved| records.saved = Some(saved))
            } else if row_id(key).is_some() {
                serde_json::from_str(text)
                    .map(|Row { at_ms, entry }| since.push((at_ms, Since::Came(Box::new(entry)))))
            } else if is_left(key) {
                serde_json::from_str(text).map(|Left { at_ms, known, saved }| {
                    since.push((at_ms, Since::Left(known, saved)));
                })
            } else {
                Ok(())
            };
            match read {
                Err(error) if key == LATEST => records.problem = Some(error.to_string()),
                Err(error) => log::warn!("stored under `{key}`: {error}"),
                Ok(()) => {}
            }
        }
        since.sort_by(|(one, _), (other, _)| one.total_cmp(other));
        for (_, since) in since {
            records.add(since);
        }
        records
    }

    fn add(&mut self, since: Since) {
        match since {
            Since::Came(entry) => {
                let entries =
                    self.saved.as_mut().map_or(&mut self.loose, |saved| &mut saved.entries);
                if entries.iter().all(|there| there.id != entry.id) {
                    entries.push(*entry);
                }
            }
            Since::Left(known, saved) => {
                let mut there = self.saved.take().unwrap_or_default();
                there.entries.append(&mut self.loose);
                self.saved = Some(saved.with_others_of(&there, &known));
            }
        }
    }

    /// Everything that is there.
    pub(crate) fn all(self) -> Saved {
        let mut saved = self.saved.unwrap_or_default();
        saved.entries.extend(self.loose);
        saved
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::platform::clip_of;

    fn saved(query: &str, ids: &[&str]) -> Saved {
        Saved { query: query.to_owned(), entries: ids.iter().map(|id| clip_of(id)).collect() }
    }

    fn row(at_ms: f64, id: &str) -> (String, String) {
        let entry = clip_of(id);
        (row_key(id), serde_json::to_string(&Row { at_ms, entry }).unwrap())
    }

    fn left(at_ms: f64, saved: Saved, known: &[&str]) -> (String, String) {
        let known = known.iter().map(|&id| id.to_owned()).collect();
        (left_key("7"), serde_json::to_string(&Left { at_ms, known, saved }).unwrap())
    }

    fn latest(saved: &Saved) -> (String, String) {
        (LATEST.to_owned(), serde_json::to_string(saved).unwrap())
    }

    fn read(texts: &[(String, String)]) -> Records {
        Records::read(texts.iter().map(|(key, text)| (key.as_str(), text.as_str())))
    }

    fn ids(entries: &[SavedEntry]) -> Vec<&str> {
        entries.iter().map(|entry| entry.id.as_str()).collect()
    }

    #[test]
    fn a_clip_that_came_since_the_record_follows_it() {
        let records =
            read(&[row(9.0, "b"), latest(&saved("t=1", &["a"])), row(8.0, "c"), row(7.0, "a")]);
        let all = records.saved.unwrap();
        assert_eq!((all.query.as_str(), ids(&all.entries)), ("t=1", vec!["a", "c", "b"]));
        assert!(records.loose.is_empty() && records.problem.is_none());
    }

    #[test]
    fn clips_without_a_record_are_in_the_order_in_which_they_came() {
        let records = read(&[row(9.0, "b"), row(8.0, "c")]);
        assert_eq!(records.saved, None);
        assert_eq!(ids(&records.loose), ["c", "b"]);
        assert_eq!(ids(&records.all().entries), ["c", "b"]);
    }

    #[test]
    fn a_record_that_cannot_be_read_takes_no_clip_along() {
        for text in ["{\"garbage\":", "{\"version\":9}", ""] {
            let records = read(&[(LATEST.to_owned(), text.to_owned()), row(8.0, "c")]);
            assert!(records.problem.is_some() && records.saved.is_none(), "{text}");
            assert_eq!(ids(&records.loose), ["c"]);
        }
    }

    #[test]
    fn what_a_window_left_is_newer_than_the_record() {
        let records = read(&[
            latest(&saved("t=1", &["a", "b", "theirs"])),
            left(10.0, saved("t=2", &["b", "c"]), &["a", "b", "c"]),
            row(5.0, "a"),
            row(20.0, "later"),
        ]);
        let all = records.saved.unwrap();
        assert_eq!(
            (all.query.as_str(), ids(&all.entries)),
            ("t=2", vec!["b", "c", "theirs", "later"])
        );
    }

    #[test]
    fn keys_are_told_apart() {
        assert_eq!(row_id(&row_key("walk~1")), Some("walk~1"));
        assert!(is_left(&left_key("1")) && is_unread(&unread_key(5.0)));
        assert!(
            [LATEST, "left", "unread", "clip"]
                .iter()
                .all(|key| row_id(key).is_none() && !is_left(key) && !is_unread(key))
        );
        assert_eq!(read(&[(unread_key(1.0), "{".to_owned())]), Records::default());
    }
}
