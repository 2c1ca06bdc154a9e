//! Retargeting of clips to another skeleton.

use super::contacts::FootTracks;
use super::ground::rise_between;
use super::{Clip, ClipError, stance_for_rest};
use crate::skeleton::{Pose, Retargeting, Roles, Skeleton, WorldPose};
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

/// Retargets a clip to another skeleton by the directions of its bones; [`Retargeting`] describes
/// how joints are mapped and rotated. [`crate::retarget::retarget_motion`] begins with this, and
/// then keeps feet and hands where they belong.
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
    if Arc::ptr_eq(clip.skeleton(), target) || clip.skeleton() == target {
        return Ok(clip.clone());
    }
    let mut directions = Directions::new((clip, source_roles), (target, target_roles), None)?;
    loop {
        if let Some((made, _)) = directions.advance(clip, clip.frames())? {
            return Ok(made);
        }
    }
}

/// The computation of [`retarget`] in slices.
#[derive(Debug)]
pub(crate) struct Directions {
    way: Retargeting,
    target: Arc<Skeleton>,
    source_roles: Roles,
    target_roles: Roles,
    poses: Vec<Pose>,
    /// The result before it is raised, with the feet of both clips.
    standing: Option<(Clip, [FootTracks; 2], usize)>,
}

impl Directions {
    /// Prepares retargeting from a clip to another skeleton. `stance` is that of the target if its
    /// rest pose is implausible.
    pub(crate) fn new(
        source: (&Clip, &Roles),
        target: (&Arc<Skeleton>, &Roles),
        stance: Option<&WorldPose>,
    ) -> Result<Self, RetargetError> {
        let ((clip, source_roles), (target, target_roles)) = (source, target);
        let own = stance_for_rest(clip, source_roles);
        let from = clip.skeleton();
        let way =
            Retargeting::standing(from, source_roles, own.as_ref(), target, target_roles, stance)
                .ok_or(RetargetError::NothingInCommon)?;
        Ok(Self {
            way,
            target: Arc::clone(target),
            source_roles: source_roles.clone(),
            target_roles: target_roles.clone(),
            poses: Vec::with_capacity(clip.frames()),
            standing: None,
        })
    }

    /// Returns the number of frames that are done, in two passes.
    pub(crate) fn frames_done(&self) -> usize {
        match &self.standing {
            None => self.poses.len(),
            Some((clip, _, read)) => clip.frames() + read,
        }
    }

    /// Processes up to `frames` more frames (at least one) of the clip, which must be the same in
    /// every call. Returns the result when it is complete, and the way that it took.
    pub(crate) fn advance(
        &mut self,
        clip: &Clip,
        frames: usize,
    ) -> Result<Option<(Clip, Retargeting)>, RetargetError> {
        let after = |done: usize| done.saturating_add(frames.max(1)).min(clip.frames());
        let Some((standing, tracks, read)) = &mut self.standing else {
            let done = self.poses.len();
            let way = &self.way;
            self.poses.extend((done..after(done)).map(|frame| way.pose(&clip.pose(frame))));
            if self.poses.len() == clip.frames() {
                let poses = std::mem::take(&mut self.poses);
                let target = Arc::clone(&self.target);
                let made = Clip::from_poses(clip.name(), target, clip.fps(), poses)?
                    .with_provenance(clip.provenance());
                let tracks = [
                    FootTracks::new(clip, &self.source_roles),
                    FootTracks::new(&made, &self.target_roles),
                ];
                let read = if self.way.is_same_rig() { made.frames() } else { 0 };
                self.standing = Some((made, tracks, read));
            }
            return Ok(None);
        };
        let next = *read..after(*read);
        tracks[0].read(clip, next.clone());
        tracks[1].read(standing, next.clone());
        *read = next.end;
        if *read < clip.frames() {
            return Ok(None);
        }
        let Some((made, [source, moved], _)) = self.standing.take() else { return Ok(None) };
        let rise = if self.way.is_same_rig() {
            None
        } else {
            rise_between(&source, &moved, self.way.scale())
        };
        Ok(Some((made.raised(rise.unwrap_or(0.0)), self.way.clone())))
    }
}

#[cfg(test)]
mod tests;
