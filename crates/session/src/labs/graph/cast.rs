use crate::labs::LabError;
use crate::labs::Retargeted;
use segue_motion::clip::Motion;
use segue_motion::graph::{FrameSet, JoltSearch, WalkProfile};
use std::sync::Arc;

/// The clips of a graph, on the skeleton and at the rate of the first.
#[derive(Debug)]
pub struct Cast {
    names: Vec<String>,
    motions: Vec<Arc<Motion>>,
    retargeted: Vec<Option<Arc<Retargeted>>>,
    set: Arc<FrameSet>,
    profile: WalkProfile,
    jolts: JoltSearch,
}

/// So many frames of single joints are measured in one slice.
const JOINT_FRAMES: usize = 12_000;

/// A clip that was made ready for the others, and how it came onto their skeleton.
pub(super) type Fitted = (Arc<Motion>, Option<Arc<Retargeted>>);

impl Cast {
    /// The clips in order; the rest of what has to be known of them is found by [`Self::advance`].
    pub(super) fn new(names: Vec<String>, fitted: Vec<Fitted>) -> Result<Self, LabError> {
        let (motions, retargeted): (Vec<_>, Vec<_>) = fitted.into_iter().unzip();
        let first = motions.first().ok_or(LabError::NoGraphClips)?;
        let height = f64::from(first.roles().body_height(first.clip().skeleton()));
        let set = Arc::new(FrameSet::new(motions.clone(), height)?);
        let profile = WalkProfile::begun(Arc::clone(&set));
        Ok(Self { names, motions, retargeted, set, profile, jolts: JoltSearch::default() })
    }

    /// A slice of that; `true` when nothing is left.
    pub(super) fn advance(&mut self) -> bool {
        let joints = (JOINT_FRAMES / self.set.frames().max(1)).max(1);
        self.profile.advance(joints) && self.jolts.advance(&self.set, JOINT_FRAMES)
    }

    /// What the clips are called.
    #[must_use]
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// The clips, made ready.
    #[must_use]
    pub fn motions(&self) -> &[Arc<Motion>] {
        &self.motions
    }

    /// How a clip came onto the skeleton of the first; `None` where it is its own.
    #[must_use]
    pub fn retargeted(&self, clip: usize) -> Option<&Arc<Retargeted>> {
        self.retargeted.get(clip)?.as_ref()
    }

    /// Their frames.
    #[must_use]
    pub fn set(&self) -> &Arc<FrameSet> {
        &self.set
    }

    pub(super) fn profile(&self) -> &WalkProfile {
        &self.profile
    }
}
