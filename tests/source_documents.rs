//! The experiments of the four documents that Segue reproduces, each as one link, with the results
//! that the document reports: a course report on motion graphs, a program for motion path editing,
//! homework on blending and motion matching, and an article on Gleicher's motion path editing.
//!
//! Motions are synthesised. The homework's own files are used as well, if they are beside the
//! project.

#[path = "../crates/formats/tests/common/mod.rs"]
mod common;

use glam::{DVec2, Vec3};
use petgraph::visit::EdgeRef;
use segue_motion::blend::WeightLaw;
use segue_motion::clip::Motion;
use segue_motion::graph::{Construction, MotionGraph};
use segue_motion::math::{Planar, quat, spring};
use segue_motion::path::SplineEnds;
use segue_scene::{Director, StageOptions, Viewport};
use segue_session::{Command, CycleMade, Key, Level, Outcome, Pane, Session, Slot, Value, Walk};
use std::sync::Arc;

/// Returns an angle in the range from -π to π.
fn wrap_angle(angle: f64) -> f64 {
    angle.sin().atan2(angle.cos())
}

/// Returns a session with an opened link and all its work done.
fn opened(link: &str) -> Session {
    let mut session = Session::new();
    session.apply(Command::OpenLink(link.to_owned())).expect("a link is never refused");
    while session.work() {}
    let said: Vec<_> =
        session.notices().list().iter().filter(|notice| notice.level != Level::Info).collect();
    assert!(said.is_empty(), "{link}: {said:?}");
    session
}

fn outcome(session: &Session, pane: usize) -> &Arc<Outcome> {
    let pane: &Pane = &session.panes()[pane];
    assert_eq!(pane.problem, None);
    pane.outcome.as_ref().expect("a result")
}

fn motion(session: &Session, pane: usize) -> &Motion {
    &outcome(session, pane).motion
}

fn walk(session: &Session, pane: usize) -> &Walk {
    outcome(session, pane).walk().expect("a walk")
}

fn graph(session: &Session, pane: usize) -> &MotionGraph {
    walk(session, pane).built.graph()
}

fn number(session: &Session, pane: usize, id: &str) -> f64 {
    let metrics = &outcome(session, pane).metrics;
    let metric = metrics.iter().find(|metric| metric.id.name() == id);
    metric.and_then(|metric| metric.value).unwrap_or_else(|| panic!("no {id}"))
}

/// Returns a metric in every pane.
fn numbers(session: &Session, id: &str) -> Vec<f64> {
    (0..session.panes().len()).map(|pane| number(session, pane, id)).collect()
}

fn clip(session: &mut Session, id: &str) -> Arc<Motion> {
    session.make_all();
    session.library().find(id).and_then(|entry| entry.motion.clone()).expect("a clip")
}

fn is_rising(values: &[f64]) -> bool {
    values.windows(2).all(|pair| pair[0] < pair[1])
}

// The course report: motion graphs.

#[test]
fn transform_places_the_first_frame_and_moves_the_whole_clip() {
    let mut session = opened("lab=view&a=walk_left&place_x=2&place_z=-1&place_heading=90");
    let first = motion(&session, 0).ground_frames()[0];
    assert!(
        first.shift.distance(DVec2::new(2.0, -1.0)) < 1e-5
            && (first.yaw.to_degrees() - 90.0).abs() < 1e-3
    );
    let own = clip(&mut session, "walk_left");
    let moved = first.after(&own.ground_frames()[0].inverse());
    let (there, here) = (motion(&session, 0).clip(), own.clip());
    assert_eq!(there.frames(), here.frames());
    for frame in (0..here.frames()).step_by(17) {
        let (p, q) = (there.world_pose(frame), here.world_pose(frame));
        assert!(
            p.positions.iter().zip(&q.positions).all(|(p, q)| p.distance(moved.apply(*q)) < 1e-4)
        );
    }
}

#[test]
fn blend_in_the_world_slerps_joints_and_mixes_roots() {
    let link =
        "lab=blend&a=walk&b=run&blend_window=30&root_blend=off&weight_law=linear&align_by=first";
    let session = opened(link);
    let made = outcome(&session, 0);
    let transition = made.transition.expect("a transition");
    let [a, b] = [Slot::A, Slot::B]
        .map(|slot| made.sources.iter().find(|source| source.slot == slot).expect("a source"));
    let frame = |secs: f64| (secs * 60.0).round() as usize;
    let (leave, enter, window) =
        (frame(transition.leave_a_secs), frame(transition.enter_b_secs), transition.window_frames);
    assert_eq!(window, 30);
    // The first pose of B is placed where A's is, with the same facing.
    let placed = b.world_from_clip.after(&b.motion.ground_frames()[enter]);
    let stands = a.motion.ground_frames()[leave];
    assert!(
        placed.shift.distance(stands.shift) < 1e-4
            && wrap_angle(placed.yaw - stands.yaw).abs() < 1e-4
    );
    let (clip_a, clip_b) = (a.motion.clip(), b.motion.clip().transformed(&b.world_from_clip));
    for p in 0..window {
        let weight = WeightLaw::Linear.alpha((p + 1) as f64 / window as f64) as f32;
        assert!((weight - (1.0 - (p + 1) as f32 / window as f32)).abs() < 1e-6);
        let root = clip_b.root_translations()[enter + p]
            .lerp(clip_a.root_translations()[leave + p], weight);
        assert!(root.distance(made.motion.clip().root_translations()[leave + p]) < 1e-4);
        let (qa, qb) = (clip_a.rotations(leave + p), clip_b.rotations(enter + p));
        for (joint, &found) in made.motion.clip().rotations(leave + p).iter().enumerate() {
            // Towards the nearer of the two quaternions of a rotation.
            let near = if qa[joint].dot(qb[joint]) < 0.0 { -qa[joint] } else { qa[joint] };
            assert!(
                quat::angle_between(found, qb[joint].slerp(near, weight)) < 1e-3,
                "{p} {joint}"
            );
        }
    }
}

const SEGMENTS: &str = "lab=graph&construction=segments&segment_size=60&blend_window=15";

#[test]
fn segments_have_edges_to_the_next_and_to_all_similar_ones() {
    let session =
        opened(&format!("{SEGMENTS}&prune=off&clips=walk,walk_left,walk_right&edge_threshold=10"));
    let whole = walk(&session, 0).built.whole();
    assert_eq!(whole.options().construction, Construction::Segments { segment_size: 60 });
    let mut goes_on = 0;
    for node in whole.graph().node_indices() {
        let stretch = whole.graph()[node];
        let length = whole.set().clips()[stretch.clip].clip().frames();
        let edges: Vec<_> = whole.graph().edges(node).map(|edge| whole.jump(edge.id())).collect();
        let next = edges.iter().filter(|jump| jump.is_none()).count();
        // The last segment of a clip has no successor.
        assert_eq!(next, usize::from(stretch.end < length));
        goes_on += next;
        assert!(edges.iter().flatten().all(|jump| jump.distance_cm <= 10.0 && jump.window == 15));
    }
    assert!(goes_on > 3 && !whole.jumps().is_empty());
}

#[test]
fn weight_proportional_to_distance_prefers_the_worst_transition() {
    let link = format!("{SEGMENTS}&segment_size=30&edge_threshold=20&continuity=0&edge_weight=");
    let [right, wrong] = ["inverse", "proportional"].map(|law| opened(&format!("{link}{law}")));
    let graph = graph(&wrong, 0);
    for node in graph.graph().node_indices() {
        let ways: Vec<(f64, f64)> = (walk(&wrong, 0).choices.probabilities(node))
            .filter_map(|(edge, p)| Some((graph.jump(edge)?.distance_cm, p)))
            .collect();
        let sum: f64 = ways.iter().map(|way| way.0).sum();
        assert!(ways.iter().all(|(distance, p)| (p - distance / sum).abs() < 1e-6));
    }
    let mean_cm = |session: &Session| {
        let walk = walk(session, 0);
        let taken = walk
            .passed
            .iter()
            .filter_map(|passed| walk.built.graph().jumps().get(passed.stay.jump?));
        let distances: Vec<f64> = taken.map(|jump| jump.distance_cm).collect();
        distances.iter().sum::<f64>() / distances.len() as f64
    };
    assert!(mean_cm(&right) < mean_cm(&wrong), "{} {}", mean_cm(&right), mean_cm(&wrong));
}

#[test]
fn constant_weight_of_the_consecutive_edge_leaves_a_clip_with_many_edges_sooner() {
    let link = format!(
        "{SEGMENTS}&edge_weight=proportional&going_on=constant&compare=continuity_weight:1,1000"
    );
    let session = opened(&link);
    for (pane, weight) in [1.0, 1_000.0].into_iter().enumerate() {
        let (graph, walk) = (graph(&session, pane), walk(&session, pane));
        let mut by_ways = Vec::new();
        for node in graph.graph().node_indices() {
            let distances: Vec<f64> = (walk.choices.probabilities(node))
                .filter_map(|(edge, _)| Some(graph.jump(edge)?.distance_cm))
                .collect();
            let sum: f64 = distances.iter().sum();
            let stays = walk.choices.p_continue(graph, node);
            if stays > 0.0 && stays < 1.0 {
                assert!((stays - weight / (weight + sum)).abs() < 1e-6);
                by_ways.push((distances.len(), stays));
            }
        }
        by_ways.sort_by_key(|way: &(usize, f64)| way.0);
        let [few, many] = [by_ways.first(), by_ways.last()].map(|way| way.expect("a choice").1);
        assert!(few > many, "{few} {many}");
    }
    let per_min = numbers(&session, "seams_per_min");
    assert!(per_min[0] > per_min[1], "{per_min:?}");
}

#[test]
fn long_window_lags_and_short_window_jumps() {
    let session =
        opened("lab=graph&construction=segments&segment_size=60&compare=blend_window:30,15,10");
    let (lag, burst) = (numbers(&session, "lag_s"), numbers(&session, "velocity_jump_dps"));
    assert!(lag[0] > lag[1] && lag[1] > lag[2], "{lag:?}");
    assert!(is_rising(&burst), "{burst:?}");
}

#[test]
fn segments_as_long_as_the_window_are_refused() {
    let session = opened(
        "lab=graph&construction=segments&blend_window=20&segment_size=60&compare=segment_size:60,30,20",
    );
    let built = [0, 1].map(|pane| walk(&session, pane).built.clone());
    let jumps = [0, 1].map(|pane| built[pane].whole().jumps().len());
    // Shorter segments give more to compare and to choose from.
    assert!(jumps[1] > 2 * jumps[0]);
    assert_eq!(
        session.panes()[2].problem.as_ref().map(ToString::to_string).as_deref(),
        Some(
            "a blend window of 20 frames leaves nothing of a segment of 20: lower the window to 19 or raise the segment to 21"
        )
    );
}

#[test]
fn higher_weight_of_continuing_keeps_a_clip_longer() {
    let session = opened("lab=graph&compare=continuity:0.3,0.8,0.98");
    let per_min = numbers(&session, "seams_per_min");
    assert!(per_min[0] > per_min[1] && per_min[1] > per_min[2], "{per_min:?}");
}

#[test]
fn wrong_angle_spins() {
    let session = opened("lab=graph&compare=atan:atan2,atan,degrees");
    let spins = numbers(&session, "spins");
    assert_eq!(spins[0], 0.0);
    assert!(spins[1..].iter().all(|&spins| spins > 5.0), "{spins:?}");
}

#[test]
fn transform_of_the_first_frame_alone_flashes() {
    let session = opened("lab=graph&compare=transform:whole,first,teleport");
    let [flashes, spins, slides] =
        ["flashes", "spins", "foot_slide_cm"].map(|id| numbers(&session, id));
    assert_eq!((flashes[0], spins[0]), (0.0, 0.0));
    assert!(flashes[1] > 0.0 && flashes[2] > 0.0);
    assert!(slides[2] > slides[0] && slides[1] > slides[0]);
    // The clip that is not transformed stays where it was recorded.
    let walk = walk(&session, 2);
    for passed in walk.passed.iter() {
        let settled = passed.start + passed.seam.map_or(0, |seam| seam.frames);
        if settled < passed.end.min(walk.motion.ground_frames().len()) {
            let recorded = &walk.built.clips().motions()[passed.stay.clip];
            let stood = recorded.ground_frames()[passed.stay.from + settled - passed.start];
            let stands = walk.motion.ground_frames()[settled];
            assert!(stands.shift.distance(stood.shift) < 1e-3, "{stands:?} {stood:?}");
        }
    }
}

#[test]
fn walk_has_the_requested_root_blend_and_weight_law() {
    let link = "lab=graph&clips=walk,walk_left,walk_right&walk_seconds=30&continuity=0.5";
    let sessions = ["", "&root_blend=off", "&root_blend=off&align_by=first", "&weight_law=linear"]
        .map(|more| opened(&format!("{link}{more}")));
    let places = |session: &Session| motion(session, 0).ground_frames().to_vec();
    let usual = places(&sessions[0]);
    for (other, name) in sessions[1..].iter().zip(["root", "alignment", "law"]) {
        let found = places(other);
        assert_eq!(found.len(), usual.len());
        assert_eq!(
            walk(other, 0).passed.len(),
            walk(&sessions[0], 0).passed.len(),
            "{name}: the same way"
        );
        assert!(found.iter().zip(&usual).any(|(p, q)| p.shift.distance(q.shift) > 1e-3), "{name}");
    }
}

// The program for path editing.

#[test]
fn motion_without_its_path_stays_in_place_with_constant_facing() {
    let mut session = opened("lab=view&a=walk_left&compare=root_motion:world,in_place,residual");
    let own = clip(&mut session, "walk_left");
    assert!(Arc::ptr_eq(motion(&session, 0).clip(), own.clip()));
    let still = motion(&session, 1);
    let facing = segue_motion::clip::character_frames(still.clip(), still.roles());
    for (frame, told) in facing.iter().zip(still.ground_frames()) {
        for stands in [frame, told] {
            assert!(stands.shift.length() < 1e-3 && stands.yaw.abs() < 1e-3, "{stands:?}");
        }
    }
    // Relative to the path the hips sway by a few centimetres.
    let residual = motion(&session, 2).ground_frames();
    let far =
        residual.iter().map(|frame| (frame.shift - residual[0].shift).length()).fold(0.0, f64::max);
    let turned = residual
        .iter()
        .map(|frame| wrap_angle(frame.yaw - residual[0].yaw).abs())
        .fold(0.0, f64::max);
    assert!(far > 0.005 && far < 0.25 && turned < 0.6);
    // Heights and the pose relative to the character are unchanged.
    for pane in [1, 2] {
        let there = motion(&session, pane).clip();
        for frame in (0..there.frames()).step_by(13) {
            assert!(
                (there.root_translations()[frame].y - own.clip().root_translations()[frame].y)
                    .abs()
                    < 1e-5
            );
            assert_eq!(there.rotations(frame)[1..], own.clip().rotations(frame)[1..]);
        }
    }
}

#[test]
fn path_with_four_control_points_carries_its_residual() {
    let session = opened("lab=path&a=walk_left&control_points=4");
    let own = outcome(&session, 0).path().expect("a path");
    assert_eq!(own.curve.spline().points().len(), 4);
    let error = number(&session, 0, "fit_rms_cm");
    let finer = number(&opened("lab=path&a=walk_left&control_points=16"), 0, "fit_rms_cm");
    assert!(finer < error);
    // Without edits, the result is the recording.
    let recorded = outcome(&session, 0).sources[0].motion.clip();
    let made = motion(&session, 0).clip();
    let off = made
        .root_translations()
        .iter()
        .zip(recorded.root_translations())
        .map(|(p, q)| p.distance(*q));
    assert!(off.fold(0.0, f32::max) < 1e-3);
}

#[test]
fn time_warp_compares_five_frames_with_a_slope_limit_of_two() {
    let session = opened("lab=register&a=walk&b=slow_walk");
    let params = session.params();
    assert_eq!(
        (
            params.number(Key::RegistrationWindow),
            params.number(Key::SlopeLimit),
            params.number(Key::WarpWeight)
        ),
        (5.0, 2.0, 0.5)
    );
    let registered = outcome(&session, 0).registered().expect("a registration");
    let path: Vec<(usize, usize)> = registered.registration.path().cells.clone();
    let (mut across, mut along) = (0, 0);
    for step in path.windows(2) {
        let (da, db) = (step[1].0 - step[0].0, step[1].1 - step[0].1);
        assert!((da, db) == (1, 1) || (da, db) == (1, 0) || (da, db) == (0, 1));
        across = if db == 0 { across + 1 } else { 0 };
        along = if da == 0 { along + 1 } else { 0 };
        assert!(across <= 2 && along <= 2);
    }
    // The average of the pair.
    assert!(
        registered.frame_pairs.iter().all(|frame_pair| (frame_pair.weights[1] - 0.5).abs() < 1e-9)
    );
}

#[test]
fn join_has_a_linear_weight_over_the_requested_part() {
    let of = |law: &str| {
        let session = opened(&format!("lab=register&a=walk&b=run&warp_mode=join&weight_law={law}"));
        let made = outcome(&session, 0).clone();
        let transition = made.transition.expect("a transition");
        let from = (transition.start_secs * made.motion.clip().fps()).round() as usize;
        let frame_pairs = &made.registered().expect("a registration").frame_pairs;
        // The frames of A in the transition, with B's weight in each.
        frame_pairs[from..from + transition.window_frames]
            .iter()
            .map(|frame_pair| (frame_pair.frames[0], frame_pair.weights[1]))
            .collect::<Vec<(f64, f64)>>()
    };
    let (linear, smooth) = (of("linear"), of("smooth"));
    assert!(linear.len() > 10 && linear.len() == smooth.len());
    let (first, last) = (linear[0], linear[linear.len() - 1]);
    assert!(first.1 < 0.05 && last.1 > 0.95);
    let slope = (last.1 - first.1) / (last.0 - first.0);
    let share = |frame: f64| first.1 + slope * (frame - first.0);
    for (frame, weight) in linear {
        assert!((weight - share(frame)).abs() < 1e-6, "{frame}: {weight}");
    }
    // The other law over the same part of the registration.
    for (frame, weight) in smooth {
        assert!(
            (weight - (1.0 - WeightLaw::Smooth.alpha(share(frame)))).abs() < 1e-6,
            "{frame}: {weight}"
        );
    }
}

#[test]
fn camera_follows_any_extra_character() {
    let link = "lab=path&a=walk&others=walk_left,walk_right&play=off&t=2&follow=";
    for (follow, other) in [
        ("other&follow_other=1", Some(0)),
        ("other&follow_other=2", Some(1)),
        ("result", None),
        ("other&follow_other=3", None),
    ] {
        let session = opened(&format!("{link}{follow}"));
        let followed = match other {
            Some(other) => session.extra_characters()[other].motion.clone().expect("it is there"),
            None => outcome(&session, 0).motion.clone(),
        };
        let panes = [(0, Viewport::default())];
        let options = StageOptions { panes: &panes, ..StageOptions::default() };
        let stage = Director::default().stage(&session, &options, 0.0);
        let (focus, stands) = (stage.panes[0].focus, followed.standing_at(2.0).origin());
        assert!(focus.distance(stands) < 0.2, "{follow}: {focus} {stands}");
    }
}

// The article on Gleicher's motion path editing.

const CURVE: &str = "lab=path&a=walk&path=AAgAABB-MHRKZmJQdDZ8Fn4J";

#[test]
fn offset_in_the_world_leaves_its_side_of_the_path() {
    let session = opened(&format!("{CURVE}&compare=path_offset:path,world"));
    let mut most: f64 = 0.0;
    for (pane, is_local) in [(0, true), (1, false)] {
        let made = outcome(&session, pane);
        let path = made.path().expect("a path");
        assert!(path.is_edited);
        let old = path.fitted.places().iter().zip(path.fitted.motion().ground_frames());
        for ((old, stood), (place, stands)) in
            old.zip(path.places.iter().zip(made.motion.ground_frames()))
        {
            let local =
                |place: &Planar, stands: &Planar| place.inverse().apply_ground(stands.shift);
            let found = local(&place.frame, stands).distance(local(&old.frame, stood));
            let world = (stands.shift - place.frame.shift).distance(stood.shift - old.frame.shift);
            assert!((if is_local { found } else { world }) < 1e-4);
            most = if is_local { most } else { most.max(found) };
        }
    }
    // The sway of the hips is a few centimetres.
    assert!(most > 0.01);
}

#[test]
fn path_of_an_unclamped_basis_begins_beside_its_first_control_point() {
    let link = "lab=path&a=walk_left&control_points=4&compare=path_spline:clamped,uniform";
    let session = opened(link);
    let [clamped, uniform] =
        [0, 1].map(|pane| outcome(&session, pane).path().expect("a path").curve.spline().clone());
    assert_eq!(uniform.ends(), SplineEnds::Uniform);
    assert_eq!(clamped.position(0.0), clamped.points()[0]);
    let p = uniform.points();
    // The matrix of the article: (1, 4, 1, 0)/6 at 0 and (0, 1, 4, 1)/6 at 1.
    let ends = [(p[0] + p[1] * 4.0 + p[2]) / 6.0, (p[1] + p[2] * 4.0 + p[3]) / 6.0];
    for (u, place) in [(0.0, ends[0]), (1.0, ends[1])] {
        assert!(
            uniform.position(u).distance(place) < 1e-9
                && uniform.position(u).distance(clamped.position(u)) < 1e-9
        );
    }
    assert!(uniform.position(0.0).distance(p[0]) > 0.1);
}

#[test]
fn body_faces_along_an_edited_path_or_as_recorded() {
    let session = opened(&format!("{CURVE}&compare=path_facing:path,world"));
    let turned = |pane: usize| {
        let frames = motion(&session, pane).ground_frames();
        frames.iter().map(|frame| wrap_angle(frame.yaw - frames[0].yaw).abs()).fold(0.0, f64::max)
    };
    assert!(turned(0) > 0.4 && turned(1) < 0.3);
}

// The homework: blending, loops, transitions, matching.

#[test]
fn two_gaits_blend_to_one_and_a_half_metres_per_second() {
    let session = opened("lab=speed&a=walk&b=run&speed=1.5");
    let made = outcome(&session, 0);
    let Some(CycleMade::Gait { asked_mps, .. }) = made.cycle.map(|cycle| cycle.made) else {
        panic!("a gait")
    };
    let frames = made.motion.ground_frames();
    let way = frames[0].shift.distance(frames[frames.len() - 1].shift);
    let speed = way / made.duration_secs();
    assert!((asked_mps - 1.5).abs() < 1e-9 && (speed / 1.5 - 1.0).abs() < 0.02);
}

#[test]
fn springs_from_both_ends_leave_a_known_seam() {
    let session = opened(
        "lab=loop&a=walk&loop_from=0.5&loop_to=1.4&half_life=0.2&loop_ratio=0.5&compare=loop_method:exact,both",
    );
    let (before, seam) = (numbers(&session, "loop_before_deg"), numbers(&session, "loop_seam_deg"));
    // A share (1 + yT) exp(-yT) of the difference is left at the other end.
    let left = |secs: f64| {
        let yt = 2.0 * std::f64::consts::LN_2 / 0.2 * secs;
        (1.0 + yt) * (-yt).exp()
    };
    assert!(seam[0] < 0.01 && seam[1] > 0.1 && seam[1] < before[1] * 2.0 * left(0.9));
}

#[test]
fn half_life_leaves_six_tenths() {
    // (1 + y t) exp(-y t) with y = 2 ln 2 / h: the share that a critically damped spring has left
    // at its half-life, and the time at which half is left.
    let left = |t: f64| {
        (1.0 + 2.0 * std::f64::consts::LN_2 * t) * (-2.0 * std::f64::consts::LN_2 * t).exp()
    };
    assert!((left(1.0) - 0.597).abs() < 1e-3 && (left(1.211) - 0.5).abs() < 1e-3);
    assert!((spring::secs_until(0.27, 0.5) - 1.211 * 0.27).abs() < 1e-3);
    let session = opened("lab=transition&a=walk&b=run&compare=half_life:0.1,0.27,0.6");
    let lag = numbers(&session, "lag_s");
    assert!(is_rising(&lag), "{lag:?}");
}

#[test]
fn frame_set_by_hand_slides_and_foot_lock_corrects_it() {
    let link = "lab=transition&a=walk&b=run&half_life=0.27&mix_frame_b=20";
    let [free, held] = ["", "&foot_lock=on"].map(|more| opened(&format!("{link}{more}")));
    let entered = outcome(&free, 0).transition.expect("a transition").enter_b_secs;
    assert!((entered * 60.0 - 20.0).abs() < 1e-6);
    let slides = [&free, &held].map(|session| number(session, 0, "foot_slide_cm"));
    assert!(slides[1] < 0.5 * slides[0], "{slides:?}");
    // The homework weights positions by 0.6 and rotations by 0.4.
    let params = free.params();
    assert_eq!((params.number(Key::MatchPosition), params.number(Key::MatchRotation)), (0.6, 0.4));
}

#[test]
fn velocities_divided_by_the_rate_stop_the_motion() {
    let session =
        opened("lab=transition&a=walk&b=run&half_life=0.27&compare=mistake:none,velocity");
    let seams = numbers(&session, "velocity_jump_dps");
    assert!(seams[1] > 2.0 * seams[0], "{seams:?}");
}

#[test]
fn driven_character_turns_with_the_stick() {
    let link = "lab=match&hysteresis=votes&search_by=tree&scenario=";
    for (scenario, degrees) in [("spin", 180.0), ("left", 90.0), ("right", -90.0)] {
        let session = opened(&format!("{link}{scenario}"));
        let frames = motion(&session, 0).ground_frames();
        let (mut turned, mut farthest) = (0.0_f64, 0.0_f64);
        for pair in frames.windows(2) {
            turned += wrap_angle(pair[1].yaw - pair[0].yaw).to_degrees();
            farthest = if turned.abs() > farthest.abs() { turned } else { farthest };
        }
        // Half a turn may be made in either direction.
        let off = if scenario == "spin" { farthest.abs() - degrees } else { farthest - degrees };
        assert!(off.abs() < 25.0, "{scenario}: {farthest}");
    }
}

#[test]
fn every_search_finds_the_same_frames() {
    let made = ["tree", "boxes", "scan"]
        .map(|by| opened(&format!("lab=match&scenario=left&search_by={by}")));
    let roots = |session: &Session| motion(session, 0).clip().root_translations().to_vec();
    let first: Vec<Vec3> = roots(&made[0]);
    assert!(first.len() > 100 && made[1..].iter().all(|other| roots(other) == first));
}

/// Uses the homework's own files, if they are there.
#[test]
fn files_of_the_homework_are_shown_in_place_and_on_a_path() {
    let Some(data) = common::shared_data() else {
        return;
    };
    for name in ["walk_forward.bvh", "run_forward.bvh"] {
        let Ok(bytes) = std::fs::read(data.join("games105").join(name)) else {
            continue;
        };
        let mut session = Session::new();
        session.load(name, bytes.into()).expect("a file that can be read");
        let id = session.params().text(Key::A).to_owned();
        assert!(id.starts_with(name.trim_end_matches(".bvh")), "{id}");
        session
            .apply(Command::OpenLink(format!("lab=view&a={id}&root_motion=in_place")))
            .expect("a link is never refused");
        while session.work() {}
        let still = motion(&session, 0);
        assert!(still.ground_frames().iter().all(|frame| frame.shift.length() < 1e-3));
        session.apply(Command::Set(vec![(Key::Lab, Value::Choice("path"))])).expect("a lab");
        while session.work() {}
        assert!(number(&session, 0, "fit_rms_cm") < 5.0);
    }
}
