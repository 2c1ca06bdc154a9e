//! A smooth body around any skeleton: its shapes, one surface around those that may flow into each other, and weights along the tree.

use super::capsules::capsules;
use super::contour::contour;
use super::field::{Cone, Field};
use super::shapes::{Placed, Shape, shapes};
use super::weights::{Neighbours, fair, normals, shared};
use super::{SkinnedMesh, bind};
use crate::skeleton::{Role, Roles, Side, Skeleton, WorldPose};
use std::collections::BTreeMap;

/// Cells of the surface are at most this large, as a share of what is thin there.
const CELL_SHARE: f32 = 0.5;
/// And at most this large, as a share of the body's height: 1.9 cm on an adult.
const LARGEST_CELL: f32 = 0.0108;
/// Vertices of the whole mesh, about; cells become larger where it would be more.
const MOST_VERTICES: f32 = 14_000.0;
/// Skeletons of more shapes get one surface for each.
const MOST_BLENDED: usize = 400;
/// Of even more, only the largest are shown.
const MOST_SHAPES: usize = 4000;
/// A joint and its ancestor this many steps above are near enough in the tree to flow into each other.
const NEAR_STEPS: usize = 2;

pub(super) fn around(skeleton: &Skeleton, roles: &Roles, girth: f32) -> SkinnedMesh {
    let pose = bind::bind_pose(skeleton, roles);
    let rest = skeleton.rest_positions();
    let mut shapes = shapes(skeleton, &rest, Some(roles));
    shapes.retain(|shape| u16::try_from(shape.a.joint.max(shape.b.joint)).is_ok());
    let girths = girths(skeleton, roles, girth);
    for shape in &mut shapes {
        shape.radius_a *= girths[shape.a.joint];
        shape.radius_b *= girths[shape.b.joint];
    }
    let mut mesh = if shapes.len() > MOST_BLENDED {
        shapes.retain(|shape| !shape.soft);
        shapes.sort_by(|x, y| y.weight(&rest).total_cmp(&x.weight(&rest)));
        shapes.truncate(MOST_SHAPES);
        capsules(&shapes, &pose)
    } else {
        blended(skeleton, roles, &shapes, &pose)
    };
    mesh.bind = bind::joint_from_bind(&pose);
    mesh
}

/// By how much the radii at each joint are multiplied: a stout body has a stout trunk, but not as much larger a head, hands and feet.
fn girths(skeleton: &Skeleton, roles: &Roles, girth: f32) -> Vec<f32> {
    let power = |joint: usize| {
        let role = roles.role_of(joint)?;
        let is = |of: fn(Side) -> Role| Side::BOTH.into_iter().any(|side| of(side) == role);
        Some(match role {
            Role::Head => 0.15,
            _ if is(Role::foot) || is(Role::toe) => 0.0,
            _ if is(Role::hand) => 0.15,
            _ if is(Role::shin) || is(Role::forearm) => 0.6,
            _ if is(Role::thigh) || is(Role::upper_arm) => 0.8,
            _ => 1.0,
        })
    };
    let mut powers: Vec<f32> = Vec::with_capacity(skeleton.len());
    for joint in 0..skeleton.len() {
        let above = skeleton.parent(joint).map_or(1.0, |parent| powers[parent]);
        powers.push(power(joint).unwrap_or(above));
    }
    powers.into_iter().map(|power| girth.powf(power)).collect()
}

/// Surfaces around the shapes: one for those that may flow into each other, and one for each shell that must not.
fn blended(skeleton: &Skeleton, roles: &Roles, shapes: &[Shape], pose: &WorldPose) -> SkinnedMesh {
    let placed: Vec<(&Shape, Placed)> = shapes.iter().filter_map(|shape| Some((shape, shape.placed(pose)?))).collect();
    let cones: Vec<Cone> = placed.iter().map(|(_, placed)| Cone::new(placed)).collect();
    let paths: Vec<Vec<(f32, usize)>> = placed.iter().map(|(shape, placed)| path(skeleton, shape, placed, pose)).collect();
    let largest = LARGEST_CELL * roles.body_height(skeleton);
    // Cells are halved and halved again, so sizes are rounded to that.
    let size = |cone: &Cone| largest * (CELL_SHARE * cone.thinness() / largest).clamp(0.2, 1.0).log2().round().exp2();
    let sizes: Vec<f32> = cones.iter().map(size).collect();
    // A surface passes through about 1.5 cells for each square of a cell's size.
    let vertices: f32 = cones.iter().zip(&sizes).map(|(cone, size)| 0.8 * cone.area() / (size * size)).sum();
    let coarser = (vertices / MOST_VERTICES).max(1.0).sqrt();
    let mut shells: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for (index, (shape, _)) in placed.iter().enumerate() {
        shells.entry(shape.shell).or_default().push(index);
    }
    let mut mesh = SkinnedMesh::default();
    for members in shells.values() {
        let are_neighbours = |i: usize, j: usize| are_near(skeleton, &paths[members[i]], &paths[members[j]]);
        let field = Field::new(members.iter().map(|&index| cones[index]).collect(), are_neighbours);
        let sizes: Vec<f32> = members.iter().map(|&index| sizes[index] * coarser).collect();
        let mut surface = contour(&field, &sizes);
        let neighbours = Neighbours::of(surface.positions.len(), &surface.triangles);
        fair(&mut surface.positions, &neighbours, 8);
        let first: Vec<u16> = (surface.owners.iter())
            .map(|&(shape, share)| joint_at(&paths[members[shape]], share) as u16)
            .collect();
        let (joints, weights) = shared(&first, &neighbours);
        let before = mesh.positions.len() as u32;
        mesh.normals.extend(normals(&surface.positions, &surface.triangles));
        mesh.positions.extend(surface.positions);
        mesh.joints.extend(joints);
        mesh.weights.extend(weights);
        mesh.triangles
            .extend(surface.triangles.iter().map(|triangle| triangle.map(|corner| corner + before)));
    }
    mesh
}

/// The joints along a shape, each from where on (0 at its start to 1 at its end) it moves what lies there.
fn path(skeleton: &Skeleton, shape: &Shape, placed: &Placed, pose: &WorldPose) -> Vec<(f32, usize)> {
    let above = |joint: usize| std::iter::successors(Some(joint), |&joint| skeleton.parent(joint));
    let (start, end) = (shape.a.joint, shape.b.joint);
    let mut joints: Vec<usize> = above(start).collect();
    let shared = above(end).find(|joint| joints.contains(joint));
    joints.truncate(joints.iter().position(|joint| Some(*joint) == shared).map_or(1, |place| place + 1));
    let mut down: Vec<usize> = above(end).take_while(|joint| Some(*joint) != shared).collect();
    down.reverse();
    joints.extend(down);
    let along = placed.b - placed.a;
    let mut from = 0.0f32;
    let steps = joints.into_iter().enumerate().map(|(step, joint)| {
        if step > 0 {
            let share = (pose.positions[joint] - placed.a).dot(along) / along.length_squared().max(1e-12);
            from = from.max(share.clamp(0.0, 1.0));
        }
        (from, joint)
    });
    steps.collect()
}

fn joint_at(path: &[(f32, usize)], share: f32) -> usize {
    // What lies at the very end belongs to the bone that leads there.
    path.iter()
        .take_while(|(from, _)| *from <= share && *from < 1.0)
        .last()
        .or(path.first())
        .map_or(0, |(_, joint)| *joint)
}

/// Whether two shapes lie on one way along the tree: joints of theirs are one, or the one is a little above the other.
fn are_near(skeleton: &Skeleton, one: &[(f32, usize)], other: &[(f32, usize)]) -> bool {
    let is_above = |above: usize, below: usize| {
        std::iter::successors(Some(below), |&joint| skeleton.parent(joint))
            .take(NEAR_STEPS + 1)
            .any(|joint| joint == above)
    };
    one.iter()
        .any(|&(_, i)| other.iter().any(|&(_, j)| is_above(i, j) || is_above(j, i)))
}
