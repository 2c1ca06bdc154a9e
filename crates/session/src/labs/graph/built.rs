use super::Cast;
use super::wanted::GraphKey;
use petgraph::graph::NodeIndex;
use petgraph::visit::Dfs;
use segue_motion::graph::{
    Candidates, CountedTo, DistanceOverview, FrameDistances, GraphError, GraphOptions, MotionGraph,
    Place,
};
use std::ops::ControlFlow;
use std::sync::Arc;

/// The distances of all windows of one length.
#[derive(Debug)]
pub struct Field {
    distances: Distances,
    /// Of held distances.
    histogram: Vec<u32>,
}

/// All distances of a set, as far as they are held.
#[derive(Debug)]
pub enum Distances {
    /// Each of them.
    Held(FrameDistances),
    /// The smallest of every square of windows.
    FromAfar(Box<DistanceOverview>),
}

impl Field {
    /// To be counted.
    pub(super) fn held(distances: FrameDistances) -> Self {
        Self { distances: Distances::Held(distances), histogram: vec![0; DistanceOverview::BINS] }
    }

    pub(super) fn from_afar(overview: DistanceOverview) -> Self {
        Self { distances: Distances::FromAfar(Box::new(overview)), histogram: Vec::new() }
    }

    /// Counts about so many cells more; `true` behind the last one.
    pub(super) fn count(&mut self, at: &mut CountedTo, cells: usize) -> bool {
        match &self.distances {
            Distances::Held(distances) => {
                distances.count(at, cells, DistanceOverview::BIN_CM, &mut self.histogram)
            }
            Distances::FromAfar(_) => true,
        }
    }

    /// The distances.
    #[must_use]
    pub fn distances(&self) -> &Distances {
        &self.distances
    }

    /// Where all of them are held.
    pub(super) fn all(&self) -> Option<&FrameDistances> {
        match &self.distances {
            Distances::Held(distances) => Some(distances),
            Distances::FromAfar(_) => None,
        }
    }

    /// Frames of each window.
    #[must_use]
    pub fn window(&self) -> usize {
        match &self.distances {
            Distances::Held(distances) => distances.window(),
            Distances::FromAfar(overview) => overview.window(),
        }
    }

    /// The distance of the windows that start at two frames, centimetres; `None` where a window
    /// crosses the end of its clip.
    #[must_use]
    pub fn cm(&self, a: Place, b: Place) -> Option<f64> {
        match &self.distances {
            Distances::Held(distances) => distances.cm(a, b),
            Distances::FromAfar(overview) => overview.cm(a, b),
        }
    }

    /// How many pairs of windows lie in each half centimetre; the last takes what is farther.
    #[must_use]
    pub fn histogram(&self) -> &[u32] {
        match &self.distances {
            Distances::Held(_) => &self.histogram,
            Distances::FromAfar(overview) => overview.histogram(),
        }
    }

    /// How wide each of its bins is, centimetres.
    #[must_use]
    pub fn bin_cm(&self) -> f64 {
        DistanceOverview::BIN_CM
    }

    /// Numbers that are held.
    pub(super) fn cells(&self) -> usize {
        match &self.distances {
            Distances::Held(_) => self.histogram.iter().map(|&count| count as usize).sum(),
            Distances::FromAfar(overview) => overview.cells(),
        }
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
    lacks_some: bool,
    /// Per clip, whether anything of it is walked in.
    is_walked: Vec<bool>,
}

/// A [`Built`] on its way: of very many transitions each slice takes milliseconds.
#[derive(Debug)]
pub(super) enum Building {
    /// Where one may go over.
    Found(Arc<Candidates>),
    /// Stretches and transitions, and whether there are more than are held.
    Linked(MotionGraph, bool),
    /// Which of them hang together.
    Parted(Arc<MotionGraph>, bool, Vec<Vec<NodeIndex>>),
}

impl Building {
    /// The next slice: what is left, or the graph.
    pub(super) fn advance(
        self,
        cast: &Arc<Cast>,
        key: GraphKey,
    ) -> Result<ControlFlow<Built, Self>, GraphError> {
        Ok(match self {
            Self::Found(candidates) => {
                let lacks_some = !candidates.are_all_within(key.options.edge_threshold_cm);
                let whole = MotionGraph::new(cast.set(), &candidates, &key.options)?;
                ControlFlow::Continue(Self::Linked(whole, lacks_some))
            }
            Self::Linked(whole, lacks_some) => {
                let components = whole.components();
                ControlFlow::Continue(Self::Parted(Arc::new(whole), lacks_some, components))
            }
            Self::Parted(whole, lacks_some, components) => {
                let built = Built::new(cast, whole, &components, key)?;
                ControlFlow::Break(Built { lacks_some, ..built })
            }
        })
    }
}

impl Built {
    fn new(
        cast: &Arc<Cast>,
        whole: Arc<MotionGraph>,
        components: &[Vec<NodeIndex>],
        key: GraphKey,
    ) -> Result<Self, GraphError> {
        let graph =
            if key.pruned { Arc::new(whole.pruned_to(components)?) } else { Arc::clone(&whole) };
        let mut component = vec![0; whole.graph().node_count()];
        let (mut rings, mut ring_components) = (Vec::new(), Vec::new());
        let all = cast.set().frames().max(1) as f64;
        for (index, nodes) in components.iter().enumerate() {
            for node in nodes {
                if let Some(slot) = component.get_mut(node.index()) {
                    *slot = index;
                }
            }
            let inside = |node: &NodeIndex| {
                let mut next = whole.graph().neighbors(*node);
                next.any(|next| nodes.binary_search(&next).is_ok())
            };
            if nodes.iter().any(inside) {
                ring_components.push(index);
                let stretches = nodes.iter().filter_map(|&node| whole.graph().node_weight(node));
                rings.push(
                    stretches.map(|stretch| stretch.end - stretch.start).sum::<usize>() as f64
                        / all,
                );
            }
        }
        let mut is_walked = vec![false; cast.set().clips().len()];
        for stretch in graph.graph().node_weights() {
            is_walked[stretch.clip] = true;
        }
        Ok(Self {
            lacks_some: false,
            is_walked,
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

    /// Whether there are more transitions below the threshold than can be held: the closest are.
    #[must_use]
    pub fn lacks_some(&self) -> bool {
        self.lacks_some
    }

    /// Whether anything of a clip is walked in: from everywhere, where the graph is pruned.
    #[must_use]
    pub fn is_walked(&self, clip: usize) -> bool {
        self.is_walked.get(clip).copied().unwrap_or(false)
    }

    /// The clips that ways lead to from a place, that one's included; of a graph that is pruned,
    /// all that are walked in.
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

    /// The index of a transition in the whole graph.
    #[must_use]
    pub fn jump_of(&self, leave: Place, enter: Place) -> Option<usize> {
        self.whole.jumps().iter().position(|jump| jump.leave == leave && jump.enter == enter)
    }
}
