//! Forward kinematics, and local poses from world poses.

use super::{Pose, Skeleton};
use crate::math::{Planar, quat};
use glam::{Quat, Vec3};

/// The world transforms of all joints.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WorldPose {
    /// World positions, metres.
    pub positions: Vec<Vec3>,
    /// World rotations (`world_from_joint`), unit quaternions.
    pub rotations: Vec<Quat>,
}

impl WorldPose {
    /// Returns the world position of a point in the joint's frame.
    #[must_use]
    pub fn point(&self, joint: usize, point_in_joint: Vec3) -> Vec3 {
        self.positions[joint] + self.rotations[joint] * point_in_joint
    }

    /// Transforms the whole pose over the ground.
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

/// Computes forward kinematics of a pose.
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

/// Computes forward kinematics into a reusable buffer, from borrowed parts of a pose.
///
/// `rotations` holds one local rotation per joint; missing ones are the identity. `translations`
/// replace rest offsets, sorted by joint.
pub fn world_pose_into(
    skeleton: &Skeleton,
    root_translation: Vec3,
    rotations: &[Quat],
    translations: impl IntoIterator<Item = (usize, Vec3)>,
    world: &mut WorldPose,
) {
    place(skeleton, root_translation, rotations, translations, 0..skeleton.len(), world);
}

/// Computes forward kinematics of `joints` alone, as [`world_pose_into`] does for all: in rising
/// order and with all their ancestors, as [`Skeleton::with_ancestors`] returns them. The entries of
/// other joints are undefined. Indices out of range are ignored.
pub(crate) fn world_pose_of(
    skeleton: &Skeleton,
    root_translation: Vec3,
    rotations: &[Quat],
    translations: impl IntoIterator<Item = (usize, Vec3)>,
    joints: &[usize],
    world: &mut WorldPose,
) {
    place(skeleton, root_translation, rotations, translations, joints.iter().copied(), world);
}

/// Computes local rotations from a world pose, and translations for joints that are farther than
/// 0.1 mm from the position that their offset gives: the inverse of [`world_pose`]. Joints that the
/// pose does not have stay at rest.
#[must_use]
pub fn local_pose(skeleton: &Skeleton, world: &WorldPose) -> Pose {
    const TOLERANCE_M: f32 = 1e-4;
    let mut pose = Pose {
        root_translation: world.positions.first().copied().unwrap_or_default(),
        ..Pose::default()
    };
    for (index, joint) in skeleton.joints().iter().enumerate() {
        let (Some(&position), Some(&rotation)) =
            (world.positions.get(index), world.rotations.get(index))
        else {
            break;
        };
        let Some(parent) = joint.parent else {
            pose.rotations.push(rotation);
            continue;
        };
        let parent_from_world = world.rotations[parent].conjugate();
        pose.rotations.push(quat::renormalize(parent_from_world * rotation));
        let translation = parent_from_world * (position - world.positions[parent]);
        if translation.distance(joint.offset) > TOLERANCE_M {
            pose.translations.push((index, translation));
        }
    }
    pose.rotations.resize(skeleton.len(), Quat::IDENTITY);
    pose
}

fn place(
    skeleton: &Skeleton,
    root_translation: Vec3,
    rotations: &[Quat],
    translations: impl IntoIterator<Item = (usize, Vec3)>,
    joints: impl Iterator<Item = usize>,
    world: &mut WorldPose,
) {
    world.positions.resize(skeleton.len(), Vec3::ZERO);
    world.rotations.resize(skeleton.len(), Quat::IDENTITY);
    let mut moved = translations.into_iter().peekable();
    for index in joints {
        let Some(joint) = skeleton.joints().get(index) else {
            continue;
        };
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
        world.positions[index] = position;
        world.rotations[index] = rotation;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::skeleton::fixtures;

    #[test]
    fn local_pose_of_world_pose_is_the_pose() {
        let skeleton = fixtures::cmu_bvh();
        let mut next = fixtures::noise(3);
        let mut random = |scale: f32| Vec3::new(next(), next(), next()) * scale;
        let pose = Pose {
            root_translation: random(2.0),
            rotations: (0..skeleton.len()).map(|_| quat::exp(random(1.5))).collect(),
            translations: vec![(4, random(0.3)), (9, random(0.3))],
        };
        let world = world_pose(&skeleton, &pose);
        let back = local_pose(&skeleton, &world);
        assert_eq!(back.translations.iter().map(|(joint, _)| *joint).collect::<Vec<_>>(), [4, 9]);
        let again = world_pose(&skeleton, &back);
        for joint in 0..skeleton.len() {
            assert!(again.positions[joint].distance(world.positions[joint]) < 1e-5);
            assert!(quat::angle_between(again.rotations[joint], world.rotations[joint]) < 1e-3);
        }
        // Joints beyond the end of a shorter pose stay at rest.
        let short = WorldPose {
            positions: world.positions[..5].to_vec(),
            rotations: world.rotations[..5].to_vec(),
        };
        assert_eq!(local_pose(&skeleton, &short).rotations.len(), skeleton.len());
    }
}
