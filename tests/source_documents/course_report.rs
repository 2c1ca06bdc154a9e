//! The course report: motion graphs.

use super::*;

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
