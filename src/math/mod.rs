//! The little mathematics that every other module shares.

pub mod curve;
mod planar;
pub mod quat;
pub mod stats;

pub use planar::Planar;
pub(crate) use planar::wrap_angle;
