//! The simulation object, steered by springs.

use super::control::Control;
use crate::math::{Planar, spring, wrap_angle};
use glam::DVec2;

/// The simulation object: the player steers it, and the character follows it.
///
/// Its velocity is a critically damped spring towards the goal velocity, with an acceleration of
/// its own, so that the path is smooth to the third derivative; its yaw is a spring towards the
/// goal yaw (Holden, "Code vs Data Driven Displacement", 2021). Both are solved in closed form: a
/// prediction is the same formula with a longer time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Simulation {
    /// (x, z), metres.
    pub position: DVec2,
    /// Metres per second.
    pub velocity: DVec2,
    /// Metres per second squared.
    pub acceleration: DVec2,
    /// Radians about +Y.
    pub yaw: f64,
    /// Radians per second.
    pub yaw_rate: f64,
    /// The desired velocity.
    pub goal_velocity: DVec2,
    /// The desired yaw.
    pub goal_yaw: f64,
}

/// Half-lives of the springs, seconds.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Steering {
    /// Half-life of the velocity.
    pub velocity_half_life_secs: f64,
    /// Half-life of the facing.
    pub facing_half_life_secs: f64,
}

/// The least velocity that determines the facing, metres per second.
const MIN_HEADING_MPS: f64 = 0.1;

impl Simulation {
    /// Returns an object at rest.
    #[must_use]
    pub fn at_rest(at: &Planar) -> Self {
        Self { position: at.shift, yaw: at.yaw, goal_yaw: at.yaw, ..Self::default() }
    }

    /// Sets the desired velocity and facing. Without strafing, the facing follows the direction of
    /// travel and keeps its last value at rest.
    pub fn set_goal(&mut self, control: &Control) {
        self.goal_velocity = control.velocity();
        let v = self.goal_velocity;
        if let Some(yaw) = control.facing() {
            self.goal_yaw = wrap_angle(yaw);
        } else if v.length() > MIN_HEADING_MPS {
            self.goal_yaw = libm::atan2(v.x, v.y);
        }
    }

    /// Returns the object after `secs` with constant input.
    #[must_use]
    pub fn after(&self, secs: f64, steering: &Steering) -> Self {
        let mut later = *self;
        let t = secs.max(0.0);
        let y = spring::rate(steering.velocity_half_life_secs);
        let response = spring::response(steering.velocity_half_life_secs, t);
        let off = self.velocity - self.goal_velocity;
        // The integral of e^(-ys) (off + j s), with j = a + y off.
        let j = self.acceleration + off * y;
        let e = libm::exp(-y * t);
        later.position += self.goal_velocity * t
            + off * ((1.0 - e) / y)
            + j * ((1.0 - e * (1.0 + y * t)) / (y * y));
        later.velocity = self.goal_velocity + off * response.xx + self.acceleration * response.xv;
        later.acceleration = off * response.vx + self.acceleration * response.vv;
        let turn = wrap_angle(self.yaw - self.goal_yaw);
        let (left, rate) =
            spring::response(steering.facing_half_life_secs, t).of(turn, self.yaw_rate);
        later.yaw = wrap_angle(self.goal_yaw + left);
        later.yaw_rate = rate;
        later
    }

    /// Returns its ground frame.
    #[must_use]
    pub fn place(&self) -> Planar {
        Planar { yaw: self.yaw, shift: self.position }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEERING: Steering =
        Steering { velocity_half_life_secs: 0.25, facing_half_life_secs: 0.2 };

    #[test]
    fn simulation_in_short_steps_equals_one_long_step() {
        let start = Simulation {
            velocity: DVec2::new(1.0, -0.5),
            acceleration: DVec2::new(-3.0, 2.0),
            yaw: 3.0,
            yaw_rate: 1.0,
            goal_velocity: DVec2::new(-1.4, 0.3),
            goal_yaw: -2.5,
            ..Simulation::default()
        };
        let mut stepped = start;
        for _ in 0..70 {
            stepped = stepped.after(0.01, &STEERING);
        }
        let once = start.after(0.7, &STEERING);
        assert!(
            stepped.position.distance(once.position) < 1e-12
                && stepped.velocity.distance(once.velocity) < 1e-12
        );
        assert!(
            wrap_angle(stepped.yaw - once.yaw).abs() < 1e-12
                && (stepped.yaw_rate - once.yaw_rate).abs() < 1e-12
        );
        let (h, at) = (1e-5, |t: f64| start.after(t, &STEERING));
        let rate = (at(0.3 + h).position - at(0.3 - h).position) / (2.0 * h);
        assert!(rate.distance(at(0.3).velocity) < 1e-8);
        let rate = (at(0.3 + h).velocity - at(0.3 - h).velocity) / (2.0 * h);
        assert!(rate.distance(at(0.3).acceleration) < 1e-8);
        let far = start.after(9.0, &STEERING);
        assert!(
            far.velocity.distance(start.goal_velocity) < 1e-9
                && (far.yaw - start.goal_yaw).abs() < 1e-9
        );
    }

    #[test]
    fn simulation_without_strafing_faces_its_travel() {
        let mut simulation = Simulation::at_rest(&Planar::new(0.5, 1.0, 2.0));
        simulation.set_goal(&Control::default());
        assert_eq!(simulation.goal_yaw, 0.5);
        simulation.set_goal(&Control::new(DVec2::new(2.0, 0.0), None));
        assert!((simulation.goal_yaw - std::f64::consts::FRAC_PI_2).abs() < 1e-12);
        simulation.set_goal(&Control::new(DVec2::new(2.0, 0.0), Some(0.0)));
        assert_eq!(simulation.goal_yaw, 0.0);
        let quick = Steering { velocity_half_life_secs: 0.0, facing_half_life_secs: 0.0 };
        let there = simulation.after(0.5, &quick);
        assert!((there.position.x - 2.0).abs() < 1e-6 && there.yaw == 0.0);
    }
}
