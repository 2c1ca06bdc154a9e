//! Tests of meshes with a skin, built and damaged here.

use super::*;
use glam::{DMat4, DVec3};
use segue_motion::skeleton::Roles;
use segue_motion::skin::{SkinnedMesh, linear_blend};

/// Checks the invariants of a mesh that was read.
pub(super) fn check(mesh: &SkinnedMesh, joints: usize) {
    let count = mesh.positions.len();
    assert_eq!(
        (mesh.normals.len(), mesh.joints.len(), mesh.weights.len(), mesh.bind.len()),
        (count, count, count, joints)
    );
    assert!(mesh.colors.is_empty() || mesh.colors.len() == count);
    assert!(
        mesh.positions.iter().all(|p| p.is_finite())
            && mesh.normals.iter().all(|n| n.is_normalized())
    );
    assert!(mesh.triangles.iter().flatten().all(|&corner| (corner as usize) < count));
    for (joints_of, weights) in mesh.joints.iter().zip(&mesh.weights) {
        assert!(joints_of.iter().all(|&joint| usize::from(joint) < joints));
        assert!(
            (weights.iter().sum::<f32>() - 1.0).abs() < 1e-5
                && weights.is_sorted_by(|a, b| a >= b)
                && weights[3] >= 0.0
        );
    }
}

/// Returns a square of two triangles on two bones, `Hips` at 1 m and `Chest` 0.5 m above: its lower
/// edge follows the hips, its upper one both.
pub(super) fn square() -> GltfBuilder {
    let mut builder = GltfBuilder::new(&two_bones(), &[0, 1]);
    let positions =
        builder.floats("VEC3", 3, &[-0.1, 1.0, 0.0, 0.1, 1.0, 0.0, 0.1, 1.5, 0.0, -0.1, 1.5, 0.0]);
    let bytes: Vec<u8> = [[0, 9, 9, 9], [0, 9, 9, 9], [0, 1, 0, 0], [0, 1, 0, 0]].concat();
    let view = builder.view(&bytes);
    let joints = builder
        .accessor(json!({ "bufferView": view, "componentType": 5121, "count": 4, "type": "VEC4" }));
    let weights = builder.floats(
        "VEC4",
        4,
        &[
            [1.0, 0.0, 0.0, 0.0],
            [2.0, 0.0, 0.0, 0.0],
            [0.25, 0.75, 0.0, 0.0],
            [0.25, 0.75, 0.0, 0.0],
        ]
        .concat(),
    );
    let view = builder.view(&[0u16, 1, 2, 0, 2, 3].map(u16::to_le_bytes).concat());
    let indices = builder.accessor(
        json!({ "bufferView": view, "componentType": 5123, "count": 6, "type": "SCALAR" }),
    );
    // The bind pose at 1 and 1.5 m, that of the nodes at rest.
    let matrix = |y: f32| {
        DMat4::from_translation(DVec3::new(0.0, -f64::from(y), 0.0)).as_mat4().to_cols_array()
    };
    let matrices = builder.floats("MAT4", 16, &[matrix(1.0), matrix(1.5)].concat());
    builder.root["skins"][0]["inverseBindMatrices"] = json!(matrices);
    builder.root["meshes"] = json!([{ "primitives": [{
        "attributes": { "POSITION": positions, "JOINTS_0": joints, "WEIGHTS_0": weights }, "indices": indices, "material": 0 }] }]);
    builder.root["materials"] =
        json!([{ "pbrMetallicRoughness": { "baseColorFactor": [1.0, 0.0, 0.5, 1.0] } }]);
    builder.root["nodes"]
        .as_array_mut()
        .unwrap()
        .push(json!({ "name": "Skin", "mesh": 0, "skin": 0 }));
    builder
}

pub(super) fn mesh_of(imported: &ImportedFile) -> &SkinnedMesh {
    let found = &imported.clips[0];
    let mesh = found.mesh.as_ref().unwrap();
    check(mesh, found.clip.skeleton().len());
    mesh
}

#[test]
fn mesh_has_its_colour_and_computed_normals() {
    let imported = square().read();
    let mesh = mesh_of(&imported);
    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3]]);
    assert_eq!(mesh.positions[2], Vec3::new(0.1, 1.5, 0.0));
    assert!(mesh.normals.iter().all(|normal| normal.distance(Vec3::Z) < 1e-6));
    assert_eq!((mesh.joints[2], mesh.weights[2]), ([1, 0, 0, 0], [0.75, 0.25, 0.0, 0.0]));
    assert_eq!(mesh.weights[1], [1.0, 0.0, 0.0, 0.0]);
    assert!(
        (mesh.colors[0][2] - 0.735).abs() < 1e-3 && mesh.colors[0][0] == 1.0,
        "{:?}",
        mesh.colors[0]
    );
    assert_eq!(sentences(&imported), ["the file has a skeleton but no animation"]);
}

#[test]
fn mesh_deforms_as_specified() {
    let mut builder = square();
    // Mesh and bones in centimetres in another pose: the bind matrices scale by 2, rotate, and
    // stretch one axis.
    let bind = |y: f64| {
        DMat4::from_rotation_z(0.3)
            * DMat4::from_scale(DVec3::new(2.0, 1.5, 2.0))
            * DMat4::from_translation(DVec3::new(0.0, -y, 0.1))
    };
    let matrices = [bind(1.0), bind(1.5)];
    let values: Vec<f32> = matrices.iter().flat_map(|m| m.as_mat4().to_cols_array()).collect();
    builder.root["skins"][0]["inverseBindMatrices"] = json!(builder.floats("MAT4", 16, &values));
    builder.channel(1, "rotation", "LINEAR", &[0.0, 1.0], &[about_z(0.0), about_z(1.2)].concat());
    let imported = builder.read();
    let mesh = mesh_of(&imported);
    let clip = &imported.clips[0].clip;
    let (mut transforms, mut positions, mut normals) = (vec![], vec![], vec![]);
    for (frame, angle) in [(0, 0.0), (30, 1.2)] {
        mesh.joint_transforms(&clip.world_pose(frame), &mut transforms);
        linear_blend(mesh, &transforms, &mut positions, &mut normals);
        let hips = DMat4::from_translation(DVec3::Y);
        let chest = hips * DMat4::from_translation(DVec3::Y * 0.5) * DMat4::from_rotation_z(angle);
        let vertex = DVec3::new(0.1, 1.5, 0.0);
        let expected = (hips * matrices[0]).transform_point3(vertex) * 0.25
            + (chest * matrices[1]).transform_point3(vertex) * 0.75;
        // Bound again at rest, a vertex that two joints share moves slightly differently with them,
        // except at rest.
        let slack = if angle == 0.0 { 1e-6 } else { 0.2 };
        assert!(positions[2].distance(expected.as_vec3()) < slack, "{} {expected}", positions[2]);
        let lower = (hips * matrices[0]).transform_point3(DVec3::new(-0.1, 1.0, 0.0));
        assert!(positions[0].distance(lower.as_vec3()) < 1e-6);
    }
}

#[test]
fn mesh_of_every_layout_is_read() {
    let triangles = |mode: u32, change: &dyn Fn(&mut GltfBuilder)| {
        let mut builder = square();
        builder.root["meshes"][0]["primitives"][0]["mode"] = json!(mode);
        let primitive = builder.root["meshes"][0]["primitives"][0].as_object_mut().unwrap();
        primitive.remove("indices");
        change(&mut builder);
        mesh_of(&builder.read()).triangles.clone()
    };
    assert_eq!(triangles(4, &|_| ()), [[0, 1, 2]]);
    assert_eq!(triangles(5, &|_| ()), [[0, 1, 2], [2, 1, 3]]);
    assert_eq!(triangles(6, &|_| ()), [[0, 1, 2], [0, 2, 3]]);
    // Positions of which one is replaced by zeros, and weights as bytes.
    let mut builder = square();
    let index = builder.view(&[2, 0, 0, 0]);
    let value = builder.view(&[7.0f32, 8.0, 9.0].map(f32::to_le_bytes).concat());
    let sparse = builder.accessor(json!({ "componentType": 5126, "count": 4, "type": "VEC3", "sparse": {
        "count": 1, "indices": { "bufferView": index, "componentType": 5121 }, "values": { "bufferView": value } } }));
    let weights = builder.view(&[255u8, 0, 0, 0].repeat(4));
    let weights = builder.accessor(json!({
        "bufferView": weights, "componentType": 5121, "normalized": true, "count": 4,
        "type": "VEC4"
    }));
    let attributes = &mut builder.root["meshes"][0]["primitives"][0]["attributes"];
    attributes["POSITION"] = json!(sparse);
    attributes["WEIGHTS_0"] = json!(weights);
    let imported = builder.read();
    let mesh = mesh_of(&imported);
    assert_eq!(
        (mesh.positions[2], mesh.weights[2]),
        (Vec3::new(7.0, 8.0, 9.0), [1.0, 0.0, 0.0, 0.0])
    );
}

#[test]
fn mesh_parts_that_are_ignored_give_warnings() {
    let mut builder = square();
    builder.root["meshes"][0]["primitives"][0]["targets"] = json!([{}]);
    builder.root["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] =
        json!({ "index": 0 });
    assert_eq!(
        sentences(&builder.read()),
        [
            "imported without 1 texture: the plain colour is used",
            "1 mesh keeps one shape: morph targets stay at the weights of the file",
            "the file has a skeleton but no animation"
        ]
    );
}

#[test]
fn mesh_without_a_skin_follows_the_joint_above() {
    let mut builder = square();
    let corners = builder.floats("VEC3", 3, &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
    builder
        .list("meshes")
        .push(json!({ "primitives": [{ "attributes": { "POSITION": corners } }] }));
    // A quarter turn about Z and half the size, 0.2 m in front of the chest.
    let quarter = std::f32::consts::FRAC_PI_2;
    let nodes = builder.list("nodes");
    nodes[1]["children"].as_array_mut().unwrap().push(json!(4));
    nodes.push(json!({
        "name": "Badge", "mesh": 1, "translation": [0.0, 0.0, 0.2],
        "rotation": about_z(quarter), "scale": [0.5, 0.5, 0.5]
    }));
    // One that hangs from no joint.
    nodes.push(json!({ "name": "Floor", "mesh": 1 }));
    builder.channel(
        1,
        "rotation",
        "LINEAR",
        &[0.0, 1.0],
        &[about_z(0.0), about_z(quarter)].concat(),
    );
    let imported = builder.read();
    let (mesh, clip) = (mesh_of(&imported), &imported.clips[0].clip);
    assert_eq!(mesh.positions.len(), 4 + 3);
    let chest = clip.skeleton().find("Chest").unwrap() as u16;
    assert_eq!((mesh.joints[5][0], mesh.weights[5][0]), (chest, 1.0));
    let (mut transforms, mut positions, mut normals) = (vec![], vec![], vec![]);
    let badge = Vec3::new(0.0, 1.5, 0.2);
    for (frame, tip) in [(0, Vec3::Y), (30, Vec3::NEG_X)] {
        mesh.joint_transforms(&clip.world_pose(frame), &mut transforms);
        linear_blend(mesh, &transforms, &mut positions, &mut normals);
        assert!(positions[4].distance(badge) < 1e-6, "{}", positions[4]);
        assert!(positions[5].distance(badge + tip * 0.5) < 1e-6, "{}", positions[5]);
    }
}

/// Adds two morph targets: one moves the second vertex, written sparsely, and one all normals.
fn add_targets(builder: &mut GltfBuilder) {
    let places = builder.view(&[1, 0]);
    let moves = builder.view(&[0.5_f32, 0.0, 1.0].map(f32::to_le_bytes).concat());
    let sparse = builder.accessor(json!({
        "componentType": 5126, "count": 4, "type": "VEC3", "sparse": {
            "count": 1, "indices": { "bufferView": places, "componentType": 5123 },
            "values": { "bufferView": moves }
        }
    }));
    let still = builder.floats("VEC3", 3, &[0.0; 12]);
    let turns = builder.floats("VEC3", 3, &[2.0, 0.0, 0.0].repeat(4));
    let normals = builder.floats("VEC3", 3, &[0.0, 0.0, 1.0].repeat(4));
    let primitive = &mut builder.root["meshes"][0]["primitives"][0];
    primitive["attributes"]["NORMAL"] = json!(normals);
    primitive["targets"] = json!([{ "POSITION": sparse }, { "POSITION": still, "NORMAL": turns }]);
}

#[test]
fn mesh_has_the_shape_of_its_morph_weights() {
    let with = |mesh: Value, node: Value| {
        let mut builder = square();
        add_targets(&mut builder);
        builder.root["meshes"][0]["weights"] = mesh;
        builder.root["nodes"][3]["weights"] = node;
        let imported = builder.read();
        let mesh = mesh_of(&imported);
        (mesh.positions[1], mesh.positions[0], mesh.normals[0])
    };
    let (first, other) = (Vec3::new(0.1, 1.0, 0.0), Vec3::new(-0.1, 1.0, 0.0));
    let moved = first + Vec3::new(0.25, 0.0, 0.5);
    let turned = Vec3::new(1.0, 0.0, 1.0).normalize_or_zero();
    let null = Value::Null;
    assert_eq!(with(null.clone(), null.clone()), (first, other, Vec3::Z));
    assert_eq!(with(json!([0.5, 0.0]), null.clone()), (moved, other, Vec3::Z));
    // The weights of the node come before those of its mesh.
    assert_eq!(with(json!([1.0]), json!([0.5])), (moved, other, Vec3::Z));
    let (.., normal) = with(null, json!([0.0, 0.5]));
    assert!(normal.distance(turned) < 1e-6, "{normal}");
}

#[test]
fn morph_target_of_another_size_leaves_its_mesh_out() {
    let mut builder = square();
    let short = builder.floats("VEC3", 3, &[0.0; 9]);
    builder.root["meshes"][0]["primitives"][0]["targets"] = json!([{ "POSITION": short }]);
    builder.root["meshes"][0]["weights"] = json!([1.0]);
    let imported = builder.read();
    assert_eq!(imported.clips[0].mesh, None);
    let told = sentences(&imported);
    assert!(told[0].contains("a morph target that is not one value for each vertex"), "{told:?}");
}

#[test]
fn compressed_meshes_are_left_out_and_said_to_be() {
    let mut builder = square();
    let at = builder.root["meshes"][0]["primitives"][0]["attributes"]["POSITION"].as_u64();
    let accessor = &mut builder.root["accessors"][at.unwrap() as usize];
    accessor.as_object_mut().unwrap().remove("bufferView");
    builder.root["extensionsRequired"] = json!(["KHR_draco_mesh_compression"]);
    let imported = builder.read();
    assert_eq!(imported.clips[0].mesh, None);
    assert_eq!(
        sentences(&imported)[0],
        "imported without 1 mesh that Draco compressed: save the file without compression"
    );
}

#[test]
fn invalid_meshes_are_left_out_and_the_motion_is_kept() {
    let spoilt = |change: &dyn Fn(&mut GltfBuilder)| {
        let mut builder = square();
        change(&mut builder);
        builder.read()
    };
    let primitive = |builder: &GltfBuilder, key: &str| {
        builder.root["meshes"][0]["primitives"][0]["attributes"][key].as_u64().unwrap() as usize
    };
    let count = |key: &'static str, count: u64| {
        spoilt(&move |builder| {
            let at = primitive(builder, key);
            builder.root["accessors"][at]["count"] = json!(count);
        })
    };
    let left_out: [(&str, ImportedFile); 7] = [
        ("4 billion vertices", count("POSITION", 4_000_000_000)),
        ("4 billion joints", count("JOINTS_0", u64::MAX)),
        ("too few weights", count("WEIGHTS_0", 2)),
        (
            "4 billion zeros",
            spoilt(&|builder| {
                let at = primitive(builder, "POSITION");
                builder.root["accessors"][at] =
                    json!({ "componentType": 5126, "count": 2_000_000u32, "type": "VEC3" });
            }),
        ),
        (
            "indices out of range",
            spoilt(&|builder| {
                let view = builder.view(&[0u16, 1, 77].map(u16::to_le_bytes).concat());
                let at = builder.accessor(json!({
                    "bufferView": view, "componentType": 5123, "count": 3, "type": "SCALAR"
                }));
                builder.root["meshes"][0]["primitives"][0]["indices"] = json!(at);
            }),
        ),
        (
            "joints out of range",
            spoilt(&|builder| {
                let view = builder.view(&[200u8; 16]);
                let at = builder.accessor(json!({
                    "bufferView": view, "componentType": 5121, "count": 4, "type": "VEC4"
                }));
                builder.root["meshes"][0]["primitives"][0]["attributes"]["JOINTS_0"] = json!(at);
            }),
        ),
        (
            "too few bind matrices",
            spoilt(&|builder| {
                let at = builder.floats("MAT4", 16, &[0.0; 16]);
                builder.root["skins"][0]["inverseBindMatrices"] = json!(at);
            }),
        ),
    ];
    for (name, imported) in left_out {
        assert!(imported.clips[0].mesh.is_none(), "{name}");
        assert_eq!(imported.clips[0].clip.skeleton().len(), 2, "{name}");
        let told = sentences(&imported);
        assert!(
            told.iter().any(|text| text.starts_with("imported without 1 mesh; the first has ")),
            "{name}: {told:?}"
        );
    }
    // Values that are not finite: such a weight is ignored, a triangle with such a corner is left
    // out, and such a normal is computed.
    let nan = spoilt(&|builder| {
        let weights = builder.floats("VEC4", 4, &[f32::NAN; 16]);
        builder.root["meshes"][0]["primitives"][0]["attributes"]["WEIGHTS_0"] = json!(weights);
    });
    assert!(nan.clips[0].mesh.is_none());
    let nan = spoilt(&|builder| {
        let (mut places, mut weights) = ([0.0; 12], [0.0; 16]);
        (places[0], places[4], places[6], weights[0], weights[4], weights[5]) =
            (f32::NAN, 1.0, 1.0, 1.0, 1.0, f32::INFINITY);
        let attributes = [
            ("POSITION", builder.floats("VEC3", 3, &places)),
            ("WEIGHTS_0", builder.floats("VEC4", 4, &weights)),
            ("NORMAL", builder.floats("VEC3", 3, &[f32::NAN; 12])),
        ];
        for (key, at) in attributes {
            builder.root["meshes"][0]["primitives"][0]["attributes"][key] = json!(at);
        }
        let primitive = builder.root["meshes"][0]["primitives"][0].as_object_mut().unwrap();
        primitive.remove("indices");
        primitive.insert("mode".into(), json!(5));
    });
    let mesh = mesh_of(&nan);
    assert_eq!(mesh.triangles, [[2, 1, 3]]);
}

#[test]
fn generated_body_written_by_another_program_is_read() {
    let clip = wander(&fixtures::cmu_bvh(), 3, 2);
    let options = GlbOptions { smooth: true, ..GlbOptions::default() };
    let bytes = write_glb(&clip, &options).unwrap();
    // Segue generates that body itself.
    assert!(
        read("x.glb", &bytes, &|_| None, &ImportOptions::default()).unwrap().clips[0]
            .mesh
            .is_none()
    );
    let imported =
        read("x.glb", &by_another_program(bytes), &|_| None, &ImportOptions::default()).unwrap();
    let mesh = mesh_of(&imported);
    let skeleton = clip.skeleton();
    let builder = SkinnedMesh::around(skeleton, &Roles::detect(skeleton), 1.0);
    assert_eq!(
        (mesh.triangles.len(), mesh.positions.len()),
        (builder.triangles.len(), builder.positions.len())
    );
    // Bound at rest instead of where it was generated; the motion is the same, except for weights
    // in steps of 1/255 and vertices that limbs share.
    let (mut transforms, mut read_back, mut direct, mut normals) = (vec![], vec![], vec![], vec![]);
    let rest = segue_motion::skeleton::world_pose(
        skeleton,
        &segue_motion::skeleton::Pose {
            root_translation: skeleton.joints()[0].offset,
            ..Default::default()
        },
    );
    builder.joint_transforms(&rest, &mut transforms);
    linear_blend(&builder, &transforms, &mut direct, &mut normals);
    read_back.clone_from(&mesh.positions);
    for (a, b) in read_back.iter().zip(&direct) {
        assert!(a.distance(*b) < 5e-3, "{a} {b}");
    }
}
