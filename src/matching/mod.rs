//! Motion matching.

mod builder;
mod database;
mod error;
mod features;
mod made;
mod motion;
pub mod search;
mod simulation;
mod tags;

pub use builder::DatabaseBuilder;
pub use database::{Database, DatabaseOptions, MatchClip, Place};
pub use error::MatchError;
pub use features::{Block, FeatureOptions, Features, Layout, RATE, Weights};
pub use made::{made_clips, made_params};
pub use motion::Motion;
pub use search::{Found, Hit};
pub use simulation::simulation_roots;
pub use tags::{Tag, TagFilter, TagRange, TagSet, suggest_tags};
