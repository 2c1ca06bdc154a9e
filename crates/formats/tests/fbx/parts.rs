//! Files that are read in parts, compared with the same files read at once.

use crate::document::{Element, Form, binary_in};
use crate::examples;
use proptest::prelude::*;
use segue_fbx::{OpenOptions, Scene};

/// The memory of a part that holds a few dozen times of keys.
const PART: usize = 64 << 10;

fn open(bytes: &[u8], max_key_memory: usize) -> Scene<'_> {
    let options = OpenOptions { max_memory: 1 << 30, meshes: true, max_key_memory };
    Scene::open(bytes, options, &mut |_| true).expect("a scene")
}

/// Checks that a file is the same in parts: takes, meshes, and every transform to the last bit.
fn is_same(bytes: &[u8], step: usize) {
    let (whole, mut parts) = (open(bytes, usize::MAX), open(bytes, PART));
    assert!(parts.is_in_parts() && !whole.is_in_parts());
    assert_eq!(whole.nodes(), parts.nodes());
    assert_eq!(whole.takes(), parts.takes());
    assert_eq!(whole.meshes(usize::MAX), parts.meshes(usize::MAX));
    parts.forget_looks().expect("there is nothing to read");
    let (mut all, mut some) = (whole.poses(), parts.poses());
    for (take, found) in whole.takes().iter().enumerate() {
        let keys = &found.key_secs;
        let [first, .., last] = keys[..] else { panic!("a take without keys") };
        // Before and behind all keys, on keys and between them, forwards and backwards.
        let count = 4 * keys.len();
        let secs = |place: usize| first - 0.1 + (last - first + 0.2) * place as f64 / count as f64;
        let on_keys = keys.iter().copied();
        let times =
            on_keys.chain((0..count).map(secs)).chain([last, first, first - 1.0, last + 1.0]);
        for secs in times.step_by(step) {
            for node in 0..whole.nodes().len() {
                assert_eq!(
                    all.transform(take, node, secs),
                    some.transform(take, node, secs),
                    "take {take} node {node} at {secs} s"
                );
            }
        }
    }
}

#[test]
fn transforms_of_a_file_in_parts_are_those_of_the_whole() {
    let document = examples::long().document();
    for form in [
        Form { version: 7400, is_packed: false },
        Form { version: 7500, is_packed: true },
        Form { version: 7700, is_packed: false },
    ] {
        is_same(&binary_in(form, &document), 5);
    }
}

#[test]
fn constant_scales_are_found_in_parts_as_in_the_whole() {
    // Whether the scale of a joint changes decides how it is inherited.
    for inherits in [0, 2] {
        let mut file = examples::long();
        for node in &mut file.nodes {
            node.inherits = Some(inherits);
        }
        is_same(&binary_in(Form { version: 7400, is_packed: true }, &file.document()), 37);
    }
}

/// Adds elements to each curve.
fn with_curves(elements: &mut [Element], add: &dyn Fn(&mut Element)) {
    for element in elements {
        if element.name() == "AnimationCurve" {
            add(element);
        }
        with_curves(element.children_mut(), add);
    }
}

#[test]
fn curves_that_go_on_behind_their_keys_are_read_whole() {
    use crate::document::{Value, branch, leaf};
    for mode in [b'C', b'K', b'R', b'M', b'A'] {
        let mut document = examples::long().document();
        with_curves(&mut document, &|curve| {
            for name in ["Pre-Extrapolation", "Post-Extrapolation"] {
                let mode = leaf("Type", vec![Value::Char(mode)]);
                let times = leaf("Repetition", vec![Value::Int(-1)]);
                curve.push(branch(name, Vec::new(), vec![mode, times]));
            }
        });
        let bytes = binary_in(Form { version: 7400, is_packed: true }, &document);
        if mode == b'C' {
            is_same(&bytes, 29);
        } else {
            let [whole, parts] = [open(&bytes, usize::MAX), open(&bytes, PART)];
            assert!(!parts.is_in_parts());
            let secs = whole.takes()[0].key_secs.last().unwrap() + 0.3;
            let at = |scene: &Scene<'_>| scene.poses().transform(0, 3, secs).unwrap();
            assert_eq!(at(&whole), at(&parts));
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]
    #[test]
    fn file_that_is_changed_is_read_in_parts_as_in_the_whole(
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
        is_packed in any::<bool>(),
    ) {
        let mut file = examples::long();
        file.nodes.truncate(4);
        for track in file.takes.iter_mut().flat_map(|take| &mut take.layers) {
            track.retain(|track| track.node < 4);
        }
        let mut bytes = binary_in(Form { version: 7400, is_packed }, &file.document());
        for (place, byte) in changes {
            let at = place.index(bytes.len());
            bytes[at] = byte;
        }
        let open = |max_key_memory: usize| {
            let options = OpenOptions { max_memory: 64 << 20, meshes: true, max_key_memory };
            Scene::open(&bytes, options, &mut |_| true)
        };
        let (whole, parts) = (open(usize::MAX), open(PART));
        prop_assert_eq!(whole.as_ref().err(), parts.as_ref().err());
        if let (Ok(whole), Ok(parts)) = (whole, parts) {
            prop_assert_eq!(whole.nodes().len(), parts.nodes().len());
            let (mut all, mut some) = (whole.poses(), parts.poses());
            for secs in [0.0, 0.5, 3.0] {
                for node in 0..whole.nodes().len() {
                    let bits = |transform: segue_fbx::Transform| {
                        transform.translation.map(f64::to_bits)
                    };
                    prop_assert_eq!(
                        all.transform(0, node, secs).map(bits),
                        some.transform(0, node, secs).map(bits)
                    );
                }
            }
        }
    }
}
