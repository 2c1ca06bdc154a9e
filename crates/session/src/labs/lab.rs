//! The trait of labs: what a result depends on, what it is called, and what it is made from.

use super::error::LabError;
use super::outcome::{Outcome, Slot};
use crate::LabId;
use crate::params::{Key, Mark, Params, Value};
use segue_motion::clip::Motion;
use segue_text::Message;
use std::any::Any;
use std::fmt;
use std::sync::Arc;

/// The facts of a lab, in the lab's own file. `S` is what labs remember between results: a lab
/// names the parts of it that it uses.
pub(crate) trait Lab<S>: Sync {
    /// Returns the ids of the clips that the lab's own list names; none where it has no list.
    fn listed(&self, params: &Params) -> Vec<String> {
        self.more_clips(params).unwrap_or_default()
    }

    /// Returns what is to be set so that the lab no longer names a clip; nothing where it does not.
    fn without_clip(&self, _params: &Params, _id: &str) -> Vec<(Key, Value)> {
        Vec::new()
    }

    /// Returns the ids of the clips that the result is made from besides those in its slots.
    ///
    /// # Errors
    /// Says what of the list cannot be read.
    fn more_clips(&self, _params: &Params) -> Result<Vec<String>, LabError> {
        Ok(Vec::new())
    }

    /// Returns what is to be set so that the lab works with these clips; `None` where it takes no
    /// list of clips.
    fn with_clips(&self, _ids: &[String]) -> Option<Vec<(Key, Value)>> {
        None
    }

    /// Returns what the result depends on; `None` while that is still being computed.
    /// `match_window` is the window of the automatic match, in frames.
    ///
    /// # Errors
    /// Says why there can be no result, and what to do.
    fn inputs(
        &self,
        labs: &mut S,
        clips: LabClips,
        params: &Params,
        match_window: usize,
    ) -> Result<Option<Inputs>, LabError>;

    /// Returns the name of the result; `a` and `b` are the names of the clips in its slots.
    fn result_name(&self, params: &Params, a: Message, b: Message) -> Message;

    /// Returns the name of a file with the result, without its ending.
    fn file_stem(&self, params: &Params) -> String;

    /// Returns the id of the result, where that is not the lab's name with its parameters.
    fn own_id(&self, _params: &Params) -> Option<String> {
        None
    }

    /// Returns what is to be set for the name in front of an [own id](Self::own_id); `None` for
    /// other names.
    fn values_of_id(&self, _name: &str) -> Option<Vec<(Key, Value)>> {
        None
    }

    /// Returns whether the result is a clip of the library as it is, which has an id already.
    fn is_clip_as_it_is(&self, _params: &Params) -> bool {
        false
    }

    /// Returns what is to be set so that the recipe makes the result as long as it is by now.
    fn grown(&self, _outcome: &Outcome) -> Vec<(Key, Value)> {
        Vec::new()
    }

    /// Returns the values that were found for parameters left to Segue; `fps` are the frame rates
    /// of the clips in A and B.
    fn found(&self, _outcome: &Outcome, _fps: [f64; 2]) -> Vec<(Key, f64)> {
        Vec::new()
    }

    /// Returns a link to the lab's bundled captured clips; `None` where it takes a list of clips or
    /// has none.
    fn captured_link(&self) -> Option<&'static str> {
        None
    }

    /// Returns whether the lab shows one clip: a file that is opened takes its place.
    fn shows_clip(&self) -> bool {
        false
    }

    /// Returns whether results are made in a moment, and from parameters alone.
    fn is_synthetic(&self) -> bool {
        false
    }

    /// Returns whether the user drives the result, with these parameters.
    fn is_own_drive(&self, _params: &Params) -> bool {
        false
    }

    /// Returns whether there is something beside the result.
    fn has(&self, _beside: Beside) -> bool {
        false
    }
}

/// Returns the slots whose clips a lab's result is made from.
pub(crate) fn slots_of(lab: LabId) -> impl Iterator<Item = Slot> {
    [Slot::A, Slot::B].into_iter().filter(move |slot| slot.key().param().is_used_by(lab))
}

/// Returns whether a parameter can change the result: those of foot lock cannot while it is off.
pub(super) fn counts(params: &Params, key: Key) -> bool {
    params.is_on(Key::FootLock) || !key.param().has(Mark::Lock)
}

/// A part of what labs remember between results.
pub(crate) trait HasPart<T> {
    /// Returns the part.
    fn part(&mut self) -> &mut T;
}

/// The clips that a result is made from.
#[derive(Clone, Debug, Default)]
pub(crate) struct LabClips {
    /// Those of the lab's slots, in their order.
    pub(crate) slots: Vec<Arc<Motion>>,
    /// Those that it takes besides, by id.
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

/// Something that a lab shows beside its result.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Beside {
    /// Clips that play beside the result.
    ExtraCharacters,
    /// The graph that a walk goes through.
    Graph,
    /// The distances between the frames of two clips.
    DistanceMap,
}

/// All that a lab's result depends on. Equal inputs give equal results: nothing is computed again.
pub(crate) trait LabInputs: fmt::Debug + PartialEq + Send + Sync + 'static {
    /// Makes the result.
    ///
    /// # Errors
    /// Says why there can be no result, and what to do.
    fn run(&self) -> Result<Outcome, LabError>;

    /// Returns whether the result is shown while more of it is computed: it will be another motion
    /// then, or have numbers.
    fn is_draft(&self) -> bool {
        false
    }
}

/// The inputs of any lab.
#[derive(Clone, Debug)]
pub(crate) struct Inputs(Arc<dyn AnyInputs>);

/// [`LabInputs`] of a lab that is not known here.
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
    /// Takes the inputs of a lab.
    pub(crate) fn new(inputs: impl LabInputs) -> Self {
        Self(Arc::new(inputs))
    }

    /// Makes the result; errors as [`LabInputs::run`].
    pub(crate) fn run(&self) -> Result<Outcome, LabError> {
        self.0.run()
    }

    /// As [`LabInputs::is_draft`].
    pub(crate) fn is_draft(&self) -> bool {
        self.0.is_draft()
    }

    /// Returns the inputs as those of one lab; `None` where they are another's.
    pub(crate) fn of_lab<T: LabInputs>(&self) -> Option<&T> {
        (&*self.0 as &dyn Any).downcast_ref()
    }
}

impl PartialEq for Inputs {
    fn eq(&self, other: &Self) -> bool {
        self.0.equals(&*other.0)
    }
}
