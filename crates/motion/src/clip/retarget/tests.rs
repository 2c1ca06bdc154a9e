//! Tests of retargeting between rigs.

use super::*;
use crate::clip::JointTranslations;
use crate::clip::fixtures::{largest_distance, wander, wander_by};
use crate::math::{quat, stats};
use crate::skeleton::{Joint, Role, Side, WorldPose, fixtures};
use crate::synth::{Action, Params, synthesize};
use glam::{Quat, Vec3};
use proptest::prelude::*;

fn bone(world: &WorldPose, roles: &Roles, [from, to]: [Role; 2]) -> Vec3 {
    let at = |role| world.positions[roles.get(role).unwrap()];
    (at(to) - at(from)).normalize_or_zero()
}

/// Returns the bones of the limbs down to ankles and wrists.
fn bones() -> Vec<[Role; 2]> {
    let limbs = |side| {
        let leg = Role::leg(side);
        let arm = Role::arm(side);
        [[leg[0], leg[1]], [leg[1], leg[2]], [arm[0], arm[1]], [arm[1], arm[2]]]
    };
    Side::BOTH.into_iter().flat_map(limbs).collect()
}

/// Returns the largest angle between a limb's bone in two clips of rigs with roles, radians.
fn largest_bone_angle(a: &Clip, a_roles: &Roles, b: &Clip, b_roles: &Roles) -> f32 {
    let mut worst = 0.0f32;
    for frame in 0..a.frames() {
        let (first, second) = (a.world_pose(frame), b.world_pose(frame));
        for pair in bones() {
            let (ours, theirs) = (bone(&first, a_roles, pair), bone(&second, b_roles, pair));
            worst = worst.max(2.0 * (0.5 * ours.distance(theirs)).asin());
        }
    }
    worst
}

#[test]
fn retarget_to_the_same_skeleton_is_the_clip() {
    for (rig, skeleton, _) in fixtures::all() {
        let (roles, clip) = (fixtures::roles(&skeleton), wander(&skeleton, 4, 7));
        assert_eq!(retarget(&clip, &roles, &skeleton, &roles), Ok(clip.clone()), "{rig}");
        let equal = Arc::new(Skeleton::clone(&skeleton));
        assert_eq!(retarget(&clip, &roles, &equal, &roles), Ok(clip), "{rig}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]
    #[test]
    fn retarget_to_another_joint_order_keeps_positions(rig in 0usize..11, seed in 0u64..1000) {
        let (_, source, _) = fixtures::all().swap_remove(rig);
        let (target, order) = fixtures::shuffled(&source, seed);
        let clip = wander(&source, 3, seed);
        let values = (0..3).map(|i| Vec3::Y * (1.0 + 0.1 * i as f32)).collect();
        let clip = clip.with_translations(vec![JointTranslations { joint: 1, values }]).unwrap();
        let there =
            retarget(&clip, &fixtures::roles(&source), &target, &fixtures::roles(&target)).unwrap();
        for frame in 0..3 {
            let (before, after) = (clip.world_pose(frame), there.world_pose(frame));
            for (new, &old) in order.iter().enumerate() {
                prop_assert!(before.positions[old].distance(after.positions[new]) < 1e-5);
            }
        }
        let back = retarget(&there, &fixtures::roles(&target), &source, &fixtures::roles(&source))
            .unwrap();
        prop_assert!(largest_distance(&clip, &back) < 1e-5);
    }

    /// The limbs have the directions of the source's for any proportions and rest pose.
    #[test]
    fn retarget_between_rigs_keeps_limb_directions(
        from in 0usize..11,
        to in 0usize..11,
        seed in 0u64..1000,
        radians in 0.0f32..0.6,
    ) {
        let (_, source, _) = fixtures::all().swap_remove(from);
        let (_, target, _) = fixtures::all().swap_remove(to);
        let source = fixtures::uneven(&source, 1.0, radians, 0.1, seed);
        let target = fixtures::uneven(&target, 1.4, radians, 0.1, seed + 1);
        let (source_roles, target_roles) = (fixtures::roles(&source), fixtures::roles(&target));
        let clip = wander(&source, 3, seed);
        let there = retarget(&clip, &source_roles, &target, &target_roles).unwrap();
        // Rest poses within 2° count as equal.
        prop_assert!(largest_bone_angle(&clip, &source_roles, &there, &target_roles) < 0.036);
    }
}

#[test]
fn retarget_without_fingers_changes_nothing_else() {
    let full = fixtures::mixamo();
    let kept: Vec<usize> = (0..full.len())
        .filter(|&j| {
            !full.joints()[j].name.contains("Index") && !full.joints()[j].name.contains("Thumb")
        })
        .collect();
    let joints = kept.iter().map(|&old| {
        let joint = &full.joints()[old];
        Joint {
            parent: joint.parent.and_then(|p| kept.iter().position(|&k| k == p)),
            ..joint.clone()
        }
    });
    let fingerless = Arc::new(Skeleton::new(joints.collect()).unwrap());
    let (full_roles, roles) = (fixtures::roles(&full), fixtures::roles(&fingerless));
    let clip = wander(&full, 5, 3);
    let there = retarget(&clip, &full_roles, &fingerless, &roles).unwrap();
    let back = retarget(&there, &roles, &full, &full_roles).unwrap();
    for frame in 0..5 {
        let (original, without, again) =
            (clip.world_pose(frame), there.world_pose(frame), back.world_pose(frame));
        for (new, &old) in kept.iter().enumerate() {
            assert!(original.positions[old].distance(without.positions[new]) < 1e-5);
            assert!(original.positions[old].distance(again.positions[old]) < 1e-5);
        }
    }
}

#[test]
fn retarget_to_another_size_keeps_rotations_and_scales_translations() {
    let small = fixtures::lafan();
    let large = fixtures::uneven(&small, 2.0, 0.0, 0.0, 0);
    let (small_roles, large_roles) = (fixtures::roles(&small), fixtures::roles(&large));
    let clip = wander(&small, 5, 1);
    let there = retarget(&clip, &small_roles, &large, &large_roles).unwrap();
    for frame in 0..5 {
        assert_eq!(there.rotations(frame), clip.rotations(frame));
        let (a, b) = (clip.world_pose(frame), there.world_pose(frame));
        for joint in 0..small.len() {
            assert!((a.positions[joint] * 2.0).distance(b.positions[joint]) < 1e-4);
        }
    }
}

/// The motion looks the same on a body with arms that hang at rest instead of stretching out, and
/// on one whose rest pose lies on its side.
#[test]
fn retarget_to_another_rest_pose_keeps_positions() {
    let source = fixtures::mixamo();
    let roles = fixtures::roles(&source);
    let clip = wander(&source, 6, 11);
    let lie = Quat::from_axis_angle(Vec3::ONE.normalize_or(Vec3::X), std::f32::consts::TAU / 3.0);
    let hang = |side: Side| Quat::from_rotation_z(if side == Side::Left { -1.2 } else { 1.2 });
    let arms = Side::BOTH.map(|side| roles.get(Role::upper_arm(side)).unwrap());
    let in_arm = |joint: usize| {
        Side::BOTH.into_iter().find(|side| {
            std::iter::successors(source.parent(joint), |&j| source.parent(j))
                .any(|j| j == arms[side.index()])
        })
    };
    for turn in [Quat::IDENTITY, lie, Quat::from_rotation_x(-std::f32::consts::FRAC_PI_2)] {
        let joints = source.joints().iter().enumerate().map(|(index, joint)| {
            let own = in_arm(index).map_or(turn, |side| turn * hang(side));
            Joint {
                offset: own * joint.offset,
                end_site: joint.end_site.map(|end| own * end),
                ..joint.clone()
            }
        });
        let target = Arc::new(Skeleton::new(joints.collect()).unwrap());
        // Roles come from the names; by shape a body that lies down has none.
        let there = retarget(&clip, &roles, &target, &roles).unwrap();
        for frame in 0..clip.frames() {
            let (a, b) = (clip.world_pose(frame), there.world_pose(frame));
            for role in Role::ALL {
                let joint = roles.get(role).unwrap();
                let lift = b.positions[0] - a.positions[0];
                assert!(
                    (a.positions[joint] + lift).distance(b.positions[joint]) < 1e-4,
                    "{role:?}"
                );
                assert!(lift.length() < 1e-3);
            }
        }
        let back = retarget(&there, &roles, &source, &roles).unwrap();
        assert!(largest_distance(&clip, &back) < 2e-3);
    }
}

/// In rigs whose bones all lie along one axis the legs point up along the back at rest. Knees still
/// bend backwards.
#[test]
fn retarget_from_legs_folded_at_rest_bends_knees_backwards() {
    let source = fixtures::lafan();
    let roles = fixtures::roles(&source);
    let up = |joint: &Joint| {
        let is_leg = ["LeftLeg", "RightLeg", "LeftFoot", "RightFoot", "LeftToe", "RightToe"]
            .contains(&joint.name.as_str());
        let offset = if is_leg { Vec3::Y * joint.offset.length() } else { joint.offset };
        Joint {
            offset,
            end_site: joint.end_site.map(|end| Vec3::Y * end.length()),
            ..joint.clone()
        }
    };
    let target = Arc::new(Skeleton::new(source.joints().iter().map(up).collect()).unwrap());
    let clip = wander_by(&source, 6, 4, 0.4);
    let there = retarget(&clip, &roles, &target, &roles).unwrap();
    assert!(largest_bone_angle(&clip, &roles, &there, &roles) < 0.036);
    // The two shins turn alike about the axis of the knee: each thigh's left stays left.
    for frame in 0..clip.frames() {
        for side in Side::BOTH {
            for role in [Role::thigh(side), Role::shin(side), Role::foot(side)] {
                let joint = roles.get(role).unwrap();
                let (a, b) = (
                    clip.world_pose(frame).rotations[joint] * Vec3::X,
                    there.world_pose(frame).rotations[joint] * Vec3::X,
                );
                assert!(a.dot(b) > 0.99, "{role:?}: {a} {b}");
            }
        }
    }
}

#[test]
fn retarget_keeps_the_height_of_feet() {
    let (source, target) =
        (fixtures::cmu_bvh(), fixtures::uneven(&fixtures::games105(), 0.8, 0.2, 0.1, 2));
    let (source_roles, target_roles) = (fixtures::roles(&source), fixtures::roles(&target));
    let clip = wander_by(&source, 30, 2, 0.2);
    let there = retarget(&clip, &source_roles, &target, &target_roles).unwrap();
    let scale =
        target_roles.leg_length(&target).unwrap() / source_roles.leg_length(&source).unwrap();
    // Measured by the points that both feet have: one of these rigs has no toe tips.
    let level = |clip: &Clip, roles: &Roles| {
        let joints = [Role::LeftFoot, Role::RightFoot, Role::LeftToe, Role::RightToe]
            .map(|role| roles.get(role).unwrap());
        let lowest = |frame| {
            joints
                .map(|joint| clip.world_pose(frame).positions[joint].y)
                .into_iter()
                .fold(f32::INFINITY, f32::min)
        };
        stats::percentile(&(0..clip.frames()).map(lowest).collect::<Vec<f32>>(), 0.05).unwrap()
    };
    let (before, after) = (level(&clip, &source_roles), level(&there, &target_roles));
    assert!((before * scale - after).abs() < 1e-5, "{before} {after}");
    // The hips' trajectory over the ground is scaled.
    let hips = |clip: &Clip, roles: &Roles, frame| {
        clip.world_pose(frame).positions[roles.get(Role::Hips).unwrap()]
    };
    let way = |clip: &Clip, roles: &Roles| hips(clip, roles, 29) - hips(clip, roles, 0);
    let (ours, theirs) = (way(&there, &target_roles), way(&clip, &source_roles) * scale);
    assert!((ours - theirs).length() < 1e-4);
}

/// An ankle stands higher than a toe tip and must not be compared with it, as between a body
/// without toes and one with toe tips.
#[test]
fn retarget_between_feet_with_and_without_toes_keeps_their_height() {
    let with_toes = fixtures::lafan();
    let small = fixtures::uneven(&with_toes, 0.8, 0.0, 0.0, 0);
    let kept: Vec<usize> =
        (0..small.len()).filter(|&joint| !small.joints()[joint].name.ends_with("Toe")).collect();
    let joint = |&joint: &usize| {
        let joint = &small.joints()[joint];
        Joint {
            parent: joint.parent.and_then(|parent| kept.iter().position(|&kept| kept == parent)),
            end_site: None,
            ..joint.clone()
        }
    };
    let without = Arc::new(Skeleton::new(kept.iter().map(joint).collect()).unwrap());
    for (source, target) in [(&with_toes, &without), (&without, &with_toes)] {
        let (source_roles, target_roles) = (Roles::detect(source), Roles::detect(target));
        let clip = wander_by(source, 30, 2, 0.2);
        let there = retarget(&clip, &source_roles, target, &target_roles).unwrap();
        let scale =
            target_roles.leg_length(target).unwrap() / source_roles.leg_length(source).unwrap();
        for frame in 0..clip.frames() {
            let (a, b) = (clip.world_pose(frame), there.world_pose(frame));
            for side in Side::BOTH {
                let height = |world: &WorldPose, roles: &Roles| {
                    world.positions[roles.get(Role::foot(side)).unwrap()].y
                };
                let off = height(&b, &target_roles) - height(&a, &source_roles) * scale;
                assert!(off.abs() < 0.01, "{} cm in frame {frame}", off * 100.0);
            }
        }
    }
}

#[test]
fn retarget_to_more_spine_joints_shares_the_bend() {
    let (source, target) = (fixtures::games105(), fixtures::mixamo());
    let (source_roles, target_roles) = (fixtures::roles(&source), fixtures::roles(&target));
    let joints = source.len();
    let mut rotations = vec![Quat::IDENTITY; joints];
    rotations[source_roles.get(Role::Spine).unwrap()] = Quat::from_rotation_x(0.2);
    rotations[source.find("lowerback_torso").unwrap()] = Quat::from_rotation_x(0.4);
    let clip = Clip::new("bow", source, 30.0, rotations, vec![Vec3::Y]).unwrap();
    let there = retarget(&clip, &source_roles, &target, &target_roles).unwrap();
    let world = there.world_pose(0);
    let bend = |name: &str| quat::log(world.rotations[target.find(name).unwrap()]).x;
    // Spine and chest as in the source, the joint between them half-way.
    assert!((bend("mixamorig:Spine") - 0.2).abs() < 1e-5);
    assert!((bend("mixamorig:Spine1") - 0.4).abs() < 1e-5);
    assert!((bend("mixamorig:Spine2") - 0.6).abs() < 1e-5);
}

#[test]
fn retarget_of_hips_below_a_still_root_keeps_their_trajectory() {
    let (source, target) = (fixtures::bandai(), fixtures::lafan());
    let (source_roles, target_roles) = (fixtures::roles(&source), fixtures::roles(&target));
    let rotations = wander(&source, 4, 1);
    let rotations = (0..4)
        .flat_map(|f| {
            std::iter::once(Quat::IDENTITY)
                .chain(rotations.rotations(f)[1..].iter().copied())
                .collect::<Vec<_>>()
        })
        .collect();
    let values: Vec<Vec3> = (0..4).map(|i| Vec3::new(0.1, 0.95, 0.3 * i as f32)).collect();
    let clip =
        Clip::new("walk", Arc::clone(&source), 30.0, rotations, vec![Vec3::ZERO; 4]).unwrap();
    let clip = clip
        .with_translations(vec![JointTranslations {
            joint: source_roles.get(Role::Hips).unwrap(),
            values,
        }])
        .unwrap();
    let there = retarget(&clip, &source_roles, &target, &target_roles).unwrap();
    for frame in 0..4 {
        let (a, b) = (clip.world_pose(frame), there.world_pose(frame));
        // Between chest and head these rigs have different joints.
        for role in Side::BOTH.into_iter().flat_map(Role::leg).chain([Role::Hips, Role::Spine]) {
            let distance = a.positions[source_roles.get(role).unwrap()]
                .distance(b.positions[target_roles.get(role).unwrap()]);
            assert!(distance < 1e-3, "{role:?}: {distance}");
        }
    }
}

#[test]
fn retarget_without_common_joints_is_refused() {
    let clip = wander(&fixtures::lafan(), 2, 1);
    let target = fixtures::nameless(&fixtures::lafan());
    assert_eq!(
        retarget(&clip, &Roles::default(), &target, &Roles::default()),
        Err(RetargetError::NothingInCommon)
    );
}

/// The ankles of one rig lie higher above the sole, and its feet point outwards at rest: soles stay
/// flat, headings stay.
#[test]
fn retarget_keeps_soles_flat_and_their_heading() {
    let source = fixtures::lafan();
    let roles = fixtures::roles(&source);
    let outwards =
        |name: &str| Quat::from_rotation_y(if name.starts_with("Left") { 0.35 } else { -0.35 });
    let joints = source.joints().iter().map(|joint| {
        let is_toe = joint.name.ends_with("Toe");
        let offset = if is_toe {
            outwards(&joint.name) * (joint.offset - Vec3::Y * 0.04)
        } else {
            joint.offset
        };
        Joint {
            offset,
            end_site: joint
                .end_site
                .map(|end| if is_toe { outwards(&joint.name) * end } else { end }),
            ..joint.clone()
        }
    });
    let target = Arc::new(Skeleton::new(joints.collect()).unwrap());
    let clip = wander(&source, 6, 9);
    let there = retarget(&clip, &roles, &target, &roles).unwrap();
    for frame in 0..clip.frames() {
        let (a, b) = (clip.world_pose(frame), there.world_pose(frame));
        for side in Side::BOTH {
            for joint in [roles.get(Role::foot(side)).unwrap(), roles.get(Role::toe(side)).unwrap()]
            {
                let (ours, theirs) = (b.rotations[joint], a.rotations[joint]);
                // The up axis of a sole stays up, and its forward axis stays forward.
                assert!((ours * Vec3::Y).distance(theirs * Vec3::Y) < 1e-5);
                let forward = outwards(&source.joints()[joint].name) * Vec3::Z;
                assert!((ours * forward).distance(theirs * Vec3::Z) < 0.03, "{side:?}");
            }
        }
    }
}

/// Thousands of joints, in a chain or all on one parent, take neither long nor all memory.
#[test]
fn retarget_of_unusual_trees_succeeds() {
    type ParentOf = fn(usize) -> Option<usize>;
    let shapes: [ParentOf; 2] = [|i| i.checked_sub(1), |i| (i > 0).then_some(0)];
    for parent in shapes {
        let joint = |i: usize| Joint {
            name: format!("{i}"),
            parent: parent(i),
            offset: Vec3::Y * 0.01,
            end_site: None,
            channels: vec![],
        };
        let source = Arc::new(Skeleton::new((0..3000).map(joint).collect()).unwrap());
        let target = fixtures::uneven(&source, 1.0, 0.3, 0.1, 3);
        let roles = Roles::detect(&source);
        let clip = wander_by(&source, 2, 1, 0.1);
        let there = retarget(&clip, &roles, &target, &Roles::detect(&target)).unwrap();
        assert_eq!(there.frames(), 2);
        assert!(there.world_positions(0..2).iter().all(|p| p.is_finite()));
        let mut sided = Roles::default();
        sided.set(Role::LeftThigh, Some(1));
        sided.set(Role::RightThigh, Some(2));
        let twice =
            crate::clip::mirror(&clip, &sided).and_then(|once| crate::clip::mirror(&once, &sided));
        assert!(
            twice.is_err()
                || twice
                    .is_ok_and(|twice| twice.world_positions(0..2).iter().all(|p| p.is_finite()))
        );
    }
}

/// An implausible rest pose does not determine the twist of bones. A collar bone must not come out
/// rotated by half a turn.
#[test]
fn retarget_with_implausible_rest_pose_equals_the_plain_one() {
    let clip = synthesize(&Params::new(Action::Walk)).unwrap().clip;
    let roles = Roles::detect(clip.skeleton());
    let target = fixtures::mixamo();
    let target_roles = fixtures::roles(&target);
    let plain = retarget(&clip, &roles, &target, &target_roles).unwrap();
    for seed in 0..3 {
        let (turned, turns) = fixtures::turned(clip.skeleton(), seed);
        let poses = (0..clip.frames())
            .map(|frame| fixtures::turned_pose(clip.skeleton(), &turns, &clip.pose(frame)));
        let rewritten = Clip::from_poses("turned", turned, clip.fps(), poses).unwrap();
        let moved = retarget(&rewritten, &roles, &target, &target_roles).unwrap();
        let stance = stance_for_rest(&rewritten, &roles);
        let (from, to) = ((&plain, &target_roles), (rewritten.skeleton(), &roles));
        let mut directions = Directions::new(from, to, stance.as_ref()).unwrap();
        // A few frames at a time.
        let back = loop {
            if let Some((back, _)) = directions.advance(&plain, 17).unwrap() {
                break back;
            }
        };
        for frame in (0..clip.frames()).step_by(20) {
            let [plain, moved, back, clip] =
                [&plain, &moved, &back, &rewritten].map(|clip| clip.world_pose(frame));
            for role in Role::ALL {
                if let Some(joint) = target_roles.get(role) {
                    let apart = quat::angle_between(plain.rotations[joint], moved.rotations[joint])
                        .to_degrees();
                    assert!(apart < 25.0, "{seed} {frame} {role:?}: {apart}°");
                }
                if let Some(joint) = roles.get(role) {
                    let apart = quat::angle_between(clip.rotations[joint], back.rotations[joint])
                        .to_degrees();
                    assert!(apart < 25.0, "{seed} {frame} {role:?} and back: {apart}°");
                }
            }
        }
    }
}
