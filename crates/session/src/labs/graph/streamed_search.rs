//! Candidates of clips that are too long for keeping their distances, computed by workers.

use super::tiled_search::TiledStep;
use crate::jobs::{JobBoard, StreamTask, Taken, Ticket};
use segue_motion::graph::{
    CandidateSort, CandidateStream, DistanceOverview, FrameSet, GraphError, GraphOptions,
};
use std::sync::Arc;

/// The least number of pairs of parts that one job compares, 4 ms each: jobs have whole rows.
const PAIRS_PER_JOB: usize = 16;

/// The search of a [`CandidateStream`] whose rows are jobs. The parts of the clips are prepared
/// here, too, in slices, because pictures of the distances need them.
#[derive(Debug)]
pub(super) struct StreamedSearch {
    options: GraphOptions,
    stream: CandidateStream,
    /// The jobs that have not ended.
    jobs: Vec<Ticket<StreamTask>>,
}

impl StreamedSearch {
    /// Offers all jobs.
    pub(super) fn begin(
        set: &Arc<FrameSet>,
        options: GraphOptions,
        board: &mut JobBoard,
    ) -> Result<Self, GraphError> {
        let stream = CandidateStream::new(set, &options)?;
        let (parts, body_height) = (stream.parts(), set.body_height());
        let (mut first, mut pairs, mut jobs) = (0, 0, Vec::new());
        for part in 0..parts {
            pairs += parts - part;
            if pairs >= PAIRS_PER_JOB || part + 1 == parts {
                let task = StreamTask { parts: first..part + 1, options, body_height };
                jobs.push(board.offer(task, set.clips()));
                (first, pairs) = (part + 1, 0);
            }
        }
        Ok(Self { options, stream, jobs })
    }

    /// Returns the options of the candidates.
    pub(super) fn options(&self) -> &GraphOptions {
        &self.options
    }

    /// Returns the progress, 0 to 1.
    pub(super) fn progress(&self) -> f64 {
        let progress = self.stream.progress();
        progress.done as f64 / progress.total.max(1) as f64
    }

    /// Prepares a part, or takes the answer to one job, if one has ended.
    pub(super) fn advance(&mut self, board: &mut JobBoard) -> Result<TiledStep, GraphError> {
        if !self.stream.is_prepared() {
            self.stream.advance(1)?;
            return Ok(TiledStep::Took(0.0));
        }
        if self.jobs.is_empty() {
            return Ok(TiledStep::Complete);
        }
        for at in 0..self.jobs.len() {
            match board.take(&self.jobs[at]) {
                Taken::Waits => {}
                Taken::Failed => return Ok(TiledStep::Failed),
                Taken::Answer(rows, secs) => {
                    self.jobs.remove(at);
                    for row in rows {
                        self.stream.include(row);
                    }
                    return Ok(TiledStep::Took(secs));
                }
            }
        }
        Ok(TiledStep::Waits)
    }

    /// Returns the sort of the candidates, and the overview of the distances. All jobs have ended.
    pub(super) fn into_sort(self) -> Result<(CandidateSort, DistanceOverview), GraphError> {
        self.stream.into_sort()
    }
}
