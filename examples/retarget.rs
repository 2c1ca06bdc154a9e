//! Moves a walk to a smaller body with other joint names, and compares the two.
//!
//! `cargo run --no-default-features --example retarget -- retarget.bvh` also writes the result.

#![expect(clippy::print_stdout, reason = "the numbers are the example's output")]

use segue_formats::bvh;
use segue_motion::clip::{
    Clip, ContactOptions, Contacts, character_frames, ground_speed, retarget,
};
use segue_motion::metrics::foot_slide_cm;
use segue_motion::skeleton::{JointMap, Roles, Skeleton};
use segue_motion::synth::{Action, Params, humanoid, synthesize};
use std::error::Error;
use std::sync::Arc;

fn main() -> Result<(), Box<dyn Error>> {
    let walk = synthesize(&Params::new(Action::Walk))?.clip;
    let roles = Roles::detect(walk.skeleton());

    // A body of 1.2 m, its joints named as Mixamo does.
    let mut joints = humanoid(1.2)?.joints().to_vec();
    for joint in &mut joints {
        joint.name = format!("mixamorig:{}", joint.name);
    }
    let child = Arc::new(Skeleton::new(joints)?);
    let child_roles = Roles::detect(&child);
    let map = JointMap::between(&child, &child_roles, walk.skeleton(), &roles);
    println!("{} of {} joints have a counterpart", map.count(), child.len());

    // Angles are kept, lengths scale with the legs.
    let result = retarget(&walk, &roles, &child, &child_roles)?;
    print_gait("source", &walk, &roles);
    print_gait("result", &result, &child_roles);
    if let Some(path) = std::env::args_os().nth(1) {
        std::fs::write(path, bvh::write(&result, &bvh::WriteOptions::default()))?;
    }
    Ok(())
}

/// Prints the height of a body, its speed over the ground, and the greatest slide of its planted
/// feet.
fn print_gait(name: &str, clip: &Clip, roles: &Roles) {
    let height = roles.body_height(clip.skeleton());
    let speed = ground_speed(&character_frames(clip, roles), clip.fps());
    let contacts = Contacts::detect(clip, roles, &ContactOptions::default());
    let slide = foot_slide_cm(clip, roles, &contacts).unwrap_or(f64::NAN);
    println!("{name}: {height:.2} m tall, {speed:.2} m/s, feet slide {slide:.1} cm at most");
}
