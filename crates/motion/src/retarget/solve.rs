//! The solution: hips and limbs for the places of feet and hands.

use super::tracks::{LimbTrack, Tracks};
use super::{Task, feet, hands};
use crate::clip::{Clip, ClipError};
use crate::transition::{Flexion, LimbPose, hips};
use glam::{Quat, Vec3};
use std::sync::Arc;

/// The flexions of knees and elbows: from 2° to 155°.
pub(super) const LIMITS: Flexion = Flexion { least: 0.035, most: 2.7 };

/// The places of feet and hands at full weight, metres; empty for limbs that one of the bodies
/// lacks.
#[derive(Debug, Default)]
pub(super) struct Goals {
    /// The ankles, in the world.
    pub(super) feet: [Vec<Vec3>; 2],
    /// The wrists, from their shoulder joints.
    pub(super) hands: [Vec<Vec3>; 2],
}

/// The solved clip, with the goals and the tracks from which its errors are measured.
pub(super) struct Solved {
    pub(super) clip: Clip,
    pub(super) goals: Goals,
    pub(super) tracks: Tracks,
}

/// Returns the clip with feet and hands at their places.
pub(super) fn solve(task: &Task) -> Result<Solved, ClipError> {
    let tracks = Tracks::of(task);
    let (feet, mut hand_shifts) = (feet::goals(task, &tracks), hands::shifts(&tracks));
    let goals = goals(&tracks, &feet, &hand_shifts);
    let (mut foot_shifts, weights) = (feet.shifts, task.options);
    let frames = task.plain.frames();
    let legs = tracks.legs.iter().filter(|leg| leg.is_some()).count().max(1);
    let given = (0..2).filter(|&side| tracks.legs[side].is_some());
    let rise = feet.rise * given.map(|side| weights.feet[side]).sum::<f32>() / legs as f32;
    for (shifts, weight) in foot_shifts.iter_mut().zip(weights.feet) {
        for shift in shifts {
            // The body is raised by `rise` only, so that the rest is left to this leg.
            *shift = (*shift + Vec3::Y * feet.rise) * weight - Vec3::Y * rise;
        }
    }
    for (shifts, weight) in hand_shifts.iter_mut().zip(weights.hands) {
        for shift in shifts {
            *shift *= weight;
        }
    }
    let heights = if weights.feet == [0.0; 2] {
        vec![0.0; frames]
    } else {
        let (posed, shifts): (Vec<Vec<LimbPose>>, Vec<Vec<Vec3>>) = (0..2)
            .filter_map(|side| {
                let (leg, _) = tracks.legs[side].as_ref()?;
                Some((leg.posed.clone(), foot_shifts[side].clone()))
            })
            .unzip();
        let mut heights = hips::heights(&posed, &shifts, task.plain.fps());
        heights.resize(frames, 0.0);
        heights
    };
    let mut rotations: Vec<Quat> =
        (0..frames).flat_map(|frame| task.plain.rotations(frame)).copied().collect();
    let joints = task.target.skeleton.len();
    let legs = (tracks.legs.iter().flatten().map(|(leg, _)| leg)).zip(
        (0..2)
            .filter(|&side| tracks.legs[side].is_some())
            .map(|side| (&foot_shifts[side], weights.feet[side], 1.0)),
    );
    let arms = (tracks.arms.iter().flatten()).zip(
        (0..2)
            .filter(|&side| tracks.arms[side].is_some())
            .map(|side| (&hand_shifts[side], weights.hands[side], 0.0)),
    );
    for (track, (shifts, weight, with_hips)) in legs.chain(arms) {
        if weight > 0.0 {
            for (frame, local) in rotations.chunks_exact_mut(joints).enumerate() {
                let shift = shifts[frame] - Vec3::Y * (heights[frame] * with_hips);
                turn(track, frame, shift, local);
            }
        }
    }
    let roots = task.plain.root_translations().iter().zip(&heights);
    let roots = roots.map(|(root, height)| *root + Vec3::Y * (rise + height)).collect();
    let skeleton = Arc::clone(task.target.skeleton);
    let made = Clip::new(task.plain.name(), skeleton, task.plain.fps(), rotations, roots)?;
    let clip = made.with_provenance(task.plain.provenance());
    Ok(Solved { clip, goals, tracks })
}

/// Writes the rotations that move the end of a limb by `shift` relative to its start.
fn turn(track: &LimbTrack, frame: usize, shift: Vec3, local: &mut [Quat]) {
    let posed = &track.posed[frame];
    let [upper, lower] = posed.solved(shift, track.axis, LIMITS);
    track.limb.write(posed, [upper, lower, Quat::IDENTITY], local);
}

fn goals(tracks: &Tracks, feet: &feet::FootGoals, hand_shifts: &[Vec<Vec3>; 2]) -> Goals {
    let foot = |side: usize| {
        let Some((leg, _)) = &tracks.legs[side] else { return Vec::new() };
        let ends = leg.starts.iter().zip(&leg.posed).zip(&feet.shifts[side]);
        let raised = Vec3::Y * feet.rise;
        ends.map(|((start, pose), shift)| *start + pose.line() + *shift + raised).collect()
    };
    let hand = |side: usize| {
        let Some(arm) = &tracks.arms[side] else { return Vec::new() };
        arm.posed.iter().zip(&hand_shifts[side]).map(|(pose, shift)| pose.line() + *shift).collect()
    };
    Goals { feet: [foot(0), foot(1)], hands: [hand(0), hand(1)] }
}
