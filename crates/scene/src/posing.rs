//! Poses of motions in the world.

use glam::Quat;
use segue_motion::clip::Interpolation;
use segue_motion::clip::Motion;
use segue_motion::math::Planar;
use segue_motion::skeleton::{Role, Roles, Side, Skeleton, WorldPose, world_pose};

/// Returns the pose of a motion at a time, in the world; the motion is placed by `world_from_clip`.
#[must_use]
pub fn pose_at(motion: &Motion, secs: f64, world_from_clip: &Planar) -> Option<WorldPose> {
    let pose = motion.clip().sample(secs, Interpolation::Linear)?;
    let mut world = world_pose(motion.clip().skeleton(), &pose);
    if *world_from_clip != Planar::IDENTITY {
        world.apply(world_from_clip);
    }
    Some(world)
}

/// Returns the pose of a rig with both hands twisted about their forearms, degrees; `None` for 0.
pub(crate) fn twisted(
    (skeleton, roles): (&Skeleton, &Roles),
    world: &WorldPose,
    degrees: f64,
) -> Option<WorldPose> {
    let mut world = (degrees != 0.0).then(|| world.clone())?;
    for side in Side::BOTH {
        let (Some(elbow), Some(hand)) =
            (roles.get(Role::forearm(side)), roles.get(Role::hand(side)))
        else {
            continue;
        };
        let (Some(&from), Some(&wrist)) = (world.positions.get(elbow), world.positions.get(hand))
        else {
            continue;
        };
        let Some(axis) = (wrist - from).try_normalize() else {
            continue;
        };
        let turn = Quat::from_axis_angle(axis, degrees.to_radians() as f32);
        // The hand and its descendants; parents come first.
        let mut moved = vec![false; skeleton.len()];
        for joint in hand..skeleton.len() {
            moved[joint] =
                joint == hand || skeleton.parent(joint).is_some_and(|parent| moved[parent]);
            if moved[joint]
                && let (Some(position), Some(rotation)) =
                    (world.positions.get_mut(joint), world.rotations.get_mut(joint))
            {
                *position = wrist + turn * (*position - wrist);
                *rotation = turn * *rotation;
            }
        }
    }
    Some(world)
}
