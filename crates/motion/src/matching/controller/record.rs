//! Records of searches.

use super::super::{Block, Place};

/// The cause of a search.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
pub enum SearchReason {
    /// The search interval has passed.
    Interval,
    /// The clip ends.
    ClipEnd,
    /// The input has changed.
    InputChange,
}

/// The reason why the controller did not jump to the winner.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
pub enum HoldReason {
    /// The winner is the frame that is playing, or next to it.
    Same,
    /// The winner is not better by the continuing bias.
    Bias,
    /// The last jump is too recent.
    MinimumTime,
    /// Fewer than three votes so far.
    Votes,
    /// The input is constant, and the winner is in another clip.
    CurrentClip,
    /// No frame has the required tags.
    Nothing,
}

/// A possible target of a jump.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Candidate {
    /// The frame.
    pub place: Place,
    /// Its cost.
    pub cost: f32,
    /// Its cost block by block, in the order of [`Block::ALL`].
    pub split: [f32; Block::COUNT],
}

/// The result of a search.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct SearchRecord {
    /// The time, in ticks since the controller began.
    pub tick: u64,
    /// The cause.
    pub reason: SearchReason,
    /// The frame that was playing, and its cost.
    pub current: Candidate,
    /// The admitted frame of least cost, or that of a clip that is preferred.
    pub winner: Option<Candidate>,
    /// The best frames of their neighbourhoods, the winner first: at most
    /// [`super::ControllerOptions::candidates`]. All but the winner are frames that cost less than
    /// those next to them in their clip, the cheapest first.
    pub candidates: Vec<Candidate>,
    /// The reason why it did not jump to the winner; `None` when it did.
    pub held: Option<HoldReason>,
    /// Number of frames that the search visited.
    pub visited: usize,
    /// The normalised features of the query.
    pub query: Vec<f32>,
}
