//! The cost of registration curves: two clips of 1,500 frames and 31 joints, distances of windows
//! of 30 frames. `distances/directly` is a fiftieth of the same matrix by its definition, O(N²JK):
//! the whole takes fifty times as long.

mod common;

use common::skeleton;
use criterion::{Criterion, criterion_group, criterion_main};
use glam::{Quat, Vec3};
use segue_motion::clip::Clip;
use segue_motion::registration::{
    PairTerms, PathOptions, Registration, RegistrationOptions, distances_directly, limb_weights,
    optimal_path,
};
use segue_motion::skeleton::Skeleton;
use std::hint::black_box;
use std::sync::Arc;

const FRAMES: usize = 1_500;
const WINDOW: usize = 30;
const FPS: f64 = 60.0;

/// Returns strides at `cadence` that speed up and slow down by `sway`.
fn clip(skeleton: &Arc<Skeleton>, frames: usize, cadence: f32, sway: f32) -> Arc<Clip> {
    let (mut rotations, mut roots) =
        (Vec::with_capacity(frames * skeleton.len()), Vec::with_capacity(frames));
    for frame in 0..frames {
        let time = frame as f32 / FPS as f32;
        let phase = cadence * time + sway * time.sin();
        rotations.extend(
            (0..skeleton.len())
                .map(|joint| Quat::from_rotation_x(0.4 * (phase + joint as f32).sin())),
        );
        roots.push(Vec3::new((0.3 * time).sin(), 1.0, 0.3 * phase));
    }
    Arc::new(Clip::new("bench", Arc::clone(skeleton), FPS, rotations, roots).expect("lengths fit"))
}

fn terms(a: &Clip, b: &Clip, weights: &[f64]) -> PairTerms {
    let mut terms =
        PairTerms::new(a, 0..a.frames(), b, 0..b.frames(), weights, 1).expect("the clips fit");
    terms.finish();
    terms
}

fn distances(c: &mut Criterion) {
    let skeleton = skeleton();
    let weights = limb_weights(&skeleton);
    let (a, b) = (clip(&skeleton, FRAMES, 5.0, 0.3), clip(&skeleton, FRAMES, 5.0, -0.5));
    let all = 0..FRAMES;
    let mut group = c.benchmark_group("distances");
    group.sample_size(10);
    group.bench_function("pair terms (once per pair of clips)", |bench| {
        bench.iter(|| terms(&a, black_box(&b), &weights));
    });
    let terms = terms(&a, &b, &weights);
    group.bench_function("a new window", |bench| {
        bench.iter(|| terms.distances(black_box(WINDOW), &all, &all).expect("complete"));
    });
    let matrix = terms.distances(WINDOW, &all, &all).expect("complete");
    let options = RegistrationOptions::new(FPS);
    group.bench_function("a path", |bench| {
        bench.iter(|| optimal_path(black_box(&matrix), &PathOptions::default()).expect("a path"));
    });
    group.bench_function("path and curves (a new slope limit)", |bench| {
        bench.iter(|| Registration::new(&terms, black_box(&matrix), &options).expect("a path"));
    });
    group.bench_function("all: terms, window, path, curves", |bench| {
        bench.iter(|| {
            let terms = self::terms(&a, black_box(&b), &weights);
            let matrix = terms.distances(WINDOW, &all, &all).expect("complete");
            Registration::new(&terms, &matrix, &options).expect("a path")
        });
    });
    group.bench_function("directly, a fiftieth of the rows", |bench| {
        bench.iter(|| {
            distances_directly(
                (&a, 0..FRAMES / 50),
                (black_box(&b), all.clone()),
                &weights,
                WINDOW,
                1,
            )
            .expect("finite")
        });
    });
}

fn all_pairs(c: &mut Criterion) {
    let skeleton = skeleton();
    let weights = limb_weights(&skeleton);
    let clip = clip(&skeleton, 6_000, 5.0, 0.3);
    let all = 0..6_000;
    let mut group = c.benchmark_group("all pairs of 6,000 frames");
    group.sample_size(10);
    group.bench_function("pair terms", |bench| {
        bench.iter(|| terms(&clip, black_box(&clip), &weights));
    });
    let terms = terms(&clip, &clip, &weights);
    group.bench_function("a new window", |bench| {
        bench.iter(|| terms.distances(black_box(WINDOW), &all, &all).expect("complete"));
    });
}

criterion_group!(benches, distances, all_pairs);
criterion_main!(benches);
