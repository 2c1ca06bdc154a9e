//! Files that are added to the library: read at once or elsewhere, bundled takes, and the memory
//! that the page has for them.

mod admission;
mod intake;
mod mends;
mod messages;
mod reread;
mod samples;
mod setup;
mod skeletons;
mod storage;
mod tasks;

pub(crate) use intake::FileIntake;
pub use intake::LoadedFile;
pub(crate) use storage::{is_as_it_came, stored_entries};
pub use tasks::Job;

#[cfg(test)]
mod memory_tests;
#[cfg(test)]
mod sample_tests;
#[cfg(test)]
mod storage_tests;
#[cfg(test)]
mod task_tests;
#[cfg(test)]
mod tests;
