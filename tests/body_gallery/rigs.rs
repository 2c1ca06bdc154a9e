//! Skeletons by the positions of their joints: animals, and rigs with joints that disturb.

use glam::{Quat, Vec3};
use segue_motion::clip::Clip;
use segue_motion::skeleton::{Joint, Pose, Skeleton, fixtures};
use std::sync::Arc;

/// Name, name of the parent, position of the joint on the left side or in the middle; `*` stands
/// for either side.
type Row = (&'static str, &'static str, [f32; 3]);

/// Builds a skeleton from rows; those with `|` at the end of their name are end sites.
fn built(sides: [&str; 2], rows: &[Row]) -> Skeleton {
    let mut joints: Vec<Joint> = Vec::new();
    let mut places: Vec<Vec3> = Vec::new();
    for &(name, parent, at) in rows {
        let both = if name.contains('*') { 2 } else { 1 };
        for (side, mirror) in sides.iter().zip([1.0, -1.0]).take(both) {
            let parent = parent.replace('*', side);
            let above = joints.iter().position(|joint| joint.name == parent);
            let place = Vec3::from(at) * Vec3::new(mirror, 1.0, 1.0);
            let offset = above.map_or(place, |above| place - places[above]);
            if let (true, Some(above)) = (name.ends_with('|'), above) {
                joints[above].end_site = Some(offset);
                continue;
            }
            joints.push(Joint {
                name: name.replace('*', side),
                parent: above,
                offset,
                end_site: None,
                channels: vec![],
            });
            places.push(place);
        }
    }
    Skeleton::new(joints).unwrap()
}

/// Returns a dog with the names of a human, as in captures of dogs.
fn wolf() -> Skeleton {
    built(
        ["Left", "Right"],
        &[
            ("Hips", "", [0.0, 0.62, -0.35]),
            ("Spine", "Hips", [0.0, 0.64, -0.1]),
            ("Spine1", "Spine", [0.0, 0.66, 0.15]),
            ("Neck", "Spine1", [0.0, 0.72, 0.36]),
            ("Head", "Neck", [0.0, 0.88, 0.52]),
            ("Head|", "Head", [0.0, 0.84, 0.74]),
            ("*Shoulder", "Spine1", [0.05, 0.68, 0.28]),
            ("*Arm", "*Shoulder", [0.08, 0.52, 0.36]),
            ("*ForeArm", "*Arm", [0.09, 0.36, 0.24]),
            ("*Hand", "*ForeArm", [0.09, 0.08, 0.28]),
            ("*Hand|", "*Hand", [0.09, 0.02, 0.36]),
            ("*UpLeg", "Hips", [0.08, 0.58, -0.36]),
            ("*Leg", "*UpLeg", [0.09, 0.34, -0.24]),
            ("*Foot", "*Leg", [0.09, 0.13, -0.44]),
            ("*Foot|", "*Foot", [0.09, 0.02, -0.36]),
            ("Tail", "Hips", [0.0, 0.64, -0.45]),
            ("Tail1", "Tail", [0.0, 0.56, -0.68]),
            ("Tail1|", "Tail1", [0.0, 0.46, -0.9]),
        ],
    )
}

/// Returns a horse: a long neck, a tail, five joints in each leg.
fn horse() -> Skeleton {
    built(
        ["l", "r"],
        &[
            ("pelvis", "", [0.0, 1.35, -0.55]),
            ("spine_01", "pelvis", [0.0, 1.38, -0.25]),
            ("spine_02", "spine_01", [0.0, 1.36, 0.05]),
            ("spine_03", "spine_02", [0.0, 1.38, 0.35]),
            ("neck_01", "spine_03", [0.0, 1.42, 0.6]),
            ("neck_02", "neck_01", [0.0, 1.6, 0.78]),
            ("neck_03", "neck_02", [0.0, 1.8, 0.92]),
            ("skull", "neck_03", [0.0, 1.95, 1.02]),
            ("jaw", "skull", [0.0, 1.86, 1.06]),
            ("jaw|", "jaw", [0.0, 1.62, 1.3]),
            ("skull|", "skull", [0.0, 1.68, 1.34]),
            ("ear_*", "skull", [0.06, 2.05, 1.0]),
            ("ear_*|", "ear_*", [0.08, 2.15, 1.0]),
            ("scapula_*", "spine_03", [0.1, 1.38, 0.42]),
            ("humerus_*", "scapula_*", [0.16, 1.05, 0.62]),
            ("radius_*", "humerus_*", [0.17, 0.9, 0.45]),
            ("cannon_*", "radius_*", [0.17, 0.48, 0.48]),
            ("pastern_*", "cannon_*", [0.17, 0.18, 0.47]),
            ("hoof_*", "pastern_*", [0.17, 0.06, 0.53]),
            ("hoof_*|", "hoof_*", [0.17, 0.0, 0.58]),
            ("femur_*", "pelvis", [0.15, 1.2, -0.6]),
            ("stifle_*", "femur_*", [0.17, 0.95, -0.42]),
            ("hock_*", "stifle_*", [0.17, 0.58, -0.72]),
            ("fetlock_*", "hock_*", [0.17, 0.2, -0.66]),
            ("toe_*", "fetlock_*", [0.17, 0.06, -0.6]),
            ("toe_*|", "toe_*", [0.17, 0.0, -0.55]),
            ("tail_01", "pelvis", [0.0, 1.4, -0.8]),
            ("tail_02", "tail_01", [0.0, 1.2, -0.98]),
            ("tail_03", "tail_02", [0.0, 0.95, -1.05]),
            ("tail_03|", "tail_03", [0.0, 0.6, -1.08]),
        ],
    )
}

/// Returns a spider: eight legs of four bones, jaws, and an abdomen.
fn spider() -> Skeleton {
    let point = |name: String, parent: Option<usize>, offset: Vec3, end_site: Option<Vec3>| Joint {
        name,
        parent,
        offset,
        end_site,
        channels: vec![],
    };
    let mut joints = vec![
        point("body".into(), None, Vec3::new(0.0, 0.35, 0.0), None),
        point("abdomen".into(), Some(0), Vec3::new(0.0, 0.05, -0.15), Some(Vec3::Z * -0.5)),
        point("head".into(), Some(0), Vec3::Z * 0.15, Some(Vec3::new(0.0, -0.02, 0.12))),
    ];
    for leg in 0..8 {
        let (side, name) = if leg < 4 { (1.0, "L") } else { (-1.0, "R") };
        let angle = 0.75 - 0.5 * (leg % 4) as f32;
        let out = Vec3::new(side * angle.cos(), 0.0, angle.sin());
        let mut parent = 0;
        for (part, (reach, rise)) in
            [(0.12, 0.0), (0.12, 0.12), (0.3, 0.25), (0.3, -0.35)].into_iter().enumerate()
        {
            let end = (part == 3).then(|| out * 0.18 + Vec3::Y * -0.35);
            let offset = out * reach + Vec3::Y * rise;
            joints.push(point(format!("leg_{name}{}_{part}", leg % 4), Some(parent), offset, end));
            parent = joints.len() - 1;
        }
    }
    Skeleton::new(joints).unwrap()
}

/// Returns a chain of joints, as of a rope or a tail.
fn rope() -> Skeleton {
    let joints = (0..14).map(|index: usize| Joint {
        name: format!("rope{index}"),
        parent: index.checked_sub(1),
        offset: if index == 0 { Vec3::Y } else { Vec3::new(0.1, 0.02, 0.0) },
        end_site: (index == 13).then_some(Vec3::X * 0.1),
        channels: vec![],
    });
    Skeleton::new(joints.collect()).unwrap()
}

/// Returns a person of average build with the rows of arms and legs that are given.
fn person(spine: &[Row], arms: &[Row], legs: &[Row]) -> Skeleton {
    built(["Left", "Right"], &[spine, arms, legs].concat())
}

const SPINE: [Row; 6] = [
    ("Hips", "", [0.0, 0.98, 0.0]),
    ("Spine", "Hips", [0.0, 1.08, -0.01]),
    ("Spine1", "Spine", [0.0, 1.25, -0.01]),
    ("Neck", "Spine1", [0.0, 1.5, -0.01]),
    ("Head", "Neck", [0.0, 1.58, 0.02]),
    ("Head|", "Head", [0.0, 1.78, 0.03]),
];
const ARMS: [Row; 5] = [
    ("*Shoulder", "Spine1", [0.03, 1.44, 0.0]),
    ("*Arm", "*Shoulder", [0.18, 1.45, 0.0]),
    ("*ForeArm", "*Arm", [0.46, 1.45, -0.01]),
    ("*Hand", "*ForeArm", [0.72, 1.45, 0.0]),
    ("*Hand|", "*Hand", [0.88, 1.44, 0.0]),
];
const LEGS: [Row; 5] = [
    ("*UpLeg", "Hips", [0.095, 0.92, 0.0]),
    ("*Leg", "*UpLeg", [0.1, 0.5, 0.01]),
    ("*Foot", "*Leg", [0.1, 0.09, -0.02]),
    ("*Toe", "*Foot", [0.11, 0.02, 0.12]),
    ("*Toe|", "*Toe", [0.11, 0.015, 0.19]),
];

/// Returns rigs of persons with joints that disturb.
fn odd_persons() -> Vec<(&'static str, Skeleton)> {
    let rolls = person(
        &SPINE,
        &[
            ("*Shoulder", "Spine1", [0.03, 1.44, 0.0]),
            ("*Arm", "*Shoulder", [0.18, 1.45, 0.0]),
            ("*ArmRoll", "*Arm", [0.32, 1.45, -0.005]),
            ("*ForeArm", "*ArmRoll", [0.46, 1.45, -0.01]),
            ("*ForeArmRoll", "*ForeArm", [0.59, 1.45, -0.005]),
            ("*Hand", "*ForeArmRoll", [0.72, 1.45, 0.0]),
            ("*ElbowHelper", "*ArmRoll", [0.46, 1.45, -0.06]),
        ],
        &[
            ("*UpLeg", "Hips", [0.095, 0.92, 0.0]),
            ("*UpLegRoll", "*UpLeg", [0.097, 0.7, 0.0]),
            ("*Leg", "*UpLegRoll", [0.1, 0.5, 0.01]),
            ("*LegRoll", "*Leg", [0.1, 0.3, 0.0]),
            ("*Foot", "*LegRoll", [0.1, 0.09, -0.02]),
            ("*Toe", "*Foot", [0.11, 0.02, 0.12]),
            ("*KneeHelper", "*UpLegRoll", [0.1, 0.5, 0.07]),
            ("*Gluteus", "Hips", [0.09, 0.9, -0.12]),
        ],
    );
    let spine = person(
        &[
            ("Hips", "", [0.0, 0.98, 0.0]),
            ("Spine", "Hips", [0.0, 1.04, -0.01]),
            ("Spine1", "Spine", [0.0, 1.1, -0.015]),
            ("Spine2", "Spine1", [0.0, 1.16, -0.02]),
            ("Spine3", "Spine2", [0.0, 1.22, -0.025]),
            ("Spine4", "Spine3", [0.0, 1.28, -0.03]),
            ("Spine5", "Spine4", [0.0, 1.34, -0.03]),
            ("Spine6", "Spine5", [0.0, 1.4, -0.025]),
            ("Neck", "Spine6", [0.0, 1.48, -0.01]),
            ("Neck1", "Neck", [0.0, 1.52, 0.0]),
            ("Neck2", "Neck1", [0.0, 1.56, 0.01]),
            ("Head", "Neck2", [0.0, 1.6, 0.02]),
        ],
        &[
            ("*Shoulder", "Spine6", [0.03, 1.44, 0.0]),
            ("*Arm", "*Shoulder", [0.18, 1.45, 0.0]),
            ("*ForeArm", "*Arm", [0.46, 1.45, -0.01]),
            ("*Hand", "*ForeArm", [0.72, 1.45, 0.0]),
        ],
        &LEGS,
    );
    let low_hips = person(
        &[
            ("Hips", "", [0.0, 0.82, 0.0]),
            ("Spine", "Hips", [0.0, 1.08, -0.01]),
            ("Spine1", "Spine", [0.0, 1.25, -0.01]),
            ("Neck", "Spine1", [0.0, 1.5, -0.01]),
            ("Head", "Neck", [0.0, 1.58, 0.02]),
        ],
        &ARMS,
        &LEGS,
    );
    // A skeleton of key points: no collar bones, toes or ends, the neck at the height of the arms.
    let bare = person(
        &[
            ("Hips", "", [0.0, 0.94, 0.0]),
            ("Spine", "Hips", [0.0, 1.2, 0.0]),
            ("Neck", "Spine", [0.0, 1.45, 0.0]),
            ("Head", "Neck", [0.0, 1.6, 0.05]),
        ],
        &[
            ("*Arm", "Neck", [0.17, 1.43, 0.0]),
            ("*ForeArm", "*Arm", [0.45, 1.43, 0.0]),
            ("*Hand", "*ForeArm", [0.7, 1.43, 0.0]),
        ],
        &[
            ("*UpLeg", "Hips", [0.13, 0.92, 0.0]),
            ("*Leg", "*UpLeg", [0.12, 0.5, 0.0]),
            ("*Foot", "*Leg", [0.11, 0.08, 0.0]),
        ],
    );
    // A child, or a figure of a comic: short legs, a large head, wide shoulders.
    let child = person(
        &[
            ("Hips", "", [0.0, 0.5, 0.0]),
            ("Spine", "Hips", [0.0, 0.57, 0.0]),
            ("Spine1", "Spine", [0.0, 0.68, 0.0]),
            ("Neck", "Spine1", [0.0, 0.86, 0.0]),
            ("Head", "Neck", [0.0, 0.92, 0.01]),
            ("Head|", "Head", [0.0, 1.16, 0.02]),
        ],
        &[
            ("*Shoulder", "Spine1", [0.02, 0.82, 0.0]),
            ("*Arm", "*Shoulder", [0.15, 0.82, 0.0]),
            ("*ForeArm", "*Arm", [0.3, 0.82, 0.0]),
            ("*Hand", "*ForeArm", [0.44, 0.82, 0.0]),
        ],
        &[
            ("*UpLeg", "Hips", [0.07, 0.46, 0.0]),
            ("*Leg", "*UpLeg", [0.07, 0.25, 0.01]),
            ("*Foot", "*Leg", [0.07, 0.06, 0.0]),
            ("*Toe", "*Foot", [0.08, 0.02, 0.08]),
        ],
    );
    let headless = person(
        &SPINE[..3],
        &[("*Arm", "Spine1", [0.18, 1.45, 0.0]), ("*ForeArm", "*Arm", [0.46, 1.45, 0.0])],
        &LEGS,
    );
    vec![
        ("rolls", rolls),
        ("long_spine", spine),
        ("low_hips", low_hips),
        ("bare", bare),
        ("child", child),
        ("headless", headless),
    ]
}

/// Returns all rigs of persons.
pub(crate) fn persons() -> Vec<(String, Arc<Skeleton>)> {
    let common =
        fixtures::all().into_iter().map(|(name, skeleton, _)| (name.replace(' ', "_"), skeleton));
    let odd = odd_persons().into_iter().map(|(name, rig)| (name.to_owned(), Arc::new(rig)));
    common.chain(odd).collect()
}

/// Returns animals, and trees that are no bodies.
pub(crate) fn creatures() -> Vec<(&'static str, Skeleton)> {
    let point = Joint {
        name: "point".into(),
        parent: None,
        offset: Vec3::Y,
        end_site: None,
        channels: vec![],
    };
    vec![
        ("wolf", wolf()),
        ("horse", horse()),
        ("spider", spider()),
        ("rope", rope()),
        ("point", Skeleton::new(vec![point]).unwrap()),
    ]
}

/// Returns a four-legged skeleton standing still, with joint axes rotated by constants, so that its
/// rest pose is meaningless.
pub(crate) fn dog() -> Clip {
    let bones: [(&str, Option<usize>, [f32; 3]); 16] = [
        ("Pelvis", None, [0.0, 0.6, -0.3]),
        ("Spine", Some(0), [0.0, 0.03, 0.25]),
        ("Chest", Some(1), [0.0, 0.0, 0.3]),
        ("Neck", Some(2), [0.0, 0.08, 0.12]),
        ("Head", Some(3), [0.0, 0.15, 0.12]),
        ("Snout", Some(4), [0.0, -0.02, 0.18]),
        ("Tail", Some(0), [0.0, 0.05, -0.2]),
        ("Tip", Some(6), [0.0, 0.1, -0.2]),
        ("HindLeftA", Some(0), [0.1, -0.05, 0.0]),
        ("HindLeftB", Some(8), [0.0, -0.27, 0.05]),
        ("HindLeftC", Some(9), [0.0, -0.25, -0.08]),
        ("HindRightA", Some(0), [-0.1, -0.05, 0.0]),
        ("HindRightB", Some(11), [0.0, -0.27, 0.05]),
        ("ForeLeftA", Some(2), [0.1, -0.1, 0.0]),
        ("ForeLeftB", Some(13), [0.0, -0.45, 0.0]),
        ("ForeRightA", Some(2), [-0.1, -0.1, 0.0]),
    ];
    let turn = |joint: usize| Quat::from_axis_angle(Vec3::new(0.6, 0.0, 0.8), 1.3 * joint as f32);
    let joints = bones.iter().map(|&(name, parent, offset)| Joint {
        name: name.into(),
        parent,
        offset: parent.map_or(Quat::IDENTITY, turn).conjugate() * Vec3::from(offset),
        end_site: None,
        channels: vec![],
    });
    let skeleton = Skeleton::new(joints.collect()).unwrap();
    let pose = |sway: f32| Pose {
        root_translation: Vec3::new(0.0, 0.6, 0.0),
        rotations: (0..skeleton.len())
            .map(|joint| {
                skeleton.parent(joint).map_or(Quat::from_rotation_y(sway), turn).conjugate()
                    * turn(joint)
            })
            .collect(),
        translations: vec![],
    };
    let poses = vec![pose(0.0), pose(0.1), pose(0.0)];
    Clip::from_poses("dog", Arc::new(skeleton.clone()), 30.0, poses).unwrap()
}
