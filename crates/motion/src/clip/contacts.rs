//! Foot contacts: the frames in which each foot is planted.

mod corrections;

pub use self::corrections::{ContactCorrection, ContactCorrections, StanceEnd};

use super::Clip;
use crate::math::stats;
use crate::skeleton::{BodyPlan, Foot, FootPair, Role, Roles, WorldPose};
use glam::Vec3;
use std::ops::Range;

/// Thresholds for planted feet. Lengths and speeds are those of a character 1.75 m tall and are
/// scaled to the clip's character.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct ContactOptions {
    /// A point of the foot enters contact at or below this height above its own lowest level,
    /// metres.
    pub enter_height_m: f32,
    /// It leaves contact above this height, metres. At least `enter_height_m`.
    pub leave_height_m: f32,
    /// It enters contact at or below this speed, metres per second.
    pub enter_speed_mps: f32,
    /// It leaves contact above this speed, metres per second. At least `enter_speed_mps`.
    pub leave_speed_mps: f32,
    /// Contacts, and gaps between contacts, that are shorter than this are removed as noise,
    /// seconds.
    pub min_secs: f32,
}

impl Default for ContactOptions {
    fn default() -> Self {
        Self {
            enter_height_m: 0.04,
            leave_height_m: 0.07,
            enter_speed_mps: 0.4,
            leave_speed_mps: 0.8,
            min_secs: 0.06,
        }
    }
}

/// The height of the character to which the options' lengths and speeds apply, metres.
pub(super) const REFERENCE_HEIGHT_M: f32 = 1.75;
/// The level of the ground is this percentile of a point's heights: lower values are noise and
/// dents of a soft floor.
pub(super) const GROUND_PERCENTILE: f32 = 0.05;
/// A leaning floor raises the level of one foot over that of both feet by up to this much, metres.
/// A foot that stays higher is held up.
const LEANING_FLOOR_M: f32 = 0.05;
/// Speed limits apply unchanged to bodies up to this speed, metres per second, and grow with the
/// speed above it: in a sprint a planted foot rolls and trembles faster.
const STEADY_SPEED_MPS: f32 = 2.0;
/// A point of a foot of a body on four legs counts while it is low only where its own lowest level
/// is within this height above that of the foot's lowest point, metres: a hock is far above the
/// ground, and slow long before the foot stands.
const MAX_ABOVE_FOOT_M: f32 = 0.1;
/// The body's speed is averaged over this time to either side, seconds: about one step.
const BODY_SPEED_SECS: f64 = 0.25;

/// The frames in which each foot is planted: of two feet, or of the four of a body on four legs.
///
/// Where a foot is asked for, a [`Side`](crate::skeleton::Side) is the hind foot of that side; of a
/// body on two legs, its left or right foot.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Contacts {
    /// The flags of the feet, by [`Foot::index`]: two or four of the same length.
    planted: Vec<Vec<bool>>,
}

impl Default for Contacts {
    fn default() -> Self {
        Self::from_flags([Vec::new(), Vec::new()])
    }
}

impl Contacts {
    /// Detects the contacts of a clip's feet with the ground, by height and speed of ankles, toe
    /// joints and toe tips, with hysteresis.
    ///
    /// A foot is planted while at least one of its points is. Each point is measured against its
    /// own lowest level in the clip (5th percentile), so a clip that floats 3 cm above the ground
    /// gives the same contacts, and an ankle need not come down to the height of a toe. Above 2 m/s
    /// the limits on speed grow in proportion to the body's own speed.
    ///
    /// A body on four legs has four feet. Points that are never near the ground, as a hock, are
    /// left out.
    #[must_use]
    pub fn detect(clip: &Clip, roles: &Roles, options: &ContactOptions) -> Self {
        let tracks = FootTracks::of(clip, roles);
        let scale = roles.body_height(clip.skeleton()) / REFERENCE_HEIGHT_M;
        let speed_ratio = tracks.speed_ratio(clip.fps(), scale);
        let min_frames = (f64::from(options.min_secs) * clip.fps()).round().max(0.0) as usize;
        let mut contacts =
            Self::of_feet(Foot::of(roles.body_plan()), |_| vec![false; clip.frames()]);
        for (kind, pair) in tracks.feet.iter().flat_map(|kind| FootPair::BOTH.map(|p| (kind, p))) {
            let both = || kind.iter().filter(|(foot, _)| foot.pair == pair);
            let all: Vec<f32> = both().flat_map(|(_, track)| heights_of(track)).collect();
            let Some(common) = stats::percentile(&all, GROUND_PERCENTILE) else {
                continue;
            };
            for (foot, track) in both() {
                let own = level_of(track).unwrap_or(common);
                let level = if own - common > LEANING_FLOOR_M * scale { common } else { own };
                let point =
                    Point { track, level, scale, speed_ratio: &speed_ratio, fps: clip.fps() };
                if let Some(planted) = contacts.planted.get_mut(foot.index()) {
                    point.plant(options, planted);
                }
            }
        }
        for flags in &mut contacts.planted {
            drop_short_runs(flags, false, min_frames);
            drop_short_runs(flags, true, min_frames);
        }
        contacts
    }

    /// Returns contacts of two feet from flags: whether the left and the right foot is planted, one
    /// flag per frame.
    #[must_use]
    pub fn from_flags(planted: [Vec<bool>; 2]) -> Self {
        Self { planted: planted.into() }
    }

    /// Returns the contacts of the feet of a body, those of [`Foot::of`], from flags: whether a
    /// foot is planted, one flag per frame. All must have the same number of frames.
    #[must_use]
    pub fn of_feet(feet: &[Foot], flags: impl FnMut(Foot) -> Vec<bool>) -> Self {
        let plan = match feet {
            [] | [_] | [_, _] => BodyPlan::Biped,
            _ => BodyPlan::Quadruped,
        };
        Self { planted: Foot::of(plan).iter().copied().map(flags).collect() }
    }

    /// Returns the feet: two, or the four of a body on four legs.
    #[must_use]
    pub fn feet(&self) -> &'static [Foot] {
        Foot::of(if self.planted.len() > 2 { BodyPlan::Quadruped } else { BodyPlan::Biped })
    }

    /// Returns the contacts of a result that leaves `outgoing` at its frame `leave` and enters
    /// `incoming` at its frame `enter`. Before frame `handover` of the result they are those of the
    /// outgoing clip, from then on those of the incoming clip.
    #[must_use]
    pub fn joined(
        outgoing: &Self,
        incoming: &Self,
        leave: usize,
        enter: usize,
        handover: usize,
    ) -> Self {
        let frames = (leave + incoming.frames()).saturating_sub(enter).max(handover);
        Self::of_feet(outgoing.feet_with(incoming), |foot| {
            (0..frames)
                .map(|frame| {
                    if frame < handover {
                        outgoing.planted(foot, frame)
                    } else {
                        incoming.planted(foot, (frame + enter).saturating_sub(leave))
                    }
                })
                .collect()
        })
    }

    /// Returns the contacts with other flags where `by_hand` has one for a foot in a frame.
    pub(crate) fn corrected(&self, by_hand: impl Fn(Foot, usize) -> Option<bool>) -> Self {
        Self::of_feet(self.feet(), |foot| {
            let found = self.flags(foot).iter().enumerate();
            found.map(|(frame, &planted)| by_hand(foot, frame).unwrap_or(planted)).collect()
        })
    }

    /// Returns the feet of these contacts and of others: four where either has four.
    pub(crate) fn feet_with(&self, other: &Self) -> &'static [Foot] {
        let (own, others) = (self.feet(), other.feet());
        if own.len() >= others.len() { own } else { others }
    }

    /// Returns the flags of a foot; none of one that the body does not have.
    fn flags(&self, foot: Foot) -> &[bool] {
        self.planted.get(foot.index()).map_or(&[], Vec::as_slice)
    }

    /// Returns the contacts of a motion that plays these frames of this one, in this order. Frames
    /// beyond the end have none.
    #[must_use]
    pub fn of_frames(&self, frames: &[usize]) -> Self {
        Self::of_feet(self.feet(), |foot| {
            frames.iter().map(|&frame| self.planted(foot, frame)).collect()
        })
    }

    /// Returns the contacts of the mirror image: those of the other foot.
    #[must_use]
    pub fn mirrored(&self) -> Self {
        Self::of_feet(self.feet(), |foot| self.flags(foot.mirrored()).to_vec())
    }

    /// Returns the number of frames.
    #[must_use]
    pub fn frames(&self) -> usize {
        self.planted.first().map_or(0, Vec::len)
    }

    /// Returns whether a foot is planted in `frame`; `false` beyond the clip, and for a foot that
    /// the body does not have.
    #[must_use]
    pub fn planted(&self, foot: impl Into<Foot>, frame: usize) -> bool {
        self.flags(foot.into()).get(frame).copied().unwrap_or(false)
    }

    /// Returns the phase of a foot in `frame`: 0 at a touchdown, rising to 1 at the next. Before
    /// the first and after the last touchdown the nearest stride is repeated. `None` for a foot
    /// with fewer than two touchdowns.
    #[must_use]
    pub fn phase(&self, foot: impl Into<Foot>, frame: usize) -> Option<f32> {
        phase_between(&self.touchdowns(foot), frame)
    }

    /// Returns the frames in which a foot touches down, in order. A foot that is planted when the
    /// clip begins touched down before.
    pub(crate) fn touchdowns(&self, foot: impl Into<Foot>) -> Vec<usize> {
        let starts = self.intervals(foot).into_iter().map(|stance| stance.start);
        starts.filter(|&at| at > 0).collect()
    }

    /// Returns the frames during which a foot is planted, as ranges in order of time.
    #[must_use]
    pub fn intervals(&self, foot: impl Into<Foot>) -> Vec<Range<usize>> {
        runs(self.flags(foot.into())).filter(|(value, _)| *value).map(|(_, range)| range).collect()
    }
}

/// Returns the phase of a foot in `frame` as [`Contacts::phase`] does, given the frames in which it
/// touches down.
pub(crate) fn phase_between(touchdowns: &[usize], frame: usize) -> Option<f32> {
    let next = touchdowns
        .partition_point(|&at| at <= frame)
        .clamp(1, touchdowns.len().saturating_sub(1).max(1));
    let (from, to) = (*touchdowns.get(next - 1)?, *touchdowns.get(next)?);
    let phase = (frame as f32 - from as f32) / (to - from) as f32;
    Some(phase.rem_euclid(1.0))
}

/// Returns the step over the ground of the point that moves least: a foot that rolls without
/// sliding has one that stands nearly still.
pub(crate) fn stillest_step(before: &[Vec3], after: &[Vec3]) -> Option<Vec3> {
    stillest_point(before, after).map(|(_, step)| step)
}

/// Returns the index of the point that moves least over the ground, and its step.
pub(crate) fn stillest_point(before: &[Vec3], after: &[Vec3]) -> Option<(usize, Vec3)> {
    let steps = before
        .iter()
        .zip(after)
        .map(|(before, after)| (*after - *before) * Vec3::new(1.0, 0.0, 1.0));
    steps.enumerate().min_by(|a, b| a.1.length_squared().total_cmp(&b.1.length_squared()))
}

fn heights_of(track: &[Vec3]) -> Vec<f32> {
    track.iter().map(|point| point.y).collect()
}

/// Returns the lowest level of a point, metres; `None` without a frame.
fn level_of(track: &[Vec3]) -> Option<f32> {
    stats::percentile(&heights_of(track), GROUND_PERCENTILE)
}

/// World positions of the points of the feet and of the hips, frame by frame.
#[derive(Debug)]
pub(super) struct FootTracks {
    /// Positions of ankles, toe joints and toe tips, for each foot that has them.
    pub(super) feet: [Vec<(Foot, Vec<Vec3>)>; 3],
    /// Positions of the hips.
    body: Vec<Vec3>,
    /// For each track, kind by kind: a joint, and a point in its frame.
    points: [Vec<(usize, Vec3)>; 3],
    hips: usize,
    /// The joints to pose.
    needed: Vec<usize>,
}

impl FootTracks {
    /// Returns the tracks of all frames. Those of points that are never near the ground are left
    /// out of a body on four legs.
    pub(super) fn of(clip: &Clip, roles: &Roles) -> Self {
        let mut tracks = Self::new(clip, roles);
        tracks.read(clip, 0..clip.frames());
        if roles.is_quadruped() {
            tracks.leave_high_points_out(roles.body_height(clip.skeleton()) / REFERENCE_HEIGHT_M);
        }
        tracks
    }

    fn leave_high_points_out(&mut self, scale: f32) {
        let levels = |kind: &Vec<(Foot, Vec<Vec3>)>| {
            kind.iter().map(|(_, track)| level_of(track)).collect::<Vec<_>>()
        };
        let levels: Vec<Vec<Option<f32>>> = self.feet.iter().map(levels).collect();
        let mut lowest = [f32::INFINITY; 4];
        for ((foot, _), level) in self.feet.iter().flatten().zip(levels.iter().flatten()) {
            let lowest = &mut lowest[foot.index()];
            *lowest = level.map_or(*lowest, |level| lowest.min(level));
        }
        let most = lowest.map(|level| level + MAX_ABOVE_FOOT_M * scale);
        for ((kind, points), levels) in self.feet.iter_mut().zip(&mut self.points).zip(levels) {
            let stays: Vec<bool> = (kind.iter().zip(levels))
                .map(|((foot, _), level)| level <= Some(most[foot.index()]))
                .collect();
            // Tracks and the points that they follow go together.
            let mut of_tracks = stays.iter();
            kind.retain(|_| of_tracks.next() == Some(&true));
            let mut of_points = stays.iter();
            points.retain(|_| of_points.next() == Some(&true));
        }
    }

    /// Returns tracks without a frame, to be filled by [`read`](Self::read).
    pub(super) fn new(clip: &Clip, roles: &Roles) -> Self {
        let skeleton = clip.skeleton();
        let mut feet: [Vec<(Foot, Vec<Vec3>)>; 3] = Default::default();
        let mut points: [Vec<(usize, Vec3)>; 3] = Default::default();
        for &foot in Foot::of(roles.body_plan()) {
            let of = roles.points_of_foot(skeleton, foot);
            for ((tracks, points), point) in feet.iter_mut().zip(&mut points).zip(of) {
                tracks.extend(point.map(|_| (foot, Vec::with_capacity(clip.frames()))));
                points.extend(point);
            }
        }
        let hips = roles.get_within(Role::Hips, skeleton.len()).unwrap_or(0);
        let joints = points.iter().flatten().map(|&(joint, _)| joint).chain([hips]);
        let needed = skeleton.with_ancestors(joints);
        Self { feet, body: Vec::with_capacity(clip.frames()), points, hips, needed }
    }

    /// Adds these frames, which follow those that were read.
    pub(super) fn read(&mut self, clip: &Clip, frames: Range<usize>) {
        let mut world = WorldPose::default();
        for frame in frames {
            clip.world_pose_of(frame, &self.needed, &mut world);
            self.body.push(world.positions[self.hips]);
            let tracks = self.feet.iter_mut().flatten().zip(self.points.iter().flatten());
            for ((_, track), &(joint, point)) in tracks {
                track.push(world.point(joint, point));
            }
        }
    }

    /// Returns for every frame the ratio of the body's speed to the steady speed, at least 1.
    fn speed_ratio(&self, fps: f64, scale: f32) -> Vec<f32> {
        let reach = ((BODY_SPEED_SECS * fps).round() as usize).max(1);
        let last = self.body.len().saturating_sub(1);
        let speed_ratio = |frame: usize| {
            let (before, after) = (frame.saturating_sub(reach), (frame + reach).min(last));
            let step = (self.body[after] - self.body[before]) * Vec3::new(1.0, 0.0, 1.0);
            let secs = (after - before).max(1) as f32 / fps as f32;
            (step.length() / secs / scale / STEADY_SPEED_MPS).max(1.0)
        };
        (0..self.body.len()).map(speed_ratio).collect()
    }
}

/// A point of a foot over time.
struct Point<'a> {
    track: &'a [Vec3],
    /// The height of the ground under it, metres.
    level: f32,
    /// The ratio of the character's height to that of the options.
    scale: f32,
    speed_ratio: &'a [f32],
    fps: f64,
}

impl Point<'_> {
    /// Marks the frames in which the point is on the ground.
    // Not inlined: browsers optimise a function between two of its calls, and a foot has several
    // points.
    #[inline(never)]
    fn plant(&self, options: &ContactOptions, planted: &mut [bool]) {
        let mut down = false;
        for (frame, planted) in planted.iter_mut().enumerate() {
            let height = (self.track[frame].y - self.level) / self.scale;
            let speed = speed(self.track, frame, self.fps) / self.scale / self.speed_ratio[frame];
            down = if down {
                height <= options.leave_height_m && speed <= options.leave_speed_mps
            } else {
                height <= options.enter_height_m && speed <= options.enter_speed_mps
            };
            *planted |= down;
        }
    }
}

/// Returns the speed by central differences, metres per second.
fn speed(track: &[Vec3], frame: usize, fps: f64) -> f32 {
    let (before, after) = (frame.saturating_sub(1), (frame + 1).min(track.len() - 1));
    if before == after {
        return 0.0;
    }
    track[before].distance(track[after]) * fps as f32 / (after - before) as f32
}

/// Returns the maximal runs of equal flags, in order.
fn runs(flags: &[bool]) -> impl Iterator<Item = (bool, Range<usize>)> + '_ {
    let mut start = 0;
    flags.chunk_by(|a, b| a == b).map(move |run| {
        let range = start..start + run.len();
        start = range.end;
        (run[0], range)
    })
}

/// Inverts runs of `value` that are shorter than `min_frames` and touch neither end of the clip.
pub(super) fn drop_short_runs(flags: &mut [bool], value: bool, min_frames: usize) {
    let last = flags.len();
    let short: Vec<Range<usize>> = runs(flags)
        .filter(|(v, range)| {
            *v == value && range.len() < min_frames && range.start > 0 && range.end < last
        })
        .map(|(_, range)| range)
        .collect();
    for range in short {
        flags[range].fill(!value);
    }
}

#[cfg(test)]
mod tests;
