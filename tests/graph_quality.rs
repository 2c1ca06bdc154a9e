//! A walk through the motion graph of captured motion, where this machine has it, with default options: nobody spins, nothing flashes.
//! `cargo xtask graph-quality` shows the same numbers for ten minutes of a whole folder.

#[path = "formats_common/mod.rs"]
mod formats_common;
#[path = "../examples/graph_quality/measure.rs"]
mod measure;

use segue::graph::{GraphOptions, StitchOptions};

#[test]
fn captured_motion() {
    let Some(folder) = formats_common::subject_16() else { return };
    let set = measure::clips_of_folder(&folder, |_| true).expect("the takes are read");
    let options = GraphOptions::default();
    let stitch = StitchOptions::dissolve(options.blend_window);
    let walked = measure::walk(&set, &options, &stitch, 7, 600.0).expect("there is a graph");
    let metrics = &walked.metrics;
    assert!(
        metrics.secs >= 600.0 && metrics.seams.len() > 60,
        "{} s, {} seams",
        metrics.secs,
        metrics.seams.len()
    );
    for seam in &metrics.seams {
        assert!(seam.spin_deg <= 30.0 && seam.flash <= 2.0, "{seam:?}");
    }
}
