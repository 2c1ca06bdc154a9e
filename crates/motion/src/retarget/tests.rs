//! Tests of retargeting by inverse kinematics.

use super::*;
use crate::clip::fixtures::{QuadrupedWalk, quadruped, wander};
use crate::clip::{ContactOptions, Contacts, retarget};
use crate::skeleton::{Foot, Joint, Role, Side, fixtures};
use crate::synth::{Action, Params, synthesize};
use glam::{Quat, Vec3};
use proptest::prelude::*;
use std::ops::ControlFlow;

fn synthesised(action: Action) -> Motion {
    Motion::analyze(synthesize(&Params::new(action)).unwrap().clip)
}

fn body(skeleton: &Arc<Skeleton>, roles: &Roles) -> TargetBody {
    TargetBody::at_rest(skeleton, roles)
}

fn full(source: &Motion, skeleton: &Arc<Skeleton>) -> RetargetedMotion {
    let roles = Roles::detect(skeleton);
    retarget_motion(source, &body(skeleton, &roles), &RetargetOptions::default()).unwrap()
}

/// Both joints of a role, and the factor of the bone that ends there.
type Factor = (fn(Side) -> Role, f32);

/// Returns the skeleton with the bones that end at joints of some roles stretched.
fn stretched(skeleton: &Skeleton, factors: &[Factor]) -> Arc<Skeleton> {
    let roles = Roles::detect(skeleton);
    let factor = |joint: usize| {
        let of = |(role, factor): &Factor| {
            let is = Side::BOTH.iter().any(|side| roles.get(role(*side)) == Some(joint));
            if is { *factor } else { 1.0 }
        };
        factors.iter().map(of).product::<f32>()
    };
    let joints = skeleton.joints().iter().enumerate();
    let joints = joints
        .map(|(index, joint)| Joint { offset: joint.offset * factor(index), ..joint.clone() });
    Arc::new(Skeleton::new(joints.collect()).unwrap())
}

#[test]
fn retarget_motion_to_the_same_rig_is_the_clip() {
    let walk = synthesised(Action::Walk);
    let skeleton = Arc::new(Skeleton::clone(walk.clip().skeleton()));
    let made = full(&walk, &skeleton);
    assert_eq!(made.clip, **walk.clip());
    assert_eq!((made.report, made.is_same_rig), (RetargetErrors::default(), true));
    let (shuffled, order) = fixtures::shuffled(&skeleton, 3);
    let made = full(&walk, &shuffled);
    for (new, &old) in order.iter().enumerate() {
        let (a, b) = (walk.clip().world_pose(40), made.clip.world_pose(40));
        assert!(a.positions[old].distance(b.positions[new]) < 1e-5);
    }
}

/// The forefeet of an animal stand where the hind feet do: on the ground, and still.
#[test]
fn forefeet_of_another_animal_stand_still_on_the_ground() {
    // Forelegs that are too short for the height of their shoulders would not reach the ground.
    for (forelegs, hind_legs) in [(1.15, 0.9), (1.3, 1.0)] {
        for axis in [None, Some(Vec3::X)] {
            let made = QuadrupedWalk { yaw: 0.8, axis, ..QuadrupedWalk::default() };
            let walk = Motion::analyze(made.clip());
            let factors: [Factor; 4] = [
                (Role::forearm, forelegs),
                (Role::hand, forelegs),
                (Role::shin, hind_legs),
                (Role::foot, hind_legs),
            ];
            let (target, roles) = (stretched(&quadruped(), &factors), Roles::detect(&quadruped()));
            let options = RetargetOptions::default();
            let RetargetedMotion { clip, report, .. } =
                retarget_motion(&walk, &body(&target, &roles), &options).unwrap();
            let what = format!("{forelegs} {axis:?} {report:?}");
            assert_eq!(report.skating.result.stances, report.source_skating.stances, "{what}");
            assert!(report.skating.directions.worst_cm > 2.0, "{what}");
            assert!(
                report.skating.result.worst_cm < report.source_skating.worst_cm + 0.3,
                "{what}"
            );
            assert!(report.penetration_cm.result < 0.5, "{what}");
            assert_eq!(report.beyond_limits.result, 0, "{what}");
            // Planted, they are as low as the source's.
            for foot in Foot::ALL {
                let lowest = |clip: &Clip, roles: &Roles, frame: usize| {
                    let (world, points) =
                        (clip.world_pose(frame), roles.foot_points(clip.skeleton(), foot));
                    let heights = points.iter().map(|&(joint, point)| world.point(joint, point).y);
                    heights.fold(f32::INFINITY, f32::min)
                };
                for frame in
                    (0..clip.frames()).filter(|frame| walk.contacts().planted(foot, *frame))
                {
                    let [theirs, ours] =
                        [lowest(walk.clip(), walk.roles(), frame), lowest(&clip, &roles, frame)];
                    assert!(
                        (ours - theirs).abs() < 0.02,
                        "{what} {foot:?} {frame}: {theirs} {ours}"
                    );
                }
            }
        }
    }
}

/// Slices of any length give the same bits as one, and their progress grows.
#[test]
fn motion_retargeting_in_slices_equals_retarget_motion() {
    let walk = Arc::new(synthesised(Action::Walk));
    for (name, skeleton, _) in fixtures::all() {
        let target = body(&skeleton, &Roles::detect(&skeleton));
        let whole = retarget_motion(&walk, &target, &RetargetOptions::default()).unwrap();
        let options = RetargetOptions::default();
        let mut work = MotionRetargeting::new(Arc::clone(&walk), target, options).unwrap();
        let (mut slices, mut before) = (0, -1.0);
        let made = loop {
            assert!(work.progress() > before && work.progress() < 1.0, "{name} {before}");
            (before, slices) = (work.progress(), slices + 1);
            work = match work.advance(23).unwrap() {
                ControlFlow::Continue(rest) => rest,
                ControlFlow::Break(made) => break made,
            };
        };
        assert_eq!(made.clip, whole.clip, "{name}");
        assert_eq!(made.report, whole.report, "{name}");
        assert!(slices > 5 * walk.clip().frames() / 23 || *walk.clip().skeleton() == skeleton);
    }
}

/// A cycle ends as it begins, one step further, and its feet are held over its ends.
#[test]
fn retarget_motion_of_a_cycle_is_a_cycle() {
    let walk = synthesised(Action::Walk);
    let cycle = crate::gait::GaitCycle::find(&walk).unwrap().looped().clone();
    let frames = cycle.clip.frames();
    let source = cycle.repeat(2).unwrap().crop(0..frames + 1).unwrap();
    let source = Motion::analyze(source).declared_cycle(true);
    let target = stretched(&fixtures::lafan(), &[(Role::shin, 1.2), (Role::thigh, 1.3)]);
    let made = full(&source, &target).clip;
    assert_eq!(made.frames(), frames + 1);
    for (&first, &last) in made.rotations(0).iter().zip(made.rotations(frames)).skip(1) {
        assert!(crate::math::quat::angle_between(first, last) < 1e-4);
    }
    let roles = Roles::detect(&target);
    let legs = roles.leg_length(&target).unwrap()
        / source.roles().leg_length(source.clip().skeleton()).unwrap();
    let steps = [source.clip(), &made].map(|clip| {
        let hips = Roles::detect(clip.skeleton()).get(Role::Hips).unwrap();
        [0, frames].map(|frame| clip.world_pose(frame).positions[hips])
    });
    let [own, ours] = steps.map(|[from, to]| to - from);
    assert!((own * legs).distance(ours) < 1e-3, "{own} {ours}");
    assert!(ours.y.abs() < 1e-5, "{ours}");
    // The hips are moved as they would be if the cycle went on: without it, they end elsewhere.
    let open = full(&source.declared_cycle(false), &target).clip;
    let height = |clip: &Clip, frame: usize| clip.root_translations()[frame].y;
    let jump = |clip: &Clip| (height(clip, 0) - height(clip, frames)).abs();
    assert!(jump(&open) > 1e-4 && jump(&made) < 1e-5, "{} {}", jump(&open), jump(&made));
}

#[test]
fn retarget_motion_without_weights_keeps_directions() {
    let walk = synthesised(Action::Walk);
    let skeleton = stretched(&fixtures::lafan(), &[(Role::shin, 1.2), (Role::hand, 0.8)]);
    let roles = Roles::detect(&skeleton);
    let plain = retarget(walk.clip(), walk.roles(), &skeleton, &roles).unwrap();
    let none = RetargetOptions { feet: [-1.0, f32::NAN], hands: [0.0; 2] };
    for options in [RetargetOptions::DIRECTIONS, none] {
        let made = retarget_motion(&walk, &body(&skeleton, &roles), &options).unwrap();
        assert_eq!(made.clip, plain);
        let errors = made.report;
        assert_eq!(errors.skating.directions, errors.skating.result);
        assert_eq!(errors.feet[0].unwrap().directions, errors.feet[0].unwrap().result);
    }
    // Half of the weight goes half of the way.
    let reach = |weight: f32| {
        let options = RetargetOptions::weights(weight, weight);
        let made = retarget_motion(&walk, &body(&skeleton, &roles), &options).unwrap();
        [made.report.feet[0], made.report.hands[1]].map(|limb| limb.unwrap().result.mean_cm)
    };
    let (none, half, whole) = (reach(0.0), reach(0.5), reach(1.0));
    for limb in 0..2 {
        let share = (half[limb] - whole[limb]) / (none[limb] - whole[limb]);
        assert!((0.35..0.65).contains(&share), "{limb}: {none:?} {half:?} {whole:?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]
    /// Feet do not slide more than the source's, nor sink in, and no knee or elbow bends beyond its
    /// limits, on any rig with any proportions.
    #[test]
    fn retarget_motion_to_any_proportions_keeps_feet_planted(
        rig in 0usize..11,
        action in 0usize..3,
        size in 0.4f32..2.0,
        [thigh, shin, arm] in prop::array::uniform3(0.75f32..1.35),
        hips in 0.6f32..1.5,
        foot in 0.6f32..1.5,
    ) {
        let source = synthesised([Action::Walk, Action::Run, Action::Stop][action]);
        let (name, skeleton, _) = fixtures::all().swap_remove(rig);
        let factors: [Factor; 6] = [
            (Role::thigh, hips), (Role::shin, thigh), (Role::foot, shin), (Role::toe, foot),
            (Role::forearm, arm), (Role::hand, arm),
        ];
        let skeleton = Arc::new(stretched(&skeleton, &factors).scaled(size));
        let errors = full(&source, &skeleton).report;
        let (result, own) = (errors.skating.result, errors.source_skating);
        prop_assert!(result.stances > 0 && result.worst_cm < own.worst_cm + 0.3, "{name}: {errors:?}");
        prop_assert!(errors.penetration_cm.result < 0.5, "{name}: {errors:?}");
        prop_assert_eq!(errors.beyond_limits.result, 0, "{}", name);
        for foot in errors.feet {
            prop_assert!(foot.unwrap().result.worst_cm < 1.0, "{name}: {errors:?}");
        }
    }
}

/// A knee that the source bends backwards, as noisy captures do, comes out bent forwards.
#[test]
fn retarget_motion_of_backward_knees_bends_them_forwards() {
    let walk = synthesised(Action::Walk);
    let roles = walk.roles();
    let knee = roles.get(Role::LeftShin).unwrap();
    let poses = (0..walk.clip().frames()).map(|frame| {
        let mut pose = walk.clip().pose(frame);
        if (20..26).contains(&frame) {
            pose.rotations[knee] = Quat::from_rotation_x(-0.2);
        }
        pose
    });
    let (skeleton, fps) = (Arc::clone(walk.clip().skeleton()), walk.clip().fps());
    let bent = Motion::analyze(Clip::from_poses("bent", skeleton, fps, poses).unwrap());
    let errors = full(&bent, &stretched(&fixtures::smpl(), &[(Role::shin, 1.2)])).report;
    assert_eq!(errors.beyond_limits.directions, 6);
    assert_eq!(errors.beyond_limits.result, 0);
}

/// One body in several rest poses: arms level or hanging, axes rotated joint by joint.
#[test]
fn retarget_motion_to_other_rest_poses_keeps_positions() {
    let walk = synthesised(Action::Walk);
    let target = stretched(&fixtures::mixamo(), &[(Role::shin, 1.15), (Role::hand, 0.9)]);
    let roles = Roles::detect(&target);
    let hanging = |joint: usize| {
        let arm = Side::BOTH.map(|side| roles.get(Role::upper_arm(side)).unwrap());
        let above = std::iter::successors(target.parent(joint), |&j| target.parent(j));
        let mut of = above.filter_map(|j| arm.iter().position(|&a| a == j));
        of.next().map_or(Quat::IDENTITY, |side| {
            Quat::from_rotation_z(if side == 0 { -0.8 } else { 0.8 })
        })
    };
    let joints = target.joints().iter().enumerate().map(|(index, joint)| Joint {
        offset: hanging(index) * joint.offset,
        end_site: joint.end_site.map(|end| hanging(index) * end),
        ..joint.clone()
    });
    let a_pose = Arc::new(Skeleton::new(joints.collect()).unwrap());
    let (first, second) = (full(&walk, &target), full(&walk, &a_pose));
    let (turned, turns) = fixtures::turned(&target, 5);
    let poses = (0..first.clip.frames())
        .map(|frame| fixtures::turned_pose(&target, &turns, &first.clip.pose(frame)));
    let model = Clip::from_poses("turned", Arc::clone(&turned), walk.clip().fps(), poses).unwrap();
    let onto = TargetBody::of_clip(&model, &roles);
    let third = retarget_motion(&walk, &onto, &RetargetOptions::default()).unwrap();
    let ends = Side::BOTH.into_iter().flat_map(|side| [Role::foot(side), Role::shin(side)]);
    let ends: Vec<Role> = ends.chain([Role::Hips]).collect();
    for frame in (0..walk.clip().frames()).step_by(7) {
        let [a, b, c] = [&first, &second, &third].map(|made| made.clip.world_pose(frame).positions);
        for &role in &ends {
            let joint = roles.get(role).unwrap();
            assert!(a[joint].distance(b[joint]) < 2e-3, "{role:?} hanging arms");
            assert!(a[joint].distance(c[joint]) < 0.02, "{role:?} {}", a[joint].distance(c[joint]));
        }
        for side in Side::BOTH {
            let hand = roles.get(Role::hand(side)).unwrap();
            assert!(a[hand].distance(b[hand]) < 2e-3, "hanging arms");
        }
    }
}

/// Hands that are held together stay together, on broad shoulders and with short arms.
#[test]
fn retarget_motion_of_hands_that_touch_lets_them_touch() {
    let skeleton = fixtures::lafan();
    let roles = Roles::detect(&skeleton);
    let mut pose = fixtures::step(&skeleton, &roles);
    for (side, sign) in Side::BOTH.into_iter().zip([1.0f32, -1.0]) {
        pose.rotations[roles.get(Role::upper_arm(side)).unwrap()] =
            Quat::from_rotation_y(-sign * 1.45);
        pose.rotations[roles.get(Role::forearm(side)).unwrap()] =
            Quat::from_rotation_y(-sign * 1.05);
    }
    let between = |clip: &Clip, roles: &Roles| {
        let at = clip.world_pose(1).positions;
        let [left, right] = Side::BOTH.map(|side| at[roles.get(Role::hand(side)).unwrap()]);
        (left - right).length()
    };
    let clip = Clip::from_poses("clap", skeleton, 30.0, vec![pose; 3]).unwrap();
    let source = Motion::analyze(clip);
    let own = between(source.clip(), &roles);
    assert!(own < 0.1, "{own}");
    let broad = stretched(&fixtures::mixamo(), &[(Role::upper_arm, 1.5)]);
    let broad_roles = Roles::detect(&broad);
    let made = full(&source, &broad);
    let plain = retarget(source.clip(), &roles, &broad, &broad_roles).unwrap();
    let (before, after) = (between(&plain, &broad_roles), between(&made.clip, &broad_roles));
    assert!(before > own + 0.08, "{before}");
    assert!((after - own).abs() < 0.02, "{own} {before} {after}");
}

/// A foot that is dragged over the floor on purpose is dragged as far by another body.
#[test]
fn retarget_motion_of_a_foot_that_slides_on_purpose_lets_it_slide() {
    let walk = synthesised(Action::Walk);
    let frames = walk.clip().frames();
    let pulled = |frame: usize| crate::math::Planar::new(0.0, 0.4 * frame as f64 / 60.0, 0.0);
    let clip = walk.clip().transformed_by_frame(&(0..frames).map(pulled).collect::<Vec<_>>());
    let source = Motion::analyze(clip).with_contacts(walk.contacts().clone());
    let target = Arc::new(fixtures::lafan().scaled(1.1));
    let skating = full(&source, &target).report;
    assert!(skating.source_skating.mean_cm > 18.0, "{skating:?}");
    let ratio = skating.skating.result.mean_cm / skating.source_skating.mean_cm;
    let legs = Roles::detect(&target).leg_length(&target).unwrap()
        / walk.roles().leg_length(walk.clip().skeleton()).unwrap();
    assert!((ratio / f64::from(legs) - 1.0).abs() < 0.1, "{ratio} {legs}");
}

#[test]
fn retarget_motion_of_odd_clips_is_finite() {
    let target = stretched(&fixtures::xsens(), &[(Role::foot, 1.2)]);
    for (name, skeleton, _) in fixtures::all() {
        for frames in [1, 2, 5] {
            let source = Motion::analyze(wander(&skeleton, frames, 3));
            let made = full(&source, &target);
            assert_eq!(made.clip.frames(), frames, "{name}");
            assert!(made.clip.world_positions(0..frames).iter().all(|p| p.is_finite()), "{name}");
        }
    }
    // A body without legs, and one with a single arm.
    let source = synthesised(Action::Idle);
    let mut roles = Roles::detect(&target);
    for role in Role::leg(Side::Left).into_iter().chain(Role::leg(Side::Right)) {
        roles.set(role, None);
    }
    roles.set(Role::LeftHand, None);
    let made =
        retarget_motion(&source, &body(&target, &roles), &RetargetOptions::default()).unwrap();
    assert_eq!(made.report.feet, [None, None]);
    assert!(made.report.hands[0].is_none() && made.report.hands[1].is_some());
}

/// The knees of a smooth walk stay smooth.
#[test]
fn retarget_motion_of_a_walk_does_not_jolt_its_knees() {
    let source = synthesised(Action::Walk);
    for factor in [0.85, 1.0, 1.2] {
        let target = stretched(&fixtures::lafan(), &[(Role::shin, factor), (Role::thigh, 1.3)]);
        let roles = Roles::detect(&target);
        let plain = retarget(source.clip(), source.roles(), &target, &roles).unwrap();
        let jolt = |clip: &Clip| {
            let legs = Side::BOTH.map(|side| crate::transition::Limb::leg(&target, &roles, side));
            let mut worst = 0.0f32;
            for leg in legs.into_iter().flatten() {
                let pose = |frame| leg.pose(&clip.world_pose(frame)).flexion(Vec3::X);
                let flexion: Vec<f32> = (0..clip.frames()).map(pose).collect();
                for w in flexion.windows(3) {
                    worst = worst.max((w[0] - 2.0 * w[1] + w[2]).abs());
                }
            }
            worst.to_degrees()
        };
        let (before, after) = (jolt(&plain), jolt(&full(&source, &target).clip));
        assert!(after < 2.0 * before + 1.0, "{factor}: {before}° {after}°");
    }
    let none = Contacts::detect(source.clip(), &Roles::default(), &ContactOptions::default());
    assert!(none.intervals(Side::Left).is_empty());
    let floating = source.with_contacts(none);
    let errors = full(&floating, &fixtures::smpl()).report;
    assert_eq!(errors.skating.result.stances, 0);
}
