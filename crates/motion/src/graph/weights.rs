use super::{GraphError, MotionGraph, Way};
use petgraph::graph::{EdgeIndex, NodeIndex};

/// How the distance of a transition makes it more or less probable.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum DistanceLaw {
    /// 1 / D: a transition twice as far is half as probable.
    Inverse,
    /// exp(-D / σ), with D less the smallest of the node (Lee, Chai, Reitsma, Hodgins, Pollard
    /// 2002, section 4.1).
    Exponential {
        /// σ, centimetres.
        sigma_cm: f64,
    },
    /// All alike.
    Uniform,
    /// D itself: the classic mistake, by which the worst transitions are the most probable.
    Proportional,
}

/// How probable it is that a clip goes on where it can and there are transitions.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum Continuity {
    /// With this probability, 0 to 1, however many transitions there are.
    Share(f64),
    /// With this weight, above 0, among the weights that [`DistanceLaw`] gives the transitions:
    /// every further way out makes it less probable.
    Weight(f64),
}

impl Continuity {
    /// The largest weight that can be given.
    pub const MAX_WEIGHT: f64 = 1e6;
}

/// How probable each way out of a stretch is.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct WeightOptions {
    /// How probable it is that the clip goes on.
    pub continuity: Continuity,
    /// How the transitions share the rest.
    pub law: DistanceLaw,
}

impl Default for WeightOptions {
    fn default() -> Self {
        Self { continuity: Continuity::Share(0.95), law: DistanceLaw::Inverse }
    }
}

/// Shares of a node's ways out add up to this.
const WHOLE: u64 = 1 << 32;
/// The smallest distance that is divided by, centimetres.
const MIN_CM: f64 = 0.01;
/// More steps do not change where a walk is found in the long run.
const MAX_STEPS: usize = 2_000;

/// The ways out of every node with their probabilities, as whole numbers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Choices {
    /// Edges in the order of their indices, one node's behind the other's, with shares of [`WHOLE`]
    /// that add up to it for each node.
    ways: Vec<(EdgeIndex, u64)>,
    /// Where in `ways` those of a node end.
    ends: Vec<usize>,
}

impl Choices {
    /// The probabilities of a graph's edges. Those of one node add up to 1, exactly: they are
    /// multiples of 2⁻³². A node whose clip ends has transitions only; one without transitions goes
    /// on; one without both has none.
    ///
    /// # Errors
    /// [`GraphError::Setting`] when the continuity is out of range, or σ not above 0.
    pub fn new(graph: &MotionGraph, options: &WeightOptions) -> Result<Self, GraphError> {
        let setting = |what, value: f64, least: f64, most: f64| {
            if (least..=most).contains(&value) {
                Ok(())
            } else {
                Err(GraphError::Setting { what, value, least, most })
            }
        };
        match options.continuity {
            Continuity::Share(share) => setting("a continuity", share, 0.0, 1.0)?,
            Continuity::Weight(weight) => {
                setting("a weight of going on", weight, 1e-6, Continuity::MAX_WEIGHT)?;
            }
        }
        if let DistanceLaw::Exponential { sigma_cm } = options.law {
            setting("a width of the exponential law", sigma_cm, 1e-3, 1e6)?;
        }
        let edges = graph.graph.raw_edges();
        let sources = edges.iter().map(petgraph::graph::Edge::source);
        let (ends, order) = grouped(graph.graph.node_count(), sources);
        let mut ways = Vec::with_capacity(edges.len());
        let (mut from, mut of_one) = (0, Vec::new());
        for &end in &ends {
            of_one.clear();
            of_one.extend(order[from..end].iter().map(|&index| {
                let jump = match edges[index].weight {
                    Way::Continue => None,
                    Way::Jump(jump) => graph.jumps.get(jump),
                };
                (EdgeIndex::new(index), jump.map(|jump| jump.distance_cm))
            }));
            share_out(&of_one, options, &mut ways);
            from = end;
        }
        Ok(Self { ways, ends })
    }

    /// The ways out of a node, with shares of 2³² that add up to it.
    pub(super) fn ways(&self, node: NodeIndex) -> &[(EdgeIndex, u64)] {
        let end_of = |index: usize| self.ends.get(index).copied();
        let from = node.index().checked_sub(1).map_or(Some(0), end_of);
        let range = from.zip(end_of(node.index())).map(|(from, end)| from..end);
        range.and_then(|range| self.ways.get(range)).unwrap_or_default()
    }

    /// The ways out of a node with their probabilities.
    pub fn probabilities(&self, node: NodeIndex) -> impl Iterator<Item = (EdgeIndex, f64)> + '_ {
        self.ways(node).iter().map(|&(edge, share)| (edge, share_of(share)))
    }

    /// The probability that the clip goes on behind a node.
    #[must_use]
    pub fn p_continue(&self, graph: &MotionGraph, node: NodeIndex) -> f64 {
        let goes_on = |edge: &(EdgeIndex, f64)| graph.jump(edge.0).is_none();
        self.probabilities(node).filter(goes_on).map(|(_, p)| p).sum()
    }

    /// How many nodes play on end until the next transition, on average, if all are like this one:
    /// 1 / (1 - p). Infinite where the clip always goes on.
    #[must_use]
    pub fn expected_run_nodes(&self, graph: &MotionGraph, node: NodeIndex) -> f64 {
        (1.0 - self.p_continue(graph, node)).recip()
    }

    /// Seconds from one transition to the next in a long walk, on average: frames per step over
    /// transitions per step, weighed by how often a walk comes through each node (the stationary
    /// distribution, by power iteration). `None` where a walk has no transitions in the long run,
    /// or comes to an end.
    #[must_use]
    pub fn expected_run_secs(&self, graph: &MotionGraph) -> Option<f64> {
        let mut run = RunLength::new(graph, self);
        while !run.advance(MAX_STEPS) {}
        run.secs(graph, self)
    }
}

/// [`Choices::expected_run_secs`] in slices.
#[derive(Clone, Debug)]
pub struct RunLength {
    /// How probable it is to be in each node.
    now: Vec<f64>,
    next: Vec<f64>,
    /// The ways into every node, one node's behind the other's: where they come from, and half of
    /// how probable they are there.
    ways: Vec<(u32, f64)>,
    /// Where in `ways` those of a node end.
    ends: Vec<usize>,
    steps: usize,
}

impl RunLength {
    /// Of walks through a graph.
    #[must_use]
    pub fn new(graph: &MotionGraph, choices: &Choices) -> Self {
        let nodes = graph.graph.node_count();
        let from_nodes = graph
            .graph
            .node_indices()
            .flat_map(|node| choices.ways(node).iter().map(move |way| (node, way)));
        let edges = graph.graph.raw_edges();
        let targets = choices.ways.iter().map(|(edge, _)| edges[edge.index()].target());
        let (ends, order) = grouped(nodes, targets);
        let all: Vec<(u32, f64)> = from_nodes
            .map(|(node, &(_, share))| (node.index() as u32, 0.5 * share_of(share)))
            .collect();
        Self {
            now: vec![1.0 / nodes as f64; nodes],
            next: vec![0.0; nodes],
            ways: order.iter().map(|&way| all[way]).collect(),
            ends,
            steps: 0,
        }
    }

    /// Does up to `steps` more steps, O(edges) each; `true` when no more are needed.
    pub fn advance(&mut self, steps: usize) -> bool {
        for _ in 0..steps {
            if self.steps >= MAX_STEPS {
                break;
            }
            self.steps += 1;
            let (mut from, mut change) = (0, 0.0);
            for ((next, &end), &now) in self.next.iter_mut().zip(&self.ends).zip(&self.now) {
                // Half of it stays where it is: a walk that comes round in a fixed number of steps
                // would never settle.
                let arriving = self.ways[from..end]
                    .iter()
                    .map(|&(from, share)| self.now[from as usize] * share);
                *next = arriving.fold(0.5 * now, |sum, p| sum + p);
                change += (*next - now).abs();
                from = end;
            }
            std::mem::swap(&mut self.now, &mut self.next);
            if change < 1e-12 {
                self.steps = MAX_STEPS;
            }
        }
        self.steps >= MAX_STEPS
    }

    /// Seconds from one transition to the next; `None` where there are none in the long run.
    #[must_use]
    pub fn secs(&self, graph: &MotionGraph, choices: &Choices) -> Option<f64> {
        let (mut frames, mut jumps) = (0.0, 0.0);
        for (node, p) in graph.graph.node_indices().zip(&self.now) {
            for (edge, share) in choices.probabilities(node) {
                frames += p * share * graph.frames_of(edge) as f64;
                jumps += if graph.jump(edge).is_some() { p * share } else { 0.0 };
            }
        }
        (jumps > 1e-9).then(|| frames / jumps / graph.set.fps())
    }
}

/// A share as a probability.
fn share_of(share: u64) -> f64 {
    share as f64 / WHOLE as f64
}

/// Brings things together that belong to the same of `groups`: where those of each group end, and
/// the numbers of the things in that order, in which things of one group stay in theirs. Three
/// passes over flat arrays: of very many edges, lists of lists would take most of the time.
fn grouped(groups: usize, of: impl Iterator<Item = NodeIndex> + Clone) -> (Vec<usize>, Vec<usize>) {
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

/// Appends the ways out of one node with their shares. `edges` are those of the node, with the
/// distances of transitions.
fn share_out(
    edges: &[(EdgeIndex, Option<f64>)],
    options: &WeightOptions,
    ways: &mut Vec<(EdgeIndex, u64)>,
) {
    let distances = || edges.iter().filter_map(|&(_, distance)| distance);
    let nearest = distances().fold(f64::INFINITY, f64::min);
    let weight = |distance: f64| match options.law {
        DistanceLaw::Inverse => distance.max(MIN_CM).recip(),
        DistanceLaw::Exponential { sigma_cm } => libm::exp((nearest - distance) / sigma_cm),
        DistanceLaw::Uniform => 1.0,
        DistanceLaw::Proportional => distance.max(MIN_CM),
    };
    let sum: f64 = distances().map(weight).sum();
    let goes_on = edges.iter().any(|&(_, distance)| distance.is_none());
    let going_on = match options.continuity {
        Continuity::Share(share) => share,
        Continuity::Weight(weight) => weight / (weight + sum),
    };
    let share = match (goes_on, sum > 0.0) {
        (true, true) => (going_on * WHOLE as f64).round() as u64,
        (true, false) => WHOLE,
        (false, _) => 0,
    };
    let for_jumps = WHOLE - share;
    let first = ways.len();
    ways.extend(edges.iter().map(|&(edge, distance)| match distance {
        None => (edge, share),
        Some(distance) => (edge, (weight(distance) / sum * for_jumps as f64).floor() as u64),
    }));
    // What rounding down has left goes to the closest transition, the first of equals.
    let own = ways.get_mut(first..).unwrap_or_default();
    let given: u64 = own.iter().map(|&(_, share)| share).sum();
    let closest = edges.iter().position(|&(_, distance)| distance == Some(nearest));
    if let Some((_, share)) = closest.and_then(|at| own.get_mut(at)) {
        *share = (*share + WHOLE).saturating_sub(given);
    }
}
