//! The errors that remain after retargeting.

use super::Task;
use super::solve::{LIMITS, Solved};
use crate::clip::Clip;
use crate::metrics::foot_slides;
use crate::skeleton::{Roles, Side, WorldPose};
use crate::transition::LimbPose;
use glam::Vec3;

/// Flexions beyond the limits by less than this count as within them, radians (0.6°).
const TOLERANCE_RADIANS: f32 = 0.01;

/// A quantity of the directions alone, and of the result.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct Compared<T> {
    /// That of the bones' directions alone.
    pub directions: T,
    /// That of the result.
    pub result: T,
}

/// The distance between the end of a limb and the place where the source has it, at the scale of
/// the body.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct LimbReach {
    /// The largest distance, centimetres.
    pub worst_cm: f64,
    /// The mean distance, centimetres.
    pub mean_cm: f64,
}

/// The slide of planted feet.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct SkatingValues {
    /// The slide in the worst stance, centimetres.
    pub worst_cm: f64,
    /// The mean slide per stance, centimetres.
    pub mean_cm: f64,
    /// The number of stances.
    pub stances: usize,
}

/// The errors of a retargeted motion, each beside that of the bones' directions alone.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
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
}

/// Measures a result.
pub(super) fn measure(task: &Task, solved: &Solved) -> RetargetErrors {
    let mut errors = RetargetErrors {
        skating: Compared {
            directions: skating(task.plain, task.target.roles, task),
            result: skating(&solved.clip, task.target.roles, task),
        },
        source_skating: skating(task.source.clip(), task.source.roles(), task),
        ..RetargetErrors::default()
    };
    for (clip, pick) in [(task.plain, false), (&solved.clip, true)] {
        let found = Found::of(task, clip, solved);
        let feet = errors.feet.iter_mut().zip(found.feet);
        for (error, found) in feet.chain(errors.hands.iter_mut().zip(found.hands)) {
            if let Some(found) = found {
                let error = error.get_or_insert_default();
                *if pick { &mut error.result } else { &mut error.directions } = found;
            }
        }
        let (depth, hits) = (f64::from(found.depth_m) * 100.0, found.beyond_limits);
        if pick {
            (errors.penetration_cm.result, errors.beyond_limits.result) = (depth, hits);
        } else {
            (errors.penetration_cm.directions, errors.beyond_limits.directions) = (depth, hits);
        }
    }
    errors
}

fn skating(clip: &Clip, roles: &Roles, task: &Task) -> SkatingValues {
    let slides = foot_slides(clip, roles, task.source.contacts());
    let slides = || slides.iter().map(|slide| slide.slide_cm);
    let stances = slides().count();
    SkatingValues {
        worst_cm: slides().fold(0.0, f64::max),
        mean_cm: slides().sum::<f64>() / stances.max(1) as f64,
        stances,
    }
}

/// The errors of one clip of the target's body.
#[derive(Default)]
struct Found {
    feet: [Option<LimbReach>; 2],
    hands: [Option<LimbReach>; 2],
    depth_m: f32,
    beyond_limits: usize,
}

impl Found {
    fn of(task: &Task, clip: &Clip, solved: &Solved) -> Self {
        let (skeleton, roles) = (task.target.skeleton, task.target.roles);
        let points = Side::BOTH.map(|side| super::foot_points(skeleton, roles, side));
        let (tracks, goals) = (&solved.tracks, &solved.goals);
        let legs = || (0..2).filter_map(|side| Some((side, &tracks.legs[side].as_ref()?.0)));
        let arms = || (0..2).filter_map(|side| Some((side, tracks.arms[side].as_ref()?)));
        let limbs = legs().chain(arms()).flat_map(|(_, track)| track.limb.joints());
        let feet = points.iter().flatten().flatten().map(|(joint, _)| *joint);
        let needed = skeleton.with_ancestors(limbs.chain(feet));
        let ground = task.ground_m();
        let mut found = Self::default();
        let mut sums = [(0.0f64, 0.0f64); 4];
        let mut world = WorldPose::default();
        for frame in 0..clip.frames() {
            clip.world_pose_of(frame, &needed, &mut world);
            let mut add = |at: usize, off: Vec3| {
                let off = f64::from(off.length()) * 100.0;
                sums[at] = (sums[at].0.max(off), sums[at].1 + off);
            };
            let outside = |pose: &LimbPose, axis: Vec3| {
                let flexion = pose.flexion(axis);
                let allowed = LIMITS.least - TOLERANCE_RADIANS..=LIMITS.most + TOLERANCE_RADIANS;
                !allowed.contains(&flexion)
            };
            for (side, track) in legs() {
                let pose = track.limb.pose(&world);
                add(side, world.positions[track.limb.joints()[2]] - goals.feet[side][frame]);
                found.beyond_limits += usize::from(outside(&pose, track.axis));
            }
            for (side, track) in arms() {
                let pose = track.limb.pose(&world);
                add(2 + side, pose.line() - goals.hands[side][frame]);
                found.beyond_limits += usize::from(outside(&pose, track.axis));
            }
            let lowest = (points.iter().flatten().flatten())
                .map(|&(joint, point)| world.point(joint, point).y)
                .fold(f32::INFINITY, f32::min);
            found.depth_m = found.depth_m.max(ground - lowest);
        }
        let frames = clip.frames().max(1) as f64;
        let reach = |(worst_cm, sum): (f64, f64)| LimbReach { worst_cm, mean_cm: sum / frames };
        found.feet = [0, 1].map(|side| tracks.legs[side].is_some().then(|| reach(sums[side])));
        found.hands = [0, 1].map(|side| tracks.arms[side].is_some().then(|| reach(sums[2 + side])));
        found
    }
}
