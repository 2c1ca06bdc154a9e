use super::controller::OwnFoot;
use super::features::{BODY, Layout, RATE};
use super::pace::Pace;
use super::round::{moved_by, standing};
use super::simulation::simulation_roots_of_cycle;
use super::tags::TagRange;
use super::{MatchError, simulation_roots};
use crate::clip::{Clip, Contacts, character_frames, estimate_ground, stillest_point};
use crate::math::{Planar, stats, wrap_angle};
use crate::skeleton::{Role, Roles, Side, WorldPose};
use glam::{DVec2, Vec3};
use std::sync::Arc;

/// A clip of a database, with what is measured on it once.
#[derive(Clone, Debug, PartialEq)]
pub struct Motion {
    clip: Arc<Clip>,
    roots: Vec<Planar>,
    contacts: Contacts,
    ground_m: f32,
    stand_m: f32,
    /// Left and right, frame by frame.
    feet: [Vec<OwnFoot>; 2],
    body: Vec<[f32; BODY]>,
    pace: Pace,
    source: usize,
    mirrored: bool,
    /// Where a round of a clip that goes round leads: `clip_from_clip`.
    cycle: Option<Planar>,
    pub(super) tags: Vec<TagRange>,
}

/// The joints that features are taken from.
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

impl Motion {
    /// Measures a clip at [`RATE`]; with `cycle`, where a round of it leads, one that goes round.
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
        let mut feet =
            Side::BOTH.map(|side| own_foot(&clip, &roots, cycle.as_ref(), roles, &contacts, side));
        let standing: Vec<f32> =
            (feet.iter().flatten().filter(|foot| foot.planted)).map(|foot| foot.above_m).collect();
        let stand_m = stats::percentile(&standing, 0.5).unwrap_or(ground_m);
        for foot in feet.iter_mut().flatten() {
            foot.above_m -= stand_m;
        }
        Ok(Self {
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
        })
    }

    /// The clip, on the database's skeleton and at [`RATE`].
    #[must_use]
    pub fn clip(&self) -> &Arc<Clip> {
        &self.clip
    }

    /// The simulation root of each frame: `clip_from_simulation`.
    #[must_use]
    pub fn roots(&self) -> &[Planar] {
        &self.roots
    }

    /// How fast it goes.
    #[must_use]
    pub fn pace(&self) -> &Pace {
        &self.pace
    }

    /// When the feet are on the ground.
    #[must_use]
    pub fn contacts(&self) -> &Contacts {
        &self.contacts
    }

    /// The height of the ground under the clip, metres.
    #[must_use]
    pub fn ground_m(&self) -> f32 {
        self.ground_m
    }

    /// The height that the lowest point of a foot has as a rule while it is on the ground, metres.
    /// Feet that dip into the floor at push-off set the ground lower than this.
    pub(super) fn stand_m(&self) -> f32 {
        self.stand_m
    }

    /// What the feet do in a frame: left, right.
    pub(super) fn feet(&self, frame: usize) -> [OwnFoot; 2] {
        [0, 1].map(|side: usize| self.feet[side].get(frame).copied().unwrap_or_default())
    }

    /// The number of the clip that it was made from, among those that the database was built from.
    #[must_use]
    pub fn source(&self) -> usize {
        self.source
    }

    /// Whether it is a mirrored copy.
    #[must_use]
    pub fn is_mirrored(&self) -> bool {
        self.mirrored
    }

    /// Whether it is a cycle, which plays round and round: its last frame is followed by its first.
    #[must_use]
    pub fn is_cycle(&self) -> bool {
        self.cycle.is_some()
    }

    /// Where a round of a cycle leads: the frame behind the last is the first, moved by this over
    /// the ground. `None` for a clip that ends.
    #[must_use]
    pub fn cycle(&self) -> Option<Planar> {
        self.cycle
    }

    /// The frame that follows; `None` at the end of a clip that is no cycle.
    #[must_use]
    pub fn next(&self, frame: usize) -> Option<usize> {
        match frame + 1 {
            next if next < self.frames() => Some(next),
            _ => self.cycle.map(|_| 0),
        }
    }

    /// How many frames two of its frames are apart, in a cycle the shorter way round.
    pub(super) fn frames_between(&self, a: usize, b: usize) -> usize {
        let apart = a.abs_diff(b);
        if self.is_cycle() { apart.min(self.frames().saturating_sub(apart)) } else { apart }
    }

    /// Its tags, at [`RATE`].
    #[must_use]
    pub fn tags(&self) -> &[TagRange] {
        &self.tags
    }

    /// Frames.
    #[must_use]
    pub fn frames(&self) -> usize {
        self.clip.frames()
    }

    /// The frames from 0 on whose trajectory lies inside the clip: all of a cycle.
    pub(super) fn valid(&self, layout: &Layout) -> usize {
        let behind = if self.is_cycle() { 0 } else { layout.horizon() };
        self.frames().saturating_sub(behind)
    }

    /// Where the simulation root is in a frame. Behind the clip's end a cycle begins again, and
    /// another clip goes on as it did over the last half second.
    #[must_use]
    pub fn root(&self, frame: usize) -> Planar {
        if let Some(root) = self.roots.get(frame) {
            return *root;
        }
        let Some(last) = self.roots.last() else {
            return Planar::IDENTITY;
        };
        if let Some(cycle) = &self.cycle {
            return standing(&self.roots, cycle, isize::try_from(frame).unwrap_or(0));
        }
        let behind = self.roots.len() - 1;
        let over = (frame - behind) as f64;
        // The steps of half a second: a single one would go on with what the smoothing made of the
        // end.
        let steps = behind.min(RATE / 2);
        let Some(before) = behind.checked_sub(steps.max(1)).and_then(|at| self.roots.get(at))
        else {
            return *last;
        };
        let made = before.inverse().after(last);
        // Along the circle that these steps are an arc of; straight where they do not turn.
        let share = over / steps as f64;
        let (turn, whole) = (made.yaw * share, made.yaw);
        let stretch =
            if whole.abs() < 1e-6 { share } else { libm::sin(0.5 * turn) / libm::sin(0.5 * whole) };
        let middle = 0.5 * (turn - whole);
        let (sin, cos) = (libm::sin(middle), libm::cos(middle));
        let way = DVec2::new(
            made.shift.x * cos + made.shift.y * sin,
            made.shift.y * cos - made.shift.x * sin,
        ) * stretch;
        last.after(&Planar { yaw: wrap_angle(turn), shift: way })
    }

    /// The raw features of a frame into a row of the layout's length.
    pub(super) fn write_row(&self, layout: &Layout, frame: usize, row: &mut [f32]) {
        let here = self.root(frame).inverse();
        let times = layout.ahead().len();
        for (index, ahead) in layout.ahead().iter().enumerate() {
            let there = here.after(&self.root(frame + ahead));
            write_trajectory(row, times, index, &there);
        }
        if let (Some(body), Some(to)) = (self.body.get(frame), row.get_mut(layout.body()..)) {
            for (to, value) in to.iter_mut().zip(body) {
                *to = *value;
            }
        }
    }
}

/// Writes one place of a trajectory, in the character's frame, into a row for so many times.
pub(super) fn write_trajectory(row: &mut [f32], times: usize, index: usize, there: &Planar) {
    let values = [there.shift.x, there.shift.y, libm::sin(there.yaw), libm::cos(there.yaw)];
    let places = [2 * index, 2 * index + 1, 2 * (times + index), 2 * (times + index) + 1];
    for (place, value) in places.into_iter().zip(values) {
        if let Some(to) = row.get_mut(place) {
            *to = value as f32;
        }
    }
}

/// Feet and hips in the character's frame. Velocities are those over the world by central
/// differences, one-sided at the ends of a clip that is no cycle.
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
                    let back = moved_by(cycle, -1);
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

/// So many frames before a foot lands it is told for how long it will stand, since it takes as many
/// to lift one.
const LOOK_AHEAD: usize = 8;

/// So many frames before a foot is low it is lifted.
const LIFT_AHEAD: usize = 4;

/// What a foot does, frame by frame: its velocity is that of the step into the frame, in the first
/// frame of a clip that is no cycle of the step out of it; its height is that in the world.
fn own_foot(
    clip: &Clip,
    roots: &[Planar],
    cycle: Option<&Planar>,
    roles: &Roles,
    contacts: &Contacts,
    side: Side,
) -> Vec<OwnFoot> {
    let points = roles.foot_points(clip.skeleton(), side);
    let needed = clip.skeleton().with_ancestors(points.iter().map(|&(joint, _)| joint));
    let mut world = WorldPose::default();
    let ways: Vec<Vec<Vec3>> = (0..clip.frames())
        .map(|frame| {
            clip.world_pose_of(frame, &needed, &mut world);
            points.iter().map(|&(joint, point)| world.point(joint, point)).collect()
        })
        .collect();
    let last = ways.len().saturating_sub(1);
    let step = |frame: usize| match (frame, cycle) {
        (0, Some(cycle)) => {
            let back = moved_by(cycle, -1);
            let before: Vec<Vec3> = ways[last].iter().map(|point| back.apply(*point)).collect();
            stillest_point(&before, &ways[0])
        }
        (0, None) => stillest_point(&ways[0], &ways[last.min(1)]),
        _ => stillest_point(&ways[frame - 1], &ways[frame]),
    };
    let planted: Vec<bool> = (0..ways.len()).map(|frame| contacts.planted(side, frame)).collect();
    let stance = |frame: usize| {
        let round = if cycle.is_some() { &planted[..frame] } else { &[] };
        let coming = planted[frame..].iter().chain(round);
        let lands = coming.clone().take(LOOK_AHEAD).position(|&planted| planted);
        lands.map_or(0, |lands| coming.skip(lands).take_while(|&&planted| planted).count())
    };
    let lowest =
        |frame: usize| ways[frame].iter().map(|point| point.y).fold(f32::INFINITY, f32::min);
    let falls = |frame: usize| {
        let coming = (frame..=frame + LIFT_AHEAD).map(|ahead| match cycle {
            Some(_) => lowest(ahead % ways.len()),
            None => lowest(ahead.min(last)),
        });
        lowest(frame) - coming.fold(f32::INFINITY, f32::min)
    };
    (0..ways.len())
        .map(|frame| (frame, step(frame).unwrap_or_default()))
        .map(|(frame, (stillest, step))| OwnFoot {
            planted: planted[frame],
            stance_frames: stance(frame),
            stillest,
            above_m: lowest(frame),
            falls_m: falls(frame),
            velocity_mps: roots[frame].inverse().apply_vector(step) * RATE as f32,
        })
        .collect()
}

/// The contacts of the mirror image.
pub(super) fn mirrored_contacts(contacts: &Contacts) -> Contacts {
    Contacts::from_flags(Side::BOTH.map(|side| {
        (0..contacts.frames()).map(|frame| contacts.planted(side.other(), frame)).collect()
    }))
}
