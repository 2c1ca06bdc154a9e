//! The work while the blend window is dragged: two clips of 3,000 frames and 31 joints.
//!
//! `window/cached terms` is the cost of a new window: the distances between all windows on the
//! search's grid. `registration.rs` compares that with the definition.

mod common;

use common::skeleton;
use criterion::{Criterion, criterion_group, criterion_main};
use glam::{Quat, Vec3};
use segue_motion::blend::{DissolveOptions, RootBlend, dissolve};
use segue_motion::clip::{Clip, Motion};
use segue_motion::metrics::TransitionMetrics;
use segue_motion::registration::{SearchOptions, TransitionSearch, limb_weights};
use segue_motion::skeleton::{Roles, Skeleton};
use segue_motion::synth::{Action, Params, synthesize};
use std::hint::black_box;
use std::sync::Arc;

const FRAMES: usize = 3_000;
const FPS: f64 = 120.0;

fn clip(skeleton: &Arc<Skeleton>, cadence: f32, speed: f32) -> Arc<Clip> {
    let mut rotations = Vec::with_capacity(FRAMES * skeleton.len());
    let mut roots = Vec::with_capacity(FRAMES);
    for frame in 0..FRAMES {
        let time = frame as f32 / FPS as f32;
        for joint in 0..skeleton.len() {
            rotations.push(Quat::from_rotation_x(0.4 * (cadence * time + joint as f32).sin()));
        }
        roots.push(Vec3::new((0.3 * time).sin(), 1.0, speed * time));
    }
    Arc::new(Clip::new("bench", Arc::clone(skeleton), FPS, rotations, roots).expect("lengths fit"))
}

fn registration(c: &mut Criterion) {
    let skeleton = skeleton();
    let (a, b) = (clip(&skeleton, 5.0, 1.2), clip(&skeleton, 6.5, 2.0));
    let weights = limb_weights(&skeleton);
    let prepared = || {
        TransitionSearch::new(Arc::clone(&a), Arc::clone(&b), &weights, 1.75)
            .expect("the clips fit")
    };
    c.bench_function("window/first (once per pair of clips)", |bench| {
        bench.iter(|| {
            let mut search = prepared();
            search.advance(usize::MAX);
            search
        });
    });
    let mut search = prepared();
    search.advance(usize::MAX);
    for window in [30, 120] {
        c.bench_function(&format!("window/best transition, {window} frames"), |bench| {
            bench.iter(|| {
                search.best(black_box(&SearchOptions::new(window))).expect("the window fits")
            });
        });
        c.bench_function(&format!("window/cached terms, {window} frames"), |bench| {
            bench.iter(|| {
                search
                    .terms()
                    .distances(black_box(window), &(0..FRAMES), &(0..FRAMES))
                    .expect("complete")
            });
        });
    }
}

fn blending(c: &mut Criterion) {
    let skeleton = skeleton();
    let (a, b) = (clip(&skeleton, 5.0, 1.2), clip(&skeleton, 6.5, 2.0));
    let roles = Roles::detect(&skeleton);
    let (a, b) = (Motion::with_roles(a, &roles), Motion::with_roles(b, &roles));
    for root in [RootBlend::Velocity, RootBlend::World] {
        let options = DissolveOptions { window: 120, root, ..DissolveOptions::default() };
        c.bench_function(&format!("dissolve, 120 frames, {root:?}"), |bench| {
            bench.iter(|| {
                dissolve(&a, 2_800, black_box(&b), 50, &options).expect("the window fits")
            });
        });
    }
}

fn measuring(c: &mut Criterion) {
    let [a, b] = [Action::Walk, Action::Run].map(|action| {
        let params = Params { fps: 120.0, duration_secs: 25.0, ..Params::new(action) };
        Motion::analyze(synthesize(&params).expect("natural parameters").clip)
    });
    for window in [30, 120] {
        let options = DissolveOptions { window, ..DissolveOptions::default() };
        let out = dissolve(&a, 2_000, &b, 500, &options).expect("the window fits");
        c.bench_function(&format!("metrics, {window} frames"), |bench| {
            bench.iter(|| TransitionMetrics::measure(&a, &b, black_box(&out)));
        });
    }
    c.bench_function("analysis and metrics of a cut (once per clip)", |bench| {
        bench.iter(|| {
            let a = Motion::analyze(Arc::clone(a.clip()));
            let options = DissolveOptions { window: 0, ..DissolveOptions::default() };
            let out = dissolve(&a, 2_000, &b, 500, &options).expect("the window fits");
            TransitionMetrics::measure(&a, &b, &out)
        });
    });
}

criterion_group!(benches, registration, blending, measuring);
criterion_main!(benches);
