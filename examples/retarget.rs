//! Moves a walk to a smaller body with other joint names, and compares the two.
//!
//! `cargo run --no-default-features --example retarget -- retarget.bvh` also writes the result.

#![expect(clippy::print_stdout, reason = "the numbers are the example's output")]

use segue_formats::bvh;
use segue_motion::clip::{Clip, Contacts, Motion, character_frames, ground_speed};
use segue_motion::metrics::foot_slide_cm;
use segue_motion::retarget::{RetargetOptions, TargetBody, retarget_motion};
use segue_motion::skeleton::{Joint, JointMap, Role, Roles, Side, Skeleton};
use segue_motion::synth::{Action, Params, humanoid, synthesize};
use std::error::Error;
use std::sync::Arc;

fn main() -> Result<(), Box<dyn Error>> {
    let walk = Motion::analyze(synthesize(&Params::new(Action::Walk))?.clip);

    // A body of 1.2 m with short shins, its joints named as Mixamo does.
    let small = humanoid(1.2)?;
    let roles = Roles::detect(&small);
    let ankles = Side::BOTH.map(|side| roles.get(Role::foot(side)));
    let joint = |(index, joint): (usize, &Joint)| Joint {
        name: format!("mixamorig:{}", joint.name),
        offset: joint.offset * if ankles.contains(&Some(index)) { 0.8 } else { 1.0 },
        ..joint.clone()
    };
    let child = Arc::new(Skeleton::new(small.joints().iter().enumerate().map(joint).collect())?);
    let child_roles = Roles::detect(&child);
    let map = JointMap::between(&child, &child_roles, walk.clip().skeleton(), walk.roles());
    println!("{} of {} joints have a counterpart", map.count(), child.len());

    // First the directions of the bones alone, then with the places of feet and hands.
    let body = TargetBody::at_rest(&child, &child_roles);
    let plain = retarget_motion(&walk, &body, &RetargetOptions::DIRECTIONS)?;
    let made = retarget_motion(&walk, &body, &RetargetOptions::default())?;
    print_gait("source", walk.clip(), walk.roles(), walk.contacts());
    print_gait("directions", &plain.clip, &child_roles, walk.contacts());
    print_gait("result", &made.clip, &child_roles, walk.contacts());
    for (name, foot) in ["left", "right"].into_iter().zip(made.report.feet) {
        if let Some(foot) = foot {
            let (before, after) = (foot.directions.mean_cm, foot.result.mean_cm);
            println!("{name} foot: {before:.1} cm from its place by directions, {after:.1} cm now");
        }
    }
    if let Some(path) = std::env::args_os().nth(1) {
        std::fs::write(path, bvh::write(&made.clip, &bvh::WriteOptions::default()))?;
    }
    Ok(())
}

/// Prints the height of a body, its speed over the ground, and the greatest slide of its planted
/// feet.
fn print_gait(name: &str, clip: &Clip, roles: &Roles, contacts: &Contacts) {
    let height = roles.body_height(clip.skeleton());
    let speed = ground_speed(&character_frames(clip, roles), clip.fps());
    let slide = foot_slide_cm(clip, roles, contacts).unwrap_or(f64::NAN);
    println!("{name}: {height:.2} m tall, {speed:.2} m/s, feet slide {slide:.1} cm at most");
}
