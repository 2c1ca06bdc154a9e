//! Clips that play beside the result on the stage, most of them motions on paths of their own.

use crate::clip_resolver::ClipResolver;
use crate::command::{CommandError, ExtraCharacterCommand};
use crate::document::Document;
use crate::labs::LabError;
use crate::labs::lab::Beside;
use crate::labs::{lab_of, recipe_id, recipe_ingredients, recipe_name, recipe_params};
use crate::library::{Entry, Origin, split_reference};
use crate::panes::Panes;
use crate::params::{Key, List, Params, Value, ValueError};
use crate::{LabId, Selected};
use segue_motion::clip::Motion;
use std::sync::Arc;

/// The greatest number of extra characters.
pub(crate) const MAX_CHARACTERS: usize = 6;

/// A clip that plays beside the result.
#[derive(Clone, Debug)]
pub struct ExtraCharacter {
    /// The id of the clip in the link.
    pub id: String,
    /// The clip's name on screen.
    pub name: String,
    /// The motion, or the reason why there is none.
    pub motion: Result<Arc<Motion>, LabError>,
}

impl ExtraCharacter {
    /// Returns the duration of the motion, seconds; `None` if there is none.
    #[must_use]
    pub fn duration_secs(&self) -> Option<f64> {
        self.motion.as_ref().ok().map(|motion| motion.clip().duration_secs())
    }
}

/// The clips that play beside the result.
#[derive(Debug, Default)]
pub(crate) struct ExtraCharacters {
    /// The characters, in the order of the parameter's list; none in other labs.
    pub(crate) list: Vec<ExtraCharacter>,
}

impl ExtraCharacters {
    /// Returns the duration of the longest motion, seconds.
    pub(crate) fn duration_secs(&self) -> f64 {
        self.list.iter().filter_map(ExtraCharacter::duration_secs).fold(0.0, f64::max)
    }

    /// Resolves the clips in the list.
    pub(crate) fn refresh(&mut self, clips: &mut ClipResolver<'_>) {
        self.list.clear();
        if !lab_of(clips.document.params.lab()).has(Beside::ExtraCharacters) {
            return;
        }
        for id in ids(clips.document).into_iter().take(MAX_CHARACTERS) {
            clips.document.ensure_clip(&id);
            let motion = clips.motion(&id);
            let entry = clips.document.library.find(&id);
            let name =
                entry.map_or_else(|| split_reference(&id).0.to_owned(), |entry| entry.name.clone());
            self.list.push(ExtraCharacter { id, name, motion });
        }
    }
}

/// Returns the ids in the list.
fn ids(document: &Document) -> Vec<String> {
    document.params.clip_ids(Key::Others).to_vec()
}

/// Carries out a command as one step for undo.
pub(crate) fn apply(
    command: ExtraCharacterCommand,
    document: &mut Document,
    panes: &Panes,
) -> Result<(), CommandError> {
    let mut ids = ids(document);
    let nobody = CommandError::NotPossible("this place of the list is empty");
    let mut params = document.params.clone();
    match command {
        ExtraCharacterCommand::Add(_) | ExtraCharacterCommand::AddResult(_)
            if ids.len() >= MAX_CHARACTERS =>
        {
            return Err(CommandError::NotPossible(
                "the stage is full: it already has six extra characters",
            ));
        }
        ExtraCharacterCommand::Add(id) => {
            let id = document.clip(&id)?.id.clone();
            document.remember(None);
            ids.push(id);
        }
        ExtraCharacterCommand::AddResult(pane) => {
            let entry = result_entry(panes, pane)?;
            document.remember(None);
            ids.push(put(document, entry));
        }
        ExtraCharacterCommand::Edit(place) => {
            let id = ids.get(place).cloned().ok_or(nobody)?;
            let entry = result_entry(panes, 0)?;
            edit(&mut params, &id)?;
            document.remember(None);
            ids[place] = put(document, entry);
        }
        ExtraCharacterCommand::Remove(place) => {
            if place >= ids.len() {
                return Err(nobody);
            }
            document.remember(None);
            ids.remove(place);
        }
    }
    params.set(Key::Others, List::ClipIds(ids).into())?;
    document.params = params;
    Ok(())
}

/// Returns the result of a pane as an entry of the library.
fn result_entry(panes: &Panes, pane: usize) -> Result<Entry, CommandError> {
    let made = panes.get(pane)?.recipe()?;
    let id = recipe_id(made.params, made.outcome, [1.0; 2])
        .ok_or(CommandError::NotPossible("there is no result to put on the stage"))?;
    Ok(Entry {
        motion: (!made.outcome.awaits_feet()).then(|| Arc::clone(&made.outcome.motion)),
        ..Entry::new(id, recipe_name(made.params), Origin::Made)
    })
}

/// Adds an entry to the library, if it is not there. Returns its id.
fn put(document: &mut Document, entry: Entry) -> String {
    let id = entry.id.clone();
    if document.library.find(&id).is_none() {
        document.library.put(entry);
        document.library_revision += 1;
    }
    id
}

/// Sets the parameters to those of a clip: to its recipe if the lab with extra characters made it,
/// otherwise to the clip as that lab opens it.
fn edit(params: &mut Params, id: &str) -> Result<(), ValueError> {
    let has_characters = |lab: &LabId| lab_of(*lab).has(Beside::ExtraCharacters);
    let Some(lab) = LabId::ALL.iter().copied().find(has_characters) else {
        return Ok(());
    };
    let made = recipe_params(id).filter(|made| made.lab() == lab);
    for key in recipe_ingredients(lab) {
        let value = match (&made, key) {
            (Some(made), _) => made.get(key).clone(),
            (None, Key::A) => Value::Text(id.to_owned()),
            (None, _) => key.param().default_value(),
        };
        params.set(key, value)?;
    }
    Ok(())
}
