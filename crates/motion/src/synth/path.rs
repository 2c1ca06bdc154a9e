//! The planned path over the ground: position and heading of the body over time.

use glam::DVec2;

/// One moment of a path.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Place {
    /// (x, z), metres.
    pub(super) position: DVec2,
    /// Heading about +Y, radians, not wrapped.
    pub(super) yaw: f64,
    /// Metres per second along the heading.
    pub(super) speed: f64,
    /// Radians per second.
    pub(super) yaw_rate: f64,
    /// Change of speed, metres per second squared.
    pub(super) thrust: f64,
}

impl Place {
    /// Returns the heading as (x, z).
    pub(super) fn forward(&self) -> DVec2 {
        DVec2::new(libm::sin(self.yaw), libm::cos(self.yaw))
    }

    /// Returns the direction to the left as (x, z).
    pub(super) fn left(&self) -> DVec2 {
        DVec2::new(libm::cos(self.yaw), -libm::sin(self.yaw))
    }

    /// Returns the acceleration over the ground: thrust along the heading, centripetal across it.
    pub(super) fn acceleration(&self) -> DVec2 {
        self.forward() * self.thrust + self.left() * (self.speed * self.yaw_rate)
    }

    /// Returns the lean of the body as the tangent of its angle, world (x, z): acceleration over
    /// gravity. Exact up to a good quarter of g, and never more than 21°, beyond which the feet
    /// would slip.
    pub(super) fn lean(&self, gravity: f64) -> DVec2 {
        const MAX_TANGENT: f64 = 0.38;
        let lean = self.acceleration() / gravity;
        lean / (1.0 + (lean.length_squared() / (MAX_TANGENT * MAX_TANGENT)).powi(2)).sqrt().sqrt()
    }

    /// Converts (left, forward) of this place to world (x, z).
    pub(super) fn to_world(self, v: DVec2) -> DVec2 {
        self.left() * v.x + self.forward() * v.y
    }

    /// Converts world (x, z) to (left, forward) of this place.
    pub(super) fn to_local(self, v: DVec2) -> DVec2 {
        DVec2::new(self.left().dot(v), self.forward().dot(v))
    }
}

/// A path sampled at equal time steps; between samples it is an arc, before and after them it
/// continues as at its ends.
#[derive(Clone, Debug)]
pub(super) struct Path {
    start_secs: f64,
    dt_secs: f64,
    places: Vec<Place>,
}

/// Returns the chord of an arc of length `speed × dt` that turns by `yaw_rate × dt`, from heading
/// `yaw`. Exact for constant rates.
fn arc(yaw: f64, speed: f64, yaw_rate: f64, dt: f64) -> DVec2 {
    let half_turn = 0.5 * yaw_rate * dt;
    let sinc = if half_turn.abs() < 1e-6 {
        1.0 - half_turn * half_turn / 6.0
    } else {
        libm::sin(half_turn) / half_turn
    };
    let (sin, cos) = libm::sincos(yaw + half_turn);
    DVec2::new(sin, cos) * (speed * dt * sinc)
}

impl Path {
    /// Integrates `rates(time) = (speed, yaw rate)` over `count` samples from `start_secs`; at time
    /// 0 it passes the origin with heading 0.
    pub(super) fn integrate(
        start_secs: f64,
        dt_secs: f64,
        count: usize,
        rates: impl Fn(f64) -> (f64, f64),
    ) -> Self {
        let mut places = Vec::with_capacity(count);
        let mut here = Place::default();
        for i in 0..count {
            let time = start_secs + i as f64 * dt_secs;
            let (speed, yaw_rate) = rates(time);
            let thrust = (rates(time + 0.5 * dt_secs).0 - rates(time - 0.5 * dt_secs).0) / dt_secs;
            here = Place { speed, yaw_rate, thrust, ..here };
            places.push(here);
            let (speed, yaw_rate) = rates(time + 0.5 * dt_secs);
            here.position += arc(here.yaw, speed, yaw_rate, dt_secs);
            here.yaw += yaw_rate * dt_secs;
        }
        let mut path = Self { start_secs, dt_secs, places };
        let origin = path.at(0.0);
        let turn = Place { yaw: -origin.yaw, ..Place::default() };
        for place in &mut path.places {
            place.position = turn.to_world(place.position - origin.position);
            place.yaw -= origin.yaw;
        }
        path
    }

    /// Returns the place at any time; `±∞` give the ends.
    pub(super) fn at(&self, secs: f64) -> Place {
        let Some(last) = self.places.len().checked_sub(1) else {
            return Place::default();
        };
        let steps = (secs - self.start_secs) / self.dt_secs;
        let index = steps.floor().clamp(0.0, last as f64);
        let from = self.places[index as usize];
        let dt = if steps.is_finite() { (steps - index) * self.dt_secs } else { 0.0 };
        let mean_speed = from.speed + 0.5 * from.thrust * dt;
        Place {
            position: from.position + arc(from.yaw, mean_speed, from.yaw_rate, dt),
            yaw: from.yaw + from.yaw_rate * dt,
            speed: from.speed + from.thrust * dt,
            ..from
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn path_of_a_steady_turn_is_a_circle_through_the_origin() {
        let path = Path::integrate(-2.0, 0.01, 1000, |_| (1.4, 0.5));
        let radius = 1.4 / 0.5;
        for secs in [-2.0, -0.013, 0.0, 1.237, 7.5] {
            let place = path.at(secs);
            let angle: f64 = 0.5 * secs;
            let expected = DVec2::new(radius * (1.0 - angle.cos()), radius * angle.sin());
            assert!(
                (place.position - expected).length() < 1e-9,
                "{secs}: {} {expected}",
                place.position
            );
            assert!((place.yaw - angle).abs() < 1e-9);
        }
    }

    #[test]
    fn path_of_rising_speed_covers_the_integral_of_the_speed() {
        let path = Path::integrate(0.0, 0.01, 201, |t| (t, 0.0));
        assert!((path.at(2.0).position.y - 2.0).abs() < 1e-6);
        assert!((path.at(1.0).thrust - 1.0).abs() < 1e-9);
    }
}
