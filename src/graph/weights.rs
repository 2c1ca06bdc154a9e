use super::{GraphError, MotionGraph, Way};
use petgraph::graph::{EdgeIndex, NodeIndex};
use petgraph::visit::EdgeRef;

/// How the distance of a transition makes it more or less probable.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum DistanceLaw {
    /// 1 / D: a transition twice as far is half as probable.
    Inverse,
    /// exp(-D / σ), with D less the smallest of the node (Lee, Chai, Reitsma, Hodgins, Pollard 2002, section 4.1).
    Exponential {
        /// σ, centimetres.
        sigma_cm: f64,
    },
    /// All alike.
    Uniform,
    /// D itself: the classic mistake, by which the worst transitions are the most probable.
    Proportional,
}

/// How probable each way out of a stretch is.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct WeightOptions {
    /// The probability that a clip goes on where it can and there are transitions, 0 to 1.
    pub continuity: f64,
    /// How the transitions share the rest.
    pub law: DistanceLaw,
}

impl Default for WeightOptions {
    fn default() -> Self {
        Self {
            continuity: 0.95,
            law: DistanceLaw::Inverse,
        }
    }
}

/// Shares of a node's ways out add up to this.
const WHOLE: u64 = 1 << 32;
/// The smallest distance that is divided by, centimetres.
const LEAST_CM: f64 = 0.01;
/// More steps do not change where a walk is found in the long run.
const MOST_STEPS: usize = 2_000;

/// The ways out of every node with their probabilities, as whole numbers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Choices {
    /// Per node: edges in the order of their indices, with shares of [`WHOLE`] that add up to it.
    ways: Vec<Vec<(EdgeIndex, u64)>>,
}

impl Choices {
    /// The probabilities of a graph's edges. Those of one node add up to 1, exactly: they are multiples of 2⁻³². A node whose clip ends has
    /// transitions only; one without transitions goes on; one without both has none.
    ///
    /// # Errors
    /// [`GraphError::Setting`] when the continuity is not from 0 to 1, or σ not above 0.
    pub fn new(graph: &MotionGraph, options: &WeightOptions) -> Result<Self, GraphError> {
        let setting = |what, value: f64, least: f64, most: f64| {
            if (least..=most).contains(&value) {
                Ok(())
            } else {
                Err(GraphError::Setting { what, value, least, most })
            }
        };
        setting("a continuity", options.continuity, 0.0, 1.0)?;
        if let DistanceLaw::Exponential { sigma_cm } = options.law {
            setting("a width of the exponential law", sigma_cm, 1e-3, 1e6)?;
        }
        let ways = graph.graph.node_indices().map(|node| ways_out(graph, node, options)).collect();
        Ok(Self { ways })
    }

    /// The ways out of a node, with shares of 2³² that add up to it.
    pub(super) fn ways(&self, node: NodeIndex) -> &[(EdgeIndex, u64)] {
        self.ways.get(node.index()).map_or(&[], Vec::as_slice)
    }

    /// The ways out of a node with their probabilities.
    pub fn probabilities(&self, node: NodeIndex) -> impl Iterator<Item = (EdgeIndex, f64)> + '_ {
        self.ways(node).iter().map(|&(edge, share)| (edge, share as f64 / WHOLE as f64))
    }

    /// The probability that the clip goes on behind a node.
    #[must_use]
    pub fn p_continue(&self, graph: &MotionGraph, node: NodeIndex) -> f64 {
        let goes_on = |edge: &(EdgeIndex, f64)| graph.jump(edge.0).is_none();
        self.probabilities(node).filter(goes_on).map(|(_, p)| p).sum()
    }

    /// How many nodes play on end until the next transition, on average, if all are like this one: 1 / (1 - p). Infinite where the clip always goes on.
    #[must_use]
    pub fn expected_run_nodes(&self, graph: &MotionGraph, node: NodeIndex) -> f64 {
        (1.0 - self.p_continue(graph, node)).recip()
    }

    /// Seconds from one transition to the next in a long walk, on average: frames per step over transitions per step, weighed by how often a
    /// walk comes through each node (the stationary distribution, by power iteration). `None` where a walk has no transitions in the long run, or
    /// comes to an end.
    #[must_use]
    pub fn expected_run_secs(&self, graph: &MotionGraph) -> Option<f64> {
        let mut run = RunLength::new(graph, self);
        while !run.advance(MOST_STEPS) {}
        run.secs(graph, self)
    }
}

/// [`Choices::expected_run_secs`] in slices.
#[derive(Clone, Debug)]
pub struct RunLength {
    /// How probable it is to be in each node.
    now: Vec<f64>,
    next: Vec<f64>,
    /// The ways into every node, one node's behind the other's: where they come from, and half of how probable they are there.
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
        let mut into = vec![Vec::new(); nodes];
        for node in graph.graph.node_indices() {
            for (edge, share) in choices.probabilities(node) {
                if let Some((_, to)) = graph.graph.edge_endpoints(edge) {
                    into[to.index()].push((node.index() as u32, 0.5 * share));
                }
            }
        }
        let ends = into.iter().scan(0, |sum, ways| {
            *sum += ways.len();
            Some(*sum)
        });
        Self {
            now: vec![1.0 / nodes as f64; nodes],
            next: vec![0.0; nodes],
            ends: ends.collect(),
            ways: into.concat(),
            steps: 0,
        }
    }

    /// Does up to `steps` more steps, O(edges) each; `true` when no more are needed.
    pub fn advance(&mut self, steps: usize) -> bool {
        for _ in 0..steps {
            if self.steps >= MOST_STEPS {
                break;
            }
            self.steps += 1;
            let (mut from, mut change) = (0, 0.0);
            for ((next, &end), &now) in self.next.iter_mut().zip(&self.ends).zip(&self.now) {
                // Half of it stays where it is: a walk that comes round in a fixed number of steps would never settle.
                let arriving = self.ways[from..end].iter().map(|&(from, share)| self.now[from as usize] * share);
                *next = arriving.fold(0.5 * now, |sum, p| sum + p);
                change += (*next - now).abs();
                from = end;
            }
            std::mem::swap(&mut self.now, &mut self.next);
            if change < 1e-12 {
                self.steps = MOST_STEPS;
            }
        }
        self.steps >= MOST_STEPS
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

fn ways_out(graph: &MotionGraph, node: NodeIndex, options: &WeightOptions) -> Vec<(EdgeIndex, u64)> {
    let mut edges: Vec<(EdgeIndex, Option<f64>)> = (graph.graph.edges(node))
        .map(|edge| {
            let distance = match edge.weight() {
                Way::Continue => None,
                Way::Jump(index) => graph.jumps.get(*index).map(|jump| jump.distance_cm),
            };
            (edge.id(), distance)
        })
        .collect();
    edges.sort_unstable_by_key(|&(edge, _)| edge);
    let distances = || edges.iter().filter_map(|&(_, distance)| distance);
    let nearest = distances().fold(f64::INFINITY, f64::min);
    let weight = |distance: f64| match options.law {
        DistanceLaw::Inverse => distance.max(LEAST_CM).recip(),
        DistanceLaw::Exponential { sigma_cm } => libm::exp((nearest - distance) / sigma_cm),
        DistanceLaw::Uniform => 1.0,
        DistanceLaw::Proportional => distance.max(LEAST_CM),
    };
    let sum: f64 = distances().map(weight).sum();
    let goes_on = edges.iter().any(|&(_, distance)| distance.is_none());
    let share = match (goes_on, sum > 0.0) {
        (true, true) => (options.continuity * WHOLE as f64).round() as u64,
        (true, false) => WHOLE,
        (false, _) => 0,
    };
    let for_jumps = WHOLE - share;
    let mut ways: Vec<(EdgeIndex, u64)> = (edges.iter())
        .map(|&(edge, distance)| match distance {
            None => (edge, share),
            Some(distance) => (edge, (weight(distance) / sum * for_jumps as f64).floor() as u64),
        })
        .collect();
    // What rounding down has left goes to the closest transition, the first of equals.
    let given: u64 = ways.iter().map(|&(_, share)| share).sum();
    let closest = edges.iter().position(|&(_, distance)| distance == Some(nearest));
    if let Some((_, share)) = closest.and_then(|at| ways.get_mut(at)) {
        *share = (*share + WHOLE).saturating_sub(given);
    }
    ways
}
