//! Tests of the dissolve.

use super::*;
use crate::clip::JointTranslations;
use crate::registration::fixtures::{Walk, body};
use crate::skeleton::{Joint, Roles};
use proptest::prelude::*;
use std::f32::consts::PI;

fn source(walk: Walk) -> Motion {
    Motion::analyze(walk.clip())
}

fn two_walks() -> (Motion, Motion) {
    let a = source(Walk { frames: 100, ..Walk::default() });
    let b = source(Walk {
        frames: 80,
        speed: 2.2,
        cadence: 1.3,
        swing: 0.7,
        phase: 0.3,
        heading: 2.5,
        start: (7.0, -5.0),
        ..Walk::default()
    });
    (a, b)
}

fn worst_distance(a: &Clip, b: &Clip) -> f32 {
    assert_eq!(a.frames(), b.frames());
    let (p, q) = (a.world_positions(0..a.frames()), b.world_positions(0..b.frames()));
    p.iter().zip(&q).map(|(p, q)| p.distance(*q)).fold(0.0, f32::max)
}

fn laws() -> impl Strategy<Value = (WeightLaw, RootBlend)> {
    (0usize..3, any::<bool>()).prop_map(|(law, world)| {
        (WeightLaw::ALL[law], if world { RootBlend::World } else { RootBlend::Velocity })
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]
    #[test]
    fn dissolve_of_a_clip_with_itself_is_the_clip(
        (law, root) in laws(),
        window in 0usize..60,
        at in 0usize..59,
        turning in -1.0f32..1.0,
    ) {
        let a = source(Walk {
            frames: 120,
            turning,
            heading: 3.0,
            start: (3.0, -2.0),
            ..Walk::default()
        });
        let out = dissolve(
            &a,
            at,
            &a,
            at,
            &DissolveOptions { window, law, root, ..DissolveOptions::default() },
        )
        .unwrap();
        let worst = worst_distance(&out.clip, a.clip());
        prop_assert!(worst < 1e-5, "{worst}");
        let angle = (0..120)
            .flat_map(|f| out.clip.rotations(f).iter().zip(a.clip().rotations(f)))
            .map(|(p, q)| quat::angle_between(*p, *q));
        prop_assert!(angle.fold(0.0, f32::max) < 1e-5 * PI);
    }

    #[test]
    fn dissolve_does_not_depend_on_the_position_of_b(
        yaw in -3.0f64..3.0,
        x in -9.0f64..9.0,
        z in -9.0f64..9.0,
        (law, root) in laws(),
    ) {
        let (a, b) = two_walks();
        let moved = Motion::with_roles(b.clip().transformed(&Planar::new(yaw, x, z)), b.roles());
        let options = DissolveOptions { window: 20, law, root, ..DissolveOptions::default() };
        let (here, there) = (
            dissolve(&a, 50, &b, 10, &options).unwrap(),
            dissolve(&a, 50, &moved, 10, &options).unwrap(),
        );
        let worst = worst_distance(&here.clip, &there.clip);
        prop_assert!(worst < 2e-4, "{worst}");
    }

    #[test]
    fn dissolve_is_a_before_the_window_and_b_from_its_last_frame(
        (law, root) in laws(),
        window in 0usize..40,
        align in any::<bool>(),
    ) {
        let (a, b) = two_walks();
        let out = dissolve(
            &a,
            55,
            &b,
            7,
            &DissolveOptions { window, law, align, root, ..DissolveOptions::default() },
        )
        .unwrap();
        let overlap = if window < 2 { 0 } else { window };
        prop_assert_eq!(out.transition.clone(), 55..55 + overlap);
        prop_assert_eq!(out.clip.frames(), 55 + 80 - 7);
        prop_assert_eq!(out.frames.len(), out.clip.frames());
        for f in 0..55 {
            prop_assert_eq!(out.clip.pose(f), a.clip().pose(f));
        }
        let from = overlap.saturating_sub(1);
        for f in from..80 - 7 {
            let mut expected = b.clip().world_pose(7 + f);
            expected.apply(&out.world_from_b);
            let found = out.clip.world_pose(55 + f);
            for (p, q) in found.positions.iter().zip(&expected.positions) {
                prop_assert!(p.distance(*q) < 2e-5, "frame {} {} {}", f, p, q);
            }
        }
        prop_assert!(out.clip.root_translations().iter().all(|p| p.is_finite()));
    }
}

#[derive(serde::Deserialize)]
struct Golden {
    fps: f64,
    offset: Vec3,
    cases: Vec<Case>,
}

#[derive(serde::Deserialize)]
struct Case {
    root: RootBlend,
    leave: usize,
    enter: usize,
    window: usize,
    a: GoldenMotion,
    b: GoldenMotion,
    during: GoldenMotion,
    last_root: Vec3,
    last_rotation: Quat,
}

#[derive(serde::Deserialize)]
struct GoldenMotion {
    roots: Vec<Vec3>,
    rotations: Vec<[Quat; 2]>,
}

#[test]
fn dissolve_agrees_with_numpy() {
    let golden: Golden =
        serde_json::from_str(include_str!("../../../tests/golden/dissolve.json")).unwrap();
    let joint = |parent, offset| Joint {
        name: "joint".into(),
        parent,
        offset,
        end_site: None,
        channels: vec![],
    };
    let skeleton = Arc::new(
        Skeleton::new(vec![joint(None, Vec3::ZERO), joint(Some(0), golden.offset)]).unwrap(),
    );
    let source = |motion: &GoldenMotion| {
        let clip = Clip::new(
            "golden",
            Arc::clone(&skeleton),
            golden.fps,
            motion.rotations.concat(),
            motion.roots.clone(),
        )
        .unwrap();
        Motion::with_roles(clip, &Roles::default())
    };
    assert_eq!(golden.cases.len(), 6);
    for case in &golden.cases {
        let options =
            DissolveOptions { window: case.window, root: case.root, ..DissolveOptions::default() };
        let out =
            dissolve(&source(&case.a), case.leave, &source(&case.b), case.enter, &options).unwrap();
        for p in 0..case.window {
            let (found, expected) =
                (out.clip.root_translations()[case.leave + p], case.during.roots[p]);
            assert!(
                found.distance(expected) < 2e-5,
                "{:?} {} frame {p}: {found} {expected}",
                case.root,
                case.window
            );
            for (found, expected) in
                out.clip.rotations(case.leave + p).iter().zip(case.during.rotations[p])
            {
                assert!(quat::angle_between(*found, expected) < 2e-5);
            }
        }
        let last = out.clip.frames() - 1;
        assert!(out.clip.root_translations()[last].distance(case.last_root) < 5e-5);
        assert!(quat::angle_between(out.clip.rotations(last)[0], case.last_rotation) < 2e-5);
    }
}

#[test]
fn dissolve_of_straight_walks_by_velocity_is_straight() {
    // Two straight walks, far apart, at an angle of 143°.
    let (a, b) = two_walks();
    let out =
        dissolve(&a, 50, &b, 10, &DissolveOptions { window: 30, ..DissolveOptions::default() })
            .unwrap();
    // The body sways about its heading by as much as the sources, and A's heading continues.
    let sway = |s: &Motion, heading: f64| {
        s.ground_frames().iter().map(|f| wrap_angle(f.yaw - heading).abs()).fold(0.0, f64::max)
    };
    let most = sway(&a, 0.0).max(sway(&b, 2.5)) * 2.0 + 0.02;
    for frame in &out.frames {
        assert!(frame.yaw.abs() < most, "{} {most}", frame.yaw);
    }
    // Steps grow from 1.3 m/s to 2.2 m/s, within 10 % for the variation within a stride.
    for pair in out.frames.windows(2) {
        let speed = (pair[1].shift - pair[0].shift).length() * 60.0;
        assert!((1.1..2.5).contains(&speed), "{speed}");
    }
}

#[test]
fn dissolve_without_alignment_moves_to_b() {
    let (a, b) = two_walks();
    for root in [RootBlend::Velocity, RootBlend::World] {
        let jump = |window: usize, align: bool| {
            let out = dissolve(
                &a,
                50,
                &b,
                10,
                &DissolveOptions { window, align, root, ..DissolveOptions::default() },
            )
            .unwrap();
            let roots = out.clip.root_translations();
            (49..55 + window).map(|f| roots[f].distance(roots[f + 1])).fold(0.0, f32::max)
        };
        let apart = a.clip().root_translations()[49].distance(b.clip().root_translations()[10]);
        assert!(apart > 5.0 && (jump(0, false) - apart).abs() < 1e-6, "a flash over the whole way");
        assert!(jump(20, false) > 0.3, "a flight of a metre per tenth of a second");
        assert!(
            jump(0, true) < 0.15 && jump(20, true) < 0.05,
            "{} {}",
            jump(0, true),
            jump(20, true)
        );
    }
}

#[test]
fn dissolve_with_windows_of_0_and_1_is_the_same_cut() {
    let (a, b) = two_walks();
    for root in [RootBlend::Velocity, RootBlend::World] {
        let cut = |window| {
            dissolve(
                &a,
                50,
                &b,
                10,
                &DissolveOptions { window, root, ..DissolveOptions::default() },
            )
            .unwrap()
        };
        assert_eq!(cut(0), cut(1));
        assert!(cut(0).transition.is_empty() && cut(0).b_during.is_empty());
        // Right after A's last frame, and before its first.
        for leave in [0, 100] {
            let out = dissolve(
                &a,
                leave,
                &b,
                0,
                &DissolveOptions { window: 0, root, ..DissolveOptions::default() },
            )
            .unwrap();
            assert_eq!(out.clip.frames(), leave + 80);
            let start = out.clip.root_translations()[leave];
            assert!(
                (start - a.clip().root_translations()[leave.min(99)]).length() < 0.12,
                "{leave} {start}"
            );
        }
    }
}

#[test]
fn dissolve_as_a_cut_continues_with_the_step_of_b() {
    let (a, b) = two_walks();
    let out =
        dissolve(&a, 50, &b, 10, &DissolveOptions { window: 0, ..DissolveOptions::default() })
            .unwrap();
    let step = out.frames[49].inverse().after(&out.frames[50]);
    let own = b.ground_frames()[9].inverse().after(&b.ground_frames()[10]);
    assert!(
        (step.shift - own.shift).length() < 1e-9 && wrap_angle(step.yaw - own.yaw).abs() < 1e-9
    );
}

#[test]
fn dissolve_blends_joint_translations() {
    let clip = Walk { frames: 30, ..Walk::default() }.clip();
    let roles = Roles::detect(clip.skeleton());
    let tracked = |joint: usize, at: Vec3| {
        let track = JointTranslations { joint, values: vec![at; 30] };
        Motion::with_roles(Arc::new(clip.clone().with_translations(vec![track]).unwrap()), &roles)
    };
    let (a, b) = (tracked(2, Vec3::X), tracked(4, Vec3::Z));
    let out = dissolve(
        &a,
        10,
        &b,
        10,
        &DissolveOptions { window: 4, law: WeightLaw::Linear, ..DissolveOptions::default() },
    )
    .unwrap();
    let rest = body();
    let at = |frame: usize| out.clip.pose(frame).translations;
    assert_eq!(at(9), [(2, Vec3::X), (4, rest.joints()[4].offset)]);
    assert_eq!(at(13), [(2, rest.joints()[2].offset), (4, Vec3::Z)]);
    let half = |joint: usize, other: Vec3| (joint, (rest.joints()[joint].offset + other) * 0.5);
    assert_eq!(at(11), [half(2, Vec3::X), half(4, Vec3::Z)]);
}

#[test]
fn dissolve_of_incompatible_clips_is_refused() {
    let (a, b) = two_walks();
    let options = DissolveOptions { window: 30, ..DissolveOptions::default() };
    let refused = |leave, enter, options: &DissolveOptions| {
        dissolve(&a, leave, &b, enter, options).unwrap_err()
    };
    assert_eq!(
        refused(71, 0, &options),
        BlendError::Window { which: "outgoing", frames: 100, at: 71, window: 30 }
    );
    assert!(refused(71, 0, &options).to_string().contains("lower the window to 29"));
    assert_eq!(
        refused(10, 51, &options),
        BlendError::Window { which: "incoming", frames: 80, at: 51, window: 30 }
    );
    let cut = DissolveOptions { window: 0, ..options };
    assert!(matches!(refused(100, 80, &cut), BlendError::Window { which: "incoming", .. }));
    assert!(matches!(refused(usize::MAX, 0, &cut), BlendError::Window { which: "outgoing", .. }));
    let slow = source(Walk { fps: 30.0, ..Walk::default() });
    assert!(matches!(dissolve(&a, 0, &slow, 0, &options), Err(BlendError::FrameRates { .. })));
    let joint = Joint {
        name: "Hips".into(),
        parent: None,
        offset: Vec3::ZERO,
        end_site: None,
        channels: vec![],
    };
    let other = Clip::new(
        "point",
        Arc::new(Skeleton::new(vec![joint]).unwrap()),
        60.0,
        vec![Quat::IDENTITY; 50],
        vec![Vec3::ZERO; 50],
    )
    .unwrap();
    let other = Motion::with_roles(other, &Roles::default());
    assert!(matches!(dissolve(&a, 0, &other, 0, &options), Err(BlendError::Skeletons { .. })));
    let empty = Motion::with_roles(Arc::new(a.clip().crop(0..0).unwrap()), &Roles::default());
    assert!(dissolve(&empty, 0, &b, 0, &cut).is_err() && dissolve(&b, 0, &empty, 0, &cut).is_err());
}

/// Returns a character that stands in place and sways about a heading, with its left arm turning
/// about its bone in the same way.
fn swaying(heading: f32, phase: f32, arm: f32) -> Motion {
    let still = Walk { frames: 90, speed: 0.0, cadence: 0.0, swing: 0.0, ..Walk::default() };
    let clip = still.clip();
    let joints = clip.skeleton().len();
    let mut rotations: Vec<Quat> =
        (0..clip.frames()).flat_map(|f| clip.rotations(f).to_vec()).collect();
    for (frame, pose) in rotations.chunks_mut(joints).enumerate() {
        let sway = 0.08 * (frame as f32 * 0.5 + phase).sin();
        pose[0] = Quat::from_rotation_y(heading + sway) * pose[0];
        pose[joints - 1] = Quat::from_rotation_x(arm + sway) * pose[joints - 1];
    }
    let roots = clip.root_translations().to_vec();
    let swaying =
        Clip::new("swaying", Arc::clone(clip.skeleton()), clip.fps(), rotations, roots).unwrap();
    let roles = Roles::detect(swaying.skeleton());
    Motion::with_roles(swaying, &roles)
}

#[test]
fn dissolve_of_bodies_back_to_back_turns_one_way() {
    for (arm, align) in [(0.0, false), (PI, true), (PI, false)] {
        let (a, b) =
            (swaying(0.3, 0.0, 0.0), swaying(if align { 0.3 } else { 0.3 + PI }, 1.5, arm));
        // Without the sway either way round is half a turn in 39 steps.
        let options = DissolveOptions {
            window: 40,
            align,
            root: RootBlend::World,
            law: WeightLaw::Linear,
            ..DissolveOptions::default()
        };
        let out = dissolve(&a, 30, &b, 10, &options).unwrap();
        let steady = PI / 40.0 + 2.0 * 0.08 * 0.5;
        let joints = out.clip.skeleton().len();
        for frame in 1..out.clip.frames() {
            let [before, here] = [frame - 1, frame].map(|frame| out.clip.rotations(frame));
            for joint in [0, joints - 1] {
                let turned = quat::angle_between(before[joint], here[joint]);
                assert!(
                    turned < steady,
                    "arm {arm}, align {align}: joint {joint} turns by {turned} in frame {frame}"
                );
            }
            let yaw = wrap_angle(out.frames[frame].yaw - out.frames[frame - 1].yaw);
            assert!(yaw.abs() < f64::from(steady), "{frame}: {yaw}");
            let body = out.clip.rotations(frame)[0] * out.frames[frame].rotation().conjugate();
            let apart = quat::angle_between(
                body,
                out.clip.rotations(0)[0] * out.frames[0].rotation().conjugate(),
            );
            assert!(apart < 0.02, "the body faces where its frame does: {apart}");
        }
    }
}

#[test]
fn dissolve_aligned_by_first_pose_ignores_the_window() {
    let (a, b) = (source(Walk { turning: 0.6, ..Walk::default() }), source(Walk::default()));
    let options = DissolveOptions {
        window: 30,
        align_by: AlignBy::FirstPose,
        root: RootBlend::World,
        ..DissolveOptions::default()
    };
    let out = dissolve(&a, 40, &b, 12, &options).unwrap();
    let (stands, wanted) = (out.aligned_b.after(&b.ground_frames()[12]), a.ground_frames()[40]);
    assert!(
        stands.shift.distance(wanted.shift) < 1e-9
            && wrap_angle(stands.yaw - wanted.yaw).abs() < 1e-9
    );
    assert_eq!(out.world_from_b, out.aligned_b);
    // The window as a whole turns, and fits better elsewhere.
    let by_window =
        dissolve(&a, 40, &b, 12, &DissolveOptions { align_by: AlignBy::Window, ..options })
            .unwrap();
    assert!(wrap_angle(by_window.aligned_b.yaw - out.aligned_b.yaw).abs() > 0.02);
}
