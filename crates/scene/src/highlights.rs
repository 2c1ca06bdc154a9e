//! Highlighted elements of the stage.

use glam::DVec2;
use segue_motion::graph;
use segue_motion::matching;

/// The elements that are highlighted on the stage, or shown in place of the result, as long as the
/// pointer is on their counterparts in a panel.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Highlights {
    /// Whether the chosen joint is marked.
    pub joint: bool,
    /// The pair of frames of A and B (at A's rate) that is shown, aligned, in place of the result.
    pub pair: Option<[f64; 2]>,
    /// The transition whose windows are shown, aligned with each other, in place of the result.
    pub jump: Option<[graph::Place; 2]>,
    /// The frame that is shown as a ghost at the position of the driven character.
    pub candidate: Option<matching::Place>,
    /// The state of the path under the pointer.
    pub path: PathMarks,
}

/// The parts of a path that are hovered, dragged or drawn.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PathMarks {
    /// Whether control points are visible.
    pub handles: bool,
    /// The chosen control point.
    pub chosen: Option<usize>,
    /// The control point under the pointer.
    pub hovered: Option<usize>,
    /// The point of the path under the pointer, (x, z) in metres, at which a control point can be
    /// added.
    pub place: Option<DVec2>,
    /// Whether a control point is dragged or a curve is drawn. Cameras do not move meanwhile.
    pub is_held: bool,
    /// The curve that is being drawn, (x, z) in metres.
    pub drawn: Vec<DVec2>,
}
