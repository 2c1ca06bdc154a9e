//! Motion graphs and distance fields of the Graph lab.

use super::GraphClips;
use super::requests::GraphKey;
use petgraph::graph::{EdgeIndex, NodeIndex};
use petgraph::visit::Dfs;
use segue_motion::graph::{
    Candidates, Choices, CountedTo, DistanceOverview, FrameDistances, GraphError, GraphOptions,
    MotionGraph, Place,
};
use std::ops::ControlFlow;
use std::sync::Arc;

/// The distances of all windows of one length.
#[derive(Debug)]
pub struct DistanceField {
    distances: Distances,
    /// The histogram of the stored distances.
    histogram: Vec<u32>,
}

/// All distances of a set, as far as they are kept in memory.
#[derive(Debug)]
pub enum Distances {
    /// Every distance.
    Held(FrameDistances),
    /// The smallest distance in every square of windows.
    Overview(Box<DistanceOverview>),
}

impl DistanceField {
    /// Returns a field whose distances are yet to be counted.
    pub(super) fn held(distances: FrameDistances) -> Self {
        Self { distances: Distances::Held(distances), histogram: vec![0; DistanceOverview::BINS] }
    }

    /// Returns a field of distances with their histogram.
    pub(super) fn counted(distances: FrameDistances, histogram: Vec<u32>) -> Self {
        Self { distances: Distances::Held(distances), histogram }
    }

    pub(super) fn overview(overview: DistanceOverview) -> Self {
        Self { distances: Distances::Overview(Box::new(overview)), histogram: Vec::new() }
    }

    /// Counts about `cells` more cells; returns `true` after the last one.
    pub(super) fn count(&mut self, at: &mut CountedTo, cells: usize) -> bool {
        match &self.distances {
            Distances::Held(distances) => {
                distances.count(at, cells, DistanceOverview::BIN_CM, &mut self.histogram)
            }
            Distances::Overview(_) => true,
        }
    }

    /// Returns the distances.
    #[must_use]
    pub fn distances(&self) -> &Distances {
        &self.distances
    }

    /// Returns all distances, if they are kept in memory.
    pub(super) fn all(&self) -> Option<&FrameDistances> {
        match &self.distances {
            Distances::Held(distances) => Some(distances),
            Distances::Overview(_) => None,
        }
    }

    /// Returns the number of frames of each window.
    #[must_use]
    pub fn window(&self) -> usize {
        match &self.distances {
            Distances::Held(distances) => distances.window(),
            Distances::Overview(overview) => overview.window(),
        }
    }

    /// Returns the distance of the windows that start at two frames, centimetres; `None` if a
    /// window crosses the end of its clip.
    #[must_use]
    pub fn cm(&self, a: Place, b: Place) -> Option<f64> {
        match &self.distances {
            Distances::Held(distances) => distances.cm(a, b),
            Distances::Overview(overview) => overview.cm(a, b),
        }
    }

    /// Returns the number of pairs of windows in each half centimetre; the last bin includes all
    /// larger distances.
    #[must_use]
    pub fn histogram(&self) -> &[u32] {
        match &self.distances {
            Distances::Held(_) => &self.histogram,
            Distances::Overview(overview) => overview.histogram(),
        }
    }

    /// Returns the width of the bins, centimetres.
    #[must_use]
    pub fn bin_cm(&self) -> f64 {
        DistanceOverview::BIN_CM
    }

    /// Returns the number of stored distances.
    pub(super) fn cells(&self) -> usize {
        match &self.distances {
            Distances::Held(_) => self.histogram.iter().map(|&count| count as usize).sum(),
            Distances::Overview(overview) => overview.cells(),
        }
    }
}

/// A graph, and facts about it.
#[derive(Debug)]
pub struct BuiltGraph {
    pub(super) clips: Arc<GraphClips>,
    pub(super) key: GraphKey,
    whole: Arc<MotionGraph>,
    graph: Arc<MotionGraph>,
    /// The share of all frames of each component that allows endless walks, the largest first.
    component_shares: Vec<f64>,
    /// For each node of the whole graph, the index of its component in `component_shares`; `None`
    /// if that allows no endless walk.
    share_of: Vec<Option<usize>>,
    dead_ends: usize,
    is_truncated: bool,
    /// For each clip, whether walks can use any of it.
    is_walked: Vec<bool>,
}

/// The construction of a [`BuiltGraph`] in slices, because very many transitions take milliseconds
/// each.
#[derive(Debug)]
pub(super) enum Building {
    /// Candidates for transitions are known.
    Found(Arc<Candidates>),
    /// Nodes and transitions are known, and whether there are more transitions than can be kept.
    Linked(MotionGraph, bool),
    /// Components are known.
    Parted(Arc<MotionGraph>, bool, Vec<Vec<NodeIndex>>),
}

impl Building {
    /// Does the next slice; returns the remaining work, or the graph.
    pub(super) fn advance(
        self,
        clips: &Arc<GraphClips>,
        key: GraphKey,
    ) -> Result<ControlFlow<BuiltGraph, Self>, GraphError> {
        Ok(match self {
            Self::Found(candidates) => {
                let is_truncated = !candidates.are_all_within(key.options.edge_threshold_cm);
                let whole = MotionGraph::new(clips.set(), &candidates, &key.options)?;
                ControlFlow::Continue(Self::Linked(whole, is_truncated))
            }
            Self::Linked(whole, is_truncated) => {
                let components = whole.components();
                ControlFlow::Continue(Self::Parted(Arc::new(whole), is_truncated, components))
            }
            Self::Parted(whole, is_truncated, components) => {
                let built = BuiltGraph::new(clips, whole, &components, key)?;
                ControlFlow::Break(BuiltGraph { is_truncated, ..built })
            }
        })
    }
}

impl BuiltGraph {
    fn new(
        clips: &Arc<GraphClips>,
        whole: Arc<MotionGraph>,
        components: &[Vec<NodeIndex>],
        key: GraphKey,
    ) -> Result<Self, GraphError> {
        let graph =
            if key.pruned { Arc::new(whole.pruned_to(components)?) } else { Arc::clone(&whole) };
        let mut share_of = vec![None; whole.graph().node_count()];
        let mut component_shares = Vec::new();
        let all = clips.set().frames().max(1) as f64;
        for nodes in components {
            let inside = |node: &NodeIndex| {
                let mut next = whole.graph().neighbors(*node);
                next.any(|next| nodes.binary_search(&next).is_ok())
            };
            if nodes.iter().any(inside) {
                for node in nodes {
                    if let Some(slot) = share_of.get_mut(node.index()) {
                        *slot = Some(component_shares.len());
                    }
                }
                let stretches = nodes.iter().filter_map(|&node| whole.graph().node_weight(node));
                component_shares.push(
                    stretches.map(|stretch| stretch.end - stretch.start).sum::<usize>() as f64
                        / all,
                );
            }
        }
        let mut is_walked = vec![false; clips.set().clips().len()];
        for stretch in graph.graph().node_weights() {
            is_walked[stretch.clip] = true;
        }
        Ok(Self {
            is_truncated: false,
            is_walked,
            clips: Arc::clone(clips),
            key,
            dead_ends: whole.dead_ends().len(),
            whole,
            graph,
            component_shares,
            share_of,
        })
    }

    /// Returns the clips.
    #[must_use]
    pub fn clips(&self) -> &Arc<GraphClips> {
        &self.clips
    }

    /// Returns the options of its construction.
    #[must_use]
    pub fn options(&self) -> &GraphOptions {
        &self.key.options
    }

    /// Returns whether walks are restricted to the largest component.
    #[must_use]
    pub fn is_pruned(&self) -> bool {
        self.key.pruned
    }

    /// Returns the whole graph.
    #[must_use]
    pub fn whole(&self) -> &Arc<MotionGraph> {
        &self.whole
    }

    /// Returns the graph of the walks.
    #[must_use]
    pub fn graph(&self) -> &Arc<MotionGraph> {
        &self.graph
    }

    /// Returns the index in [`Self::component_shares`] of the component of a node of the whole
    /// graph; `None` if it is in none of them.
    #[must_use]
    pub fn component_of(&self, node: usize) -> Option<usize> {
        self.share_of.get(node).copied().flatten()
    }

    /// Returns the shares of all frames of the components that allow endless walks, the largest
    /// first.
    #[must_use]
    pub fn component_shares(&self) -> &[f64] {
        &self.component_shares
    }

    /// Returns the probability of each transition of the whole graph at the end of its stretch;
    /// `None` where walks cannot take it. O(edges).
    #[must_use]
    pub fn probabilities(&self, choices: &Choices) -> Vec<Option<f64>> {
        let nodes = self.graph.graph().node_indices();
        self.of_transitions(nodes.flat_map(|node| choices.probabilities(node)))
    }

    /// Returns 0 for each transition of the whole graph that walks can take, else `None`. O(edges).
    #[must_use]
    pub fn reachable(&self) -> Vec<Option<f64>> {
        self.of_transitions(self.graph.graph().edge_indices().map(|edge| (edge, 0.0)))
    }

    /// Returns values of edges of the graph of the walks by the transitions of the whole graph.
    fn of_transitions(&self, values: impl Iterator<Item = (EdgeIndex, f64)>) -> Vec<Option<f64>> {
        let mut of_transitions = vec![None; self.whole.jumps().len()];
        for (edge, value) in values {
            let index = self.graph.origin(edge);
            if let Some(slot) = index.and_then(|index| of_transitions.get_mut(index)) {
                *slot = Some(value);
            }
        }
        of_transitions
    }

    /// Returns the number of nodes without an outgoing edge.
    #[must_use]
    pub fn dead_ends(&self) -> usize {
        self.dead_ends
    }

    /// Returns whether there are more transitions below the threshold than can be kept: the closest
    /// are kept.
    #[must_use]
    pub fn is_truncated(&self) -> bool {
        self.is_truncated
    }

    /// Returns whether walks can use any of a clip; from everywhere, if the graph is pruned.
    #[must_use]
    pub fn is_walked(&self, clip: usize) -> bool {
        self.is_walked.get(clip).copied().unwrap_or(false)
    }

    /// Returns the clips that can be reached from a place, its own included; in a pruned graph, all
    /// clips that walks use.
    #[must_use]
    pub fn clips_from(&self, place: Place) -> Vec<bool> {
        let start = self.graph.node_at(place);
        let Some(start) = start.filter(|_| !self.key.pruned) else {
            return self.is_walked.clone();
        };
        let graph = self.graph.graph();
        let mut reached = vec![false; self.is_walked.len()];
        let mut search = Dfs::new(graph, start);
        while let Some(node) = search.next(graph) {
            if let Some(slot) =
                graph.node_weight(node).and_then(|stretch| reached.get_mut(stretch.clip))
            {
                *slot = true;
            }
        }
        reached
    }

    /// Returns the index of a transition in the whole graph.
    #[must_use]
    pub fn jump_of(&self, leave: Place, enter: Place) -> Option<usize> {
        self.whole.jumps().iter().position(|jump| jump.leave == leave && jump.enter == enter)
    }
}
