//! The bodies of the SMPL family: names and parents of their joints, and a body of our own for
//! files that have none.
//!
//! SMPL (Loper et al., "SMPL: A Skinned Multi-Person Linear Model", 2015) has 24 joints, SMPL-H
//! (Romero et al., "Embodied Hands", 2017) 52 and SMPL-X (Pavlakos et al., "Expressive Body
//! Capture", 2019) 55. All three begin with the same 22 joints; at rest the body stands in a T-pose
//! with Y up, faces +Z and has its left on +X.

use glam::Vec3;
use segue_motion::skeleton::Joint;

/// The number of joints that all bodies share.
pub(super) const BODY_JOINTS: usize = 22;

/// Names, parents and offsets of the shared joints, metres: round figures of our own for a body of
/// about 1.7 m whose pelvis stands at 0.93 m.
const BODY: [(&str, usize, [f32; 3]); BODY_JOINTS] = [
    ("pelvis", 0, [0.0, -0.22, 0.03]),
    ("left_hip", 0, [0.06, -0.09, -0.01]),
    ("right_hip", 0, [-0.06, -0.09, -0.01]),
    ("spine1", 0, [0.0, 0.11, -0.02]),
    ("left_knee", 1, [0.04, -0.38, 0.0]),
    ("right_knee", 2, [-0.04, -0.38, 0.0]),
    ("spine2", 3, [0.0, 0.13, 0.0]),
    ("left_ankle", 4, [-0.01, -0.4, -0.04]),
    ("right_ankle", 5, [0.01, -0.4, -0.04]),
    ("spine3", 6, [0.0, 0.06, 0.02]),
    ("left_foot", 7, [0.03, -0.06, 0.12]),
    ("right_foot", 8, [-0.03, -0.06, 0.12]),
    ("neck", 9, [0.0, 0.21, -0.04]),
    ("left_collar", 9, [0.07, 0.12, -0.02]),
    ("right_collar", 9, [-0.07, 0.12, -0.02]),
    ("head", 12, [0.0, 0.09, 0.05]),
    ("left_shoulder", 13, [0.12, 0.04, -0.02]),
    ("right_shoulder", 14, [-0.12, 0.04, -0.02]),
    ("left_elbow", 16, [0.26, 0.0, -0.02]),
    ("right_elbow", 17, [-0.26, 0.0, -0.02]),
    ("left_wrist", 18, [0.25, 0.0, 0.0]),
    ("right_wrist", 19, [-0.25, 0.0, 0.0]),
];

/// The fingers of a left hand in the order of their joints, with the offsets of the three, metres.
const FINGERS: [(&str, [[f32; 3]; 3]); 5] = [
    ("index", [[0.1, 0.0, 0.02], [0.03, 0.0, 0.0], [0.02, 0.0, 0.0]]),
    ("middle", [[0.11, 0.0, 0.0], [0.03, 0.0, 0.0], [0.02, 0.0, 0.0]]),
    ("pinky", [[0.08, 0.0, -0.04], [0.02, 0.0, 0.0], [0.02, 0.0, 0.0]]),
    ("ring", [[0.1, 0.0, -0.02], [0.03, 0.0, 0.0], [0.02, 0.0, 0.0]]),
    ("thumb", [[0.03, -0.01, 0.03], [0.03, -0.01, 0.02], [0.03, 0.0, 0.01]]),
];

/// The joints of the face of SMPL-X.
const FACE: [(&str, [f32; 3]); 3] = [
    ("jaw", [0.0, 0.0, 0.02]),
    ("left_eye_smplhf", [0.03, 0.07, 0.08]),
    ("right_eye_smplhf", [-0.03, 0.07, 0.08]),
];

/// The ends of the bones that no joint ends, metres.
const ENDS: [(&str, [f32; 3]); 5] = [
    ("left_foot", [0.0, -0.02, 0.07]),
    ("right_foot", [0.0, -0.02, 0.07]),
    ("head", [0.0, 0.18, 0.0]),
    ("left_hand", [0.1, 0.0, 0.0]),
    ("right_hand", [-0.1, 0.0, 0.0]),
];

/// Returns whether a body of the family has this number of joints: 22 (the shared ones), 24, 52 or
/// 55.
pub(super) const fn is_known(joints: usize) -> bool {
    matches!(joints, BODY_JOINTS | 24 | 52 | 55)
}

/// Returns the joints of a generic body, with the pelvis at its standing height over the origin of
/// the model; for an unknown `count` only the joints that all bodies of the family share.
pub(super) fn joints(count: usize) -> Vec<Joint> {
    let mut joints: Vec<Joint> = Vec::with_capacity(count);
    let mut add = |name: String, parent: Option<usize>, offset: [f32; 3]| {
        let end = ENDS.iter().find(|(own, _)| *own == name);
        let end_site = end.map(|(_, end)| Vec3::from_array(*end));
        let offset = Vec3::from_array(offset);
        joints.push(Joint { name, parent, offset, end_site, channels: Vec::new() });
    };
    for (index, (name, parent, offset)) in BODY.into_iter().enumerate() {
        add(name.to_owned(), (index > 0).then_some(parent), offset);
    }
    if count == 24 {
        add("left_hand".into(), Some(20), [0.08, 0.0, 0.0]);
        add("right_hand".into(), Some(21), [-0.08, 0.0, 0.0]);
    }
    if count == 55 {
        for (name, offset) in FACE {
            add(name.to_owned(), Some(15), offset);
        }
    }
    if count == 52 || count == 55 {
        let mut next = count - 30;
        for (side, wrist, sign) in [("left", 20, 1.0), ("right", 21, -1.0)] {
            for (finger, offsets) in FINGERS {
                for (i, [x, y, z]) in offsets.into_iter().enumerate() {
                    let parent = if i == 0 { wrist } else { next - 1 };
                    add(format!("{side}_{finger}{}", i + 1), Some(parent), [sign * x, y, z]);
                    next += 1;
                }
            }
        }
    }
    if count == BODY_JOINTS {
        for (wrist, x) in [(20, 0.18), (21, -0.18)] {
            if let Some(joint) = joints.get_mut(wrist) {
                joint.end_site = Some(Vec3::new(x, 0.0, 0.0));
            }
        }
    }
    joints
}

#[cfg(test)]
mod tests {
    use super::*;
    use segue_motion::skeleton::{Role, Roles, Side, Skeleton};

    #[test]
    fn joints_of_every_body_are_a_symmetric_skeleton_with_all_roles() {
        for count in [22, 24, 52, 55] {
            let skeleton = Skeleton::new(joints(count)).unwrap();
            assert_eq!(skeleton.len(), count);
            let places = skeleton.rest_positions();
            for (left, joint) in skeleton.joints().iter().enumerate() {
                let Some(name) = joint.name.strip_prefix("left") else { continue };
                let right = skeleton.find(&format!("right{name}")).unwrap();
                let mirrored = places[left] * Vec3::new(-1.0, 1.0, 1.0);
                assert!(mirrored.distance(places[right]) < 1e-6, "{name}");
            }
            let roles = Roles::by_name(&skeleton);
            let named = |role| roles.get(role).map(|joint| skeleton.joints()[joint].name.as_str());
            assert_eq!(named(Role::Hips), Some("pelvis"));
            assert_eq!(named(Role::thigh(Side::Left)), Some("left_hip"));
            assert_eq!(named(Role::foot(Side::Left)), Some("left_ankle"));
            assert_eq!(named(Role::LeftToe), Some("left_foot"));
            assert_eq!(named(Role::upper_arm(Side::Right)), Some("right_shoulder"));
            assert_eq!(named(Role::hand(Side::Right)), Some("right_wrist"));
        }
        assert!(is_known(55) && !is_known(23));
    }
}
