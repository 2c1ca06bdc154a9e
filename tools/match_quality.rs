//! Measures how well a character follows recorded input with the synthesised motions and default
//! options, for every scenario. Prints a table in Markdown. `cargo xtask match-quality` runs it.

#![expect(clippy::print_stdout, reason = "the table is what it is for")]

use segue_motion::matching::{
    ControllerOptions, Database, DatabaseOptions, Scenario, drive, made_clips,
};
use std::error::Error;
use std::sync::Arc;
use std::time::Instant;

fn main() -> Result<(), Box<dyn Error>> {
    let start = Instant::now();
    let clips = made_clips(1.75)?;
    let made = start.elapsed().as_secs_f64();
    let database = Arc::new(Database::new(clips, &DatabaseOptions::default())?);
    println!(
        "{} motions, {} frames, {} of them searched; made in {made:.2} s, database built in {:.2} s.",
        database.motions().len(),
        database.frames(),
        database.valid().len(),
        start.elapsed().as_secs_f64() - made
    );
    println!();
    println!(
        "| scenario | position error, worst (cm) | time to turn (s) | skate, worst (cm) | without planting (cm) | seams per minute | shortest run (s) | frames visited |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    for scenario in Scenario::ALL {
        let recording = scenario.recording();
        let played = drive(&database, ControllerOptions::default(), &recording)?;
        let free = drive(
            &database,
            ControllerOptions { planting: None, ..ControllerOptions::default() },
            &recording,
        )?;
        let (metrics, free) = (played.metrics(&database), free.metrics(&database));
        let number =
            |value: Option<f64>| value.map_or("–".to_owned(), |value| format!("{value:.2}"));
        println!(
            "| {} | {:.1}, {:.1} | {} | {}, {} | {}, {} | {:.1} | {} | {} |",
            scenario.title(),
            metrics.error_cm,
            metrics.worst_error_cm,
            number(metrics.turn_secs),
            number(metrics.skate_cm),
            number(metrics.worst_skate_cm),
            number(free.skate_cm),
            number(free.worst_skate_cm),
            metrics.seams_per_minute,
            number(metrics.shortest_secs),
            played.visited / played.searches.max(1),
        );
    }
    Ok(())
}
