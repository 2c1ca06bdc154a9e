//! Separation of sheets of a surface that touch each other.
//!
//! Dual contouring has one vertex for each cell, so that two sheets that pass through one cell (the
//! skin of an arm and that of the chest beside it) share vertices, and edges with four triangles.
//! Here each sheet gets vertices of its own.

use super::contour::Contour;
use super::weights::Neighbours;
use crate::math::sort::sort_by;
use glam::Vec3;
use std::collections::HashMap;

/// An edge of a triangle in the direction of its corners.
#[derive(Clone, Copy)]
struct HalfEdge {
    /// The vertices that it joins, the smaller first.
    ends: (u32, u32),
    /// Whether it leads from the smaller vertex to the greater.
    is_upwards: bool,
    /// Three times the triangle, plus the corner from which it leads.
    corner: u32,
}

/// Gives every sheet vertices of its own, so that an edge belongs to two triangles. Returns whether
/// there was anything to do; `neighbours` are then no longer those of the surface.
pub(super) fn separate(contour: &mut Contour, neighbours: &Neighbours) -> bool {
    let mut is_shared = vec![false; contour.positions.len()];
    for vertex in 0..contour.positions.len() {
        let around = neighbours.of_vertex(vertex);
        for (place, &other) in around.iter().enumerate() {
            // An edge of more than two triangles occurs several times in the same direction.
            if around[..place].contains(&other) {
                is_shared[vertex] = true;
                is_shared[other as usize] = true;
            }
        }
    }
    if !is_shared.contains(&true) {
        return false;
    }
    let mut edges: Vec<HalfEdge> = Vec::new();
    for (triangle, corners) in contour.triangles.iter().enumerate() {
        for place in 0..3 {
            let (from, to) = (corners[place], corners[(place + 1) % 3]);
            if is_shared[from as usize] || is_shared[to as usize] {
                edges.push(HalfEdge {
                    ends: (from.min(to), from.max(to)),
                    is_upwards: from < to,
                    corner: (3 * triangle + place) as u32,
                });
            }
        }
    }
    edges.sort_unstable_by_key(|edge| (edge.ends, edge.corner));
    let mut sheets = Sheets { above: (0..3 * contour.triangles.len() as u32).collect() };
    for around in edges.chunk_by_mut(|x, y| x.ends == y.ends) {
        if around.len() > 2 {
            order_around(contour, around);
        }
        sheets.join_around(around);
    }
    sheets.assign(contour, &is_shared);
    true
}

/// Returns the next corner of a triangle.
fn next(corner: u32) -> u32 {
    corner - corner % 3 + (corner + 1) % 3
}

/// Sorts the edges that join two vertices by the angle of their triangles about the edge.
fn order_around(contour: &Contour, around: &mut [HalfEdge]) {
    let vertex = |corner: u32| {
        let triangle = contour.triangles[corner as usize / 3];
        contour.positions[triangle[corner as usize % 3] as usize]
    };
    let Some(&HalfEdge { ends, .. }) = around.first() else { return };
    let start = contour.positions[ends.0 as usize];
    let axis = (contour.positions[ends.1 as usize] - start).normalize_or(Vec3::Y);
    let (u, v) = axis.any_orthonormal_pair();
    let angle = |edge: &HalfEdge| {
        let way = vertex(next(next(edge.corner))) - start;
        // u, v and the axis are right-handed, so that the angle grows as a turn about the axis.
        let sign = u.cross(v).dot(axis).signum();
        libm::atan2f(sign * way.dot(v), way.dot(u))
    };
    sort_by(around, |x, y| angle(x).total_cmp(&angle(y)));
}

/// Corners of triangles that are one vertex of a sheet: a forest of disjoint sets.
struct Sheets {
    above: Vec<u32>,
}

impl Sheets {
    fn root(&mut self, mut corner: u32) -> u32 {
        while self.above[corner as usize] != corner {
            let above = self.above[self.above[corner as usize] as usize];
            self.above[corner as usize] = above;
            corner = above;
        }
        corner
    }

    fn join(&mut self, one: u32, other: u32) {
        let (one, other) = (self.root(one), self.root(other));
        // The smaller is the root, so that the result does not depend on the order.
        self.above[one.max(other) as usize] = one.min(other);
    }

    /// Joins the triangles around an edge in pairs: each upwards edge and a downwards one before
    /// it, with the inside between them. They alternate unless triangles are folded over each
    /// other; in any order, they pair like brackets.
    fn join_around(&mut self, around: &[HalfEdge]) {
        let (mut downwards, mut upwards) = (Vec::new(), Vec::new());
        for &edge in around {
            if !edge.is_upwards {
                downwards.push(edge);
            } else if let Some(other) = downwards.pop() {
                self.join_edges(edge, other);
            } else {
                upwards.push(edge);
            }
        }
        // The order is circular: the last downwards edges come before the first upwards ones.
        for (edge, other) in upwards.into_iter().zip(downwards.into_iter().rev()) {
            self.join_edges(edge, other);
        }
    }

    /// Joins two triangles at an edge that they share in opposite directions.
    fn join_edges(&mut self, one: HalfEdge, other: HalfEdge) {
        self.join(one.corner, next(other.corner));
        self.join(next(one.corner), other.corner);
    }

    /// Gives the corners of every set but the first at a shared vertex a copy of it.
    fn assign(mut self, contour: &mut Contour, is_shared: &[bool]) {
        let mut own: HashMap<u32, u32> = HashMap::new();
        let mut is_taken = vec![false; is_shared.len()];
        for corner in 0..self.above.len() {
            let vertex = contour.triangles[corner / 3][corner % 3];
            if !is_shared[vertex as usize] {
                continue;
            }
            let root = self.root(corner as u32);
            let place = *own.entry(root).or_insert_with(|| {
                if !std::mem::replace(&mut is_taken[vertex as usize], true) {
                    return vertex;
                }
                contour.positions.push(contour.positions[vertex as usize]);
                contour.owners.push(contour.owners[vertex as usize]);
                contour.positions.len() as u32 - 1
            });
            contour.triangles[corner / 3][corner % 3] = place;
        }
    }
}
