//! The body that all clips of a corpus share, and clips on it.

use crate::{CorpusError, PlaceError};
use segue_motion::clip::{Clip, Contacts, Interpolation, Motion, resample};
use segue_motion::matching::{FeatureOptions, Layout, RATE, feature_rows};
use segue_motion::retarget::{RetargetOptions, TargetBody, retarget_motion};
use segue_motion::skeleton::{Roles, Skeleton};
use segue_motion::synth::humanoid;
use std::sync::Arc;

/// Frame rate of poses, frames per second.
pub const POSE_FPS: usize = 30;
/// The number of frames of poses from one row of features to the next: ten rows a second.
pub const FEATURE_STEP: usize = 3;
/// The height of the standard body, metres.
const HEIGHT_M: f32 = 1.75;
/// The greatest duration of a clip, seconds: at the rate of matching it then takes 170 MB.
const MAX_SECS: f64 = 7_200.0;
/// The number of frames at the rate of matching from one frame of poses to the next.
const RATIO: usize = RATE / POSE_FPS;

/// The standard body.
#[derive(Clone, Debug)]
pub struct StandardBody {
    target: TargetBody,
    layout: Layout,
}

/// A clip on the standard body.
#[derive(Clone, Debug)]
pub struct PlacedClip {
    /// The clip, at [`POSE_FPS`].
    pub clip: Arc<Clip>,
    /// The contacts of its feet.
    pub contacts: Contacts,
    /// Raw features of every [`FEATURE_STEP`]th frame whose trajectory lies inside the clip.
    pub features: Vec<f32>,
}

impl StandardBody {
    /// Returns the standard body.
    ///
    /// # Errors
    /// [`CorpusError::Body`], [`CorpusError::Features`] if the libraries below do not make it.
    pub fn new() -> Result<Self, CorpusError> {
        let skeleton = humanoid(HEIGHT_M)?;
        let roles = Roles::detect(&skeleton);
        let layout = Layout::new(&FeatureOptions::default())?;
        Ok(Self { target: TargetBody::at_rest(&skeleton, &roles), layout })
    }

    /// Returns its skeleton.
    #[must_use]
    pub fn skeleton(&self) -> &Arc<Skeleton> {
        self.target.skeleton()
    }

    /// Returns the roles of its joints.
    #[must_use]
    pub fn roles(&self) -> &Roles {
        self.target.roles()
    }

    /// Returns the layout of features.
    #[must_use]
    pub fn layout(&self) -> &Layout {
        &self.layout
    }

    /// Puts a motion on the body: it is resampled to the rate of matching, retargeted, and every
    /// second frame is kept. A clip of less than a second has no features.
    ///
    /// # Errors
    /// [`PlaceError`] if it is empty, too long, not finite, that of a body on four legs, or no part
    /// of it corresponds to the body.
    pub fn place(&self, motion: &Motion) -> Result<PlacedClip, PlaceError> {
        let own = motion.clip();
        let secs = own.duration_secs();
        if own.frames() == 0 {
            return Err(PlaceError::Empty);
        }
        if motion.roles().is_quadruped() {
            return Err(PlaceError::FourLegs);
        }
        if !(0.0..=MAX_SECS).contains(&secs) {
            return Err(PlaceError::TooLong { secs, max_secs: MAX_SECS });
        }
        let fine = resample(own, RATE as f64, Interpolation::Cubic)?;
        let fine = Motion::with_roles(fine, motion.roles());
        let made = retarget_motion(&fine, &self.target, &RetargetOptions::default())?.clip;
        let is_finite = made.root_translations().iter().all(|root| root.is_finite())
            && (0..made.frames())
                .all(|frame| made.rotations(frame).iter().all(|rotation| rotation.is_finite()));
        if !is_finite {
            return Err(PlaceError::NotFinite);
        }
        let step = RATIO * FEATURE_STEP;
        let features = feature_rows(&made, self.roles(), &self.layout, step)?;
        let made = Motion::with_roles(made, self.roles());
        let kept: Vec<usize> = (0..made.clip().frames()).step_by(RATIO).collect();
        let contacts = made.contacts().of_frames(&kept);
        let poses = kept.iter().map(|&frame| made.clip().pose(frame));
        let skeleton = Arc::clone(self.skeleton());
        let clip = Clip::from_poses(own.name(), skeleton, POSE_FPS as f64, poses)?;
        Ok(PlacedClip { clip: Arc::new(clip), contacts, features })
    }
}
