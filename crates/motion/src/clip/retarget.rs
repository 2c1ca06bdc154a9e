use super::ground::rise_between;
use super::{Clip, ClipError, stance_for_rest};
use crate::skeleton::{Pose, Retargeting, Roles, Skeleton, WorldPose};
use glam::Vec3;
use std::sync::Arc;

/// Why a clip cannot be moved to another skeleton.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RetargetError {
    /// No joint of one skeleton corresponds to a joint of the other.
    #[error(
        "the two skeletons have no joint in common, neither by name nor by role: say by hand which joints are the hips and the legs"
    )]
    NothingInCommon,
    /// The result is no clip.
    #[error(transparent)]
    Clip(#[from] ClipError),
}

/// The clip on another skeleton: see [`Retargeting`] for how joints are matched and turned.
///
/// The result stands as high above the ground as the source does, in proportion to its legs, by
/// those points of the feet that both bodies have. On the same skeleton the clip comes back
/// unchanged; on the same rig with its joints in another order every shared joint stays where it
/// was.
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

/// As [`retarget`], onto the skeleton of another clip: where that rests in a way that shows no
/// creature, the clip shows how it stands ([`stance_for_rest`]).
///
/// # Errors
/// As [`retarget`].
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
    let way = Retargeting::standing(
        source,
        source_roles,
        stance.as_ref(),
        target,
        target_roles,
        target_stance.as_ref(),
    )
    .ok_or(RetargetError::NothingInCommon)?;
    let mut poses: Vec<Pose> =
        (0..clip.frames()).map(|frame| way.pose(&clip.pose(frame))).collect();
    let make =
        |poses: Vec<Pose>| Clip::from_poses(clip.name(), Arc::clone(target), clip.fps(), poses);
    if !way.is_same_rig() {
        let standing = make(poses.clone())?;
        let rise = rise_between((clip, source_roles), (&standing, target_roles), way.scale())
            .unwrap_or(0.0);
        for pose in &mut poses {
            pose.root_translation += Vec3::Y * rise;
        }
    }
    Ok(make(poses)?.with_provenance(clip.provenance()))
}

#[cfg(test)]
mod tests;
