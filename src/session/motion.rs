use crate::clip::{Clip, ContactOptions, Contacts, character_frames, detect_contacts};
use crate::math::Planar;
use crate::skeleton::Roles;
use std::sync::Arc;

/// A clip with what is derived from it once and used everywhere.
#[derive(Clone, Debug)]
pub struct Motion {
    /// The clip.
    pub clip: Arc<Clip>,
    /// What its joints are for.
    pub roles: Roles,
    /// When which foot is planted.
    pub contacts: Contacts,
    /// Where the character stands and what it faces, one frame of reference per frame of the clip.
    pub ground_frames: Vec<Planar>,
}

impl Motion {
    /// Derives everything from a clip; `roles` are found in the skeleton when none are given.
    #[must_use]
    pub fn analyze(clip: Clip, roles: Option<Roles>) -> Self {
        let roles = roles.unwrap_or_else(|| Roles::detect(clip.skeleton()));
        let contacts = detect_contacts(&clip, &roles, &ContactOptions::default());
        let ground_frames = character_frames(&clip, &roles);
        Self {
            clip: Arc::new(clip),
            roles,
            contacts,
            ground_frames,
        }
    }
}
