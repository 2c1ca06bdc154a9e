//! World poses of neighbouring frames, each computed once.

use super::Clip;
use crate::skeleton::WorldPose;

/// The last world poses of a clip that were computed. Of three neighbouring frames each has a place
/// of its own, so that a walk from frame to frame poses each frame once. It does not hold the clip:
/// every call must be given the same one.
#[derive(Clone, Debug)]
pub(crate) struct RecentPoses {
    joints: Vec<usize>,
    /// Poses with their frames, by the frame's remainder.
    poses: [(Option<usize>, WorldPose); 3],
}

impl RecentPoses {
    /// Returns the poses of these joints, which must be in rising order and with all their
    /// ancestors. The entries of other joints are undefined.
    pub(crate) fn of(joints: Vec<usize>) -> Self {
        Self { joints, poses: Default::default() }
    }

    /// Computes the pose of a frame, unless it is one of the last.
    pub(crate) fn ensure(&mut self, clip: &Clip, frame: usize) {
        let (known, world) = &mut self.poses[frame % 3];
        if *known != Some(frame) {
            clip.world_pose_of(frame, &self.joints, world);
            *known = Some(frame);
        }
    }

    /// Returns the pose of a frame that [`ensure`](Self::ensure) was called for, if no other frame
    /// has taken its place.
    pub(crate) fn get(&self, frame: usize) -> &WorldPose {
        debug_assert_eq!(self.poses[frame % 3].0, Some(frame));
        &self.poses[frame % 3].1
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clip::fixtures::wander;
    use crate::skeleton::fixtures;

    #[test]
    fn recent_poses_are_those_of_their_frames() {
        let clip = wander(&fixtures::lafan(), 12, 7);
        let mut recent = RecentPoses::of((0..clip.skeleton().len()).collect());
        for frame in [0, 1, 2, 1, 0, 3, 9, 10, 11, 9, 6, 0] {
            recent.ensure(&clip, frame);
            assert_eq!(recent.get(frame), &clip.world_pose(frame), "{frame}");
        }
    }
}
