//! Tests of VRM files and VRM animations, built here: names and axes of their nodes say nothing.

use super::*;
use glam::DQuat;
use segue_motion::skeleton::{Role, RoleSource, Roles};
use segue_motion::skin::SkinnedMesh;

/// Bones in a T-pose that faces +Z: name, parent and offset, metres.
const BONES: [(&str, Option<usize>, [f32; 3]); 22] = [
    ("hips", None, [0.0, 0.9, 0.0]),
    ("spine", Some(0), [0.0, 0.1, 0.0]),
    ("chest", Some(1), [0.0, 0.12, 0.0]),
    ("neck", Some(2), [0.0, 0.25, 0.0]),
    ("head", Some(3), [0.0, 0.08, 0.0]),
    ("leftShoulder", Some(2), [0.03, 0.2, 0.0]),
    ("leftUpperArm", Some(5), [0.12, 0.0, 0.0]),
    ("leftLowerArm", Some(6), [0.25, 0.0, 0.0]),
    ("leftHand", Some(7), [0.22, 0.0, 0.0]),
    ("leftIndexProximal", Some(8), [0.08, 0.0, 0.0]),
    ("rightShoulder", Some(2), [-0.03, 0.2, 0.0]),
    ("rightUpperArm", Some(10), [-0.12, 0.0, 0.0]),
    ("rightLowerArm", Some(11), [-0.25, 0.0, 0.0]),
    ("rightHand", Some(12), [-0.22, 0.0, 0.0]),
    ("leftUpperLeg", Some(0), [0.09, -0.05, 0.0]),
    ("leftLowerLeg", Some(14), [0.0, -0.4, 0.0]),
    ("leftFoot", Some(15), [0.0, -0.38, 0.0]),
    ("leftToes", Some(16), [0.0, -0.06, 0.12]),
    ("rightUpperLeg", Some(0), [-0.09, -0.05, 0.0]),
    ("rightLowerLeg", Some(18), [0.0, -0.4, 0.0]),
    ("rightFoot", Some(19), [0.0, -0.38, 0.0]),
    ("rightToes", Some(20), [0.0, -0.06, 0.12]),
];

/// The bones that have a role, by the index above.
const ROLES: [(Role, usize); 17] = [
    (Role::Hips, 0),
    (Role::Spine, 1),
    (Role::Head, 4),
    (Role::LeftUpperArm, 6),
    (Role::LeftForearm, 7),
    (Role::LeftHand, 8),
    (Role::RightUpperArm, 11),
    (Role::RightForearm, 12),
    (Role::RightHand, 13),
    (Role::LeftThigh, 14),
    (Role::LeftShin, 15),
    (Role::LeftFoot, 16),
    (Role::LeftToe, 17),
    (Role::RightThigh, 18),
    (Role::RightShin, 19),
    (Role::RightFoot, 20),
    (Role::RightToe, 21),
];

/// Returns the rotation of a bone's axes in the world of a body that faces +Z.
fn axes(bone: usize) -> DQuat {
    let angle = bone as f64;
    DQuat::from_rotation_y(0.7 * angle) * DQuat::from_rotation_x(0.4 * angle)
}

/// Returns a file of the bones, which all have names without a meaning, below a node `n22` at the
/// origin; with `faces_back` the body faces -Z.
fn body(faces_back: bool) -> GltfBuilder {
    let mut nodes: Vec<Value> = BONES
        .iter()
        .enumerate()
        .map(|(bone, (_, parent, offset))| {
            let above = parent.map_or(DQuat::IDENTITY, axes);
            let place = above.inverse() * Vec3::from_array(*offset).as_dvec3();
            let children: Vec<usize> =
                (0..BONES.len()).filter(|&child| BONES[child].1 == Some(bone)).collect();
            json!({
                "name": format!("n{bone}"), "translation": place.to_array(),
                "rotation": (above.inverse() * axes(bone)).to_array(), "children": children
            })
        })
        .collect();
    let half_turn = if faces_back { [0, 1, 0, 0] } else { [0, 0, 0, 1] };
    nodes.push(json!({ "name": "n22", "children": [0], "rotation": half_turn }));
    GltfBuilder::new(&json!(nodes), &[])
}

fn one() -> Value {
    let bones: serde_json::Map<String, Value> = BONES
        .iter()
        .enumerate()
        .map(|(node, (name, ..))| ((*name).to_owned(), json!({ "node": node })))
        .collect();
    json!({ "humanBones": bones })
}

fn zero() -> Value {
    let bone = |(node, (name, ..)): (usize, &(&str, _, _))| json!({ "bone": name, "node": node });
    let mut bones: Vec<Value> = BONES.iter().enumerate().map(bone).collect();
    // Of two nodes for one bone the first counts; -1 is none.
    bones.push(json!({ "bone": "head", "node": 3 }));
    bones.push(json!({ "bone": "jaw", "node": -1, "useDefaultValues": true }));
    json!({ "humanBones": bones })
}

/// Adds a mesh of one triangle that follows some of the nodes.
fn add_mesh(builder: &mut GltfBuilder, joints: &[usize], corner: Vec3) -> usize {
    let corners = [corner, corner + Vec3::X * 0.1, corner + Vec3::Z * 0.1];
    let positions = builder.floats("VEC3", 3, &corners.map(|p| p.to_array()).concat());
    let view = builder.view(&[0; 12]);
    let owners = builder
        .accessor(json!({ "bufferView": view, "componentType": 5121, "count": 3, "type": "VEC4" }));
    let weights = builder.floats("VEC4", 4, &[1.0, 0.0, 0.0, 0.0].repeat(3));
    // The inverse of each joint's transform in the world at rest.
    let world = |node: usize| {
        let chain: Vec<usize> = std::iter::successors(Some(node), |&node| BONES[node].1).collect();
        let position: Vec3 = chain.iter().map(|&node| Vec3::from_array(BONES[node].2)).sum();
        let back = builder.root["nodes"][22]["rotation"][1] == json!(1);
        let turn = if back { DQuat::from_xyzw(0.0, 1.0, 0.0, 0.0) } else { DQuat::IDENTITY };
        glam::DMat4::from_rotation_translation(turn * axes(node), turn * position.as_dvec3())
    };
    let matrices: Vec<f32> =
        joints.iter().flat_map(|&node| world(node).inverse().as_mat4().to_cols_array()).collect();
    let matrices = builder.floats("MAT4", 16, &matrices);
    builder.list("skins").push(json!({ "joints": joints, "inverseBindMatrices": matrices }));
    let attributes = json!({ "POSITION": positions, "JOINTS_0": owners, "WEIGHTS_0": weights });
    builder.list("meshes").push(json!({ "primitives": [{ "attributes": attributes }] }));
    let (mesh, skin) = (builder.list("meshes").len() - 1, builder.list("skins").len() - 1);
    builder.list("nodes").push(json!({ "name": "skin", "mesh": mesh, "skin": skin }));
    builder.list("nodes").len() - 1
}

/// Checks that every role is that of the bone map, and returns the clip.
fn checked(imported: &ImportedFile) -> &Clip {
    let clip = only(imported);
    let roles = imported.clips[0].roles.as_ref().unwrap();
    for (role, bone) in ROLES {
        let name = &clip.skeleton().joints()[roles.get(role).unwrap()].name;
        assert_eq!((name, roles.source(role)), (&format!("n{bone}"), Some(RoleSource::ByFile)));
    }
    clip
}

fn mesh_of(imported: &ImportedFile) -> &SkinnedMesh {
    let mesh = imported.clips[0].mesh.as_ref().unwrap();
    skin::check(mesh, imported.clips[0].clip.skeleton().len());
    mesh
}

#[test]
fn bone_map_of_vrm_gives_the_roles_whatever_names_say() {
    let mut builder = body(false);
    builder.root["extensions"] = json!({ "VRMC_vrm": { "specVersion": "1.0", "humanoid": one() } });
    // The toes have no weights, and the body is two skins.
    add_mesh(&mut builder, &[0, 1, 2, 3, 4], Vec3::Y);
    add_mesh(&mut builder, &[14, 15, 16, 18, 19, 20], Vec3::Y * 0.5);
    let imported = builder.read();
    let clip = checked(&imported);
    assert_eq!(clip.skeleton().joints()[0].name, "n0", "the node above the hips is folded");
    assert_eq!(clip.skeleton().len(), 22);
    assert_eq!(sentences(&imported), ["the file has a skeleton but no animation"]);
    let at = |bone: usize| {
        let joint = clip.skeleton().find(&format!("n{bone}")).unwrap();
        clip.world_positions(0..1)[joint]
    };
    assert!(at(17).distance(Vec3::new(0.09, 0.01, 0.12)) < 1e-6, "{}", at(17));
    assert!(at(9).distance(Vec3::new(0.7, 1.32, 0.0)) < 1e-6, "{}", at(9));
    assert_eq!(mesh_of(&imported).triangles.len(), 2);
    // A file without the map knows less.
    builder.root.as_object_mut().unwrap().remove("extensions");
    assert!(builder.read().clips.iter().all(|clip| clip.roles.is_none()));
}

#[test]
fn body_of_vrm_0_is_turned_to_face_forwards() {
    let with = |builder: &mut GltfBuilder, extensions: Value, corner: Vec3| {
        builder.root["extensions"] = extensions;
        let all: Vec<usize> = (0..22).collect();
        add_mesh(builder, &all, corner);
        builder.channel(
            14,
            "rotation",
            "LINEAR",
            &[0.0, 1.0],
            &[[0.0, 0.0, 0.0, 1.0], [0.6, 0.0, 0.0, 0.8]].concat(),
        );
        builder.channel(
            22,
            "translation",
            "LINEAR",
            &[0.0, 1.0],
            &[0.0, 0.0, 0.0, if corner.z < 0.0 { -0.4 } else { 0.4 }, 0.1, 0.0],
        );
        builder.read()
    };
    let corner = Vec3::new(0.05, 0.9, 0.02);
    let one = with(&mut body(false), json!({ "VRMC_vrm": { "humanoid": one() } }), corner);
    let back = Vec3::new(-0.05, 0.9, -0.02);
    let zero = with(&mut body(true), json!({ "VRM": { "humanoid": zero() } }), back);
    let (forwards, turned) = (checked(&one), checked(&zero));
    assert_eq!(forwards.frames(), turned.frames());
    let frames = 0..forwards.frames();
    let (there, here) =
        (forwards.world_positions(frames.clone()), turned.world_positions(frames.clone()));
    assert!(there.iter().zip(&here).all(|(p, q)| p.distance(*q) < 1e-5));
    for frame in frames {
        for (p, q) in forwards.rotations(frame).iter().zip(turned.rotations(frame)) {
            assert!(quat::angle_between(*p, *q) < 1e-3);
        }
    }
    // The triangle's corners are written along the axes of the file.
    let (one, zero) = (mesh_of(&one), mesh_of(&zero));
    assert!(one.positions[0].distance(corner) < 1e-6);
    assert!(zero.positions[0].distance(corner) < 1e-6);
    assert!(zero.positions[1].distance(corner - Vec3::X * 0.1) < 1e-6);
    assert!(zero.normals[0].distance(one.normals[0]) < 1e-5);
}

#[test]
fn animation_of_vrm_is_a_motion_without_its_face() {
    let mut builder = body(false);
    let happy = builder.list("nodes").len();
    builder.list("nodes").push(json!({ "name": "happy" }));
    builder.list("nodes").push(json!({ "name": "eyes" }));
    builder.list("nodes").push(json!({ "name": "camera of the scene" }));
    builder.root["extensions"] = json!({ "VRMC_vrm_animation": {
        "specVersion": "1.0", "humanoid": one(),
        "expressions": { "preset": { "happy": { "node": happy } } },
        "lookAt": { "node": happy + 1 }
    } });
    let times = [0.0, 0.5, 1.0];
    builder.channel(happy, "translation", "LINEAR", &times, &[0.0; 9]);
    builder.channel(happy + 1, "rotation", "LINEAR", &times, &[about_z(0.3); 3].concat());
    builder.channel(happy + 2, "translation", "LINEAR", &times, &[1.0; 9]);
    builder.channel(
        0,
        "translation",
        "STEP",
        &times,
        &[0.0, 0.9, 0.0, 0.0, 0.8, 0.1, 0.2, 0.9, 0.0],
    );
    let bent = DQuat::from_rotation_x(0.8);
    let local = (axes(14).inverse() * bent * axes(15)).as_quat().to_array();
    builder.channel(15, "rotation", "LINEAR", &[0.0], &local);
    let imported = builder.read();
    let clip = checked(&imported);
    assert_eq!((clip.frames(), clip.skeleton().len()), (31, 22));
    assert_eq!(clip.root_translations()[20], Vec3::new(0.0, 0.8, 0.1));
    // The knee is bent about the world's X, whatever the axes of its node.
    let knee = clip.skeleton().find("n15").unwrap();
    assert!(quat::angle_between(clip.rotations(3)[knee], bent.as_quat()) < 1e-3);
    assert_eq!(
        sentences(&imported),
        ["imported without 2 animations of expressions or of the eyes"]
    );
    // With the face alone there is still a body, at rest.
    builder.root["animations"][0]["channels"].as_array_mut().unwrap().truncate(2);
    let still = builder.read();
    assert_eq!(checked(&still).frames(), 1);
}

#[test]
fn meshes_for_the_first_person_alone_are_left_out() {
    let read = |extensions: &dyn Fn(usize) -> Value| {
        let mut builder = body(false);
        add_mesh(&mut builder, &[0, 1], Vec3::Y);
        let node = add_mesh(&mut builder, &[0, 1], Vec3::ZERO);
        builder.root["extensions"] = extensions(node);
        builder.read()
    };
    let first = |node: usize| json!([{ "node": node, "type": "firstPersonOnly" }, { "node": 0 }]);
    let imported = read(
        &|node| json!({ "VRMC_vrm": { "humanoid": one(), "firstPerson": { "meshAnnotations": first(node) } } }),
    );
    assert_eq!(mesh_of(&imported).positions[0], Vec3::Y);
    assert_eq!(mesh_of(&imported).triangles.len(), 1);
    let first = json!([{ "mesh": 1, "firstPersonFlag": "FirstPersonOnly" }, { "mesh": -1 }]);
    let imported = read(
        &|_| json!({ "VRM": { "humanoid": zero(), "firstPerson": { "meshAnnotations": first } } }),
    );
    assert_eq!(mesh_of(&imported).triangles.len(), 1);
    let all = read(&|_| json!({ "VRMC_vrm": { "humanoid": one(), "firstPerson": {} } }));
    assert_eq!(mesh_of(&all).triangles.len(), 2);
}

#[test]
fn bone_map_that_is_not_as_specified_gives_a_warning() {
    let mut builder = body(false);
    add_mesh(&mut builder, &[0, 1, 2], Vec3::Y);
    builder.root["extensions"] = json!({ "VRMC_vrm": { "humanoid": { "humanBones": [1, 2] } } });
    let imported = builder.read();
    assert!(imported.clips[0].roles.is_none());
    let told = sentences(&imported);
    assert!(
        told[0].starts_with("the bone map of the file cannot be read (invalid type"),
        "{told:?}"
    );
    // Nodes that are not there have no role; the others keep theirs.
    let mut bones = one();
    bones["humanBones"]["head"]["node"] = json!(4_000_000_000_u32);
    bones["humanBones"]["spine"] = json!({});
    builder.root["extensions"] = json!({ "VRMC_vrm": { "humanoid": bones } });
    let imported = builder.read();
    let roles: &Roles = imported.clips[0].roles.as_ref().unwrap();
    assert_eq!(roles.source(Role::Hips), Some(RoleSource::ByFile));
    assert_ne!(roles.source(Role::Head), Some(RoleSource::ByFile));
}
