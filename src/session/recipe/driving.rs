//! The Match lab: a character that is driven, live or by input that was written down.

mod crowd;
mod driver;
mod live;
mod settings;
mod trace;

pub(in crate::session) use crowd::Crowd;
pub(in crate::session) use driver::{Driver, ReplayInputs, Source};
pub(in crate::session) use live::Live;
pub(in crate::session) use settings::{filter_of, options_of, recording_of};
pub use trace::{DriveMoment, Driven};
