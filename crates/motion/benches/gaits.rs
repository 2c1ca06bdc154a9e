//! The work while a speed, a weight, or the switch of the foot lock is dragged: 600 frames.

use criterion::{Criterion, criterion_group, criterion_main};
use segue_motion::blend::{LayerOptions, layer};
use segue_motion::clip::{ContactOptions, Contacts, Motion};
use segue_motion::gait::{GaitCycle, SpeedBlend, SpeedOptions, SpeedPlayer};
use segue_motion::skeleton::Roles;
use segue_motion::synth::Action;
use segue_motion::transition::{FootLockOptions, foot_lock};
use std::hint::black_box;

#[path = "common/gait.rs"]
mod common;

use common::gait;

fn living(c: &mut Criterion) {
    let [walk, run] = [Action::Walk, Action::Run].map(|action| gait(action, 600, 0.0));
    let roles = Roles::detect(walk.skeleton());
    let contacts = Contacts::detect(&walk, &roles, &ContactOptions::default());
    c.bench_function("foot lock, 600 frames", |bench| {
        bench.iter(|| {
            foot_lock(black_box(&walk), &roles, &contacts, &FootLockOptions::default())
                .expect("there are legs")
        });
    });
    let sources = [walk, run].map(|clip| Motion::with_roles(clip, &roles));
    c.bench_function("layer, 600 frames", |bench| {
        bench.iter(|| {
            layer(black_box(&sources[0]), &sources[1], &LayerOptions::default())
                .expect("one skeleton")
        });
    });
    let cycles = [0, 1].map(|gait: usize| GaitCycle::find(&sources[gait]).expect("whole cycles"));
    let blend = SpeedBlend::new(&cycles[0], &cycles[1], &roles, &SpeedOptions::default())
        .expect("speeds differ");
    c.bench_function("find a cycle in 600 frames (once per clip)", |bench| {
        bench.iter(|| GaitCycle::find(black_box(&sources[0])).expect("whole cycles"));
    });
    c.bench_function("one cycle at a speed", |bench| {
        bench.iter(|| blend.cycle_at(black_box(2.3)).expect("a speed"));
    });
    c.bench_function("600 frames at a speed", |bench| {
        bench.iter(|| blend.clip_of(black_box(2.3), 10.0).expect("a speed"));
    });
    let mut player = SpeedPlayer::new(&blend, 1.4);
    c.bench_function("one frame of a player", |bench| {
        bench.iter(|| player.advance(&blend, 1.0 / 60.0, black_box(2.3)));
    });
}

criterion_group!(benches, living);
criterion_main!(benches);
