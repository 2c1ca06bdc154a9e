//! A frame of the screen with a hundred characters: everything on the processor up to what the
//! graphics card is told.

use criterion::{Criterion, criterion_group, criterion_main};
use segue_motion::skeleton::Roles;
use segue_motion::skin::{Sculptor, SkinnedMesh};
use segue_motion::synth::humanoid;
use segue_scene::{Colors, Director, Look, Viewport};
use segue_session::{Command, Session};
use std::hint::black_box;

fn frame(c: &mut Criterion) {
    let colors = Colors::default();
    let shown = [(0, Viewport { width: 1440, height: 900, ..Viewport::default() })];
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
        director.stage(&session, &shown, 1.0, Look::DARK, &colors, 0.0);
        while director.work() {}
        c.bench_function(&format!("scene of {count} characters"), |bench| {
            bench.iter(|| {
                director.stage(black_box(&session), &shown, 1.0, Look::DARK, &colors, 1.0 / 60.0)
            });
        });
    }
}

fn mesh(c: &mut Criterion) {
    let skeleton = humanoid(1.75).expect("a person");
    let roles = Roles::detect(&skeleton);
    c.bench_function("a body about a skeleton", |bench| {
        bench.iter(|| SkinnedMesh::around(black_box(&skeleton), &roles, 1.0));
    });
    let mut sculptor = Sculptor::new(&skeleton, &roles, &skeleton.rest_pose());
    let sculpture =
        std::iter::from_fn(|| Some(sculptor.advance())).find_map(|done| done).expect("a body");
    c.bench_function("another girth of that body", |bench| {
        bench.iter(|| sculpture.with_girth(black_box(1.3)));
    });
}

criterion_group!(benches, frame, mesh);
criterion_main!(benches);
