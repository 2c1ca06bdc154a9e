//! The index against the exhaustive search, on features of synthesised motion.

use super::*;
use crate::{Scaling, StandardBody};
use segue_motion::clip::Motion;
use segue_motion::matching::Layout;
use segue_motion::synth::{Action, Params, synthesize};
use std::sync::OnceLock;

/// A corpus of features, and queries that are not in it; scaled.
struct Sample {
    layout: Layout,
    clips: Vec<MomentRows>,
    rows: Vec<f32>,
    queries: Vec<f32>,
}

fn sample() -> &'static Sample {
    static SAMPLE: OnceLock<Sample> = OnceLock::new();
    SAMPLE.get_or_init(|| {
        let body = StandardBody::new().unwrap();
        let dims = body.layout().dims();
        let features = |number: usize| {
            let action = [Action::Walk, Action::Run, Action::Start, Action::Stop][number % 4];
            let mut params = Params::new(action);
            params.duration_secs = 6.0;
            params.turn_rate_dps = (number * 7 % 13) as f32 * 6.0 - 36.0;
            params.seed = number as u32;
            if action != Action::Run {
                params.speed_mps = 0.9 + (number * 5 % 11) as f32 * 0.08;
            }
            let motion = Motion::analyze(synthesize(&params).unwrap().clip);
            body.place(&motion).unwrap().features
        };
        let own: Vec<Vec<f32>> = (0..60).map(features).collect();
        let mut queries: Vec<f32> = (100..105).flat_map(features).collect();
        let scaling = Scaling::of(body.layout(), own.iter().flat_map(|own| own.chunks_exact(dims)));
        let clips = own.iter().enumerate();
        let clips = clips.map(|(clip, own)| MomentRows { clip, count: own.len() / dims }).collect();
        let mut rows = own.concat();
        for row in rows.chunks_exact_mut(dims).chain(queries.chunks_exact_mut(dims)) {
            scaling.apply(row);
        }
        Sample { layout: body.layout().clone(), clips, rows, queries }
    })
}

/// Returns the bytes of lists.
fn lists<'a>(index: &Index, files: &'a [Vec<u8>], wanted: &[usize]) -> Vec<(usize, &'a [u8])> {
    let bytes = |list: &usize| {
        let place = index.place(*list).unwrap();
        (*list, &files[place.file][place.bytes()])
    };
    wanted.iter().map(bytes).collect()
}

/// Returns the moments nearest to a query by the features themselves.
fn exhaustive(sample: &Sample, query: &[f32], count: usize) -> Vec<(f32, u32, u32)> {
    let places = sample
        .clips
        .iter()
        .flat_map(|own| (0..own.count).map(move |moment| (own.clip as u32, moment as u32)));
    let mut all: Vec<(f32, u32, u32)> = (sample.rows.chunks_exact(query.len()).zip(places))
        .map(|(row, (clip, moment))| (squared(row, query).sqrt(), clip, moment))
        .collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
    all.truncate(count);
    all
}

#[test]
fn search_with_the_stated_probes_finds_95_percent_of_the_ten_nearest() {
    let sample = sample();
    let dims = sample.layout.dims();
    let files = build(&sample.rows, dims, &sample.clips).unwrap();
    let index = Index::read(&files.centroids).unwrap();
    assert!(index.moments() > 2_500 && index.lists() > 80, "{} lists", index.lists());
    let recall = |probes: usize| {
        let (mut found, mut queries) = (0usize, 0usize);
        for query in sample.queries.chunks_exact(dims) {
            let wanted = index.nearest_lists(query, probes).unwrap();
            let hits = index.search(query, &lists(&index, &files.lists, &wanted), 10).unwrap();
            let near = exhaustive(sample, query, 10);
            found += hits
                .iter()
                .filter(|hit| near.iter().any(|(_, c, m)| (*c, *m) == (hit.clip, hit.moment)))
                .count();
            queries += 1;
        }
        found as f64 / (10 * queries) as f64
    };
    let found = [1, files.probes, index.lists()].map(recall);
    // One list is not enough, so that this can fail; all lists lose by rounding alone.
    assert!(found[0] < 0.9 && found[1] >= 0.95 && found[2] >= 0.98, "{found:?}");
}

#[test]
fn search_of_all_lists_has_the_distances_of_the_exhaustive_search() {
    let sample = sample();
    let dims = sample.layout.dims();
    let files = build(&sample.rows, dims, &sample.clips).unwrap();
    let index = Index::read(&files.centroids).unwrap();
    let query = &sample.queries[..dims];
    let all = index.nearest_lists(query, usize::MAX).unwrap();
    let hits = index.search(query, &lists(&index, &files.lists, &all), usize::MAX).unwrap();
    assert_eq!(hits.len(), index.moments());
    let near = exhaustive(sample, query, usize::MAX);
    for (hit, (distance, ..)) in hits.iter().zip(near) {
        assert!((hit.distance - distance).abs() < 0.02, "{} {distance}", hit.distance);
    }
    let clips = index.search_clips(query, &lists(&index, &files.lists, &all), 7).unwrap();
    assert_eq!((clips.len(), clips[0]), (7, hits[0]));
    assert!(clips.iter().all(|hit| hits.iter().find(|own| own.clip == hit.clip) == Some(hit)));
}

#[test]
fn every_moment_is_in_one_list() {
    let sample = sample();
    let dims = sample.layout.dims();
    let files = build(&sample.rows, dims, &sample.clips).unwrap();
    let index = Index::read(&files.centroids).unwrap();
    let query = vec![0.0; dims];
    let all: Vec<usize> = (0..index.lists()).collect();
    let hits = index.search(&query, &lists(&index, &files.lists, &all), usize::MAX).unwrap();
    let mut places: Vec<(u32, u32)> = hits.iter().map(|hit| (hit.clip, hit.moment)).collect();
    places.sort_unstable();
    let expected = sample
        .clips
        .iter()
        .flat_map(|own| (0..own.count).map(move |moment| (own.clip as u32, moment as u32)));
    assert!(places.into_iter().eq(expected));
}

#[test]
fn index_that_is_damaged_is_refused() {
    let files = build(&[0.0, 1.0, 2.0, 3.0], 2, &[MomentRows { clip: 0, count: 2 }]).unwrap();
    let bytes = &files.centroids;
    let index = Index::read(bytes).unwrap();
    for end in 0..bytes.len() {
        assert!(Index::read(&bytes[..end]).is_err(), "{end}");
    }
    assert!(Index::read(&[bytes.as_slice(), &[0]].concat()).is_err());
    let mut endless = bytes.clone();
    endless[12..16].fill(0xff);
    assert!(Index::read(&endless).is_err());
    assert!(index.search(&[0.0], &[], 1).is_err());
    assert!(index.nearest_lists(&[0.0; 3], 1).is_err());
    assert!(index.search(&[0.0, 0.0], &[(0, &[1, 2, 3])], 1).is_err());
    assert!(index.search(&[0.0, 0.0], &[(99, &[])], 1).is_err());
}

#[test]
fn index_without_moments_finds_nothing() {
    let files = build(&[], 27, &[MomentRows { clip: 0, count: 0 }]).unwrap();
    let index = Index::read(&files.centroids).unwrap();
    assert_eq!(index.moments(), 0);
    assert_eq!(index.nearest_lists(&[0.0; 27], 5).unwrap(), [0usize; 0]);
    assert_eq!(index.search(&[0.0; 27], &[], 5).unwrap(), []);
}
