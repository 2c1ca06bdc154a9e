//! Meshes with a skin, made here and spoilt here.

use super::*;
use segue_motion::skeleton::Roles;
use segue_motion::skin::{SkinnedMesh, linear_blend};

/// What every mesh that was read must be.
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

/// A square of two triangles on two bones, `Hips` at 1 m and `Chest` 0.5 m above: its lower edge
/// follows the hips, its upper one both.
fn square() -> Made {
    let mut made = Made::new(&two_bones(), &[0, 1]);
    let positions =
        made.floats("VEC3", 3, &[-0.1, 1.0, 0.0, 0.1, 1.0, 0.0, 0.1, 1.5, 0.0, -0.1, 1.5, 0.0]);
    let bytes: Vec<u8> = [[0, 9, 9, 9], [0, 9, 9, 9], [0, 1, 0, 0], [0, 1, 0, 0]].concat();
    let view = made.view(&bytes);
    let joints = made
        .accessor(json!({ "bufferView": view, "componentType": 5121, "count": 4, "type": "VEC4" }));
    let weights = made.floats(
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
    let view = made.view(&[0u16, 1, 2, 0, 2, 3].map(u16::to_le_bytes).concat());
    let indices = made.accessor(
        json!({ "bufferView": view, "componentType": 5123, "count": 6, "type": "SCALAR" }),
    );
    // A bind pose at 1 and 1.5 m, as the nodes rest.
    let matrix = |y: f32| {
        DMat4::from_translation(DVec3::new(0.0, -f64::from(y), 0.0)).as_mat4().to_cols_array()
    };
    let matrices = made.floats("MAT4", 16, &[matrix(1.0), matrix(1.5)].concat());
    made.root["skins"][0]["inverseBindMatrices"] = json!(matrices);
    made.root["meshes"] = json!([{ "primitives": [{
        "attributes": { "POSITION": positions, "JOINTS_0": joints, "WEIGHTS_0": weights }, "indices": indices, "material": 0 }] }]);
    made.root["materials"] =
        json!([{ "pbrMetallicRoughness": { "baseColorFactor": [1.0, 0.0, 0.5, 1.0] } }]);
    made.root["nodes"]
        .as_array_mut()
        .unwrap()
        .push(json!({ "name": "Skin", "mesh": 0, "skin": 0 }));
    made
}

fn mesh_of(imported: &Imported) -> &SkinnedMesh {
    let found = &imported.clips[0];
    let mesh = found.mesh.as_ref().unwrap();
    check(mesh, found.clip.skeleton().len());
    mesh
}

#[test]
fn a_mesh_comes_with_its_skin_colour_and_computed_normals() {
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
    assert_eq!(sentences(&imported), ["the file holds a skeleton and no motion"]);
}

#[test]
fn the_mesh_follows_the_clip_as_the_format_says() {
    let mut made = square();
    // Mesh and bones in centimetres of another pose: the bind matrices scale by 2, turn, and
    // stretch one axis.
    let bind = |y: f64| {
        DMat4::from_rotation_z(0.3)
            * DMat4::from_scale(DVec3::new(2.0, 1.5, 2.0))
            * DMat4::from_translation(DVec3::new(0.0, -y, 0.1))
    };
    let matrices = [bind(1.0), bind(1.5)];
    let values: Vec<f32> = matrices.iter().flat_map(|m| m.as_mat4().to_cols_array()).collect();
    made.root["skins"][0]["inverseBindMatrices"] = json!(made.floats("MAT4", 16, &values));
    made.channel(1, "rotation", "LINEAR", &[0.0, 1.0], &[about_z(0.0), about_z(1.2)].concat());
    let imported = made.read();
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
        // Bound anew at rest, a vertex that two joints share follows them a little differently: not
        // at all at rest.
        let slack = if angle == 0.0 { 1e-6 } else { 0.2 };
        assert!(positions[2].distance(expected.as_vec3()) < slack, "{} {expected}", positions[2]);
        let lower = (hips * matrices[0]).transform_point3(DVec3::new(-0.1, 1.0, 0.0));
        assert!(positions[0].distance(lower.as_vec3()) < 1e-6);
    }
}

#[test]
fn strips_and_fans_meshes_without_indices_and_sparse_ones_are_read() {
    let triangles = |mode: u32, change: &dyn Fn(&mut Made)| {
        let mut made = square();
        made.root["meshes"][0]["primitives"][0]["mode"] = json!(mode);
        let primitive = made.root["meshes"][0]["primitives"][0].as_object_mut().unwrap();
        primitive.remove("indices");
        change(&mut made);
        mesh_of(&made.read()).triangles.clone()
    };
    assert_eq!(triangles(4, &|_| ()), [[0, 1, 2]]);
    assert_eq!(triangles(5, &|_| ()), [[0, 1, 2], [2, 1, 3]]);
    assert_eq!(triangles(6, &|_| ()), [[0, 1, 2], [0, 2, 3]]);
    // Positions where one of zeros is replaced, and bytes as weights.
    let mut made = square();
    let index = made.view(&[2, 0, 0, 0]);
    let value = made.view(&[7.0f32, 8.0, 9.0].map(f32::to_le_bytes).concat());
    let sparse = made.accessor(json!({ "componentType": 5126, "count": 4, "type": "VEC3", "sparse": {
        "count": 1, "indices": { "bufferView": index, "componentType": 5121 }, "values": { "bufferView": value } } }));
    let weights = made.view(&[255u8, 0, 0, 0].repeat(4));
    let weights = made.accessor(json!({ "bufferView": weights, "componentType": 5121, "normalized": true, "count": 4, "type": "VEC4" }));
    let attributes = &mut made.root["meshes"][0]["primitives"][0]["attributes"];
    attributes["POSITION"] = json!(sparse);
    attributes["WEIGHTS_0"] = json!(weights);
    let imported = made.read();
    let mesh = mesh_of(&imported);
    assert_eq!(
        (mesh.positions[2], mesh.weights[2]),
        (Vec3::new(7.0, 8.0, 9.0), [1.0, 0.0, 0.0, 0.0])
    );
}

#[test]
fn what_is_not_read_of_a_mesh_is_told() {
    let mut made = square();
    made.root["meshes"][0]["primitives"][0]["targets"] = json!([{}]);
    made.root["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = json!({ "index": 0 });
    assert_eq!(
        sentences(&made.read()),
        [
            "1 surface with morph targets; they keep their shape",
            "1 texture left out; the plain colour was taken",
            "the file holds a skeleton and no motion"
        ]
    );
}

#[test]
fn hostile_meshes_are_left_out_and_the_motion_stays() {
    let spoilt = |change: &dyn Fn(&mut Made)| {
        let mut made = square();
        change(&mut made);
        made.read()
    };
    let primitive = |made: &Made, key: &str| {
        made.root["meshes"][0]["primitives"][0]["attributes"][key].as_u64().unwrap() as usize
    };
    let count = |key: &'static str, count: u64| {
        spoilt(&move |made| {
            let at = primitive(made, key);
            made.root["accessors"][at]["count"] = json!(count);
        })
    };
    let left_out: [(&str, Imported); 7] = [
        ("4 billion vertices", count("POSITION", 4_000_000_000)),
        ("4 billion joints", count("JOINTS_0", u64::MAX)),
        ("too few weights", count("WEIGHTS_0", 2)),
        (
            "4 billion zeros",
            spoilt(&|made| {
                let at = primitive(made, "POSITION");
                made.root["accessors"][at] =
                    json!({ "componentType": 5126, "count": 2_000_000u32, "type": "VEC3" });
            }),
        ),
        (
            "indices out of range",
            spoilt(&|made| {
                let view = made.view(&[0u16, 1, 77].map(u16::to_le_bytes).concat());
                let at = made.accessor(json!({ "bufferView": view, "componentType": 5123, "count": 3, "type": "SCALAR" }));
                made.root["meshes"][0]["primitives"][0]["indices"] = json!(at);
            }),
        ),
        (
            "joints out of range",
            spoilt(&|made| {
                let view = made.view(&[200u8; 16]);
                let at = made.accessor(json!({ "bufferView": view, "componentType": 5121, "count": 4, "type": "VEC4" }));
                made.root["meshes"][0]["primitives"][0]["attributes"]["JOINTS_0"] = json!(at);
            }),
        ),
        (
            "too few bind matrices",
            spoilt(&|made| {
                let at = made.floats("MAT4", 16, &[0.0; 16]);
                made.root["skins"][0]["inverseBindMatrices"] = json!(at);
            }),
        ),
    ];
    for (name, imported) in left_out {
        assert!(imported.clips[0].mesh.is_none(), "{name}");
        assert_eq!(imported.clips[0].clip.skeleton().len(), 2, "{name}");
        let told = sentences(&imported);
        assert!(
            told.iter().any(|text| text.starts_with("1 surface left out; the first has ")),
            "{name}: {told:?}"
        );
    }
    // Numbers that are none: a weight counts nothing, a triangle with such a corner is left out, a
    // normal is computed.
    let nan = spoilt(&|made| {
        let weights = made.floats("VEC4", 4, &[f32::NAN; 16]);
        made.root["meshes"][0]["primitives"][0]["attributes"]["WEIGHTS_0"] = json!(weights);
    });
    assert!(nan.clips[0].mesh.is_none());
    let nan = spoilt(&|made| {
        let (mut places, mut weights) = ([0.0; 12], [0.0; 16]);
        (places[0], places[4], places[6], weights[0], weights[4], weights[5]) =
            (f32::NAN, 1.0, 1.0, 1.0, 1.0, f32::INFINITY);
        let attributes = [
            ("POSITION", made.floats("VEC3", 3, &places)),
            ("WEIGHTS_0", made.floats("VEC4", 4, &weights)),
            ("NORMAL", made.floats("VEC3", 3, &[f32::NAN; 12])),
        ];
        for (key, at) in attributes {
            made.root["meshes"][0]["primitives"][0]["attributes"][key] = json!(at);
        }
        let primitive = made.root["meshes"][0]["primitives"][0].as_object_mut().unwrap();
        primitive.remove("indices");
        primitive.insert("mode".into(), json!(5));
    });
    let mesh = mesh_of(&nan);
    assert_eq!(mesh.triangles, [[2, 1, 3]]);
}

#[test]
fn our_own_body_comes_back_when_another_program_wrote_it() {
    let clip = wander(&fixtures::cmu_bvh(), 3, 2);
    let options = GlbOptions { smooth: true, ..GlbOptions::default() };
    let bytes = write_glb(&clip, &options).unwrap();
    // Segue makes that body itself.
    assert!(
        read("x.glb", &bytes, &|_| None, &ImportOptions::default()).unwrap().clips[0]
            .mesh
            .is_none()
    );
    let imported =
        read("x.glb", &by_another_program(bytes), &|_| None, &ImportOptions::default()).unwrap();
    let mesh = mesh_of(&imported);
    let skeleton = clip.skeleton();
    let made = SkinnedMesh::around(skeleton, &Roles::detect(skeleton), 1.0);
    assert_eq!(
        (mesh.triangles.len(), mesh.positions.len()),
        (made.triangles.len(), made.positions.len())
    );
    // Bound at rest instead of where it was made; the motion is the same, but for weights in parts
    // of 255 and what limbs share.
    let (mut transforms, mut read_back, mut direct, mut normals) = (vec![], vec![], vec![], vec![]);
    let rest = segue_motion::skeleton::world_pose(
        skeleton,
        &segue_motion::skeleton::Pose {
            root_translation: skeleton.joints()[0].offset,
            ..Default::default()
        },
    );
    made.joint_transforms(&rest, &mut transforms);
    linear_blend(&made, &transforms, &mut direct, &mut normals);
    read_back.clone_from(&mesh.positions);
    for (a, b) in read_back.iter().zip(&direct) {
        assert!(a.distance(*b) < 5e-3, "{a} {b}");
    }
}
