//! Transitions that start at once, and clips that close into a cycle: inertialization, dead blending, loops, and the cut and the dissolve beside them.
//!
//! A dissolve plays two clips at once and looks like neither for its whole window. Inertialization plays only the new clip, from the first
//! frame on, and lets the *difference* to what was playing, in pose and in velocity, die away (Bollo 2018). [`concatenate`] is one entry point for
//! all of them, with one meaning of "leave" and "enter", so that they can be compared; [`Inertializer`] does it frame by frame for whoever
//! jumps while playing. [`close_loop`] spreads the difference between the ends of a clip over it, and [`find_cycle`] finds ends that differ little.
//!
//! What goes wrong when a step of it is forgotten can be seen: [`concatenate_mistaken`] makes the classic mistakes, one at a time.
//!
//! Feet that stood still may slide while an offset dies away, or two clips are mixed: [`foot_lock`] plants them again.
//!
//! ```
//! use segue::blend::Source;
//! use segue::math::Decay;
//! use segue::skeleton::Roles;
//! use segue::synth::{Action, Params, synthesize};
//! use segue::transition::{Inertialization, LoopOptions, Method, TransitionOptions, close_loop, concatenate};
//! use std::sync::Arc;
//!
//! let [walk, run] = [Action::Walk, Action::Run].map(|action| synthesize(&Params::new(action)));
//! let (walk, run) = (Arc::new(walk?.clip), Arc::new(run?.clip));
//! let roles = Roles::detect(walk.skeleton());
//! let (a, b) = (Source::new(walk, &roles), Source::new(run, &roles));
//!
//! let spring = Inertialization::Offset(Decay::Spring { half_life_secs: 0.15 });
//! let out = concatenate(&a, 100, &b, 20, &TransitionOptions::new(Method::Inertialize(spring)))?;
//! assert_eq!(out.clip.pose(99), a.clip().pose(99));
//! assert_eq!(out.clip.frames(), 100 + b.clip().frames() - 20);
//!
//! let cycle = close_loop(&b, 5..60, &LoopOptions::default())?;
//! assert!(cycle.before.turn_deg > 1.0 && cycle.seam.turn_deg < 1e-3);
//! assert_eq!(cycle.repeat(100)?.frames(), 5_500);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod concatenate;
mod cut_points;
mod foot_lock;
mod inertialize;
mod loop_curve;
mod loops;
mod mistake;
mod moving;

pub use concatenate::{Method, TransitionOptions, concatenate};
pub use cut_points::{CutPoints, CycleSearch, find_cycle};
pub(crate) use foot_lock::Leg;
pub use foot_lock::{FootLockError, FootLockOptions, FootLocking, foot_lock};
pub use inertialize::{Inertialization, Inertializer};
pub use loop_curve::{LoopCurve, LoopMethod};
pub use loops::{Loop, LoopError, LoopOptions, LoopSeam, close_loop, play_around};
pub use mistake::{Mistake, concatenate_mistaken};
pub use moving::MovingPose;
