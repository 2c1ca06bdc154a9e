//! Usual speeds in a clip, against which transitions are measured.

use super::{Motion, stillest_step, turn_change};
use crate::clip::Clip;
use crate::math::{quat, stats};
use crate::skeleton::{Foot, Roles, WorldPose};
use glam::{Quat, Vec3};

/// The number of steps from which usual values are computed: enough for a 99th percentile, and
/// bounded for long clips.
const SAMPLES: usize = 1_000;

/// The usual speeds of a motion's joints and root, and the motion of its feet.
#[derive(Clone, Debug)]
pub(crate) struct UsualMotion {
    /// Per foot ([`Foot::of`]) and frame: the distance that the stillest point of the foot moves
    /// over the ground in the step into that frame, metres.
    pub(crate) slides: Vec<Vec<f32>>,
    /// Per joint, the 99th percentile of the turn from one frame to the next, radians.
    pub(crate) turn: Vec<f32>,
    /// Per joint, the 99th percentile of the change of that turn (as a rotation vector) from one
    /// step to the next, radians.
    pub(crate) change: Vec<f32>,
    /// The 99th percentile of the character's step over the ground, metres.
    pub(crate) step: f32,
}

impl UsualMotion {
    /// Measures a motion. O(frames × joints).
    pub(super) fn of(motion: &Motion) -> Self {
        let clip = motion.clip();
        let (turn, change) = usual_turns(clip);
        let steps: Vec<f32> = motion
            .ground_frames()
            .windows(2)
            .map(|pair| pair[0].shift.distance(pair[1].shift) as f32)
            .collect();
        let step = stats::percentile(&steps, 0.99).unwrap_or(0.0);
        Self { slides: slides(clip, motion.roles()), turn, change, step }
    }
}

/// Returns the rotation vector of the step from one local rotation to the next, radians, in the
/// parent's frame.
pub(crate) fn turn(from: Quat, to: Quat) -> Vec3 {
    quat::log(to * from.conjugate())
}

fn usual_turns(clip: &Clip) -> (Vec<f32>, Vec<f32>) {
    let stride = clip.frames().div_ceil(SAMPLES).max(1);
    let p99 = |values: &[f32]| stats::percentile(values, 0.99).unwrap_or(0.0);
    (0..clip.skeleton().len())
        .map(|joint| {
            let (mut turns, mut changes) =
                (Vec::with_capacity(SAMPLES), Vec::with_capacity(SAMPLES));
            for frame in (1..clip.frames()).step_by(stride) {
                let of = |frame: usize| clip.rotations(frame)[joint];
                turns.push(turn(of(frame - 1), of(frame)).length());
                changes.extend(turn_change(clip, frame, joint));
            }
            (p99(&turns), p99(&changes))
        })
        .unzip()
}

fn slides(clip: &Clip, roles: &Roles) -> Vec<Vec<f32>> {
    let feet = Foot::of(roles.body_plan()).iter();
    let points: Vec<_> = feet.map(|&foot| roles.foot_points(clip.skeleton(), foot)).collect();
    let mut slides = vec![Vec::with_capacity(clip.frames()); points.len()];
    let mut before: Vec<Vec<Vec3>> = vec![Vec::new(); points.len()];
    let mut world = WorldPose::default();
    for frame in 0..clip.frames() {
        clip.world_pose_into(frame, &mut world);
        for ((points, slides), before) in points.iter().zip(&mut slides).zip(&mut before) {
            let now: Vec<Vec3> =
                points.iter().map(|&(joint, point)| world.point(joint, point)).collect();
            slides.push(stillest_step(before, &now).map_or(0.0, Vec3::length));
            *before = now;
        }
    }
    slides
}
