//! Gaits by speed: a walk and a run become every speed between, and a little beyond.
//!
//! One cycle of each gait, from one strike of the left foot to the next, is found by the contacts of the feet and closed ([`GaitCycle`]). Both are laid
//! on one phase, so that strikes meet strikes and lifts meet lifts, and blended pose by pose ([`SpeedBlend`]): with speeds `v₁` and
//! `v₂` the weight of the second is `w = (v - v₁)/(v₂ - v₁)`, the stride `(1 - w) v₁T₁ + w v₂T₂`, and the time of a cycle that stride over `v`. The way
//! over the ground is made of the cycles' own steps in the character's frame.
//!
//! What it does not do: feet stand as well as a blend of two stances stands; [`foot_lock`](crate::transition::foot_lock) with the
//! contacts that come along cleans up the rest.
//!
//! ```
//! use segue::blend::Source;
//! use segue::clip::{ContactOptions, Contacts};
//! use segue::gait::{GaitCycle, SpeedBlend, SpeedOptions};
//! use segue::skeleton::Roles;
//! use segue::synth::{Action, Params, synthesize};
//! use std::sync::Arc;
//!
//! let mut cycles = Vec::new();
//! let mut roles = Roles::default();
//! for action in [Action::Walk, Action::Run] {
//!     let clip = Arc::new(synthesize(&Params::new(action))?.clip);
//!     roles = Roles::detect(clip.skeleton());
//!     let contacts = Contacts::detect(&clip, &roles, &ContactOptions::default());
//!     cycles.push(GaitCycle::find(&Source::new(clip, &roles), &contacts)?);
//! }
//! let blend = SpeedBlend::new(&cycles[0], &cycles[1], &roles, &SpeedOptions::default())?;
//! let jog = blend.cycle_at(2.5)?;
//! assert!((jog.facts.speed_mps - 2.5).abs() < 0.01 && jog.facts.weight > 0.4 && !jog.facts.extrapolated);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod cycle;
mod phase;
mod player;
mod speed;
mod strikes;

pub use cycle::GaitCycle;
pub use phase::{Events, PhaseAlignment};
pub use player::SpeedPlayer;
pub use speed::{GaitClip, GaitFacts, SpeedBlend, SpeedOptions};
pub use strikes::strike_phases;

use crate::clip::ClipError;
use crate::transition::LoopError;

/// Why gaits cannot be blended by speed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum GaitError {
    /// No whole cycle.
    #[error(
        "`{name}` has no whole cycle, from one strike of the left foot to the next with one of the right foot between: use a longer walk or run"
    )]
    NoCycle {
        /// Name of the clip.
        name: String,
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
    #[error("the gaits go at {a_mps:.2} and {b_mps:.2} m/s: for speeds between them take two that differ by 0.1 m/s or more, and move")]
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
