//! The result of a transition, whatever its method.

use crate::clip::Clip;
use crate::math::Planar;
use std::ops::Range;
use std::sync::Arc;

/// Clip A, then clip B: the result of a transition by any method.
#[derive(Clone, Debug, PartialEq)]
pub struct Concatenation {
    /// A up to the transition, the transition, then B; B's part lies in A's world.
    pub clip: Arc<Clip>,
    /// The transition's frames in the result; empty for a cut, whose first frame of B is
    /// `transition.start`. At its end a dissolve is all B; less than 1 % of an inertialization's
    /// offset is left.
    pub transition: Range<usize>,
    /// The frame of B that corresponds to the transition's start.
    pub enter: usize,
    /// The first frame of the result in which B has the greater part: the middle of the window, or
    /// the frame at which half of the offset is left.
    pub handover: usize,
    /// The initial alignment of B with A: `result_world_from_b_world`. The identity without
    /// alignment.
    pub aligned_b: Planar,
    /// The transform of B in every frame of the transition. Constant when roots are blended in the
    /// world; with blended velocities it drifts from [`aligned_b`](Self::aligned_b) to
    /// [`world_from_b`](Self::world_from_b).
    pub b_during: Vec<Planar>,
    /// The transform of B after the transition.
    pub world_from_b: Planar,
    /// The ground frames of the character in the result, as blended (`world_from_character`).
    pub frames: Vec<Planar>,
}
