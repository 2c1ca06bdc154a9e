//! Writing of VRM animations (VRMA).
//!
//! Source: VRM Consortium, `vrm-specification`: `VRMC_vrm_animation-1.0/README.md`. The nodes stand
//! in a T-pose that faces +Z, the feet on the ground. Programs take from each bone its rotation
//! against that pose, and from the hips their place, scaled by their height there.

use super::write::{File, GENERATOR, GlbError, animation, nodes};
use glam::{Quat, Vec3};
use segue_motion::clip::{Clip, Interpolation, reference_pose, resample};
use segue_motion::math::quat;
use segue_motion::skeleton::{Joint, Role, Roles, Side, Skeleton, WorldPose, canonical_stance};
use serde_json::{Map, Value, json};
use std::borrow::Cow;
use std::sync::Arc;

/// The version of the extension.
const SPEC_VERSION: &str = "1.0";

/// The bones of the format that roles name.
const BONES: [(&str, Role); 16] = [
    ("spine", Role::Spine),
    ("head", Role::Head),
    ("leftUpperLeg", Role::LeftThigh),
    ("leftLowerLeg", Role::LeftShin),
    ("leftFoot", Role::LeftFoot),
    ("leftToes", Role::LeftToe),
    ("rightUpperLeg", Role::RightThigh),
    ("rightLowerLeg", Role::RightShin),
    ("rightFoot", Role::RightFoot),
    ("rightToes", Role::RightToe),
    ("leftUpperArm", Role::LeftUpperArm),
    ("leftLowerArm", Role::LeftForearm),
    ("leftHand", Role::LeftHand),
    ("rightUpperArm", Role::RightUpperArm),
    ("rightLowerArm", Role::RightForearm),
    ("rightHand", Role::RightHand),
];

/// The reason why a clip cannot be written as a VRM animation.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error, segue_text::ToMessage)]
pub enum VrmaError {
    /// The format has bones of a human body only.
    #[error(
        "a VRM animation needs a body: set at least hips and thighs under Body parts in the clip's panel"
    )]
    NoBody,
    /// The motion is too large for the format.
    #[error(transparent)]
    Glb(#[from] GlbError),
}

/// Writes a clip as a VRM animation: a binary glTF with a node for each bone of the format that the
/// clip has, and the motion of all other joints in that of the bones below them.
///
/// Bones follow from the roles. Between spine and head, chest and upper chest are the joints up to
/// the one from which both arms come, the neck is the next one; a shoulder is the joint above an
/// upper arm. Bones without a joint are left out, and so are fingers. `fps` are the frames per
/// second; the clip's own where `None` or not accepted by [`resample`].
///
/// # Errors
/// [`VrmaError`] when the hips or a thigh have no joint, or the clip is too large.
pub fn write_vrma(clip: &Clip, roles: &Roles, fps: Option<f64>) -> Result<Vec<u8>, VrmaError> {
    let resampled = fps.and_then(|fps| resample(clip, fps, Interpolation::default()).ok());
    let clip: Cow<'_, Clip> = resampled.map_or(Cow::Borrowed(clip), Cow::Owned);
    let bones = bones(clip.skeleton(), roles).ok_or(VrmaError::NoBody)?;
    let body = on_bones(&clip, roles, &bones).ok_or(VrmaError::NoBody)?;
    let mut file = File::default();
    let names = bones.iter().enumerate();
    let human: Map<String, Value> =
        names.map(|(node, bone)| (bone.name.to_owned(), json!({ "node": node }))).collect();
    let mut root = json!({
        "asset": { "version": "2.0", "generator": format!("{GENERATOR}{}", env!("CARGO_PKG_VERSION")) },
        "extensionsUsed": ["VRMC_vrm_animation"],
        "extensions": { "VRMC_vrm_animation": {
            "specVersion": SPEC_VERSION, "humanoid": { "humanBones": human }
        } },
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": nodes(body.skeleton()),
    });
    if body.frames() > 0 {
        root["animations"] = json!([animation(&mut file, body.name(), &body, body.skeleton())]);
    }
    Ok(file.finish(root)?)
}

/// A bone of the format.
struct Bone {
    name: &'static str,
    /// The clip's joint that moves it.
    joint: usize,
}

/// Returns the bones that a skeleton has, each behind those above it, the hips first; `None` if it
/// has no hips or lacks a leg.
fn bones(skeleton: &Skeleton, roles: &Roles) -> Option<Vec<Bone>> {
    let joint = |role: Role| roles.get_within(role, skeleton.len());
    let hips = joint(Role::Hips)?;
    let mut found = vec![Bone { name: "hips", joint: hips }];
    let mut add = |name: &'static str, joint: usize| {
        let is_below = ancestors(skeleton, joint).any(|above| above == hips);
        if is_below && found.iter().all(|bone: &Bone| bone.joint != joint && bone.name != name) {
            found.push(Bone { name, joint });
        }
    };
    for (name, role) in BONES {
        if let Some(joint) = joint(role) {
            add(name, joint);
        }
    }
    let arms = Side::BOTH.map(|side| joint(Role::upper_arm(side)));
    if let (Some(spine), Some(head)) = (joint(Role::Spine), joint(Role::Head)) {
        let between = path(skeleton, spine, head);
        let carries_arms = |joint: &usize| {
            let is_above = |arm: usize| ancestors(skeleton, arm).any(|above| above == *joint);
            arms.iter().flatten().all(|arm| is_above(*arm)) && arms.iter().any(Option::is_some)
        };
        // Those that carry the arms come first.
        let trunk = between.iter().take_while(|joint| carries_arms(joint)).count();
        match &between[..trunk] {
            [] => {}
            [chest] => add("chest", *chest),
            [chest, .., upper] => {
                add("chest", *chest);
                add("upperChest", *upper);
            }
        }
        if let Some(neck) = between.get(trunk) {
            add("neck", *neck);
        }
        let top = trunk.checked_sub(1).and_then(|last| between.get(last)).unwrap_or(&spine);
        for (name, arm) in ["leftShoulder", "rightShoulder"].into_iter().zip(arms) {
            if let Some(shoulder) = arm.and_then(|arm| path(skeleton, *top, arm).pop()) {
                add(name, shoulder);
            }
        }
    }
    let has = |name: &str| found.iter().any(|bone| bone.name == name);
    if !(has("leftUpperLeg") && has("rightUpperLeg")) {
        return None;
    }
    // Parents stand before their children in a skeleton.
    found.sort_by_key(|bone| (bone.joint != hips, bone.joint));
    Some(found)
}

/// Returns the joints above a joint, the nearest first.
fn ancestors(skeleton: &Skeleton, joint: usize) -> impl Iterator<Item = usize> + '_ {
    std::iter::successors(skeleton.parent(joint), |joint| skeleton.parent(*joint))
}

/// Returns the joints between two, from the upper one down, without both; none where the second is
/// not below the first.
fn path(skeleton: &Skeleton, from: usize, to: usize) -> Vec<usize> {
    let mut between: Vec<usize> =
        ancestors(skeleton, to).take_while(|joint| *joint != from).collect();
    if between.len() == ancestors(skeleton, to).count() {
        return Vec::new();
    }
    between.reverse();
    between
}

/// Returns the motion of the bones alone, on a skeleton that rests in the T-pose.
fn on_bones(clip: &Clip, roles: &Roles, bones: &[Bone]) -> Option<Clip> {
    let skeleton: &Skeleton = clip.skeleton();
    let stance = t_pose(clip, roles);
    let resting = skeleton.resting_in(&stance);
    let place = |joint: usize| stance.positions.get(joint).copied();
    let ground = lowest(&resting, &stance);
    let parent_of = |bone: &Bone| {
        ancestors(skeleton, bone.joint)
            .find_map(|above| bones.iter().position(|own| own.joint == above))
    };
    let parents: Vec<Option<usize>> = bones.iter().map(parent_of).collect();
    let joints = bones.iter().zip(&parents).map(|(bone, parent)| {
        let above = parent.and_then(|parent| place(bones.get(parent)?.joint));
        let origin = above.unwrap_or(Vec3::Y * ground);
        Some(Joint {
            name: skeleton.joints().get(bone.joint)?.name.clone(),
            parent: *parent,
            offset: place(bone.joint)? - origin,
            end_site: None,
            channels: Vec::new(),
        })
    });
    let own = Arc::new(Skeleton::new(joints.collect::<Option<Vec<Joint>>>()?).ok()?);
    let mut rotations = Vec::with_capacity(clip.frames() * bones.len());
    let mut hips = Vec::with_capacity(clip.frames());
    let mut world = WorldPose::default();
    for frame in 0..clip.frames() {
        clip.world_pose_into(frame, &mut world);
        let turned: Vec<Quat> = bones
            .iter()
            .map(|bone| world.rotations[bone.joint] * stance.rotations[bone.joint].conjugate())
            .collect();
        let local = |(turn, parent): (&Quat, &Option<usize>)| {
            parent.map_or(*turn, |parent| turned[parent].conjugate() * *turn)
        };
        rotations.extend(turned.iter().zip(&parents).map(local));
        hips.push(world.positions[bones.first()?.joint]);
    }
    let clip = Clip::new(clip.name(), own, clip.fps(), rotations, hips);
    clip.ok()
}

/// Returns the height of the lowest joint or end of a bone, metres.
fn lowest(resting: &Skeleton, stance: &WorldPose) -> f32 {
    let ends = resting.joints().iter().zip(&stance.positions).flat_map(|(joint, place)| {
        [Some(place.y), joint.end_site.map(|end| place.y + end.y)].into_iter().flatten()
    });
    ends.reduce(f32::min).unwrap_or(0.0)
}

/// Returns the pose in which the body of a clip stands upright and faces +Z, with straight legs and
/// level arms.
fn t_pose(clip: &Clip, roles: &Roles) -> WorldPose {
    let skeleton: &Skeleton = clip.skeleton();
    let mut pose = canonical_stance(skeleton, roles, &reference_pose(clip, roles));
    let joint = |role: Role| roles.get_within(role, skeleton.len());
    for side in Side::BOTH {
        let out = if side == Side::Left { Vec3::X } else { Vec3::NEG_X };
        let [upper, fore, hand] = Role::arm(side).map(joint);
        let [thigh, shin, foot, _] = Role::leg(side).map(joint);
        for (start, end, direction) in [
            (upper, fore, out),
            (fore, hand, out),
            (thigh, shin, Vec3::NEG_Y),
            (shin, foot, Vec3::NEG_Y),
        ] {
            if let (Some(start), Some(end)) = (start, end) {
                swing(skeleton, &mut pose, start, end, direction);
            }
        }
        // The fingers of most skeletons end at the hand.
        if let Some(hand) = hand {
            let end = skeleton.children(hand).next();
            if let Some(end) = end {
                swing(skeleton, &mut pose, hand, end, out);
            }
        }
        // The sole stays as it was against the world: legs only became straight.
        if let (Some(foot), Some(toe)) = (foot, joint(Role::toe(side))) {
            let way = pose.positions[toe] - pose.positions[foot];
            let ahead = Vec3::new(0.0, way.y.min(0.0), Vec3::new(way.x, 0.0, way.z).length());
            swing(skeleton, &mut pose, foot, toe, ahead);
        }
    }
    pose
}

/// Turns a joint, with everything below it, so that another joint lies in that direction.
fn swing(skeleton: &Skeleton, pose: &mut WorldPose, joint: usize, end: usize, direction: Vec3) {
    let (Some(&pivot), Some(&tip)) = (pose.positions.get(joint), pose.positions.get(end)) else {
        return;
    };
    let turn = quat::between_directions(tip - pivot, direction);
    let mut moves = vec![false; skeleton.len()];
    for index in joint..skeleton.len() {
        moves[index] = index == joint || skeleton.parent(index).is_some_and(|parent| moves[parent]);
        if moves[index] {
            pose.rotations[index] = turn * pose.rotations[index];
            pose.positions[index] = pivot + turn * (pose.positions[index] - pivot);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ImportOptions, import};
    use segue_motion::clip::fixtures::wander_by;
    use segue_motion::skeleton::{RoleSource, fixtures};
    use segue_motion::synth::{Action, Params, synthesize};

    fn rigs() -> Vec<(&'static str, Arc<Skeleton>)> {
        fixtures::all().into_iter().map(|(name, skeleton, _)| (name, skeleton)).collect()
    }

    /// Returns the rotations in the world of the clip's bones against the T-pose.
    fn against_t_pose(clip: &Clip, roles: &Roles, frame: usize) -> Vec<(Role, Quat)> {
        let (pose, stance) = (clip.world_pose(frame), t_pose(clip, roles));
        Role::ALL
            .into_iter()
            .filter_map(|role| {
                let joint = roles.get(role)?;
                Some((role, pose.rotations[joint] * stance.rotations[joint].conjugate()))
            })
            .collect()
    }

    #[test]
    fn vrma_of_any_rig_turns_its_bones_as_the_clip_does() {
        for (name, skeleton) in rigs() {
            let roles = fixtures::roles(&skeleton);
            let clip = wander_by(&skeleton, 9, 3, 0.6);
            let bytes = write_vrma(&clip, &roles, None).unwrap();
            assert_eq!(bytes, write_vrma(&clip, &roles, None).unwrap());
            let file = import("own.vrma", &bytes, &ImportOptions::default()).unwrap();
            assert_eq!(file.warnings, [], "{name}");
            let back = &file.clips[0];
            let own = back.roles.as_ref().unwrap();
            assert_eq!(back.clip.frames(), 9, "{name}");
            for frame in [0, 4, 8] {
                let there = back.clip.world_pose(frame);
                let here = clip.world_pose(frame);
                let hips = [&roles, own].map(|roles| roles.get(Role::Hips).unwrap());
                let apart = here.positions[hips[0]].distance(there.positions[hips[1]]);
                assert!(apart < 1e-4, "{name}: hips {apart} m");
                for (role, turn) in against_t_pose(&clip, &roles, frame) {
                    assert_eq!(own.source(role), Some(RoleSource::ByFile), "{name} {role:?}");
                    let found = there.rotations[own.get(role).unwrap()];
                    let apart = quat::angle_between(turn, found);
                    assert!(apart < 1e-3, "{name} {role:?}: {apart}");
                }
            }
        }
    }

    #[test]
    fn vrma_rests_in_a_t_pose_on_the_ground() {
        for (name, skeleton) in rigs() {
            let roles = fixtures::roles(&skeleton);
            let clip = wander_by(&skeleton, 3, 5, 0.4);
            let own = bones(&skeleton, &roles).unwrap();
            let body = on_bones(&clip, &roles, &own).unwrap();
            let rest = body.skeleton().rest_pose();
            let root = body.skeleton().joints()[0].offset;
            let at = |bone: &str| {
                let index = own.iter().position(|own| own.name == bone).unwrap();
                rest.positions[index] + root
            };
            let way = |from: &str, to: &str| (at(to) - at(from)).normalize_or_zero();
            assert!((0.4..1.3).contains(&root.y), "{name}: hips at {} m", root.y);
            assert!(at("leftFoot").y < 0.2 && at("head").y > root.y, "{name}");
            for (from, to, direction) in [
                ("leftUpperArm", "leftLowerArm", Vec3::X),
                ("leftLowerArm", "leftHand", Vec3::X),
                ("rightUpperArm", "rightLowerArm", Vec3::NEG_X),
                ("leftUpperLeg", "leftLowerLeg", Vec3::NEG_Y),
                ("rightLowerLeg", "rightFoot", Vec3::NEG_Y),
            ] {
                assert!(
                    way(from, to).distance(direction) < 1e-3,
                    "{name}: {from} {}",
                    way(from, to)
                );
            }
        }
    }

    #[test]
    fn vrma_moves_arms_and_legs_as_the_clip_does() {
        let walk = synthesize(&Params::new(Action::Walk)).unwrap().clip;
        let roles = Roles::detect(walk.skeleton());
        let bytes = write_vrma(&walk, &roles, Some(30.0)).unwrap();
        let file = import("own.vrma", &bytes, &ImportOptions::default()).unwrap();
        let (back, own) = (&file.clips[0].clip, file.clips[0].roles.as_ref().unwrap());
        assert!((back.fps() - 30.0).abs() < 1e-6);
        let expected = resample(&walk, 30.0, Interpolation::default()).unwrap();
        for frame in 0..back.frames() {
            let (here, there) = (expected.world_pose(frame), back.world_pose(frame));
            for side in Side::BOTH {
                for [from, to] in [
                    [Role::thigh(side), Role::foot(side)],
                    [Role::upper_arm(side), Role::hand(side)],
                    [Role::Hips, Role::thigh(side)],
                ] {
                    let way = |pose: &WorldPose, roles: &Roles| {
                        let at = |role| pose.positions[roles.get(role).unwrap()];
                        at(to) - at(from)
                    };
                    let apart = way(&here, &roles).distance(way(&there, own));
                    assert!(apart < 1e-4, "{to:?} in frame {frame}: {apart} m");
                }
            }
        }
    }

    #[test]
    fn vrma_of_a_motion_without_a_body_is_refused() {
        let walk = synthesize(&Params::new(Action::Walk)).unwrap().clip;
        let refused = write_vrma(&walk, &Roles::default(), None);
        assert_eq!(refused, Err(VrmaError::NoBody));
    }
}
