//! The result of a lab: a motion, and facts about it.

use crate::metrics::{self, Metric, MetricId};
use crate::params::Key;
use segue_motion::clip::{Clip, Motion};
use segue_motion::gait::GaitFacts;
use segue_motion::math::Planar;
use segue_motion::metrics::{MotionTrace, ResultMetrics};
use segue_motion::retarget::{RetargetErrors, RetargetOptions};
use serde::{Deserialize, Serialize};
use std::any::Any;
use std::fmt;
use std::sync::Arc;

/// One of the two clips of a lab.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Slot {
    /// The clip that plays first; drawn in a warm colour.
    A,
    /// The clip that follows; drawn in a cool colour.
    B,
}

impl Slot {
    /// Returns the letter on screen.
    #[must_use]
    pub const fn label(self) -> &'static str {
        match self {
            Self::A => "A",
            Self::B => "B",
        }
    }

    /// Returns the parameter that names the clip in the slot.
    #[must_use]
    pub const fn key(self) -> Key {
        match self {
            Self::A => Key::A,
            Self::B => Key::B,
        }
    }
}

/// A clip that a result was made from, placed in the result's time and world.
#[derive(Clone, Debug)]
pub struct PlacedClip {
    /// Its slot.
    pub slot: Slot,
    /// The clip as it is in the library, on its own skeleton.
    pub motion: Arc<Motion>,
    /// The time in the result at which its first frame plays, seconds; negative if it is entered at
    /// a later frame.
    pub starts_at_secs: f64,
    /// Its placement on the result's ground.
    pub world_from_clip: Planar,
}

impl PlacedClip {
    pub(crate) fn new(
        slot: Slot,
        motion: &Arc<Motion>,
        starts_at_secs: f64,
        world_from_clip: Planar,
    ) -> Self {
        Self { slot, motion: Arc::clone(motion), starts_at_secs, world_from_clip }
    }
}

/// The transition from one clip to the other.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Transition {
    /// First time of the window in the result, seconds.
    pub start_secs: f64,
    /// Last time of the window in the result, seconds.
    pub end_secs: f64,
    /// The time at which A is left, seconds in A.
    pub leave_a_secs: f64,
    /// The time at which B is entered, seconds in B.
    pub enter_b_secs: f64,
    /// The window's length in frames of the result.
    pub window_frames: usize,
    /// The distance of the two windows after the best alignment: root mean square per joint,
    /// centimetres at a body height of 1.75 m.
    pub distance_cm: f32,
    /// The search for the place; `None` if it was not found by a search for the best match.
    pub search: Option<MatchSearch>,
}

/// A search for the frames at which A is left and B is entered.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct MatchSearch {
    /// Whether single poses were compared instead of windows.
    pub by_pose: bool,
    /// The length of the windows, frames.
    pub window_frames: usize,
    /// Whether the windows are shorter than asked for, because the clip ends soon after a frame
    /// that was set by hand.
    pub is_shortened: bool,
    /// Whether whole clips were searched, because half of one is too short for a window.
    pub is_widened: bool,
    /// The last times at which A can be left and B entered, seconds in each: a dissolve needs its
    /// window after both.
    pub latest_secs: [f64; 2],
}

/// A report on retargeting B.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RetargetReport {
    /// The joints of A's skeleton without a counterpart in B, by name, parents first: they keep
    /// their rest pose.
    pub unmatched: Vec<String>,
    /// The errors that remain; `None` where both bodies are one rig, which needs no weights.
    pub errors: Option<RetargetErrors>,
    /// The weights of feet and hands.
    pub options: RetargetOptions,
}

/// The cycle that a result repeats.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Cycle {
    /// The length of a cycle, seconds: a whole number of frames. The result is a whole number of
    /// cycles long, and its last frame has the pose of its first.
    pub secs: f64,
    /// The origin of the cycle.
    pub made: CycleMade,
}

/// The origin of a [`Cycle`].
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum CycleMade {
    /// Two gaits blended to a speed.
    Gait {
        /// Facts that follow from the speed of the result.
        facts: GaitFacts,
        /// The speed that was asked for, metres per second.
        asked_mps: f64,
        /// The speeds of A and B in the cycles that were cut from them, metres per second.
        clips_mps: [f64; 2],
        /// The beginnings and ends of these cycles, seconds in A and in B. A clip that is itself a
        /// cycle may end before its cycle does.
        cuts_secs: [[f64; 2]; 2],
    },
    /// A part of A whose ends were made to match.
    Cut {
        /// The beginning of the part, seconds in A.
        from_secs: f64,
        /// The end of the part, seconds in A.
        to_secs: f64,
        /// The distance of the bodies at both ends: root mean square per joint, centimetres at a
        /// body height of 1.75 m.
        distance_cm: f64,
    },
}

/// A result: a motion, and facts about its origin.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// The motion that plays.
    pub motion: Arc<Motion>,
    /// The clips that it was made from; empty if it is a clip of the library itself.
    pub sources: Vec<PlacedClip>,
    /// The transition in it; `None` if there is none.
    pub transition: Option<Transition>,
    /// The cycle that it repeats; `None` if it does not loop.
    pub cycle: Option<Cycle>,
    /// The retargeting of B to the skeleton of A; `None` if both have the same one.
    pub retargeted: Option<Arc<RetargetReport>>,
    /// Facts that are specific to its lab.
    pub facts: LabFacts,
    /// The artefact metrics: those of every lab, then those of its own.
    pub metrics: Vec<Metric>,
    /// The clips that it was made from, on its skeleton: only what exceeds them is an artefact.
    /// Empty for an unchanged clip.
    pub(crate) beside: Vec<Arc<Clip>>,
    /// The motion on which the metrics of every lab are measured.
    pub(crate) measured: MeasuredMotion,
    /// Whether these metrics are known.
    pub(crate) is_measured: bool,
}

/// A fact that is specific to one lab.
trait Fact: Any + fmt::Debug + Send + Sync {}

impl<T: Any + fmt::Debug + Send + Sync> Fact for T {}

/// The facts about a result that are specific to one lab, as a type of its own. The lab's file has
/// the method of [`Outcome`] that returns them.
#[derive(Clone, Debug, Default)]
pub struct LabFacts(Option<Arc<dyn Fact>>);

impl LabFacts {
    /// Wraps the facts of a lab.
    pub(crate) fn of<T: Any + fmt::Debug + Send + Sync>(facts: Arc<T>) -> Self {
        Self(Some(Arc::new(facts)))
    }

    /// Returns the facts, if they are of this type.
    pub(crate) fn get<T: Any>(&self) -> Option<&Arc<T>> {
        (&**self.0.as_ref()? as &dyn Any).downcast_ref()
    }
}

/// The motion on which artefact metrics are measured.
#[derive(Clone, Debug, Default)]
pub(crate) enum MeasuredMotion {
    /// The motion of the result.
    #[default]
    Motion,
    /// A clip that is shown elsewhere, or without its root motion.
    Clip(Arc<Clip>),
    /// A trace that was recorded while the result was made.
    Trace(Arc<MotionTrace>),
}

impl Outcome {
    /// Returns an outcome that is one unchanged clip.
    pub(crate) fn plain(motion: Arc<Motion>) -> Self {
        Self {
            motion,
            sources: Vec::new(),
            transition: None,
            cycle: None,
            retargeted: None,
            facts: LabFacts::default(),
            metrics: Vec::new(),
            beside: Vec::new(),
            measured: MeasuredMotion::Motion,
            is_measured: false,
        }
    }

    /// Returns whether the metrics of every lab apply but are not yet known.
    pub(crate) fn awaits_numbers(&self) -> bool {
        let common = metrics::of_result(&ResultMetrics::default(), 1.0);
        !self.is_measured
            && self.metrics.iter().zip(&common).filter(|(own, common)| own.id == common.id).count()
                == common.len()
    }

    /// Puts the metrics of every lab before those of its own; without values if they are not yet
    /// known.
    pub(crate) fn take_numbers(&mut self, found: Option<ResultMetrics>) {
        let fps = self.motion.clip().fps();
        let common = metrics::of_result(&found.unwrap_or_default(), fps);
        self.metrics.retain(|metric| common.iter().all(|other| other.id != metric.id));
        self.metrics.splice(..0, common);
        self.is_measured = found.is_some();
    }

    /// Returns a metric; `None` if the result has none of that name.
    #[must_use]
    pub fn metric(&self, id: MetricId) -> Option<Metric> {
        self.metrics.iter().copied().find(|metric| metric.id == id)
    }

    /// Returns the duration from the first frame to the last, seconds.
    #[must_use]
    pub fn duration_secs(&self) -> f64 {
        self.motion.clip().duration_secs()
    }

    /// Returns the time in the motion and the placement of the character at a time beyond the end
    /// of a looping result. A result that does not loop holds its last frame.
    pub(crate) fn around(&self, secs: f64) -> (f64, Planar) {
        let duration = self.duration_secs();
        if self.cycle.is_none() || duration <= 0.0 || secs.is_nan() || secs <= duration {
            return (secs, Planar::IDENTITY);
        }
        let rounds = (secs / duration).floor();
        let step = self.step(0.0, duration);
        let place = (0..rounds as usize).fold(Planar::IDENTITY, |place, _| place.after(&step));
        (secs - rounds * duration, place)
    }

    /// Returns the transform from the character's position at one time of the motion to that at
    /// another.
    pub(crate) fn step(&self, from_secs: f64, to_secs: f64) -> Planar {
        self.motion.standing_at(to_secs).after(&self.motion.standing_at(from_secs).inverse())
    }
}
