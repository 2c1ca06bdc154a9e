//! Files that are read in parts, compared with the same files read at once.

use crate::document::{Element, Form, binary_in};
use crate::examples;
use crate::rig::{File, Track};
use proptest::prelude::*;
use segue_fbx::{OpenError, OpenOptions, Scene};
use segue_formats::{ImportOptions, fbx};

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
    parts.drop_meshes(&mut |_| panic!("read again")).expect("there is nothing to read");
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

/// Returns a file of 16 joints whose keys pack to less than a hundredth: all of a take have one
/// time, and all of a curve one value, or the first key another one.
fn dense(frames: usize, is_level: bool) -> Vec<u8> {
    let values = (0..frames).map(|frame| [f64::from(u8::from(frame == 0 && !is_level)); 3]);
    let values: Vec<[f64; 3]> = values.collect();
    let track =
        |node| Track { node, property: "Lcl Rotation", values: values.clone(), is_mixed: false };
    let mut file = File { fps: 1e20, ..examples::several_takes() };
    file.takes.truncate(1);
    file.takes[0].layers = vec![(0..file.nodes.len()).map(track).collect()];
    binary_in(Form { version: 7400, is_packed: true }, &file.document())
}

#[test]
fn meshes_are_dropped_by_one_more_reading_at_most() {
    // The keys alone take so much memory that a second call could find another reading worth it.
    let mut file = examples::long();
    for track in file.takes.iter_mut().flat_map(|take| &mut take.layers).flatten() {
        track.values = track.values.repeat(10);
    }
    let bytes = binary_in(Form { version: 7400, is_packed: true }, &file.document());
    let mut scene = open(&bytes, usize::MAX);
    let before = scene.poses().transform(0, 3, 1.0).unwrap();
    let mut readings = || {
        // Within a reading, a report may be a few bytes behind the one before.
        let half = bytes.len() / 2;
        let (mut readings, mut last) = (0, usize::MAX);
        let dropped = scene.drop_meshes(&mut |done| {
            readings += usize::from(last >= half && done < half);
            last = done;
            true
        });
        dropped.map(|()| readings)
    };
    assert_eq!([readings(), readings(), readings()], [Ok(1), Ok(0), Ok(0)]);
    assert_eq!(scene.poses().transform(0, 3, 1.0).unwrap(), before);
}

#[test]
fn node_without_a_valid_place_is_read_again_as_it_was() {
    let mut file = examples::long();
    file.nodes[6].place = [f64::NAN, 0.0, 0.0];
    let bytes = binary_in(Form { version: 7400, is_packed: true }, &file.document());
    let scene = open(&bytes, PART);
    assert!(scene.nodes().iter().any(|node| node.local.translation[0].is_nan()));
    assert!(scene.is_in_parts());
}

#[test]
fn keys_that_unpack_to_more_than_the_memory_are_refused() {
    let (frames, joints) = (20_000, 16);
    let bytes = dense(frames, false);
    // The values of all curves, and times that they share.
    let unpacked = frames * (4 * 3 * joints + 8);
    assert!(bytes.len() < unpacked / 40, "{} bytes of {unpacked}", bytes.len());
    let open = |max_memory: usize| {
        let options = OpenOptions { max_memory, meshes: true, max_key_memory: PART };
        Scene::open(&bytes, options, &mut |_| true)
    };
    for max_memory in [0, 1, 1 << 16, unpacked / 2, unpacked - 1] {
        assert_eq!(open(max_memory).err(), Some(OpenError::Keys), "{max_memory} bytes");
    }
    assert!(open(2 * unpacked).is_ok_and(|scene| scene.is_in_parts()));
    // The sentence says what to do.
    let options = ImportOptions { max_bytes: bytes.len(), ..ImportOptions::default() };
    let error = fbx::read("dense.fbx", &bytes, &options).unwrap_err();
    assert!(error.to_string().contains("more motion than fits"), "{error}");
    assert!(error.hint.is_some());
}

#[test]
fn keys_that_unpack_to_many_times_the_file_are_refused() {
    // All keys of a level curve are kept as one, so that memory does not bound their number.
    let (few, many) = (dense(20_000, true), dense(120_000, true));
    let open = |bytes: &[u8]| {
        let options = OpenOptions { max_memory: 1 << 30, meshes: true, max_key_memory: PART };
        Scene::open(bytes, options, &mut |_| true).map(|scene| scene.is_in_parts())
    };
    assert_eq!((open(&few), open(&many)), (Ok(true), Err(OpenError::Keys)));
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
