use super::options::FootPlanting;
use crate::clip::stillest_step;
use crate::math::spring;
use crate::registration::REFERENCE_HEIGHT_M;
use crate::skeleton::{Pose, Roles, Side, Skeleton, WorldPose, world_pose_of};
use crate::transition::Leg;
use glam::Vec3;

/// Plants feet while playing: what [`crate::transition::foot_lock`] does with a whole clip, without knowing what comes.
///
/// While a foot is said to stand, the slide of the point of it that moves least is taken back, tick by tick, so that this point stands exactly. The
/// shift that has come together then decays, with its velocity, when the foot is lifted. A foot that would be held too far from its own way is
/// let go until it is lifted. What is below the ground is lifted out of it.
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
            // A hundredth of a millimetre is not seen.
            if shift.length_squared() > 1e-10 {
                foot.leg.move_ankle(&self.world, shift, foot.axis, &mut pose.rotations);
            }
        }
        stand
    }
}
