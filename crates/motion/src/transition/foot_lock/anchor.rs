//! Where a planted foot belongs.

use super::FootLockOptions;
use super::envelope::{largest_around, smoothed};
use crate::clip::{Clip, stillest_step};
use crate::math::{Decay, curve, stats, wrap_angle};
use crate::skeleton::{Roles, Side, WorldPose};
use glam::{Quat, Vec3};
use std::ops::Range;

/// Stances with less than this between them are one, seconds and metres: the foot is not lifted and
/// set down again in so short a time, or so near.
const SHORTEST_SWING_SECS: f64 = 0.14;
const SHORTEST_SWING_M: f32 = 0.05;
/// Below this speed a foot is as good as still when its place is chosen, metres per second.
const STILL_MPS: f32 = 0.05;
/// A foot that is lifted out of the ground is lifted smoothly over this time to either side,
/// seconds.
const LIFT_SECS: f64 = 0.06;

/// A foot swings at the full above this speed, metres per second, and not at all below
/// [`STEPS_MPS`].
const SWINGS_MPS: f32 = 1.2;
const STEPS_MPS: f32 = 0.5;

/// What takes longer is no swing from one stance to the next, seconds.
const LONGEST_SWING_SECS: f64 = 1.5;

/// How far a foot is turned against its leg to keep its heading, radians: 30°. From half of it on
/// it turns with the body more and more.
const MAX_TURN_RADIANS: f32 = 0.52;

/// The way of one foot through the clip.
#[derive(Debug)]
pub(super) struct Foot {
    ankle: usize,
    points: Vec<(usize, Vec3)>,
    /// World positions of the ankle, frame by frame.
    ankles: Vec<Vec3>,
    /// World positions of the points, frame by frame.
    way: Vec<Vec3>,
}

impl Foot {
    pub(super) fn new(clip: &Clip, roles: &Roles, side: Side, ankle: usize) -> Self {
        let points = roles.foot_points(clip.skeleton(), side);
        Self {
            ankle,
            ankles: Vec::with_capacity(clip.frames()),
            way: Vec::with_capacity(points.len() * clip.frames()),
            points,
        }
    }

    pub(super) fn push(&mut self, world: &WorldPose) {
        self.ankles.push(world.positions[self.ankle]);
        self.way.extend(self.points.iter().map(|&(joint, point)| world.point(joint, point)));
    }

    fn at(&self, frame: usize) -> &[Vec3] {
        let count = self.points.len();
        self.way.get(frame * count..(frame + 1) * count).unwrap_or(&[])
    }

    /// By how much the foot is turned about the vertical in every frame, as rotation vectors, so
    /// that it keeps its heading in these stances although the body was turned by so many radians.
    /// The mean of a stance stays.
    pub(super) fn turns(
        &self,
        stances: &[Range<usize>],
        body_yaws: &[f64],
        fps: f64,
        options: &FootLockOptions,
    ) -> Vec<Vec3> {
        let mut turns = vec![Vec3::ZERO; self.ankles.len()];
        for stance in stances {
            let Some(&first) = body_yaws.get(stance.start) else {
                continue;
            };
            let mut yaw = first;
            let yaws: Vec<f64> = (body_yaws.iter().skip(stance.start).take(stance.len()))
                .map(|&next| {
                    yaw += wrap_angle(next - yaw);
                    yaw
                })
                .collect();
            let mean = yaws.iter().sum::<f64>() / yaws.len() as f64;
            for (turn, yaw) in turns[stance.clone()].iter_mut().zip(yaws) {
                let back = (mean - yaw) as f32;
                turn.y = curve::soft_limit(back.abs(), 0.5 * MAX_TURN_RADIANS, MAX_TURN_RADIANS)
                    .copysign(back);
            }
        }
        fade_around(stances, options.blend_secs, fps, &mut turns);
        turns
    }

    /// This foot, turned about its ankle in every frame.
    pub(super) fn turned(&self, turns: &[Vec3]) -> Self {
        let ways = self.way.chunks(self.points.len().max(1)).zip(self.ankles.iter().zip(turns));
        let turned = ways.flat_map(|(points, (&ankle, &turn))| {
            let rotation = Quat::from_scaled_axis(turn);
            points.iter().map(move |&point| ankle + rotation * (point - ankle))
        });
        Self {
            ankle: self.ankle,
            points: self.points.clone(),
            ankles: self.ankles.clone(),
            way: turned.collect(),
        }
    }

    /// What is added to the foot's place in every frame, metres; the stances are
    /// [`parted`](Self::parted).
    pub(super) fn shifts(
        &self,
        stances: &[Range<usize>],
        fps: f64,
        scale: f32,
        options: &FootLockOptions,
    ) -> Vec<Vec3> {
        let mut shifts = vec![Vec3::ZERO; self.ankles.len()];
        for stance in stances {
            self.hold(stance, fps, scale, options, &mut shifts);
        }
        fade_around(stances, options.blend_secs, fps, &mut shifts);
        if let Some(clearance_m) = options.clearance_m {
            self.clear(stances, fps, scale, clearance_m, &mut shifts);
        }
        shifts
    }

    /// Lifts the foot, where it swings from one stance to the next, over the height that each of
    /// its points has in these; before the first stance and behind the last one over the height
    /// that it has there.
    fn clear(
        &self,
        stances: &[Range<usize>],
        fps: f64,
        scale: f32,
        clearance_m: f32,
        shifts: &mut [Vec3],
    ) {
        let longest = (LONGEST_SWING_SECS * fps) as usize;
        let reach = ((LIFT_SECS * fps).round() as usize).max(1);
        for next in 0..=stances.len() {
            let (before, behind) =
                (next.checked_sub(1).and_then(|before| stances.get(before)), stances.get(next));
            let swing = before.map_or(0, |before| before.end)
                ..behind.map_or(shifts.len(), |behind| behind.start);
            let Some(levels) =
                before.or(behind).zip(behind.or(before)).filter(|_| swing.len() <= longest)
            else {
                continue;
            };
            let levels = [levels.0, levels.1].map(|stance| self.levels(stance, shifts));
            let missing = |frame: usize| {
                let speed = self.step_into(frame).length() * fps as f32 / scale;
                let swings = curve::smoothstep((speed - STEPS_MPS) / (SWINGS_MPS - STEPS_MPS));
                let part = (frame + 1 - swing.start) as f32 / (swing.len() + 1) as f32;
                let missing = self.at(frame).iter().enumerate().map(|(point, place)| {
                    let [from, to] = [levels[0][point], levels[1][point]];
                    from + (to - from) * part + clearance_m * scale - place.y - shifts[frame].y
                });
                swings * missing.fold(0.0, f32::max)
            };
            let lifts: Vec<f32> = swing.clone().map(missing).collect();
            if lifts.iter().all(|&lift| lift == 0.0) {
                continue;
            }
            let lifts = smoothed(&largest_around(&lifts, reach), reach);
            for (index, lift) in lifts.into_iter().enumerate() {
                // It leaves the ground smoothly, and comes down on time.
                let up = before.map_or(usize::MAX, |_| index + 1);
                let down = behind.map_or(usize::MAX, |_| swing.len() - index);
                let near = up.min(down).min(2 * reach) as f32 / (2 * reach) as f32;
                shifts[swing.start + index].y += lift * curve::smoothstep(near);
            }
        }
    }

    /// The height that each point has as a rule in a stance.
    fn levels(&self, stance: &Range<usize>, shifts: &[Vec3]) -> Vec<f32> {
        let level = |point: usize| {
            let heights: Vec<f32> =
                stance.clone().map(|frame| self.at(frame)[point].y + shifts[frame].y).collect();
            stats::percentile(&heights, 0.5).unwrap_or(f32::NEG_INFINITY)
        };
        (0..self.points.len()).map(level).collect()
    }

    /// Stances with next to nothing between them as one. Where the foot goes far in so short a time
    /// it needs longer: both stances give up frames.
    pub(super) fn parted(
        &self,
        stances: &[Range<usize>],
        fps: f64,
        scale: f32,
    ) -> Vec<Range<usize>> {
        let shortest = (SHORTEST_SWING_SECS * fps).round() as usize;
        let mut parted: Vec<Range<usize>> = Vec::with_capacity(stances.len());
        for stance in stances {
            let mut stance = stance.clone();
            if let Some(last) = parted.last_mut()
                && stance.start < last.end + shortest
            {
                if self.drift(last.end..stance.start + 1).length() < SHORTEST_SWING_M * scale {
                    last.end = stance.end;
                    continue;
                }
                let missing = last.end + shortest - stance.start;
                last.end -= (missing / 2).min(last.len() / 2);
                stance.start += missing.div_ceil(2).min(stance.len() / 2);
            }
            parted.push(stance);
        }
        parted
    }

    /// What the stillest points slide in the steps into these frames.
    fn drift(&self, frames: Range<usize>) -> Vec3 {
        frames.map(|frame| self.step_into(frame)).sum()
    }

    fn step_into(&self, frame: usize) -> Vec3 {
        let before = frame.checked_sub(1).map_or(&[][..], |before| self.at(before));
        stillest_step(before, self.at(frame)).unwrap_or(Vec3::ZERO)
    }

    /// The shifts of one stance.
    fn hold(
        &self,
        stance: &Range<usize>,
        fps: f64,
        scale: f32,
        options: &FootLockOptions,
        shifts: &mut [Vec3],
    ) {
        let still = STILL_MPS * scale / fps as f32;
        let (mut drift, mut sum, mut weights) = (Vec3::ZERO, Vec3::ZERO, 0.0);
        let mut before = Vec3::ZERO;
        for frame in stance.clone() {
            let step = if frame > stance.start { self.step_into(frame) } else { Vec3::ZERO };
            drift += step;
            shifts[frame] = -drift;
            // A frame is as still as the steps on both sides of it; the first has no step before
            // it.
            let weight =
                (still * still + before.length_squared().max(step.length_squared())).recip();
            if frame > stance.start || stance.len() == 1 {
                sum += drift * weight;
                weights += weight;
            }
            before = step;
        }
        let place = sum / weights.max(f32::MIN_POSITIVE);
        let most = options.max_shift_m * scale;
        for frame in stance.clone() {
            let shift = shifts[frame] + place;
            let length = shift.length();
            let limited = if length > 0.0 {
                curve::soft_limit(length, 0.5 * most, most) / length
            } else {
                1.0
            };
            shifts[frame] = shift * limited;
        }
        let Some(ground) = options.ground_m else {
            return;
        };
        let depth = |frame: usize| {
            let lowest = self.at(frame).iter().map(|point| point.y).fold(f32::INFINITY, f32::min);
            (ground - lowest).max(0.0)
        };
        let depths: Vec<f32> = stance.clone().map(depth).collect();
        if depths.iter().all(|&depth| depth == 0.0) {
            return;
        }
        // A toe that dips for one frame must not kick the leg.
        let reach = ((LIFT_SECS * fps).round() as usize).max(1);
        let lifts = smoothed(&largest_around(&depths, reach), reach);
        for (shift, lift) in shifts[stance.clone()].iter_mut().zip(lifts) {
            shift.y = lift;
        }
    }
}

/// Lets what is done in the stances die away with its own velocity before and behind them.
fn fade_around(stances: &[Range<usize>], blend_secs: f64, fps: f64, values: &mut [Vec3]) {
    for (index, stance) in stances.iter().enumerate() {
        let next = stances.get(index + 1).map(|next| next.start);
        let before =
            index.checked_sub(1).and_then(|before| stances.get(before)).map(|before| before.end);
        let last = stance.end - 1;
        // Backwards in time before the stance, forwards behind it. The steps next to the stance
        // tell the velocity.
        let inside = |frame: usize| values[frame.clamp(stance.start, last)];
        let into = (inside(stance.start), inside(stance.start) - inside(stance.start + 1));
        let out = (inside(last), inside(last) - inside(last.saturating_sub(1)));
        // By the next stance all of it is gone; at an end of the clip it is cut off.
        let within = |frames: usize| blend_secs.min((frames + 1) as f64 / fps);
        let into_secs = before.map_or(blend_secs, |before| within(stance.start - before));
        fade(into, into_secs, fps, values[before.unwrap_or(0)..stance.start].iter_mut().rev());
        let out_secs = next.map_or(blend_secs, |next| within(next - stance.end));
        let end = next.unwrap_or(values.len());
        fade(out, out_secs, fps, values[stance.end..end].iter_mut());
    }
}

/// Adds what dies away from a value and its step into the frames behind it.
fn fade<'a>(
    (value, step): (Vec3, Vec3),
    blend_secs: f64,
    fps: f64,
    frames: impl Iterator<Item = &'a mut Vec3>,
) {
    let decay = Decay::Cubic { blend_secs };
    for (index, frame) in frames.enumerate() {
        let secs = (index + 1) as f64 / fps;
        if secs >= blend_secs {
            break;
        }
        *frame += decay.of_vec3(value, step * fps as f32, secs).0;
    }
}
