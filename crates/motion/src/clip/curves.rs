//! Curves of one joint over time, for plots.

use super::Clip;
use crate::math::quat;
use crate::skeleton::WorldPose;
use glam::{Quat, Vec3};

/// The quantity that is plotted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CurveKind {
    /// Speed of its position in the world, metres per second.
    Speed,
    /// Height above `y = 0`, metres.
    Height,
    /// Distance over the ground from its position in the first frame, metres.
    Distance,
    /// Angle of its local rotation from the rest pose, degrees: 0 to 180.
    Angle,
    /// Speed of its rotation in the world, degrees per second.
    AngularSpeed,
}

/// Returns one value per frame. Rates are central differences at the clip's own frame rate,
/// one-sided at the ends.
///
/// The curve is empty when the clip has no such joint; rates are 0 in a clip of one frame.
#[must_use]
pub fn joint_curve(clip: &Clip, joint: usize, kind: CurveKind) -> Vec<f32> {
    if joint >= clip.skeleton().len() {
        return Vec::new();
    }
    let track = joint_track(clip, joint);
    let last = track.len().saturating_sub(1);
    (0..track.len())
        .map(|frame| {
            let (before, after) = (frame.saturating_sub(1), (frame + 1).min(last));
            let secs = (after - before).max(1) as f32 * clip.dt_secs();
            match kind {
                CurveKind::Height => track[frame].0.y,
                CurveKind::Distance => (track[frame].0 - track[0].0).with_y(0.0).length(),
                CurveKind::Speed => (track[after].0 - track[before].0).length() / secs,
                CurveKind::Angle => {
                    quat::angle_between(Quat::IDENTITY, clip.rotations(frame)[joint]).to_degrees()
                }
                CurveKind::AngularSpeed => {
                    quat::angle_between(track[before].1, track[after].1).to_degrees() / secs
                }
            }
        })
        .collect()
}

/// Returns the world position and rotation of one joint in every frame. Computes kinematics of its
/// own chain alone, because plots are updated while a slider moves.
fn joint_track(clip: &Clip, joint: usize) -> Vec<(Vec3, Quat)> {
    let chain = clip.skeleton().with_ancestors([joint]);
    let mut world = WorldPose::default();
    (0..clip.frames())
        .map(|frame| {
            clip.world_pose_of(frame, &chain, &mut world);
            (world.positions[joint], world.rotations[joint])
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clip::JointTranslations;
    use crate::synth::{Action, Params, synthesize};

    #[test]
    fn joint_track_agrees_with_full_kinematics() {
        let clip = synthesize(&Params::new(Action::Run)).unwrap().clip;
        let values =
            (0..clip.frames()).map(|frame| Vec3::new(0.1, 0.2, 0.001 * frame as f32)).collect();
        let clip = clip.with_translations(vec![JointTranslations { joint: 2, values }]).unwrap();
        for joint in 0..clip.skeleton().len() {
            let track = joint_track(&clip, joint);
            for frame in (0..clip.frames()).step_by(7) {
                let world = clip.world_pose(frame);
                let mut part = WorldPose::default();
                clip.world_pose_of(
                    frame,
                    &clip.skeleton().with_ancestors([joint, 9999]),
                    &mut part,
                );
                assert_eq!(
                    (part.positions[joint], part.rotations[joint]),
                    (world.positions[joint], world.rotations[joint])
                );
                assert_eq!(
                    track[frame],
                    (world.positions[joint], world.rotations[joint]),
                    "joint {joint}, frame {frame}"
                );
            }
        }
    }

    #[test]
    fn joint_curve_of_missing_joint_is_empty_and_rates_are_per_second() {
        let clip = synthesize(&Params::new(Action::Walk)).unwrap().clip;
        let heights = joint_curve(&clip, 0, CurveKind::Height);
        let speeds = joint_curve(&clip, 0, CurveKind::Speed);
        assert_eq!(heights[3], clip.root_translations()[3].y);
        let roots = clip.root_translations();
        let distances = joint_curve(&clip, 0, CurveKind::Distance);
        let last = roots.len() - 1;
        assert_eq!(distances[0], 0.0);
        assert_eq!(distances[last], (roots[last] - roots[0]).with_y(0.0).length());
        let mean = speeds.iter().sum::<f32>() / speeds.len() as f32;
        assert!((mean - 1.4).abs() < 0.1, "{mean}");
        assert!(joint_curve(&clip, 999, CurveKind::Speed).is_empty());
    }
}
