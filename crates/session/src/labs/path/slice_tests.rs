//! Tests of the Path lab's work in slices.

use super::*;

use segue_motion::synth::{Action, Params as SynthParams, synthesize};

/// Returns a walk there and back again and again, of more frames than are carried at once.
fn long_walk() -> Arc<Motion> {
    let walk = synthesize(&SynthParams::new(Action::Walk)).unwrap().clip;
    let there = (0..walk.frames()).chain((0..walk.frames()).rev());
    let frames = there.cycle().take(CARRIED_AT_ONCE + 500);
    let poses: Vec<_> = frames.map(|frame| walk.pose(frame)).collect();
    let long = Clip::from_poses("long", Arc::clone(walk.skeleton()), walk.fps(), poses);
    Arc::new(Motion::analyze(Arc::new(long.unwrap())))
}

/// Returns the inputs of the parameters, and the slices of work before they are known.
fn inputs(motion: &Arc<Motion>, params: &Params, paths: &mut Paths) -> (PathInputs, usize) {
    let (jobs, mut slices) = (&mut JobBoard::default(), 0);
    loop {
        paths.clear_requests();
        if let Some(inputs) = paths.inputs(motion, params).unwrap() {
            return (inputs, slices);
        }
        while paths.work(jobs) {
            slices += 1;
        }
        assert!(paths.is_ready());
    }
}

#[test]
fn long_motion_on_its_path_is_the_same_in_slices() {
    let (motion, mut params, mut paths) = (long_walk(), Params::default(), Paths::default());
    for keep in ["speed", "duration"] {
        params.set(Key::PathKeep, Value::Choice(keep)).unwrap();
        let (sliced, slices) = inputs(&motion, &params, &mut paths);
        assert!(sliced.free.is_some() && slices > 4, "{slices}");
        let at_once = PathInputs { free: None, ..sliced.clone() };
        let (made, expected) = (sliced.run().unwrap(), at_once.run().unwrap());
        assert!(made.motion == expected.motion, "{keep}");
        assert_eq!(made.metrics, expected.metrics);
        assert_eq!(made.path().unwrap().places, expected.path().unwrap().places);
    }
    // The next edit begins with what is shown: an edited path is there at once.
    let spline = inputs(&motion, &params, &mut paths).0.fitted.curve().spline().clone();
    params.set(Key::Path, List::EditedPath(Some(spline)).into()).unwrap();
    paths.clear_requests();
    let edited = paths.inputs(&motion, &params).unwrap().expect("at once");
    assert!(edited.free.is_none() && edited.run().unwrap().path().unwrap().is_edited);
}
