//! The cost of a search: 27 dimensions; 5,000, 50,000 and 500,000 frames; queries from a recorded
//! drive through the database and from noise. Segue's boxes are compared with a plain scan, with
//! boxes over 16 and 64 frames in order of time with early exit (the usual way, Holden 2020), and
//! with the k-d tree of `kiddo`. Also the cost of building a database, and of a crowd. Percentiles:
//! `cargo xtask match-speed`.

use criterion::{Criterion, criterion_group, criterion_main};
use segue_motion::matching::{
    Controller, ControllerOptions, Database, DatabaseOptions, RATE, Recording,
};
use segue_motion::math::Planar;
use std::hint::black_box;
use std::sync::Arc;
use std::time::Duration;

#[path = "common/search.rs"]
mod search;
use search::{Kind, Method, Trial, clips, recording};

fn searches(c: &mut Criterion) {
    for frames in [5_000, 50_000, 500_000] {
        let trial = Trial::new(frames);
        for kind in Kind::ALL {
            let mut group =
                c.benchmark_group(format!("matching/{}/{}", trial.frames(), kind.name()));
            group
                .sample_size(10)
                .measurement_time(Duration::from_secs(2))
                .warm_up_time(Duration::from_millis(500));
            for method in Method::ALL {
                let mut next = 0;
                group.bench_function(method.name(), |bench| {
                    bench.iter(|| {
                        next = (next + 1) % trial.queries(kind);
                        black_box(trial.search(method, kind, next))
                    });
                });
            }
            group.finish();
        }
    }
}

fn building(c: &mut Criterion) {
    let mut group = c.benchmark_group("matching/build");
    group.sample_size(10);
    let clips = clips(50_000);
    group.bench_function("50,000 frames", |bench| {
        bench.iter(|| Database::new(clips.clone(), &DatabaseOptions::default()).expect("clips"));
    });
}

/// Simulates a second of sixty characters, each driven by a recording of its own.
fn crowd(c: &mut Criterion) {
    let mut group = c.benchmark_group("matching/crowd");
    group.sample_size(10);
    let database =
        Arc::new(Database::new(clips(20_000), &DatabaseOptions::default()).expect("clips"));
    let recordings: Vec<Recording> = (0..60).map(|seed| recording(seed, 6_000)).collect();
    let mut characters: Vec<Controller> = (0..60)
        .map(|_| {
            Controller::new(Arc::clone(&database), ControllerOptions::default(), &Planar::IDENTITY)
                .expect("defaults")
        })
        .collect();
    let mut second = 0;
    group.bench_function("60 characters, 60 updates", |bench| {
        bench.iter(|| {
            for (character, recording) in characters.iter_mut().zip(&recordings) {
                for tick in 0..RATE {
                    let control =
                        recording.control((second * RATE + tick) % 6_000).unwrap_or_default();
                    character.tick(&control);
                }
            }
            second += 1;
        });
    });
}

criterion_group!(benches, building, crowd, searches);
criterion_main!(benches);
