//! Tests that all searches agree.

use super::*;
use crate::matching::features::Normaliser;
use crate::matching::tags::Tag;
use crate::matching::{FeatureOptions, Features, Layout, Normalisation};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::{Rng, SeedableRng};
use std::sync::Arc;

/// Returns a random number from -1 to 1.
fn number(random: &mut Pcg64Mcg) -> f32 {
    (random.next_u32() >> 8) as f32 / (1 << 23) as f32 - 1.0
}

struct Field {
    features: Features,
    tags: Vec<TagSet>,
    valid: Arc<Vec<u32>>,
}

/// Returns frames that move through the space of features as a motion does, with clips whose ends
/// cannot be found, and tags.
fn field(times: usize, frames: usize, seed: u64) -> Field {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let trajectory_secs = (1..=times).map(|i| i as f64 / 3.0).collect();
    let layout =
        Layout::new(&FeatureOptions { trajectory_secs, ..FeatureOptions::default() }).unwrap();
    let (mut rows, mut tags, mut valid) = (Vec::new(), Vec::new(), Vec::new());
    let (mut at, mut speed) = (vec![0.0f32; layout.dims()], vec![0.0f32; layout.dims()]);
    for frame in 0..frames {
        if frame % 97 == 0 {
            at.fill_with(|| number(&mut random));
        }
        for (at, speed) in at.iter_mut().zip(&mut speed) {
            *speed = 0.9 * *speed + 0.03 * number(&mut random);
            *at += *speed;
        }
        // Some frames are duplicated: equal costs.
        if frame % 13 == 5 {
            let twin = rows.len() - layout.dims();
            rows.extend_from_within(twin..);
        } else {
            rows.extend_from_slice(&at);
        }
        let kind = (frame / 41) % 5;
        tags.push(
            TagSet::of(match kind {
                0 => &[Tag::Walk],
                1 => &[Tag::Run, Tag::Turn],
                2 => &[Tag::Idle],
                3 => &[Tag::Walk, Tag::Own(3)],
                _ => &[],
            })
            .with(Tag::Exclude, frame % 211 < 9),
        );
        if frame % 97 < 70 {
            valid.push(frame as u32);
        }
    }
    let valid = Arc::new(valid);
    let features = Normaliser::new(layout, Normalisation::Block, rows, Arc::clone(&valid)).finish();
    Field { features, tags, valid }
}

impl Field {
    fn candidates(&self) -> Candidates<'_> {
        Candidates { features: &self.features, tags: &self.tags, valid: &self.valid }
    }

    fn index(&self) -> BoxIndex {
        BoxBuilder::new(&self.valid, &[]).finish(&self.features)
    }
}

fn filters() -> [TagFilter; 6] {
    let of = |tags: &[Tag]| TagSet::of(tags);
    let none = TagSet::NONE;
    [
        TagFilter::default(),
        TagFilter { ask: of(&[Tag::Walk]), forbid: none },
        TagFilter { ask: none, forbid: of(&[Tag::Turn, Tag::Idle]) },
        TagFilter { ask: of(&[Tag::Run, Tag::Own(3)]), forbid: of(&[Tag::Idle]) },
        TagFilter { ask: of(&[Tag::Own(3)]), forbid: none },
        TagFilter { ask: of(&[Tag::Own(9)]), forbid: none },
    ]
}

/// 10,000 random queries: noise, frames of the field with a little noise, and unchanged frames;
/// random weights, some of them 0; filters; with and without a known frame.
#[test]
fn searches_of_ten_thousand_queries_agree() {
    let mut asked = 0;
    for (round, (times, frames)) in
        [(3, 3_000), (1, 700), (6, 900), (3, 20), (3, 90)].into_iter().enumerate()
    {
        let field = field(times, frames, round as u64);
        let (candidates, index) = (field.candidates(), field.index());
        let masks = index.masks(&field.tags);
        let dims = field.features.layout().dims();
        let mut random = Pcg64Mcg::seed_from_u64(99 + round as u64);
        for set in 0..20 {
            let weights: Vec<f32> = (0..dims)
                .map(|_| {
                    if set % 4 == 3 && random.next_u32() % 3 == 0 {
                        0.0
                    } else {
                        1.0 + number(&mut random)
                    }
                })
                .collect();
            let filter = filters()[set % 6];
            let tree = TreeIndex::new(&candidates, &weights, filter);
            for kind in 0..100 {
                let near = field.features.row(random.next_u32() as usize % frames).unwrap();
                let noise = [2.0, 0.1, 0.0, 0.01][kind % 4];
                let query: Vec<f32> = (near.iter())
                    .map(|x| if kind % 4 == 0 { 0.0 } else { *x } + noise * number(&mut random))
                    .collect();
                let query = Query { row: &query, weights: &weights, filter };
                let oracle = scan(&candidates, &query);
                let boxes = index.search(&masks, &query, None);
                assert_eq!(boxes.best, oracle.best, "{round} {set} {kind}");
                assert_eq!(
                    tree.as_ref().and_then(|tree| tree.search(&candidates, &query).best),
                    oracle.best,
                    "{round} {set} {kind}"
                );
                let known = field.valid[random.next_u32() as usize % field.valid.len()] as usize;
                if filter.admits(field.tags[known]) {
                    let cost = query.cost(field.features.row(known).unwrap());
                    let warm = index.search(&masks, &query, Some(Hit { frame: known, cost }));
                    assert_eq!(warm.best, oracle.best);
                    assert!(warm.visited <= index.len() + index.len() / 16 + SMALL_INDEX);
                }
                asked += 1;
            }
        }
    }
    assert_eq!(asked, 10_000);
}

/// Frames that may be visited twice in a small index.
const SMALL_INDEX: usize = 200;

#[test]
fn box_search_near_a_frame_visits_few_frames() {
    let field = field(3, 20_000, 5);
    let (index, weights) = (field.index(), vec![1.0; 27]);
    let masks = index.masks(&field.tags);
    let mut visited = 0;
    for frame in (0..20_000).step_by(501) {
        let query: Vec<f32> = field.features.row(frame).unwrap().iter().map(|x| x + 0.02).collect();
        let query = Query { row: &query, weights: &weights, filter: TagFilter::default() };
        visited += index.search(&masks, &query, None).visited;
    }
    assert!(visited / 40 < 3_000, "{}", visited / 40);
}

#[test]
fn search_of_an_invalid_query_finds_nothing() {
    let field = field(3, 400, 1);
    let (candidates, index) = (field.candidates(), field.index());
    let masks = index.masks(&field.tags);
    let weights = vec![1.0; 27];
    for query in [vec![0.0; 26], vec![f32::NAN; 27], vec![f32::INFINITY; 27], vec![]] {
        let query = Query { row: &query, weights: &weights, filter: TagFilter::default() };
        assert_eq!(scan(&candidates, &query), SearchResult::default());
        assert_eq!(index.search(&masks, &query, None), SearchResult::default());
    }
    // Costs that overflow are all equal.
    let far = vec![1e30; 27];
    let query = Query { row: &far, weights: &weights, filter: TagFilter::default() };
    assert_eq!(index.search(&masks, &query, None).best, scan(&candidates, &query).best);
    let empty = Candidates { valid: &[], ..candidates };
    assert!(TreeIndex::new(&empty, &weights, TagFilter::default()).is_none());
    assert_eq!(BoxBuilder::new(&[], &[]).finish(&field.features).len(), 0);
    // Rows that are all equal make a tree of no depth, or none.
    let layout = Layout::new(&FeatureOptions::default()).unwrap();
    let valid = Arc::new((0..5_000).collect());
    let rows = vec![1.0; 27 * 5_000];
    let same = Normaliser::new(layout, Normalisation::Block, rows, Arc::clone(&valid)).finish();
    let candidates = Candidates { features: &same, tags: &[], valid: &valid };
    let query = vec![0.5; 27];
    let query = Query { row: &query, weights: &weights, filter: TagFilter::default() };
    let index = BoxBuilder::new(&valid, &[]).finish(&same);
    assert_eq!(index.search(&index.masks(&[]), &query, None).best.map(|hit| hit.frame), Some(0));
    let tree = TreeIndex::new(&candidates, &weights, TagFilter::default());
    assert_eq!(
        tree.and_then(|tree| tree.search(&candidates, &query).best).map_or(0, |hit| hit.frame),
        0
    );
}

#[test]
fn nearest_frames_are_those_of_least_cost() {
    let field = field(3, 700, 5);
    let candidates = field.candidates();
    let dims = field.features.layout().dims();
    let weights = vec![1.0; dims];
    for (turn, filter) in filters().into_iter().enumerate() {
        let row = field.features.row(turn * 101).unwrap();
        let query = Query { row, weights: &weights, filter };
        let admitted = field.valid.iter().map(|frame| *frame as usize);
        let mut hits: Vec<Hit> = admitted
            .filter(|frame| filter.admits(field.tags[*frame]))
            .map(|frame| Hit { frame, cost: query.cost(field.features.row(frame).unwrap()) })
            .collect();
        // Duplicated frames have equal costs: the earlier one is first.
        hits.sort_by(|a, b| a.cost.total_cmp(&b.cost).then(a.frame.cmp(&b.frame)));
        for count in [0, 1, 7, 10_000] {
            let found = scan_nearest(&candidates, &query, count);
            assert_eq!(found, hits[..count.min(hits.len())], "{turn} {count}");
        }
        assert_eq!(
            scan_nearest(&candidates, &query, 1).first(),
            scan(&candidates, &query).best.as_ref()
        );
    }
    let broken = Query { row: &[f32::NAN; 27], weights: &weights, filter: TagFilter::default() };
    assert!(scan_nearest(&candidates, &broken, 3).is_empty());
}
