//! Clips: frames × joints of a skeleton, and what can be asked of one clip alone.

mod contacts;
mod resample;
mod root_motion;
mod sampling;
mod storage;
mod velocity;

pub use contacts::{ContactOptions, Contacts, ground_height};
pub use resample::resample;
pub use root_motion::{character_frames, facing, ground_speed, motion_root};
pub use sampling::Interpolation;
pub use storage::{Clip, ClipError, JointTranslations, Provenance, UpAxis};
pub use velocity::{Velocities, velocities};
