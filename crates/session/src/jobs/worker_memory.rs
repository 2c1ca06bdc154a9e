//! The memory of a worker between jobs.

use crate::labs::PairLabs;
use segue_motion::graph::{StreamComputer, TileComputer};
use segue_motion::registration::{DistanceMatrix, PairTerms};
use std::sync::Arc;

/// The intermediate results that a worker keeps between jobs.
#[derive(Debug)]
pub(crate) struct WorkerMemory {
    /// The limit for each of the two, bytes.
    pub(super) max_bytes: usize,
    /// Products of the frames of a set of clips, by the numbers of these.
    pub(super) tiles: Option<(Vec<u32>, TileComputer)>,
    /// The points of a set of long clips, by the numbers of these.
    pub(super) stream: Option<(Vec<u32>, StreamComputer)>,
    /// Products of the frames of two clips, by the numbers of these and the stride, the last one
    /// last.
    pub(super) pairs: Vec<([u32; 2], usize, PairTerms)>,
    /// The last distances of two clips, by their numbers and the stride.
    pub(super) matrix: Option<([u32; 2], usize, Arc<DistanceMatrix>)>,
    /// The labs with their caches, and the numbers of the clips of their last result.
    pub(super) labs: Option<(Vec<u32>, PairLabs)>,
}

impl WorkerMemory {
    /// Returns an empty memory of about `max_bytes`.
    pub(super) fn new(max_bytes: usize) -> Self {
        Self {
            max_bytes: max_bytes / 2,
            tiles: None,
            stream: None,
            pairs: Vec::new(),
            matrix: None,
            labs: None,
        }
    }

    /// Drops what was computed from a clip.
    pub(super) fn forget(&mut self, clip: u32) {
        if self.tiles.as_ref().is_some_and(|(clips, _)| clips.contains(&clip)) {
            self.tiles = None;
        }
        if self.stream.as_ref().is_some_and(|(clips, _)| clips.contains(&clip)) {
            self.stream = None;
        }
        self.pairs.retain(|(clips, _, _)| !clips.contains(&clip));
        if self.matrix.as_ref().is_some_and(|(clips, _, _)| clips.contains(&clip)) {
            self.matrix = None;
        }
        if self.labs.as_ref().is_some_and(|(clips, _)| clips.contains(&clip)) {
            self.labs = None;
        }
    }
}
