//! Files into the library, and the work back from storage.

use super::{Session, slot_key};
use crate::formats::{self, ImportError, ImportOptions, Imported, import};
use crate::session::library::{Entry, Library, Origin, Sample, SourceFile, file_id};
use crate::session::motion::Motion;
use crate::session::notice::Level;
use crate::session::params::{Key, Value};
use crate::session::recipe::{Slot, made_params};
use crate::session::saved::{Saved, SavedEntry};
use crate::session::undo::History;
use crate::skeleton::Roles;
use sha2::{Digest as _, Sha256};
use std::sync::Arc;

/// What a file gave.
#[derive(Clone, Debug, PartialEq)]
pub struct Loaded {
    /// The ids of its clips.
    pub ids: Vec<String>,
    /// What was odd in it, one sentence each.
    pub warnings: Vec<String>,
}

impl Session {
    /// Reads one file, exactly as if it were dropped on the page: its clips join the library, and the first ones take the places of
    /// built-in clips in A and B.
    ///
    /// # Errors
    /// [`ImportError`] with name, line, column, found and expected; nothing already loaded changes.
    #[expect(clippy::needless_pass_by_value, reason = "the library keeps the file: who loads one hands it over")]
    pub fn load(&mut self, name: &str, bytes: Arc<[u8]>) -> Result<Loaded, ImportError> {
        let options = ImportOptions::default();
        let imported = match import(name, &bytes, &options) {
            Ok(imported) => imported,
            Err(error) => {
                self.say(Level::Error, error.to_string());
                return Err(error);
            }
        };
        self.remember(None);
        let sha256 = sha256_hex(&bytes);
        let (entries, warnings) = file_entries(name, &sha256, &bytes, &options, imported, None);
        let mut ids = Vec::new();
        for entry in entries {
            let id = entry.id.clone();
            let awaited = [Slot::A, Slot::B].into_iter().any(|slot| self.slot(slot).is_none());
            self.library.put(entry);
            if !(awaited
                && [Slot::A, Slot::B]
                    .into_iter()
                    .any(|slot| self.slot(slot).is_some_and(|entry| entry.id == id)))
            {
                self.offer(&id);
            }
            ids.push(id);
        }
        self.history.settle();
        self.library_revision += 1;
        let what = if warnings.is_empty() {
            String::new()
        } else {
            format!(" {}", warnings.join(" "))
        };
        self.say(
            if warnings.is_empty() { Level::Info } else { Level::Warning },
            format!("{name} is in the library.{what}"),
        );
        self.refresh();
        Ok(Loaded { ids, warnings })
    }

    /// Puts a clip that just came into the slot where a user expects it: what is looked at in View; else A, then B, as long as
    /// they hold clips that nobody brought.
    fn offer(&mut self, id: &str) {
        let brought = |session: &Self, slot| {
            session
                .slot(slot)
                .is_some_and(|entry| matches!(entry.origin, Origin::File(_)) && entry.id != id)
        };
        let slot = if self.params.text(Key::Lab) == "view" || !brought(self, Slot::A) {
            Slot::A
        } else if !brought(self, Slot::B) {
            Slot::B
        } else {
            return;
        };
        if self.slot(Slot::A).is_some_and(|entry| entry.id == id) || self.slot(Slot::B).is_some_and(|entry| entry.id == id) {
            return;
        }
        self.set_unchecked(slot_key(slot), Value::Text(id.to_owned()));
        // Times of the clip that was there mean nothing in this one.
        for key in [Key::LeaveA, Key::EnterB, Key::In, Key::Out] {
            self.set_unchecked(key, Value::Auto);
        }
    }

    /// Takes a bundled take that was asked for with [`Request::Sample`]; `packed` is its gzip file.
    ///
    /// # Errors
    /// [`ImportError`] when it is damaged.
    pub fn load_sample(&mut self, sample: &'static Sample, packed: &[u8]) -> Result<(), ImportError> {
        let bytes = formats::unpack_gzip(sample.file, packed)?;
        let imported = import(sample.file.trim_end_matches(".gz"), &bytes, &ImportOptions::default())?;
        let warnings: Vec<String> = imported.warnings.iter().map(ToString::to_string).collect();
        if let Some(clip) = imported.clips.into_iter().next() {
            let motion = Arc::new(Motion::analyze(clip.clip, None));
            self.library.change(sample.id, |entry| {
                entry.motion = Some(motion);
                entry.warnings = warnings;
            });
        }
        self.refresh();
        Ok(())
    }

    /// What is stored of the work.
    #[must_use]
    pub fn saved(&self) -> Saved {
        Saved {
            query: self.query(),
            entries: self.library.entries().iter().map(|entry| SavedEntry::from(&**entry)).collect(),
        }
    }

    /// Brings stored work back; `bytes_of` gives a file's bytes by its SHA-256. Files that are gone or no longer read are named in a notice.
    /// The parameters come from `query` when there is one (a link was opened), else from what was stored.
    pub fn restore(&mut self, saved: &Saved, bytes_of: impl Fn(&str) -> Option<Arc<[u8]>>, query: Option<&str>) {
        let mut lost = Vec::new();
        let mut library = Library::default();
        for stored in &saved.entries {
            match &stored.file {
                None => {
                    if let Some(entry) = self.library.find(&stored.id) {
                        library.put(Entry {
                            name: stored.name.clone(),
                            ..(**entry).clone()
                        });
                    } else if made_params(&stored.id).is_some() {
                        library.put(Entry {
                            id: stored.id.clone(),
                            name: stored.name.clone(),
                            origin: Origin::Made,
                            motion: None,
                            warnings: Vec::new(),
                            roles_by_hand: None,
                        });
                    }
                }
                Some(file) => {
                    let imported = bytes_of(&file.sha256).map(|bytes| (import(&file.name, &bytes, &file.options), bytes));
                    let Some((Ok(imported), bytes)) = imported else {
                        lost.push(file.name.clone());
                        continue;
                    };
                    let (entries, _) = file_entries(&file.name, &file.sha256, &bytes, &file.options, imported, stored.roles.as_ref());
                    for entry in entries.into_iter().filter(|entry| entry.id == stored.id) {
                        library.put(Entry {
                            name: stored.name.clone(),
                            ..entry
                        });
                    }
                }
            }
        }
        if !library.entries().is_empty() {
            self.library = library;
        }
        if !lost.is_empty() {
            self.say(
                Level::Warning,
                format!(
                    "Not found in this browser's storage any more: {}. Drop them again.",
                    lost.join(", ")
                ),
            );
        }
        self.open_link(query.unwrap_or(&saved.query));
        self.history = History::default();
        self.refresh();
    }
}

/// An entry for every clip of a file, and the file's warnings.
fn file_entries(
    name: &str,
    sha256: &str,
    bytes: &Arc<[u8]>,
    options: &ImportOptions,
    imported: Imported,
    roles: Option<&Roles>,
) -> (Vec<Entry>, Vec<String>) {
    let warnings: Vec<String> = imported.warnings.iter().map(ToString::to_string).collect();
    let entry = |(index, clip): (usize, crate::formats::ImportedClip)| Entry {
        id: file_id(name, sha256, index),
        name: clip.clip.name().to_owned(),
        origin: Origin::File(SourceFile {
            name: name.to_owned(),
            sha256: sha256.to_owned(),
            bytes: Arc::clone(bytes),
            index,
            options: *options,
        }),
        motion: Some(Arc::new(Motion::analyze(clip.clip, roles.cloned()))),
        warnings: warnings.clone(),
        roles_by_hand: roles.cloned(),
    };
    (imported.clips.into_iter().enumerate().map(entry).collect(), warnings)
}

fn sha256_hex(bytes: &[u8]) -> String {
    use std::fmt::Write as _;
    Sha256::digest(bytes).iter().fold(String::with_capacity(64), |mut hex, byte| {
        // Writing to a string cannot fail.
        write!(hex, "{byte:02x}").ok();
        hex
    })
}
