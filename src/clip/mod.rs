//! Clips: frames × joints of a skeleton, and what can be asked of one clip alone.

mod sampling;
mod storage;

pub use sampling::Interpolation;
pub use storage::{Clip, ClipError, JointTranslations, Provenance, UpAxis};
