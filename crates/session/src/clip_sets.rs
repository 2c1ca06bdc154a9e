//! The set of clips of a lab: synthesised, captured, or the user's own.

use super::labs::lab::{Lab, slots_of};
use super::labs::{LabSet, Slot, lab_of};
use super::library::{Entry, Origin};
use super::link;
use super::params::{Key, Kind, ListKind, Value};
use super::samples::SUBJECT_16;
use super::session::Session;

/// A set of clips for the whole lab.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ClipSet {
    /// Synthesised clips: the lab's defaults.
    Made,
    /// The bundled takes of one actor.
    Captured,
    /// The user's own files, in labs with any number of clips.
    Own,
}

impl Session {
    /// Returns the parameters that make the open lab use a set; `None` if it has no choice of sets,
    /// or there are no such clips.
    #[must_use]
    pub fn clip_set(&self, set: ClipSet) -> Option<Vec<(Key, Value)>> {
        let lab = lab_of(self.params().lab());
        match set {
            ClipSet::Captured => captured(lab),
            ClipSet::Made => captured(lab).map(|values| {
                let default = |(key, _): (Key, Value)| (key, key.param().default_value());
                values.into_iter().map(default).collect()
            }),
            ClipSet::Own => {
                let own = self.library().entries().iter().filter(|entry| is_own_motion(entry));
                let ids: Vec<String> = own.map(|entry| entry.id.clone()).take(MAX_OWN).collect();
                lab.with_clips(&ids).filter(|_| !ids.is_empty())
            }
        }
    }

    /// Returns the parameters that make the open lab use these clips: as its list of clips, or in A
    /// and B; `None` if it cannot use so many.
    #[must_use]
    pub fn with_clips(&self, ids: &[String]) -> Option<Vec<(Key, Value)>> {
        let lab = self.params().lab();
        if ids.is_empty() {
            return None;
        }
        lab_of(lab).with_clips(ids).or_else(|| {
            let slots: Vec<Slot> = slots_of(lab).collect();
            let values =
                slots.iter().zip(ids).map(|(slot, id)| (slot.key(), Value::Text(id.clone())));
            (ids.len() == slots.len()).then(|| values.collect())
        })
    }

    /// Returns whether the open lab uses a set.
    #[must_use]
    pub fn uses_clip_set(&self, set: ClipSet) -> bool {
        let names_clips =
            |key: Key| matches!(key.param().kind, Kind::Clip | Kind::List(ListKind::ClipIds));
        self.clip_set(set).is_some_and(|values| {
            let mut clips = values.iter().filter(|(key, _)| names_clips(*key));
            clips.all(|(key, value)| self.params().get(*key) == value)
        })
    }
}

/// The greatest number of own clips: the limit of the Graph lab.
const MAX_OWN: usize = 64;

/// Returns the parameters that make a lab use the bundled captured clips.
fn captured(lab: &dyn Lab<LabSet>) -> Option<Vec<(Key, Value)>> {
    let listed = || {
        let ids: Vec<String> = SUBJECT_16.iter().map(|sample| sample.id.to_owned()).collect();
        lab.with_clips(&ids)
    };
    lab.captured_link().map(|query| link::read(query).values).or_else(listed)
}

/// Returns whether an entry is a motion file of the user's. A skeleton or a character alone is not.
fn is_own_motion(entry: &Entry) -> bool {
    entry.moves() && matches!(entry.origin, Origin::File(_))
}
