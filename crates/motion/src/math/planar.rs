//! Rigid transforms of the ground plane, and angles modulo a whole turn.

use glam::{DVec2, Quat, Vec3};
use std::f64::consts::{PI, TAU};

/// A rigid transform of the ground plane: a rotation about +Y, then a shift in x and z. Heights
/// stay.
///
/// `x = x' cos θ + z' sin θ + x₀`, `z = -x' sin θ + z' cos θ + z₀` (Kovar, Gleicher, Pighin 2002,
/// section 3.1). Stored in `f64`, because walks chain thousands of them. As the ground frame of a
/// character (its position and facing) it reads `world_from_character`.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Planar {
    /// The rotation about +Y, radians. 0 faces +Z.
    pub yaw: f64,
    /// The shift, metres: (x, z).
    pub shift: DVec2,
}

impl Planar {
    /// The identity.
    pub const IDENTITY: Self = Self { yaw: 0.0, shift: DVec2::ZERO };

    /// Returns a rotation of `yaw` radians about +Y followed by a shift of `(x, z)` metres.
    #[must_use]
    pub const fn new(yaw: f64, x: f64, z: f64) -> Self {
        Self { yaw, shift: DVec2::new(x, z) }
    }

    /// Returns the ground frame of a character that stands at `position` (its height is ignored)
    /// and faces the ground projection of `facing`.
    #[must_use]
    pub fn standing_at(position: Vec3, facing: Vec3) -> Self {
        Self::new(
            libm::atan2(f64::from(facing.x), f64::from(facing.z)),
            f64::from(position.x),
            f64::from(position.z),
        )
    }

    /// Returns the rotation as a quaternion.
    #[must_use]
    pub fn rotation(&self) -> Quat {
        Quat::from_rotation_y(self.yaw as f32)
    }

    /// Returns the direction to which +Z is turned.
    #[must_use]
    pub fn forward(&self) -> Vec3 {
        Vec3::new(libm::sin(self.yaw) as f32, 0.0, libm::cos(self.yaw) as f32)
    }

    /// Returns the shift as a point on the ground.
    #[must_use]
    pub fn origin(&self) -> Vec3 {
        Vec3::new(self.shift.x as f32, 0.0, self.shift.y as f32)
    }

    fn turned(&self, v: DVec2) -> DVec2 {
        let (sin, cos) = libm::sincos(self.yaw);
        DVec2::new(v.x * cos + v.y * sin, -v.x * sin + v.y * cos)
    }

    /// Transforms a point. Its height stays.
    #[must_use]
    pub fn apply(&self, point: Vec3) -> Vec3 {
        let p = self.turned(DVec2::new(f64::from(point.x), f64::from(point.z))) + self.shift;
        Vec3::new(p.x as f32, point.y, p.y as f32)
    }

    /// Transforms a point of the ground, (x, z) in metres.
    #[must_use]
    pub fn apply_ground(&self, point: DVec2) -> DVec2 {
        self.turned(point) + self.shift
    }

    /// Transforms a direction or velocity: rotated, not shifted.
    #[must_use]
    pub fn apply_vector(&self, v: Vec3) -> Vec3 {
        let p = self.turned(DVec2::new(f64::from(v.x), f64::from(v.z)));
        Vec3::new(p.x as f32, v.y, p.y as f32)
    }

    /// Returns `self` after `first`: `a.after(b).apply(p) == a.apply(b.apply(p))`. The yaw is
    /// wrapped into `[-π, π)`.
    #[must_use]
    pub fn after(&self, first: &Self) -> Self {
        Self { yaw: wrap_angle(self.yaw + first.yaw), shift: self.turned(first.shift) + self.shift }
    }

    /// Returns the transform as seen in a mirror in the plane x = 0: with the reflection S it is
    /// `S · self · S`.
    #[must_use]
    pub fn mirrored(&self) -> Self {
        // Without rounding, so that mirroring twice changes nothing. Half a turn is its own image.
        let yaw = if self.yaw <= -PI { self.yaw } else { -self.yaw };
        Self { yaw, shift: DVec2::new(-self.shift.x, self.shift.y) }
    }

    /// Returns a rotation of `yaw` radians about a point of the ground, (x, z) in metres.
    #[must_use]
    pub fn turn_about(yaw: f64, point: DVec2) -> Self {
        let turn = Self { yaw, shift: DVec2::ZERO };
        Self { yaw, shift: point - turn.turned(point) }
    }

    /// Returns the inverse transform.
    #[must_use]
    pub fn inverse(&self) -> Self {
        let back = Self { yaw: -self.yaw, shift: DVec2::ZERO };
        Self { yaw: wrap_angle(-self.yaw), shift: -back.turned(self.shift) }
    }
}

/// Wraps `angle` (radians) into `[-π, π)`.
#[must_use]
pub fn wrap_angle(angle: f64) -> f64 {
    (angle + PI).rem_euclid(TAU) - PI
}

/// Returns `angle` (radians) plus as many whole turns as bring it nearest to `reference`, to unwrap
/// a sequence of angles.
#[must_use]
pub(crate) fn unwrap_near(angle: f64, reference: f64) -> f64 {
    reference + wrap_angle(angle - reference)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn planar() -> impl Strategy<Value = Planar> {
        (-3.0f64..3.0, -9.0f64..9.0, -9.0f64..9.0).prop_map(|(yaw, x, z)| Planar::new(yaw, x, z))
    }

    proptest! {
        #[test]
        fn planar_after_its_inverse_is_identity(
            a in planar(),
            x in -5.0f32..5.0,
            y in -1.0f32..3.0,
            z in -5.0f32..5.0,
        ) {
            let p = Vec3::new(x, y, z);
            prop_assert!((a.inverse().apply(a.apply(p)) - p).length() < 1e-5);
            prop_assert!((a.after(&a.inverse()).apply(p) - p).length() < 1e-5);
        }

        #[test]
        fn planar_after_applies_the_argument_first(a in planar(), b in planar()) {
            let p = Vec3::new(1.0, 2.0, -3.0);
            prop_assert!((a.after(&b).apply(p) - a.apply(b.apply(p))).length() < 1e-4);
        }

        #[test]
        fn planar_mirrored_is_the_reflected_transform(
            a in planar(),
            x in -5.0f32..5.0,
            z in -5.0f32..5.0,
        ) {
            let (p, reflected) = (Vec3::new(x, 1.0, z), Vec3::new(-1.0, 1.0, 1.0));
            let image = a.mirrored().apply(p * reflected);
            prop_assert!((image - a.apply(p) * reflected).length() < 1e-5);
        }

        #[test]
        fn planar_turn_about_a_point_leaves_it_in_place(yaw in -3.0f64..3.0, at in planar()) {
            let turn = Planar::turn_about(yaw, at.shift);
            prop_assert!(turn.apply_ground(at.shift).distance(at.shift) < 1e-9);
            prop_assert_eq!(turn.yaw, yaw);
        }

        #[test]
        fn planar_agrees_with_its_quaternion(a in planar()) {
            let v = Vec3::new(0.3, 0.5, -0.8);
            prop_assert!((a.rotation() * v - a.apply_vector(v)).length() < 1e-5);
            prop_assert!((a.rotation() * Vec3::Z - a.forward()).length() < 1e-5);
        }
    }
}
