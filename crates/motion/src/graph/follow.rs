use super::{GraphError, Jump, MotionGraph, StitchOptions, Stitcher, Way};
use crate::math::Planar;
use glam::DVec2;
use petgraph::graph::{EdgeIndex, NodeIndex};
use petgraph::visit::EdgeRef;
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::sync::Arc;

/// How far a search looks ahead before it commits itself, seconds.
const HORIZON_SECS: f64 = 4.0;
/// How much of what it found it then keeps, seconds.
const KEPT_SECS: f64 = 1.0;
/// What a second costs on the path itself, m²·s⁻¹: otherwise to stand still on it would be best.
const PATIENCE: f64 = 0.05;
/// Ways over the ground are read every so many frames.
const READ_EVERY: usize = 4;

/// A line on the ground, to be walked along.
#[derive(Clone, Debug, PartialEq)]
pub struct GroundPath {
    points: Vec<DVec2>,
    /// Metres from the start to each point.
    lengths: Vec<f64>,
}

impl GroundPath {
    /// The line through these points, (x, z) in metres. Points that are not finite, or repeat the
    /// one before, are left out.
    ///
    /// # Errors
    /// [`GraphError::Setting`] when less than 10 cm of line is left.
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

    /// Metres from end to end.
    #[must_use]
    pub fn length(&self) -> f64 {
        self.lengths.last().copied().unwrap_or(0.0)
    }

    /// The point so many metres from the start; the ends beyond them.
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

/// A way through a graph along a path.
#[derive(Clone, Debug, PartialEq)]
pub struct Followed {
    /// Its edges, from the start node on: for [`Walker::take`](super::Walker::take).
    pub edges: Vec<EdgeIndex>,
    /// Where the first clip lies: `world_from_clip`.
    pub world_from_first: Planar,
    /// How far off the path it is, metres: the root of the mean square.
    pub rms_m: f64,
    /// How far it comes along the path, metres.
    pub along_m: f64,
    /// The end of the path is reached.
    pub arrives: bool,
    /// Nodes that were looked at.
    pub looked_at: usize,
}

/// A way through the graph whose trace on the ground stays close to a path (Kovar, Gleicher, Pighin
/// 2002, section 5): branch and bound over what lies a few seconds ahead, of which the first is
/// kept, and so on.
///
/// The cost is the squared distance, summed over time, of the character from the point of the path
/// that is as far along it as the character has walked; a little is added per second. `budget` is
/// the number of nodes that are looked at in all. When it is used up, the best so far is given. The
/// character starts at node `start`, at the path's first point, and faces along it.
///
/// *Why a number and not a time.* A number gives the same way on every machine, so that a link that
/// holds a path shows everybody the same walk. Time bounds the waiting alone: whoever cannot wait
/// for the end shows [`PathSearch::so_far`], and goes on.
///
/// Clips are laid on each other as a [`Stitcher`] with these options does, so that what it makes of
/// the way lies where the way was planned. Transitions that overlap are taken to begin from the
/// clip that is left; there it may be off by centimetres.
#[must_use]
pub fn follow(
    graph: &MotionGraph,
    start: NodeIndex,
    path: &GroundPath,
    budget: usize,
    options: &StitchOptions,
) -> Followed {
    let mut search = PathSearch::new(graph, start, path, budget, options);
    while !search.advance(graph, path, usize::MAX) {}
    search.so_far(graph, path)
}

/// [`follow`] in slices of a number of nodes. However it is cut, it finds the same.
#[derive(Clone, Debug)]
pub struct PathSearch {
    stitcher: Stitcher,
    /// Where the transitions that were looked at lay the clip that they enter: by their numbers,
    /// `left_from_entered`.
    placings: RefCell<BTreeMap<usize, Planar>>,
    world_from_first: Planar,
    here: State,
    edges: Vec<EdgeIndex>,
    looked_at: usize,
    budget: usize,
    /// The search of what lies ahead of `here`.
    ahead: Option<Ahead>,
    is_over: bool,
}

impl PathSearch {
    /// Stands at the start; the arguments are those of [`follow`].
    #[must_use]
    pub fn new(
        graph: &MotionGraph,
        start: NodeIndex,
        path: &GroundPath,
        budget: usize,
        options: &StitchOptions,
    ) -> Self {
        let world_from_first = first_place(graph, start, path);
        // A mistake is made in the walk, not in the plan.
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

    /// Looks at about `nodes` more nodes; `true` when the path, the ways or the budget are at an
    /// end. Every call is given the same graph and path.
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
                    let stages = (path.length() / KEPT_SECS / 0.7).ceil().max(1.0) as usize;
                    none.insert(Ahead::new(Limits {
                        stop_at: (self.looked_at + (self.budget / stages).max(64)).min(self.budget),
                        until: self.here.frames as f64 + HORIZON_SECS * graph.set().fps(),
                    }))
                }
            };
            if ahead.advance(&ground, &self.here, &mut self.looked_at, until) {
                // The first second of the best way ahead is gone.
                let best = self.ahead.take().and_then(|ahead| ahead.best);
                let kept = self.here.frames as f64 + KEPT_SECS * graph.set().fps();
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

    /// How much of the path is walked along, 0 to 1.
    #[must_use]
    pub fn progress(&self, path: &GroundPath) -> f64 {
        (self.here.along / path.length()).min(1.0)
    }

    /// The best so far: what is kept, and the best way ahead.
    #[must_use]
    pub fn so_far(&self, graph: &MotionGraph, path: &GroundPath) -> Followed {
        let ground = Ground { graph, path, stitcher: &self.stitcher, placings: &self.placings };
        let (mut here, mut edges) = (self.here, self.edges.clone());
        let best = self.ahead.as_ref().and_then(|ahead| ahead.best.as_ref());
        for &edge in best.map(|(_, way)| way.as_slice()).unwrap_or_default() {
            here = ground.behind(&here, edge);
            edges.push(edge);
        }
        Followed {
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
    let world = Planar::new(ahead.x.atan2(ahead.y), path.at(0.0).x, path.at(0.0).y);
    let stretch = graph.graph().node_weight(start);
    let frame =
        stretch.and_then(|stretch| graph.set().clip(stretch.clip)?.frames().get(stretch.start));
    frame.map_or(world, |frame| world.after(&frame.inverse()))
}

/// At the start of a node.
#[derive(Clone, Copy, Debug)]
struct State {
    node: NodeIndex,
    /// `world_from_clip` of the node's clip.
    world: Planar,
    /// Where the character was read last.
    last: Option<DVec2>,
    /// Metres walked.
    along: f64,
    /// In 1e-6 m² · frames: whole numbers, which compare alike everywhere.
    cost: u64,
    square: f64,
    frames: usize,
}

/// When a search of what lies ahead ends.
#[derive(Clone, Copy, Debug)]
struct Limits {
    /// So many nodes are looked at in all.
    stop_at: usize,
    /// The frame up to which is searched.
    until: f64,
}

/// Branch and bound over the ways of a few seconds, depth first.
#[derive(Clone, Debug)]
struct Ahead {
    limits: Limits,
    is_begun: bool,
    /// The edges that lead to the deepest level.
    trail: Vec<EdgeIndex>,
    /// On each level the ways that were not gone yet.
    levels: Vec<std::vec::IntoIter<(EdgeIndex, State)>>,
    best: Option<(u64, Vec<EdgeIndex>)>,
}

impl Ahead {
    fn new(limits: Limits) -> Self {
        Self { limits, is_begun: false, trail: Vec::new(), levels: Vec::new(), best: None }
    }

    /// Goes on until so many nodes are looked at; `true` when all ways are gone, or enough of them.
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
            // The first way down is always gone to its end.
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
            // At the horizon, at the end of the path, or in a dead end: there what lies ahead
            // cannot be walked.
            let cost = if goes_on { u64::MAX - 1 } else { bound };
            if is_better(bound) && is_better(cost) {
                self.best = Some((cost, self.trail.clone()));
            }
            self.trail.pop();
            return;
        }
        // The most promising first: a good bound early.
        ways.sort_by_key(|(bound, edge, _)| (*bound, *edge));
        let ways: Vec<_> = ways.into_iter().map(|(_, edge, next)| (edge, next)).collect();
        self.levels.push(ways.into_iter());
    }
}

/// Where one walks.
struct Ground<'a> {
    graph: &'a MotionGraph,
    path: &'a GroundPath,
    stitcher: &'a Stitcher,
    placings: &'a RefCell<BTreeMap<usize, Planar>>,
}

impl Ground<'_> {
    /// What is still to be paid at least: the rest of the path on the path itself, at a run.
    fn to_come(&self, state: &State) -> u64 {
        let left = (self.path.length() - state.along).max(0.0);
        (left / 4.0 * PATIENCE * self.graph.set().fps() * 1e6) as u64
    }

    /// The state at the other end of an edge.
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

    /// Where a transition lays the clip that it enters; where that cannot be made, where it is
    /// aligned.
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
            let count = READ_EVERY.min(frames.end - frame);
            if let Some(at) = source.frames().get(frame) {
                let at = state.world.apply_ground(at.shift);
                state.along += state.last.map_or(0.0, |last| last.distance(at));
                let square = at.distance_squared(self.path.at(state.along));
                state.square += square * count as f64;
                state.cost = state
                    .cost
                    .saturating_add(((square + PATIENCE) * 1e6).round() as u64 * count as u64);
                state.last = Some(at);
            }
            state.frames += count;
            frame += count;
        }
    }
}
