//! Skeletons that files do not name: those of Kimodo ("Skeletons" in its documentation), by the
//! number of their joints.

use super::body;

/// The name and the parent of a joint.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct RigJoint {
    pub(super) name: String,
    pub(super) parent: Option<usize>,
}

/// Trunk and head of SOMA, with the names of the parents.
const TRUNK: [(&str, &str); 11] = [
    ("Hips", ""),
    ("Spine1", "Hips"),
    ("Spine2", "Spine1"),
    ("Chest", "Spine2"),
    ("Neck1", "Chest"),
    ("Neck2", "Neck1"),
    ("Head", "Neck2"),
    ("HeadEnd", "Head"),
    ("Jaw", "Head"),
    ("LeftEye", "Head"),
    ("RightEye", "Head"),
];
const ARM: [(&str, &str); 4] =
    [("Shoulder", "Chest"), ("Arm", "Shoulder"), ("ForeArm", "Arm"), ("Hand", "ForeArm")];
const LEG: [(&str, &str); 5] = [
    ("Leg", "Hips"),
    ("Shin", "Leg"),
    ("Foot", "Shin"),
    ("ToeBase", "Foot"),
    ("ToeEnd", "ToeBase"),
];
const FINGERS: [(&str, usize); 5] =
    [("Thumb", 3), ("Index", 4), ("Middle", 4), ("Ring", 4), ("Pinky", 4)];

/// The chains of the Unitree G1, each below the joint before.
const G1_LEG: [&str; 7] = [
    "hip_pitch_skel",
    "hip_roll_skel",
    "hip_yaw_skel",
    "knee_skel",
    "ankle_pitch_skel",
    "ankle_roll_skel",
    "toe_base",
];
const G1_WAIST: [&str; 3] = ["waist_yaw_skel", "waist_roll_skel", "waist_pitch_skel"];
const G1_ARM: [&str; 8] = [
    "shoulder_pitch_skel",
    "shoulder_roll_skel",
    "shoulder_yaw_skel",
    "elbow_skel",
    "wrist_roll_skel",
    "wrist_pitch_skel",
    "wrist_yaw_skel",
    "hand_roll_skel",
];

/// Returns the skeleton of 22 (SMPL-X without face and hands), 30 or 77 (SOMA), or 34 joints
/// (Unitree G1).
pub(super) fn of(count: usize) -> Option<Vec<RigJoint>> {
    match count {
        body::BODY_JOINTS => {
            let joints = body::joints(count).into_iter();
            Some(joints.map(|own| RigJoint { name: own.name, parent: own.parent }).collect())
        }
        30 => Some(soma(false)),
        77 => Some(soma(true)),
        34 => Some(g1()),
        _ => None,
    }
}

/// Collects joints, whose parents are found by name.
#[derive(Default)]
struct Rig {
    joints: Vec<RigJoint>,
}

impl Rig {
    fn add(&mut self, name: String, parent: &str) {
        let parent = self.joints.iter().position(|joint| joint.name == parent);
        self.joints.push(RigJoint { name, parent });
    }
}

/// Returns SOMA with all of its joints, or without fingers and ends.
fn soma(whole: bool) -> Vec<RigJoint> {
    let mut rig = Rig::default();
    for (name, parent) in TRUNK {
        if whole || name != "HeadEnd" {
            rig.add(name.to_owned(), parent);
        }
    }
    let below = |side: &str, parent: &str| match parent {
        "Chest" | "Hips" => parent.to_owned(),
        _ => format!("{side}{parent}"),
    };
    for side in ["Left", "Right"] {
        for (name, parent) in ARM {
            rig.add(format!("{side}{name}"), &below(side, parent));
        }
        let hand = format!("{side}Hand");
        for (finger, bones) in FINGERS {
            if whole {
                let mut above = hand.clone();
                let numbers = (1..=bones).map(|number| number.to_string());
                for number in numbers.chain(["End".to_owned()]) {
                    let name = format!("{hand}{finger}{number}");
                    rig.add(name.clone(), &above);
                    above = name;
                }
            } else if matches!(finger, "Thumb" | "Middle") {
                rig.add(format!("{hand}{finger}End"), &hand);
            }
        }
    }
    for side in ["Left", "Right"] {
        for (name, parent) in LEG {
            if whole || name != "ToeEnd" {
                rig.add(format!("{side}{name}"), &below(side, parent));
            }
        }
    }
    rig.joints
}

fn g1() -> Vec<RigJoint> {
    let mut rig = Rig::default();
    let pelvis = "pelvis_skel";
    rig.add(pelvis.to_owned(), "");
    let mut chain = |names: &[&str], prefix: &str, start: &str| {
        let mut above = start.to_owned();
        for name in names {
            let name = format!("{prefix}{name}");
            rig.add(name.clone(), &above);
            above = name;
        }
    };
    chain(&G1_LEG, "left_", pelvis);
    chain(&G1_LEG, "right_", pelvis);
    chain(&G1_WAIST, "", pelvis);
    chain(&G1_ARM, "left_", "waist_pitch_skel");
    chain(&G1_ARM, "right_", "waist_pitch_skel");
    rig.joints
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rigs_have_their_numbers_of_joints_and_one_root() {
        for count in [22, 30, 34, 77] {
            let rig = of(count).unwrap();
            assert_eq!(rig.len(), count);
            for (index, joint) in rig.iter().enumerate() {
                assert!(joint.parent.map_or(index == 0, |parent| parent < index), "{}", joint.name);
            }
        }
        let soma = of(77).unwrap();
        let parent = |name: &str| {
            let joint = soma.iter().find(|joint| joint.name == name).unwrap();
            soma[joint.parent.unwrap()].name.as_str()
        };
        assert_eq!(parent("LeftHandPinkyEnd"), "LeftHandPinky4");
        assert_eq!(parent("RightHandThumb1"), "RightHand");
        assert_eq!(parent("LeftLeg"), "Hips");
        assert_eq!(parent("RightShoulder"), "Chest");
        assert_eq!(of(23), None);
    }
}
