use super::options::FootPlanting;
use crate::clip::stillest_step;
use crate::math::{quat, spring};
use crate::registration::REFERENCE_HEIGHT_M;
use crate::skeleton::{Pose, Roles, Side, Skeleton, WorldPose, world_pose_of};
use crate::transition::Leg;
use glam::{Quat, Vec3};

/// Plants feet while playing: what [`crate::transition::foot_lock`] does with a whole clip, without knowing what comes.
///
/// While a foot is said to stand, the slide of the point of it that moves least is taken back, tick by tick, so that this point stands exactly. The
/// shift that has come together then decays, with its velocity, when the foot is lifted. A foot that would be held too far from its own way is
/// let go until it is lifted. What is below the ground is lifted out of it.
///
/// None of this turns a joint of the leg faster, beyond its own motion, than three quarters of what it usually does not exceed: a leg that is nearly
/// straight would snap when its foot is let go, since there a centimetre is many degrees of the knee. The foot slips a little then.
///
/// A foot comes to stand when the clip says so *and* it has come down: right after a jump it may still be on its way to where the new clip has it.
#[derive(Clone, Debug)]
pub(super) struct Feet {
    both: Vec<Foot>,
    needed: Vec<usize>,
    scale: f32,
    ground_m: f32,
    world: WorldPose,
}

/// A foot has come down when it is no higher than this above the ground, metres for a body of 1.75 m, and slower than this, metres per second:
/// a little more than what [`crate::clip::ContactOptions`] asks for, since what is left of a transition sways it.
const DOWN_M: f32 = 0.06;
const DOWN_MPS: f32 = 0.6;

/// Of the speed that a joint usually does not exceed, what planting may add to it.
const ADDED_SPEED: f32 = 0.75;

#[derive(Clone, Debug)]
struct Foot {
    side: Side,
    leg: Leg,
    axis: Vec3,
    points: Vec<(usize, Vec3)>,
    before: Vec<Vec3>,
    shift: Vec3,
    rate: Vec3,
    stands: bool,
    let_go: bool,
    /// What planting did to thigh, shin and foot in the last tick: on the left of their local rotations.
    turned: [Quat; 3],
}

impl Feet {
    /// `examples` are poses that tell about which axis the knees bend; `ground_m` is the height of the ground.
    pub(super) fn new(skeleton: &Skeleton, roles: &Roles, examples: &[WorldPose], ground_m: f32) -> Self {
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
            ground_m,
            world: WorldPose::default(),
        }
    }

    /// One tick of `dt_secs`: `planted` says which feet the clip has on the ground; `pose` is in the world and is corrected, where there are options.
    /// Which feet stand.
    pub(super) fn apply(
        &mut self,
        skeleton: &Skeleton,
        pose: &mut Pose,
        planted: [bool; 2],
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
        let mut stand = [false; 2];
        for foot in &mut self.both {
            let now: Vec<Vec3> = foot.points.iter().map(|&(joint, point)| self.world.point(joint, point)).collect();
            let lowest = now.iter().map(|point| point.y).fold(f32::INFINITY, f32::min);
            let step = stillest_step(&foot.before, &now);
            let slow = step.is_some_and(|step| step.length() < DOWN_MPS * self.scale * dt_secs as f32);
            let stood = foot.stands;
            // Feet that dip into the floor at push-off set the ground lower than where they stand.
            let planted = planted[foot.side.index()] && (stood || (slow && lowest - self.ground_m.max(0.0) < DOWN_M * self.scale));
            foot.stands = planted;
            foot.before = now;
            stand[foot.side.index()] = planted;
            let Some(options) = options else {
                (foot.shift, foot.rate) = (Vec3::ZERO, Vec3::ZERO);
                foot.turned = [Quat::IDENTITY; 3];
                continue;
            };
            foot.let_go &= planted;
            match step.filter(|_| planted && stood && !foot.let_go) {
                Some(step) => {
                    foot.shift -= step;
                    foot.rate = -step / dt_secs as f32;
                    foot.let_go = foot.shift.length() > options.most_shift_m * self.scale;
                }
                // Set down just now: it stays where it is.
                None if planted && !foot.let_go => foot.rate = Vec3::ZERO,
                None => (foot.shift, foot.rate) = spring::response(options.half_life_secs, dt_secs).of_vec3(foot.shift, foot.rate),
            }
            let shift = foot.shift + Vec3::Y * (self.ground_m - lowest).max(0.0);
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
    /// Goes from what was done to the leg in the last tick only as far towards what was done now as its joints may turn in a tick. `free` are their local
    /// rotations without planting.
    fn turn_no_faster(&mut self, free: [Quat; 3], local: &mut [Quat], usual_radps: &[f32], dt_secs: f32) {
        let joints = self.leg.joints();
        let usual = |joint: usize| usual_radps.get(joint).copied().unwrap_or(f32::INFINITY);
        let most_turn = joints.map(|joint| ADDED_SPEED * usual(joint) * dt_secs);
        let wanted: [Quat; 3] = std::array::from_fn(|index| quat::renormalize(local[joints[index]] * free[index].conjugate()));
        self.turned = towards(self.turned, wanted, most_turn);
        // What is not held back stays as it was worked out, bit for bit.
        if self.turned != wanted {
            for (index, joint) in joints.into_iter().enumerate() {
                local[joint] = quat::renormalize(self.turned[index] * free[index]);
            }
        }
    }
}

/// From what was done to the joints of a leg as far towards what is wanted as each may turn, all by the same share; what is wanted where they may.
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
    use crate::clip::{ContactOptions, Contacts, character_frames};
    use crate::matching::pace::Pace;
    use crate::matching::simulation_roots;
    use crate::synth::{Action, Params, synthesize};

    #[test]
    fn a_foot_that_is_let_go_does_not_snap_the_knee() {
        let clip = synthesize(&Params::new(Action::Walk)).unwrap().clip;
        let roles = Roles::detect(clip.skeleton());
        let contacts = Contacts::detect(&clip, &roles, &ContactOptions::default());
        let pace = Pace::of(&clip, &simulation_roots(&character_frames(&clip, &roles)));
        let examples: Vec<WorldPose> = (0..clip.frames()).step_by(5).map(|frame| clip.world_pose(frame)).collect();
        let stance = contacts.intervals(Side::Left).into_iter().find(|stance| stance.start > 0).unwrap();
        // The foot is said to stand for longer than it does, as a wrong contact has it: the body walks on, and the leg is stretched.
        let fastest = |usual: &[f32]| {
            let mut feet = Feet::new(clip.skeleton(), &roles, &examples, 0.0);
            let (mut fastest, mut before): (f32, Option<Vec<Quat>>) = (0.0, None);
            for frame in stance.start..clip.frames() {
                let mut pose = clip.pose(frame);
                let planted = [frame < stance.end + 8, false];
                let options = FootPlanting {
                    half_life_secs: 0.08,
                    most_shift_m: 0.3,
                };
                feet.apply(clip.skeleton(), &mut pose, planted, Some(&options), usual, 1.0 / clip.fps());
                for joint in feet.both.iter().flat_map(|foot| foot.leg.joints()) {
                    if let Some(before) = &before {
                        let speed = quat::angle_between(before[joint], pose.rotations[joint]) * clip.fps() as f32;
                        fastest = fastest.max(speed / pace.joints_radps[joint]);
                    }
                }
                before = Some(pose.rotations);
            }
            fastest
        };
        let (free, held) = (fastest(&[]), fastest(&pace.joints_radps));
        assert!(free > 2.0, "{free}");
        assert!(held <= 1.0 + ADDED_SPEED + 0.05, "{held}");
    }
}
