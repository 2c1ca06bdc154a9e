//! What the page is told.

/// What the page's API tells its listeners.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
#[serde(untagged)]
pub(crate) enum Event {
    /// Anything but the playhead has changed.
    Change {
        /// The link to the new state.
        query: String,
    },
    /// Something did not work.
    Error {
        /// What and why.
        message: String,
    },
    /// Something that takes long goes on.
    Progress {
        /// What.
        name: String,
        /// How much of it is done, 0 to 1, where that is known.
        progress: Option<f64>,
    },
    /// The graphics device is gone.
    Lost {
        /// What the driver says.
        message: String,
    },
}

impl Event {
    /// The name that listeners know it by.
    pub(crate) fn name(&self) -> &'static str {
        match self {
            Self::Change { .. } => "change",
            Self::Error { .. } => "error",
            Self::Progress { .. } => "progress",
            Self::Lost { .. } => "lost",
        }
    }
}
