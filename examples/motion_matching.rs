//! Steers a character along a figure eight by motion matching, and measures how well it follows.
//!
//! `cargo run --release --no-default-features --example motion_matching -- drive.bvh` also writes
//! the motion.

#![expect(clippy::print_stdout, reason = "the numbers are the example's output")]

use segue_formats::bvh;
use segue_motion::matching::{
    ControllerOptions, Database, DatabaseOptions, Scenario, drive, made_clips,
};
use std::error::Error;
use std::sync::Arc;

fn main() -> Result<(), Box<dyn Error>> {
    // Features of every frame: positions and velocities of feet and hips, and the trajectory of the
    // next second.
    let database = Arc::new(Database::new(made_clips(1.75)?, &DatabaseOptions::default())?);
    println!("{} frames in {} motions", database.frames(), database.motions().len());

    // The recorded stick is the input of every frame; the best frame is searched for ten times a
    // second.
    let recording = Scenario::FigureEight.recording();
    let driven = drive(&database, ControllerOptions::default(), &recording)?;
    let metrics = driven.metrics(&database);
    println!("{:.1} s with {} jumps", driven.clip.duration_secs(), driven.jumps.len());
    println!("distance from the desired path: {:.1} cm on average", metrics.error_cm);
    let visited = driven.visited / driven.searches.max(1);
    println!("each of {} searches looked at {visited} frames", driven.searches);
    if let Some(path) = std::env::args_os().nth(1) {
        std::fs::write(path, bvh::write(&driven.clip, &bvh::WriteOptions::default()))?;
    }
    Ok(())
}
