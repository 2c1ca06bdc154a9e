//! Cleaning: faults of a captured take, found and mended.
//!
//! # The idea
//!
//! A take is compared with itself. What a joint usually does from one frame to the next says what
//! it cannot do: a step that departs from the steps around it by many times the usual departure is
//! no movement. Two such steps with a smooth way between their outer ends are a *spike*; where the
//! motion goes on, turned, they are a *flip*; where it is the other side's motion, a *swap*; where
//! nothing moved before the step, a *gap*.
//!
//! | fault | seen by | mend |
//! |---|---|---|
//! | swap | a step of several joints that exchanging left and right explains | exchanged back |
//! | gap | equal frames, then a jump that makes up for them | a cubic between both sides |
//! | spike, flip | steps beyond the usual, and back | a cubic; the turn is taken out |
//! | jitter | fourth differences as large as those of noise | zero-phase low-pass |
//! | drift | planted feet that all move or turn alike | moved back evenly |
//! | ground | planted feet above or below it, or rising evenly | levelled |
//! | ends | a T-pose in front of the motion; standing still | cut off |
//! | skating | planted feet that slide | foot lock |
//! | rate | gravity in flights, or the length and frequency of steps | told, not mended |
//!
//! Each [`Fault`] has its frames, joints, size and confidence. [`mend`] takes the faults that are
//! to go and leaves the others.
//!
//! # Example
//!
//! ```
//! use segue_motion::clean::{MendOptions, damage, find_faults, mend};
//! use segue_motion::clip::Motion;
//! use segue_motion::synth::{Action, Params, synthesize};
//! use std::sync::Arc;
//!
//! let walk = Motion::analyze(synthesize(&Params::new(Action::Walk))?.clip);
//! let spoilt = damage(walk.clip(), walk.roles(), 2, 1)?;
//! let motion = Arc::new(Motion::analyze(spoilt.clip));
//!
//! let faults = find_faults(&motion);
//! assert_eq!(faults.len(), 2);
//! let all: Vec<_> = faults.iter().collect();
//! let mended = mend(&motion, &all, &MendOptions::default())?;
//! assert!(find_faults(&mended.motion).is_empty());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Accuracy and cost
//!
//! `cargo xtask clean-quality` puts faults into takes and counts what is found. The search is
//! O(frames × joints), in slices ([`FaultSearch`]).
//!
//! # What it does not do
//!
//! It has no model of the body: a fault that is smooth, as a knee that bends sideways, is not seen.
//! A swap is an exchange of rotations; rigs whose left and right axes mirror each other show
//! swapped markers in another way. A swap that lasts for more than half of a take is taken for the
//! truth.
//!
//! # Sources
//!
//! Zero-phase filter and choice of the cut-off: Winter, "Biomechanics and Motor Control of Human
//! Movement", 4th ed., section 3.4.4. Noise by differences: Gasser, Sroka, Jennen-Steinmetz,
//! "Residual variance and residual pattern in nonlinear regression", 1986. Slope of the ground:
//! Sen, "Estimates of the regression coefficient based on Kendall's tau", 1968. Frequency of steps:
//! Sekiya et al., "The invariant relationship between step length and step rate", 1996.

mod damage;
mod ends;
mod fault;
mod finder;
mod footing;
mod gaps;
mod jitter;
mod mend;
#[cfg(test)]
mod quadruped_tests;
mod rate;
mod spikes;
mod steps;
mod swaps;
mod tracks;

pub use damage::{Damage, Damaged, damage, false_alarms};
pub use ends::first_frame_is_t_pose;
pub use fault::{Fault, FaultKind, SizeUnit};
pub use finder::{FaultSearch, find_faults};
pub use mend::{MendError, MendOptions, Mended, Mending, mend};
