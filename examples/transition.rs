//! Goes from a walk to a run by four methods at the same frames, and compares the seams.
//!
//! `cargo run --no-default-features --example transition -- transition.bvh` also writes the
//! inertialized result.

#![expect(clippy::print_stdout, reason = "the numbers are the example's output")]

use segue_formats::bvh;
use segue_motion::blend::WeightLaw;
use segue_motion::clip::Motion;
use segue_motion::math::Decay;
use segue_motion::metrics::{MotionTrace, ResultMetrics};
use segue_motion::synth::{Action, Params, synthesize};
use segue_motion::transition::{Inertialization, Method, TransitionOptions, concatenate};
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let walk = Motion::analyze(synthesize(&Params::new(Action::Walk))?.clip);
    let run = Motion::analyze(synthesize(&Params::new(Action::Run))?.clip);
    let traces = [&walk, &run].map(|motion| MotionTrace::new(motion.clip(), motion.roles()));

    let spring =
        Method::Inertialize(Inertialization::Offset(Decay::Spring { half_life_secs: 0.2 }));
    let quintic = Method::Inertialize(Inertialization::Offset(Decay::Quintic { blend_secs: 0.4 }));
    let dissolve = Method::Dissolve { window: 24, law: WeightLaw::default() };
    let methods = [
        ("cut", Method::Cut),
        ("dissolve", dissolve),
        ("quintic", quintic),
        ("inertialize", spring),
    ];
    for (name, method) in methods {
        let result = concatenate(&walk, 100, &run, 20, &TransitionOptions::new(method))?.clip;
        let metrics =
            ResultMetrics::measure(&MotionTrace::new(&result, walk.roles()), &traces.each_ref());
        let pose = metrics.pose_jump_deg.ok_or("the clips are too short to measure")?;
        let velocity = metrics.velocity_jump_dps.ok_or("the clips are too short to measure")?;
        println!("{name:12} pose jump {pose:5.1} °, velocity jump {velocity:5.0} °/s");
        if let (Some(path), "inertialize") = (std::env::args_os().nth(1), name) {
            std::fs::write(path, bvh::write(&result, &bvh::WriteOptions::default()))?;
        }
    }
    Ok(())
}
