//! The mesh of all limbs: a unit rounded cone, which the shader bends to a limb.

use super::buffers::filled_buffer;
use eframe::wgpu;

/// A vertex: the cosine and the sine about the axis, the position from the seam (0) to the pole
/// (1), and the ball (0 or 1).
pub(super) type ConeVertex = [f32; 4];

/// A unit rounded cone.
pub(super) struct ConeMesh {
    pub(super) vertices: Vec<ConeVertex>,
    pub(super) indices: Vec<u16>,
}

impl ConeMesh {
    /// Returns a mesh with `sides` around the axis and `rings` from each seam to its pole.
    pub(super) fn new(sides: u16, rings: u16) -> Self {
        let mut vertices = Vec::new();
        // Rows from the pole of the first ball over its seam, along the cone, to the pole of the
        // second.
        let rows = (0..=rings).rev().map(|r| (r, 0.0)).chain((0..=rings).map(|r| (r, 1.0)));
        for (ring, ball) in rows {
            for side in 0..sides {
                let (sin, cos) =
                    (f32::from(side) / f32::from(sides) * std::f32::consts::TAU).sin_cos();
                vertices.push([cos, sin, f32::from(ring) / f32::from(rings), ball]);
            }
        }
        let mut indices = Vec::new();
        let row_count = 2 * (rings + 1);
        for row in 0..row_count - 1 {
            for side in 0..sides {
                let next = (side + 1) % sides;
                let [a, b, c, d] = [
                    row * sides + side,
                    row * sides + next,
                    (row + 1) * sides + side,
                    (row + 1) * sides + next,
                ];
                // At the poles, one of the two triangles has no area.
                if row > 0 {
                    indices.extend([a, b, c]);
                }
                if row + 2 < row_count {
                    indices.extend([b, d, c]);
                }
            }
        }
        Self { vertices, indices }
    }
}

/// A rounded cone in the memory of the device.
pub(super) struct ConeBuffers {
    pub(super) vertices: wgpu::Buffer,
    pub(super) indices: wgpu::Buffer,
    pub(super) index_count: u32,
}

impl ConeBuffers {
    /// Uploads a mesh to the device.
    pub(super) fn new(device: &wgpu::Device, queue: &wgpu::Queue, mesh: &ConeMesh) -> Self {
        let buffer = |contents: &[u8], usage| filled_buffer(device, queue, "cone", contents, usage);
        Self {
            vertices: buffer(bytemuck::cast_slice(&mesh.vertices), wgpu::BufferUsages::VERTEX),
            indices: buffer(bytemuck::cast_slice(&mesh.indices), wgpu::BufferUsages::INDEX),
            index_count: mesh.indices.len() as u32,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    /// Bends a vertex as the shader does, for a ball of radius 1 at the origin and one of radius
    /// 0.5 at (0, 3, 0).
    fn bend(vertex: ConeVertex) -> Vec3 {
        let tilt = (0.5f32 / 3.0).asin();
        let pole = if vertex[3] > 0.5 { 1.0 } else { -1.0 } * std::f32::consts::FRAC_PI_2;
        let angle = tilt + (pole - tilt) * vertex[2];
        let unit = Vec3::new(vertex[0] * angle.cos(), angle.sin(), -vertex[1] * angle.cos());
        if vertex[3] > 0.5 { Vec3::Y * 3.0 + unit * 0.5 } else { unit }
    }

    #[test]
    fn cone_mesh_is_closed_and_has_the_volume_of_a_rounded_cone() {
        let mesh = ConeMesh::new(96, 48);
        let at = |i: u16| bend(mesh.vertices[usize::from(i)]);
        // Positions are rounded to 10 µm, so that the vertices of a pole coincide.
        let place = |i: u16| (at(i) * 1e5).round().as_ivec3().to_array();
        let mut volume = 0.0;
        let mut edges = std::collections::BTreeMap::<_, i32>::new();
        for t in mesh.indices.chunks_exact(3) {
            volume += at(t[0]).dot(at(t[1]).cross(at(t[2]))) / 6.0;
            for (from, to) in [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])] {
                let (from, to) = (place(from), place(to));
                *edges.entry((from.min(to), from.max(to))).or_default() +=
                    if from < to { 1 } else { -1 };
            }
        }
        assert!(edges.values().all(|&sum| sum == 0), "every edge is used once in each direction");
        // The volume of the frustum between the tangent circles plus that of both spherical caps.
        let (r, s, l) = (1.0f64, 0.5f64, 3.0f64);
        let sine = (r - s) / l;
        let cos = (1.0 - sine * sine).sqrt();
        let (y1, y2, r1, r2) = (r * sine, l + s * sine, r * cos, s * cos);
        let pi = std::f64::consts::PI;
        let frustum = pi / 3.0 * (y2 - y1) * (r1 * r1 + r1 * r2 + r2 * r2);
        let cap = |radius: f64, height: f64| pi * height * height * (radius - height / 3.0);
        let expected = frustum + cap(r, r + r * sine) + cap(s, s - s * sine);
        assert!((f64::from(volume) / expected - 1.0).abs() < 3e-3, "{volume} is not {expected}");
    }
}
