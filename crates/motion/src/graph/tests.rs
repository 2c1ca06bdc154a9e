//! Tests of motion graphs.

use super::*;
use crate::clip::Motion;
use crate::registration::fixtures::Walk;
use std::sync::Arc;

mod construction;
mod distances;
mod long_run;
mod stitching;
mod walks;

const HEIGHT: f64 = 1.7;

fn set_of(walks: &[Walk]) -> Arc<FrameSet> {
    let sources = walks.iter().map(|walk| Arc::new(Motion::analyze(walk.clip())));
    Arc::new(FrameSet::new(sources.collect(), HEIGHT).unwrap())
}

/// Returns a walk, a faster one that turns, and one with another position and facing.
pub(super) fn three(frames: [usize; 3]) -> Arc<FrameSet> {
    let walk = Walk::default();
    set_of(&[
        Walk { frames: frames[0], ..walk },
        Walk { frames: frames[1], cadence: 1.1, turning: 0.7, speed: 1.5, ..walk },
        Walk {
            frames: frames[2],
            phase: 0.3,
            heading: 2.5,
            start: (4.0, -3.0),
            swing: 0.5,
            ..walk
        },
    ])
}

fn compared(set: &Arc<FrameSet>) -> AllPairs {
    let mut all = AllPairs::new(Arc::clone(set)).unwrap();
    all.finish().unwrap();
    all
}

fn options(
    construction: Construction,
    blend_window: usize,
    edge_threshold_cm: f64,
) -> GraphOptions {
    GraphOptions { construction, blend_window, edge_threshold_cm, ..GraphOptions::default() }
}

fn built(set: &Arc<FrameSet>, options: &GraphOptions) -> Result<MotionGraph, GraphError> {
    let all = compared(set);
    let candidates = Candidates::find(&all, &all.distances(options.blend_window)?, options)?;
    MotionGraph::new(set, &candidates, options)
}

fn walker(graph: &Arc<MotionGraph>, weights: &WeightOptions, seed: u64) -> Walker {
    Walker::new(Arc::clone(graph), Arc::new(Choices::new(graph, weights).unwrap()), seed)
}

fn pieces(
    graph: &Arc<MotionGraph>,
    walker: &mut Walker,
    options: &StitchOptions,
    stays: usize,
) -> Vec<WalkPiece> {
    let mut stitcher = Stitcher::new(Arc::clone(graph.set()), options);
    let mut pieces = Vec::new();
    while let Some(stay) = walker.next_stay().filter(|_| pieces.len() < stays) {
        pieces.push(stitcher.stitch(graph, &stay).unwrap());
    }
    pieces
}

fn nodes(graph: &MotionGraph) -> Vec<(usize, usize, usize)> {
    graph.graph().node_weights().map(|s| (s.clip, s.start, s.end)).collect()
}

fn minima_graph() -> Arc<MotionGraph> {
    let set = three([300, 260, 240]);
    Arc::new(built(&set, &options(Construction::Minima, 12, 9.0)).unwrap().pruned().unwrap())
}
