//! Gaits by speed: a walk and a run become every speed between, and a little beyond.
//!
//! # The idea
//!
//! One cycle of each gait, from one strike of the left foot to the next, is found by the contacts
//! of the feet and closed ([`GaitCycle`]); a clip that is one cycle, or most of one, is closed by
//! its own ends. Both are laid on one phase, so that strikes meet strikes and lifts meet lifts, and
//! blended pose by pose ([`SpeedBlend`]). Faster means two things at once, longer strides and more
//! of them:
//!
//! ```text
//! w = (v - v₁)/(v₂ - v₁)                    weight of the second gait
//! stride = (1 - w) v₁T₁ + w v₂T₂            T: the time of a cycle
//! T = stride / v
//! ```
//!
//! In a walk a foot lifts after the other one has struck, in a run before. No single phase fits
//! both legs, so each leg follows a clock of its own events ([`PhaseAlignment::Feet`]). Picture two
//! wheels with spokes of uneven spacing, bent until the spokes lie on each other. The way over the
//! ground is made of the cycles' own steps in the character's frame. [`SpeedPlayer`] lets the speed
//! be dragged while it plays: the phase goes on whatever the speed does.
//!
//! # Example
//!
//! ```
//! use segue_motion::blend::Source;
//! use segue_motion::clip::{ContactOptions, Contacts, character_frames, ground_speed};
//! use segue_motion::gait::{GaitCycle, SpeedBlend, SpeedOptions};
//! use segue_motion::skeleton::Roles;
//! use segue_motion::synth::{Action, Params, synthesize};
//! use std::sync::Arc;
//!
//! let mut cycles = Vec::new();
//! let mut roles = Roles::default();
//! for action in [Action::Walk, Action::Run] {
//!     let clip = Arc::new(synthesize(&Params::new(action))?.clip);
//!     roles = Roles::detect(clip.skeleton());
//!     let contacts = Contacts::detect(&clip, &roles, &ContactOptions::default());
//!     cycles.push(GaitCycle::find(&Source::new(clip, &roles), &roles, &contacts)?);
//! }
//! let blend = SpeedBlend::new(&cycles[0], &cycles[1], &roles, &SpeedOptions::default())?;
//! let jog = blend.cycle_at(2.5)?;
//! assert!(jog.facts.weight > 0.4 && jog.facts.weight < 0.6 && !jog.facts.extrapolated);
//! // What was asked for is made; its strides and its cadence lie between those of the gaits.
//! let measured = ground_speed(&character_frames(&jog.clip, &roles), jog.clip.fps());
//! assert!((measured - 2.5).abs() < 0.02 * 2.5);
//! let [walk, run] = blend.speeds_mps().map(|speed| blend.facts(speed));
//! assert!(walk.stride_m < jog.facts.stride_m && jog.facts.stride_m < run.stride_m);
//! assert!(walk.cadence_spm < jog.facts.cadence_spm && jog.facts.cadence_spm < run.cadence_spm);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Accuracy and cost
//!
//! From walk to run the measured speed is the one asked for to 2 %. At its own speed each gait
//! comes out as it is, to 1e-5 radians. A hundred cycles do not drift. Weights go from -0.25 to
//! 1.25; beyond the two gaits the result is marked as a guess. A pose is O(joints).
//!
//! # What it does not do
//!
//! Feet stand as well as a blend of two stances stands; [`foot_lock`](crate::transition::foot_lock)
//! with the contacts that come along cleans up the rest. Gaits need both feet in turn: whoever hops
//! on one leg, or crawls, has no cycle here.
//!
//! # Sources
//!
//! Blending two cycles by speed is a classic exercise of animation courses. How each leg gets a
//! clock of its own is told at [`PhaseAlignment`].

mod cycle;
mod phase;
mod player;
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

/// Why gaits cannot be blended by speed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum GaitError {
    /// The joints of a foot are not known.
    #[error("`{name}` has no joints that are known as its feet: choose these joints by hand")]
    NoFeet {
        /// Name of the clip.
        name: String,
    },
    /// No whole cycle, and no ends that meet.
    #[error(
        "`{name}` does not contain a gait cycle (left strike, right strike, left strike), and its {secs:.2} s do not close into one: use a longer walk or run, or one cycle whose end leads into its beginning"
    )]
    NoCycle {
        /// Name of the clip.
        name: String,
        /// Its duration, seconds.
        secs: f64,
    },
    /// The clips move different bodies.
    #[error("`{a}` and `{b}` move different skeletons: retarget one onto the other first")]
    Skeletons {
        /// Name of the first clip.
        a: String,
        /// Name of the second clip.
        b: String,
    },
    /// Nothing lies between the gaits.
    #[error(
        "the cycles of A and B move at {a_mps:.2} and {b_mps:.2} m/s: choose two clips that move, at speeds that differ by at least 0.1 m/s"
    )]
    Speeds {
        /// Speed of the first gait.
        a_mps: f64,
        /// Speed of the second gait.
        b_mps: f64,
    },
    /// A number that is none.
    #[error("a {what} of {value} cannot be used: give a number from 0 to {most}")]
    Option {
        /// Which number.
        what: &'static str,
        /// The number given.
        value: f64,
        /// The largest number.
        most: f64,
    },
    /// The cycle cannot be closed.
    #[error(transparent)]
    Loop(#[from] LoopError),
    /// The result is no clip.
    #[error(transparent)]
    Clip(#[from] ClipError),
}
