//! Writes a corpus of many clips, to try the page with it, without reading as many files: some
//! hundred synthesised clips are processed as files are, and the others are cut out of them, bent,
//! and changed in their joints. `cargo xtask make-large-corpus N DIR` runs it. The same number
//! gives the same files; there is no `clips.parquet`, which the page does not read.
//!
//! Then it measures what the page needs of it: bytes, milliseconds, and how many of the nearest
//! moments a search finds.

#![expect(clippy::print_stdout, reason = "it says what it has written and measured")]

mod measure;
mod output;
mod variants;

use output::Output;
use segue_corpus::{FileRecord, Gatherer, Options, RowTexts, write_columns};
use sha2::{Digest as _, Sha256};
use std::error::Error;
use std::fs;
use std::path::Path;
use std::time::Instant;
use variants::{Bases, Variant};

/// Clips that are made together, on all processors.
const BATCH: usize = 1_024;
/// The number of clips that are not in the corpus and ask it for moments.
const QUERIES: usize = 100;

fn main() -> Result<(), Box<dyn Error>> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let [count, folder] = args.as_slice() else {
        return Err("expected a number of clips and a folder".into());
    };
    let count: usize = count.parse().map_err(|_| format!("{count} is no number of clips"))?;
    let folder = Path::new(folder);
    let started = Instant::now();
    let bases = Bases::new()?;
    println!("{} clips processed in {:.1} s", bases.len(), started.elapsed().as_secs_f64());
    let features = write_corpus(&bases, count, folder)?;
    println!(
        "{count} clips made in {:.1} s, in {}",
        started.elapsed().as_secs_f64(),
        folder.display()
    );
    let queries = made_by_all(count..count + QUERIES, |serial| bases.variant(serial, count))?;
    measure::measure(folder, &features, &queries)
}

/// Writes a corpus into a folder. Returns the raw features of its moments, with their rows.
fn write_corpus(
    bases: &Bases,
    count: usize,
    folder: &Path,
) -> Result<measure::Moments, Box<dyn Error>> {
    fs::create_dir_all(folder.join("index"))?;
    let keys = keys(count);
    let mut gatherer = Gatherer::new(Options::default())?;
    let (mut texts, mut moments) = (Vec::new(), measure::Moments::default());
    let mut poses = Output::new(folder, "poses");
    let mut thumbnails = Output::new(folder, "thumbnails");
    for start in (0..count).step_by(BATCH) {
        let end = count.min(start + BATCH);
        let made = made_by_all(start..end, |at| bases.variant(keys[at].1, count))?;
        for ((key, _), Variant { record, path, name, labels }) in keys[start..end].iter().zip(made)
        {
            poses.add(&record.poses)?;
            thumbnails.add(&record.thumbnail)?;
            moments.add(&record.features);
            texts.push(RowTexts { path, name, labels });
            gatherer.add(key, &FileRecord { clips: vec![record] })?;
        }
    }
    poses.finish()?;
    thumbnails.finish()?;
    let started = Instant::now();
    let made = gatherer.finish()?;
    println!("gathered in {:.1} s", started.elapsed().as_secs_f64());
    if made.pose_shards.len() != poses.shards()
        || made.thumbnail_shards.len() != thumbnails.shards()
    {
        return Err("the clips lie in other shards than they were written into".into());
    }
    let columns = write_columns(&made.rows, &texts)?;
    fs::write(folder.join(segue_corpus::COLUMNS), columns)?;
    fs::write(folder.join("index/centroids.bin"), &made.centroids)?;
    for (number, list) in made.lists.iter().enumerate() {
        fs::write(folder.join(format!("index/lists-{number:05}.bin")), list)?;
    }
    fs::write(folder.join("corpus.json"), format!("{:#}\n", made.manifest))?;
    Ok(moments)
}

/// Returns the keys of clips in their order, each with the serial number of its clip: as random as
/// the hashes of files.
fn keys(count: usize) -> Vec<(String, usize)> {
    let key = |serial: usize| {
        let digest = Sha256::digest(serial.to_le_bytes());
        let digits =
            digest.iter().take(16).fold(String::new(), |text, byte| format!("{text}{byte:02x}"));
        (digits, serial)
    };
    let mut keys: Vec<(String, usize)> = (0..count).map(key).collect();
    keys.sort();
    keys
}

/// Returns what is made of each number, in order, on all processors.
fn made_by_all<T: Send>(
    numbers: std::ops::Range<usize>,
    make: impl Fn(usize) -> Result<T, String> + Sync,
) -> Result<Vec<T>, String> {
    let workers = std::thread::available_parallelism().map_or(1, usize::from);
    let numbers: Vec<usize> = numbers.collect();
    let parts: Vec<Result<Vec<T>, String>> = std::thread::scope(|scope| {
        let make = &make;
        let threads: Vec<_> = numbers
            .chunks(numbers.len().div_ceil(workers).max(1))
            .map(|own| scope.spawn(move || own.iter().map(|number| make(*number)).collect()))
            .collect();
        let stopped = |_| Err("a thread has stopped".to_owned());
        threads.into_iter().map(|thread| thread.join().unwrap_or_else(stopped)).collect()
    });
    let mut made = Vec::with_capacity(numbers.len());
    for part in parts {
        made.extend(part?);
    }
    Ok(made)
}

#[cfg(test)]
mod tests {
    use super::*;
    use segue_corpus::CorpusPage;

    #[test]
    fn corpus_is_one_that_a_page_reads() {
        let folder = std::env::temp_dir().join(format!("segue-large-{}", std::process::id()));
        let bases = Bases::with(6).unwrap();
        write_corpus(&bases, 40, &folder).unwrap();
        let read = |name: &str| fs::read(folder.join(name)).unwrap();
        let manifest = String::from_utf8(read("corpus.json")).unwrap();
        let page = CorpusPage::new(&manifest, &read("columns.bin")).unwrap();
        assert_eq!(page.table().rows(), 40);
        for row in 0..40 {
            let place = page.table().poses(row).unwrap();
            let shard = read(&format!("poses-{:05}.bin", place.shard));
            let poses = &shard[place.offset..place.offset + place.length];
            assert!(poses.starts_with(b"SGPO"), "{row}");
            let place = page.table().thumbnail(row).unwrap();
            let shard = read(&format!("thumbnails-{:05}.bin", place.shard));
            assert!(shard[place.offset..].starts_with(b"\x89PNG"), "{row}");
        }
        fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn same_number_gives_the_same_clip() {
        let bases = Bases::with(3).unwrap();
        let [a, b, other] = [7, 7, 8].map(|serial| bases.variant(serial, 20).unwrap());
        assert_eq!(a.record, b.record);
        assert_ne!(a.record.poses, other.record.poses);
        assert_ne!(a.path, other.path);
    }
}
