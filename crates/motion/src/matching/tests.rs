//! Tests of databases and controllers.

use super::search::{Query, scan};
use super::*;
use crate::clip::{Clip, Contacts, Interpolation, Motion, resample};
use crate::gait::GaitCycle;
use crate::math::{Decay, Planar, wrap_angle};
use crate::skeleton::{Joint, Roles, Skeleton};
use crate::synth::{Action, Params, synthesize};
use crate::transition::{Inertialization, repeat_clip};
use glam::{DVec2, Quat, Vec3};
use serde_json::Value;
use std::collections::BTreeSet;
use std::sync::{Arc, OnceLock};

/// Returns a small database of synthesised motions, built once.
fn small_database() -> &'static Arc<Database> {
    static DATABASE: OnceLock<Arc<Database>> = OnceLock::new();
    DATABASE.get_or_init(|| {
        Arc::new(Database::new(made_clips(1.75).unwrap(), &DatabaseOptions::default()).unwrap())
    })
}

fn golden() -> Value {
    serde_json::from_str(include_str!("../../tests/oracles/matching.json")).unwrap()
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|number| number.as_f64().unwrap()).collect()
}

fn joint(name: &str, parent: Option<usize>, offset: [f32; 3]) -> Joint {
    Joint {
        name: name.into(),
        parent,
        offset: Vec3::from_array(offset),
        end_site: None,
        channels: vec![],
    }
}

/// Returns the oracle's body: hips, and on either side a thigh that swings and a foot.
fn oracle_clip(golden: &Value) -> Arc<Motion> {
    let skeleton = Skeleton::new(vec![
        joint("Hips", None, [0.0; 3]),
        joint("LeftUpLeg", Some(0), [0.1, 0.0, 0.0]),
        joint("LeftFoot", Some(1), [0.0, -0.8, 0.02]),
        joint("RightUpLeg", Some(0), [-0.1, 0.0, 0.0]),
        joint("RightFoot", Some(3), [0.0, -0.8, 0.02]),
    ]);
    let skeleton = Arc::new(skeleton.unwrap());
    let (yaws, swings) = (numbers(&golden["yaw"]), numbers(&golden["swing"]));
    let rotations = (yaws.iter().zip(&swings)).flat_map(|(&yaw, &swing)| {
        let swung = |swing: f64| Quat::from_rotation_x(swing as f32);
        [
            Quat::from_rotation_y(yaw as f32),
            swung(swing),
            Quat::IDENTITY,
            swung(-swing),
            Quat::IDENTITY,
        ]
    });
    let roots = golden["position"].as_array().unwrap().iter().map(|at| {
        let at = numbers(at);
        Vec3::new(at[0] as f32, at[1] as f32, at[2] as f32)
    });
    let roles = Roles::detect(&skeleton);
    let clip =
        Clip::new("oracle", skeleton, RATE as f64, rotations.collect(), roots.collect()).unwrap();
    Arc::new(Motion::with_roles(clip, &roles))
}

#[test]
fn database_agrees_with_the_oracle() {
    let golden = golden();
    let options = DatabaseOptions { mirrored: false, ..DatabaseOptions::default() };
    let database = Database::new(vec![oracle_clip(&golden)], &options).unwrap();
    let motion = &database.motions()[0];
    for (root, wanted) in motion.roots().iter().zip(golden["roots"].as_array().unwrap()) {
        let wanted = numbers(wanted);
        assert!(wrap_angle(root.yaw - wanted[0]).abs() < 2e-6, "{root:?} {wanted:?}");
        assert!(root.shift.distance(DVec2::new(wanted[1], wanted[2])) < 2e-6);
    }
    let features = database.features();
    let (means, scales) = (numbers(&golden["means"]), numbers(&golden["scales"]));
    for (block, scale) in Block::ALL.into_iter().zip(&scales) {
        let found = f64::from(features.scales()[features.layout().range(block).start]);
        assert!((found - scale).abs() < 1e-4 * scale, "{block:?}");
    }
    for (frame, row) in golden["rows"].as_object().unwrap() {
        let found = features.row(frame.parse().unwrap()).unwrap();
        for (block, scale) in Block::ALL.into_iter().zip(&scales) {
            for dim in features.layout().range(block) {
                let wanted = (numbers(row)[dim] - means[dim]) / scale;
                // The grid's half step, and rounding of the scale.
                let error = (f64::from(found[dim]) - wanted).abs();
                assert!(
                    error < 0.5 / 4096.0 + 3e-4 * wanted.abs().max(1.0),
                    "{frame} {dim}: {} {wanted}",
                    found[dim]
                );
            }
        }
    }
}

#[test]
fn simulation_agrees_with_the_oracle() {
    let pair = |value: &Value| DVec2::from_slice(&numbers(value));
    for case in golden()["simulation"].as_array().unwrap() {
        let start = Simulation {
            velocity: pair(&case["velocity"]),
            acceleration: pair(&case["acceleration"]),
            goal_velocity: pair(&case["goal"]),
            ..Simulation::default()
        };
        let steering = Steering {
            velocity_half_life_secs: case["half_life"].as_f64().unwrap(),
            facing_half_life_secs: 0.2,
        };
        let end = start.after(case["secs"].as_f64().unwrap(), &steering);
        let wanted = numbers(&case["end"]);
        for (found, wanted) in
            [end.position, end.velocity, end.acceleration].into_iter().zip(wanted.chunks(2))
        {
            assert!(found.distance(DVec2::from_slice(wanted)) < 1e-7, "{found} {wanted:?}");
        }
    }
}

#[test]
fn database_of_invalid_clips_is_refused() {
    let options = DatabaseOptions::default();
    assert_eq!(Database::new(vec![], &options), Err(MatchError::NoClips));
    let walk = Motion::analyze(synthesize(&Params::new(Action::Walk)).unwrap().clip);
    let with = |clip: Clip| Arc::new(Motion::with_roles(clip, walk.roles()));
    let short = with(walk.clip().crop(0..35).unwrap());
    let alone = Database::new(vec![short.clone()], &options);
    assert!(matches!(alone, Err(MatchError::NoValidFrame { clips: 1, .. })), "{alone:?}");
    assert!(alone.unwrap_err().to_string().contains("0.57 s"));
    // With a longer clip it is left out.
    let both = Database::new(vec![short, Arc::new(walk.clone())], &options).unwrap();
    assert!(matches!(both.skipped(), [MatchError::TooShort { .. }]) && both.motions().len() == 2);
    assert_eq!(both.motions()[0].source(), 1);
    let footless = Arc::new(Motion::with_roles(Arc::clone(walk.clip()), &Roles::default()));
    let error = Database::new(vec![footless], &options).unwrap_err();
    assert!(error.to_string().contains("hips"), "{error}");
    let endless = Clip::new(
        "endless",
        walk.clip().skeleton().clone(),
        1e-5,
        vec![Quat::IDENTITY; 2 * walk.clip().skeleton().len()],
        vec![Vec3::Y; 2],
    );
    assert!(matches!(
        Database::new(vec![with(endless.unwrap())], &options),
        Err(MatchError::TooManyFrames { .. })
    ));
    let mut broken = walk.clip().root_translations().to_vec();
    broken[7].x = f32::NAN;
    let rotations =
        (0..walk.clip().frames()).flat_map(|frame| walk.clip().rotations(frame).to_vec()).collect();
    let broken =
        with(Clip::new("broken", walk.clip().skeleton().clone(), 60.0, rotations, broken).unwrap());
    assert!(matches!(Database::new(vec![broken], &options), Err(MatchError::NotFinite { .. })));
}

#[test]
fn database_with_other_rates_times_and_tags_differs_as_documented() {
    let database = small_database();
    let features = FeatureOptions { trajectory_secs: vec![0.25, 0.5], ..FeatureOptions::default() };
    let retimed = DatabaseBuilder::retimed(database, &features).unwrap().finish().unwrap();
    assert_eq!((retimed.frames(), retimed.features().layout().dims()), (database.frames(), 23));
    assert!(retimed.valid().len() > database.valid().len());
    assert!(Arc::ptr_eq(&retimed.motions()[3], &database.motions()[3]));
    // The same motion at another rate gives the same features.
    let clip = synthesize(&Params::new(Action::Walk)).unwrap().clip;
    let finer = resample(&clip, 120.0, Interpolation::Cubic).unwrap();
    // The clips end here: a repetition has a whole number of frames, which differs between rates.
    let [usual, fine] = [clip, finer].map(|clip| {
        Database::new(vec![Arc::new(Motion::analyze(clip))], &cycle_options(false)).unwrap()
    });
    assert_eq!(usual.frames(), fine.frames());
    assert!(usual.valid().iter().all(|&frame| usual.tags(frame as usize).has(Tag::Walk)));
    for &frame in usual.valid() {
        let rows = [&usual, &fine].map(|database| database.features().row(frame as usize).unwrap());
        for (a, b) in rows[0].iter().zip(rows[1]) {
            assert!((a - b).abs() < 2e-3, "{frame}: {a} {b}");
        }
    }
    let excluded = usual.retagged(0, &[TagRange { tag: Tag::Exclude, frames: 0..usual.frames() }]);
    let query = vec![0.0; 27];
    let question = Query { query: &query, weights: &[1.0; 27], filter: TagFilter::default() };
    assert_eq!(excluded.index().search(excluded.masks(), &question, None).best, None);
    assert!(scan(&usual.candidates(), &question).best.is_some());
    for number in (0..database.frames()).step_by(997) {
        assert_eq!(database.number(database.place(number).unwrap()), Some(number));
    }
    assert_eq!(
        (
            database.place(database.frames()),
            database.pose(Place { motion: 999, frame: 0 }, &Planar::IDENTITY)
        ),
        (None, None)
    );
}

/// A mirrored copy has the mirrored features.
#[test]
fn mirrored_motion_has_mirrored_features() {
    let database = small_database();
    let layout = database.features().layout();
    for motion in (0..database.motions().len()).step_by(2) {
        for frame in [5, 70] {
            let row = |motion| {
                let mut row = vec![0.0; layout.dims()];
                database.motion(motion).unwrap().write_row(layout, frame, &mut row);
                row
            };
            let (row, image) = (row(motion), row(motion + 1));
            for place in 0..6 {
                assert!(
                    (row[2 * place] + image[2 * place]).abs() < 1e-3
                        && (row[2 * place + 1] - image[2 * place + 1]).abs() < 1e-3
                );
            }
            for (from, to) in [(12, 15), (15, 12), (18, 21), (21, 18), (24, 24)] {
                assert!(
                    (row[from] + image[to]).abs() < 5e-3
                        && (row[from + 2] - image[to + 2]).abs() < 5e-3,
                    "{motion} {frame} {from}"
                );
            }
        }
    }
}

fn options() -> ControllerOptions {
    ControllerOptions::default()
}

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

/// Returns one stride of a made gait, without the frame that equals its first.
fn one_stride(action: Action, fps: f32, turn_rate_dps: f32) -> Arc<Motion> {
    let params = Params { turn_rate_dps, fps, ..Params::new(action) };
    let clip = Arc::new(synthesize(&params).unwrap().clip);
    let roles = Roles::detect(clip.skeleton());
    let cycle = GaitCycle::find(&Motion::with_roles(Arc::clone(&clip), &roles)).unwrap();
    Arc::new(Motion::with_roles(clip.crop(cycle.range()).unwrap(), &roles))
}

fn cycle_options(cycles: bool) -> DatabaseOptions {
    DatabaseOptions { cycles, ..DatabaseOptions::default() }
}

#[test]
fn cycle_has_the_features_of_its_repeated_clip() {
    for (action, fps, turn) in [
        (Action::Walk, 60.0, 0.0),
        (Action::Run, 60.0, 0.0),
        (Action::Walk, 100.0, 60.0),
        (Action::Run, 30.0, -40.0),
    ] {
        let stride = one_stride(action, fps, turn);
        let secs = stride.clip().frames() as f64 / stride.clip().fps();
        let database = Database::new(vec![stride.clone()], &cycle_options(true)).unwrap();
        assert!(database.skipped().is_empty() && database.motions().len() == 2);
        let layout = database.features().layout().clone();
        for motion in database.motions() {
            let name = format!("{action:?} {fps} {turn} {}", motion.is_mirrored());
            assert!(motion.is_cycle() && motion.valid(&layout) == motion.frames(), "{name}");
            assert!(
                (motion.frames() as f64 / RATE as f64 - secs).abs() < 1.6 / RATE as f64,
                "{name} {secs}"
            );
            // The slow way: nine repetitions as one long clip, of which the fifth is compared.
            let frames = motion.frames();
            // The motion continues over the seam.
            let step =
                |frame: usize| motion.root(frame).inverse().after(&motion.root(frame + 1)).shift;
            assert!(step(frames - 1).distance(step(frames - 2)) < 0.1 * step(0).length(), "{name}");
            let long = repeat_clip(motion.clip(), &motion.cycle().unwrap(), 9).unwrap();
            let long = Database::new(
                vec![Arc::new(Motion::with_roles(long, stride.roles()))],
                &cycle_options(false),
            )
            .unwrap();
            let long = &long.motions()[0];
            assert!(!long.is_cycle());
            for frame in 0..frames {
                let (mut own, mut wanted) = (vec![0.0; layout.dims()], vec![0.0; layout.dims()]);
                motion.write_row(&layout, frame, &mut own);
                long.write_row(&layout, 4 * frames + frame, &mut wanted);
                for (dim, (own, wanted)) in own.iter().zip(&wanted).enumerate() {
                    assert!(
                        (own - wanted).abs() < 2e-3,
                        "{name}, frame {frame}, {dim}: {own} {wanted}"
                    );
                }
                for side in crate::skeleton::Side::BOTH {
                    assert_eq!(
                        motion.contacts().planted(side, frame),
                        long.contacts().planted(side, 4 * frames + frame),
                        "{name} {frame}"
                    );
                }
            }
        }
        // Without repetition it ends, and is too short for its trajectory features if it lasts less
        // than a second.
        let ends = Database::new(vec![stride.clone()], &cycle_options(false));
        assert_eq!(ends.is_err(), secs < 1.0, "{secs} {ends:?}");
    }
    let whole: Vec<&str> = small_database()
        .motions()
        .iter()
        .filter(|motion| motion.is_cycle())
        .map(|motion| motion.clip().name())
        .collect();
    let leads_away = |name: &&str| ["start", "stop", "turn"].iter().any(|word| name.contains(word));
    assert!(!whole.iter().any(leads_away), "{whole:?}");
}

#[test]
fn cycle_plays_without_end() {
    let stride = one_stride(Action::Walk, 60.0, 0.0);
    let options = DatabaseOptions { mirrored: false, ..cycle_options(true) };
    let database = Arc::new(Database::new(vec![stride], &options).unwrap());
    let motion = Arc::clone(&database.motions()[0]);
    let frames = motion.frames();
    let control = Control::new(DVec2::new(0.0, 1.4), None);
    let mut controller =
        Controller::new(Arc::clone(&database), self::options(), &Planar::IDENTITY).unwrap();
    let (mut cycle_options, mut most, mut ends) = (0, 0.0f32, 0);
    for tick in 0..1_200 {
        let before = controller.place().frame;
        let jumps = controller.jumps();
        let pose = controller.pose().rotations.clone();
        controller.tick(&control);
        let search =
            controller.last_search().filter(|search| search.tick + 1 == controller.ticks());
        ends += usize::from(search.is_some_and(|search| search.reason == SearchReason::ClipEnd));
        if controller.jumps() == jumps {
            assert_eq!(controller.place().frame, (before + 1) % frames, "{tick}");
            cycle_options += usize::from(before + 1 == frames);
        }
        if tick > 300 {
            let turned = pose.iter().zip(&controller.pose().rotations);
            most =
                turned.map(|(&a, &b)| crate::math::quat::angle_between(a, b)).fold(most, f32::max);
        }
    }
    // Twenty seconds are nearly twenty strides, and none of them ends.
    assert!(cycle_options >= 15 && ends == 0, "{cycle_options} {ends}");
    let own = (0..frames - 1).flat_map(|frame| {
        let clip = motion.clip();
        let turned = clip.rotations(frame).iter().zip(clip.rotations(frame + 1));
        turned.map(|(&a, &b)| crate::math::quat::angle_between(a, b)).collect::<Vec<_>>()
    });
    let own = own.fold(0.0, f32::max);
    assert!(most < 1.3 * own + 0.02, "{most} {own}");
    assert!(
        (controller.root().shift.y - 28.0).abs() < 1.5 && controller.root().shift.x.abs() < 0.5,
        "{:?}",
        controller.root()
    );
}

#[test]
fn votes_for_another_clip_allow_jumps_within_a_clip() {
    let options = ControllerOptions {
        hysteresis: Hysteresis::ThreeVotesForAnotherClip,
        prefer_current: 0.0,
        ..options()
    };
    let mut controller =
        Controller::new(Arc::clone(small_database()), options, &Planar::IDENTITY).unwrap();
    let mut elsewhere = 0;
    for control in Scenario::FigureEight.recording().controls() {
        let (before, jumps) = (controller.place(), controller.jumps());
        controller.tick(&control);
        let Some(search) =
            controller.last_search().filter(|search| search.tick + 1 == controller.ticks())
        else {
            continue;
        };
        let Some(winner) = search.winner else {
            continue;
        };
        let jumped = controller.jumps() > jumps;
        let other = winner.place.motion != before.motion;
        elsewhere = if other { elsewhere + 1 } else { 0 };
        if search.reason == SearchReason::ClipEnd {
            elsewhere = 0;
        } else if jumped && other {
            assert!(elsewhere >= 3, "{search:?}");
            elsewhere = 0;
        } else if !jumped {
            let voted =
                matches!(search.held, Some(HoldReason::Same | HoldReason::Votes)) && elsewhere < 3;
            // A frame of another clip that is not cheaper at all, while the input is constant.
            assert!(voted || search.held == Some(HoldReason::CurrentClip), "{search:?}");
        }
    }
    // In a database of one clip no votes are needed.
    let walk = Motion::analyze(synthesize(&Params::new(Action::Walk)).unwrap().clip);
    let alone = DatabaseOptions { mirrored: false, ..cycle_options(false) };
    let alone = Arc::new(Database::new(vec![Arc::new(walk)], &alone).unwrap());
    let jumps = |hysteresis| {
        let options = ControllerOptions { hysteresis, ..options };
        drive(&alone, options, &Scenario::StartStop.recording()).unwrap().jumps
    };
    let free = jumps(Hysteresis::None);
    assert!(
        free.iter().any(|jump| jump.reason != SearchReason::ClipEnd)
            && free == jumps(options.hysteresis)
    );
}

#[test]
fn preferred_source_is_kept_while_the_input_is_constant() {
    let motions = small_database().motions();
    let named =
        motions.iter().find(|motion| motion.clip().name() == "walk 1.9 m/s").unwrap().source();
    let share = |prefer_source, prefer_current| {
        let options = ControllerOptions {
            prefer_source,
            prefer_current,
            hysteresis: Hysteresis::None,
            candidates: 4,
            ..options()
        };
        let mut controller =
            Controller::new(Arc::clone(small_database()), options, &Planar::IDENTITY).unwrap();
        let mut there = 0;
        for tick in 0..480 {
            controller.tick(&Control::new(DVec2::new(0.0, 1.4), None));
            let search = controller.last_search().unwrap();
            assert_eq!(search.candidates.first(), search.winner.as_ref());
            there += u32::from(tick >= 240 && motions[controller.place().motion].source() == named);
        }
        f64::from(there) / 240.0
    };
    assert!(share(Some(named), 1.0) > 0.95);
    let usual = share(None, 0.0);
    assert!(usual < 0.3 && share(Some(named), 0.0) < 0.3, "{usual}");
}

#[test]
fn hysteresis_suppresses_jumps_and_tags_filter_frames() {
    let recording = Scenario::StartStop.recording();
    let jumps = |hysteresis| {
        let options = ControllerOptions { hysteresis, prefer_current: 0.0, ..options() };
        drive(small_database(), options, &recording).unwrap().jumps
    };
    let free = jumps(Hysteresis::None).len();
    for hysteresis in [
        Hysteresis::ContinuingBias { share: 0.3, constant: 0.3 },
        Hysteresis::MinimumTime { secs: 0.5 },
        Hysteresis::ThreeVotes,
        Hysteresis::ThreeVotesForAnotherClip,
    ] {
        assert!(jumps(hysteresis).len() < free, "{hysteresis:?}");
    }
    let apart = jumps(Hysteresis::MinimumTime { secs: 0.5 });
    let apart = apart.windows(2).filter(|pair| pair[1].reason != SearchReason::ClipEnd);
    assert!(apart.map(|pair| pair[1].frame - pair[0].frame).all(|frames| frames >= 30));

    let walk = TagFilter { ask: TagSet::of(&[Tag::Run]), forbid: TagSet::of(&[Tag::Turn]) };
    let mut controller =
        Controller::new(Arc::clone(small_database()), options(), &Planar::IDENTITY).unwrap();
    let control = Control::new(DVec2::new(0.0, 1.4), None).with_filter(walk);
    let mut places = BTreeSet::new();
    for _ in 0..180 {
        controller.tick(&control);
        if let Some(winner) = controller.last_search().and_then(|search| search.winner) {
            places.insert(winner.place);
        }
    }
    assert!(!places.is_empty());
    for place in places {
        assert!(
            walk.admits(small_database().tags(small_database().number(place).unwrap())),
            "{place:?}"
        );
    }
    // No frame has such a tag: the clip continues, and at its end the character stands.
    let nowhere =
        control.with_filter(TagFilter { ask: TagSet::of(&[Tag::Own(7)]), forbid: TagSet::NONE });
    for _ in 0..600 {
        controller.tick(&nowhere);
    }
    let search = controller.last_search().unwrap();
    assert_eq!((search.winner, search.held), (None, Some(HoldReason::Nothing)));
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
fn mirrored_contacts_are_swapped() {
    let contacts = Contacts::from_flags([vec![true, false, true], vec![false, false, true]]);
    let swapped = Contacts::from_flags([vec![false, false, true], vec![true, false, true]]);
    assert_eq!(motion::mirrored_contacts(&contacts), swapped);
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
