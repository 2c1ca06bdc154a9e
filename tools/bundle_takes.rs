//! Makes the bundled takes of the CMU database's subject 16: reads ASF and AMC from the given
//! folder, keeps every second frame, and writes BVH packed with gzip into `assets/samples`.
//!
//! `cargo run --release --package segue-tools --bin bundle_takes -- FOLDER`

#![expect(clippy::print_stdout, reason = "the table is for the README beside the files")]

use flate2::Compression;
use flate2::write::GzEncoder;
use segue_formats::acclaim::{read_motion, read_skeleton};
use segue_formats::{ImportOptions, bvh};
use segue_motion::clip::Clip;
use sha2::{Digest as _, Sha256};
use std::error::Error;
use std::fmt::Write as _;
use std::fs;
use std::io::Write as _;
use std::path::Path;

/// The takes, each with its first frame. In the first two frames of `16_15` the left arm was not
/// solved.
const TAKES: [(&str, usize); 9] = [
    ("16_15", 2),
    ("16_22", 0),
    ("16_11", 0),
    ("16_13", 0),
    ("16_17", 0),
    ("16_19", 0),
    ("16_33", 0),
    ("16_55", 0),
    ("16_57", 0),
];

/// The number of frames from one that is kept to the next.
const STRIDE: usize = 2;

/// Digits after the point: hundredths of a degree and of a centimetre, with which a hand deviates
/// by less than half a millimetre.
const DECIMALS: usize = 2;

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args_os().nth(1).ok_or("name the folder of 16.asf and 16_*.amc")?;
    let folder = Path::new(&folder);
    let samples = Path::new(env!("CARGO_MANIFEST_DIR")).join("../assets/samples");
    let options = ImportOptions::default();
    let skeleton = read_skeleton("16.asf", &fs::read(folder.join("16.asf"))?, &options)?;
    for (name, first) in TAKES {
        let file = format!("{name}.amc");
        let read = read_motion(&file, &fs::read(folder.join(&file))?, &skeleton, &options)?;
        let clip = read.clips.into_iter().next().ok_or("an AMC file is one clip")?.clip;
        let clip = every_second_frame(&clip, first)?;
        let text = rounded(&bvh::write(&clip, &WRITE));
        let mut packed = GzEncoder::new(Vec::new(), Compression::best());
        packed.write_all(text.as_bytes())?;
        let packed = packed.finish()?;
        fs::write(samples.join(format!("{name}.bvh.gz")), &packed)?;
        let sha256 = hex(&Sha256::digest(&text));
        println!(
            "| `{name}.bvh.gz` | {} | {} | {} | `{sha256}` |",
            packed.len(),
            clip.frames(),
            clip.fps()
        );
    }
    Ok(())
}

/// Centimetres and Y up, as most programs assume for BVH files. With one rotation order for all,
/// every take has the same skeleton.
const WRITE: bvh::WriteOptions = bvh::WriteOptions {
    metres_per_unit: Some(0.01),
    up: None,
    rotation_order: Some(bvh::RotationOrder::Zxy),
    fps: None,
};

fn every_second_frame(clip: &Clip, first: usize) -> Result<Clip, Box<dyn Error>> {
    let poses = (first..clip.frames()).step_by(STRIDE).map(|frame| clip.pose(frame));
    let fps = clip.fps() / STRIDE as f64;
    Ok(Clip::from_poses(clip.name(), clip.skeleton().clone(), fps, poses)?
        .with_provenance(clip.provenance()))
}

/// Returns the text with fewer digits in the motion; the skeleton keeps all of its digits.
fn rounded(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    let mut is_row = false;
    for line in text.lines() {
        if !is_row {
            out.push_str(line);
        }
        let numbers =
            line.split(' ').filter_map(|number| number.parse::<f64>().ok()).filter(|_| is_row);
        for (column, number) in numbers.enumerate() {
            let digits = format!("{number:.DECIMALS$}");
            let digits = digits.trim_end_matches('0').trim_end_matches('.');
            let digits = if digits == "-0" { "0" } else { digits };
            let space = if column > 0 { " " } else { "" };
            // Writing to a string cannot fail.
            let _written = write!(out, "{space}{digits}");
        }
        out.push('\n');
        is_row |= line.starts_with("Frame Time:");
    }
    out
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().fold(String::new(), |hex, byte| hex + &format!("{byte:02x}"))
}
