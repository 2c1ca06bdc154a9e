//! Tests of controllers driven by recordings.

use super::*;
use crate::math::{Decay, wrap_angle};
use crate::transition::Inertialization;

#[test]
fn recording_replays_bit_for_bit_at_any_screen_rate() {
    let recording = Scenario::Spin.recording();
    let again = Recording::from_text(&recording.to_text()).unwrap();
    let first = drive(small_database(), options(), &recording).unwrap();
    assert_eq!(drive(small_database(), options(), &again).unwrap(), first);
    for method in [SearchMethod::Scan, SearchMethod::Tree] {
        let other =
            drive(small_database(), ControllerOptions { method, ..options() }, &recording).unwrap();
        assert_eq!(other.clip, first.clip, "{method:?}");
    }
    // 144 Hz and 25 Hz give the same ticks.
    for rate in [144.0, 25.0] {
        let mut controller =
            Controller::new(Arc::clone(small_database()), options(), &Planar::IDENTITY).unwrap();
        let control = Control::new(DVec2::new(0.0, 1.4), None);
        let ticks: usize =
            (0..(2.0 * rate) as usize).map(|_| controller.step(1.0 / rate, &control)).sum();
        assert!(ticks.abs_diff(120) <= 1);
        while controller.ticks() < 120 {
            controller.tick(&control);
        }
        assert_eq!(controller.pose().root_translation, first.clip.root_translations()[119]);
        assert!(
            controller.shown().root_translation.distance(controller.pose().root_translation) < 0.05
        );
        assert_eq!(controller.step(f64::NAN, &control) + controller.step(-1.0, &control), 0);
        assert!(controller.step(1e9, &control) <= 60);
    }
}

#[test]
fn scenarios_are_followed_without_stutter_or_skating_feet() {
    for scenario in Scenario::ALL {
        assert_eq!(Scenario::find(scenario.id()), Some(scenario));
        let driven = drive(small_database(), options(), &scenario.recording()).unwrap();
        let metrics = driven.metrics(small_database());
        assert!(
            metrics.error_cm < 10.0 && metrics.worst_error_cm < 36.0,
            "{scenario:?} {metrics:?}"
        );
        assert!(metrics.turn_secs.unwrap_or(0.0) <= 1.2, "{scenario:?} {metrics:?}");
        assert!(metrics.skate_cm.unwrap() < 2.5, "{scenario:?} {metrics:?}");
        assert!(metrics.seams_per_minute < 100.0, "{scenario:?} {metrics:?}");
        assert_eq!(
            metrics.turn_secs.is_some(),
            matches!(scenario, Scenario::TurnLeft | Scenario::TurnRight | Scenario::Spin)
        );
    }
    let straight = drive(small_database(), options(), &Scenario::WalkStraight.recording()).unwrap();
    let settled = straight.jumps.iter().filter(|jump| jump.frame > 180).count();
    assert!(settled <= 5, "{:?}", straight.jumps);
}

#[test]
fn jumps_have_continuous_poses_and_velocities() {
    let driven = drive(
        small_database(),
        ControllerOptions { planting: None, following: None, ..options() },
        &Scenario::FigureEight.recording(),
    )
    .unwrap();
    let clip = &driven.clip;
    let step = |frame: usize| {
        let turned = clip.rotations(frame - 1).iter().zip(clip.rotations(frame));
        turned.map(|(&a, &b)| crate::math::quat::angle_between(a, b)).fold(0.0, f32::max)
    };
    let most = (1..clip.frames()).map(step).fold(0.0, f32::max);
    assert!(driven.jumps.len() > 3);
    for jump in driven.jumps.iter().filter(|jump| jump.frame > 1) {
        // It starts with the velocity that it had; the pull of an offset of half a radian in one
        // tick is 0.03.
        let (before, at) = (step(jump.frame.saturating_sub(1)), step(jump.frame));
        // The velocity is that of the old clip's next step, which may be longer than the step
        // before.
        let motion = &small_database().motions()[jump.from.place.motion];
        let next = motion.next(jump.from.place.frame).unwrap_or(jump.from.place.frame);
        let own = (motion.clip().rotations(jump.from.place.frame).iter())
            .zip(motion.clip().rotations(next))
            .skip(1)
            .map(|(&a, &b)| crate::math::quat::angle_between(a, b))
            .fold(0.0, f32::max);
        assert!(at < before.max(own) + 0.05, "{jump:?} {before} {own} {at}");
    }
    assert!(most < 0.5, "{most}");
}

/// A change of the half-life in the middle of a jump keeps the offset's velocity.
#[test]
fn options_changed_during_a_jump_keep_the_velocity() {
    let options = |half_life_secs| ControllerOptions {
        transition: Inertialization::Offset(Decay::Spring { half_life_secs }),
        planting: None,
        following: None,
        ..options()
    };
    let recording = Scenario::StartStop.recording();
    let mut compared = 0;
    for ticks_after_jump in [1, 4, 8] {
        let start = || {
            Controller::new(Arc::clone(small_database()), options(0.15), &Planar::IDENTITY).unwrap()
        };
        let (mut kept, mut changed) = (start(), start());
        let mut since_jump = usize::MAX;
        for control in recording.controls() {
            let jumps = kept.jumps();
            kept.tick(&control);
            changed.tick(&control);
            since_jump = if kept.jumps() > jumps { 0 } else { since_jump.saturating_add(1) };
            if since_jump != ticks_after_jump {
                continue;
            }
            changed.set_options(options(0.1501)).unwrap();
            let ahead = [&mut kept, &mut changed].map(|controller| {
                controller.tick(&control);
                controller.pose().rotations.clone()
            });
            let [a, b] = &ahead;
            let apart = a
                .iter()
                .zip(b)
                .map(|(&a, &b)| crate::math::quat::angle_between(a, b))
                .fold(0.0, f32::max);
            // Nearly the same half-life, nearly the same pose a tick later: 1e-3 rad are 3.4
            // degrees per second.
            assert!(apart < 1e-3, "{ticks_after_jump}: {apart}");
            compared += 1;
            break;
        }
    }
    assert_eq!(compared, 3);
}

#[test]
fn search_record_has_reason_and_costs() {
    let options = ControllerOptions { candidates: 6, ..options() };
    let mut controller =
        Controller::new(Arc::clone(small_database()), options, &Planar::new(0.4, 2.0, -1.0))
            .unwrap();
    assert!(controller.root().shift.distance(DVec2::new(2.0, -1.0)) < 1e-9);
    let control = Control::new(DVec2::new(1.0, 1.0), None);
    for _ in 0..90 {
        controller.tick(&control);
    }
    let search = controller.last_search().unwrap();
    assert_eq!(search.candidates.first(), search.winner.as_ref());
    assert!(
        search.candidates.len() == 6
            && search.candidates.windows(2).all(|pair| pair[0].cost <= pair[1].cost)
    );
    for candidate in search.candidates.iter().chain([&search.current]) {
        assert!(
            (candidate.split.iter().sum::<f32>() - candidate.cost).abs()
                < 1e-4 * candidate.cost.max(1.0)
        );
        assert!(small_database().pose(candidate.place, &controller.root()).is_some());
    }
    assert_eq!((controller.desired().len(), controller.matched().len()), (3, 3));
    assert!(serde_json::to_string(search).is_ok());
    // Weights apply at once, options are checked.
    let mut other = options;
    other.weights.0[0] = -1.0;
    assert!(matches!(controller.set_options(other), Err(MatchError::Setting { .. })));
    other.weights.0 = [0.0, 0.0, 1.0, 1.0, 1.0];
    controller.set_options(other).unwrap();
    controller.tick(&control);
    let tagged = small_database().retagged(0, &[]);
    controller.set_database(Arc::new(tagged));
    controller.tick(&control);
    assert!(controller.pose().root_translation.is_finite());
}

#[test]
fn planted_feet_stand_still() {
    let recording = Scenario::WalkToRun.recording();
    let slide = |planting| {
        let driven =
            drive(small_database(), ControllerOptions { planting, ..options() }, &recording)
                .unwrap();
        driven.metrics(small_database()).skate_cm.unwrap()
    };
    let (with, without) = (slide(options().planting), slide(None));
    assert!(with < 0.5 * without, "{with} {without}");
}

#[test]
fn controller_of_walks_is_not_pulled_faster_than_its_clips() {
    let walk = Motion::analyze(synthesize(&Params::new(Action::Walk)).unwrap().clip);
    let database =
        Arc::new(Database::new(vec![Arc::new(walk)], &DatabaseOptions::default()).unwrap());
    let mut controller =
        Controller::new(Arc::clone(&database), options(), &Planar::IDENTITY).unwrap();
    let (rate, pace) = (RATE as f64, database.pace());
    assert!(pace.travel_mps < 1.6 && pace.turn_radps < 0.5, "{pace:?}");
    let (mut fastest, mut fastest_turn, mut farthest) = (0.0_f64, 0.0_f64, 0.0_f64);
    for tick in 0..480 {
        let velocity = if tick < 240 { DVec2::new(0.0, 3.2) } else { DVec2::new(0.0, -3.2) };
        let before = controller.root();
        controller.tick(&Control::new(velocity, None));
        let (root, simulation) = (controller.root(), controller.simulation());
        fastest = fastest.max(root.shift.distance(before.shift) * rate);
        fastest_turn = fastest_turn.max(wrap_angle(root.yaw - before.yaw).abs() * rate);
        farthest = farthest.max(root.shift.distance(simulation.position));
    }
    assert!(fastest < 1.2 * pace.travel_mps, "{fastest}");
    assert!(fastest_turn < 2.0, "{fastest_turn}");
    assert!(farthest <= 0.35 + 1e-9, "{farthest}");
    // It has turned all the same, as far as it is held to the simulation object.
    let off = wrap_angle(controller.root().yaw - std::f64::consts::PI).abs();
    assert!(off < 1.01, "{off}");
}
