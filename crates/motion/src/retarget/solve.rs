//! The solution: hips and limbs for the places of feet and hands.

use super::feet::{FootGoals, place_forefeet};
use super::tracks::{LimbTrack, Tracks};
use super::{Task, hands};
use crate::clip::{Clip, ClipError};
use crate::transition::{Flexion, LimbPose, hips};
use glam::{Quat, Vec3};
use std::ops::Range;
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

/// The solution of all frames: the movements of limbs and hips, and the rotations so far.
#[derive(Debug)]
pub(super) struct Solution {
    pub(super) goals: Goals,
    /// The shifts of the ends of limbs, in proportion to their weights, metres; empty for limbs
    /// that one of the bodies lacks.
    foot_shifts: [Vec<Vec3>; 2],
    hand_shifts: [Vec<Vec3>; 2],
    /// The amount by which the body is raised, and more in each frame, metres.
    rise: f32,
    heights: Vec<f32>,
    rotations: Vec<Quat>,
}

impl Solution {
    /// Finds the movements of limbs and hips.
    pub(super) fn new(task: &Task, tracks: &Tracks, feet: FootGoals) -> Self {
        let foot_goals = foot_goals(tracks, &feet);
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
        let mut hand_shifts = hands::shifts(tracks);
        let rises: Vec<f32> = heights.iter().map(|height| rise + height).collect();
        place_forefeet(task, tracks, &rises, &mut hand_shifts);
        let goals = Goals { feet: foot_goals, hands: hand_goals(tracks, &hand_shifts) };
        for (shifts, weight) in hand_shifts.iter_mut().zip(weights.hands) {
            for shift in shifts {
                *shift *= weight;
            }
        }
        let rotations = Vec::with_capacity(frames * task.target.skeleton.len());
        Self { goals, foot_shifts, hand_shifts, rise, heights, rotations }
    }

    /// Moves the limbs in these frames, which follow those that are done.
    pub(super) fn turn(&mut self, task: &Task, tracks: &Tracks, frames: Range<usize>) {
        for frame in frames {
            let first = self.rotations.len();
            self.rotations.extend_from_slice(task.plain.rotations(frame));
            let local = &mut self.rotations[first..];
            for side in 0..2 {
                if let Some((leg, _)) = &tracks.legs[side]
                    && task.options.feet[side] > 0.0
                {
                    let shift = self.foot_shifts[side][frame] - Vec3::Y * self.heights[frame];
                    turn(leg, frame, shift, local);
                }
                if let Some(arm) = &tracks.arms[side]
                    && task.options.hands[side] > 0.0
                {
                    turn(arm, frame, self.hand_shifts[side][frame], local);
                }
            }
        }
    }

    /// Returns the clip with feet and hands at their places, when all frames are done.
    pub(super) fn clip(&mut self, task: &Task) -> Result<Clip, ClipError> {
        let roots = task.plain.root_translations().iter().zip(&self.heights);
        let roots = roots.map(|(root, height)| *root + Vec3::Y * (self.rise + height)).collect();
        let (skeleton, rotations) =
            (Arc::clone(&task.target.skeleton), std::mem::take(&mut self.rotations));
        let made = Clip::new(task.plain.name(), skeleton, task.plain.fps(), rotations, roots)?;
        Ok(made.with_provenance(task.plain.provenance()))
    }
}

/// Writes the rotations that move the end of a limb by `shift` relative to its start.
fn turn(track: &LimbTrack, frame: usize, shift: Vec3, local: &mut [Quat]) {
    let posed = &track.posed[frame];
    let [upper, lower] = posed.solved(shift, track.axis, LIMITS);
    track.limb.write(posed, [upper, lower, Quat::IDENTITY], local);
}

fn foot_goals(tracks: &Tracks, feet: &FootGoals) -> [Vec<Vec3>; 2] {
    [0, 1].map(|side: usize| {
        let Some((leg, _)) = &tracks.legs[side] else { return Vec::new() };
        let ends = leg.starts.iter().zip(&leg.posed).zip(&feet.shifts[side]);
        let raised = Vec3::Y * feet.rise;
        ends.map(|((start, pose), shift)| *start + pose.line() + *shift + raised).collect()
    })
}

fn hand_goals(tracks: &Tracks, shifts: &[Vec<Vec3>; 2]) -> [Vec<Vec3>; 2] {
    [0, 1].map(|side: usize| {
        let Some(arm) = &tracks.arms[side] else { return Vec::new() };
        arm.posed.iter().zip(&shifts[side]).map(|(pose, shift)| pose.line() + *shift).collect()
    })
}
