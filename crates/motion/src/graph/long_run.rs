//! The limiting distribution of a random walk: how often it visits each node in the long run.

use super::components::components;
use super::grouped::grouped;
use petgraph::graph::NodeIndex;
use std::ops::Range;

/// The under-relaxation of a sweep. Full sweeps need not converge: where cycles have several ways
/// back to earlier nodes, the visits can oscillate.
const RELAXATION: f64 = 0.9;
/// The relative change in one sweep below which the visits are known.
const TOLERANCE: f64 = 1e-12;
/// The greatest number of sweeps over one component; a hundred are usual.
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
/// The nodes are taken by strongly connected components. Of a transient one, which walks leave for
/// good, the expected number of visits is computed; it tells how many walks arrive in the following
/// components. In a closed one, which no walk leaves, walks have the stationary distribution. Both
/// are solved by sweeps of Gauss and Seidel in the order of the nodes (Stewart, Introduction to the
/// Numerical Solution of Markov Chains, 1994, chapter 3): along a clip, in which one node follows
/// the other, a single sweep carries the walks as far as they would go in as many steps as there
/// are nodes.
#[derive(Clone, Debug)]
pub(super) struct LongRun {
    /// How often each node is visited: in a transient component, from a walk's start until it
    /// leaves.
    visits: Vec<f64>,
    /// The nodes, component by component. Walks come from earlier ones, never from later ones.
    order: Vec<usize>,
    components: Vec<Component>,
    /// The ways from nodes of the same component, without those that stay at their node.
    within: WaysInto,
    /// The ways from nodes of earlier components.
    between: WaysInto,
    /// The probability that the next step of a walk leaves a node.
    leaving: Vec<f64>,
    /// How often walks begin at each node of the present component, or come from earlier ones.
    entering: Vec<f64>,
    /// The visits of the nodes of the present component before the sweep.
    before: Vec<f64>,
    /// The present component, and its number of sweeps.
    component: usize,
    sweeps: usize,
    /// The ways that are not in `within` and `between` yet; `None` when all is prepared.
    unprepared: Option<Unprepared>,
}

/// The input of a computation that is not prepared yet.
#[derive(Clone, Debug)]
struct Unprepared {
    /// The ways.
    steps: Vec<Step>,
    /// The component of each node, once it is known.
    component_of: Option<Vec<usize>>,
}

#[derive(Clone, Debug)]
struct Component {
    /// Its nodes, in the order of all.
    nodes: Range<usize>,
    /// Whether walks leave it for good.
    is_transient: bool,
}

/// The ways into every node.
#[derive(Clone, Debug, Default)]
struct WaysInto {
    /// Where each way comes from and its probability there, node by node.
    ways: Vec<(u32, f64)>,
    /// The end of each node's part of `ways`.
    ends: Vec<usize>,
}

impl WaysInto {
    fn new(nodes: usize, steps: &[Step]) -> Self {
        let (ends, order) = grouped(nodes, steps.iter().map(|step| step.to.index()));
        let way = |at: usize| (steps[at].from.index() as u32, steps[at].probability);
        Self { ways: order.into_iter().map(way).collect(), ends }
    }

    /// Returns a node's part of the ways.
    fn range(&self, node: usize) -> Range<usize> {
        node.checked_sub(1).map_or(0, |before| self.ends[before])..self.ends[node]
    }

    /// Returns how many walks arrive at a node.
    fn arriving(&self, node: usize, visits: &[f64]) -> f64 {
        let ways = &self.ways[self.range(node)];
        ways.iter().map(|&(from, probability)| visits[from as usize] * probability).sum()
    }

    /// Returns the number of ways into some nodes.
    fn count(&self, nodes: &[usize]) -> usize {
        nodes.iter().map(|&node| self.range(node).len()).sum()
    }
}

impl LongRun {
    /// Begins the computation for a number of nodes and the ways between them, whose probabilities
    /// sum to 1 at each node, or to 0 where walks end.
    pub(super) fn new(nodes: usize, steps: Vec<Step>) -> Self {
        Self {
            visits: vec![0.0; nodes],
            order: Vec::new(),
            components: Vec::new(),
            within: WaysInto::default(),
            between: WaysInto::default(),
            leaving: vec![0.0; nodes],
            entering: Vec::new(),
            before: Vec::new(),
            component: 0,
            sweeps: 0,
            unprepared: Some(Unprepared { steps, component_of: None }),
        }
    }

    /// Does the next of two parts of the preparation: the components, then the ways into each node.
    /// With hundreds of thousands of ways, both together would take longer than a frame of the
    /// screen.
    fn prepare(&mut self, Unprepared { mut steps, component_of }: Unprepared) {
        let nodes = self.visits.len();
        let Some(component_of) = component_of else {
            steps.retain(|step| step.probability > 0.0 && step.from != step.to);
            for step in &steps {
                self.leaving[step.from.index()] += step.probability;
            }
            (self.order, self.components) = components_in_order(nodes, steps.iter().copied());
            let mut component_of = vec![0; nodes];
            for (index, component) in self.components.iter().enumerate() {
                for &node in &self.order[component.nodes.clone()] {
                    component_of[node] = index;
                }
            }
            self.unprepared = Some(Unprepared { steps, component_of: Some(component_of) });
            return;
        };
        let of = |node: NodeIndex| component_of[node.index()];
        let (within, between): (Vec<Step>, Vec<Step>) =
            steps.into_iter().partition(|step| of(step.from) == of(step.to));
        for step in &between {
            self.components[of(step.from)].is_transient = true;
        }
        self.within = WaysInto::new(nodes, &within);
        self.between = WaysInto::new(nodes, &between);
    }

    /// Prepares the ways in the first two calls; then follows about `ways` more of them, at least
    /// those of one sweep. Returns `true` when all is computed.
    pub(super) fn advance(&mut self, ways: usize) -> bool {
        if let Some(unprepared) = self.unprepared.take() {
            self.prepare(unprepared);
            return false;
        }
        let mut followed = 0;
        while followed < ways.max(1)
            && let Some(component) = self.components.get(self.component).cloned()
        {
            let nodes = &self.order[component.nodes.clone()];
            followed += nodes.len() + self.within.count(nodes);
            if self.sweeps == 0 {
                self.enter(&component);
            }
            let is_known = self.sweep(&component);
            self.sweeps += 1;
            if is_known || self.sweeps >= MAX_SWEEPS {
                self.finish(&component);
                (self.component, self.sweeps) = (self.component + 1, 0);
            }
        }
        self.component >= self.components.len()
    }

    /// Returns the share of all walks that is at each node in the long run, after the last
    /// [`advance`](Self::advance): 0 in transient components.
    pub(super) fn shares(&self) -> impl Iterator<Item = f64> + '_ {
        let mut shares = self.visits.clone();
        for component in self.components.iter().filter(|component| component.is_transient) {
            for &node in &self.order[component.nodes.clone()] {
                shares[node] = 0.0;
            }
        }
        shares.into_iter()
    }

    /// Counts the walks that come into a component.
    fn enter(&mut self, component: &Component) {
        let start = (self.order.len() as f64).recip();
        let nodes = &self.order[component.nodes.clone()];
        self.entering.clear();
        let from_others =
            nodes.iter().map(|&node| start + self.between.arriving(node, &self.visits));
        self.entering.extend(from_others);
        let all: f64 = self.entering.iter().sum();
        for &node in nodes {
            self.visits[node] = all / nodes.len() as f64;
        }
    }

    /// Does one sweep over a component; returns whether it has converged. A separate function,
    /// because browsers optimise a function between two of its calls.
    #[inline(never)]
    fn sweep(&mut self, component: &Component) -> bool {
        let nodes = &self.order[component.nodes.clone()];
        let visits = &mut self.visits;
        self.before.clear();
        for (&node, &entering) in nodes.iter().zip(&self.entering) {
            self.before.push(visits[node]);
            // A node without a way to another one keeps its walks.
            if self.leaving[node] > 0.0 {
                let entering = if component.is_transient { entering } else { 0.0 };
                let arriving = entering + self.within.arriving(node, visits);
                visits[node] = arriving / self.leaving[node];
            }
        }
        let (mut change, mut all) = (0.0, 0.0);
        for (&node, before) in nodes.iter().zip(&self.before) {
            let moved = RELAXATION * (visits[node] - before);
            visits[node] = before + moved;
            change += moved.abs();
            all += visits[node];
        }
        change <= TOLERANCE * all
    }

    /// Scales the visits of a closed component: they sum to the probability that walks end up in
    /// it.
    fn finish(&mut self, component: &Component) {
        if component.is_transient {
            return;
        }
        let nodes = &self.order[component.nodes.clone()];
        let all: f64 = nodes.iter().map(|&node| self.visits[node]).sum();
        let entered: f64 = self.entering.iter().sum();
        for &node in nodes {
            self.visits[node] *= entered / all;
        }
    }
}

/// Returns the nodes by strongly connected components, those that others are reached from first,
/// and these components, of which none counts as transient yet.
fn components_in_order(
    nodes: usize,
    steps: impl Iterator<Item = Step> + Clone,
) -> (Vec<usize>, Vec<Component>) {
    let edges = steps.map(|step| (step.from.index(), step.to.index()));
    let (mut order, mut parts) = (Vec::with_capacity(nodes), Vec::new());
    for component in components(nodes, edges).into_iter().rev() {
        let first = order.len();
        order.extend(component);
        parts.push(Component { nodes: first..order.len(), is_transient: false });
    }
    (order, parts)
}
