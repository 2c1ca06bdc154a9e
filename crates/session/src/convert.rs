//! Motions in another format, on another body: the bytes of one file for each.

use crate::export::{ExportFormat, ExportOptions, export};
use segue_formats::{PackedFile, ZipFull};
use segue_motion::clip::{Clip, Interpolation, Motion, reference_pose, resample};
use segue_motion::retarget::{RetargetOptions, TargetBody, retarget_motion};
use segue_motion::skeleton::{FoldedChain, Joint, Pose, Roles, Skeleton, local_pose};
use segue_motion::skin::{Character, SkinnedMesh};
use segue_text::{Message, ToMessage as _};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Options of a conversion.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ConvertOptions {
    /// The format and its options.
    pub export: ExportOptions,
    /// The body to which motions are retargeted; `None` to keep their own.
    pub rig: Option<TargetRig>,
}

/// A skeleton to which motions are retargeted, standing.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TargetRig {
    joints: Vec<Joint>,
    above: Option<FoldedChain>,
    roles: Roles,
    /// A pose in which the body stands: joints may have any rest pose.
    rotations: Vec<glam::Quat>,
    root: glam::Vec3,
}

impl TargetRig {
    /// Returns the body of a motion.
    #[must_use]
    pub fn of(motion: &Motion) -> Self {
        let (clip, roles) = (motion.clip(), motion.roles());
        let skeleton = clip.skeleton();
        let Pose { root_translation: root, rotations, .. } =
            local_pose(skeleton, &reference_pose(clip, roles));
        Self {
            joints: skeleton.joints().to_vec(),
            above: skeleton.folded_chain().cloned(),
            roles: roles.clone(),
            rotations,
            root,
        }
    }

    /// Returns a motion on this body, with its feet and hands where they belong.
    pub(crate) fn put_on(&self, motion: &Motion) -> Result<Motion, Message> {
        let skeleton = Skeleton::new(self.joints.clone()).map_err(|error| error.to_message())?;
        let skeleton = Arc::new(skeleton.with_folded_chain(self.above.clone()));
        let model = Clip::new("", skeleton, 30.0, self.rotations.clone(), vec![self.root])
            .map_err(|error| error.to_message())?;
        let body = TargetBody::of_clip(&model, &self.roles);
        let made = retarget_motion(motion, &body, &RetargetOptions::default())
            .map_err(|error| error.to_message())?;
        Ok(Motion::with_roles(made.clip, &self.roles).with_contacts(motion.contacts().clone()))
    }
}

/// A clip in another format. The compressed bytes of its file are not in here where they are sent
/// beside it ([`ReadFile::unpacked`](crate::reading::ReadFile::unpacked), and
/// [`packed::write`](crate::packed::write)).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ConvertedClip {
    /// The clip's name.
    pub clip: String,
    /// The number of its frames as it was read.
    pub frames: usize,
    /// Frames per second as it was read.
    pub fps: f64,
    /// The number of its joints as it was read.
    pub joints: usize,
    /// The file.
    pub file: PackedFile,
}

/// Returns the bytes of a file with a motion in another format. `mesh` is the body of its file on
/// its own skeleton, which a GLB file gets.
///
/// # Errors
/// The reason why it cannot be written in the format, or be put on the body.
pub fn convert_to_bytes(
    motion: &Motion,
    mesh: Option<&Arc<SkinnedMesh>>,
    options: &ConvertOptions,
) -> Result<Vec<u8>, Message> {
    let (own, how) = (motion.clip(), &options.export);
    if own.frames() == 0 {
        return Err("it has no frames".into());
    }
    let put_on = options.rig.as_ref().map(|rig| rig.put_on(motion)).transpose()?;
    let shown = put_on.as_ref().unwrap_or(motion);
    // The other formats resample by themselves.
    let rate = how.fps.filter(|_| how.format == ExportFormat::Csv);
    let resampled = rate
        .and_then(|fps| resample(shown.clip(), fps, Interpolation::default()).ok())
        .map(|clip| Motion::with_roles(clip, shown.roles()));
    let character = mesh.filter(|_| options.rig.is_none()).map(|mesh| Character {
        skeleton: own.skeleton().clone(),
        roles: motion.roles().clone(),
        mesh: mesh.clone(),
    });
    export(resampled.as_ref().unwrap_or(shown), character.as_ref(), &[], how)
        .map_err(|error| error.to_message())
}

/// Converts a motion as [`convert_to_bytes`] does, compressed for an archive.
///
/// # Errors
/// Those of [`convert_to_bytes`], and that there is no memory for it.
pub fn convert_motion(
    motion: &Motion,
    mesh: Option<&Arc<SkinnedMesh>>,
    options: &ConvertOptions,
) -> Result<ConvertedClip, Message> {
    let bytes = convert_to_bytes(motion, mesh, options)?;
    let file = PackedFile::new(&bytes).ok_or_else(|| ZipFull.to_message())?;
    let own = motion.clip();
    let (frames, fps, joints) = (own.frames(), own.fps(), own.skeleton().len());
    Ok(ConvertedClip { clip: own.name().to_owned(), frames, fps, joints, file })
}
