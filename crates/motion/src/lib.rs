//! Character motion as plain data: clips, their skeletons, and algorithms that make new clips from
//! them.
//!
//! The library is pure and deterministic. It uses no screen, file system, clock or thread:
//! randomness comes from a seed, and time is a parameter. The crate `segue-formats` reads and
//! writes motion files; the app Segue is built on both.
//!
//! This documentation is also a small textbook. Each module is a chapter: the idea, the formula, an
//! example that runs, the accuracy and the cost, the limits, and the sources.
//!
//! # A first example
//!
//! The example blends a walk into a run and measures the result. [`synth`] makes both clips, so no
//! file is needed.
//!
//! ```
//! use segue_motion::blend::{DissolveOptions, dissolve};
//! use segue_motion::clip::Motion;
//! use segue_motion::metrics::TransitionMetrics;
//! use segue_motion::registration::{SearchOptions, best_transition, limb_weights};
//! use segue_motion::synth::{Action, Params, synthesize};
//!
//! // Analyse: joint roles, ground frames, foot contacts.
//! let walk = Motion::analyze(synthesize(&Params::new(Action::Walk))?.clip);
//! let run = Motion::analyze(synthesize(&Params::new(Action::Run))?.clip);
//!
//! // Align: find the half second of each clip that is most like one of the other.
//! let weights = limb_weights(walk.clip().skeleton());
//! let height = f64::from(walk.body_height());
//! let options = SearchOptions::new(30);
//! let found = best_transition(walk.clip(), run.clip(), &weights, height, &options)?;
//!
//! // Blend, and for comparison cut.
//! let blended = |window| {
//!     let options = DissolveOptions { window, ..DissolveOptions::default() };
//!     dissolve(&walk, found.leave, &run, found.enter, &options)
//! };
//!
//! // Measure: jumps of joints and character in a frame, beyond the usual.
//! let blend = TransitionMetrics::measure(&walk, &run, &blended(30)?);
//! let cut = TransitionMetrics::measure(&walk, &run, &blended(0)?);
//! assert!(cut.seam_deg.is_some_and(|jump| jump > 60.0));
//! assert!(blend.seam_deg.is_some_and(|jump| jump < 5.0));
//! assert!(blend.jump_cm.is_some_and(|jump| jump < 0.1));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Modules, in reading order
//!
//! Representation of motion:
//!
//! 1. [`math`]: rotations as vectors, rigid transforms of the ground, springs, curves.
//! 2. [`skeleton`]: joint trees, forward and two-bone inverse kinematics, joint roles, retargeting
//!    and mirroring.
//! 3. [`clip`]: poses over time: sampling, velocities, facing, foot contacts.
//! 4. [`synth`]: motions made from parameters, with ground truth.
//!
//! Combining clips:
//!
//! 5. [`registration`]: distances between windows, the best transition between two clips, time
//!    warps.
//! 6. [`blend`]: dissolves, registered blends, layers.
//! 7. [`transition`]: inertialization, dead blending, loops, foot locking.
//! 8. [`gait`]: every speed between a walk and a run.
//! 9. [`metrics`]: artefacts, as numbers with a unit.
//! 10. [`retarget`]: motions on other bodies, with the places of feet and hands.
//!
//! Applications:
//!
//! 11. [`graph`]: motion graphs, and walks through them.
//! 12. [`path`]: motion along an edited path.
//! 13. [`matching`]: motion matching for a steered character.
//! 14. [`points`]: skeletons from points: joint centres, optical markers.
//! 15. [`clean`]: faults of captured takes, found and mended.
//! 16. [`skin`]: a smooth mesh around any skeleton; linear blend and dual quaternion skinning.
//!
//! `tests/architecture.rs` in the workspace checks the dependencies between these modules:
//!
//! ```text
//! math ← skeleton ← clip ← synth, registration, points, skin
//! registration ← blend ← transition ← gait
//! blend ← metrics; metrics, transition ← retarget, clean
//! all of these ← graph, path, matching
//! ```
//!
//! # Conventions
//!
//! - *Units.* Metres, seconds, radians. A name has a suffix where a bare number could be something
//!   else (`dt_secs`, `rms_cm`, `spin_deg`). Rates are per second, at the clip's own frame rate.
//! - *Axes.* Right-handed, Y up. The ground is the plane `y = 0`. A character whose yaw is 0 faces
//!   +Z and has its left at +X; positive yaw turns it left (about +Y). A point on the ground is (x,
//!   z).
//! - *Rotations.* Quaternions are unit; `q` and `-q` are the same rotation, so every interpolation
//!   first brings both into one hemisphere.
//! - *Transforms* are named destination-from-source: `world_from_joint * point_in_joint`.
//!   `a_world_from_b_world` aligns clip B with clip A.
//! - *Skeletons* list parents first, so one pass from the front poses a body. In the rest pose
//!   every rotation is the identity.
//! - *Windows.* A transition leaves clip A at frame `i`, enters clip B at frame `j` and overlaps
//!   `k` frames: `A[i..i + k)` lies over `B[j..j + k)`, in search, blend and picture alike.
//! - *Numbers* of clips are stored in `f32`; long sums and ground frames are `f64`.
//! - *Long work* comes in slices: each call of `advance` does a part of it, so that the caller can
//!   return to its event loop in between.
//! - *Errors* are values that state the fault and the remedy. Nothing in a file or a link can make
//!   the library panic.

pub mod blend;
pub mod clean;
pub mod clip;
pub mod gait;
pub mod graph;
pub mod matching;
pub mod math;
pub mod metrics;
pub mod path;
pub mod points;
pub mod registration;
pub mod retarget;
pub mod skeleton;
pub mod skin;
pub mod synth;
pub mod transition;
