//! Mathematics shared by all other modules: rotations as vectors, rigid transforms of the ground,
//! springs, and curves. Vectors and quaternions themselves are those of the crate `glam`.
//!
//! # The idea
//!
//! *Rotations* do not add, but small ones nearly do. The logarithm turns a quaternion into a
//! rotation vector (axis × angle), which can be added and scaled; the exponential turns it back
//! ([`quat`]). `q` and `-q` are one rotation: always take the nearer one.
//!
//! ```text
//! v = log(q), |v| ≤ π        q = exp(v)
//! ω = log(q₂ · q₁⁻¹) / dt    angular velocity in the world
//! ```
//!
//! *A character on the ground* has a position and a facing: a [`Planar`] transform, three numbers.
//! A walk is a chain of them, each step in the frame of the one before: `here.after(&step)`.
//!
//! *A critically damped spring* pulls an offset to zero as fast as possible without overshoot
//! ([`spring`]). Picture a door closer: it takes over whatever speed the door has, and the door
//! does not swing to and fro. The solution is in closed form, so a step may be of any length:
//!
//! ```text
//! x(t) = e^(-yt) (x + (v + xy) t),   y = 2 ln 2 / half-life
//! ```
//!
//! [`Decay`] adds two curves of finite duration, a cubic and a quintic. All three are linear in
//! offset and velocity: four numbers ([`Response`]) serve a whole body.
//!
//! # Example
//!
//! ```
//! use glam::{Quat, Vec3};
//! use segue_motion::math::{Planar, quat, spring};
//! use std::f64::consts::FRAC_PI_2;
//!
//! // Half a radian in a tenth of a second, whatever the sign of the quaternion.
//! let turn = Quat::from_rotation_y(0.5);
//! for q in [turn, -turn] {
//!     assert!((quat::angular_velocity(Quat::IDENTITY, q, 0.1) - Vec3::Y * 5.0).length() < 1e-5);
//! }
//! // A step ahead and a quarter turn to the left, four times, ends where it began.
//! let step = Planar::new(FRAC_PI_2, 0.0, 1.0);
//! let here = (0..4).fold(Planar::IDENTITY, |here, _| here.after(&step));
//! assert!(here.shift.length() < 1e-12);
//! // From rest a spring has 59.7 % left after one half-life, and half of it after 1.211.
//! let (left, _) = spring::response(0.2, 0.2).of(1.0, 0.0);
//! assert!((left - 0.597).abs() < 1e-3);
//! assert!((spring::secs_until(0.2, 0.5) - 0.2 * 1.211).abs() < 1e-4);
//! // Twelve short steps equal one long step.
//! let step = |(x, v), _| spring::towards(x, v, 0.0, 0.2, 0.2 / 12.0);
//! assert!(((0..12).fold((1.0, 0.0), step).0 - left).abs() < 1e-12);
//! ```
//!
//! # Accuracy and cost
//!
//! Decays agree with `SciPy` to 1e-10. `log` undoes `exp` to 2e-5 radians up to nearly half a turn,
//! and rotations of a millionth of a radian keep their digits: logarithms do not use `acos`, which
//! loses half the digits near the identity. Everything except curves through points and percentiles
//! is O(1).
//!
//! # What it does not do
//!
//! No scales, no rigid transforms of space, no general linear algebra. The rate of a rotation
//! vector equals the angular velocity only for small vectors; [`quat::rate_to_angular_velocity`]
//! converts the one to the other.
//!
//! # Sources
//!
//! Holden, "Spring-It-On: The Game Developer's Spring-Roll-Call", 2021. Bollo, "Inertialization",
//! GDC 2018 (the quintic). Solà, Deray, Atchuthan, "A micro Lie theory", 2018. Kovar, Gleicher,
//! Pighin, "Motion Graphs", 2002, section 3.1 (ground transforms). Fritsch, Carlson 1980 and
//! Fritsch, Butland 1984 ([`MonotoneCurve`]).

pub mod curve;
mod decay;
mod lowpass;
mod monotone;
mod planar;
pub mod quat;
mod response;
pub mod sort;
pub mod spring;
pub mod stats;

pub use decay::Decay;
pub use lowpass::LowPass;
pub use monotone::MonotoneCurve;
pub(crate) use planar::unwrap_near;
pub use planar::{Planar, wrap_angle};
pub use response::Response;
