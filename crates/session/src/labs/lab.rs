//! The trait of labs: the inputs of a result, its name, and its recipe.

use super::error::LabError;
use super::outcome::{Outcome, Slot};
use crate::LabId;
use crate::params::{Key, Mark, Params, Value};
use segue_motion::clip::Motion;
use segue_text::Message;
use std::any::Any;
use std::fmt;
use std::sync::Arc;

/// The definition of a lab, in the lab's own file. `S` is the state that labs keep between results:
/// a lab names the parts of it that it uses.
pub(crate) trait Lab<S>: Sync {
    /// Returns the ids of the clips in the lab's own list; empty if it has no list.
    fn listed(&self, params: &Params) -> Vec<String> {
        self.more_clips(params).unwrap_or_default()
    }

    /// Returns the parameters to set so that the lab no longer uses a clip; empty if it does not
    /// use it.
    fn without_clip(&self, _params: &Params, _id: &str) -> Vec<(Key, Value)> {
        Vec::new()
    }

    /// Returns the ids of the clips that the result is made from besides those in its slots.
    ///
    /// # Errors
    /// [`LabError`] if the list cannot be read.
    fn more_clips(&self, _params: &Params) -> Result<Vec<String>, LabError> {
        Ok(Vec::new())
    }

    /// Returns the parameters that make the lab work with these clips; `None` if it takes no list
    /// of clips.
    fn with_clips(&self, _ids: &[String]) -> Option<Vec<(Key, Value)>> {
        None
    }

    /// Returns everything that the result depends on; `None` while it is being computed.
    /// `match_window` is the window of the automatic match, in frames.
    ///
    /// # Errors
    /// [`LabError`] with the reason why there can be no result, and the remedy.
    fn inputs(
        &self,
        labs: &mut S,
        clips: LabClips,
        params: &Params,
        match_window: usize,
    ) -> Result<Option<Inputs>, LabError>;

    /// Returns the name of the result; `a` and `b` are the names of the clips in its slots.
    fn result_name(&self, params: &Params, a: Message, b: Message) -> Message;

    /// Returns the name of a file of the result, without its ending.
    fn file_stem(&self, params: &Params) -> String;

    /// Returns the id of the result, if that is not the lab's name with its parameters.
    fn own_id(&self, _params: &Params) -> Option<String> {
        None
    }

    /// Returns the parameters to set for the name before the brackets of an [own id](Self::own_id);
    /// `None` for other names.
    fn values_of_id(&self, _name: &str) -> Option<Vec<(Key, Value)>> {
        None
    }

    /// Returns whether the result is an unchanged clip of the library, which has an id already.
    fn is_clip_as_it_is(&self, _params: &Params) -> bool {
        false
    }

    /// Returns the parameters to set so that the recipe makes the result as long as it is now.
    fn length_parameters(&self, _outcome: &Outcome) -> Vec<(Key, Value)> {
        Vec::new()
    }

    /// Returns the values of parameters that were determined automatically; `fps` are the frame
    /// rates of the clips in A and B.
    fn found(&self, _outcome: &Outcome, _fps: [f64; 2]) -> Vec<(Key, f64)> {
        Vec::new()
    }

    /// Returns a link to the lab with its bundled captured clips; `None` if it takes a list of
    /// clips or has none.
    fn captured_link(&self) -> Option<&'static str> {
        None
    }

    /// Returns whether the result is an unchanged clip, which a newly opened one replaces.
    fn shows_clip(&self) -> bool {
        false
    }

    /// Returns whether results are made at once, and from parameters alone.
    fn is_synthetic(&self) -> bool {
        false
    }

    /// Returns whether, with these parameters, the user drives the character.
    fn is_own_drive(&self, _params: &Params) -> bool {
        false
    }

    /// Returns whether the lab has a view beside the result.
    fn has(&self, _beside: Beside) -> bool {
        false
    }
}

/// Returns the slots whose clips a lab's result is made from.
pub(crate) fn slots_of(lab: LabId) -> impl Iterator<Item = Slot> {
    [Slot::A, Slot::B].into_iter().filter(move |slot| slot.key().param().is_used_by(lab))
}

/// Returns whether a parameter can change the result. Those of the foot lock cannot while it is
/// off.
pub(super) fn can_change_result(params: &Params, key: Key) -> bool {
    params.is_on(Key::FootLock) || !key.param().has(Mark::Lock)
}

/// A part of the state that labs keep between results.
pub(crate) trait HasPart<T> {
    /// Returns the part.
    fn part(&mut self) -> &mut T;
}

/// The clips that a result is made from.
#[derive(Clone, Debug, Default)]
pub(crate) struct LabClips {
    /// The clips in the lab's slots, in their order.
    pub(crate) slots: Vec<Arc<Motion>>,
    /// The other clips, by id.
    pub(crate) more: Vec<MoreClip>,
}

/// A clip that a lab takes besides those in its slots.
#[derive(Clone, Debug)]
pub(crate) struct MoreClip {
    pub(crate) id: String,
    /// Its name on screen.
    pub(crate) name: String,
    pub(crate) motion: Arc<Motion>,
}

impl LabClips {
    pub(crate) fn first(&self) -> Result<&Arc<Motion>, LabError> {
        self.slots.first().ok_or(LabError::NoClip)
    }

    pub(crate) fn motions(&self) -> Vec<Arc<Motion>> {
        self.more.iter().map(|clip| Arc::clone(&clip.motion)).collect()
    }
}

/// A view that a lab may show beside its result.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Beside {
    /// Clips that play beside the result.
    ExtraCharacters,
    /// The graph of a walk.
    Graph,
    /// The distances between the frames of two clips.
    DistanceMap,
}

/// The inputs of a lab's result. Equal inputs give equal results, so nothing is computed twice.
pub(crate) trait LabInputs: fmt::Debug + PartialEq + Send + Sync + 'static {
    /// Computes the result.
    ///
    /// # Errors
    /// [`LabError`] with the reason why there can be no result, and the remedy.
    fn run(&self) -> Result<Outcome, LabError>;

    /// Returns whether the result is preliminary: its motion or its metrics will change.
    fn is_draft(&self) -> bool {
        false
    }
}

/// The inputs of a result that is made already. They equal their own copies alone.
#[derive(Clone, Debug)]
pub(crate) struct MadeInputs(pub(super) Arc<Outcome>);

impl PartialEq for MadeInputs {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

impl LabInputs for MadeInputs {
    fn run(&self) -> Result<Outcome, LabError> {
        Ok(Outcome::clone(&self.0))
    }
}

/// The inputs of any lab.
#[derive(Clone, Debug)]
pub(crate) struct Inputs(Arc<dyn AnyInputs>);

/// [`LabInputs`] of any lab.
trait AnyInputs: Any + fmt::Debug + Send + Sync {
    fn run(&self) -> Result<Outcome, LabError>;
    fn is_draft(&self) -> bool;
    fn equals(&self, other: &dyn AnyInputs) -> bool;
}

impl<T: LabInputs> AnyInputs for T {
    fn run(&self) -> Result<Outcome, LabError> {
        LabInputs::run(self)
    }

    fn is_draft(&self) -> bool {
        LabInputs::is_draft(self)
    }

    fn equals(&self, other: &dyn AnyInputs) -> bool {
        (other as &dyn Any).downcast_ref::<T>().is_some_and(|other| self == other)
    }
}

impl Inputs {
    /// Wraps the inputs of a lab.
    pub(crate) fn new(inputs: impl LabInputs) -> Self {
        Self(Arc::new(inputs))
    }

    /// Computes the result; errors as [`LabInputs::run`].
    pub(crate) fn run(&self) -> Result<Outcome, LabError> {
        self.0.run()
    }

    /// Returns whether the result is preliminary, as [`LabInputs::is_draft`].
    pub(crate) fn is_draft(&self) -> bool {
        self.0.is_draft()
    }

    /// Returns the inputs as those of one lab; `None` if they are another's.
    pub(crate) fn of_lab<T: LabInputs>(&self) -> Option<&T> {
        (&*self.0 as &dyn Any).downcast_ref()
    }
}

impl PartialEq for Inputs {
    fn eq(&self, other: &Self) -> bool {
        self.0.equals(&*other.0)
    }
}
