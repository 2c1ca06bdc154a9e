//! Motions for the skeletons of `skeleton::fixtures`, for tests.

mod quadruped;

pub use quadruped::{QuadrupedWalk, quadruped};

use super::{Clip, JointTranslations};
use crate::skeleton::{Joint, Skeleton, fixtures::noise};
use glam::{Quat, Vec3};
use std::sync::Arc;

/// Returns a smooth pseudo-random motion of every joint, with angles of up to half a radian, 30
/// frames per second.
pub fn wander(skeleton: &Arc<Skeleton>, frames: usize, seed: u64) -> Clip {
    wander_by(skeleton, frames, seed, 0.5)
}

/// Returns a smooth pseudo-random motion of every joint, with angles of up to about `radians`.
pub fn wander_by(skeleton: &Arc<Skeleton>, frames: usize, seed: u64, radians: f32) -> Clip {
    let mut next = noise(seed);
    let joints = skeleton.len();
    let mut vectors =
        |count: usize| (0..count).map(|_| Vec3::new(next(), next(), next())).collect::<Vec<_>>();
    let (middle, swing, way) = (vectors(joints), vectors(joints), vectors(1)[0]);
    let (mut rotations, mut roots) = (Vec::new(), Vec::new());
    for frame in 0..frames {
        let t = frame as f32 / 30.0;
        roots
            .push(Vec3::new(0.3, 0.95, -0.2) + Vec3::new(way.x, 0.05 * (5.0 * t).sin(), way.z) * t);
        rotations.extend((0..joints).map(|j| {
            Quat::from_scaled_axis((middle[j] + swing[j] * (3.0 * t).sin()) * 0.5 * radians)
        }));
    }
    Clip::new("wander", Arc::clone(skeleton), 30.0, rotations, roots).unwrap()
}

/// Returns the largest distance between the same joint of two clips of one skeleton, metres.
pub fn largest_distance(a: &Clip, b: &Clip) -> f32 {
    let (a, b) = (a.world_positions(0..a.frames()), b.world_positions(0..b.frames()));
    assert_eq!(a.len(), b.len());
    a.iter().zip(&b).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max)
}

/// Returns a skeleton of a root and joints that hang from it, `count` in all.
pub fn points_skeleton(count: usize) -> Arc<Skeleton> {
    let joint = |index: usize| Joint {
        name: format!("p{index}"),
        parent: (index > 0).then_some(0),
        offset: Vec3::ZERO,
        end_site: None,
        channels: vec![],
    };
    Arc::new(Skeleton::new((0..count).map(joint).collect()).unwrap())
}

/// Returns a clip of a [`points_skeleton`] from the position of each point in each frame.
pub fn points_clip(skeleton: &Arc<Skeleton>, fps: f64, frames: &[Vec<[f32; 3]>]) -> Clip {
    let at = |frame: &Vec<[f32; 3]>, joint: usize| Vec3::from_array(frame[joint]);
    let roots = frames.iter().map(|frame| at(frame, 0)).collect();
    let rotations = vec![Quat::IDENTITY; frames.len() * skeleton.len()];
    let tracks = (1..skeleton.len()).map(|joint| JointTranslations {
        joint,
        values: frames.iter().map(|frame| at(frame, joint) - at(frame, 0)).collect(),
    });
    let clip = Clip::new("points", Arc::clone(skeleton), fps, rotations, roots).unwrap();
    clip.with_translations(tracks.collect()).unwrap()
}
