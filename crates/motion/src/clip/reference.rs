//! Reference poses: the standing body of a clip, independent of its rest pose.

use super::Clip;
use crate::math::quat;
use crate::skeleton::{
    Role, Roles, Side, Skeleton, WorldPose, canonical_stance, rest_is_plausible, uprightness,
};
use glam::{Quat, Vec3};

/// The greatest number of frames of a clip that are examined.
const MAX_SAMPLES: usize = 120;
/// Frames that are less upright than the most upright one by up to this count as upright, too.
const UPRIGHT_TOLERANCE: f32 = 0.06;
/// A rest pose from which a clip's joints are rotated by more than this in the mean is implausible,
/// radians (40°).
const MAX_MEAN_ANGLE: f32 = 0.7;

/// Returns a pose that shows the bones' directions when the body stands, for
/// [`crate::skeleton::canonical_stance`]: the rest pose where that is plausible, otherwise the
/// frame in which the body is most upright. Of frames that are about as upright, the one in which
/// head, hands and feet are closest to their mean rotations is taken.
///
/// If roles are missing, it is the rest pose, or, if the clip's joints are rotated far from that,
/// the frame in which they are farthest apart.
#[must_use]
pub fn reference_pose(clip: &Clip, roles: &Roles) -> WorldPose {
    let skeleton = clip.skeleton();
    let rest = skeleton.rest_pose();
    let step = clip.frames().div_ceil(MAX_SAMPLES).max(1);
    let frames = || (0..clip.frames()).step_by(step).map(|frame| clip.world_pose(frame));
    match rest_is_plausible(skeleton, roles) {
        Some(true) => rest,
        Some(false) => most_upright(&frames().collect::<Vec<_>>(), skeleton, roles).unwrap_or(rest),
        None if mean_angle_from_rest(clip, step) <= MAX_MEAN_ANGLE => rest,
        None => {
            let spreads: Vec<f32> = frames().map(|pose| spread(&pose)).collect();
            let widest = spreads.iter().enumerate().max_by(|x, y| x.1.total_cmp(y.1));
            widest.map_or(rest, |(sample, _)| clip.world_pose(sample * step))
        }
    }
}

/// Returns the stance that replaces the rest pose of a clip's skeleton: its [`canonical_stance`]
/// where the rest pose is implausible. `None` where it is plausible, and where roles are missing.
#[must_use]
pub(crate) fn stance_for_rest(clip: &Clip, roles: &Roles) -> Option<WorldPose> {
    let is_strange = rest_is_plausible(clip.skeleton(), roles) == Some(false);
    is_strange.then(|| canonical_stance(clip.skeleton(), roles, &reference_pose(clip, roles)))
}

/// Returns the mean angle of the joints below the root from rest, radians, over every `step`-th
/// frame.
fn mean_angle_from_rest(clip: &Clip, step: usize) -> f32 {
    let frames = (0..clip.frames()).step_by(step);
    let turns = frames.flat_map(|frame| clip.rotations(frame).iter().skip(1));
    let (sum, count) = turns.fold((0.0f32, 0usize), |(sum, count), turn| {
        (sum + quat::angle_between(*turn, Quat::IDENTITY), count + 1)
    });
    sum / count.max(1) as f32
}

fn most_upright(poses: &[WorldPose], skeleton: &Skeleton, roles: &Roles) -> Option<WorldPose> {
    let upright: Vec<f32> =
        poses.iter().map(|pose| uprightness(pose, roles).unwrap_or(-1.0)).collect();
    let best = upright.iter().copied().reduce(f32::max)?;
    let ends = (Side::BOTH.into_iter()).flat_map(|side| [Role::hand(side), Role::foot(side)]);
    // Head rotations are relative to the hips, those of hands and feet relative to their limbs.
    let hips = roles.get_within(Role::Hips, skeleton.len());
    let head = roles.get_within(Role::Head, skeleton.len()).zip(hips);
    let pairs = ends.filter_map(|role| {
        let joint = roles.get_within(role, skeleton.len())?;
        Some((joint, skeleton.parent(joint)?))
    });
    let mut apart = vec![0.0f32; poses.len()];
    for (joint, against) in pairs.chain(head) {
        let turn = |pose: &WorldPose| {
            quat::renormalize(pose.rotations[against].conjugate() * pose.rotations[joint])
        };
        let turns: Vec<Quat> = poses.iter().map(turn).collect();
        let mean = quat::mean(turns.iter().copied());
        for (apart, turn) in apart.iter_mut().zip(turns) {
            *apart += quat::angle_between(turn, mean);
        }
    }
    let candidates = (0..poses.len()).filter(|&sample| upright[sample] >= best - UPRIGHT_TOLERANCE);
    let sample = candidates.min_by(|&x, &y| apart[x].total_cmp(&apart[y]))?;
    poses.get(sample).cloned()
}

/// Returns the mean distance of the joints from their centre, metres.
fn spread(pose: &WorldPose) -> f32 {
    let count = pose.positions.len().max(1) as f32;
    let middle = pose.positions.iter().sum::<Vec3>() / count;
    pose.positions.iter().map(|position| position.distance(middle)).sum::<f32>() / count
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::skeleton::{Pose, fixtures};
    use std::sync::Arc;

    #[test]
    fn reference_pose_with_implausible_rest_is_the_most_upright_frame() {
        let skeleton = fixtures::games105();
        let roles = fixtures::roles(&skeleton);
        let hips = roles.get(Role::Hips).unwrap();
        let standing = fixtures::step(&skeleton, &roles);
        let mut lying = standing.clone();
        lying.rotations[hips] *= Quat::from_rotation_x(1.5);
        let mut crouching = standing.clone();
        for side in Side::BOTH {
            crouching.rotations[roles.get(Role::thigh(side)).unwrap()] =
                Quat::from_rotation_x(-1.8);
            crouching.rotations[roles.get(Role::shin(side)).unwrap()] = Quat::from_rotation_x(2.2);
        }
        let mut looking_away = standing.clone();
        looking_away.rotations[roles.get(Role::Head).unwrap()] = Quat::from_rotation_y(1.2);
        let poses = [lying, looking_away, crouching, standing.clone(), standing];
        let plain = Clip::from_poses("plain", Arc::clone(&skeleton), 30.0, poses.clone()).unwrap();
        assert_eq!(reference_pose(&plain, &roles), skeleton.rest_pose());
        let (turned, turns) = fixtures::turned(&skeleton, 3);
        let poses: Vec<Pose> =
            poses.iter().map(|pose| fixtures::turned_pose(&skeleton, &turns, pose)).collect();
        let clip = Clip::from_poses("turned", turned, 30.0, poses).unwrap();
        assert_eq!(reference_pose(&clip, &roles), clip.world_pose(3));
    }

    #[test]
    fn reference_pose_without_roles_is_the_most_spread_frame() {
        let joints = |offsets: [Vec3; 4]| {
            let joint = |(index, offset): (usize, Vec3)| crate::skeleton::Joint {
                name: format!("{index}"),
                parent: index.checked_sub(1).map(|above| if above == 2 { 0 } else { above }),
                offset,
                end_site: None,
                channels: vec![],
            };
            Arc::new(Skeleton::new(offsets.into_iter().enumerate().map(joint).collect()).unwrap())
        };
        let clip = |skeleton: &Arc<Skeleton>, turn: f32| {
            let mut rotations = vec![Quat::IDENTITY; 8];
            rotations[1] = Quat::from_rotation_z(turn);
            rotations[5] = Quat::from_rotation_z(0.5 * turn);
            Clip::new("creature", Arc::clone(skeleton), 30.0, rotations, vec![Vec3::ZERO; 2])
                .unwrap()
        };
        let stretched = joints([Vec3::ZERO, Vec3::X, Vec3::X, Vec3::NEG_X]);
        assert_eq!(
            reference_pose(&clip(&stretched, 0.6), &Roles::default()),
            stretched.rest_pose()
        );
        // At rest the second bone lies back on the first.
        let folded = joints([Vec3::ZERO, Vec3::X, Vec3::NEG_X, Vec3::X * 0.5]);
        let moving = clip(&folded, 3.0);
        assert_eq!(reference_pose(&moving, &Roles::default()), moving.world_pose(0));
    }
}
