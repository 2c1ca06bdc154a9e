//! Tests of the probabilities of ways, and of walks.

use super::*;

#[test]
fn visited_discount_in_a_long_walk_is_as_strong_as_in_a_short_one() {
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

#[test]
fn shares_of_a_node_sum_to_one_and_follow_their_law() {
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
fn continuity_by_weight_falls_with_the_number_of_ways_out() {
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
fn walk_runs_have_the_expected_length() {
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
fn walk_in_a_pruned_graph_is_endless_and_determined_by_its_seed() {
    let set = three([300, 260, 240]);
    let whole = built(&set, &options(Construction::Minima, 12, 9.0)).unwrap();
    assert!(!whole.dead_ends().is_empty());
    let graph = Arc::new(whole.pruned().unwrap());
    assert_eq!(graph.dead_ends(), []);
    assert_eq!(graph.components().len(), 1);
    assert_eq!(graph.components()[0].len(), graph.graph().node_count());
    // Each of its transitions is one of the whole graph.
    assert!(graph.jumps().len() < whole.jumps().len());
    for made in [&*graph, &whole] {
        for edge in made.graph().edge_indices() {
            let origin = made.origin(edge).map(|index| whole.jumps()[index]);
            assert_eq!(origin.as_ref(), made.jump(edge));
        }
    }
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
fn walker_reaches_a_requested_clip_and_avoids_visited_nodes() {
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
