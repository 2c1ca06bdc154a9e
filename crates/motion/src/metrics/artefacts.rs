//! Artefacts of a motion compared with the clips that it was made from.

use crate::clip::Clip;
use crate::math::sort::sort_by_key;
use crate::math::{stats, wrap_angle};
use crate::skeleton::{self, Role, Roles, Side, WorldPose};
use glam::{Vec2, Vec3};
use std::ops::Range;

mod joints;
mod meter;

pub(super) use joints::{JointTrace, Statistics};
pub use meter::TraceMeter;

/// The height to which lengths are scaled, metres: the median, over the frames, of the height of
/// all joints and end sites.
const BODY_M: f32 = 1.7;
/// The percentile that counts as rare.
const RARE_PERCENTILE: f32 = 0.999;
/// The ratio to the rare speed from which on a speed is an artefact.
const ARTEFACT_RATIO: f32 = 2.0;
/// The least turn of a joint in one frame that counts as a flash, degrees.
const MIN_FLASH_DEG: f32 = 2.0;
/// Flashes with no more frames than this between them count as one.
const MAX_FLASH_GAP_FRAMES: usize = 3;
/// The duration of the windows in which spins are measured, seconds.
pub const SPIN_SECS: f64 = 0.2;
/// The least turn in such a window that counts as a spin, degrees.
const MIN_SPIN_DEG: f32 = 30.0;
/// A foot is low within this height of the 5th percentile of its heights, metres.
const LOW_M: f32 = 0.04;
/// The least duration of a stance, seconds: a low foot at a median speed below [`MAX_STANCE_MPS`].
const MIN_STANCE_SECS: f64 = 0.1;
/// The greatest median speed of a stance, metres per second.
const MAX_STANCE_MPS: f32 = 0.6;
/// Skating is measured below this height above the 2nd percentile of the foot's heights, metres.
const SKATING_M: f32 = 0.025;
/// The factor by which a speed must exceed another to count as higher: less is rounding error.
const SPEED_TOLERANCE: f32 = 1.01;

/// The measurements of a motion that [`Artefacts`] and [`ResultMetrics`](super::ResultMetrics)
/// compare, made once: rotation of its joints, speed of its root, change of its heading, motion of
/// its feet. Lengths are those of a body of 1.7 m.
#[derive(Clone, Debug, PartialEq)]
pub struct MotionTrace {
    pub(super) fps: f64,
    pub(super) joints: Vec<JointTrace>,
    /// Per step: the root's speed, metres per second; its 99.9th percentile, and its maximum.
    root_mps: Vec<f32>,
    rare_mps: f32,
    max_mps: f32,
    /// Per frame: the turn of the hips over the next 0.2 s, degrees.
    turned_deg: Vec<f32>,
    max_turn_deg: f32,
    stances_cm: Vec<f64>,
    skating_cm_per_sec: Option<f64>,
}

impl MotionTrace {
    /// Measures a clip. O(frames × joints).
    #[must_use]
    pub fn new(clip: &Clip, roles: &Roles) -> Self {
        let mut meter = TraceMeter::new(clip, roles);
        while meter.advance(clip, usize::MAX) {}
        meter.finish(clip)
    }

    /// Returns for every stance the distance that the foot moves over the ground, centimetres: the
    /// diagonal of the bounding box of the toe joint (the ankle without one) in the middle three
    /// fifths of the stance. A stance is a run of frames of at least 0.1 s in which the toe is
    /// within 4 cm of the 5th percentile of its heights, at a median speed below 0.6 m/s.
    #[must_use]
    pub fn stances_cm(&self) -> &[f64] {
        &self.stances_cm
    }

    /// Returns skating, centimetres per second (Zhang et al. 2018, "Mode-Adaptive Neural Networks",
    /// section 7): the mean over the frames and all feet of `|v| (2 - 2^(h / H))` for
    /// `h < H = 2.5 cm`, v being the velocity of the toe over the ground and h its height above the
    /// 2nd percentile of its heights. `None` without feet.
    #[must_use]
    pub fn skating_cm_per_sec(&self) -> Option<f64> {
        self.skating_cm_per_sec
    }

    /// Returns the largest turn of the hips within 0.2 s, degrees.
    #[must_use]
    pub fn max_turn_deg(&self) -> f64 {
        f64::from(self.max_turn_deg)
    }

    /// Returns the artefacts of this motion that none of its sources has. Sources with another
    /// number of joints are ignored for joints; if no source has the same number, the motion's own
    /// speeds are used. Without sources the motion is compared with itself.
    #[must_use]
    pub fn beside(&self, sources: &[&Self]) -> Artefacts {
        let own = [self];
        let sources = if sources.is_empty() { &own } else { sources };
        let like = self.alike(sources);
        let like = if like.is_empty() { &own[..] } else { &like };
        let most =
            |of: fn(&Self) -> f32| sources.iter().map(|source| of(source)).fold(0.0, f32::max);
        let (flashes, new_flashes) = self.flashes(like);
        let (rare_mps, max_mps) = (most(|source| source.rare_mps), most(|source| source.max_mps));
        let beyond =
            |limit: f32| self.root_mps.iter().filter(|speed| **speed > limit + 1e-6).count();
        let turned = MIN_SPIN_DEG.max(ARTEFACT_RATIO * most(|source| source.max_turn_deg));
        let spins = runs(self.turned_deg.iter().map(|deg| *deg > turned));
        Artefacts {
            spins: spins.len(),
            flashes: flashes.len(),
            new_flashes,
            root_jumps: beyond(ARTEFACT_RATIO * rare_mps),
            new_root_jumps: beyond((ARTEFACT_RATIO * rare_mps).max(SPEED_TOLERANCE * max_mps)),
        }
    }

    /// Returns the motions that have as many joints as this one.
    pub(super) fn alike<'a>(&self, others: &[&'a Self]) -> Vec<&'a Self> {
        let is_alike = |other: &&Self| other.joints.len() == self.joints.len();
        others.iter().copied().filter(is_alike).collect()
    }

    /// Returns the turn of the hips over the 0.2 s after each frame, degrees; empty without hip
    /// joints.
    pub(super) fn turned_deg(&self) -> &[f32] {
        &self.turned_deg
    }

    /// Returns the frames at which flashes begin, and the flashes that turn a joint faster than any
    /// source ever does.
    fn flashes(&self, sources: &[&Self]) -> (Vec<usize>, Vec<Flash>) {
        let dps = self.fps as f32;
        let of = |value: fn(&JointTrace) -> f32, joint: usize| {
            let values = sources.iter().filter_map(|source| source.joints.get(joint).map(value));
            values.fold(0.0, f32::max)
        };
        let (mut frames, mut new) = (Vec::new(), Vec::new());
        for (joint, trace) in self.joints.iter().enumerate() {
            let limit = ARTEFACT_RATIO * of(|joint| joint.rare_dps, joint);
            let most = SPEED_TOLERANCE * of(|joint| joint.speed.most, joint);
            for (frame, &turn) in trace.turns_deg.iter().enumerate() {
                let speed = turn * dps;
                if speed > limit + 1e-6 && turn > MIN_FLASH_DEG {
                    frames.push(frame);
                    if speed > most {
                        let times = f64::from(2.0 * speed / limit.max(1e-6));
                        new.push(Flash { frame, joint, times });
                    }
                }
            }
        }
        frames.sort_unstable();
        frames.dedup();
        sort_by_key(&mut new, |flash| (flash.frame, flash.joint));
        (separate_events(frames, |frame| *frame), separate_events(new, |flash| flash.frame))
    }
}

/// Returns the events, in order of time, that are preceded by more than [`MAX_FLASH_GAP_FRAMES`]
/// frames without one.
fn separate_events<T>(events: Vec<T>, frame: impl Fn(&T) -> usize) -> Vec<T> {
    let mut last = None;
    let begins = |event: &T| {
        let now = frame(event);
        let before: Option<usize> = last.replace(now);
        before.is_none_or(|before| now - before > MAX_FLASH_GAP_FRAMES)
    };
    events.into_iter().filter(begins).collect()
}

/// The visible faults of a motion that the motions from which it was made do not have.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Artefacts {
    /// Number of times at which the hips begin to turn by more than 30° within 0.2 s, and by more
    /// than twice the largest turn of any source in that time.
    pub spins: usize,
    /// Number of times at which a joint's local rotation changes faster than twice the 99.9th
    /// percentile of the sources for that joint, and by more than 2° in one frame. Times with no
    /// more than three frames between them count as one.
    pub flashes: usize,
    /// The flashes in which the joint is also faster than it ever is in a source: replayed glitches
    /// of a source are not counted.
    pub new_flashes: Vec<Flash>,
    /// Number of steps in which the root is faster than twice the 99.9th percentile of the sources.
    pub root_jumps: usize,
    /// Number of these in which it is also faster than it ever is in a source.
    pub new_root_jumps: usize,
}

/// A joint that turns too fast.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flash {
    /// The frame before the step.
    pub frame: usize,
    /// The joint.
    pub joint: usize,
    /// Its speed, as a multiple of the 99.9th percentile of the sources: more than 2.
    pub times: f64,
}

fn largest(values: &[f32]) -> f32 {
    values.iter().copied().fold(0.0, f32::max)
}

/// Returns the runs of `true`, as ranges.
fn runs(flags: impl Iterator<Item = bool>) -> Vec<Range<usize>> {
    let mut runs: Vec<Range<usize>> = Vec::new();
    for (frame, _) in flags.enumerate().filter(|(_, flag)| *flag) {
        match runs.last_mut() {
            Some(run) if run.end == frame => run.end += 1,
            _ => runs.push(frame..frame + 1),
        }
    }
    runs
}

/// World positions of a motion.
#[derive(Debug)]
struct BodyTracks {
    /// The feet of the skeleton: their toe joints, or the ankles without; of forefeet, the joint
    /// that follows the end of the leg.
    feet: Vec<usize>,
    /// The hip joints, left and right.
    hips: Option<(usize, usize)>,
    /// Joints with an end site, and that site.
    ends: Vec<(usize, Vec3)>,
    /// Per frame: the distance from the lowest to the highest joint or end site, metres.
    heights: Vec<f32>,
    /// Per foot, frame by frame.
    toes: Vec<Vec<Vec3>>,
    /// The direction of the line from the right hip joint to the left one, radians; empty without
    /// these.
    headings: Vec<f64>,
}

impl BodyTracks {
    /// Returns empty tracks for a clip.
    fn new(clip: &Clip, roles: &Roles) -> Self {
        let skeleton = clip.skeleton();
        let joint = |role| roles.get_within(role, skeleton.len());
        let of_foot = |&foot: &skeleton::Foot| roles.ball_or_ankle(skeleton, foot);
        let feet: Vec<usize> =
            skeleton::Foot::of(roles.body_plan()).iter().filter_map(of_foot).collect();
        Self {
            toes: vec![Vec::with_capacity(clip.frames()); feet.len()],
            feet,
            hips: joint(Role::thigh(Side::Left)).zip(joint(Role::thigh(Side::Right))),
            ends: (skeleton.joints().iter().enumerate())
                .filter_map(|(index, joint)| Some((index, joint.end_site?)))
                .collect(),
            heights: Vec::with_capacity(clip.frames()),
            headings: Vec::new(),
        }
    }

    /// Adds further frames.
    fn take(&mut self, clip: &Clip, frames: Range<usize>) {
        let mut world = WorldPose::default();
        for frame in frames {
            clip.world_pose_into(frame, &mut world);
            let tips = self.ends.iter().map(|&(joint, end)| world.point(joint, end).y);
            let (low, high) = (world.positions.iter().map(|p| p.y).chain(tips))
                .fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), y| {
                    (low.min(y), high.max(y))
                });
            self.heights.push(high - low);
            for (path, &foot) in self.toes.iter_mut().zip(&self.feet) {
                path.push(world.positions[foot]);
            }
            if let Some((left, right)) = self.hips {
                let across = world.positions[left] - world.positions[right];
                self.headings.push(libm::atan2(f64::from(across.x), f64::from(across.z)));
            }
        }
    }

    /// Returns the factor to a body of 1.7 m.
    fn scale(&self) -> f32 {
        let height = stats::percentile(&self.heights, 0.5).unwrap_or(0.0);
        if height > 0.0 { BODY_M / height } else { 1.0 }
    }

    /// Returns the toe tracks on a body of 1.7 m.
    fn scaled_toes(&self) -> Vec<Vec<Vec3>> {
        let scale = self.scale();
        let scaled = |path: &Vec<Vec3>| path.iter().map(|&point| point * scale).collect();
        self.toes.iter().map(scaled).collect()
    }
}

fn turned_deg(headings: &[f64], fps: f64) -> Vec<f32> {
    let window = ((SPIN_SECS * fps).round() as usize).max(1);
    let mut heading = headings.first().copied().unwrap_or(0.0);
    let unwrapped: Vec<f64> = headings
        .iter()
        .map(|&next| {
            heading += wrap_angle(next - heading);
            heading
        })
        .collect();
    let turns = unwrapped.iter().zip(unwrapped.iter().skip(window));
    turns.map(|(from, to)| (to - from).abs().to_degrees() as f32).collect()
}

/// The track of a foot's toe on a body of 1.7 m.
struct Foot<'a> {
    path: &'a [Vec3],
    heights: Vec<f32>,
    /// Speed over the ground in the step into every frame, metres per second; 0 for the first.
    speeds: Vec<f32>,
    fps: f64,
}

impl<'a> Foot<'a> {
    fn new(path: &'a [Vec3], fps: f64) -> Self {
        let steps = path.windows(2).map(|pair| flat(pair[0]).distance(flat(pair[1])) * fps as f32);
        Self {
            path,
            heights: path.iter().map(|point| point.y).collect(),
            speeds: std::iter::once(0.0).chain(steps).take(path.len()).collect(),
            fps,
        }
    }

    fn above(&self, percentile: f32) -> impl Iterator<Item = f32> + '_ {
        let level = stats::percentile(&self.heights, percentile).unwrap_or(0.0);
        self.heights.iter().map(move |height| height - level)
    }

    fn stances_cm(&self) -> Vec<f64> {
        let low = runs(self.above(0.05).map(|height| height < LOW_M));
        let stands = |run: &Range<usize>| {
            let median = stats::percentile(&self.speeds[run.clone()], 0.5);
            run.len() as f64 / self.fps >= MIN_STANCE_SECS
                && median.is_some_and(|speed| speed < MAX_STANCE_MPS)
        };
        let moved_cm = |run: Range<usize>| {
            let edge = run.len() / 5;
            let middle =
                self.path[run.start + edge..run.end - edge].iter().map(|&point| flat(point));
            let (low, high) = middle
                .fold((Vec2::INFINITY, Vec2::NEG_INFINITY), |(low, high), p| {
                    (low.min(p), high.max(p))
                });
            f64::from((high - low).length()) * 100.0
        };
        low.into_iter().filter(stands).map(moved_cm).collect()
    }

    fn skating_cm_per_sec(&self) -> f64 {
        let weighed = self.above(0.02).zip(&self.speeds).filter(|(height, _)| *height < SKATING_M);
        let sum: f64 = weighed
            .map(|(height, &speed)| {
                f64::from(speed * (2.0 - libm::exp2f(height.max(0.0) / SKATING_M)))
            })
            .sum();
        sum / self.path.len().max(1) as f64 * 100.0
    }
}

fn flat(point: Vec3) -> Vec2 {
    Vec2::new(point.x, point.z)
}

#[cfg(test)]
mod tests;
