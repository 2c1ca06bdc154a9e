//! The Match lab: a character that is driven, live or by input that was written down.

mod crowd;
mod driver;
mod live;
mod settings;
mod tagging;
mod trace;

pub(in crate::session) use crowd::Crowd;
pub(in crate::session) use driver::{Driver, ReplayInputs, Source};
pub(in crate::session) use live::Live;
#[cfg(test)]
pub(in crate::session) use settings::options_of;
pub(in crate::session) use settings::{options_in, recording_of};
pub use tagging::{HandTag, own_words, write_tags};
pub(in crate::session) use tagging::{filter_of, read_tags};
pub use trace::{DriveMoment, Driven};
