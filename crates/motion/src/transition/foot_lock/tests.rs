//! Tests of the foot lock.

use super::*;
use crate::clip::fixtures::{QuadrupedWalk, wander_by};
use crate::clip::{ContactOptions, Motion, stillest_step};
use crate::math::quat;
use crate::math::{Planar, wrap_angle};
use crate::metrics::foot_slides;
use crate::registration::fixtures::Walk;
use crate::skeleton::{FootPair, Joint, Role, Skeleton, fixtures};
use crate::synth::{Action, Params, synthesize};
use crate::transition::limb::LimbPose;
use proptest::prelude::*;
use std::sync::Arc;

/// Returns a walk whose feet slide: its root is too fast for its steps.
fn sliding(speed: f32) -> (Clip, Roles) {
    let walk = Walk { frames: 240, speed, cadence: 0.9, ..Walk::default() };
    let clip = walk.clip();
    let roles = Roles::detect(clip.skeleton());
    (clip, roles)
}

/// Returns contacts of feet that move backwards relative to the hips.
fn contacts_moving_backwards(clip: &Clip, roles: &Roles) -> Contacts {
    let planted = |side| {
        let foot = roles.get(Role::foot(side)).unwrap();
        let ahead: Vec<f32> = (0..clip.frames())
            .map(|frame| clip.world_pose(frame))
            .map(|w| w.positions[foot].z - w.positions[0].z)
            .collect();
        (0..clip.frames()).map(|frame| frame > 0 && ahead[frame] < ahead[frame - 1]).collect()
    };
    Contacts::from_flags(Side::BOTH.map(planted))
}

/// Returns the greatest step of a planted foot's stillest point, metres.
fn worst_step(clip: &Clip, roles: &Roles, contacts: &Contacts) -> f32 {
    let mut worst = 0.0_f32;
    for side in Side::BOTH {
        let points = roles.foot_points(clip.skeleton(), side);
        let way: Vec<Vec<Vec3>> = (0..clip.frames())
            .map(|frame| clip.world_pose(frame))
            .map(|world| points.iter().map(|&(joint, point)| world.point(joint, point)).collect())
            .collect();
        for stance in contacts.intervals(side) {
            for frame in stance.skip(1) {
                worst = worst.max(stillest_step(&way[frame - 1], &way[frame]).unwrap().length());
            }
        }
    }
    worst
}

/// Returns the same motion on a body with a twist joint in the middle of every thigh and shin,
/// which is rotated a little.
fn with_helpers(clip: &Clip, roles: &Roles) -> (Clip, Roles) {
    let old = clip.skeleton();
    let (mut joints, mut places): (Vec<Joint>, Vec<usize>) = (vec![], vec![]);
    for (index, joint) in old.joints().iter().enumerate() {
        let mut joint = joint.clone();
        let parent = joint.parent.map(|parent| places[parent]);
        joint.parent = parent;
        if Side::BOTH.iter().any(|&side| {
            [Role::shin(side), Role::foot(side)]
                .contains(&roles.role_of(index).unwrap_or(Role::Head))
        }) {
            let half = joint.offset * 0.5;
            joints.push(Joint {
                name: format!("{} twist", joint.name),
                parent,
                offset: half,
                end_site: None,
                channels: vec![],
            });
            joint.parent = Some(joints.len() - 1);
            joint.offset = half;
        }
        places.push(joints.len());
        joints.push(joint);
    }
    let skeleton = Arc::new(Skeleton::new(joints).unwrap());
    let poses = (0..clip.frames()).map(|frame| {
        let mut pose = clip.pose(frame);
        let turned = Quat::from_rotation_x(0.05 * (frame as f32 * 0.1).sin());
        let mut rotations = vec![turned; skeleton.len()];
        for (&place, rotation) in places.iter().zip(&pose.rotations) {
            rotations[place] = *rotation;
        }
        pose.rotations = rotations;
        pose
    });
    let clip = Clip::from_poses("helpers", Arc::clone(&skeleton), clip.fps(), poses).unwrap();
    let mut there = Roles::default();
    for role in Role::ALL {
        there.set(role, roles.get(role).map(|joint| places[joint]));
    }
    (clip, there)
}

#[test]
fn foot_lock_holds_planted_feet_and_keeps_their_rotation() {
    for speed in [0.9, 1.3, 1.6] {
        let (clip, roles) = sliding(speed);
        for (clip, roles) in [with_helpers(&clip, &roles), (clip, roles)] {
            let contacts = contacts_moving_backwards(&clip, &roles);
            let far = FootLockOptions { max_shift_m: 1.0, ..FootLockOptions::default() };
            let locked = foot_lock(&clip, &roles, &contacts, &far).unwrap();
            let (before, after) =
                (worst_step(&clip, &roles, &contacts), worst_step(&locked, &roles, &contacts));
            assert!(before > 5e-3 && after < 2e-4, "{speed}: {before} {after}");
            for frame in 0..clip.frames() {
                let (was, is) = (clip.world_pose(frame), locked.world_pose(frame));
                for side in Side::BOTH {
                    let foot = roles.get(Role::foot(side)).unwrap();
                    assert!(
                        quat::angle_between(was.rotations[foot], is.rotations[foot]) < 2e-3,
                        "{frame}"
                    );
                }
                // Only the legs and the height of the body change.
                let head = roles.get(Role::Head).unwrap();
                let moved = is.positions[head] - was.positions[head];
                assert!(
                    moved.x.abs() + moved.z.abs() < 1e-5 && moved.y.abs() < 0.15,
                    "{frame} {moved}"
                );
            }
        }
    }
}

/// Returns the path length of a foot's toe joint while it is planted, metres.
fn toe_path_length(clip: &Clip, roles: &Roles, contacts: &Contacts) -> f32 {
    let mut farthest = 0.0_f32;
    for side in Side::BOTH {
        let toe = roles.get(Role::toe(side)).unwrap();
        for stance in contacts.intervals(side) {
            let places: Vec<Vec3> =
                stance.map(|frame| clip.world_pose(frame).positions[toe]).collect();
            farthest =
                places.iter().map(|place| place.distance(places[0])).fold(farthest, f32::max);
        }
    }
    farthest
}

#[test]
fn foot_lock_with_body_yaws_keeps_the_heading_of_planted_feet() {
    let standing = synthesize(&Params::new(Action::Idle)).unwrap().clip;
    let roles = Roles::detect(standing.skeleton());
    let (frames, joints) = (standing.frames(), standing.skeleton().len());
    let contacts = Contacts::from_flags([vec![true; frames], vec![true; frames]]);
    let turned_by = |most: f64| -> (Arc<Clip>, Vec<f64>) {
        // Yaws may jump by whole turns.
        let yaws: Vec<f64> = (0..frames)
            .map(|frame| wrap_angle(3.1 + most * (frame as f64 / frames as f64 * 6.0).sin()))
            .collect();
        let turns: Vec<Planar> = yaws.iter().map(|&yaw| Planar::new(yaw, 0.0, 0.0)).collect();
        let mut rotations: Vec<Quat> =
            (0..frames).flat_map(|frame| standing.rotations(frame)).copied().collect();
        for (root, turn) in rotations.iter_mut().step_by(joints).zip(&turns) {
            *root = turn.rotation() * *root;
        }
        let roots =
            turns.iter().zip(standing.root_translations()).map(|(turn, &root)| turn.apply(root));
        let clip = Clip::new(
            "turned",
            standing.skeleton().clone(),
            standing.fps(),
            rotations,
            roots.collect(),
        );
        (Arc::new(clip.unwrap()), yaws)
    };
    let options = FootLockOptions::default();
    let locking =
        |clip: &Arc<Clip>| FootLocking::new(Arc::clone(clip), &roles, &contacts, &options).unwrap();

    let (clip, yaws) = turned_by(0.15);
    let before = toe_path_length(&locking(&clip).finish().unwrap(), &roles, &contacts);
    let after =
        toe_path_length(&locking(&clip).with_body_yaws(&yaws).finish().unwrap(), &roles, &contacts);
    assert!(before > 0.01 && after < 2e-3, "{before} {after} m");

    // The rotation of an ankle is limited: beyond 30° the foot turns with the body.
    let (clip, yaws) = turned_by(1.5);
    let (with_it, held) =
        (locking(&clip).finish().unwrap(), locking(&clip).with_body_yaws(&yaws).finish().unwrap());
    let foot = roles.get(Role::foot(Side::Left)).unwrap();
    let wrung = (0..frames).map(|frame| {
        quat::angle_between(
            with_it.world_pose(frame).rotations[foot],
            held.world_pose(frame).rotations[foot],
        )
    });
    let most = wrung.fold(0.0, f32::max);
    assert!(most > 0.45 && most < 0.53, "{most}");
}

#[test]
fn foot_lock_without_contacts_changes_nothing() {
    for (rig, skeleton, _) in fixtures::all() {
        let clip = wander_by(&skeleton, 30, 3, 0.4);
        let roles = fixtures::roles(&skeleton);
        let none = Contacts::from_flags([vec![false; 30], vec![false; 30]]);
        assert_eq!(foot_lock(&clip, &roles, &none, &FootLockOptions::default()), Ok(clip), "{rig}");
    }
}

#[test]
fn foot_lock_leaves_distant_frames_unchanged() {
    let (clip, roles) = sliding(1.5);
    let mut flags = vec![false; clip.frames()];
    flags[100..130].fill(true);
    let contacts = Contacts::from_flags([flags, vec![false; clip.frames()]]);
    let locked = foot_lock(&clip, &roles, &contacts, &FootLockOptions::default()).unwrap();
    // The margin covers blending, and the smoothing of the hips around it.
    let margin = (0.5 * clip.fps()) as usize;
    for frame in (0..100 - margin).chain(130 + margin..clip.frames()) {
        assert_eq!(locked.pose(frame), clip.pose(frame), "{frame}");
    }
    assert_ne!(locked.pose(101), clip.pose(101));
}

#[test]
fn foot_lock_raises_swinging_feet() {
    let clip = synthesize(&Params::new(Action::Walk)).unwrap().clip;
    let roles = Roles::detect(clip.skeleton());
    let contacts = Contacts::detect(&clip, &roles, &ContactOptions::default());
    let toe = roles.get(Role::LeftToe).unwrap();
    let path = |clip: &Clip| {
        (0..clip.frames()).map(|frame| clip.world_pose(frame).positions[toe]).collect::<Vec<_>>()
    };
    let locked = |clearance_m| {
        let options = FootLockOptions { clearance_m, ..FootLockOptions::default() };
        path(&foot_lock(&clip, &roles, &contacts, &options).unwrap())
    };
    let (as_it_is, high) = (locked(None), locked(Some(0.12)));
    let stances = contacts.intervals(Side::Left);
    let standing: Vec<f32> =
        stances.iter().cloned().flatten().map(|frame| as_it_is[frame].y).collect();
    let level = crate::math::stats::percentile(&standing, 0.5).unwrap();
    let mut lowest = [f32::INFINITY; 2];
    for pair in stances.windows(2) {
        // Well inside the swing.
        for frame in pair[0].end + 10..pair[1].start - 10 {
            for (lowest, path) in lowest.iter_mut().zip([&as_it_is, &high]) {
                *lowest = lowest.min(path[frame].y - level);
            }
        }
        for frame in pair[0].clone() {
            assert!(as_it_is[frame].distance(high[frame]) < 1e-4, "{frame}");
        }
    }
    assert!(lowest[0] < 0.09 && lowest[1] > 0.11, "{lowest:?}");
}

/// A correction need not decay before the end of a clip: the leg would snap.
#[test]
fn foot_lock_near_the_end_of_a_clip_does_not_snap() {
    let (clip, roles) = sliding(1.6);
    let contacts = contacts_moving_backwards(&clip, &roles);
    let stance =
        contacts.intervals(Side::Left).into_iter().find(|stance| stance.start > 60).unwrap();
    let end = stance.end + 3;
    let short = clip.crop(0..end).unwrap();
    let flags =
        Side::BOTH.map(|side| (0..end).map(|frame| contacts.planted(side, frame)).collect());
    let locked =
        foot_lock(&short, &roles, &Contacts::from_flags(flags), &FootLockOptions::default())
            .unwrap();
    let foot = roles.get(Role::LeftFoot).unwrap();
    let moved = |frame: usize| {
        (locked.world_pose(frame).positions[foot] - short.world_pose(frame).positions[foot])
            * Vec3::new(1.0, 0.0, 1.0)
    };
    let (last, gone) = (moved(stance.end - 1), moved(end - 1));
    assert!(last.length() > 0.03 && gone.length() > 0.6 * last.length(), "{last} {gone}");
}

#[test]
fn foot_lock_lifts_feet_out_of_the_ground() {
    let (clip, roles) = sliding(1.2);
    let lowest = |clip: &Clip, frame: usize, side| {
        let world = clip.world_pose(frame);
        let points = roles.foot_points(clip.skeleton(), side);
        points
            .iter()
            .map(|&(joint, point)| world.point(joint, point).y)
            .fold(f32::INFINITY, f32::min)
    };
    let contacts = Contacts::detect(&clip, &roles, &ContactOptions::default());
    let all = || {
        Side::BOTH.into_iter().flat_map(|side| {
            contacts.intervals(side).into_iter().flatten().map(move |frame| (frame, side))
        })
    };
    let ground =
        all().map(|(frame, side)| lowest(&clip, frame, side)).fold(f32::INFINITY, f32::min) + 0.02;
    let lock = |ground_m| {
        let options = FootLockOptions { ground_m, ..FootLockOptions::default() };
        foot_lock(&clip, &roles, &contacts, &options).unwrap()
    };
    let (lifted, left) = (lock(Some(ground)), lock(None));
    for (frame, side) in all() {
        assert!(lowest(&lifted, frame, side) >= ground - 1e-4, "{frame}");
        assert!((lowest(&left, frame, side) - lowest(&clip, frame, side)).abs() < 1e-3, "{frame}");
    }
    assert!(all().any(|(frame, side)| lowest(&clip, frame, side) < ground - 0.015));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// A leg reaches its target, or stops before it is stretched; without a shift it stays the
    /// same.
    #[test]
    fn move_ankle_reaches_its_target_or_stops(
        flexion in -0.1f32..1.8,
        tilt in -0.6f32..0.6,
        x in -0.4f32..0.4,
        y in -0.5f32..0.3,
        z in -0.4f32..0.4,
        turn in -3.0f32..3.0,
    ) {
        let world = Quat::from_rotation_y(turn) * Quat::from_rotation_x(tilt);
        let leg = LimbPose {
            thigh: world * Vec3::NEG_Y * 0.43,
            shin: world * Quat::from_rotation_x(flexion) * Vec3::NEG_Y * 0.42,
            rotations: [world; 3],
            parents: [world; 3],
        };
        let [a, b] = leg.turned(Vec3::ZERO, Vec3::X);
        prop_assert!(quat::log(a).length() < 1e-3 && quat::log(b).length() < 1e-3);
        let shift = Vec3::new(x, y, z);
        let [a, b] = leg.turned(shift, Vec3::X);
        let (reached, asked) = (a * leg.thigh + b * leg.shin, leg.line() + shift);
        // A knee that is bent the wrong way is bent to the right side in the process.
        let tolerance = if flexion < 0.05 { 2e-2 } else { 1e-4 };
        if asked.length() < leg.reach() {
            prop_assume!(asked.length() > 0.15);
            prop_assert!(reached.distance(asked) < tolerance, "{reached} {asked}");
        } else {
            prop_assert!(reached.normalize_or_zero().distance(asked.normalize_or_zero()) < 1e-2);
            prop_assert!(reached.length() <= leg.reach() + 1e-4);
        }
        // The knee never bends to the other side.
        let hinge = a * world * Vec3::X;
        prop_assert!((a * leg.thigh).cross(b * leg.shin).dot(hinge) > -0.03);
    }
}

/// Captured knees of straight legs are bent the wrong way by some degrees; a shortened leg bends
/// them the right way all the same.
#[test]
fn foot_lock_never_flips_knees() {
    let mut before: Option<f32> = None;
    for step in 0..=40 {
        let flexion = 0.1 - 0.005 * step as f32;
        let leg = LimbPose {
            thigh: Vec3::NEG_Y * 0.43,
            shin: Quat::from_rotation_x(flexion) * Vec3::NEG_Y * 0.42,
            rotations: [Quat::IDENTITY; 3],
            parents: [Quat::IDENTITY; 3],
        };
        let [a, b] = leg.turned(Vec3::Y * 0.05, Vec3::X);
        let bend = (a * leg.thigh).cross(b * leg.shin).x / (0.43 * 0.42);
        assert!(
            bend > 0.3 && before.is_none_or(|before| (bend - before).abs() < 0.05),
            "{flexion} {bend} {before:?}"
        );
        before = Some(bend);
    }
}

/// The leg is stretched evenly, as before the heel of a long step comes down.
#[test]
fn foot_lock_of_a_stretched_leg_does_not_snap() {
    let leg = LimbPose {
        thigh: Vec3::NEG_Y * 0.43,
        shin: Quat::from_rotation_x(0.6) * Vec3::NEG_Y * 0.42,
        rotations: [Quat::IDENTITY; 3],
        parents: [Quat::IDENTITY; 3],
    };
    let flexion_deg = |shift_m: f32| {
        let [a, b] = leg.turned(leg.line().normalize_or_zero() * shift_m, Vec3::X);
        (a * leg.thigh).angle_between(b * leg.shin).to_degrees()
    };
    // 24 cm/s at 120 frames a second: 2 mm a frame. The closed form is 2.5° where the stretch ends;
    // nearer to a straight leg it is more.
    let flexions: Vec<f32> = (0..30).map(|frame| flexion_deg(0.002 * frame as f32)).collect();
    let steps = flexions.windows(2).map(|pair| (pair[1] - pair[0]).abs());
    let most = steps.fold(0.0, f32::max);
    assert!(most < 2.5, "{most} {flexions:?}");
    assert!(flexions[29] < 13.0 && flexions[0] > 34.0, "{flexions:?}");
}

#[test]
fn foot_lock_of_invalid_input_is_refused() {
    let (clip, roles) = sliding(1.3);
    let contacts = contacts_moving_backwards(&clip, &roles);
    let lock = |roles: &Roles, contacts: &Contacts, options: &FootLockOptions| {
        foot_lock(&clip, roles, contacts, options)
    };
    let options = FootLockOptions::default();
    assert_eq!(lock(&Roles::default(), &contacts, &options), Err(FootLockError::NoLegs));
    assert!(matches!(
        lock(&roles, &Contacts::from_flags([vec![true; 7], vec![true; 7]]), &options),
        Err(FootLockError::Contacts { contacts: 7, .. })
    ));
    for blend_secs in [-0.1, f64::NAN, 1e9] {
        let wrong = FootLockOptions { blend_secs, ..options };
        assert!(matches!(lock(&roles, &contacts, &wrong), Err(FootLockError::Option { .. })));
    }
    // Roles of another skeleton, or in the wrong order, are not a leg; one leg is enough.
    let mut one = roles.clone();
    one.set(Role::LeftShin, Some(9_999));
    assert!(lock(&one, &contacts, &options).is_ok());
    one.set(Role::RightShin, roles.get(Role::Head));
    assert_eq!(lock(&one, &contacts, &options), Err(FootLockError::NoLegs));
    // Without blending the result jumps, which is not an error; nor is a clip without frames.
    let hard = FootLockOptions { blend_secs: 0.0, max_shift_m: 0.0, ..options };
    assert!(lock(&roles, &contacts, &hard).is_ok());
    let empty = clip.crop(0..0).unwrap();
    assert_eq!(foot_lock(&empty, &roles, &Contacts::default(), &options), Ok(empty));
}

/// The forefeet of a body on four legs are held as its hind feet are, and no leg bends the other
/// way.
#[test]
fn foot_lock_holds_sliding_forefeet() {
    for axis in [None, Some(Vec3::X), Some(Vec3::Y)] {
        let made = QuadrupedWalk { axis, fore_slide_mps: 0.1, ..QuadrupedWalk::default() };
        let motion = Motion::analyze(made.clip());
        let (clip, roles, contacts) = (motion.clip(), motion.roles(), motion.contacts());
        let locked = foot_lock(clip, roles, contacts, &FootLockOptions::default()).unwrap();
        for pair in FootPair::BOTH {
            let worst = |clip: &Clip| {
                let slides = foot_slides(clip, roles, contacts).into_iter();
                let of_pair = slides.filter(|slide| slide.foot.pair == pair);
                of_pair.map(|slide| slide.slide_cm).fold(0.0, f64::max)
            };
            let (before, after) = (worst(clip), worst(&locked));
            assert!(pair == FootPair::Hind || before > 3.0, "{axis:?}: {before} cm");
            assert!(after < 0.2, "{axis:?}, {pair:?}: {before} to {after} cm");
        }
        for foot in Foot::ALL {
            let leg = Limb::on(clip.skeleton(), roles, foot).unwrap();
            for frame in 0..clip.frames() {
                let [before, after] =
                    [clip, &locked].map(|clip: &Clip| leg.pose(&clip.world_pose(frame)).bend());
                assert!(before.dot(after) > 0.0, "{axis:?}, {foot:?}, {frame}");
            }
        }
    }
}
