//! What happens while a hand drags the blend window: two clips of 3,000 frames and 31 joints.
//!
//! `window/cached terms` is what a new window costs: the distances between all windows on the
//! search's grid. `registration.rs` holds that against the definition.

mod common;

use common::skeleton;
use criterion::{Criterion, criterion_group, criterion_main};
use glam::{Quat, Vec3};
use segue_motion::blend::{DissolveOptions, RootBlend, dissolve};
use segue_motion::clip::{Clip, ContactOptions, Contacts, Motion};
use segue_motion::metrics::{Profile, Subject, TransitionMetrics};
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
    let [walk, run] = [Action::Walk, Action::Run].map(|action| {
        let clip = synthesize(&Params { fps: 120.0, duration_secs: 25.0, ..Params::new(action) })
            .expect("natural parameters")
            .clip;
        let roles = Roles::detect(clip.skeleton());
        let contacts = Contacts::detect(&clip, &roles, &ContactOptions::default());
        (Profile::new(Arc::new(Motion::with_roles(clip, &roles)), &roles, contacts), roles)
    });
    let ((a, roles), (b, _)) = (walk, run);
    for window in [30, 120] {
        let out = dissolve(
            a.source(),
            2_000,
            b.source(),
            500,
            &DissolveOptions { window, ..DissolveOptions::default() },
        )
        .expect("the window fits");
        let (start, end) = (out.transition.start, out.transition.end);
        let subject = Subject {
            result: &out.clip,
            start,
            end,
            handover: out.handover,
            enter: 500,
            a: &a,
            b: &b,
            roles: &roles,
            ground_m: 0.0,
        };
        c.bench_function(&format!("metrics, {window} frames"), |bench| {
            bench.iter(|| TransitionMetrics::measure(black_box(&subject)));
        });
    }
    c.bench_function("metrics, profile (once per clip)", |bench| {
        bench.iter(|| Profile::new(Arc::clone(a.source()), &roles, a.contacts().clone()));
    });
}

criterion_group!(benches, registration, blending, measuring);
criterion_main!(benches);
