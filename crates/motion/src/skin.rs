//! Skinning: one smooth mesh that follows a skeleton.
//!
//! A [`SkinnedMesh`] lies in its *bind pose*; every vertex has the joints that move it and their
//! weights. For a pose of the skeleton, [`SkinnedMesh::joint_transforms`] gives one rigid transform
//! per joint (`world_from_bind`). Vertices are blended from those of their joints: either by the
//! weighted mean of the moved points ([`linear_blend`]), which loses volume where a limb twists, or
//! by the weighted mean of the motions themselves ([`dual_quaternion`]), which keeps it. Both are
//! written here plainly, one vertex after the other; the renderer does the same on the GPU.
//!
//! [`SkinnedMesh::around_clip`] makes a mesh for any skeleton: a mannequin where the joints of a
//! person on two legs are known, otherwise limbs along the bones, with the trunk, the head and the
//! paws of an animal. A [`SkinBuilder`] makes it in slices, and the resulting [`ProceduralSkin`]
//! takes any girth at once. A mesh that was read from a file is a [`SkinnedMesh`], too.
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
//! Making a body takes about 0.1 s, in slices of a millisecond. Posing it with the functions of
//! this module takes a millisecond, on the GPU next to nothing. Hands have no separate fingers
//! where the skeleton has none, and there are no collisions.
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
mod placed_shape;
pub mod shapes;
mod sheets;
mod texture;
mod weights;

pub use around::{ProceduralSkin, SkinBuilder};
pub use character::{Character, Drive};
pub use deform::{RigidTransform, dual_quaternion, linear_blend};
pub use texture::{AlphaMode, Sampler, Texture, TexturedPart, Wrap};
pub use weights::normals;

use crate::clip::{Clip, reference_pose};
use crate::skeleton::{Roles, Skeleton, WorldPose};
use glam::{Quat, Vec3};
use std::collections::BTreeMap;
use std::sync::Arc;

/// A mesh bound to a skeleton, in its bind pose. All per-vertex lists have the same length.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SkinnedMesh {
    /// Positions in the world of the bind pose, metres, Y up.
    pub positions: Vec<Vec3>,
    /// Unit normals, outward.
    pub normals: Vec<Vec3>,
    /// The joints of the skeleton that move each vertex. Unused entries have weight 0 and still are
    /// valid joints.
    pub joints: Vec<[u16; 4]>,
    /// The weight of each of these joints: descending, non-negative, their sum 1.
    pub weights: Vec<[f32; 4]>,
    /// Three vertices each, counter-clockwise from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Base colour of each vertex, red, green, blue and alpha in 0–1 as written in a palette
    /// (sRGB-encoded, straight alpha). Empty where the mesh has no colours of its own, or all are
    /// white below a texture.
    pub colors: Vec<[f32; 4]>,
    /// The place of each vertex in the image of its texture: (0, 0) is the upper left corner, (1,
    /// 1) the lower right one. Empty where the mesh has no textures.
    pub coordinates: Vec<[f32; 2]>,
    /// The parts with a texture, in the order of their triangles. No vertex is on two parts.
    pub textured: Vec<TexturedPart>,
    /// `joint_from_bind` of every joint of the skeleton: the bind pose in the joint's frame.
    pub bind: Vec<RigidTransform>,
}

impl SkinnedMesh {
    /// Makes a body for a skeleton from its rest pose alone: see [`SkinBuilder::new`] and, for the
    /// girth, [`ProceduralSkin::with_girth`]. The same input gives the same mesh.
    #[must_use]
    pub fn around(skeleton: &Skeleton, roles: &Roles, girth: f32) -> Self {
        Self::sculpted(SkinBuilder::new(skeleton, roles, &skeleton.rest_pose()), girth)
    }

    /// Makes a body for the skeleton of a clip. Where its rest pose is implausible, the reference
    /// pose of the clip is used instead ([`reference_pose`]).
    #[must_use]
    pub fn around_clip(clip: &Clip, roles: &Roles, girth: f32) -> Self {
        Self::sculpted(
            SkinBuilder::new(clip.skeleton(), roles, &reference_pose(clip, roles)),
            girth,
        )
    }

    fn sculpted(mut skin_builder: SkinBuilder, girth: f32) -> Self {
        loop {
            if let Some(procedural_skin) = skin_builder.advance() {
                return procedural_skin.with_girth(girth);
            }
        }
    }

    /// Returns whether it has colours of its own: of its vertices, or of textures.
    #[must_use]
    pub fn has_own_colors(&self) -> bool {
        !self.colors.is_empty() || !self.textured.is_empty()
    }

    /// Returns the memory of the mesh, bytes.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        let per_vertex = 2 * size_of::<Vec3>() + size_of::<([u16; 4], [f32; 4])>();
        let arrays = per_vertex * self.positions.len()
            + size_of_val(&self.colors[..])
            + size_of_val(&self.coordinates[..])
            + size_of_val(&self.triangles[..])
            + size_of_val(&self.bind[..]);
        let images: BTreeMap<usize, usize> = (self.textured.iter())
            .map(|part| (Arc::as_ptr(&part.texture.image).addr(), part.texture.image.len()))
            .collect();
        (arrays + images.values().sum::<usize>()) as u64
    }

    /// Returns `world_from_bind` of every joint for a pose of the skeleton: the transform of a
    /// vertex that follows this joint alone. Joints that the pose does not have stay in the bind
    /// pose.
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

    /// Writes [`Self::world_from_bind`] into a list, which is overwritten.
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

    /// Maps the mesh to another list of joints: joint `i` becomes `joint_of[i]`, or the root where
    /// that list is too short; `bind` holds `joint_from_bind` of the new joints.
    pub fn rebind(&mut self, joint_of: &[usize], bind: Vec<RigidTransform>) {
        for joint in self.joints.as_flattened_mut() {
            *joint = joint_of.get(usize::from(*joint)).map_or(0, |&joint| joint as u16);
        }
        self.bind = bind;
    }

    /// Turns the mesh and its joints' axes about the origin. The joints' rotations at rest remain
    /// the identity.
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
mod body_tests;
#[cfg(test)]
mod tests;
