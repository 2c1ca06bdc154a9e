//! A body for any tree: one tapered limb per bone, a head, and a ball where the bones meet.

use super::{Anchor, Shape};
use crate::skeleton::{Role, Roles, Skeleton};
use glam::Vec3;

/// The power by which girth grows with the length of all bones below a bone (1/2 would preserve the
/// cross-section areas of a forking tree).
const GIRTH_POWER: f32 = 0.6;
/// Radius of a bone with the whole skeleton below it, per metre of the skeleton's total length.
const GIRTH: f32 = 0.04;
/// The greatest total length that counts, in lengths of the longest path from the root: eight legs
/// do not make each of them thicker.
const MAX_TOTAL: f32 = 3.5;
/// The greatest radius of a bone as a share of its length, so that short bones do not become balls,
/// and as a share of the length of all bones below it, so that a back of many short bones does not
/// become thin.
const MAX_RADIUS_SHARES: (f32, f32) = (0.42, 0.11);
/// The least radius of the end of a limb as a share of the radius where its last bone begins: paws
/// and hooves are no points.
const MIN_TIP: f32 = 0.7;
/// The radius of the back of the head, and of its front, in radii of the neck.
const HEAD: (f32, f32) = (1.3, 0.75);

/// The lengths of bones, metres.
struct Lengths {
    /// The length of all bones below each joint.
    below: Vec<f32>,
    /// The length of all bones, as far as it counts.
    total: f32,
}

impl Lengths {
    fn of(skeleton: &Skeleton) -> Self {
        let joints = skeleton.joints();
        let mut below: Vec<f32> =
            joints.iter().map(|j| j.end_site.map_or(0.0, Vec3::length)).collect();
        let mut deepest = below.clone();
        for index in (1..joints.len()).rev() {
            if let Some(parent) = joints[index].parent {
                let length = joints[index].offset.length();
                below[parent] += below[index] + length;
                deepest[parent] = deepest[parent].max(deepest[index] + length);
            }
        }
        let total = below[0].min(MAX_TOTAL * deepest[0]);
        Self { below, total }
    }

    /// Returns the radius of a bone of a length with `below` metres of bones from its start on.
    fn radius(&self, below: f32, length: f32) -> f32 {
        let (of_bone, of_limb) = MAX_RADIUS_SHARES;
        let limit = (of_bone * length).max(of_limb * below);
        (GIRTH * libm::powf(self.total, 1.0 - GIRTH_POWER) * libm::powf(below, GIRTH_POWER))
            .min(limit)
    }
}

/// Returns one shape per bone that has a length, and those of the trunk and the head.
pub(super) fn shapes(skeleton: &Skeleton, rest: &[Vec3], roles: Option<&Roles>) -> Vec<Shape> {
    let joints = skeleton.joints();
    let lengths = Lengths::of(skeleton);
    let total = lengths.total;
    let zero = |joint| Anchor { joint, point: Vec3::ZERO };
    let mut shapes = Vec::with_capacity(joints.len() + 2);
    if !(total.is_finite() && total > 0.0) {
        // A single point, or joints at one position: a ball of 5 cm makes them visible.
        shapes.push(Shape::round(zero(0), 0.05, zero(0), 0.05));
        return shapes;
    }
    let shortest = total * 1e-3;
    let head = roles.and_then(|roles| roles.get_within(Role::Head, joints.len()));
    for (index, joint) in joints.iter().enumerate() {
        let below = lengths.below[index];
        let length = joint.offset.length();
        if let Some(parent) = joint.parent.filter(|_| length > shortest) {
            let thick = lengths.radius(below + length, length);
            let thin = lengths.radius(below + 0.25 * length, length);
            let is_last = below < shortest;
            let thin = if is_last { thin.max(MIN_TIP * thick) } else { thin };
            shapes.push(Shape::round(zero(parent), thick, zero(index), thin));
        }
        if let Some(end) = joint.end_site.filter(|end| end.length() > shortest) {
            let thick = lengths.radius(end.length(), end.length());
            let tip = Anchor { joint: index, point: end };
            shapes.push(Shape::round(zero(index), thick, tip, MIN_TIP * thick));
        }
    }
    if let Some(head) = head.filter(|&head| head > 0) {
        shapes.extend(head_shape(skeleton, rest, &lengths, head));
    }
    // A trunk: everything is below the root, also where its bones are short.
    let nearest =
        skeleton.children(0).map(|child| rest[child].length()).fold(f32::INFINITY, f32::min);
    if nearest.is_finite() {
        let thick = lengths.radius(total * 0.6, total).min(nearest.max(shortest) * 1.5);
        shapes.push(Shape::round(zero(0), thick, zero(0), thick));
    }
    shapes
}

/// Returns the head, from its joint to the farthest end of the bones below it; `None` where the
/// joint has neither an end nor children.
fn head_shape(skeleton: &Skeleton, rest: &[Vec3], lengths: &Lengths, head: usize) -> Option<Shape> {
    let joint = skeleton.joints().get(head)?;
    let children = skeleton.children(head).map(|child| rest[child] - rest[head]);
    let front = children
        .chain(joint.end_site)
        .max_by(|x, y| x.length_squared().total_cmp(&y.length_squared()))?;
    let neck = joint.offset.length();
    let radius = lengths.radius(lengths.below[head] + neck, neck + front.length());
    let radius = radius.min(front.length());
    let (back, snout) = HEAD;
    Some(Shape::round(
        Anchor { joint: head, point: front * 0.15 },
        radius * back,
        Anchor { joint: head, point: front * 0.85 },
        radius * snout,
    ))
}
