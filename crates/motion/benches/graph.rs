//! The cost of a motion graph: 6,000 frames of 31 joints, windows of 30 frames. "Directly" is a
//! thousandth of the same pairs by the definition of the distance: the whole takes a thousand times
//! as long.

mod common;

use common::skeleton;
use criterion::{Criterion, criterion_group, criterion_main};
use glam::{Quat, Vec3};
use segue_motion::clip::{Clip, Motion};
use segue_motion::graph::{
    AllPairs, CandidateStream, Candidates, FrameSet, GraphOptions, MotionGraph,
};
use segue_motion::registration::distances_directly;
use segue_motion::skeleton::Roles;
use std::hint::black_box;
use std::sync::Arc;

const FRAMES: usize = 6_000;
const WINDOW: usize = 30;
const FPS: f64 = 60.0;

/// Returns strides whose cadence varies.
fn set(frames: usize) -> Arc<FrameSet> {
    let skeleton = skeleton();
    let (mut rotations, mut roots) =
        (Vec::with_capacity(frames * skeleton.len()), Vec::with_capacity(frames));
    for frame in 0..frames {
        let time = frame as f32 / FPS as f32;
        let phase = 5.0 * time + 0.9 * (0.7 * time).sin();
        rotations.extend(
            (0..skeleton.len())
                .map(|joint| Quat::from_rotation_x(0.4 * (phase + joint as f32).sin())),
        );
        roots.push(Vec3::new((0.3 * time).sin(), 1.0, 0.3 * phase));
    }
    let clip =
        Clip::new("bench", Arc::clone(&skeleton), FPS, rotations, roots).expect("lengths fit");
    let source = Arc::new(Motion::with_roles(clip, &Roles::detect(&skeleton)));
    Arc::new(FrameSet::new(vec![source], 1.75).expect("one clip"))
}

fn graph(c: &mut Criterion) {
    let set = set(FRAMES);
    let options =
        GraphOptions { blend_window: WINDOW, edge_threshold_cm: 3.0, ..GraphOptions::default() };
    let terms = || {
        let mut all = AllPairs::new(Arc::clone(&set)).expect("few enough");
        all.finish().expect("finite");
        all
    };
    let mut group = c.benchmark_group("graph");
    group.sample_size(10);
    group.bench_function("all pairs of 6,000 frames", |bench| bench.iter(terms));
    let all = terms();
    group.bench_function("a new window", |bench| {
        bench.iter(|| all.distances(black_box(WINDOW)).expect("complete"));
    });
    let distances = all.distances(WINDOW).expect("complete");
    group.bench_function("a new threshold", |bench| {
        bench.iter(|| {
            let candidates = Candidates::find(&all, &distances, black_box(&options))
                .expect("a window that fits");
            MotionGraph::new(&set, &candidates, &options).expect("transitions")
        });
    });
    group.bench_function("minima alone, tile by tile", |bench| {
        bench.iter(|| {
            CandidateStream::new(&set, &options).expect("it fits").finish().expect("finite")
        });
    });
    let clip = set.clips()[0].clip();
    // 18 million pairs, a thousandth of them.
    let rows = 0..3;
    group.bench_function("directly, a thousandth of the pairs", |bench| {
        bench.iter(|| {
            distances_directly(
                (clip, rows.clone()),
                (black_box(clip), 0..FRAMES),
                set.weights(),
                WINDOW,
                1,
            )
            .expect("finite")
        });
    });
}

criterion_group!(benches, graph);
criterion_main!(benches);
