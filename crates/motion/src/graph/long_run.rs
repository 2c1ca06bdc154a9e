//! The long run of a random walk: how often it visits each node.

use petgraph::algo::kosaraju_scc;
use petgraph::graph::{DiGraph, NodeIndex};
use std::ops::Range;

/// The share of a sweep by which the visits move. Sweeps of whole steps would not converge where
/// every cycle has several ways back to earlier nodes: the visits would go round.
const STEP: f64 = 0.9;
/// The relative change of one sweep below which the visits are known.
const ENOUGH: f64 = 1e-12;
/// The greatest number of sweeps over one part; a hundred are usual.
const MAX_SWEEPS: usize = 2_000;

/// A way of a random walk.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Step {
    pub(super) from: NodeIndex,
    pub(super) to: NodeIndex,
    /// Its probability at the node `from`.
    pub(super) probability: f64,
}

/// The computation of the distribution over the nodes that a random walk has in the long run, if it
/// begins at each node with the same probability.
///
/// The nodes are taken part by part, a part being nodes of which each can be reached from every
/// other. Of a part that walks leave for good, the expected number of visits is computed; it tells
/// how many walks arrive in the following parts. In a part that no walk leaves, walks have the
/// stationary distribution. Both are solved by sweeps of Gauss and Seidel in the order of the
/// nodes (Stewart, Introduction to the Numerical Solution of Markov Chains, 1994, chapter 3): along
/// a clip, in which one node follows the other, a single sweep carries the walks as far as they
/// would go in as many steps as there are nodes.
#[derive(Clone, Debug)]
pub(super) struct LongRun {
    /// How often each node is visited: in parts that are left for good, from its start until then.
    visits: Vec<f64>,
    /// The nodes, part by part. Walks come from earlier parts, never from later ones.
    order: Vec<usize>,
    parts: Vec<Part>,
    /// The ways from nodes of the same part, without those that stay at their node.
    within: WaysInto,
    /// The ways from nodes of earlier parts.
    between: WaysInto,
    /// The probability that the next step of a walk leaves a node.
    leaving: Vec<f64>,
    /// How often walks begin at each node of the present part, or come from earlier parts.
    entering: Vec<f64>,
    /// The visits of the nodes of the present part before the sweep.
    before: Vec<f64>,
    /// The present part, and its number of sweeps.
    part: usize,
    sweeps: usize,
}

#[derive(Clone, Debug)]
struct Part {
    /// Its nodes, in the order of all.
    nodes: Range<usize>,
    /// Whether walks leave it for good.
    is_left: bool,
}

/// The ways into every node.
#[derive(Clone, Debug)]
struct WaysInto {
    /// Where each way comes from and its probability there, node by node.
    ways: Vec<(u32, f64)>,
    /// The end of each node's part of `ways`.
    ends: Vec<usize>,
}

impl WaysInto {
    fn new(nodes: usize, steps: impl Iterator<Item = Step> + Clone) -> Self {
        let (ends, order) = grouped(nodes, steps.clone().map(|step| step.to));
        let ways: Vec<(u32, f64)> =
            steps.map(|step| (step.from.index() as u32, step.probability)).collect();
        Self { ways: order.into_iter().map(|at| ways[at]).collect(), ends }
    }

    /// Returns how many walks arrive at a node.
    fn arriving(&self, node: usize, visits: &[f64]) -> f64 {
        let from = node.checked_sub(1).map_or(0, |before| self.ends[before]);
        let ways = &self.ways[from..self.ends[node]];
        ways.iter().map(|&(from, probability)| visits[from as usize] * probability).sum()
    }

    /// Returns the number of ways into some nodes.
    fn count(&self, nodes: &[usize]) -> usize {
        let of_one = |&node: &usize| {
            self.ends[node] - node.checked_sub(1).map_or(0, |before| self.ends[before])
        };
        nodes.iter().map(of_one).sum()
    }
}

impl LongRun {
    /// Begins the computation for a number of nodes and the ways between them, whose probabilities
    /// sum to 1 at each node, or to 0 where walks end.
    pub(super) fn new(nodes: usize, steps: &[Step]) -> Self {
        let taken = steps.iter().copied().filter(|step| step.probability > 0.0);
        let mut graph = DiGraph::<(), ()>::with_capacity(nodes, steps.len());
        for _ in 0..nodes {
            graph.add_node(());
        }
        let mut leaving = vec![0.0; nodes];
        for Step { from, to, probability } in taken.clone().filter(|step| step.from != step.to) {
            graph.add_edge(from, to, ());
            leaving[from.index()] += probability;
        }
        let mut components = kosaraju_scc(&graph);
        components.reverse();
        let (mut order, mut parts, mut part_of) =
            (Vec::with_capacity(nodes), Vec::new(), vec![0; nodes]);
        for mut component in components {
            component.sort_unstable();
            let from = order.len();
            for node in component {
                part_of[node.index()] = parts.len();
                order.push(node.index());
            }
            parts.push(Part { nodes: from..order.len(), is_left: false });
        }
        let is_within = |step: &Step| part_of[step.from.index()] == part_of[step.to.index()];
        for step in taken.clone().filter(|step| !is_within(step)) {
            parts[part_of[step.from.index()]].is_left = true;
        }
        let within = taken.clone().filter(|step| is_within(step) && step.from != step.to);
        Self {
            within: WaysInto::new(nodes, within),
            between: WaysInto::new(nodes, taken.filter(|step| !is_within(step))),
            visits: vec![0.0; nodes],
            order,
            parts,
            leaving,
            entering: Vec::new(),
            before: Vec::new(),
            part: 0,
            sweeps: 0,
        }
    }

    /// Follows up to `ways` more ways, at least those of one sweep; returns `true` when all is
    /// computed.
    pub(super) fn advance(&mut self, ways: usize) -> bool {
        let mut followed = 0;
        while followed < ways.max(1)
            && let Some(part) = self.parts.get(self.part).cloned()
        {
            let nodes = &self.order[part.nodes.clone()];
            followed += nodes.len() + self.within.count(nodes);
            if self.sweeps == 0 {
                self.enter(&part);
            }
            let is_known = self.sweep(&part);
            self.sweeps += 1;
            if is_known || self.sweeps >= MAX_SWEEPS {
                self.finish(&part);
                (self.part, self.sweeps) = (self.part + 1, 0);
            }
        }
        self.part >= self.parts.len()
    }

    /// Returns the share of all walks that is at each node in the long run, after the last
    /// [`advance`](Self::advance): 0 in parts that walks leave for good.
    pub(super) fn shares(&self) -> impl Iterator<Item = f64> + '_ {
        let mut shares = self.visits.clone();
        for part in self.parts.iter().filter(|part| part.is_left) {
            for &node in &self.order[part.nodes.clone()] {
                shares[node] = 0.0;
            }
        }
        shares.into_iter()
    }

    /// Counts the walks that come into a part.
    fn enter(&mut self, part: &Part) {
        let start = (self.order.len() as f64).recip();
        let nodes = &self.order[part.nodes.clone()];
        self.entering.clear();
        let from_others =
            nodes.iter().map(|&node| start + self.between.arriving(node, &self.visits));
        self.entering.extend(from_others);
        let all: f64 = self.entering.iter().sum();
        for &node in nodes {
            self.visits[node] = all / nodes.len() as f64;
        }
    }

    /// Computes the visits of a part once from each other; returns whether they have hardly
    /// changed. A separate function, because browsers optimise a function between two of its calls.
    #[inline(never)]
    fn sweep(&mut self, part: &Part) -> bool {
        let nodes = &self.order[part.nodes.clone()];
        let visits = &mut self.visits;
        self.before.clear();
        for (&node, &entering) in nodes.iter().zip(&self.entering) {
            self.before.push(visits[node]);
            // A walk that is alone at its node stays there.
            if self.leaving[node] > 0.0 {
                let entering = if part.is_left { entering } else { 0.0 };
                let arriving = entering + self.within.arriving(node, visits);
                visits[node] = arriving / self.leaving[node];
            }
        }
        let (mut change, mut all) = (0.0, 0.0);
        for (&node, before) in nodes.iter().zip(&self.before) {
            let moved = STEP * (visits[node] - before);
            visits[node] = before + moved;
            change += moved.abs();
            all += visits[node];
        }
        change <= ENOUGH * all
    }

    /// Makes the visits of a part that no walk leaves the shares of the walks that have come there.
    fn finish(&mut self, part: &Part) {
        if part.is_left {
            return;
        }
        let nodes = &self.order[part.nodes.clone()];
        let all: f64 = nodes.iter().map(|&node| self.visits[node]).sum();
        let entered: f64 = self.entering.iter().sum();
        for &node in nodes {
            self.visits[node] *= entered / all;
        }
    }
}

/// Groups items by `of`: returns the end of each group, and the indices of the items in that order,
/// stable within a group. Three passes over flat arrays: with very many edges, lists of lists would
/// take most of the time.
pub(super) fn grouped(
    groups: usize,
    of: impl Iterator<Item = NodeIndex> + Clone,
) -> (Vec<usize>, Vec<usize>) {
    let mut next = vec![0; groups + 1];
    let mut count = 0;
    for group in of.clone() {
        next[group.index() + 1] += 1;
        count += 1;
    }
    for group in 0..groups {
        next[group + 1] += next[group];
    }
    let mut order = vec![0; count];
    for (thing, group) in of.enumerate() {
        order[next[group.index()]] = thing;
        next[group.index()] += 1;
    }
    next.pop();
    (next, order)
}
