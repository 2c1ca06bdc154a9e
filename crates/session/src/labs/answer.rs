//! A lab's answer to the parameters of a pane.

use super::error::LabError;
use super::lab::Inputs;
use super::outcome::Outcome;
use std::sync::Arc;

/// The answer to what the parameters of a pane ask for.
pub(crate) enum Answer {
    /// The result, or a draft of it.
    Made { outcome: Arc<Outcome>, is_draft: bool, inputs: Option<Inputs> },
    /// The pane shows the result of the present parameters already, or a draft of it.
    Same { is_draft: bool },
    /// The result is being computed.
    Awaited,
    /// The result cannot be made, for that reason.
    Refused(LabError),
}
