use super::super::{Block, Place};

/// Why a search was made.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
pub enum Reason {
    /// It was time.
    Interval,
    /// The clip ends.
    ClipEnd,
    /// The player asked for something else.
    InputChange,
}

/// Why the controller stayed where it was.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
pub enum Held {
    /// The winner is where it is playing, or next to it.
    Same,
    /// The winner is not better by the continuing bias.
    Bias,
    /// The last jump is too recent.
    MinimumTime,
    /// Not three votes yet.
    Votes,
    /// The input is still, and the winner is in another clip.
    CurrentClip,
    /// No frame has the tags that are asked for.
    Nothing,
}

/// A frame that could be gone to.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Candidate {
    /// Where.
    pub place: Place,
    /// What it costs.
    pub cost: f32,
    /// The same, block by block, in the order of [`Block::ALL`].
    pub split: [f32; Block::COUNT],
}

/// What a search came to.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct SearchRecord {
    /// When, in ticks since the controller began.
    pub tick: u64,
    /// Why.
    pub reason: Reason,
    /// The frame that was playing, and its cost.
    pub current: Candidate,
    /// The frame of least cost among those admitted, or that of a clip that is preferred.
    pub winner: Option<Candidate>,
    /// The best frames of the neighbourhoods, the winner first:
    /// [`super::ControllerOptions::candidates`] of them at most. Beside the winner they are frames
    /// that cost less than those next to them in their clip, the cheapest first.
    pub candidates: Vec<Candidate>,
    /// What kept it from going to the winner; `None` when it went.
    pub held: Option<Held>,
    /// Frames that the search looked at.
    pub visited: usize,
    /// The normalised features that were looked for.
    pub query: Vec<f32>,
}
