//! The pose in which a mesh is built: limbs apart from each other and from the trunk.

use super::RigidTransform;
use super::shapes::is_person;
use crate::math::quat;
use crate::skeleton::{Role, Roles, Side, Skeleton, WorldPose};
use glam::{Quat, Vec3};

/// The angle of the arms below level, radians (40°): between their most frequent position and the
/// extreme ones, so that the shoulders deform least.
const ARMS_DOWN_RADIANS: f32 = 0.52;
/// The angle of the legs from the vertical, radians (11°): the thighs separate below the crotch.
const LEGS_OUT_RADIANS: f32 = 0.20;

/// Returns the bind pose of a skeleton that rests in `stance`, with its joints' own axes: limbs
/// of a person are spread, and everything else is as in the stance. The root is at the origin.
pub(super) fn bind_pose(skeleton: &Skeleton, roles: &Roles, stance: &WorldPose) -> WorldPose {
    let rest = skeleton.rest_positions();
    let joint = |role| roles.get_within(role, rest.len());
    let at = |role| joint(role).map(|joint| rest[joint]);
    // The rotation of each joint against its rest, in the world; the rest of the limb follows.
    let mut turns: Vec<Option<Quat>> = vec![None; rest.len()];
    let body = is_person(&rest, roles).then(|| axes(&rest, roles)).flatten();
    if let Some((left, up)) = body {
        for (side, sign) in [(Side::Left, 1.0), (Side::Right, -1.0)] {
            let out = left * sign;
            let arm = out * libm::cosf(ARMS_DOWN_RADIANS) - up * libm::sinf(ARMS_DOWN_RADIANS);
            let leg = out * libm::sinf(LEGS_OUT_RADIANS) - up * libm::cosf(LEGS_OUT_RADIANS);
            let bones = [
                (Role::upper_arm(side), Role::forearm(side), arm),
                (Role::forearm(side), Role::hand(side), arm),
                (Role::thigh(side), Role::shin(side), leg),
                (Role::shin(side), Role::foot(side), leg),
            ];
            for (start, end, direction) in bones {
                let (Some(index), Some(from), Some(to)) = (joint(start), at(start), at(end)) else {
                    continue;
                };
                turns[index] = (to - from).try_normalize().map(|bone| turn(bone, direction, left));
            }
        }
    }
    let mut world = WorldPose::default();
    for (index, joint) in skeleton.joints().iter().enumerate() {
        let (above, position) = match joint.parent {
            None => (Quat::IDENTITY, Vec3::ZERO),
            Some(parent) => {
                let above = world.rotations[parent];
                (above, world.positions[parent] + above * joint.offset)
            }
        };
        world.rotations.push(turns[index].unwrap_or(above));
        world.positions.push(position);
    }
    for (turned, standing) in world.rotations.iter_mut().zip(&stance.rotations) {
        *turned = quat::renormalize(*turned * *standing);
    }
    world
}

/// Returns the rotation from one direction to another; half a turn is made about `left`, as legs
/// bend.
fn turn(from: Vec3, to: Vec3, left: Vec3) -> Quat {
    if from.dot(to) < -0.99 {
        let half = Quat::from_axis_angle(left, std::f32::consts::PI);
        return quat::renormalize(quat::between_directions(half * from, to) * half);
    }
    quat::between_directions(from, to)
}

/// Returns the directions from right to left and up the back: orthogonal unit vectors. `None` where
/// roles are missing.
fn axes(rest: &[Vec3], roles: &Roles) -> Option<(Vec3, Vec3)> {
    let at = |role| roles.get_within(role, rest.len()).map(|joint| rest[joint]);
    let across = |role: fn(Side) -> Role| Some(at(role(Side::Left))? - at(role(Side::Right))?);
    let middle =
        |role: fn(Side) -> Role| Some((at(role(Side::Left))? + at(role(Side::Right))?) * 0.5);
    let low = middle(Role::thigh)?;
    let up = (at(Role::Head).or_else(|| middle(Role::upper_arm))? - low).try_normalize()?;
    let across = across(Role::thigh)? + across(Role::upper_arm).unwrap_or_default();
    let left = across.reject_from_normalized(up).try_normalize()?;
    Some((left, up))
}

/// Returns `joint_from_bind` of every joint.
pub(super) fn joint_from_bind(bind: &WorldPose) -> Vec<RigidTransform> {
    let joints = bind.positions.iter().zip(&bind.rotations);
    joints
        .map(|(&translation, &rotation)| RigidTransform { rotation, translation }.inverse())
        .collect()
}
