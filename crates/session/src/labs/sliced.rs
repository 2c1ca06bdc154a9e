//! Work that takes longer than a frame, and is done in slices.

/// The kinds of work that is done in slices.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum JobKind {
    /// The best place for a transition is searched for.
    Matching,
    /// Clips are registered in time.
    Registering,
    /// A motion graph is built.
    BuildingGraph,
    /// Planted feet are held.
    HoldingFeet,
    /// The features of clips are computed for motion matching.
    BuildingDatabase,
    /// Recorded input is played.
    Driving,
    /// A file is read; its name.
    Reading(String),
}

impl JobKind {
    /// The name in the page's API: a word of its own, or the file's name.
    #[must_use]
    pub fn name(&self) -> &str {
        match self {
            Self::Matching => "matching",
            Self::Registering => "registering",
            Self::BuildingGraph => "graphing",
            Self::HoldingFeet => "holding feet",
            Self::BuildingDatabase => "building the database",
            Self::Driving => "driving",
            Self::Reading(file) => file,
        }
    }
}

/// Work that is done in slices, between frames, for panes that wait for it.
pub(crate) trait Sliced {
    /// Forgets which panes wait: all are about to ask again.
    fn ask_anew(&mut self);

    /// Does one slice. Returns `false` when there was nothing to do.
    fn work(&mut self) -> bool;

    /// Returns whether something that a pane waits for is there, so that it should ask again.
    fn is_ready(&self) -> bool;

    /// Returns the kind of the present work and how much of it is done, 0 to 1; `None` without work
    /// that is worth telling.
    fn progress(&self) -> Option<(JobKind, f64)>;
}
