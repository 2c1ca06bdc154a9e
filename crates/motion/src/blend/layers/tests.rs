//! Tests of layers and masks.

use super::*;
use crate::clip::JointTranslations;
use crate::clip::character_frames;
use crate::clip::fixtures::{wander, wander_by};
use crate::skeleton::{Role, Roles, fixtures};
use crate::synth::{Action, Params, synthesize};
use proptest::prelude::*;
use std::sync::Arc;

/// Lays clips over each other that have the same roles.
fn layer(
    base: &Clip,
    roles: &Roles,
    over: &Clip,
    options: &LayerOptions,
) -> Result<Clip, LayerError> {
    let [base, over] = [base, over].map(|clip| Motion::with_roles(clip.clone(), roles));
    super::layer(&base, &over, options)
}

fn options(parts: &[BodyPart]) -> LayerOptions {
    LayerOptions { parts: parts.to_vec(), feather: 0, ..LayerOptions::default() }
}

#[test]
fn layer_agrees_with_scipy() {
    #[derive(serde::Deserialize)]
    struct Case {
        weight: f32,
        base: [f32; 4],
        over: [f32; 4],
        reference: [f32; 4],
        additive: [f32; 4],
        in_place: [f32; 4],
    }
    #[derive(serde::Deserialize)]
    struct Golden {
        layers: Vec<Case>,
    }
    let golden: Golden =
        serde_json::from_str(include_str!("../../../tests/oracles/gaits.json")).unwrap();
    for case in golden.layers {
        let [base, over, reference, additive, in_place] =
            [case.base, case.over, case.reference, case.additive, case.in_place]
                .map(Quat::from_array);
        assert!(quat::angle_between(added(base, over, reference, case.weight), additive) < 1e-6);
        assert!(quat::angle_between(quat::slerp(base, over, case.weight), in_place) < 1e-4);
    }
    // The same through a clip: one joint of the body, with frame 0 of the layer as the reference.
    let skeleton = fixtures::lafan();
    let roles = fixtures::roles(&skeleton);
    let (base, over) = (wander(&skeleton, 9, 1), wander(&skeleton, 9, 2));
    let mode = LayerMode::Additive(Reference::Frame(0));
    let out = layer(
        &base,
        &roles,
        &over,
        &LayerOptions { mode, weight: 0.7, ..options(&[BodyPart::UpperBody]) },
    )
    .unwrap();
    let joint = roles.get(Role::LeftForearm).unwrap();
    for frame in 0..9 {
        let wanted = added(
            base.rotations(frame)[joint],
            over.rotations(frame)[joint],
            over.rotations(0)[joint],
            0.7,
        );
        // The last frame of a loop is its first.
        if frame < 8 {
            assert!(quat::angle_between(out.rotations(frame)[joint], wanted) < 1e-5, "{frame}");
        }
    }
    assert!(quat::angle_between(out.rotations(0)[joint], base.rotations(0)[joint]) < 1e-6);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn layer_with_weight_0_is_the_base_and_with_weight_1_the_layer(
        seed in 0u64..50,
        part in 0usize..7,
        feather in 0usize..4,
        additive in any::<bool>(),
    ) {
        for (_, skeleton, _) in fixtures::all() {
            let roles = fixtures::roles(&skeleton);
            let (base, over) =
                (wander_by(&skeleton, 12, seed, 0.3), wander_by(&skeleton, 12, seed + 1, 0.3));
            let mode =
                if additive { LayerMode::Additive(Reference::Rest) } else { LayerMode::Override };
            let with = |weight, parts: &[BodyPart]| LayerOptions {
                weight,
                feather,
                mode,
                time: LayerTime::Hold,
                ..options(parts)
            };
            let part = BodyPart::ALL[part];
            prop_assert_eq!(
                layer(&base, &roles, &over, &with(0.0, &[part])).unwrap(),
                base.clone()
            );
            let whole = layer(&base, &roles, &over, &with(1.0, &[BodyPart::Whole])).unwrap();
            let some = layer(&base, &roles, &over, &with(1.0, &[part])).unwrap();
            let weights = mask(&skeleton, &roles, &[part], feather);
            for frame in 0..12 {
                for (joint, &weight) in weights.iter().enumerate().skip(1) {
                    if !additive {
                        prop_assert!(
                            quat::angle_between(
                                whole.rotations(frame)[joint],
                                over.rotations(frame)[joint]
                            ) < 1e-6
                        );
                    }
                    if weight == 0.0 {
                        prop_assert_eq!(some.rotations(frame)[joint], base.rotations(frame)[joint]);
                    } else if weight == 1.0 {
                        prop_assert!(
                            quat::angle_between(
                                some.rotations(frame)[joint],
                                whole.rotations(frame)[joint]
                            ) < 1e-6
                        );
                    }
                }
                if weights[0] == 0.0 {
                    prop_assert_eq!(
                        some.root_translations()[frame],
                        base.root_translations()[frame]
                    );
                }
            }
        }
    }
}

#[test]
fn layer_of_the_base_itself_changes_nothing() {
    let clip = synthesize(&Params::new(Action::Walk)).unwrap().clip;
    let roles = Roles::detect(clip.skeleton());
    for keep_orientation in [false, true] {
        let all = LayerOptions {
            keep_orientation,
            weight: 0.6,
            time: LayerTime::Hold,
            ..options(&[BodyPart::Whole])
        };
        let out = layer(&clip, &roles, &clip, &all).unwrap();
        assert!(crate::clip::fixtures::largest_distance(&out, &clip) < 1e-4);
    }
}

#[test]
fn layer_of_the_whole_body_takes_its_own_steps() {
    let [walk, run] =
        [Action::Walk, Action::Run].map(|action| synthesize(&Params::new(action)).unwrap().clip);
    let roles = Roles::detect(walk.skeleton());
    let placed = walk.transformed(&Planar::new(1.0, 3.0, -2.0));
    let out = layer(&placed, &roles, &run, &options(&[BodyPart::Whole])).unwrap();
    let (got, wanted) = (character_frames(&out, &roles), character_frames(&run, &roles));
    let start = character_frames(&placed, &roles)[0];
    for frame in 0..run.frames().min(out.frames()) {
        let here = start.after(&wanted[0].inverse()).after(&wanted[frame]);
        assert!(got[frame].shift.distance(here.shift) < 1e-3, "{frame}");
    }
    // The run is shorter, and continues from its beginning without a jump.
    let steps: Vec<f64> =
        got.windows(2).map(|pair| pair[0].shift.distance(pair[1].shift)).collect();
    assert!(
        out.frames() > run.frames() && steps.iter().all(|step| (step * 60.0 - 3.5).abs() < 0.6),
        "{steps:?}"
    );
}

#[test]
fn layer_keeping_orientation_does_not_nod() {
    let [walk, idle] =
        [Action::Walk, Action::Idle].map(|action| synthesize(&Params::new(action)).unwrap().clip);
    let roles = Roles::detect(walk.skeleton());
    let head = roles.get(Role::Head).unwrap();
    let off = |keep_orientation, feather| {
        let upper = LayerOptions { feather, keep_orientation, ..options(&[BodyPart::UpperBody]) };
        let out = layer(&walk, &roles, &idle, &upper).unwrap();
        let stands = [&out, &idle].map(|clip| character_frames(clip, &roles));
        let orientation = |clip: &Clip, frame: usize, stands: &[Planar]| {
            stands[frame].inverse().rotation() * clip.world_pose(frame).rotations[head]
        };
        let angles = (0..out.frames()).map(|frame| {
            quat::angle_between(
                orientation(&out, frame, &stands[0]),
                orientation(&idle, frame, &stands[1]),
            )
        });
        angles.fold(0.0, f32::max).to_degrees()
    };
    // The facing of a body is the mean of hips and shoulders, so half of the hips' turn in the walk
    // remains.
    assert!(off(false, 0) > 5.0, "{}", off(false, 0));
    assert!(off(true, 0) < 3.5 && off(true, 2) < 3.5, "{} {}", off(true, 0), off(true, 2));
}

#[test]
fn layer_with_a_start_begins_and_ends_there() {
    let skeleton = fixtures::bandai();
    let roles = fixtures::roles(&skeleton);
    let (base, over) = (wander(&skeleton, 40, 1), wander(&skeleton, 11, 2));
    let joint = roles.get(Role::RightHand).unwrap();
    let at = |time, start_secs, frame: usize| {
        let told = LayerOptions { time, start_secs, ..options(&[BodyPart::RightArm]) };
        layer(&base, &roles, &over, &told).unwrap().rotations(frame)[joint]
    };
    let of = |frame: usize| over.rotations(frame)[joint];
    let same = |a: Quat, b: Quat| quat::angle_between(a, b) < 1e-5;
    assert!(
        same(at(LayerTime::Loop, 0.0, 23), of(3)) && same(at(LayerTime::Hold, 0.0, 23), of(10))
    );
    assert!(same(at(LayerTime::Loop, 0.1, 0), of(3)) && same(at(LayerTime::Hold, -0.5, 14), of(0)));
    assert!(
        same(at(LayerTime::Loop, -0.1, 0), of(7)) && same(at(LayerTime::Hold, -0.5, 17), of(2))
    );
    assert!(same(at(LayerTime::Hold, 0.05, 1), quat::slerp(of(2), of(3), 0.5)));
}

#[test]
fn layer_timed_samples_the_given_times() {
    let skeleton = fixtures::bandai();
    let roles = fixtures::roles(&skeleton);
    let (base, over) = (wander(&skeleton, 12, 1), wander(&skeleton, 11, 2));
    let told = LayerOptions { start_secs: over.time_of(1), ..options(&[BodyPart::Whole]) };
    // Twice as fast, and across its end.
    let times: Vec<f64> = (0..8).map(|frame| over.time_of(2 * frame)).collect();
    let motions = [&base, &over].map(|clip| Motion::with_roles(clip.clone(), &roles));
    let out = layer_timed(&motions[0], &motions[1], &told, &times).unwrap();
    let joint = roles.get(Role::RightHand).unwrap();
    for frame in 0..8 {
        let wanted = over.rotations((1 + 2 * frame) % 10)[joint];
        assert!(quat::angle_between(out.rotations(frame)[joint], wanted) < 1e-5, "{frame}");
    }
    // Steps over the ground are those between the times.
    let stands = [&out, &over].map(|clip| character_frames(clip, &roles));
    let step = |of: &[Planar], from: usize, to: usize| of[from].inverse().after(&of[to]);
    let (made, own) = (step(&stands[0], 1, 2), step(&stands[1], 3, 5));
    assert!(made.shift.distance(own.shift) < 1e-3, "{made:?} {own:?}");
    // Frames without a time of their own have the base's.
    let late = layer(&base, &roles, &over, &told).unwrap();
    assert_eq!(out.rotations(9)[joint], late.rotations(9)[joint]);
}

#[test]
fn layer_added_to_its_mean_when_still_adds_nothing() {
    let skeleton = fixtures::lafan();
    let roles = fixtures::roles(&skeleton);
    let (base, still) = (wander(&skeleton, 9, 1), wander(&skeleton, 1, 2));
    let against_mean = LayerOptions {
        mode: LayerMode::Additive(Reference::Mean),
        ..options(&[BodyPart::UpperBody])
    };
    let out = layer(&base, &roles, &still, &against_mean).unwrap();
    assert!(crate::clip::fixtures::largest_distance(&out, &base) < 1e-5);
    // The mean of a joint that swings evenly to both sides is the middle.
    let joint = roles.get(Role::RightUpperArm).unwrap();
    let swung = |angle: f32| {
        let mut pose = still.pose(0);
        pose.rotations[joint] *= Quat::from_rotation_x(angle);
        pose
    };
    let mut poses = [swung(0.6), swung(-0.6), swung(0.0)];
    poses[1].rotations[joint] = -poses[1].rotations[joint];
    let over = Clip::from_poses("swings", still.skeleton().clone(), base.fps(), poses).unwrap();
    let out = layer(&base, &roles, &over, &against_mean).unwrap();
    let added = base.rotations(0)[joint].conjugate() * out.rotations(0)[joint];
    assert!((quat::log(added) - Vec3::X * 0.6).length() < 1e-3, "{added}");
}

#[test]
fn layer_blends_joint_translations() {
    let skeleton = fixtures::lafan();
    let roles = fixtures::roles(&skeleton);
    let hand = roles.get(Role::LeftHand).unwrap();
    let track = |x: f32| vec![JointTranslations { joint: hand, values: vec![Vec3::X * x; 5] }];
    let base = wander(&skeleton, 5, 1).with_translations(track(0.2)).unwrap();
    let over = wander(&skeleton, 5, 2).with_translations(track(0.6)).unwrap();
    let half = LayerOptions { weight: 0.5, ..options(&[BodyPart::LeftArm]) };
    assert!(
        (layer(&base, &roles, &over, &half).unwrap().translations()[0].values[3].x - 0.4).abs()
            < 1e-6
    );
    let against = LayerOptions { mode: LayerMode::Additive(Reference::Frame(0)), ..half };
    assert!(
        (layer(&base, &roles, &over, &against).unwrap().translations()[0].values[3].x - 0.2).abs()
            < 1e-6
    );
}

#[test]
fn mask_of_parts_covers_their_joints() {
    for (rig, skeleton, _) in fixtures::all() {
        let roles = fixtures::roles(&skeleton);
        for feather in [0, 1, 3] {
            let of = |part| mask(&skeleton, &roles, &[part], feather);
            let (upper, lower) = (of(BodyPart::UpperBody), of(BodyPart::LowerBody));
            assert!(upper.iter().zip(&lower).all(|(u, l)| (u + l - 1.0).abs() < 1e-6), "{rig}");
            assert_eq!((upper[0], lower[0]), (0.0, 1.0), "{rig}");
            let at = |weights: &[f32], role| weights[roles.get(role).unwrap()];
            // A spine that carries the legs belongs to the pelvis.
            let spine = roles.get(Role::Spine).unwrap();
            let pelvis =
                std::iter::successors(roles.get(Role::LeftThigh), |&joint| skeleton.parent(joint))
                    .any(|joint| joint == spine);
            let first = if pelvis { 0.0 } else { 1.0 / (feather + 1) as f32 };
            assert_eq!(
                (upper[spine], at(&lower, Role::LeftToe), at(&upper, Role::LeftHand)),
                (first, 1.0, 1.0),
                "{rig}"
            );
            let [arm, head, back] = [BodyPart::RightArm, BodyPart::Head, BodyPart::Spine].map(of);
            assert!(
                at(&arm, Role::RightHand) > 0.9
                    && at(&arm, Role::LeftHand) == 0.0
                    && at(&arm, Role::Head) == 0.0,
                "{rig}"
            );
            assert!(
                at(&head, Role::Head) > 0.2
                    && at(&head, Role::RightUpperArm) == 0.0
                    && at(&head, Role::Spine) == 0.0,
                "{rig}"
            );
            assert!(
                (pelvis || at(&back, Role::Spine) > 0.0)
                    && at(&back, Role::Head) == 0.0
                    && at(&back, Role::LeftUpperArm) == 0.0,
                "{rig}"
            );
            assert!(
                mask(&skeleton, &Roles::default(), &[BodyPart::LeftArm, BodyPart::Head], 0)
                    .iter()
                    .all(|w| *w == 0.0)
            );
        }
    }
}

#[test]
fn layer_of_incompatible_clips_is_refused() {
    let skeleton = fixtures::lafan();
    let roles = fixtures::roles(&skeleton);
    let (base, over) = (wander(&skeleton, 5, 1), wander(&skeleton, 5, 2));
    let with = |weight, start_secs, mode| {
        layer(
            &base,
            &roles,
            &over,
            &LayerOptions { weight, mode, start_secs, ..options(&[BodyPart::Head]) },
        )
    };
    for weight in [-0.1, 1.1, f32::NAN] {
        assert!(matches!(
            with(weight, 0.0, LayerMode::Override),
            Err(LayerError::Number { what: "weight", .. })
        ));
    }
    assert!(matches!(
        with(1.0, f64::INFINITY, LayerMode::Override),
        Err(LayerError::Number { .. })
    ));
    let late = LayerMode::Additive(Reference::Frame(5));
    assert_eq!(with(1.0, 0.0, late), Err(LayerError::NoFrame { frame: 5, frames: 5 }));
    let other = wander(&fixtures::bandai(), 5, 1);
    assert!(matches!(
        layer(&base, &roles, &other, &LayerOptions::default()),
        Err(LayerError::Skeletons { .. })
    ));
    let none = over.crop(0..0).unwrap();
    assert!(matches!(
        layer(&base, &roles, &none, &LayerOptions::default()),
        Err(LayerError::NoFrame { .. })
    ));
    let empty = base.crop(0..0).unwrap();
    assert_eq!(layer(&empty, &roles, &over, &LayerOptions::default()), Ok(empty.clone()));
    assert!(Arc::ptr_eq(empty.skeleton(), base.skeleton()));
}
