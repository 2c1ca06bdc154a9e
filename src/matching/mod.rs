//! Motion matching.

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
    Candidate, Controller, ControllerOptions, FootPlanting, Following, Held, Hysteresis, Reason, SearchMethod, SearchRecord,
};
pub use database::{Database, DatabaseOptions, MatchClip, Place};
pub use desired::{Simulation, Steering};
pub use drive::{Drive, DriveMetrics, drive};
pub use error::MatchError;
pub use features::{Block, FeatureOptions, Features, Layout, RATE, Weights};
pub use made::{made_clips, made_params};
pub use motion::Motion;
pub use scenario::Scenario;
pub use search::{Found, Hit};
pub use simulation::simulation_roots;
pub use tags::{Tag, TagFilter, TagRange, TagSet, suggest_tags};
