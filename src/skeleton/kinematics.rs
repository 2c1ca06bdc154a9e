use super::{Pose, Skeleton};
use crate::math::Planar;
use glam::{Quat, Vec3};

/// Every joint in the world.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WorldPose {
    /// World positions, metres.
    pub positions: Vec<Vec3>,
    /// World rotations (`world_from_joint`), unit quaternions.
    pub rotations: Vec<Quat>,
}

impl WorldPose {
    /// The world position of a point in the joint's frame.
    #[must_use]
    pub fn point(&self, joint: usize, point_in_joint: Vec3) -> Vec3 {
        self.positions[joint] + self.rotations[joint] * point_in_joint
    }

    /// Moves the whole pose over the ground.
    pub fn apply(&mut self, world_from_here: &Planar) {
        let turn = world_from_here.rotation();
        for position in &mut self.positions {
            *position = world_from_here.apply(*position);
        }
        for rotation in &mut self.rotations {
            *rotation = turn * *rotation;
        }
    }
}

/// Forward kinematics of one pose.
#[must_use]
pub fn world_pose(skeleton: &Skeleton, pose: &Pose) -> WorldPose {
    let mut world = WorldPose::default();
    world_pose_into(
        skeleton,
        pose.root_translation,
        &pose.rotations,
        pose.translations.iter().copied(),
        &mut world,
    );
    world
}

/// Forward kinematics into a buffer that is used again, from borrowed parts of a pose.
///
/// `rotations` holds one local rotation per joint; joints beyond its end rest. `translations` replace rest offsets, sorted by joint.
pub fn world_pose_into(
    skeleton: &Skeleton,
    root_translation: Vec3,
    rotations: &[Quat],
    translations: impl IntoIterator<Item = (usize, Vec3)>,
    world: &mut WorldPose,
) {
    world.positions.clear();
    world.rotations.clear();
    let mut moved = translations.into_iter().peekable();
    for (index, joint) in skeleton.joints().iter().enumerate() {
        let local = rotations.get(index).copied().unwrap_or(Quat::IDENTITY);
        let mut translation = joint.offset;
        while let Some((at, value)) = moved.next_if(|&(at, _)| at <= index) {
            if at == index {
                translation = value;
            }
        }
        let (position, rotation) = match joint.parent {
            None => (root_translation, local),
            Some(parent) => {
                let parent_rotation = world.rotations[parent];
                (world.positions[parent] + parent_rotation * translation, parent_rotation * local)
            }
        };
        world.positions.push(position);
        world.rotations.push(rotation);
    }
}
