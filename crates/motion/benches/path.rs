//! The work while a control point is dragged: a clip of 3,000 frames and 31 joints, carried to
//! another path for every frame of the screen.

use criterion::{Criterion, criterion_group, criterion_main};
use glam::DVec2;
use segue_motion::clip::{ContactOptions, Contacts, Motion};
use segue_motion::path::{
    ArcLengthPath, CarryOptions, FitOptions, FittedPath, MotionOptions, PathEdit, PathEditor, Pins,
    Timing, carry,
};
use segue_motion::skeleton::Roles;
use segue_motion::synth::Action;
use segue_motion::transition::FootLockOptions;
use std::hint::black_box;
use std::sync::Arc;

#[path = "common/gait.rs"]
mod common;

use common::gait;

fn dragging(c: &mut Criterion) {
    let clip = Arc::new(gait(Action::Walk, 3_000, 12.0));
    let roles = Roles::detect(clip.skeleton());
    let contacts = Contacts::detect(&clip, &roles, &ContactOptions::default());
    let size = format!("{} frames, {} joints", clip.frames(), clip.skeleton().len());
    let source = Arc::new(Motion::with_roles(clip, &roles));
    let fit = FitOptions { control_points: 24, ..FitOptions::default() };
    c.bench_function(&format!("fit, {size}"), |bench| {
        bench.iter(|| {
            FittedPath::new(black_box(Arc::clone(&source)), &fit).expect("a walk goes somewhere")
        });
    });
    let path = FittedPath::new(source, &fit).expect("a walk goes somewhere");
    let spline = path.curve().spline().clone();
    let to = spline.points()[9] + DVec2::new(1.0, 0.5);
    let edited = || {
        let moved = spline
            .edited(&PathEdit::Move { index: 9, to: black_box(to) }, Pins::default())
            .expect("the point is there");
        ArcLengthPath::new(moved).expect("it has a length")
    };
    let editor = PathEditor::new(path, &roles, contacts);
    for (name, timing) in
        [("metres", Timing::Metres), ("speed", Timing::Speed), ("duration", Timing::Duration)]
    {
        let options = CarryOptions { timing, ..CarryOptions::default() };
        c.bench_function(&format!("carry, {name}"), |bench| {
            bench.iter(|| carry(editor.path(), &edited(), &options).expect("there is a path"));
        });
        let whole = MotionOptions { carry: options, foot_lock: Some(FootLockOptions::default()) };
        c.bench_function(&format!("carry, plant the feet and measure, {name}"), |bench| {
            bench.iter(|| editor.motion(&edited(), &whole).expect("there are legs"));
        });
    }
}

criterion_group!(benches, dragging);
criterion_main!(benches);
