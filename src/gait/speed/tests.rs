use super::*;
use crate::blend::Source;
use crate::clip::{ContactOptions, character_frames, ground_speed, stillest_step};
use crate::synth::{Action, Params, synthesize};
use std::sync::Arc;

fn cycle(params: &Params) -> (GaitCycle, Roles) {
    let clip = Arc::new(synthesize(params).unwrap().clip);
    let roles = Roles::detect(clip.skeleton());
    let contacts = Contacts::detect(&clip, &roles, &ContactOptions::default());
    (GaitCycle::find(&Source::new(clip, &roles), &contacts).unwrap(), roles)
}

fn blend(alignment: PhaseAlignment) -> (SpeedBlend, Roles) {
    let (walk, roles) = cycle(&Params::new(Action::Walk));
    let (run, _) = cycle(&Params::new(Action::Run));
    let options = SpeedOptions {
        alignment,
        ..SpeedOptions::default()
    };
    (SpeedBlend::new(&walk, &run, &roles, &options).unwrap(), roles)
}

fn measured(clip: &Clip, roles: &Roles) -> f64 {
    f64::from(ground_speed(&character_frames(clip, roles), clip.fps()))
}

/// Centimetres that planted feet slide per cycle.
fn skate(made: &GaitClip, roles: &Roles) -> f32 {
    let mut sum = 0.0;
    for side in Side::BOTH {
        let points = roles.foot_points(made.clip.skeleton(), side);
        let at = |frame: usize| -> Vec<Vec3> {
            let world = made.clip.world_pose(frame);
            points.iter().map(|&(joint, point)| world.point(joint, point)).collect()
        };
        for frame in 1..made.clip.frames() {
            if made.contacts.planted(side, frame) && made.contacts.planted(side, frame - 1) {
                sum += stillest_step(&at(frame - 1), &at(frame)).unwrap().length() * 100.0;
            }
        }
    }
    sum
}

#[test]
fn show() {
    for alignment in [PhaseAlignment::Feet, PhaseAlignment::Strikes, PhaseAlignment::None] {
        let (blend, roles) = blend(alignment);
        println!("{alignment:?} {:?} {:?}", blend.gaits[0].events, blend.gaits[1].events);
        for i in 0..=12 {
            let v = 0.9 + 0.25 * f64::from(i);
            let made = blend.cycle_at(v).unwrap();
            let long = blend.clip_of(v, 6.0).unwrap();
            let low = made
                .clip
                .world_positions(0..made.clip.frames())
                .iter()
                .map(|p| p.y)
                .fold(9.0, f32::min);
            println!(
                "{v:.2} cycle {:.3} long {:.3} skate {:.1} low {low:.3} {:?}",
                measured(&made.clip, &roles),
                measured(&long.clip, &roles),
                skate(&made, &roles),
                made.facts
            );
        }
    }
}
