//! The time of a frame with up to a hundred characters on the processor: everything up to the draw
//! list.

use criterion::{Criterion, criterion_group, criterion_main};
use segue_motion::skeleton::Roles;
use segue_motion::skin::{SkinBuilder, SkinnedMesh};
use segue_motion::synth::humanoid;
use segue_scene::{Director, StageOptions, Viewport};
use segue_session::{Command, Session};
use std::hint::black_box;

fn frame(c: &mut Criterion) {
    let panes = [(0, Viewport { width: 1440, height: 900, ..Viewport::default() })];
    let options = StageOptions { panes: &panes, ..StageOptions::default() };
    for count in [1, 100] {
        let mut session = Session::new();
        session
            .apply(Command::OpenLink(format!("lab=match&crowd={count}")))
            .expect("the link is read");
        while session.work() {}
        for _ in 0..60 {
            session.tick(1.0 / 60.0);
        }
        let mut director = Director::default();
        director.stage(&session, &options, 0.0);
        while director.work() {}
        c.bench_function(&format!("scene of {count} characters"), |bench| {
            bench.iter(|| director.stage(black_box(&session), &options, 1.0 / 60.0));
        });
    }
}

fn mesh(c: &mut Criterion) {
    let skeleton = humanoid(1.75).expect("a person");
    let roles = Roles::detect(&skeleton);
    c.bench_function("a body about a skeleton", |bench| {
        bench.iter(|| SkinnedMesh::around(black_box(&skeleton), &roles, 1.0));
    });
    let mut skin_builder = SkinBuilder::new(&skeleton, &roles, &skeleton.rest_pose());
    let procedural_skin =
        std::iter::from_fn(|| Some(skin_builder.advance())).find_map(|done| done).expect("a body");
    c.bench_function("another girth of that body", |bench| {
        bench.iter(|| procedural_skin.with_girth(black_box(1.3)));
    });
}

criterion_group!(benches, frame, mesh);
criterion_main!(benches);
