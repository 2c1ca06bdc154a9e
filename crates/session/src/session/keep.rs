//! Results that are kept in the library.

use super::Session;
use crate::command::CommandError;
use crate::labs::{Answer, ClipEdit, Outcome, Slot, edit_params};
use crate::labs::{lab_of, recipe_id, recipe_name, recipe_params};
use crate::library::{Entry, Origin};
use crate::notice::Level;
use crate::pane::NoResult;
use crate::params::{Key, Params};
use segue_text::msg;
use std::sync::Arc;

impl Session {
    /// Adds a pane's result to the library.
    pub(super) fn keep(&mut self, pane: usize) -> Result<(), CommandError> {
        let made = self.panes.get(pane)?.recipe()?;
        let (params, outcome) =
            (self.with_recording(made.params.clone()), Arc::clone(made.outcome));
        if outcome.walk().is_some_and(|walk| walk.is_guided) {
            return Err(CommandError::NotPossible(
                "this walk is the same as the one in the first pane: open it alone to keep it",
            ));
        }
        let is_whole = !outcome.awaits_feet() && !self.is_driven();
        let known = CommandError::NotPossible("this clip is in the library already");
        if lab_of(params.lab()).is_clip_as_it_is(&params) {
            return Err(known);
        }
        let id = self.recipe_of(&params, &outcome)?;
        if self.document.library.find(&id).is_some() {
            return Err(known);
        }
        let name = recipe_name(&readable_recipe(&id)?);
        let said = msg!("Saved to the library: {name}. Choose it as A or B.");
        let entry = Entry::new(id, name, Origin::Made);
        self.document.add(if is_whole {
            entry.with_motion(Arc::clone(&outcome.motion))
        } else {
            entry
        });
        self.say(Level::Info, said);
        Ok(())
    }

    /// Returns the id by which links name a pane's result as a clip, whether or not the library has
    /// it: its recipe, or the id of the clip that it is unchanged.
    ///
    /// # Errors
    /// [`CommandError`] if there is no result, or no link can say how it is made.
    pub fn result_id(&self, pane: usize) -> Result<String, CommandError> {
        let made = self.panes.get(pane)?.recipe()?;
        let params = self.with_recording(made.params.clone());
        if lab_of(params.lab()).is_clip_as_it_is(&params) {
            return Ok(params.text(Key::A).to_owned());
        }
        let id = self.recipe_of(&params, made.outcome)?;
        readable_recipe(&id)?;
        Ok(id)
    }

    /// Returns the recipe of a result of the clips in the slots.
    fn recipe_of(&self, params: &Params, outcome: &Outcome) -> Result<String, CommandError> {
        let fps = [Slot::A, Slot::B].map(|slot| {
            let facts = self.document.slot(slot).and_then(|entry| entry.facts.as_ref());
            facts.map_or(1.0, |facts| facts.fps)
        });
        recipe_id(params, outcome, fps).ok_or(CommandError::NotPossible(
            "what was found lies beyond what a link can say: use shorter clips",
        ))
    }

    /// Adds a clip with one edit to the library, and puts it into a slot.
    pub(super) fn keep_edited(
        &mut self,
        reference: &str,
        edit: ClipEdit,
        slot: Option<Slot>,
    ) -> Result<(), CommandError> {
        let source = self.document.clip(reference)?.id.clone();
        let unsayable = CommandError::NotPossible(
            "what was found lies beyond what a link can say: use shorter clips",
        );
        let params = edit_params(&source, edit).ok_or(unsayable.clone())?;
        let outcome = match self.clips().answer_here(&params) {
            Answer::Made { outcome, .. } => outcome,
            Answer::Refused(problem) => return Err(NoResult::Refused(problem).into()),
            Answer::Same { .. } | Answer::Awaited => return Err(NoResult::Awaited.into()),
        };
        let id = recipe_id(&params, &outcome, [1.0; 2]).ok_or(unsayable)?;
        let name = recipe_name(&readable_recipe(&id)?);
        let is_known = self.document.library.find(&id).is_some();
        if is_known && slot.is_none() {
            return Err(CommandError::NotPossible("this clip is in the library already"));
        }
        let said = msg!("Added to the library: {name}.", name = name.clone());
        let entry = Entry::new(&*id, name, Origin::Made).with_motion(Arc::clone(&outcome.motion));
        self.document.add_to_slot(entry, slot);
        if !is_known {
            self.say(Level::Info, said);
        }
        Ok(())
    }
}

/// Returns the parameters of a recipe, if a link can contain it.
fn readable_recipe(id: &str) -> Result<Params, CommandError> {
    recipe_params(id).ok_or(CommandError::NotPossible(
        "it is made of results of results, which do not fit into a link: save it as a file, and open that",
    ))
}
