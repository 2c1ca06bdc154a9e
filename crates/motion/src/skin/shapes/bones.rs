//! A body for any tree: one tapered limb per bone.

use super::{Anchor, Shape};
use crate::skeleton::Skeleton;
use glam::Vec3;

/// The power by which girth grows with the length of all bones below a bone (1/2 would preserve the
/// cross-section areas of a forking tree).
const GIRTH_POWER: f32 = 0.6;
/// Radius of a bone with the whole skeleton below it, per metre of the skeleton's total length.
const GIRTH: f32 = 0.04;
/// The greatest radius of a bone as a share of its length, so that short bones do not become balls.
const MAX_RADIUS_SHARE: f32 = 0.42;

/// Returns the radius of a bone with `below` metres of bones below it, in a skeleton of `total`
/// metres.
fn radius(below: f32, total: f32) -> f32 {
    GIRTH * total.powf(1.0 - GIRTH_POWER) * below.powf(GIRTH_POWER)
}

/// Returns one shape per bone that has a length.
pub(super) fn shapes(skeleton: &Skeleton, rest: &[Vec3]) -> Vec<Shape> {
    let joints = skeleton.joints();
    // The length of all bones below each joint.
    let mut below: Vec<f32> = joints.iter().map(|j| j.end_site.map_or(0.0, Vec3::length)).collect();
    for index in (1..joints.len()).rev() {
        if let Some(parent) = joints[index].parent {
            below[parent] += below[index] + joints[index].offset.length();
        }
    }
    let total = below[0];
    let mut shapes = Vec::with_capacity(joints.len());
    if !(total.is_finite() && total > 0.0) {
        // A single point, or joints at one position: a ball of 5 cm makes them visible.
        let root = Anchor { joint: 0, point: Vec3::ZERO };
        shapes.push(Shape::round(root, 0.05, root, 0.05));
        return shapes;
    }
    let shortest = total * 1e-3;
    for (index, joint) in joints.iter().enumerate() {
        let here = Anchor { joint: index, point: Vec3::ZERO };
        if let Some(parent) = joint.parent {
            let length = joint.offset.length();
            if length > shortest {
                let limit = length * MAX_RADIUS_SHARE;
                let thick = radius(below[index] + length, total).min(limit);
                let thin = radius(below[index] + 0.25 * length, total).min(limit);
                shapes.push(Shape::round(
                    Anchor { joint: parent, point: Vec3::ZERO },
                    thick,
                    here,
                    thin,
                ));
            }
        }
        if let Some(end) = joint.end_site {
            let length = end.length();
            if length > shortest {
                let limit = length * MAX_RADIUS_SHARE;
                let tip = Anchor { joint: index, point: end };
                shapes.push(Shape::round(
                    here,
                    radius(length, total).min(limit),
                    tip,
                    radius(0.3 * length, total).min(limit),
                ));
            }
        }
    }
    // A trunk: everything is below the root, also where its bones are short.
    let root = Anchor { joint: 0, point: Vec3::ZERO };
    let nearest =
        skeleton.children(0).map(|child| rest[child].length()).fold(f32::INFINITY, f32::min);
    if nearest.is_finite() {
        let thick = radius(total * 0.6, total).min(nearest.max(shortest) * 1.5);
        shapes.push(Shape::round(root, thick, root, thick));
    }
    shapes
}
