//! Databases and the simulation object compared with an oracle.

use super::*;
use crate::math::wrap_angle;
use crate::skeleton::{Joint, Skeleton};
use glam::Quat;
use serde_json::Value;

fn golden() -> Value {
    serde_json::from_str(include_str!("../../../tests/oracles/matching.json")).unwrap()
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|number| number.as_f64().unwrap()).collect()
}

fn joint(name: &str, parent: Option<usize>, offset: [f32; 3]) -> Joint {
    Joint {
        name: name.into(),
        parent,
        offset: Vec3::from_array(offset),
        end_site: None,
        channels: vec![],
    }
}

/// Returns the oracle's body: hips, and on either side a thigh that swings and a foot.
fn oracle_clip(golden: &Value) -> Arc<Motion> {
    let skeleton = Skeleton::new(vec![
        joint("Hips", None, [0.0; 3]),
        joint("LeftUpLeg", Some(0), [0.1, 0.0, 0.0]),
        joint("LeftFoot", Some(1), [0.0, -0.8, 0.02]),
        joint("RightUpLeg", Some(0), [-0.1, 0.0, 0.0]),
        joint("RightFoot", Some(3), [0.0, -0.8, 0.02]),
    ]);
    let skeleton = Arc::new(skeleton.unwrap());
    let (yaws, swings) = (numbers(&golden["yaw"]), numbers(&golden["swing"]));
    let rotations = (yaws.iter().zip(&swings)).flat_map(|(&yaw, &swing)| {
        let swung = |swing: f64| Quat::from_rotation_x(swing as f32);
        [
            Quat::from_rotation_y(yaw as f32),
            swung(swing),
            Quat::IDENTITY,
            swung(-swing),
            Quat::IDENTITY,
        ]
    });
    let roots = golden["position"].as_array().unwrap().iter().map(|at| {
        let at = numbers(at);
        Vec3::new(at[0] as f32, at[1] as f32, at[2] as f32)
    });
    let roles = Roles::detect(&skeleton);
    let clip =
        Clip::new("oracle", skeleton, RATE as f64, rotations.collect(), roots.collect()).unwrap();
    Arc::new(Motion::with_roles(clip, &roles))
}

#[test]
fn database_agrees_with_the_oracle() {
    let golden = golden();
    let options = DatabaseOptions { mirrored: false, ..DatabaseOptions::default() };
    let database = Database::new(vec![oracle_clip(&golden)], &options).unwrap();
    let motion = &database.motions()[0];
    for (root, wanted) in motion.roots().iter().zip(golden["roots"].as_array().unwrap()) {
        let wanted = numbers(wanted);
        assert!(wrap_angle(root.yaw - wanted[0]).abs() < 2e-6, "{root:?} {wanted:?}");
        assert!(root.shift.distance(DVec2::new(wanted[1], wanted[2])) < 2e-6);
    }
    let features = database.features();
    let (means, scales) = (numbers(&golden["means"]), numbers(&golden["scales"]));
    for (block, scale) in Block::ALL.into_iter().zip(&scales) {
        let found = f64::from(features.scales()[features.layout().range(block).start]);
        assert!((found - scale).abs() < 1e-4 * scale, "{block:?}");
    }
    for (frame, row) in golden["rows"].as_object().unwrap() {
        let found = features.row(frame.parse().unwrap()).unwrap();
        for (block, scale) in Block::ALL.into_iter().zip(&scales) {
            for dim in features.layout().range(block) {
                let wanted = (numbers(row)[dim] - means[dim]) / scale;
                // The grid's half step, and rounding of the scale.
                let error = (f64::from(found[dim]) - wanted).abs();
                assert!(
                    error < 0.5 / 4096.0 + 3e-4 * wanted.abs().max(1.0),
                    "{frame} {dim}: {} {wanted}",
                    found[dim]
                );
            }
        }
    }
}

#[test]
fn simulation_agrees_with_the_oracle() {
    let pair = |value: &Value| DVec2::from_slice(&numbers(value));
    for case in golden()["simulation"].as_array().unwrap() {
        let start = Simulation {
            velocity: pair(&case["velocity"]),
            acceleration: pair(&case["acceleration"]),
            goal_velocity: pair(&case["goal"]),
            ..Simulation::default()
        };
        let steering = Steering {
            velocity_half_life_secs: case["half_life"].as_f64().unwrap(),
            facing_half_life_secs: 0.2,
        };
        let end = start.after(case["secs"].as_f64().unwrap(), &steering);
        let wanted = numbers(&case["end"]);
        for (found, wanted) in
            [end.position, end.velocity, end.acceleration].into_iter().zip(wanted.chunks(2))
        {
            assert!(found.distance(DVec2::from_slice(wanted)) < 1e-7, "{found} {wanted:?}");
        }
    }
}
