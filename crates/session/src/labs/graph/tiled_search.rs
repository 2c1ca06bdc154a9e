//! Distances and candidates of the Graph lab, computed by workers.

use super::DistanceField;
use crate::jobs::{DistanceTask, JobBoard, Taken, Ticket};
use segue_motion::graph::{
    CandidateSort, DistanceOverview, DistanceTile, FrameDistances, FrameSet, GraphOptions,
    TileCandidates, TileDistances,
};
use std::sync::Arc;

/// The number of distances of one job, a multiple of some milliseconds; a tile is not divided.
const CELLS_PER_JOB: usize = 200_000;

/// The distances and the candidates of a set as jobs.
#[derive(Debug)]
pub(super) struct TiledSearch {
    options: GraphOptions,
    wants_field: bool,
    /// The jobs that have not ended, each with its tiles and the number of their distances.
    jobs: Vec<(Vec<DistanceTile>, usize, Ticket<DistanceTask>)>,
    cells: usize,
    done: usize,
    distances: Vec<(DistanceTile, Vec<f32>)>,
    counts: Vec<u32>,
    candidates: Vec<TileCandidates>,
}

/// The state of the jobs of a search.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum TiledStep {
    /// No job has ended meanwhile.
    Waits,
    /// A job has ended, which took that many seconds.
    Took(f64),
    /// All have ended.
    Complete,
    /// Workers cannot run one of them.
    Failed,
}

impl TiledSearch {
    /// Offers all jobs. `options` are those of the candidates; with `wants_field` the distances are
    /// asked for, too.
    pub(super) fn begin(
        set: &Arc<FrameSet>,
        options: GraphOptions,
        wants_field: bool,
        board: &mut JobBoard,
    ) -> Self {
        let mut search = Self {
            options,
            wants_field,
            jobs: Vec::new(),
            cells: 0,
            done: 0,
            distances: Vec::new(),
            counts: vec![0; DistanceOverview::BINS],
            candidates: Vec::new(),
        };
        let (mut tiles, mut cells) = (Vec::new(), 0);
        let mut rest = DistanceTile::all(set, options.blend_window).into_iter().peekable();
        while let Some(tile) = rest.next() {
            cells += tile.cells(set, options.blend_window);
            tiles.push(tile);
            if cells < CELLS_PER_JOB && rest.peek().is_some() {
                continue;
            }
            let tiles = std::mem::take(&mut tiles);
            let task = DistanceTask {
                tiles: tiles.clone(),
                options,
                body_height: set.body_height(),
                wants_distances: wants_field,
            };
            search.jobs.push((tiles, cells, board.offer(task, set.clips())));
            search.cells += std::mem::take(&mut cells);
        }
        search
    }

    /// Returns the options of the candidates.
    pub(super) fn options(&self) -> &GraphOptions {
        &self.options
    }

    /// Returns the progress, 0 to 1.
    pub(super) fn progress(&self) -> f64 {
        self.done as f64 / self.cells.max(1) as f64
    }

    /// Takes the answer to one job, if one has ended.
    pub(super) fn advance(&mut self, board: &mut JobBoard) -> TiledStep {
        if self.jobs.is_empty() {
            return TiledStep::Complete;
        }
        for at in 0..self.jobs.len() {
            match board.take(&self.jobs[at].2) {
                Taken::Waits => {}
                Taken::Failed => return TiledStep::Failed,
                Taken::Answer(answer, secs) => {
                    let (tiles, cells, _) = self.jobs.remove(at);
                    self.done += cells;
                    for (tile, TileDistances { rms_m, counts, candidates }) in
                        tiles.into_iter().zip(answer)
                    {
                        for (sum, count) in self.counts.iter_mut().zip(counts) {
                            *sum += count;
                        }
                        self.candidates.push(candidates);
                        self.distances.push((tile, rms_m));
                    }
                    return TiledStep::Took(secs);
                }
            }
        }
        TiledStep::Waits
    }

    /// Returns the distances, if they were asked for, and the sort of the candidates. All jobs have
    /// ended.
    pub(super) fn into_sort(self, set: &Arc<FrameSet>) -> (Option<DistanceField>, CandidateSort) {
        let field = self.wants_field.then(|| {
            let window = self.options.blend_window;
            let distances = FrameDistances::of_tiles(set, window, self.distances);
            DistanceField::counted(distances, self.counts)
        });
        (field, CandidateSort::of_tiles(set, &self.options, self.candidates))
    }
}
