//! A body of tapered limbs, one per shape of [`crate::skin::shapes`]: posed in microseconds, whatever the skeleton.

#[cfg(test)]
mod tests;

use super::{Color, Limb};
use crate::skeleton::{Roles, Skeleton, WorldPose};
use crate::skin::shapes::{Placed, Shape, shapes};

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
        let mut shapes = shapes(skeleton, &rest, roles);
        shapes.retain(|shape| !shape.soft);
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
        for shape in &self.shapes {
            let Some(Placed {
                a,
                b,
                radius_a,
                radius_b,
                flat,
                flatness,
            }) = shape.placed(pose)
            else {
                continue;
            };
            out.push(Limb {
                a,
                b,
                radius_a,
                radius_b,
                flat,
                flatness,
                color: color_of(shape.a.joint),
            });
        }
    }
}
