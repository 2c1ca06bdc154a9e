//! Tests of the motion of walks, and of walks along a path.

use super::*;
use crate::transition::Mistake;
use glam::DVec2;
use petgraph::graph::NodeIndex;

fn profile(set: &Arc<FrameSet>) -> WalkProfile {
    WalkProfile::new(Arc::clone(set))
}

#[test]
fn pieces_of_a_walk_join_without_a_jump() {
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
        let mut assembling = WalkAssembly::new(&pieces, most).unwrap();
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
fn pieces_with_overlapping_transitions_join_without_a_jump() {
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
fn walk_mistakes_cause_spins() {
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
fn follow_stays_close_to_its_path() {
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
fn first_frame_mistake_returns_to_the_recorded_position() {
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
