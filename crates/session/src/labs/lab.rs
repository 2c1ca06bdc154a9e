//! What the document knows of a lab without running it: what its result depends on, and what that
//! is called.

use super::{
    Outcome, Slot, blend, graph, layers, loop_, make, match_, path, register, speed, view,
};
use crate::LabId;
use crate::params::{Group, Key, Params, Value};

/// The facts of a lab. Each lab's own file holds them; [`of`] lists all labs.
pub(crate) trait Lab: Sync {
    /// The labs whose parameters the result depends on.
    fn parameters_of(&self) -> &'static [LabId];

    /// Parameters of other labs that the result depends on.
    fn shared_keys(&self) -> &'static [Key] {
        &[]
    }

    /// Whether the result depends on how the feet of its clips are read and held.
    fn has_feet(&self) -> bool {
        true
    }

    /// The slots whose clips the result is made from.
    fn slots(&self) -> &'static [Slot] {
        &[Slot::A, Slot::B]
    }

    /// The ids of the clips that the lab's own list names; none where it has no list, and where
    /// that cannot be read.
    fn listed(&self, _params: &Params) -> Vec<String> {
        Vec::new()
    }

    /// The ids of the clips that the result is made from besides those in its slots.
    ///
    /// # Errors
    /// Says what of the list cannot be read.
    fn more_clips(&self, _params: &Params) -> Result<Vec<String>, String> {
        Ok(Vec::new())
    }

    /// What is to be set so that the lab works with these clips; `None` where it takes no list of
    /// clips.
    fn with_clips(&self, _ids: &[String]) -> Option<Vec<(Key, Value)>> {
        None
    }

    /// What the result is called; `a` and `b` are what the clips in its slots are called.
    fn result_name(&self, params: &Params, a: &str, b: &str) -> String;

    /// What a file of the result is called, without its ending.
    fn file_stem(&self, params: &Params) -> String;

    /// The values that were found for parameters left to Segue; `fps` are the frame rates of the
    /// clips in A and B.
    fn found(&self, _outcome: &Outcome, _fps: [f64; 2]) -> Vec<(Key, f64)> {
        Vec::new()
    }

    /// A link to the lab's bundled captured clips; `None` where it takes a list of clips or has
    /// none.
    fn captured_link(&self) -> Option<&'static str> {
        None
    }

    /// Whether the result depends on a parameter.
    fn depends_on(&self, key: Key) -> bool {
        matches!(key.param().group, Group::Lab(lab) if self.parameters_of().contains(&lab))
            || self.shared_keys().contains(&key)
            || (self.has_feet() && is_of_feet(key))
    }
}

/// Returns the facts of a lab.
pub(crate) fn of(lab: LabId) -> &'static dyn Lab {
    match lab {
        LabId::View => &view::ViewLab,
        LabId::Make => &make::MakeLab,
        LabId::Blend => &blend::BlendLab,
        LabId::Transition => &blend::TransitionLab,
        LabId::Speed => &speed::SpeedLab,
        LabId::Loop => &loop_::LoopLab,
        LabId::Layers => &layers::LayersLab,
        LabId::Register => &register::RegisterLab,
        LabId::Path => &path::PathLab,
        LabId::Graph => &graph::GraphLab,
        LabId::Match => &match_::MatchLab,
    }
}

/// Returns whether a parameter says how feet are read and held: every lab with clips has these.
fn is_of_feet(key: Key) -> bool {
    matches!(key, Key::FootLock | Key::Ground | Key::ContactHeight | Key::ContactSpeed)
        || is_of_lock(key)
}

/// Returns whether a parameter says how planted feet are held.
pub(super) fn is_of_lock(key: Key) -> bool {
    matches!(key, Key::LockBlend | Key::LockReach | Key::LockClearance)
}
