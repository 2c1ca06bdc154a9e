//! FBX: characters and their takes from binary and ASCII files.
//!
//! FBX (Autodesk) has no public specification; [`segue_fbx`] reads it. A file is a tree of nodes of
//! which some are bones, and any number of takes. Every take of every character becomes a clip.
//!
//! Unlike other formats, FBX states its unit and its axes. The axes are taken as stated, and so is
//! the unit unless the body would be smaller than a mouse or taller than a house.
//!
//! Joints are the bones, the nodes that skins name, and the nodes above and between them that move;
//! where there are neither bones nor skins, those that move. Joints get new axes, so that in the
//! rest pose every rotation is the identity, as everywhere in Segue. The rest pose has the
//! rotations of the bind pose where the file has one, because the nodes often stand in any pose of
//! the motion.
//!
//! Each frame is computed in the world, with all pivots, layers and scales, and taken apart again:
//! a joint whose distance from its parent changes gets a track of translations. Positions in the
//! world are therefore exact also where scales are uneven or animated.
//!
//! A skinned mesh keeps the base colours of its materials, with textures in PNG, JPEG and WebP, in
//! the file or beside it.

mod joints;
mod mesh;
mod read;
mod sample;
mod texture;
mod timing;
mod write;

pub use read::{read, read_with_progress};
pub(crate) use segue_fbx::is_fbx;
pub use write::{FbxOptions, FbxWriteError, write_fbx};
