//! A corpus of a few synthesised files, read as a page reads it.

use super::*;
use crate::{FileRecord, Gatherer, Options, RowTexts, Slot, process_file, work_key, write_columns};
use segue_formats::bvh::{self, WriteOptions};
use segue_motion::clip::Clip;
use segue_motion::synth::{Action, Params, synthesize};
use serde_json::Value as Json;
use std::sync::OnceLock;

/// The files of a corpus.
struct Made {
    manifest: String,
    columns: Vec<u8>,
    centroids: Vec<u8>,
    lists: Vec<Vec<u8>>,
    /// The poses of each row.
    poses: Vec<Vec<u8>>,
    paths: Vec<String>,
}

fn walk(speed_mps: f32) -> Clip {
    let params = Params { speed_mps, duration_secs: 6.0, ..Params::new(Action::Walk) };
    synthesize(&params).unwrap().clip
}

fn made() -> &'static Made {
    static MADE: OnceLock<Made> = OnceLock::new();
    MADE.get_or_init(|| {
        let options = Options::default();
        let mut records: Vec<(String, String, FileRecord)> = Vec::new();
        for number in 0..6u8 {
            let path = format!("walks/walk{number}.bvh");
            let clip = walk(0.9 + 0.15 * f32::from(number));
            let bytes = bvh::write(&clip, &WriteOptions::default()).into_bytes();
            let record = process_file(&path, &bytes, &[], &options);
            records.push((work_key(&path, &bytes, &[], &options), path, record));
        }
        let broken = process_file("broken.bvh", b"HIERARCHY", &[], &options);
        records.push(("ffff0000ffff0000".into(), "broken.bvh".into(), broken));
        records.sort_by(|a, b| a.0.cmp(&b.0));
        let mut gatherer = Gatherer::new(options).unwrap();
        for (key, _, record) in &records {
            gatherer.add(key, record).unwrap();
        }
        let gathered = gatherer.finish().unwrap();
        let texts: Vec<RowTexts> = (records.iter())
            .map(|(_, path, _)| RowTexts {
                path: path.clone(),
                name: crate::columns::stem(path).to_owned(),
                labels: Vec::new(),
            })
            .collect();
        Made {
            manifest: gathered.manifest.to_string(),
            columns: write_columns(&gathered.rows, &texts).unwrap(),
            centroids: gathered.centroids,
            lists: gathered.lists,
            poses: records.iter().map(|own| own.2.clips[0].poses.clone()).collect(),
            paths: texts.into_iter().map(|own| own.path).collect(),
        }
    })
}

fn page() -> CorpusPage {
    CorpusPage::new(&made().manifest, &made().columns).unwrap()
}

fn row_of(path: &str) -> u32 {
    made().paths.iter().position(|own| own == path).unwrap() as u32
}

/// Returns what a search finds.
fn like(page: &mut CorpusPage, query: &[f32], count: usize) -> Vec<Json> {
    let lists = page.nearest_lists(query, 0).unwrap();
    for (list, place) in &lists {
        page.take_list(*list, made().lists[place.file][place.bytes()].to_vec()).unwrap();
    }
    let lists: Vec<usize> = lists.into_iter().map(|(list, _)| list).collect();
    let found = page.search(query, &lists, count).unwrap();
    serde_json::from_str::<Vec<Json>>(&found).unwrap()
}

#[test]
fn page_has_the_numbers_of_the_corpus() {
    let page = page();
    let counts: Json = serde_json::from_str(&page.counts().unwrap()).unwrap();
    assert_eq!(
        (&counts["rows"], &counts["clips"], &counts["unreadable"]),
        (&7.into(), &6.into(), &1.into())
    );
    assert!(counts["seconds"].as_f64().unwrap() > 6.0, "{counts}");
    let rows = page.select(r#"{"text": "walk", "sort": {"by": "name"}}"#).unwrap();
    let cells: Vec<Json> = serde_json::from_str(&page.cells(&rows).unwrap()).unwrap();
    let names: Vec<&str> = cells.iter().map(|own| own["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["walk0", "walk1", "walk2", "walk3", "walk4", "walk5"]);
    assert!(cells.iter().all(|own| own["values"]["pose_jump_deg"].is_number()), "{cells:?}");
    assert!(page.columns().unwrap().contains("skating_cmps"));
    let errors = [
        page.cells(&[7]).unwrap_err().to_string(),
        page.select("nonsense").unwrap_err().to_string(),
    ];
    assert!(
        errors[0].contains("row 7 is out of range") && errors[1].contains("filter"),
        "{errors:?}"
    );
}

#[test]
fn places_of_poses_are_those_of_the_shards() {
    let page = page();
    let mut end = 0;
    for (row, poses) in (0..).zip(&made().poses) {
        let expected = Slot { shard: 0, offset: end, length: poses.len() };
        assert_eq!(page.table().poses(row), Some(expected).filter(|slot| slot.length > 0));
        end += poses.len();
    }
}

#[test]
fn moment_of_a_clip_is_most_like_itself() {
    let mut page = page();
    page.set_index(&made().centroids).unwrap();
    let row = row_of("walks/walk3.bvh");
    let query = page.query_of_poses(&made().poses[row as usize], 2.3).unwrap();
    let found = like(&mut page, &query, 3);
    assert_eq!((found.len(), &found[0]["row"]), (3, &row.into()));
    assert!((found[0]["seconds"].as_f64().unwrap() - 2.3).abs() < 1e-9, "{found:?}");
    assert!(found[0]["distance"].as_f64().unwrap() < 0.2, "{found:?}");
    // Beyond the end it is the last moment.
    let query = page.query_of_poses(&made().poses[row as usize], 99.0).unwrap();
    let found = like(&mut page, &query, 1);
    let end = found[0]["seconds"].as_f64().unwrap();
    assert!(found[0]["row"] == row && (4.5..6.0).contains(&end), "{found:?}");
}

#[test]
fn moment_of_a_file_is_like_that_of_its_clip() {
    let mut page = page();
    page.set_index(&made().centroids).unwrap();
    let row = row_of("walks/walk2.bvh");
    let file = write_npz(&walk(1.2).scaled(0.7));
    let query = page.query_of_file("mine.npz", &file, 3.1).unwrap();
    let found = like(&mut page, &query, 2);
    assert_eq!(found[0]["row"], row, "{found:?}");
    let own = page.query_of_poses(&made().poses[row as usize], 3.1).unwrap();
    let apart: f32 = own.iter().zip(&query).map(|(a, b)| (a - b) * (a - b)).sum();
    assert!(apart.sqrt() < 0.3, "{}", apart.sqrt());
    let last = page.query_of_file("mine.npz", &file, f64::INFINITY).unwrap();
    assert_eq!(last.len(), own.len());
    assert!(matches!(page.query_of_file("a.npz", b"no", 0.0), Err(PageError::Read(_))));
    let short = write_npz(&walk(1.2).crop(0..20).unwrap());
    assert!(matches!(page.query_of_file("a.npz", &short, 0.0), Err(PageError::TooShort)));
}

#[test]
fn query_of_a_part_is_that_of_the_whole_clip() {
    let page = page();
    let poses = &made().poses[0];
    let clip = decode_poses("", poses, page.body.skeleton()).unwrap().clip;
    let dims = page.body.layout().dims();
    for (row, own) in page.body.features(&clip).unwrap().chunks_exact(dims).enumerate() {
        let part = page.body.moment(&clip, row as f64 * 0.1).unwrap().unwrap();
        let apart = own.iter().zip(&part).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        assert!(apart < 0.02, "{row}: {apart}");
    }
}

#[test]
fn part_of_a_clip_is_a_file_of_its_own() {
    let page = page();
    let poses = &made().poses[0];
    let read = |from, to| {
        let file = page.npz("walk", poses, from, to).unwrap();
        let read = numpy::read("walk.npz", &file, &ImportOptions::default()).unwrap();
        read.clips.into_iter().next().unwrap().clip
    };
    let whole = read(None, None);
    assert_eq!((whole.fps(), whole.skeleton().len()), (30.0, 22));
    assert_eq!(read(Some(1.0), Some(2.0)).frames(), 31);
    assert_eq!(read(Some(1.0), None).frames(), whole.frames() - 30);
    assert_eq!(read(Some(99.0), Some(1.0)).frames(), 1);
    assert_eq!(read(Some(f64::NAN), Some(-3.0)).frames(), 1);
    assert!(page.npz("walk", &poses[..20], None, None).is_err());
}

#[test]
fn search_needs_its_bytes() {
    let mut page = page();
    let query = vec![0.0; page.body.layout().dims()];
    assert!(matches!(page.nearest_lists(&query, 3), Err(PageError::NoIndex)));
    assert!(matches!(page.take_list(0, Vec::new()), Err(PageError::NoIndex)));
    page.set_index(&made().centroids).unwrap();
    let (list, _) = page.nearest_lists(&query, 1).unwrap()[0];
    assert!(matches!(page.search(&query, &[list], 1), Err(PageError::NoList(_))));
    assert!(matches!(page.take_list(list, vec![1]), Err(PageError::Corpus(_))));
    assert!(matches!(page.take_list(999_999, vec![1]), Err(PageError::NoList(_))));
    assert!(page.nearest_lists(&query[1..], 1).is_err());
    assert!(page.set_index(b"SGCE").is_err());
}

#[test]
fn corpus_of_another_format_is_refused_with_what_to_do() {
    let with = |format: u32| {
        let mut manifest: Json = serde_json::from_str(&made().manifest).unwrap();
        manifest["format"] = format.into();
        CorpusPage::new(&manifest.to_string(), &made().columns).unwrap_err().to_string()
    };
    assert!(with(1).contains("build it again"), "{}", with(1));
    assert!(with(99).contains("newer"), "{}", with(99));
    let old = CorpusPage::new(r#"{"format": 1}"#, b"").unwrap_err();
    assert!(matches!(old, PageError::Older));
    assert_eq!((old.word(), PageError::NoIndex.word()), (Some("olderCorpus"), None));
    assert!(matches!(CorpusPage::new("<html>", b""), Err(PageError::Manifest(_))));
    assert!(matches!(CorpusPage::new(&made().manifest, b"x"), Err(PageError::Corpus(_))));
    let empty = write_columns(&[], &[]).unwrap();
    let error = CorpusPage::new(&made().manifest, &empty).unwrap_err();
    assert!(error.to_string().contains("found 0, expected 7"), "{error}");
}
