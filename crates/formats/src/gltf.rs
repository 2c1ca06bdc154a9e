//! glTF 2.0: characters and their animations from `.glb` and `.gltf` files, and clips as `.glb`
//! files.
//!
//! The format (Khronos Group, "glTF 2.0 Specification") is a JSON tree of nodes with translation,
//! rotation and scale, and binary arrays (accessors) with keys over time. Lengths are metres, +Y is
//! up, and a character looks along +Z: as inside Segue.
//!
//! The reader takes motion and skinned meshes. The joints are the nodes that skins name, or that
//! animations move where there is no skin. Joints get new axes, so that in the rest pose every
//! rotation is the identity and offsets are those of the rest pose, as everywhere in Segue; scales
//! of nodes go into offsets. World positions do not change. A skinned mesh keeps its base colours,
//! with textures in PNG, JPEG and WebP, and the shape that the weights of its morph targets give it
//! at rest. A mesh without a skin follows the joint that it hangs from; all others are ignored, and
//! so are other images.
//!
//! VRM 0.x, VRM 1.0 and VRM animations (VRMA) are glTF files with a bone map, which gives the roles
//! of the joints. Bones without a role (chest, neck, shoulders, eyes, jaw, fingers) are joints with
//! the names of their nodes. Constraints between nodes, swinging bones and expressions are ignored.

mod accessor;
mod bones;
pub(crate) mod characters;
mod curve;
mod document;
mod humanoid;
mod morph;
pub(crate) mod node;
pub(crate) mod rate;
pub(crate) mod read;
pub(crate) mod skin;
mod texture;
mod vrma;
mod write;

pub use read::read;
pub use vrma::{VrmaError, write_vrma};
pub use write::{GlbError, GlbOptions, write_character_glb, write_clips_glb, write_glb};

/// Returns whether the bytes are a `.glb` file, or JSON that may be a `.gltf` file.
#[must_use]
pub(crate) fn is_gltf(bytes: &[u8]) -> bool {
    let is_json = || {
        let text = super::text::decode(bytes.get(..1 << 12).unwrap_or(bytes));
        text.iter().find(|b| !super::text::is_space(**b)) == Some(&b'{')
    };
    bytes.starts_with(b"glTF") || is_json()
}

#[cfg(test)]
mod tests;
