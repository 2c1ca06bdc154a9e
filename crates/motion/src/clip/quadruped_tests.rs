//! Tests of bodies on four legs: that they are recognised, where they face, and their contacts.

use super::fixtures::{QuadrupedWalk, quadruped, wander_by};
use super::*;
use crate::math::{Planar, quat, wrap_angle};
use crate::skeleton::{
    BodyPlan, Foot, Pose, Role, Roles, Side, WorldPose, fixtures, rest_is_plausible, world_pose,
};
use crate::synth::{Action, Params, synthesize};
use glam::{Quat, Vec3};
use proptest::prelude::*;
use std::f32::consts::FRAC_PI_2;
use std::sync::Arc;

/// The axes along which bones lie in files, and none.
const AXES: [Option<Vec3>; 3] = [None, Some(Vec3::X), Some(Vec3::Y)];

fn walk(axis: Option<Vec3>, yaw: f64) -> (QuadrupedWalk, Motion) {
    let made = QuadrupedWalk { yaw, axis, ..QuadrupedWalk::default() };
    (made, Motion::analyze(made.clip()))
}

/// Returns the stances of a foot that begin and end within the walk.
fn true_stances(made: &QuadrupedWalk, foot: Foot) -> Vec<std::ops::Range<usize>> {
    let flags = Contacts::from_flags(
        [0, 1].map(|_| (0..made.frames).map(|frame| made.is_planted(foot, frame)).collect()),
    );
    let inner = |stance: &std::ops::Range<usize>| stance.start > 0 && stance.end < made.frames;
    flags.intervals(Side::Left).into_iter().filter(inner).collect()
}

#[test]
fn body_on_four_legs_is_recognised_by_rest_or_by_motion() {
    for axis in AXES {
        let (_, motion) = walk(axis, 0.4);
        assert!(motion.roles().is_quadruped(), "{axis:?}");
        assert_eq!(motion.roles().missing().count(), 0, "{axis:?}");
        let at_rest = Roles::detect(motion.clip().skeleton());
        assert_eq!(at_rest.is_quadruped(), axis.is_none(), "{axis:?}");
    }
    // By its shape alone: the joints are those of the names.
    let (named, nameless) = (Roles::detect(&quadruped()), fixtures::nameless(&quadruped()));
    let shaped = Roles::detect(&nameless);
    assert!(shaped.is_quadruped());
    for role in Role::ALL {
        let expected = match role {
            // The name says `Shoulder`, and the shape the joint below it.
            Role::Hips | Role::Head => continue,
            _ => named.get(role),
        };
        assert_eq!(shaped.get(role), expected, "{role:?}");
    }
}

/// Returns a take of which a walk on four legs is the last fifth. Before, the trunk is raised by an
/// angle, with the legs, or without the hind legs, which then stand below it. The rest pose shows
/// nothing.
fn raised(radians: f32, stands: bool) -> Clip {
    let made = QuadrupedWalk { axis: Some(Vec3::X), ..QuadrupedWalk::default() };
    let walk = made.clip();
    let roles = Roles::by_name(walk.skeleton());
    let thighs = Side::BOTH.map(|side| roles.get(Role::thigh(side)).unwrap());
    let raise = Quat::from_rotation_x(-radians);
    let poses = (0..made.frames).map(|frame| {
        let mut rotations = walk.rotations(frame).to_vec();
        if frame < 4 * made.frames / 5 {
            rotations[0] = raise * rotations[0];
            let hips = rotations[0];
            for thigh in thighs.into_iter().filter(|_| stands) {
                rotations[thigh] = hips.conjugate() * raise.conjugate() * hips * rotations[thigh];
            }
        }
        let root_translation = walk.root_translations()[frame];
        Pose { root_translation, rotations, translations: Vec::new() }
    });
    Clip::from_poses("raised", Arc::clone(walk.skeleton()), made.fps, poses).unwrap()
}

#[test]
fn body_that_sits_for_most_of_a_take_is_a_quadruped() {
    assert!(Motion::analyze(raised(1.0, false)).roles().is_quadruped());
}

/// Such as a figure with short legs that crawls at the end.
#[test]
fn body_that_stands_on_two_legs_for_most_of_a_take_is_a_biped() {
    assert!(!Motion::analyze(raised(FRAC_PI_2, true)).roles().is_quadruped());
}

#[test]
fn bodies_of_people_are_bipeds() {
    for (name, skeleton, _) in fixtures::all() {
        assert_eq!(fixtures::roles(&skeleton).body_plan(), BodyPlan::Biped, "{name}");
    }
    for action in [Action::Walk, Action::Jump, Action::Run] {
        let motion = Motion::analyze(synthesize(&Params::new(action)).unwrap().clip);
        assert_eq!(motion.contacts().feet(), Side::BOTH.map(Foot::from));
    }
}

/// A person on hands and feet, with a rest pose that shows nothing.
#[test]
fn crawling_person_is_a_biped() {
    let skeleton = fixtures::games105();
    let roles = fixtures::roles(&skeleton);
    let mut pose = Pose {
        root_translation: Vec3::Y * 0.7,
        rotations: vec![Quat::IDENTITY; skeleton.len()],
        translations: Vec::new(),
    };
    let quarter = Quat::from_rotation_x(FRAC_PI_2);
    pose.rotations[roles.get(Role::Hips).unwrap()] = quarter;
    for side in Side::BOTH {
        pose.rotations[roles.get(Role::thigh(side)).unwrap()] = quarter.conjugate();
    }
    let level = world_pose(&skeleton, &pose);
    for side in Side::BOTH {
        let [arm, _, hand] = Role::arm(side).map(|role| roles.get(role).unwrap());
        let down = quat::between_directions(
            (level.positions[hand] - level.positions[arm]).normalize_or_zero(),
            Vec3::NEG_Y,
        );
        let above = level.rotations[skeleton.parent(arm).unwrap()];
        pose.rotations[arm] = above.conjugate() * down * above;
    }
    let (turned, frames) = fixtures::turned(&skeleton, 4);
    let poses: Vec<Pose> =
        (0..5).map(|_| fixtures::turned_pose(&skeleton, &frames, &pose)).collect();
    let clip = Clip::from_poses("crawl", turned, 30.0, poses).unwrap();
    assert_ne!(rest_is_plausible(clip.skeleton(), &roles), Some(true));
    assert!(!Motion::analyze(clip).roles().is_quadruped());
}

#[test]
fn contacts_of_four_feet_are_those_of_the_walk() {
    for axis in AXES {
        for yaw in [0.0, 2.5] {
            let (made, motion) = walk(axis, yaw);
            assert_eq!(motion.contacts().feet(), Foot::ALL);
            for foot in Foot::ALL {
                let found = motion.contacts().intervals(foot);
                for stance in true_stances(&made, foot) {
                    let is_it = |found: &&std::ops::Range<usize>| {
                        found.start.abs_diff(stance.start) <= 3
                            && found.end.abs_diff(stance.end) <= 3
                    };
                    let matching = found.iter().filter(is_it).count();
                    assert_eq!(matching, 1, "{axis:?}, {foot:?}, {stance:?}: {found:?}");
                }
                assert!(found.len() <= true_stances(&made, foot).len() + 2, "{foot:?}: {found:?}");
            }
            assert_eq!(motion.ground_m(), 0.0);
        }
    }
}

#[test]
fn body_on_four_legs_faces_from_hips_to_shoulders() {
    for axis in AXES {
        for yaw in [0.0, -1.2, 3.0] {
            let (made, motion) = walk(axis, yaw);
            for frame in motion.ground_frames() {
                assert!(wrap_angle(frame.yaw - yaw).abs() < 0.04, "{axis:?}: {}", frame.yaw);
            }
            let speed = ground_speed(motion.ground_frames(), motion.clip().fps());
            assert!((speed - made.speed_mps).abs() < 0.03, "{speed}");
        }
    }
    // On its side it still faces ahead; upright its shoulders show where.
    let (_, motion) = walk(None, 0.0);
    let turned = |turn: Quat| {
        let pose = motion.clip().world_pose(0);
        let positions = pose.positions.iter().map(|&position| turn * position).collect();
        let rotations = pose.rotations.iter().map(|&rotation| turn * rotation).collect();
        facing(&WorldPose { positions, rotations }, motion.roles()).unwrap()
    };
    for angle in [-FRAC_PI_2, 1.0, FRAC_PI_2] {
        assert!(turned(Quat::from_rotation_z(angle)).z > 0.95, "{angle}");
    }
    for angle in [-1.4, -0.8, 0.8] {
        assert!(turned(Quat::from_rotation_x(angle)).z > 0.95, "rearing by {angle}");
    }
}

#[test]
fn stance_of_a_body_on_four_legs_stands_on_them_and_faces_ahead() {
    for axis in AXES {
        let (_, motion) = walk(axis, 2.0);
        let (skeleton, roles) = (motion.clip().skeleton(), motion.roles());
        let reference = reference_pose(motion.clip(), roles);
        let stance = crate::skeleton::canonical_stance(skeleton, roles, &reference);
        let ahead = facing(&stance, roles).unwrap();
        assert!(ahead.z > 0.95, "{axis:?}: {ahead}");
        let at = |role| stance.positions[roles.get(role).unwrap()];
        for foot in Foot::ALL {
            let [first, _, last] = foot.leg();
            assert!(at(first).y - at(last).y > 0.25, "{axis:?}, {foot:?}");
        }
    }
}

#[test]
fn mirror_image_of_a_walk_on_four_legs_exchanges_the_feet() {
    for axis in AXES {
        let (_, motion) = walk(axis, 0.0);
        let image = motion.mirrored().unwrap();
        assert!(image.roles().is_quadruped(), "{axis:?}");
        for foot in Foot::ALL {
            assert_eq!(
                image.contacts().intervals(foot),
                motion.contacts().intervals(foot.mirrored())
            );
            // The joints are where the mirror image has them.
            for role in foot.leg() {
                let at = |motion: &Motion, role: Role| {
                    let joint = motion.roles().get(role).unwrap();
                    motion.clip().world_pose(50).positions[joint]
                };
                let expected = at(&motion, role.mirrored()) * Vec3::new(-1.0, 1.0, 1.0);
                let off = at(&image, role).distance(expected);
                assert!(off < 1e-3, "{axis:?}, {role:?}: {off} m");
            }
        }
    }
}

#[test]
fn contacts_of_four_feet_are_joined_corrected_and_cut_together() {
    let (_, motion) = walk(None, 0.0);
    let contacts = motion.contacts();
    let cut = contacts.of_frames(&[10, 20, 30]);
    let fore = Foot::ALL[3];
    assert_eq!(cut.planted(fore, 1), contacts.planted(fore, 20));
    let two = Contacts::from_flags([vec![true; 60], vec![false; 60]]);
    let joined = Contacts::joined(&two, contacts, 30, 40, 30);
    assert_eq!(joined.feet(), Foot::ALL);
    assert!(!joined.planted(fore, 29) && joined.planted(Side::Left, 29));
    assert_eq!(joined.planted(fore, 35), contacts.planted(fore, 45));
    let wanted = contacts.with(fore, 0..100, true);
    let corrections = ContactCorrections::between(contacts, &wanted);
    assert!(corrections.list().iter().all(|edit| edit.foot == fore && edit.planted));
    assert_eq!(motion.clone().with_contact_corrections(corrections.clone()).contacts(), &wanted);
    // A body on two legs has no such foot.
    assert_eq!(corrections.applied_to(&two), two);
    assert!(!two.planted(fore, 0));
}

#[test]
fn roles_of_a_quadruped_are_stored_with_its_plan() {
    let of_dog = Roles::detect(&quadruped());
    let json = serde_json::to_string(&of_dog).unwrap();
    assert_eq!(serde_json::from_str::<Roles>(&json).unwrap(), of_dog);
    let of_person = fixtures::roles(&fixtures::lafan());
    let json = serde_json::to_string(&of_person).unwrap();
    assert!(!json.contains("plan"), "{json}");
    assert_eq!(serde_json::from_str::<Roles>(&json).unwrap(), of_person);
    assert!(serde_json::from_str::<Roles>(r#"{"Wing":{"joint":1,"found":"ByHand"}}"#).is_err());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    /// Place and direction of a walk say nothing about its contacts.
    #[test]
    fn contacts_of_four_feet_do_not_depend_on_the_place(
        yaw in -3.0f64..3.0,
        x in -5.0f64..5.0,
        speed_mps in 0.4f32..0.6,
        along_x in any::<bool>(),
    ) {
        let axis = along_x.then_some(Vec3::X);
        let made = QuadrupedWalk { frames: 120, speed_mps, axis, ..QuadrupedWalk::default() };
        let motion = Motion::analyze(made.clip());
        let there = Planar::new(yaw, x, 1.0);
        let moved = Motion::analyze(made.clip().transformed(&there));
        for foot in Foot::ALL {
            let count = (0..made.frames).filter(|&frame| {
                motion.contacts().planted(foot, frame) != moved.contacts().planted(foot, frame)
            });
            prop_assert!(count.count() <= 2, "{:?}", foot);
        }
    }

    /// Any motion of a person stays one on two feet.
    #[test]
    fn wandering_person_is_a_biped(seed in 0u64..200) {
        let clip = wander_by(&fixtures::turned(&fixtures::lafan(), seed).0, 20, seed, 1.5);
        prop_assert!(!Motion::analyze(clip).roles().is_quadruped());
    }
}
