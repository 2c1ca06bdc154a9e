//! Foot planting during playback.

use super::super::Database;
use super::super::foot_state::FootState;
use super::options::FootPlanting;
use crate::math::curve::smoothstep;
use crate::math::{quat, spring};
use crate::registration::REFERENCE_HEIGHT_M;
use crate::skeleton::{self, Pose, Skeleton, WorldPose, world_pose_of};
use crate::transition::Limb;
use glam::{Quat, Vec3};

/// Foot planting during playback, tick by tick: like [`crate::transition::foot_lock`] for a whole
/// clip, without knowledge of the future.
///
/// While a foot is planted, the slide of its stillest point in the clip is subtracted, tick by
/// tick, so that this point stands exactly. When the foot is lifted, the accumulated shift decays
/// from its own velocity. A foot that would be held too far from its animated position is released
/// until it is lifted. Points below the ground are lifted above it.
///
/// If a leg cannot reach the position of its planted foot, the hips are lowered.
///
/// No correction turns a joint of the leg faster, in addition to its own motion, than three
/// quarters of the speed that it usually does not exceed: a leg that is nearly straight would snap
/// when its foot is released, since there a centimetre is many degrees of the knee. In that case
/// the foot slips a little.
///
/// A foot becomes planted when the clip has a contact *and* the foot has come down: right after a
/// jump it may still be on its way to its position in the new clip. Where the body carries the foot
/// over the ground, as when it is pulled back to a slower pace, the foot is planted if it can be
/// held until its clip lifts it; otherwise it is lifted before it lands. A released foot is planted
/// again when it is back at its animated position.
///
/// A foot that moves over the ground is off the ground: if a transition, the pull towards the
/// simulation object or the decay of its shift moves a foot over the ground faster than its clip
/// does, it is lifted, as in a step, and not dragged.
#[derive(Clone, Debug)]
pub(super) struct Feet {
    all: Vec<Foot>,
    needed: Vec<usize>,
    scale: f32,
    ground_m: f32,
    stand_m: f32,
    /// The amount by which the hips are lowered, metres, and its rate.
    lower: f32,
    lower_rate: f32,
    world: WorldPose,
}

/// A foot has landed when it is no higher than this above the ground, metres for a body of 1.75 m,
/// and the body does not carry it over the ground faster than this, metres per second. Both are a
/// little more than in [`crate::clip::ContactOptions`], since the rest of a transition makes the
/// foot sway.
const LANDED_M: f32 = 0.06;
const LANDED_MPS: f32 = 0.6;

/// A released foot may be planted again when at most this share of [`FootPlanting::max_shift_m`]
/// is left.
const RESUME_SHARE: f32 = 0.25;

/// The greatest clearance of a foot that is moved over the ground, metres for a body of 1.75 m:
/// enough to look like a step instead of a slide.
const MAX_CLEARANCE_M: f32 = 0.04;
/// The speed of the foot at which that clearance is reached, metres per second; below
/// [`MIN_CLEARANCE_MPS`] it is 0.
const FULL_CLEARANCE_MPS: f32 = 0.5;
const MIN_CLEARANCE_MPS: f32 = 0.05;
/// The greatest amount by which the hips are lowered, metres for a body of 1.75 m, where a leg
/// cannot reach the position of its planted foot.
const MAX_LOWERED_M: f32 = 0.08;
/// Half-life of lowering the hips, seconds.
const LOWER_HALF_LIFE_SECS: f64 = 0.03;

/// The greatest number of poses from which the axes of the knees are computed.
const MAX_EXAMPLES: usize = 240;

/// Half-life of lifting a foot and setting it down, seconds.
const LIFT_HALF_LIFE_SECS: f64 = 0.04;

/// The speed that planting may add to a joint, as a share of the speed that the joint usually does
/// not exceed.
const ADDED_SPEED: f32 = 0.75;

/// Steps a number as [`spring::towards`] does, in single precision.
fn towards_f32(
    value: f32,
    rate: f32,
    target: f32,
    half_life_secs: f64,
    dt_secs: f64,
) -> (f32, f32) {
    let (value, rate) = spring::towards(
        f64::from(value),
        f64::from(rate),
        f64::from(target),
        half_life_secs,
        dt_secs,
    );
    (value as f32, rate as f32)
}

/// Returns the clearance of a foot that moves over the ground at this speed, metres and metres per
/// second for a body of 1.75 m.
fn clearance(speed_mps: f32) -> f32 {
    MAX_CLEARANCE_M
        * smoothstep((speed_mps - MIN_CLEARANCE_MPS) / (FULL_CLEARANCE_MPS - MIN_CLEARANCE_MPS))
}

#[derive(Clone, Debug)]
struct Foot {
    /// The index of the foot.
    index: usize,
    leg: Limb,
    axis: Vec3,
    points: Vec<(usize, Vec3)>,
    before: Vec<Vec3>,
    shift: Vec3,
    rate: Vec3,
    lift: f32,
    lift_rate: f32,
    /// The total correction of its ankle, relative to the hips of the clip.
    moved: Vec3,
    stands: bool,
    released: bool,
    /// The corrections of thigh, shin and foot in the last tick, applied on the left of their local
    /// rotations.
    turned: [Quat; 3],
}

impl Feet {
    pub(super) fn new(database: &Database) -> Self {
        let (skeleton, roles) = (database.skeleton(), database.roles());
        // The axis of a knee is measured where the knee bends. All motions are used, because in
        // some of them it never does.
        let poses =
            || (0..database.frames()).step_by(database.frames().div_ceil(MAX_EXAMPLES).max(1));
        let examples: Vec<WorldPose> = poses()
            .filter_map(|frame| database.place(frame))
            .filter_map(|place| Some(database.motion(place.motion)?.clip().world_pose(place.frame)))
            .collect();
        let foot = |&foot: &skeleton::Foot| {
            let leg = Limb::on(skeleton, roles, foot)?;
            Some(Foot {
                index: foot.index(),
                axis: leg.usual_axis(examples.iter().map(|world| leg.pose(world))),
                leg,
                points: roles.foot_points(skeleton, foot),
                before: Vec::new(),
                shift: Vec3::ZERO,
                rate: Vec3::ZERO,
                lift: 0.0,
                lift_rate: 0.0,
                moved: Vec3::ZERO,
                stands: false,
                released: false,
                turned: [Quat::IDENTITY; 3],
            })
        };
        let of_body = skeleton::Foot::of(roles.body_plan());
        let feet: Vec<Foot> = of_body.iter().filter_map(foot).collect();
        let joints = feet.iter().flat_map(|foot| foot.points.iter().map(|&(joint, _)| joint));
        Self {
            needed: skeleton.with_ancestors(joints),
            all: feet,
            scale: roles.body_height(skeleton) / REFERENCE_HEIGHT_M as f32,
            ground_m: database.ground_m(),
            stand_m: database.stand_m(),
            lower: 0.0,
            lower_rate: 0.0,
            world: WorldPose::default(),
        }
    }

    /// Corrects `pose`, which is in the world, by one tick of `dt_secs`; without options only
    /// contacts are computed. `own` are the states of the feet in the clip. Returns which feet are
    /// planted.
    pub(super) fn apply(
        &mut self,
        skeleton: &Skeleton,
        pose: &mut Pose,
        own: [FootState; 4],
        options: Option<&FootPlanting>,
        usual_radps: &[f32],
        dt_secs: f64,
    ) -> [bool; 4] {
        world_pose_of(
            skeleton,
            pose.root_translation,
            &pose.rotations,
            pose.translations.iter().copied(),
            &self.needed,
            &mut self.world,
        );
        let (mut stand, mut too_high) = ([false; 4], 0.0_f32);
        for foot in &mut self.all {
            let now: Vec<Vec3> =
                foot.points.iter().map(|&(joint, point)| self.world.point(joint, point)).collect();
            let lowest = now.iter().map(|point| point.y).fold(f32::INFINITY, f32::min);
            let own = own[foot.index];
            let points = foot.before.get(own.stillest).zip(now.get(own.stillest));
            let step = points.map(|(before, now)| (*now - *before) * Vec3::new(1.0, 0.0, 1.0));
            let slow =
                step.is_some_and(|step| step.length() < LANDED_MPS * self.scale * dt_secs as f32);
            let stood = foot.stands;
            let down = lowest - self.stand_m < LANDED_M * self.scale;
            foot.before = now;
            let Some(options) = options else {
                foot.stands = own.planted && (stood || (slow && down));
                stand[foot.index] = foot.stands;
                (foot.shift, foot.rate, foot.lift, foot.lift_rate) =
                    (Vec3::ZERO, Vec3::ZERO, 0.0, 0.0);
                foot.turned = [Quat::IDENTITY; 3];
                continue;
            };
            let most_shift = options.max_shift_m * self.scale;
            // The part of the step that comes from the body's motion, not from the clip's.
            let over_ground = Vec3::new(1.0, 0.0, 1.0);
            let slip = step.map_or(0.0, |step| {
                (step - own.velocity_mps * over_ground * dt_secs as f32).length()
            });
            let holds = slip < LANDED_MPS * self.scale * dt_secs as f32
                || slip * own.stance_frames as f32 <= most_shift;
            foot.released &= own.planted && foot.shift.length() > RESUME_SHARE * most_shift;
            foot.stands =
                own.planted && !foot.released && (stood || (holds && down && step.is_some()));
            stand[foot.index] = foot.stands;
            let before = foot.shift;
            match step.filter(|_| stood) {
                Some(step) if foot.stands => {
                    foot.shift -= step;
                    foot.rate = -step / dt_secs as f32;
                    foot.released = foot.shift.length() > most_shift;
                    foot.stands = !foot.released;
                }
                // A foot that has just landed stays in place.
                _ if foot.stands => foot.rate = Vec3::ZERO,
                _ => {
                    (foot.shift, foot.rate) = spring::response(options.half_life_secs, dt_secs)
                        .of_vec3(foot.shift, foot.rate);
                }
            }
            let speed = step.map_or(0.0, |step| (step + foot.shift - before).length())
                / (dt_secs as f32 * self.scale);
            let target = if foot.stands {
                0.0
            } else {
                let above = own.above_m / self.scale;
                let own_speed = (own.velocity_mps * over_ground).length() / self.scale;
                if holds {
                    // The clip's own motion is not changed.
                    let clear = clearance(speed).min(clearance(speed - own_speed).max(above));
                    (clear * self.scale + self.stand_m - lowest).max(0.0)
                } else {
                    let clear = clearance(slip / (dt_secs as f32 * self.scale));
                    (clear * self.scale + self.stand_m - (lowest - own.descent_m)).max(0.0)
                }
            };
            (foot.lift, foot.lift_rate) =
                towards_f32(foot.lift, foot.lift_rate, target, LIFT_HALF_LIFE_SECS, dt_secs);
            foot.moved = foot.shift + Vec3::Y * (foot.lift + (self.ground_m - lowest).max(0.0));
            too_high = too_high.max(foot.leg.too_high(&self.world, foot.moved));
        }
        if options.is_none() {
            (self.lower, self.lower_rate) = (0.0, 0.0);
            return stand;
        }
        let target = too_high.min(MAX_LOWERED_M * self.scale);
        (self.lower, self.lower_rate) =
            towards_f32(self.lower, self.lower_rate, target, LOWER_HALF_LIFE_SECS, dt_secs);
        pose.root_translation.y -= self.lower;
        for foot in &mut self.all {
            let shift = foot.moved + Vec3::Y * self.lower;
            let free = foot.leg.joints().map(|joint| pose.rotations[joint]);
            // A correction of a hundredth of a millimetre is invisible.
            if shift.length_squared() > 1e-10 {
                foot.leg.move_ankle(&self.world, shift, foot.axis, &mut pose.rotations);
            } else if foot.turned == [Quat::IDENTITY; 3] {
                continue;
            }
            foot.limit_speed(free, &mut pose.rotations, usual_radps, dt_secs as f32);
        }
        stand
    }
}

impl Foot {
    /// Limits the change of the leg's correction since the last tick to the speed that its joints
    /// may have. `free` are their local rotations without planting.
    fn limit_speed(
        &mut self,
        free: [Quat; 3],
        local: &mut [Quat],
        usual_radps: &[f32],
        dt_secs: f32,
    ) {
        let joints = self.leg.joints();
        let usual = |joint: usize| usual_radps.get(joint).copied().unwrap_or(f32::INFINITY);
        let most_turn = joints.map(|joint| ADDED_SPEED * usual(joint) * dt_secs);
        let wanted: [Quat; 3] = std::array::from_fn(|index| {
            quat::renormalize(local[joints[index]] * free[index].conjugate())
        });
        self.turned = towards(self.turned, wanted, most_turn);
        // Unlimited corrections are kept as computed, bit for bit.
        if self.turned != wanted {
            for (index, joint) in joints.into_iter().enumerate() {
                local[joint] = quat::renormalize(self.turned[index] * free[index]);
            }
        }
    }
}

/// Interpolates the corrections of a leg's joints from the last ones towards the wanted ones, all
/// by the same share, so that none turns by more than `most_turn`; returns the wanted ones where
/// possible.
fn towards(last: [Quat; 3], wanted: [Quat; 3], most_turn: [f32; 3]) -> [Quat; 3] {
    let mut share = 1.0_f32;
    for ((last, wanted), most) in last.into_iter().zip(wanted).zip(most_turn) {
        let angle = quat::angle_between(last, wanted);
        if angle > most {
            share = share.min(most / angle);
        }
    }
    if share >= 1.0 {
        return wanted;
    }
    std::array::from_fn(|index| quat::slerp(last[index], wanted[index], share))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clip::{Clip, Motion};
    use crate::matching::DatabaseOptions;
    use crate::skeleton::{Role, Side};
    use crate::synth::{Action, Params, synthesize};
    use std::sync::Arc;

    const PLANTING: FootPlanting = FootPlanting { half_life_secs: 0.08, max_shift_m: 0.3 };
    const TICK_SECS: f64 = 1.0 / 60.0;

    fn database(actions: &[Action]) -> Database {
        let clips = actions.iter().map(|&action| {
            Arc::new(Motion::analyze(synthesize(&Params::new(action)).unwrap().clip))
        });
        let options =
            DatabaseOptions { mirrored: false, cycles: false, ..DatabaseOptions::default() };
        Database::new(clips.collect(), &options).unwrap()
    }

    /// Plays a clip through `change`, with `own` as the state of the left foot in each frame;
    /// returns the corrected poses.
    fn played(
        database: &Database,
        usual: &[f32],
        frames: std::ops::Range<usize>,
        own: impl Fn(usize) -> FootState,
        change: impl Fn(usize, &mut Pose),
    ) -> Vec<Pose> {
        let clip: &Clip = database.motion(0).unwrap().clip();
        let mut feet = Feet::new(database);
        let pose = |frame: usize| {
            let mut pose = clip.pose(frame);
            change(frame, &mut pose);
            let mut feet_own = [FootState::default(); 4];
            feet_own[0] = own(frame);
            feet.apply(database.skeleton(), &mut pose, feet_own, Some(&PLANTING), usual, TICK_SECS);
            pose
        };
        frames.map(pose).collect()
    }

    fn left_foot(database: &Database, pose: &Pose) -> Vec3 {
        let (skeleton, roles) = (database.skeleton(), database.roles());
        let moved = pose.translations.iter().copied();
        let (mut world, needed) = (WorldPose::default(), (0..skeleton.len()).collect::<Vec<_>>());
        world_pose_of(skeleton, pose.root_translation, &pose.rotations, moved, &needed, &mut world);
        world.positions[roles.get(Role::LeftFoot).unwrap()]
    }

    #[test]
    fn released_foot_does_not_snap_the_knee() {
        let database = database(&[Action::Walk]);
        let motion = database.motion(0).unwrap();
        let pace = &motion.pace().joints_radps;
        let stances = motion.contacts().intervals(Side::Left);
        let stance = stances.into_iter().find(|stance| stance.start > 0).unwrap();
        // The foot is marked as planted for longer than it is, as with a wrong contact: the body
        // walks on, and the leg is stretched.
        let own =
            |frame: usize| FootState { planted: frame < stance.end + 8, ..motion.feet(frame)[0] };
        let fastest = |usual: &[f32]| {
            let poses = played(&database, usual, stance.start..motion.frames(), own, |_, _| {});
            let legs = Side::BOTH.map(|side| {
                Limb::leg(database.skeleton(), database.roles(), side).unwrap().joints()
            });
            let speed = |joint: usize, pair: &[Pose]| {
                quat::angle_between(pair[0].rotations[joint], pair[1].rotations[joint])
                    / TICK_SECS as f32
            };
            let of_leg = |joint: usize| {
                poses.windows(2).map(|pair| speed(joint, pair)).fold(0.0, f32::max) / pace[joint]
            };
            legs.into_iter().flatten().map(of_leg).fold(0.0, f32::max)
        };
        let (free, held) = (fastest(&[]), fastest(pace));
        assert!(free > 2.0, "{free}");
        assert!(held <= 1.0 + ADDED_SPEED + 0.05, "{held}");
    }

    /// A standing body is pushed over the ground, with its feet in the air in the clip or planted:
    /// a moving foot is lifted, a planted one stays.
    #[test]
    fn foot_moved_over_the_ground_is_lifted() {
        let database = database(&[Action::Idle]);
        let push = |frame: usize, pose: &mut Pose| {
            pose.root_translation += Vec3::X * 0.005 * frame.saturating_sub(10) as f32;
        };
        let path = |own: FootState| {
            let poses = played(&database, &[], 0..40, |_| own, push);
            poses.iter().map(|pose| left_foot(&database, pose)).collect::<Vec<_>>()
        };
        let stands = FootState { planted: true, ..FootState::default() };
        let stood = path(stands);
        assert!(stood[39].distance(stood[1]) < 4e-3, "{} {}", stood[1], stood[39]);
        let moved = path(FootState::default());
        // At 0.3 m/s it is lifted neither fully nor at once.
        assert!(
            (moved[39] - moved[0]).x > 0.14 && moved[39].y - moved[0].y > 0.01,
            "{} {}",
            moved[0],
            moved[39]
        );
        assert!(moved.windows(2).all(|pair| pair[1].y - pair[0].y < 6e-3));
        // The clip's own motion is not changed.
        let own = path(FootState {
            above_m: database.motion(0).unwrap().feet(0)[0].above_m,
            velocity_mps: Vec3::X * 0.3,
            ..FootState::default()
        });
        assert!((own[39].y - own[0].y).abs() < 1e-3, "{} {}", own[0], own[39]);
    }

    /// A body that is pulled back to a slower pace carries its feet over the ground: a foot that
    /// can be held for all of its stance is planted.
    #[test]
    fn carried_foot_is_planted_where_it_can_be_held() {
        let database = database(&[Action::Idle]);
        let push =
            |frame: usize, pose: &mut Pose| pose.root_translation += Vec3::X * 0.015 * frame as f32;
        let way = |stance: std::ops::Range<usize>| {
            let own = |frame: usize| FootState {
                planted: stance.contains(&frame),
                stance_frames: if stance.contains(&frame) { stance.end - frame } else { 0 },
                ..FootState::default()
            };
            let poses = played(&database, &[], 0..stance.end, own, push);
            left_foot(&database, &poses[stance.end - 1])
                .distance(left_foot(&database, &poses[stance.start]))
        };
        let (short, long) = (way(20..32), way(20..60));
        // At 0.9 m/s these stances are 18 and 60 cm long, and a foot is held for 30 cm: of the long
        // one in the second half.
        assert!(short < 0.04, "{short}");
        assert!(long > 0.25 && long < 0.35, "{long}");
    }

    /// A foot that cannot be held is in the air when it would land, and does not touch the ground
    /// while it moves.
    #[test]
    fn foot_carried_too_far_is_lifted_before_landing() {
        let database = database(&[Action::Run]);
        let motion = database.motion(0).unwrap();
        let push = |frame: usize, pose: &mut Pose| {
            pose.root_translation -= Vec3::Z * (2.0 * TICK_SECS as f32) * frame as f32;
        };
        let own = |frame: usize| motion.feet(frame)[0].turned(&motion.root(frame));
        let poses = played(&database, &[], 0..motion.frames(), own, push);
        let leg = &Feet::new(&database).all[0];
        let needed: Vec<usize> = (0..database.skeleton().len()).collect();
        let lowest = |pose: &Pose| {
            let (moved, mut world) = (pose.translations.iter().copied(), WorldPose::default());
            world_pose_of(
                database.skeleton(),
                pose.root_translation,
                &pose.rotations,
                moved,
                &needed,
                &mut world,
            );
            let heights = leg.points.iter().map(|&(joint, point)| world.point(joint, point).y);
            heights.fold(f32::INFINITY, f32::min) - database.ground_m()
        };
        let landings: Vec<usize> = (20..motion.frames())
            .filter(|&frame| own(frame).planted && !own(frame - 1).planted)
            .collect();
        assert!(landings.len() >= 2, "{landings:?}");
        for landing in landings {
            let height = lowest(&poses[landing]);
            assert!(height > 0.05, "{landing}: {height} m");
        }
    }

    /// A stance is not given up for good: where the foot is back at its animated position it is
    /// planted again.
    #[test]
    fn released_foot_is_planted_again() {
        let database = database(&[Action::Idle]);
        let stands = FootState { planted: true, ..FootState::default() };
        // A push by 0.5 m, farther than a foot is held.
        let push = |frame: usize, pose: &mut Pose| {
            pose.root_translation += Vec3::X * (0.01 * frame.clamp(10, 60) as f32);
        };
        let poses = played(&database, &[], 0..140, |_| stands, push);
        let feet: Vec<Vec3> = poses.iter().map(|pose| left_foot(&database, pose)).collect();
        assert!(feet[20].distance(feet[11]) < 4e-3, "{} {}", feet[11], feet[20]);
        assert!(feet[139].x - feet[11].x > 0.3, "{} {}", feet[11], feet[139]);
        assert!(feet.windows(2).skip(110).all(|pair| pair[1].distance(pair[0]) < 1e-3));
        let highest = feet.iter().map(|foot| foot.y).fold(0.0, f32::max);
        assert!(highest - feet[0].y > 0.01, "it steps: {highest}");
    }

    #[test]
    fn knee_axes_come_from_all_motions() {
        let [walk, both] = [&[Action::Walk][..], &[Action::Idle, Action::Walk]]
            .map(|actions| Feet::new(&database(actions)));
        for (walk, both) in walk.all.iter().zip(&both.all) {
            assert!(walk.axis.angle_between(both.axis) < 0.15, "{} {}", walk.axis, both.axis);
        }
    }
}
