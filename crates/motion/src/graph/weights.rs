//! Probabilities of the ways out of a stretch.

use super::grouped::grouped;
use super::long_run::{LongRun, Step};
use super::{GraphError, MotionGraph, Way};
use petgraph::graph::{EdgeIndex, NodeIndex};

/// The law by which the distance of a transition determines its probability.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum DistanceLaw {
    /// 1 / D: a transition at twice the distance has half the probability.
    Inverse,
    /// exp(-D / σ), with D minus the smallest of the node (Lee, Chai, Reitsma, Hodgins, Pollard
    /// 2002, section 4.1).
    Exponential {
        /// σ, centimetres.
        sigma_cm: f64,
    },
    /// Equal probabilities.
    Uniform,
    /// D itself: the classic mistake, by which the worst transitions are the most probable.
    Proportional,
}

/// The probability that a clip continues where it can and there are transitions.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum Continuity {
    /// This probability, 0 to 1, however many transitions there are.
    Share(f64),
    /// This weight, above 0, among the weights that [`DistanceLaw`] gives the transitions: every
    /// further way out makes it less probable.
    Weight(f64),
}

impl Continuity {
    /// The greatest weight.
    pub const MAX_WEIGHT: f64 = 1e6;
}

/// Options of the probabilities of ways out.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct WeightOptions {
    /// The probability that the clip continues.
    pub continuity: Continuity,
    /// The distribution of the rest over transitions.
    pub law: DistanceLaw,
}

impl Default for WeightOptions {
    fn default() -> Self {
        Self { continuity: Continuity::Share(0.95), law: DistanceLaw::Inverse }
    }
}

/// The sum of the shares of a node's ways out.
const WHOLE: u64 = 1 << 32;
/// The least distance used as a divisor, centimetres.
const MIN_CM: f64 = 0.01;

/// The ways out of every node with their probabilities, as integers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Choices {
    /// Edges in the order of their indices, node by node, with shares that sum to [`WHOLE`] for
    /// each node.
    ways: Vec<(EdgeIndex, u64)>,
    /// The end of each node's part of `ways`.
    ends: Vec<usize>,
}

impl Choices {
    /// Computes the probabilities of a graph's edges. Those of one node sum to 1 exactly: they are
    /// multiples of 2⁻³². A node whose clip ends has transitions only; one without transitions
    /// continues; one without both has none.
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
                setting("a weight of continuing", weight, 1e-6, Continuity::MAX_WEIGHT)?;
            }
        }
        if let DistanceLaw::Exponential { sigma_cm } = options.law {
            setting("a width of the exponential law", sigma_cm, 1e-3, 1e6)?;
        }
        let edges = graph.graph.raw_edges();
        let sources = edges.iter().map(|edge| edge.source().index());
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

    /// Returns the ways out of a node, with shares that sum to 2³².
    pub(super) fn ways(&self, node: NodeIndex) -> &[(EdgeIndex, u64)] {
        let end_of = |index: usize| self.ends.get(index).copied();
        let from = node.index().checked_sub(1).map_or(Some(0), end_of);
        let range = from.zip(end_of(node.index())).map(|(from, end)| from..end);
        range.and_then(|range| self.ways.get(range)).unwrap_or_default()
    }

    /// Returns the ways out of a node with their probabilities.
    pub fn probabilities(&self, node: NodeIndex) -> impl Iterator<Item = (EdgeIndex, f64)> + '_ {
        self.ways(node).iter().map(|&(edge, share)| (edge, share_of(share)))
    }

    /// Returns the probability that the clip continues after a node.
    #[must_use]
    pub fn p_continue(&self, graph: &MotionGraph, node: NodeIndex) -> f64 {
        let goes_on = |edge: &(EdgeIndex, f64)| graph.jump(edge.0).is_none();
        self.probabilities(node).filter(goes_on).map(|(_, p)| p).sum()
    }

    /// Returns the mean number of consecutive nodes until the next transition, if all are like this
    /// one: 1 / (1 - p). Infinite where the clip always continues.
    #[must_use]
    pub fn expected_run_nodes(&self, graph: &MotionGraph, node: NodeIndex) -> f64 {
        (1.0 - self.p_continue(graph, node)).recip()
    }

    /// Returns the mean time from one transition to the next in a long walk, seconds: frames per
    /// step over transitions per step, weighted by how often a walk visits each node (the limiting
    /// distribution of walks that begin at every node with the same probability). `None` where
    /// walks have no transitions in the long run, or all of them come to an end.
    #[must_use]
    pub fn expected_run_secs(&self, graph: &MotionGraph) -> Option<f64> {
        let mut run = RunLength::new(graph, self);
        while !run.advance(usize::MAX) {}
        run.secs(graph, self)
    }
}

/// The computation of [`Choices::expected_run_secs`] in slices, by sweeps of Gauss and Seidel
/// (Stewart, Introduction to the Numerical Solution of Markov Chains, 1994, chapter 3) until the
/// visits of the nodes change by less than 1e-12 of all, at most 2,000 for each strongly connected
/// component.
#[derive(Clone, Debug)]
pub struct RunLength(LongRun);

impl RunLength {
    /// Begins the computation for walks through a graph.
    #[must_use]
    pub fn new(graph: &MotionGraph, choices: &Choices) -> Self {
        let edges = graph.graph.raw_edges();
        let mut steps = Vec::with_capacity(edges.len());
        for node in graph.graph.node_indices() {
            steps.extend(choices.ways(node).iter().map(|&(edge, share)| {
                let edge = &edges[edge.index()];
                Step { from: edge.source(), to: edge.target(), probability: share_of(share) }
            }));
        }
        Self(LongRun::new(graph.graph.node_count(), steps))
    }

    /// Does a part of the preparation, in the first two calls; then at least one more sweep, until
    /// about `edges` edges were followed, each counted at every sweep. Returns `true` after the
    /// last one.
    pub fn advance(&mut self, edges: usize) -> bool {
        self.0.advance(edges)
    }

    /// Returns the mean time from one transition to the next, seconds; `None` where there are none
    /// in the long run.
    #[must_use]
    pub fn secs(&self, graph: &MotionGraph, choices: &Choices) -> Option<f64> {
        let (mut frames, mut jumps) = (0.0, 0.0);
        for (node, p) in graph.graph.node_indices().zip(self.0.shares()) {
            for (edge, share) in choices.probabilities(node) {
                frames += p * share * graph.frames_of(edge) as f64;
                jumps += if graph.jump(edge).is_some() { p * share } else { 0.0 };
            }
        }
        (jumps > 1e-9).then(|| frames / jumps / graph.set.fps())
    }
}

/// Returns a share as a probability.
fn share_of(share: u64) -> f64 {
    share as f64 / WHOLE as f64
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
    // The remainder of rounding down goes to the closest transition, the first of equals.
    let own = ways.get_mut(first..).unwrap_or_default();
    let given: u64 = own.iter().map(|&(_, share)| share).sum();
    let closest = edges.iter().position(|&(_, distance)| distance == Some(nearest));
    if let Some((_, share)) = closest.and_then(|at| own.get_mut(at)) {
        *share = (*share + WHOLE).saturating_sub(given);
    }
}
