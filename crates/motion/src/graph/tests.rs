//! Tests of motion graphs.

use super::*;
use crate::blend::align_onto;
use crate::clip::Motion;
use crate::clip::fixtures::{points_clip, points_skeleton};
use crate::math::Planar;
use crate::registration::fixtures::Walk;
use crate::registration::rms_cm;
use crate::skeleton::Roles;
use crate::transition::Mistake;
use glam::DVec2;
use petgraph::graph::NodeIndex;
use petgraph::visit::EdgeRef;
use proptest::prelude::*;
use std::sync::Arc;

const HEIGHT: f64 = 1.7;

fn set_of(walks: &[Walk]) -> Arc<FrameSet> {
    let sources = walks.iter().map(|walk| {
        let clip = Arc::new(walk.clip());
        let roles = Roles::detect(clip.skeleton());
        Arc::new(Motion::with_roles(clip, &roles))
    });
    Arc::new(FrameSet::new(sources.collect(), HEIGHT).unwrap())
}

/// Returns a walk, a faster one that turns, and one with another position and facing.
fn three(frames: [usize; 3]) -> Arc<FrameSet> {
    let walk = Walk::default();
    set_of(&[
        Walk { frames: frames[0], ..walk },
        Walk { frames: frames[1], cadence: 1.1, turning: 0.7, speed: 1.5, ..walk },
        Walk {
            frames: frames[2],
            phase: 0.3,
            heading: 2.5,
            start: (4.0, -3.0),
            swing: 0.5,
            ..walk
        },
    ])
}

fn compared(set: &Arc<FrameSet>) -> AllPairs {
    let mut all = AllPairs::new(Arc::clone(set)).unwrap();
    all.finish().unwrap();
    all
}

fn options(
    construction: Construction,
    blend_window: usize,
    edge_threshold_cm: f64,
) -> GraphOptions {
    GraphOptions { construction, blend_window, edge_threshold_cm, ..GraphOptions::default() }
}

fn built(set: &Arc<FrameSet>, options: &GraphOptions) -> Result<MotionGraph, GraphError> {
    let all = compared(set);
    let candidates = Candidates::find(&all, &all.distances(options.blend_window)?, options)?;
    MotionGraph::new(set, &candidates, options)
}

fn walker(graph: &Arc<MotionGraph>, weights: &WeightOptions, seed: u64) -> Walker {
    Walker::new(Arc::clone(graph), Arc::new(Choices::new(graph, weights).unwrap()), seed)
}

fn pieces(
    graph: &Arc<MotionGraph>,
    walker: &mut Walker,
    options: &StitchOptions,
    stays: usize,
) -> Vec<WalkPiece> {
    let mut stitcher = Stitcher::new(Arc::clone(graph.set()), options);
    let mut pieces = Vec::new();
    while let Some(stay) = walker.next_stay().filter(|_| pieces.len() < stays) {
        pieces.push(stitcher.stitch(graph, &stay).unwrap());
    }
    pieces
}

fn profile(set: &Arc<FrameSet>) -> WalkProfile {
    WalkProfile::new(Arc::clone(set))
}

#[test]
fn frames_are_numbered_through() {
    let set = three([30, 20, 25]);
    assert_eq!((set.frames(), set.longest(), set.fps()), (75, 30, 60.0));
    for number in 0..75 {
        assert_eq!(set.number(set.place(number).unwrap()), Some(number));
    }
    assert_eq!(set.place(30), Some(Place { clip: 1, frame: 0 }));
    assert_eq!((set.place(75), set.number(Place { clip: 1, frame: 20 })), (None, None));
    assert_eq!(FrameSet::new(vec![], HEIGHT), Err(GraphError::NoClips));
    let faster = Walk { fps: 30.0, ..Walk::default() };
    let sources = [Walk::default(), faster].map(|walk| {
        let clip = Arc::new(walk.clip());
        let roles = Roles::detect(clip.skeleton());
        Arc::new(Motion::with_roles(clip, &roles))
    });
    assert!(matches!(FrameSet::new(sources.to_vec(), HEIGHT), Err(GraphError::Blend(_))));
    assert!(matches!(
        FrameSet::new(sources[..1].to_vec(), f64::NAN),
        Err(GraphError::Setting { .. })
    ));
}

/// Checks that the overview and its details equal those computed from all distances.
fn overview_is_of(overview: &DistanceOverview, all: &FrameDistances) {
    let (frames, block) = (all.set().frames(), overview.block());
    assert_eq!(overview.window(), all.window());
    let held = all.picture(0..frames, 0..frames, 1);
    let nearest = |rows: std::ops::Range<usize>,
                   columns: std::ops::Range<usize>,
                   factor: usize|
     -> Vec<f32> {
        let mut picture = Vec::new();
        for row in rows.clone().step_by(factor) {
            for column in columns.clone().step_by(factor) {
                let cells = (row..(row + factor).min(rows.end)).flat_map(|row| {
                    let columns = column..(column + factor).min(columns.end);
                    columns.map(move |column| (row, column))
                });
                picture.push(
                    cells.map(|(row, column)| held[row * frames + column]).fold(f32::NAN, f32::min),
                );
            }
        }
        picture
    };
    let same = |found: &[f32], wanted: &[f32], what: &str| {
        assert_eq!(found.len(), wanted.len(), "{what}");
        for (at, (found, wanted)) in found.iter().zip(wanted).enumerate() {
            // The points are relative to other centres: see the accuracy of `PairTerms`.
            let alike = (found * found - wanted * wanted).abs() < 4e-3 + 2e-3 * wanted;
            assert!(alike || (found.is_nan() && wanted.is_nan()), "{what} {at}: {found} {wanted}");
        }
    };
    for factor in [block, 4 * block] {
        let last = frames / factor * factor;
        let (rows, columns) = (0..frames, (last / 2 / factor * factor)..frames);
        same(
            &overview.picture(rows.clone(), columns.clone(), factor),
            &nearest(rows, columns, factor),
            "from afar",
        );
    }
    for (rows, columns, factor) in [
        (0..frames, 0..frames, 2),
        (frames / 3..frames / 2, frames / 4..frames, 1),
        (5..6, 0..frames, 3),
    ] {
        let mut detail = overview.detail(rows.clone(), columns.clone(), factor);
        while !detail.advance(1).unwrap().is_complete() {}
        same(detail.picture(), &nearest(rows, columns, factor), "nearby");
    }
    let counts =
        (overview.histogram(), all.histogram(DistanceOverview::BIN_CM, DistanceOverview::BINS));
    let off: usize = counts.0.iter().zip(&counts.1).map(|(a, b)| a.abs_diff(*b) as usize).sum();
    let total: usize = counts.0.iter().map(|&count| count as usize).sum();
    assert_eq!(total, counts.1.iter().map(|&count| count as usize).sum::<usize>());
    // At the edge of a bin the last digit decides.
    assert!(off * 200 <= total + 200, "{off} of {total}");
    for (a, b) in [(0, frames - 1), (frames / 2, 3), (4, 4)] {
        let (a, b) = (all.set().place(a).unwrap(), all.set().place(b).unwrap());
        let (found, wanted) = (overview.cm(a, b), all.cm(a, b));
        assert_eq!(found.is_some(), wanted.is_some());
        if let (Some(found), Some(wanted)) = (found, wanted) {
            assert!(
                (found * found - wanted * wanted).abs() < 4e-3 + 2e-3 * wanted,
                "{found} {wanted}"
            );
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]
    #[test]
    fn all_pairs_are_what_aligning_gives(frames in [5usize..40, 5usize..40, 5usize..40], window in 1usize..12, slice in 1usize..900) {
        let set = three(frames);
        let mut all = AllPairs::new(Arc::clone(&set)).unwrap();
        prop_assert!(all.distances(window).is_err());
        let mut before = 0;
        while !all.advance(slice).unwrap().is_complete() {
            prop_assert!(all.progress().done > before);
            before = all.progress().done;
        }
        prop_assert_eq!(all.progress().total, {
            let all: usize = frames.iter().sum();
            250 * all + all * (all + 1) / 2
        });
        let mut sweep = all.sweep(window).unwrap();
        while !sweep.advance(7).unwrap().is_complete() {}
        let distances = sweep.finish().unwrap();
        for a in 0..set.frames() {
            for b in 0..set.frames() {
                let (p, q) = (set.place(a).unwrap(), set.place(b).unwrap());
                let fits = [p, q].iter().all(|place| place.frame + window <= set.frames_of(place.clip));
                let found = distances.cm(p, q);
                prop_assert_eq!(found.is_some(), fits);
                // One candidate in seven is sufficient.
                let Some(found) = found.filter(|_| (a + 3 * b) % 7 == 0) else { continue };
                let source = |place: Place| set.clip(place.clip).unwrap().clip();
                let direct = align_onto(source(p), p.frame, source(q), q.frame, window, set.weights(), 0.0).unwrap();
                let wanted = rms_cm(direct.distance, direct.weight, HEIGHT);
                prop_assert!((found * found - wanted * wanted).abs() < 4e-3 + 2e-3 * wanted, "{:?} {:?} {} {}", p, q, found, wanted);
                let aligned = all.alignment(p, q, window).unwrap();
                if !direct.turn_is_free && !aligned.turn_is_free && wanted < 30.0 {
                    let off = aligned.transform.inverse().after(&direct.transform);
                    prop_assert!(off.yaw.abs() < 1e-3 && off.shift.length() < 1e-2, "{:?}", off);
                }
            }
        }
    }

    #[test]
    fn tiles_find_what_all_pairs_do(
        frames in [20usize..90, 20usize..90, 20usize..90], window in 1usize..18, segment in prop::option::of(19usize..20), threshold in 0.5f64..30.0
    ) {
        let set = three(frames);
        let construction = segment.map_or(Construction::Minima, |segment_size| Construction::Segments { segment_size });
        let options = options(construction, window, threshold);
        let all = compared(&set);
        let held = Candidates::find(&all, &all.distances(window).unwrap(), &options).unwrap();
        let (streamed, overview) = CandidateStream::new(&set, &options).unwrap().finish().unwrap();
        overview_is_of(&overview, &all.distances(window).unwrap());
        let places = |of: &Candidates| {
            let mut places: Vec<_> = of.found().iter().map(|found| (found.leave, found.enter)).collect();
            places.sort_unstable();
            places
        };
        prop_assert_eq!(places(&held), places(&streamed));
        for (a, b) in held.found().iter().zip(streamed.found()) {
            prop_assert!((a.distance_cm - b.distance_cm).abs() < 0.0021);
        }
        if segment.is_none() {
            // The slow way: every pair, compared with its neighbours.
            let distances = all.distances(window).unwrap();
            for found in held.found() {
                let (a, b) = (found.leave, found.enter);
                let here = distances.cm(a, b).unwrap();
                prop_assert!(here <= threshold && a.frame >= 1 && b.frame + window < set.frames_of(b.clip));
                for (da, db) in [(-1i64, 0i64), (1, 0), (0, -1), (0, 1), (1, 1), (-1, -1), (1, -1), (-1, 1)] {
                    let moved = |place: Place, by: i64| Place { frame: (place.frame as i64 + by) as usize, ..place };
                    if a.frame as i64 + da >= 0 && b.frame as i64 + db >= 0
 && let Some(there) = distances.cm(moved(a, da), moved(b, db)) {
                            prop_assert!(there >= here, "{:?} {} {}", found, here, there);
 }
                }
            }
        }
    }
}

#[test]
fn long_clips_are_tiled_without_a_gap() {
    let set = three([2_600, 530, 40]);
    let options = options(Construction::Minima, 20, 12.0);
    let all = compared(&set);
    let held = Candidates::find(&all, &all.distances(20).unwrap(), &options).unwrap();
    let mut stream = CandidateStream::new(&set, &options).unwrap();
    let total = stream.advance(1).unwrap().total;
    // 2,581, 511 and 21 windows, in parts that end at every 256th of all frames: 11, 3 and one.
    assert_eq!(total, 15 + 15 * 16 / 2);
    let (streamed, overview) = stream.finish().unwrap();
    assert_eq!(overview.block(), 2);
    overview_is_of(&overview, &all.distances(20).unwrap());
    assert!(held.found().len() > 100, "{}", held.found().len());
    let same = held
        .found()
        .iter()
        .filter(|a| streamed.found().iter().any(|b| (a.leave, a.enter) == (b.leave, b.enter)))
        .count();
    // Equal neighbours may swap places because of the last digit.
    assert!(
        same * 100 >= held.found().len() * 98
            && held.found().len().abs_diff(streamed.found().len()) * 100 <= held.found().len()
    );
}

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
        GraphError::NowhereToGo { lower_window, farthest_secs, .. } => {
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
fn any_setting_answers() {
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
fn one_short_clip_is_told_what_would_do() {
    let set = set_of(&[Walk { frames: 60, ..Walk::default() }]);
    let mut told = 0;
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
                let is_told =
                    matches!(error, GraphError::NowhereToGo { .. } | GraphError::NoMinimum { .. });
                told += usize::from(is_told);
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
    assert!(told > 10, "{told}");
    let short = set_of(&[Walk { frames: 2, ..Walk::default() }]);
    let sentence = options(Construction::Minima, 1, 6.0).check(&short).unwrap_err().to_string();
    assert!(!sentence.contains("lower") && sentence.ends_with("add a longer clip"), "{sentence}");
    let far = |window| GraphError::TooFar { window, nearest_cm: 71.5 }.to_string();
    assert!(far(30).contains("lower the blend window of 30") && !far(1).contains("lower"));
}

#[test]
fn a_long_walk_is_as_curious_as_a_short_one() {
    let graph = minima_graph();
    let most_seen = |factor: f64, before: usize| {
        let mut walker = self::walker(
            &graph,
            &WeightOptions { continuity: Continuity::Share(0.5), ..WeightOptions::default() },
            4,
        );
        walker = walker.with_visited_discount(factor).unwrap();
        assert!((0..before).all(|_| walker.next_edge().is_some()));
        let seen = walker.visits().to_vec();
        assert!((0..2_000).all(|_| walker.next_edge().is_some()));
        walker.visits().iter().zip(seen).map(|(now, seen)| now - seen).max().unwrap()
    };
    let (plain, early, late) = (most_seen(1.0, 30_000), most_seen(0.7, 0), most_seen(0.7, 30_000));
    // A random walk without discounts visits some places again and again.
    assert!(late <= early && 10 * late < 7 * plain, "{plain} {early} {late}");
}

fn nodes(graph: &MotionGraph) -> Vec<(usize, usize, usize)> {
    graph.graph().node_weights().map(|s| (s.clip, s.start, s.end)).collect()
}

#[test]
fn what_is_found_for_a_threshold_serves_all_lower_ones() {
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
fn jolts_that_are_found_ahead_are_those_that_a_search_finds() {
    let (ahead, plain) = (three([60, 50, 40]), three([60, 50, 40]));
    let mut search = JoltSearch::default();
    let slices = (0..1_000).take_while(|_| !search.advance(&ahead, 100)).count();
    assert!(slices > 5 && search.advance(&ahead, 100), "{slices}");
    for clip in 0..4 {
        assert_eq!(ahead.jolts(clip), plain.jolts(clip));
    }
}

#[test]
fn numbers_that_are_none_are_refused() {
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

fn minima_graph() -> Arc<MotionGraph> {
    let set = three([300, 260, 240]);
    Arc::new(built(&set, &options(Construction::Minima, 12, 9.0)).unwrap().pruned().unwrap())
}

#[test]
fn shares_add_up_and_follow_their_law() {
    let graph = minima_graph();
    let laws = [
        DistanceLaw::Inverse,
        DistanceLaw::Exponential { sigma_cm: 1.5 },
        DistanceLaw::Uniform,
        DistanceLaw::Proportional,
    ];
    for law in laws {
        for continuity in [0.0, 0.3, 1.0] {
            let weights = WeightOptions { continuity: Continuity::Share(continuity), law };
            let choices = Choices::new(&graph, &weights).unwrap();
            for node in graph.graph().node_indices() {
                let whole: u64 = choices.ways(node).iter().map(|way| way.1).sum();
                assert_eq!(whole, 1 << 32);
                let jumps: Vec<(f64, f64)> = choices
                    .probabilities(node)
                    .filter_map(|(edge, p)| Some((graph.jump(edge)?.distance_cm, p)))
                    .collect();
                let p_continue = choices.p_continue(&graph, node);
                if jumps.len() < choices.ways(node).len() && !jumps.is_empty() {
                    assert!((p_continue - continuity).abs() < 1e-9);
                    assert_eq!(choices.expected_run_nodes(&graph, node), 1.0 / (1.0 - p_continue));
                }
                for pair in jumps.windows(2).filter(|_| continuity < 1.0) {
                    let [(d, p), (e, q)] = [pair[0], pair[1]];
                    let wanted = match law {
                        DistanceLaw::Inverse => e.max(0.01) / d.max(0.01),
                        DistanceLaw::Exponential { sigma_cm } => ((e - d) / sigma_cm).exp(),
                        DistanceLaw::Uniform => 1.0,
                        DistanceLaw::Proportional => d.max(0.01) / e.max(0.01),
                    };
                    assert!((p / q / wanted - 1.0).abs() < 1e-6, "{law:?} {p} {q} {wanted}");
                }
            }
        }
    }
    assert!(
        Choices::new(
            &graph,
            &WeightOptions { continuity: Continuity::Share(1.1), ..WeightOptions::default() }
        )
        .is_err()
    );
    let nothing = DistanceLaw::Exponential { sigma_cm: 0.0 };
    assert!(
        Choices::new(&graph, &WeightOptions { law: nothing, ..WeightOptions::default() }).is_err()
    );
}

#[test]
fn a_constant_weight_of_going_on_stays_less_often_the_more_ways_lead_out() {
    let graph = minima_graph();
    let shares = |weight: f64| {
        let weights = WeightOptions {
            continuity: Continuity::Weight(weight),
            law: DistanceLaw::Proportional,
        };
        let choices = Choices::new(&graph, &weights).unwrap();
        let mut of_nodes: Vec<(f64, f64)> = Vec::new();
        for node in graph.graph().node_indices() {
            assert_eq!(choices.ways(node).iter().map(|way| way.1).sum::<u64>(), 1 << 32);
            let jumps: Vec<f64> = choices
                .probabilities(node)
                .filter_map(|(edge, _)| Some(graph.jump(edge)?.distance_cm.max(0.01)))
                .collect();
            if jumps.len() < choices.ways(node).len() && !jumps.is_empty() {
                let sum: f64 = jumps.iter().sum();
                let p = choices.p_continue(&graph, node);
                assert!((p - weight / (weight + sum)).abs() < 1e-9, "{weight}: {p}");
                of_nodes.push((sum, p));
            }
        }
        of_nodes.sort_by(|a, b| a.0.total_cmp(&b.0));
        of_nodes
    };
    // With a constant weight, the probability to continue falls with the number of transitions;
    // with a weight of 1,000 it is nearly 1.
    let (one, thousand) = (shares(1.0), shares(1_000.0));
    assert!(one.first().unwrap().1 > 1.5 * one.last().unwrap().1, "{one:?}");
    assert!(
        one.iter().zip(&thousand).all(|(one, thousand)| thousand.1 > one.1 && thousand.1 > 0.5)
    );
    for wrong in [0.0, -1.0, f64::NAN] {
        let weights =
            WeightOptions { continuity: Continuity::Weight(wrong), ..WeightOptions::default() };
        assert!(Choices::new(&graph, &weights).is_err(), "{wrong}");
    }
}

#[test]
fn runs_are_as_long_as_expected() {
    let graph = minima_graph();
    for continuity in [0.2, 0.8] {
        let weights =
            WeightOptions { continuity: Continuity::Share(continuity), ..WeightOptions::default() };
        let expected = Choices::new(&graph, &weights).unwrap().expected_run_secs(&graph).unwrap();
        let mut walker = walker(&graph, &weights, 11);
        let (mut frames, count) = (0, 20_000);
        for _ in 0..count {
            let stay = walker.next_stay().unwrap();
            frames += stay.to - stay.from;
        }
        let found = frames as f64 / f64::from(count) / graph.set().fps();
        assert!((found / expected - 1.0).abs() < 0.05, "{continuity}: {found} {expected}");
    }
}

#[test]
fn a_pruned_graph_has_no_end_and_a_seed_gives_one_walk() {
    let set = three([300, 260, 240]);
    let whole = built(&set, &options(Construction::Minima, 12, 9.0)).unwrap();
    assert!(!whole.dead_ends().is_empty());
    let graph = Arc::new(whole.pruned().unwrap());
    assert_eq!(graph.dead_ends(), []);
    assert_eq!(graph.components().len(), 1);
    assert_eq!(graph.components()[0].len(), graph.graph().node_count());
    let edges = |seed| {
        let mut walker = walker(&graph, &WeightOptions::default(), seed);
        (0..2_000).map(|_| walker.next_edge().unwrap().index()).collect::<Vec<_>>()
    };
    assert_eq!(edges(5), edges(5));
    assert_ne!(edges(5), edges(6));
    // A walk through the unpruned graph ends, and stays at its end.
    let whole = Arc::new(whole);
    let mut walker = walker(
        &whole,
        &WeightOptions { continuity: Continuity::Share(1.0), ..WeightOptions::default() },
        1,
    );
    let last = std::iter::from_fn(|| walker.next_stay()).last().unwrap();
    assert_eq!((last.clip, last.to), (0, 300));
    assert_eq!(walker.next_stay(), None);
}

#[test]
fn a_clip_can_be_gone_to_and_what_was_seen_can_be_avoided() {
    let graph = minima_graph();
    let weights = WeightOptions::default();
    let mut walker = walker(&graph, &weights, 2);
    let clips: Vec<usize> = (0..3)
        .filter(|&clip| graph.graph().node_weights().any(|stretch| stretch.clip == clip))
        .collect();
    assert!(clips.len() > 1);
    for &clip in clips.iter().rev() {
        assert!(walker.go_to_clip(clip));
        let there = |walker: &Walker| graph.graph()[walker.node()].clip == clip;
        let steps = (0..200).find(|_| there(&walker) || walker.next_edge().is_none());
        assert!(steps.is_some() && there(&walker));
    }
    assert!(!walker.go_to_clip(99));
    let unseen = |factor: f64| {
        let mut walker = self::walker(&graph, &weights, 4).with_visited_discount(factor).unwrap();
        assert!((0..300).all(|_| walker.next_edge().is_some()));
        walker.visits().iter().filter(|visits| **visits == 0).count()
    };
    assert!(unseen(0.3) < unseen(1.0), "{} {}", unseen(0.3), unseen(1.0));
    assert!(self::walker(&graph, &weights, 4).with_visited_discount(1.5).is_err());
    // All transitions are discounted to 0, and still a way is chosen.
    let mut all_seen = self::walker(&graph, &weights, 4).with_visited_discount(0.0).unwrap();
    assert!((0..500).all(|_| all_seen.next_edge().is_some()));
}

#[test]
fn pieces_follow_each_other_without_a_jump() {
    let graph = minima_graph();
    let set = graph.set();
    let profile = profile(set);
    for stitch in [StitchOptions::dissolve(12), StitchOptions::inertialize(0.1)] {
        let mut walker = walker(
            &graph,
            &WeightOptions { continuity: Continuity::Share(0.4), ..WeightOptions::default() },
            9,
        );
        let pieces = pieces(&graph, &mut walker, &stitch, 60);
        let mut start = 0;
        for piece in &pieces {
            assert_eq!(
                (piece.start, piece.clip.frames()),
                (start, piece.stay.to - piece.stay.from)
            );
            start += piece.clip.frames();
            // After the transition it is the clip itself, as recorded.
            let settled = piece.seam.map_or(0, |seam| seam.frames);
            if let StitchOptions { method: crate::transition::Method::Dissolve { .. }, .. } = stitch
            {
                for frame in (settled..piece.clip.frames()).step_by(5) {
                    let own =
                        set.clip(piece.stay.clip).unwrap().clip().pose(piece.stay.from + frame);
                    let off =
                        piece.clip.pose(frame).root_translation.distance(own.root_translation);
                    assert!(off < 1e-4, "{off}");
                    assert_eq!(piece.clip.rotations(frame)[3], own.rotations[3]);
                }
            }
        }
        let (clip, frames) = assembled(&pieces).unwrap().unwrap();
        let most = clip.frames() - 7;
        let mut assembling = Assembling::new(&pieces, most).unwrap();
        while !assembling.advance(&pieces, 23) {}
        assert_eq!(
            assembling.finish().unwrap(),
            (clip.crop(0..most).unwrap(), frames[..most].to_vec())
        );
        assert_eq!((clip.frames(), frames.len()), (start, start));
        let metrics = WalkMetrics::measure(&pieces, &graph, &profile);
        let mut meter = WalkMeter::new(set);
        for piece in &pieces {
            while !meter.advance(piece, &profile, 17) {}
        }
        assert_eq!(meter.metrics(&profile), metrics);
        assert_eq!(metrics.seams.len(), pieces.len() - 1);
        assert_eq!((metrics.spins(), metrics.flashes()), (0, 0), "{:?}", metrics.seams);
        assert!(metrics.variety > 0.3 && metrics.variety <= 1.0);
        let roots = clip.root_translations();
        let longest = roots.windows(2).map(|pair| pair[0].distance(pair[1])).fold(0.0, f32::max);
        assert!(longest < 0.06, "{longest}");
        let numbers = [metrics.seams_per_minute(), metrics.median_lag_s()];
        assert!(numbers.into_iter().flatten().all(f64::is_finite), "{numbers:?}");
    }
    assert!(assembled(&[]).unwrap().is_none());
}

#[test]
fn overlapping_blends_do_not_jump_either() {
    let set = three([200, 200, 200]);
    let options = options(Construction::Segments { segment_size: 20 }, 17, 25.0);
    let graph = Arc::new(built(&set, &options).unwrap().pruned().unwrap());
    let mut walker = walker(
        &graph,
        &WeightOptions { continuity: Continuity::Share(0.1), ..WeightOptions::default() },
        1,
    );
    let pieces = pieces(&graph, &mut walker, &StitchOptions::dissolve(17), 80);
    assert!(pieces.iter().any(|piece| piece.clip.frames() == 3));
    let metrics = WalkMetrics::measure(&pieces, &graph, &profile(&set));
    assert_eq!((metrics.spins(), metrics.flashes()), (0, 0));
}

#[test]
fn mistakes_spin() {
    let graph = minima_graph();
    let profile = profile(graph.set());
    let measured = |mistake| {
        let mut walker = walker(
            &graph,
            &WeightOptions { continuity: Continuity::Share(0.4), ..WeightOptions::default() },
            9,
        );
        let options = StitchOptions { mistake, ..StitchOptions::dissolve(12) };
        WalkMetrics::measure(&pieces(&graph, &mut walker, &options, 60), &graph, &profile)
    };
    assert_eq!(measured(None).spins(), 0);
    let of_transition =
        [Mistake::AtanForAtan2, Mistake::DegreesInTransform, Mistake::WrongFacingAxis]
            .map(WalkMistake::Transition);
    let of_walk = [WalkMistake::FirstFrameOnly, WalkMistake::FirstFrameThenRecorded];
    for mistake in of_walk.into_iter().chain(of_transition) {
        let wrong = measured(Some(mistake));
        assert!(wrong.spins() > 0, "{mistake:?}");
        assert_eq!(wrong.secs, measured(None).secs);
    }
}

#[test]
fn a_path_is_followed() {
    let set = three([300, 260, 240]);
    let graph =
        Arc::new(built(&set, &options(Construction::Minima, 12, 12.0)).unwrap().pruned().unwrap());
    let path = GroundPath::new(&[DVec2::new(3.0, 1.0), DVec2::new(3.0, 5.0), DVec2::new(8.0, 9.0)])
        .unwrap();
    assert!((path.length() - 4.0 - 41.0_f64.sqrt()).abs() < 1e-12);
    assert_eq!(
        (path.at(-1.0), path.at(4.0), path.at(99.0)),
        (DVec2::new(3.0, 1.0), DVec2::new(3.0, 5.0), DVec2::new(8.0, 9.0))
    );
    let start = NodeIndex::new(0);
    let stitched = StitchOptions::dissolve(12);
    let found = follow(&graph, start, &path, 60_000, &stitched);
    assert!(
        found.arrives && found.rms_m < 1.5,
        "{} {} {} {}",
        found.arrives,
        found.rms_m,
        found.along_m,
        found.looked_at
    );
    assert_eq!(follow(&graph, start, &path, 60_000, &stitched), found);
    // Slices give the same result, and the best walk so far gets longer.
    for nodes in [1, 700] {
        let mut search = FollowSearch::new(&graph, start, &path, 60_000, &stitched);
        let (mut before, mut slices) = (0.0, 0);
        while !search.advance(&graph, &path, nodes) {
            slices += 1;
            if slices % (2_100 / nodes) == 0 {
                let (so_far, kept) = (search.so_far(&graph, &path), search.progress(&path));
                assert!(
                    !so_far.edges.is_empty()
                        && kept >= before
                        && so_far.along_m >= kept * path.length() - 1e-9
                );
                before = kept;
            }
        }
        assert!(slices > 10 && before > 0.3, "{slices} {before}");
        assert_eq!(search.so_far(&graph, &path), found);
    }
    for pair in found.edges.windows(2) {
        let [before, after] =
            [pair[0], pair[1]].map(|edge| graph.graph().edge_endpoints(edge).unwrap());
        assert_eq!(before.1, after.0);
    }
    // The resulting motion follows the planned trajectory.
    for options in [StitchOptions::dissolve(12), StitchOptions::inertialize(0.1)] {
        let found = follow(&graph, start, &path, 6_000, &options);
        let mut stitcher = Stitcher::new(Arc::clone(graph.set()), &options);
        stitcher.start_at(found.world_from_first);
        let mut walker = walker(&graph, &WeightOptions::default(), 1);
        walker.take(found.edges.iter().copied());
        let (mut along, mut last, mut square, mut frames) = (0.0, None, 0.0, 0.0);
        while walker.has_way() {
            let piece = stitcher.stitch(&graph, &walker.next_stay().unwrap()).unwrap();
            for frame in &piece.frames {
                let at = piece.world_from_piece.after(frame).shift;
                along += last.map_or(0.0, |last: DVec2| last.distance(at));
                last = Some(at);
                square += at.distance_squared(path.at(along));
                frames += 1.0;
            }
        }
        let rms_m = f64::sqrt(square / frames);
        assert!((rms_m - found.rms_m).abs() < 0.05 * found.rms_m, "{rms_m} {}", found.rms_m);
    }
    // A small budget also gives a walk, and is hardly exceeded.
    let hasty = follow(&graph, start, &path, 40, &stitched);
    assert!(!hasty.edges.is_empty() && hasty.looked_at < 1_000);
    assert!(
        GroundPath::new(&[DVec2::ZERO]).is_err()
            && GroundPath::new(&[DVec2::NAN, DVec2::ZERO]).is_err()
    );
}

#[test]
fn graphs_are_written() {
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
fn pictures_and_histograms_count_every_pair() {
    let set = three([30, 22, 18]);
    let all = compared(&set);
    let distances = all.distances(5).unwrap();
    let windows = 26 + 18 + 14;
    let counts = distances.histogram(2.0, 10);
    assert_eq!(counts.iter().sum::<u32>() as usize, windows * (windows - 1) / 2);
    let picture = distances.picture(0..70, 20..70, 10);
    assert_eq!(picture.len(), 7 * 5);
    let one = distances.picture(3..4, 40..41, 1)[0];
    assert!(
        (f64::from(one)
            - distances.cm(Place { clip: 0, frame: 3 }, Place { clip: 1, frame: 10 }).unwrap())
        .abs()
            < 1e-3
    );
    assert!(distances.picture(27..28, 0..1, 1)[0].is_nan());
    let _: Planar = all
        .alignment(Place { clip: 1, frame: 3 }, Place { clip: 0, frame: 4 }, 5)
        .unwrap()
        .transform;
}

/// Distance, centimetres; clip and frame that are left; clip and frame that are entered.
#[test]
fn a_clip_whose_first_frame_alone_is_moved_goes_back_to_where_it_was_recorded() {
    let graph = minima_graph();
    let window = 12;
    let mut walker = walker(&graph, &WeightOptions::default(), 9);
    let options = StitchOptions {
        mistake: Some(WalkMistake::FirstFrameThenRecorded),
        ..StitchOptions::dissolve(window)
    };
    let pieces = pieces(&graph, &mut walker, &options, 12);
    assert!(pieces.len() > 5);
    for piece in &pieces {
        let recorded = graph.set().clip(piece.stay.clip).unwrap();
        for frame in (piece.seam.map_or(0, |seam| seam.frames)..piece.clip.frames()).step_by(7) {
            let stands = piece.world_from_piece.after(&piece.frames[frame]);
            let stood = recorded.ground_frames()[piece.stay.from + frame];
            assert!(
                stands.shift.distance(stood.shift) < 1e-4 && (stands.yaw - stood.yaw).abs() < 1e-4
            );
            let root = piece.world_from_piece.apply(piece.clip.root_translations()[frame]);
            assert!(
                root.distance(recorded.clip().root_translations()[piece.stay.from + frame]) < 1e-4
            );
        }
    }
    // In the frame of the seam it is at the position of the previous clip.
    let (_, frames) = assembled(&pieces).unwrap().unwrap();
    for piece in pieces.iter().filter(|piece| piece.seam.is_some()) {
        let step = frames[piece.start - 1].shift.distance(frames[piece.start].shift);
        assert!(step < 0.06, "{step}");
    }
}

#[test]
fn transitions_beyond_the_most_ways_out_are_counted() {
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
        // The stay that comes closest.
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
fn graph_and_walk_are_those_of_numpy() {
    let golden: Golden =
        serde_json::from_str(include_str!("../../tests/oracles/graph.json")).unwrap();
    let skeleton = points_skeleton(4);
    let sources = golden.clips.iter().map(|frames| {
        let clip = points_clip(&skeleton, 60.0, frames);
        Arc::new(Motion::with_roles(clip, &Roles::detect(&skeleton)))
    });
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
