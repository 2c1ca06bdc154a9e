//! The frames of several clips.

use super::GraphError;
use crate::blend::check;
use crate::clip::{JoltScan, Motion, jolts};
use crate::registration::{DistanceMatrix, limb_weights};
use std::sync::{Arc, OnceLock};

/// A frame of one of the clips.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, serde::Serialize)]
pub struct Place {
    /// The clip's index in its [`FrameSet`].
    pub clip: usize,
    /// The frame of that clip.
    pub frame: usize,
}

/// Several clips of one skeleton at one frame rate, one after the other. Windows do not cross from
/// one clip into the next.
#[derive(Clone, Debug, PartialEq)]
pub struct FrameSet {
    clips: Vec<Arc<Motion>>,
    /// The number of each clip's first frame; then the number of all frames.
    starts: Vec<usize>,
    weights: Vec<f64>,
    body_height: f64,
    /// Per clip and frame, the jolts of the joints; computed on demand, or ahead by a
    /// [`JoltSearch`].
    jolts: Vec<OnceLock<Vec<f32>>>,
}

impl FrameSet {
    /// Returns the set of clips in this order; distances are scaled by `body_height` (metres,
    /// [`crate::skeleton::Roles::body_height`]).
    ///
    /// # Errors
    /// [`GraphError::NoClips`], or [`GraphError::Blend`] when a clip has another skeleton or frame
    /// rate, or no frames; [`GraphError::Setting`] for a height out of range.
    pub fn new(clips: Vec<Arc<Motion>>, body_height: f64) -> Result<Self, GraphError> {
        let first = clips.first().ok_or(GraphError::NoClips)?;
        for clip in &clips {
            check(first, 0, clip, 0, 0)?;
        }
        if !(0.01..=1_000.0).contains(&body_height) {
            return Err(GraphError::Setting {
                what: "a body height",
                value: body_height,
                least: 0.01,
                most: 1_000.0,
            });
        }
        let weights = limb_weights(first.clip().skeleton());
        let mut starts = vec![0];
        for clip in &clips {
            starts.push(starts.last().copied().unwrap_or(0) + clip.clip().frames());
        }
        Ok(Self { jolts: vec![OnceLock::new(); clips.len()], clips, starts, weights, body_height })
    }

    /// Returns the jolts of a clip's frames ([`jolts`]); empty for an unknown clip.
    pub(super) fn jolts(&self, clip: usize) -> &[f32] {
        match (self.jolts.get(clip), self.clips.get(clip)) {
            (Some(found), Some(source)) => found.get_or_init(|| jolts(source.clip())),
            _ => &[],
        }
    }

    /// Returns the clips.
    #[must_use]
    pub fn clips(&self) -> &[Arc<Motion>] {
        &self.clips
    }

    /// Returns one clip.
    #[must_use]
    pub fn clip(&self, clip: usize) -> Option<&Arc<Motion>> {
        self.clips.get(clip)
    }

    /// Returns the height of the body by which distances are scaled, metres.
    #[must_use]
    pub fn body_height(&self) -> f64 {
        self.body_height
    }

    /// Returns the number of frames of one clip; 0 for an unknown one.
    #[must_use]
    pub fn frames_of(&self, clip: usize) -> usize {
        self.clips.get(clip).map_or(0, |source| source.clip().frames())
    }

    /// Returns the number of frames of all clips together.
    #[must_use]
    pub fn frames(&self) -> usize {
        self.starts.last().copied().unwrap_or(0)
    }

    /// Returns the number of frames of the longest clip.
    #[must_use]
    pub fn longest(&self) -> usize {
        self.clips.iter().map(|source| source.clip().frames()).max().unwrap_or(0)
    }

    /// Returns the frame rate of all clips, frames per second.
    #[must_use]
    pub fn fps(&self) -> f64 {
        self.clips.first().map_or(1.0, |source| source.clip().fps())
    }

    /// Returns the weights of the joints.
    #[must_use]
    pub fn weights(&self) -> &[f64] {
        &self.weights
    }

    /// Returns the clip of a frame of the set, and its frame there.
    #[must_use]
    pub fn place(&self, frame: usize) -> Option<Place> {
        // Clips are not empty, so that no two start at the same number.
        let clip = self.starts.partition_point(|&start| start <= frame).checked_sub(1)?;
        (clip < self.clips.len()).then(|| Place { clip, frame: frame - self.starts[clip] })
    }

    /// Returns the number in the set of a clip's frame; `None` outside the clip.
    #[must_use]
    pub fn number(&self, place: Place) -> Option<usize> {
        (place.frame < self.frames_of(place.clip)).then(|| self.starts[place.clip] + place.frame)
    }

    /// Returns the number of the cut before a frame, or after the last one of its clip, counted
    /// over all clips; less than [`Self::cuts`].
    pub(super) fn cut(&self, place: Place) -> Option<usize> {
        (place.clip < self.clips.len() && place.frame <= self.frames_of(place.clip))
            .then(|| self.starts[place.clip] + place.clip + place.frame)
    }

    /// Returns the number of cuts.
    pub(super) fn cuts(&self) -> usize {
        self.frames() + self.clips.len()
    }

    /// Converts a distance in metres of the clips' own body to centimetres on the reference body,
    /// rounded to 0.001 cm, as it is shown, ordered, and compared with a threshold. A value within
    /// a last digit of the middle between two roundings may still be rounded either way, where the
    /// clips themselves differ by a last digit.
    #[must_use]
    pub(crate) fn rounded_cm(&self, rms_m: f32) -> f64 {
        (f64::from(rms_m) * self.cm_per_m() * 1_000.0).round() / 1_000.0
    }

    /// Returns centimetres on the reference body per metre of the clips' own.
    pub(super) fn cm_per_m(&self) -> f64 {
        DistanceMatrix::cm_scale(self.body_height)
    }
}

/// The computation of a set's jolts, which a search for minima needs, in slices. Otherwise the
/// search computes them, a whole clip at a time: 0.1 s for 30,000 frames of 31 joints.
#[derive(Clone, Debug, Default)]
pub struct JoltSearch {
    /// The next clip.
    clip: usize,
    begun: Option<JoltScan>,
}

impl JoltSearch {
    /// Processes about `joint_frames` more frames of single joints, at least one joint of one clip;
    /// returns `true` when nothing is left to do. Every call must be given the same set.
    pub fn advance(&mut self, set: &FrameSet, joint_frames: usize) -> bool {
        let (Some(source), Some(found)) = (set.clips.get(self.clip), set.jolts.get(self.clip))
        else {
            return true;
        };
        let clip = source.clip();
        let joints = (joint_frames / clip.frames().max(1)).max(1);
        let mut begun = self.begun.take().unwrap_or_else(|| JoltScan::new(clip));
        if begun.advance(clip, joints) {
            // A search may have computed the same values in the meantime.
            found.get_or_init(|| begun.finish());
            self.clip += 1;
        } else {
            self.begun = Some(begun);
        }
        self.clip >= set.clips.len()
    }
}
