//! The response of an offset and its velocity to a decay.

use glam::Vec3;

/// The linear map from an offset `x` and its velocity `v` to the rest of both after some time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Response {
    /// Offset from offset.
    pub xx: f64,
    /// Offset from velocity, seconds.
    pub xv: f64,
    /// Velocity from offset, per second.
    pub vx: f64,
    /// Velocity from velocity.
    pub vv: f64,
}

impl Response {
    /// The response after which neither offset nor velocity is left.
    pub const ZERO: Self = Self { xx: 0.0, xv: 0.0, vx: 0.0, vv: 0.0 };

    /// Applies the response to an offset and its velocity, and returns both.
    #[must_use]
    pub fn of(&self, x: f64, v: f64) -> (f64, f64) {
        (self.xx * x + self.xv * v, self.vx * x + self.vv * v)
    }

    /// Applies the response to each component of an offset and its velocity, and returns both.
    #[must_use]
    pub fn of_vec3(&self, x: Vec3, v: Vec3) -> (Vec3, Vec3) {
        (x * self.xx as f32 + v * self.xv as f32, x * self.vx as f32 + v * self.vv as f32)
    }
}
