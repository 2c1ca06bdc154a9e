//! Clips from lists of poses.

use super::{Clip, ClipError, JointTranslations};
use crate::skeleton::{Pose, Skeleton};
use std::sync::Arc;

impl Clip {
    /// Returns a clip from whole poses, one per frame. The joints with translations are those of
    /// the first pose.
    ///
    /// # Errors
    /// [`ClipError`] when the frame rate is not a positive number, a pose does not have one
    /// rotation per joint, or poses have translations for different joints.
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
                return Err(ClipError::Length { what: "translations of a pose", found, expected });
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
#[cfg(test)]
mod tests {
    use super::*;
    use crate::clip::fixtures::wander;
    use crate::skeleton::fixtures;
    use glam::Vec3;

    #[test]
    fn from_poses_of_a_clip_is_the_clip() {
        let clip = wander(&fixtures::cmu_bvh(), 7, 3);
        let values = (0..7).map(|i| Vec3::X * i as f32).collect();
        let clip = clip.with_translations(vec![JointTranslations { joint: 4, values }]).unwrap();
        let poses = (0..clip.frames()).map(|frame| clip.pose(frame));
        assert_eq!(
            Clip::from_poses(clip.name(), clip.skeleton().clone(), clip.fps(), poses),
            Ok(clip)
        );
    }

    #[test]
    fn from_poses_of_different_shape_is_refused() {
        let clip = wander(&fixtures::cmu_bvh(), 2, 3);
        let make = |a: Pose, b: Pose| Clip::from_poses("x", clip.skeleton().clone(), 30.0, [a, b]);
        let (plain, mut short, mut moved) = (clip.pose(0), clip.pose(1), clip.pose(1));
        short.rotations.pop();
        moved.translations.push((2, Vec3::ONE));
        assert!(matches!(make(plain.clone(), short), Err(ClipError::Length { .. })));
        assert!(matches!(make(plain, moved.clone()), Err(ClipError::Length { .. })));
        let mut other = moved.clone();
        other.translations[0].0 = 3;
        assert_eq!(make(moved, other), Err(ClipError::Translations(3)));
    }
}
