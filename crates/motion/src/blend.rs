//! Blending: weights, aligning one motion with another, the dissolve, registered blends, and
//! layers.
//!
//! # The idea
//!
//! A dissolve leaves clip A at frame `i`, enters clip B at frame `j` and overlaps `k` frames. Its
//! result is `A[..i]`, then `k` frames in which `A[i..i + k)` fades into `B[j..j + k)`, then
//! `B[j + k..]`. In frame p of the window:
//!
//! ```text
//! α = 2t³ - 3t² + 1,  t = (p + 1)/k           weight of A: 1 before the window, 0 at its end
//! pose  = α A[i + p] + (1 - α) B[j + p]       angles slerp the shorter way, lengths lerp
//! frame = frame before · (α a + (1 - α) b)    a, b: the characters' own steps
//! ```
//!
//! Poses are blended in the character's own frame, and the trajectory over the ground is integrated
//! from blended *steps*: forward, sideways, turn. It therefore does not matter where either
//! character walked before. Picture two people who walk side by side in step while the camera pans
//! from one to the other. Blended in the world ([`RootBlend::World`]), the character is pulled from
//! one trajectory to the other.
//!
//! [`registered_blend`] plays both clips along a time warp, so that corresponding frames meet for
//! as long as the clips last. A [`layer`] puts a part of one body over another, or adds the
//! difference of a motion to a reference pose:
//!
//! ```text
//! in place   slerp(base, over, w)                        w = mask · weight
//! added      base · exp(w · log(reference⁻¹ · over))
//! ```
//!
//! # Example
//!
//! ```
//! use segue_motion::clip::Motion;
//! use segue_motion::blend::{BodyPart, DissolveOptions, LayerOptions, dissolve, layer};
//! use segue_motion::registration::{SearchOptions, best_transition, limb_weights};
//! use segue_motion::skeleton::Role;
//! use segue_motion::synth::{Action, Params, synthesize};
//!
//! let a = Motion::analyze(synthesize(&Params::new(Action::Walk))?.clip);
//! let b = Motion::analyze(synthesize(&Params::new(Action::Run))?.clip);
//! let (walk, run, roles) = (a.clip(), b.clip(), a.roles());
//!
//! // Find where half a second of walking and of running look most alike.
//! let weights = limb_weights(walk.skeleton());
//! let height = f64::from(a.body_height());
//! let found = best_transition(walk, run, &weights, height, &SearchOptions::new(30))?;
//!
//! let options = DissolveOptions { window: 30, ..DissolveOptions::default() };
//! let out = dissolve(&a, found.leave, &b, found.enter, &options)?;
//! assert_eq!(out.clip.pose(found.leave - 1), walk.pose(found.leave - 1));
//! assert_eq!(out.transition, found.leave..found.leave + 30);
//! // After the window B plays unchanged, elsewhere on the ground.
//! let (there, own) = (out.clip.world_pose(out.transition.end), run.world_pose(found.enter + 30));
//! let mut pairs = there.positions.iter().zip(&own.positions);
//! assert!(pairs.all(|(p, q)| p.distance(out.world_from_b.apply(*q)) < 1e-5));
//!
//! // The arms of the run over the legs of the walk: the knees are the walk's, bit for bit.
//! let upper_body = LayerOptions { parts: vec![BodyPart::UpperBody], ..LayerOptions::default() };
//! let mixed = layer(&a, &b, &upper_body)?;
//! let knee = roles.get(Role::LeftShin).ok_or("no knee")?;
//! let elbow = roles.get(Role::LeftForearm).ok_or("no elbow")?;
//! assert_eq!(mixed.rotations(40)[knee], walk.rotations(40)[knee]);
//! assert!(mixed.rotations(40)[elbow].angle_between(run.rotations(40)[elbow]) < 1e-3);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Accuracy and cost
//!
//! A clip dissolved into itself is equal to 1e-5 m; the position of B in its own world changes the
//! result by less than 0.2 mm. Between two straight walks no turn appears that neither has, and
//! except for the sway of a stride speeds stay between those of both. Dissolves and layers agree
//! with `SciPy`. O(frames × joints).
//!
//! # What it does not do
//!
//! It does not plant feet: a foot that stands in A and swings in B slides, and
//! [`crate::transition::foot_lock`] repairs that. Two very different poses have a mean that occurs
//! in neither clip: search for a better transition first. Nothing is retargeted or resampled: clips
//! that need it are refused with a [`BlendError`].
//!
//! # Sources
//!
//! Kovar, Gleicher, Pighin, "Motion Graphs", 2002 (window and weight). Kovar, Gleicher 2003,
//! section 5 (registered blends). Perlin 2002 ([`WeightLaw::Smoother`]).

mod assembly;
mod concatenation;
mod dissolve;
mod layers;
mod mask;
mod place;
mod registered;
mod weight;
mod weight_curve;

pub(crate) use assembly::{Assembly, moving_joints, moving_joints_of, translation_of};
pub use concatenation::Concatenation;
pub use dissolve::{AlignBy, DissolveOptions, RootBlend, dissolve};
pub(crate) use dissolve::{alignment_of, check};
pub use layers::{LayerError, LayerMode, LayerOptions, LayerTime, Reference, layer, layer_timed};
pub use mask::{BodyPart, mask};
pub use place::{align_facing, align_onto};
pub use registered::{
    FrameMix, Partner, RegisteredBlend, RegisteredJoin, registered_blend, registered_join,
};
pub use weight::WeightLaw;
pub use weight_curve::WeightCurve;

use crate::clip::ClipError;
use crate::registration::RegistrationError;

/// The greatest duration that may be asked for in a transition, seconds.
pub(crate) const MAX_SECS: f64 = 60.0;

/// Error blending two clips.
#[derive(Clone, Debug, PartialEq, thiserror::Error, segue_text::ToMessage)]
pub enum BlendError {
    /// The clips have different skeletons.
    #[error("`{a}` and `{b}` move different skeletons: retarget one onto the other first")]
    Skeletons {
        /// Name of the outgoing clip.
        a: String,
        /// Name of the incoming clip.
        b: String,
    },
    /// The frame rates differ.
    #[error(
        "the clips run at {a_fps} and {b_fps} frames per second: resample one to the other's rate first"
    )]
    FrameRates {
        /// Frame rate of the outgoing clip.
        a_fps: f64,
        /// Frame rate of the incoming clip.
        b_fps: f64,
    },
    /// The window does not fit between its first frame and the end of the clip.
    #[error(
        "{window} frames from frame {at} do not fit into the {which} clip of {frames} frames: lower the window to {most} or start it earlier",
        most = frames.saturating_sub(*at)
    )]
    Window {
        /// "outgoing" or "incoming".
        which: &'static str,
        /// Frames of that clip.
        frames: usize,
        /// The window's first frame.
        at: usize,
        /// Frames of the window.
        window: usize,
    },
    /// The clips have no registered part in common.
    #[error(
        "`{reference}` and the clips blended with it have no registered part in common: register them over the same frames, or free fewer ends"
    )]
    NothingInCommon {
        /// Name of the clip that the others are registered to.
        reference: String,
    },
    /// A duration out of range.
    #[error("a {what} of {secs} s cannot be used: give a number of seconds from 0 to {MAX_SECS}")]
    Time {
        /// Which time.
        what: &'static str,
        /// The number given.
        secs: f64,
    },
    /// The windows cannot be aligned.
    #[error(transparent)]
    Registration(#[from] RegistrationError),
    /// The result is not a valid clip.
    #[error(transparent)]
    Clip(#[from] ClipError),
}
