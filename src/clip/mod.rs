//! Clips: frames × joints of a skeleton, and what can be asked of one clip alone.

mod contacts;
mod curves;
#[cfg(test)]
pub(crate) mod fixtures;
mod jolts;
mod mirror;
mod poses;
mod resample;
mod retarget;
mod root_motion;
mod sampling;
mod storage;
mod velocity;

pub(crate) use contacts::stillest_step;
pub use contacts::{ContactOptions, Contacts, ground_height};
pub use curves::{CurveKind, joint_curve};
pub(crate) use jolts::{jolts, turn_change};
pub use mirror::{MirrorError, mirror};
pub use resample::resample;
pub use retarget::{RetargetError, retarget};
pub use root_motion::{character_frames, facing, ground_speed, motion_root};
pub use sampling::Interpolation;
pub use storage::{Clip, ClipError, JointTranslations, Provenance, UpAxis};
pub use velocity::{Velocities, velocities};
