//! Segue's motion core: clips, the skeletons they move, and what is made from them.
//!
//! The core is pure and deterministic. It knows no screen, no file system, no clock and no threads: data goes in, data
//! comes out, chance is a seed and time is a parameter. The app (`src/main.rs`, feature `app`) is built on top of it.
//!
//! # Conventions
//!
//! Right-handed, Y up, metres, seconds, radians. The ground is the plane `y = 0`. A character whose yaw is 0 faces +Z;
//! positive yaw turns it left (about +Y). Quaternions are unit; `q` and `-q` are the same rotation, so everything that
//! interpolates first brings both into one hemisphere. Every rate is per second at the clip's own frame rate.
//!
//! Transforms are named destination-from-source: `world_from_joint * point_in_joint`.

pub mod blend;
pub mod clip;
pub mod formats;
pub mod gait;
pub mod graph;
pub mod matching;
pub mod math;
pub mod metrics;
pub mod path;
pub mod registration;
pub mod scene;
pub mod session;
pub mod skeleton;
pub mod skin;
pub mod synth;
pub mod transition;
