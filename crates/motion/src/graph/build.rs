//! The motion graph, and its construction.

use super::components::components;
use super::error::above;
use super::{Candidate, Candidates, FrameSet, GraphError, Place};
use crate::math::Planar;
use crate::math::sort::sort_by_key;
use petgraph::Direction;
use petgraph::graph::{DiGraph, EdgeIndex, NodeIndex};
use petgraph::visit::EdgeRef;
use std::cmp::Reverse;
use std::sync::Arc;

/// The construction of a graph.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Construction {
    /// Each clip is cut into segments of equal length; transitions lead from the end of a segment
    /// to the start of another.
    Segments {
        /// Frames of a segment. The rest at a clip's end belongs to its last segment.
        segment_size: usize,
    },
    /// Transitions are local minima of the distance, and the clips are cut there (Kovar, Gleicher,
    /// Pighin 2002, section 3.2).
    Minima,
}

/// Options of a graph.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct GraphOptions {
    /// The construction.
    pub construction: Construction,
    /// Frames of a transition, and of the windows that are compared; at least 1.
    pub blend_window: usize,
    /// The greatest distance of two windows for a transition, centimetres on the reference body.
    pub edge_threshold_cm: f64,
    /// The least time between the two frames of a transition within one clip, seconds.
    pub min_jump_secs: f64,
    /// The greatest number of transitions out of a stretch; the closest are kept, and
    /// [`MotionGraph::left_out`] counts the others.
    pub most_ways_out: usize,
}

impl Default for GraphOptions {
    fn default() -> Self {
        Self {
            construction: Construction::Minima,
            blend_window: 30,
            edge_threshold_cm: 8.0,
            min_jump_secs: 0.5,
            most_ways_out: 64,
        }
    }
}

impl GraphOptions {
    /// The greatest sensible threshold, centimetres: windows that are farther apart are not alike,
    /// and no error suggests to raise the threshold beyond it.
    pub const MAX_THRESHOLD_CM: f64 = 60.0;

    /// Returns the least number of frames of a jump, at least 2: the next frame is not a jump.
    pub(super) fn min_jump(&self, set: &FrameSet) -> usize {
        ((self.min_jump_secs * set.fps()).round() as usize).max(2)
    }

    /// Returns the error with the reason why no transition is possible.
    fn no_transition_error(&self, set: &FrameSet) -> GraphError {
        let window = self.blend_window;
        let least = match self.construction {
            Construction::Segments { segment_size } => segment_size,
            Construction::Minima => window + 1,
        };
        let long_enough = (0..set.clips().len()).filter(|&clip| set.frames_of(clip) >= least);
        // From the last window of a clip to its beginning.
        let farthest = set.longest().saturating_sub(window);
        if long_enough.count() > 1 || self.min_jump(set) <= farthest {
            return GraphError::NoMinimum { window };
        }
        GraphError::JumpsTooShort {
            window,
            lower_window: set
                .longest()
                .checked_sub(self.min_jump(set))
                .filter(|&window| window > 0),
            min_jump_secs: self.min_jump_secs,
            farthest_secs: farthest as f64 / set.fps(),
        }
    }

    /// Checks the options against the clips, as far as possible without distances.
    ///
    /// # Errors
    /// [`GraphError`] names the option that does not fit, and what to change.
    pub fn check(&self, set: &FrameSet) -> Result<(), GraphError> {
        let setting = |what, value: f64, least: f64, most: f64| {
            if (least..=most).contains(&value) {
                Ok(())
            } else {
                Err(GraphError::Setting { what, value, least, most })
            }
        };
        setting("a blend window", self.blend_window as f64, 1.0, f64::from(u32::MAX))?;
        setting("an edge threshold", self.edge_threshold_cm, 0.0, 1e6)?;
        setting("a shortest jump", self.min_jump_secs, 0.0, 1e6)?;
        setting("a number of ways out", self.most_ways_out as f64, 1.0, f64::from(u32::MAX))?;
        let (window, longest) = (self.blend_window, set.longest());
        if longest < window + 2 {
            return Err(GraphError::WindowTooLong { window, longest });
        }
        if let Construction::Segments { segment_size } = self.construction {
            setting("a segment size", segment_size as f64, 1.0, f64::from(u32::MAX))?;
            if segment_size > longest {
                return Err(GraphError::SegmentTooLong { segment: segment_size, longest });
            }
            if window >= segment_size {
                return Err(GraphError::SegmentTooShort { segment: segment_size, window });
            }
        }
        Ok(())
    }

    /// Returns the segments of a clip; empty where it is shorter than one, or for another
    /// construction.
    pub(super) fn stretches(&self, set: &FrameSet, clip: usize) -> Vec<Stretch> {
        let Construction::Segments { segment_size } = self.construction else {
            return Vec::new();
        };
        let (size, frames) = (segment_size.max(1), set.frames_of(clip));
        let count = frames / size;
        let end = |index: usize| {
            if index + 1 == count { frames } else { (index + 1) * size }
        };
        (0..count).map(|index| Stretch { clip, start: index * size, end: end(index) }).collect()
    }

    /// Returns whether a segment is entered at this frame.
    pub(super) fn is_entered_at(&self, set: &FrameSet, place: Place) -> bool {
        let Construction::Segments { segment_size } = self.construction else {
            return false;
        };
        let size = segment_size.max(1);
        place.frame.is_multiple_of(size) && place.frame / size < set.frames_of(place.clip) / size
    }

    /// Returns whether a segment is left at this frame.
    pub(super) fn is_left_at(&self, set: &FrameSet, place: Place) -> bool {
        let (end, frames) = (place.frame + self.blend_window, set.frames_of(place.clip));
        let Construction::Segments { segment_size } = self.construction else {
            return false;
        };
        let (size, count) = (segment_size.max(1), frames / segment_size.max(1));
        count > 0
            && (end == frames || (end.is_multiple_of(size) && end >= size && end / size < count))
    }

    /// Returns whether a segment is entered or left at this frame.
    pub(super) fn is_end(&self, set: &FrameSet, place: Place) -> bool {
        self.is_entered_at(set, place) || self.is_left_at(set, place)
    }
}

/// Consecutive frames of one clip: a node of the graph.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, serde::Serialize)]
pub struct Stretch {
    /// The clip's index in its [`FrameSet`].
    pub clip: usize,
    /// Its first frame.
    pub start: usize,
    /// One past its last frame.
    pub end: usize,
}

/// A way from one stretch to the next: an edge of the graph.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Way {
    /// The clip continues.
    Continue,
    /// A transition: its index in [`MotionGraph::jumps`].
    Jump(usize),
}

/// A transition.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jump {
    /// The clip and the frame at which it is left.
    pub leave: Place,
    /// The clip and the frame at which it is entered.
    pub enter: Place,
    /// Frames that overlap: `leave..leave + window` and `enter..enter + window`.
    pub window: usize,
    /// The distance of the two windows, centimetres on the reference body.
    pub distance_cm: f64,
    /// The best alignment of the entered clip with the one that is left:
    /// `left_world_from_entered_world`.
    pub alignment: Planar,
}

/// Stretches of clips, and the ways between them.
#[derive(Clone, Debug)]
pub struct MotionGraph {
    pub(super) set: Arc<FrameSet>,
    pub(super) options: GraphOptions,
    pub(super) graph: DiGraph<Stretch, Way>,
    pub(super) jumps: Vec<Jump>,
    /// The index of each transition in the graph that this one is a part of; its own in a whole
    /// one.
    origins: Vec<usize>,
    left_out: usize,
}

impl MotionGraph {
    /// Builds the graph of these candidates. `options` are those by which they were found; the
    /// threshold may be lower.
    ///
    /// Segments: one node each, in the order of clips and frames. A segment is left `blend_window`
    /// frames before its end and entered at its start; where that is more than half of a segment,
    /// transitions overlap. Minima: each clip is cut where it is left and where a transition into
    /// it is over, `blend_window` frames after the frame where it was entered, so that transitions
    /// do not overlap.
    ///
    /// # Errors
    /// [`GraphError`] when the options do not fit the clips, or there is no transition; it says
    /// what to change.
    pub fn new(
        set: &Arc<FrameSet>,
        candidates: &Candidates,
        options: &GraphOptions,
    ) -> Result<Self, GraphError> {
        options.check(set)?;
        let is_near = |of: &Candidate| of.distance_cm <= options.edge_threshold_cm;
        let near = candidates.found.partition_point(is_near);
        let chosen = candidates.found.get(..near).unwrap_or_default();
        if chosen.is_empty() {
            return Err(match candidates.nearest_cm {
                Some(nearest_cm) if above(nearest_cm) > GraphOptions::MAX_THRESHOLD_CM => {
                    GraphError::TooFar { window: options.blend_window, nearest_cm }
                }
                Some(nearest_cm) => {
                    GraphError::NoTransition { threshold_cm: options.edge_threshold_cm, nearest_cm }
                }
                None => options.no_transition_error(set),
            });
        }
        let mut made = Self {
            set: Arc::clone(set),
            options: *options,
            // One edge for each jump, and one for each cut, where the clip continues; a jump cuts
            // at two places at most.
            graph: DiGraph::with_capacity(0, near + set.cuts().min(2 * near)),
            jumps: Vec::with_capacity(near),
            origins: Vec::new(),
            left_out: 0,
        };
        made.add_stretches(chosen);
        let (starting, ending) =
            (made.nodes_at(|stretch| stretch.start), made.nodes_at(|stretch| stretch.end));
        let node_at =
            |nodes: &[Option<NodeIndex>], place| nodes.get(set.cut(place)?).copied().flatten();
        let mut ways_out = vec![0; made.graph.node_count()];
        for &Candidate { leave, enter, distance_cm, alignment } in chosen {
            let arrives = Place { frame: enter.frame + made.arrival(), ..enter };
            let leaves = Place { frame: leave.frame + made.departure(), ..leave };
            if let (Some(from), Some(to)) = (node_at(&ending, leaves), node_at(&starting, arrives))
            {
                if ways_out[from.index()] >= options.most_ways_out {
                    made.left_out += 1;
                    continue;
                }
                ways_out[from.index()] += 1;
                made.graph.add_edge(from, to, Way::Jump(made.jumps.len()));
                let window = options.blend_window;
                made.jumps.push(Jump { leave, enter, window, distance_cm, alignment });
            }
        }
        made.origins = (0..made.jumps.len()).collect();
        Ok(made)
    }

    /// Returns the number of frames from the entry of a stretch to the start of its node.
    fn arrival(&self) -> usize {
        match self.options.construction {
            Construction::Segments { .. } => 0,
            Construction::Minima => self.options.blend_window,
        }
    }

    /// Returns the number of frames from where a stretch is left to the end of its node.
    fn departure(&self) -> usize {
        self.options.blend_window - self.arrival()
    }

    fn add_stretches(&mut self, chosen: &[Candidate]) {
        let mut is_cut = vec![false; self.set.cuts()];
        for candidate in chosen {
            let arrival = Place {
                frame: candidate.enter.frame + self.options.blend_window,
                ..candidate.enter
            };
            for cut in
                [candidate.leave, arrival].into_iter().filter_map(|place| self.set.cut(place))
            {
                is_cut[cut] = true;
            }
        }
        for clip in 0..self.set.clips().len() {
            let stretches = match self.options.construction {
                Construction::Segments { .. } => self.options.stretches(&self.set, clip),
                Construction::Minima => {
                    let frames = self.set.frames_of(clip);
                    let is_cut =
                        |frame| self.set.cut(Place { clip, frame }).is_some_and(|cut| is_cut[cut]);
                    let inside = (1..frames).filter(|&frame| is_cut(frame));
                    let cuts: Vec<usize> =
                        std::iter::once(0).chain(inside).chain([frames]).collect();
                    let stretch = |pair: &[usize]| Stretch { clip, start: pair[0], end: pair[1] };
                    cuts.windows(2).map(stretch).collect()
                }
            };
            let mut before = None;
            for stretch in stretches {
                let here = self.graph.add_node(stretch);
                if let Some(before) = before {
                    self.graph.add_edge(before, here, Way::Continue);
                }
                before = Some(here);
            }
        }
    }

    /// Returns the nodes by one of their ends, one per cut of the set.
    fn nodes_at(&self, end: fn(&Stretch) -> usize) -> Vec<Option<NodeIndex>> {
        let mut nodes = vec![None; self.set.cuts()];
        for (node, stretch) in self.graph.node_indices().zip(self.graph.node_weights()) {
            let place = Place { clip: stretch.clip, frame: end(stretch) };
            if let Some(slot) = self.set.cut(place).and_then(|cut| nodes.get_mut(cut)) {
                *slot = Some(node);
            }
        }
        nodes
    }

    /// Returns the clips.
    #[must_use]
    pub fn set(&self) -> &Arc<FrameSet> {
        &self.set
    }

    /// Returns the options.
    #[must_use]
    pub fn options(&self) -> &GraphOptions {
        &self.options
    }

    /// Returns nodes and edges.
    #[must_use]
    pub fn graph(&self) -> &DiGraph<Stretch, Way> {
        &self.graph
    }

    /// Returns the transitions, closest first.
    #[must_use]
    pub fn jumps(&self) -> &[Jump] {
        &self.jumps
    }

    /// Returns the number of transitions below the threshold that were left out, because the
    /// greatest number of closer ones leave the same stretch.
    #[must_use]
    pub fn left_out(&self) -> usize {
        self.left_out
    }

    /// Returns the transition of an edge; `None` where the clip continues, and for an unknown edge.
    #[must_use]
    pub fn jump(&self, edge: EdgeIndex) -> Option<&Jump> {
        match self.graph.edge_weight(edge)? {
            Way::Jump(index) => self.jumps.get(*index),
            Way::Continue => None,
        }
    }

    /// Returns the index of an edge's transition among those of the graph that this one was
    /// [pruned](Self::pruned_to) from, or of this one where it is whole; `None` where the clip
    /// continues, and for an unknown edge.
    #[must_use]
    pub fn origin(&self, edge: EdgeIndex) -> Option<usize> {
        match self.graph.edge_weight(edge)? {
            Way::Jump(index) => self.origins.get(*index).copied(),
            Way::Continue => None,
        }
    }

    /// Returns the number of frames between the starts of the two nodes of an edge.
    #[must_use]
    pub fn frames_of(&self, edge: EdgeIndex) -> usize {
        let node =
            self.graph.edge_endpoints(edge).and_then(|(from, _)| self.graph.node_weight(from));
        let Some(node) = node else { return 0 };
        match self.jump(edge) {
            None => node.end - node.start,
            Some(jump) => (jump.leave.frame + self.arrival()).saturating_sub(node.start),
        }
    }

    /// Returns the nodes without a way out: the clips' ends.
    #[must_use]
    pub fn dead_ends(&self) -> Vec<NodeIndex> {
        self.graph.externals(Direction::Outgoing).collect()
    }

    /// Returns the strongly connected components, largest first (by frames, then by the first
    /// node): inside one, every node can be reached from every other.
    #[must_use]
    pub fn components(&self) -> Vec<Vec<NodeIndex>> {
        let frames = |nodes: &[usize]| -> usize {
            let stretches =
                nodes.iter().filter_map(|&node| self.graph.node_weight(NodeIndex::new(node)));
            stretches.map(|stretch| stretch.end - stretch.start).sum()
        };
        let edges = self.graph.raw_edges().iter();
        let edges = edges.map(|edge| (edge.source().index(), edge.target().index()));
        let found = components(self.graph.node_count(), edges).into_iter();
        let mut found: Vec<_> =
            found.map(|nodes| ((Reverse(frames(&nodes)), nodes.first().copied()), nodes)).collect();
        sort_by_key(&mut found, |(key, _)| *key);
        let nodes = |nodes: Vec<usize>| nodes.into_iter().map(NodeIndex::new).collect();
        found.into_iter().map(|(_, component)| nodes(component)).collect()
    }

    /// Returns the graph of the largest component alone: no walk in it comes to an end.
    ///
    /// # Errors
    /// [`GraphError::NoCycle`] when no component has an edge inside it.
    pub fn pruned(&self) -> Result<Self, GraphError> {
        self.pruned_to(&self.components())
    }

    /// Returns the graph of the largest of known components, as [`Self::pruned`] does.
    ///
    /// # Errors
    /// [`GraphError::NoCycle`] when no component has an edge inside it.
    pub fn pruned_to(&self, components: &[Vec<NodeIndex>]) -> Result<Self, GraphError> {
        let inside = |nodes: &[NodeIndex]| {
            let within = |edge: petgraph::graph::EdgeReference<'_, Way>| {
                nodes.binary_search(&edge.target()).is_ok()
            };
            nodes.iter().any(|&node| self.graph.edges(node).any(within))
        };
        let Some(kept) = components.iter().find(|nodes| inside(nodes)) else {
            return Err(GraphError::NoCycle {
                transitions: self.jumps.len(),
                threshold_cm: self.options.edge_threshold_cm,
            });
        };
        let mut pruned = Self {
            set: Arc::clone(&self.set),
            options: self.options,
            // Vectors that grow would copy hundreds of thousands of edges several times.
            graph: DiGraph::with_capacity(kept.len(), self.graph.edge_count()),
            jumps: Vec::with_capacity(self.jumps.len()),
            origins: Vec::with_capacity(self.jumps.len()),
            left_out: self.left_out,
        };
        let mut new = vec![None; self.graph.node_count()];
        for &node in kept {
            if let (Some(stretch), Some(slot)) =
                (self.graph.node_weight(node), new.get_mut(node.index()))
            {
                *slot = Some(pruned.graph.add_node(*stretch));
            }
        }
        for edge in self.graph.edge_references() {
            let (Some(from), Some(to)) = (new[edge.source().index()], new[edge.target().index()])
            else {
                continue;
            };
            let way = match (edge.weight(), self.jump(edge.id())) {
                (Way::Jump(index), Some(jump)) => {
                    pruned.jumps.push(*jump);
                    pruned.origins.push(self.origins[*index]);
                    Way::Jump(pruned.jumps.len() - 1)
                }
                _ => Way::Continue,
            };
            pruned.graph.add_edge(from, to, way);
        }
        Ok(pruned)
    }

    /// Returns the node of a frame; `None` where the graph has none.
    #[must_use]
    pub fn node_at(&self, place: Place) -> Option<NodeIndex> {
        let holds = |stretch: &Stretch| {
            stretch.clip == place.clip && (stretch.start..stretch.end).contains(&place.frame)
        };
        self.graph.node_indices().find(|&node| self.graph.node_weight(node).is_some_and(holds))
    }
}
