//! Retargeting of clips to another skeleton.

use super::ground::rise_between;
use super::{Clip, ClipError, stance_for_rest};
use crate::skeleton::{Pose, Retargeting, Roles, Skeleton, WorldPose};
use glam::Vec3;
use std::sync::Arc;

/// Error retargeting a clip.
#[derive(Clone, Debug, PartialEq, thiserror::Error, segue_text::ToMessage)]
pub enum RetargetError {
    /// No joint of one skeleton corresponds to a joint of the other.
    #[error(
        "the two skeletons have no joint in common, neither by name nor by role: set the body parts, at least hips and legs"
    )]
    NothingInCommon,
    /// The result is not a valid clip.
    #[error(transparent)]
    Clip(#[from] ClipError),
}

/// Retargets a clip to another skeleton; [`Retargeting`] describes how joints are mapped and
/// rotated.
///
/// The feet of the result are as high above the ground as the source's, in proportion to the legs,
/// by the points of the feet that both bodies have. On the same skeleton the clip is returned
/// unchanged; on the same rig with its joints in another order every shared joint keeps its
/// position.
///
/// # Errors
/// [`RetargetError::NothingInCommon`] when no joint of `target` corresponds to one of the clip's.
pub fn retarget(
    clip: &Clip,
    source_roles: &Roles,
    target: &Arc<Skeleton>,
    target_roles: &Roles,
) -> Result<Clip, RetargetError> {
    retarget_to(clip, source_roles, target, target_roles, || None)
}

/// Retargets a clip, as [`retarget`] does, to the skeleton of another clip. If that skeleton has an
/// implausible rest pose, its stance is taken from the clip
/// ([`reference_pose`](super::reference_pose)).
///
/// # Errors
/// The same as for [`retarget`].
pub fn retarget_onto(
    clip: &Clip,
    source_roles: &Roles,
    model: &Clip,
    model_roles: &Roles,
) -> Result<Clip, RetargetError> {
    retarget_to(clip, source_roles, model.skeleton(), model_roles, || {
        stance_for_rest(model, model_roles)
    })
}

fn retarget_to(
    clip: &Clip,
    source_roles: &Roles,
    target: &Arc<Skeleton>,
    target_roles: &Roles,
    target_stance: impl FnOnce() -> Option<WorldPose>,
) -> Result<Clip, RetargetError> {
    let source = clip.skeleton();
    if Arc::ptr_eq(source, target) || source == target {
        return Ok(clip.clone());
    }
    let (stance, target_stance) = (stance_for_rest(clip, source_roles), target_stance());
    let retargeting = Retargeting::standing(
        source,
        source_roles,
        stance.as_ref(),
        target,
        target_roles,
        target_stance.as_ref(),
    )
    .ok_or(RetargetError::NothingInCommon)?;
    let mut poses: Vec<Pose> =
        (0..clip.frames()).map(|frame| retargeting.pose(&clip.pose(frame))).collect();
    let make =
        |poses: Vec<Pose>| Clip::from_poses(clip.name(), Arc::clone(target), clip.fps(), poses);
    if !retargeting.is_same_rig() {
        let standing = make(poses.clone())?;
        let rise =
            rise_between((clip, source_roles), (&standing, target_roles), retargeting.scale())
                .unwrap_or(0.0);
        for pose in &mut poses {
            pose.root_translation += Vec3::Y * rise;
        }
    }
    Ok(make(poses)?.with_provenance(clip.provenance()))
}

#[cfg(test)]
mod tests;
