//! Axis-aligned bounding boxes.

use glam::Vec3;
use segue_motion::skeleton::WorldPose;

/// An axis-aligned box in the world, metres. Empty until a point is included.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// The corner with the smallest coordinates.
    pub min: Vec3,
    /// The corner with the largest coordinates.
    pub max: Vec3,
}

impl Default for Bounds {
    fn default() -> Self {
        Self::EMPTY
    }
}

impl Bounds {
    /// The empty box.
    pub const EMPTY: Self = Self { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY };

    /// Returns whether no point has been included.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        !self.min.cmple(self.max).all()
    }

    /// Extends the box to a point. A point that is not finite is ignored.
    pub fn include(&mut self, point: Vec3) {
        if point.is_finite() {
            self.min = self.min.min(point);
            self.max = self.max.max(point);
        }
    }

    /// Extends the box to every joint of a pose.
    pub fn include_pose(&mut self, pose: &WorldPose) {
        for &position in &pose.positions {
            self.include(position);
        }
    }

    /// Returns the box extended by `margin` metres on every side.
    #[must_use]
    pub fn grown(&self, margin: f32) -> Self {
        Self { min: self.min - margin, max: self.max + margin }
    }

    /// Returns the centre; the origin for an empty box.
    #[must_use]
    pub fn center(&self) -> Vec3 {
        if self.is_empty() { Vec3::ZERO } else { (self.min + self.max) * 0.5 }
    }

    /// Returns the eight corners.
    #[must_use]
    pub fn corners(&self) -> [Vec3; 8] {
        std::array::from_fn(|i| {
            let pick = |bit: usize, min: f32, max: f32| if i >> bit & 1 == 0 { min } else { max };
            Vec3::new(
                pick(0, self.min.x, self.max.x),
                pick(1, self.min.y, self.max.y),
                pick(2, self.min.z, self.max.z),
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_of_points_contain_the_finite_ones() {
        let mut bounds = Bounds::default();
        assert!(bounds.is_empty());
        assert_eq!(bounds.center(), Vec3::ZERO);
        bounds.include(Vec3::new(f32::NAN, 0.0, 0.0));
        assert!(bounds.is_empty());
        bounds.include(Vec3::ONE);
        bounds.include(Vec3::new(3.0, -1.0, 1.0));
        assert_eq!(bounds.center(), Vec3::new(2.0, 0.0, 1.0));
        assert_eq!(bounds.grown(1.0).corners()[7], Vec3::new(4.0, 2.0, 2.0));
    }
}
