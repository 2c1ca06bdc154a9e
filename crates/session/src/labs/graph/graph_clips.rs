//! The clips of a motion graph, fitted to one skeleton.

use crate::labs::LabError;
use crate::labs::RetargetReport;
use crate::labs::pair::FittedClip;
use segue_motion::clip::Motion;
use segue_motion::graph::{FrameSet, JoltSearch, WalkProfile};
use std::sync::Arc;

/// The clips of a graph, all on the skeleton and at the frame rate of the first.
#[derive(Debug)]
pub struct GraphClips {
    names: Vec<String>,
    motions: Vec<Arc<Motion>>,
    retargeted: Vec<Option<Arc<RetargetReport>>>,
    set: Arc<FrameSet>,
    profile: WalkProfile,
    jolts: JoltSearch,
}

/// The number of frames of single joints that are measured in one slice.
const JOINT_FRAMES: usize = 12_000;

impl GraphClips {
    /// Returns the clips in order, not yet measured: call [`Self::advance`].
    pub(super) fn new(names: Vec<String>, fitted: Vec<FittedClip>) -> Result<Self, LabError> {
        let (motions, retargeted): (Vec<_>, Vec<_>) = fitted.into_iter().unzip();
        let first = motions.first().ok_or(LabError::NoGraphClips)?;
        let height = f64::from(first.roles().body_height(first.clip().skeleton()));
        let set = Arc::new(FrameSet::new(motions.clone(), height)?);
        let profile = WalkProfile::begun(Arc::clone(&set));
        Ok(Self { names, motions, retargeted, set, profile, jolts: JoltSearch::default() })
    }

    /// Measures a slice; returns `true` if nothing is left.
    pub(super) fn advance(&mut self) -> bool {
        let joints = (JOINT_FRAMES / self.set.frames().max(1)).max(1);
        self.profile.advance(joints) && self.jolts.advance(&self.set, JOINT_FRAMES)
    }

    /// Returns the names of the clips.
    #[must_use]
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// Returns the fitted clips.
    #[must_use]
    pub fn motions(&self) -> &[Arc<Motion>] {
        &self.motions
    }

    /// Returns the report on retargeting a clip; `None` if it has the skeleton of the first.
    #[must_use]
    pub fn retargeted(&self, clip: usize) -> Option<&Arc<RetargetReport>> {
        self.retargeted.get(clip)?.as_ref()
    }

    /// Returns the frames of all clips.
    #[must_use]
    pub fn set(&self) -> &Arc<FrameSet> {
        &self.set
    }

    pub(super) fn profile(&self) -> &WalkProfile {
        &self.profile
    }
}
