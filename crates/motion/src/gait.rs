//! Blending of two gait cycles by speed: every speed between a walk and a run, and a little beyond.
//!
//! # The idea
//!
//! One cycle of each gait, from one strike of the left foot to the next, is found by the contacts
//! of the feet and closed ([`GaitCycle`]); a clip that is one cycle, or most of one, is closed at
//! its own ends. Both are aligned in phase, so that strikes meet strikes and lifts meet lifts, and
//! blended pose by pose ([`SpeedBlend`]). Going faster means two things at once, longer strides and
//! more of them:
//!
//! ```text
//! w = (v - v₁)/(v₂ - v₁)                    weight of the second gait
//! stride = (1 - w) v₁T₁ + w v₂T₂            T: the time of a cycle
//! T = stride / v
//! ```
//!
//! In a walk a foot lifts after the other one has struck, in a run before. No single phase fits
//! both legs, so each leg has a phase of its own, from its own events ([`PhaseAlignment::Feet`]).
//! Picture two wheels with spokes of uneven spacing, bent until the spokes coincide. The trajectory
//! over the ground is made of the cycles' own steps in the character's frame. [`SpeedPlayer`] lets
//! the speed change during playback: the phase is continuous at any change of speed.
//!
//! # Example
//!
//! ```
//! use segue_motion::clip::{Motion, ground_speed};
//! use segue_motion::gait::{GaitCycle, SpeedBlend, SpeedOptions};
//! use segue_motion::synth::{Action, Params, synthesize};
//!
//! let walk = Motion::analyze(synthesize(&Params::new(Action::Walk))?.clip);
//! let run = Motion::analyze(synthesize(&Params::new(Action::Run))?.clip);
//! let cycles = [GaitCycle::find(&walk)?, GaitCycle::find(&run)?];
//! let blend = SpeedBlend::new(&cycles[0], &cycles[1], walk.roles(), &SpeedOptions::default())?;
//! let jog = blend.cycle_at(2.5)?;
//! assert!(jog.facts.weight > 0.4 && jog.facts.weight < 0.6 && !jog.facts.extrapolated);
//! // The speed is the one asked for; strides and cadence lie between those of the gaits.
//! let jog_motion = Motion::analyze(jog.clip.clone());
//! let measured = ground_speed(jog_motion.ground_frames(), jog.clip.fps());
//! assert!((measured - 2.5).abs() < 0.02 * 2.5);
//! let [walk, run] = blend.speeds_mps().map(|speed| blend.facts(speed));
//! assert!(walk.stride_m < jog.facts.stride_m && jog.facts.stride_m < run.stride_m);
//! assert!(walk.cadence_spm < jog.facts.cadence_spm && jog.facts.cadence_spm < run.cadence_spm);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Accuracy and cost
//!
//! From walk to run the measured speed is the one asked for to 2 %. At its own speed each gait is
//! reproduced to 1e-5 radians. A hundred cycles do not drift. Weights go from -0.25 to 1.25;
//! outside of 0 to 1 the result is marked as extrapolated. A pose is O(joints).
//!
//! # What it does not do
//!
//! A blend of two stances may slide; [`foot_lock`](crate::transition::foot_lock) with the contacts
//! that come with the result cleans that up. Gaits need both feet in turn: hopping on one leg and
//! crawling have no cycle here.
//!
//! # Sources
//!
//! Blending two cycles by speed is a classic exercise of animation courses. [`PhaseAlignment`]
//! documents the phase of each leg.

mod cycle;
mod phase;
mod player;
#[cfg(test)]
mod quadruped_tests;
mod speed;
mod strikes;

pub use cycle::GaitCycle;
pub(crate) use cycle::events_of;
pub use phase::{Events, PhaseAlignment};
pub use player::SpeedPlayer;
pub use speed::{GaitClip, GaitFacts, SpeedBlend, SpeedOptions};
pub use strikes::strike_phases;

use crate::clip::ClipError;
use crate::transition::LoopError;

/// Error blending gaits by speed.
#[derive(Clone, Debug, PartialEq, thiserror::Error, segue_text::ToMessage)]
pub enum GaitError {
    /// The joints of a foot are unknown.
    #[error("`{name}` has no joints that are known as its feet: set its body parts")]
    NoFeet {
        /// Name of the clip.
        name: String,
    },
    /// The clip has no whole cycle, and its ends do not meet.
    #[error(
        "`{name}` does not contain a gait cycle (left strike, right strike, left strike), and its {secs:.2} s do not close into one: use a longer walk or run, or treat it as a loop"
    )]
    NoCycle {
        /// Name of the clip.
        name: String,
        /// Its duration, seconds.
        secs: f64,
    },
    /// The clips have different skeletons.
    #[error("`{a}` and `{b}` move different skeletons: retarget one onto the other first")]
    Skeletons {
        /// Name of the first clip.
        a: String,
        /// Name of the second clip.
        b: String,
    },
    /// The speeds of the gaits are too close to each other, or one is 0.
    #[error(
        "the cycles of A and B move at {a_mps:.2} and {b_mps:.2} m/s: choose two clips that move, at speeds that differ by at least 0.1 m/s"
    )]
    Speeds {
        /// Speed of the first gait.
        a_mps: f64,
        /// Speed of the second gait.
        b_mps: f64,
    },
    /// A number out of range.
    #[error("a {what} of {value} cannot be used: give a number from 0 to {most}")]
    Option {
        /// Name of the number.
        what: &'static str,
        /// The number given.
        value: f64,
        /// The largest number.
        most: f64,
    },
    /// The cycle cannot be closed.
    #[error(transparent)]
    Loop(#[from] LoopError),
    /// The result is not a valid clip.
    #[error(transparent)]
    Clip(#[from] ClipError),
}
