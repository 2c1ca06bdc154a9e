//! Events of the page's API.

/// An event for the listeners of the page's API.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
#[serde(untagged)]
pub(crate) enum Event {
    /// A change of the state other than the playhead.
    Change {
        /// The link to the new state.
        query: String,
    },
    /// A failure.
    Error {
        /// A sentence that names the failure and its reason.
        message: String,
    },
    /// The progress of a computation or of a file.
    Progress {
        /// The name of the computation or the file.
        name: String,
        /// The share that is done, 0 to 1, where it is known.
        progress: Option<f64>,
    },
    /// The loss of the graphics device.
    Lost {
        /// The reason that the driver gives.
        message: String,
    },
}

impl Event {
    /// Returns the name by which listeners register for it.
    pub(crate) fn name(&self) -> &'static str {
        match self {
            Self::Change { .. } => "change",
            Self::Error { .. } => "error",
            Self::Progress { .. } => "progress",
            Self::Lost { .. } => "lost",
        }
    }
}
