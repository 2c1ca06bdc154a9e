//! Scheduling and caching of motion graphs and walks.

use super::super::sliced::{JobKind, Sliced};
use super::built_graph::Building;
use super::requests::{GraphKey, WalkRequest};
use super::streamed_search::StreamedSearch;
use super::tiled_search::{TiledSearch, TiledStep};
use super::walk_builder::WalkBuilder;
use super::{BuiltGraph, DistanceField, GraphClips, GraphInputs};
use crate::jobs::JobBoard;
use crate::labs::LabError;
use crate::labs::pair::{FRAMES_PER_SLICE, FittedClip, Fitting, FittingOptions, retarget_options};
use crate::params::{MAX_PANES, Params};
use segue_motion::clip::Motion;
use segue_motion::graph::{
    AllPairs, CandidateSearch, CandidateStream, Candidates, CountedTo, DistanceOverview,
    GraphError, GraphOptions, PausedAllSweep,
};
use segue_motion::registration::Progress;
use segue_motion::retarget::RetargetOptions;
use std::ops::ControlFlow;
use std::sync::Arc;

/// The number of pairs of frames in one slice, about a millisecond for 31 joints.
const PAIRS: usize = 100_000;
/// The number of cells of the matrix in one slice.
const CELLS: usize = 250_000;
/// The number of pairs of frames from which on workers are asked: what takes them longer than to
/// begin.
const FOR_WORKERS: usize = 400_000;
/// Above this number of frames the distance matrix (300 MB) is not kept in memory.
const MAX_FRAMES: usize = 6_000;
/// The number of cells of all distance fields that are kept: 160 MB.
const MAX_CELLS: usize = 40_000_000;
/// The number of candidates that are kept for other thresholds: 50 MB.
const MAX_CANDIDATES: usize = 800_000;

/// Builds graphs and walks in slices, and caches what a change does not affect: products of frames
/// for a new window, candidates for a new threshold, the graph for another walk.
#[expect(clippy::struct_excessive_bools, reason = "each is a state of its own")]
#[derive(Debug, Default)]
pub(crate) struct GraphScheduler {
    /// The requested clips, by name and motion.
    clips: Vec<(String, Arc<Motion>)>,
    retarget: RetargetOptions,
    fitted: Vec<FittedClip>,
    /// The clip that is being fitted.
    fitting: Option<Fitting>,
    /// The clips while they are measured.
    measuring_clips: Option<Box<GraphClips>>,
    graph_clips: Option<Result<Arc<GraphClips>, LabError>>,
    all: Option<AllPairs>,
    sweep: Option<PausedAllSweep>,
    /// A distance field that is being counted, and the progress.
    counting: Option<(DistanceField, CountedTo)>,
    /// One field for each window that was requested last.
    fields: Vec<Arc<DistanceField>>,
    /// The search in progress, with the options whose threshold it covers.
    search: Option<(GraphOptions, Search)>,
    /// The search that workers are at.
    tiled: Option<TiledSearch>,
    streamed: Option<StreamedSearch>,
    /// Whether workers gave no answer, and everything is done here.
    in_line: bool,
    /// The last candidates, with their options.
    found: Vec<(GraphOptions, Arc<Candidates>)>,
    building: Option<(GraphKey, Building)>,
    built: Vec<(GraphKey, Result<Arc<BuiltGraph>, LabError>)>,
    builders: Vec<(WalkRequest, Result<WalkBuilder, LabError>)>,
    /// The requests of the panes, the first pane's first.
    wanted: Vec<WalkRequest>,
    now_secs: f64,
    /// Whether there is something new to show.
    is_ready: bool,
    stopped: bool,
    /// The parameters of the walk that the others follow.
    guide: Option<Params>,
    /// Seconds of work for each graph.
    took: Vec<(GraphKey, f64)>,
    worked_for: Option<GraphKey>,
    /// Whether the last slice was one of the last walk.
    stepped: bool,
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

/// The outcome of a slice.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Progressed {
    /// There may be more to do.
    Worked,
    /// Workers are at what is to be done.
    Waits,
}

/// The outcome of a slice of a search for candidates.
#[derive(Debug)]
enum Searched {
    Found(Arc<Candidates>),
    Worked,
    Waits,
}

/// The stages of a search for candidates.
#[derive(Debug)]
enum Search {
    Held(Box<CandidateSearch>),
    Streamed(Box<CandidateStream>),
}

impl GraphScheduler {
    /// Makes walks that are requested from now on follow the walk of these parameters, where their
    /// graphs allow it.
    pub(crate) fn set_guide(&mut self, params: Option<&Params>) {
        self.guide = params.cloned();
    }

    /// Returns a walk as far as it has been made; `None` if that takes longer than a frame: call
    /// [`work`](Self::work), then ask again.
    pub(crate) fn inputs(
        &mut self,
        clips: Vec<(String, Arc<Motion>)>,
        params: &Params,
    ) -> Result<Option<GraphInputs>, LabError> {
        self.set_clips(clips, retarget_options(params));
        let wanted = WalkRequest::guided(params, self.guide.as_ref(), self.clips.len())?;
        let known = self.builders.iter().find(|(known, _)| *known == wanted);
        let found = match (known, &self.graph_clips) {
            (_, Some(Err(problem))) | (Some((_, Err(problem))), _) => Err(problem.clone()),
            (Some((_, Ok(builder))), _) => {
                Ok(builder.walk().map(|walk| GraphInputs(Arc::clone(walk))))
            }
            (None, _) => Ok(None),
        };
        if found.is_ok() {
            self.wanted.push(wanted);
        }
        match found {
            Ok(None) if self.stopped => Err(LabError::Stopped),
            found => found,
        }
    }

    /// Returns the clips, if they are ready.
    pub(crate) fn graph_clips(&self) -> Option<&Arc<GraphClips>> {
        self.graph_clips.as_ref()?.as_ref().ok()
    }

    /// Returns the distances that the first pane requested, or the last ones while it waits.
    pub(crate) fn field(&self) -> Option<&Arc<DistanceField>> {
        let window = self.wanted.first().map(|wanted| wanted.graph.options.blend_window);
        let asked = self.fields.iter().find(|field| Some(field.window()) == window);
        asked.or(self.fields.last())
    }

    /// Returns the graph that the first pane requested, if it is ready.
    pub(crate) fn built(&self) -> Option<&Arc<BuiltGraph>> {
        let key = self.wanted.first()?.graph;
        self.known(key)?.as_ref().ok()
    }

    fn known(&self, key: GraphKey) -> Option<&Result<Arc<BuiltGraph>, LabError>> {
        self.built.iter().find(|(known, _)| *known == key).map(|(_, built)| built)
    }

    /// Returns the time that building a graph took, seconds; `None` if it was not measured.
    pub(crate) fn build_secs(&self, built: &BuiltGraph) -> Option<f64> {
        self.took.iter().find(|(key, _)| *key == built.key).map(|(_, secs)| *secs)
    }

    /// Records the duration of the last slice, seconds.
    pub(crate) fn took(&mut self, secs: f64) {
        if let (true, Some((_, Ok(builder)))) = (self.stepped, self.builders.last_mut()) {
            builder.took(secs);
        }
        self.stepped = false;
        if let Some(key) = self.worked_for.take() {
            self.add_secs(key, secs);
        }
    }

    /// Adds to the time that a graph took, seconds.
    fn add_secs(&mut self, key: GraphKey, secs: f64) {
        match self.took.iter_mut().find(|(known, _)| *known == key) {
            Some((_, sum)) => *sum += secs,
            None => self.took.push((key, secs)),
        }
        let extra = self.took.len().saturating_sub(16);
        self.took.drain(..extra);
    }

    /// Stops the work in progress, or resumes it.
    pub(crate) fn stop(&mut self, stopped: bool) {
        self.stopped = stopped;
    }

    /// Returns whether the work was stopped.
    pub(crate) fn is_stopped(&self) -> bool {
        self.stopped
    }

    /// Sets the playhead, seconds, so that walks are extended before it reaches their end.
    pub(crate) fn play_at(&mut self, now_secs: f64) {
        self.now_secs = now_secs;
    }

    /// Returns the progress of the requested work, 0 to 1; `None` if panes wait for nothing.
    fn share_done(&self) -> Option<f64> {
        if self.stopped {
            return None;
        }
        let wanted = self.next()?;
        let share = |progress: Progress| progress.done as f64 / progress.total.max(1) as f64;
        match self.builders.iter().find(|(known, _)| known == wanted) {
            // The extension of a walk is not waited for.
            Some((_, Ok(builder))) if builder.walk().is_some() && !builder.is_searching() => {
                return None;
            }
            Some((_, Ok(builder))) => return Some(0.85 + 0.15 * builder.progress()),
            _ if self.known(wanted.graph).is_some() => return Some(0.85),
            _ => {}
        }
        let fitting = self.fitting.as_ref().map_or(0.0, |fitting| f64::from(fitting.progress()));
        let fitted = (self.fitted.len() as f64 + fitting) / self.clips.len().max(1) as f64;
        let by_workers = self.tiled.as_ref().map(TiledSearch::progress);
        let by_workers = by_workers.or(self.streamed.as_ref().map(StreamedSearch::progress));
        if let Some(progress) = by_workers {
            return Some(0.1 * fitted + 0.75 * progress);
        }
        let pairs = self.all.as_ref().map_or(0.0, |all| share(all.progress()));
        let window = wanted.graph.options.blend_window;
        let swept = if self.fields.iter().any(|field| field.window() == window) {
            1.0
        } else {
            match (&self.sweep, &self.all) {
                _ if self.counting.is_some() => 1.0,
                (Some(sweep), Some(all)) if sweep.window() == window => share(sweep.progress(all)),
                _ => 0.0,
            }
        };
        let is_found = self.places(&wanted.graph.options).is_some();
        let searched = match &self.search {
            _ if is_found => return Some(0.85),
            Some((known, search)) if serves(known, &wanted.graph.options) => match search {
                Search::Held(search) => share(search.progress()),
                Search::Streamed(stream) => {
                    return Some(0.1 * fitted + 0.75 * share(stream.progress()));
                }
            },
            // In this mode the distances are computed by the search for candidates, not before.
            _ if self.is_streamed() => return Some(0.1 * fitted),
            _ => 0.0,
        };
        Some(0.1 * fitted + 0.4 * pairs + 0.25 * swept + 0.1 * searched)
    }

    fn builder(&self, wanted: &WalkRequest) -> Option<&Result<WalkBuilder, LabError>> {
        self.builders.iter().find(|(known, _)| known == wanted).map(|(_, builder)| builder)
    }

    fn next(&self) -> Option<&WalkRequest> {
        let builder = |wanted: &WalkRequest| self.builder(wanted);
        let short = |wanted: &&WalkRequest| match builder(wanted) {
            Some(Ok(builder)) => builder.is_short(self.now_secs),
            Some(Err(_)) => false,
            None => true,
        };
        let begins = |wanted: &&WalkRequest| !matches!(builder(wanted), Some(Ok(builder)) if builder.walk().is_some());
        // The first view of a walk takes precedence over the extension of another.
        let first = self.wanted.iter().filter(short).find(begins);
        first.or_else(|| self.wanted.iter().find(short))
    }

    /// Discards everything for other clips, and for others on the skeleton of the first.
    fn set_clips(&mut self, clips: Vec<(String, Arc<Motion>)>, retarget: RetargetOptions) {
        let same = clips.len() == self.clips.len()
            && clips.iter().zip(&self.clips).all(|(a, b)| a.0 == b.0 && Arc::ptr_eq(&a.1, &b.1));
        if !same || retarget != self.retarget {
            *self = Self { clips, retarget, guide: self.guide.take(), ..Self::default() };
        }
    }

    /// Does a slice of the most urgent work.
    fn step(&mut self, wanted: &WalkRequest, jobs: &mut JobBoard) -> Result<Progressed, LabError> {
        if let Some(guide) = &wanted.guide {
            // Without the walk to follow, this one would be random. If that one has failed, there
            // is nothing to follow.
            let is_to_be_made = match self.builder(guide) {
                Some(Ok(builder)) => builder.is_short(self.now_secs),
                Some(Err(_)) => false,
                None => true,
            };
            if is_to_be_made {
                return Ok(self.step(guide, jobs).unwrap_or_else(|problem| {
                    self.settle(guide, Err(problem));
                    Progressed::Worked
                }));
            }
        }
        if let Some(at) = self.builders.iter().position(|(known, _)| known == wanted) {
            let entry = self.builders.remove(at);
            self.builders.push(entry);
            self.stepped = true;
            if let Some(((_, Ok(builder)), others)) = self.builders.split_last_mut() {
                let guide = wanted
                    .guide
                    .as_deref()
                    .and_then(|guide| others.iter_mut().find(|(known, _)| known == guide));
                let guide = guide.and_then(|(_, guide)| Some(guide.as_mut().ok()?.plan()));
                self.is_ready |= builder.step(self.now_secs, guide)?;
            }
            return Ok(Progressed::Worked);
        }
        let Some(graph_clips) = self.ready_graph_clips()? else {
            return Ok(Progressed::Worked);
        };
        wanted.graph.options.check(graph_clips.set())?;
        if let Some(built) = self.known(wanted.graph) {
            let built = Arc::clone(built.as_ref().map_err(LabError::clone)?);
            let like = self.builders.iter().filter_map(|(_, builder)| builder.as_ref().ok());
            let builder = WalkBuilder::new(&built, wanted, like);
            self.settle(wanted, builder);
            return Ok(Progressed::Worked);
        }
        self.worked_for = Some(wanted.graph);
        let key = wanted.graph;
        let Some((_, building)) = self.building.take().filter(|(known, _)| *known == key) else {
            let found = match self.search_slice(&graph_clips, key, jobs)? {
                Searched::Found(found) => found,
                Searched::Worked => return Ok(Progressed::Worked),
                Searched::Waits => return Ok(Progressed::Waits),
            };
            self.building = Some((key, Building::Found(found)));
            return Ok(Progressed::Worked);
        };
        let found = match building.advance(&graph_clips, key) {
            Ok(ControlFlow::Continue(building)) => {
                self.building = Some((key, building));
                return Ok(Progressed::Worked);
            }
            Ok(ControlFlow::Break(built)) => Ok(Arc::new(built)),
            Err(error) => Err(error.into()),
        };
        if self.built.len() >= 2 * MAX_PANES {
            drop(self.built.remove(0));
        }
        self.built.push((wanted.graph, found));
        Ok(Progressed::Worked)
    }

    /// Fits the clips to one skeleton, a part of one in each slice.
    fn ready_graph_clips(&mut self) -> Result<Option<Arc<GraphClips>>, LabError> {
        if let Some(graph_clips) = &self.graph_clips {
            return graph_clips.clone().map(Some);
        }
        if let (Some((name, next)), Some((_, first))) =
            (self.clips.get(self.fitted.len()), self.clips.first())
        {
            let slice = match self.fitting.take() {
                Some(fitting) => fitting.advance(FRAMES_PER_SLICE),
                None => Fitting::new(first, next, FittingOptions::at_rate_of_a(self.retarget)),
            };
            match slice {
                Ok(ControlFlow::Continue(fitting)) => self.fitting = Some(fitting),
                Ok(ControlFlow::Break(ready)) => self.fitted.push(ready),
                Err(problem) => {
                    self.graph_clips = Some(Err(LabError::OfClip {
                        name: name.clone(),
                        error: Box::new(problem),
                    }));
                }
            }
            return Ok(None);
        }
        if let Some(mut measuring_clips) = self.measuring_clips.take() {
            if measuring_clips.advance() {
                self.graph_clips = Some(Ok(Arc::from(measuring_clips)));
            } else {
                self.measuring_clips = Some(measuring_clips);
            }
            return Ok(None);
        }
        let names = self.clips.iter().map(|(name, _)| name.clone()).collect();
        // All clips are fitted at this point.
        match GraphClips::new(names, self.fitted.clone()) {
            Ok(graph_clips) => self.measuring_clips = Some(Box::new(graph_clips)),
            Err(problem) => self.graph_clips = Some(Err(problem)),
        }
        Ok(None)
    }

    /// Does a slice of the search for candidates; returns them when they are found.
    fn search_slice(
        &mut self,
        graph_clips: &Arc<GraphClips>,
        key: GraphKey,
        jobs: &mut JobBoard,
    ) -> Result<Searched, GraphError> {
        if let Some(found) = self.places(&key.options) {
            return Ok(Searched::Found(Arc::clone(found)));
        }
        if self.is_for_workers(jobs) {
            return if self.is_streamed() {
                self.stream_by_workers(graph_clips, key, jobs)
            } else {
                Ok(self.ask_workers(graph_clips, key, jobs))
            };
        }
        Ok(self.slice_in_line(graph_clips, key)?.map_or(Searched::Worked, Searched::Found))
    }

    /// Returns whether workers compute the distances.
    fn is_for_workers(&self, jobs: &JobBoard) -> bool {
        let frames = self.graph_clips().map_or(0, |graph_clips| graph_clips.set().frames());
        let is_long = frames * (frames + 1) / 2 >= FOR_WORKERS;
        is_long
            && jobs.has_workers()
            && !self.in_line
            && self.all.is_none()
            && self.search.is_none()
    }

    /// Asks workers for the candidates, and for the distances where they are not known, or takes
    /// one of their answers.
    fn ask_workers(
        &mut self,
        graph_clips: &Arc<GraphClips>,
        key: GraphKey,
        jobs: &mut JobBoard,
    ) -> Searched {
        let under_way = self.tiled.take().filter(|tiled| serves(tiled.options(), &key.options));
        let mut tiled = under_way.unwrap_or_else(|| {
            let window = key.options.blend_window;
            let wants_field = self.fields.iter().all(|field| field.window() != window);
            TiledSearch::begin(graph_clips, widened(&key.options), wants_field, jobs)
        });
        match tiled.advance(jobs) {
            TiledStep::Waits => {
                self.tiled = Some(tiled);
                Searched::Waits
            }
            TiledStep::Took(secs) => {
                self.add_secs(key, secs);
                self.tiled = Some(tiled);
                Searched::Worked
            }
            TiledStep::Complete => {
                let options = *tiled.options();
                let (field, found) = tiled.finish(graph_clips.set());
                if let Some(field) = field {
                    self.keep_field(Arc::new(field));
                }
                Searched::Found(self.keep_found(options, found))
            }
            TiledStep::Failed => {
                self.in_line = true;
                Searched::Worked
            }
        }
    }

    /// Asks workers for the candidates of clips that are too long for keeping their distances, or
    /// takes one of their answers.
    fn stream_by_workers(
        &mut self,
        graph_clips: &Arc<GraphClips>,
        key: GraphKey,
        jobs: &mut JobBoard,
    ) -> Result<Searched, GraphError> {
        let under_way = self.streamed.take().filter(|known| serves(known.options(), &key.options));
        let mut streamed = match under_way {
            Some(streamed) => streamed,
            None => StreamedSearch::begin(graph_clips, widened(&key.options), jobs)?,
        };
        match streamed.advance(jobs)? {
            TiledStep::Waits => {
                self.streamed = Some(streamed);
                Ok(Searched::Waits)
            }
            TiledStep::Took(secs) => {
                self.add_secs(key, secs);
                self.streamed = Some(streamed);
                Ok(Searched::Worked)
            }
            TiledStep::Complete => {
                let options = *streamed.options();
                let (found, overview) = streamed.finish()?;
                self.keep_overview(overview);
                Ok(Searched::Found(self.keep_found(options, found)))
            }
            TiledStep::Failed => {
                self.in_line = true;
                Ok(Searched::Worked)
            }
        }
    }

    /// Keeps the distances of long clips, where they are not known: they are the same for every
    /// threshold, so that drawings of them stay valid.
    fn keep_overview(&mut self, overview: DistanceOverview) {
        if self.fields.iter().all(|field| field.window() != overview.window()) {
            self.keep_field(Arc::new(DistanceField::overview(overview)));
        }
    }

    /// Does a slice of the search for candidates here.
    fn slice_in_line(
        &mut self,
        graph_clips: &Arc<GraphClips>,
        key: GraphKey,
    ) -> Result<Option<Arc<Candidates>>, GraphError> {
        if self.is_streamed() {
            let (options, mut stream) = match self.search.take() {
                Some((known, Search::Streamed(stream))) if serves(&known, &key.options) => {
                    (known, stream)
                }
                _ => {
                    let options = widened(&key.options);
                    (options, Box::new(CandidateStream::new(graph_clips.set(), &options)?))
                }
            };
            if stream.advance(1)?.is_complete() {
                let (found, overview) = stream.finish()?;
                self.keep_overview(overview);
                return Ok(Some(self.keep_found(options, found)));
            }
            self.search = Some((options, Search::Streamed(stream)));
            return Ok(None);
        }
        let Some(all) = &mut self.all else {
            self.all = Some(AllPairs::new(Arc::clone(graph_clips.set()))?);
            return Ok(None);
        };
        if !all.progress().is_complete() {
            all.advance(PAIRS)?;
            return Ok(None);
        }
        let window = key.options.blend_window;
        let known = self
            .fields
            .iter()
            .filter(|field| field.window() == window)
            .find_map(|field| field.all());
        let Some(distances) = known else {
            if let Some((mut field, mut at)) =
                self.counting.take().filter(|(field, _)| field.window() == window)
            {
                if field.count(&mut at, CELLS) {
                    self.keep_field(Arc::new(field));
                } else {
                    self.counting = Some((field, at));
                }
                return Ok(None);
            }
            let mut sweep = match self.sweep.take().filter(|sweep| sweep.window() == window) {
                Some(sweep) => sweep.resume(all),
                None => all.sweep(window)?,
            };
            if sweep.advance(CELLS.div_ceil(graph_clips.set().longest().max(1)))?.is_complete() {
                self.counting = Some((DistanceField::held(sweep.finish()?), CountedTo::default()));
            } else {
                self.sweep = Some(sweep.pause());
            }
            return Ok(None);
        };
        let (options, mut search) = match self.search.take() {
            Some((known, Search::Held(search))) if serves(&known, &key.options) => (known, search),
            _ => {
                let options = widened(&key.options);
                (options, Box::new(CandidateSearch::new(distances, &options)?))
            }
        };
        // Sorting the candidates takes a slice of its own.
        if search.progress().is_complete() {
            return Ok(Some(self.keep_found(options, search.finish())));
        }
        search.advance(all, distances, CELLS)?;
        self.search = Some((options, Search::Held(search)));
        Ok(None)
    }

    /// Returns whether the distances are not kept in memory.
    fn is_streamed(&self) -> bool {
        self.graph_clips().is_some_and(|graph_clips| graph_clips.set().frames() > MAX_FRAMES)
    }

    /// Returns known candidates that serve a graph, if the distances that are shown with it are
    /// also known.
    fn places(&self, options: &GraphOptions) -> Option<&Arc<Candidates>> {
        let is_shown = self.fields.iter().any(|field| field.window() == options.blend_window);
        let mut known = self.found.iter().filter(|(known, _)| is_shown && serves(known, options));
        known.next().map(|(_, found)| found)
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

    fn keep_field(&mut self, field: Arc<DistanceField>) {
        self.fields.push(field);
        while self.fields.len() > MAX_PANES
            || (self.fields.len() > 1
                && self.fields.iter().map(|field| field.cells()).sum::<usize>() > MAX_CELLS)
        {
            self.fields.remove(0);
        }
    }

    fn settle(&mut self, wanted: &WalkRequest, builder: Result<WalkBuilder, LabError>) {
        self.is_ready |= builder.is_err();
        self.builders.retain(|(known, _)| known != wanted);
        if self.builders.len() >= 2 * MAX_PANES {
            // Drops the oldest walk that no pane shows and no walk follows.
            let unwanted = self.builders.iter().position(|(known, _)| !self.wanted.contains(known));
            drop(self.builders.remove(unwanted.unwrap_or(0)));
        }
        self.builders.push((wanted.clone(), builder));
    }
}

impl Sliced for GraphScheduler {
    fn clear_requests(&mut self) {
        self.wanted.clear();
        self.is_ready = false;
    }

    fn work(&mut self, jobs: &mut JobBoard) -> bool {
        (self.worked_for, self.stepped) = (None, false);
        if self.is_ready {
            return false;
        }
        let next = if self.stopped { None } else { self.next().cloned() };
        let Some(wanted) = next else {
            // Jobs of workers for what is not requested any more are cancelled.
            (self.tiled, self.streamed) = (None, None);
            return false;
        };
        match self.step(&wanted, jobs) {
            Ok(progressed) => progressed == Progressed::Worked,
            Err(problem) => {
                self.settle(&wanted, Err(problem));
                self.is_ready = true;
                true
            }
        }
    }

    fn is_ready(&self) -> bool {
        self.is_ready
    }

    fn progress(&self) -> Option<(JobKind, f64)> {
        Some((JobKind::BuildingGraph, self.share_done()?))
    }
}
