use super::Cast;
use super::wanted::GraphKey;
use crate::graph::{Candidates, FrameDistances, GraphError, GraphOptions, MotionGraph, Place};
use std::sync::Arc;

/// Width of a bin of the histogram, centimetres.
const BIN_CM: f64 = 0.5;
/// Its bins: as far as a threshold goes.
const BINS: usize = 120;

/// The distances of all windows of one length.
#[derive(Debug)]
pub struct Field {
    distances: FrameDistances,
    histogram: Vec<u32>,
}

impl Field {
    pub(super) fn new(distances: FrameDistances) -> Self {
        Self {
            distances,
            histogram: vec![0; BINS],
        }
    }

    /// Counts one pair of clips; `true` behind the last one.
    pub(super) fn count(&mut self, pair: usize) -> bool {
        self.distances.count(pair, BIN_CM, &mut self.histogram);
        pair + 1 >= self.distances.pairs_of_clips()
    }

    /// The distances.
    #[must_use]
    pub fn distances(&self) -> &FrameDistances {
        &self.distances
    }

    /// How many pairs of windows lie in each half centimetre; the last takes what is farther.
    #[must_use]
    pub fn histogram(&self) -> &[u32] {
        &self.histogram
    }

    /// How wide each of its bins is, centimetres.
    #[must_use]
    pub fn bin_cm(&self) -> f64 {
        BIN_CM
    }

    pub(super) fn cells(&self) -> usize {
        self.histogram.iter().map(|&count| count as usize).sum()
    }
}

/// A graph, and what is known of it.
#[derive(Debug)]
pub struct Built {
    pub(super) cast: Arc<Cast>,
    pub(super) key: GraphKey,
    whole: Arc<MotionGraph>,
    graph: Arc<MotionGraph>,
    /// Per node of the whole graph: its component, the largest first.
    component: Vec<usize>,
    /// The shares of all frames of the components that one can walk in, largest first.
    rings: Vec<f64>,
    /// Their components, in the same order.
    ring_components: Vec<usize>,
    dead_ends: usize,
}

impl Built {
    pub(super) fn new(cast: &Arc<Cast>, candidates: &Candidates, key: GraphKey) -> Result<Self, GraphError> {
        let whole = Arc::new(MotionGraph::new(cast.set(), candidates, &key.options)?);
        let graph = if key.pruned {
            Arc::new(whole.pruned()?)
        } else {
            Arc::clone(&whole)
        };
        let mut component = vec![0; whole.graph().node_count()];
        let (mut rings, mut ring_components) = (Vec::new(), Vec::new());
        let all = cast.set().frames().max(1) as f64;
        for (index, nodes) in whole.components().iter().enumerate() {
            for node in nodes {
                if let Some(slot) = component.get_mut(node.index()) {
                    *slot = index;
                }
            }
            let inside = |node: &petgraph::graph::NodeIndex| {
                let mut next = whole.graph().neighbors(*node);
                next.any(|next| nodes.binary_search(&next).is_ok())
            };
            if nodes.iter().any(inside) {
                ring_components.push(index);
                let stretches = nodes.iter().filter_map(|&node| whole.graph().node_weight(node));
                rings.push(stretches.map(|stretch| stretch.end - stretch.start).sum::<usize>() as f64 / all);
            }
        }
        Ok(Self {
            cast: Arc::clone(cast),
            key,
            dead_ends: whole.dead_ends().len(),
            whole,
            graph,
            component,
            rings,
            ring_components,
        })
    }

    /// The clips.
    #[must_use]
    pub fn cast(&self) -> &Arc<Cast> {
        &self.cast
    }

    /// How it was made.
    #[must_use]
    pub fn options(&self) -> &GraphOptions {
        &self.key.options
    }

    /// Whether only the largest component is walked in.
    #[must_use]
    pub fn is_pruned(&self) -> bool {
        self.key.pruned
    }

    /// All of the graph.
    #[must_use]
    pub fn whole(&self) -> &Arc<MotionGraph> {
        &self.whole
    }

    /// What is walked in.
    #[must_use]
    pub fn graph(&self) -> &Arc<MotionGraph> {
        &self.graph
    }

    /// In which of [`Self::rings`] a node of the whole graph lies; `None` outside of them.
    #[must_use]
    pub fn ring_of(&self, node: usize) -> Option<usize> {
        let component = self.component.get(node)?;
        self.ring_components.iter().position(|ring| ring == component)
    }

    /// The shares of all frames of the components that one can walk in for ever, largest first.
    #[must_use]
    pub fn rings(&self) -> &[f64] {
        &self.rings
    }

    /// Nodes without a way out.
    #[must_use]
    pub fn dead_ends(&self) -> usize {
        self.dead_ends
    }

    /// The index of a transition in the whole graph.
    #[must_use]
    pub fn jump_of(&self, leave: Place, enter: Place) -> Option<usize> {
        self.whole
            .jumps()
            .iter()
            .position(|jump| jump.leave == leave && jump.enter == enter)
    }
}
