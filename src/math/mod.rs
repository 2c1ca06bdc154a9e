//! The little mathematics that every other module shares.

pub mod curve;
mod decay;
mod monotone;
mod planar;
pub mod quat;
pub mod spring;
pub mod stats;

pub use decay::{Decay, Response};
pub use monotone::MonotoneCurve;
pub use planar::Planar;
pub(crate) use planar::wrap_angle;
