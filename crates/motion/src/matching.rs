//! Motion matching: at every moment, play the frame of the database that best fits the character's
//! pose and the player's input.
//!
//! # The idea
//!
//! Ten times a second the [`Controller`] queries a [`Database`] for the frame whose feet and hips
//! are placed and move most like the character's, and whose trajectory leads where the player
//! steers. It continues from there; the difference decays ([`crate::transition::Inertializer`]). In
//! between, the clip plays. Picture a DJ who always finds the record that is in time with the one
//! on the deck, and leads where the dancers want.
//!
//! ```text
//! cost(frame) = Σ_d (w_d (q_d - x_d))²      x = (feature - mean) / scale of its block
//! ```
//!
//! - *Features* ([`Layout`]): 27 numbers per frame in the character's own frame: its position and
//!   facing in 1/3, 2/3 and 1 s, the positions of its feet, the velocities of feet and hips. They
//!   are normalised block by block; [`Weights`] come with the query, so that they can change during
//!   playback.
//! - *Searches* ([`search`]): a plain scan, bounding boxes that visit few frames, a k-d tree. All
//!   find the same frame.
//! - *Steering* ([`Simulation`]): critically damped springs from the player's input to a smooth
//!   trajectory. The desired trajectory is one part of the query, the current state of the body the
//!   other.
//! - *Input* ([`Control`], [`Recording`]): rounded as it is recorded, replayed exactly.
//!
//! A clip that is a cycle, such as one stride of a walk, repeats: it is searched to its last frame,
//! its trajectories continue into the next repetition, and it plays on until another frame fits
//! better.
//!
//! The character's frame is the *simulation root*: the hips projected to the ground, without the
//! sway of the stride ([`simulation_roots`]).
//!
//! # Example
//!
//! ```
//! use segue_motion::clip::Motion;
//! use segue_motion::matching::search::{Query, scan};
//! use segue_motion::matching::{Control, Controller, ControllerOptions, Database, DatabaseOptions};
//! use segue_motion::matching::{TagFilter, Weights};
//! use segue_motion::math::Planar;
//! use segue_motion::synth::{Action, Params, synthesize};
//! use std::sync::Arc;
//!
//! let mut clips = Vec::new();
//! for action in [Action::Idle, Action::Start, Action::Walk, Action::Stop] {
//!     clips.push(Arc::new(Motion::analyze(synthesize(&Params::new(action))?.clip)));
//! }
//! let database = Arc::new(Database::new(clips, &DatabaseOptions::default())?);
//!
//! // Three seconds of "walk ahead at 1.4 m/s", from standing.
//! let options = ControllerOptions::default();
//! let mut character = Controller::new(Arc::clone(&database), options, &Planar::IDENTITY)?;
//! for _ in 0..180 {
//!     character.tick(&Control::new(glam::DVec2::new(0.0, 1.4), None));
//! }
//! assert!((character.root().shift.y - 3.7).abs() < 0.3 && character.jumps() < 12);
//!
//! // The boxes find the same frame as the scan, and visit fewer frames.
//! let weights = Weights::default().spread(database.features().layout());
//! let row = database.features().row(700).ok_or("no such frame")?;
//! let query: Vec<f32> = row.iter().map(|x| x + 0.02).collect();
//! let query = Query { row: &query, weights: &weights, filter: TagFilter::default() };
//! let slow = scan(&database.candidates(), &query);
//! let fast = database.index().search(database.masks(), &query, None);
//! assert!(slow.best == fast.best && fast.visited < slow.visited / 2);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Accuracy and cost
//!
//! The three searches agree, frame and cost, on 10,000 random queries. Features, roots and steering
//! agree with an oracle in `NumPy` and `SciPy`. A recording replays bit for bit, at any refresh
//! rate of the screen. In the recorded scenarios the character stays within 10 cm of its target in
//! the mean, and turns are made within 1.2 s. A scan is O(frames × dimensions), a tick without a
//! search O(joints).
//!
//! # What it does not do
//!
//! It assumes one ground plane, without obstacles and other characters. It looks one second ahead
//! and plans nothing: motion that is not in the clips does not appear. Retargeted clips keep their
//! feet planted only as well as [`crate::retarget`] does.
//!
//! # Sources
//!
//! Clavet, "Motion Matching and The Road to Next-Gen Animation", GDC 2016. Holden, Kanoun,
//! Perepichka, Popa, "Learned Motion Matching", 2020, section 3 (features and their scales).
//! Holden, "Code vs Data Driven Displacement", 2021 (the simulation object).

mod builder;
mod control;
mod controller;
mod cycle;
mod database;
mod desired;
mod drive;
mod error;
mod features;
mod foot_state;
mod made;
mod measurement;
mod motion;
mod pace;
mod scenario;
pub mod search;
mod simulation;
mod tags;

pub use builder::DatabaseBuilder;
pub use control::{Control, Recording, RecordingError};
pub use controller::{
    Candidate, Controller, ControllerOptions, FollowOptions, FootPlanting, HoldReason, Hysteresis,
    SearchMethod, SearchReason, SearchRecord,
};
pub use database::{Database, DatabaseOptions, Place};
pub use desired::{Simulation, Steering};
pub use drive::{Drive, DriveMetrics, Jump, drive};
pub use error::MatchError;
pub use features::{Block, FeatureOptions, Features, Layout, Normalisation, RATE, Weights};
pub use foot_state::FootState;
pub use made::{made_clip, made_clips, made_name, made_params};
pub use measurement::{ClipMeasurement, MeasuredClip};
pub use motion::{DatabaseClip, DatabaseClipParts, feature_rows};
pub use pace::Pace;
pub use scenario::Scenario;
pub use search::{Hit, SearchResult};
pub use simulation::simulation_roots;
pub use tags::{Tag, TagFilter, TagRange, TagSet, suggest_tags};

#[cfg(test)]
mod tests;
