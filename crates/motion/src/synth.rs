//! Synthesis of walks, runs, turns, jumps and standing from parameters. The library's examples and
//! tests are built on it, because everything about a synthesised clip is known.
//!
//! # The idea
//!
//! A motion is planned from the feet up. [`Params`] give a path over the ground and, through the
//! published relations of speed, cadence and stance, the moments at which each foot is set down and
//! lifted. Planted feet roll over heel and ball without sliding; between plants they swing. The
//! hips follow as an inverted pendulum follows its point of support `p`:
//!
//! ```text
//! ẍ = ω² (x - p),   ω² = g / h       x(t) = ∫ ω/2 · e^(-ω|s|) p(t + s) ds
//! ```
//!
//! Picture a broomstick on a hand: to go left, the hand first goes right. The only bounded motion
//! looks ahead as far as back, so that sway, the shift of weight before a first step and the lean
//! into a curve follow from the footholds. In running and jumping the hips obey gravity in flight.
//! Legs are two bones between hip and ankle; trunk, arms and head move against them. Bodies of
//! different size walk alike at equal Froude number `v² / gl`.
//!
//! All decisions of the plan are returned in [`Truth`]: synthesised clips are the reference
//! by which detectors of contacts, phase and speed are tested.
//!
//! # Example
//!
//! ```
//! use segue_motion::synth::{Action, Params, synthesize};
//!
//! let circle = Params { speed_mps: 1.2, turn_rate_dps: 20.0, ..Params::new(Action::Walk) };
//! let made = synthesize(&circle)?;
//! assert!((made.truth.stride_m - 1.2 * made.truth.cycle_secs).abs() < 1e-5);
//!
//! // While the truth has the toes on the ground, they stand still, though the body walks on.
//! let toe = made.clip.skeleton().find("LeftToe").ok_or("no toe")?;
//! let at = |frame: usize| made.clip.world_pose(frame).positions[toe];
//! let stands = |frame: usize| made.truth.contacts[frame][0].toe;
//! let standing: Vec<usize> =
//!     (1..made.clip.frames()).filter(|&f| stands(f - 1) && stands(f)).collect();
//! assert!(standing.len() > 60 && standing.iter().all(|&f| at(f).distance(at(f - 1)) < 1e-3));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Accuracy and cost
//!
//! Over all actions planted feet slip by less than 1 mm and sink by less than 2 mm; the mean speed
//! of walks and runs is the one asked for to 0.5 %; in flight a body falls with 9.81 m/s² within
//! 0.15. Walks and runs are whole cycles that end in their first pose to 2e-3 radians. The cost is
//! linear in frames; the same parameters give the same clip.
//!
//! # What it does not do
//!
//! It models no muscles, no mass except the pendulum's, no ground except the plane, no fatigue, and
//! no use of the hands.
//!
//! # Sources
//!
//! Cadence and stance: Grieve and Gear 1966, Murray 1967, Inman, Ralston and Todd 1981 (walking);
//! Cavanagh and Kram 1989, Weyand et al. 2000 (running). Other sizes: Alexander and Jayes 1983.
//! Preview of the pendulum: Kajita et al. 2003. Proportions: Drillis and Contini 1966, in Winter,
//! "Biomechanics and Motor Control of Human Movement".

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
mod planner;
mod posture;
mod spot;
mod track;
mod truth;

pub use body::{heel_in_foot, humanoid};
pub use make::synthesize;
pub use params::{Action, Params, Preset, Style, SynthError, presets};
pub use truth::{FootContact, Synthesized, Truth};
