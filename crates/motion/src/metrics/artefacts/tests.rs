//! Tests of motion traces.

use super::*;
use crate::math::Planar;
use crate::skeleton::fixtures;
use crate::synth::{Action, Params, synthesize};
use glam::Quat;
use std::sync::Arc;

#[test]
fn trace_of_a_made_walk_has_still_stances() {
    let clip = synthesize(&Params::new(Action::Walk)).unwrap().clip;
    let roles = Roles::detect(clip.skeleton());
    let walk = MotionTrace::new(&clip, &roles);
    assert_eq!(walk.beside(&[]), Artefacts::default());
    assert!(walk.stances_cm().len() >= 4);
    // Position and size do not matter.
    let elsewhere = MotionTrace::new(&clip.transformed(&Planar::new(2.0, 30.0, -4.0)), &roles);
    let (own, other) =
        (walk.skating_cm_per_sec().unwrap(), elsewhere.skating_cm_per_sec().unwrap());
    assert!((own - other).abs() < 0.02 * own.max(0.1), "{own} {other}");
}

#[test]
fn trace_without_feet_or_with_one_frame_is_partial() {
    let skeleton = fixtures::lafan();
    let pose = vec![Quat::IDENTITY; skeleton.len()];
    let clip = Clip::new("pose", Arc::clone(&skeleton), 30.0, pose, vec![Vec3::Y]).unwrap();
    let trace = MotionTrace::new(&clip, &Roles::default());
    assert_eq!((trace.skating_cm_per_sec(), trace.stances_cm().len()), (None, 0));
    assert_eq!(trace.beside(&[&trace]), Artefacts::default());
    let with_feet = MotionTrace::new(&clip, &fixtures::roles(&skeleton));
    assert_eq!(with_feet.skating_cm_per_sec(), Some(0.0));
}
