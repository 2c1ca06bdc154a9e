//! Clips: poses over time, and everything that is derived from a single clip: sampling, speed,
//! facing, foot contacts.
//!
//! # The idea
//!
//! A [`Clip`] is a table: a row for every frame, a column for every joint, a local rotation in each
//! cell, and beside it the root's trajectory in the world. Everything else is derived from the
//! table:
//!
//! ```text
//! pose(t)       between frames ⌊t·fps⌋ and the next: positions lerp, rotations slerp
//! velocity(f)   (x[f + 1] - x[f - 1]) / 2dt        angular: log(q[f + 1] · q[f - 1]⁻¹) / 2dt
//! facing        across × up, across = from right to left over hips and shoulders;
//!               of a body on four legs, from hips to shoulders
//! speed         length of the root's trajectory over the ground / duration
//! ```
//!
//! Facing is computed from joint positions, never from an Euler angle, which can jump where the
//! body does not. Position and facing together are the character's ground frame
//! ([`character_frames`]), in which poses are blended and matched.
//!
//! The first joint is the carrier of the body: the joint at which legs and trunk meet. Files may
//! have joints above it, such as a root that stands still or moves over the ground. On import these
//! are folded into the carrier ([`Clip::folded`]); they are restored when the clip is written
//! ([`Clip::unfolded`]). A lever between root and hips would otherwise be blended by its angles,
//! and swing the body.
//!
//! [`Contacts`] hold the frames in which a foot is on the ground: it is low *and* slow. Each limit
//! has hysteresis, one value to enter contact and a looser one to leave it: about a single limit a
//! trembling foot would flicker. [`ContactCorrections`] overrule it where it errs.
//!
//! A [`Motion`] is edited as a whole: a part of it ([`Motion::cropped`]), backwards
//! ([`Motion::reversed`]), from left to right ([`Motion::mirrored`]), at another frame rate
//! ([`Motion::resampled`]), larger or smaller ([`Motion::scaled`]), elsewhere on the ground
//! ([`Motion::moved`]). Contacts, ground frames and seams follow exactly, frame by frame: what was
//! corrected by hand stays corrected.
//!
//! The root motion of a clip that moves in place ([`take_in_place`]) follows from its feet: a
//! standing foot moves backward under the body, and [`root_motion_from_feet`] integrates this
//! motion.
//!
//! # Example
//!
//! ```
//! use segue_motion::clip::{ContactOptions, Contacts, Interpolation};
//! use segue_motion::clip::{character_frames, ground_speed};
//! use segue_motion::skeleton::{Roles, Side};
//! use segue_motion::synth::{Action, Params, synthesize};
//!
//! let made = synthesize(&Params { speed_mps: 1.2, ..Params::new(Action::Walk) })?;
//! let roles = Roles::detect(made.clip.skeleton());
//!
//! // The measured trajectory holds the sway of the hips, which makes it a little longer.
//! let speed = ground_speed(&character_frames(&made.clip, &roles), made.clip.fps());
//! assert!(speed > 1.2 && speed < 1.21);
//!
//! // Detected contacts against the truth: less than one frame in twenty differs.
//! let contacts = Contacts::detect(&made.clip, &roles, &ContactOptions::default());
//! for side in Side::BOTH {
//!     let made_so = |frame: usize| made.truth.contacts[frame][side.index()].any();
//!     let is_wrong = |&frame: &usize| contacts.planted(side, frame) != made_so(frame);
//!     assert!((0..made.clip.frames()).filter(is_wrong).count() * 20 < made.clip.frames());
//! }
//! // Between two frames.
//! let pose = made.clip.sample(30.5 / 60.0, Interpolation::Linear).ok_or("no frames")?;
//! let roots = made.clip.root_translations();
//! assert!(pose.root_translation.distance((roots[30] + roots[31]) * 0.5) < 1e-6);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Accuracy and cost
//!
//! A clip resampled to a multiple of its rate and back is equal to 1e-5 m, and so is one that is
//! mirrored twice. Contacts do not depend on the height of the captured floor or the size of the
//! character; with the frame rate they change by at most 2.5 of the coarser frames. Everything is
//! one pass over frames × joints, except for the sorting of heights in contacts.
//!
//! # What it does not do
//!
//! One frame rate, no key frames, no compression. The ground is a plane: stairs and slopes have no
//! contacts. A body that lies on its side has no facing: over such frames its heading turns evenly
//! from the last known one to the next.
//!
//! # Sources
//!
//! Angular velocities: Holden, "Joint limits, quaternions and angular velocity". Cubic
//! interpolation: Catmull and Rom, on rotation vectors.

mod carrier;
mod contacts;
mod curves;
mod edits;
#[expect(
    clippy::missing_panics_doc,
    clippy::must_use_candidate,
    clippy::unwrap_used,
    reason = "made for tests"
)]
#[cfg(any(test, feature = "fixtures"))]
pub mod fixtures;
mod ground;
mod ground_root;
mod in_place;
mod jolts;
mod mirror;
mod motion;
mod poses;
#[cfg(test)]
mod quadruped_tests;
mod recent_poses;
mod reference;
mod resample;
mod retarget;
mod root_motion;
mod sampling;
mod storage;
mod usual;
mod velocity;

pub use contacts::{ContactCorrection, ContactCorrections, ContactOptions, Contacts, StanceEnd};
pub(crate) use contacts::{phase_between, stillest_point, stillest_step};
pub use curves::{CurveKind, joint_curve, joint_values};
pub use ground::estimate_ground;
pub use in_place::{RootMotion, RootMotionError, root_motion_from_feet, take_in_place};
pub(crate) use jolts::{JoltScan, SingleJolts, jolts, turn_change};
pub use mirror::{MirrorError, mirror};
pub use motion::{FootOptions, Motion, MotionAnalysis, with_body_plan_of};
pub(crate) use recent_poses::RecentPoses;
pub use reference::reference_pose;
pub(crate) use reference::stance_for_rest;
pub use resample::resample;
pub(crate) use retarget::Directions;
pub use retarget::{RetargetError, retarget};
pub use root_motion::{character_frames, facing, ground_speed};
pub use sampling::Interpolation;
pub use storage::{Clip, ClipError, JointTranslations, Provenance, UpAxis};
pub(crate) use usual::{FootSteps, UsualMotion, turn};
pub use velocity::{Velocities, velocities};
