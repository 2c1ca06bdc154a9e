//! What the pointer highlights.

use glam::DVec2;
use segue_motion::graph;
use segue_motion::matching;

/// What the pointer highlights on the stage, or shows there in place of the result.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Highlights {
    /// Whether the chosen joint is marked.
    pub joint: bool,
    /// The pair of frames of A and B (at A's rate) that is shown, aligned, in place of the result.
    pub pair: Option<[f64; 2]>,
    /// The transition whose windows are shown, laid on each other, in place of the result.
    pub jump: Option<[graph::Place; 2]>,
    /// The frame that is shown as a ghost where the driven character stands.
    pub candidate: Option<matching::Place>,
    /// What is done with a path.
    pub path: PathMarks,
}

/// What is pointed at, held and drawn of a path.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PathMarks {
    /// Whether control points are to be seen.
    pub handles: bool,
    /// The chosen control point.
    pub chosen: Option<usize>,
    /// The control point under the pointer.
    pub hovered: Option<usize>,
    /// The place on the path that the pointer is at, (x, z) in metres: a point can be added there.
    pub place: Option<DVec2>,
    /// A point is held, or a curve is drawn: cameras stand still.
    pub is_held: bool,
    /// The curve that is being drawn by hand, (x, z) in metres.
    pub drawn: Vec<DVec2>,
}
