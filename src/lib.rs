//! Segue's motion core: clips, the skeletons they move, and what is made from them.
//!
//! The core is pure and deterministic. It knows no screen, no file system, no clock and no threads: data goes in, data comes out, chance is
//! a seed and time is a parameter. The app (`src/main.rs`, feature `app`) is built on top of it.
//!
//! These pages are a small textbook as well. A module is a chapter: the idea, the formula, an example that runs, how exact it is and what it
//! costs, what it does not do, and whose work it stands on.
//!
//! # A first example
//!
//! A walk goes over into a run, the result is measured, and a file is written. [`synth`] makes both clips, so that the example needs no
//! file; [`formats::import`] would read them from one.
//!
//! ```
//! use segue::blend::{Concatenation, DissolveOptions, Source, dissolve};
//! use segue::clip::{Clip, ContactOptions, Contacts};
//! use segue::formats::{ImportOptions, bvh, import};
//! use segue::metrics::{Profile, Subject, TransitionMetrics};
//! use segue::registration::{SearchOptions, best_transition, limb_weights};
//! use segue::skeleton::Roles;
//! use segue::synth::{Action, Params, synthesize};
//! use std::sync::Arc;
//!
//! let walk = Arc::new(synthesize(&Params::new(Action::Walk))?.clip);
//! let run = Arc::new(synthesize(&Params::new(Action::Run))?.clip);
//! let roles = Roles::detect(walk.skeleton());
//!
//! // Align: where is half a second of the one most like half a second of the other?
//! let weights = limb_weights(walk.skeleton());
//! let height = f64::from(roles.body_height(walk.skeleton()));
//! let found = best_transition(&walk, &run, &weights, height, &SearchOptions::new(30))?;
//!
//! // Blend, and for comparison cut.
//! let profile = |clip: &Arc<Clip>| {
//!     let contacts = Contacts::detect(clip, &roles, &ContactOptions::default());
//!     Profile::new(Arc::new(Source::new(Arc::clone(clip), &roles)), &roles, contacts)
//! };
//! let (a, b) = (profile(&walk), profile(&run));
//! let blended = |window| {
//!     let options = DissolveOptions { window, ..DissolveOptions::default() };
//!     dissolve(a.source(), found.leave, b.source(), found.enter, &options)
//! };
//! let (blend, cut) = (blended(30)?, blended(0)?);
//!
//! // Measure: how far do joints and character jump in a frame, beyond what is usual?
//! let measured = |out: &Concatenation| {
//!     TransitionMetrics::measure(&Subject {
//!         result: &out.clip,
//!         start: out.transition.start,
//!         end: out.transition.end,
//!         handover: out.handover,
//!         enter: found.enter,
//!         a: &a,
//!         b: &b,
//!         roles: &roles,
//!         ground_m: 0.0,
//!     })
//! };
//! assert!(measured(&cut).seam_deg.is_some_and(|jump| jump > 60.0));
//! assert!(measured(&blend).seam_deg.is_some_and(|jump| jump < 5.0));
//! assert!(measured(&blend).jump_cm.is_some_and(|jump| jump < 0.1));
//!
//! // Export, and read it back.
//! let text = bvh::write(&blend.clip, &bvh::WriteOptions::default());
//! let back = import("walk_to_run.bvh", text.as_bytes(), &ImportOptions::default())?;
//! assert_eq!(back.clips[0].clip.frames(), blend.clip.frames());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # The chapters, in reading order
//!
//! What a motion is:
//!
//! 1. [`math`]: rotations as vectors, rigid transforms of the ground, springs, curves.
//! 2. [`skeleton`]: a tree of joints, where it puts them, what each is for; other bodies and mirror images.
//! 3. [`clip`]: poses over time; sampling, velocities, facing, feet on the ground.
//! 4. [`formats`]: BVH, ASF and AMC, glTF, CSV: from bytes to clips and back.
//! 5. [`synth`]: motions made from parameters, with the truth about them.
//!
//! How two become one:
//!
//! 6. [`registration`]: distances of windows, the best place to go over, timewarps.
//! 7. [`blend`]: the dissolve, registered blends, layers.
//! 8. [`transition`]: inertialization, dead blending, loops, planted feet.
//! 9. [`gait`]: a walk and a run become every speed between.
//! 10. [`metrics`]: what goes wrong, as numbers with a unit.
//!
//! What is built on that:
//!
//! 11. [`graph`]: motion graphs, and walks through them.
//! 12. [`path`]: the road is dragged, the character follows.
//! 13. [`matching`]: a character that is steered.
//! 14. [`skin`]: a smooth body around any skeleton, and two ways in which it follows.
//! 15. [`session`]: the document that holds all of it, and its commands.
//! 16. [`scene`]: what of it is to be seen.
//!
//! Who may use whom is held by a test (`tests/architecture.rs`), which reads the `use` lines:
//!
//! ```text
//! math ← skeleton ← clip ← formats, synth, registration
//! registration ← blend ← transition ← gait
//! blend ← metrics
//! all of these ← graph, path, matching ← session ← scene ← the app
//! ```
//!
//! # Conventions
//!
//! - *Units.* Metres, seconds, radians; a name says so where a bare number could be anything else (`dt_secs`, `rms_cm`, `spin_deg`). Every
//!   rate is per second at the clip's own frame rate.
//! - *Axes.* Right-handed, Y up. The ground is the plane `y = 0`. A character whose yaw is 0 faces +Z and has its left at +X; positive yaw
//!   turns it left (about +Y). A point of the ground is (x, z).
//! - *Rotations.* Quaternions are unit; `q` and `-q` are the same rotation, so everything that interpolates first brings both into one
//!   hemisphere.
//! - *Transforms* are named destination-from-source: `world_from_joint * point_in_joint`. `a_world_from_b_world` lays clip B on clip A.
//! - *Skeletons* list parents first: one pass from the front poses a body. At rest every rotation is the identity.
//! - *Windows.* A transition leaves clip A at frame `i`, enters clip B at frame `j` and overlaps `k` frames: `A[i..i + k)` lies over
//!   `B[j..j + k)`, in search, blend and picture alike.
//! - *Numbers* of clips are stored in `f32`; sums that run long, and frames on the ground, are `f64`.
//! - *Long work* comes in slices: an `advance` that does a part of it, so that the caller decides when to stop for a frame of the screen.
//! - *Errors* are values that say what was found and what would do. Nothing in a file or a link can make the library panic.

pub mod blend;
pub mod clip;
pub mod formats;
pub mod gait;
pub mod graph;
pub mod matching;
pub mod math;
pub mod metrics;
pub mod path;
pub mod registration;
pub mod scene;
pub mod session;
pub mod skeleton;
pub mod skin;
pub mod synth;
pub mod transition;
