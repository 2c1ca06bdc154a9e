//! Writes the small corpus of the browser tests, of synthesised motion:
//! `cargo xtask make-test-corpus`. There is no `clips.parquet`, which the page does not read.

#![expect(clippy::print_stdout, reason = "it says what it has written")]

use segue_corpus::{
    COLUMNS, FileRecord, Gathered, Gatherer, Options, Piece, RowTexts, process_file, work_key,
    write_columns,
};
use segue_formats::bvh::{WriteOptions, write};
use segue_motion::synth::{Action, Params, synthesize};
use std::collections::BTreeMap;
use std::error::Error;
use std::fs;
use std::io::{BufWriter, Write as _};
use std::path::Path;

/// A file of the corpus.
struct Input {
    path: String,
    labels: Vec<String>,
    key: String,
    record: FileRecord,
}

fn main() -> Result<(), Box<dyn Error>> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let [folder] = args.as_slice() else {
        return Err("expected a folder".into());
    };
    let (inputs, folder) = (inputs()?, Path::new(folder));
    let bytes = gather(&inputs, folder)?;
    println!("{} files, {:.0} KB, in {}", inputs.len(), bytes as f64 / 1e3, folder.display());
    Ok(())
}

/// Returns the files: short clips, a copy, and files that cannot be used.
fn inputs() -> Result<Vec<Input>, Box<dyn Error>> {
    let clip = |action, duration_secs, seed, fps| Params {
        duration_secs,
        seed,
        fps,
        ..Params::new(action)
    };
    let walk = clip(Action::Walk, 2.2, 3, 60.0);
    let takes = [
        ("calm/walk.bvh", walk, "walk"),
        ("calm/walk at 30.bvh", Params { fps: 30.0, ..walk }, "walk"),
        (
            "calm/walk in a curve.bvh",
            Params { turn_rate_dps: 40.0, ..clip(Action::Walk, 2.2, 4, 60.0) },
            "walk",
        ),
        ("calm/stand.bvh", clip(Action::Idle, 1.7, 5, 30.0), "idle"),
        ("fast/run.bvh", clip(Action::Run, 1.6, 6, 60.0), "run"),
        (
            "fast/run in a curve.bvh",
            Params { turn_rate_dps: 60.0, ..clip(Action::Run, 1.5, 7, 60.0) },
            "run",
        ),
        ("fast/jump.bvh", clip(Action::Jump, 2.5, 8, 60.0), "jump"),
    ];
    let mut inputs = Vec::new();
    for (path, params, label) in takes {
        let text = write(&synthesize(&params)?.clip, &WriteOptions::default());
        inputs.push(input(path, text.as_bytes(), &[label]));
    }
    let box_file = "HIERARCHY\nROOT box\n{\n OFFSET 0 0 0\n CHANNELS 3 Xposition Yposition Zposition\n \
                    End Site\n {\n  OFFSET 0 10 0\n }\n}\nMOTION\nFrames: 2\nFrame Time: 0.1\n0 0 0\n1 0 0\n";
    inputs.push(input("things/box.bvh", box_file.as_bytes(), &[]));
    inputs.push(input("things/broken.bvh", b"HIERARCHY\nROOT", &[]));
    Ok(inputs)
}

fn input(path: &str, bytes: &[u8], labels: &[&str]) -> Input {
    let options = Options::default();
    Input {
        path: path.to_owned(),
        labels: labels.iter().map(|label| (*label).to_owned()).collect(),
        key: work_key(path, bytes, &[], &options),
        record: process_file(path, bytes, &[], &options),
    }
}

/// Gathers a corpus and writes its files. Returns the number of their bytes.
fn gather(inputs: &[Input], folder: &Path) -> Result<u64, Box<dyn Error>> {
    let mut gatherer = Gatherer::new(Options::default())?;
    for input in inputs {
        gatherer.add(&input.key, &input.record)?;
    }
    let Gathered { rows, pose_shards, thumbnail_shards, centroids, lists, manifest } =
        gatherer.finish()?;
    let by_key: BTreeMap<&str, &Input> =
        inputs.iter().map(|input| (input.key.as_str(), input)).collect();
    let of = |key: &str| by_key.get(key).copied().ok_or("a key without a file");
    let texts: Vec<RowTexts> = rows
        .iter()
        .map(|row| {
            let input = of(&row.key)?;
            let file = input.path.rsplit('/').next().unwrap_or(&input.path);
            let name = row.row.name.clone();
            let stem = || file.trim_end_matches(".bvh").to_owned();
            let name = name.unwrap_or_else(stem);
            Ok(RowTexts { path: input.path.clone(), name, labels: input.labels.clone() })
        })
        .collect::<Result<_, &str>>()?;
    fs::create_dir_all(folder.join("index"))?;
    let mut written = 0;
    let mut put = |name: &str, bytes: &[u8]| {
        written += bytes.len() as u64;
        fs::write(folder.join(name), bytes)
    };
    put("index/centroids.bin", &centroids)?;
    for (number, list) in lists.iter().enumerate() {
        put(&format!("index/lists-{number:05}.bin"), list)?;
    }
    put(COLUMNS, &write_columns(&rows, &texts)?)?;
    put("corpus.json", &serde_json::to_vec(&manifest)?)?;
    let mut shards =
        |kind: &str, shards: &[Vec<Piece>], part: usize| -> Result<(), Box<dyn Error>> {
            for (number, shard) in shards.iter().enumerate() {
                let file = fs::File::create(folder.join(format!("{kind}-{number:05}.bin")))?;
                let mut file = BufWriter::new(file);
                for Piece { key, clip } in shard {
                    let clip = of(key)?.record.clips.get(*clip).ok_or("a piece without a clip")?;
                    let bytes = if part == 0 { &clip.poses } else { &clip.thumbnail };
                    written += bytes.len() as u64;
                    file.write_all(bytes)?;
                }
                file.flush()?;
            }
            Ok(())
        };
    shards("poses", &pose_shards, 0)?;
    shards("thumbnails", &thumbnail_shards, 1)?;
    Ok(written)
}
