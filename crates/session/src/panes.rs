//! The panes: one for each value of the compared parameter, computed again where their inputs have
//! changed.

use crate::clip_resolver::{ClipResolver, widest_window};
use crate::command::CommandError;
use crate::labs::{DrivenPane, LiveDrive, Outcome, PlacedClip, Slot};
use crate::labs::{lab_of, recipe_ingredients, slots_of};
use crate::pane::{NoResult, Pane, PaneResult};
use crate::params::{Key, Kind, MAX_PANES, Params, Value};
use segue_motion::clip::Motion;
use segue_motion::math::Planar;
use std::sync::Arc;

/// The panes of the stage, left to right.
#[derive(Debug, Default)]
pub(crate) struct Panes {
    pub(crate) list: Vec<Pane>,
}

impl Panes {
    /// Returns a pane by its number, counted from 0.
    pub(crate) fn get(&self, index: usize) -> Result<&Pane, CommandError> {
        self.list.get(index).ok_or(CommandError::NotPossible("there is no such pane"))
    }

    /// Returns the first result.
    pub(crate) fn first_result(&self) -> Result<PaneResult<'_>, NoResult> {
        let (mut found, mut refused) = (None, None);
        for result in self.list.iter().map(Pane::result) {
            match result {
                Ok(made) => found = found.or(Some(made)),
                Err(NoResult::Awaited) => return Err(NoResult::Awaited),
                Err(problem) => refused = refused.or(Some(problem)),
            }
        }
        found.ok_or(refused.unwrap_or(NoResult::Awaited))
    }

    /// Returns the outcome on the stage in the first pane.
    pub(crate) fn main_outcome(&self) -> Option<&Arc<Outcome>> {
        self.list.first().and_then(|pane| pane.outcome.as_ref())
    }

    /// Returns the duration of the longest result, or of the clips that stand in for one, seconds.
    pub(crate) fn duration_secs(&self) -> f64 {
        let results = self.list.iter().filter_map(|pane| pane.outcome.as_ref());
        let sources = self.list.iter().flat_map(|pane| &pane.sources);
        results
            .map(|outcome| outcome.duration_secs())
            .chain(sources.map(|source| source.motion.clip().duration_secs()))
            .fold(0.0, f64::max)
    }

    /// Shows a later moment of the driven characters.
    pub(crate) fn show_next(&mut self, outcomes: Vec<Option<Outcome>>) {
        for (pane, outcome) in self.list.iter_mut().zip(outcomes) {
            if let Some(outcome) = outcome {
                pane.show_next(outcome);
            }
        }
    }

    /// Computes the panes again whose inputs have changed; those that the user drives only get
    /// their variant.
    pub(crate) fn refresh(&mut self, clips: &mut ClipResolver<'_>) {
        let compare = clips
            .document
            .params
            .compare()
            .filter(|compare| uses(clips.document.params.lab(), compare.key));
        let variants: Vec<Option<(Key, Value)>> = match compare {
            Some(compare) => compare
                .values
                .iter()
                .take(MAX_PANES)
                .map(|value| Some((compare.key, value.clone())))
                .collect(),
            None => vec![None],
        };
        let is_driven = is_driven_by_user(&clips.document.params);
        let match_window = widest_window(&clips.document.params, compare);
        let mut old = std::mem::take(&mut self.list).into_iter();
        clips.labs.clear_requests();
        clips.labs.graphs.set_guide(None);
        for variant in variants {
            let mut pane = old.next().unwrap_or_default();
            pane.variant = variant;
            let params = Arc::new(pane.params_in(&clips.document.params));
            if !is_driven {
                let answer = clips.answer(&params, pane.inputs.as_ref(), match_window);
                pane.take(answer, &params);
                pane.measure(&mut clips.labs.meter);
            }
            if self.list.is_empty() {
                clips.labs.graphs.set_guide(Some(&params));
            }
            self.list.push(pane);
        }
    }

    /// Adapts the driven characters to the parameters; there are none if the user does not drive.
    pub(crate) fn refresh_driven(&mut self, drive: &mut LiveDrive, clips: &mut ClipResolver<'_>) {
        if !is_driven_by_user(&clips.document.params) {
            drive.restart();
            return;
        }
        let mut wanted = Vec::new();
        for pane in &self.list {
            let params = Arc::new(pane.params_in(&clips.document.params));
            let database = (clips.lab_clips(&params))
                .and_then(|motions| clips.labs.drives.database_of(motions, &params));
            wanted.push(DrivenPane { params, database, shown: pane.outcome.clone() });
        }
        let params: Vec<_> = wanted.iter().map(|pane| Arc::clone(&pane.params)).collect();
        let crowd = clips.document.params.number(Key::Crowd) as usize - 1;
        let answers = drive.refresh(wanted, crowd, &mut clips.labs.meter);
        for ((pane, answer), params) in self.list.iter_mut().zip(answers).zip(params) {
            pane.take(answer, &params);
        }
    }

    /// Shows the available clips of results that cannot be made.
    pub(crate) fn show_sources(&mut self, clips: &mut ClipResolver<'_>) {
        for pane in self.list.iter_mut().filter(|pane| pane.problem.is_some()) {
            let params = pane.params_in(&clips.document.params);
            let found = slots_of(clips.document.params.lab())
                .filter_map(|slot| Some((slot, clips.motion(params.text(slot.key())).ok()?)));
            pane.sources = beside_each_other(found.collect());
        }
    }
}

/// Returns whether the user drives in the lab of the parameters, now or when a database is
/// available.
pub(crate) fn is_driven_by_user(params: &Params) -> bool {
    lab_of(params.lab()).is_own_drive(params)
}

/// Returns whether a parameter has an effect in a lab. Parameters of the view have one in every
/// lab.
fn uses(lab: crate::LabId, key: Key) -> bool {
    let is_clip = |key: Key| recipe_ingredients(lab).any(|ingredient| ingredient == key);
    if key.param().group.is_of_lab() {
        key.param().is_used_by(lab)
    } else {
        !matches!(key.param().kind, Kind::Clip) || is_clip(key)
    }
}

/// Places clips on the stage, the first to the left of the second, seen from behind; a single one
/// stays where its file has it.
fn beside_each_other(clips: Vec<(Slot, Arc<Motion>)>) -> Vec<PlacedClip> {
    /// The distance from the middle to either side, metres.
    const ASIDE_METRES: f64 = 0.6;
    let Some(stands) = clips.first().map(|(_, first)| first.standing_at(0.0)) else {
        return Vec::new();
    };
    let alone = clips.len() == 1;
    let placed =
        clips.into_iter().zip([ASIDE_METRES, -ASIDE_METRES]).map(|((slot, motion), side)| {
            let aside = Planar::new(0.0, if alone { 0.0 } else { side }, 0.0);
            let world_from_clip = stands.after(&aside).after(&motion.standing_at(0.0).inverse());
            PlacedClip::new(slot, &motion, 0.0, world_from_clip)
        });
    placed.collect()
}
