//! Scheduling and caching of registrations.

use super::super::sliced::{JobKind, Sliced};
use super::{DistanceMap, ExtraClip, RegisterInputs, RegisteredKind};
use crate::choices;
use crate::jobs::{JobBoard, RegistrationAnswer, RegistrationTask, Taken, Ticket};
use crate::labs::LabError;
use crate::labs::feet::Lock;
use crate::labs::pair::Pair;
use crate::params::{Key, MAX_PANES, Params};
use segue_motion::clip::Motion;
use segue_motion::registration::{
    PairTerms, PathEnd, PathError, PathOptions, PausedSweep, Registration, RegistrationError,
    RegistrationOptions, RegistrationPath, TimeWarpSearch, limb_weights, optimal_path,
};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// The number of pairs of frames from which on workers are asked: what takes them longer than to
/// begin.
const FOR_WORKERS: usize = 300_000;
/// The number of pairs of frames that are processed at once: a few seconds of motion need no second
/// slice.
const AT_ONCE: usize = 100_000;
/// The number of pairs in one slice of work: about a millisecond for 31 joints.
const PER_SLICE: usize = 60_000;
/// Above this number of pairs, only every few frames are compared: 48 MiB of terms.
const MAX_PAIRS: f64 = 4e6;

/// A request for registration curves, besides the two clips.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct RegistrationRequest {
    pub(crate) window: usize,
    path: PathOptions,
    smoothing: usize,
}

/// The registration of two clips.
#[derive(Clone, Debug)]
pub(super) struct FoundRegistration {
    pub(super) map: Arc<DistanceMap>,
    pub(super) registration: Arc<Registration>,
    /// Both clips at their own speed from the beginning of the path.
    pub(super) lockstep: Arc<Registration>,
}

/// The registrations of all clips of a blend to A.
#[derive(Debug, Default)]
pub(crate) struct RegistrationSchedulers {
    b: RegistrationScheduler,
    also: Vec<RegistrationScheduler>,
}

impl RegistrationSchedulers {
    /// Prepares the inputs, with which the result is a pure function; `also` are the further clips
    /// on A's skeleton, with their weights. `None` if that takes longer than a frame: call
    /// [`work`](Self::work), then ask again.
    pub(crate) fn inputs(
        &mut self,
        pair: &Arc<Pair>,
        also: &[(Arc<Pair>, f64)],
        params: &Params,
    ) -> Result<Option<RegisterInputs>, LabError> {
        let pins = params.pins().to_vec();
        let found = self.b.found(pair, wanted_of(pair, params, pins)?)?;
        let made = RegisteredKind::of(params);
        let also = if matches!(made, RegisteredKind::Join { .. }) { &[] } else { also };
        self.also.resize_with(also.len(), Default::default);
        let mut more = Vec::with_capacity(also.len());
        for ((pair, weight), scheduler) in also.iter().zip(&mut self.also) {
            // Pins are pairs of A and B.
            let wanted = wanted_of(pair, params, Vec::new())?;
            let found = scheduler.found(pair, wanted)?;
            let (pair, weight) = (Arc::clone(pair), *weight);
            more.push(found.map(|found| ExtraClip { pair, found, weight }));
        }
        let Some((found, also)) = found.zip(more.into_iter().collect::<Option<Vec<_>>>()) else {
            return Ok(None);
        };
        Ok(Some(RegisterInputs {
            pair: Arc::clone(pair),
            found,
            also,
            made,
            is_plain: params.choice::<choices::WarpWith>() == choices::WarpWith::Plain,
            foot_lock: Lock::of(params),
        }))
    }

    /// Returns the distances of A and B that were requested last.
    pub(crate) fn last_map(&self) -> Option<&Arc<DistanceMap>> {
        self.b.last_map()
    }

    fn all(&self) -> impl Iterator<Item = &RegistrationScheduler> {
        std::iter::once(&self.b).chain(&self.also)
    }

    fn all_mut(&mut self) -> impl Iterator<Item = &mut RegistrationScheduler> {
        std::iter::once(&mut self.b).chain(&mut self.also)
    }
}

impl Sliced for RegistrationSchedulers {
    fn clear_requests(&mut self) {
        self.all_mut().for_each(RegistrationScheduler::clear_requests);
    }

    fn work(&mut self, jobs: &mut JobBoard) -> bool {
        // Each offers its jobs, before any of them waits for an answer.
        let worked = self.all_mut().map(|one| one.ask_workers(jobs)).fold(false, |a, b| a | b);
        if worked || self.all_mut().any(|one| one.work(jobs)) {
            return true;
        }
        // A slice of its own: the frame that shows the map would take too long.
        self.last_map().is_some_and(|map| map.make_picture())
    }

    fn is_ready(&self) -> bool {
        self.all().any(RegistrationScheduler::is_ready)
    }

    fn progress(&self) -> Option<(JobKind, f64)> {
        let under_way: Vec<f32> = self.all().filter_map(RegistrationScheduler::progress).collect();
        let ended = self.also.len() + 1 - under_way.len();
        let progress =
            (under_way.iter().sum::<f32>() + ended as f32) / (self.also.len() + 1) as f32;
        (!under_way.is_empty()).then(|| (JobKind::Registering, f64::from(progress)))
    }
}

/// The search for a path.
#[derive(Debug)]
enum Search {
    UnderWay(Box<TimeWarpSearch>),
    Found(RegistrationPath),
}

/// Registers clips in slices, and caches what a change does not affect: products of frames for a
/// new window, distances for a new path.
#[derive(Debug, Default)]
struct RegistrationScheduler {
    pair: Option<Arc<Pair>>,
    stride: usize,
    terms: Option<PairTerms>,
    sweep: Option<PausedSweep>,
    /// The last ones requested, at most one for each pane.
    maps: Vec<Arc<DistanceMap>>,
    search: Option<(RegistrationRequest, Search)>,
    found: Vec<(RegistrationRequest, Result<Arc<FoundRegistration>, LabError>)>,
    /// The requests of the panes.
    wanted: Vec<RegistrationRequest>,
    /// Whether all of them were found and not been fetched yet.
    is_ready: bool,
    /// The requests that workers were asked for.
    offered: Vec<(RegistrationRequest, Ticket<RegistrationTask>)>,
    /// The requests that workers gave no answer to.
    refused: Vec<RegistrationRequest>,
}

impl RegistrationScheduler {
    /// Clears the pending requests. Call before a refresh; each pane requests again what it needs.
    fn clear_requests(&mut self) {
        self.wanted.clear();
        self.is_ready = false;
    }

    /// Returns the registration. `None` if that takes longer than a frame: call
    /// [`work`](Self::work), then ask again.
    fn found(
        &mut self,
        pair: &Arc<Pair>,
        wanted: RegistrationRequest,
    ) -> Result<Option<Arc<FoundRegistration>>, LabError> {
        self.set_pair(pair);
        let at_once =
            pair.a.clip().frames().saturating_mul(pair.incoming.clip().frames()) <= AT_ONCE;
        loop {
            if let Some((_, found)) = self.found.iter().find(|(known, _)| *known == wanted) {
                return found.clone().map(Some);
            }
            if !at_once {
                self.wanted.push(wanted);
                return Ok(None);
            }
            self.step(&wanted);
        }
    }

    /// Returns the distances that were requested last.
    fn last_map(&self) -> Option<&Arc<DistanceMap>> {
        self.maps.last()
    }

    /// Does one slice of the requested work. Returns `false` if there was nothing to do, or workers
    /// are at it.
    fn work(&mut self, jobs: &JobBoard) -> bool {
        let is_known =
            |wanted: &&RegistrationRequest| self.found.iter().any(|(known, _)| known == *wanted);
        let mut open = self.wanted.iter().filter(|wanted| !is_known(wanted));
        let Some(wanted) = open.find(|wanted| !self.is_for_workers(jobs, wanted)).cloned() else {
            return false;
        };
        self.step(&wanted);
        self.is_ready = self.next().is_none();
        true
    }

    /// Returns whether workers find a registration.
    fn is_for_workers(&self, jobs: &JobBoard, wanted: &RegistrationRequest) -> bool {
        let Some(pair) = self.pair.as_ref().filter(|_| jobs.has_workers()) else {
            return false;
        };
        let samples = |clip: &segue_motion::clip::Clip| clip.frames().div_ceil(self.stride.max(1));
        let pairs = samples(pair.a.clip()).saturating_mul(samples(pair.incoming.clip()));
        pairs >= FOR_WORKERS && self.terms.is_none() && !self.refused.contains(wanted)
    }

    /// Asks workers for what is requested, and takes one answer. Returns `false` if there was
    /// nothing to do.
    fn ask_workers(&mut self, jobs: &mut JobBoard) -> bool {
        // Jobs that are no longer requested are cancelled.
        let wanted = &self.wanted;
        self.offered.retain(|(asked, _)| wanted.contains(asked));
        self.refused.retain(|refused| wanted.contains(refused));
        let mut worked = false;
        for wanted in self.wanted.clone() {
            let is_known = self.found.iter().any(|(known, _)| *known == wanted);
            let is_asked = self.offered.iter().any(|(asked, _)| *asked == wanted);
            if is_known || is_asked || !self.is_for_workers(jobs, &wanted) {
                continue;
            }
            if let Some(pair) = &self.pair {
                let task = RegistrationTask {
                    wants_matrix: self
                        .maps
                        .iter()
                        .all(|map| map.matrix().window() != wanted.window),
                    stride: self.stride,
                    request: wanted.clone(),
                };
                let ticket = jobs.offer(task, &[Arc::clone(&pair.a), Arc::clone(&pair.incoming)]);
                self.offered.push((wanted, ticket));
                worked = true;
            }
        }
        for at in 0..self.offered.len() {
            let answer = match jobs.take(&self.offered[at].1) {
                Taken::Waits => continue,
                Taken::Answer(answer, _) => Some(answer),
                Taken::Failed => None,
            };
            let (wanted, _) = self.offered.remove(at);
            match answer.and_then(|answer| self.taken(&wanted, answer)) {
                Some(found) => self.keep(&wanted, Ok(found)),
                None => self.refused.push(wanted),
            }
            self.is_ready = self.next().is_none();
            return true;
        }
        worked
    }

    /// Returns the registration in a worker's answer; `None` where it has none, as where there is
    /// no path.
    fn taken(
        &mut self,
        wanted: &RegistrationRequest,
        answer: RegistrationAnswer,
    ) -> Option<FoundRegistration> {
        let pair = self.pair.as_ref()?;
        if let Some(matrix) = answer.matrix {
            keep_map(&mut self.maps, Arc::new(DistanceMap::new(matrix, pair)));
        }
        let map = self.maps.iter().find(|map| map.matrix().window() == wanted.window)?;
        let [registration, lockstep] = answer.curves?.map(Arc::new);
        Some(FoundRegistration { map: Arc::clone(map), registration, lockstep })
    }

    /// Returns whether a requested result is available, so that its pane should ask again.
    fn is_ready(&self) -> bool {
        self.is_ready
    }

    fn next(&self) -> Option<&RegistrationRequest> {
        let is_known =
            |wanted: &&RegistrationRequest| self.found.iter().any(|(known, _)| known == *wanted);
        self.wanted.iter().find(|wanted| !is_known(wanted))
    }

    /// Returns the progress of the work, 0 to 1; `None` if there is none.
    fn progress(&self) -> Option<f32> {
        let wanted = self.next()?;
        let share = |progress: segue_motion::registration::Progress| {
            progress.done as f32 / progress.total.max(1) as f32
        };
        let terms = self.terms.as_ref().map_or(0.0, |terms| share(terms.progress()));
        let swept = match &self.sweep {
            _ if self.maps.iter().any(|map| map.matrix().window() == wanted.window) => 1.0,
            Some(sweep) if sweep.window() == wanted.window => share(sweep.progress()),
            _ => 0.0,
        };
        Some(0.45 * terms + 0.45 * swept)
    }

    fn set_pair(&mut self, pair: &Arc<Pair>) {
        if self.pair.as_ref().is_some_and(|known| Arc::ptr_eq(known, pair)) {
            return;
        }
        *self = Self { wanted: std::mem::take(&mut self.wanted), ..Self::default() };
        let (a, b) = (pair.a.clip(), pair.incoming.clip());
        let pairs = a.frames() as f64 * b.frames() as f64;
        self.stride = (pairs / MAX_PAIRS).sqrt().ceil().max(1.0) as usize;
        self.pair = Some(Arc::clone(pair));
    }

    /// Does a slice of the most urgent work.
    fn step(&mut self, wanted: &RegistrationRequest) {
        let Some(pair) = self.pair.clone() else {
            self.keep(wanted, Err(LabError::NothingToRegister));
            return;
        };
        let stride = self.stride;
        let rows = (PER_SLICE * stride / pair.incoming.clip().frames().max(1)).max(4);
        let known = self.maps.iter().position(|map| map.matrix().window() == wanted.window);
        let map = known.map(|at| {
            let map = self.maps.remove(at);
            self.maps.push(Arc::clone(&map));
            map
        });
        // The search comes first: where a worker's distances have no path, no terms are computed.
        let found = match map {
            Some(map) => match self.advance_search(wanted, &map, rows) {
                Some(path) => Some((map, path)),
                None => return,
            },
            None => None,
        };
        let terms = match &mut self.terms {
            Some(terms) => terms,
            None => match terms_of(&pair.a, &pair.incoming, stride) {
                Ok(terms) => self.terms.insert(terms),
                Err(error) => {
                    self.keep(wanted, Err(error.into()));
                    return;
                }
            },
        };
        if !terms.progress().is_complete() {
            terms.advance(rows);
            return;
        }
        if let Some((map, path)) = found {
            let found = curves(terms, &map, path, wanted.smoothing).map(|found| {
                let [registration, lockstep] = found.map(Arc::new);
                FoundRegistration { map: Arc::clone(&map), registration, lockstep }
            });
            self.search = None;
            self.keep(wanted, found.map_err(|error| in_frames(error, map.middle())));
            return;
        }
        let begun = self.sweep.take().filter(|sweep| sweep.window() == wanted.window);
        let sweep = match begun {
            Some(sweep) => Ok(sweep.resume(terms)),
            None => terms.sweep(wanted.window, &(0..usize::MAX), &(0..usize::MAX)),
        };
        match sweep {
            Ok(mut sweep) => {
                if !sweep.advance(rows).is_complete() {
                    self.sweep = Some(sweep.pause());
                    return;
                }
                keep_map(&mut self.maps, Arc::new(DistanceMap::new(sweep.finish(), &pair)));
            }
            Err(error) => self.keep(wanted, Err(error.into())),
        }
    }

    /// Returns the path through the distances if it is found. Otherwise does one slice of the
    /// search; if there is no path, keeps the error as the result.
    fn advance_search(
        &mut self,
        wanted: &RegistrationRequest,
        map: &DistanceMap,
        rows: usize,
    ) -> Option<RegistrationPath> {
        if let Some((of, Search::Found(path))) = &self.search
            && of == wanted
        {
            return Some(path.clone());
        }
        let search = match self.search.take().filter(|(of, _)| of == wanted) {
            Some((_, Search::UnderWay(search))) => Ok(search),
            _ => TimeWarpSearch::new(map.matrix(), &in_cells(&wanted.path, map)).map(Box::new),
        };
        let advanced = search.and_then(|mut search| {
            let found = search.advance(map.matrix(), rows)?;
            Ok(found.map_or(Search::UnderWay(search), Search::Found))
        });
        match advanced {
            Ok(search) => self.search = Some((wanted.clone(), search)),
            Err(error) => self.keep(wanted, Err(in_frames(error, map.middle()))),
        }
        None
    }

    fn keep(&mut self, wanted: &RegistrationRequest, found: Result<FoundRegistration, LabError>) {
        if self.found.len() >= 2 * MAX_PANES {
            drop(self.found.remove(0));
        }
        self.found.push((wanted.clone(), found.map(Arc::new)));
    }
}

fn wanted_of(
    pair: &Pair,
    params: &Params,
    pins: Vec<(usize, usize)>,
) -> Result<RegistrationRequest, LabError> {
    let window = params.number(Key::RegistrationWindow) as usize;
    let slack = params.number(Key::EndSlack) / 100.0;
    let end = if params.choice::<choices::Ends>() == choices::Ends::Corner {
        PathEnd::Corner
    } else {
        PathEnd::Border { slack }
    };
    let (frames_a, frames_b) = (pair.a.clip().frames(), pair.incoming.clip().frames());
    if let Some((a, b)) = pins.iter().find(|(a, b)| *a >= frames_a || *b >= frames_b) {
        return Err(LabError::PinBeyond { a: *a, b: *b, frames_a, frames_b });
    }
    let usual = RegistrationOptions::new(pair.a.clip().fps()).smoothing;
    Ok(RegistrationRequest {
        window,
        path: PathOptions {
            slope_limit: params.number(Key::SlopeLimit) as usize,
            start: end,
            end,
            pins,
            ..PathOptions::default()
        },
        smoothing: params.optional(Key::WarpSmoothing).map_or(usual, |frames| frames as usize),
    })
}

/// Returns the options of a path with its pins as cells instead of frames.
fn in_cells(path: &PathOptions, map: &DistanceMap) -> PathOptions {
    let cell = |pin: &(usize, usize)| map.cell_of([pin.0 as f64, pin.1 as f64]).unwrap_or(*pin);
    PathOptions { pins: path.pins.iter().map(cell).collect(), ..path.clone() }
}

/// Adds a map, and drops the oldest one where there are more than panes.
fn keep_map(maps: &mut Vec<Arc<DistanceMap>>, map: Arc<DistanceMap>) {
    if maps.len() >= MAX_PANES {
        maps.remove(0);
    }
    maps.push(map);
}

/// Returns the products of the frames of A, and of B on its skeleton, none of which is computed
/// yet.
pub(crate) fn terms_of(
    a: &Motion,
    b: &Motion,
    stride: usize,
) -> Result<PairTerms, RegistrationError> {
    let (a, b) = (a.clip(), b.clip());
    PairTerms::new(a, 0..a.frames(), b, 0..b.frames(), &limb_weights(a.skeleton()), stride)
}

/// Returns the registration that is requested, and that at equal speed.
pub(crate) fn registered(
    terms: &PairTerms,
    map: &DistanceMap,
    request: &RegistrationRequest,
) -> Result<[Registration; 2], PathError> {
    let path = optimal_path(map.matrix(), &in_cells(&request.path, map))?;
    curves(terms, map, path, request.smoothing)
}

/// Returns the registration along a path through the distances, and that at equal speed.
fn curves(
    terms: &PairTerms,
    map: &DistanceMap,
    path: RegistrationPath,
    smoothing: usize,
) -> Result<[Registration; 2], PathError> {
    let matrix = map.matrix();
    let registration = Registration::along(terms, matrix, path, smoothing)?;
    let (row, column) = registration.path().cells.first().copied().unwrap_or_default();
    let steps = (matrix.rows() - row).min(matrix.columns() - column);
    let cells: Vec<(usize, usize)> = (0..steps).map(|k| (row + k, column + k)).collect();
    let sum: f64 = cells.iter().filter_map(|cell| matrix.get(cell.0, cell.1)).map(f64::from).sum();
    let diagonal = RegistrationPath { pins: Vec::new(), mean_m: sum / steps.max(1) as f64, cells };
    let lockstep = Registration::along(terms, matrix, diagonal, smoothing)?;
    Ok([registration, lockstep])
}

/// Returns the error with the frames that its windows represent.
fn in_frames(error: PathError, middle: usize) -> LabError {
    let moved = |frames: (usize, usize)| (frames.0 + middle, frames.1 + middle);
    LabError::Warp(match error {
        PathError::Pins { first, second } => {
            PathError::Pins { first: moved(first), second: moved(second) }
        }
        PathError::PinAtEnd { pin, end } => PathError::PinAtEnd { pin: moved(pin), end },
        PathError::NoPath { from, to, slope_limit, needed } => {
            PathError::NoPath { from: from.map(moved), to: to.map(moved), slope_limit, needed }
        }
        other => other,
    })
}
