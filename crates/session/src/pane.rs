//! A pane of the stage: a result, and its relation to the present parameters.

use crate::labs::{Answer, ArtefactMeter, Inputs, LabError, Outcome, PlacedClip};
use crate::params::{Key, Params, Value};
use crate::playback::speed_ramp::{SpeedRamp, cycle_durations};
use segue_motion::math::Planar;
use segue_text::ToMessage;
use std::sync::Arc;

/// One pane of the stage: a result under one value of the compared parameter.
///
/// While a result is computed, an older one may stay on the stage. Clips, files, numbers and
/// reports are made from [`Pane::result`], never from the outcome on the stage.
#[derive(Clone, Debug, Default)]
pub struct Pane {
    /// The compared parameter and this pane's value; `None` when there is nothing to compare.
    pub variant: Option<(Key, Value)>,
    /// The result on the stage: the present one, or, while that is computed, an earlier one
    /// ([`Pane::is_outdated`]). Always `None` beside a [`problem`](Self::problem).
    pub outcome: Option<Arc<Outcome>>,
    /// The reason why the result cannot be made, with the remedy.
    pub problem: Option<LabError>,
    /// The clips from which the result would have been made, placed on the stage in its stead.
    /// Empty without a problem.
    pub sources: Vec<PlacedClip>,
    /// The parameters that `outcome` was made from.
    made_from: Option<Arc<Params>>,
    standing: OutcomeState,
    pub(crate) inputs: Option<Inputs>,
    /// The placement in the shown world that a looping result has reached.
    pub(crate) place: Planar,
    /// A gait that has not reached the speed of the result yet.
    pub(crate) ramp: Option<SpeedRamp>,
}

/// The relation of an outcome to the present parameters.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum OutcomeState {
    /// The result of earlier parameters, while that of the present ones is being computed.
    #[default]
    Earlier,
    /// A draft of the present parameters: its place has not been found, or its feet are not locked
    /// yet.
    Draft,
    /// The final result.
    Finished,
}

impl OutcomeState {
    fn of(is_draft: bool) -> Self {
        if is_draft { Self::Draft } else { Self::Finished }
    }
}

/// A result, and the parameters that it was made from.
#[derive(Clone, Copy, Debug)]
pub struct PaneResult<'a> {
    /// The result.
    pub outcome: &'a Arc<Outcome>,
    /// The parameters by which it is made again.
    pub params: &'a Params,
}

/// The reason why a pane has no result to pass on.
#[derive(Clone, Debug, PartialEq, thiserror::Error, ToMessage)]
pub enum NoResult {
    /// The result is refused.
    #[error("{problem}", problem = .0.to_sentence())]
    Refused(LabError),
    /// The result is not available yet.
    #[error("the result is still being computed")]
    Awaited,
}

/// The content of a pane at some time.
#[derive(Clone, Copy, Debug)]
pub struct PaneContent<'a> {
    /// The pane's result; a gait that approaches it, if the speed has just been changed.
    pub outcome: &'a Arc<Outcome>,
    /// The time in its motion, seconds.
    pub secs: f64,
    /// The placement of the motion in the shown world.
    pub place: Planar,
}

impl Pane {
    /// Returns the result of the present parameters, to be kept, saved, measured or described.
    ///
    /// # Errors
    /// [`NoResult`] if it cannot be made, and while it is computed: the stage then shows a result
    /// of earlier parameters, or a draft.
    pub fn result(&self) -> Result<PaneResult<'_>, NoResult> {
        if let Some(problem) = &self.problem {
            return Err(NoResult::Refused(problem.clone()));
        }
        self.made().filter(|_| self.standing == OutcomeState::Finished).ok_or(NoResult::Awaited)
    }

    /// Returns the result for uses that make it again from its parameters: like [`Pane::result`],
    /// but its feet may still have to be locked.
    pub(crate) fn recipe(&self) -> Result<PaneResult<'_>, NoResult> {
        let drafted = self
            .made()
            .filter(|made| self.standing == OutcomeState::Draft && made.outcome.awaits_feet());
        drafted.map_or_else(|| self.result(), Ok)
    }

    /// Returns the outcome on the stage, and the parameters that it was made from.
    fn made(&self) -> Option<PaneResult<'_>> {
        let (outcome, params) = (self.outcome.as_ref()?, self.made_from.as_deref()?);
        Some(PaneResult { outcome, params })
    }

    /// Returns the parameters that the outcome on the stage was made from; `None` if there is none.
    #[must_use]
    pub fn made_from(&self) -> Option<&Params> {
        self.made().map(|made| made.params)
    }

    /// Returns the compared parameter and its value in the outcome on the stage; without an
    /// outcome, its value in the present parameters.
    #[must_use]
    pub fn compared(&self) -> Option<(Key, &Value)> {
        let (key, value) = self.variant.as_ref()?;
        Some((*key, self.made_from().map_or(value, |from| from.get(*key))))
    }

    /// Returns whether the outcome on the stage has earlier parameters, while that of the present
    /// ones is being computed.
    #[must_use]
    pub fn is_outdated(&self) -> bool {
        self.outcome.is_some() && self.standing == OutcomeState::Earlier
    }

    /// Applies the answer to `params`. If there can be no result, an earlier one is removed.
    pub(crate) fn take(&mut self, answer: Answer, params: &Arc<Params>) {
        self.problem = None;
        self.sources.clear();
        match answer {
            Answer::Made { outcome, is_draft, inputs } => {
                self.outcome = Some(outcome);
                self.inputs = inputs;
                self.made_from = Some(Arc::clone(params));
                self.standing = OutcomeState::of(is_draft);
            }
            Answer::Same { is_draft } => {
                self.made_from = Some(Arc::clone(params));
                self.standing = OutcomeState::of(is_draft);
            }
            Answer::Awaited => {
                self.standing = OutcomeState::Earlier;
                // An earlier result of the same lab stays until there is a newer one.
                if self.made_from().is_some_and(|from| from.get(Key::Lab) != params.get(Key::Lab)) {
                    self.clear();
                }
            }
            Answer::Refused(problem) => {
                self.clear();
                self.problem = Some(problem);
            }
        }
    }

    /// Adds the metrics of every lab at the front of a new result's list. Until they are measured
    /// it is a draft.
    pub(crate) fn measure(&mut self, meter: &mut ArtefactMeter) {
        let Some(outcome) =
            self.outcome.as_mut().filter(|_| self.standing != OutcomeState::Earlier)
        else {
            return;
        };
        if outcome.is_measured {
            return;
        }
        let found = meter.numbers(outcome);
        if found.is_none() {
            self.standing = OutcomeState::Draft;
        }
        if found.is_some() || !outcome.awaits_numbers() {
            Arc::make_mut(outcome).take_numbers(found);
        }
    }

    /// Shows a later moment of a driven character.
    pub(crate) fn show_next(&mut self, outcome: Outcome) {
        self.outcome = Some(Arc::new(outcome));
    }

    /// Returns the parameters with the pane's own value of the compared one.
    pub(crate) fn params_in(&self, params: &Params) -> Params {
        let mut params = params.clone();
        if let Some((key, value)) = &self.variant {
            let result = params.set(*key, value.clone());
            debug_assert!(result.is_ok(), "compare holds checked values: {result:?}");
        }
        params
    }

    fn clear(&mut self) {
        (self.outcome, self.made_from, self.inputs, self.ramp) = (None, None, None, None);
        self.place = Planar::IDENTITY;
        self.standing = OutcomeState::Earlier;
    }

    /// Returns the content at a time of the timeline; `None` without a result. A result that loops
    /// and is shorter than the timeline begins again, and continues from where the character is.
    #[must_use]
    pub fn shown_at(&self, secs: f64) -> Option<PaneContent<'_>> {
        let own = self.outcome.as_ref()?;
        let on_ramp = self.ramp.as_ref().and_then(|ramp| {
            let [own_secs, ramp_secs] = cycle_durations(own, &ramp.outcome)?;
            Some((&ramp.outcome, secs / own_secs * ramp_secs))
        });
        let (outcome, secs) = on_ramp.unwrap_or((own, secs));
        let (secs, place) = outcome.around(secs);
        Some(PaneContent { outcome, secs, place: self.place.after(&place) })
    }
}
