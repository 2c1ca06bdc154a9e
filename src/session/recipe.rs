//! What is made from clips and parameters: inputs in, clip and numbers out.

use super::motion::Motion;
use crate::math::Planar;
use crate::metrics::Metric;
use std::sync::Arc;

mod blend;
mod layers;
mod make;
mod pair;

pub use blend::mistake_shows;
pub(super) use blend::{BlendInputs, Blender};
pub use layers::{LayerFacts, LayerFit};
pub(super) use layers::{LayerInputs, Layerer};
pub(super) use make::{made_id, made_motion, made_params, preset_motion, synth_action};
pub(super) use pair::{Pair, Pairs};

/// The two places that a clip can take.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Slot {
    /// What plays first; warm.
    A,
    /// What follows; cool.
    B,
}

impl Slot {
    /// The letter on screen.
    #[must_use]
    pub const fn label(self) -> &'static str {
        match self {
            Self::A => "A",
            Self::B => "B",
        }
    }
}

/// A clip that a result was made from, as it lies in the result's time and world.
#[derive(Clone, Debug)]
pub struct Source {
    /// Its slot.
    pub slot: Slot,
    /// The clip as it is in the library, on its own skeleton.
    pub motion: Arc<Motion>,
    /// The time in the result at which its first frame plays, seconds; negative when it is entered later than there.
    pub starts_at_secs: f64,
    /// Where it lies on the result's ground.
    pub world_from_clip: Planar,
}

/// Where one clip goes over into the other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transition {
    /// First time of the window in the result, seconds.
    pub start_secs: f64,
    /// Last time of the window in the result, seconds.
    pub end_secs: f64,
    /// Where A is left, seconds in A.
    pub leave_a_secs: f64,
    /// Where B is entered, seconds in B.
    pub enter_b_secs: f64,
    /// The window's length in frames of the result.
    pub window_frames: usize,
    /// How far apart the two windows are after the best alignment: root mean square per joint, centimetres at a body height of 1.75 m.
    pub distance_cm: f32,
}

/// How B came onto a skeleton that is not its own.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Retargeted {
    /// The joints of A's skeleton that nothing of B moves, by name, parents first: they keep their rest pose.
    pub unmatched: Vec<String>,
}

/// A result: a motion, and what is known about how it came to be.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// What plays.
    pub motion: Arc<Motion>,
    /// What it was made from; empty when it is a clip of the library itself.
    pub sources: Vec<Source>,
    /// Where the transition is; `None` where there is none.
    pub transition: Option<Transition>,
    /// How B came onto the skeleton of A; `None` where both have the same one.
    pub retargeted: Option<Arc<Retargeted>>,
    /// What of it is a layer; `None` where there is none.
    pub layer: Option<LayerFacts>,
    /// The artefacts, as numbers.
    pub metrics: Vec<Metric>,
}

impl Outcome {
    /// A result that is one clip as it is.
    pub(super) fn plain(motion: Arc<Motion>) -> Self {
        Self {
            motion,
            sources: Vec::new(),
            transition: None,
            retargeted: None,
            layer: None,
            metrics: Vec::new(),
        }
    }

    /// Seconds from the first frame to the last.
    #[must_use]
    pub fn duration_secs(&self) -> f64 {
        self.motion.clip.duration_secs()
    }
}
