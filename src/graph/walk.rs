use super::{Choices, GraphError, MotionGraph, Place};
use petgraph::algo::astar;
use petgraph::graph::{EdgeIndex, NodeIndex};
use petgraph::visit::EdgeRef;
use rand_pcg::Pcg32;
use rand_pcg::rand_core::Rng;
use std::collections::VecDeque;
use std::sync::Arc;

/// The stream of the generator: any odd number would do, this one is what its author gives.
const STREAM: u64 = 0x0a02_bdbf_7bb3_c0a7;
/// The discount is a multiple of 1 / 65,536.
const DISCOUNT_BITS: u32 = 16;

/// One clip from where it is entered to where it is left.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
pub struct Stay {
    /// The clip's index.
    pub clip: usize,
    /// The first frame: where the transition into it enters it.
    pub from: usize,
    /// One past the last frame: where the next transition leaves it.
    pub to: usize,
    /// The transition into it, its index in [`MotionGraph::jumps`]; none for the first stay.
    pub jump: Option<usize>,
}

/// Goes through a graph, by chance or to where it is told. The same graph, choices and seed give the same way on every machine.
#[derive(Clone, Debug)]
pub struct Walker {
    graph: Arc<MotionGraph>,
    choices: Arc<Choices>,
    rng: Pcg32,
    at: NodeIndex,
    /// The clip's frame at which the present stay began, and the transition that led there.
    since: (usize, Option<usize>),
    ended: bool,
    visits: Vec<u32>,
    /// What a way into a node is worth after every visit of it, in 1 / 65,536.
    discount: u64,
    ahead: VecDeque<EdgeIndex>,
}

impl Walker {
    /// Starts at the graph's first node.
    #[must_use]
    pub fn new(graph: Arc<MotionGraph>, choices: Arc<Choices>, seed: u64) -> Self {
        let start = NodeIndex::new(0);
        let since = graph.graph.node_weight(start).map_or(0, |stretch| stretch.start);
        Self {
            rng: Pcg32::new(seed, STREAM),
            at: start,
            since: (since, None),
            ended: graph.graph.node_count() == 0,
            visits: vec![0; graph.graph.node_count()],
            discount: 1 << DISCOUNT_BITS,
            ahead: VecDeque::new(),
            graph,
            choices,
        }
    }

    /// Starts at another node; `None` where the graph has none there.
    #[must_use]
    pub fn starting_at(mut self, place: Place) -> Option<Self> {
        let node = self.graph.node_at(place)?;
        (self.at, self.since) = (node, (self.graph.graph.node_weight(node)?.start, None));
        Some(self)
    }

    /// Every visit of a node makes the ways into it less probable: by this factor, 0 to 1, for each. 1 changes nothing, and is what a walk starts with.
    ///
    /// # Errors
    /// [`GraphError::Setting`] outside 0 to 1.
    pub fn with_visited_discount(mut self, factor: f64) -> Result<Self, GraphError> {
        if !(0.0..=1.0).contains(&factor) {
            return Err(GraphError::Setting {
                what: "a visited discount",
                value: factor,
                least: 0.0,
                most: 1.0,
            });
        }
        self.discount = (factor * f64::from(1 << DISCOUNT_BITS)).round() as u64;
        Ok(self)
    }

    /// The node that plays now.
    #[must_use]
    pub fn node(&self) -> NodeIndex {
        self.at
    }

    /// How often each node was visited.
    #[must_use]
    pub fn visits(&self) -> &[u32] {
        &self.visits
    }

    /// From here the shortest way (in frames) to a clip, then by chance again. False, and nothing changes, where there is no way.
    pub fn go_to_clip(&mut self, clip: usize) -> bool {
        let graph = &self.graph.graph;
        let is_there = |node: NodeIndex| graph.node_weight(node).is_some_and(|stretch| stretch.clip == clip);
        let frames = |edge: petgraph::graph::EdgeReference<'_, super::Way>| self.graph.frames_of(edge.id());
        let Some((_, nodes)) = astar(graph, self.at, is_there, frames, |_| 0) else {
            return false;
        };
        self.ahead.clear();
        for pair in nodes.windows(2) {
            // Of several transitions between the same two nodes the closest, which was added first.
            let between = graph.edges_connecting(pair[0], pair[1]).map(|edge| edge.id());
            let shortest = between.min_by_key(|&edge| (self.graph.frames_of(edge), edge));
            self.ahead.extend(shortest);
        }
        true
    }

    /// Takes these edges next, one behind the other; the first leaves the present node.
    pub fn take(&mut self, edges: impl IntoIterator<Item = EdgeIndex>) {
        self.ahead = edges.into_iter().collect();
    }

    /// The next edge; `None` in a dead end.
    pub fn next_edge(&mut self) -> Option<EdgeIndex> {
        let leads_from_here = |edge: &EdgeIndex| self.graph.graph.edge_endpoints(*edge).is_some_and(|(from, _)| from == self.at);
        let edge = if let Some(edge) = self.ahead.pop_front().filter(leads_from_here) {
            edge
        } else {
            self.ahead.clear();
            self.chosen()?
        };
        let (_, to) = self.graph.graph.edge_endpoints(edge)?;
        if let Some(visits) = self.visits.get_mut(self.at.index()) {
            *visits = visits.saturating_add(1);
        }
        self.at = to;
        Some(edge)
    }

    /// Up to the next transition; the last stay, before a dead end, goes to where its node ends, and `None` comes behind it.
    pub fn next_stay(&mut self) -> Option<Stay> {
        if self.ended {
            return None;
        }
        loop {
            let stretch = *self.graph.graph.node_weight(self.at)?;
            let (from, jump) = self.since;
            let stay = |to: usize| Stay {
                clip: stretch.clip,
                from,
                to,
                jump,
            };
            let Some(edge) = self.next_edge() else {
                self.ended = true;
                return Some(stay(stretch.end));
            };
            if let Some(super::Way::Jump(index)) = self.graph.graph.edge_weight(edge) {
                let jump = self.graph.jumps.get(*index)?;
                self.since = (jump.enter.frame, Some(*index));
                return Some(stay(jump.leave.frame));
            }
        }
    }

    /// Whole numbers alone: shares of 2³², discounted by multiplications and shifts, and one draw of 64 bits.
    fn chosen(&mut self) -> Option<EdgeIndex> {
        let ways = self.choices.ways(self.at);
        let discounted = |&(edge, share): &(EdgeIndex, u64)| {
            let to = self.graph.graph.edge_endpoints(edge).map_or(0, |(_, to)| to.index());
            let mut worth = share << DISCOUNT_BITS;
            if self.discount < 1 << DISCOUNT_BITS {
                for _ in 0..self.visits.get(to).copied().unwrap_or(0).min(64) {
                    worth = ((u128::from(worth) * u128::from(self.discount)) >> DISCOUNT_BITS) as u64;
                }
            }
            // What could be chosen stays choosable, so that a walk does not end where all is known.
            if share > 0 { worth.max(1) } else { 0 }
        };
        let worths: Vec<u64> = ways.iter().map(discounted).collect();
        let whole: u64 = worths.iter().sum();
        let drawn = u128::from(self.rng.next_u64());
        let mut ticket = ((drawn * u128::from(whole)) >> 64) as u64;
        for (&(edge, _), &worth) in ways.iter().zip(&worths) {
            if ticket < worth {
                return Some(edge);
            }
            ticket -= worth;
        }
        None
    }
}
