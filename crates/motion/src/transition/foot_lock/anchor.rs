//! The corrections of the positions and headings of feet, planted and swinging.

use super::FootLockOptions;
use super::envelope::{largest_around, smoothed};
use crate::clip::{Clip, stillest_step};
use crate::math::{Decay, curve, stats, wrap_angle};
use crate::skeleton::{self, Roles, WorldPose};
use glam::{Quat, Vec3};
use std::ops::Range;

/// Stances with less than this between them are merged, seconds and metres: a foot is not lifted
/// and set down again in so short a time, or so near.
const MIN_SWING_SECS: f64 = 0.14;
const MIN_SWING_M: f32 = 0.05;
/// Speed below which a foot counts as still when its position is chosen, metres per second.
const STILL_MPS: f32 = 0.05;
/// Time to either side over which a foot that is lifted out of the ground is lifted smoothly,
/// seconds.
const LIFT_SECS: f64 = 0.06;

/// A foot is swinging fully above this speed, metres per second, and not at all below
/// [`SLOW_STEP_MPS`].
const FULL_SWING_MPS: f32 = 1.2;
const SLOW_STEP_MPS: f32 = 0.5;

/// The greatest duration of a swing from one stance to the next, seconds.
const MAX_SWING_SECS: f64 = 1.5;

/// The greatest rotation of a foot against its leg to keep its heading, radians: 30°. From half of
/// it on the foot turns with the body more and more.
const MAX_TURN_RADIANS: f32 = 0.52;

/// The track of one foot through the clip.
#[derive(Debug)]
pub(crate) struct Foot {
    ankle: usize,
    points: Vec<(usize, Vec3)>,
    /// World positions of the ankle, frame by frame.
    ankles: Vec<Vec3>,
    /// World positions of the points, frame by frame.
    track: Vec<Vec3>,
}

impl Foot {
    pub(super) fn new(clip: &Clip, roles: &Roles, foot: skeleton::Foot, ankle: usize) -> Self {
        let points = roles.foot_points(clip.skeleton(), foot);
        Self {
            ankle,
            ankles: Vec::with_capacity(clip.frames()),
            track: Vec::with_capacity(points.len() * clip.frames()),
            points,
        }
    }

    /// Returns a foot that moves as given: the positions of the ankle, and, frame by frame, those
    /// of the points.
    pub(crate) fn moving(ankles: Vec<Vec3>, points: usize, track: Vec<Vec3>) -> Self {
        // Only the number of points is used once they are placed.
        Self { ankle: 0, points: vec![(0, Vec3::ZERO); points], ankles, track }
    }

    pub(super) fn push(&mut self, world: &WorldPose) {
        self.ankles.push(world.positions[self.ankle]);
        self.track.extend(self.points.iter().map(|&(joint, point)| world.point(joint, point)));
    }

    fn at(&self, frame: usize) -> &[Vec3] {
        let count = self.points.len();
        self.track.get(frame * count..(frame + 1) * count).unwrap_or(&[])
    }

    /// Returns the rotation of the foot about the vertical in every frame, as rotation vectors,
    /// that keeps its heading in these stances although the body was turned by `body_yaws` radians.
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

    /// Returns this foot, rotated about its ankle in every frame.
    pub(super) fn turned(&self, turns: &[Vec3]) -> Self {
        let ways = self.track.chunks(self.points.len().max(1)).zip(self.ankles.iter().zip(turns));
        let turned = ways.flat_map(|(points, (&ankle, &turn))| {
            let rotation = Quat::from_scaled_axis(turn);
            points.iter().map(move |&point| ankle + rotation * (point - ankle))
        });
        Self {
            ankle: self.ankle,
            points: self.points.clone(),
            ankles: self.ankles.clone(),
            track: turned.collect(),
        }
    }

    /// Returns the correction of the foot's position in every frame, metres; the stances are
    /// [`merged`](Self::merged).
    pub(crate) fn shifts(
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
            self.raise_swings(stances, fps, scale, clearance_m, &mut shifts);
        }
        shifts
    }

    /// Raises the foot, where it swings from one stance to the next, above the height that each of
    /// its points has in these; before the first stance and after the last one above the height in
    /// that stance.
    fn raise_swings(
        &self,
        stances: &[Range<usize>],
        fps: f64,
        scale: f32,
        clearance_m: f32,
        shifts: &mut [Vec3],
    ) {
        let longest = (MAX_SWING_SECS * fps) as usize;
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
                let swings =
                    curve::smoothstep((speed - SLOW_STEP_MPS) / (FULL_SWING_MPS - SLOW_STEP_MPS));
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

    /// Returns the usual height of each point in a stance.
    fn levels(&self, stance: &Range<usize>, shifts: &[Vec3]) -> Vec<f32> {
        let level = |point: usize| {
            let heights: Vec<f32> =
                stance.clone().map(|frame| self.at(frame)[point].y + shifts[frame].y).collect();
            stats::percentile(&heights, 0.5).unwrap_or(f32::NEG_INFINITY)
        };
        (0..self.points.len()).map(level).collect()
    }

    /// Merges stances with a short time between them. Where the foot moves far in that time it
    /// needs longer: both stances are shortened.
    pub(crate) fn merged(
        &self,
        stances: &[Range<usize>],
        fps: f64,
        scale: f32,
    ) -> Vec<Range<usize>> {
        let shortest = (MIN_SWING_SECS * fps).round() as usize;
        let mut merged: Vec<Range<usize>> = Vec::with_capacity(stances.len());
        for stance in stances {
            let mut stance = stance.clone();
            if let Some(last) = merged.last_mut()
                && stance.start < last.end + shortest
            {
                if self.drift(last.end..stance.start + 1).length() < MIN_SWING_M * scale {
                    last.end = stance.end;
                    continue;
                }
                let missing = last.end + shortest - stance.start;
                last.end -= (missing / 2).min(last.len() / 2);
                stance.start += missing.div_ceil(2).min(stance.len() / 2);
            }
            merged.push(stance);
        }
        merged
    }

    /// Returns the sum of the steps of the stillest points into these frames.
    fn drift(&self, frames: Range<usize>) -> Vec3 {
        frames.map(|frame| self.step_into(frame)).sum()
    }

    fn step_into(&self, frame: usize) -> Vec3 {
        let before = frame.checked_sub(1).map_or(&[][..], |before| self.at(before));
        stillest_step(before, self.at(frame)).unwrap_or(Vec3::ZERO)
    }

    /// Computes the corrections of one stance.
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

/// Lets the corrections of the stances decay from their own velocity before and after them.
fn fade_around(stances: &[Range<usize>], blend_secs: f64, fps: f64, values: &mut [Vec3]) {
    for (index, stance) in stances.iter().enumerate() {
        let next = stances.get(index + 1).map(|next| next.start);
        let before =
            index.checked_sub(1).and_then(|before| stances.get(before)).map(|before| before.end);
        let last = stance.end - 1;
        // Backwards in time before the stance, forwards after it. The steps next to the stance give
        // the velocity.
        let inside = |frame: usize| values[frame.clamp(stance.start, last)];
        let into = (inside(stance.start), inside(stance.start) - inside(stance.start + 1));
        let out = (inside(last), inside(last) - inside(last.saturating_sub(1)));
        // It reaches 0 by the next stance; at an end of the clip it is cut off.
        let within = |frames: usize| blend_secs.min((frames + 1) as f64 / fps);
        let into_secs = before.map_or(blend_secs, |before| within(stance.start - before));
        fade(into, into_secs, fps, values[before.unwrap_or(0)..stance.start].iter_mut().rev());
        let out_secs = next.map_or(blend_secs, |next| within(next - stance.end));
        let end = next.unwrap_or(values.len());
        fade(out, out_secs, fps, values[stance.end..end].iter_mut());
    }
}

/// Adds a value that decays from its own velocity `step` to the adjacent frames.
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
