//! The drawn parts of a graph, which are made between frames: a graph may have hundreds of
//! thousands of transitions.

use crate::ui::kit::{self, Fate, MatrixMark, Stretch};
use segue_motion::graph::Place;
use segue_session::{BuiltGraph, Session, Walk};
use std::sync::Arc;

/// The number of transitions that are handled at once, about a millisecond.
const JUMPS_AT_ONCE: usize = 20_000;

/// The drawn parts of a graph, by the indices of the whole graph's transitions.
#[derive(Clone, Debug)]
pub(crate) struct GraphDrawing {
    of: DrawnGraph,
    /// The ends of each transition.
    pub(super) ends: Vec<[Place; 2]>,
    /// The mark of each transition on the map of distances.
    pub(super) marks: Vec<MatrixMark>,
    /// The arc of each transition in the strip below the stage.
    pub(super) arcs: Vec<kit::Arc>,
    /// The indices of the arcs that are drawn.
    pub(super) drawn_arcs: Vec<usize>,
    /// The stretches between transitions.
    pub(super) stretches: Vec<Stretch>,
}

/// The graph and the probabilities of a drawing. Equal if they are the same objects.
#[derive(Clone, Debug)]
struct DrawnGraph {
    built: Arc<BuiltGraph>,
    /// The probability of each transition in the walk that is shown; `None` without a walk.
    probabilities: Option<Arc<Vec<Option<f64>>>>,
}

impl PartialEq for DrawnGraph {
    fn eq(&self, other: &Self) -> bool {
        let same_probabilities = match (&self.probabilities, &other.probabilities) {
            (Some(one), Some(other)) => Arc::ptr_eq(one, other),
            (one, other) => one.is_none() && other.is_none(),
        };
        Arc::ptr_eq(&self.built, &other.built) && same_probabilities
    }
}

/// The drawing of the graph that is shown, kept until the graph or its probabilities change.
#[derive(Clone, Debug, Default)]
pub(crate) struct DrawingCache {
    made: Option<Arc<GraphDrawing>>,
    builder: Option<DrawingBuilder>,
    /// The number of drawings made so far.
    drawings_made: u64,
}

impl DrawingCache {
    /// Returns the drawing of the graph that is shown, and begins a new one when the graph or its
    /// probabilities have changed. Until that is made, returns the one before if it has the same
    /// clips, else `None`.
    pub(super) fn of(&mut self, session: &Session) -> Option<Arc<GraphDrawing>> {
        let built = session.graph_built()?;
        let walk = session.graph_walk().filter(|walk| Arc::ptr_eq(&walk.built, built));
        let of = DrawnGraph {
            built: Arc::clone(built),
            probabilities: walk.map(|walk| Arc::clone(&walk.probabilities)),
        };
        if self.made.as_ref().is_some_and(|made| made.of == of) {
            self.builder = None;
        } else if self.builder.as_ref().is_none_or(|builder| builder.drawing.of != of) {
            self.builder = Some(DrawingBuilder::new(of));
        }
        let has_same_clips =
            |made: &&Arc<GraphDrawing>| Arc::ptr_eq(made.of.built.clips(), built.clips());
        self.made.as_ref().filter(has_same_clips).map(Arc::clone)
    }

    /// Returns whether a drawing is still to be made.
    pub(crate) fn is_incomplete(&self) -> bool {
        self.builder.is_some()
    }

    /// Makes a part of the drawing; returns whether any is left.
    pub(crate) fn work(&mut self) -> bool {
        let Some(mut builder) = self.builder.take() else { return false };
        if builder.advance() {
            self.made = Some(Arc::new(builder.drawing));
            self.drawings_made += 1;
        } else {
            self.builder = Some(builder);
        }
        self.is_incomplete()
    }

    /// Returns the number of drawings made so far: when it changes, the graph has to be drawn
    /// again.
    pub(crate) fn drawings_made(&self) -> u64 {
        self.drawings_made
    }
}

/// The construction of a [`GraphDrawing`] in slices.
#[derive(Clone, Debug)]
struct DrawingBuilder {
    drawing: GraphDrawing,
    /// The probability of each transition; `None` where walks cannot take it. Without a walk, it is
    /// yet to be made.
    probabilities: Option<Arc<Vec<Option<f64>>>>,
    has_stretches: bool,
}

impl DrawingBuilder {
    fn new(of: DrawnGraph) -> Self {
        let count = of.built.whole().jumps().len();
        let probabilities = of.probabilities.clone();
        let drawing = GraphDrawing {
            of,
            ends: Vec::with_capacity(count),
            marks: Vec::with_capacity(count),
            arcs: Vec::with_capacity(count),
            drawn_arcs: Vec::new(),
            stretches: Vec::new(),
        };
        Self { drawing, probabilities, has_stretches: false }
    }

    /// Makes a part; returns whether the drawing is complete.
    fn advance(&mut self) -> bool {
        let drawing = &mut self.drawing;
        let Some(probabilities) = &self.probabilities else {
            self.probabilities = Some(Arc::new(drawing.of.built.reachable()));
            return false;
        };
        let whole = drawing.of.built.whole();
        let (done, jumps) = (drawing.ends.len(), whole.jumps());
        if let Some(rest) = jumps.get(done..).filter(|rest| !rest.is_empty()) {
            let set = drawing.of.built.clips().set();
            for (index, jump) in rest.iter().enumerate().take(JUMPS_AT_ONCE) {
                let probability = probabilities.get(done + index).copied().flatten();
                let ends = [jump.leave, jump.enter];
                let numbers = ends.map(|place| set.number(place).unwrap_or(0));
                let faint = probability.is_none();
                drawing.ends.push(ends);
                drawing.marks.push(MatrixMark { at: numbers.map(|number| number as f32), faint });
                let weight = probability.unwrap_or(0.0) as f32;
                drawing.arcs.push(kit::Arc { ends: numbers, weight, faint });
            }
            return false;
        }
        if !self.has_stretches {
            drawing.stretches = stretches(&drawing.of.built);
            self.has_stretches = true;
            return false;
        }
        drawing.drawn_arcs = kit::drawn_arcs(&drawing.arcs);
        true
    }
}

/// Returns the stretches of a graph.
fn stretches(built: &BuiltGraph) -> Vec<Stretch> {
    let (whole, set) = (built.whole(), built.clips().set());
    let mut is_dead = vec![false; whole.graph().node_count()];
    for node in whole.dead_ends() {
        is_dead[node.index()] = true;
    }
    let stretch = |node: usize, of: &segue_motion::graph::Stretch| {
        let from = set.number(Place { clip: of.clip, frame: of.start })?;
        let fate = match built.component_of(node) {
            Some(0) => Fate::Main,
            Some(component) => Fate::Apart(component - 1),
            None if is_dead[node] => Fate::End,
            None => Fate::Astray,
        };
        Some(Stretch { from, to: from + of.end - of.start, fate })
    };
    let nodes = whole.graph().node_weights().enumerate();
    nodes.filter_map(|(node, of)| stretch(node, of)).collect()
}

impl GraphDrawing {
    /// Returns the ends of a transition that a graph has: the drawing may be that of the graph
    /// before.
    pub(super) fn ends_in(&self, built: &BuiltGraph, jump: usize) -> Option<[Place; 2]> {
        let [leave, enter] = *self.ends.get(jump)?;
        built.jump_of(leave, enter).map(|_| [leave, enter])
    }

    /// Returns the transition under the pointer, else the one that plays.
    pub(super) fn pointed_or_lit(
        &self,
        pointed: Option<[Place; 2]>,
        walk: Option<&Walk>,
        secs: f64,
    ) -> Option<usize> {
        let pointed = pointed.and_then(|ends| self.ends.iter().position(|known| *known == ends));
        pointed.or_else(|| self.lit(walk, secs))
    }

    /// Returns the transition that plays now, or the one that is shown alone.
    fn lit(&self, walk: Option<&Walk>, secs: f64) -> Option<usize> {
        let walk = walk.filter(|walk| Arc::ptr_eq(&walk.built, &self.of.built))?;
        let at = walk.at(secs)?;
        let stay = if walk.is_jump { 1 } else { at.stay };
        let seam = walk.passed.get(stay)?.seam?;
        if !walk.is_jump && at.left.is_none() {
            return None;
        }
        self.ends.iter().position(|ends| *ends == [seam.leave, seam.enter])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use segue_session::{Command, Key, Value};

    fn apply(command: Command, session: &mut Session) {
        session.apply(command).unwrap();
        while session.work() {}
    }

    #[test]
    fn last_drawing_of_the_same_clips_is_shown_until_the_next_one_is_made() {
        let mut session = Session::new();
        apply(Command::OpenLink("lab=graph&clips=walk,walk_left".into()), &mut session);
        let mut cache = DrawingCache::default();
        assert!(cache.of(&session).is_none() && cache.is_incomplete());
        while cache.work() {}
        let first = cache.of(&session).unwrap();
        let jumps = session.graph_built().unwrap().whole().jumps();
        let ends: Vec<[Place; 2]> = jumps.iter().map(|jump| [jump.leave, jump.enter]).collect();
        assert!(!ends.is_empty() && first.ends == ends && !cache.is_incomplete());
        assert_eq!(
            (first.marks.len(), first.arcs.len(), cache.drawings_made()),
            (ends.len(), ends.len(), 1)
        );

        let threshold = (Key::EdgeThreshold, Value::Number(1.0));
        apply(Command::Set(vec![threshold]), &mut session);
        assert!(cache.of(&session).is_some_and(|shown| Arc::ptr_eq(&shown, &first)));
        assert!(cache.is_incomplete());
        while cache.work() {}
        let second = cache.of(&session).unwrap();
        assert!(second.ends.len() < ends.len() && !cache.is_incomplete());

        apply(Command::OpenLink("lab=graph&clips=walk,walk_right".into()), &mut session);
        assert!(cache.of(&session).is_none() && cache.is_incomplete());
    }
}
