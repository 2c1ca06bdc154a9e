//! Results that are kept in the library.

use super::Session;
use crate::command::CommandError;
use crate::labs::{Slot, lab_of, recipe_id, recipe_name, recipe_params};
use crate::library::{Entry, Origin};
use crate::notice::Level;
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
        let fps = [Slot::A, Slot::B].map(|slot| {
            let motion = self.document.slot(slot).and_then(|entry| entry.motion.as_ref());
            motion.map_or(1.0, |motion| motion.clip().fps())
        });
        let known = CommandError::NotPossible("this clip is in the library already");
        if lab_of(params.lab()).is_clip_as_it_is(&params) {
            return Err(known);
        }
        let id = recipe_id(&params, &outcome, fps).ok_or(CommandError::NotPossible(
            "what was found lies beyond what a link can say: use shorter clips",
        ))?;
        if self.document.library.find(&id).is_some() {
            return Err(known);
        }
        let recipe = recipe_params(&id).ok_or(CommandError::NotPossible(
            "it is made of results of results, which do not fit into a link: save it as a file, and open that",
        ))?;
        let name = recipe_name(&recipe);
        let said = msg!("Saved to the library: {name}. Choose it as A or B.");
        self.document.add(Entry {
            motion: is_whole.then(|| Arc::clone(&outcome.motion)),
            ..Entry::new(id, name, Origin::Made)
        });
        self.say(Level::Info, said);
        Ok(())
    }
}
