use super::super::Database;
use super::options::FootPlanting;
use crate::math::curve::smoothstep;
use crate::math::{Planar, quat, spring};
use crate::registration::REFERENCE_HEIGHT_M;
use crate::skeleton::{Pose, Side, Skeleton, WorldPose, world_pose_of};
use crate::transition::Leg;
use glam::{Quat, Vec3};

/// Plants feet while playing: what [`crate::transition::foot_lock`] does with a whole clip, without
/// knowing what comes.
///
/// While a foot is said to stand, the slide of the point of it that moves least in its clip is
/// taken back, tick by tick, so that this point stands exactly. The shift that has come together
/// then decays, with its velocity, when the foot is lifted. A foot that would be held too far from
/// its own way is let go until it is lifted. What is below the ground is lifted out of it.
///
/// Where a leg cannot reach the place where its foot stands, the hips are lowered.
///
/// None of this turns a joint of the leg faster, beyond its own motion, than three quarters of what
/// it usually does not exceed: a leg that is nearly straight would snap when its foot is let go,
/// since there a centimetre is many degrees of the knee. The foot slips a little then.
///
/// A foot comes to stand when the clip says so *and* it has come down: right after a jump it may
/// still be on its way to where the new clip has it. Where the body carries it over the ground, as
/// one that is pulled back to a slower pace does, it stands if it can be held until its clip lifts
/// it; else it is lifted before it lands. One that was let go comes to stand again when it is back
/// on its own way.
///
/// What moves over the ground is off it: a foot that a transition, a pull towards the wish or the
/// way back from where it stood moves over the ground faster than its clip does is lifted, as in a
/// step, and not dragged.
#[derive(Clone, Debug)]
pub(super) struct Feet {
    both: Vec<Foot>,
    needed: Vec<usize>,
    scale: f32,
    ground_m: f32,
    stand_m: f32,
    /// How far the hips are lowered, metres, and how fast.
    lower: f32,
    lower_rate: f32,
    world: WorldPose,
}

/// A foot has come down when it is no higher than this above the ground, metres for a body of 1.75
/// m, and the body does not carry it over the ground faster than this, metres per second: a little
/// more than what [`crate::clip::ContactOptions`] asks for, since what is left of a transition
/// sways it.
const DOWN_M: f32 = 0.06;
const DOWN_MPS: f32 = 0.6;

/// A foot that was let go may stand again when no more than this share of
/// [`FootPlanting::most_shift_m`] is left.
const BACK_SHARE: f32 = 0.25;

/// A foot that is moved over the ground is lifted by this, metres for a body of 1.75 m: enough for
/// what is seen as sliding to be a step.
const LIFT_M: f32 = 0.04;
/// It is so above this speed, metres per second; slower than [`SLIP_MPS`] it stays down.
const LIFTED_MPS: f32 = 0.5;
const SLIP_MPS: f32 = 0.05;
/// The hips are lowered by no more than this, metres for a body of 1.75 m, where a leg cannot reach
/// the place where its foot stands.
const MAX_LOWERED_M: f32 = 0.08;
/// Half-life of that, seconds.
const LOWER_HALF_LIFE_SECS: f64 = 0.03;

/// Poses from which it is seen about which axis knees bend, at most.
const EXAMPLES: usize = 240;

/// Half-life of lifting and setting down, seconds.
const LIFT_HALF_LIFE_SECS: f64 = 0.04;

/// Of the speed that a joint usually does not exceed, what planting may add to it.
const ADDED_SPEED: f32 = 0.75;

/// What a foot does in the frame that plays.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(in super::super) struct OwnFoot {
    /// Whether it is on the ground.
    pub(in super::super) planted: bool,
    /// For how many more frames it stays there, this one among them; shortly before it lands, for
    /// how many it will. 0 in the air.
    pub(in super::super) stance_frames: usize,
    /// How high its lowest point is above where it is as a rule while the foot stands, metres.
    pub(in super::super) above_m: f32,
    /// How far its lowest point comes down in the next frames, metres.
    pub(in super::super) falls_m: f32,
    /// Which of its points moves least over the ground: while it is pulled along, another one may
    /// seem to stand.
    pub(in super::super) stillest: usize,
    /// The velocity of that point, metres per second, in the frame of the character.
    pub(in super::super) velocity_mps: Vec3,
}

impl OwnFoot {
    /// The same in the world, where the character is here.
    pub(super) fn turned(self, world_from_character: &Planar) -> Self {
        Self { velocity_mps: world_from_character.apply_vector(self.velocity_mps), ..self }
    }
}

/// [`spring::towards`] in single precision.
fn towards_number(
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

/// How high a foot is to be that moves over the ground at this speed, metres and metres per second
/// for a body of 1.75 m.
fn clearance(speed_mps: f32) -> f32 {
    LIFT_M * smoothstep((speed_mps - SLIP_MPS) / (LIFTED_MPS - SLIP_MPS))
}

#[derive(Clone, Debug)]
struct Foot {
    side: Side,
    leg: Leg,
    axis: Vec3,
    points: Vec<(usize, Vec3)>,
    before: Vec<Vec3>,
    shift: Vec3,
    rate: Vec3,
    lift: f32,
    lift_rate: f32,
    /// How far its ankle is moved in all, against the hips as they are in the clip.
    moved: Vec3,
    stands: bool,
    let_go: bool,
    /// What planting did to thigh, shin and foot in the last tick: on the left of their local
    /// rotations.
    turned: [Quat; 3],
}

impl Feet {
    pub(super) fn new(database: &Database) -> Self {
        let (skeleton, roles) = (database.skeleton(), database.roles());
        // How a knee bends can be seen where it bends: of all motions, since in some nobody bends
        // one.
        let poses = || (0..database.frames()).step_by(database.frames().div_ceil(EXAMPLES).max(1));
        let examples: Vec<WorldPose> = poses()
            .filter_map(|frame| database.place(frame))
            .filter_map(|place| Some(database.motion(place.motion)?.clip().world_pose(place.frame)))
            .collect();
        let foot = |side: Side| {
            let leg = Leg::find(skeleton, roles, side)?;
            Some(Foot {
                side,
                axis: leg.usual_axis(examples.iter()),
                leg,
                points: roles.foot_points(skeleton, side),
                before: Vec::new(),
                shift: Vec3::ZERO,
                rate: Vec3::ZERO,
                lift: 0.0,
                lift_rate: 0.0,
                moved: Vec3::ZERO,
                stands: false,
                let_go: false,
                turned: [Quat::IDENTITY; 3],
            })
        };
        let feet: Vec<Foot> = Side::BOTH.into_iter().filter_map(foot).collect();
        let joints = feet.iter().flat_map(|foot| foot.points.iter().map(|&(joint, _)| joint));
        Self {
            needed: skeleton.with_ancestors(joints),
            both: feet,
            scale: roles.body_height(skeleton) / REFERENCE_HEIGHT_M as f32,
            ground_m: database.ground_m(),
            stand_m: database.stand_m(),
            lower: 0.0,
            lower_rate: 0.0,
            world: WorldPose::default(),
        }
    }

    /// One tick of `dt_secs`: `own` is what the feet do in the clip; `pose` is in the world and is
    /// corrected, where there are options. Which feet stand.
    pub(super) fn apply(
        &mut self,
        skeleton: &Skeleton,
        pose: &mut Pose,
        own: [OwnFoot; 2],
        options: Option<&FootPlanting>,
        usual_radps: &[f32],
        dt_secs: f64,
    ) -> [bool; 2] {
        world_pose_of(
            skeleton,
            pose.root_translation,
            &pose.rotations,
            pose.translations.iter().copied(),
            &self.needed,
            &mut self.world,
        );
        let (mut stand, mut too_high) = ([false; 2], 0.0_f32);
        for foot in &mut self.both {
            let now: Vec<Vec3> =
                foot.points.iter().map(|&(joint, point)| self.world.point(joint, point)).collect();
            let lowest = now.iter().map(|point| point.y).fold(f32::INFINITY, f32::min);
            let own = own[foot.side.index()];
            let points = foot.before.get(own.stillest).zip(now.get(own.stillest));
            let step = points.map(|(before, now)| (*now - *before) * Vec3::new(1.0, 0.0, 1.0));
            let slow =
                step.is_some_and(|step| step.length() < DOWN_MPS * self.scale * dt_secs as f32);
            let stood = foot.stands;
            let down = lowest - self.stand_m < DOWN_M * self.scale;
            foot.before = now;
            let Some(options) = options else {
                foot.stands = own.planted && (stood || (slow && down));
                stand[foot.side.index()] = foot.stands;
                (foot.shift, foot.rate, foot.lift, foot.lift_rate) =
                    (Vec3::ZERO, Vec3::ZERO, 0.0, 0.0);
                foot.turned = [Quat::IDENTITY; 3];
                continue;
            };
            let most_shift = options.most_shift_m * self.scale;
            // What the body's way over the ground adds to the foot's own.
            let over_ground = Vec3::new(1.0, 0.0, 1.0);
            let slip = step.map_or(0.0, |step| {
                (step - own.velocity_mps * over_ground * dt_secs as f32).length()
            });
            let holds = slip < DOWN_MPS * self.scale * dt_secs as f32
                || slip * own.stance_frames as f32 <= most_shift;
            foot.let_go &= own.planted && foot.shift.length() > BACK_SHARE * most_shift;
            foot.stands =
                own.planted && !foot.let_go && (stood || (holds && down && step.is_some()));
            stand[foot.side.index()] = foot.stands;
            let before = foot.shift;
            match step.filter(|_| stood) {
                Some(step) if foot.stands => {
                    foot.shift -= step;
                    foot.rate = -step / dt_secs as f32;
                    foot.let_go = foot.shift.length() > most_shift;
                    foot.stands = !foot.let_go;
                }
                // Set down just now: it stays where it is.
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
                    // What the clip itself does is left alone.
                    let clear = clearance(speed).min(clearance(speed - own_speed).max(above));
                    (clear * self.scale + self.stand_m - lowest).max(0.0)
                } else {
                    let clear = clearance(slip / (dt_secs as f32 * self.scale));
                    (clear * self.scale + self.stand_m - (lowest - own.falls_m)).max(0.0)
                }
            };
            (foot.lift, foot.lift_rate) =
                towards_number(foot.lift, foot.lift_rate, target, LIFT_HALF_LIFE_SECS, dt_secs);
            foot.moved = foot.shift + Vec3::Y * (foot.lift + (self.ground_m - lowest).max(0.0));
            too_high = too_high.max(foot.leg.too_high(&self.world, foot.moved));
        }
        if options.is_none() {
            (self.lower, self.lower_rate) = (0.0, 0.0);
            return stand;
        }
        let target = too_high.min(MAX_LOWERED_M * self.scale);
        (self.lower, self.lower_rate) =
            towards_number(self.lower, self.lower_rate, target, LOWER_HALF_LIFE_SECS, dt_secs);
        pose.root_translation.y -= self.lower;
        for foot in &mut self.both {
            let shift = foot.moved + Vec3::Y * self.lower;
            let free = foot.leg.joints().map(|joint| pose.rotations[joint]);
            // A hundredth of a millimetre is not seen.
            if shift.length_squared() > 1e-10 {
                foot.leg.move_ankle(&self.world, shift, foot.axis, &mut pose.rotations);
            } else if foot.turned == [Quat::IDENTITY; 3] {
                continue;
            }
            foot.turn_no_faster(free, &mut pose.rotations, usual_radps, dt_secs as f32);
        }
        stand
    }
}

impl Foot {
    /// Goes from what was done to the leg in the last tick only as far towards what was done now as
    /// its joints may turn in a tick. `free` are their local rotations without planting.
    fn turn_no_faster(
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
        // What is not held back stays as it was worked out, bit for bit.
        if self.turned != wanted {
            for (index, joint) in joints.into_iter().enumerate() {
                local[joint] = quat::renormalize(self.turned[index] * free[index]);
            }
        }
    }
}

/// From what was done to the joints of a leg as far towards what is wanted as each may turn, all by
/// the same share; what is wanted where they may.
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
    use crate::clip::Clip;
    use crate::matching::{DatabaseOptions, MatchClip};
    use crate::skeleton::{Role, Roles};
    use crate::synth::{Action, Params, synthesize};
    use std::sync::Arc;

    const PLANTING: FootPlanting = FootPlanting { half_life_secs: 0.08, most_shift_m: 0.3 };
    const TICK_SECS: f64 = 1.0 / 60.0;

    fn database(actions: &[Action]) -> Database {
        let clips = actions.iter().map(|&action| {
            let clip = synthesize(&Params::new(action)).unwrap().clip;
            let roles = Roles::detect(clip.skeleton());
            MatchClip::new(Arc::new(clip), roles)
        });
        let options =
            DatabaseOptions { mirrored: false, cycles: false, ..DatabaseOptions::default() };
        Database::new(clips.collect(), &options).unwrap()
    }

    /// Plays a clip, the left foot doing what `own` says of each frame, through `change`: what each
    /// pose comes to.
    fn played(
        database: &Database,
        usual: &[f32],
        frames: std::ops::Range<usize>,
        own: impl Fn(usize) -> OwnFoot,
        change: impl Fn(usize, &mut Pose),
    ) -> Vec<Pose> {
        let clip: &Clip = database.motion(0).unwrap().clip();
        let mut feet = Feet::new(database);
        let pose = |frame: usize| {
            let mut pose = clip.pose(frame);
            change(frame, &mut pose);
            let own = [own(frame), OwnFoot::default()];
            feet.apply(database.skeleton(), &mut pose, own, Some(&PLANTING), usual, TICK_SECS);
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
    fn a_foot_that_is_let_go_does_not_snap_the_knee() {
        let database = database(&[Action::Walk]);
        let motion = database.motion(0).unwrap();
        let pace = &motion.pace().joints_radps;
        let stances = motion.contacts().intervals(Side::Left);
        let stance = stances.into_iter().find(|stance| stance.start > 0).unwrap();
        // The foot is said to stand for longer than it does, as a wrong contact has it: the body
        // walks on, and the leg is stretched.
        let own =
            |frame: usize| OwnFoot { planted: frame < stance.end + 8, ..motion.feet(frame)[0] };
        let fastest = |usual: &[f32]| {
            let poses = played(&database, usual, stance.start..motion.frames(), own, |_, _| {});
            let legs = Side::BOTH.map(|side| {
                Leg::find(database.skeleton(), database.roles(), side).unwrap().joints()
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

    /// A body that stands and is pushed over the ground, its feet in the air in the clip or not:
    /// what moves is lifted, what stands stays.
    #[test]
    fn a_foot_that_is_moved_over_the_ground_is_lifted() {
        let database = database(&[Action::Idle]);
        let push = |frame: usize, pose: &mut Pose| {
            pose.root_translation += Vec3::X * 0.005 * frame.saturating_sub(10) as f32;
        };
        let path = |own: OwnFoot| {
            let poses = played(&database, &[], 0..40, |_| own, push);
            poses.iter().map(|pose| left_foot(&database, pose)).collect::<Vec<_>>()
        };
        let stands = OwnFoot { planted: true, ..OwnFoot::default() };
        let stood = path(stands);
        assert!(stood[39].distance(stood[1]) < 4e-3, "{} {}", stood[1], stood[39]);
        let moved = path(OwnFoot::default());
        // It goes at 0.3 m/s: not as fast as to be lifted to the full, and not at once.
        assert!(
            (moved[39] - moved[0]).x > 0.14 && moved[39].y - moved[0].y > 0.01,
            "{} {}",
            moved[0],
            moved[39]
        );
        assert!(moved.windows(2).all(|pair| pair[1].y - pair[0].y < 6e-3));
        // What the clip itself does is left alone.
        let own = path(OwnFoot {
            above_m: database.motion(0).unwrap().feet(0)[0].above_m,
            velocity_mps: Vec3::X * 0.3,
            ..OwnFoot::default()
        });
        assert!((own[39].y - own[0].y).abs() < 1e-3, "{} {}", own[0], own[39]);
    }

    /// A body that is pulled back to a slower pace carries its feet over the ground: one that can
    /// be held for all of its stance is.
    #[test]
    fn a_foot_that_is_carried_along_stands_where_it_can_be_held() {
        let database = database(&[Action::Idle]);
        let push =
            |frame: usize, pose: &mut Pose| pose.root_translation += Vec3::X * 0.015 * frame as f32;
        let way = |stance: std::ops::Range<usize>| {
            let own = |frame: usize| OwnFoot {
                planted: stance.contains(&frame),
                stance_frames: if stance.contains(&frame) { stance.end - frame } else { 0 },
                ..OwnFoot::default()
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

    /// One that cannot be held is in the air when it would land, and does not touch the ground
    /// while it moves.
    #[test]
    fn a_foot_that_is_carried_too_far_is_lifted_before_it_lands() {
        let database = database(&[Action::Run]);
        let motion = database.motion(0).unwrap();
        let push = |frame: usize, pose: &mut Pose| {
            pose.root_translation -= Vec3::Z * (2.0 * TICK_SECS as f32) * frame as f32;
        };
        let own = |frame: usize| motion.feet(frame)[0].turned(&motion.root(frame));
        let poses = played(&database, &[], 0..motion.frames(), own, push);
        let leg = &Feet::new(&database).both[0];
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

    /// One stance is not given up for good: where the foot is back on its own way it stands again.
    #[test]
    fn a_foot_that_was_let_go_stands_again() {
        let database = database(&[Action::Idle]);
        let stands = OwnFoot { planted: true, ..OwnFoot::default() };
        // Pushed by 0.5 m, which is farther than a foot is held.
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
    fn knees_bend_as_they_do_in_any_of_the_motions() {
        let [walk, both] = [&[Action::Walk][..], &[Action::Idle, Action::Walk]]
            .map(|actions| Feet::new(&database(actions)));
        for (walk, both) in walk.both.iter().zip(&both.both) {
            assert!(walk.axis.angle_between(both.axis) < 0.15, "{} {}", walk.axis, both.axis);
        }
    }
}
