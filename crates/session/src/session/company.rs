//! Who plays along on the stage of the Path lab: clips of the library, most of them motions on
//! paths of their own.

use super::Session;
use crate::command::{CommandError, CompanyChange};
use crate::labs::LabError;
use crate::labs::lab::{self, Beside};
use crate::labs::{read_ids, recipe_id, recipe_name, take_up, write_ids};
use crate::library::{Entry, Origin, split_reference};
use crate::params::{Key, Value};
use segue_motion::clip::Motion;
use std::sync::Arc;

/// As many as a stage and an eye have room for.
const MOST: usize = 6;

/// One who plays along.
#[derive(Clone, Debug)]
pub struct Companion {
    /// The id of the clip, as the link has it.
    pub id: String,
    /// What a person calls it.
    pub name: String,
    /// What it does, or why that is not to be seen.
    pub motion: Result<Arc<Motion>, LabError>,
}

impl Companion {
    /// How long it moves, seconds; `None` where nothing is to be seen.
    #[must_use]
    pub fn duration_secs(&self) -> Option<f64> {
        self.motion.as_ref().ok().map(|motion| motion.clip().duration_secs())
    }
}

impl Session {
    /// Who plays along, in the order of the list; nobody in other labs.
    #[must_use]
    pub fn company(&self) -> &[Companion] {
        &self.company
    }

    pub(super) fn company_ids(&self) -> Vec<String> {
        read_ids(self.document.params.text(Key::Others)).unwrap_or_default()
    }

    /// Finds or makes everybody in the list.
    pub(super) fn refresh_company(&mut self) {
        self.company.clear();
        if !lab::of(self.document.params.lab()).has(Beside::Company) {
            return;
        }
        for id in self.company_ids().into_iter().take(MOST) {
            self.document.bring(&id);
            let motion = self.motion_of(&id);
            let entry = self.document.library.find(&id);
            let name =
                entry.map_or_else(|| split_reference(&id).0.to_owned(), |entry| entry.name.clone());
            self.company.push(Companion { id, name, motion });
        }
    }

    /// One step of undo, whatever the change.
    pub(super) fn change_company(&mut self, change: CompanyChange) -> Result<(), CommandError> {
        let mut ids = self.company_ids();
        let nobody = CommandError::NotPossible("nobody is in this place of the list");
        let mut params = self.document.params.clone();
        match change {
            CompanyChange::Join(_) | CompanyChange::JoinResult(_) if ids.len() >= MOST => {
                return Err(CommandError::NotPossible("the stage is full: six play along already"));
            }
            CompanyChange::Join(id) => {
                let id =
                    self.document.library.find(&id).ok_or(CommandError::NoClip(id))?.id.clone();
                self.document.remember(None);
                ids.push(id);
            }
            CompanyChange::JoinResult(pane) => {
                let made = self.made_by(pane)?;
                self.document.remember(None);
                ids.push(self.put_made(made));
            }
            CompanyChange::Edit(place) => {
                let id = ids.get(place).cloned().ok_or(nobody)?;
                let made = self.made_by(0)?;
                take_up(&mut params, &id)?;
                self.document.remember(None);
                ids[place] = self.put_made(made);
            }
            CompanyChange::Leave(place) => {
                if place >= ids.len() {
                    return Err(nobody);
                }
                self.document.remember(None);
                ids.remove(place);
            }
        }
        params.set(Key::Others, Value::Text(write_ids(&ids)))?;
        self.document.params = params;
        Ok(())
    }

    /// Takes a clip off the stage that is no longer in the library.
    /// The result of a pane, as an entry of the library.
    fn made_by(&self, pane: usize) -> Result<Entry, CommandError> {
        let made = self.pane(pane)?.recipe()?;
        let id = recipe_id(made.params, made.outcome, [1.0; 2])
            .ok_or(CommandError::NotPossible("there is no result to put on the stage"))?;
        Ok(Entry {
            motion: (!made.outcome.awaits_feet()).then(|| Arc::clone(&made.outcome.motion)),
            ..Entry::new(id, recipe_name(made.params), Origin::Made)
        })
    }

    /// Puts it into the library, if it is not there; its id.
    fn put_made(&mut self, made: Entry) -> String {
        let id = made.id.clone();
        if self.document.library.find(&id).is_none() {
            self.document.library.put(made);
            self.document.library_revision += 1;
        }
        id
    }
}
