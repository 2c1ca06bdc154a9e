//! The candidates for transitions of a set of clips, and the distances that they are found in.

use super::DistanceField;
use super::streamed_search::StreamedSearch;
use super::tiled_search::{TiledSearch, TiledStep};
use crate::jobs::JobBoard;
use crate::params::MAX_PANES;
use segue_motion::graph::{
    AllPairs, CandidateSearch, CandidateSort, CandidateStream, Candidates, CountedTo, FrameSet,
    GraphError, GraphOptions, PausedAllSweep,
};
use segue_motion::registration::Progress;
use std::sync::Arc;

/// The number of pairs of frames in one slice, about a millisecond for 31 joints.
const PAIRS: usize = 100_000;
/// The number of cells of the matrix in one slice.
const CELLS: usize = 250_000;
/// The number of pairs of frames from which on workers compute them; fewer take less time than a
/// worker takes to begin.
const MIN_WORKER_PAIRS: usize = 400_000;
/// Above this number of frames the distance matrix (300 MB) is not kept in memory.
const MAX_FRAMES: usize = 6_000;
/// The number of cells of all distance fields that are kept: 160 MB.
const MAX_CELLS: usize = 40_000_000;
/// The number of candidates that are kept for other thresholds: 50 MB.
const MAX_CANDIDATES: usize = 800_000;

/// Finds candidates in slices, or by workers, and caches what a change of the options does not
/// affect: products of frames for a new window, candidates for a new threshold.
#[derive(Debug, Default)]
pub(super) struct CandidateFinder {
    all: Option<AllPairs>,
    sweep: Option<PausedAllSweep>,
    /// A distance field that is being counted, and the progress.
    counting: Option<(DistanceField, CountedTo)>,
    /// One field for each window that was requested last.
    fields: Vec<Arc<DistanceField>>,
    /// The search in progress, with the options whose threshold it covers.
    search: Option<(GraphOptions, Search)>,
    /// The search in progress by workers.
    by_workers: Option<WorkerSearch>,
    /// The candidates of a search that are being sorted, with its options.
    sorting: Option<(GraphOptions, CandidateSort)>,
    /// Whether workers gave no answer, so that everything is computed in slices.
    in_line: bool,
    /// The last candidates, with their options.
    found: Vec<(GraphOptions, Arc<Candidates>)>,
}

/// The outcome of a slice of the search for candidates.
#[derive(Debug)]
pub(super) enum Searched {
    /// The candidates.
    Found(Arc<Candidates>),
    /// There is more to do; workers took that long for the answer that has arrived, seconds.
    Worked { worker_secs: f64 },
    /// Workers compute everything that is left.
    Waits,
}

/// The stages of a search in slices.
#[derive(Debug)]
enum Search {
    Held(Box<CandidateSearch>),
    Streamed(Box<CandidateStream>),
}

/// A search by workers.
#[derive(Debug)]
enum WorkerSearch {
    Tiled(Box<TiledSearch>),
    Streamed(Box<StreamedSearch>),
}

impl WorkerSearch {
    fn options(&self) -> &GraphOptions {
        match self {
            Self::Tiled(search) => search.options(),
            Self::Streamed(search) => search.options(),
        }
    }

    /// Returns whether its candidates serve a graph.
    fn serves(&self, options: &GraphOptions) -> bool {
        serves(self.options(), options)
    }

    fn progress(&self) -> f64 {
        match self {
            Self::Tiled(search) => search.progress(),
            Self::Streamed(search) => search.progress(),
        }
    }

    fn advance(&mut self, jobs: &mut JobBoard) -> Result<TiledStep, GraphError> {
        match self {
            Self::Tiled(search) => Ok(search.advance(jobs)),
            Self::Streamed(search) => search.advance(jobs),
        }
    }

    /// Returns the distances, if they were asked for, and the sort of the candidates. All jobs have
    /// ended.
    fn into_sort(
        self,
        set: &Arc<FrameSet>,
    ) -> Result<(Option<DistanceField>, CandidateSort), GraphError> {
        match self {
            Self::Tiled(search) => Ok(search.into_sort(set)),
            Self::Streamed(search) => {
                let (sort, overview) = search.into_sort()?;
                Ok((Some(DistanceField::overview(overview)), sort))
            }
        }
    }
}

/// Returns search options with the threshold raised above the requested one, so that moderate
/// increases need no new search. Candidates above the requested threshold are filtered when the
/// graph is built; at most as many as can be kept are found.
fn widened(options: &GraphOptions) -> GraphOptions {
    let most = GraphOptions::MAX_THRESHOLD_CM.max(options.edge_threshold_cm);
    GraphOptions {
        edge_threshold_cm: (1.5 * options.edge_threshold_cm + 4.0).min(most),
        ..*options
    }
}

/// Returns whether the candidates for some options serve others.
fn serves(known: &GraphOptions, options: &GraphOptions) -> bool {
    let alike = GraphOptions {
        edge_threshold_cm: known.edge_threshold_cm,
        most_ways_out: known.most_ways_out,
        ..*options
    };
    alike == *known && options.edge_threshold_cm <= known.edge_threshold_cm
}

/// Returns whether the distances of clips are not kept in memory.
fn is_streamed(set: &FrameSet) -> bool {
    set.frames() > MAX_FRAMES
}

impl CandidateFinder {
    /// Returns the distances of the windows that were requested last.
    pub(super) fn fields(&self) -> &[Arc<DistanceField>] {
        &self.fields
    }

    /// Cancels the jobs of workers.
    pub(super) fn cancel_jobs(&mut self) {
        self.by_workers = None;
    }

    /// Asks workers for the candidates of a graph, where workers are to find them and have not been
    /// asked. The set is that of all calls.
    ///
    /// # Errors
    /// [`GraphError`] with the reason why they cannot be found.
    pub(super) fn begin(
        &mut self,
        set: &Arc<FrameSet>,
        options: &GraphOptions,
        jobs: &mut JobBoard,
    ) -> Result<(), GraphError> {
        let is_under_way = self.is_sorting(options)
            || self.by_workers.as_ref().is_some_and(|search| search.serves(options));
        if self.known(options).is_none() && self.is_for_workers(set, jobs) && !is_under_way {
            self.by_workers = Some(self.begin_by_workers(set, widened(options), jobs)?);
        }
        Ok(())
    }

    /// Does a slice of the search for the candidates of a graph. The set is that of all calls.
    ///
    /// # Errors
    /// [`GraphError`] with the reason why they cannot be found.
    pub(super) fn advance(
        &mut self,
        set: &Arc<FrameSet>,
        options: &GraphOptions,
        jobs: &mut JobBoard,
    ) -> Result<Searched, GraphError> {
        if let Some(found) = self.known(options) {
            return Ok(Searched::Found(Arc::clone(found)));
        }
        if let Some((known, mut sort)) =
            self.sorting.take().filter(|(known, _)| serves(known, options))
        {
            if sort.advance() {
                return Ok(Searched::Found(self.keep_found(known, sort.finish())));
            }
            self.sorting = Some((known, sort));
            return Ok(Searched::Worked { worker_secs: 0.0 });
        }
        self.begin(set, options, jobs)?;
        if let Some(search) = self.by_workers.take().filter(|search| search.serves(options)) {
            return self.take_answer(search, set, jobs);
        }
        self.advance_in_line(set, options)?;
        Ok(Searched::Worked { worker_secs: 0.0 })
    }

    /// Returns the progress of the search for the candidates of a graph, 0 to 1.
    pub(super) fn progress(&self, set: &FrameSet, options: &GraphOptions) -> f64 {
        /// The shares of the time that comparing, sweeping and searching take.
        const SHARES: [f64; 3] = [0.53, 0.33, 0.14];
        let share = |progress: Progress| progress.done as f64 / progress.total.max(1) as f64;
        if self.known(options).is_some() || self.is_sorting(options) {
            return 1.0;
        }
        if let Some(search) = &self.by_workers {
            return search.progress();
        }
        let search = self.search.as_ref().filter(|(known, _)| serves(known, options));
        let searched = match search {
            Some((_, Search::Streamed(stream))) => return share(stream.progress()),
            // The distances are computed by the search for candidates, not before.
            _ if is_streamed(set) => return 0.0,
            Some((_, Search::Held(search))) => share(search.progress()),
            None => 0.0,
        };
        let pairs = self.all.as_ref().map_or(0.0, |all| share(all.progress()));
        let window = options.blend_window;
        let swept = match (&self.sweep, &self.all) {
            _ if self.counting.is_some() || self.has_field(window) => 1.0,
            (Some(sweep), Some(all)) if sweep.window() == window => share(sweep.progress(all)),
            _ => 0.0,
        };
        SHARES[0] * pairs + SHARES[1] * swept + SHARES[2] * searched
    }

    /// Returns whether candidates that serve a graph are being sorted.
    fn is_sorting(&self, options: &GraphOptions) -> bool {
        self.sorting.as_ref().is_some_and(|(known, _)| serves(known, options))
    }

    /// Returns whether workers compute the distances.
    fn is_for_workers(&self, set: &FrameSet, jobs: &JobBoard) -> bool {
        let frames = set.frames();
        frames * (frames + 1) / 2 >= MIN_WORKER_PAIRS
            && jobs.has_workers()
            && !self.in_line
            && self.all.is_none()
            && self.search.is_none()
    }

    /// Takes one of the answers of workers.
    fn take_answer(
        &mut self,
        mut search: WorkerSearch,
        set: &Arc<FrameSet>,
        jobs: &mut JobBoard,
    ) -> Result<Searched, GraphError> {
        match search.advance(jobs)? {
            TiledStep::Waits => {
                self.by_workers = Some(search);
                Ok(Searched::Waits)
            }
            TiledStep::Took(worker_secs) => {
                self.by_workers = Some(search);
                Ok(Searched::Worked { worker_secs })
            }
            TiledStep::Complete => {
                let options = *search.options();
                let (field, sort) = search.into_sort(set)?;
                self.keep_field(field);
                self.sorting = Some((options, sort));
                Ok(Searched::Worked { worker_secs: 0.0 })
            }
            TiledStep::Failed => {
                self.in_line = true;
                Ok(Searched::Worked { worker_secs: 0.0 })
            }
        }
    }

    fn begin_by_workers(
        &self,
        set: &Arc<FrameSet>,
        options: GraphOptions,
        jobs: &mut JobBoard,
    ) -> Result<WorkerSearch, GraphError> {
        Ok(if is_streamed(set) {
            let search = StreamedSearch::begin(set, options, jobs)?;
            WorkerSearch::Streamed(Box::new(search))
        } else {
            let wants_field = !self.has_field(options.blend_window);
            let search = TiledSearch::begin(set, options, wants_field, jobs);
            WorkerSearch::Tiled(Box::new(search))
        })
    }

    /// Does a slice of the search without workers.
    fn advance_in_line(
        &mut self,
        set: &Arc<FrameSet>,
        options: &GraphOptions,
    ) -> Result<(), GraphError> {
        if is_streamed(set) {
            let (widened, mut stream) = match self.search.take() {
                Some((known, Search::Streamed(stream))) if serves(&known, options) => {
                    (known, stream)
                }
                _ => {
                    let options = widened(options);
                    (options, Box::new(CandidateStream::new(set, &options)?))
                }
            };
            if stream.advance(1)?.is_complete() {
                let (sort, overview) = stream.into_sort()?;
                self.keep_field(Some(DistanceField::overview(overview)));
                self.sorting = Some((widened, sort));
                return Ok(());
            }
            self.search = Some((widened, Search::Streamed(stream)));
            return Ok(());
        }
        let Some(all) = &mut self.all else {
            self.all = Some(AllPairs::new(Arc::clone(set))?);
            return Ok(());
        };
        if !all.progress().is_complete() {
            all.advance(PAIRS)?;
            return Ok(());
        }
        let window = options.blend_window;
        let of_window = self.fields.iter().filter(|field| field.window() == window);
        let Some(distances) = of_window.clone().find_map(|field| field.all()) else {
            if let Some((mut field, mut at)) =
                self.counting.take().filter(|(field, _)| field.window() == window)
            {
                if field.count(&mut at, CELLS) {
                    self.keep_field(Some(field));
                } else {
                    self.counting = Some((field, at));
                }
                return Ok(());
            }
            let mut sweep = match self.sweep.take().filter(|sweep| sweep.window() == window) {
                Some(sweep) => sweep.resume(all),
                None => all.sweep(window)?,
            };
            if sweep.advance(CELLS.div_ceil(set.longest().max(1)))?.is_complete() {
                self.counting = Some((DistanceField::held(sweep.finish()?), CountedTo::default()));
            } else {
                self.sweep = Some(sweep.pause());
            }
            return Ok(());
        };
        let (widened, mut search) = match self.search.take() {
            Some((known, Search::Held(search))) if serves(&known, options) => (known, search),
            _ => {
                let options = widened(options);
                (options, Box::new(CandidateSearch::new(distances, &options)?))
            }
        };
        if search.progress().is_complete() {
            self.sorting = Some((widened, search.into_sort()));
            return Ok(());
        }
        search.advance(all, distances, CELLS)?;
        self.search = Some((widened, Search::Held(search)));
        Ok(())
    }

    /// Returns known candidates that serve a graph, if the distances that are shown with it are
    /// also known.
    fn known(&self, options: &GraphOptions) -> Option<&Arc<Candidates>> {
        let is_shown = self.has_field(options.blend_window);
        let mut known = self.found.iter().filter(|(known, _)| is_shown && serves(known, options));
        known.next().map(|(_, found)| found)
    }

    fn has_field(&self, window: usize) -> bool {
        self.fields.iter().any(|field| field.window() == window)
    }

    fn keep_found(&mut self, options: GraphOptions, found: Candidates) -> Arc<Candidates> {
        let found = Arc::new(found);
        // A search with a higher threshold serves all uses of a lower one.
        self.found.retain(|(known, _)| !serves(&options, known));
        self.found.push((options, Arc::clone(&found)));
        let count = |found: &[(GraphOptions, Arc<Candidates>)]| {
            found.iter().map(|(_, found)| found.found().len()).sum::<usize>()
        };
        while self.found.len() > 1
            && (self.found.len() > MAX_PANES || count(&self.found) > MAX_CANDIDATES)
        {
            self.found.remove(0);
        }
        found
    }

    /// Keeps distances, where those of their window are not known: they are the same for every
    /// threshold, so that drawings of the known ones stay valid.
    fn keep_field(&mut self, field: Option<DistanceField>) {
        let Some(field) = field.filter(|field| !self.has_field(field.window())) else {
            return;
        };
        self.fields.push(Arc::new(field));
        while self.fields.len() > MAX_PANES
            || (self.fields.len() > 1
                && self.fields.iter().map(|field| field.cells()).sum::<usize>() > MAX_CELLS)
        {
            self.fields.remove(0);
        }
    }
}
