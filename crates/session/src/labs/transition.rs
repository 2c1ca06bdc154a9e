//! The Transition lab: from one clip to another by a method of choice.

use super::blend::{BlendCache, BlendLab};
use super::lab::{HasPart, Inputs, Lab, LabClips};
use super::pair::Pairs;
use super::{LabError, Outcome, Transition};
use crate::params::{Key, Params};
use segue_text::Message;

/// The Transition lab: a transition from A to B by one of several methods. One of them is a
/// dissolve, which has the Blend lab's parameters.
pub(super) struct TransitionLab;

impl<S: HasPart<Pairs> + HasPart<BlendCache>> Lab<S> for TransitionLab {
    fn result_name(&self, params: &Params, a: Message, b: Message) -> Message {
        Lab::<S>::result_name(&BlendLab, params, a, b)
    }

    fn file_stem(&self, params: &Params) -> String {
        Lab::<S>::file_stem(&BlendLab, params)
    }

    fn found(&self, outcome: &Outcome, fps: [f64; 2]) -> Vec<(Key, f64)> {
        let found = |transition: &Transition| {
            vec![
                (Key::MixFrameA, (transition.leave_a_secs * fps[0]).round()),
                (Key::MixFrameB, (transition.enter_b_secs * fps[1]).round()),
            ]
        };
        outcome.transition.as_ref().map(found).unwrap_or_default()
    }

    fn inputs(
        &self,
        labs: &mut S,
        clips: LabClips,
        params: &Params,
        match_window: usize,
    ) -> Result<Option<Inputs>, LabError> {
        BlendLab.inputs(labs, clips, params, match_window)
    }
}
