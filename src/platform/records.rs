//! The texts in storage by their keys: the record of all work, a record of every clip that came
//! from a file, and the exit records of closed windows.
//!
//! A clip's record is stored together with the bytes of its file, as soon as the file is read; the
//! record of all work follows later. A clip that the record of all work does not name is thus
//! newer, or that record is damaged; its own record has what is needed. A window that is being
//! closed has no time to read what others have stored, so it writes an exit record of its own,
//! which is merged when the work is read or stored next.

use segue_session::{Saved, SavedEntry};
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;

/// The key of the record of all work.
pub(crate) const LATEST: &str = "latest";
const CLIP_PREFIX: &str = "clip ";
const EXIT_PREFIX: &str = "left ";
const UNREAD_PREFIX: &str = "unread ";

/// Returns the key of a clip's record, by its id.
pub(crate) fn clip_key(id: &str) -> String {
    format!("{CLIP_PREFIX}{id}")
}

/// Returns the id of the clip whose record has that key; `None` for other keys.
pub(crate) fn clip_id(key: &str) -> Option<&str> {
    key.strip_prefix(CLIP_PREFIX)
}

/// Returns the key of a window's exit record.
pub(crate) fn exit_key(window: &str) -> String {
    format!("{EXIT_PREFIX}{window}")
}

/// Returns whether a key is that of an exit record.
pub(crate) fn is_exit_key(key: &str) -> bool {
    key.starts_with(EXIT_PREFIX)
}

/// Returns the key of a damaged record, which is kept.
pub(crate) fn unread_key(at_ms: f64) -> String {
    format!("{UNREAD_PREFIX}{at_ms:.0}")
}

/// Returns whether a key is that of a damaged record.
pub(crate) fn is_unread_key(key: &str) -> bool {
    key.starts_with(UNREAD_PREFIX)
}

/// The record of a clip that came from a file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct ClipRecord {
    /// The time at which it was read, milliseconds since 1970.
    pub(crate) at_ms: f64,
    /// The clip.
    pub(crate) entry: SavedEntry,
}

/// The record that a window writes when it is closed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct ExitRecord {
    /// The time at which it was written, milliseconds since 1970.
    pub(crate) at_ms: f64,
    /// The ids of all clips that the window has read or written; see [`Saved::with_others_of`].
    pub(crate) known: BTreeSet<String>,
    /// The window's work.
    pub(crate) saved: Saved,
}

/// The merged records of a storage.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Records {
    /// The work; `None` where no record of it can be read.
    pub(crate) saved: Option<Saved>,
    /// The clips of files in the order of their reading, where no record of the work can be read.
    pub(crate) loose: Vec<SavedEntry>,
    /// The reason why the record of all work cannot be read.
    pub(crate) problem: Option<String>,
}

/// A record that is merged into that of all work.
enum LaterRecord {
    Clip(Box<SavedEntry>),
    Exit(BTreeSet<String>, Saved),
}

impl Records {
    /// Reads and merges texts, each with its key. Records of clips that the record of all work
    /// names may be left out.
    pub(crate) fn read<'a>(texts: impl IntoIterator<Item = (&'a str, &'a str)>) -> Self {
        Self::read_over(None, texts)
    }

    /// Reads and merges texts as [`Self::read`] does, over a record of all work that is known
    /// already and not among them.
    pub(crate) fn read_over<'a>(
        known: Option<Saved>,
        texts: impl IntoIterator<Item = (&'a str, &'a str)>,
    ) -> Self {
        let mut records = Self { saved: known, ..Self::default() };
        let mut later = Vec::new();
        let (latest, others): (Vec<_>, Vec<_>) =
            texts.into_iter().partition(|(key, _)| *key == LATEST);
        for (_, text) in latest {
            match serde_json::from_str(text) {
                Ok(saved) => records.saved = Some(saved),
                Err(error) => records.problem = Some(error.to_string()),
            }
        }
        let mut ids = records.ids();
        // A window that is closed may have removed clips, which were then added again.
        let may_be_newer = others.iter().any(|(key, _)| is_exit_key(key));
        for (key, text) in others {
            let read = if let Some(id) = clip_id(key) {
                if ids.contains(id) && !may_be_newer {
                    continue;
                }
                serde_json::from_str(text).map(|ClipRecord { at_ms, entry }| {
                    later.push((at_ms, LaterRecord::Clip(Box::new(entry))));
                })
            } else if is_exit_key(key) {
                serde_json::from_str(text).map(|ExitRecord { at_ms, known, saved }| {
                    later.push((at_ms, LaterRecord::Exit(known, saved)));
                })
            } else {
                Ok(())
            };
            if let Err(error) = read {
                log::warn!("stored under `{key}`: {error}");
            }
        }
        later.sort_by(|(one, _), (other, _)| one.total_cmp(other));
        for (_, record) in later {
            match record {
                LaterRecord::Clip(entry) => {
                    if ids.insert(entry.id.clone()) {
                        let saved = records.saved.as_mut();
                        saved.map_or(&mut records.loose, |saved| &mut saved.entries).push(*entry);
                    }
                }
                LaterRecord::Exit(known, saved) => {
                    let mut there = records.saved.take().unwrap_or_default();
                    there.entries.append(&mut records.loose);
                    records.saved = Some(saved.with_others_of(&there, &known));
                    ids = records.ids();
                }
            }
        }
        records
    }

    /// Returns the ids of all clips.
    fn ids(&self) -> BTreeSet<String> {
        let saved = self.saved.iter().flat_map(|saved| &saved.entries);
        saved.chain(&self.loose).map(|entry| entry.id.clone()).collect()
    }

    /// Returns the work with the loose clips.
    pub(crate) fn all(self) -> Saved {
        let mut saved = self.saved.unwrap_or_default();
        saved.entries.extend(self.loose);
        saved
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::platform::work::clip_of;

    fn saved(query: &str, ids: &[&str]) -> Saved {
        let entries = ids.iter().map(|id| clip_of(id)).collect();
        Saved { query: query.to_owned(), entries, ..Saved::default() }
    }

    fn clip_record(at_ms: f64, id: &str) -> (String, String) {
        let entry = clip_of(id);
        (clip_key(id), serde_json::to_string(&ClipRecord { at_ms, entry }).unwrap())
    }

    fn exit_record(at_ms: f64, saved: Saved, known: &[&str]) -> (String, String) {
        let known = known.iter().map(|&id| id.to_owned()).collect();
        (exit_key("7"), serde_json::to_string(&ExitRecord { at_ms, known, saved }).unwrap())
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
    fn clips_newer_than_the_record_follow_its_clips() {
        let records = read(&[
            clip_record(9.0, "b"),
            latest(&saved("t=1", &["a"])),
            clip_record(8.0, "c"),
            clip_record(7.0, "a"),
        ]);
        let all = records.saved.unwrap();
        assert_eq!((all.query.as_str(), ids(&all.entries)), ("t=1", vec!["a", "c", "b"]));
        assert!(records.loose.is_empty() && records.problem.is_none());
    }

    #[test]
    fn loose_clips_are_in_the_order_of_their_reading() {
        let records = read(&[clip_record(9.0, "b"), clip_record(8.0, "c")]);
        assert_eq!(records.saved, None);
        assert_eq!(ids(&records.loose), ["c", "b"]);
        assert_eq!(ids(&records.all().entries), ["c", "b"]);
    }

    #[test]
    fn damaged_record_leaves_the_clips() {
        for text in ["{\"garbage\":", "{\"version\":9}", ""] {
            let records = read(&[(LATEST.to_owned(), text.to_owned()), clip_record(8.0, "c")]);
            assert!(records.problem.is_some() && records.saved.is_none(), "{text}");
            assert_eq!(ids(&records.loose), ["c"]);
        }
    }

    #[test]
    fn exit_record_replaces_the_older_record() {
        let records = read(&[
            latest(&saved("t=1", &["a", "b", "theirs"])),
            exit_record(10.0, saved("t=2", &["b", "c"]), &["a", "b", "c"]),
            clip_record(5.0, "a"),
            clip_record(20.0, "later"),
        ]);
        let all = records.saved.unwrap();
        assert_eq!(
            (all.query.as_str(), ids(&all.entries)),
            ("t=2", vec!["b", "c", "theirs", "later"])
        );
    }

    #[test]
    fn clip_that_was_added_again_after_an_exit_record_is_there() {
        let records = read(&[
            latest(&saved("t=1", &["a", "b"])),
            exit_record(10.0, saved("t=2", &["b"]), &["a", "b"]),
            clip_record(20.0, "a"),
        ]);
        assert_eq!(ids(&records.saved.unwrap().entries), ["b", "a"]);
    }

    #[test]
    fn texts_are_merged_over_a_known_record() {
        let known = saved("t=1", &["a"]);
        let texts = [clip_record(8.0, "c"), clip_record(7.0, "a")];
        let merged = |known, texts: &[(String, String)]| {
            Records::read_over(known, texts.iter().map(|(key, text)| (key.as_str(), text.as_str())))
        };
        let all = [&[latest(&known)], &texts[..]].concat();
        assert_eq!(merged(Some(known), &texts), read(&all));
    }

    #[test]
    fn keys_of_records_are_distinct() {
        assert_eq!(clip_id(&clip_key("walk~1")), Some("walk~1"));
        assert!(is_exit_key(&exit_key("1")) && is_unread_key(&unread_key(5.0)));
        assert!(
            [LATEST, "left", "unread", "clip"]
                .iter()
                .all(|key| clip_id(key).is_none() && !is_exit_key(key) && !is_unread_key(key))
        );
        assert_eq!(read(&[(unread_key(1.0), "{".to_owned())]), Records::default());
    }
}
