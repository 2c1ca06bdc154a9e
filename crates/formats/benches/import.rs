//! Reading speed of motion files in bytes of text per second, compared with another reader of the
//! same files.
//!
//! `cargo bench --package segue-formats`. The file of the CMU database is read where the machine
//! has it.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use mimalloc::MiMalloc;
use segue_formats::bvh::{WriteOptions, write};
use segue_formats::{ImportOptions, import};
use segue_motion::synth::{Action, Params, synthesize};
use std::hint::black_box;
use std::path::{Path, PathBuf};

/// The allocator of the command line and of the Python package, whose speed is measured here.
#[global_allocator]
static ALLOCATOR: MiMalloc = MiMalloc;

/// The size of a long capture session.
const LARGE: usize = 100_000_000;

/// The approximate size of the CMU take, which it stands in for where that is missing.
const SMALL: usize = 2_000_000;

/// Returns a take of that database, if this machine has it.
fn take() -> Vec<u8> {
    let beside = Path::new(env!("CARGO_MANIFEST_DIR"))
        .ancestors()
        .skip(1)
        .map(|folder| folder.join("shared/data"));
    let mut places = std::env::var_os("SEGUE_SHARED").map(PathBuf::from).into_iter().chain(beside);
    let read = |place: PathBuf| std::fs::read(place.join("cmu/01_01.bvh")).ok();
    places.find_map(read).unwrap_or_else(|| made(SMALL))
}

/// Returns a minute of walking in six decimals, repeated.
fn made(bytes: usize) -> Vec<u8> {
    let clip = synthesize(&Params { duration_secs: 60.0, ..Params::new(Action::Walk) })
        .expect("natural parameters")
        .clip;
    let text = write(&clip, &WriteOptions::default());
    let (hierarchy, motion) = text.split_once("Frames: ").expect("a header");
    let (_, motion) = motion.split_once('\n').expect("a header");
    let (frame_time, rows) = motion.split_once('\n').expect("a header");
    let times = bytes.div_ceil(rows.len());
    let frames = times * clip.frames();
    let mut file = format!("{hierarchy}Frames: {frames}\n{frame_time}\n");
    file.reserve_exact(times * rows.len());
    (0..times).for_each(|_| file.push_str(rows));
    file.into_bytes()
}

fn reading(c: &mut Criterion) {
    for (name, bytes) in [("01_01.bvh", take()), ("100 MB", made(LARGE))] {
        let mut group = c.benchmark_group(name);
        group.throughput(Throughput::Bytes(bytes.len() as u64)).sample_size(10);
        group.bench_function("segue", |bench| {
            bench.iter(|| {
                import(name, black_box(&bytes), &ImportOptions::default()).expect("a clip")
            });
        });
        group.bench_function("bvh_anim 0.4", |bench| {
            bench.iter(|| bvh_anim::from_bytes(black_box(&bytes)).expect("a clip"));
        });
        group.finish();
    }
}

criterion_group!(benches, reading);
criterion_main!(benches);
