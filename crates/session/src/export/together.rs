//! Several clips in one file: on one skeleton, each as an animation.

use super::{ExportBody, ExportFormat, ExportOptions, with_root};
use crate::labs::CharacterMotion;
use segue_formats::fbx::{FbxOptions, write_fbx};
use segue_formats::gltf::{GlbOptions, write_clips_glb};
use segue_motion::clip::{Clip, Motion};
use segue_motion::retarget::{RetargetOptions, TargetBody, retarget_motion};
use segue_motion::skin::{Character, SkinnedMesh};
use segue_text::{Message, ToMessage as _, msg};
use std::sync::Arc;

/// Clips that are saved in one file. All are on one body: that of a character, or that of the first
/// clip. Clips with other joints are put on it, with their feet and hands where they belong.
#[derive(Clone, Debug, Default)]
pub struct Together {
    options: ExportOptions,
    character: Option<Character>,
    /// The first clip, on whose body the others are put where there is no character.
    first: Option<Arc<Motion>>,
    mesh: Option<Arc<SkinnedMesh>>,
    clips: Vec<Clip>,
}

impl Together {
    /// Begins a file. Formats that hold bodies get the `character`, if there is one and the options
    /// ask for it.
    #[must_use]
    pub fn new(options: ExportOptions, character: Option<&Character>) -> Self {
        let has_body = options.format == ExportFormat::Glb && options.body == ExportBody::Character;
        let character = character.filter(|_| has_body).cloned();
        Self { options, character, ..Self::default() }
    }

    /// Adds a clip under a name. `mesh` is the body of its file on its own skeleton, which the file
    /// gets where the clip is the first one and no character was chosen. Returns a note where the
    /// clip was put on another body.
    ///
    /// # Errors
    /// The reason why it cannot be in this file.
    pub fn add(
        &mut self,
        name: &str,
        motion: &Arc<Motion>,
        mesh: Option<&Arc<SkinnedMesh>>,
    ) -> Result<Option<Message>, Message> {
        if motion.clip().frames() == 0 {
            return Err("it has no frames".into());
        }
        let (clip, roles, is_moved) = match (&self.character, &self.first) {
            (Some(character), _) => {
                let moved = CharacterMotion::new(motion, character)
                    .ok_or_else(|| msg!("it has no limbs in common with the character"))?;
                (moved.clip().clone(), &character.roles, moved.errors().is_some())
            }
            (None, None) => {
                self.first = Some(Arc::clone(motion));
                self.mesh = mesh.filter(|_| self.options.body == ExportBody::Character).cloned();
                (Clip::clone(motion.clip()), motion.roles(), false)
            }
            (None, Some(first)) => {
                let has_its_joints =
                    motion.clip().skeleton().has_joints_of(first.clip().skeleton());
                if has_its_joints {
                    (Clip::clone(motion.clip()), motion.roles(), false)
                } else {
                    (on_body_of(first, motion)?, first.roles(), true)
                }
            }
        };
        let clip = with_root(&clip, roles, &self.options).into_owned();
        self.clips.push(clip.with_name(name));
        Ok(is_moved.then(|| msg!("it was put on the body of the file")))
    }

    /// Returns the number of clips.
    #[must_use]
    pub fn len(&self) -> usize {
        self.clips.len()
    }

    /// Returns whether there is no clip.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.clips.is_empty()
    }

    /// Returns the file.
    ///
    /// # Errors
    /// The reason why the format cannot hold the clips.
    pub fn write(&self) -> Result<Vec<u8>, Message> {
        let clips: Vec<&Clip> = self.clips.iter().collect();
        let ExportOptions { format, metres_per_unit, up, fps, .. } = self.options;
        match format {
            ExportFormat::Glb => {
                let mesh = self.character.as_ref().map(|character| &character.mesh);
                let mesh = mesh.or(self.mesh.as_ref()).map(|mesh| &**mesh);
                write_clips_glb(&clips, mesh, &GlbOptions { fps, smooth: true })
                    .map_err(|error| error.to_message())
            }
            ExportFormat::Fbx => write_fbx(&clips, &FbxOptions { metres_per_unit, up, fps })
                .map_err(|error| error.to_message()),
            _ => Err("a file of this format holds one clip: choose FBX or GLB".into()),
        }
    }
}

/// Returns a motion on the body of another, joints above the hips included.
fn on_body_of(first: &Motion, motion: &Motion) -> Result<Clip, Message> {
    let body = TargetBody::of(first);
    let made = retarget_motion(motion, &body, &RetargetOptions::default())
        .map_err(|error| error.to_message())?;
    Ok(made.clip.with_chain_of(first.clip().skeleton()))
}
