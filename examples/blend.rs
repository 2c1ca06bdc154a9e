//! Blends a walk into a run where the two look most alike, and measures the seam.
//!
//! `cargo run --no-default-features --example blend -- blend.bvh` also writes the dissolve.

#![expect(clippy::print_stdout, reason = "the numbers are the example's output")]

use segue_formats::bvh;
use segue_motion::blend::{DissolveOptions, dissolve};
use segue_motion::clip::Motion;
use segue_motion::metrics::{MotionTrace, ResultMetrics};
use segue_motion::registration::{SearchOptions, best_transition, limb_weights};
use segue_motion::synth::{Action, Params, synthesize};
use std::error::Error;

/// The number of frames in which both clips play.
const WINDOW: usize = 30;

fn main() -> Result<(), Box<dyn Error>> {
    let walk = Motion::analyze(synthesize(&Params::new(Action::Walk))?.clip);
    let run = Motion::analyze(synthesize(&Params::new(Action::Run))?.clip);

    // The window of the walk that is most like a window of the run, after the best alignment on the
    // ground.
    let weights = limb_weights(walk.clip().skeleton());
    let height = f64::from(walk.body_height());
    let options = SearchOptions::new(WINDOW);
    let best = best_transition(walk.clip(), run.clip(), &weights, height, &options)?;
    println!("leave the walk at frame {}, enter the run at frame {}", best.leave, best.enter);

    // The velocity jump of a cut, and of the dissolve, beyond what the clips themselves do.
    let traces = [&walk, &run].map(|motion| MotionTrace::new(motion.clip(), motion.roles()));
    for window in [0, WINDOW] {
        let options = DissolveOptions { window, ..DissolveOptions::default() };
        let result = dissolve(&walk, best.leave, &run, best.enter, &options)?.clip;
        let metrics =
            ResultMetrics::measure(&MotionTrace::new(&result, walk.roles()), &traces.each_ref());
        let jump = metrics.velocity_jump_dps.ok_or("the clips are too short to measure")?;
        println!("window of {window:2} frames: velocity jump {jump:.0} °/s");
        if let (Some(path), WINDOW) = (std::env::args_os().nth(1), window) {
            std::fs::write(path, bvh::write(&result, &bvh::WriteOptions::default()))?;
        }
    }
    Ok(())
}
