//! Peak memory of reading an FBX file, the file itself included, measured by a counting allocator,
//! which ufbx uses as well. A binary of its own with one test, so that nothing else allocates.

#[path = "fbx/document.rs"]
#[expect(dead_code, reason = "the other test writes text as well")]
mod document;
#[path = "fbx/rig.rs"]
mod rig;

use document::{Form, binary_in};
use glam::{DMat4, DVec3};
use peak_alloc::PeakAlloc;
use rig::{File, Material, Node, Paint, Skin, Take, Track};
use segue_formats::{ImportOptions, import};

/// Moves growing vectors to a new place, as the allocators of browsers do.
#[global_allocator]
static ALLOCATOR: PeakAlloc = PeakAlloc;

/// The size of files, bytes: 50 MB in optimised builds; the ratio is tested.
const BYTES: usize = if cfg!(debug_assertions) { 12_000_000 } else { 50_000_000 };

/// The most memory for a vertex of a mesh, bytes.
const MAX_VERTEX_BYTES: f64 = 300.0;

/// The number of joints, in a chain.
const JOINTS: usize = 65;

/// Returns noise between -1 and 1 that does not pack well, as that of recorded motion.
fn noise(seed: usize) -> f64 {
    let mixed = (seed as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    let mixed = (mixed ^ (mixed >> 29)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    ((mixed >> 40) as f64) / f64::from(1 << 23) - 1.0
}

fn chain() -> Vec<Node> {
    let node = |joint: usize| Node {
        name: format!("Joint{joint}"),
        kind: "LimbNode",
        parent: joint.checked_sub(1),
        place: [0.0, 3.0, 0.0],
        ..Node::default()
    };
    (0..JOINTS).map(node).collect()
}

/// Returns a recording of so many frames: rotations of all joints, and, as most programs write
/// them, translations and scales that do not change.
fn recording(frames: usize, with_constant: bool) -> File {
    let tracks = (0..JOINTS).flat_map(|node| {
        let turns = Track {
            node,
            property: "Lcl Rotation",
            values: (0..frames)
                .map(|frame| {
                    let slow = (frame as f64 / 50.0 + node as f64).sin();
                    [0, 1, 2].map(|axis| 40.0 * slow + noise(3 * (frame * JOINTS + node) + axis))
                })
                .collect(),
            is_mixed: false,
        };
        let still = |property: &'static str, value: [f64; 3]| Track {
            node,
            property,
            values: vec![value; frames],
            is_mixed: false,
        };
        let constant = with_constant.then(|| {
            [still("Lcl Translation", [0.0, 3.0, 0.0]), still("Lcl Scaling", [1.0, 1.0, 1.0])]
        });
        std::iter::once(turns).chain(constant.into_iter().flatten())
    });
    let layers = vec![tracks.collect()];
    let takes = vec![Take { name: "Take 001".into(), layers }];
    File { nodes: chain(), takes, skin: None, fps: 120.0, unit: 1.0, z_up: false }
}

/// Returns a body of so many squares.
fn body(squares: usize) -> File {
    let side = (squares as f64).sqrt().ceil() as i32;
    let corner = |row: i32, column: i32| row * (side + 1) + column;
    let places = (0..=side).flat_map(|row| (0..=side).map(move |column| (row, column)));
    let vertices: Vec<[f64; 3]> = places
        .map(|(row, column)| {
            let seed = corner(row, column) as usize;
            [f64::from(column), f64::from(row), noise(seed)].map(|length| 0.1 * length)
        })
        .collect();
    let faces = (0..side).flat_map(|row| {
        (0..side).map(move |column| {
            let next = row + 1;
            [(row, column), (row, column + 1), (next, column + 1), (next, column)]
                .map(|(row, column)| corner(row, column))
                .to_vec()
        })
    });
    let of_joint = |joint: usize| {
        let own = (0..vertices.len()).filter(move |vertex| vertex % JOINTS == joint);
        let bind = DMat4::from_translation(DVec3::new(0.0, 3.0 * joint as f64, 0.0));
        (joint, bind, own.map(|vertex| vertex as i32).collect())
    };
    let clusters = (0..JOINTS).map(of_joint).collect();
    let faces: Vec<Vec<i32>> = faces.collect();
    let corners = faces.iter().flatten().map(|&corner| {
        [corner / (side + 1), corner % (side + 1)].map(|place| f64::from(place) / f64::from(side))
    });
    let paint = Paint {
        sets: vec![("map1", corners.collect())],
        materials: vec![Material { color: [1.0; 3], factor: 1.0, texture: None }],
        of_faces: vec![0; faces.len()],
    };
    let skin = Skin { faces, clusters, vertices: vertices.clone(), paint: Some(paint) };
    File { skin: Some(skin), ..recording(60, false) }
}

/// Returns the peak of memory as a multiple of a file's size.
fn ratio(bytes: &[u8]) -> f64 {
    ALLOCATOR.reset_peak_usage();
    let before = ALLOCATOR.current_usage() - bytes.len();
    let imported = import("big.fbx", bytes, &ImportOptions::default()).expect("a clip");
    let peak = ALLOCATOR.peak_usage() - before;
    let clip = &imported.clips[0].clip;
    // The size of the motion alone, to check that the allocator counts.
    let motion = clip.frames() * clip.skeleton().len() * size_of::<glam::Quat>();
    assert!(peak > bytes.len() + motion);
    peak as f64 / bytes.len() as f64
}

#[test]
fn peak_memory_is_at_most_four_times_the_file() {
    let plain = Form { version: 7400, is_packed: false };
    let packed = Form { version: 7500, is_packed: true };
    // Bytes of the file for each frame: 12 for a key, or about 4.
    let frames = |bytes: usize| BYTES / (bytes * 3 * JOINTS);
    let squares = BYTES / 140;
    let files: [(&str, &dyn Fn() -> Vec<u8>); 4] = [
        ("keys", &|| binary_in(plain, &recording(frames(12), false).document())),
        ("packed keys", &|| binary_in(packed, &recording(frames(5), false).document())),
        ("constant keys", &|| binary_in(packed, &recording(frames(5), true).document())),
        ("a mesh", &|| binary_in(plain, &body(squares).document())),
    ];
    for (name, file) in files {
        let bytes = file();
        let ratio = ratio(&bytes);
        println!("{name}: {} bytes, peak {ratio:.2} times the file", bytes.len());
        assert!(ratio <= 4.0, "{name}: {ratio}");
    }
    // Squares pack so well that a file says little about the size of its mesh.
    let bytes = binary_in(packed, &body(squares).document());
    let each = (ratio(&bytes) - 1.0) * bytes.len() as f64 / squares as f64;
    println!("a packed mesh: {} bytes, {each:.0} more for each vertex", bytes.len());
    assert!(each <= MAX_VERTEX_BYTES, "{each}");
}
