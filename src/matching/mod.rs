//! Motion matching: at every moment the frame of all clips that fits best to where the character is and where the player wants it to go (Clavet,
//! "Motion Matching and The Road to Next-Gen Animation", GDC 2016; Holden et al., "Learned Motion Matching", 2020).
//!
//! Ten times a second the [`Controller`] asks a [`Database`]: which frame has its feet where mine are, moving as mine move, and leads where the
//! player steers? It goes on from there; the difference dies away ([`crate::transition::Inertializer`]). In between, the clip plays.
//!
//! - *Features* ([`Layout`]): 27 numbers per frame in the character's own frame: where it will be and what it will face in 1/3, 2/3 and 1 s, where its
//!   feet are, how feet and hips move. Normalised block by block; [`Weights`] come with the question, so that they are live.
//! - *Searches* ([`search`]): a plain scan, boxes that look at few frames, a k-d tree. All find the same frame.
//! - *Steering* ([`Simulation`]): critically damped springs from what the player asks for to a smooth way.
//! - *Input* ([`Control`], [`Recording`]): rounded as it is recorded, replayed exactly.
//!
//! The character's frame is the *simulation root*: the hips over the ground, without the sway of the stride ([`simulation_roots`]).
//!
//! ```
//! use segue::matching::{Control, Controller, ControllerOptions, Database, DatabaseOptions, MatchClip};
//! use segue::{math::Planar, skeleton::Roles, synth};
//! use std::sync::Arc;
//!
//! let mut clips = Vec::new();
//! for action in [synth::Action::Idle, synth::Action::Start, synth::Action::Walk, synth::Action::Stop] {
//!     let clip = Arc::new(synth::synthesize(&synth::Params::new(action))?.clip);
//!     let roles = Roles::detect(clip.skeleton());
//!     clips.push(MatchClip::new(clip, roles));
//! }
//! let database = Arc::new(Database::new(clips, &DatabaseOptions::default())?);
//! let mut character = Controller::new(database, ControllerOptions::default(), &Planar::IDENTITY)?;
//! for _ in 0..180 {
//!     character.tick(&Control::new(glam::DVec2::new(0.0, 1.4), None));
//! }
//! assert!((character.root().shift.y - 3.7).abs() < 0.3 && character.jumps() < 12);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! What it does not do: it knows one ground plane, no obstacles, and no other characters. Retargeted clips keep their feet only as well as
//! [`crate::clip::retarget`] does.

mod builder;
mod control;
mod controller;
mod database;
mod desired;
mod drive;
mod error;
mod features;
mod made;
mod motion;

mod scenario;
pub mod search;
mod simulation;
mod tags;

pub use builder::DatabaseBuilder;
pub use control::{Control, Recording, RecordingError};
pub use controller::{
    Candidate, Controller, ControllerOptions, Following, FootPlanting, Held, Hysteresis, Reason, SearchMethod, SearchRecord,
};
pub use database::{Database, DatabaseOptions, MatchClip, Place};
pub use desired::{Simulation, Steering};
pub use drive::{Drive, DriveMetrics, Jump, drive};
pub use error::MatchError;
pub use features::{Block, FeatureOptions, Features, Layout, RATE, Weights};
pub use made::{made_clip, made_clips, made_params};
pub use motion::Motion;
pub use scenario::Scenario;
pub use search::{Found, Hit};
pub use simulation::simulation_roots;
pub use tags::{Tag, TagFilter, TagRange, TagSet, suggest_tags};

#[cfg(test)]
mod tests;
