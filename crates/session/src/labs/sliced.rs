//! Work that takes longer than a frame, and is done in slices.

use crate::jobs::JobBoard;

/// The kinds of work that is done in slices.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum JobKind {
    /// The reading of the feet and places of a long clip, its measurement, and what a lab makes of
    /// it before any result: a fitted path, a layer in time.
    Analyzing,
    /// The computation of a result of long clips in a worker, which tells no progress.
    Computing,
    /// A search for the best place of a transition, or for the ends of a cycle.
    Matching,
    /// The registration of clips in time.
    Registering,
    /// The construction of a motion graph.
    BuildingGraph,
    /// The retargeting of a clip to another skeleton.
    Retargeting,
    /// The locking of planted feet.
    HoldingFeet,
    /// The search for faults of a take, and their mends.
    Cleaning,
    /// The computation of features for motion matching.
    BuildingDatabase,
    /// The playback of recorded input.
    Driving,
    /// The reading of a file with this name.
    Reading(String),
    /// The reading of many files.
    ReadingFiles {
        /// The number of those that were read.
        done: usize,
        /// The number of all of them.
        all: usize,
    },
}

impl JobKind {
    /// Returns the name in the page's API: a fixed word, or the file's name.
    #[must_use]
    pub fn name(&self) -> &str {
        match self {
            Self::Analyzing => "analysing",
            Self::Computing => "computing the result",
            Self::Matching => "matching",
            Self::Registering => "registering",
            Self::BuildingGraph => "graphing",
            Self::Retargeting => "retargeting",
            Self::HoldingFeet => "holding feet",
            Self::Cleaning => "cleaning",
            Self::BuildingDatabase => "building the database",
            Self::Driving => "driving",
            Self::Reading(file) => file,
            Self::ReadingFiles { .. } => "files",
        }
    }
}

/// Work that is done in slices between frames, for panes that wait for it.
pub(crate) trait Sliced {
    /// Clears the pending requests. Call before a refresh; each pane requests again what it needs.
    fn clear_requests(&mut self);

    /// Does one slice; what takes long is offered as jobs where workers take them. Returns `false`
    /// if there was nothing to do, or workers are at all of it.
    fn work(&mut self, jobs: &mut JobBoard) -> bool;

    /// Returns whether a requested result is available, so that its pane should ask again.
    fn is_ready(&self) -> bool;

    /// Returns the kind of the present work and its progress, 0 to 1; `None` if there is no work,
    /// or none that takes long enough to be shown.
    fn progress(&self) -> Option<(JobKind, f64)>;
}
