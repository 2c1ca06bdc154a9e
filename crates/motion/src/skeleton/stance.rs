//! The canonical stance, in which a body is made around a skeleton: upright, legs apart from each
//! other and arms from the trunk, whatever the file's rest pose is.

use super::joint_map::Landmarks;
use super::{Joint, Role, Roles, Side, Skeleton, WorldPose};
use crate::math::quat;
use glam::{Mat3, Quat, Vec3};
use std::f32::consts::PI;

/// Angle of the arms below level, radians (40°): between their usual position and their limits, so
/// that shoulders bend least.
const ARMS_DOWN_RADIANS: f32 = 0.70;
/// Angle of the bone from the ankle to the ball of the foot below level where the sole is level,
/// radians (27°).
const FOOT_DOWN_RADIANS: f32 = 0.47;
/// Greatest natural angle of the bones up the back and of the head from the vertical, radians
/// (25°).
const MAX_LEAN_RADIANS: f32 = 0.44;
/// Limbs of a rest pose are moved to the stance when they are farther from it than this, radians
/// (57°): arms may be level or hang.
const MAX_LIMB_DEVIATION_RADIANS: f32 = 1.0;
/// A body whose own axes are nearer to those of the world than this keeps its orientation, radians
/// (15°).
const MAX_UPRIGHT_RADIANS: f32 = 0.26;

impl Skeleton {
    /// Returns the skeleton whose rest pose is `stance`: at rest its joints have the positions of
    /// the stance, and the axes of the world.
    #[must_use]
    pub fn resting_in(&self, stance: &WorldPose) -> Self {
        let at = |joint: usize| stance.positions.get(joint).copied().unwrap_or_default();
        let rotation = |joint: usize| stance.rotations.get(joint).copied().unwrap_or_default();
        let joints = self.joints().iter().enumerate().map(|(index, joint)| Joint {
            offset: joint.parent.map_or(joint.offset, |parent| at(index) - at(parent)),
            end_site: joint.end_site.map(|end| rotation(index) * end),
            ..joint.clone()
        });
        Self::new(joints.collect()).unwrap_or_else(|_| self.clone())
    }

    /// Returns the rest pose of the skeleton, with the root at the origin.
    #[must_use]
    pub fn rest_pose(&self) -> WorldPose {
        WorldPose { positions: self.rest_positions(), rotations: vec![Quat::IDENTITY; self.len()] }
    }
}

/// Returns whether the rest pose is that of a standing body: on two legs below its trunk, its head
/// above and its feet ahead, or on four legs. `None` where roles are missing.
///
/// Files may have any rest pose: all bones along one axis, or every joint rotated by a constant.
#[must_use]
pub(crate) fn rest_is_plausible(skeleton: &Skeleton, roles: &Roles) -> Option<bool> {
    let rest = skeleton.rest_positions();
    let body = Landmark::of(&rest, roles)?;
    Some(body.stands_on_two() || body.stands_on_four())
}

/// Returns whether the rest pose is that of a body on two legs, in any direction.
#[must_use]
pub(crate) fn rests_on_two_legs(skeleton: &Skeleton, roles: &Roles) -> bool {
    let body = Landmark::of(&skeleton.rest_positions(), roles);
    body.is_some_and(|body| body.stands_on_two())
}

/// Returns how upright a pose is, from -1 (upside down) to 1 (standing straight): the mean over
/// trunk and legs of the cosine of their angle to the vertical, a bent leg counting for less.
/// `None` where roles are missing.
///
/// A body on four legs is upright where its trunk is level and its legs point down: the mean over
/// the trunk, whose cosine is that to the ground, and all legs.
#[must_use]
pub(crate) fn uprightness(pose: &WorldPose, roles: &Roles) -> Option<f32> {
    let body = Landmark::of(&pose.positions, roles)?;
    if roles.is_quadruped()
        && let Some(arms) = &body.arms
    {
        let down = |limb: &Limb| (limb.start - limb.end).y / limb.length().max(1e-6);
        let legs: f32 = body.legs.iter().chain(arms).map(down).sum();
        let trunk = trunk_of(&body.legs, arms);
        let level = Vec3::new(trunk.x, 0.0, trunk.z).length();
        return Some((level + legs) / 5.0);
    }
    let legs: f32 =
        body.legs.iter().map(|leg| (leg.start - leg.end).y / leg.length().max(1e-6)).sum();
    Some((body.up.y + legs) / 3.0)
}

/// Returns the canonical stance of a skeleton: upright, facing +Z, the root at the origin.
///
/// `reference` is any pose that shows the bones' relative directions, and above all their twist:
/// the rest pose where that is plausible, otherwise a frame in which the body is upright. The whole
/// body is rotated upright. If the reference is a rest pose that stands on its legs, that is all;
/// otherwise the trunk becomes vertical, legs point down, feet ahead, arms to the sides and 40°
/// down. Each bone is moved by the shortest rotation, which keeps its twist; joints without a role
/// follow their parents. Where roles are missing, the reference is the stance.
///
/// A body on four legs ([`BodyPlan::Quadruped`](super::BodyPlan)) is only turned about the
/// vertical, until it faces +Z.
#[must_use]
pub fn canonical_stance(skeleton: &Skeleton, roles: &Roles, reference: &WorldPose) -> WorldPose {
    let mut stance = Stance::new(skeleton, reference);
    let body = Landmark::of(&reference.positions, roles);
    if roles.is_quadruped() {
        let arms = body.as_ref().and_then(|body| Some((&body.legs, body.arms.as_ref()?)));
        if let Some((legs, arms)) = arms {
            let ahead = trunk_of(legs, arms);
            let yaw = libm::atan2f(ahead.x, ahead.z);
            if yaw.abs() > MAX_UPRIGHT_RADIANS && Vec3::new(ahead.x, 0.0, ahead.z).length() > 0.5 {
                stance.turn(0, Quat::from_rotation_y(-yaw));
            }
        }
        return stance.world_pose();
    }
    let body = body.filter(|body| !body.stands_on_four());
    let Some(body) = body else {
        return stance.world_pose();
    };
    if quat::log(body.world_from_body.conjugate()).length() > MAX_UPRIGHT_RADIANS {
        stance.turn(0, body.world_from_body.conjugate());
    }
    // A rest pose that stands is intended; in a frame of a clip all accidental deviation is
    // removed.
    let is_rest = reference
        .rotations
        .iter()
        .all(|rotation| quat::angle_between(*rotation, reference.rotations[0]) < 1e-3);
    match is_rest {
        true if body.stands_on_two() => {}
        true => stance.straighten(roles, MAX_LIMB_DEVIATION_RADIANS),
        false => stance.straighten(roles, 0.0),
    }
    stance.world_pose()
}

/// A limb of two bones.
struct Limb {
    start: Vec3,
    middle: Vec3,
    end: Vec3,
}

impl Limb {
    fn length(&self) -> f32 {
        self.start.distance(self.middle) + self.middle.distance(self.end)
    }

    /// Returns the vector from start to end as a share of the limb's length: shorter than 1 where
    /// it is bent.
    fn way(&self) -> Vec3 {
        (self.end - self.start) / self.length().max(1e-6)
    }
}

/// Returns the unit vector from the middle of the hip joints to that of the shoulder joints.
fn trunk_of(legs: &[Limb; 2], arms: &[Limb; 2]) -> Vec3 {
    let middle = |[left, right]: &[Limb; 2]| left.start + right.start;
    (middle(arms) - middle(legs)).normalize_or_zero()
}

/// The directions of a body in a pose.
struct Landmark {
    legs: [Limb; 2],
    arms: Option<[Limb; 2]>,
    /// From the ankles to the balls of the feet, where known.
    feet: [Option<Vec3>; 2],
    head: Option<Vec3>,
    /// From right to left, and up along the back.
    left: Vec3,
    up: Vec3,
    world_from_body: Quat,
}

impl Landmark {
    fn of(positions: &[Vec3], roles: &Roles) -> Option<Self> {
        let at = |role| roles.get_within(role, positions.len()).map(|joint| positions[joint]);
        let limb = |[start, middle, end]: [Role; 3]| {
            Some(Limb { start: at(start)?, middle: at(middle)?, end: at(end)? })
        };
        let leg = |side| limb([Role::thigh(side), Role::shin(side), Role::foot(side)]);
        let legs = [leg(Side::Left)?, leg(Side::Right)?];
        let arms = match Side::BOTH.map(|side| limb(Role::arm(side))) {
            [Some(left), Some(right)] => Some([left, right]),
            _ => None,
        };
        let low = (legs[0].start + legs[1].start) * 0.5;
        let high = match (at(Role::Head), &arms) {
            (Some(head), _) => head,
            (None, Some([left, right])) => (left.start + right.start) * 0.5,
            _ => at(Role::Spine)?,
        };
        let up = (high - low).try_normalize()?;
        let hips = legs[0].start - legs[1].start;
        let across =
            hips + arms.as_ref().map_or(Vec3::ZERO, |[left, right]| left.start - right.start);
        // If the shoulders are turned half round against the hips, the sum is 0.
        let left = [across, hips]
            .into_iter()
            .find_map(|across| across.reject_from_normalized(up).try_normalize())?;
        let foot = |side| Some(at(Role::toe(side))? - at(Role::foot(side))?);
        Some(Self {
            feet: Side::BOTH.map(foot),
            head: at(Role::Head),
            legs,
            arms,
            left,
            up,
            world_from_body: quat::renormalize(Quat::from_mat3(&Mat3::from_cols(
                left,
                up,
                left.cross(up),
            ))),
        })
    }

    /// Returns whether legs point down from the trunk, feet point ahead, shoulders are parallel to
    /// hips, and arms point to their own sides or down.
    fn stands_on_two(&self) -> bool {
        let Self { left, up, .. } = *self;
        let forward = left.cross(up);
        let down = |from: Vec3, to: Vec3| (from - to).normalize_or_zero().dot(up);
        let legs = self
            .legs
            .iter()
            .all(|leg| down(leg.start, leg.middle) > 0.75 && down(leg.middle, leg.end) > 0.6);
        let hips = (self.legs[0].start - self.legs[1].start).normalize_or_zero().dot(left) > 0.7;
        let feet = (self.feet.into_iter().flatten())
            .all(|foot| foot.normalize_or_zero().dot(forward) > 0.1);
        let arms = self.arms.as_ref().is_none_or(|arms| {
            let shoulders = (arms[0].start - arms[1].start).normalize_or_zero().dot(left) > 0.7;
            let above = self
                .head
                .is_none_or(|head| (head - (arms[0].start + arms[1].start) * 0.5).dot(up) > 0.0);
            let aside = arms.iter().zip([1.0, -1.0]).all(|(arm, sign)| {
                let way = arm.way();
                way.length() > 0.6 && way.dot(up) < 0.5 && way.dot(left) * sign > -0.3
            });
            shoulders && above && aside
        });
        legs && hips && feet && arms
    }

    /// Returns whether arms and legs point the same way, and across the trunk.
    fn stands_on_four(&self) -> bool {
        let Some(arms) = &self.arms else { return false };
        let ways = || self.legs.iter().chain(arms).map(|limb| limb.way().normalize_or_zero());
        let down = ways().sum::<Vec3>().normalize_or_zero();
        down.dot(self.up).abs() < 0.6 && ways().all(|way| way.dot(down) > 0.8)
    }
}

/// A stance under construction: a reference, and the rotation of each joint against it.
struct Stance<'a> {
    skeleton: &'a Skeleton,
    reference: &'a WorldPose,
    /// The rotation of each joint relative to its parent's, in the world, on top of the reference.
    turns: Vec<Quat>,
}

impl<'a> Stance<'a> {
    fn new(skeleton: &'a Skeleton, reference: &'a WorldPose) -> Self {
        Self { skeleton, reference, turns: vec![Quat::IDENTITY; skeleton.len()] }
    }

    /// Rotates a joint and everything below it, about axes of the world.
    fn turn(&mut self, joint: usize, turn: Quat) {
        if let Some(own) = self.turns.get_mut(joint) {
            *own = quat::renormalize(turn * *own);
        }
    }

    /// Returns the joints as they are rotated now.
    fn world_pose(&self) -> WorldPose {
        let mut made = WorldPose::default();
        // The rotation of every joint in the world; parents come first.
        let mut whole: Vec<Quat> = Vec::with_capacity(self.skeleton.len());
        let rotation =
            |joint: usize| self.reference.rotations.get(joint).copied().unwrap_or_default();
        let position =
            |joint: usize| self.reference.positions.get(joint).copied().unwrap_or_default();
        for (index, turn) in self.turns.iter().enumerate() {
            let (turn, place) = match self.skeleton.parent(index) {
                None => (*turn, Vec3::ZERO),
                Some(parent) => (
                    *turn * whole[parent],
                    made.positions[parent] + whole[parent] * (position(index) - position(parent)),
                ),
            };
            whole.push(turn);
            made.positions.push(place);
            made.rotations.push(quat::renormalize(turn * rotation(index)));
        }
        made
    }

    /// Rotates `joint` so that the vector `way` of the current pose points in `direction`; does
    /// nothing where that vector is 0. For opposite directions the axis is `half`.
    fn swing(
        &mut self,
        joint: usize,
        way: impl Fn(&WorldPose) -> Option<Vec3>,
        direction: Vec3,
        half: Vec3,
        least: f32,
    ) {
        let Some(from) =
            way(&self.world_pose()).filter(|way| way.length() > 1e-4).map(Vec3::normalize_or_zero)
        else {
            return;
        };
        let angle = from.angle_between(direction);
        if angle <= least {
            return;
        }
        let turn = if angle > PI - 0.15 {
            let half = Quat::from_axis_angle(half, PI);
            quat::between_directions(half * from, direction) * half
        } else {
            quat::between_directions(from, direction)
        };
        self.turn(joint, turn);
    }

    /// Moves trunk, head and limbs of an upright body to the stance, from the hips outwards; parts
    /// that are nearer to it than `least`, radians, stay.
    fn straighten(&mut self, roles: &Roles, least: f32) {
        let joints = self.skeleton.len();
        let joint = |role| roles.get_within(role, joints);
        let at = |pose: &WorldPose, joint: Option<usize>| pose.positions.get(joint?).copied();
        let between = |from: Option<usize>, to: Option<usize>| {
            move |pose: &WorldPose| Some(at(pose, to)? - at(pose, from)?)
        };
        let across = |role: fn(Side) -> Role| {
            let [left, right] = Side::BOTH.map(|side| joint(role(side)));
            between(right, left)
        };
        let (thighs, shoulders) = (across(Role::thigh), across(Role::upper_arm));
        self.swing(joint(Role::Hips).unwrap_or(0), thighs, Vec3::X, Vec3::Y, least);
        let [left_arm, right_arm] = Side::BOTH.map(|side| joint(Role::upper_arm(side)));
        if let Some(spine) = joint(Role::Spine) {
            let trunk = |pose: &WorldPose| {
                Some((at(pose, left_arm)? + at(pose, right_arm)?) * 0.5 - at(pose, Some(spine))?)
            };
            self.swing(spine, trunk, Vec3::Y, Vec3::X, least);
        }
        let chest = Landmarks::of(self.skeleton, roles).chest;
        if let Some(chest) = chest {
            self.swing(chest, shoulders, Vec3::X, Vec3::Y, least);
        }
        if let Some(head) = joint(Role::Head) {
            let neck = std::iter::successors(self.skeleton.parent(head), |&joint| {
                self.skeleton.parent(joint)
            })
            .take_while(|&joint| Some(joint) != chest && Some(joint) != roles.get(Role::Hips))
            .last();
            if let Some(neck) = neck {
                self.swing(
                    neck,
                    between(Some(neck), Some(head)),
                    Vec3::Y,
                    Vec3::X,
                    MAX_LEAN_RADIANS.max(least),
                );
            }
            self.swing(head, self.end_of(head), Vec3::Y, Vec3::X, MAX_LEAN_RADIANS.max(least));
        }
        for (side, sign) in [(Side::Left, 1.0), (Side::Right, -1.0)] {
            let arm = Vec3::new(
                sign * libm::cosf(ARMS_DOWN_RADIANS),
                -libm::sinf(ARMS_DOWN_RADIANS),
                0.0,
            );
            let foot =
                Vec3::new(0.0, -libm::sinf(FOOT_DOWN_RADIANS), libm::cosf(FOOT_DOWN_RADIANS));
            let [thigh, shin, ankle, toe] = Role::leg(side).map(joint);
            let [upper, fore, hand] = Role::arm(side).map(joint);
            let bones = [
                (thigh, shin, Vec3::NEG_Y),
                (shin, ankle, Vec3::NEG_Y),
                (ankle, toe, foot),
                (upper, fore, arm),
                (fore, hand, arm),
            ];
            for (start, end, direction) in bones {
                if let (Some(start), Some(_)) = (start, end) {
                    self.swing(start, between(Some(start), end), direction, Vec3::X, least);
                }
            }
            for (last, direction) in [(toe, Vec3::Z), (hand, arm)] {
                if let Some(last) = last {
                    self.swing(last, self.end_of(last), direction, Vec3::X, least);
                }
            }
        }
    }

    /// Returns a function for the vector from a joint to the middle of its children, or to its end
    /// site.
    fn end_of(&self, joint: usize) -> impl Fn(&WorldPose) -> Option<Vec3> + use<> {
        let children: Vec<usize> = self.skeleton.children(joint).collect();
        let end = self.skeleton.joints().get(joint).and_then(|joint| joint.end_site);
        move |pose| {
            let here = *pose.positions.get(joint)?;
            if children.is_empty() {
                return Some(*pose.rotations.get(joint)? * end?);
            }
            let sum: Vec3 = children.iter().filter_map(|&child| pose.positions.get(child)).sum();
            Some(sum / children.len() as f32 - here)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::skeleton::{Pose, fixtures, world_pose};

    /// Checks the positions of a body's joints, whatever their axes are.
    fn assert_stands(name: &str, skeleton: &Skeleton, roles: &Roles, stance: &WorldPose) {
        let body = Landmark::of(&stance.positions, roles).unwrap();
        assert!(body.stands_on_two(), "{name}");
        assert!(
            body.up.y > 0.95 && body.left.x > 0.95,
            "{name}: up {}, left {}",
            body.up,
            body.left
        );
        for (joint, parent) in skeleton.joints().iter().map(|joint| joint.parent).enumerate() {
            let Some(parent) = parent else { continue };
            let length = stance.positions[joint].distance(stance.positions[parent]);
            assert!(
                (length - skeleton.joints()[joint].offset.length()).abs() < 1e-4,
                "{name}: {joint}"
            );
            let offset = stance.rotations[parent] * skeleton.joints()[joint].offset;
            assert!(
                offset.distance(stance.positions[joint] - stance.positions[parent]) < 1e-4,
                "{name}"
            );
        }
    }

    #[test]
    fn stance_of_plausible_rest_pose_is_the_rest_pose() {
        let mut plausible = 0;
        for (name, skeleton, _) in fixtures::all() {
            let roles = fixtures::roles(&skeleton);
            let rest = skeleton.rest_pose();
            let stance = canonical_stance(&skeleton, &roles, &rest);
            assert_stands(name, &skeleton, &roles, &stance);
            if rest_is_plausible(&skeleton, &roles) == Some(true) {
                plausible += 1;
                // The body is rotated as a whole, if at all.
                for rotation in &stance.rotations {
                    assert!(quat::angle_between(*rotation, stance.rotations[0]) < 1e-4, "{name}");
                }
            }
        }
        assert!(plausible >= 5, "{plausible}");
        // Bones along one axis, and joints rotated by constants.
        let skeleton = fixtures::lafan();
        let roles = fixtures::roles(&skeleton);
        let along = skeleton.joints().iter().map(|joint| Joint {
            offset: joint.parent.map_or(joint.offset, |_| Vec3::X * joint.offset.length()),
            ..joint.clone()
        });
        let along = Skeleton::new(along.collect()).unwrap();
        assert_ne!(rest_is_plausible(&along, &roles), Some(true));
        for seed in 0..5 {
            assert_eq!(
                rest_is_plausible(&fixtures::turned(&skeleton, seed).0, &roles),
                Some(false)
            );
        }
    }

    #[test]
    fn stance_does_not_depend_on_joint_axes() {
        for (name, skeleton) in [("CMU", fixtures::cmu_bvh()), ("games105", fixtures::games105())] {
            let roles = fixtures::roles(&skeleton);
            let expected = canonical_stance(&skeleton, &roles, &skeleton.rest_pose());
            let (turned, frames) = fixtures::turned(&skeleton, 7);
            assert_eq!(rest_is_plausible(&turned, &roles), Some(false), "{name}");
            let pose =
                fixtures::turned_pose(&skeleton, &frames, &fixtures::step(&skeleton, &roles));
            let reference = world_pose(&turned, &pose);
            let stance = canonical_stance(&turned, &roles, &reference);
            assert_stands(name, &turned, &roles, &stance);
            // The axes are those of the rest pose, within what feet and a bent spine leave open.
            let resting = turned.resting_in(&stance);
            assert_stands(name, &resting, &roles, &resting.rest_pose());
            for role in [Role::LeftThigh, Role::RightShin, Role::LeftUpperArm, Role::RightForearm] {
                let joint = roles.get(role).unwrap();
                let child = skeleton.children(joint).next().unwrap();
                let bone =
                    |positions: &[Vec3]| (positions[child] - positions[joint]).normalize_or_zero();
                // From the stance of the plain skeleton to this one there is a swing of the bone,
                // and no twist about it.
                let swing =
                    quat::between_directions(bone(&expected.positions), bone(&stance.positions));
                let plain = stance.rotations[joint]
                    * frames[joint].conjugate()
                    * expected.rotations[joint].conjugate();
                let apart = quat::angle_between(plain, swing).to_degrees();
                assert!(apart < 20.0, "{name}, {role:?}: twisted by {apart}°");
            }
        }
    }

    #[test]
    fn stance_of_quadruped_is_its_rest_pose() {
        let point = |name: &str, parent, offset| Joint {
            name: name.into(),
            parent,
            offset,
            end_site: None,
            channels: vec![],
        };
        let rope = Skeleton::new(vec![
            point("a", None, Vec3::Y),
            point("b", Some(0), Vec3::X),
            point("c", Some(1), Vec3::NEG_Z),
        ]);
        let rope = rope.unwrap();
        let stance = canonical_stance(&rope, &Roles::default(), &rope.rest_pose());
        assert_eq!(stance, rope.rest_pose());
        assert_eq!(rest_is_plausible(&rope, &Roles::default()), None);
        // A human's joints, on hands and feet.
        let skeleton = fixtures::games105();
        let roles = fixtures::roles(&skeleton);
        let mut pose = Pose {
            root_translation: Vec3::Y,
            rotations: vec![Quat::IDENTITY; skeleton.len()],
            translations: Vec::new(),
        };
        let quarter = Quat::from_rotation_x(std::f32::consts::FRAC_PI_2);
        pose.rotations[roles.get(Role::Hips).unwrap()] = quarter;
        for side in Side::BOTH {
            pose.rotations[roles.get(Role::thigh(side)).unwrap()] = quarter.conjugate();
        }
        let mut crawling = world_pose(&skeleton, &pose);
        for side in Side::BOTH {
            let arm = roles.get(Role::upper_arm(side)).unwrap();
            let hand = roles.get(Role::hand(side)).unwrap();
            let way = crawling.positions[hand] - crawling.positions[arm];
            let local = quat::between_directions(way, Vec3::NEG_Y);
            let above = crawling.rotations[skeleton.parent(arm).unwrap()];
            pose.rotations[arm] = above.conjugate() * local * above;
        }
        crawling = world_pose(&skeleton, &pose);
        let stance = canonical_stance(&skeleton, &roles, &crawling);
        let moved = stance.positions[0] - crawling.positions[0];
        for (made, given) in stance.positions.iter().zip(&crawling.positions) {
            assert!((*made - *given).distance(moved) < 1e-4);
        }
    }
}
