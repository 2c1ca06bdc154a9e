//! Properties of any tree of nodes, and of any damage to a file.

use super::*;
use glam::{DMat4, DQuat, DVec3};
use proptest::prelude::*;
use segue_motion::skeleton::FoldedChain;

/// A tree of nodes: for each, its parent among those before it, its translation, rotation and
/// scale.
type Tree = Vec<(prop::sample::Index, [f32; 3], [f32; 3], f32)>;

/// The fuzzer's files with bone maps, textures, morph targets and rigid meshes.
const SEEDS: [&[u8]; 3] = [
    include_bytes!("../../../../../fuzz/corpus-seeds/gltf/vrm0.gltf"),
    include_bytes!("../../../../../fuzz/corpus-seeds/gltf/vrm1.gltf"),
    include_bytes!("../../../../../fuzz/corpus-seeds/gltf/vrma.gltf"),
];

#[test]
fn seeds_of_the_fuzzer_are_read_whole() {
    for (seed, expected) in SEEDS.into_iter().zip([
        &["1 mesh keeps one shape", "the file has a skeleton"][..],
        &["1 mesh keeps one shape", "the file has a skeleton"],
        &["imported without 1 animation of expressions"],
    ]) {
        let imported = open(seed).unwrap();
        let told = sentences(&imported);
        assert_eq!(told.len(), expected.len(), "{told:?}");
        assert!(told.iter().zip(expected).all(|(told, start)| told.starts_with(start)), "{told:?}");
        assert!(imported.clips[0].roles.is_some());
    }
}

fn tree() -> impl Strategy<Value = Tree> {
    let vector = || [-1.0f32..1.0, -1.0f32..1.0, -1.0f32..1.0];
    prop::collection::vec(
        (
            any::<prop::sample::Index>(),
            vector(),
            vector().prop_map(|v| v.map(|v| 3.0 * v)),
            0.3f32..2.0,
        ),
        2..9,
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(120))]

    #[test]
    fn joint_positions_equal_node_matrices(
        tree in tree(),
        joints in prop::collection::btree_set(0usize..9, 1..6),
        keys in prop::collection::vec(
            (0usize..9, [-2.0f32..2.0, -2.0f32..2.0, -2.0f32..2.0], any::<bool>()),
            1..6,
        ),
    ) {
        let turn = |v: [f32; 3]| quat::exp(Vec3::from_array(v));
        let parent = |node: usize| (node > 0).then(|| tree[node].0.index(node));
        let nodes: Vec<Value> = tree
            .iter()
            .enumerate()
            .map(|(node, (_, place, angles, scale))| {
                let children: Vec<usize> =
                    (node + 1..tree.len()).filter(|&child| parent(child) == Some(node)).collect();
                let mut builder = json!({
                    "name": format!("n{node}"), "translation": place,
                    "rotation": turn(*angles).to_array(), "scale": vec![scale; 3]
                });
                if !children.is_empty() {
                    builder["children"] = json!(children);
                }
                builder
            })
            .collect();
        let joints: Vec<usize> = joints.into_iter().filter(|&joint| joint < tree.len()).collect();
        prop_assume!(!joints.is_empty());
        let mut builder = GltfBuilder::new(&json!(nodes), &joints);
        // From rest to a key one frame later; of several channels for one property, the last one
        // counts.
        let mut moved: Vec<([f32; 3], Quat)> =
            tree.iter().map(|(_, place, angles, _)| (*place, turn(*angles))).collect();
        let at_rest = moved.clone();
        for &(node, to, turns) in keys.iter().filter(|key| key.0 < tree.len()) {
            if turns {
                moved[node].1 = turn(to);
                builder.channel(
                    node,
                    "rotation",
                    "LINEAR",
                    &[0.0, 1.0 / 24.0],
                    &[at_rest[node].1.to_array(), turn(to).to_array()].concat(),
                );
            } else {
                moved[node].0 = to;
                builder.channel(
                    node,
                    "translation",
                    "LINEAR",
                    &[0.0, 1.0 / 24.0],
                    &[at_rest[node].0, to].concat(),
                );
            }
        }
        let world = |poses: &[([f32; 3], Quat)]| {
            let mut all: Vec<DMat4> = Vec::new();
            for (node, (place, turn)) in poses.iter().enumerate() {
                let local = DMat4::from_scale_rotation_translation(
                    DVec3::splat(f64::from(tree[node].3)),
                    DQuat::from_array(turn.to_array().map(f64::from)),
                    DVec3::from_array(place.map(f64::from)),
                );
                all.push(parent(node).map_or(DMat4::IDENTITY, |parent| all[parent]) * local);
            }
            all
        };
        let imported = builder.read();
        for found in &imported.clips {
            let clip = &found.clip;
            for (frame, matrices) in
                [world(&at_rest), world(&moved)].iter().enumerate().take(clip.frames())
            {
                let pose = clip.world_pose(frame);
                for (joint, position) in clip.skeleton().joints().iter().zip(&pose.positions) {
                    let node: usize = joint.name[1..].parse().unwrap();
                    let expected = matrices[node].transform_point3(DVec3::ZERO).as_vec3();
                    let size = 1.0 + expected.length();
                    prop_assert!(
                        position.distance(expected) < 2e-5 * size,
                        "{} in frame {frame}: {position}, not {expected}",
                        joint.name
                    );
                }
            }
        }
        let skeletons = imported.clips.iter().map(|found| found.clip.skeleton());
        let kept = skeletons.clone().flat_map(|skeleton| skeleton.joints());
        let folded =
            skeletons.filter_map(|skeleton| skeleton.folded_chain()).flat_map(FoldedChain::joints);
        let names: Vec<&str> = kept.chain(folded).map(|joint| joint.name.as_str()).collect();
        prop_assert!(
            joints.iter().all(|joint| names.contains(&format!("n{joint}").as_str())),
            "{names:?}"
        );
    }

    #[test]
    fn damaged_files_are_read_or_refused(
        edits in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>(), 0u8..4), 1..10),
        file in 0usize..4,
    ) {
        let clip = wander(&fixtures::cmu_bvh(), 4, 9);
        // A text has all of its data in it, the images and the bone maps included.
        let (mut bytes, json) = if let Some(text) = SEEDS.get(file) {
            (text.to_vec(), text.len())
        } else {
            let glb = by_another_program(write_glb(&clip, &GlbOptions::default()).unwrap());
            let json = glb[20..].windows(4).position(|w| w == b"BIN\0").unwrap();
            (glb, 20 + json)
        };
        for (at, value, kind) in edits {
            // Mostly in the JSON, and there mostly in its digits.
            let at = at.index(if kind == 0 { bytes.len() } else { json });
            match kind {
                1 | 2 if bytes[at].is_ascii_digit() => bytes[at] = b'0' + value % 10,
                3 => bytes[at] = b"[]{},:\"-9e."[usize::from(value) % 11],
                _ => bytes[at] = value,
            }
        }
        let options = ImportOptions { max_bytes: 1 << 22, ..ImportOptions::default() };
        if let Ok(imported) = read("spoilt.glb", &bytes, &|_| None, &options) {
            for found in &imported.clips {
                prop_assert!(
                    (0..found.clip.frames()).all(|frame| found
                        .clip
                        .rotations(frame)
                        .iter()
                        .all(|q| q.is_normalized()))
                );
                prop_assert!(found.clip.root_translations().iter().all(|place| place.is_finite()));
                if let Some(mesh) = &found.mesh {
                    skin::check(mesh, found.clip.skeleton().len());
                }
            }
        }
    }
}
