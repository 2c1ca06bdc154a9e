//! Rounded cones in the world.

use glam::Vec3;

/// A [`Shape`](super::shapes::Shape) in a pose: everything in the world, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlacedShape {
    /// Centre of the first ball.
    pub a: Vec3,
    /// Centre of the second ball.
    pub b: Vec3,
    /// Radius of the first ball.
    pub radius_a: f32,
    /// Radius of the second ball.
    pub radius_b: f32,
    /// Unit axis along which the shape is flattened; zero where the shape is round.
    pub flat: Vec3,
    /// Factor on the shape's size along `flat`: 1 is round.
    pub flatness: f32,
}
