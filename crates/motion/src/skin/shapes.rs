//! The shapes of a body: tapered limbs from the bones alone, and a mannequin where the joints of
//! a person on two legs are known.
//!
//! The same shapes are drawn as limbs and used as the surface around which the smooth mesh is
//! built.

mod bones;
mod human;

pub use super::placed_shape::PlacedShape;
pub(super) use human::is_person;

use crate::skeleton::{Roles, Skeleton, WorldPose};
use glam::Vec3;
use std::ops::Range;

/// A point that moves with a joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Anchor {
    /// Index of the joint.
    pub joint: usize,
    /// In the joint's frame, metres.
    pub point: Vec3,
}

/// A rounded cone before it is posed: two balls and their common hull, as a scene's `Limb`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shape {
    /// Centre of the first ball.
    pub a: Anchor,
    /// Centre of the second ball.
    pub b: Anchor,
    /// Radius of the first ball, metres.
    pub radius_a: f32,
    /// Radius of the second ball, metres.
    pub radius_b: f32,
    /// Unit axis along which the shape is flattened, in the frame of the joint of `a`; zero where
    /// the shape is round.
    pub flat: Vec3,
    /// Factor on the shape's size along `flat`: 1 is round.
    pub flatness: f32,
    /// The shell of the shape. Shapes of different shells never blend, however near they are:
    /// fingers. 0 is that of the body.
    pub shell: usize,
    /// Whether the shape is only for surfaces that blend with their neighbours; alone it would look
    /// like a lump.
    pub soft: bool,
    /// How far the motion of a neighbouring joint reaches into the surface of the shape, in its
    /// radii: the standard deviation of the transition between the weights of two joints.
    pub spread: f32,
    /// The share of the length, from the start, within which the surface follows the joint above
    /// that of `a`: the top of a shoulder does not turn with the arm.
    pub held: f32,
}

/// The usual [`Shape::spread`].
const SPREAD: f32 = 0.7;

impl Shape {
    fn round(a: Anchor, radius_a: f32, b: Anchor, radius_b: f32) -> Self {
        Self {
            a,
            b,
            radius_a,
            radius_b,
            flat: Vec3::ZERO,
            flatness: 1.0,
            shell: 0,
            soft: false,
            spread: SPREAD,
            held: 0.0,
        }
    }

    fn flattened(self, flat: Vec3, flatness: f32) -> Self {
        Self { flat, flatness, ..self }
    }

    /// Converts a shape that was made on `stance` with axes of the world into the axes that the
    /// joints have there.
    #[must_use]
    pub fn in_axes_of(self, stance: &WorldPose) -> Self {
        let own =
            |joint: usize| stance.rotations.get(joint).copied().unwrap_or_default().conjugate();
        let moved = |anchor: Anchor| Anchor { point: own(anchor.joint) * anchor.point, ..anchor };
        Self { a: moved(self.a), b: moved(self.b), flat: own(self.a.joint) * self.flat, ..self }
    }

    /// Returns the shape in a pose, or `None` if the pose lacks its joints or holds numbers that
    /// are not finite.
    #[must_use]
    #[expect(
        clippy::inline_always,
        reason = "posing the limbs of a crowd takes a tenth longer with a call for each"
    )]
    #[inline(always)]
    pub fn placed(&self, pose: &WorldPose) -> Option<PlacedShape> {
        let at = |anchor: Anchor| {
            Some(
                *pose.positions.get(anchor.joint)?
                    + *pose.rotations.get(anchor.joint)? * anchor.point,
            )
        };
        let (a, b) = (at(self.a)?, at(self.b)?);
        let flat = *pose.rotations.get(self.a.joint)? * self.flat;
        (a.is_finite() && b.is_finite()).then_some(PlacedShape {
            a,
            b,
            radius_a: self.radius_a,
            radius_b: self.radius_b,
            flat,
            flatness: self.flatness,
        })
    }

    /// Returns a measure of how much of its surroundings the shape can hide, m².
    #[must_use]
    pub fn weight(&self, rest: &[Vec3]) -> f32 {
        let at =
            |anchor: Anchor| rest.get(anchor.joint).map_or(anchor.point, |&p| p + anchor.point);
        let radius = self.radius_a.max(self.radius_b);
        radius * (radius + at(self.a).distance(at(self.b)))
    }
}

/// Returns a ball of a radius, metres, at each of these joints.
#[must_use]
pub fn ball_shapes(joints: Range<usize>, radius: f32) -> Vec<Shape> {
    let centre = |joint: usize| Anchor { joint, point: Vec3::ZERO };
    joints.map(|joint| Shape::round(centre(joint), radius, centre(joint), radius)).collect()
}

/// Returns the shapes of a skeleton whose joints rest at `rest` (metres, the root at the origin):
/// those of a mannequin where the roles are those of a person, otherwise one per bone, and a head.
/// All of their numbers are finite.
#[must_use]
pub fn limb_shapes(skeleton: &Skeleton, rest: &[Vec3], roles: Option<&Roles>) -> Vec<Shape> {
    let mut shapes = roles
        .and_then(|roles| human::shapes(skeleton, rest, roles))
        .unwrap_or_else(|| bones::shapes(skeleton, rest, roles));
    shapes.retain(|s| {
        s.radius_a.is_finite()
            && s.radius_b.is_finite()
            && s.a.point.is_finite()
            && s.b.point.is_finite()
    });
    shapes
}
