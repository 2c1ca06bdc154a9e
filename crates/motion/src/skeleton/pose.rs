//! Poses relative to a skeleton.

use glam::{Quat, Vec3};

/// One frame of a clip: the transform of every joint relative to its parent.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Pose {
    /// Translation of the root joint in the world, metres. Replaces its rest offset.
    pub root_translation: Vec3,
    /// Local rotation of every joint (`parent_from_joint`), unit quaternions.
    pub rotations: Vec<Quat>,
    /// Local translations of the joints that move relative to their parent, metres; they replace
    /// the rest offset. Sorted by joint.
    pub translations: Vec<(usize, Vec3)>,
}
