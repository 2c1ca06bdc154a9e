//! A mesh of simple bones around a skeleton at rest, for programs that show an armature only by its
//! skin.

use glam::{Quat, Vec3};
use segue_motion::skeleton::Skeleton;
use segue_motion::skin::{RigidTransform, SkinnedMesh};

/// Bones shorter than this have no direction, metres.
const MIN_BONE_LENGTH: f32 = 1e-4;
/// The position of the thickest part of a bone, and its radius there, as shares of the bone's
/// length.
const WAIST_SHARE: f32 = 0.2;
const GIRTH_SHARE: f32 = 0.1;
/// The size of the octahedron at a joint from which no bone starts, metres.
const MARKER_SIZE: f32 = 0.015;

/// Triangles of three vertices each; every vertex follows one joint.
#[derive(Default)]
pub(super) struct Bones {
    pub(super) positions: Vec<Vec3>,
    pub(super) normals: Vec<Vec3>,
    pub(super) joints: Vec<usize>,
}

impl Bones {
    /// Builds an octahedron from each joint to each of its children and to its end site, and a
    /// small one at joints with neither.
    pub(super) fn around(skeleton: &Skeleton, positions: &[Vec3]) -> Self {
        let mut bones = Self::default();
        let mut has_bone = vec![false; skeleton.len()];
        for (index, joint) in skeleton.joints().iter().enumerate() {
            if let Some(parent) = joint.parent {
                has_bone[parent] |= bones.bone(parent, positions[parent], positions[index]);
            }
            if let Some(end) = joint.end_site {
                has_bone[index] |= bones.bone(index, positions[index], positions[index] + end);
            }
        }
        for (joint, _) in has_bone.iter().enumerate().filter(|(_, has_bone)| !**has_bone) {
            let up = Vec3::Y * MARKER_SIZE;
            bones.octahedron(
                joint,
                positions[joint] - up,
                positions[joint] + up,
                0.5,
                [Vec3::Z * MARKER_SIZE, Vec3::X * MARKER_SIZE],
            );
        }
        bones
    }

    /// Converts the bones to a mesh that is bound with the joints at `positions`. The skeleton has
    /// at most 65,536 joints.
    pub(super) fn into_mesh(self, positions: &[Vec3]) -> SkinnedMesh {
        let bind =
            |&position: &Vec3| RigidTransform { rotation: Quat::IDENTITY, translation: -position };
        SkinnedMesh {
            joints: self.joints.iter().map(|&joint| [joint as u16, 0, 0, 0]).collect(),
            weights: vec![[1.0, 0.0, 0.0, 0.0]; self.joints.len()],
            triangles: (0..self.joints.len() as u32 / 3)
                .map(|triangle| [3 * triangle, 3 * triangle + 1, 3 * triangle + 2])
                .collect(),
            bind: positions.iter().map(bind).collect(),
            positions: self.positions,
            normals: self.normals,
            ..SkinnedMesh::default()
        }
    }

    fn bone(&mut self, joint: usize, start: Vec3, end: Vec3) -> bool {
        let along = end - start;
        let length = along.length();
        let Some(direction) = along.try_normalize().filter(|_| length > MIN_BONE_LENGTH) else {
            return false;
        };
        let (side, other) = direction.any_orthonormal_pair();
        self.octahedron(
            joint,
            start,
            end,
            WAIST_SHARE,
            [side * (GIRTH_SHARE * length), other * (GIRTH_SHARE * length)],
        );
        true
    }

    /// Adds an octahedron; `side`, `other` and the direction from `start` to `end` are
    /// right-handed.
    fn octahedron(
        &mut self,
        joint: usize,
        start: Vec3,
        end: Vec3,
        waist: f32,
        [side, other]: [Vec3; 2],
    ) {
        let middle = start.lerp(end, waist);
        let ring = [middle + side, middle + other, middle - side, middle - other];
        for quarter in 0..4 {
            let (a, b) = (ring[quarter], ring[(quarter + 1) % 4]);
            self.triangle(joint, [a, b, end]);
            self.triangle(joint, [b, a, start]);
        }
    }

    /// Adds a triangle whose corners run anticlockwise as seen from outside.
    fn triangle(&mut self, joint: usize, [a, b, c]: [Vec3; 3]) {
        let normal = (b - a).cross(c - a).normalize_or(Vec3::Y);
        self.positions.extend([a, b, c]);
        self.normals.extend([normal; 3]);
        self.joints.extend([joint; 3]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use segue_motion::skeleton::fixtures;

    #[test]
    fn bones_of_every_joint_are_closed_and_face_outwards() {
        let skeleton = fixtures::cmu_bvh();
        let positions = skeleton.rest_positions();
        let bones = Bones::around(&skeleton, &positions);
        assert!((0..skeleton.len()).all(|joint| bones.joints.contains(&joint)));
        assert_eq!(bones.positions.len() % 24, 0);
        for (corners, normals) in bones.positions.chunks(24).zip(bones.normals.chunks(24)) {
            let middle = corners.iter().sum::<Vec3>() / 24.0;
            let outwards = corners
                .iter()
                .zip(normals)
                .all(|(corner, normal)| (corner - middle).dot(*normal) > 0.0);
            assert!(outwards && normals.iter().all(|normal| normal.is_normalized()));
        }
    }
}
