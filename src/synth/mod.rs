//! Walking, running, standing, turning and jumping, made from parameters.
//!
//! A motion is planned from the feet up. [`Params`] give a way over the ground and, through the published relations of speed, cadence and stance,
//! the moments at which each foot is set down and lifted. Planted feet roll over heel and ball without sliding; between
//! plants they swing. The hips follow as an inverted pendulum follows its point of support, so that sway, the shift of weight before
//! a first step and the lean into a curve come out of the footholds; in running and jumping they obey gravity in flight. Legs are two
//! bones between hip and ankle; trunk, arms and head move against them.
//!
//! Everything that was decided on the way is kept in [`Truth`]: made clips are the yardstick that detectors of contacts, phase and speed are
//! tested with. What it does not do: it knows no muscles and no mass but the pendulum's, no ground but the plane, and no fatigue.
//!
//! ```
//! use segue::synth::{Action, Params, synthesize};
//!
//! let made = synthesize(&Params { speed_mps: 1.2, turn_rate_dps: 20.0, ..Params::new(Action::Walk) })?;
//! assert_eq!(made.truth.contacts.len(), made.clip.frames());
//! # Ok::<(), segue::synth::SynthError>(())
//! ```

mod arms;
mod balance;
mod body;
mod foot;
mod gait;
mod height;
mod leg;
mod make;
mod params;
mod path;
mod plan;
mod posture;
mod spot;
mod track;
mod truth;

pub use body::{heel_in_foot, humanoid};
pub use make::synthesize;
pub use params::{Action, Params, Preset, Style, SynthError, presets};
pub use truth::{FootContact, Synthesized, Truth};
