//! The state of the labs between frames.

use super::graph::DrawingCache;
use super::path::hand::PathHand;
use crate::ui::kit::Chosen;
use eframe::egui::Vec2;
use segue_motion::graph::Place;

/// The state of each lab.
#[derive(Clone, Debug, Default)]
pub(crate) struct LabStates {
    /// The state of the Graph lab.
    pub(crate) graph: GraphState,
    /// The state of the Match lab.
    pub(crate) match_: MatchState,
    /// The state of the Path lab.
    pub(crate) path: PathHand,
    /// The state of the Register lab.
    pub(crate) register: RegisterState,
}

/// The state of the Graph lab.
#[derive(Clone, Debug, Default)]
pub(crate) struct GraphState {
    /// The transition that the pointer is at, on the map of distances or on an arc.
    pub(crate) hovered_jump: Option<[Place; 2]>,
    /// The transition that the pointer was at in the frame before.
    pub(crate) last_jump: Option<[Place; 2]>,
    /// The playhead of the walk when a single transition was opened, seconds.
    pub(crate) walk_secs: f64,
    /// Whether the map has a panel of its own; otherwise it is among the parameters.
    pub(crate) has_map_panel: bool,
    /// The cache of the drawn parts of the graph.
    pub(crate) drawing: DrawingCache,
}

/// The state of the Match lab: the input of the stick, and the choices.
#[derive(Clone, Debug, Default)]
pub(crate) struct MatchState {
    /// The push of the stick on the screen; `None` while it is released.
    pub(crate) stick: Option<Vec2>,
    /// Whether the stick on the screen makes the character run.
    pub(crate) runs: bool,
    /// The present push of keys, stick and gamepad, for display.
    pub(crate) pushed: Vec2,
    /// The candidate on the stage, by its index.
    pub(crate) chosen: Option<usize>,
    /// The stretch of a clip that is to be tagged.
    pub(crate) stretch: Option<Chosen>,
    /// The custom tag that is being typed for it.
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

/// The state of the Register lab.
#[derive(Clone, Debug, Default)]
pub(crate) struct RegisterState {
    /// The pair of frames of A and B, at A's rate, that the pointer is at on the map of distances.
    pub(crate) hovered_pair: Option<[f64; 2]>,
}
