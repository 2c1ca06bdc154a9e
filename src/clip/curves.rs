//! One number per frame of one joint, to be plotted.

use super::Clip;
use crate::math::quat;
use crate::skeleton::WorldPose;

/// What of a joint is plotted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CurveKind {
    /// Speed of its position in the world, metres per second.
    Speed,
    /// Height above `y = 0`, metres.
    Height,
    /// Speed of its rotation in the world, degrees per second.
    AngularSpeed,
}

/// One value per frame. Rates are central differences at the clip's own frame rate, one-sided at the ends.
///
/// Empty when the clip has no such joint; rates are 0 in a clip of one frame.
#[must_use]
pub fn joint_curve(clip: &Clip, joint: usize, kind: CurveKind) -> Vec<f32> {
    if joint >= clip.skeleton().len() {
        return Vec::new();
    }
    let mut world = WorldPose::default();
    let track: Vec<_> = (0..clip.frames())
        .map(|frame| {
            clip.world_pose_into(frame, &mut world);
            (world.positions[joint], world.rotations[joint])
        })
        .collect();
    let last = track.len().saturating_sub(1);
    (0..track.len())
        .map(|frame| {
            let (before, after) = (frame.saturating_sub(1), (frame + 1).min(last));
            let secs = (after - before).max(1) as f32 * clip.dt_secs();
            match kind {
                CurveKind::Height => track[frame].0.y,
                CurveKind::Speed => (track[after].0 - track[before].0).length() / secs,
                CurveKind::AngularSpeed => quat::angle_between(track[before].1, track[after].1).to_degrees() / secs,
            }
        })
        .collect()
}
