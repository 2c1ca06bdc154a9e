//! The result of a lab: a motion, and what is known about it.

use crate::params::Key;
use segue_motion::clip::{Clip, Motion};
use segue_motion::gait::GaitFacts;
use segue_motion::math::Planar;
use segue_motion::metrics::{Metric, MotionTrace, ResultMetrics};
use std::any::Any;
use std::fmt;
use std::sync::Arc;

/// The two places that a clip can take.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Slot {
    /// The first clip; warm.
    A,
    /// The second clip; cool.
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

    /// The parameter that says which clip is in it.
    #[must_use]
    pub const fn key(self) -> Key {
        match self {
            Self::A => Key::A,
            Self::B => Key::B,
        }
    }
}

/// A clip that a result was made from, as it lies in the result's time and world.
#[derive(Clone, Debug)]
pub struct PlacedClip {
    /// Its slot.
    pub slot: Slot,
    /// The clip as it is in the library, on its own skeleton.
    pub motion: Arc<Motion>,
    /// The time in the result at which its first frame plays, seconds; negative when it is entered
    /// later than there.
    pub starts_at_secs: f64,
    /// Where it lies on the result's ground.
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
    /// How far apart the two windows are after the best alignment: root mean square per joint,
    /// centimetres at a body height of 1.75 m.
    pub distance_cm: f32,
    /// How the place was searched for; `None` where no search for the best match found it.
    pub search: Option<MatchSearch>,
}

/// How the frames at which A is left and B is entered were compared.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MatchSearch {
    /// Whether single poses were compared, and not windows.
    pub by_pose: bool,
    /// Frames of the windows.
    pub window_frames: usize,
    /// The windows are shorter than asked for: behind a frame set by hand no more is left of its
    /// clip.
    pub is_shortened: bool,
    /// A clip is too short for its half to hold a window behind it: all of it was searched.
    pub is_widened: bool,
    /// The last times at which A can be left and B entered, seconds in each: a dissolve needs its
    /// window behind both.
    pub latest_secs: [f64; 2],
}

/// How B came onto a skeleton that is not its own.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Retargeted {
    /// The joints of A's skeleton that nothing of B moves, by name, parents first: they keep their
    /// rest pose.
    pub unmatched: Vec<String>,
}

/// The cycle of a result that loops.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cycle {
    /// How long one takes, seconds: a whole number of frames. The result is a whole number of
    /// cycles long, and its last frame has the pose of its first.
    pub secs: f64,
    /// What it was made of.
    pub made: CycleMade,
}

/// How a [`Cycle`] came to be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CycleMade {
    /// Two gaits at a speed.
    Gait {
        /// What goes with the speed that was made.
        facts: GaitFacts,
        /// The speed that was asked for, metres per second.
        asked_mps: f64,
        /// How fast A and B go in the cycles that were taken of them, metres per second.
        clips_mps: [f64; 2],
        /// Where these cycles begin and end, seconds in A and in B. A clip that is closed by its
        /// own ends may end before its cycle does.
        cuts_secs: [[f64; 2]; 2],
    },
    /// A part of A whose ends were brought together.
    Cut {
        /// Where it begins, seconds in A.
        from_secs: f64,
        /// Where it is over, seconds in A.
        to_secs: f64,
        /// How far apart the bodies at both ends are: root mean square per joint, centimetres at a
        /// body height of 1.75 m.
        distance_cm: f64,
    },
}

/// A result: a motion, and what is known about how it came to be.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// The motion that plays.
    pub motion: Arc<Motion>,
    /// What it was made from; empty when it is a clip of the library itself.
    pub sources: Vec<PlacedClip>,
    /// Where the transition is; `None` where there is none.
    pub transition: Option<Transition>,
    /// The cycle in which it loops; `None` where it has an end.
    pub cycle: Option<Cycle>,
    /// How B came onto the skeleton of A; `None` where both have the same one.
    pub retargeted: Option<Arc<Retargeted>>,
    /// What only its lab knows of it.
    pub facts: LabFacts,
    /// The artefacts, as numbers: those that every lab has, and its own behind them.
    pub metrics: Vec<Metric>,
    /// The clips that it is made of, on its skeleton: only what exceeds them is an artefact. None
    /// for a clip as it is.
    pub(crate) beside: Vec<Arc<Clip>>,
    /// The motion that the metrics of every lab are measured of.
    pub(crate) measured: Measured,
    /// Those numbers are known.
    pub(crate) is_measured: bool,
}

/// A value that one lab alone knows of its results.
trait Fact: Any + fmt::Debug + Send + Sync {}

impl<T: Any + fmt::Debug + Send + Sync> Fact for T {}

/// What one lab alone knows of a result, as a type of its own. The lab's file has the method of
/// [`Outcome`] that returns it.
#[derive(Clone, Debug, Default)]
pub struct LabFacts(Option<Arc<dyn Fact>>);

impl LabFacts {
    /// Takes the facts of a lab.
    pub(crate) fn of<T: Any + fmt::Debug + Send + Sync>(facts: Arc<T>) -> Self {
        Self(Some(Arc::new(facts)))
    }

    /// Returns the facts, where they are of this type.
    pub(crate) fn get<T: Any>(&self) -> Option<&Arc<T>> {
        (&**self.0.as_ref()? as &dyn Any).downcast_ref()
    }
}

/// The motion that the metrics of every lab are measured of.
#[derive(Clone, Debug, Default)]
pub(crate) enum Measured {
    /// Its motion.
    #[default]
    Motion,
    /// A clip that is shown elsewhere, or without its way over the ground.
    Clip(Arc<Clip>),
    /// What was taken of it while it was made.
    Trace(Arc<MotionTrace>),
}

impl Outcome {
    /// A result that is one clip as it is.
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
            measured: Measured::Motion,
            is_measured: false,
        }
    }

    /// Returns whether there are rows for the metrics of every lab, and not yet their values.
    pub(crate) fn awaits_numbers(&self) -> bool {
        let common = ResultMetrics::default().list();
        !self.is_measured
            && self.metrics.iter().zip(&common).filter(|(own, common)| own.id == common.id).count()
                == common.len()
    }

    /// Puts the numbers that every lab has before its own; without a value where they are not known
    /// yet.
    pub(crate) fn take_numbers(&mut self, found: Option<ResultMetrics>) {
        let common = found.unwrap_or_default().list();
        self.metrics.retain(|metric| common.iter().all(|other| other.id != metric.id));
        self.metrics.splice(..0, common);
        self.is_measured = found.is_some();
    }

    /// Seconds from the first frame to the last.
    #[must_use]
    pub fn duration_secs(&self) -> f64 {
        self.motion.clip().duration_secs()
    }

    /// Returns where a result that loops is at a time beyond its end: the time in its motion, and
    /// the place of that. A result that has an end stays as it is.
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

    /// Returns the step of the character from one time of the motion to another.
    pub(crate) fn step(&self, from_secs: f64, to_secs: f64) -> Planar {
        self.motion.standing_at(to_secs).after(&self.motion.standing_at(from_secs).inverse())
    }
}
