//! How good walks through a motion graph are: ten minutes of every clip of a folder, with default options, measured. Prints a table in Markdown.
//! `cargo xtask graph-quality` runs it.

#![expect(clippy::print_stdout, reason = "the table is what it is for")]

mod measure;

use measure::{Walked, clips_of_folder, walk};
use segue::graph::{GraphOptions, StitchOptions};
use std::error::Error;

/// Seconds of walk.
const SECS: f64 = 600.0;

fn main() -> Result<(), Box<dyn Error>> {
    let Some(folder) = std::env::args_os().nth(1) else {
        return Err("name a folder of motion files: BVH, or AMC beside their ASF".into());
    };
    let set = clips_of_folder(folder.as_ref(), |_| true)?;
    let options = GraphOptions::default();
    let ways = [
        ("dissolve", StitchOptions::dissolve(options.blend_window)),
        ("inertialization, half-life 0.2 s", StitchOptions::inertialize(0.2)),
    ];
    for (name, stitch) in ways {
        let walked = walk(&set, &options, &stitch, 7, SECS)?;
        print(name, &walked);
    }
    Ok(())
}

fn print(name: &str, walked: &Walked) {
    let Walked { graph, metrics, .. } = walked;
    println!("| {:.1} minutes, {name} | |", metrics.secs / 60.0);
    println!("|---|---|");
    println!("| clips, frames | {}, {} |", graph.set().clips().len(), graph.set().frames());
    println!(
        "| nodes, transitions in the largest component | {}, {} of {} |",
        graph.graph().node_count(),
        graph.jumps().len(),
        walked.transitions
    );
    println!(
        "| build: all pairs, window, candidates and graph | {:.2} s, {:.2} s, {:.2} s |",
        walked.secs[0], walked.secs[1], walked.secs[2]
    );
    for metric in metrics.list() {
        let value = metric.value.map_or("none".to_owned(), |value| format!("{value:.2}"));
        println!("| {} | {value} {} |", metric.label, metric.unit);
    }
    let most = |value: fn(&segue::graph::Seam) -> f64| metrics.seams.iter().map(value).fold(0.0, f64::max);
    println!("| largest spin (a spin is above 30°) | {:.1}° |", most(|seam| seam.spin_deg));
    println!(
        "| largest jump (a flash is above 2) | {:.2} times the clips' 99.9th percentile |",
        most(|seam| f64::from(seam.flash))
    );
    println!(
        "| foot slide in stances without a transition | {:.2} cm |",
        metrics.own_skate_cm.unwrap_or(0.0)
    );
    println!();
}
