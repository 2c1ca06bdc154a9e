//! Artefacts as numbers with a unit: the faults that a viewer would notice, measured.
//!
//! # The idea
//!
//! A useful number is 0 for good motion and grows with the visible fault. A jump of 5° is much for
//! a spine and little for a runner's knee, so a joint is measured *beyond* the greatest value that
//! it has in the source clips.
//!
//! Some numbers apply to every motion, however it was made: [`ResultMetrics`], measured against a
//! [`MotionTrace`] of the source clips.
//!
//! | | unit | definition |
//! |---|---|---|
//! | pose jump | ° | the largest turn of a joint in one step, beyond the clips' |
//! | velocity jump | °/s | the largest change of a joint's angular velocity in 1/30 s, beyond the
//! clips' |
//! | spin | ° | the most yaw of the hips in 0.2 s, beyond the clips' |
//! | skating | cm/s | the mean speed of low feet over the ground |
//!
//! ```text
//! pose jump     = max over joints of
//!     max over steps |ω| / fps - max over the clips' steps |ω| / fps
//! velocity jump = max over joints of
//!     max over frames |ω(t, t + T) - ω(t - T, t)| - the same of the clips,  T = 1/30 s
//! spin          = max over frames |yaw(t + 0.2 s) - yaw(t)| - the same of the clips
//! ```
//!
//! `ω(s, t)` is the mean angular velocity from s to t. A velocity jump does not depend on the frame
//! rate: where a blend has an acceleration it is that times T, where the velocity is discontinuous
//! it is the discontinuity.
//!
//! Others apply to a place or a kind of motion: [`foot_slide_cm`], [`ClipMetrics`],
//! [`TransitionMetrics`].
//!
//! | | unit | definition |
//! |---|---|---|
//! | foot slide | cm | the farthest that a planted foot moves in the worst stance |
//! | position jump | cm | the character's step over the ground, beyond the usual |
//! | penetration | cm | the depth of the deepest point below the ground |
//! | lag | s | the time until the velocity is the new clip's, to 10 % |
//!
//! ```text
//! slide = max over a stance of  |Σ step of the foot's stillest point|
//! ```
//!
//! For a single transition the frames of both clips that play are known: the fields of
//! [`TransitionMetrics`] are measured beyond what the clips do in these very frames.
//!
//! A foot that rolls from heel to toe moves, but one of its points stands still: that point is
//! followed. [`foot_slide_cm`] does so for a whole clip.
//!
//! # Example
//!
//! The same transition, correct and with a well-known mistake: `atan` in place of `atan2`.
//!
//! ```
//! use segue_motion::blend::Concatenation;
//! use segue_motion::clip::Motion;
//! use segue_motion::metrics::TransitionMetrics;
//! use segue_motion::synth::{Action, Params, synthesize};
//! use segue_motion::transition::{Method, Mistake, TransitionOptions};
//! use segue_motion::transition::{concatenate, concatenate_mistaken};
//!
//! let a = Motion::analyze(synthesize(&Params::new(Action::Walk))?.clip);
//! let b = Motion::analyze(synthesize(&Params::new(Action::Run))?.clip);
//! let options = TransitionOptions::new(Method::Dissolve { window: 30, law: Default::default() });
//! let right = concatenate(&a, 100, &b, 20, &options)?;
//! let wrong = concatenate_mistaken(&a, 100, &b, 20, &options, Mistake::AtanForAtan2)?;
//! let spin_deg = |made: &Concatenation| {
//!     TransitionMetrics::measure(&a, &b, made).spin_deg.unwrap_or(f64::NAN)
//! };
//! assert!(spin_deg(&right) < 1.0 && spin_deg(&wrong) > 90.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Accuracy and cost
//!
//! A joint that is turned by 30° in one frame measures 30° to 0.001°, and a foot that is made to
//! slide by 5 cm slides 5 cm. A clip that continues as itself has no artefact. A transition costs
//! O(its frames × joints) and half a second to either side, and each clip O(frames × joints) once.
//!
//! # What it does not do
//!
//! No number says whether a motion is beautiful, or in character. Limbs that pass through each
//! other are not detected. The usual motion of a trembling capture hides a trembling seam. Feet
//! count as planted where the *sources* have contacts: a wrong contact is measured as a slide.
//!
//! # Sources
//!
//! The definitions are Segue's own; each stands at its field in [`TransitionMetrics`].

mod artefacts;
mod deviation;
mod extreme;
mod lowest;
mod result;
mod slide;
mod transition;
mod whole;

pub use artefacts::{Artefacts, Flash, MotionTrace, SPIN_SECS, TraceMeter};
pub use deviation::Deviations;
pub use extreme::Extreme;
pub use result::{JointFrame, ResultMetrics};
pub use slide::{SlideMeter, StanceSlide, foot_slide_cm, foot_slides, worst_foot_slide};
pub use transition::{TransitionMetrics, deepest_penetration, penetration_cm};
pub use whole::{ClipMeter, ClipMetrics};
