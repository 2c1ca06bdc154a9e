//! A mesh with fewer triangles, for pictures in motion that are drawn in software. A triangle takes
//! as long there as dozens of pixels, however small it is.

use glam::{DVec3, Vec3};
use segue_motion::skin::SkinnedMesh;
use std::collections::BTreeMap;

/// The number of cells along the longest side of a mesh: for a body that fills a pane of the
/// coarse picture, a cell has about five pixels.
const CELLS: f32 = 64.0;

/// The number of places along the side of an image that are taken for different ones: those of the
/// two sides of a seam are.
const PLACES: f32 = 8.0;

/// The vertices of a mesh, where those that are close together are taken for one (Rossignac and
/// Borrel, "Multi-resolution 3D approximations for rendering complex scenes": clusters of a grid).
/// Vertices on different limbs, on the two sides of a thin part, and in different places of a
/// texture stay apart.
pub(super) struct Clusters {
    clusters: Vec<Cluster>,
    /// The cluster of each vertex.
    of_vertices: Vec<usize>,
}

impl Clusters {
    /// Returns the clusters of a mesh.
    pub(super) fn of(mesh: &SkinnedMesh) -> Self {
        // As in the vertex buffer, positions that are not finite are at the origin.
        let finite = |position: &Vec3| if position.is_finite() { *position } else { Vec3::ZERO };
        let positions: Vec<Vec3> = mesh.positions.iter().map(finite).collect();
        let low = positions.iter().copied().reduce(Vec3::min).unwrap_or_default();
        let high = positions.iter().copied().reduce(Vec3::max).unwrap_or_default();
        let cell = ((high - low).max_element() / CELLS).max(f32::MIN_POSITIVE);
        let parts = mesh.part_of_vertices();
        let mut clusters: Vec<Cluster> = Vec::new();
        let mut known = BTreeMap::new();
        let mut of_vertices = Vec::with_capacity(positions.len());
        for (index, &position) in positions.iter().enumerate() {
            let at = ((position - low) / cell).floor().as_ivec3().to_array();
            let joint = mesh.joints.get(index).map_or(0, |joints| joints[0]);
            let side = facing(mesh.normals.get(index).copied().unwrap_or_default());
            let place = mesh.coordinates.get(index).copied().unwrap_or_default();
            let place = place.map(|value| (value * PLACES).floor() as i32);
            let number =
                *known.entry((at, joint, side, parts[index], place)).or_insert_with(|| {
                    clusters.push(Cluster::default());
                    clusters.len() - 1
                });
            clusters[number].sum += position.as_dvec3();
            clusters[number].count += 1;
            of_vertices.push(number);
        }
        for (index, (position, &number)) in positions.iter().zip(&of_vertices).enumerate() {
            clusters[number].offer(index as u32, position.as_dvec3());
        }
        Self { clusters, of_vertices }
    }

    /// Returns the triangles between clusters that stand for these, in their order. Triangles with
    /// an invalid corner are left out.
    pub(super) fn coarse(&self, triangles: &[[u32; 3]]) -> Vec<[u32; 3]> {
        let stand_in = |corner: u32| {
            let cluster = self.clusters.get(*self.of_vertices.get(corner as usize)?)?;
            Some(cluster.nearest?.1)
        };
        let merged = triangles.iter().filter_map(|&[a, b, c]| {
            let [a, b, c] = [stand_in(a)?, stand_in(b)?, stand_in(c)?];
            (a != b && b != c && c != a).then_some([a, b, c])
        });
        merged.collect()
    }
}

/// Vertices that are taken for one.
#[derive(Default)]
struct Cluster {
    sum: DVec3,
    count: u32,
    /// The squared distance from their mean, and the index, of the vertex that is nearest to it.
    nearest: Option<(f64, u32)>,
}

impl Cluster {
    /// Takes a vertex for the nearest where it is.
    fn offer(&mut self, index: u32, position: DVec3) {
        let distance = position.distance_squared(self.sum / f64::from(self.count));
        if self.nearest.is_none_or(|(least, _)| distance < least) {
            self.nearest = Some((distance, index));
        }
    }
}

/// Returns the side of a cube to which a normal points, 0 to 5.
fn facing(normal: Vec3) -> u8 {
    let size = normal.abs();
    let axis = if size.x >= size.y && size.x >= size.z {
        0
    } else if size.y >= size.z {
        1
    } else {
        2
    };
    2 * axis + u8::from(normal[usize::from(axis)] < 0.0)
}
