//! The needs of a page with a corpus: bytes, time, and the share of the nearest moments that it
//! finds.

use super::variants::Variant;
use segue_corpus::{CorpusPage, ListPlace, POSE_FPS};
use serde::Deserialize;
use std::collections::BTreeSet;
use std::error::Error;
use std::fs;
use std::path::Path;
use std::time::Instant;

/// The number of neighbours that are looked for.
const NEIGHBOURS: usize = 10;
/// The time in a clip that asks, as a share of the moments that it has.
const ASKED_AT: f64 = 0.4;

/// The raw features of all moments of a corpus.
#[derive(Debug, Default)]
pub(crate) struct Moments {
    features: Vec<f32>,
    /// The number of features of each row of the table.
    lengths: Vec<usize>,
}

impl Moments {
    pub(crate) fn add(&mut self, features: &[f32]) {
        self.features.extend(features);
        self.lengths.push(features.len());
    }

    /// Returns the nearest moment of each clip: its distance and the clip's row, the nearest first.
    fn nearest(&self, query: &[f32], scaling: &Scaling) -> Vec<(f32, u32)> {
        let dims = query.len();
        let mut rest = self.features.as_slice();
        let mut best: Vec<(f32, u32)> = Vec::new();
        for (clip, length) in (0..).zip(&self.lengths) {
            let (own, others) = rest.split_at(*length);
            rest = others;
            let distance = |row: &[f32]| {
                let scaled = row.iter().zip(&scaling.means).zip(&scaling.factors);
                let apart = scaled.zip(query).map(|(((own, mean), factor), query)| {
                    let apart = (own - mean) * factor - query;
                    apart * apart
                });
                apart.sum::<f32>()
            };
            let near = own.chunks_exact(dims).map(distance).fold(f32::INFINITY, f32::min);
            if near.is_finite() {
                best.push((near.sqrt(), clip));
            }
        }
        best.sort_by(|a, b| a.0.total_cmp(&b.0));
        best.truncate(NEIGHBOURS);
        best
    }
}

#[derive(Deserialize)]
struct Scaling {
    means: Vec<f32>,
    factors: Vec<f32>,
}

#[derive(Deserialize)]
struct Found {
    row: u32,
    distance: f32,
}

/// Prints the measures of a corpus; `queries` are clips that are not in it.
pub(crate) fn measure(
    folder: &Path,
    moments: &Moments,
    queries: &[Variant],
) -> Result<(), Box<dyn Error>> {
    let read = |name: &str| fs::read(folder.join(name));
    let (manifest, columns) = (read("corpus.json")?, read(segue_corpus::COLUMNS)?);
    let centroids = read("index/centroids.bin")?;
    let manifest = String::from_utf8(manifest)?;
    let mut timed = Timed::default();
    let mut page =
        timed.run("open corpus.json and columns.bin", || CorpusPage::new(&manifest, &columns))?;
    timed.run("columns", || page.columns())?;
    let all = timed.run("select all", || page.select("{}"))?;
    timed.run("select by text", || page.select(r#"{"text": "walk -tired"}"#))?;
    let by_name = r#"{"sort": {"by": "name", "down": true}}"#;
    timed.run("sort by name, the first time", || page.select(by_name))?;
    timed.run("sort by skating", || page.select(r#"{"sort": {"by": "skating_cmps"}}"#))?;
    let ranges = r#"{"ranges": {"seconds": [2, 8], "pose_jump_deg": [null, 9]}, "copies": "hide"}"#;
    timed.run("select by ranges", || page.select(ranges))?;
    timed.run("histogram", || page.histogram("skating_cmps", ranges, 40))?;
    timed.run("cells of 50 rows", || page.cells(&all[..all.len().min(50)]))?;
    timed.run("map", || Ok::<_, String>(page.table().map()))?;
    timed.run("centroids", || page.set_index(&centroids))?;

    let value: serde_json::Value = serde_json::from_str(&manifest)?;
    let scaling: Scaling = serde_json::from_value(value["features"]["scaling"].clone())?;
    let (mut bytes, mut of_clips, mut of_distance) = (Vec::new(), 0, 0);
    let (mut wanted, mut lists_read) = (0, 0);
    let (mut query_ms, mut search_ms) = (0.0f64, 0.0f64);
    let mut asked = 0usize;
    for Variant { record, .. } in queries {
        let dims = scaling.means.len();
        let count = record.features.len() / dims;
        if count == 0 {
            continue;
        }
        let secs = (count as f64 * ASKED_AT).floor() * 3.0 / POSE_FPS as f64;
        let started = Instant::now();
        let query = page.query_of_poses(&record.poses, secs)?;
        query_ms = query_ms.max(started.elapsed().as_secs_f64() * 1e3);
        let lists = page.nearest_lists(&query, 0)?;
        bytes.push(lists.iter().map(|(_, place)| place.length).sum::<usize>());
        lists_read = lists.len();
        for (list, place) in &lists {
            page.take_list(*list, range(folder, *place)?)?;
        }
        let numbers: Vec<usize> = lists.iter().map(|(list, _)| *list).collect();
        let started = Instant::now();
        let found = page.search(&query, &numbers, NEIGHBOURS)?;
        search_ms = search_ms.max(started.elapsed().as_secs_f64() * 1e3);
        let found: Vec<Found> = serde_json::from_str(&found)?;
        let near = moments.nearest(&query, &scaling);
        let rows: BTreeSet<u32> = near.iter().map(|own| own.1).collect();
        let farthest = near.last().map_or(0.0, |own| own.0);
        of_clips += found.iter().filter(|own| rows.contains(&own.row)).count();
        // What is as near as the last of them is as good: distances are rounded.
        of_distance += found.iter().filter(|own| own.distance <= 1.01 * farthest).count();
        wanted += near.len();
        asked += 1;
    }
    timed.print();
    println!(
        "query of poses: {query_ms:.1} ms, search of {lists_read} lists: {search_ms:.1} ms (the slowest of {asked})"
    );
    let share = |found: usize| 100.0 * found as f64 / wanted.max(1) as f64;
    println!(
        "recall@10 of clips: {:.1} %; as near as the tenth, within 1 %: {:.1} %",
        share(of_clips),
        share(of_distance)
    );
    bytes.sort_unstable();
    let (middle, most) = (bytes.get(bytes.len() / 2), bytes.last());
    let rows = page.table().rows();
    let mut sum = 0;
    println!("| read by the page | bytes | a clip |\n|---|---|---|");
    for (name, own) in [
        ("corpus.json", manifest.len()),
        (segue_corpus::COLUMNS, columns.len()),
        ("index/centroids.bin", centroids.len()),
        ("lists of a search, in the middle", middle.copied().unwrap_or(0)),
    ] {
        sum += own;
        println!("| {name} | {own} | {:.2} |", own as f64 / rows as f64);
    }
    println!("| all | {sum} | {:.2} |", sum as f64 / rows as f64);
    println!("the largest search: {} bytes", most.copied().unwrap_or(0));
    Ok(())
}

fn range(folder: &Path, place: ListPlace) -> Result<Vec<u8>, Box<dyn Error>> {
    use std::io::{Read as _, Seek as _, SeekFrom};
    let mut file = fs::File::open(folder.join(format!("index/lists-{:05}.bin", place.file)))?;
    file.seek(SeekFrom::Start(place.offset as u64))?;
    let mut bytes = vec![0; place.length];
    file.read_exact(&mut bytes)?;
    Ok(bytes)
}

/// The steps of a page, and their durations, milliseconds.
#[derive(Default)]
struct Timed(Vec<(&'static str, f64)>);

impl Timed {
    fn run<T, E>(
        &mut self,
        what: &'static str,
        work: impl FnOnce() -> Result<T, E>,
    ) -> Result<T, E> {
        let started = Instant::now();
        let done = work();
        self.0.push((what, started.elapsed().as_secs_f64() * 1e3));
        done
    }

    fn print(&self) {
        for (what, ms) in &self.0 {
            println!("{what}: {ms:.1} ms");
        }
    }
}
