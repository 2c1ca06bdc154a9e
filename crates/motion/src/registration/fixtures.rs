//! A small body that walks by sines, for tests that do not need a realistic walk.

use crate::clip::Clip;
use crate::skeleton::{Joint, Skeleton};
use glam::{Quat, Vec3};
use std::sync::Arc;

/// Returns hips, spine, head, two arms of two bones and two legs of three: 13 joints, about 1.7 m,
/// facing +Z at rest.
pub fn body() -> Arc<Skeleton> {
    let joint = |name: &str, parent: Option<usize>, x: f32, y: f32, z: f32| Joint {
        name: name.into(),
        parent,
        offset: Vec3::new(x, y, z),
        end_site: None,
        channels: vec![],
    };
    let mut joints = vec![
        joint("Hips", None, 0.0, 0.92, 0.0),
        joint("Spine", Some(0), 0.0, 0.25, 0.0),
        joint("Head", Some(1), 0.0, 0.45, 0.0),
        joint("LeftArm", Some(1), 0.2, 0.22, 0.0),
        joint("LeftForeArm", Some(3), 0.0, -0.28, 0.0),
        joint("RightArm", Some(1), -0.2, 0.22, 0.0),
        joint("RightForeArm", Some(5), 0.0, -0.28, 0.0),
        joint("LeftUpLeg", Some(0), 0.1, 0.0, 0.0),
        joint("LeftLeg", Some(7), 0.0, -0.43, 0.0),
        joint("LeftFoot", Some(8), 0.0, -0.42, 0.0),
        joint("RightUpLeg", Some(0), -0.1, 0.0, 0.0),
        joint("RightLeg", Some(10), 0.0, -0.43, 0.0),
        joint("RightFoot", Some(11), 0.0, -0.42, 0.0),
    ];
    for (index, end) in [
        (2, Vec3::Y * 0.18),
        (4, Vec3::Y * -0.26),
        (6, Vec3::Y * -0.26),
        (9, Vec3::new(0.0, -0.06, 0.2)),
        (12, Vec3::new(0.0, -0.06, 0.2)),
    ] {
        joints[index].end_site = Some(end);
    }
    Arc::new(Skeleton::new(joints).unwrap())
}

/// Parameters of the walk.
#[derive(Clone, Copy, Debug)]
pub struct Walk {
    /// Number of frames.
    pub frames: usize,
    /// Frame rate, frames per second.
    pub fps: f64,
    /// Speed, metres per second.
    pub speed: f32,
    /// Strides per second.
    pub cadence: f32,
    /// Amplitude of the limbs' swing, radians.
    pub swing: f32,
    /// Phase of the stride at the start, 0 to 1.
    pub phase: f32,
    /// Facing at the start, radians.
    pub heading: f32,
    /// Yaw rate, radians per second.
    pub turning: f32,
    /// Position at the start: x and z, metres.
    pub start: (f32, f32),
}

impl Default for Walk {
    fn default() -> Self {
        Self {
            frames: 120,
            fps: 60.0,
            speed: 1.3,
            cadence: 0.9,
            swing: 0.45,
            phase: 0.0,
            heading: 0.0,
            turning: 0.0,
            start: (0.0, 0.0),
        }
    }
}

impl Walk {
    /// Returns the walk as a clip.
    pub fn clip(self) -> Clip {
        let skeleton = body();
        let dt = self.fps.recip() as f32;
        let (mut rotations, mut roots) = (vec![], vec![]);
        let mut at = Vec3::new(self.start.0, 0.0, self.start.1);
        for frame in 0..self.frames {
            let time = frame as f32 * dt;
            let yaw = self.heading + self.turning * time;
            let phase = std::f32::consts::TAU * (self.phase + self.cadence * time);
            let (s, c) = phase.sin_cos();
            roots.push(at + Vec3::Y * (0.92 + 0.02 * (2.0 * phase).cos()));
            let x = Quat::from_rotation_x;
            let swing = self.swing;
            let knee = |s: f32| x(swing * (0.6 - 0.6 * s).max(0.0));
            rotations.extend([
                Quat::from_rotation_y(yaw) * Quat::from_rotation_z(0.03 * s),
                Quat::from_rotation_y(-0.1 * s) * x(0.05 * swing),
                x(0.04 * c),
                x(swing * s),
                x(-0.4 - 0.3 * swing * s),
                x(-swing * s),
                x(-0.4 + 0.3 * swing * s),
                x(-swing * s),
                knee(c),
                x(0.2 * swing * c),
                x(swing * s),
                knee(-c),
                x(-0.2 * swing * c),
            ]);
            at += Quat::from_rotation_y(yaw)
                * Vec3::Z
                * (self.speed * dt * (1.0 + 0.1 * (2.0 * phase).sin()));
        }
        Clip::new("walk", skeleton, self.fps, rotations, roots).unwrap()
    }
}
