use super::Clip;
use crate::math::quat;
use glam::Vec3;

/// How fast every joint moves in one frame, in the world.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Velocities {
    /// Linear velocities, metres per second.
    pub linear: Vec<Vec3>,
    /// Angular velocities (axis × rate, world frame), radians per second.
    pub angular: Vec<Vec3>,
}

/// The velocities of all joints in `frame`, by central differences at the clip's own frame rate; one-sided in the first and last frame, 0 in a
/// clip of one frame.
///
/// # Panics
/// When there is no such frame.
#[must_use]
pub fn velocities(clip: &Clip, frame: usize) -> Velocities {
    let (before, after) = (frame.saturating_sub(1), (frame + 1).min(clip.frames() - 1));
    let joints = clip.skeleton().len();
    if before == after {
        return Velocities {
            linear: vec![Vec3::ZERO; joints],
            angular: vec![Vec3::ZERO; joints],
        };
    }
    let dt_secs = (after - before) as f32 * clip.dt_secs();
    let (from, to) = (clip.world_pose(before), clip.world_pose(after));
    Velocities {
        linear: from.positions.iter().zip(&to.positions).map(|(&a, &b)| (b - a) / dt_secs).collect(),
        angular: from
            .rotations
            .iter()
            .zip(&to.rotations)
            .map(|(&a, &b)| quat::angular_velocity(a, b, dt_secs))
            .collect(),
    }
}
