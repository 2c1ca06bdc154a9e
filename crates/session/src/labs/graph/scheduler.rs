//! Scheduling and caching of motion graphs and walks.

use super::super::sliced::{JobKind, Sliced};
use super::built_graph::Building;
use super::candidate_finder::{CandidateFinder, Searched};
use super::requests::{GraphKey, WalkRequest};
use super::walk_builder::WalkBuilder;
use super::{BuiltGraph, DistanceField, GraphClips, GraphInputs};
use crate::jobs::JobBoard;
use crate::labs::LabError;
use crate::labs::pair::{FRAMES_PER_SLICE, FittedClip, Fitting, FittingOptions, retarget_options};
use crate::params::{MAX_PANES, Params};
use segue_motion::clip::Motion;
use segue_motion::graph::GraphError;
use segue_motion::retarget::RetargetOptions;
use std::ops::ControlFlow;
use std::sync::Arc;

/// Builds graphs and walks in slices, and caches what a change does not affect: candidates for a
/// new threshold, the graph for another walk.
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
    finder: CandidateFinder,
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

/// The outcome of a slice.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Progressed {
    /// There may be more to do.
    Worked,
    /// Workers are at what is to be done.
    Waits,
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
        let fields = self.finder.fields();
        let asked = fields.iter().find(|field| Some(field.window()) == window);
        asked.or(fields.last())
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
        let set = self.graph_clips().map(|clips| clips.set());
        let set = set.or(self.measuring_clips.as_ref().map(|clips| clips.set()));
        let found = set.map_or(0.0, |set| self.finder.progress(set, &wanted.graph.options));
        Some(0.1 * fitted + 0.75 * found)
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
        self.begin_comparing(wanted, jobs)?;
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
            match self.finder.advance(graph_clips.set(), &key.options, jobs)? {
                Searched::Found(found) => self.building = Some((key, Building::Found(found))),
                Searched::Worked { worker_secs } => self.add_secs(key, worker_secs),
                Searched::Waits => return Ok(Progressed::Waits),
            }
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

    /// Has workers compare the clips while these are measured here. Options that do not fit them
    /// are refused later: the clips are shown all the same.
    fn begin_comparing(
        &mut self,
        wanted: &WalkRequest,
        jobs: &mut JobBoard,
    ) -> Result<(), GraphError> {
        match (&self.measuring_clips, &wanted.graph.options) {
            (Some(clips), options) if options.check(clips.set()).is_ok() => {
                self.finder.begin(clips.set(), options, jobs)
            }
            _ => Ok(()),
        }
    }

    /// Fits the clips to one skeleton and measures them, a slice in each call; `None` until they
    /// are ready.
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
            self.finder.cancel_jobs();
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
