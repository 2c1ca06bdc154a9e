//! The search for a walk along a path on the ground.

use super::{GraphError, Jump, MotionGraph, StitchOptions, Stitcher, Way};
use crate::math::Planar;
use glam::DVec2;
use petgraph::graph::{EdgeIndex, NodeIndex};
use petgraph::visit::EdgeRef;
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::sync::Arc;

/// The time over which the search looks ahead, seconds.
const HORIZON_SECS: f64 = 4.0;
/// The duration of the beginning of a search's result that is kept, seconds.
const COMMITTED_SECS: f64 = 1.0;
/// The cost of a second on the path itself, m²·s⁻¹: without it standing still would be best.
const STANDSTILL_COST: f64 = 0.05;
/// The number of frames between samples of the trajectory.
const FRAMES_PER_SAMPLE: usize = 4;

/// A polyline on the ground along which a walk is searched.
#[derive(Clone, Debug, PartialEq)]
pub struct GroundPath {
    points: Vec<DVec2>,
    /// Distance from the start to each point, metres.
    lengths: Vec<f64>,
}

impl GroundPath {
    /// Returns the polyline through these points, (x, z) in metres. Points that are not finite, or
    /// repeat the one before, are left out.
    ///
    /// # Errors
    /// [`GraphError::Setting`] when it is shorter than 10 cm.
    pub fn new(points: &[DVec2]) -> Result<Self, GraphError> {
        let mut path = Self { points: Vec::new(), lengths: Vec::new() };
        for &point in points.iter().filter(|point| point.is_finite()) {
            let step = path.points.last().map_or(0.0, |last| last.distance(point));
            if path.points.is_empty() || step > 1e-6 {
                path.lengths.push(path.length() + step);
                path.points.push(point);
            }
        }
        if !(0.1..=1e5).contains(&path.length()) {
            return Err(GraphError::Setting {
                what: "a path (in metres)",
                value: path.length(),
                least: 0.1,
                most: 1e5,
            });
        }
        Ok(path)
    }

    /// Returns the length, metres.
    #[must_use]
    pub fn length(&self) -> f64 {
        self.lengths.last().copied().unwrap_or(0.0)
    }

    /// Returns the point at this distance from the start, clamped to the ends.
    #[must_use]
    pub fn at(&self, metres: f64) -> DVec2 {
        let next = self.lengths.partition_point(|&length| length <= metres);
        match (
            next.checked_sub(1)
                .and_then(|last| Some((self.points.get(last)?, self.lengths.get(last)?))),
            self.points.get(next),
        ) {
            (Some((from, start)), Some(to)) => {
                from.lerp(*to, (metres - start) / from.distance(*to))
            }
            (Some((from, _)), None) => *from,
            (None, first) => first.copied().unwrap_or(DVec2::ZERO),
        }
    }
}

/// A walk through a graph along a path.
#[derive(Clone, Debug, PartialEq)]
pub struct FollowedWalk {
    /// Its edges, from the start node on, for [`Walker::take`](super::Walker::take).
    pub edges: Vec<EdgeIndex>,
    /// The transform of the first clip: `world_from_clip`.
    pub world_from_first: Planar,
    /// Root mean square distance from the path, metres.
    pub rms_m: f64,
    /// Distance covered along the path, metres.
    pub along_m: f64,
    /// Whether the end of the path is reached.
    pub arrives: bool,
    /// Number of nodes visited.
    pub looked_at: usize,
}

/// Finds a walk through the graph whose trajectory stays close to a path (Kovar, Gleicher, Pighin
/// 2002, section 5): branch and bound over the next few seconds, of which the first is kept, and so
/// on.
///
/// The cost is the squared distance, integrated over time, between the character and the point of
/// the path at the distance that the character has walked, plus a little per second. `budget` is
/// the number of nodes that are visited in all; when it is used up, the best walk so far is
/// returned. The character starts at node `start`, at the path's first point, and faces along it.
///
/// The limit is a number of nodes and not a time, so that every machine finds the same walk, and a
/// link that holds a path shows the same everywhere. For a preview before the end use
/// [`FollowSearch::so_far`].
///
/// Clips are aligned as by a [`Stitcher`] with these options, so that its walk has the planned
/// trajectory. Overlapping transitions are planned from the clip that is left; there the trajectory
/// may be off by centimetres.
#[must_use]
pub fn follow(
    graph: &MotionGraph,
    start: NodeIndex,
    path: &GroundPath,
    budget: usize,
    options: &StitchOptions,
) -> FollowedWalk {
    let mut search = FollowSearch::new(graph, start, path, budget, options);
    while !search.advance(graph, path, usize::MAX) {}
    search.so_far(graph, path)
}

/// The search of [`follow`] in slices of a number of nodes. The slices do not change the result.
#[derive(Clone, Debug)]
pub struct FollowSearch {
    stitcher: Stitcher,
    /// The transforms of entered clips by visited transitions, by their indices:
    /// `left_from_entered`.
    placings: RefCell<BTreeMap<usize, Planar>>,
    world_from_first: Planar,
    here: State,
    edges: Vec<EdgeIndex>,
    looked_at: usize,
    budget: usize,
    /// The search ahead of `here`.
    ahead: Option<SearchAhead>,
    is_over: bool,
}

impl FollowSearch {
    /// Begins the search at the start; the arguments are those of [`follow`].
    #[must_use]
    pub fn new(
        graph: &MotionGraph,
        start: NodeIndex,
        path: &GroundPath,
        budget: usize,
        options: &StitchOptions,
    ) -> Self {
        let world_from_first = first_place(graph, start, path);
        // Deliberate mistakes are made when the walk is stitched, not in its plan.
        let options = StitchOptions { mistake: None, ..*options };
        Self {
            stitcher: Stitcher::new(Arc::clone(graph.set()), &options),
            placings: RefCell::default(),
            world_from_first,
            here: State {
                node: start,
                world: world_from_first,
                last: None,
                along: 0.0,
                cost: 0,
                square: 0.0,
                frames: 0,
            },
            edges: Vec::new(),
            looked_at: 0,
            budget,
            ahead: None,
            is_over: false,
        }
    }

    /// Visits about `nodes` more nodes; returns `true` when the path is complete, or no walk or
    /// budget is left. Every call must be given the same graph and path.
    pub fn advance(&mut self, graph: &MotionGraph, path: &GroundPath, nodes: usize) -> bool {
        let ground = Ground { graph, path, stitcher: &self.stitcher, placings: &self.placings };
        let until = self.looked_at.saturating_add(nodes.max(1));
        while !self.is_over && self.looked_at < until {
            let ahead = match &mut self.ahead {
                Some(ahead) => ahead,
                None if self.here.along >= path.length() || self.looked_at >= self.budget => {
                    self.is_over = true;
                    break;
                }
                none => {
                    // Enough for every second of the path at a slow walk.
                    let stages = (path.length() / COMMITTED_SECS / 0.7).ceil().max(1.0) as usize;
                    none.insert(SearchAhead::new(Limits {
                        stop_at: (self.looked_at + (self.budget / stages).max(64)).min(self.budget),
                        until: self.here.frames as f64 + HORIZON_SECS * graph.set().fps(),
                    }))
                }
            };
            if ahead.advance(&ground, &self.here, &mut self.looked_at, until) {
                // The first second of the best walk ahead is kept.
                let best = self.ahead.take().and_then(|ahead| ahead.best);
                let kept = self.here.frames as f64 + COMMITTED_SECS * graph.set().fps();
                let before = self.edges.len();
                for edge in best.map(|(_, way)| way).unwrap_or_default() {
                    if self.edges.len() > before && self.here.frames as f64 >= kept {
                        break;
                    }
                    self.here = ground.behind(&self.here, edge);
                    self.edges.push(edge);
                }
                self.is_over = self.edges.len() == before;
            }
        }
        self.is_over
    }

    /// Returns the progress along the path, 0 to 1.
    #[must_use]
    pub fn progress(&self, path: &GroundPath) -> f64 {
        (self.here.along / path.length()).min(1.0)
    }

    /// Returns the best walk so far: the kept part, and the best walk ahead.
    #[must_use]
    pub fn so_far(&self, graph: &MotionGraph, path: &GroundPath) -> FollowedWalk {
        let ground = Ground { graph, path, stitcher: &self.stitcher, placings: &self.placings };
        let (mut here, mut edges) = (self.here, self.edges.clone());
        let best = self.ahead.as_ref().and_then(|ahead| ahead.best.as_ref());
        for &edge in best.map(|(_, way)| way.as_slice()).unwrap_or_default() {
            here = ground.behind(&here, edge);
            edges.push(edge);
        }
        FollowedWalk {
            edges,
            world_from_first: self.world_from_first,
            rms_m: (here.square / (here.frames as f64).max(1.0)).sqrt(),
            along_m: here.along.min(path.length()),
            arrives: here.along >= path.length(),
            looked_at: self.looked_at,
        }
    }
}

fn first_place(graph: &MotionGraph, start: NodeIndex, path: &GroundPath) -> Planar {
    let ahead = path.at(0.5_f64.min(path.length())) - path.at(0.0);
    let world = Planar::new(libm::atan2(ahead.x, ahead.y), path.at(0.0).x, path.at(0.0).y);
    let stretch = graph.graph().node_weight(start);
    let frame = stretch
        .and_then(|stretch| graph.set().clip(stretch.clip)?.ground_frames().get(stretch.start));
    frame.map_or(world, |frame| world.after(&frame.inverse()))
}

/// The state at the start of a node.
#[derive(Clone, Copy, Debug)]
struct State {
    node: NodeIndex,
    /// `world_from_clip` of the node's clip.
    world: Planar,
    /// The last sampled position of the character.
    last: Option<DVec2>,
    /// Distance walked, metres.
    along: f64,
    /// In 1e-6 m² · frames: integers, which compare alike on every machine.
    cost: u64,
    square: f64,
    frames: usize,
}

/// The limits of a search ahead.
#[derive(Clone, Copy, Debug)]
struct Limits {
    /// The number of nodes in all after which it stops.
    stop_at: usize,
    /// The last frame that is searched.
    until: f64,
}

/// Branch and bound over the walks of a few seconds, depth first.
#[derive(Clone, Debug)]
struct SearchAhead {
    limits: Limits,
    is_begun: bool,
    /// The edges to the deepest level.
    trail: Vec<EdgeIndex>,
    /// The edges on each level that are not visited yet.
    levels: Vec<std::vec::IntoIter<(EdgeIndex, State)>>,
    best: Option<(u64, Vec<EdgeIndex>)>,
}

impl SearchAhead {
    fn new(limits: Limits) -> Self {
        Self { limits, is_begun: false, trail: Vec::new(), levels: Vec::new(), best: None }
    }

    /// Continues until `until` nodes are visited; returns `true` when all walks are searched, or
    /// enough of them.
    fn advance(
        &mut self,
        ground: &Ground<'_>,
        here: &State,
        looked_at: &mut usize,
        until: usize,
    ) -> bool {
        if !std::mem::replace(&mut self.is_begun, true) {
            self.descend(ground, here, looked_at);
        }
        while let Some(level) = self.levels.last_mut() {
            // The first walk is always searched to its end.
            if self.best.is_some() && *looked_at >= self.limits.stop_at {
                return true;
            }
            if *looked_at >= until {
                return false;
            }
            if let Some((edge, next)) = level.next() {
                self.trail.push(edge);
                self.descend(ground, &next, looked_at);
            } else {
                self.levels.pop();
                self.trail.pop();
            }
        }
        true
    }

    /// Opens the level below a state, or goes back.
    fn descend(&mut self, ground: &Ground<'_>, here: &State, looked_at: &mut usize) {
        let bound = here.cost.saturating_add(ground.to_come(here));
        let goes_on = here.along < ground.path.length() && (here.frames as f64) < self.limits.until;
        let is_better = |cost: u64| self.best.as_ref().is_none_or(|(best, _)| cost < *best);
        let mut ways: Vec<(u64, EdgeIndex, State)> = Vec::new();
        if is_better(bound) && goes_on {
            ways.extend(ground.graph.graph().edges(here.node).map(|edge| {
                let next = ground.behind(here, edge.id());
                (next.cost.saturating_add(ground.to_come(&next)), edge.id(), next)
            }));
            *looked_at += ways.len();
        }
        if ways.is_empty() {
            // At the horizon, at the end of the path, or in a dead end, beyond which no walk
            // continues.
            let cost = if goes_on { u64::MAX - 1 } else { bound };
            if is_better(bound) && is_better(cost) {
                self.best = Some((cost, self.trail.clone()));
            }
            self.trail.pop();
            return;
        }
        // The most promising way is searched first, for a good bound early.
        ways.sort_by_key(|(bound, edge, _)| (*bound, *edge));
        let ways: Vec<_> = ways.into_iter().map(|(_, edge, next)| (edge, next)).collect();
        self.levels.push(ways.into_iter());
    }
}

/// The data of a search.
struct Ground<'a> {
    graph: &'a MotionGraph,
    path: &'a GroundPath,
    stitcher: &'a Stitcher,
    placings: &'a RefCell<BTreeMap<usize, Planar>>,
}

impl Ground<'_> {
    /// Returns a lower bound of the remaining cost: the rest of the path on the path itself, at a
    /// run.
    fn to_come(&self, state: &State) -> u64 {
        let left = (self.path.length() - state.along).max(0.0);
        (left / 4.0 * STANDSTILL_COST * self.graph.set().fps() * 1e6) as u64
    }

    /// Returns the state at the other end of an edge.
    fn behind(&self, here: &State, edge: EdgeIndex) -> State {
        let mut next = *here;
        let graph = self.graph.graph();
        let ends = graph.edge_endpoints(edge);
        let Some((stretch, (_, to))) = graph.node_weight(here.node).copied().zip(ends) else {
            return next;
        };
        let jump = match graph.edge_weight(edge) {
            Some(&Way::Jump(index)) => self.graph.jumps().get(index).map(|jump| (index, jump)),
            _ => None,
        };
        let end = jump.map_or(stretch.end, |(_, jump)| jump.leave.frame);
        self.walk(&mut next, stretch.clip, stretch.start..end.max(stretch.start));
        next.node = to;
        if let Some((index, jump)) = jump {
            next.world = here.world.after(&self.placing(index, jump));
            let start = graph.node_weight(to).map_or(jump.enter.frame, |to| to.start);
            self.walk(&mut next, jump.enter.clip, jump.enter.frame..start.max(jump.enter.frame));
        }
        next
    }

    /// Returns the transform of the clip that a transition enters; where the transition cannot be
    /// made, its alignment.
    fn placing(&self, index: usize, jump: &Jump) -> Planar {
        let place = || self.stitcher.placing(jump).unwrap_or(jump.alignment);
        *self.placings.borrow_mut().entry(index).or_insert_with(place)
    }

    fn walk(&self, state: &mut State, clip: usize, frames: std::ops::Range<usize>) {
        let Some(source) = self.graph.set().clip(clip) else {
            return;
        };
        let mut frame = frames.start;
        while frame < frames.end {
            let count = FRAMES_PER_SAMPLE.min(frames.end - frame);
            if let Some(at) = source.ground_frames().get(frame) {
                let at = state.world.apply_ground(at.shift);
                state.along += state.last.map_or(0.0, |last| last.distance(at));
                let square = at.distance_squared(self.path.at(state.along));
                state.square += square * count as f64;
                state.cost = state.cost.saturating_add(
                    ((square + STANDSTILL_COST) * 1e6).round() as u64 * count as u64,
                );
                state.last = Some(at);
            }
            state.frames += count;
            frame += count;
        }
    }
}
