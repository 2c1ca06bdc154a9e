//! Files that are added to the library: read at once or elsewhere, bundled takes, and the memory
//! that the page has for them.

mod admission;
mod arrivals;
mod corrections;
mod idle;
mod intake;
mod messages;
mod motion_uses;
mod reread;
mod roles;
mod samples;
mod setup;
mod skeletons;
mod storage;
mod tasks;

pub(crate) use intake::FileIntake;
pub use intake::LoadedFile;
pub(crate) use setup::setup_for_new;
pub(crate) use storage::{is_as_it_came, stored_entries};
pub use tasks::Job;

#[cfg(test)]
mod archive_tests;
#[cfg(test)]
mod body_tests;
#[cfg(test)]
mod character_tests;
#[cfg(test)]
mod correction_tests;
#[cfg(test)]
mod external_reader_tests;
#[cfg(test)]
mod fixtures;
#[cfg(test)]
mod group_tests;
#[cfg(test)]
mod humanoid_tests;
#[cfg(test)]
mod idle_tests;
#[cfg(test)]
mod memory_tests;
#[cfg(test)]
mod sample_tests;
#[cfg(test)]
mod skeleton_tests;
#[cfg(test)]
mod storage_tests;
#[cfg(test)]
mod task_tests;
