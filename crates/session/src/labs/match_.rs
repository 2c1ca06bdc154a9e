//! The Match lab: a character that is driven, live or by input that was written down.

mod crowd;
mod driver;
mod live;
mod settings;
mod tagging;
mod trace;

pub(crate) use crowd::Crowd;
pub(crate) use driver::{Driver, ReplayInputs, Source};
pub(crate) use live::Live;
#[cfg(test)]
pub(crate) use settings::options_of;
pub(crate) use settings::{options_in, recording_of};
pub use tagging::{HandTag, own_words, write_tags};
pub(crate) use tagging::{filter_of, read_tags};
pub use trace::{DriveMoment, Driven};
