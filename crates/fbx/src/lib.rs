//! FBX scenes as plain data: nodes, takes, skinned meshes.
//!
//! FBX (Autodesk) has no public specification. This crate is a small and safe surface over
//! [ufbx](https://github.com/ufbx/ufbx), which reads binary and ASCII files of the versions 3000 to
//! 7700 and evaluates what a node's transform depends on: pivots and offsets, rotation before and
//! after, orders of Euler angles, layers, spline tangents, and the modes in which scale is
//! inherited.
//!
//! # The idea
//!
//! A file is a tree of nodes, each with a transform from its own axes to those of its parent, and a
//! list of takes, which give other transforms for every time:
//!
//! ```text
//! bytes → Scene::open → nodes (names, parents, transforms, bind poses)
//!                     → takes (names, times of keys, which nodes move)
//!                     → Poses::transform(take, node, time): translation, rotation, scale
//!                     → Scene::meshes: vertices, triangles, weights, materials
//!                     → Scene::image: image files, or their names
//! ```
//!
//! All transforms are in axes with Y up, X to the right and Z to the front, whatever the file's own
//! axes; lengths are in the file's unit, which [`Scene::metres_per_unit`] states.
//!
//! # Accuracy and cost
//!
//! Transforms are computed in double precision when they are asked for: a scene takes the memory of
//! its file's content, about 40 bytes for each key of a curve, and no more for being sampled.
//! [`OpenOptions::max_memory`] bounds it. A binary file whose keys would take more than
//! [`OpenOptions::max_key_memory`] is read in parts: its keys take the 4 bytes of their values, and
//! the part around one time as much as that option says.
//!
//! # What it does not do
//!
//! Constraints and inverse kinematics are counted, not evaluated. Files beside the FBX file are not
//! opened. Nothing is written.

mod curves;
mod cut;
mod error;
#[cfg(target_arch = "wasm32")]
mod libc;
mod material;
mod math;
mod matrix;
mod memory;
mod mesh;
mod parts;
mod records;
mod scene;
mod stream;
mod take;

pub use error::OpenError;
pub use material::{Image, Material, Texture};
pub use mesh::{Cluster, Influence, MAX_INFLUENCES, Mesh};
pub use scene::{Node, NodeKind, OpenOptions, Poses, Scene, Transform, UpAxis};
pub use take::{Movement, Take};

/// Returns whether these bytes begin an FBX file, binary or ASCII.
#[must_use]
pub fn is_fbx(bytes: &[u8]) -> bool {
    const BINARY: &[u8] = b"Kaydara FBX Binary";
    /// The length of the head in which the first line of an ASCII file stands.
    const HEAD: usize = 256;
    if bytes.starts_with(BINARY) {
        return true;
    }
    let head = bytes.get(..HEAD).unwrap_or(bytes);
    let text = head.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(head).trim_ascii_start();
    let comment = text.strip_prefix(b";").map(<[u8]>::trim_ascii_start);
    comment.is_some_and(|comment| comment.starts_with(b"FBX"))
        || text.starts_with(b"FBXHeaderExtension:")
}
