//! The plan of a walk: its stays, without frames.

use super::requests::WalkRequest;
use petgraph::graph::EdgeIndex;
use petgraph::visit::EdgeRef;
use segue_motion::graph::{Choices, GraphError, MotionGraph, Place, Stay, Walker};
use std::sync::Arc;

/// The tolerance within which two transitions count as the same, seconds at each end.
const GUIDE_SECS: f64 = 0.3;
/// The number of stays of the other walk that are searched for it.
const GUIDE_STAYS: usize = 12;

/// The stays of a walk as far as they were requested, found without making frames. A walk that
/// follows another one requests as much of that one's plan as it needs, so that it does not depend
/// on how much of the other has been shown.
#[derive(Clone, Debug)]
pub(super) struct Plan {
    graph: Arc<MotionGraph>,
    walker: Walker,
    stays: Vec<Stay>,
    /// The number of frames of these stays.
    frames: usize,
    /// The times at which to leave for a clip, and the number of these visits that were begun.
    visits: Vec<(f64, usize)>,
    visited: usize,
    /// Visits of clips that cannot be reached.
    missed: Vec<(f64, usize)>,
    /// The stay that plays now in the walk that this one follows.
    guided: usize,
}

impl Plan {
    pub(super) fn new(
        graph: &Arc<MotionGraph>,
        choices: &Arc<Choices>,
        wanted: &WalkRequest,
    ) -> Result<Self, GraphError> {
        let walker = Walker::new(Arc::clone(graph), Arc::clone(choices), wanted.seed);
        Ok(Self {
            graph: Arc::clone(graph),
            walker: walker.with_visited_discount(wanted.discount)?,
            stays: Vec::new(),
            frames: 0,
            visits: wanted.visits.clone(),
            visited: 0,
            missed: Vec::new(),
            guided: 0,
        })
    }

    /// Takes these edges first.
    pub(super) fn take(&mut self, edges: Vec<EdgeIndex>) {
        self.walker.take(edges);
    }

    /// Returns a stay by its number; `None` after the last one, where the walk ends. `guide` is the
    /// walk that this one follows, if any; it is the same in every call.
    pub(super) fn stay(&mut self, number: usize, mut guide: Option<&mut Self>) -> Option<Stay> {
        while self.stays.len() <= number {
            if let Some(guide) = guide.as_deref_mut() {
                self.follow_guide(guide);
            }
            let stay = self.next()?;
            self.frames += stay.to - stay.from;
            self.stays.push(stay);
        }
        self.stays.get(number).copied()
    }

    /// Returns the visits that failed so far: time and clip.
    pub(super) fn missed(&self) -> &[(f64, usize)] {
        &self.missed
    }

    /// Returns the next stay, which ends early if a visit is due.
    fn next(&mut self) -> Option<Stay> {
        let fps = self.graph.set().fps();
        let mut next = self.walker.clone();
        let mut stay = next.next_stay()?;
        while let Some(&(secs, clip)) = self.visits.get(self.visited) {
            let due = (secs * fps).round() as usize;
            if self.frames + (stay.to - stay.from) <= due {
                break;
            }
            self.visited += 1;
            // Frames that have played stay as they are.
            self.walker.go_on_to(stay.from + due.saturating_sub(self.frames));
            if self.walker.go_to_clip(clip) {
                next = self.walker.clone();
                stay = next.next_stay()?;
            } else {
                self.missed.push((secs, clip));
            }
        }
        self.walker = next;
        Some(stay)
    }

    /// Returns the transition into a stay.
    fn seam(&mut self, number: usize) -> Option<[Place; 2]> {
        let stay = self.stay(number, None)?;
        let jump = self.graph.jumps().get(stay.jump?)?;
        Some([jump.leave, jump.enter])
    }

    /// Takes the edge that is most like the next transition of another walk; a random one if there
    /// is none, and follows it again once both are in the same clip.
    fn follow_guide(&mut self, guide: &mut Self) {
        // A visit determines the way.
        if self.walker.has_way() {
            return;
        }
        let graph = Arc::clone(&self.graph);
        let Some(here) = graph.graph().node_weight(self.walker.node()).copied() else {
            return;
        };
        let window = guide.graph.options().blend_window;
        let middle = |place: Place, window: usize| place.frame + window / 2;
        let mut ahead = (self.guided + 1..=self.guided + GUIDE_STAYS)
            .filter_map(|number| Some((number, guide.seam(number)?)));
        let next = ahead
            .find(|(_, [leave, _])| leave.clip == here.clip && middle(*leave, window) > here.start);
        let Some((number, [leave, enter])) = next else {
            return;
        };
        let near = (GUIDE_SECS * graph.set().fps()).round() as usize;
        let mut on = Vec::new();
        let mut best: Option<(usize, Vec<EdgeIndex>)> = None;
        let mut node = self.walker.node();
        loop {
            let mut onward = None;
            for edge in graph.graph().edges(node) {
                let Some(jump) = graph.jump(edge.id()) else {
                    onward = Some((edge.id(), edge.target()));
                    continue;
                };
                let apart = |a: Place, b: Place| {
                    (a.clip == b.clip).then(|| middle(a, jump.window).abs_diff(middle(b, window)))
                };
                let off = apart(jump.leave, leave).zip(apart(jump.enter, enter));
                let Some((left, entered)) = off.filter(|off| off.0 <= near && off.1 <= near) else {
                    continue;
                };
                if best.as_ref().is_none_or(|(least, _)| left + entered < *least) {
                    let mut way: Vec<EdgeIndex> = on.clone();
                    way.push(edge.id());
                    best = Some((left + entered, way));
                }
            }
            let Some((edge, target)) = onward else { break };
            on.push(edge);
            node = target;
        }
        if let Some((_, way)) = best {
            self.walker.take(way);
            self.guided = number;
        }
    }
}
