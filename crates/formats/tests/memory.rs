//! Peak memory of reading a file, the file itself included, measured by a counting allocator. A
//! binary of its own with one test, so that nothing else allocates.

use peak_alloc::PeakAlloc;
use segue_formats::bvh::{WriteOptions, write};
use segue_formats::{ImportOptions, import};
use segue_motion::synth::{Action, Params, synthesize};

/// Moves growing vectors to a new place, as the allocators of browsers do.
#[global_allocator]
static ALLOCATOR: PeakAlloc = PeakAlloc;

/// A description of the number of frames in the header, and the text made from the true number.
type Header = (&'static str, fn(usize) -> String);

/// 100 MB in optimised builds; the ratio is tested.
const BYTES: usize = if cfg!(debug_assertions) { 12_000_000 } else { 100_000_000 };

/// Returns a file that repeats a walk, with `header` as the number of frames.
fn file(header: impl Fn(usize) -> String) -> Vec<u8> {
    let clip = synthesize(&Params::new(Action::Walk)).expect("natural parameters").clip;
    let text = write(&clip, &WriteOptions::default());
    let (hierarchy, motion) = text.split_once("Frames: ").expect("a header");
    let (_, motion) = motion.split_once('\n').expect("a header");
    let (frame_time, rows) = motion.split_once('\n').expect("a header");
    let times = BYTES.div_ceil(rows.len());
    let mut file = Vec::with_capacity(hierarchy.len() + 100 + times * rows.len());
    file.extend_from_slice(
        format!("{hierarchy}{}\n{frame_time}\n", header(times * clip.frames())).as_bytes(),
    );
    (0..times).for_each(|_| file.extend_from_slice(rows.as_bytes()));
    file
}

#[test]
fn peak_memory_is_at_most_three_times_the_file() {
    let headers: [Header; 4] = [
        ("right", |frames| format!("Frames: {frames}")),
        ("far too many", |_| "Frames: 4000000000".to_owned()),
        ("a few too many", |frames| format!("Frames: {}", frames + frames / 12)),
        ("none", |_| String::new()),
    ];
    for (name, header) in headers {
        let bytes = file(header);
        ALLOCATOR.reset_peak_usage();
        let before = ALLOCATOR.current_usage() - bytes.capacity();
        let imported = import("walk.bvh", &bytes, &ImportOptions::default()).expect("a clip");
        let peak = ALLOCATOR.peak_usage() - before;
        let clip = &imported.clips[0].clip;
        let ratio = peak as f64 / bytes.len() as f64;
        println!(
            "{name}: {} bytes, {} frames, peak {peak} bytes: {ratio:.2} times the file",
            bytes.len(),
            clip.frames()
        );
        // The size of the motion alone, to check that the allocator counts.
        let motion = clip.frames() * clip.skeleton().len() * size_of::<glam::Quat>();
        assert!(peak > bytes.len() + motion, "{name}");
        assert!(ratio <= 3.0, "{name}: {ratio}");
    }
}
