//! Profiles of source clips, against which transitions are measured.

use crate::clip::{Clip, Contacts, Motion, stillest_step, turn_change};
use crate::math::{quat, stats};
use crate::skeleton::{Roles, Side, WorldPose};
use glam::{Quat, Vec3};
use std::sync::Arc;

/// The number of steps from which usual values are computed: enough for a 99th percentile, and
/// bounded for long clips.
const SAMPLES: usize = 1_000;

/// The measurements of a source clip that metrics need, made once: usual speeds, and the motion of
/// its feet.
#[derive(Clone, Debug, PartialEq)]
pub struct Profile {
    pub(super) source: Arc<Motion>,
    pub(super) contacts: Contacts,
    /// Per side and frame: the distance that the stillest point of the foot moves over the ground
    /// in the step into that frame, metres.
    pub(super) slides: [Vec<f32>; 2],
    /// Per joint, the 99th percentile of the turn from one frame to the next, radians.
    pub(super) usual_turn: Vec<f32>,
    /// Per joint, the 99th percentile of the change of that turn (as a rotation vector) from one
    /// step to the next, radians.
    pub(super) usual_change: Vec<f32>,
    /// The 99th percentile of the character's step over the ground, metres.
    pub(super) usual_step: f32,
}

impl Profile {
    /// Measures a clip. `contacts` are those of the same clip ([`Contacts::detect`]). O(frames ×
    /// joints).
    #[must_use]
    pub fn new(source: Arc<Motion>, roles: &Roles, contacts: Contacts) -> Self {
        let clip = source.clip();
        let (usual_turn, usual_change) = usual_turns(clip);
        let steps: Vec<f32> = source
            .ground_frames()
            .windows(2)
            .map(|pair| pair[0].shift.distance(pair[1].shift) as f32)
            .collect();
        let usual_step = stats::percentile(&steps, 0.99).unwrap_or(0.0);
        let slides = slides(clip, roles);
        Self { source, contacts, slides, usual_turn, usual_change, usual_step }
    }

    /// Returns the clip with its ground frames.
    #[must_use]
    pub fn source(&self) -> &Arc<Motion> {
        &self.source
    }

    /// Returns the contacts of the feet.
    #[must_use]
    pub fn contacts(&self) -> &Contacts {
        &self.contacts
    }
}

/// Returns the rotation vector of the step from one local rotation to the next, radians, in the
/// parent's frame.
pub(super) fn turn(from: Quat, to: Quat) -> Vec3 {
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

fn slides(clip: &Clip, roles: &Roles) -> [Vec<f32>; 2] {
    let points = Side::BOTH.map(|side| roles.foot_points(clip.skeleton(), side));
    let mut slides = [Vec::with_capacity(clip.frames()), Vec::with_capacity(clip.frames())];
    let mut before: [Vec<Vec3>; 2] = Default::default();
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
