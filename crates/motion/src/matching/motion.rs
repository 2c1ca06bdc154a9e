//! The clips of a database.

use super::cycle::{cycle_frame, cycle_power};
use super::features::{BODY, Layout, RATE};
use super::foot_state::FootState;
use super::pace::Pace;
use super::simulation::simulation_roots_of_cycle;
use super::tags::TagRange;
use super::{MatchError, simulation_roots};
use crate::clip::{Clip, Contacts, character_frames, estimate_ground, stillest_point};
use crate::math::{Planar, stats, wrap_angle};
use crate::skeleton::{Foot, Role, Roles, WorldPose};
use glam::{DVec2, Vec3};
use std::sync::Arc;

/// A clip of a database, with its measurements.
#[derive(Clone, Debug, PartialEq)]
pub struct DatabaseClip(DatabaseClipParts);

/// The parts of a [`DatabaseClip`], as they travel between programs. All lists have an element for
/// each frame of the clip.
#[derive(Clone, Debug, PartialEq)]
pub struct DatabaseClipParts {
    /// The clip, on the database's skeleton and at [`RATE`].
    pub clip: Arc<Clip>,
    /// The simulation roots: `clip_from_simulation`.
    pub roots: Vec<Planar>,
    /// The contacts of the feet.
    pub contacts: Contacts,
    /// The height of the ground under the clip, metres.
    pub ground_m: f32,
    /// The usual height of a planted foot's lowest point, metres.
    pub stand_m: f32,
    /// The states of the feet, by [`Foot::index`]; empty for feet that the body does not have.
    pub feet: [Vec<FootState>; 4],
    /// The features of the body, in the order of [`Layout`](super::Layout).
    pub body: Vec<[f32; BODY]>,
    /// The greatest speeds.
    pub pace: Pace,
    /// The number of its source among the clips of the database.
    pub source: usize,
    /// Whether it is a mirrored copy.
    pub mirrored: bool,
    /// The transform of one repetition of a cycle: `clip_from_clip`.
    pub cycle: Option<Planar>,
    /// Its tags, at [`RATE`].
    pub tags: Vec<TagRange>,
}

impl DatabaseClipParts {
    /// The number of features of the body.
    pub const BODY_FEATURES: usize = BODY;
}

/// The joints of the features.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct FeatureJoints {
    hips: usize,
    feet: [usize; 2],
}

impl FeatureJoints {
    pub(super) fn find(clip: &Clip, roles: &Roles) -> Result<Self, MatchError> {
        let joint = |role: Role| {
            roles.get_within(role, clip.skeleton().len()).ok_or_else(|| MatchError::NoFeet {
                name: clip.name().to_owned(),
                missing: role.name(),
            })
        };
        Ok(Self {
            hips: joint(Role::Hips)?,
            feet: [joint(Role::LeftFoot)?, joint(Role::RightFoot)?],
        })
    }
}

impl DatabaseClip {
    /// Measures a clip at [`RATE`]; a cycle has the transform of one repetition in `cycle`.
    pub(super) fn new(
        clip: Arc<Clip>,
        cycle: Option<Planar>,
        roles: &Roles,
        contacts: Contacts,
        source: usize,
        mirrored: bool,
    ) -> Result<Self, MatchError> {
        let joints = FeatureJoints::find(&clip, roles)?;
        let frames = character_frames(&clip, roles);
        let roots = match &cycle {
            Some(cycle) => simulation_roots_of_cycle(&frames, cycle),
            None => simulation_roots(&frames),
        };
        let body = body_features(&clip, cycle.as_ref(), joints, &roots);
        let finite = body.iter().flatten().all(|value| value.is_finite())
            && roots.iter().all(|root| root.shift.is_finite() && root.yaw.is_finite());
        if !finite {
            let name = clip.name().to_owned();
            return Err(MatchError::NotFinite { name });
        }
        let ground_m = estimate_ground(&clip, roles, &contacts);
        let mut feet: [Vec<FootState>; 4] = Default::default();
        for (&foot, states) in Foot::of(roles.body_plan()).iter().zip(&mut feet) {
            *states = foot_states(&clip, &roots, cycle.as_ref(), roles, &contacts, foot);
        }
        let cycle_frame: Vec<f32> =
            (feet.iter().flatten().filter(|foot| foot.planted)).map(|foot| foot.above_m).collect();
        let stand_m = stats::percentile(&cycle_frame, 0.5).unwrap_or(ground_m);
        for foot in feet.iter_mut().flatten() {
            foot.above_m -= stand_m;
        }
        Ok(Self(DatabaseClipParts {
            pace: Pace::of(&clip, &roots),
            ground_m,
            stand_m,
            feet,
            clip,
            roots,
            contacts,
            body,
            source,
            mirrored,
            cycle,
            tags: Vec::new(),
        }))
    }

    /// Returns its parts.
    #[must_use]
    pub fn into_parts(self) -> DatabaseClipParts {
        self.0
    }

    /// Returns the clip with these parts; `None` if it has no frame, or lists of different lengths.
    #[must_use]
    pub fn of_parts(parts: DatabaseClipParts) -> Option<Self> {
        let frames = parts.clip.frames();
        let (joints, [left, right, fore @ ..]) = (parts.clip.skeleton().len(), &parts.feet);
        let lengths = [parts.roots.len(), parts.contacts.frames(), left.len(), right.len()];
        let are_alike = parts.body.len() == frames
            && lengths.into_iter().all(|len| len == frames)
            && fore.iter().all(|states| states.is_empty() || states.len() == frames);
        let is_whole = frames > 0 && are_alike && parts.pace.joints_radps.len() == joints;
        is_whole.then_some(Self(parts))
    }

    /// Returns the same clip with other tags.
    #[must_use]
    pub(super) fn with_tags(mut self, tags: Vec<TagRange>) -> Self {
        self.0.tags = tags;
        self
    }

    /// Returns the clip, on the database's skeleton and at [`RATE`].
    #[must_use]
    pub fn clip(&self) -> &Arc<Clip> {
        &self.0.clip
    }

    /// Returns the simulation root of each frame: `clip_from_simulation`.
    #[must_use]
    pub fn roots(&self) -> &[Planar] {
        &self.0.roots
    }

    /// Returns the greatest speeds of the clip.
    #[must_use]
    pub fn pace(&self) -> &Pace {
        &self.0.pace
    }

    /// Returns the contacts of the feet.
    #[must_use]
    pub fn contacts(&self) -> &Contacts {
        &self.0.contacts
    }

    /// Returns the height of the ground under the clip, metres.
    #[must_use]
    pub fn ground_m(&self) -> f32 {
        self.0.ground_m
    }

    /// Returns the usual height of a planted foot's lowest point, metres. It may be above the
    /// ground, which feet set lower when they dip into the floor at push-off.
    pub(super) fn stand_m(&self) -> f32 {
        self.0.stand_m
    }

    /// Returns the states of the feet in a frame, by [`Foot::index`].
    pub(super) fn feet(&self, frame: usize) -> [FootState; 4] {
        let states = self.0.feet.each_ref();
        states.map(|states| states.get(frame).copied().unwrap_or_default())
    }

    /// Returns the number of its source among the clips from which the database was built.
    #[must_use]
    pub fn source(&self) -> usize {
        self.0.source
    }

    /// Returns whether it is a mirrored copy.
    #[must_use]
    pub fn is_mirrored(&self) -> bool {
        self.0.mirrored
    }

    /// Returns whether it is a cycle, which repeats: its last frame is followed by its first.
    #[must_use]
    pub fn is_cycle(&self) -> bool {
        self.0.cycle.is_some()
    }

    /// Returns the transform of one repetition of a cycle: the frame after the last is the first,
    /// moved by this over the ground. `None` for a clip that ends.
    #[must_use]
    pub fn cycle(&self) -> Option<Planar> {
        self.0.cycle
    }

    /// Returns the next frame; `None` at the end of a clip that is not a cycle.
    #[must_use]
    pub fn next(&self, frame: usize) -> Option<usize> {
        match frame + 1 {
            next if next < self.frames() => Some(next),
            _ => self.0.cycle.map(|_| 0),
        }
    }

    /// Returns the number of frames between two frames, in a cycle by the shorter way.
    pub(super) fn frames_between(&self, a: usize, b: usize) -> usize {
        let apart = a.abs_diff(b);
        if self.is_cycle() { apart.min(self.frames().saturating_sub(apart)) } else { apart }
    }

    /// Returns its tags, at [`RATE`].
    #[must_use]
    pub fn tags(&self) -> &[TagRange] {
        &self.0.tags
    }

    /// Returns the number of frames.
    #[must_use]
    pub fn frames(&self) -> usize {
        self.0.clip.frames()
    }

    /// Returns the number of frames, from frame 0 on, whose trajectory lies inside the clip: all
    /// for a cycle.
    pub(super) fn valid(&self, layout: &Layout) -> usize {
        let behind = if self.is_cycle() { 0 } else { layout.horizon() };
        self.frames().saturating_sub(behind)
    }

    /// Returns the simulation root of a frame. Beyond the clip's end a cycle repeats, and another
    /// clip is extrapolated by its last half second.
    #[must_use]
    pub fn root(&self, frame: usize) -> Planar {
        if let Some(root) = self.0.roots.get(frame) {
            return *root;
        }
        let Some(last) = self.0.roots.last() else {
            return Planar::IDENTITY;
        };
        if let Some(cycle) = &self.0.cycle {
            return cycle_frame(&self.0.roots, cycle, isize::try_from(frame).unwrap_or(0));
        }
        let behind = self.0.roots.len() - 1;
        let over = (frame - behind) as f64;
        // The steps of half a second: a single one would extrapolate the error of the smoothing at
        // the end.
        let steps = behind.min(RATE / 2);
        let Some(before) = behind.checked_sub(steps.max(1)).and_then(|at| self.0.roots.get(at))
        else {
            return *last;
        };
        let made = before.inverse().after(last);
        // Along the circular arc of these steps; straight if they do not turn.
        let share = over / steps as f64;
        let (turn, whole) = (made.yaw * share, made.yaw);
        let stretch =
            if whole.abs() < 1e-6 { share } else { libm::sin(0.5 * turn) / libm::sin(0.5 * whole) };
        let middle = 0.5 * (turn - whole);
        let (sin, cos) = (libm::sin(middle), libm::cos(middle));
        let travel = DVec2::new(
            made.shift.x * cos + made.shift.y * sin,
            made.shift.y * cos - made.shift.x * sin,
        ) * stretch;
        last.after(&Planar { yaw: wrap_angle(turn), shift: travel })
    }

    /// Writes the raw features of a frame into a row.
    pub(super) fn write_row(&self, layout: &Layout, frame: usize, row: &mut [f32]) {
        let here = self.root(frame).inverse();
        let times = layout.ahead().len();
        for (index, ahead) in layout.ahead().iter().enumerate() {
            let there = here.after(&self.root(frame + ahead));
            write_trajectory(row, times, index, &there);
        }
        if let (Some(body), Some(to)) = (self.0.body.get(frame), row.get_mut(layout.body()..)) {
            for (to, value) in to.iter_mut().zip(body) {
                *to = *value;
            }
        }
    }
}

/// Returns the raw features of a clip at [`RATE`], for every frame of which the trajectory lies
/// inside it: row-major, [`Layout::dims`] numbers each. `every` is the number of frames from one
/// row to the next. They are those of a [`Database`](super::Database) of this clip before
/// they are normalised.
///
/// # Errors
/// [`MatchError::NoFeet`] when hips or feet are unknown, [`MatchError::NotFinite`].
pub fn feature_rows(
    clip: &Clip,
    roles: &Roles,
    layout: &Layout,
    every: usize,
) -> Result<Vec<f32>, MatchError> {
    let joints = FeatureJoints::find(clip, roles)?;
    let roots = simulation_roots(&character_frames(clip, roles));
    let body = body_features(clip, None, joints, &roots);
    let mut rows = Vec::new();
    let frames = clip.frames().saturating_sub(layout.horizon());
    for frame in (0..frames).step_by(every.max(1)) {
        let here = roots[frame].inverse();
        let mut row = vec![0.0; layout.dims()];
        for (index, ahead) in layout.ahead().iter().enumerate() {
            let there = here.after(&roots[frame + ahead]);
            write_trajectory(&mut row, layout.ahead().len(), index, &there);
        }
        row[layout.body()..].copy_from_slice(&body[frame]);
        rows.extend(row);
    }
    if rows.iter().any(|value| !value.is_finite()) {
        return Err(MatchError::NotFinite { name: clip.name().to_owned() });
    }
    Ok(rows)
}

/// Writes one ground frame of a trajectory, in the character's frame, into a row with this many
/// times.
pub(super) fn write_trajectory(row: &mut [f32], times: usize, index: usize, there: &Planar) {
    let values = [there.shift.x, there.shift.y, libm::sin(there.yaw), libm::cos(there.yaw)];
    let places = [2 * index, 2 * index + 1, 2 * (times + index), 2 * (times + index) + 1];
    for (place, value) in places.into_iter().zip(values) {
        if let Some(to) = row.get_mut(place) {
            *to = value as f32;
        }
    }
}

/// Returns the features of feet and hips in the character's frame. Velocities are those in the
/// world by central differences, one-sided at the ends of a clip that is not a cycle.
fn body_features(
    clip: &Clip,
    cycle: Option<&Planar>,
    joints: FeatureJoints,
    roots: &[Planar],
) -> Vec<[f32; BODY]> {
    let FeatureJoints { hips, feet } = joints;
    let needed = clip.skeleton().with_ancestors([hips, feet[0], feet[1]]);
    let mut world = WorldPose::default();
    let positions: Vec<[Vec3; 3]> = (0..clip.frames())
        .map(|frame| {
            clip.world_pose_of(frame, &needed, &mut world);
            [feet[0], feet[1], hips].map(|joint| world.positions[joint])
        })
        .collect();
    let last = positions.len().saturating_sub(1);
    (0..positions.len())
        .map(|frame| {
            let here = roots[frame].inverse();
            let (mut before, mut after) =
                (positions[frame.saturating_sub(1)], positions[(frame + 1).min(last)]);
            let mut steps = (frame + 1).min(last) - frame.saturating_sub(1);
            if let Some(cycle) = cycle {
                steps = 2;
                if frame == 0 {
                    let back = cycle_power(cycle, -1);
                    before = positions[last].map(|position| back.apply(position));
                }
                if frame == last {
                    after = positions[0].map(|position| cycle.apply(position));
                }
            }
            let rate = RATE as f32 / steps.max(1) as f32;
            let velocity = |point: usize| here.apply_vector((after[point] - before[point]) * rate);
            let values = [
                here.apply(positions[frame][0]),
                here.apply(positions[frame][1]),
                velocity(0),
                velocity(1),
                velocity(2),
            ];
            let mut row = [0.0; BODY];
            for (to, value) in row.chunks_exact_mut(3).zip(values) {
                to.copy_from_slice(&value.to_array());
            }
            row
        })
        .collect()
}

/// The number of frames before a landing in which the length of the next stance is given: as many
/// as it takes to lift a foot.
const STANCE_PREVIEW_FRAMES: usize = 8;

/// The number of frames in which the descent of a foot is measured, so that it is lifted before it
/// is low.
const DESCENT_PREVIEW_FRAMES: usize = 4;

/// Returns the states of a foot, frame by frame. Velocities are those of the step into the frame;
/// in the first frame of a clip that is not a cycle, of the step out of it. Heights are those in
/// the world.
fn foot_states(
    clip: &Clip,
    roots: &[Planar],
    cycle: Option<&Planar>,
    roles: &Roles,
    contacts: &Contacts,
    foot: Foot,
) -> Vec<FootState> {
    let points = roles.foot_points(clip.skeleton(), foot);
    let needed = clip.skeleton().with_ancestors(points.iter().map(|&(joint, _)| joint));
    let mut world = WorldPose::default();
    let tracks: Vec<Vec<Vec3>> = (0..clip.frames())
        .map(|frame| {
            clip.world_pose_of(frame, &needed, &mut world);
            points.iter().map(|&(joint, point)| world.point(joint, point)).collect()
        })
        .collect();
    let last = tracks.len().saturating_sub(1);
    let step = |frame: usize| match (frame, cycle) {
        (0, Some(cycle)) => {
            let back = cycle_power(cycle, -1);
            let before: Vec<Vec3> = tracks[last].iter().map(|point| back.apply(*point)).collect();
            stillest_point(&before, &tracks[0])
        }
        (0, None) => stillest_point(&tracks[0], &tracks[last.min(1)]),
        _ => stillest_point(&tracks[frame - 1], &tracks[frame]),
    };
    let planted: Vec<bool> = (0..tracks.len()).map(|frame| contacts.planted(foot, frame)).collect();
    let stance = |frame: usize| {
        let round = if cycle.is_some() { &planted[..frame] } else { &[] };
        let coming = planted[frame..].iter().chain(round);
        let lands = coming.clone().take(STANCE_PREVIEW_FRAMES).position(|&planted| planted);
        lands.map_or(0, |lands| coming.skip(lands).take_while(|&&planted| planted).count())
    };
    let lowest =
        |frame: usize| tracks[frame].iter().map(|point| point.y).fold(f32::INFINITY, f32::min);
    let descent = |frame: usize| {
        let coming = (frame..=frame + DESCENT_PREVIEW_FRAMES).map(|ahead| match cycle {
            Some(_) => lowest(ahead % tracks.len()),
            None => lowest(ahead.min(last)),
        });
        lowest(frame) - coming.fold(f32::INFINITY, f32::min)
    };
    (0..tracks.len())
        .map(|frame| (frame, step(frame).unwrap_or_default()))
        .map(|(frame, (stillest, step))| FootState {
            planted: planted[frame],
            stance_frames: stance(frame),
            stillest,
            above_m: lowest(frame),
            descent_m: descent(frame),
            velocity_mps: roots[frame].inverse().apply_vector(step) * RATE as f32,
        })
        .collect()
}
