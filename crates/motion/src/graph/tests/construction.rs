//! Tests of the construction of graphs, of its errors, and of the export.

use super::*;
use crate::clip::fixtures::{points_clip, points_skeleton};
use petgraph::visit::EdgeRef;

/// Returns the options that an error message suggests.
fn remedies(error: &GraphError, options: &GraphOptions) -> Vec<(&'static str, GraphOptions)> {
    let segments = |segment_size| GraphOptions {
        construction: Construction::Segments { segment_size },
        ..*options
    };
    let window = |blend_window| GraphOptions { blend_window, ..*options };
    let threshold = |edge_threshold_cm| GraphOptions { edge_threshold_cm, ..*options };
    match *error {
        GraphError::SegmentTooShort { segment, window: found } => {
            let lowered = (segment > 1).then(|| ("lower the window", window(segment - 1)));
            [("raise the segment", segments(found + 1))].into_iter().chain(lowered).collect()
        }
        GraphError::SegmentTooLong { longest, .. } => {
            vec![("lower the segment", segments(longest))]
        }
        GraphError::WindowTooLong { longest, .. } if longest > 2 => {
            vec![("lower the window", window(longest - 2))]
        }
        GraphError::NoTransition { nearest_cm, .. } => {
            let raised = error::above(nearest_cm);
            assert!(
                raised <= GraphOptions::MAX_THRESHOLD_CM
                    && error.to_string().contains(&format!("to {raised:.1} cm"))
            );
            vec![("raise the threshold", threshold(raised))]
        }
        GraphError::JumpsTooShort { lower_window, farthest_secs, .. } => {
            let jump = (farthest_secs * 100.0 + 1e-6).floor() / 100.0;
            let lowered = GraphOptions { min_jump_secs: jump, ..*options };
            let window = lower_window.map(|found| ("lower the window", window(found)));
            [("lower the jump", lowered)].into_iter().chain(window).collect()
        }
        GraphError::NoMinimum { window } => vec![("cut", segments(window + 1))],
        _ => Vec::new(),
    }
}

/// Every segment size and blend window gives a graph without dead ends, or an error whose advice
/// leads to one.
#[test]
fn graph_of_any_options_is_built_or_refused_with_working_advice() {
    let set = three([34, 25, 9]);
    let all = compared(&set);
    let attempt = |options: &GraphOptions| -> Result<MotionGraph, GraphError> {
        options.check(&set)?;
        let candidates = Candidates::find(&all, &all.distances(options.blend_window)?, options)?;
        MotionGraph::new(&set, &candidates, options)?.pruned()
    };
    let (mut graphs, mut sentences) = (0, 0);
    let mut kinds: std::collections::BTreeMap<String, usize> = std::collections::BTreeMap::new();
    for segment_size in 0..=36 {
        for blend_window in 1..=36 {
            for (threshold, min_jump_secs) in [(0.0, 0.05), (6.0, 0.05), (60.0, 0.05), (6.0, 0.6)] {
                // 0 stands for the construction by minima.
                let construction = match segment_size {
                    0 => Construction::Minima,
                    segment_size => Construction::Segments { segment_size },
                };
                let options = GraphOptions {
                    min_jump_secs,
                    ..options(construction, blend_window, threshold)
                };
                match attempt(&options) {
                    Ok(graph) => {
                        graphs += 1;
                        let graph = Arc::new(graph);
                        let mut walker = walker(&graph, &WeightOptions::default(), 3);
                        let pieces =
                            pieces(&graph, &mut walker, &StitchOptions::dissolve(blend_window), 12);
                        assert_eq!(pieces.len(), 12, "{options:?}");
                        for piece in &pieces {
                            assert!(
                                piece.clip.frames() > 0
                                    && piece.frames.len() == piece.clip.frames()
                            );
                        }
                    }
                    Err(error) => {
                        sentences += 1;
                        let sentence = error.to_string();
                        assert!(sentence.contains(':'), "{sentence}");
                        let mended = remedies(&error, &options);
                        for (remedy, mended) in &mended {
                            let again = attempt(mended);
                            let is_same = again.as_ref().is_err_and(|again| {
                                std::mem::discriminant(again) == std::mem::discriminant(&error)
                            });
                            assert!(!is_same, "{sentence}: {remedy} {mended:?} {again:?}");
                        }
                        // The message names each remedy that works, and only remedies that were
                        // tried.
                        for word in ["lower", "raise", "cut"] {
                            let tried = mended
                                .iter()
                                .filter(|(remedy, _)| remedy.starts_with(word))
                                .count();
                            // "lower the jump to … s, the window to …"
                            let named = sentence.matches(word).count()
                                + usize::from(
                                    word == "lower" && sentence.contains(" s, the window to"),
                                );
                            assert_eq!(tried, named, "{sentence} {mended:?}");
                        }
                        *kinds
                            .entry(
                                sentence
                                    .split([':', '0', '1', '2', '3', '4', '5', '6', '7', '8', '9'])
                                    .next()
                                    .unwrap()
                                    .to_owned(),
                            )
                            .or_insert(0) += 1;
                    }
                }
            }
        }
    }
    assert!(graphs > 300 && sentences > 300, "{graphs} {sentences}");
    assert!(kinds.len() >= 5, "{kinds:?}");
}

/// With one short clip the window leaves no room for a jump.
#[test]
fn graph_of_one_short_clip_is_refused_with_working_advice() {
    let set = set_of(&[Walk { frames: 60, ..Walk::default() }]);
    let mut advised = 0;
    for construction in [
        Construction::Minima,
        Construction::Segments { segment_size: 57 },
        Construction::Segments { segment_size: 20 },
    ] {
        for blend_window in [5, 19, 40, 50, 56] {
            for min_jump_secs in [0.0, 0.2, 0.5, 2.0] {
                let options =
                    GraphOptions { min_jump_secs, ..options(construction, blend_window, 60.0) };
                let Err(error) = built(&set, &options) else {
                    continue;
                };
                let has_advice = matches!(
                    error,
                    GraphError::JumpsTooShort { .. } | GraphError::NoMinimum { .. }
                );
                advised += usize::from(has_advice);
                for (remedy, mended) in remedies(&error, &options) {
                    let again = built(&set, &mended);
                    let is_same = again.as_ref().is_err_and(|again| {
                        std::mem::discriminant(again) == std::mem::discriminant(&error)
                    });
                    assert!(!is_same, "{error}: {remedy} {mended:?} {again:?}");
                }
            }
        }
    }
    assert!(advised > 10, "{advised}");
    let short = set_of(&[Walk { frames: 2, ..Walk::default() }]);
    let sentence = options(Construction::Minima, 1, 6.0).check(&short).unwrap_err().to_string();
    assert!(!sentence.contains("lower") && sentence.ends_with("add a longer clip"), "{sentence}");
    let far = |window| GraphError::TooFar { window, nearest_cm: 71.5 }.to_string();
    assert!(far(30).contains("lower the blend window of 30") && !far(1).contains("lower"));
}

#[test]
fn candidates_of_a_threshold_include_those_of_lower_ones() {
    let set = three([300, 260, 240]);
    let all = compared(&set);
    for construction in [Construction::Minima, Construction::Segments { segment_size: 30 }] {
        let high = options(construction, 12, 20.0);
        let found = Candidates::find(&all, &all.distances(12).unwrap(), &high).unwrap();
        assert!(found.are_all_within(20.0) && !found.are_all_within(20.1));
        for threshold in [3.0, 8.0, 19.9, 20.0] {
            let low = options(construction, 12, threshold);
            match (MotionGraph::new(&set, &found, &low), built(&set, &low)) {
                (Ok(one), Ok(other)) => {
                    assert_eq!((one.jumps(), nodes(&one)), (other.jumps(), nodes(&other)));
                }
                (one, other) => assert_eq!(one.err(), other.err()),
            }
        }
    }
}

#[test]
fn graph_options_out_of_range_are_refused() {
    let set = three([30, 30, 30]);
    for wrong in [
        GraphOptions { edge_threshold_cm: f64::NAN, ..GraphOptions::default() },
        GraphOptions { edge_threshold_cm: -1.0, ..GraphOptions::default() },
        GraphOptions { min_jump_secs: f64::INFINITY, ..GraphOptions::default() },
        GraphOptions { most_ways_out: 0, ..GraphOptions::default() },
        GraphOptions { blend_window: usize::MAX, ..GraphOptions::default() },
        options(Construction::Segments { segment_size: usize::MAX }, 3, 5.0),
    ] {
        assert!(matches!(wrong.check(&set), Err(GraphError::Setting { .. })), "{wrong:?}");
    }
    let all = compared(&set);
    let distances = all.distances(7).unwrap();
    let other = Candidates::find(&all, &distances, &options(Construction::Minima, 8, 5.0));
    assert_eq!(other, Err(GraphError::OtherWindow { found: 7, expected: 8 }));
}

#[test]
fn export_contains_every_node_and_edge() {
    let graph = minima_graph();
    let choices = Choices::new(&graph, &WeightOptions::default()).unwrap();
    let json = graph.to_json(&choices);
    assert_eq!(json["nodes"].as_array().unwrap().len(), graph.graph().node_count());
    let edges = json["edges"].as_array().unwrap();
    assert_eq!(edges.len(), graph.graph().edge_count());
    assert_eq!(edges.iter().filter(|edge| edge["leave"].is_object()).count(), graph.jumps().len());
    let dot = graph.to_dot(&choices);
    assert!(
        dot.starts_with("digraph {") && dot.matches(" -> ").count() == edges.len(),
        "{}",
        &dot[..200]
    );
    assert_eq!(dot.matches("style = dashed").count(), graph.jumps().len());
}

#[test]
fn transitions_beyond_the_limit_of_ways_out_are_counted() {
    let set = three([300, 260, 240]);
    let all = GraphOptions {
        most_ways_out: 1_000,
        ..options(Construction::Segments { segment_size: 30 }, 12, 20.0)
    };
    let graph = built(&set, &all).unwrap();
    assert_eq!(graph.left_out(), 0);
    let few = built(&set, &GraphOptions { most_ways_out: 2, ..all }).unwrap();
    assert!(few.left_out() > 0);
    assert_eq!(few.jumps().len() + few.left_out(), graph.jumps().len());
    assert_eq!(few.pruned().unwrap().left_out(), few.left_out());
    for node in few.graph().node_indices() {
        let mut jumps = few
            .graph()
            .edges(node)
            .filter_map(|edge| few.jump(edge.id()))
            .map(|jump| jump.distance_cm)
            .collect::<Vec<_>>();
        assert!(jumps.len() <= 2);
        // The closest two transitions of all are kept.
        let mut of_all = graph
            .graph()
            .edges(node)
            .filter_map(|edge| graph.jump(edge.id()))
            .map(|jump| jump.distance_cm)
            .collect::<Vec<_>>();
        for distances in [&mut jumps, &mut of_all] {
            distances.sort_by(f64::total_cmp);
        }
        of_all.truncate(2);
        assert_eq!(jumps, of_all);
    }
}

/// Distance, centimetres; clip and frame that are left; clip and frame that are entered.
type GoldenJump = (f64, (usize, usize), (usize, usize));

#[derive(serde::Deserialize)]
struct Golden {
    window: usize,
    threshold_cm: f64,
    min_jump: usize,
    height: f64,
    continuity: f64,
    seed: u64,
    clips: Vec<Vec<Vec<[f32; 3]>>>,
    jumps: Vec<GoldenJump>,
    nodes: Vec<(usize, usize, usize)>,
    kept: Vec<(usize, usize, usize)>,
    stays: Vec<(usize, usize, usize)>,
}

#[test]
fn graph_and_walk_agree_with_numpy() {
    let golden: Golden =
        serde_json::from_str(include_str!("../../../tests/oracles/graph.json")).unwrap();
    let skeleton = points_skeleton(4);
    let sources = golden
        .clips
        .iter()
        .map(|frames| Arc::new(Motion::analyze(points_clip(&skeleton, 60.0, frames))));
    let set = Arc::new(FrameSet::new(sources.collect(), golden.height).unwrap());
    let options = GraphOptions {
        min_jump_secs: golden.min_jump as f64 / 60.0,
        ..options(Construction::Minima, golden.window, golden.threshold_cm)
    };
    let graph = built(&set, &options).unwrap();
    let pair = |place: Place| (place.clip, place.frame);
    assert_eq!(graph.jumps().len(), golden.jumps.len());
    for (jump, wanted) in graph.jumps().iter().zip(&golden.jumps) {
        assert!((jump.distance_cm - wanted.0).abs() < 0.0021, "{jump:?} {wanted:?}");
        assert_eq!((pair(jump.leave), pair(jump.enter)), (wanted.1, wanted.2));
    }
    assert_eq!(nodes(&graph), golden.nodes);
    let graph = Arc::new(graph.pruned().unwrap());
    assert_eq!(nodes(&graph), golden.kept);
    let weights = WeightOptions {
        continuity: Continuity::Share(golden.continuity),
        law: DistanceLaw::Inverse,
    };
    let mut walker = walker(&graph, &weights, golden.seed);
    for wanted in &golden.stays {
        let stay = walker.next_stay().unwrap();
        assert_eq!((stay.clip, stay.from, stay.to), *wanted);
    }
}
