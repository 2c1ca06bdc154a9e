//! Faults that planted feet show: a drift of the body, ground at a wrong height, skating.

use super::fault::{Fault, FaultKind, Form, SizeUnit, confidence};
use super::mend::levelled;
use crate::clip::{Clip, Contacts, Motion, estimate_ground, stillest_point};
use crate::math::stats;
use crate::metrics::foot_slides;
use crate::registration::REFERENCE_HEIGHT_M;
use crate::skeleton::{Foot, Roles, WorldPose};
use glam::{DVec2, Vec3};

/// The least slide of a foot in a stance, centimetres.
const MIN_SLIDE_CM: f32 = 2.0;
/// The least drift: centimetres and degrees per second; and the most, above which the body moves in
/// place instead.
const DRIFT_CMPS: [f32; 2] = [2.5, 15.0];
const TURN_DPS: [f32; 2] = [1.5, 15.0];
/// The least rise of the ground over a take, metres, and the fewest stances that show it.
const MIN_RISE_M: f32 = 0.04;
const MIN_STANCES: usize = 4;
/// The most stances that are compared pair by pair.
const MAX_STANCES: usize = 200;

/// The stances of a motion: where the feet stand, and how they move.
#[derive(Debug, Default)]
struct Stance {
    /// The index of the foot.
    foot: usize,
    /// The middle, seconds.
    secs: f64,
    /// The height of the lowest point, metres.
    height_m: f32,
    /// The velocity of the point that stands stillest, (x, z) in metres per second, and its place.
    velocity: DVec2,
    place: DVec2,
    /// The turn rate of the foot about the vertical, radians per second.
    turn_rps: f64,
}

/// Returns the median; 0 of nothing.
fn median(values: &[f64]) -> f64 {
    stats::median(values).unwrap_or(0.0)
}

/// Returns the height of a body as a share of the one to which lengths apply.
fn relative_height(height_m: f32) -> f32 {
    height_m / REFERENCE_HEIGHT_M as f32
}

fn stances(motion: &Motion) -> Vec<Stance> {
    let (clip, roles) = (motion.clip(), motion.roles());
    let fps = clip.fps();
    let mut found = Vec::new();
    let mut world = WorldPose::default();
    for &foot in motion.contacts().feet() {
        let points = roles.foot_points(clip.skeleton(), foot);
        let needed = clip.skeleton().with_ancestors(points.iter().map(|&(joint, _)| joint));
        let Some(&(ankle, _)) = points.first() else {
            continue;
        };
        for frames in motion.contacts().intervals(foot) {
            // The first and last frames of a stance roll: the rest stands.
            let edge = frames.len() / 4;
            let inner = frames.start + edge..frames.end - edge;
            if inner.len() < 3 {
                continue;
            }
            let (mut heights, mut x, mut z, mut turns) = (vec![], vec![], vec![], vec![]);
            let (mut px, mut pz) = (vec![], vec![]);
            let mut before: Option<(Vec<Vec3>, f64)> = None;
            for frame in inner.clone() {
                clip.world_pose_of(frame, &needed, &mut world);
                let now: Vec<Vec3> =
                    points.iter().map(|&(joint, point)| world.point(joint, point)).collect();
                heights.extend(now.iter().map(|p| f64::from(p.y)).min_by(f64::total_cmp));
                let yaw = yaw_of(&world, ankle);
                if let Some((last, last_yaw)) = before {
                    if let Some((point, step)) = stillest_point(&last, &now) {
                        x.push(f64::from(step.x) * fps);
                        z.push(f64::from(step.z) * fps);
                        px.push(f64::from(now[point].x));
                        pz.push(f64::from(now[point].z));
                    }
                    turns.push(crate::math::wrap_angle(yaw - last_yaw) * fps);
                }
                before = Some((now, yaw));
            }
            found.push(Stance {
                foot: foot.index(),
                secs: (inner.start + inner.end) as f64 / 2.0 / fps,
                height_m: median(&heights) as f32,
                velocity: DVec2::new(median(&x), median(&z)),
                place: DVec2::new(median(&px), median(&pz)),
                turn_rps: median(&turns),
            });
        }
    }
    found
}

/// Returns the turn of a joint about the vertical, radians: the twist of its rotation about Y.
fn yaw_of(world: &WorldPose, joint: usize) -> f64 {
    let q = world.rotations[joint];
    2.0 * libm::atan2(f64::from(q.y), f64::from(q.w))
}

/// Returns a drift that most stances share.
pub(super) fn drift(motion: &Motion) -> Option<Fault> {
    let stances = stances(motion);
    let clip = motion.clip();
    let frames = 0..clip.frames();
    let scale = relative_height(motion.body_height());
    let feet = motion.contacts().feet();
    let planted: f64 = feet
        .iter()
        .flat_map(|&foot| motion.contacts().intervals(foot))
        .map(|stance| stance.len() as f64 / clip.fps())
        .sum();
    if planted < 1.0 {
        return None;
    }
    let turn_of = |foot: &Foot| {
        let of_foot = stances.iter().filter(|s| s.foot == foot.index());
        median(&of_foot.map(|s| s.turn_rps).collect::<Vec<_>>())
    };
    let turn = median(&stances.iter().map(|s| s.turn_rps).collect::<Vec<_>>());
    let spread = median(&stances.iter().map(|s| (s.turn_rps - turn).abs()).collect::<Vec<_>>());
    let agrees =
        (feet.iter().map(turn_of)).all(|own| own * turn > 0.0 && (own / turn - 1.0).abs() < 0.5);
    let turn_dps = turn.to_degrees().abs() as f32;
    let turns = agrees && spread < 0.35 * turn.abs() && is_between(turn_dps, TURN_DPS);
    let turn_rps = if turns { turn } else { 0.0 };
    let rest = |s: &Stance| s.velocity - turn_rps * DVec2::new(s.place.y, -s.place.x);
    let velocity = DVec2::new(
        median(&stances.iter().map(|s| rest(s).x).collect::<Vec<_>>()),
        median(&stances.iter().map(|s| rest(s).y).collect::<Vec<_>>()),
    );
    let off = median(&stances.iter().map(|s| (rest(s) - velocity).length()).collect::<Vec<_>>());
    let cmps = velocity.length() as f32 * 100.0 / scale;
    let moves = off < 0.35 * velocity.length() && is_between(cmps, DRIFT_CMPS);
    if turns {
        let form = Form::Drift { velocity_mps: velocity, turn_rps };
        let sure = confidence(turn_dps, TURN_DPS[0] * 1.3);
        let size = (turn_dps, SizeUnit::DegreesPerSecond);
        return Some(Fault::of_body(FaultKind::Drift, frames, form, size, sure));
    }
    moves.then(|| {
        let form = Form::Drift { velocity_mps: velocity, turn_rps: 0.0 };
        let size = (cmps * scale, SizeUnit::CentimetresPerSecond);
        let sure = confidence(cmps, DRIFT_CMPS[0] * 1.8);
        Fault::of_body(FaultKind::Drift, frames, form, size, sure)
    })
}

fn is_between(value: f32, [least, most]: [f32; 2]) -> bool {
    (least..most).contains(&value)
}

/// Returns ground that is not at height 0, or that rises evenly. Unchanged where the user has set
/// the height of the ground.
pub(super) fn ground(motion: &Motion) -> Option<Fault> {
    if motion.feet().ground_m.is_some() {
        return None;
    }
    let clip = motion.clip();
    let scale = relative_height(motion.body_height());
    let rise_mps = rise(&stances(motion), clip, scale);
    let flat = if rise_mps == 0.0 { None } else { Some(levelled(clip, 0.0, rise_mps)) };
    let flat_clip: &Clip = flat.as_ref().unwrap_or(clip);
    let from_m = match &flat {
        None => motion.ground_m(),
        Some(flat) => estimate_ground(flat, motion.roles(), motion.contacts()),
    };
    let rise_m = rise_mps * flat_clip.duration_secs() as f32;
    let worst_m = from_m.abs().max((from_m + rise_m).abs());
    (from_m != 0.0 || rise_mps != 0.0).then(|| {
        let form = Form::Level { from_m, rise_mps };
        let size = (worst_m * 100.0, SizeUnit::Centimetres);
        let sure = confidence(worst_m / scale, 0.025);
        Fault::of_body(FaultKind::Ground, 0..clip.frames(), form, size, sure)
    })
}

/// Returns the slope of the ground under the stances, metres per second: the median of the slopes
/// of all pairs (Theil 1950, Sen 1968). 0 where it is small, or where the heights do not follow it.
fn rise(stances: &[Stance], clip: &Clip, scale: f32) -> f32 {
    let stride = stances.len().div_ceil(MAX_STANCES).max(1);
    let some: Vec<&Stance> = stances.iter().step_by(stride).collect();
    if some.len() < MIN_STANCES {
        return 0.0;
    }
    let mut slopes = Vec::with_capacity(some.len() * some.len() / 2);
    for (at, a) in some.iter().enumerate() {
        let later = some[at + 1..].iter().filter(|b| (b.secs - a.secs).abs() > 0.2);
        slopes.extend(later.map(|b| f64::from(b.height_m - a.height_m) / (b.secs - a.secs)));
    }
    let slope = median(&slopes);
    let level =
        median(&some.iter().map(|s| f64::from(s.height_m) - slope * s.secs).collect::<Vec<_>>());
    let off = |s: &&Stance| (f64::from(s.height_m) - level - slope * s.secs).abs();
    let spread = median(&some.iter().map(off).collect::<Vec<_>>());
    let whole = slope.abs() * clip.duration_secs();
    if whole > f64::from(MIN_RISE_M * scale) && spread < 0.1 * whole { slope as f32 } else { 0.0 }
}

/// Returns the stances in which a foot slides.
pub(super) fn skating(clip: &Clip, roles: &Roles, contacts: &Contacts) -> Vec<Fault> {
    let scale = relative_height(roles.body_height(clip.skeleton()));
    let mut found = Vec::new();
    for stance in foot_slides(clip, roles, contacts) {
        let cm = stance.slide_cm as f32;
        if cm > MIN_SLIDE_CM * scale {
            let form = Form::Slide(stance.foot);
            let size = (cm, SizeUnit::Centimetres);
            let sure = confidence(cm / scale, 3.0);
            let mut fault = Fault::of_body(FaultKind::Skating, stance.frames, form, size, sure);
            let points = roles.foot_points(clip.skeleton(), stance.foot);
            fault.joints = points.first().map(|&(joint, _)| joint).into_iter().collect();
            found.push(fault);
        }
    }
    found
}
