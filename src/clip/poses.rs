use super::{Clip, ClipError, JointTranslations};
use crate::skeleton::{Pose, Skeleton};
use std::sync::Arc;

impl Clip {
    /// A clip from whole poses, one per frame. The joints that have translations are those of the first pose.
    ///
    /// # Errors
    /// [`ClipError`] when the frame rate is not a positive number, a pose has not one rotation per joint, or poses differ in which joints
    /// have translations.
    pub fn from_poses(
        name: impl Into<String>,
        skeleton: Arc<Skeleton>,
        fps: f64,
        poses: impl IntoIterator<Item = Pose>,
    ) -> Result<Self, ClipError> {
        let (mut rotations, mut root_translations) = (Vec::new(), Vec::new());
        let mut tracks: Vec<JointTranslations> = Vec::new();
        for pose in poses {
            if pose.rotations.len() != skeleton.len() {
                return Err(ClipError::Length {
                    what: "rotations of a pose",
                    found: pose.rotations.len(),
                    expected: skeleton.len(),
                });
            }
            if root_translations.is_empty() {
                tracks = pose
                    .translations
                    .iter()
                    .map(|&(joint, _)| JointTranslations { joint, values: Vec::new() })
                    .collect();
            }
            if pose.translations.len() != tracks.len() {
                let (found, expected) = (pose.translations.len(), tracks.len());
                return Err(ClipError::Length {
                    what: "translations of a pose",
                    found,
                    expected,
                });
            }
            for (track, &(joint, value)) in tracks.iter_mut().zip(&pose.translations) {
                if track.joint != joint {
                    return Err(ClipError::Translations(joint));
                }
                track.values.push(value);
            }
            root_translations.push(pose.root_translation);
            rotations.extend_from_slice(&pose.rotations);
        }
        Self::new(name, skeleton, fps, rotations, root_translations)?.with_translations(tracks)
    }
}
