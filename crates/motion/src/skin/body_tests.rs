//! Tests of the bodies of many rigs: closed, of human volume, symmetric, and whole when they bend.

use super::*;
use crate::math::quat;
use crate::skeleton::{Joint, Role, Side, fixtures};
use std::collections::HashMap;
use std::sync::{Arc, LazyLock};

/// Builds a skeleton from names, names of parents and positions; `*` stands for either side.
fn built(rows: &[(&str, &str, [f32; 3])]) -> Arc<Skeleton> {
    let (mut joints, mut places): (Vec<Joint>, Vec<Vec3>) = (Vec::new(), Vec::new());
    for &(name, parent, at) in rows {
        let both = if name.contains('*') { 2 } else { 1 };
        for (side, mirror) in [("Left", 1.0), ("Right", -1.0)].into_iter().take(both) {
            let parent = parent.replace('*', side);
            let above = joints.iter().position(|joint| joint.name == parent);
            let place = Vec3::from(at) * Vec3::new(mirror, 1.0, 1.0);
            let offset = above.map_or(place, |above| place - places[above]);
            let name = name.replace('*', side);
            joints.push(Joint { name, parent: above, offset, end_site: None, channels: vec![] });
            places.push(place);
        }
    }
    Arc::new(Skeleton::new(joints).unwrap())
}

/// Returns a dog with the names of a person, as captures of dogs have them.
fn dog() -> Arc<Skeleton> {
    built(&[
        ("Hips", "", [0.0, 0.62, -0.35]),
        ("Spine", "Hips", [0.0, 0.64, -0.1]),
        ("Spine1", "Spine", [0.0, 0.66, 0.15]),
        ("Neck", "Spine1", [0.0, 0.72, 0.36]),
        ("Head", "Neck", [0.0, 0.88, 0.52]),
        ("Snout", "Head", [0.0, 0.84, 0.74]),
        ("*Shoulder", "Spine1", [0.05, 0.68, 0.28]),
        ("*Arm", "*Shoulder", [0.08, 0.52, 0.36]),
        ("*ForeArm", "*Arm", [0.09, 0.36, 0.24]),
        ("*Hand", "*ForeArm", [0.09, 0.08, 0.28]),
        ("*UpLeg", "Hips", [0.08, 0.58, -0.36]),
        ("*Leg", "*UpLeg", [0.09, 0.34, -0.24]),
        ("*Foot", "*Leg", [0.09, 0.13, -0.44]),
        ("Tail", "Hips", [0.0, 0.64, -0.45]),
        ("Tail1", "Tail", [0.0, 0.56, -0.68]),
    ])
}

/// Returns a person whose hip joints and shoulders are that far from the middle, metres, with twist
/// joints, helpers and controls.
fn person(half_hips: f32, half_shoulders: f32) -> Arc<Skeleton> {
    let arm = |along: f32| half_shoulders + along;
    built(&[
        ("root", "", [0.0, 0.0, 0.0]),
        ("Hips", "root", [0.0, 0.98, 0.0]),
        ("Spine", "Hips", [0.0, 1.08, -0.01]),
        ("Spine1", "Spine", [0.0, 1.25, -0.01]),
        ("Neck", "Spine1", [0.0, 1.5, -0.01]),
        ("Head", "Neck", [0.0, 1.58, 0.02]),
        ("*Shoulder", "Spine1", [0.03, 1.44, 0.0]),
        ("*Arm", "*Shoulder", [arm(0.0), 1.45, 0.0]),
        ("*ArmRoll", "*Arm", [arm(0.14), 1.45, -0.005]),
        ("*ForeArm", "*ArmRoll", [arm(0.28), 1.45, -0.01]),
        ("*Hand", "*ForeArm", [arm(0.54), 1.45, 0.0]),
        ("*UpLeg", "Hips", [half_hips, 0.92, 0.0]),
        ("*Leg", "*UpLeg", [half_hips, 0.5, 0.01]),
        ("*Foot", "*Leg", [half_hips, 0.09, -0.02]),
        ("*Toe", "*Foot", [half_hips, 0.02, 0.12]),
        ("*KneeHelper", "*UpLeg", [half_hips, 0.5, 0.12]),
        ("*ik_foot", "root", [half_hips, 0.09, -0.02]),
    ])
}

/// A rig of a person, with its roles and its body.
struct Body {
    name: &'static str,
    skeleton: Arc<Skeleton>,
    roles: Roles,
    mesh: SkinnedMesh,
}

impl Body {
    fn of(name: &'static str, skeleton: Arc<Skeleton>) -> Self {
        let roles = Roles::detect(&skeleton);
        let mesh = SkinnedMesh::around(&skeleton, &roles, 1.0);
        Self { name, skeleton, roles, mesh }
    }
}

/// Rigs whose bodies differ.
static BODIES: LazyLock<Vec<Body>> = LazyLock::new(|| {
    let rigs = [
        ("bandai", fixtures::bandai()),
        ("games105", fixtures::games105()),
        ("unreal", fixtures::unreal()),
    ];
    let persons = [
        ("narrow", person(0.06, 0.105)),
        ("average", person(0.095, 0.18)),
        ("wide hips", person(0.2, 0.18)),
    ];
    rigs.into_iter().chain(persons).map(|(name, rig)| Body::of(name, rig)).collect()
});

fn corners(mesh: &SkinnedMesh, triangle: [u32; 3]) -> [Vec3; 3] {
    triangle.map(|corner| mesh.positions[corner as usize])
}

/// Returns the volume of a closed mesh, m³.
fn volume(mesh: &SkinnedMesh) -> f32 {
    let parts = mesh.triangles.iter().map(|&triangle| {
        let [a, b, c] = corners(mesh, triangle);
        a.dot(b.cross(c)) / 6.0
    });
    parts.sum()
}

/// Returns the number of edges that do not belong to two triangles.
fn odd_edges(mesh: &SkinnedMesh) -> usize {
    let mut edges: HashMap<(u32, u32), usize> = HashMap::new();
    for &[a, b, c] in &mesh.triangles {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            *edges.entry((from.min(to), from.max(to))).or_default() += 1;
        }
    }
    edges.values().filter(|&&triangles| triangles != 2).count()
}

/// Returns the pose in which a mesh was generated.
fn bind_pose(mesh: &SkinnedMesh) -> WorldPose {
    let bind: Vec<RigidTransform> = mesh.bind.iter().map(|bind| bind.inverse()).collect();
    WorldPose {
        positions: bind.iter().map(|bind| bind.translation).collect(),
        rotations: bind.iter().map(|bind| bind.rotation).collect(),
    }
}

/// Rotates a joint and everything below it about its position.
fn turn(skeleton: &Skeleton, pose: &mut WorldPose, joint: usize, rotation: Quat) {
    let center = pose.positions[joint];
    for below in joint..skeleton.len() {
        if std::iter::successors(Some(below), |&j| skeleton.parent(j)).any(|j| j == joint) {
            pose.positions[below] = center + rotation * (pose.positions[below] - center);
            pose.rotations[below] = rotation * pose.rotations[below];
        }
    }
}

fn posed(mesh: &SkinnedMesh, pose: &WorldPose) -> SkinnedMesh {
    let (mut transforms, mut positions, mut normals) = (vec![], vec![], vec![]);
    mesh.joint_transforms(pose, &mut transforms);
    dual_quaternion(mesh, &transforms, &mut positions, &mut normals);
    SkinnedMesh { positions, normals, ..mesh.clone() }
}

/// Returns the area of the cut through a mesh by the plane at `center`, m²; only triangles within
/// `reach` are cut.
fn cut(mesh: &SkinnedMesh, center: Vec3, normal: Vec3, reach: f32) -> f32 {
    let mut area = 0.0;
    for &triangle in &mesh.triangles {
        let corners = corners(mesh, triangle).map(|corner| corner - center);
        if corners.iter().any(|corner| corner.length() > reach) {
            continue;
        }
        let heights = corners.map(|corner| corner.dot(normal));
        let mut ends = [Vec3::ZERO; 2];
        let mut count = 0;
        for (from, to) in [(0, 1), (1, 2), (2, 0)] {
            if (heights[from] < 0.0) != (heights[to] < 0.0) {
                let share = heights[from] / (heights[from] - heights[to]);
                ends[usize::from(heights[from] < 0.0)] = corners[from].lerp(corners[to], share);
                count += 1;
            }
        }
        if count == 2 {
            area += 0.5 * ends[0].cross(ends[1]).dot(normal);
        }
    }
    area.abs()
}

#[test]
fn edges_of_every_body_belong_to_two_triangles() {
    for Body { name, mesh, .. } in BODIES.iter().chain([&Body::of("dog", dog())]) {
        assert_eq!(odd_edges(mesh), 0, "{name}");
        for &triangle in &mesh.triangles {
            let [a, b, c] = corners(mesh, triangle);
            assert!((b - a).cross(c - a).length() > 1e-8, "{name}: a triangle without area");
        }
    }
}

#[test]
fn volume_of_a_person_is_that_of_an_adult() {
    for Body { name, skeleton, roles, mesh } in BODIES.iter() {
        let height = roles.body_height(skeleton) / 1.75;
        let litres = 1e3 * volume(mesh) / height.powi(3);
        assert!((45.0..85.0).contains(&litres), "{name}: {litres} l at 1.75 m");
    }
}

#[test]
fn body_of_a_symmetric_rig_is_symmetric() {
    for Body { name, mesh, .. } in BODIES.iter() {
        let nearest = |position: &Vec3| {
            let mirrored = *position * Vec3::new(-1.0, 1.0, 1.0);
            let all = mesh.positions.iter().map(|other| other.distance_squared(mirrored));
            all.fold(f32::INFINITY, f32::min).sqrt()
        };
        let mut apart: Vec<f32> = mesh.positions.iter().step_by(37).map(nearest).collect();
        apart.sort_by(f32::total_cmp);
        let (most, last) = (apart[apart.len() * 98 / 100], apart[apart.len() - 1]);
        // Less than the size of a cell; where thighs touch, less than two.
        assert!(most < 0.012 && last < 0.03, "{name}: {most} and {last} m");
    }
}

#[test]
fn cross_sections_of_bent_joints_keep_their_area() {
    for Body { name, skeleton, roles, mesh } in BODIES.iter() {
        let rest = bind_pose(mesh);
        for (above, joint, below, axis) in [
            (Role::LeftThigh, Role::LeftShin, Role::LeftFoot, Vec3::X),
            (Role::RightUpperArm, Role::RightForearm, Role::RightHand, Vec3::Y),
            (Role::LeftForearm, Role::LeftHand, Role::LeftHand, Vec3::Z),
        ] {
            let [above, joint, below] = [above, joint, below].map(|role| roles.get(role).unwrap());
            let at = |joint: usize| rest.positions[joint];
            let before = (at(joint) - at(above)).normalize_or(Vec3::Y);
            let after = (at(below) - at(joint)).normalize_or(before);
            let side = axis.reject_from(before).normalize_or(Vec3::X);
            let reach = 0.6 * at(joint).distance(at(above));
            let area = |degrees: f32| {
                let rotation = Quat::from_axis_angle(side, degrees.to_radians());
                let mut pose = rest.clone();
                turn(skeleton, &mut pose, joint, rotation);
                let across = (before + rotation * after).normalize_or(before);
                cut(&posed(mesh, &pose), at(joint), across, reach)
            };
            let straight = area(0.0);
            for degrees in [90.0, -90.0] {
                let share = area(degrees) / straight;
                assert!(share > 0.6, "{name}, joint {joint}: {share} of the area at {degrees}°");
            }
        }
    }
}

#[test]
fn body_in_a_squat_keeps_its_volume() {
    for Body { name, skeleton, roles, mesh } in BODIES.iter() {
        let mut pose = bind_pose(mesh);
        for side in Side::BOTH {
            let [thigh, shin] = [Role::thigh(side), Role::shin(side)].map(|role| roles.get(role));
            turn(skeleton, &mut pose, thigh.unwrap(), Quat::from_rotation_x(-1.8));
            turn(skeleton, &mut pose, shin.unwrap(), Quat::from_rotation_x(2.1));
        }
        let share = volume(&posed(mesh, &pose)) / volume(mesh);
        assert!((0.85..1.2).contains(&share), "{name}: {share} of the volume");
    }
}

#[test]
fn raised_arms_do_not_swell_beside_the_chest() {
    for Body { name, skeleton, roles, mesh } in BODIES.iter() {
        let mut pose = bind_pose(mesh);
        for (side, sign) in [(Side::Left, 1.0), (Side::Right, -1.0)] {
            let [arm, hand] = [Role::upper_arm(side), Role::hand(side)].map(|r| roles.get(r));
            let (arm, hand) = (arm.unwrap(), hand.unwrap());
            let along = (pose.positions[hand] - pose.positions[arm]).normalize_or(Vec3::X);
            let up = Vec3::new(0.1 * sign, 1.0, 0.0).normalize_or(Vec3::Y);
            turn(skeleton, &mut pose, arm, quat::between_directions(along, up));
        }
        let shoulder = pose.positions[roles.get(Role::LeftUpperArm).unwrap()];
        let raised = posed(mesh, &pose);
        let beside = raised.positions.iter().filter(|p| (-0.12..0.0).contains(&(p.y - shoulder.y)));
        let out = beside.map(|p| p.x.abs()).fold(0.0, f32::max) - shoulder.x;
        assert!(out < 0.1, "{name}: {out} m beside the shoulder");
    }
}

#[test]
fn controls_and_helpers_of_a_rig_have_no_limbs_of_their_own() {
    let skeleton = person(0.095, 0.18);
    let roles = Roles::detect(&skeleton);
    let shapes = shapes::limb_shapes(&skeleton, &skeleton.rest_positions(), Some(&roles));
    for name in ["LeftKneeHelper", "LeftArmRoll", "Leftik_foot", "Rightik_foot"] {
        let joint = skeleton.find(name).unwrap();
        assert!(shapes.iter().all(|shape| shape.b.joint != joint), "{name}");
    }
    // A tail is no helper.
    let mut rows = skeleton.joints().to_vec();
    let hips = skeleton.find("Hips");
    let tail = |parent, offset| Joint {
        name: "Tail".into(),
        parent,
        offset,
        end_site: None,
        channels: vec![],
    };
    rows.push(tail(hips, Vec3::Z * -0.2));
    rows.push(tail(Some(rows.len() - 1), Vec3::Z * -0.4));
    let last = rows.len() - 1;
    let skeleton = Skeleton::new(rows).unwrap();
    let shapes = shapes::limb_shapes(&skeleton, &skeleton.rest_positions(), Some(&roles));
    assert!(shapes.iter().any(|shape| shape.b.joint == last));
}

#[test]
fn body_of_an_animal_with_the_names_of_a_person_stands_on_four_legs() {
    let skeleton = dog();
    let roles = Roles::detect(&skeleton);
    assert!(roles.get(Role::LeftHand).is_some() && roles.get(Role::RightFoot).is_some());
    let mesh = SkinnedMesh::around(&skeleton, &roles, 1.0);
    // Its legs stay below it, and it is longer than high or wide.
    let pose = bind_pose(&mesh);
    for role in [Role::LeftHand, Role::RightHand, Role::LeftFoot, Role::RightFoot] {
        let paw = pose.positions[roles.get(role).unwrap()];
        assert!((paw.x.abs() - 0.09).abs() < 1e-3, "{role:?} at {paw}");
    }
    let low = mesh.positions.iter().copied().reduce(Vec3::min).unwrap();
    let high = mesh.positions.iter().copied().reduce(Vec3::max).unwrap();
    let size = high - low;
    assert!(size.z > 1.2 * size.y && size.x < 0.6 * size.y, "{size}");
    // A trunk that is thicker than the legs.
    let spine = skeleton.rest_positions()[skeleton.find("Spine").unwrap()];
    let around = mesh.positions.iter().filter(|p| (p.z - spine.z).abs() < 0.03);
    let depth = around.map(|p| (p.y - spine.y).abs()).fold(0.0, f32::max);
    assert!((0.06..0.16).contains(&depth), "{depth} m");
}
