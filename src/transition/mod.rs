//! Transitions that start at once, and clips that close into a cycle: inertialization, dead blending, loops, and the cut and the dissolve beside them.
//!
//! A dissolve plays two clips at once and looks like neither for its whole window. Inertialization plays only the new clip, from the first
//! frame on, and lets the *difference* to what was playing, in pose and in velocity, die away (Bollo 2018). [`concatenate`] is one entry point for
//! all of them, with one meaning of "leave" and "enter", so that they can be compared; [`Inertializer`] does it frame by frame for whoever
//! jumps while playing.

mod concatenate;
mod cut_points;
mod inertialize;
mod loop_curve;
mod loops;
mod moving;

pub use concatenate::{Method, TransitionOptions, concatenate};
pub use cut_points::{CutPoints, CycleSearch, find_cycle};
pub use inertialize::{Inertialization, Inertializer};
pub use loop_curve::{LoopCurve, LoopMethod};
pub use loops::{Loop, LoopError, LoopOptions, LoopSeam, close_loop};
pub use moving::MovingPose;
