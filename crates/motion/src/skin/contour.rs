//! Meshing of a field: dual contouring on an octree whose cells are small where shapes are thin
//! (Ju, Losasso, Schaefer, Warren, "Dual Contouring of Hermite Data", 2002). Vertices lie on the
//! field's zero instead of on features, because the field has no sharp edges.
//!
//! Each cell that touches an edge with a change of sign has one vertex; the cells around such an
//! edge form one face. An edge is processed in its smallest cell, so that cells of different sizes
//! meet without a crack.

use super::field::{Field, ShapeDistance};
use glam::{IVec3, Vec3};
use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hasher};
use std::sync::Arc;

/// The greatest number of levels of the tree: coordinates in the finest cells fit into 16 bits.
const MAX_LEVELS: u32 = 12;

/// Vertices on the zero of a field, and the faces between them.
#[derive(Clone, Debug, Default)]
pub(super) struct Contour {
    pub(super) positions: Vec<Vec3>,
    /// Counter-clockwise from outside.
    pub(super) triangles: Vec<[u32; 3]>,
    /// For each vertex the shape of the field that is nearest to it, and the position along its
    /// axis.
    pub(super) owners: Vec<(usize, f32)>,
}

/// The meshing of a field in slices.
#[derive(Clone, Debug)]
pub(super) struct Contouring {
    tree: Octree,
    /// Cells of the tree that are not processed yet: corner, level, and the shapes that affect the
    /// parent cell.
    growing: Vec<(IVec3, u32, Arc<[u16]>)>,
    /// Leaves through which the surface may pass, and the number of those that are processed;
    /// `None` while the tree grows.
    open: Option<Vec<usize>>,
    seen: usize,
    rings: Vec<[usize; 4]>,
    /// The number of leaves whose vertices are placed, if they have one.
    placed: usize,
    contour: Contour,
}

impl Contouring {
    /// Begins the meshing. `sizes` has for each shape the greatest size of a cell at its surface,
    /// metres, above 0.
    pub(super) fn new(field: Field, sizes: Vec<f32>) -> Self {
        let finest = sizes.iter().copied().fold(f32::INFINITY, f32::min);
        let [low, high] = field.bounds().unwrap_or_default();
        let extent = (high - low).max_element() + 4.0 * finest;
        let all: Arc<[u16]> =
            (0..field.cones.len()).filter_map(|index| u16::try_from(index).ok()).collect();
        let can_be_meshed = !all.is_empty() && extent.is_finite() && finest > 0.0;
        let levels = libm::log2f(extent / finest).ceil().clamp(1.0, MAX_LEVELS as f32) as u32;
        let cell = finest.max(extent / (1u32 << levels) as f32);
        Self {
            tree: Octree {
                field,
                origin: (low + high) * 0.5 - Vec3::splat(0.5 * cell * (1u32 << levels) as f32),
                cell,
                coarsest: sizes.iter().copied().fold(0.0, f32::max),
                sizes,
                levels,
                cells: HashMap::default(),
                leaves: Vec::new(),
                near: Vec::new(),
                corners: HashMap::default(),
                scratch: Vec::new(),
            },
            growing: can_be_meshed.then_some((IVec3::ZERO, levels, all)).into_iter().collect(),
            open: None,
            seen: 0,
            rings: Vec::new(),
            placed: 0,
            contour: Contour::default(),
        }
    }

    /// Processes up to `cells` more cells. Returns the mesh once it is complete.
    pub(super) fn advance(&mut self, cells: usize) -> Option<Contour> {
        for _ in 0..cells {
            if let Some((at, level, near)) = self.growing.pop() {
                self.tree.grow(at, level, &near, &mut self.growing);
                continue;
            }
            let leaves = &self.tree.leaves;
            let open = self.open.get_or_insert_with(|| {
                (0..leaves.len()).filter(|&leaf| leaves[leaf].is_open).collect()
            });
            if let Some(&leaf) = open.get(self.seen) {
                self.seen += 1;
                self.tree.cross_edges(leaf, open, &mut self.rings);
            } else if self.placed < self.tree.leaves.len() {
                self.tree.place_vertex(self.placed, &mut self.contour);
                self.placed += 1;
            } else {
                self.tree.close(&self.rings, &mut self.contour);
                return Some(std::mem::take(&mut self.contour));
            }
        }
        None
    }
}

/// A hasher for small keys: one multiplication (Fibonacci hashing).
#[derive(Clone, Copy, Debug, Default)]
struct KeyHasher(u64);

impl Hasher for KeyHasher {
    fn finish(&self) -> u64 {
        self.0
    }

    fn write(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            self.write_u64(u64::from(byte));
        }
    }

    fn write_u64(&mut self, key: u64) {
        let mixed = (self.0 ^ key).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        self.0 = mixed ^ (mixed >> 29);
    }
}

type Map<V> = HashMap<u64, V, BuildHasherDefault<KeyHasher>>;

fn key(at: IVec3, level: u32) -> u64 {
    // Coordinates lie in 0..=4096.
    let [x, y, z] = at.to_array().map(|v| v as u64 & 0xffff);
    x | y << 16 | z << 32 | u64::from(level) << 48
}

#[derive(Clone, Debug)]
struct Octree {
    field: Field,
    sizes: Vec<f32>,
    origin: Vec3,
    /// Edge length of the finest cells, metres.
    cell: f32,
    /// The largest of `sizes`.
    coarsest: f32,
    levels: u32,
    /// Leaves by corner and level.
    cells: Map<u32>,
    leaves: Vec<Leaf>,
    /// The shapes that affect the leaves, one list after the other.
    near: Vec<u16>,
    /// Values at corners.
    corners: Map<f32>,
    scratch: Vec<(usize, ShapeDistance)>,
}

#[derive(Clone, Debug)]
struct Leaf {
    at: IVec3,
    level: u32,
    near: (u32, u32),
    /// Whether the surface may pass through it, so that it is or will be processed.
    is_open: bool,
    /// The sum and the number of the intersections of the surface with the cell's edges.
    crossings: Vec3,
    count: f32,
    vertex: u32,
}

impl Octree {
    fn place(&self, at: IVec3) -> Vec3 {
        self.origin + at.as_vec3() * self.cell
    }

    /// Divides a cell, or makes it a leaf. The children of a divided cell are put on `growing`.
    fn grow(
        &mut self,
        at: IVec3,
        level: u32,
        near: &[u16],
        growing: &mut Vec<(IVec3, u32, Arc<[u16]>)>,
    ) {
        let size = self.cell * (1u32 << level) as f32;
        let center = self.place(at) + Vec3::splat(0.5 * size);
        let reach = 0.5 * size * 3f32.sqrt();
        let mut narrowed = Vec::with_capacity(near.len());
        let around =
            self.field.narrowed(center, reach, near, &self.sizes, &mut narrowed, &mut self.scratch);
        let is_near = around.least <= 1.1 * reach
            && self.field.sample(center, &narrowed, &mut self.scratch).value.abs() <= 1.6 * reach;
        // If no single surface is near, the blend of two may still be.
        let wanted = if around.size.is_finite() { around.size } else { self.coarsest };
        if is_near && level > 0 && size > 1.01 * wanted {
            let half = 1 << (level - 1);
            let narrowed: Arc<[u16]> = narrowed.into();
            growing.extend((0..8).map(|child| {
                let offset = IVec3::new(child & 1, child >> 1 & 1, child >> 2) * half;
                (at + offset, level - 1, Arc::clone(&narrowed))
            }));
            return;
        }
        self.cells.insert(key(at, level), self.leaves.len() as u32);
        let start = self.near.len() as u32;
        self.near.extend(&narrowed);
        self.leaves.push(Leaf {
            at,
            level,
            near: (start, self.near.len() as u32),
            is_open: is_near,
            crossings: Vec3::ZERO,
            count: 0.0,
            vertex: u32::MAX,
        });
    }

    fn near_of(&self, leaf: usize) -> &[u16] {
        let (start, end) = self.leaves[leaf].near;
        &self.near[start as usize..end as usize]
    }

    fn sample(&mut self, point: Vec3, leaf: usize) -> super::field::Sample {
        let (start, end) = self.leaves[leaf].near;
        let near = &self.near[start as usize..end as usize];
        self.field.sample(point, near, &mut self.scratch)
    }

    fn corner(&mut self, at: IVec3, leaf: usize) -> f32 {
        if let Some(&value) = self.corners.get(&key(at, 0)) {
            return value;
        }
        let value = self.sample(self.place(at), leaf).value;
        self.corners.insert(key(at, 0), value);
        value
    }

    /// Returns the leaf that contains a finest cell.
    fn leaf_of(&self, cell: IVec3) -> Option<usize> {
        (0..=self.levels)
            .find_map(|level| self.cells.get(&key(cell & IVec3::splat(-(1 << level)), level)))
            .map(|&leaf| leaf as usize)
    }

    /// Finds the intersections of the surface with the edges of a leaf. The leaves around each such
    /// edge are added to `rings`, and those that share a part of it to `open`.
    fn cross_edges(&mut self, leaf: usize, open: &mut Vec<usize>, rings: &mut Vec<[usize; 4]>) {
        let (at, level) = (self.leaves[leaf].at, self.leaves[leaf].level);
        let values: [f32; 8] = std::array::from_fn(|c| {
            let offset = IVec3::new(c as i32 & 1, c as i32 >> 1 & 1, c as i32 >> 2) << level as i32;
            self.corner(at + offset, leaf)
        });
        if values.iter().all(|v| *v < 0.0) || values.iter().all(|v| *v >= 0.0) {
            return;
        }
        for axis in 0..3 {
            for quadrant in 0..4 {
                // The edge is at this side of the cell in each of the other two directions.
                let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
                let (side_u, side_v) = (quadrant & 1, quadrant >> 1);
                let low = side_u << u | side_v << v;
                let (from, to) = (values[low], values[low | 1 << axis]);
                if (from < 0.0) == (to < 0.0) {
                    continue;
                }
                let side = [side_u as i32, side_v as i32];
                let Some(ring) = self.ring(leaf, axis, side, 0) else {
                    continue;
                };
                // The surface passes here, whatever the bounds are: all leaves that share the edge
                // are processed.
                for (place, other) in ring.into_iter().enumerate() {
                    let smaller =
                        if self.leaves[other].level < level { 1..1 << level } else { 1..1 };
                    let along = smaller.filter_map(|step| {
                        self.ring(leaf, axis, side, step).map(|ring| ring[place])
                    });
                    let all: Vec<usize> = std::iter::once(other).chain(along).collect();
                    for other in all {
                        if !std::mem::replace(&mut self.leaves[other].is_open, true) {
                            open.push(other);
                        }
                    }
                }
                // An edge is processed by its smallest leaf, and by the first of equal ones.
                let is_first = ring.iter().all(|&other| {
                    let (theirs, ours) = (self.leaves[other].level, level);
                    theirs > ours || (theirs == ours && other >= leaf)
                });
                if is_first {
                    self.cross(leaf, low, axis, [from, to], &ring);
                    rings.push(if from < 0.0 {
                        ring
                    } else {
                        [ring[3], ring[2], ring[1], ring[0]]
                    });
                }
            }
        }
    }

    /// Returns the leaves around an edge of a leaf, counter-clockwise as seen from its far end. If
    /// smaller leaves share the edge, those at `step` finest cells from its near end are returned.
    fn ring(&self, leaf: usize, axis: usize, side: [i32; 2], step: i32) -> Option<[usize; 4]> {
        let (at, level) = (self.leaves[leaf].at, self.leaves[leaf].level);
        let size = 1 << level;
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        let mut ring = [leaf; 4];
        for (place, (du, dv)) in [(-1, -1), (0, -1), (0, 0), (-1, 0)].into_iter().enumerate() {
            let mut cell = at;
            cell[axis] += step;
            cell[u] += side[0] * size + du;
            cell[v] += side[1] * size + dv;
            ring[place] = self.leaf_of(cell)?;
        }
        Some(ring)
    }

    /// Adds the intersection of the surface with an edge to the leaves around it.
    fn cross(
        &mut self,
        leaf: usize,
        low: usize,
        axis: usize,
        [from, to]: [f32; 2],
        ring: &[usize; 4],
    ) {
        let (at, level) = (self.leaves[leaf].at, self.leaves[leaf].level);
        let offset =
            IVec3::new(low as i32 & 1, low as i32 >> 1 & 1, low as i32 >> 2) << level as i32;
        let mut end = at + offset;
        end[axis] += 1 << level;
        let (start, end) = (self.place(at + offset), self.place(end));
        let point = start.lerp(end, (from / (from - to)).clamp(0.0, 1.0));
        for &leaf in ring {
            let leaf = &mut self.leaves[leaf];
            leaf.crossings += point;
            leaf.count += 1.0;
        }
    }

    /// Places the vertex of a leaf through which the surface passes.
    fn place_vertex(&mut self, leaf: usize, contour: &mut Contour) {
        let Leaf { crossings, count, level, .. } = self.leaves[leaf];
        if count == 0.0 {
            return;
        }
        let mean = crossings / count;
        let farthest = 0.5 * self.cell * (1u32 << level) as f32;
        let mut point = mean;
        for _ in 0..2 {
            let sample = self.sample(point, leaf);
            point -= sample.normal * sample.value.clamp(-farthest, farthest);
        }
        if point.distance(mean) > farthest {
            point = mean;
        }
        self.leaves[leaf].vertex = contour.positions.len() as u32;
        contour.positions.push(point);
        contour.owners.push(self.field.nearest(point, self.near_of(leaf)).unwrap_or_default());
    }

    /// Makes faces from the rings of leaves.
    fn close(&self, rings: &[[usize; 4]], contour: &mut Contour) {
        for ring in rings {
            let [a, b, c, d] = ring.map(|leaf| self.leaves[leaf].vertex);
            let between = |x: u32, y: u32| {
                contour.positions[x as usize].distance_squared(contour.positions[y as usize])
            };
            // The shorter diagonal; a ring of three leaves is one triangle.
            let pair = if between(a, c) <= between(b, d) {
                [[a, b, c], [a, c, d]]
            } else {
                [[a, b, d], [b, c, d]]
            };
            let is_one = |[x, y, z]: &[u32; 3]| x != y && y != z && z != x;
            contour.triangles.extend(pair.into_iter().filter(is_one));
        }
    }
}
