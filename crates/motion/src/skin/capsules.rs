//! One closed surface per shape, for skeletons with too many bones for a common surface.

use super::SkinnedMesh;
use super::shapes::Shape;
use crate::skeleton::WorldPose;
use glam::Vec3;
use std::f32::consts::{FRAC_PI_2, TAU};

/// Number of vertices around a shape.
const SIDES: u32 = 8;
/// Number of rings of vertices over each end, without the pole.
const RINGS: u32 = 2;

/// Returns a rounded cone for each shape in the bind pose, whose ends follow the joints of their
/// anchors, and the vector from the shape's axis to each vertex.
pub(super) fn capsules(shapes: &[Shape], bind: &WorldPose) -> (SkinnedMesh, Vec<Vec3>) {
    let mut mesh = SkinnedMesh::default();
    let mut reach = Vec::new();
    for shape in shapes {
        let joints = [shape.a.joint, shape.b.joint].map(u16::try_from);
        let (Ok(joint_a), Ok(joint_b), Some(placed)) = (joints[0], joints[1], shape.placed(bind))
        else {
            continue;
        };
        let axis = (placed.b - placed.a).normalize_or(Vec3::Y);
        let flat =
            placed.flat.reject_from_normalized(axis).normalize_or(axis.any_orthonormal_vector());
        let other = axis.cross(flat);
        let first = mesh.positions.len() as u32;
        let mut corner = |center: Vec3, direction: Vec3, radius: f32, joint: u16| {
            let squash = |v: Vec3, by: f32| v + flat * v.dot(flat) * (by - 1.0);
            reach.push(squash(direction, placed.flatness) * radius);
            mesh.positions.push(center + squash(direction, placed.flatness) * radius);
            mesh.normals
                .push(squash(direction, placed.flatness.max(0.05).recip()).normalize_or(direction));
            mesh.joints.push([joint, 0, 0, 0]);
            mesh.weights.push([1.0, 0.0, 0.0, 0.0]);
        };
        // From the pole at `a` to the pole at `b`; the waist of both balls is where their cone
        // touches them.
        let lean = libm::asinf(
            ((placed.radius_a - placed.radius_b) / placed.a.distance(placed.b).max(1e-6))
                .clamp(-0.9, 0.9),
        );
        corner(placed.a, -axis, placed.radius_a, joint_a);
        let up_a =
            (1..=RINGS).map(|ring| -FRAC_PI_2 + (FRAC_PI_2 + lean) * ring as f32 / RINGS as f32);
        let up_b = (0..RINGS).map(|ring| lean + (FRAC_PI_2 - lean) * ring as f32 / RINGS as f32);
        let rings = up_a
            .map(|up| (placed.a, placed.radius_a, joint_a, up))
            .chain(up_b.map(|up| (placed.b, placed.radius_b, joint_b, up)));
        for (center, radius, joint, up) in rings {
            for side in 0..SIDES {
                let (sin, cos) = libm::sincosf(TAU * side as f32 / SIDES as f32);
                corner(
                    center,
                    axis * libm::sinf(up) + (flat * cos + other * sin) * libm::cosf(up),
                    radius,
                    joint,
                );
            }
        }
        corner(placed.b, axis, placed.radius_b, joint_b);
        let last = mesh.positions.len() as u32 - 1;
        for side in 0..SIDES {
            let next = (side + 1) % SIDES;
            let at = |ring: u32, side: u32| first + 1 + ring * SIDES + side;
            mesh.triangles.push([first, at(0, next), at(0, side)]);
            for ring in 0..2 * RINGS - 1 {
                mesh.triangles.push([at(ring, side), at(ring, next), at(ring + 1, next)]);
                mesh.triangles.push([at(ring, side), at(ring + 1, next), at(ring + 1, side)]);
            }
            mesh.triangles.push([at(2 * RINGS - 1, side), at(2 * RINGS - 1, next), last]);
        }
    }
    (mesh, reach)
}
