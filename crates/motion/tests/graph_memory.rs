//! Peak memory of the search for transitions in 30,000 frames, besides the clips, measured by a
//! counting allocator. A binary of its own with one test, so that nothing else allocates.

use glam::{Quat, Vec3};
use peak_alloc::PeakAlloc;
use segue_motion::clip::{Clip, Motion};
use segue_motion::graph::{Candidate, CandidateStream, FrameSet, GraphOptions, Place};
use segue_motion::skeleton::{Joint, Roles, Skeleton};
use std::sync::Arc;

#[global_allocator]
static ALLOCATOR: PeakAlloc = PeakAlloc;

const JOINTS: usize = 31;
const CLIPS: usize = 6;
const FRAMES: usize = 5_000;
const MAX_BYTES: usize = 300_000_000;

/// The number of steps of the search: all of them in optimised builds. Otherwise the parts into
/// which the clips are cut, which are kept to the end, and some of the 2,080 tiles. The memory of a
/// tile is freed before the next, and all have the same size; the overview has its size from the
/// first one on. Only the candidates grow, up to [`max_candidate_bytes`], which is added.
const STEPS: usize = if cfg!(debug_assertions) { 160 } else { usize::MAX };

/// Returns the greatest memory of the 500,000 candidates that are kept at a time. A growing vector
/// has twice the capacity of its content, plus the old half while it moves.
fn max_candidate_bytes() -> usize {
    500_000 * size_of::<Candidate>() * 3
}

/// Returns strides whose cadence varies, differently in every clip.
fn clips() -> Arc<FrameSet> {
    let joint = |index: usize| {
        let (chain, link) = (index.div_ceil(5), (index + 4) % 5);
        Joint {
            name: format!("Joint{index}"),
            parent: (index > 0).then(|| if link == 0 { 0 } else { index - 1 }),
            offset: Quat::from_rotation_y(chain as f32) * Vec3::new(0.05, 0.2, 0.02),
            end_site: None,
            channels: vec![],
        }
    };
    let skeleton =
        Arc::new(Skeleton::new((0..JOINTS).map(joint).collect()).expect("parents come first"));
    let roles = Roles::detect(&skeleton);
    let sources = (0..CLIPS).map(|clip| {
        let (mut rotations, mut roots) =
            (Vec::with_capacity(FRAMES * JOINTS), Vec::with_capacity(FRAMES));
        for frame in 0..FRAMES {
            let time = frame as f32 / 60.0;
            let phase = (4.0 + 0.3 * clip as f32) * time + 0.9 * (0.7 * time).sin();
            rotations.extend(
                (0..JOINTS).map(|joint| Quat::from_rotation_x(0.4 * (phase + joint as f32).sin())),
            );
            roots.push(Vec3::new((0.3 * time).sin(), 1.0, 0.3 * phase));
        }
        let clip = Clip::new(format!("clip {clip}"), Arc::clone(&skeleton), 60.0, rotations, roots)
            .expect("lengths fit");
        Arc::new(Motion::with_roles(clip, &roles))
    });
    Arc::new(FrameSet::new(sources.collect(), 1.75).expect("clips of one skeleton"))
}

#[test]
fn search_in_30000_frames_takes_300_mb() {
    let set = clips();
    assert_eq!(set.frames(), 30_000);
    let before = ALLOCATOR.current_usage();
    ALLOCATOR.reset_peak_usage();
    let options = GraphOptions { edge_threshold_cm: 20.0, ..GraphOptions::default() };
    let mut stream = CandidateStream::new(&set, &options).expect("options that fit");
    let parts = 6 * 11;
    let progress = stream.advance(STEPS).expect("positions are finite");
    assert!(progress.done > parts + 90, "{progress:?}");
    let all_is_done = progress.is_complete();
    let searched = ALLOCATOR.peak_usage() - before;
    if all_is_done {
        let (found, overview) = stream.finish().expect("all is done");
        assert!(found.found().len() > 10_000 && overview.block() == 16, "{}", found.found().len());
        let [a, b] = [0, 1].map(|clip| Place { clip, frame: 100 });
        assert!(overview.cm(a, b).is_some());
    }
    let peak = ALLOCATOR.peak_usage() - before;
    println!(
        "{} of {} steps: {searched} bytes, with what is found {peak} bytes, of {} of which one holds all pairs of frames",
        progress.done,
        progress.total,
        12 * set.frames() * (set.frames() + 1) / 2
    );
    // The size of the points alone, to check that the allocator counts.
    assert!(searched > set.frames() * JOINTS * 16);
    assert!(peak + if all_is_done { 0 } else { max_candidate_bytes() } < MAX_BYTES, "{peak}");
}
