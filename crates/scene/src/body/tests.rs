//! Tests of bodies generated around skeletons.

use super::*;
use crate::{Pane, rgb};
use glam::{Quat, Vec3};
use segue_motion::clip::fixtures::{points_clip, points_skeleton};
use segue_motion::skeleton::{Joint, Pose, Role, world_pose};
use segue_motion::skin::RigidTransform;
use segue_motion::synth::{Action, Params, synthesize};

fn skeleton(joints: &[(&str, Option<usize>, [f32; 3])]) -> Skeleton {
    let joints = joints
        .iter()
        .map(|&(name, parent, offset)| Joint {
            name: name.into(),
            parent,
            offset: offset.into(),
            end_site: None,
            channels: vec![],
        })
        .collect();
    Skeleton::new(joints).unwrap()
}

/// An adult in a T-pose, metres.
fn adult() -> Skeleton {
    skeleton(&[
        ("Hips", None, [0.0, 0.95, 0.0]),
        ("LeftUpLeg", Some(0), [0.09, -0.04, 0.0]),
        ("LeftLeg", Some(1), [0.0, -0.42, 0.0]),
        ("LeftFoot", Some(2), [0.0, -0.41, 0.0]),
        ("LeftToe", Some(3), [0.0, -0.06, 0.14]),
        ("RightUpLeg", Some(0), [-0.09, -0.04, 0.0]),
        ("RightLeg", Some(5), [0.0, -0.42, 0.0]),
        ("RightFoot", Some(6), [0.0, -0.41, 0.0]),
        ("RightToe", Some(7), [0.0, -0.06, 0.14]),
        ("Spine", Some(0), [0.0, 0.1, -0.01]),
        ("Spine1", Some(9), [0.0, 0.13, 0.0]),
        ("Spine2", Some(10), [0.0, 0.13, 0.0]),
        ("Neck", Some(11), [0.0, 0.2, 0.0]),
        ("Head", Some(12), [0.0, 0.1, 0.02]),
        ("LeftShoulder", Some(11), [0.04, 0.13, 0.0]),
        ("LeftArm", Some(14), [0.13, 0.0, 0.0]),
        ("LeftForeArm", Some(15), [0.28, 0.0, 0.0]),
        ("LeftHand", Some(16), [0.25, 0.0, 0.0]),
        ("RightShoulder", Some(11), [-0.04, 0.13, 0.0]),
        ("RightArm", Some(18), [-0.13, 0.0, 0.0]),
        ("RightForeArm", Some(19), [-0.28, 0.0, 0.0]),
        ("RightHand", Some(20), [-0.25, 0.0, 0.0]),
    ])
}

fn rest_limbs(skeleton: &Skeleton, body: &Body) -> Vec<Limb> {
    let pose = Pose { root_translation: skeleton.joints()[0].offset, ..Pose::default() };
    let mut limbs = Vec::new();
    body.limbs(&world_pose(skeleton, &pose), rgb(0xff_ff_ff), &mut limbs);
    limbs
}

fn lowest(limbs: &[Limb]) -> f32 {
    // Half the height of an ellipse of radius r, scaled by k along the unit vector f, in the
    // direction y: r √(1 - f_y² (1 - k²)).
    let reach = |limb: &Limb, radius: f32| {
        radius * (1.0 - limb.flat.y.powi(2) * (1.0 - limb.flatness.powi(2))).sqrt()
    };
    limbs
        .iter()
        .flat_map(|l| [l.a.y - reach(l, l.radius_a), l.b.y - reach(l, l.radius_b)])
        .fold(f32::INFINITY, f32::min)
}

#[test]
fn body_of_an_adult_has_its_height_and_width_and_is_symmetric() {
    let skeleton = adult();
    let body = Body::new(&skeleton, Some(&Roles::detect(&skeleton)));
    let limbs = rest_limbs(&skeleton, &body);
    assert_eq!(limbs.len(), body.limb_count());
    let top =
        limbs.iter().map(|l| (l.a.y + l.radius_a).max(l.b.y + l.radius_b)).fold(0.0, f32::max);
    assert!((1.6..1.85).contains(&top), "crown at {top} m");
    // The joint at the ball of the foot is at 2 cm: the sole lies on the ground, give or take a
    // centimetre.
    assert!(lowest(&limbs).abs() < 0.012, "sole at {} m", lowest(&limbs));
    for limb in &limbs {
        let mirrored = |p: Vec3| p * Vec3::new(-1.0, 1.0, 1.0);
        let twin = limbs.iter().any(|other| {
            let straight = other.a.distance(mirrored(limb.a)) < 1e-4
                && other.b.distance(mirrored(limb.b)) < 1e-4;
            let turned = other.b.distance(mirrored(limb.a)) < 1e-4
                && other.a.distance(mirrored(limb.b)) < 1e-4;
            let same = |x: f32, y: f32| (x - y).abs() < 1e-5;
            (straight && same(other.radius_a, limb.radius_a) && same(other.radius_b, limb.radius_b))
                || (turned
                    && same(other.radius_a, limb.radius_b)
                    && same(other.radius_b, limb.radius_a))
        });
        assert!(twin, "no mirror image of {limb:?}");
    }
}

#[test]
fn body_of_a_scaled_and_moved_skeleton_is_scaled_and_moved() {
    let skeleton = adult();
    let half = Skeleton::new(
        skeleton.joints().iter().map(|j| Joint { offset: j.offset * 0.5, ..j.clone() }).collect(),
    )
    .unwrap();
    let full = rest_limbs(&skeleton, &Body::new(&skeleton, Some(&Roles::detect(&skeleton))));
    let small = rest_limbs(&half, &Body::new(&half, Some(&Roles::detect(&half))));
    for (x, y) in full.iter().zip(&small) {
        assert!((x.a * 0.5).distance(y.a) < 1e-4 && (x.radius_a * 0.5 - y.radius_a).abs() < 1e-4);
    }

    let turn = Quat::from_rotation_y(1.2);
    let body = Body::new(&skeleton, Some(&Roles::detect(&skeleton)));
    let mut rotations = vec![Quat::IDENTITY; skeleton.len()];
    rotations[0] = turn;
    let root_translation = skeleton.joints()[0].offset;
    let mut turned = Vec::new();
    body.limbs(
        &world_pose(&skeleton, &Pose { root_translation, rotations, translations: vec![] }),
        rgb(0),
        &mut turned,
    );
    for (x, y) in full.iter().zip(&turned) {
        assert!((turn * x.b).distance(y.b) < 1e-4 && (turn * x.flat).distance(y.flat) < 1e-4);
    }
}

#[test]
fn body_with_legs_upside_down_at_rest_has_the_same_shapes() {
    // In some files all bones of the resting skeleton point along one axis, and poses turn the legs
    // down. Knees and feet must look the same.
    let upright = adult();
    let mut joints = upright.joints().to_vec();
    for joint in [1, 5] {
        for below in &mut joints[joint + 1..joint + 4] {
            // Half a turn about x of everything below the hip joints.
            below.offset *= Vec3::new(1.0, -1.0, -1.0);
        }
    }
    let odd = Skeleton::new(joints).unwrap();
    let mut rotations = vec![Quat::IDENTITY; odd.len()];
    for joint in [1, 5] {
        rotations[joint] = Quat::from_rotation_x(std::f32::consts::PI);
    }
    let root_translation = odd.joints()[0].offset;
    let body = Body::new(&odd, Some(&Roles::detect(&odd)));
    let mut limbs = Vec::new();
    body.limbs(
        &world_pose(&odd, &Pose { root_translation, rotations, translations: vec![] }),
        rgb(0),
        &mut limbs,
    );
    let expected = rest_limbs(&upright, &Body::new(&upright, Some(&Roles::detect(&upright))));
    assert_eq!(limbs.len(), expected.len());
    for (x, y) in limbs.iter().zip(&expected) {
        assert!(x.a.distance(y.a) < 2e-3 && x.b.distance(y.b) < 2e-3, "{x:?} is not {y:?}");
    }
}

#[test]
fn body_of_any_tree_is_thicker_towards_its_root() {
    let skeleton = adult();
    let limbs = rest_limbs(&skeleton, &Body::new(&skeleton, None));
    let radius_from = |a: Vec3| {
        limbs
            .iter()
            .filter(|l| l.a.distance(a) < 1e-4 && l.a != l.b)
            .map(|l| l.radius_a)
            .fold(0.0, f32::max)
    };
    let (thigh, shin, foot) = (
        radius_from(Vec3::new(0.09, 0.91, 0.0)),
        radius_from(Vec3::new(0.09, 0.49, 0.0)),
        radius_from(Vec3::new(0.09, 0.08, 0.0)),
    );
    assert!(thigh > shin && shin > foot && foot > 0.01, "{thigh} {shin} {foot}");
    // One limb per bone with a length, and the trunk.
    assert_eq!(limbs.len(), 22);
}

#[test]
fn body_of_a_degenerate_skeleton_is_finite() {
    let point = skeleton(&[("root", None, [0.0; 3])]);
    assert_eq!(rest_limbs(&point, &Body::new(&point, Some(&Roles::detect(&point)))).len(), 1);
    let flat = skeleton(&[
        ("root", None, [0.0; 3]),
        ("same", Some(0), [0.0; 3]),
        ("far", Some(1), [1.0, 0.0, 0.0]),
    ]);
    let limbs = rest_limbs(&flat, &Body::new(&flat, Some(&Roles::detect(&flat))));
    assert!(!limbs.is_empty() && limbs.iter().all(|l| l.radius_a > 0.0 && l.a.is_finite()));
    // A pose with fewer joints than the body, or with numbers that are not finite, has fewer limbs.
    let body = Body::new(&adult(), None);
    let mut out = Vec::new();
    body.limbs(
        &WorldPose { positions: vec![Vec3::ZERO], rotations: vec![Quat::IDENTITY] },
        rgb(0),
        &mut out,
    );
    assert!(out.len() <= 1);
    body.limbs(
        &WorldPose { positions: vec![Vec3::NAN; 22], rotations: vec![Quat::IDENTITY; 22] },
        rgb(0),
        &mut out,
    );
    assert!(out.len() <= 1);
}

#[test]
fn retargeted_character_follows_another_skeleton_and_takes_its_colours() {
    let walk = synthesize(&Params::new(Action::Walk)).unwrap().clip;
    let roles = Roles::detect(walk.skeleton());
    let skeleton = Arc::new(adult());
    let character = Character {
        roles: Roles::detect(&skeleton),
        mesh: Arc::new(SkinnedMesh {
            bind: vec![RigidTransform::IDENTITY; skeleton.len()],
            ..SkinnedMesh::default()
        }),
        skeleton,
    };
    let drive = Drive::new(&walk, &roles, &character).unwrap();
    let body = Body::retargeted(&character, drive, walk.skeleton(), &roles);
    for role in [Role::LeftHand, Role::RightFoot, Role::Head] {
        let own = character.roles.get(role).unwrap();
        assert_eq!(Some(body.color_joint(own)), roles.get(role), "{role:?}");
    }
    let mut pane = Pane::default();
    let gray = |joint: usize| [joint as f32, 0.0, 0.0, 1.0];
    pane.add_colored_body(&body, &body.drawn_pose(walk.world_pose(10)), gray);
    let hand = character.roles.get(Role::LeftHand).unwrap();
    assert_eq!(pane.joints.len(), character.skeleton.len());
    assert_eq!(pane.joint_colors[hand], gray(roles.get(Role::LeftHand).unwrap()));
    // It follows the clip over the ground, on its own legs.
    let hips = character.roles.get(Role::Hips).unwrap();
    let there = walk.world_pose(10).positions[roles.get(Role::Hips).unwrap()];
    assert!(pane.joints[hips].translation.distance(there) < 0.3);
    assert!(pane.figures[0].skin.is_some() && !pane.limbs.is_empty());
}

#[test]
fn girth_above_one_widens_limbs_and_keeps_their_lengths() {
    let skeleton = adult();
    let roles = Roles::detect(&skeleton);
    let limbs =
        |girth: f32| rest_limbs(&skeleton, &Body::new(&skeleton, Some(&roles)).with_girth(girth));
    for (thin, broad) in limbs(1.0).iter().zip(limbs(1.5)) {
        assert_eq!((thin.a, thin.b), (broad.a, broad.b));
        assert!((broad.radius_a - 1.5 * thin.radius_a).abs() < 1e-6);
    }
}

#[test]
fn clip_of_points_has_a_ball_at_each_and_no_limb_between_them() {
    let skeleton = points_skeleton(4);
    let frames: Vec<Vec<[f32; 3]>> = (0..3)
        .map(|frame| {
            let x = 0.1 * frame as f32;
            vec![[0.0, 0.9, 0.0], [x, 0.0, 0.0], [x, 1.7, 0.0], [0.4, 0.9, x]]
        })
        .collect();
    let clip = points_clip(&skeleton, 30.0, &frames);
    assert!(clip.is_of_points());
    let walk = synthesize(&Params::new(Action::Walk)).unwrap().clip;
    assert!(!walk.is_of_points());
    let placed = Skeleton::new(
        skeleton
            .joints()
            .iter()
            .zip(&frames[0])
            .map(|(joint, at)| Joint { offset: Vec3::from_array(*at), ..joint.clone() })
            .collect(),
    );
    let body = Body::of_points(&placed.unwrap());
    let mut limbs = Vec::new();
    body.limbs(&clip.world_pose(2), rgb(0), &mut limbs);
    assert_eq!(limbs.len(), 3, "none in their middle");
    for (limb, at) in limbs.iter().zip(&frames[2][1..]) {
        assert!(limb.a == limb.b && limb.a.distance(Vec3::from_array(*at)) < 1e-5, "{limb:?}");
        assert!((0.005..0.03).contains(&limb.radius_a), "{}", limb.radius_a);
    }
}
