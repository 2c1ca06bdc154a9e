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

/// Returns the values of all frames, in the units of [`CurveKind`]; empty if the clip has no such
/// joint. See [`joint_values`].
#[must_use]
pub fn joint_curve(clip: &Clip, joint: usize, kind: CurveKind) -> Vec<f32> {
    joint_values(clip, joint, kind, 0..clip.frames())
}

/// Returns the values of the given frames in their order, in the units of [`CurveKind`]; frames
/// outside the clip are left out. Rates are central differences at the clip's own frame rate,
/// one-sided at the ends.
///
/// Empty if the clip has no such joint. Rates are 0 in a clip of one frame.
#[must_use]
pub fn joint_values(
    clip: &Clip,
    joint: usize,
    kind: CurveKind,
    frames: impl IntoIterator<Item = usize>,
) -> Vec<f32> {
    if joint >= clip.skeleton().len() || clip.frames() == 0 {
        return Vec::new();
    }
    let mut track = JointTrack::new(clip, joint);
    let last = clip.frames() - 1;
    let origin = track.at(0).0;
    let value = |frame: usize| {
        let (before, after) = (frame.saturating_sub(1), (frame + 1).min(last));
        let secs = (after - before).max(1) as f32 * clip.dt_secs();
        match kind {
            CurveKind::Height => track.at(frame).0.y,
            CurveKind::Distance => (track.at(frame).0 - origin).with_y(0.0).length(),
            CurveKind::Speed => {
                let from = track.at(before).0;
                (track.at(after).0 - from).length() / secs
            }
            CurveKind::Angle => {
                quat::angle_between(Quat::IDENTITY, clip.rotations(frame)[joint]).to_degrees()
            }
            CurveKind::AngularSpeed => {
                let from = track.at(before).1;
                quat::angle_between(from, track.at(after).1).to_degrees() / secs
            }
        }
    };
    frames.into_iter().filter(|&frame| frame <= last).map(value).collect()
}

/// The world position and rotation of one joint. Computes kinematics of its own chain alone,
/// because plots are updated while a slider moves.
struct JointTrack<'a> {
    clip: &'a Clip,
    joint: usize,
    chain: Vec<usize>,
    world: WorldPose,
    /// The last poses by frame modulo 4: the rates of consecutive frames share neighbours.
    cached: [Option<(usize, Vec3, Quat)>; 4],
}

impl<'a> JointTrack<'a> {
    fn new(clip: &'a Clip, joint: usize) -> Self {
        let chain = clip.skeleton().with_ancestors([joint]);
        Self { clip, joint, chain, world: WorldPose::default(), cached: [None; 4] }
    }

    /// Returns the world position and rotation in a frame of the clip.
    fn at(&mut self, frame: usize) -> (Vec3, Quat) {
        let place = &mut self.cached[frame % 4];
        if let Some((known, position, rotation)) = *place
            && known == frame
        {
            return (position, rotation);
        }
        self.clip.world_pose_of(frame, &self.chain, &mut self.world);
        let (position, rotation) =
            (self.world.positions[self.joint], self.world.rotations[self.joint]);
        *place = Some((frame, position, rotation));
        (position, rotation)
    }
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
            let mut track = JointTrack::new(&clip, joint);
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
                    track.at(frame),
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

    #[test]
    fn joint_values_of_some_frames_are_those_of_the_curve() {
        let clip = synthesize(&Params::new(Action::Run)).unwrap().clip;
        let last = clip.frames() - 1;
        for kind in [
            CurveKind::Speed,
            CurveKind::Height,
            CurveKind::Distance,
            CurveKind::Angle,
            CurveKind::AngularSpeed,
        ] {
            let all = joint_curve(&clip, 3, kind);
            assert_eq!(all.len(), clip.frames());
            let some = joint_values(&clip, 3, kind, [7, 3, last, last + 1]);
            assert_eq!(some, [all[7], all[3], all[last]], "{kind:?}");
        }
    }
}
