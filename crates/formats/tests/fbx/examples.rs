//! Files of our own making, each with what one family of programs writes.

use crate::rig::{File, Node, Skin, Take, Track};
use glam::{DMat4, DVec3};

/// Name, parent and offset of the joints of a body, metres.
const BODY: [(&str, Option<usize>, [f64; 3]); 15] = [
    ("Hips", None, [0.0, 0.95, 0.0]),
    ("Spine", Some(0), [0.0, 0.25, 0.02]),
    ("Head", Some(1), [0.0, 0.35, 0.0]),
    ("LeftUpLeg", Some(0), [0.1, -0.05, 0.0]),
    ("LeftLeg", Some(3), [0.0, -0.43, 0.01]),
    ("LeftFoot", Some(4), [0.0, -0.42, -0.02]),
    ("RightUpLeg", Some(0), [-0.1, -0.05, 0.0]),
    ("RightLeg", Some(6), [0.0, -0.43, 0.01]),
    ("RightFoot", Some(7), [0.0, -0.42, -0.02]),
    ("LeftArm", Some(1), [0.18, 0.2, 0.0]),
    ("LeftForeArm", Some(9), [0.28, 0.0, 0.0]),
    ("LeftHand", Some(10), [0.26, 0.0, 0.0]),
    ("RightArm", Some(1), [-0.18, 0.2, 0.0]),
    ("RightForeArm", Some(12), [-0.28, 0.0, 0.0]),
    ("RightHand", Some(13), [-0.26, 0.0, 0.0]),
];

/// Returns the nodes of the body behind `before` others, in units of so many metres.
fn body(prefix: &str, before: usize, metres: f64) -> Vec<Node> {
    let node = |(name, parent, offset): (&str, Option<usize>, [f64; 3])| Node {
        name: format!("{prefix}{name}"),
        kind: "LimbNode",
        parent: match parent {
            Some(parent) => Some(parent + before),
            None => before.checked_sub(1),
        },
        place: offset.map(|length| length / metres),
        ..Node::default()
    };
    BODY.into_iter().map(node).collect()
}

/// Returns a motion of all joints: the first of them walks, and every joint turns about all axes.
fn motion(first: usize, frames: usize, speed: f64, metres: f64, seed: f64) -> Vec<Track> {
    let walk = Track {
        node: first,
        property: "Lcl Translation",
        values: (0..frames)
            .map(|frame| {
                let time = frame as f64 / 30.0;
                [0.1 * (3.0 * time).sin(), 0.95 + 0.03 * (6.0 * time).sin(), speed * time]
                    .map(|length| length / metres)
            })
            .collect(),
        is_mixed: false,
    };
    let turns = (0..BODY.len()).map(|joint| Track {
        node: first + joint,
        property: "Lcl Rotation",
        values: (0..frames)
            .map(|frame| {
                let time = frame as f64 / 30.0;
                [1.0, 2.0, 3.0].map(|axis| {
                    25.0 * (time * (2.0 + 0.3 * axis) + seed * joint as f64 + axis).sin()
                })
            })
            .collect(),
        is_mixed: false,
    });
    std::iter::once(walk).chain(turns).collect()
}

fn take(name: &str, tracks: Vec<Track>) -> Take {
    Take { name: name.into(), layers: vec![tracks] }
}

/// A downloaded character: a namespace in front of names, centimetres, pre-rotations, a skin that
/// was bound in another pose than the nodes have, one take with the name of the site.
pub(crate) fn namespaced() -> File {
    let mut nodes = body("mixamorig:", 0, 0.01);
    for (index, node) in nodes.iter_mut().enumerate() {
        let turn = index as f64 * 7.0;
        node.more.push(("PreRotation", [turn, -0.5 * turn, 20.0 - turn]));
        node.turn = [3.0, 4.0, 5.0];
    }
    let at = |place: [f64; 3]| DMat4::from_translation(DVec3::from_array(place));
    let skin = Skin {
        vertices: vec![
            [-10.0, 90.0, 0.0],
            [10.0, 90.0, 0.0],
            [10.0, 120.0, 0.0],
            [-10.0, 120.0, 0.0],
            [0.0, 160.0, 0.0],
        ],
        faces: vec![vec![0, 1, 2, 3], vec![3, 2, 4]],
        clusters: vec![
            (0, at([0.0, 95.0, 0.0]), vec![0, 1]),
            (1, at([0.0, 120.0, 2.0]), vec![2, 3]),
            (2, at([0.0, 155.0, 2.0]), vec![4]),
        ],
        paint: None,
    };
    File {
        nodes,
        takes: vec![take("mixamo.com", motion(0, 20, 1.2, 0.01, 0.7))],
        skin: Some(skin),
        fps: 30.0,
        unit: 1.0,
        z_up: false,
    }
}

/// Captured motion: several takes at 120 frames per second, a moving node above the hips.
pub(crate) fn several_takes() -> File {
    let reference =
        Node { name: "Reference".into(), kind: "Null", place: [5.0, 0.0, -3.0], ..Node::default() };
    let nodes = std::iter::once(reference).chain(body("", 1, 0.01)).collect();
    let travel = |frames: i32, speed: f64| Track {
        node: 0,
        property: "Lcl Translation",
        values: (0..frames).map(|frame| [5.0 + speed * f64::from(frame), 0.0, -3.0]).collect(),
        is_mixed: false,
    };
    let mut walk = motion(1, 24, 1.0, 0.01, 0.4);
    walk.push(travel(24, 0.0));
    let mut run = motion(1, 30, 3.0, 0.01, 0.2);
    run.push(travel(30, 1.0));
    File {
        nodes,
        takes: vec![take("Walk", walk), take("Run", run)],
        skin: None,
        fps: 120.0,
        unit: 1.0,
        z_up: false,
    }
}

/// A game engine's skeleton: Z up, a bone on the ground that lies on its back.
pub(crate) fn z_up() -> File {
    let root = Node {
        name: "root".into(),
        kind: "LimbNode",
        more: vec![("PreRotation", [90.0, 0.0, 0.0])],
        ..Node::default()
    };
    // Without a second child, Blender lets the hips start where the root ends, and never move.
    let aside = Node {
        name: "ik_foot_root".into(),
        kind: "LimbNode",
        parent: Some(0),
        place: [30.0, 0.0, 0.0],
        ..Node::default()
    };
    let nodes = std::iter::once(root).chain(body("", 1, 0.01)).chain([aside]).collect();
    File {
        nodes,
        takes: vec![take("Jog", motion(1, 16, 2.0, 0.01, 1.1))],
        skin: None,
        fps: 30.0,
        unit: 1.0,
        z_up: true,
    }
}

/// A rig of an animation program: metres below a scaled group, pivots, offsets, rotations before
/// and after, and other orders of rotation.
pub(crate) fn pivots() -> File {
    let group = Node {
        name: "rig".into(),
        kind: "Null",
        place: [10.0, 0.0, 20.0],
        turn: [0.0, 30.0, 0.0],
        scale: Some([100.0; 3]),
        ..Node::default()
    };
    let mut nodes: Vec<Node> = std::iter::once(group).chain(body("", 1, 1.0)).collect();
    for (index, node) in nodes.iter_mut().enumerate().skip(1) {
        let size = 0.02 * index as f64;
        node.order = (index % 6) as i32;
        node.more = vec![
            ("PreRotation", [10.0, 20.0, -15.0 + index as f64]),
            ("PostRotation", [5.0, -8.0, 12.0]),
            ("RotationPivot", [size, 0.03, -0.01]),
            ("RotationOffset", [0.0, size, 0.01]),
            ("ScalingPivot", [0.01, size, 0.0]),
            ("ScalingOffset", [0.0, 0.0, 0.5 * size]),
        ];
    }
    File {
        nodes,
        takes: vec![take("Take 001", motion(1, 12, 1.0, 1.0, 0.3))],
        skin: None,
        fps: 24.0,
        unit: 1.0,
        z_up: false,
    }
}

/// All of them, by name.
pub(crate) fn all() -> [(&'static str, File); 4] {
    [
        ("namespaced", namespaced()),
        ("several_takes", several_takes()),
        ("z_up", z_up()),
        ("pivots", pivots()),
    ]
}

/// Three joints with a skin and two frames, small enough to be changed byte by byte.
pub(crate) fn tiny() -> File {
    let mut file = namespaced();
    file.nodes.truncate(3);
    for track in file.takes.iter_mut().flat_map(|take| &mut take.layers).flatten() {
        track.values.truncate(2);
    }
    file.takes[0].layers[0].retain(|track| track.node < 3);
    file
}

/// Two takes of two layers with keys of all kinds, of different numbers, and with some that have
/// the same value everywhere: so long that a part of them may be read. The scale of one joint
/// changes in the middle of a take, and children of it do not inherit it.
pub(crate) fn long() -> File {
    let mut file = several_takes();
    let frames = [900, 700];
    for (take, frames) in file.takes.iter_mut().zip(frames) {
        let mut tracks = motion(1, frames, 1.0, 0.01, 0.4);
        for (place, track) in tracks.iter_mut().enumerate() {
            track.is_mixed = place % 3 != 0;
            // Some begin or end in the middle of the take.
            track.values.truncate(frames - 40 * place);
        }
        let level = |node: usize, is_mixed: bool| Track {
            node,
            property: "Lcl Translation",
            values: vec![[1.0, 2.0, 3.0]; frames],
            is_mixed,
        };
        tracks.extend([level(5, false), level(6, true)]);
        let growth =
            (0..frames).map(|frame| if frame / 100 == 4 { [1.0, 1.2, 0.9] } else { [1.0; 3] });
        let growth =
            Track { node: 4, property: "Lcl Scaling", values: growth.collect(), is_mixed: false };
        tracks.push(growth);
        let added = motion(1, frames, 0.0, 0.01, 1.3).into_iter().skip(3).step_by(4).collect();
        take.layers = vec![tracks, added];
    }
    file
}
