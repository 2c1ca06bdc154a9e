//! Properties of the synthesiser, measured on its clips.

#![expect(clippy::unwrap_used, reason = "a test fails by panicking")]

use glam::Vec3;
use proptest::prelude::*;
use segue_motion::clip::Clip;
use segue_motion::math::quat;
use segue_motion::skeleton::WorldPose;
use segue_motion::synth::{
    Action, FootContact, Params, Style, SynthError, Synthesized, heel_in_foot, humanoid, presets,
    synthesize,
};

const FEET: [(&str, &str); 2] = [("LeftFoot", "LeftToe"), ("RightFoot", "RightToe")];

fn made(params: &Params) -> Synthesized {
    synthesize(params).unwrap_or_else(|error| panic!("{params:?}: {error}"))
}

fn walk(speed_mps: f32) -> Params {
    Params { speed_mps, ..Params::new(Action::Walk) }
}

fn run(speed_mps: f32) -> Params {
    Params { speed_mps, ..Params::new(Action::Run) }
}

fn joint(clip: &Clip, name: &str) -> usize {
    clip.skeleton().find(name).unwrap_or_else(|| panic!("no {name}"))
}

/// Returns heel, toe joint and toe tip of both feet in every frame.
fn soles(made: &Synthesized, height_m: f32) -> Vec<[[Vec3; 3]; 2]> {
    let clip = &made.clip;
    let heel = heel_in_foot(height_m);
    let feet = FEET.map(|(foot, toe)| (joint(clip, foot), joint(clip, toe)));
    let tip = clip.skeleton().joints()[feet[0].1].end_site.unwrap();
    let mut world = WorldPose::default();
    (0..clip.frames())
        .map(|frame| {
            clip.world_pose_into(frame, &mut world);
            feet.map(|(foot, toe)| {
                [world.point(foot, heel), world.positions[toe], world.point(toe, tip)]
            })
        })
        .collect()
}

/// Returns the greatest distance of a heel or a toe joint from where it was first planted, metres.
fn max_slip(made: &Synthesized, height_m: f32) -> f32 {
    let soles = soles(made, height_m);
    let mut worst = 0.0_f32;
    for side in 0..2 {
        for part in 0..2 {
            let mut planted: Option<Vec3> = None;
            for (sole, contact) in soles.iter().zip(&made.truth.contacts) {
                let down = if part == 0 { contact[side].heel } else { contact[side].toe };
                let here = sole[side][part];
                planted = down.then(|| planted.unwrap_or(here));
                worst = planted.map_or(worst, |there| worst.max(here.distance(there)));
            }
        }
    }
    worst
}

/// Returns the greatest depth of any point of a foot below the ground, metres.
fn max_depth(made: &Synthesized, height_m: f32) -> f32 {
    soles(made, height_m).iter().flatten().flatten().map(|point| -point.y).fold(0.0, f32::max)
}

/// Returns the largest change of any joint's local angular velocity from frame to frame, rad/s²,
/// with its frame and joint.
fn max_angular_acceleration(clip: &Clip) -> (f32, usize, usize) {
    let dt = clip.dt_secs();
    let velocity = |frame: usize, joint: usize| {
        quat::angular_velocity(clip.rotations(frame)[joint], clip.rotations(frame + 1)[joint], dt)
    };
    let mut worst = (0.0, 0, 0);
    for frame in 0..clip.frames().saturating_sub(2) {
        for joint in 0..clip.skeleton().len() {
            let acceleration = (velocity(frame + 1, joint) - velocity(frame, joint)).length() / dt;
            if acceleration > worst.0 {
                worst = (acceleration, frame, joint);
            }
        }
    }
    worst
}

fn knee_flexions(clip: &Clip) -> Vec<[f32; 2]> {
    let knees = ["LeftLeg", "RightLeg"].map(|name| joint(clip, name));
    (0..clip.frames())
        .map(|frame| knees.map(|knee| quat::log(clip.rotations(frame)[knee]).x.to_degrees()))
        .collect()
}

fn least_and_greatest(values: impl Iterator<Item = f32>) -> (f32, f32) {
    values.fold((f32::INFINITY, f32::NEG_INFINITY), |(least, greatest), v| {
        (least.min(v), greatest.max(v))
    })
}

fn every_action() -> Vec<Params> {
    let mut all: Vec<Params> = presets().iter().map(|preset| preset.params).collect();
    for turn_rate_dps in [-120.0, -50.0, 0.0, 50.0, 120.0] {
        all.extend([0.4, 1.0, 1.6, 2.2].map(|speed| Params { turn_rate_dps, ..walk(speed) }));
        all.extend([1.8, 3.0, 5.0, 6.5].map(|speed| Params { turn_rate_dps, ..run(speed) }));
    }
    for height_m in [1.0, 2.2] {
        all.extend(presets().iter().map(|preset| Params { height_m, ..preset.params }));
    }
    all
}

#[test]
fn presets_synthesise_and_have_ids_for_links() {
    let presets = presets();
    for preset in &presets {
        let made = made(&preset.params);
        assert!(preset.id.bytes().all(|b| b.is_ascii_lowercase() || b == b'_'), "{}", preset.id);
        assert_eq!(presets.iter().filter(|other| other.id == preset.id).count(), 1);
        let secs = made.clip.duration_secs();
        assert!((2.0..=6.1).contains(&secs), "{}: {secs} s", preset.id);
        assert_eq!(made.truth.phase.len(), made.clip.frames());
        assert_eq!(made.truth.contacts.len(), made.clip.frames());
    }
}

#[test]
fn feet_in_contact_stand_still() {
    for params in every_action() {
        let slip = max_slip(&made(&params), params.height_m);
        assert!(slip < 1e-3, "{slip} m in {params:?}");
    }
}

#[test]
fn feet_stay_above_the_ground() {
    for params in every_action() {
        let depth = max_depth(&made(&params), params.height_m);
        assert!(depth < 2e-3, "{depth} m in {params:?}");
    }
}

/// Returns the shortest distance between the segments `a` and `b`, by sampling: accurate to a few
/// millimetres on a foot.
fn distance(a: [Vec3; 2], b: [Vec3; 2]) -> f32 {
    let at = |segment: [Vec3; 2], i: u8| segment[0].lerp(segment[1], f32::from(i) / 16.0);
    let pairs = (0..=16).flat_map(|i| (0..=16).map(move |j| (i, j)));
    pairs.map(|(i, j)| at(a, i).distance(at(b, j))).fold(f32::INFINITY, f32::min)
}

#[test]
fn feet_never_intersect() {
    let mut all: Vec<Params> = presets().iter().map(|preset| preset.params).collect();
    all.extend(
        [-90.0, 45.0, 120.0]
            .map(|spin_degrees| Params { spin_degrees, ..Params::new(Action::Spin) }),
    );
    all.extend([-90.0, 60.0].map(|turn_rate_dps| Params { turn_rate_dps, ..walk(1.0) }));
    for params in all {
        let closest = (soles(&made(&params), params.height_m).iter())
            .map(|[left, right]| distance([left[0], left[2]], [right[0], right[2]]))
            .fold(f32::INFINITY, f32::min);
        assert!(closest > 0.045, "{closest} m in {params:?}");
    }
}

#[test]
fn mean_speed_is_the_requested_one() {
    for turn_rate_dps in [0.0, 30.0, -90.0] {
        for speed in [0.4, 0.9, 1.4, 2.2] {
            check_speed(&Params { turn_rate_dps, ..walk(speed) });
        }
    }
    for turn_rate_dps in [0.0, -45.0, 120.0] {
        for speed in [1.8, 3.5, 6.5] {
            check_speed(&Params { turn_rate_dps, ..run(speed) });
        }
    }
}

/// Checks the mean speed. On a line: from the displacement over whole cycles. On a circle: the hips
/// sway about it, so its radius is their mean distance from the centre, and speed = radius × turn
/// rate.
fn check_speed(params: &Params) {
    let made = made(&Params { fps: 120.0, ..*params });
    let roots = made.clip.root_translations();
    let whole = roots.len() - 1;
    let secs = made.clip.duration_secs() as f32;
    let yaw_rate = params.turn_rate_dps.to_radians();
    let speed = if yaw_rate == 0.0 {
        roots[whole].distance(roots[0]) / secs
    } else {
        let centre = Vec3::new(params.speed_mps / yaw_rate, 0.0, 0.0);
        let radius =
            roots[..whole].iter().map(|root| root.with_y(0.0).distance(centre)).sum::<f32>()
                / whole as f32;
        // The whole pose turns with the path, so the first and last frame differ by turn rate ×
        // time.
        let [a, b] = [0, whole].map(|frame| made.clip.rotations(frame)[0]);
        let expected = glam::Quat::from_rotation_y(yaw_rate * secs) * a;
        assert!(quat::angle_between(expected, b) < 0.01, "{params:?}");
        radius * yaw_rate.abs()
    };
    assert!((speed / params.speed_mps - 1.0).abs() < 0.005, "{speed} m/s in {params:?}");
    assert!((roots[whole].y - roots[0].y).abs() < 1e-3, "{params:?}");
}

#[test]
fn walks_and_runs_are_cyclic() {
    let turning = Params { turn_rate_dps: 40.0, ..walk(1.2) };
    for params in
        [walk(1.4), walk(0.7), run(3.5), turning, Params { fps: 30.0, seed: 5, ..run(3.0) }]
    {
        let made = made(&params);
        let last = made.clip.frames() - 1;
        for joint in 1..made.clip.skeleton().len() {
            let angle = quat::angle_between(
                made.clip.rotations(0)[joint],
                made.clip.rotations(last)[joint],
            );
            assert!(angle < 2e-3, "joint {joint} {angle} rad in {params:?}");
        }
        let phase = &made.truth.phase;
        assert!(phase[0] < 1e-4 && (phase[last] < 1e-3 || phase[last] > 0.999));
    }
}

#[test]
fn flight_occurs_in_running_only() {
    let up = |params: &Params| {
        made(params).truth.contacts.iter().filter(|feet| !feet[0].any() && !feet[1].any()).count()
    };
    for speed in [0.4, 1.4, 2.2] {
        assert_eq!(up(&walk(speed)), 0, "{speed}");
    }
    let flights = [1.8, 2.5, 3.5, 5.0, 6.5].map(|speed| up(&Params { fps: 120.0, ..run(speed) }));
    assert!(flights.iter().all(|&frames| frames > 0), "{flights:?}");
    // The share of a cycle in which a foot is planted: about 60 % in walking, below half in
    // running, decreasing with speed.
    let duty = |params: &Params| {
        let contacts = made(params).truth.contacts;
        contacts.iter().filter(|feet| feet[0].any()).count() as f32 / contacts.len() as f32
    };
    assert!((0.57..0.64).contains(&duty(&walk(1.4))), "{}", duty(&walk(1.4)));
    assert!(duty(&walk(0.6)) > duty(&walk(1.4)) && duty(&walk(1.4)) > duty(&walk(2.0)));
    assert!(duty(&run(2.2)) < 0.5 && duty(&run(5.0)) < duty(&run(2.2)));
}

#[test]
fn flight_follows_gravity() {
    for params in
        [Params { fps: 120.0, ..run(3.5) }, Params { fps: 120.0, ..Params::new(Action::Jump) }]
    {
        let made = made(&params);
        let (roots, contacts) = (made.clip.root_translations(), &made.truth.contacts);
        let flying = |frame: usize| contacts[frame].iter().all(|foot| !foot.any());
        let mut checked = 0;
        for frame in 1..roots.len() - 1 {
            if (frame - 1..=frame + 1).all(flying) {
                let a = (roots[frame + 1].y - 2.0 * roots[frame].y + roots[frame - 1].y)
                    * 120.0
                    * 120.0;
                assert!(
                    (a + 9.81).abs() < 0.15,
                    "{a} m/s² at frame {frame} of {:?}",
                    params.action
                );
                checked += 1;
            }
        }
        assert!(checked > 5, "{:?}", params.action);
    }
}

#[test]
fn cadence_and_step_length_match_the_literature() {
    // Adults of 1.75 m. Walking: Murray 1967, Perry and Burnfield 2010. Running: Cavanagh and Kram
    // 1989.
    for (speed, lowest, highest) in
        [(0.8, 78.0, 100.0), (1.1, 92.0, 112.0), (1.4, 106.0, 120.0), (1.8, 118.0, 138.0)]
    {
        let cadence = made(&walk(speed)).truth.cadence_spm;
        assert!((lowest..highest).contains(&cadence), "{cadence} steps/min at {speed} m/s");
    }
    for (speed, lowest, highest) in [(2.5, 148.0, 170.0), (3.5, 158.0, 176.0), (5.0, 170.0, 196.0)]
    {
        let cadence = made(&run(speed)).truth.cadence_spm;
        assert!((lowest..highest).contains(&cadence), "{cadence} steps/min at {speed} m/s");
    }
    // A child takes more and shorter steps at the same speed.
    let (child, adult) =
        (made(&Params { height_m: 1.1, ..walk(1.0) }).truth, made(&walk(1.0)).truth);
    assert!(child.cadence_spm > 1.1 * adult.cadence_spm && child.stride_m < adult.stride_m);
    assert!((adult.stride_m - adult.speed_mps * adult.cycle_secs).abs() < 1e-5);
}

#[test]
fn phase_and_contacts_agree() {
    for params in [walk(1.4), run(3.5), Params { fps: 100.0, ..walk(0.8) }] {
        let truth = made(&params).truth;
        let one_frame = 1.0 / (truth.cycle_secs * params.fps);
        let mut strikes = 0;
        for frame in 1..truth.contacts.len() {
            for side in 0..2 {
                if truth.contacts[frame][side].any() && !truth.contacts[frame - 1][side].any() {
                    // The left foot strikes at 0, the right one at a half; a strike shows in the
                    // first frame after it.
                    let late = (truth.phase[frame] - 0.5 * side as f32 + 0.5).rem_euclid(1.0) - 0.5;
                    assert!((-1e-3..one_frame * 1.01).contains(&late), "{late} at frame {frame}");
                    strikes += 1;
                }
            }
        }
        assert!(strikes >= 4);
    }
}

#[test]
fn angular_acceleration_is_bounded() {
    for params in every_action() {
        let (worst, frame, joint) = max_angular_acceleration(&made(&params).clip);
        // A runner's knee gains 1000°/s within a tenth of a cycle (Novacheck 1998); tight curves
        // are faster. Bodies of other sizes move alike at equal Froude number, and are then faster
        // by 1/size.
        let size = params.height_m / 1.75;
        let alike_mps = params.speed_mps / size.sqrt();
        let turning = 1.0 + params.turn_rate_dps.abs() / 200.0;
        let sideways = params.speed_mps * params.turn_rate_dps.to_radians() / 9.81;
        let limit = match params.action {
            Action::Run => (300.0 + 100.0 * alike_mps) * (1.0 + sideways * sideways),
            Action::Jump => 500.0,
            Action::Idle | Action::Spin => 300.0,
            _ => (360.0 + 130.0 * alike_mps) * turning,
        } / size;
        assert!(worst < limit, "{worst} rad/s² at frame {frame} in joint {joint} of {params:?}");
    }
}

#[test]
fn knee_flexion_matches_the_literature() {
    for (params, swing) in
        [(walk(1.4), 52.0..75.0), (walk(1.0), 48.0..72.0), (run(3.5), 85.0..130.0)]
    {
        let (least, peak) =
            least_and_greatest(knee_flexions(&made(&params).clip).into_iter().flatten());
        assert!(swing.contains(&peak), "{peak}° in {params:?}");
        assert!((2.0..25.0).contains(&least), "{least}° in {params:?}");
    }
    // The knee flexion of early stance in walking.
    let walked = made(&walk(1.4));
    let knees = knee_flexions(&walked.clip);
    let early = knees
        .iter()
        .zip(&walked.truth.phase)
        .filter(|(_, phase)| (0.08..0.25).contains(*phase))
        .map(|(knee, _)| knee[0]);
    let (_, peak) = least_and_greatest(early);
    assert!((14.0..34.0).contains(&peak), "{peak}°");
    for params in every_action() {
        let (least, _) =
            least_and_greatest(knee_flexions(&made(&params).clip).into_iter().flatten());
        assert!(least > 0.3, "{least}° in {params:?}");
    }
}

#[test]
fn hips_rise_in_mid_stance_of_walking_and_sink_in_running() {
    let rise = |params: &Params, middle: f32| {
        let made = made(params);
        let roots = made.clip.root_translations();
        let (low, high) = least_and_greatest(roots.iter().map(|root| root.y));
        let at = (made.truth.cycle_secs * params.fps * middle) as usize;
        (high - low, roots[at].y - 0.5 * (high + low))
    };
    let (walking, over_stance) = rise(&walk(1.4), 0.30);
    assert!((0.03..0.055).contains(&walking) && over_stance > 0.0, "{walking} {over_stance}");
    let (running, over_stance) = rise(&run(3.5), 0.15);
    assert!((0.06..0.13).contains(&running) && over_stance < 0.0, "{running} {over_stance}");
}

#[test]
fn starts_and_stops_stand_with_parallel_feet() {
    let (start, stop) = (made(&Params::new(Action::Start)), made(&Params::new(Action::Stop)));
    for (made, frame) in [(&start, 0), (&stop, stop.clip.frames() - 1)] {
        assert!(made.truth.contacts[frame].iter().all(FootContact::flat));
        let world = made.clip.world_pose(frame);
        let [left, right] = FEET.map(|(foot, _)| world.positions[joint(&made.clip, foot)]);
        assert!(
            (left.z - right.z).abs() < 5e-3 && (0.1..0.3).contains(&(left.x - right.x)),
            "{left} {right}"
        );
        let hips = world.positions[0];
        assert!((hips.x - 0.5 * (left.x + right.x)).abs() < 0.02, "{hips}");
    }
    // Before the right foot lifts, the weight has shifted to the left one.
    let lift = start.truth.contacts.iter().position(|feet| !feet[1].any()).unwrap();
    assert!(start.clip.root_translations()[lift].x > 0.015);
    // They reach, and leave, the speed.
    let speed = |clip: &Clip, frames: std::ops::Range<usize>| {
        let roots = clip.root_translations();
        roots[frames.end].distance(roots[frames.start]) * 60.0 / frames.len() as f32
    };
    let cycle = (start.truth.cycle_secs * 60.0).round() as usize;
    let end = start.clip.frames() - 1;
    assert!((speed(&start.clip, end - cycle..end) - 1.4).abs() < 0.06);
    assert!((speed(&stop.clip, 0..cycle / 2) - 1.4).abs() < 0.12);
    assert!(speed(&stop.clip, stop.clip.frames() - 20..stop.clip.frames() - 1) < 0.05);
}

#[test]
fn spin_turns_in_place_without_flight() {
    for spin_degrees in [180.0, -180.0, 90.0, -45.0, 360.0] {
        let made = made(&Params { spin_degrees, duration_secs: 5.0, ..Params::new(Action::Spin) });
        let last = made.clip.frames() - 1;
        let facing = |frame: usize| made.clip.rotations(frame)[0] * Vec3::Z;
        let (from, to) = (facing(0), facing(last));
        let turned = (to.x.atan2(to.z) - from.x.atan2(from.z)).to_degrees();
        assert!(
            ((turned - spin_degrees + 180.0).rem_euclid(360.0) - 180.0).abs() < 2.0,
            "{turned} for {spin_degrees}"
        );
        assert!(made.clip.root_translations().iter().all(|root| root.with_y(0.0).length() < 0.2));
        assert!(made.truth.contacts.iter().all(|feet| feet[0].any() || feet[1].any()));
        assert!(made.truth.contacts.iter().any(|feet| !feet[0].any()));
    }
}

#[test]
fn jump_leaves_the_ground_and_lands() {
    let made = made(&Params::new(Action::Jump));
    let heights: Vec<f32> = made.clip.root_translations().iter().map(|root| root.y).collect();
    let standing = heights[0];
    let (low, high) = least_and_greatest(heights.iter().copied());
    assert!(
        (0.15..0.5).contains(&(standing - low)) && (0.15..0.6).contains(&(high - standing)),
        "{standing} {low} {high}"
    );
    assert!((heights[heights.len() - 1] - standing).abs() < 0.01);
    let both_up =
        made.truth.contacts.iter().filter(|feet| feet.iter().all(|foot| !foot.any())).count();
    assert!((20..45).contains(&both_up), "{both_up} frames");
}

#[test]
fn idle_moves_the_body_but_not_the_feet() {
    let made = made(&Params::new(Action::Idle));
    assert!(made.truth.contacts.iter().flatten().all(FootContact::flat));
    let roots = made.clip.root_translations();
    let (_, widest) = least_and_greatest(roots.iter().map(|root| root.distance(roots[0])));
    assert!((0.005..0.08).contains(&widest), "{widest}");
}

#[test]
fn seed_determines_the_clip() {
    let of = |seed| made(&Params { seed, ..walk(1.4) }).clip;
    assert_eq!(of(3), of(3));
    assert_ne!(of(3), of(4));
    assert_ne!(of(0), of(1));
}

#[test]
fn seed_zero_is_symmetric() {
    let made = made(&Params { fps: 120.0, ..walk(1.4) });
    let half = (made.truth.cycle_secs * 60.0).round() as usize;
    let knees = knee_flexions(&made.clip);
    for frame in 0..half {
        assert!((knees[frame][0] - knees[frame + half][1]).abs() < 2.0, "frame {frame}");
    }
}

#[test]
fn params_out_of_range_are_refused_with_the_range() {
    let refused = |params: Params, words: &[&str]| {
        let error = synthesize(&params).unwrap_err();
        assert!(matches!(error, SynthError::OutOfRange { .. }));
        let text = error.to_string();
        assert!(words.iter().all(|word| text.contains(word)), "{text}");
    };
    refused(walk(3.0), &["speed", "3 m/s", "0.4", "2.2 m/s"]);
    refused(run(1.0), &["speed", "1.8", "6.5"]);
    refused(walk(f32::NAN), &["speed"]);
    refused(Params { height_m: 0.5, ..walk(1.4) }, &["height", "1", "2.2 m"]);
    refused(Params { turn_rate_dps: 150.0, ..walk(1.4) }, &["turn rate", "-120", "120"]);
    refused(Params { fps: 0.0, ..walk(1.4) }, &["frame rate"]);
    refused(Params { duration_secs: f32::INFINITY, ..walk(1.4) }, &["duration"]);
    refused(Params { style: Style { lean: -1.0, ..Style::default() }, ..walk(1.4) }, &["lean"]);
    assert!(humanoid(3.0).is_err());
}

#[test]
fn body_has_human_proportions() {
    let skeleton = humanoid(1.75).unwrap();
    assert_eq!(skeleton.len(), 22);
    let index = |name: &str| skeleton.find(name).unwrap();
    let at = |name: &str| skeleton.rest_positions()[index(name)] + skeleton.joints()[0].offset;
    let end = |name: &str| at(name) + skeleton.joints()[index(name)].end_site.unwrap();
    assert!((end("Head").y - 1.75).abs() < 0.01, "{}", end("Head"));
    assert!((at("LeftUpLeg").y / 1.75 - 0.530).abs() < 1e-3);
    assert!((at("LeftLeg").y / 1.75 - 0.285).abs() < 1e-3);
    assert!((at("LeftFoot").y / 1.75 - 0.039).abs() < 1e-3);
    assert!((at("LeftArm").y / 1.75 - 0.818).abs() < 0.02);
    assert!(at("LeftArm").x > 0.0 && at("LeftToe").z > 0.0);
    // The arm span is about the height.
    assert!((2.0 * end("LeftHand").x / 1.75 - 1.0).abs() < 0.1, "{}", end("LeftHand"));
}

fn any_params() -> impl Strategy<Value = Params> {
    let style = prop::array::uniform5(0.0f32..=2.0).prop_map(
        |[bounce, arm_swing, stance_width, energy, lean]| Style {
            bounce,
            arm_swing,
            stance_width,
            energy,
            lean,
        },
    );
    let action = prop::sample::select(Action::ALL.to_vec());
    let fps = prop::sample::select(vec![24.0f32, 60.0, 120.0]);
    (action, 0.0f32..=1.0, -120.0f32..=120.0, -360.0f32..=360.0, 1.0f32..=2.2, style, 0u32..9, fps)
        .prop_map(|(action, at, turn_rate_dps, spin_degrees, height_m, style, seed, fps)| {
            let natural = Params::new(action);
            let speed_mps = Params::speed_range(action)
                .map_or(0.0, |(least, most)| least + at * (most - least));
            Params { speed_mps, turn_rate_dps, spin_degrees, height_m, style, seed, fps, ..natural }
        })
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 160,
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    #[test]
    fn params_in_range_make_a_valid_clip(params in any_params()) {
        let made = made(&params);
        for frame in 0..made.clip.frames() {
            prop_assert!(made.clip.root_translations()[frame].is_finite());
            for rotation in made.clip.rotations(frame) {
                prop_assert!(rotation.is_finite() && (rotation.length() - 1.0).abs() < 1e-4);
            }
        }
        prop_assert!(made.truth.phase.iter().all(|phase| (0.0..=1.0).contains(phase)));
        prop_assert!(
            max_slip(&made, params.height_m) < 1e-3,
            "slip {}",
            max_slip(&made, params.height_m)
        );
        prop_assert!(
            max_depth(&made, params.height_m) < 2e-3,
            "depth {}",
            max_depth(&made, params.height_m)
        );
        // Nothing flips from one frame to the next, at any frame rate.
        let fastest = 62.0 * (1.75 / params.height_m).sqrt();
        for frame in 1..made.clip.frames() {
            for (joint, (a, b)) in
                made.clip.rotations(frame - 1).iter().zip(made.clip.rotations(frame)).enumerate()
            {
                let speed = quat::angle_between(*a, *b) * params.fps;
                prop_assert!(speed < fastest, "{speed} rad/s in joint {joint} at frame {frame}");
            }
        }
    }
}
