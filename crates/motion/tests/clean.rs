//! Faults that are put into synthesised motions are found, and mended.

#![expect(clippy::unwrap_used, reason = "what fails here fails the test")]

use glam::{Quat, Vec3};
use proptest::prelude::*;
use segue_motion::clean::{
    Damage, Fault, FaultKind, MendOptions, damage, false_alarms, find_faults, mend,
};
use segue_motion::clip::{Clip, Interpolation, Motion, resample};
use segue_motion::skeleton::{Role, Side};
use segue_motion::synth::{Action, Params, synthesize};
use std::sync::Arc;

fn made(action: Action, fps: f32, seed: u32) -> Arc<Motion> {
    let params = Params { fps, seed, duration_secs: 6.0, ..Params::new(action) };
    Arc::new(Motion::analyze(synthesize(&params).unwrap().clip))
}

fn changed(clip: &Clip, mut change: impl FnMut(usize, &mut [Quat], &mut Vec3)) -> Arc<Motion> {
    let (mut rotations, mut roots) = (Vec::new(), Vec::new());
    for frame in 0..clip.frames() {
        let (mut pose, mut root) =
            (clip.rotations(frame).to_vec(), clip.root_translations()[frame]);
        change(frame, &mut pose, &mut root);
        rotations.extend(pose);
        roots.push(root);
    }
    let skeleton = Arc::clone(clip.skeleton());
    let clip = Clip::new("changed", skeleton, clip.fps(), rotations, roots).unwrap();
    Arc::new(Motion::analyze(clip))
}

/// Returns the faults that are sure.
fn sure_faults(motion: &Arc<Motion>) -> Vec<Fault> {
    find_faults(motion).into_iter().filter(Fault::is_sure).collect()
}

fn of_kind(faults: &[Fault], kind: FaultKind) -> Vec<&Fault> {
    faults.iter().filter(|fault| fault.kind == kind).collect()
}

fn mended(motion: &Arc<Motion>, faults: &[&Fault]) -> Arc<Motion> {
    mend(motion, faults, &MendOptions::default()).unwrap().motion
}

/// Returns the largest distance between the same joints of two clips in a frame, metres.
fn apart_m(a: &Clip, b: &Clip) -> f32 {
    let (a, b) = (a.world_positions(0..a.frames()), b.world_positions(0..b.frames()));
    assert_eq!(a.len(), b.len());
    a.iter().zip(&b).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max)
}

#[test]
fn sound_motions_have_no_faults_of_joints() {
    for action in Action::ALL {
        for fps in [30.0, 60.0, 120.0] {
            let faults = sure_faults(&made(action, fps, 3));
            assert_eq!(false_alarms(&faults, &[]), 0, "{action:?} at {fps}: {faults:#?}");
            assert!(of_kind(&faults, FaultKind::Rate).is_empty(), "{action:?} at {fps}");
            assert!(of_kind(&faults, FaultKind::Drift).is_empty(), "{action:?} at {fps}");
        }
    }
}

#[test]
fn faults_put_into_motions_are_found_and_mended() {
    let (mut put, mut found, mut alarms, mut secs) = (0, 0, 0, 0.0);
    let (mut before, mut after) = (0.0, 0.0);
    for number in 0..20_u32 {
        let action = Action::ALL[number as usize % Action::ALL.len()];
        let original = made(action, [30.0, 60.0, 120.0][number as usize % 3], number + 1);
        let spoilt = damage(original.clip(), original.roles(), 5, u64::from(number)).unwrap();
        let motion = Arc::new(Motion::analyze(spoilt.clip));
        let faults = sure_faults(&motion);
        put += spoilt.damages.len();
        found += spoilt.damages.iter().filter(|damage| damage.is_found_in(&faults)).count();
        alarms += false_alarms(&faults, &spoilt.damages);
        secs += original.clip().duration_secs();
        let of_joints: Vec<&Fault> = faults.iter().filter(|f| f.is_in_tracks()).collect();
        let sound = mended(&motion, &of_joints);
        before += rms(original.clip(), motion.clip(), &spoilt.damages);
        after += rms(original.clip(), sound.clip(), &spoilt.damages);
    }
    assert!(put >= 90, "{put}");
    assert!(found * 100 >= put * 95, "{found} of {put}");
    assert!(f64::from(alarms as u32) <= 2.0 * secs / 60.0, "{alarms} in {secs} s");
    assert!(after < 0.12 * before, "{after} m of {before} m are left");
}

/// Returns the root mean square distance in the damaged frames, metres.
fn rms(a: &Clip, b: &Clip, damages: &[Damage]) -> f64 {
    let (mut sum, mut count) = (0.0, 0);
    for damage in damages {
        let [a, b] = [a, b].map(|clip| clip.world_positions(damage.frames.clone()));
        sum += a.iter().zip(&b).map(|(a, b)| f64::from(a.distance_squared(*b))).sum::<f64>();
        count += a.len();
    }
    (sum / f64::from(count.max(1) as u32)).sqrt()
}

#[test]
fn mend_of_no_fault_changes_nothing() {
    let motion = made(Action::Walk, 60.0, 2);
    assert_eq!(mended(&motion, &[]).clip(), motion.clip());
}

#[test]
fn joint_turned_over_keeps_its_motion() {
    let walk = made(Action::Walk, 60.0, 0);
    let arm = walk.roles().get(Role::LeftUpperArm).unwrap();
    let over = Quat::from_axis_angle(Vec3::Y, 3.0);
    let motion = changed(walk.clip(), |frame, pose, _| {
        if (60..110).contains(&frame) {
            pose[arm] = over * pose[arm];
        }
    });
    let faults = find_faults(&motion);
    let spikes = of_kind(&faults, FaultKind::Spike);
    assert_eq!(spikes.len(), 1, "{faults:#?}");
    assert_eq!((spikes[0].frames.clone(), &spikes[0].joints), (60..110, &vec![arm]));
    let sound = mended(&motion, &spikes);
    assert!(apart_m(sound.clip(), walk.clip()) < 0.02, "{}", apart_m(sound.clip(), walk.clip()));
}

#[test]
fn sunken_and_sloping_ground_is_levelled() {
    let walk = made(Action::Walk, 60.0, 0);
    for (lift, rise_mps) in [(-0.2_f32, 0.0_f32), (0.3, 0.0), (0.0, 0.03), (0.1, -0.04)] {
        let motion = changed(walk.clip(), |frame, _, root| {
            root.y += lift + rise_mps * frame as f32 / 60.0;
        });
        let faults = find_faults(&motion);
        let ground = of_kind(&faults, FaultKind::Ground);
        assert_eq!(ground.len(), 1, "{lift} {rise_mps}: {faults:#?}");
        let level = mended(&motion, &ground);
        let off = apart_m(level.clip(), walk.clip());
        assert!(off < 0.035, "{lift} {rise_mps}: {off} m");
    }
}

#[test]
fn drift_of_planted_feet_is_taken_out() {
    let walk = made(Action::Walk, 60.0, 0);
    let motion = changed(walk.clip(), |frame, _, root| root.x += 0.05 * frame as f32 / 60.0);
    let faults = find_faults(&motion);
    let drift = of_kind(&faults, FaultKind::Drift);
    assert_eq!(drift.len(), 1, "{faults:#?}");
    let still = mended(&motion, &drift);
    let end = walk.clip().frames() - 1;
    let off = still.clip().root_translations()[end].distance(walk.clip().root_translations()[end]);
    assert!(off < 0.06, "{off} m left of 0.3 m");
}

#[test]
fn drift_that_turns_is_taken_out() {
    let idle = made(Action::Idle, 60.0, 0);
    let motion = changed(idle.clip(), |frame, pose, root| {
        let turn = Quat::from_rotation_y((4.0_f32 * frame as f32 / 60.0).to_radians());
        pose[0] = turn * pose[0];
        *root = turn * (*root - Vec3::X) + Vec3::X;
    });
    let faults = find_faults(&motion);
    let drift = of_kind(&faults, FaultKind::Drift);
    assert_eq!(drift.len(), 1, "{faults:#?}");
    let off = apart_m(mended(&motion, &drift).clip(), idle.clip());
    assert!(off < 0.05, "{off} m");
}

#[test]
fn t_pose_and_still_ends_are_cut_off() {
    let walk = made(Action::Walk, 60.0, 0);
    let clip = walk.clip();
    let held = 90;
    let (mut rotations, mut roots) = (Vec::new(), Vec::new());
    for _ in 0..4 {
        rotations.extend(vec![Quat::IDENTITY; clip.skeleton().len()]);
        roots.push(clip.root_translations()[0]);
    }
    for frame in (0..clip.frames()).chain([clip.frames() - 1; 90]) {
        rotations.extend_from_slice(clip.rotations(frame));
        roots.push(clip.root_translations()[frame]);
    }
    let skeleton = Arc::clone(clip.skeleton());
    let long = Clip::new("long", skeleton, 60.0, rotations, roots).unwrap();
    let motion = Arc::new(Motion::analyze(long));
    let faults = find_faults(&motion);
    let ends = of_kind(&faults, FaultKind::Ends);
    assert_eq!(ends.len(), 2, "{faults:#?}");
    assert_eq!(ends[0].frames, 0..4);
    assert!(ends[0].confidence > 0.5 && ends[1].confidence < 0.5, "standing may be meant");
    let cut = mend(&motion, &ends, &MendOptions::default()).unwrap();
    assert_eq!(cut.frames.start, 4);
    assert!(cut.motion.clip().frames() < clip.frames() + held / 3);
    assert_eq!(cut.motion.clip().rotations(0), clip.rotations(0));
}

#[test]
fn wrong_rate_is_told_and_its_mend_plays_the_same_frames_at_the_likely_one() {
    for action in [Action::Walk, Action::Run] {
        let motion = made(action, 120.0, 0);
        let slow = motion.clip().clone();
        let rotations: Vec<Quat> =
            (0..slow.frames()).flat_map(|f| slow.rotations(f).to_vec()).collect();
        let skeleton = Arc::clone(slow.skeleton());
        let roots = slow.root_translations().to_vec();
        let slow = Clip::new("slow", skeleton, 30.0, rotations, roots).unwrap();
        let slow = Arc::new(Motion::analyze(slow));
        let faults = find_faults(&slow);
        let rate = of_kind(&faults, FaultKind::Rate);
        assert_eq!(rate.len(), 1, "{action:?}: {faults:#?}");
        let fps = rate[0].likely_fps().unwrap();
        assert!((90.0..=150.0).contains(&fps), "{action:?}: {fps}");
        let mended = mended(&slow, &rate);
        assert_eq!(mended.clip().fps(), fps);
        assert_eq!(**mended.clip(), Clip::clone(slow.clip()).at_rate(fps).unwrap());
        assert!(of_kind(&find_faults(&mended), FaultKind::Rate).is_empty());
    }
}

#[test]
fn skating_feet_stand_after_the_mend() {
    let walk = made(Action::Walk, 60.0, 0);
    // The body glides on by a wave, so that no even drift explains it.
    let motion = changed(walk.clip(), |frame, _, root| {
        root.x += 0.12 * (frame as f32 / 60.0 * 2.3).sin();
    });
    let faults = find_faults(&motion);
    let skating = of_kind(&faults, FaultKind::Skating);
    assert!(!skating.is_empty(), "{faults:#?}");
    let held = mended(&motion, &skating);
    let slide = |motion: &Motion| {
        let (clip, roles) = (motion.clip(), motion.roles());
        segue_motion::metrics::worst_foot_slide(clip, roles, motion.contacts()).unwrap().value
    };
    assert!(slide(&held) < 0.3 * slide(&motion), "{} of {}", slide(&held), slide(&motion));
}

#[test]
fn odd_clips_are_searched_without_harm() {
    let walk = made(Action::Walk, 60.0, 0);
    for frames in [0, 1, 2, 3, 4, 5, 8, 13] {
        let short = Arc::new(Motion::analyze(walk.clip().crop(0..frames).unwrap()));
        let faults = find_faults(&short);
        let all: Vec<&Fault> = faults.iter().collect();
        assert!(mended(&short, &all).clip().frames() <= frames);
        let spoilt = damage(short.clip(), short.roles(), 4, 1).unwrap();
        assert_eq!(spoilt.clip.frames(), frames);
    }
    // Two frames a second, and a thousand.
    for fps in [2.0, 1_000.0] {
        let other = resample(walk.clip(), fps, Interpolation::Linear).unwrap();
        let motion = Arc::new(Motion::analyze(other));
        assert!(find_faults(&motion).iter().all(|f| f.frames.end <= motion.clip().frames()));
    }
    // No body part is known, and only one side.
    let roles = segue_motion::skeleton::Roles::default();
    let unknown = Arc::new(Motion::with_roles(Arc::clone(walk.clip()), &roles));
    assert_eq!(false_alarms(&find_faults(&unknown), &[]), 0);
    let mut one_leg = walk.roles().clone();
    one_leg.set(Role::thigh(Side::Right), None);
    let one_leg = Arc::new(Motion::with_roles(Arc::clone(walk.clip()), &one_leg));
    assert_eq!(false_alarms(&find_faults(&one_leg), &[]), 0);
}

#[test]
fn faults_of_another_clip_are_refused() {
    let walk = made(Action::Walk, 60.0, 0);
    let spoilt = damage(walk.clip(), walk.roles(), 3, 1).unwrap();
    let motion = Arc::new(Motion::analyze(spoilt.clip));
    let faults = find_faults(&motion);
    let short = Arc::new(Motion::analyze(walk.clip().crop(0..10).unwrap()));
    let all: Vec<&Fault> = faults.iter().collect();
    assert!(mend(&short, &all, &MendOptions::default()).is_err());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    #[test]
    fn one_spike_is_found_where_it_is(
        seed in 1_u32..50, at in 0.15_f32..0.85, degrees in 20.0_f32..120.0, length in 1_usize..4,
    ) {
        let walk = made(Action::Walk, 60.0, seed);
        let shin = walk.roles().get(Role::LeftForearm).unwrap();
        let start = (at * walk.clip().frames() as f32) as usize;
        let turn = Quat::from_axis_angle(Vec3::new(0.6, 0.0, 0.8), degrees.to_radians());
        let motion = changed(walk.clip(), |frame, pose, _| {
            if (start..start + length).contains(&frame) {
                pose[shin] = turn * pose[shin];
            }
        });
        let faults = find_faults(&motion);
        let spikes = of_kind(&faults, FaultKind::Spike);
        prop_assert_eq!(spikes.len(), 1);
        prop_assert_eq!(spikes[0].frames.clone(), start..start + length);
        let off = apart_m(mended(&motion, &spikes).clip(), walk.clip());
        prop_assert!(off < 0.03, "{} m", off);
    }
}
