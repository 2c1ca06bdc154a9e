//! The two methods of skinning, one vertex after the other.

use super::SkinnedMesh;
use crate::math::quat;
use glam::{Mat3, Quat, Vec3};
use std::ops::Mul;

/// A rotation, then a translation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigidTransform {
    /// Unit quaternion.
    pub rotation: Quat,
    /// Metres.
    pub translation: Vec3,
}

impl Default for RigidTransform {
    fn default() -> Self {
        Self::IDENTITY
    }
}

impl RigidTransform {
    /// The identity.
    pub const IDENTITY: Self = Self { rotation: Quat::IDENTITY, translation: Vec3::ZERO };

    /// Transforms a point.
    #[must_use]
    pub fn point(self, point: Vec3) -> Vec3 {
        self.rotation * point + self.translation
    }

    /// Returns the inverse transform.
    #[must_use]
    pub fn inverse(self) -> Self {
        let rotation = self.rotation.conjugate();
        Self { rotation, translation: -(rotation * self.translation) }
    }
}

/// Applies the transform on the right first.
impl Mul for RigidTransform {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        Self {
            rotation: self.rotation * other.rotation,
            translation: self.point(other.translation),
        }
    }
}

/// Returns the transforms that move a vertex, each with its weight above 0. Joints without a
/// transform are left out.
fn influences<'a>(
    mesh: &'a SkinnedMesh,
    world_from_bind: &'a [RigidTransform],
    vertex: usize,
) -> impl Iterator<Item = (RigidTransform, f32)> + 'a {
    let (joints, weights) = (mesh.joints.get(vertex), mesh.weights.get(vertex));
    let pairs = joints.into_iter().flatten().zip(weights.into_iter().flatten());
    pairs.filter(|(_, weight)| **weight > 0.0).map(|(&joint, &weight)| {
        let transform = world_from_bind.get(usize::from(joint)).copied().unwrap_or_default();
        (transform, weight)
    })
}

/// Applies linear blend skinning: each vertex is the weighted mean of its positions moved by each
/// joint.
///
/// `world_from_bind` are those of [`SkinnedMesh::joint_transforms`]; `positions` (metres) and
/// `normals` (unit) are overwritten, one of each per vertex. Rotations need not have unit length.
/// The mean of two rotations half a turn apart is not a rotation but flattens: a limb that is
/// twisted by 180° collapses to its axis.
pub fn linear_blend(
    mesh: &SkinnedMesh,
    world_from_bind: &[RigidTransform],
    positions: &mut Vec<Vec3>,
    normals: &mut Vec<Vec3>,
) {
    deform(mesh, positions, normals, |vertex, position, normal| {
        let (mut point, mut axes, mut total) = (Vec3::ZERO, Mat3::ZERO, 0.0);
        for (transform, weight) in influences(mesh, world_from_bind, vertex) {
            let rotation = quat::renormalize(transform.rotation);
            point += (rotation * position + transform.translation) * weight;
            axes += Mat3::from_quat(rotation) * weight;
            total += weight;
        }
        if total > 0.0 {
            (point / total, (axes * normal).normalize_or(normal))
        } else {
            (position, normal)
        }
    });
}

/// Applies dual quaternion skinning (Kavan, Collins, Žára, O'Sullivan, "Skinning with Dual
/// Quaternions", I3D 2007, algorithm 1): the mean of the motions, as unit dual quaternions, is a
/// rigid motion again.
///
/// The arguments are those of [`linear_blend`]. `q` and `-q` are one rotation: all are first
/// brought into the hemisphere of the joint with the greatest weight (ibid., section 4.1). Where
/// the sum has no length, that joint alone moves the vertex.
pub fn dual_quaternion(
    mesh: &SkinnedMesh,
    world_from_bind: &[RigidTransform],
    positions: &mut Vec<Vec3>,
    normals: &mut Vec<Vec3>,
) {
    deform(mesh, positions, normals, |vertex, position, normal| {
        let mut pivot: Option<RigidTransform> = None;
        let (mut real, mut dual) =
            (Quat::from_xyzw(0.0, 0.0, 0.0, 0.0), Quat::from_xyzw(0.0, 0.0, 0.0, 0.0));
        for (transform, weight) in influences(mesh, world_from_bind, vertex) {
            let rotation = quat::renormalize(transform.rotation);
            let first = *pivot.get_or_insert(RigidTransform { rotation, ..transform });
            let rotation = quat::in_hemisphere_of(rotation, first.rotation);
            real += rotation * weight;
            dual += dual_part(rotation, transform.translation) * weight;
        }
        let Some(pivot) = pivot else {
            return (position, normal);
        };
        let length = real.length();
        if length < 1e-6 {
            return (pivot.point(position), pivot.rotation * normal);
        }
        let (real, dual) = (real * length.recip(), dual * length.recip());
        (real * position + translation(real, dual), real * normal)
    });
}

/// Returns the dual part of a rotation followed by a translation: `½ t q`.
fn dual_part(rotation: Quat, translation: Vec3) -> Quat {
    Quat::from_xyzw(translation.x, translation.y, translation.z, 0.0) * rotation * 0.5
}

/// Returns the translation of a dual quaternion whose real part has unit length: the vector part of
/// `2 dual real*`. The part of `dual` that is not orthogonal to the real part results in a scalar,
/// and is ignored.
fn translation(real: Quat, dual: Quat) -> Vec3 {
    (dual * real.conjugate() * 2.0).xyz()
}

fn deform(
    mesh: &SkinnedMesh,
    positions: &mut Vec<Vec3>,
    normals: &mut Vec<Vec3>,
    moved: impl Fn(usize, Vec3, Vec3) -> (Vec3, Vec3),
) {
    positions.clear();
    normals.clear();
    for (vertex, &position) in mesh.positions.iter().enumerate() {
        let normal = mesh.normals.get(vertex).copied().unwrap_or(Vec3::Y);
        let (position, normal) = moved(vertex, position, normal);
        positions.push(position);
        normals.push(normal);
    }
}
