//! Tests of the distances between all windows, and of the candidates for transitions.

use super::*;
use crate::blend::align_onto;
use crate::math::Planar;
use crate::registration::{RegistrationError, rms_cm};
use proptest::prelude::*;
use std::ops::Range;

#[test]
fn frame_set_of_clips_numbers_frames_consecutively() {
    let set = three([30, 20, 25]);
    assert_eq!((set.frames(), set.longest(), set.fps()), (75, 30, 60.0));
    for number in 0..75 {
        assert_eq!(set.number(set.place(number).unwrap()), Some(number));
    }
    assert_eq!(set.place(30), Some(Place { clip: 1, frame: 0 }));
    assert_eq!((set.place(75), set.number(Place { clip: 1, frame: 20 })), (None, None));
    assert_eq!(FrameSet::new(vec![], HEIGHT), Err(GraphError::NoClips));
    let faster = Walk { fps: 30.0, ..Walk::default() };
    let sources = [Walk::default(), faster].map(|walk| Arc::new(Motion::analyze(walk.clip())));
    assert!(matches!(FrameSet::new(sources.to_vec(), HEIGHT), Err(GraphError::Blend(_))));
    assert!(matches!(
        FrameSet::new(sources[..1].to_vec(), f64::NAN),
        Err(GraphError::Setting { .. })
    ));
}

/// Checks that the overview and its details equal those computed from all distances.
fn assert_overview_equals(overview: &DistanceOverview, all: &FrameDistances) {
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
        // Overlapping or apart, within the tiles of 256 frames or across them.
        (frames / 20..frames / 5, frames / 10..frames / 4, 1),
        (frames / 20..frames / 15, frames / 10..frames / 8, 1),
    ] {
        let picture = |rows: &Range<usize>, columns: &Range<usize>| {
            let mut detail = overview.detail(rows.clone(), columns.clone(), factor);
            while !detail.advance(1).is_complete() {}
            detail.picture().to_vec()
        };
        let found = picture(&rows, &columns);
        let turned = picture(&columns, &rows);
        let height = rows.len().div_ceil(factor);
        for (at, cell) in found.iter().enumerate() {
            let width = found.len() / height;
            let there = turned[at % width * height + at / width];
            assert_eq!(cell.to_bits(), there.to_bits(), "turned {at}: {cell} {there}");
        }
        same(&found, &nearest(rows, columns, factor), "nearby");
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
    fn all_pairs_agree_with_direct_alignment(
        frames in [5usize..40, 5usize..40, 5usize..40],
        window in 1usize..12,
        slice in 1usize..900,
    ) {
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
                let fits =
                    [p, q].iter().all(|place| place.frame + window <= set.frames_of(place.clip));
                let found = distances.cm(p, q);
                prop_assert_eq!(found.is_some(), fits);
                // One candidate in seven is sufficient.
                let Some(found) = found.filter(|_| (a + 3 * b) % 7 == 0) else { continue };
                let source = |place: Place| set.clip(place.clip).unwrap().clip();
                let direct =
                    align_onto(source(p), p.frame, source(q), q.frame, window, set.weights(), 0.0)
                        .unwrap();
                let wanted = rms_cm(direct.distance, direct.weight, HEIGHT);
                prop_assert!(
                    (found * found - wanted * wanted).abs() < 4e-3 + 2e-3 * wanted,
                    "{:?} {:?} {} {}",
                    p,
                    q,
                    found,
                    wanted
                );
                let aligned = all.alignment(p, q, window).unwrap();
                if !direct.turn_is_free && !aligned.turn_is_free && wanted < 30.0 {
                    let off = aligned.transform.inverse().after(&direct.transform);
                    prop_assert!(off.yaw.abs() < 1e-3 && off.shift.length() < 1e-2, "{:?}", off);
                }
            }
        }
    }

    #[test]
    fn candidate_stream_finds_the_candidates_of_all_pairs(
        frames in [20usize..90, 20usize..90, 20usize..90],
        window in 1usize..18,
        segment in prop::option::of(19usize..20),
        threshold in 0.5f64..30.0,
    ) {
        let set = three(frames);
        let construction = segment
            .map_or(Construction::Minima, |segment_size| Construction::Segments { segment_size });
        let options = options(construction, window, threshold);
        let all = compared(&set);
        let held = Candidates::find(&all, &all.distances(window).unwrap(), &options).unwrap();
        let (streamed, overview) = CandidateStream::new(&set, &options).unwrap().finish().unwrap();
        assert_overview_equals(&overview, &all.distances(window).unwrap());
        let places = |of: &Candidates| {
            let mut places: Vec<_> =
                of.found().iter().map(|found| (found.leave, found.enter)).collect();
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
                prop_assert!(
                    here <= threshold && a.frame >= 1 && b.frame + window < set.frames_of(b.clip)
                );
                for (da, db) in
                    [(-1i64, 0i64), (1, 0), (0, -1), (0, 1), (1, 1), (-1, -1), (1, -1), (-1, 1)]
                {
                    let moved = |place: Place, by: i64| Place {
                        frame: (place.frame as i64 + by) as usize,
                        ..place
                    };
                    if a.frame as i64 + da >= 0
                        && b.frame as i64 + db >= 0
                        && let Some(there) = distances.cm(moved(a, da), moved(b, db))
                    {
                        prop_assert!(there >= here, "{:?} {} {}", found, here, there);
                    }
                }
            }
            prop_assert_eq!(places(&held), minima(&set, &distances, &options));
        }
    }
}

/// Returns the ends of the candidates in their order, found by trying every pair of windows.
fn minima(
    set: &FrameSet,
    distances: &FrameDistances,
    options: &GraphOptions,
) -> Vec<(Place, Place)> {
    let clips = set.clips().len();
    let mut found = Vec::new();
    for (a, b) in (0..clips).flat_map(|a| (a..clips).map(move |b| (a, b))) {
        let block = distances.block(a, b).unwrap();
        let (rows, columns) = block.size();
        for (row, column) in (0..rows).flat_map(|row| (0..columns).map(move |at| (row, at))) {
            let too_near = a == b && column < row + options.min_jump(set);
            let here = block.get(row, column).unwrap();
            if too_near || set.rounded_cm(here) > options.edge_threshold_cm {
                continue;
            }
            let is_below = |r: usize, c: usize| {
                let there = block.get(r, c);
                there.is_none_or(|there| here < there || (here == there && (row, column) <= (r, c)))
            };
            let is_minimum = (row.saturating_sub(1)..=row + 1)
                .all(|r| (column.saturating_sub(1)..=column + 1).all(|c| is_below(r, c)));
            let is_calm = |place: Place| {
                let jolts = set.jolts(place.clip).get(place.frame.saturating_sub(1)..=place.frame);
                jolts.is_some_and(|jolts| jolts.iter().all(|&jolt| jolt <= 4.0))
            };
            let [a, b] = [(a, row), (b, column)].map(|(clip, frame)| Place { clip, frame });
            for (leave, enter) in [(a, b), (b, a)] {
                let fits = leave.frame >= 1
                    && enter.frame + options.blend_window < set.frames_of(enter.clip);
                if is_minimum && fits && is_calm(leave) && is_calm(enter) {
                    found.push((leave, enter));
                }
            }
        }
    }
    found.sort_unstable();
    found
}

/// Computes all tiles in an order drawn by `seed`, shared out among several computers as if they
/// were workers; then again with another window, from the products that these kept.
fn tiled(
    set: &Arc<FrameSet>,
    options: &[GraphOptions],
    workers: usize,
    max_bytes: usize,
    seed: u64,
) -> (FrameDistances, Vec<u32>, Candidates) {
    let mut computers: Vec<TileComputer> =
        (0..workers).map(|_| TileComputer::new(Arc::clone(set), max_bytes).unwrap()).collect();
    let mut state = seed;
    let mut draw = |below: usize| {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % below
    };
    let mut result = None;
    for options in options {
        let mut tiles = DistanceTile::all(set, options.blend_window);
        let mut counts = vec![0; DistanceOverview::BINS];
        let (mut distances, mut candidates) = (Vec::new(), Vec::new());
        while !tiles.is_empty() {
            let tile = tiles.swap_remove(draw(tiles.len()));
            let made = computers[draw(workers)].compute(&tile, options).unwrap();
            assert_eq!(made.rms_m.len(), tile.cells(set, options.blend_window));
            counts.iter_mut().zip(&made.counts).for_each(|(sum, count)| *sum += count);
            distances.push((tile, made.rms_m));
            candidates.push(made.candidates);
        }
        result = Some((
            FrameDistances::of_tiles(set, options.blend_window, distances),
            counts,
            CandidateSort::of_tiles(set, options, candidates).finish(),
        ));
    }
    result.unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(10))]
    #[test]
    fn tiles_in_any_order_give_the_bits_of_all_pairs(
        frames in [500usize..1_200, 20usize..90, 5usize..560],
        windows in [1usize..18, 1usize..18],
        segment in prop::option::of(19usize..40),
        threshold in 0.5f64..30.0,
        workers in 1usize..4,
        max_bytes in prop::option::of(1usize..2_000_000),
        seed: u64,
    ) {
        let set = three(frames);
        let construction = segment
            .map_or(Construction::Minima, |segment_size| Construction::Segments { segment_size });
        let all = compared(&set);
        let options = windows.map(|window| options(construction, window, threshold));
        let wanted = all.distances(windows[1]).unwrap();
        let max_bytes = max_bytes.unwrap_or(usize::MAX);
        let (found, counts, candidates) = tiled(&set, &options, workers, max_bytes, seed);
        prop_assert!(found == wanted);
        prop_assert_eq!(
            counts,
            wanted.histogram(DistanceOverview::BIN_CM, DistanceOverview::BINS)
        );
        prop_assert_eq!(candidates, Candidates::find(&all, &wanted, &options[1]).unwrap());
        for (a, b) in [(0, set.frames() - 1), (set.frames() / 2, 3), (530, 4)] {
            let place = |frame| set.place(frame);
            if let (Some(a), Some(b)) = (place(a), place(b)) {
                prop_assert_eq!(found.cm(a, b), wanted.cm(a, b));
            }
        }
    }
}

#[test]
fn candidates_beside_the_cut_between_parts_are_found() {
    // A walk that does not repeat itself has no equal neighbours, which might swap places.
    let walk = Walk { frames: 640, cadence: 0.931_71, turning: 0.37, ..Walk::default() };
    let source = Arc::new(Motion::analyze(walk.clip()));
    let set = Arc::new(FrameSet::new(vec![source], HEIGHT).unwrap());
    for window in [1, 9] {
        let options = options(Construction::Minima, window, 30.0);
        let all = compared(&set);
        let held = Candidates::find(&all, &all.distances(window).unwrap(), &options).unwrap();
        let stream = CandidateStream::new(&set, &options).unwrap();
        assert_eq!(stream.parts(), 2);
        let (streamed, _) = stream.finish().unwrap();
        let places = |of: &Candidates| {
            let mut places: Vec<_> =
                of.found().iter().map(|found| (found.leave.frame, found.enter.frame)).collect();
            places.sort_unstable();
            places
        };
        let places = [places(&held), places(&streamed)];
        assert!(places[0] == places[1]);
        for beside in [504..512, 512..520] {
            let is_there = |&(leave, enter)| beside.contains(&leave) || beside.contains(&enter);
            assert!(places[0].iter().any(is_there), "{window} {beside:?}");
        }
    }
}

#[test]
fn stream_with_windows_of_too_many_frames_is_refused() {
    let set = three([9_000, 30, 30]);
    let refused = |window| {
        let options = options(Construction::Minima, window, 12.0);
        let error = CandidateStream::new(&set, &options).map(|_| ()).unwrap_err();
        assert_eq!(StreamComputer::new(&set, window).map(|_| ()).unwrap_err(), error);
        error
    };
    assert!(matches!(
        refused(8_000),
        GraphError::Registration(RegistrationError::TooManyPairs { .. })
    ));
}

#[test]
fn stream_rows_in_any_order_give_the_bits_of_the_stream() {
    let set = three([1_300, 530, 40]);
    for (construction, window) in
        [(Construction::Minima, 20), (Construction::Segments { segment_size: 35 }, 12)]
    {
        let options = options(construction, window, 12.0);
        let (wanted, whole) = CandidateStream::new(&set, &options).unwrap().finish().unwrap();
        let computer = StreamComputer::new(&set, window).unwrap();
        let mut stream = CandidateStream::new(&set, &options).unwrap();
        let parts = stream.parts();
        let mut rows: Vec<usize> = (0..parts).collect();
        rows.sort_by_key(|row| (row * 7 + 3) % parts);
        while !stream.is_prepared() {
            stream.advance(1).unwrap();
        }
        for row in rows {
            assert!(!stream.progress().is_complete());
            stream.include(computer.row(row, &options).unwrap());
        }
        assert!(stream.progress().is_complete());
        let (found, overview) = stream.finish().unwrap();
        assert!(found == wanted && !found.found().is_empty());
        assert_eq!(overview.histogram(), whole.histogram());
        let all = || 0..set.frames();
        let pictures = [&overview, &whole].map(|overview| overview.picture(all(), all(), 1));
        assert!(pictures[0].iter().zip(&pictures[1]).all(|(a, b)| a.to_bits() == b.to_bits()));
    }
}

#[test]
fn candidate_stream_of_long_clips_has_no_gap() {
    let set = three([2_600, 530, 40]);
    let options = options(Construction::Minima, 20, 12.0);
    let all = compared(&set);
    let held = Candidates::find(&all, &all.distances(20).unwrap(), &options).unwrap();
    let mut stream = CandidateStream::new(&set, &options).unwrap();
    let total = stream.advance(1).unwrap().total;
    // 2,581, 511 and 21 windows, in parts that end at every 512th of all frames: 6, 2 and one.
    assert_eq!(total, 9 + 9 * 10 / 2);
    let (streamed, overview) = stream.finish().unwrap();
    assert_eq!(overview.block(), 2);
    assert_overview_equals(&overview, &all.distances(20).unwrap());
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

#[test]
fn jolt_search_in_slices_equals_jolts_on_demand() {
    let (ahead, plain) = (three([60, 50, 40]), three([60, 50, 40]));
    let mut search = JoltSearch::default();
    let slices = (0..1_000).take_while(|_| !search.advance(&ahead, 100)).count();
    assert!(slices > 5 && search.advance(&ahead, 100), "{slices}");
    for clip in 0..4 {
        assert_eq!(ahead.jolts(clip), plain.jolts(clip));
    }
}

#[test]
fn histogram_includes_every_pair() {
    let set = three([30, 22, 18]);
    let all = compared(&set);
    let distances = all.distances(5).unwrap();
    let windows = 26 + 18 + 14;
    let counts = distances.histogram(2.0, 10);
    assert_eq!(counts.iter().sum::<u32>() as usize, windows * (windows - 1) / 2);
    let _: Planar = all
        .alignment(Place { clip: 1, frame: 3 }, Place { clip: 0, frame: 4 }, 5)
        .unwrap()
        .transform;
}

#[test]
fn picture_of_any_part_is_the_mean_of_its_samples() {
    let set = three([30, 22, 18]);
    let distances = compared(&set).distances(5).unwrap();
    let tiled = {
        let mut computer = TileComputer::new(Arc::clone(&set), 0).unwrap();
        let options = options(Construction::Minima, 5, 1.0);
        let tiles = DistanceTile::all(&set, 5).into_iter().map(|tile| {
            let made = computer.compute(&tile, &options).unwrap();
            (tile, made.rms_m)
        });
        FrameDistances::of_tiles(&set, 5, tiles)
    };
    for (rows, columns, factor) in
        [(0..70, 20..70, 10), (0..70, 0..70, 9), (5..41, 5..41, 1), (40..70, 0..31, 3)]
    {
        let picture = distances.picture(rows.clone(), columns.clone(), factor);
        let squares = |of: &Range<usize>| of.clone().step_by(factor).map(move |at| at..at + factor);
        let mut texels = picture.iter();
        for down in squares(&rows) {
            for across in squares(&columns) {
                let sampled = |of: &Range<usize>, all: &Range<usize>| {
                    let frames = of.clone().filter(|frame| all.contains(frame));
                    frames.step_by(factor.div_ceil(4)).collect::<Vec<_>>()
                };
                let mut found = Vec::new();
                for row in sampled(&down, &rows) {
                    for column in sampled(&across, &columns) {
                        let place = |frame| set.place(frame).unwrap();
                        found.extend(distances.cm(place(row), place(column)));
                    }
                }
                let mean = found.iter().sum::<f64>() / found.len() as f64;
                let texel = f64::from(*texels.next().unwrap());
                let same = (texel - mean).abs() < 2e-3 || (texel.is_nan() && found.is_empty());
                assert!(same, "{down:?} {across:?}: {texel} {mean}");
            }
        }
        assert_eq!(texels.next(), None);
        let bits = |picture: &[f32]| picture.iter().map(|cm| cm.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&picture), bits(&tiled.picture(rows, columns, factor)));
    }
}
