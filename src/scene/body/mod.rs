//! What a skeleton looks like: tapered limbs from nothing but its bones.

mod bones;
mod human;
#[cfg(test)]
mod tests;

use super::{Color, Limb};
use crate::skeleton::{Roles, Skeleton, WorldPose};
use glam::Vec3;

/// A point that moves with a joint.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Anchor {
    joint: usize,
    /// In the joint's frame, metres.
    point: Vec3,
}

/// A [`Limb`] before it is posed.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Shape {
    a: Anchor,
    b: Anchor,
    radius_a: f32,
    radius_b: f32,
    /// In the frame of the joint of `a`; zero where the shape is round.
    flat: Vec3,
    flatness: f32,
}

impl Shape {
    fn round(a: Anchor, radius_a: f32, b: Anchor, radius_b: f32) -> Self {
        Self {
            a,
            b,
            radius_a,
            radius_b,
            flat: Vec3::ZERO,
            flatness: 1.0,
        }
    }

    fn flattened(self, flat: Vec3, flatness: f32) -> Self {
        Self { flat, flatness, ..self }
    }

    /// Grows with how much of its surroundings the shape can hide.
    fn weight(&self, rest: &[Vec3]) -> f32 {
        let at = |anchor: Anchor| rest.get(anchor.joint).map_or(anchor.point, |&p| p + anchor.point);
        let radius = self.radius_a.max(self.radius_b);
        radius * (radius + at(self.a).distance(at(self.b)))
    }
}

/// Where two limbs meet in the same ball, the second one's becomes a little smaller, lest both surfaces flicker through each other.
fn set_balls_apart(shapes: &mut [Shape]) {
    for index in 1..shapes.len() {
        let (before, rest) = shapes.split_at_mut(index);
        let Some(shape) = rest.first_mut() else { continue };
        if before.iter().any(|other| other.b == shape.a && other.radius_b == shape.radius_a) {
            shape.radius_a *= 0.985;
        }
    }
}

/// The shapes of one skeleton's body, made once and posed every frame.
///
/// With the roles of a human it becomes a mannequin of human proportions (segment lengths are the skeleton's own; girths follow the body
/// height). Any other tree gets one tapered limb per bone, each as thick as what hangs on it asks for.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Body {
    shapes: Vec<Shape>,
}

impl Body {
    /// Makes the body of a skeleton. `roles` may be missing or belong to another skeleton: the body is then plainer.
    #[must_use]
    pub fn new(skeleton: &Skeleton, roles: Option<&Roles>) -> Self {
        let rest = skeleton.rest_positions();
        let mut shapes = roles
            .and_then(|roles| human::shapes(skeleton, &rest, roles))
            .unwrap_or_else(|| bones::shapes(skeleton, &rest));
        shapes.retain(|s| s.radius_a.is_finite() && s.radius_b.is_finite() && s.a.point.is_finite() && s.b.point.is_finite());
        set_balls_apart(&mut shapes);
        // The renderer lets only the first few of a body shade the others: the big ones come first.
        shapes.sort_by(|x, y| y.weight(&rest).total_cmp(&x.weight(&rest)));
        Self { shapes }
    }

    /// The number of limbs that [`Body::limbs`] adds at most.
    #[must_use]
    pub fn limb_count(&self) -> usize {
        self.shapes.len()
    }

    /// Appends the limbs of the body in a pose. Joints that the pose does not have are left out.
    pub fn limbs(&self, pose: &WorldPose, color: Color, out: &mut Vec<Limb>) {
        self.colored_limbs(pose, |_| color, out);
    }

    /// Likewise, each limb in the colour of the joint that moves it.
    pub fn colored_limbs(&self, pose: &WorldPose, color_of: impl Fn(usize) -> Color, out: &mut Vec<Limb>) {
        out.reserve(self.shapes.len());
        let at = |anchor: Anchor| Some(*pose.positions.get(anchor.joint)? + *pose.rotations.get(anchor.joint)? * anchor.point);
        for shape in &self.shapes {
            let (Some(a), Some(b)) = (at(shape.a), at(shape.b)) else { continue };
            if !(a.is_finite() && b.is_finite()) {
                continue;
            }
            let flat = pose
                .rotations
                .get(shape.a.joint)
                .map_or(Vec3::ZERO, |&rotation| rotation * shape.flat);
            let (radius_a, radius_b) = (shape.radius_a, shape.radius_b);
            out.push(Limb {
                a,
                b,
                radius_a,
                radius_b,
                flat,
                flatness: shape.flatness,
                color: color_of(shape.a.joint),
            });
        }
    }
}
