//! Finds a cycle in a walk that turns, closes it, and plays it ten times.
//!
//! `cargo run --no-default-features --example loop -- loop.bvh` also writes the ten cycles.

#![expect(clippy::print_stdout, reason = "the numbers are the example's output")]

use segue_formats::bvh;
use segue_motion::clip::Motion;
use segue_motion::synth::{Action, Params, synthesize};
use segue_motion::transition::{CycleSearch, LoopOptions, close_loop, find_cycle};
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let params = Params { turn_rate_dps: 30.0, ..Params::new(Action::Walk) };
    let walk = Motion::analyze(synthesize(&params)?.clip);
    let fps = walk.clip().fps();

    // Two frames whose surroundings look alike are the ends of the cycle.
    let found = find_cycle(&walk, &CycleSearch::new(fps))?;
    let secs = found.cycle.len() as f64 / fps;
    println!("cycle: frames {} to {}, {secs:.2} s", found.cycle.start, found.cycle.end);

    // The remaining difference between both ends is spread over the cycle.
    let cycle = close_loop(&walk, found.cycle, &LoopOptions::default())?;
    println!(
        "largest turn between the ends: {:.2} ° before, {:.5} ° after",
        cycle.before.turn_deg, cycle.seam.turn_deg
    );

    let ten = cycle.repeat(10)?;
    let turned = cycle.cycle.yaw.to_degrees();
    println!(
        "each cycle turns the character by {turned:.1} °; ten of them take {:.1} s",
        ten.duration_secs()
    );
    if let Some(path) = std::env::args_os().nth(1) {
        std::fs::write(path, bvh::write(&ten, &bvh::WriteOptions::default()))?;
    }
    Ok(())
}
