//! Builds a motion graph of four clips and takes a seeded random walk of 30 seconds through it.
//!
//! `cargo run --no-default-features --example motion_graph -- walk.bvh` also writes the walk.

#![expect(clippy::print_stdout, reason = "the numbers are the example's output")]

use segue_formats::bvh;
use segue_motion::clip::Motion;
use segue_motion::graph::{AllPairs, Candidates, Choices, FrameSet, GraphOptions, MotionGraph};
use segue_motion::graph::{StitchOptions, Stitcher, Walker, WeightOptions, assembled};
use segue_motion::metrics::{MotionTrace, ResultMetrics};
use segue_motion::synth::{presets, synthesize};
use std::error::Error;
use std::sync::Arc;

fn main() -> Result<(), Box<dyn Error>> {
    let mut clips = Vec::new();
    for preset in presets().iter().filter(|preset| preset.id.contains("walk")) {
        clips.push(Arc::new(Motion::analyze(synthesize(&preset.params)?.clip)));
    }
    let first = Arc::clone(clips.first().ok_or("no preset is a walk")?);
    let set = Arc::new(FrameSet::new(clips.clone(), f64::from(first.body_height()))?);

    // The distance of every window of frames to every other one; its minima are the transitions.
    let options =
        GraphOptions { blend_window: 20, edge_threshold_cm: 8.0, ..GraphOptions::default() };
    let mut pairs = AllPairs::new(Arc::clone(&set))?;
    while !pairs.advance(100_000)?.is_complete() {}
    let candidates = Candidates::find(&pairs, &pairs.distances(options.blend_window)?, &options)?;
    let graph = Arc::new(MotionGraph::new(&set, &candidates, &options)?.pruned()?);
    println!(
        "{} clips, {} transitions, {} dead ends",
        clips.len(),
        graph.jumps().len(),
        graph.dead_ends().len()
    );

    let choices = Arc::new(Choices::new(&graph, &WeightOptions::default())?);
    let mut walker = Walker::new(Arc::clone(&graph), choices, 7);
    let mut stitcher =
        Stitcher::new(Arc::clone(&set), &StitchOptions::dissolve(options.blend_window));
    let (mut pieces, mut frames) = (Vec::new(), 0);
    while (frames as f64) < 30.0 * set.fps() {
        let stay = walker.next_stay().ok_or("a pruned graph has no dead end")?;
        let piece = stitcher.stitch(&graph, &stay)?;
        frames += piece.clip.frames();
        pieces.push(piece);
    }
    let (walk, _) = assembled(&pieces)?.ok_or("the walk is empty")?;
    let traces: Vec<MotionTrace> =
        clips.iter().map(|motion| MotionTrace::new(motion.clip(), motion.roles())).collect();
    let metrics = ResultMetrics::measure(
        &MotionTrace::new(&walk, first.roles()),
        &traces.iter().collect::<Vec<_>>(),
    );
    let jump = metrics.pose_jump_deg.ok_or("the walk is too short to measure")?;
    println!(
        "a walk of {:.1} s in {} pieces: pose jump {jump:.1} °",
        walk.duration_secs(),
        pieces.len()
    );
    if let Some(path) = std::env::args_os().nth(1) {
        std::fs::write(path, bvh::write(&walk, &bvh::WriteOptions::default()))?;
    }
    Ok(())
}
