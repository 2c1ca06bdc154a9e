//! Tests of gait cycles and of blending by speed.

use super::*;
use crate::clip::{
    ContactCorrections, Motion, StanceEnd, character_frames, ground_speed, resample, stillest_step,
};
use crate::gait::SpeedPlayer;
use crate::registration::fixtures::Walk;
use crate::synth::{Action, Params, synthesize};
use crate::transition::{FootLockOptions, foot_lock, treat_as_cycle};
use proptest::prelude::*;

fn find_cycle(clip: Clip) -> Result<(GaitCycle, Roles), GaitError> {
    let motion = Motion::analyze(clip);
    Ok((GaitCycle::find(&motion)?, motion.roles().clone()))
}

fn cycle(action: Action) -> (GaitCycle, Roles) {
    find_cycle(synthesize(&Params::new(action)).unwrap().clip).unwrap()
}

fn blend(options: &SpeedOptions) -> (SpeedBlend, Roles) {
    let (walk, roles) = cycle(Action::Walk);
    (SpeedBlend::new(&walk, &cycle(Action::Run).0, &roles, options).unwrap(), roles)
}

fn measured(clip: &Clip, roles: &Roles) -> f64 {
    f64::from(ground_speed(&character_frames(clip, roles), clip.fps()))
}

/// Returns the slide of planted feet in all, centimetres.
fn skate(clip: &Clip, contacts: &Contacts, roles: &Roles) -> f32 {
    let mut sum = 0.0;
    for side in Side::BOTH {
        let points = roles.foot_points(clip.skeleton(), side);
        let at = |frame: usize| -> Vec<Vec3> {
            let world = clip.world_pose(frame);
            points.iter().map(|&(joint, point)| world.point(joint, point)).collect()
        };
        for frame in 1..clip.frames() {
            if contacts.planted(side, frame) && contacts.planted(side, frame - 1) {
                sum += stillest_step(&at(frame - 1), &at(frame)).unwrap().length() * 100.0;
            }
        }
    }
    sum
}

#[test]
fn corrected_strikes_move_the_cycle_and_its_events() {
    let motion = Motion::analyze(synthesize(&Params::new(Action::Walk)).unwrap().clip);
    let found = GaitCycle::find(&motion).unwrap();
    // All strikes of both feet three frames later.
    let mut late = motion.contacts().clone();
    for side in Side::BOTH {
        for (index, stance) in motion.contacts().intervals(side).into_iter().enumerate() {
            late = late.with_end_at(side, index, StanceEnd::Strike, stance.start + 3);
        }
    }
    let corrections = ContactCorrections::between(motion.contacts(), &late);
    let corrected = GaitCycle::find(&motion.clone().with_contact_corrections(corrections)).unwrap();
    let frames = motion.contacts().intervals(Side::Left);
    let begins = |cycle: &GaitCycle, by: usize| {
        frames.iter().any(|stance| stance.start + by == cycle.range().start)
    };
    assert!(begins(&found, 0) && begins(&corrected, 3), "{:?}", corrected.range());
    let stance = |cycle: &GaitCycle| cycle.events().left_lift * cycle.range().len() as f64;
    assert!((stance(&found) - stance(&corrected) - 3.0).abs() < 1.5);

    // A single stride is closed at its own ends, and the contacts of the cycle are corrected, too.
    let stride = Motion::analyze(motion.clip().crop(found.range()).unwrap());
    let closed = GaitCycle::find(&stride).unwrap();
    let stance =
        |cycle: &GaitCycle| (cycle.events().left_lift * cycle.range().len() as f64).round();
    let lift = stride.contacts().intervals(Side::Left)[0].end;
    let early = stride.contacts().with_end_at(Side::Left, 0, StanceEnd::Lift, lift - 4);
    let corrections = ContactCorrections::between(stride.contacts(), &early);
    let corrected = GaitCycle::find(&stride.with_contact_corrections(corrections)).unwrap();
    assert_eq!(stance(&closed) - stance(&corrected), 4.0);
}

#[test]
fn speed_blend_agrees_with_numpy() {
    #[derive(serde::Deserialize)]
    struct Gait {
        speed: f64,
        secs: f64,
        #[serde(flatten)]
        events: Events,
    }
    #[derive(serde::Deserialize)]
    struct Case {
        speed: f64,
        made: f64,
        weight: f64,
        stride: f64,
        secs: f64,
        events: Events,
        walk: [Vec<f64>; 3],
        run: [Vec<f64>; 3],
    }
    #[derive(serde::Deserialize)]
    struct Golden {
        walk: Gait,
        run: Gait,
        ats: Vec<f64>,
        speeds: Vec<Case>,
    }
    let golden: Golden =
        serde_json::from_str(include_str!("../../../tests/oracles/gaits.json")).unwrap();
    let (mut blend, _) = blend(&SpeedOptions::default());
    for (gait, of) in blend.gaits.iter_mut().zip([&golden.walk, &golden.run]) {
        (gait.speed_mps, gait.secs, gait.events) = (of.speed, of.secs, of.events);
    }
    for wanted in golden.speeds {
        let facts = blend.facts(wanted.speed);
        let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-9, "{} m/s: {a} {b}", wanted.speed);
        close(facts.weight, wanted.weight);
        close(facts.speed_mps, wanted.made);
        close(facts.stride_m, wanted.stride);
        close(facts.cycle_secs, wanted.secs);
        close(facts.cadence_spm, 120.0 / wanted.secs);
        let events = blend.events(facts.weight);
        close(events.left_lift, wanted.events.left_lift);
        close(events.right_strike, wanted.events.right_strike);
        close(events.right_lift, wanted.events.right_lift);
        for (gait, phases) in blend.gaits.iter().zip([&wanted.walk, &wanted.run]) {
            for (index, &at) in golden.ats.iter().enumerate() {
                let find_cycle = blend.phases(gait, &events, at);
                (0..3).for_each(|part| close(find_cycle[part], phases[part][index]));
            }
        }
    }
}

#[test]
fn cycle_at_a_speed_has_that_speed() {
    let (blend, roles) = blend(&SpeedOptions::default());
    let [slow, fast] = blend.speeds_mps();
    assert!((slow - 1.4).abs() < 0.02 && (fast - 3.5).abs() < 0.02);
    for step in 0..=24 {
        let speed = 1.4 + 2.1 * f64::from(step) / 24.0;
        let (one, many) = (blend.cycle_at(speed).unwrap(), blend.clip_of(speed, 6.0).unwrap());
        for made in [&one, &many] {
            let off = measured(&made.clip, &roles) / speed - 1.0;
            assert!(off.abs() < 0.02, "{speed}: {off}");
            assert!(!made.facts.extrapolated && !made.facts.limited);
            assert!((made.facts.stride_m / made.facts.cycle_secs - speed).abs() < 1e-9);
        }
        // A cycle ends in the pose with which it began, one stride on.
        let [first, last] = [0, one.clip.frames() - 1].map(|frame| one.clip.rotations(frame));
        assert!(
            first.iter().zip(last).skip(1).all(|(a, b)| quat::angle_between(*a, *b) < 1e-4),
            "{speed}"
        );
        assert_eq!(many.clip.frames(), 361);
        // Further cycles repeat the first, and continue from its end.
        let (steps, thrice) = (one.clip.frames() - 1, blend.cycles_at(speed, 3).unwrap().clip);
        assert_eq!(thrice.frames(), 3 * steps + 1);
        for frame in [0, steps / 3, steps] {
            let [here, later] = [&one.clip, &thrice]
                .map(|clip| clip.rotations(frame + if clip == &thrice { steps } else { 0 }));
            assert!(
                here.iter().zip(later).skip(1).all(|(a, b)| quat::angle_between(*a, *b) < 1e-4),
                "{speed} {frame}"
            );
        }
    }
}

#[test]
fn cycle_at_the_speed_of_a_gait_is_that_gait() {
    for alignment in [PhaseAlignment::Feet, PhaseAlignment::Strikes, PhaseAlignment::None] {
        let options = SpeedOptions { alignment, ..SpeedOptions::default() };
        let (blend, _) = blend(&options);
        for (gait, action) in [Action::Walk, Action::Run].into_iter().enumerate() {
            let (cycle, _) = cycle(action);
            let made = blend.cycle_at(blend.speeds_mps()[gait]).unwrap().clip;
            let (own, count) = (&cycle.looped().clip, cycle.looped().clip.frames());
            assert_eq!(made.frames(), count + 1, "{alignment:?}");
            let begin = if alignment == PhaseAlignment::None {
                count - cycle.range().start % count
            } else {
                0
            };
            let at_origin = cycle.looped().frames[0].inverse();
            for frame in 0..count {
                let theirs = own.rotations((begin + frame) % count);
                let apart = made
                    .rotations(frame)
                    .iter()
                    .zip(theirs)
                    .skip(1)
                    .map(|(a, b)| quat::angle_between(*a, *b))
                    .fold(0.0, f32::max);
                assert!(apart < 1e-5, "{alignment:?} {frame} {apart}");
                if begin == 0 {
                    let root = at_origin.apply(own.root_translations()[frame]);
                    assert!(made.root_translations()[frame].distance(root) < 1e-4, "{frame}");
                }
            }
        }
    }
}

#[test]
fn cycle_aligned_by_feet_slides_less() {
    let of = |alignment| {
        let (blend, roles) = blend(&SpeedOptions { alignment, ..SpeedOptions::default() });
        let made = blend.clip_of(2.3, 4.0).unwrap();
        (skate(&made.clip, &made.contacts, &roles), made, roles)
    };
    let (feet, made, roles) = of(PhaseAlignment::Feet);
    assert!(feet < 0.6 * of(PhaseAlignment::None).0, "{feet}");
    let locked =
        foot_lock(&made.clip, &roles, &made.contacts, &FootLockOptions::default()).unwrap();
    assert!(skate(&locked, &made.contacts, &roles) < 0.02 * feet);
}

#[test]
fn cycles_at_a_speed_do_not_drift() {
    let (blend, roles) = blend(&SpeedOptions::default());
    let speed = blend.speeds_mps()[0];
    let facts = blend.facts(speed);
    let made = blend.clip_of(speed, facts.cycle_secs * 100.0).unwrap().clip;
    let steps = made.frames() / 100;
    let frames = character_frames(&made, &roles);
    let stride = |cycle: usize| frames[cycle * steps].inverse().after(&frames[(cycle + 1) * steps]);
    for cycle in [1, 50, 99] {
        let apart = made.rotations(7).iter().zip(made.rotations(cycle * steps + 7)).skip(1);
        assert!(apart.map(|(a, b)| quat::angle_between(*a, *b)).fold(0.0, f32::max) < 1e-4);
        assert!(
            stride(cycle).shift.distance(stride(0).shift) < 1e-3
                && (stride(cycle).yaw - stride(0).yaw).abs() < 1e-3
        );
    }
}

#[test]
fn clip_along_changing_speed_has_no_jump() {
    let (blend, roles) = blend(&SpeedOptions::default());
    let wanted = |secs: f64| {
        if secs < 2.0 {
            1.4
        } else if secs < 4.0 {
            3.5
        } else {
            1.0 + 2.5 * (3.0 * secs).sin().abs()
        }
    };
    let made = blend.clip_along(8.0, wanted).unwrap();
    let turns = |clip: &Clip| -> f32 {
        let steps = (1..clip.frames())
            .flat_map(|frame| clip.rotations(frame - 1).iter().zip(clip.rotations(frame)));
        steps.map(|(a, b)| quat::angle_between(*a, *b)).fold(0.0, f32::max)
    };
    let steady = turns(&blend.clip_of(3.5, 3.0).unwrap().clip)
        .max(turns(&blend.clip_of(1.4, 3.0).unwrap().clip));
    assert!(turns(&made.clip) < 1.5 * steady, "{} {steady}", turns(&made.clip));
    let frames = character_frames(&made.clip, &roles);
    for pair in frames.windows(2) {
        assert!(pair[0].shift.distance(pair[1].shift) * 60.0 < 4.2);
    }
    // A player gives the same poses, one by one.
    let mut player = SpeedPlayer::new(&blend, wanted(0.0));
    let close = |pose: &Pose, frame: usize| {
        let other = made.clip.pose(frame);
        assert!(pose.root_translation.distance(other.root_translation) < 1e-4, "{frame}");
        assert!(
            pose.rotations
                .iter()
                .zip(&other.rotations)
                .all(|(a, b)| quat::angle_between(*a, *b) < 1e-4)
        );
    };
    close(&player.pose(&blend), 0);
    for frame in 1..made.clip.frames() {
        let pose = player.advance(&blend, 1.0 / 60.0, wanted(frame as f64 / 60.0));
        close(&pose, frame);
        assert_eq!(
            player.planted(&blend),
            Side::BOTH.map(|side| made.contacts.planted(side, frame))
        );
    }
    assert!(
        (player.here().shift.length() - frames[480].shift.length()).abs() < 0.05
            && player.phase() > 8.0
    );
    // Invalid steps count as 0.
    let before = player;
    for dt in [0.0, -1.0, f64::NAN] {
        player.advance(&blend, dt, f64::NAN);
        assert_eq!((player.phase(), player.here()), (before.phase(), before.here()));
    }
}

/// Returns a part of a made gait with the length of `share` of its cycle.
fn part_of_a_cycle(action: Action, from: usize, share: f64) -> (Clip, GaitCycle) {
    let clip = synthesize(&Params::new(action)).unwrap().clip;
    let (whole, _) = find_cycle(clip.clone()).unwrap();
    let frames = (share * whole.looped().clip.frames() as f64).round() as usize;
    (clip.crop(from..from + frames).unwrap(), whole)
}

#[test]
fn gait_cycle_of_a_single_cycle_is_closed_at_its_ends() {
    for action in [Action::Walk, Action::Run] {
        for share in [1.3, 1.02, 1.0, 0.93] {
            for from in (40..100).step_by(7) {
                let (part, whole) = part_of_a_cycle(action, from, share);
                let name = format!("{action:?} {share} from {from}");
                let (cycle, roles) =
                    find_cycle(part).unwrap_or_else(|error| panic!("{name}: {error}"));
                let within = 0.02;
                let off = cycle.speed_mps() / whole.speed_mps() - 1.0;
                assert!(off.abs() < within, "{name}: {off}");
                let secs = cycle.secs() / whole.secs() - 1.0;
                assert!(secs.abs() < 2.0 * within, "{name}: {secs}");
                let (find_cycle, wanted) = (cycle.events(), whole.events());
                let apart = [
                    find_cycle.left_lift - wanted.left_lift,
                    find_cycle.right_strike - wanted.right_strike,
                    find_cycle.right_lift - wanted.right_lift,
                ];
                assert!(
                    apart.iter().all(|apart| apart.abs() < 0.1),
                    "{name}: {find_cycle:?} {wanted:?}"
                );
                assert!(cycle.looped().seam.turn_deg < 1e-3, "{name}");
                let own = measured(&cycle.looped().repeat(3).unwrap(), &roles);
                assert!((own / cycle.speed_mps() - 1.0).abs() < 0.02, "{name}");
            }
        }
    }
}

#[test]
fn speed_blend_of_single_cycles_has_the_requested_speed() {
    for (share, from) in [(1.0, 40), (0.9, 55), (1.02, 71)] {
        let [(walk, roles), (run, _)] = [Action::Walk, Action::Run]
            .map(|action| find_cycle(part_of_a_cycle(action, from, share).0).unwrap());
        let blend = SpeedBlend::new(&walk, &run, &roles, &SpeedOptions::default()).unwrap();
        for speed in [1.5, 2.0, 3.0] {
            let off = measured(&blend.clip_of(speed, 6.0).unwrap().clip, &roles) / speed - 1.0;
            assert!(off.abs() < 0.02, "{share} {speed}: {off}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    /// For every request, time runs forwards and the stride is positive.
    #[test]
    fn cycle_at_any_speed_is_a_motion(
        speed in prop_oneof![-5.0f64..20.0, Just(f64::NAN), Just(f64::INFINITY), Just(-1e300)],
    ) {
        let (blend, _) = blend(&SpeedOptions::default());
        let facts = blend.facts(speed);
        prop_assert!(
            blend.range_mps().contains(&(facts.speed_mps * (1.0 + 1e-12)))
                || blend.range_mps().contains(&(facts.speed_mps * (1.0 - 1e-12)))
        );
        prop_assert!(
            facts.cycle_secs > 0.2
                && facts.stride_m > 0.1
                && (-0.25..=1.25).contains(&facts.weight)
        );
        prop_assert_eq!(facts.limited, !blend.range_mps().contains(&speed) && !speed.is_nan());
        let made = blend.cycle_at(speed).unwrap();
        prop_assert!(
            made.clip.world_positions(0..made.clip.frames()).iter().all(|p| p.is_finite())
        );
    }

    /// Phases rise, coincide at events, and one cycle of the blend is one cycle of each gait.
    #[test]
    fn phases_rise_and_meet_at_events(
        speed in 0.9f64..4.0,
        at in -2.0f64..3.0,
        by in 0.001f64..0.5,
    ) {
        let (blend, _) = blend(&SpeedOptions::default());
        let events = blend.events(blend.facts(speed).weight);
        for gait in &blend.gaits {
            let (here, there, later) = (
                blend.phases(gait, &events, at),
                blend.phases(gait, &events, at + by),
                blend.phases(gait, &events, at + 1.0),
            );
            for part in 0..3 {
                prop_assert!(
                    there[part] > here[part] && (later[part] - here[part] - 1.0).abs() < 1e-9
                );
            }
            let right = Part::Leg(Side::Right).index();
            prop_assert!(
                (blend.phases(gait, &events, events.right_lift)[right] - gait.events.right_lift)
                    .abs()
                    < 1e-9
            );
            prop_assert!(
                (blend.phases(gait, &events, events.right_strike)[0] - gait.events.right_strike)
                    .abs()
                    < 1e-9
            );
            prop_assert!(
                (blend.phases(gait, &events, events.left_lift)[1] - gait.events.left_lift).abs()
                    < 1e-9
            );
        }
    }
}

#[test]
fn gait_cycle_begins_with_the_left_strike() {
    for (action, duty) in [(Action::Walk, 0.60), (Action::Run, 0.34)] {
        let made = synthesize(&Params {
            seed: 3,
            duration_secs: 6.0,
            turn_rate_dps: 15.0,
            ..Params::new(action)
        })
        .unwrap();
        let truth = made.truth;
        let (cycle, _) = find_cycle(made.clip).unwrap();
        let from_strike = |phase: f32| phase.min(1.0 - phase);
        assert!(from_strike(truth.phase[cycle.range().start]) < 0.06, "{action:?}");
        assert!((cycle.secs() - f64::from(truth.cycle_secs)).abs() < 0.03);
        let events = cycle.events();
        assert!(
            (events.left_lift - duty).abs() < 0.08
                && (events.right_lift - events.right_strike - duty).abs() < 0.08,
            "{events:?}"
        );
        assert!((events.right_strike - 0.5).abs() < 0.05);
        // A walk on a curve.
        assert!((cycle.looped().cycle.yaw / cycle.secs() - 15.0_f64.to_radians()).abs() < 0.03);
    }
}

#[test]
fn speed_blend_accepts_other_rates_and_refuses_invalid_input() {
    let (walk, roles) = cycle(Action::Walk);
    let run = synthesize(&Params::new(Action::Run)).unwrap().clip;
    let (coarse, _) =
        find_cycle(resample(&run, 30.0, crate::clip::Interpolation::Cubic).unwrap()).unwrap();
    let options = SpeedOptions::default();
    let mixed = SpeedBlend::new(&walk, &coarse, &roles, &options).unwrap();
    let made = mixed.clip_of(2.5, 5.0).unwrap();
    assert!((measured(&made.clip, &roles) / 2.5 - 1.0).abs() < 0.02 && made.clip.fps() == 60.0);
    assert!(matches!(
        SpeedBlend::new(&walk, &walk, &roles, &options),
        Err(GaitError::Speeds { .. })
    ));
    let small = Walk { frames: 400, speed: 1.0, cadence: 0.9, ..Walk::default() };
    if let Ok((other, _)) = find_cycle(small.clip()) {
        assert!(matches!(
            SpeedBlend::new(&walk, &other, &roles, &options),
            Err(GaitError::Skeletons { .. })
        ));
    }
    let wrong = SpeedOptions { half_life_secs: -1.0, ..options };
    assert!(matches!(
        SpeedBlend::new(&walk, &coarse, &roles, &wrong),
        Err(GaitError::Option { .. })
    ));
    for secs in [-1.0, f64::NAN, 1e9] {
        assert!(matches!(mixed.clip_of(2.0, secs), Err(GaitError::Option { .. })));
    }
    for still in [
        synthesize(&Params::new(Action::Idle)).unwrap().clip,
        run.crop(0..0).unwrap(),
        run.crop(0..20).unwrap(),
    ] {
        assert!(matches!(find_cycle(still), Err(GaitError::NoCycle { .. })));
    }
}

/// A third of a second of a run is no cycle by itself.
#[test]
fn declared_cycle_is_taken_whole() {
    let run = synthesize(&Params::new(Action::Run)).unwrap().clip;
    let source = Motion::analyze(run.crop(0..20).unwrap());
    assert!(matches!(GaitCycle::find(&source), Err(GaitError::NoCycle { .. })));
    let declared = treat_as_cycle(&source).unwrap();
    let last = declared.clip().frames() - 1;
    let gait = GaitCycle::find(&declared).unwrap();
    assert_eq!(gait.looped().clip.frames(), last);
    assert!((gait.secs() - last as f64 / declared.clip().fps()).abs() < 1e-9);
    assert!(gait.speed_mps() > 2.5, "{} m/s", gait.speed_mps());
    // It blends with a walk, although its feet do not strike once each.
    let (walk, roles) = cycle(Action::Walk);
    let middle = 0.5 * (gait.speed_mps() + walk.speed_mps());
    let mixed = SpeedBlend::new(&walk, &gait, &roles, &SpeedOptions::default()).unwrap();
    let made = mixed.cycles_at(middle, 3).unwrap();
    assert!((measured(&made.clip, &roles) - middle).abs() < 0.1 * middle);
}
