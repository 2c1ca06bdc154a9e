//! Long work as jobs: plain data in, a pure function, plain data out.
//!
//! The labs offer jobs to a [`JobBoard`]; the app takes them from the session
//! ([`Session::take_job`](crate::Session::take_job)), has them run elsewhere and hands the answers
//! back. A page sends them to workers that share nothing with it: a [`Worker`] runs there, and
//! [`Parcel`]s carry clips and answers. Each clip is sent once to each worker, under a number. A
//! window runs the same [`Worker`]s on threads.
//!
//! An answer does not depend on where a job ran, on what the worker did before, or on the order in
//! which answers arrive; and it equals, to the last bit, what the labs compute in slices where no
//! worker takes jobs ([`Session::set_workers`](crate::Session::set_workers)).
//!
//! A new job is a file with a [`Task`](task::Task), and a row of the table in `any_task.rs`.

mod analysis;
mod any_task;
mod board;
mod candidates;
mod clip_parcel;
mod cycle;
mod database_clip;
mod distances;
mod error;
mod faults;
mod mend;
mod motion_parcel;
mod parcel;
mod registration;
mod result;
mod stream;
mod task;
#[cfg(test)]
mod tests;
mod view;
mod worker;
mod worker_memory;

pub(crate) use analysis::AnalysisTask;
pub(crate) use any_task::Kind;
pub use any_task::{Answer, Job};
pub(crate) use board::{JobBoard, Taken, Ticket};
pub(crate) use clip_parcel::arrays_of;
pub(crate) use cycle::CycleTask;
pub(crate) use database_clip::DatabaseClipTask;
pub(crate) use distances::DistanceTask;
pub use error::JobError;
pub(crate) use faults::FaultTask;
pub(crate) use mend::{MendAnswer, MendTask, with_slide};
pub(crate) use motion_parcel::{pack_without_floats, unpack as unpack_motion};
pub(crate) use parcel::take;
pub use parcel::{ANSWER_PIECE_BYTES, ANSWER_PIECE_FLOATS, Parcel, ParcelError};
pub(crate) use registration::{RegistrationAnswer, RegistrationTask};
pub(crate) use result::ResultTask;
pub(crate) use stream::StreamTask;
pub use task::JobClip;
pub(crate) use view::{ViewAnswer, ViewTask};
pub use worker::Worker;
