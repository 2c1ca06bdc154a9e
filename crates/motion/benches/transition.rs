//! The work while a half-life is dragged: two clips of 3,000 frames and 31 joints, joined again for
//! every frame of the screen.

use criterion::{Criterion, criterion_group, criterion_main};
use glam::{Quat, Vec3};
use segue_motion::clip::{Clip, Motion};
use segue_motion::math::Decay;
use segue_motion::registration::{PoseSearch, PoseWeights, SearchOptions, limb_weights};
use segue_motion::skeleton::{Joint, Roles, Skeleton};
use segue_motion::transition::{
    Inertialization, LoopOptions, Method, TransitionOptions, close_loop, concatenate,
};
use std::hint::black_box;
use std::sync::Arc;

const FRAMES: usize = 3_000;
const FPS: f64 = 120.0;

/// Returns a chain of 31 joints, as many as the CMU skeleton has.
fn source(cadence: f32, speed: f32) -> Motion {
    let joint = |index: usize| Joint {
        name: format!("Joint{index}"),
        parent: index.checked_sub(1),
        offset: Vec3::Y * 0.05,
        end_site: None,
        channels: vec![],
    };
    let skeleton =
        Arc::new(Skeleton::new((0..31).map(joint).collect()).expect("parents come first"));
    let (mut rotations, mut roots) = (Vec::with_capacity(FRAMES * 31), Vec::with_capacity(FRAMES));
    for frame in 0..FRAMES {
        let time = frame as f32 / FPS as f32;
        rotations.extend(
            (0..31).map(|joint| Quat::from_rotation_x(0.4 * (cadence * time + joint as f32).sin())),
        );
        roots.push(Vec3::new((0.3 * time).sin(), 1.0, speed * time));
    }
    let clip =
        Clip::new("bench", Arc::clone(&skeleton), FPS, rotations, roots).expect("lengths fit");
    Motion::with_roles(clip, &Roles::detect(&skeleton))
}

fn joining(c: &mut Criterion) {
    let (a, b) = (source(5.0, 1.2), source(6.5, 2.0));
    let blend_secs = 0.5;
    for (name, how) in [
        ("spring", Inertialization::Offset(Decay::Spring { half_life_secs: 0.2 })),
        ("spring of 2 s", Inertialization::Offset(Decay::Spring { half_life_secs: 2.0 })),
        ("quintic", Inertialization::Offset(Decay::Quintic { blend_secs })),
        (
            "dead blending",
            Inertialization::DeadBlend { blend_secs, extrapolation_half_life_secs: 0.1 },
        ),
    ] {
        let options = TransitionOptions::new(Method::Inertialize(how));
        c.bench_function(&format!("concatenate, {name}"), |bench| {
            bench.iter(|| {
                concatenate(&a, 2_800, black_box(&b), 50, &options).expect("the frames are there")
            });
        });
    }
    c.bench_function("close a loop of 1,200 frames", |bench| {
        bench.iter(|| {
            close_loop(black_box(&a), 300..1_500, &LoopOptions::default())
                .expect("the frames are there")
        });
    });
}

fn searching(c: &mut Criterion) {
    let (a, b) = (source(5.0, 1.2), source(6.5, 2.0));
    let weights = limb_weights(a.clip().skeleton());
    let prepared = || {
        PoseSearch::new(
            (a.clip(), a.ground_frames()),
            (b.clip(), b.ground_frames()),
            &weights,
            1.75,
        )
        .expect("the clips fit")
    };
    let mut slow = c.benchmark_group("pose search");
    slow.sample_size(10);
    slow.bench_function("first (once per pair of clips)", |bench| {
        bench.iter(|| {
            let mut search = prepared();
            search.advance(usize::MAX);
            search
        });
    });
    let mut search = prepared();
    search.advance(usize::MAX);
    slow.bench_function("best pair for new weights", |bench| {
        bench.iter(|| {
            search
                .best(black_box(PoseWeights::default()), &SearchOptions::new(60))
                .expect("the window fits")
        });
    });
}

criterion_group!(benches, joining, searching);
criterion_main!(benches);
