//! A character on its way to a worker, in one piece.

use super::MeshHead;
use super::parcel::{images, put_whole_mesh};
use segue_motion::skeleton::{FoldedChain, Joint, Roles, Skeleton};
use segue_motion::skin::{Character, SkinnedMesh};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// A character without its arrays.
#[derive(Serialize, Deserialize)]
pub(crate) struct CharacterHead {
    joints: Vec<Joint>,
    above: Option<FoldedChain>,
    roles: Roles,
    mesh: MeshHead,
    /// The sizes of the images of its mesh, bytes.
    images: Vec<usize>,
}

impl CharacterHead {
    /// Returns that of a character.
    pub(crate) fn of(character: &Character) -> Self {
        let Character { skeleton, roles, mesh } = character;
        let images = images(&[mesh]);
        Self {
            joints: skeleton.joints().to_vec(),
            above: skeleton.folded_chain().cloned(),
            roles: roles.clone(),
            mesh: MeshHead::of(mesh, &images),
            images: images.iter().map(|image| image.len()).collect(),
        }
    }

    /// Returns the number of bytes of its arrays.
    pub(crate) fn bytes(&self) -> usize {
        self.images.iter().fold(self.mesh.bytes(), |sum, size| sum.saturating_add(*size))
    }

    /// Moves the arrays of the character from the front of `bytes`, and returns the character;
    /// `None` where they are too short. Their content is not checked: it comes from this page.
    pub(crate) fn take(self, bytes: &mut &[u8]) -> Option<Character> {
        let (mut arrays, mut rest) = bytes.split_at_checked(self.mesh.bytes())?;
        let mut mesh = self.mesh.room().ok()?;
        self.mesh.take(&mut mesh, &mut arrays);
        let mut images = Vec::new();
        for size in &self.images {
            let (image, later) = rest.split_at_checked(*size)?;
            images.push(Arc::from(image));
            rest = later;
        }
        *bytes = rest;
        let skeleton = Skeleton::new(self.joints).ok()?.with_folded_chain(self.above);
        let mesh = SkinnedMesh { textured: self.mesh.textured(&images), ..mesh };
        Some(Character { skeleton: Arc::new(skeleton), roles: self.roles, mesh: Arc::new(mesh) })
    }
}

/// Appends the arrays of a character, as [`CharacterHead::take`] expects them.
pub(crate) fn put_character(bytes: &mut Vec<u8>, character: &Character) {
    put_whole_mesh(bytes, &character.mesh);
    for image in images(&[&character.mesh]) {
        bytes.extend_from_slice(image);
    }
}
