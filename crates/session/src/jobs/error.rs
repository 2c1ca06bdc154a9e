//! The reason why a job has no answer.

use super::ParcelError;
use segue_motion::graph::GraphError;
use segue_motion::matching::MatchError;
use segue_motion::registration::RegistrationError;

/// The reason why a job has no answer. The labs then compute in slices, and find the error of the
/// computation itself there.
#[derive(Debug, thiserror::Error)]
pub enum JobError {
    /// A clip that the worker does not have.
    #[error("clip {0} was not sent")]
    NoClip(u32),
    /// A message that cannot be read.
    #[error(transparent)]
    Parcel(#[from] ParcelError),
    /// The computation failed: distances.
    #[error(transparent)]
    Graph(#[from] GraphError),
    /// The computation failed: registration.
    #[error(transparent)]
    Registration(#[from] RegistrationError),
    /// The computation failed: a clip of a database.
    #[error(transparent)]
    Match(#[from] MatchError),
    /// The computation has no result.
    #[error("the job has no result")]
    NoResult,
}
