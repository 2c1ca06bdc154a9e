//! Walks through a graph.

use super::{Choices, GraphError, MotionGraph, Place};
use petgraph::algo::astar;
use petgraph::graph::{EdgeIndex, NodeIndex};
use petgraph::visit::EdgeRef;
use rand_pcg::Pcg32;
use rand_pcg::rand_core::Rng;
use std::collections::VecDeque;
use std::sync::Arc;

/// The stream of the generator: any odd number is valid, this one is its author's.
const STREAM: u64 = 0x0a02_bdbf_7bb3_c0a7;
/// The number of bits by which shares are refined when they are discounted.
const DISCOUNT_BITS: u32 = 16;

/// A part of a walk in one clip, from the frame where it is entered to the frame where it is left.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
pub struct Stay {
    /// The clip's index.
    pub clip: usize,
    /// The first frame: where the transition into it enters it.
    pub from: usize,
    /// One past the last frame: where the next transition leaves it.
    pub to: usize,
    /// The transition into it, its index in [`MotionGraph::jumps`]; `None` for the first stay.
    pub jump: Option<usize>,
}

/// A walk through a graph, random or to a given target. The same graph, choices and seed give the
/// same walk on every machine.
#[derive(Clone, Debug)]
pub struct Walker {
    graph: Arc<MotionGraph>,
    choices: Arc<Choices>,
    rng: Pcg32,
    at: NodeIndex,
    /// The clip's frame at which the current stay began, and the transition that led there.
    since: (usize, Option<usize>),
    ended: bool,
    visits: Vec<u32>,
    /// The factor on the probability of the edges into a node for every visit of it.
    discount: f64,
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
            discount: 1.0,
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

    /// Sets the factor, 0 to 1, by which every visit of a node reduces the probability of the edges
    /// into it. 1, the default, changes nothing; with 0 the least visited nodes are chosen. Visits
    /// count relative to those of the least visited of the alternatives, so that the effect does
    /// not depend on the length of a walk.
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
        self.discount = factor;
        Ok(self)
    }

    /// Returns the current node.
    #[must_use]
    pub fn node(&self) -> NodeIndex {
        self.at
    }

    /// Returns the number of visits of each node.
    #[must_use]
    pub fn visits(&self) -> &[u32] {
        &self.visits
    }

    /// Takes the shortest way (in frames) to a clip from here, then continues randomly. Returns
    /// `false`, and changes nothing, where there is no way.
    pub fn go_to_clip(&mut self, clip: usize) -> bool {
        let graph = &self.graph.graph;
        let is_there =
            |node: NodeIndex| graph.node_weight(node).is_some_and(|stretch| stretch.clip == clip);
        let frames =
            |edge: petgraph::graph::EdgeReference<'_, super::Way>| self.graph.frames_of(edge.id());
        let Some((_, nodes)) = astar(graph, self.at, is_there, frames, |_| 0) else {
            return false;
        };
        self.ahead.clear();
        for pair in nodes.windows(2) {
            // The closest of several transitions between the same two nodes was added first.
            let between = graph.edges_connecting(pair[0], pair[1]).map(|edge| edge.id());
            let shortest = between.min_by_key(|&edge| (self.graph.frames_of(edge), edge));
            self.ahead.extend(shortest);
        }
        true
    }

    /// Takes these edges next, one after the other; the first leaves the current node.
    pub fn take(&mut self, edges: impl IntoIterator<Item = EdgeIndex>) {
        self.ahead = edges.into_iter().collect();
    }

    /// Returns whether it is on a given way.
    #[must_use]
    pub fn has_way(&self) -> bool {
        !self.ahead.is_empty()
    }

    /// Returns the next edge; `None` in a dead end.
    pub fn next_edge(&mut self) -> Option<EdgeIndex> {
        let edge = self.decided()?;
        self.ahead.pop_front();
        let (_, to) = self.graph.graph.edge_endpoints(edge)?;
        if let Some(visits) = self.visits.get_mut(self.at.index()) {
            *visits = visits.saturating_add(1);
        }
        self.at = to;
        // A walker that was moved edge by edge returns the current stay when it is asked for one.
        if let Some(super::Way::Jump(index)) = self.graph.graph.edge_weight(edge) {
            let enter = self.graph.jumps.get(*index)?.enter;
            self.since = (enter.frame, Some(*index));
        }
        Some(edge)
    }

    /// Returns the next edge, in front of those ahead: it is drawn once and then kept.
    fn decided(&mut self) -> Option<EdgeIndex> {
        let leads_from_here = |edge: &EdgeIndex| {
            self.graph.graph.edge_endpoints(*edge).is_some_and(|(from, _)| from == self.at)
        };
        if let Some(edge) = self.ahead.front().copied().filter(leads_from_here) {
            return Some(edge);
        }
        self.ahead.clear();
        let edge = self.chosen()?;
        self.ahead.push_front(edge);
        Some(edge)
    }

    /// Continues in its clip to the first node that begins at or after `frame` of the clip, so that
    /// the frames before it are decided. It stops at a randomly chosen transition, which leaves the
    /// clip after `frame` if the stay that [`Self::next_stay`] would return does.
    pub fn go_on_to(&mut self, frame: usize) {
        while self.graph.graph.node_weight(self.at).is_some_and(|stretch| stretch.start < frame) {
            let way = self.decided().and_then(|edge| self.graph.graph.edge_weight(edge));
            if !matches!(way, Some(super::Way::Continue)) || self.next_edge().is_none() {
                break;
            }
        }
    }

    /// Returns the stay up to the next transition; the last stay, before a dead end, ends with its
    /// node, and then `None` is returned.
    pub fn next_stay(&mut self) -> Option<Stay> {
        if self.ended {
            return None;
        }
        loop {
            let stretch = *self.graph.graph.node_weight(self.at)?;
            // Before the edge is taken: a transition begins the next stay.
            let (from, jump) = self.since;
            let stay = |to: usize| Stay { clip: stretch.clip, from, to, jump };
            let Some(edge) = self.next_edge() else {
                self.ended = true;
                return Some(stay(stretch.end));
            };
            if let Some(super::Way::Jump(index)) = self.graph.graph.edge_weight(edge) {
                return Some(stay(self.graph.jumps.get(*index)?.leave.frame));
            }
        }
    }

    /// Draws an edge: shares of 2³² as integers, and one draw of 64 bits.
    fn chosen(&mut self) -> Option<EdgeIndex> {
        let ways = self.choices.ways(self.at);
        let visits = |edge: EdgeIndex| {
            let to = self.graph.graph.edge_endpoints(edge).map_or(0, |(_, to)| to.index());
            self.visits.get(to).copied().unwrap_or(0)
        };
        let worths =
            discounted(ways.iter().map(|&(edge, share)| (share, visits(edge))), self.discount);
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

/// Returns the weights of edges, by their shares and the visits of their ends. Only the difference
/// to the least visited one counts: however long a walk is, the least visited edge keeps all of its
/// share, and ratios stay the same until they are too small for integers.
///
/// The power is `libm`'s, which is the same on every machine.
fn discounted(ways: impl Iterator<Item = (u64, u32)> + Clone, factor: f64) -> Vec<u64> {
    let finer = |share: u64| share << DISCOUNT_BITS;
    if factor >= 1.0 {
        return ways.map(|(share, _)| finer(share)).collect();
    }
    // Edges that are never taken are not counted as the least visited.
    let open = ways.clone().filter(|(share, _)| *share > 0);
    let least = open.map(|(_, visits)| visits).min().unwrap_or(0);
    let worth = |(share, visits): (u64, u32)| match visits.saturating_sub(least) {
        0 => finer(share),
        more => (finer(share) as f64 * libm::pow(factor, f64::from(more))) as u64,
    };
    ways.map(worth).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn discounted_shares_fall_with_visits_in_walks_of_any_length() {
        let shares = [(1_u64 << 32) - 3, 2, 1, 0];
        for before in [0, 10, 5_000, 3_000_000_000] {
            for factor in [0.5, 0.9] {
                let ways = shares
                    .iter()
                    .zip([before + 1, before + 21, before, 0])
                    .map(|(&share, visits)| (share, visits));
                let worths = discounted(ways, factor);
                let wanted = [1, 21, 0].map(|more| factor.powi(more)).into_iter().zip(shares);
                for (worth, (power, share)) in worths.iter().zip(wanted) {
                    let wanted = (share << DISCOUNT_BITS) as f64 * power;
                    assert!(
                        (*worth as f64 - wanted).abs() <= 1.0 + 1e-9 * wanted,
                        "{before} {factor}: {worth} {wanted}"
                    );
                }
                assert_eq!(worths[3], 0, "what cannot be chosen stays so");
            }
        }
        // With the factor 0 only the least visited nodes remain.
        let all_seen = |visits: [u32; 3]| discounted([5, 6, 7].into_iter().zip(visits), 0.0);
        assert_eq!(all_seen([9, 9, 9]), [5, 6, 7].map(|share: u64| share << DISCOUNT_BITS));
        assert_eq!(all_seen([9, 8, 9]), [0, 6 << DISCOUNT_BITS, 0]);
        assert_eq!(
            discounted([(5, 900), (6, 0)].into_iter(), 1.0),
            [5 << DISCOUNT_BITS, 6 << DISCOUNT_BITS]
        );
    }
}
