//! A smooth body around any skeleton: its shapes, one surface around those that may blend with each
//! other, and weights along the tree. It is built in slices.

use super::capsules::capsules;
use super::contour::{Contour, Contouring};
use super::field::{Cone, Field};
use super::placed_shape::PlacedShape;
use super::shapes::{Shape, limb_shapes};
use super::weights::{Neighbours, WeightDiffusion, drawn_together, fair, normals, rates};
use super::{SkinnedMesh, bind, sheets};
use crate::math::sort::sort_by;
use crate::skeleton::{Role, Roles, Side, Skeleton, WorldPose, canonical_stance};
use glam::Vec3;
use std::collections::BTreeMap;

/// The greatest size of a cell of the surface, as a share of the thinnest part there.
const MAX_CELL_SHARE: f32 = 0.5;
/// The greatest size of a cell, as a share of the body's height: 1.9 cm on an adult.
const MAX_CELL: f32 = 0.0108;
/// The approximate greatest number of vertices of the whole mesh; cells become larger where there
/// would be more.
const MAX_VERTICES: f32 = 14_000.0;
/// Skeletons with more shapes than this get one surface for each shape.
const MAX_BLENDED: usize = 400;
/// The greatest number of shapes; of more, only the largest are used.
const MAX_SHAPES: usize = 4000;
/// The greatest number of steps between a joint and its ancestor whose shapes may blend with each
/// other.
const MAX_NEAR_STEPS: usize = 2;
/// Number of cells of a contour that are processed in one slice.
const CELLS_AT_ONCE: usize = 400;
/// Number of smoothing passes over the surface.
const FAIRING_ROUNDS: usize = 8;
/// Number of smoothing passes over the vertices' distances from the axes of their limbs.
const REACH_ROUNDS: usize = 8;

/// The construction of a skeleton's body in slices: each call of [`SkinBuilder::advance`] does a
/// part of it.
#[derive(Clone, Debug)]
pub struct SkinBuilder {
    pose: WorldPose,
    /// The power of the girth by which the vertices of each joint grow.
    powers: Vec<f32>,
    /// The joints along each shape: see [`path`].
    paths: Vec<Vec<(f32, usize)>>,
    /// How far weights reach along each shape: [`Shape::spread`].
    spreads: Vec<f32>,
    /// The remaining shells, the next one last.
    shells: Vec<Shell>,
    done: ProceduralSkin,
}

/// A body whose girth can be changed at once.
///
/// A mesh for the girth 1, and the displacement of its vertices for another girth: away from the
/// axis of the limb on which they lie.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ProceduralSkin {
    mesh: SkinnedMesh,
    /// The vector from the axis of its limb to each vertex, metres, smooth over the surface.
    reach: Vec<Vec3>,
    /// The power of the girth by which each vertex grows.
    powers: Vec<f32>,
}

/// A surface around shapes that may blend with each other.
#[derive(Clone, Debug)]
struct Shell {
    members: Vec<usize>,
    cones: Vec<Cone>,
    stage: Stage,
}

#[derive(Clone, Debug)]
enum Stage {
    Contouring(Box<Contouring>),
    Separating(Contour, Neighbours),
    Smoothing(Contour, Neighbours, usize),
    WeightDiffusion(Contour, Neighbours, WeightDiffusion),
}

impl SkinBuilder {
    /// Begins the body of a skeleton: a mannequin of human proportions where the roles are those of
    /// a person on two legs, otherwise limbs along the bones. It is built on the skeleton's
    /// [`canonical_stance`]; `reference` is a pose that shows the directions of its bones
    /// ([`crate::clip::reference_pose`]). The joints of the mesh are those of the skeleton (at most
    /// the first 65,536).
    #[must_use]
    pub fn new(skeleton: &Skeleton, roles: &Roles, reference: &WorldPose) -> Self {
        let stance = canonical_stance(skeleton, roles, reference);
        let standing = &skeleton.resting_in(&stance);
        let rest = standing.rest_positions();
        let mut shapes = limb_shapes(standing, &rest, Some(roles));
        shapes.retain(|shape| u16::try_from(shape.a.joint.max(shape.b.joint)).is_ok());
        let mut skin_builder = Self {
            powers: powers(standing, roles),
            paths: Vec::new(),
            spreads: Vec::new(),
            shells: Vec::new(),
            done: ProceduralSkin::default(),
            pose: bind::bind_pose(standing, roles, &stance),
        };
        let is_blended = shapes.len() <= MAX_BLENDED;
        if !is_blended {
            shapes.retain(|shape| !shape.soft);
            sort_by(&mut shapes, |x, y| y.weight(&rest).total_cmp(&x.weight(&rest)));
            shapes.truncate(MAX_SHAPES);
        }
        let shapes: Vec<Shape> =
            shapes.into_iter().map(|shape| shape.in_axes_of(&stance)).collect();
        if is_blended {
            skin_builder.begin_shells(standing, roles, &shapes);
        } else {
            (skin_builder.done.mesh, skin_builder.done.reach) =
                capsules(&shapes, &skin_builder.pose);
        }
        skin_builder
    }

    /// Begins a field for the shapes that may blend with each other, and one for each shell that
    /// must not.
    fn begin_shells(&mut self, skeleton: &Skeleton, roles: &Roles, shapes: &[Shape]) {
        let placed: Vec<(&Shape, PlacedShape)> =
            (shapes.iter()).filter_map(|shape| Some((shape, shape.placed(&self.pose)?))).collect();
        let cones: Vec<Cone> = placed.iter().map(|(_, placed)| Cone::new(placed)).collect();
        self.paths = (placed.iter())
            .map(|(shape, placed)| path(skeleton, shape, placed, &self.pose))
            .collect();
        self.spreads = placed.iter().map(|(shape, _)| shape.spread).collect();
        let largest = MAX_CELL * roles.body_height(skeleton);
        // Cells are halved repeatedly, so sizes are rounded accordingly.
        let size = |cone: &Cone| {
            largest
                * libm::exp2f(
                    libm::log2f((MAX_CELL_SHARE * cone.thinness() / largest).clamp(0.2, 1.0))
                        .round(),
                )
        };
        let sizes: Vec<f32> = cones.iter().map(size).collect();
        // A surface passes through about 1.5 cells for each square of the size of a cell.
        let vertices: f32 =
            cones.iter().zip(&sizes).map(|(cone, size)| 0.8 * cone.area() / (size * size)).sum();
        let coarser = (vertices / MAX_VERTICES).max(1.0).sqrt();
        let mut shells: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for (index, (shape, _)) in placed.iter().enumerate() {
            shells.entry(shape.shell).or_default().push(index);
        }
        for members in shells.into_values().rev() {
            let are_neighbours = |i: usize, j: usize| {
                are_near(skeleton, &self.paths[members[i]], &self.paths[members[j]])
            };
            let own: Vec<Cone> = members.iter().map(|&index| cones[index]).collect();
            let field = Field::new(own.clone(), are_neighbours);
            let sizes = members.iter().map(|&index| sizes[index] * coarser).collect();
            self.shells.push(Shell {
                members,
                cones: own,
                stage: Stage::Contouring(Box::new(Contouring::new(field, sizes))),
            });
        }
    }

    /// Processes one slice of a millisecond, or two in a browser. Returns the body once it is
    /// complete; after that an empty one.
    pub fn advance(&mut self) -> Option<ProceduralSkin> {
        let Some(Shell { members, cones, stage }) = self.shells.last_mut() else {
            return Some(self.finished());
        };
        match stage {
            Stage::Contouring(contouring) => {
                if let Some(surface) = contouring.advance(CELLS_AT_ONCE) {
                    let neighbours = Neighbours::of(surface.positions.len(), &surface.triangles);
                    *stage = Stage::Separating(surface, neighbours);
                }
            }
            Stage::Separating(surface, neighbours) => {
                if sheets::separate(surface, neighbours) {
                    *neighbours = Neighbours::of(surface.positions.len(), &surface.triangles);
                }
                *stage = Stage::Smoothing(std::mem::take(surface), std::mem::take(neighbours), 0);
            }
            Stage::Smoothing(surface, neighbours, rounds) => {
                fair(&mut surface.positions, neighbours);
                *rounds += 1;
                if *rounds >= FAIRING_ROUNDS {
                    let first = (surface.owners.iter())
                        .map(|&(shape, share)| joint_at(&self.paths[members[shape]], share) as u16);
                    let spreads = surface.owners.iter().map(|&(shape, share)| {
                        let place = members[shape];
                        self.spreads[place] * cones[shape].radius(share)
                    });
                    let rates = rates(&surface.positions, neighbours, spreads);
                    let sharing = WeightDiffusion::new(first, rates);
                    *stage = Stage::WeightDiffusion(
                        std::mem::take(surface),
                        std::mem::take(neighbours),
                        sharing,
                    );
                }
            }
            Stage::WeightDiffusion(surface, neighbours, sharing) => {
                if sharing.advance(neighbours) {
                    self.done.add(surface, neighbours, sharing, cones, &self.powers);
                    self.shells.pop();
                }
            }
        }
        None
    }

    fn finished(&mut self) -> ProceduralSkin {
        let mut done = std::mem::take(&mut self.done);
        done.mesh.bind = bind::joint_from_bind(&self.pose);
        if done.powers.len() < done.mesh.joints.len() {
            // Plain capsules, of which each vertex follows one joint.
            let power_of =
                |joints: &[u16; 4]| self.powers.get(usize::from(joints[0])).copied().unwrap_or(1.0);
            done.powers = done.mesh.joints.iter().map(power_of).collect();
        }
        done
    }
}

impl ProceduralSkin {
    /// Adds a finished surface.
    fn add(
        &mut self,
        surface: &Contour,
        neighbours: &Neighbours,
        sharing: &WeightDiffusion,
        cones: &[Cone],
        powers: &[f32],
    ) {
        let before = self.mesh.positions.len() as u32;
        let axis_of = |&(shape, share): &(usize, f32)| cones.get(shape).map(|cone| cone.at(share));
        let mut reach: Vec<Vec3> = (surface.positions.iter().zip(&surface.owners))
            .map(|(position, owner)| axis_of(owner).map_or(Vec3::ZERO, |axis| *position - axis))
            .collect();
        // The axis changes abruptly where one limb ends and another begins; the skin must not tear
        // there.
        for _ in 0..REACH_ROUNDS {
            reach = drawn_together(&reach, neighbours, 0.5);
        }
        for (joints, weights) in sharing.shares() {
            let power = joints
                .iter()
                .zip(weights)
                .map(|(joint, weight)| powers[usize::from(*joint)] * weight);
            self.powers.push(power.sum());
            self.mesh.joints.push(joints);
            self.mesh.weights.push(weights);
        }
        self.reach.extend(reach);
        self.mesh.normals.extend(normals(&surface.positions, &surface.triangles));
        self.mesh.positions.extend(&surface.positions);
        let corners =
            surface.triangles.iter().map(|triangle| triangle.map(|corner| corner + before));
        self.mesh.triangles.extend(corners);
    }

    /// Returns the mesh of a body with this girth relative to an average adult, 0.4 to 2.5 (1 is
    /// average, and is used for NaN): the trunk is wider by this factor, arms and legs by less,
    /// head, hands and feet hardly.
    #[must_use]
    pub fn with_girth(&self, girth: f32) -> SkinnedMesh {
        let girth = if girth.is_nan() { 1.0 } else { girth.clamp(0.4, 2.5) };
        let mut mesh = self.mesh.clone();
        if girth == 1.0 {
            return mesh;
        }
        for ((position, reach), power) in
            mesh.positions.iter_mut().zip(&self.reach).zip(&self.powers)
        {
            *position += *reach * (libm::powf(girth, *power) - 1.0);
        }
        mesh.normals = normals(&mesh.positions, &mesh.triangles);
        mesh
    }
}

/// Returns the power of the girth by which the radii at each joint grow: a stout body has a stout
/// trunk, but head, hands and feet of nearly the usual size.
fn powers(skeleton: &Skeleton, roles: &Roles) -> Vec<f32> {
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
    powers
}

/// Returns the joints along a shape, each with the position on the axis (0 at its start to 1 at its
/// end) from which on it moves the surface.
fn path(
    skeleton: &Skeleton,
    shape: &Shape,
    placed: &PlacedShape,
    pose: &WorldPose,
) -> Vec<(f32, usize)> {
    let above = |joint: usize| std::iter::successors(Some(joint), |&joint| skeleton.parent(joint));
    let (start, end) = (shape.a.joint, shape.b.joint);
    let mut joints: Vec<usize> = above(start).collect();
    let shared = above(end).find(|joint| joints.contains(joint));
    joints.truncate(
        joints.iter().position(|joint| Some(*joint) == shared).map_or(1, |place| place + 1),
    );
    let mut down: Vec<usize> = above(end).take_while(|joint| Some(*joint) != shared).collect();
    down.reverse();
    joints.extend(down);
    let along = placed.b - placed.a;
    let mut from = 0.0f32;
    let steps = joints.into_iter().enumerate().map(|(step, joint)| {
        if step > 0 {
            let share =
                (pose.positions[joint] - placed.a).dot(along) / along.length_squared().max(1e-12);
            from = from.max(share.clamp(0.0, 1.0));
        }
        (from, joint)
    });
    let mut path: Vec<(f32, usize)> = steps.collect();
    if shape.held > 0.0
        && let Some(parent) = skeleton.parent(start)
    {
        for (from, _) in &mut path {
            *from = from.max(shape.held);
        }
        path.insert(0, (0.0, parent));
    }
    path
}

fn joint_at(path: &[(f32, usize)], share: f32) -> usize {
    // The very end belongs to the bone that leads there.
    path.iter()
        .take_while(|(from, _)| *from <= share && *from < 1.0)
        .last()
        .or(path.first())
        .map_or(0, |(_, joint)| *joint)
}

/// Returns whether two shapes are on one path along the tree: they have a joint in common, or a
/// joint of one is a little above a joint of the other.
fn are_near(skeleton: &Skeleton, one: &[(f32, usize)], other: &[(f32, usize)]) -> bool {
    let is_above = |above: usize, below: usize| {
        std::iter::successors(Some(below), |&joint| skeleton.parent(joint))
            .take(MAX_NEAR_STEPS + 1)
            .any(|joint| joint == above)
    };
    one.iter().any(|&(_, i)| other.iter().any(|&(_, j)| is_above(i, j) || is_above(j, i)))
}
