//! Tests of skinning against another program and closed forms, and of properties that every body
//! must have.

use super::*;
use crate::clip::Clip;
use crate::math::quat;
use crate::skeleton::Pose;
use crate::skeleton::{Joint, Role, Side, fixtures, world_pose};
use crate::synth::{Action, Params, humanoid, synthesize};
use proptest::prelude::*;
use serde::Deserialize;
use std::collections::HashMap;
use std::sync::Arc;

#[derive(Deserialize)]
struct Golden {
    rotations: Vec<[f32; 4]>,
    translations: Vec<Vec3>,
    positions: Vec<Vec3>,
    normals: Vec<Vec3>,
    joints: Vec<[u16; 4]>,
    weights: Vec<[f32; 4]>,
    linear: Vec<[Vec3; 2]>,
    dual: Vec<[Vec3; 2]>,
}

#[test]
fn skinning_by_both_methods_agrees_with_numpy() {
    let golden: Golden =
        serde_json::from_str(include_str!("../../tests/oracles/skinning.json")).unwrap();
    let transforms: Vec<RigidTransform> = (golden.rotations.iter().zip(&golden.translations))
        .map(|(rotation, &translation)| RigidTransform {
            rotation: Quat::from_array(*rotation),
            translation,
        })
        .collect();
    let mesh = SkinnedMesh {
        positions: golden.positions,
        normals: golden.normals,
        joints: golden.joints,
        weights: golden.weights,
        ..SkinnedMesh::default()
    };
    let (mut positions, mut normals) = (vec![], vec![]);
    for (expected, way) in [
        (golden.linear, linear_blend as fn(&_, &_, &mut _, &mut _)),
        (golden.dual, dual_quaternion),
    ] {
        way(&mesh, transforms.as_slice(), &mut positions, &mut normals);
        for (vertex, [position, normal]) in expected.into_iter().enumerate() {
            assert!(
                positions[vertex].distance(position) < 2e-6,
                "vertex {vertex}: {}, not {position}",
                positions[vertex]
            );
            assert!(
                normals[vertex].distance(normal) < 2e-5,
                "normal {vertex}: {}, not {normal}",
                normals[vertex]
            );
        }
    }
}

/// Returns a tube along X about two joints, at 0 and at 0.3 m, with a radius of 4 cm. Its weights
/// change evenly from 0.25 to 0.35 m.
fn tube() -> SkinnedMesh {
    let mut mesh = SkinnedMesh::default();
    for ring in 0..=60 {
        let x = 0.01 * ring as f32;
        let second = ((x - 0.25) / 0.1).clamp(0.0, 1.0);
        for side in 0..12 {
            let (sin, cos) = (std::f32::consts::TAU * side as f32 / 12.0).sin_cos();
            mesh.positions.push(Vec3::new(x, 0.04 * cos, 0.04 * sin));
            mesh.normals.push(Vec3::new(0.0, cos, sin));
            let (joints, weights) = if second > 0.5 {
                ([1, 0, 0, 0], [second, 1.0 - second, 0.0, 0.0])
            } else {
                ([0, 1, 0, 0], [1.0 - second, second, 0.0, 0.0])
            };
            mesh.joints.push(joints);
            mesh.weights.push(weights);
        }
    }
    let bind =
        |x: f32| RigidTransform { rotation: Quat::IDENTITY, translation: Vec3::new(-x, 0.0, 0.0) };
    mesh.bind = vec![bind(0.0), bind(0.3)];
    mesh
}

#[test]
fn twisted_forearm_collapses_by_linear_blend_and_keeps_its_girth_by_dual_quaternions() {
    let mesh = tube();
    // Just below half a turn, where both directions are nearly equally short.
    let twist = Quat::from_rotation_x(std::f32::consts::PI - 1e-3);
    let pose = WorldPose {
        positions: vec![Vec3::ZERO, Vec3::new(0.3, 0.0, 0.0)],
        rotations: vec![Quat::IDENTITY, twist],
    };
    let (mut transforms, mut positions, mut normals) = (vec![], vec![], vec![]);
    mesh.joint_transforms(&pose, &mut transforms);
    let mut thinnest =
        |way: fn(&SkinnedMesh, &[RigidTransform], &mut Vec<Vec3>, &mut Vec<Vec3>)| {
            way(&mesh, &transforms, &mut positions, &mut normals);
            let radius = |p: &Vec3| p.y.hypot(p.z);
            let [low, high] =
                [f32::min, f32::max].map(|of| positions.iter().map(radius).reduce(of).unwrap());
            assert!(normals.iter().all(|normal| normal.is_normalized()));
            [low, high]
        };
    let [low, high] = thinnest(linear_blend);
    assert!(low < 1e-4 && (high - 0.04).abs() < 1e-6, "linear blend: {low} to {high} m");
    let [low, high] = thinnest(dual_quaternion);
    assert!(
        (low - 0.04).abs() < 1e-6 && (high - 0.04).abs() < 1e-6,
        "dual quaternions: {low} to {high} m"
    );
    // The other sign of a rotation is the same rotation.
    let mut other = transforms.clone();
    other[1].rotation = -other[1].rotation;
    let (mut same, mut normals) = (vec![], vec![]);
    dual_quaternion(&mesh, &other, &mut same, &mut normals);
    dual_quaternion(&mesh, &transforms, &mut positions, &mut normals);
    assert!(same.iter().zip(&positions).all(|(a, b)| a.distance(*b) < 1e-6));
}

#[test]
fn mannequin_wrist_collapses_by_linear_blend_alone() {
    let skeleton = humanoid(1.75).unwrap();
    let roles = Roles::detect(&skeleton);
    let mesh = SkinnedMesh::around(&skeleton, &roles, 1.0);
    let rest = WorldPose {
        positions: skeleton.rest_positions(),
        rotations: vec![Quat::IDENTITY; skeleton.len()],
    };
    let (elbow, wrist) =
        (roles.get(Role::LeftForearm).unwrap(), roles.get(Role::LeftHand).unwrap());
    let mut twisted = rest.clone();
    twisted.rotations[wrist] = Quat::from_rotation_x(3.1);
    // The section of the arm that hand and forearm share: its mean distance from the axis of the
    // arm, at rest and twisted.
    let shared: Vec<usize> = (0..mesh.positions.len())
        .filter(|&vertex| {
            let weight = |joint: usize| {
                (0..4)
                    .filter(|&i| usize::from(mesh.joints[vertex][i]) == joint)
                    .map(|i| mesh.weights[vertex][i])
                    .sum::<f32>()
            };
            (0.42..0.58).contains(&weight(wrist)) && weight(wrist) + weight(elbow) > 0.98
        })
        .collect();
    assert!(shared.len() >= 6, "{} vertices", shared.len());
    let (mut transforms, mut positions, mut normals) = (vec![], vec![], vec![]);
    let mut girth =
        |pose: &WorldPose,
         way: fn(&SkinnedMesh, &[RigidTransform], &mut Vec<Vec3>, &mut Vec<Vec3>)| {
            mesh.joint_transforms(pose, &mut transforms);
            way(&mesh, &transforms, &mut positions, &mut normals);
            let axis = rest.positions[wrist];
            shared
                .iter()
                .map(|&vertex| (positions[vertex].y - axis.y).hypot(positions[vertex].z - axis.z))
                .sum::<f32>()
                / shared.len() as f32
        };
    let before = girth(&rest, linear_blend);
    let (linear, dual) = (girth(&twisted, linear_blend), girth(&twisted, dual_quaternion));
    assert!(linear < 0.15 * before, "linear blend: {linear} of {before} m");
    assert!((dual - before).abs() < 0.05 * before, "dual quaternions: {dual} of {before} m");
}

/// Checks the properties of every mesh.
fn check(name: &str, skeleton: &Skeleton, mesh: &SkinnedMesh) {
    let count = mesh.positions.len();
    assert!(count > 0, "{name}");
    assert!(
        [mesh.normals.len(), mesh.joints.len(), mesh.weights.len()].iter().all(|&len| len == count),
        "{name}"
    );
    assert_eq!(mesh.bind.len(), skeleton.len(), "{name}");
    assert!(
        mesh.positions.iter().all(|p| p.is_finite())
            && mesh.normals.iter().all(|n| n.is_normalized()),
        "{name}"
    );
    for (joints, weights) in mesh.joints.iter().zip(&mesh.weights) {
        assert!(
            joints.iter().all(|&joint| usize::from(joint) < skeleton.len()),
            "{name}: {joints:?}"
        );
        assert!(
            (weights.iter().sum::<f32>() - 1.0).abs() < 1e-5
                && weights.is_sorted_by(|a, b| a >= b)
                && weights[3] >= 0.0,
            "{name}: {weights:?}"
        );
    }
    // The surface is closed: every edge occurs equally often in both directions.
    let mut edges: HashMap<(u32, u32), i32> = HashMap::new();
    for &[a, b, c] in &mesh.triangles {
        assert!(a.max(b).max(c) < count as u32 && a != b && b != c && c != a, "{name}");
        for (from, to) in [(a, b), (b, c), (c, a)] {
            *edges.entry((from.min(to), from.max(to))).or_default() +=
                if from < to { 1 } else { -1 };
        }
    }
    assert!(
        edges.values().all(|&sum| sum == 0),
        "{name}: {} open edges",
        edges.values().filter(|sum| **sum != 0).count()
    );
    let volume: f64 = (mesh.triangles.iter())
        .map(|triangle| {
            let [a, b, c] = triangle.map(|corner| mesh.positions[corner as usize].as_dvec3());
            a.dot(b.cross(c)) / 6.0
        })
        .sum();
    assert!(volume > 0.0, "{name}: {volume} m³, so the triangles face inwards");
}

#[test]
fn body_of_every_rig_is_closed() {
    for (name, skeleton, _) in fixtures::all() {
        let mesh = SkinnedMesh::around(&skeleton, &Roles::detect(&skeleton), 1.0);
        check(name, &skeleton, &mesh);
        assert!(
            (4_000..30_000).contains(&mesh.positions.len()),
            "{name}: {} vertices",
            mesh.positions.len()
        );
    }
    // Without roles, the same bones get a plainer body.
    let skeleton = fixtures::lafan();
    check("no roles", &skeleton, &SkinnedMesh::around(&skeleton, &Roles::default(), 1.0));
}

#[test]
fn rigid_motion_of_all_joints_moves_the_mesh_rigidly() {
    let skeleton = fixtures::cmu_bvh();
    let mesh = SkinnedMesh::around(&skeleton, &Roles::detect(&skeleton), 1.0);
    let motion = RigidTransform {
        rotation: quat::exp(Vec3::new(0.7, -1.1, 0.4)),
        translation: Vec3::new(3.0, 1.0, -2.0),
    };
    let moved: Vec<RigidTransform> = mesh.bind.iter().map(|bind| motion * bind.inverse()).collect();
    let pose = WorldPose {
        positions: moved.iter().map(|joint| joint.translation).collect(),
        rotations: moved.iter().map(|joint| joint.rotation).collect(),
    };
    let (mut transforms, mut positions, mut normals) = (vec![], vec![], vec![]);
    mesh.joint_transforms(&pose, &mut transforms);
    for way in [linear_blend, dual_quaternion] {
        way(&mesh, &transforms, &mut positions, &mut normals);
        for (vertex, position) in positions.iter().enumerate() {
            assert!(position.distance(motion.point(mesh.positions[vertex])) < 5e-6);
            assert!(normals[vertex].distance(motion.rotation * mesh.normals[vertex]) < 5e-6);
        }
    }
}

#[test]
fn girth_above_one_thickens_the_body() {
    let skeleton = humanoid(1.75).unwrap();
    let roles = Roles::detect(&skeleton);
    let around = |girth| SkinnedMesh::around(&skeleton, &roles, girth);
    let (plain, stout) = (around(1.0), around(1.4));
    let width = |mesh: &SkinnedMesh| {
        let waist = mesh.positions.iter().filter(|p| (0.05..0.2).contains(&p.y) && p.x.abs() < 0.4);
        waist.map(|p| p.x).fold(0.0, f32::max)
    };
    assert!(width(&stout) > 1.25 * width(&plain), "{} {}", width(&stout), width(&plain));
    for crazy in [f32::NAN, f32::INFINITY, -1.0] {
        check("crazy girth", &skeleton, &around(crazy));
    }
}

#[test]
fn body_of_a_symmetric_skeleton_is_symmetric() {
    let skeleton = humanoid(1.75).unwrap();
    let mesh = SkinnedMesh::around(&skeleton, &Roles::detect(&skeleton), 1.0);
    let [left, right] = [1.0, -1.0].map(|sign| {
        let side = mesh.positions.iter().filter(move |p| p.x * sign > 0.0);
        let (low, high) = side.fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), &p| {
            let p = Vec3::new(p.x * sign, p.y, p.z);
            (low.min(p), high.max(p))
        });
        [low, high]
    });
    for (left, right) in left.into_iter().zip(right) {
        assert!(left.distance(right) < 0.004, "{left} {right}");
    }
}

fn chain(joints: usize, offset: Vec3) -> Skeleton {
    let joint = |index: usize| Joint {
        name: format!("j{index}"),
        parent: index.checked_sub(1),
        offset: if index == 0 { Vec3::ZERO } else { offset },
        end_site: None,
        channels: vec![],
    };
    Skeleton::new((0..joints).map(joint).collect()).unwrap()
}

#[test]
fn body_of_an_unusual_skeleton_is_bounded_in_size() {
    for (name, skeleton) in [
        ("a point", chain(1, Vec3::ZERO)),
        ("all at one place", chain(30, Vec3::ZERO)),
        ("a stick", chain(2, Vec3::Y)),
        ("very long", chain(4, Vec3::new(100.0, 0.0, 0.0))),
        ("very short", chain(4, Vec3::new(1e-4, 0.0, 0.0))),
        ("thousands", chain(5000, Vec3::new(0.01, 0.02, 0.0))),
    ] {
        let mesh = SkinnedMesh::around(&skeleton, &Roles::detect(&skeleton), 1.0);
        check(name, &skeleton, &mesh);
        assert!(mesh.positions.len() < 200_000, "{name}: {} vertices", mesh.positions.len());
    }
}

#[test]
fn character_of_another_rig_stands_where_the_clip_stands() {
    let walk = synthesize(&Params::new(Action::Walk)).unwrap().clip;
    let roles = Roles::detect(walk.skeleton());
    for (name, skeleton, _) in
        fixtures::all().into_iter().filter(|(name, ..)| ["mixamo", "lafan", "smpl"].contains(name))
    {
        let own = Roles::detect(&skeleton);
        let mesh = Arc::new(SkinnedMesh::around(&skeleton, &own, 1.0));
        let character = Character { skeleton, roles: own, mesh };
        let drive = Drive::new(&walk, &roles, &character).unwrap();
        let (mut pose, mut transforms, mut positions, mut normals) =
            (WorldPose::default(), vec![], vec![], vec![]);
        let mut lowest = f32::INFINITY;
        for frame in (0..walk.frames()).step_by(20) {
            drive.pose(&walk.world_pose(frame), &mut pose);
            character.mesh.joint_transforms(&pose, &mut transforms);
            linear_blend(&character.mesh, &transforms, &mut positions, &mut normals);
            lowest = positions.iter().map(|p| p.y).fold(lowest, f32::min);
            // Arms and legs have the directions of the clip's.
            for role in [Role::LeftShin, Role::RightForearm] {
                let direction = |skeleton: &Skeleton, roles: &Roles, world: &WorldPose| {
                    let (start, end) = if role == Role::LeftShin {
                        (role, Role::foot(Side::Left))
                    } else {
                        (role, Role::hand(Side::Right))
                    };
                    let at =
                        |role| world.positions[roles.get_within(role, skeleton.len()).unwrap()];
                    (at(end) - at(start)).normalize_or_zero()
                };
                let theirs = direction(walk.skeleton(), &roles, &walk.world_pose(frame));
                let ours = direction(&character.skeleton, &character.roles, &pose);
                assert!(theirs.dot(ours) > 0.97, "{name}: {theirs} {ours}");
            }
        }
        assert!(lowest.abs() < 0.03, "{name}: the soles are at {lowest} m");
    }
    // On its own skeleton nothing is changed.
    let skeleton = Arc::clone(walk.skeleton());
    let mesh = Arc::new(SkinnedMesh::around(&skeleton, &roles, 1.0));
    let own = Character { skeleton, roles: roles.clone(), mesh };
    let mut pose = WorldPose::default();
    Drive::new(&walk, &roles, &own).unwrap().pose(&walk.world_pose(3), &mut pose);
    assert_eq!(pose, walk.world_pose(3));
    // Skeletons without anything in common.
    let rope = Arc::new(chain(3, Vec3::Y));
    let mesh = Arc::new(SkinnedMesh::around(&rope, &Roles::default(), 1.0));
    let rope = Character { skeleton: rope, roles: Roles::default(), mesh };
    assert!(Drive::new(&walk, &roles, &rope).is_none());
}

/// Returns a skeleton of any shape; its bones are up to 10^`scale` metres long.
fn random_tree(seed: u64, joints: usize, scale: f32) -> Skeleton {
    let mut next = fixtures::noise(seed);
    let list = (0..joints)
        .map(|index| Joint {
            name: format!("j{index}"),
            parent: index
                .checked_sub(1)
                .map(|last| (next().abs() * (last + 1) as f32) as usize % (last + 1)),
            offset: Vec3::new(next(), next(), next()) * 10f32.powf(scale) * next().abs(),
            end_site: None,
            channels: vec![],
        })
        .collect();
    Skeleton::new(list).unwrap()
}

#[test]
fn body_whose_triangles_fold_is_closed() {
    let skeleton = random_tree(13_108_890_028_104_798_581, 3, 0.0);
    check("folded", &skeleton, &SkinnedMesh::around(&skeleton, &Roles::default(), 1.0));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]
    #[test]
    fn body_of_a_random_tree_is_valid(
        seed in any::<u64>(),
        joints in 2usize..16,
        scale in -2.0f32..2.0,
    ) {
        let skeleton = random_tree(seed, joints, scale);
        let mesh = SkinnedMesh::around(&skeleton, &Roles::detect(&skeleton), 1.0);
        check("random", &skeleton, &mesh);
        prop_assert!(mesh.positions.len() < 60_000, "{}", mesh.positions.len());
        let world = world_pose(
            &skeleton,
            &Pose { rotations: vec![quat::exp(Vec3::ONE); joints], ..Pose::default() },
        );
        let (mut transforms, mut positions, mut normals) = (vec![], vec![], vec![]);
        mesh.joint_transforms(&world, &mut transforms);
        dual_quaternion(&mesh, &transforms, &mut positions, &mut normals);
        prop_assert!(positions.iter().all(|p| p.is_finite()));
    }
}

/// Returns the vertices of a mesh in a pose.
fn posed(mesh: &SkinnedMesh, pose: &WorldPose) -> Vec<Vec3> {
    let (mut transforms, mut positions, mut normals) = (vec![], vec![], vec![]);
    mesh.joint_transforms(pose, &mut transforms);
    linear_blend(mesh, &transforms, &mut positions, &mut normals);
    positions
}

#[test]
fn body_does_not_depend_on_joint_axes() {
    for (name, skeleton) in [("mixamo", fixtures::mixamo()), ("games105", fixtures::games105())] {
        let roles = fixtures::roles(&skeleton);
        let step = fixtures::step(&skeleton, &roles);
        let (turned, turns) = fixtures::turned(&skeleton, 5);
        let clip = |skeleton: &Arc<Skeleton>, pose: Pose| {
            Clip::from_poses("step", Arc::clone(skeleton), 30.0, [pose]).unwrap()
        };
        let other = clip(&turned, fixtures::turned_pose(&skeleton, &turns, &step));
        let plain = clip(&skeleton, step);
        let [expected, found] = [&plain, &other].map(|clip| {
            let mesh = SkinnedMesh::around_clip(clip, &roles, 1.0);
            check(name, clip.skeleton(), &mesh);
            posed(&mesh, &clip.world_pose(0))
        });
        // Evenly chosen points of one body are near the other.
        let nearest = |point: &Vec3| {
            expected.iter().map(|other| other.distance(*point)).fold(f32::INFINITY, f32::min)
        };
        let mut apart: Vec<f32> = found.iter().step_by(23).map(nearest).collect();
        apart.sort_by(f32::total_cmp);
        let (middle, last) = (apart[apart.len() / 2], apart[apart.len() * 99 / 100]);
        assert!(middle < 0.012 && last < 0.05, "{name}: {middle} and {last} m apart");
    }
}
