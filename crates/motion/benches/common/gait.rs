//! Gaits for the foot lock benches.

use glam::Quat;
use segue_motion::clip::Clip;
use segue_motion::skeleton::{Joint, Skeleton};
use segue_motion::synth::{Action, Params, synthesize};
use std::sync::Arc;

/// Returns `frames` frames of a synthesised gait that turns, degrees per second, on a body of 31
/// joints: fingers are added.
pub(crate) fn gait(action: Action, frames: usize, turn_rate_dps: f32) -> Clip {
    let params =
        Params { duration_secs: frames as f32 / 60.0 + 0.2, turn_rate_dps, ..Params::new(action) };
    let made = synthesize(&params).expect("a gait can be made").clip;
    let made = made.crop(0..frames).expect("long enough");
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
        pose.rotations.resize(31, Quat::IDENTITY);
        pose
    });
    Clip::from_poses(made.name(), skeleton, made.fps(), poses).expect("one rotation per joint")
}
