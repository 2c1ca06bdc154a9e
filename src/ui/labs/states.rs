//! What the labs remember between frames.

use super::path::hand::PathHand;
use crate::ui::kit::Chosen;
use eframe::egui::Vec2;
use segue_motion::graph::Place;

/// What each lab remembers.
#[derive(Clone, Debug, Default)]
pub(crate) struct LabStates {
    /// Of the Graph lab.
    pub(crate) graph: GraphState,
    /// Of the Match lab.
    pub(crate) match_: MatchState,
    /// Of the Path lab.
    pub(crate) path: PathHand,
    /// Of the Register lab.
    pub(crate) register: RegisterState,
}

/// What the Graph lab remembers.
#[derive(Clone, Debug, Default)]
pub(crate) struct GraphState {
    /// The transition that the pointer is at, on the map of distances or on an arc.
    pub(crate) hovered_jump: Option<[Place; 2]>,
    /// The transition that the pointer was at in the frame before.
    pub(crate) last_jump: Option<[Place; 2]>,
    /// Where the walk was when a single transition was opened, seconds.
    pub(crate) walk_secs: f64,
    /// The map has a panel of its own; elsewhere it stands among the parameters.
    pub(crate) has_map_panel: bool,
}

/// What the Match lab remembers: how the character is driven, and what is chosen.
#[derive(Clone, Debug, Default)]
pub(crate) struct MatchState {
    /// What the stick on the screen asks for; `None` while it is let go.
    pub(crate) stick: Option<Vec2>,
    /// The stick on the screen runs.
    pub(crate) runs: bool,
    /// Where keys, stick and gamepad push now, for the eye.
    pub(crate) pushed: Vec2,
    /// The candidate that is shown on the stage, by its place in the list.
    pub(crate) chosen: Option<usize>,
    /// The stretch of a clip that is to be tagged.
    pub(crate) stretch: Option<Chosen>,
    /// The word of one's own that is being typed for it.
    pub(crate) word: String,
    /// The candidate under the pointer.
    pub(crate) hovered: Option<usize>,
}

impl MatchState {
    /// Returns whether a thumb is on the stick: two fingers do not move the camera then.
    pub(crate) fn is_held(&self) -> bool {
        self.stick.is_some()
    }
}

/// What the Register lab remembers.
#[derive(Clone, Debug, Default)]
pub(crate) struct RegisterState {
    /// The pair of frames of A and B, at A's rate, that the pointer is at on the map of distances.
    pub(crate) hovered_pair: Option<[f64; 2]>,
}
