//! The skinned body: one smooth mesh that follows a skeleton.
//!
//! A [`SkinnedMesh`] lies in its *bind pose*; every vertex says which joints move it and by how
//! much. For a pose of the skeleton, [`SkinnedMesh::joint_transforms`] gives one rigid transform
//! per joint (`world_from_bind`), and the vertices are mixed from those of their joints: either by
//! the weighted mean of the moved points ([`linear_blend`]), which loses volume where a limb
//! twists, or by the weighted mean of the motions themselves ([`dual_quaternion`]), which keeps it.
//! Both are written here plainly, one vertex after the other; the renderer does the same on the
//! GPU.
//!
//! [`SkinnedMesh::around_clip`] makes a mesh for any skeleton, a mannequin where the roles of a
//! human are known; a [`Sculptor`] makes it piece by piece, and the [`Sculpture`] that comes of it
//! takes any girth in a moment. A mesh that came with a file is a [`SkinnedMesh`], too.
//!
//! A motion with weights `w` that sum to 1 takes a point `p` of the bind pose to
//!
//! ```text
//! linear blend       Σ w (R p + t)          half way between two halves of a turn: the axis itself
//! dual quaternions   (Σ w q) / |Σ w q|      a rigid motion again, so nothing shrinks
//! ```
//!
//! ```
//! use segue_motion::skeleton::{Roles, WorldPose};
//! use segue_motion::skin::{SkinnedMesh, dual_quaternion, linear_blend};
//! use segue_motion::synth::{Action, Params, synthesize};
//!
//! let clip = synthesize(&Params::new(Action::Walk)).unwrap().clip;
//! let mesh = SkinnedMesh::around_clip(&clip, &Roles::detect(clip.skeleton()), 1.0);
//! let mut world = WorldPose::default();
//! clip.world_pose_into(30, &mut world);
//! let mut joints = Vec::new();
//! mesh.joint_transforms(&world, &mut joints);
//! let [mut linear, mut dual, mut normals] = [Vec::new(), Vec::new(), Vec::new()];
//! linear_blend(&mesh, &joints, &mut linear, &mut normals);
//! dual_quaternion(&mesh, &joints, &mut dual, &mut normals);
//! // A walk twists little: the two differ by less than three centimetres anywhere.
//! let apart = linear.iter().zip(&dual).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max);
//! assert!(apart > 0.0 && apart < 0.03, "{apart}");
//! ```
//!
//! A body takes about 0.1 s to be made, in pieces of a millisecond, and a millisecond to be posed
//! here, in one thread; on the GPU that is free. Hands have no separate fingers where the skeleton
//! has none, and nothing collides.
//!
//! Sources: Kavan, Collins, Žára, O'Sullivan, "Skinning with Dual Quaternions", 2007; Ju, Losasso,
//! Schaefer, Warren, "Dual Contouring of Hermite Data", 2002.

mod around;
mod bind;
mod capsules;
mod character;
mod contour;
mod deform;
mod field;
pub mod shapes;
mod weights;

pub use around::{Sculptor, Sculpture};
pub use character::{Character, Drive};
pub use deform::{RigidTransform, dual_quaternion, linear_blend};
pub use weights::normals;

use crate::clip::{Clip, reference_pose};
use crate::skeleton::{Roles, Skeleton, WorldPose};
use glam::{Quat, Vec3};

/// A mesh bound to a skeleton, in its bind pose. All lists of vertices are of one length.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SkinnedMesh {
    /// Metres, in the world of the bind pose, Y up.
    pub positions: Vec<Vec3>,
    /// Unit vectors out of the surface.
    pub normals: Vec<Vec3>,
    /// The joints of the skeleton that move each vertex. Unused ones have weight 0 and are joints
    /// nevertheless.
    pub joints: Vec<[u16; 4]>,
    /// How much each of them does: the greatest first, none negative, their sum 1.
    pub weights: Vec<[f32; 4]>,
    /// Three vertices each, counter-clockwise from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Base colour of each vertex, red, green, blue and alpha in 0–1 as written in a palette
    /// (sRGB-encoded, alpha straight). Empty where the mesh has no colours of its own.
    pub colors: Vec<[f32; 4]>,
    /// `joint_from_bind` of every joint of the skeleton: where the bind pose lies in the joint's
    /// frame.
    pub bind: Vec<RigidTransform>,
}

impl SkinnedMesh {
    /// Makes a body for a skeleton at once, of which nothing is known but its rest pose: see
    /// [`Sculptor::new`] and, for the girth, [`Sculpture::with_girth`]. The same input gives the
    /// same mesh.
    #[must_use]
    pub fn around(skeleton: &Skeleton, roles: &Roles, girth: f32) -> Self {
        Self::sculpted(Sculptor::new(skeleton, roles, &skeleton.rest_pose()), girth)
    }

    /// Makes a body for the skeleton of a clip at once. Where its rest pose means nothing, the clip
    /// shows how it stands ([`reference_pose`]).
    #[must_use]
    pub fn around_clip(clip: &Clip, roles: &Roles, girth: f32) -> Self {
        Self::sculpted(Sculptor::new(clip.skeleton(), roles, &reference_pose(clip, roles)), girth)
    }

    fn sculpted(mut sculptor: Sculptor, girth: f32) -> Self {
        loop {
            if let Some(sculpture) = sculptor.advance() {
                return sculpture.with_girth(girth);
            }
        }
    }

    /// `world_from_bind` of every joint for a pose of the skeleton: what moves a vertex of the bind
    /// pose that follows this joint alone. Joints that the pose does not have stay where the bind
    /// pose is.
    pub fn world_from_bind(&self, world: &WorldPose) -> impl Iterator<Item = RigidTransform> {
        self.bind.iter().enumerate().map(|(joint, joint_from_bind)| {
            match (world.positions.get(joint), world.rotations.get(joint)) {
                (Some(&translation), Some(&rotation)) => {
                    RigidTransform { rotation, translation } * *joint_from_bind
                }
                _ => RigidTransform::IDENTITY,
            }
        })
    }

    /// The same in a list that is overwritten.
    pub fn joint_transforms(&self, world: &WorldPose, out: &mut Vec<RigidTransform>) {
        out.clear();
        out.extend(self.world_from_bind(world));
    }

    /// Scales the mesh and its bind pose about the origin.
    pub fn scale(&mut self, factor: f32) {
        for position in &mut self.positions {
            *position *= factor;
        }
        for transform in &mut self.bind {
            transform.translation *= factor;
        }
    }

    /// Moves the mesh to another list of joints: joint `i` becomes `joint_of[i]`, or the root where
    /// that list is too short; `bind` holds `joint_from_bind` of the new joints.
    pub fn rebind(&mut self, joint_of: &[usize], bind: Vec<RigidTransform>) {
        for joint in self.joints.as_flattened_mut() {
            *joint = joint_of.get(usize::from(*joint)).map_or(0, |&joint| joint as u16);
        }
        self.bind = bind;
    }

    /// Turns the mesh and its joints' axes about the origin. At rest the joints have no rotation,
    /// as before.
    pub fn turn(&mut self, turn: Quat) {
        for position in &mut self.positions {
            *position = turn * *position;
        }
        for normal in &mut self.normals {
            *normal = turn * *normal;
        }
        for transform in &mut self.bind {
            *transform = RigidTransform {
                rotation: turn * transform.rotation * turn.conjugate(),
                translation: turn * transform.translation,
            };
        }
    }
}

#[cfg(test)]
mod tests;
