//! Usual speeds in a clip, against which transitions are measured.

use super::{Motion, RecentPoses, stillest_step, turn_change};
use crate::clip::Clip;
use crate::math::{quat, stats};
use crate::skeleton::Foot;
use glam::{Quat, Vec3};

/// The number of steps from which usual values are computed: enough for a 99th percentile, and
/// bounded for long clips.
const SAMPLES: usize = 1_000;

/// The usual speeds of a motion's joints and root.
#[derive(Clone, Debug)]
pub(crate) struct UsualMotion {
    /// Per joint, the 99th percentile of the turn from one frame to the next, radians.
    pub(crate) turn: Vec<f32>,
    /// Per joint, the 99th percentile of the change of that turn (as a rotation vector) from one
    /// step to the next, radians.
    pub(crate) change: Vec<f32>,
    /// The 99th percentile of the character's step over the ground, metres.
    pub(crate) step: f32,
}

impl UsualMotion {
    /// Measures a motion. O(frames + joints).
    pub(super) fn of(motion: &Motion) -> Self {
        let clip = motion.clip();
        let (turn, change) = usual_turns(clip);
        let steps: Vec<f32> = motion
            .ground_frames()
            .windows(2)
            .map(|pair| pair[0].shift.distance(pair[1].shift) as f32)
            .collect();
        let step = stats::percentile(&steps, 0.99).unwrap_or(0.0);
        Self { turn, change, step }
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

/// The steps of a foot over the ground, frame by frame.
#[derive(Debug)]
pub(crate) struct FootSteps<'a> {
    motion: &'a Motion,
    points: Vec<(usize, Vec3)>,
    poses: RecentPoses,
}

impl<'a> FootSteps<'a> {
    pub(crate) fn new(motion: &'a Motion, foot: Foot) -> Self {
        let skeleton = motion.clip().skeleton();
        let points = motion.roles().foot_points(skeleton, foot);
        let joints = skeleton.with_ancestors(points.iter().map(|&(joint, _)| joint));
        Self { motion, points, poses: RecentPoses::of(joints) }
    }

    /// Returns the distance that the stillest point of the foot moves in the step into a frame,
    /// metres; 0 in the first frame, where there is no such frame, and without a foot.
    pub(crate) fn length_m(&mut self, frame: usize) -> f32 {
        let clip = self.motion.clip();
        let Some(before) = frame.checked_sub(1).filter(|_| frame < clip.frames()) else {
            return 0.0;
        };
        let [before, after] = [before, frame].map(|frame| {
            self.poses.ensure(clip, frame);
            let world = self.poses.get(frame);
            self.points.iter().map(|&(joint, point)| world.point(joint, point)).collect::<Vec<_>>()
        });
        stillest_step(&before, &after).map_or(0.0, Vec3::length)
    }
}
