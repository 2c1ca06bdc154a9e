//! Transitions that start at once, and clips that close into a cycle: inertialization, dead
//! blending, loops, foot locking, and the cut and the dissolve in the same form.
//!
//! # The idea
//!
//! A dissolve plays two clips at once and looks like neither for its whole window. Inertialization
//! plays only the new clip, from the first frame on, and lets the *difference* to the old one, in
//! pose and in velocity, decay. Picture a passenger in a bus that brakes: the bus is the new
//! motion, and the lean of the passenger is the offset.
//!
//! ```text
//! x = log(q_old · q_new⁻¹),  v = ω_old - ω_new      at the seam, joint by joint; v for small x
//! q(t) = exp(decay(x, v; t)) · q_new(t)             decay: spring, cubic or quintic
//! ```
//!
//! [`concatenate()`] is one entry point for all methods, with one meaning of "leave" and "enter",
//! so that they can be compared; [`Inertializer`] does the same frame by frame during playback.
//! Dead blending extrapolates the old *pose* with decaying velocity, and fades from that to the new
//! clip: safer for poses that are far apart.
//!
//! [`close_loop`] makes a cycle: the difference between its ends, D in pose and V in velocity, is
//! removed on both sides, a share r at the head and the rest at the tail.
//!
//! ```text
//! offset(t) = decay(r X, r W; t) - decay((1 - r) X, -(1 - r) W; T - t)
//! ```
//!
//! With X = D and W = V, as is usual, each spring has `(1 + yT) e^(-yT)` of its offset left at the
//! other end; [`LoopCurve`] solves for the X and W that close exactly. [`find_cycle`] searches for
//! ends that differ little. [`foot_lock()`] plants feet that slide. [`concatenate_mistaken`] makes
//! the classic mistakes, one at a time.
//!
//! # Example
//!
//! ```
//! use segue_motion::clip::{Clip, Motion};
//! use segue_motion::math::Decay;
//! use segue_motion::synth::{Action, Params, synthesize};
//! use segue_motion::transition::{Inertialization, Method, TransitionOptions, concatenate};
//! use segue_motion::transition::{LoopCurve, LoopMethod, LoopOptions, close_loop};
//!
//! let a = Motion::analyze(synthesize(&Params::new(Action::Walk))?.clip);
//! let b = Motion::analyze(synthesize(&Params::new(Action::Run))?.clip);
//!
//! // The largest turn of a joint from the last frame of A to the next one.
//! let spring = Inertialization::Offset(Decay::Spring { half_life_secs: 0.15 });
//! let joined = |method| concatenate(&a, 100, &b, 20, &TransitionOptions::new(method));
//! let (smooth, cut) = (joined(Method::Inertialize(spring))?.clip, joined(Method::Cut)?.clip);
//! let step = |clip: &Clip| {
//!     let pairs = clip.rotations(99).iter().zip(clip.rotations(100));
//!     pairs.map(|(p, q)| p.angle_between(*q)).fold(0.0, f32::max)
//! };
//! assert!(step(&cut) > 1.0 && step(&smooth) < 0.1);
//! assert_eq!(smooth.pose(99), a.clip().pose(99));
//! assert_eq!(smooth.frames(), 100 + b.clip().frames() - 20);
//!
//! // A cycle of 55 frames whose ends are 84° apart; after closing nothing of that is left.
//! let cycle = close_loop(&b, 5..60, &LoopOptions::default())?;
//! assert!(cycle.before.turn_deg > 80.0 && cycle.seam.turn_deg < 1e-3);
//! assert_eq!(cycle.repeat(100)?.frames(), 5_500);
//! // In a cycle of half a second the classic method closes 86 % of the difference.
//! let share = |method| {
//!     let curve = LoopCurve::new(method, 0.5, 0.5);
//!     curve.at(0.0).xx - curve.at(0.5).xx
//! };
//! assert!((share(LoopMethod::Exact { half_life_secs: 0.2 }) - 1.0).abs() < 1e-12);
//! assert!((share(LoopMethod::Classic { half_life_secs: 0.2 }) - 0.86).abs() < 0.01);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Accuracy and cost
//!
//! Decaying rotations agree with `SciPy` to 2e-5 radians; velocities stay continuous over every
//! jump, even if the offset of the last one has not decayed yet (the quintic may brake hard: it
//! must not overshoot). Exact and cubic loops close to 0.001°, 0.1 °/s and 0.001 cm, and a hundred
//! cycles do not drift. The foot lock removes nine tenths of the slide from transitions between
//! synthesised walks and runs. Making a transition is O(frames × joints), searching for one more.
//!
//! # What it does not do
//!
//! Offsets do not take the body into account: between very different poses a limb may pass through
//! another. Inertialization plans nothing, so feet slide while the difference in speed decays. The
//! foot lock assumes one flat ground, and stretches no leg beyond its reach: a foot beyond that
//! slides.
//!
//! # Sources
//!
//! Bollo, "Inertialization: High-Performance Animation Transitions in Gears of War", GDC 2018.
//! Holden, "Spring-It-On", 2021; "Dead Blending", 2023; "Creating Looping Animations from Motion
//! Capture", 2022. Kovar, Gleicher, Pighin 2002 (the dissolve).

mod concatenate;
mod cut_points;
mod declared_cycle;
mod foot_lock;
mod inertialize;
mod limb;
mod loop_curve;
mod loops;
mod mistake;
mod moving;
mod whole_cycle;

pub use concatenate::{Method, TransitionOptions, concatenate};
pub use cut_points::{CutPoints, CycleFinder, CycleSearch, find_cycle};
pub use declared_cycle::treat_as_cycle;
pub use foot_lock::{FootLockError, FootLockOptions, FootLocking, foot_lock, has_legs};
pub(crate) use foot_lock::{anchor, envelope, hips};
pub use inertialize::{Inertialization, Inertializer};
pub(crate) use limb::{Flexion, Limb, LimbPose};
pub use loop_curve::{LoopCurve, LoopMethod};
pub use loops::{Loop, LoopError, LoopOptions, LoopSeam, close_loop, repeat_clip};
pub use mistake::{Mistake, concatenate_mistaken};
pub use moving::MovingPose;
pub use whole_cycle::WholeCycle;
