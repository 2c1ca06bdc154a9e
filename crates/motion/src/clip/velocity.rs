//! Linear and angular velocities of joints.

use super::Clip;
use crate::math::quat;
use glam::Vec3;

/// World velocities of all joints in one frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Velocities {
    /// Linear velocities, metres per second.
    pub linear: Vec<Vec3>,
    /// Angular velocities (axis × rate, world frame), radians per second.
    pub angular: Vec<Vec3>,
}

/// Returns the velocities of all joints in `frame`, by central differences at the clip's own frame
/// rate; one-sided in the first and last frame, 0 in a clip of one frame.
///
/// # Panics
/// When there is no such frame.
#[must_use]
pub fn velocities(clip: &Clip, frame: usize) -> Velocities {
    let (before, after) =
        (frame.saturating_sub(1), (frame + 1).min(clip.frames().saturating_sub(1)));
    let joints = clip.skeleton().len();
    if clip.frames() == 1 && frame == 0 {
        return Velocities { linear: vec![Vec3::ZERO; joints], angular: vec![Vec3::ZERO; joints] };
    }
    let dt_secs = (after - before) as f32 * clip.dt_secs();
    let (from, to) = (clip.world_pose(before), clip.world_pose(after));
    Velocities {
        linear: from
            .positions
            .iter()
            .zip(&to.positions)
            .map(|(&a, &b)| (b - a) / dt_secs)
            .collect(),
        angular: from
            .rotations
            .iter()
            .zip(&to.rotations)
            .map(|(&a, &b)| quat::angular_velocity(a, b, dt_secs))
            .collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clip::fixtures::wander;
    use crate::skeleton::fixtures;
    use glam::Quat;
    use std::sync::Arc;

    /// A body circles around the origin at a constant rate, facing along its path.
    #[test]
    fn velocities_on_a_circle_are_tangential() {
        let skeleton = fixtures::lafan();
        let (rate, fps) = (1.5f32, 120.0);
        let turn = |frame: usize| Quat::from_rotation_y(rate * frame as f32 / fps);
        let rotations = (0..9)
            .flat_map(|f| {
                std::iter::once(turn(f))
                    .chain(std::iter::repeat_n(Quat::IDENTITY, skeleton.len() - 1))
            })
            .collect();
        let roots = (0..9).map(|f| turn(f) * Vec3::X * 2.0).collect();
        let clip =
            Clip::new("circle", Arc::clone(&skeleton), f64::from(fps), rotations, roots).unwrap();
        for frame in 0..clip.frames() {
            let (found, world) = (velocities(&clip, frame), clip.world_pose(frame));
            // Central differences of a circle are exact except for the sine of the step, and
            // one-sided ones lag by half a step.
            let tolerance = if (1..8).contains(&frame) { 1e-3 } else { 0.03 };
            for joint in 0..skeleton.len() {
                let wanted = (Vec3::Y * rate).cross(world.positions[joint]);
                assert!((found.linear[joint] - wanted).length() < tolerance, "{frame} {joint}");
                assert!((found.angular[joint] - Vec3::Y * rate).length() < 1e-3);
            }
        }
    }

    #[test]
    fn velocities_of_one_frame_are_zero() {
        let found = velocities(&wander(&fixtures::lafan(), 1, 3), 0);
        assert!(found.linear.iter().chain(&found.angular).all(|v| *v == Vec3::ZERO));
        assert_eq!(found.linear.len(), fixtures::lafan().len());
    }
}
