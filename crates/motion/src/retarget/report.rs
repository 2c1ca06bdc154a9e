//! The errors that remain after retargeting.

use super::Task;
use super::solve::{Goals, LIMITS};
use super::tracks::Tracks;
use crate::clip::Clip;
use crate::metrics::SlideMeter;
use crate::skeleton::{Foot, WorldPose};
use crate::transition::LimbPose;
use glam::Vec3;
use std::ops::Range;

/// Flexions beyond the limits by less than this count as within them, radians (0.6°).
const TOLERANCE_RADIANS: f32 = 0.01;

/// A quantity of the directions alone, and of the result.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Compared<T> {
    /// That of the bones' directions alone.
    pub directions: T,
    /// That of the result.
    pub result: T,
}

/// The distance between the end of a limb and the place where the source has it, at the scale of
/// the body.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct LimbReach {
    /// The largest distance, centimetres.
    pub worst_cm: f64,
    /// The mean distance, centimetres.
    pub mean_cm: f64,
}

/// The slide of planted feet.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct SkatingValues {
    /// The slide in the worst stance, centimetres.
    pub worst_cm: f64,
    /// The mean slide per stance, centimetres.
    pub mean_cm: f64,
    /// The number of stances.
    pub stances: usize,
}

/// The errors of a retargeted motion, each beside that of the bones' directions alone.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct RetargetErrors {
    /// The left and the right foot; `None` where one of the bodies has no such leg.
    pub feet: [Option<Compared<LimbReach>>; 2],
    /// The left and the right hand, from their shoulders; `None` where one of the bodies has no
    /// such arm.
    pub hands: [Option<Compared<LimbReach>>; 2],
    /// The slide of planted feet ([`foot_slides`]), in the contacts of the source.
    pub skating: Compared<SkatingValues>,
    /// The slide of the source's feet, at its own scale.
    pub source_skating: SkatingValues,
    /// The greatest depth of a point of a foot below the ground, centimetres.
    pub penetration_cm: Compared<f64>,
    /// The number of frames in which a knee or an elbow is bent beyond its limits: backwards, or
    /// by more than 155°. Each limb counts on its own.
    pub beyond_limits: Compared<usize>,
    /// Whether one of the bodies stands on two legs, and the other one on four.
    #[serde(default)]
    pub is_across_plans: bool,
}

/// The measurement of a result in slices.
#[derive(Debug)]
pub(super) struct ErrorMeter {
    /// The slide of the source, of its bones' directions, and of the result.
    slides: [SlideMeter; 3],
    directions: Found,
    result: Found,
    frames: usize,
    is_across_plans: bool,
    /// The ankle, ball and tip of all feet, each as a joint and a point in its frame.
    points: Vec<(usize, Vec3)>,
    needed: Vec<usize>,
}

impl ErrorMeter {
    /// Returns a meter that has measured nothing yet.
    pub(super) fn new(task: &Task, tracks: &Tracks) -> Self {
        let (skeleton, roles) = (&task.target.skeleton, &task.target.roles);
        let feet = Foot::of(roles.body_plan()).iter();
        let points: Vec<_> = feet.flat_map(|foot| roles.foot_points(skeleton, *foot)).collect();
        let limbs = tracks.legs.iter().flatten().map(|(leg, _)| leg);
        let limbs = limbs.chain(tracks.arms.iter().flatten());
        let feet = points.iter().map(|(joint, _)| *joint);
        let needed = limbs.flat_map(|track| track.limb.joints()).chain(feet);
        Self {
            slides: [
                SlideMeter::new(task.source.clip(), task.source.roles()),
                SlideMeter::new(&task.plain, roles),
                SlideMeter::new(&task.plain, roles),
            ],
            directions: Found::default(),
            result: Found::default(),
            frames: 0,
            is_across_plans: task.source.roles().body_plan() != roles.body_plan(),
            needed: skeleton.with_ancestors(needed),
            points,
        }
    }

    /// Measures these frames of the result, which follow those that are measured.
    pub(super) fn measure(
        &mut self,
        task: &Task,
        (tracks, goals): (&Tracks, &Goals),
        solved: &Clip,
        frames: Range<usize>,
    ) {
        let clips = [task.source.clip(), &task.plain, solved];
        for (meter, clip) in self.slides.iter_mut().zip(clips) {
            meter.advance(clip, task.source.contacts(), frames.len());
        }
        let mut world = WorldPose::default();
        for (found, clip) in [(&mut self.directions, &task.plain), (&mut self.result, solved)] {
            for frame in frames.clone() {
                clip.world_pose_of(frame, &self.needed, &mut world);
                found.add(&world, tracks, goals, frame);
                let lowest = (self.points.iter())
                    .map(|&(joint, point)| world.point(joint, point).y)
                    .fold(f32::INFINITY, f32::min);
                found.depth_m = found.depth_m.max(task.ground_m() - lowest);
            }
        }
        self.frames = frames.end;
    }

    /// Returns the errors of the frames that are measured.
    pub(super) fn finish(self, tracks: &Tracks) -> RetargetErrors {
        let [source, directions, result] = self.slides.map(|meter| {
            let slides = meter.finish();
            let slides = || slides.iter().map(|slide| slide.slide_cm);
            let stances = slides().count();
            SkatingValues {
                worst_cm: slides().fold(0.0, f64::max),
                mean_cm: slides().sum::<f64>() / stances.max(1) as f64,
                stances,
            }
        });
        let (before, after) = (&self.directions, &self.result);
        let frames = self.frames.max(1) as f64;
        let reach = |limb: usize| Compared {
            directions: before.reach(limb, frames),
            result: after.reach(limb, frames),
        };
        let cm = |found: &Found| f64::from(found.depth_m) * 100.0;
        RetargetErrors {
            feet: [0, 1].map(|side| tracks.legs[side].is_some().then(|| reach(side))),
            hands: [0, 1].map(|side| tracks.arms[side].is_some().then(|| reach(2 + side))),
            skating: Compared { directions, result },
            source_skating: source,
            penetration_cm: Compared { directions: cm(before), result: cm(after) },
            beyond_limits: Compared {
                directions: before.beyond_limits,
                result: after.beyond_limits,
            },
            is_across_plans: self.is_across_plans,
        }
    }
}

/// The errors of one clip of the target's body.
#[derive(Debug, Default)]
struct Found {
    /// The largest distance from the goal and the sum over all frames, centimetres: feet, then
    /// hands.
    off_cm: [(f64, f64); 4],
    depth_m: f32,
    beyond_limits: usize,
}

impl Found {
    fn reach(&self, limb: usize, frames: f64) -> LimbReach {
        let (worst_cm, sum) = self.off_cm[limb];
        LimbReach { worst_cm, mean_cm: sum / frames }
    }

    fn add(&mut self, world: &WorldPose, tracks: &Tracks, goals: &Goals, frame: usize) {
        let mut off = |at: usize, off: Vec3, pose: &LimbPose, axis: Vec3| {
            let off = f64::from(off.length()) * 100.0;
            let sums = &mut self.off_cm[at];
            *sums = (sums.0.max(off), sums.1 + off);
            let flexion = pose.flexion(axis);
            let allowed = LIMITS.least - TOLERANCE_RADIANS..=LIMITS.most + TOLERANCE_RADIANS;
            self.beyond_limits += usize::from(!allowed.contains(&flexion));
        };
        for side in 0..2 {
            if let Some((leg, _)) = &tracks.legs[side] {
                let place = world.positions[leg.limb.joints()[2]];
                off(side, place - goals.feet[side][frame], &leg.limb.pose(world), leg.axis);
            }
            if let Some(arm) = &tracks.arms[side] {
                let pose = arm.limb.pose(world);
                off(2 + side, pose.line() - goals.hands[side][frame], &pose, arm.axis);
            }
        }
    }
}
