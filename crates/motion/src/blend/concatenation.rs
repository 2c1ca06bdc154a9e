use crate::clip::Clip;
use crate::math::Planar;
use std::ops::Range;

/// Clip A, then clip B: what comes out of every way to go from one to the other.
#[derive(Clone, Debug, PartialEq)]
pub struct Concatenation {
    /// A up to the transition, the transition, B from its end on; B's part lies in A's world.
    pub clip: Clip,
    /// The transition's frames in the result; empty for a cut, whose first frame of B is
    /// `transition.start`. At its end a dissolve is all B; what an inertialization has left there
    /// is below 1 %.
    pub transition: Range<usize>,
    /// The frame of the result from which B has the greater part: half of the window, or where half
    /// of the offset is left.
    pub handover: usize,
    /// Where B was laid on A: `result_world_from_b_world`. The identity when B is not laid on A.
    pub aligned_b: Planar,
    /// Where B lies in every frame of the transition. The same everywhere when roots are blended in
    /// the world; with blended velocities B drifts from lying on A's place to
    /// [`world_from_b`](Self::world_from_b).
    pub b_during: Vec<Planar>,
    /// Where B lies in the end.
    pub world_from_b: Planar,
    /// Where the character stands and faces in every frame of the result, as it was blended
    /// (`world_from_character`).
    pub frames: Vec<Planar>,
}
