//! Small skeletons with the names and the build of common rigs, for tests. All share one invented body that is 1.7 m tall, faces +Z and
//! stretches its arms out.

use super::{Joint, Roles, Skeleton};
use glam::{Quat, Vec3};
use std::sync::Arc;

/// (name, place in the body, name of the parent); `*` in names stands for either side.
type Row = (&'static str, &'static str, &'static str);

/// Where the left side's joints are in the shared body.
fn place(name: &str) -> Vec3 {
    let (x, y, z) = match name {
        "ground" => (0.0, 0.0, 0.0),
        "pelvis" => (0.0, 0.95, 0.0),
        "hip" => (0.09, 0.9, 0.0),
        "knee" => (0.09, 0.49, 0.01),
        "ankle" => (0.09, 0.08, -0.02),
        "ball" => (0.1, 0.02, 0.12),
        "toe tip" => (0.1, 0.015, 0.19),
        "spine1" => (0.0, 1.05, -0.01),
        "spine2" => (0.0, 1.17, -0.01),
        "chest" => (0.0, 1.29, 0.0),
        "neck" => (0.0, 1.45, 0.0),
        "head" => (0.0, 1.53, 0.02),
        "head top" => (0.0, 1.7, 0.02),
        "collar" => (0.03, 1.4, 0.01),
        "shoulder" => (0.17, 1.41, 0.0),
        "elbow" => (0.45, 1.41, -0.01),
        "wrist" => (0.7, 1.41, 0.0),
        "knuckle" => (0.79, 1.4, 0.01),
        "finger tip" => (0.83, 1.4, 0.01),
        "thumb" => (0.75, 1.39, 0.04),
        "eye" => (0.03, 1.6, 0.09),
        _ => panic!("no such place: {name}"),
    };
    Vec3::new(x, y, z)
}

/// Builds a rig; `sides` are what `*` stands for. Leaves end where their bone would.
fn rig(sides: [&str; 2], rows: &[Row]) -> Arc<Skeleton> {
    let mut joints: Vec<(Joint, Vec3)> = Vec::new();
    for &(name, at, parent) in rows {
        // A limb that hangs on a middle joint is followed on both sides; one side after the other, as files have it.
        for (side, mirror) in sides.iter().zip([1.0, -1.0]).take(if name.contains('*') { 2 } else { 1 }) {
            let position = place(at) * Vec3::new(mirror, 1.0, 1.0);
            let parent_name = parent.replace('*', side);
            let above = joints.iter().position(|(joint, _)| joint.name == parent_name);
            assert_eq!(above.is_none(), joints.is_empty(), "{name} has no parent {parent_name}");
            let offset = above.map_or(Vec3::ZERO, |above| position - joints[above].1);
            let end = match at {
                "ball" => Some(place("toe tip") - place("ball")),
                "head" => Some(place("head top") - place("head")),
                "knuckle" | "wrist" => Some(place("finger tip") - place(at)),
                _ => None,
            };
            let end_site = end.map(|end| end * Vec3::new(mirror, 1.0, 1.0));
            joints.push((
                Joint {
                    name: name.replace('*', side),
                    parent: above,
                    offset,
                    end_site,
                    channels: vec![],
                },
                position,
            ));
        }
    }
    let parents: Vec<Option<usize>> = joints.iter().map(|(joint, _)| joint.parent).collect();
    for (index, (joint, _)) in joints.iter_mut().enumerate() {
        if parents.contains(&Some(index)) {
            joint.end_site = None;
        }
    }
    Arc::new(Skeleton::new(joints.into_iter().map(|(joint, _)| joint).collect()).unwrap())
}

const LEFT_RIGHT: [&str; 2] = ["Left", "Right"];

pub(crate) fn cmu_bvh() -> Arc<Skeleton> {
    let rows = [
        ("Hips", "pelvis", ""),
        ("LHipJoint", "pelvis", "Hips"),
        ("RHipJoint", "pelvis", "Hips"),
        ("LeftUpLeg", "hip", "LHipJoint"),
        ("LowerBack", "pelvis", "Hips"),
        ("Spine", "spine1", "LowerBack"),
        ("Spine1", "chest", "Spine"),
        ("*Shoulder", "chest", "Spine1"),
        ("*Arm", "shoulder", "*Shoulder"),
        ("*ForeArm", "elbow", "*Arm"),
        ("*Hand", "wrist", "*ForeArm"),
        ("*FingerBase", "wrist", "*Hand"),
        ("*HandIndex1", "knuckle", "*FingerBase"),
        ("*Thumb", "wrist", "*Hand"),
        ("Neck", "chest", "Spine1"),
        ("Neck1", "neck", "Neck"),
        ("Head", "head", "Neck1"),
    ];
    // The two hip joints have other prefixes than the legs below them.
    let mut joints = rig(LEFT_RIGHT, &rows).joints().to_vec();
    let right_hip = Joint {
        name: "RightUpLeg".into(),
        parent: Some(2),
        offset: joints[3].offset * Vec3::new(-1.0, 1.0, 1.0),
        ..joints[3].clone()
    };
    joints.push(right_hip);
    for side in LEFT_RIGHT {
        let mirror = if side == "Left" { 1.0 } else { -1.0 };
        let mut above = joints.iter().position(|j| j.name == format!("{side}UpLeg"));
        for (name, at, before) in [("Leg", "knee", "hip"), ("Foot", "ankle", "knee"), ("ToeBase", "ball", "ankle")] {
            let offset = (place(at) - place(before)) * Vec3::new(mirror, 1.0, 1.0);
            let end_site = (name == "ToeBase").then(|| place("toe tip") - place("ball"));
            joints.push(Joint {
                name: format!("{side}{name}"),
                parent: above,
                offset,
                end_site,
                channels: vec![],
            });
            above = Some(joints.len() - 1);
        }
    }
    Arc::new(Skeleton::new(joints).unwrap())
}

pub(crate) fn cmu_asf() -> Arc<Skeleton> {
    rig(
        ["l", "r"],
        &[
            ("root", "pelvis", ""),
            ("*hipjoint", "pelvis", "root"),
            ("*femur", "hip", "*hipjoint"),
            ("*tibia", "knee", "*femur"),
            ("*foot", "ankle", "*tibia"),
            ("*toes", "ball", "*foot"),
            ("lowerback", "pelvis", "root"),
            ("upperback", "spine1", "lowerback"),
            ("thorax", "spine2", "upperback"),
            ("lowerneck", "chest", "thorax"),
            ("upperneck", "neck", "lowerneck"),
            ("head", "head", "upperneck"),
            ("*clavicle", "chest", "thorax"),
            ("*humerus", "shoulder", "*clavicle"),
            ("*radius", "elbow", "*humerus"),
            ("*wrist", "wrist", "*radius"),
            ("*hand", "knuckle", "*wrist"),
            ("*thumb", "wrist", "*wrist"),
        ],
    )
}

pub(crate) fn mixamo() -> Arc<Skeleton> {
    rig(
        LEFT_RIGHT,
        &[
            ("mixamorig:Hips", "pelvis", ""),
            ("mixamorig:Spine", "spine1", "mixamorig:Hips"),
            ("mixamorig:Spine1", "spine2", "mixamorig:Spine"),
            ("mixamorig:Spine2", "chest", "mixamorig:Spine1"),
            ("mixamorig:Neck", "neck", "mixamorig:Spine2"),
            ("mixamorig:Head", "head", "mixamorig:Neck"),
            ("mixamorig:HeadTop_End", "head top", "mixamorig:Head"),
            ("mixamorig:*Shoulder", "collar", "mixamorig:Spine2"),
            ("mixamorig:*Arm", "shoulder", "mixamorig:*Shoulder"),
            ("mixamorig:*ForeArm", "elbow", "mixamorig:*Arm"),
            ("mixamorig:*Hand", "wrist", "mixamorig:*ForeArm"),
            ("mixamorig:*HandThumb1", "thumb", "mixamorig:*Hand"),
            ("mixamorig:*HandIndex1", "knuckle", "mixamorig:*Hand"),
            ("mixamorig:*HandIndex2", "finger tip", "mixamorig:*HandIndex1"),
            ("mixamorig:*UpLeg", "hip", "mixamorig:Hips"),
            ("mixamorig:*Leg", "knee", "mixamorig:*UpLeg"),
            ("mixamorig:*Foot", "ankle", "mixamorig:*Leg"),
            ("mixamorig:*ToeBase", "ball", "mixamorig:*Foot"),
            ("mixamorig:*Toe_End", "toe tip", "mixamorig:*ToeBase"),
        ],
    )
}

pub(crate) fn lafan() -> Arc<Skeleton> {
    rig(
        LEFT_RIGHT,
        &[
            ("Hips", "pelvis", ""),
            ("*UpLeg", "hip", "Hips"),
            ("*Leg", "knee", "*UpLeg"),
            ("*Foot", "ankle", "*Leg"),
            ("*Toe", "ball", "*Foot"),
            ("Spine", "spine1", "Hips"),
            ("Spine1", "spine2", "Spine"),
            ("Spine2", "chest", "Spine1"),
            ("Neck", "neck", "Spine2"),
            ("Head", "head", "Neck"),
            ("*Shoulder", "collar", "Spine2"),
            ("*Arm", "shoulder", "*Shoulder"),
            ("*ForeArm", "elbow", "*Arm"),
            ("*Hand", "wrist", "*ForeArm"),
        ],
    )
}

pub(crate) fn bandai() -> Arc<Skeleton> {
    rig(
        ["L", "R"],
        &[
            ("joint_Root", "ground", ""),
            ("Hips", "pelvis", "joint_Root"),
            ("Spine", "spine1", "Hips"),
            ("Chest", "chest", "Spine"),
            ("Neck", "neck", "Chest"),
            ("Head", "head", "Neck"),
            ("Shoulder_*", "collar", "Chest"),
            ("UpperArm_*", "shoulder", "Shoulder_*"),
            ("LowerArm_*", "elbow", "UpperArm_*"),
            ("Hand_*", "wrist", "LowerArm_*"),
            ("UpperLeg_*", "hip", "Hips"),
            ("LowerLeg_*", "knee", "UpperLeg_*"),
            ("Foot_*", "ankle", "LowerLeg_*"),
            ("Toes_*", "ball", "Foot_*"),
        ],
    )
}

pub(crate) fn biped() -> Arc<Skeleton> {
    rig(
        ["L", "R"],
        &[
            ("Bip01", "pelvis", ""),
            ("Bip01 Pelvis", "pelvis", "Bip01"),
            ("Bip01 Spine", "spine1", "Bip01 Pelvis"),
            ("Bip01 Spine1", "chest", "Bip01 Spine"),
            ("Bip01 Neck", "neck", "Bip01 Spine1"),
            ("Bip01 Head", "head", "Bip01 Neck"),
            ("Bip01 HeadNub", "head top", "Bip01 Head"),
            ("Bip01 * Clavicle", "collar", "Bip01 Neck"),
            ("Bip01 * UpperArm", "shoulder", "Bip01 * Clavicle"),
            ("Bip01 * Forearm", "elbow", "Bip01 * UpperArm"),
            ("Bip01 * Hand", "wrist", "Bip01 * Forearm"),
            ("Bip01 * Finger0", "thumb", "Bip01 * Hand"),
            ("Bip01 * Finger01", "knuckle", "Bip01 * Finger0"),
            // The thighs of this rig hang on the back.
            ("Bip01 * Thigh", "hip", "Bip01 Spine"),
            ("Bip01 * Calf", "knee", "Bip01 * Thigh"),
            ("Bip01 * Foot", "ankle", "Bip01 * Calf"),
            ("Bip01 * Toe0", "ball", "Bip01 * Foot"),
            ("Bip01 * Toe0Nub", "toe tip", "Bip01 * Toe0"),
        ],
    )
}

pub(crate) fn games105() -> Arc<Skeleton> {
    rig(
        ["l", "r"],
        &[
            ("RootJoint", "pelvis", ""),
            ("*Hip", "hip", "RootJoint"),
            ("*Knee", "knee", "*Hip"),
            ("*Ankle", "ankle", "*Knee"),
            ("*ToeJoint", "ball", "*Ankle"),
            ("*ToeJoint_end", "toe tip", "*ToeJoint"),
            ("pelvis_lowerback", "spine1", "RootJoint"),
            ("lowerback_torso", "chest", "pelvis_lowerback"),
            ("torso_head", "neck", "lowerback_torso"),
            ("torso_head_end", "head top", "torso_head"),
            ("*Torso_Clavicle", "collar", "lowerback_torso"),
            ("*Shoulder", "shoulder", "*Torso_Clavicle"),
            ("*Elbow", "elbow", "*Shoulder"),
            ("*Wrist", "wrist", "*Elbow"),
        ],
    )
}

pub(crate) fn smpl() -> Arc<Skeleton> {
    rig(
        ["L", "R"],
        &[
            ("Pelvis", "pelvis", ""),
            ("*_Hip", "hip", "Pelvis"),
            ("*_Knee", "knee", "*_Hip"),
            ("*_Ankle", "ankle", "*_Knee"),
            ("*_Foot", "ball", "*_Ankle"),
            ("Spine1", "spine1", "Pelvis"),
            ("Spine2", "spine2", "Spine1"),
            ("Spine3", "chest", "Spine2"),
            ("Neck", "neck", "Spine3"),
            ("Head", "head", "Neck"),
            ("*_Collar", "collar", "Spine3"),
            ("*_Shoulder", "shoulder", "*_Collar"),
            ("*_Elbow", "elbow", "*_Shoulder"),
            ("*_Wrist", "wrist", "*_Elbow"),
            ("*_Hand", "knuckle", "*_Wrist"),
        ],
    )
}

pub(crate) fn xsens() -> Arc<Skeleton> {
    rig(
        LEFT_RIGHT,
        &[
            ("Pelvis", "pelvis", ""),
            ("L5", "spine1", "Pelvis"),
            ("T12", "spine2", "L5"),
            ("T8", "chest", "T12"),
            ("Neck", "neck", "T8"),
            ("Head", "head", "Neck"),
            ("*Shoulder", "collar", "T8"),
            ("*UpperArm", "shoulder", "*Shoulder"),
            ("*ForeArm", "elbow", "*UpperArm"),
            ("*Hand", "wrist", "*ForeArm"),
            ("*UpperLeg", "hip", "Pelvis"),
            ("*LowerLeg", "knee", "*UpperLeg"),
            ("*Foot", "ankle", "*LowerLeg"),
            ("*Toe", "ball", "*Foot"),
        ],
    )
}

pub(crate) fn optitrack() -> Arc<Skeleton> {
    rig(
        ["L", "R"],
        &[
            ("Hip", "pelvis", ""),
            ("Ab", "spine1", "Hip"),
            ("Chest", "chest", "Ab"),
            ("Neck", "neck", "Chest"),
            ("Head", "head", "Neck"),
            ("*Shoulder", "collar", "Chest"),
            ("*UArm", "shoulder", "*Shoulder"),
            ("*FArm", "elbow", "*UArm"),
            ("*Hand", "wrist", "*FArm"),
            ("*Thigh", "hip", "Hip"),
            ("*Shin", "knee", "*Thigh"),
            ("*Foot", "ankle", "*Shin"),
            ("*Toe", "ball", "*Foot"),
        ],
    )
}

pub(crate) fn unreal() -> Arc<Skeleton> {
    rig(
        ["l", "r"],
        &[
            ("root", "ground", ""),
            ("pelvis", "pelvis", "root"),
            ("spine_01", "spine1", "pelvis"),
            ("spine_02", "spine2", "spine_01"),
            ("spine_03", "chest", "spine_02"),
            ("neck_01", "neck", "spine_03"),
            ("head", "head", "neck_01"),
            ("eye_*", "eye", "head"),
            ("clavicle_*", "collar", "spine_03"),
            ("upperarm_*", "shoulder", "clavicle_*"),
            ("upperarm_twist_01_*", "elbow", "upperarm_*"),
            ("lowerarm_*", "elbow", "upperarm_*"),
            ("hand_*", "wrist", "lowerarm_*"),
            ("index_01_*", "knuckle", "hand_*"),
            ("thigh_*", "hip", "pelvis"),
            ("calf_*", "knee", "thigh_*"),
            ("calf_twist_01_*", "ankle", "calf_*"),
            ("foot_*", "ankle", "calf_*"),
            ("ball_*", "ball", "foot_*"),
            ("ik_foot_root", "ground", "root"),
            ("ik_foot_*", "ankle", "ik_foot_root"),
        ],
    )
}

/// Every rig, with the names that its 17 roles must go to, in the order of `Role::ALL`, left before right.
pub(crate) fn all() -> Vec<(&'static str, Arc<Skeleton>, [&'static str; 17])> {
    /// Hips, spine, head, then thigh to toe and upper arm to hand with `*` for the side.
    type Wanted = [&'static str; 10];
    fn with(sides: [&'static str; 2], w: Wanted) -> [&'static str; 17] {
        let on = |i: usize, side: usize| -> &'static str { w[i].replace('*', sides[side]).leak() };
        let mut all = [w[0], w[1], w[2], "", "", "", "", "", "", "", "", "", "", "", "", "", ""];
        for side in 0..2 {
            (0..4).for_each(|i| all[3 + 4 * side + i] = on(3 + i, side));
            (0..3).for_each(|i| all[11 + 3 * side + i] = on(7 + i, side));
        }
        all
    }
    let lr = LEFT_RIGHT;
    let upper = ["L", "R"];
    let lower = ["l", "r"];
    let mixamo_names = [
        "Hips", "Spine", "Head", "*UpLeg", "*Leg", "*Foot", "*ToeBase", "*Arm", "*ForeArm", "*Hand",
    ];
    let mixamo_names = mixamo_names.map(|name| -> &'static str { format!("mixamorig:{name}").leak() });
    let biped_names = [
        "Pelvis",
        "Spine",
        "Head",
        "* Thigh",
        "* Calf",
        "* Foot",
        "* Toe0",
        "* UpperArm",
        "* Forearm",
        "* Hand",
    ];
    let biped_names = biped_names.map(|name| -> &'static str { format!("Bip01 {name}").leak() });
    vec![
        (
            "cmu bvh",
            cmu_bvh(),
            with(
                lr,
                [
                    "Hips",
                    "LowerBack",
                    "Head",
                    "*UpLeg",
                    "*Leg",
                    "*Foot",
                    "*ToeBase",
                    "*Arm",
                    "*ForeArm",
                    "*Hand",
                ],
            ),
        ),
        (
            "cmu asf",
            cmu_asf(),
            with(
                lower,
                [
                    "root",
                    "lowerback",
                    "head",
                    "*femur",
                    "*tibia",
                    "*foot",
                    "*toes",
                    "*humerus",
                    "*radius",
                    "*wrist",
                ],
            ),
        ),
        ("mixamo", mixamo(), with(lr, mixamo_names)),
        (
            "lafan",
            lafan(),
            with(
                lr,
                [
                    "Hips", "Spine", "Head", "*UpLeg", "*Leg", "*Foot", "*Toe", "*Arm", "*ForeArm", "*Hand",
                ],
            ),
        ),
        (
            "bandai",
            bandai(),
            with(
                upper,
                [
                    "Hips",
                    "Spine",
                    "Head",
                    "UpperLeg_*",
                    "LowerLeg_*",
                    "Foot_*",
                    "Toes_*",
                    "UpperArm_*",
                    "LowerArm_*",
                    "Hand_*",
                ],
            ),
        ),
        ("biped", biped(), with(upper, biped_names)),
        (
            "games105",
            games105(),
            with(
                lower,
                [
                    "RootJoint",
                    "pelvis_lowerback",
                    "torso_head",
                    "*Hip",
                    "*Knee",
                    "*Ankle",
                    "*ToeJoint",
                    "*Shoulder",
                    "*Elbow",
                    "*Wrist",
                ],
            ),
        ),
        (
            "smpl",
            smpl(),
            with(
                upper,
                [
                    "Pelvis",
                    "Spine1",
                    "Head",
                    "*_Hip",
                    "*_Knee",
                    "*_Ankle",
                    "*_Foot",
                    "*_Shoulder",
                    "*_Elbow",
                    "*_Wrist",
                ],
            ),
        ),
        (
            "xsens",
            xsens(),
            with(
                lr,
                [
                    "Pelvis",
                    "L5",
                    "Head",
                    "*UpperLeg",
                    "*LowerLeg",
                    "*Foot",
                    "*Toe",
                    "*UpperArm",
                    "*ForeArm",
                    "*Hand",
                ],
            ),
        ),
        (
            "optitrack",
            optitrack(),
            with(
                upper,
                ["Hip", "Ab", "Head", "*Thigh", "*Shin", "*Foot", "*Toe", "*UArm", "*FArm", "*Hand"],
            ),
        ),
        (
            "unreal",
            unreal(),
            with(
                lower,
                [
                    "pelvis",
                    "spine_01",
                    "head",
                    "thigh_*",
                    "calf_*",
                    "foot_*",
                    "ball_*",
                    "upperarm_*",
                    "lowerarm_*",
                    "hand_*",
                ],
            ),
        ),
    ]
}

/// Numbers in `-1..1` that look random; the same for the same seed.
pub(crate) fn noise(seed: u64) -> impl FnMut() -> f32 {
    let mut state = seed.wrapping_mul(2).wrapping_add(1);
    move || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        ((state >> 40) as f32) / ((1u64 << 23) as f32) - 1.0
    }
}

/// The skeleton with its joints in another order that still has parents first, and for every new index the old one.
pub(crate) fn shuffled(skeleton: &Skeleton, seed: u64) -> (Arc<Skeleton>, Vec<usize>) {
    let mut next = noise(seed);
    let (mut order, mut open) = (Vec::new(), vec![0]);
    while !open.is_empty() {
        let joint = open.swap_remove((next().abs() * open.len() as f32) as usize % open.len());
        order.push(joint);
        open.extend(skeleton.children(joint));
    }
    let new_index = |old: usize| order.iter().position(|&o| o == old);
    let joints = order.iter().map(|&old| {
        let joint = &skeleton.joints()[old];
        Joint {
            parent: joint.parent.and_then(new_index),
            ..joint.clone()
        }
    });
    (Arc::new(Skeleton::new(joints.collect()).unwrap()), order)
}

/// The skeleton with names that say nothing.
pub(crate) fn nameless(skeleton: &Skeleton) -> Arc<Skeleton> {
    let joints = skeleton.joints().iter().enumerate().map(|(i, joint)| Joint {
        name: format!("j{i}"),
        ..joint.clone()
    });
    Arc::new(Skeleton::new(joints.collect()).unwrap())
}

/// The skeleton at another size, with every offset turned by up to about `radians` and stretched by up to `stretch`.
pub(crate) fn uneven(skeleton: &Skeleton, scale: f32, radians: f32, stretch: f32, seed: u64) -> Arc<Skeleton> {
    let mut next = noise(seed);
    let joints = skeleton.joints().iter().map(|joint| {
        let turn = Quat::from_scaled_axis(Vec3::new(next(), next(), next()) * radians);
        let offset = turn * joint.offset * scale * (1.0 + stretch * next());
        Joint {
            offset,
            end_site: joint.end_site.map(|end| turn * end * scale),
            ..joint.clone()
        }
    });
    Arc::new(Skeleton::new(joints.collect()).unwrap())
}

/// The roles of a rig, all of which must be there.
pub(crate) fn roles(skeleton: &Skeleton) -> Roles {
    let roles = Roles::detect(skeleton);
    assert_eq!(roles.missing().collect::<Vec<_>>(), []);
    roles
}
