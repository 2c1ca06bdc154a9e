//! What happens while a hand drags a speed, a weight, or the switch of the foot lock: 600 frames.

use criterion::{Criterion, criterion_group, criterion_main};
use segue::blend::{LayerOptions, Source, layer};
use segue::clip::{Clip, ContactOptions, Contacts};
use segue::gait::{GaitCycle, SpeedBlend, SpeedOptions, SpeedPlayer};
use segue::skeleton::{Joint, Roles, Skeleton};
use segue::synth::{Action, Params, synthesize};
use segue::transition::{FootLockOptions, foot_lock};
use std::hint::black_box;
use std::sync::Arc;

/// 600 frames of a made gait on a body of 31 joints, as many as the CMU skeleton has: fingers are added.
fn gait(action: Action) -> Clip {
    let params = Params {
        duration_secs: 10.2,
        ..Params::new(action)
    };
    let made = synthesize(&params).expect("defaults can be made").clip;
    let made = made.crop(0..600).expect("long enough");
    let mut joints = made.skeleton().joints().to_vec();
    while joints.len() < 31 {
        joints.push(Joint {
            name: format!("Finger{}", joints.len()),
            parent: Some(21),
            ..joints[21].clone()
        });
    }
    let skeleton = Arc::new(Skeleton::new(joints).expect("fingers come last"));
    let poses = (0..made.frames()).map(|frame| {
        let mut pose = made.pose(frame);
        pose.rotations.resize(31, glam::Quat::IDENTITY);
        pose
    });
    Clip::from_poses(made.name(), skeleton, made.fps(), poses).expect("one rotation per joint")
}

fn living(c: &mut Criterion) {
    let [walk, run] = [Action::Walk, Action::Run].map(gait);
    let roles = Roles::detect(walk.skeleton());
    let contacts = [&walk, &run].map(|clip| Contacts::detect(clip, &roles, &ContactOptions::default()));
    c.bench_function("foot lock, 600 frames", |bench| {
        bench.iter(|| foot_lock(black_box(&walk), &roles, &contacts[0], &FootLockOptions::default()).expect("there are legs"));
    });
    c.bench_function("layer, 600 frames", |bench| {
        bench.iter(|| layer(black_box(&walk), &roles, &run, &LayerOptions::default()).expect("one skeleton"));
    });
    let sources = [walk, run].map(|clip| Source::new(Arc::new(clip), &roles));
    let cycles = [0, 1].map(|gait: usize| GaitCycle::find(&sources[gait], &contacts[gait]).expect("whole cycles"));
    let blend = SpeedBlend::new(&cycles[0], &cycles[1], &roles, &SpeedOptions::default()).expect("speeds differ");
    c.bench_function("find a cycle in 600 frames (once per clip)", |bench| {
        bench.iter(|| GaitCycle::find(black_box(&sources[0]), &contacts[0]).expect("whole cycles"));
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
