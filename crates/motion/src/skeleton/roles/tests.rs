//! Tests of role detection.

use super::*;
use crate::skeleton::{Joint, fixtures};
use glam::Vec3;

fn names(skeleton: &Skeleton, roles: &Roles) -> Vec<String> {
    Role::ALL
        .iter()
        .map(|&role| {
            roles.get(role).map_or(String::new(), |joint| skeleton.joints()[joint].name.clone())
        })
        .collect()
}

#[test]
fn detect_on_common_rigs_finds_roles_by_name() {
    for (rig, skeleton, wanted) in fixtures::all() {
        let roles = Roles::detect(&skeleton);
        assert_eq!(names(&skeleton, &roles), wanted, "{rig}");
        for role in Role::ALL {
            assert_eq!(roles.source(role), Some(RoleSource::ByName), "{rig}: {role:?}");
        }
    }
}

#[test]
fn detect_does_not_depend_on_the_order_of_joints() {
    for (rig, skeleton, wanted) in fixtures::all() {
        for seed in 0..8 {
            let (shuffled, _) = fixtures::shuffled(&skeleton, seed);
            assert_eq!(names(&shuffled, &Roles::detect(&shuffled)), wanted, "{rig}, seed {seed}");
        }
    }
}

#[test]
fn detect_ignores_case() {
    for (rig, skeleton, wanted) in fixtures::all() {
        let lower = skeleton
            .joints()
            .iter()
            .map(|joint| Joint { name: joint.name.to_lowercase(), ..joint.clone() });
        let lower = Skeleton::new(lower.collect()).unwrap();
        let wanted = wanted.map(str::to_lowercase);
        assert_eq!(names(&lower, &names::detect(&lower)), wanted, "{rig}");
    }
}

#[test]
fn detect_without_names_finds_roles_by_shape() {
    for (rig, skeleton, mut wanted) in fixtures::all() {
        if rig == "biped" {
            // Without names, the joint from which the legs hang is the hips, and the next one above
            // it the spine.
            (wanted[0], wanted[1]) = ("Bip01 Spine", "Bip01 Spine1");
        }
        for seed in 0..4 {
            let (shuffled, _) =
                fixtures::shuffled(&fixtures::uneven(&skeleton, 1.3, 0.03, 0.05, seed), seed);
            let roles = Roles::detect(&fixtures::nameless(&shuffled));
            assert_eq!(names(&shuffled, &roles), wanted, "{rig}, seed {seed}");
            assert!(Role::ALL.iter().all(|&role| roles.source(role) == Some(RoleSource::ByShape)));
        }
    }
}

#[test]
fn detect_by_shape_takes_sides_from_the_toes() {
    let half_turn = glam::Quat::from_rotation_y(std::f32::consts::PI);
    for (rig, skeleton, wanted) in fixtures::all().into_iter().filter(|(rig, ..)| *rig != "biped") {
        let turned = skeleton.joints().iter().enumerate().map(|(i, joint)| Joint {
            name: format!("j{i}"),
            offset: half_turn * joint.offset,
            end_site: joint.end_site.map(|end| half_turn * end),
            ..joint.clone()
        });
        let turned = Skeleton::new(turned.collect()).unwrap();
        assert_eq!(names(&skeleton, &Roles::detect(&turned)), wanted, "{rig}");
    }
}

#[test]
fn detect_fills_missing_names_by_shape() {
    let skeleton = fixtures::mixamo();
    let joints = skeleton.joints().iter().map(|joint| {
        let strange = joint.name.ends_with("RightLeg") || joint.name.ends_with("Head");
        Joint { name: if strange { "xyz".into() } else { joint.name.clone() }, ..joint.clone() }
    });
    let roles = Roles::detect(&Skeleton::new(joints.collect()).unwrap());
    let all_named = Roles::detect(&skeleton);
    for role in Role::ALL {
        assert_eq!(roles.get(role), all_named.get(role), "{role:?}");
        let found = if [Role::RightShin, Role::Head].contains(&role) {
            RoleSource::ByShape
        } else {
            RoleSource::ByName
        };
        assert_eq!(roles.source(role), Some(found), "{role:?}");
    }
}

#[test]
fn detect_on_unusual_trees_does_not_panic() {
    let joint = |parent, offset| Joint {
        name: "Joint".into(),
        parent,
        offset,
        end_site: None,
        channels: vec![],
    };
    assert_eq!(Roles::detect(&Skeleton::new(vec![joint(None, Vec3::ZERO)]).unwrap()).count(), 0);
    let snake: Vec<Joint> = (0..3000).map(|i: usize| joint(i.checked_sub(1), Vec3::Z)).collect();
    assert_eq!(Roles::detect(&Skeleton::new(snake).unwrap()).count(), 0);
    let star: Vec<Joint> =
        (0..100).map(|i: usize| joint((i > 0).then_some(0), Vec3::ZERO)).collect();
    assert_eq!(Roles::detect(&Skeleton::new(star).unwrap()).count(), 0);
    let not_numbers: Vec<Joint> =
        (0..20).map(|i: usize| joint((i > 0).then_some(i / 2), Vec3::splat(f32::NAN))).collect();
    let roles = Roles::detect(&Skeleton::new(not_numbers).unwrap());
    assert!(Role::ALL.into_iter().all(|role| roles.get(role).is_none_or(|joint| joint < 20)));
}

#[test]
fn set_removes_the_joint_from_its_old_role() {
    let skeleton = fixtures::lafan();
    let mut roles = fixtures::roles(&skeleton);
    let (foot, toe) = (roles.get(Role::LeftFoot), roles.get(Role::LeftToe));
    roles.set(Role::LeftFoot, toe);
    assert_eq!((roles.get(Role::LeftFoot), roles.get(Role::LeftToe)), (toe, None));
    assert_eq!(roles.source(Role::LeftFoot), Some(RoleSource::ByHand));
    roles.set(Role::LeftFoot, foot);
    roles.set(Role::LeftFoot, None);
    assert_eq!(roles.missing().collect::<Vec<_>>(), [Role::LeftFoot, Role::LeftToe]);
}

#[test]
fn roles_serialize_by_name() {
    let roles = fixtures::roles(&fixtures::cmu_asf());
    let stored = serde_json::to_string(&roles).unwrap();
    assert!(stored.contains(r#""LeftThigh":{"joint":"#), "{stored}");
    assert_eq!(serde_json::from_str::<Roles>(&stored).unwrap(), roles);
}

#[test]
fn body_height_follows_from_the_legs() {
    let skeleton = fixtures::lafan();
    let roles = fixtures::roles(&skeleton);
    let leg = roles.leg_length(&skeleton).unwrap();
    let wanted = Vec3::new(0.0, 0.41, 0.01).length() + Vec3::new(0.0, 0.41, 0.03).length();
    assert!((leg - wanted).abs() < 1e-5);
    assert!((roles.body_height(&skeleton) - leg / 0.491).abs() < 1e-5);
    // Expected without roles: the longest path along bones, over all pairs of joints and end sites,
    // by the lengths up to where their paths to the root meet.
    let mut ways: Vec<Vec<(usize, f32)>> = Vec::new();
    for (index, joint) in skeleton.joints().iter().enumerate() {
        let mut way = vec![(index, 0.0)];
        let (mut at, mut length) = (index, 0.0);
        while let Some(parent) = skeleton.parent(at) {
            length += skeleton.joints()[at].offset.length();
            way.push((parent, length));
            at = parent;
        }
        ways.extend(
            joint
                .end_site
                .map(|end| way.iter().map(|&(joint, far)| (joint, far + end.length())).collect()),
        );
        ways.push(way);
    }
    let between = |a: &[(usize, f32)], b: &[(usize, f32)]| {
        let meeting = a
            .iter()
            .find_map(|&(joint, far)| Some(far + b.iter().find(|(other, _)| *other == joint)?.1));
        meeting.unwrap_or(0.0)
    };
    let longest =
        ways.iter().flat_map(|a| ways.iter().map(move |b| between(a, b))).fold(0.0, f32::max);
    assert!((Roles::default().body_height(&skeleton) - longest).abs() < 1e-4);
}

/// Returns a spider: eight legs of four joints, named by `name` from the side, the leg and the
/// part.
fn spider(name: impl Fn(&str, usize, usize) -> String) -> Skeleton {
    let mut joints = vec![Joint {
        name: "body".into(),
        parent: None,
        offset: Vec3::Y * 0.35,
        end_site: None,
        channels: vec![],
    }];
    for (side, sign) in [("L", 1.0), ("R", -1.0)] {
        for leg in 0..4 {
            let angle = 0.75 - 0.5 * leg as f32;
            let out = Vec3::new(sign * angle.cos(), 0.0, angle.sin());
            let mut parent = 0;
            for (part, (reach, rise)) in
                [(0.12, 0.0), (0.12, 0.12), (0.3, 0.25), (0.3, -0.35)].into_iter().enumerate()
            {
                joints.push(Joint {
                    name: name(side, leg, part),
                    parent: Some(parent),
                    offset: out * reach + Vec3::Y * rise,
                    end_site: (part == 3).then(|| out * 0.18 + Vec3::Y * -0.35),
                    channels: vec![],
                });
                parent = joints.len() - 1;
            }
        }
    }
    Skeleton::new(joints).unwrap()
}

#[test]
fn spider_has_no_limbs_of_a_person() {
    let named = [
        spider(|side, leg, part| format!("leg_{side}{leg}_{part}")),
        spider(|side, leg, part| {
            format!("{}.{leg}.{side}", ["hip", "thigh", "shin", "foot"][part.min(3)])
        }),
        spider(|side, leg, part| format!("j{side}{leg}{part}")),
    ];
    for skeleton in named {
        let roles = Roles::detect(&skeleton);
        let limbs = Side::BOTH.into_iter().flat_map(|side| {
            Role::leg(side)
                .into_iter()
                .chain(Role::arm(side))
                .filter(|&role| roles.get(role).is_some())
        });
        assert_eq!(limbs.collect::<Vec<_>>(), [], "{}", skeleton.joints()[2].name);
    }
}

#[test]
fn stated_roles_come_before_names_and_the_rest_is_found() {
    let skeleton = fixtures::mixamo();
    let found = Roles::detect(&skeleton);
    let joint = |role| found.get(role).unwrap();
    let hand = joint(Role::LeftHand);
    let parent = skeleton.parent(hand).unwrap();
    let stated = [
        // Contradicts the names: its forearm is called a hand.
        (Role::LeftHand, parent),
        (Role::LeftHand, hand),
        (Role::Spine, parent),
        (Role::Head, skeleton.len()),
        (Role::Hips, joint(Role::Hips)),
    ];
    let roles = Roles::detect_beside(&skeleton, &stated);
    assert_eq!(roles.get(Role::LeftHand), Some(parent));
    assert_eq!(roles.source(Role::LeftHand), Some(RoleSource::ByFile));
    assert_eq!(roles.get(Role::LeftForearm), None, "the hand cannot be the forearm, too");
    for role in [Role::Spine, Role::Head, Role::RightToe] {
        assert_eq!(roles.get(role), found.get(role), "{role:?}");
        assert_eq!(roles.source(role), Some(RoleSource::ByName));
    }
    assert_eq!(Roles::detect_beside(&skeleton, &[]), found);
}

#[test]
fn renumbered_roles_keep_their_joints() {
    let skeleton = fixtures::lafan();
    let roles = fixtures::roles(&skeleton);
    let (other, order) = fixtures::shuffled(&skeleton, 4);
    let mut joint_from_own = vec![0; order.len()];
    for (new, &own) in order.iter().enumerate() {
        joint_from_own[own] = new;
    }
    let moved = roles.renumbered(&joint_from_own);
    assert_eq!(names(&other, &moved), names(&skeleton, &roles));
    assert_eq!(roles.renumbered(&[]).count(), 0);
}
