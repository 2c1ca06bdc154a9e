//! A camera that moves smoothly to its goal.

use crate::Camera;
use glam::Vec3;
use segue_motion::math::spring;
use std::f32::consts::PI;

/// A camera that moves smoothly to its goal.
///
/// Change `goal` (by the pointer, by framing, by following a body) and call [`CameraRig::update`]
/// once per frame. The camera moves as a critically damped spring (Holden, "Spring-It-On", with its
/// half-life): without overshoot, and independent of the frame rate.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CameraRig {
    /// The camera that is approached.
    pub goal: Camera,
    shown: Camera,
    target_velocity: Vec3,
    yaw_velocity: f32,
    pitch_velocity: f32,
    zoom_velocity: f32,
}

impl CameraRig {
    /// Returns a rig at rest at `camera`.
    #[must_use]
    pub fn new(camera: Camera) -> Self {
        Self { goal: camera, shown: camera, ..Self::default() }
    }

    /// Returns the camera to draw with.
    #[must_use]
    pub fn camera(&self) -> &Camera {
        &self.shown
    }

    /// Moves the camera to the goal at once.
    pub fn jump(&mut self) {
        *self = Self::new(self.goal);
    }

    /// Returns whether the camera is at rest, so that no further frame is needed for it.
    #[must_use]
    pub fn is_still(&self) -> bool {
        self.shown == self.goal
    }

    /// Takes over direction, distance and projection of the goal at once; only the target remains
    /// smoothed. Used while the pointer turns the camera: its movements are not smoothed, but the
    /// camera follows a body smoothly.
    pub fn turn_at_once(&mut self) {
        self.shown = Camera { target: self.shown.target, ..self.goal };
        (self.yaw_velocity, self.pitch_velocity, self.zoom_velocity) = (0.0, 0.0, 0.0);
    }

    /// Advances by `dt_secs`; half of the distance to the goal is left after 1.2 half-lives. A
    /// half-life of 0 moves the camera at once.
    pub fn update(&mut self, half_life_secs: f32, dt_secs: f32) {
        if self.is_still() || half_life_secs <= 0.0 || !dt_secs.is_finite() {
            self.jump();
            return;
        }
        let goal = self.goal;
        // The rest of an offset after this step.
        let left = |offset, velocity| {
            spring::towards_point(
                offset,
                velocity,
                Vec3::ZERO,
                f64::from(half_life_secs),
                f64::from(dt_secs),
            )
        };
        let (target, target_velocity) = left(self.shown.target - goal.target, self.target_velocity);
        let yaw_offset = (self.shown.yaw - goal.yaw + PI).rem_euclid(2.0 * PI) - PI;
        // A zoom appears even when the logarithm of the distance changes evenly.
        let zoom_offset = (self.shown.distance / goal.distance).ln();
        let (turn, turn_velocity) = left(
            Vec3::new(yaw_offset, self.shown.pitch - goal.pitch, zoom_offset),
            Vec3::new(self.yaw_velocity, self.pitch_velocity, self.zoom_velocity),
        );
        let still = target.length() < 1e-4
            && turn.length() < 1e-4
            && target_velocity.length() < 1e-3
            && turn_velocity.length() < 1e-3;
        if still || !(target.is_finite() && turn.is_finite()) {
            self.jump();
            return;
        }
        self.shown = Camera {
            target: goal.target + target,
            yaw: goal.yaw + turn.x,
            pitch: goal.pitch + turn.y,
            distance: goal.distance * turn.z.exp(),
            ..goal
        };
        self.target_velocity = target_velocity;
        [self.yaw_velocity, self.pitch_velocity, self.zoom_velocity] = turn_velocity.to_array();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn camera_rig_at_any_frame_rate_arrives_by_the_shorter_way_without_overshoot() {
        let start = Camera { yaw: 3.0, distance: 2.0, ..Camera::default() };
        let mut at_60 = CameraRig::new(start);
        let mut at_15 = at_60;
        for rig in [&mut at_60, &mut at_15] {
            rig.goal =
                Camera { yaw: -3.0, distance: 8.0, target: Vec3::new(1.0, 0.9, 0.0), ..start };
        }
        let mut previous = 0.0;
        for _ in 0..10 {
            for _ in 0..4 {
                at_60.update(0.15, 1.0 / 60.0);
            }
            at_15.update(0.15, 1.0 / 15.0);
            assert!((at_60.camera().target - at_15.camera().target).length() < 1e-4);
            assert!((at_60.camera().distance - at_15.camera().distance).abs() < 1e-3);
            let x = at_60.camera().target.x;
            assert!(x > previous && x <= 1.0);
            previous = x;
            // From 3 to -3 the shorter way passes π, not 0.
            assert!((at_60.camera().yaw.abs() - PI).abs() < 0.15);
        }
        for _ in 0..600 {
            at_60.update(0.15, 1.0 / 60.0);
        }
        assert!(at_60.is_still());
        assert_eq!(*at_60.camera(), at_60.goal);
    }
}
