//! Pictures of meshes: an orthographic rasteriser with a depth buffer, and PNG files.

use flate2::write::ZlibEncoder;
use flate2::{Compression, Crc};
use glam::{Quat, Vec3};
use std::io::Write as _;

/// A grey picture with a depth buffer on white.
pub(crate) struct Canvas {
    width: usize,
    height: usize,
    depth: Vec<f32>,
    pixels: Vec<u8>,
}

/// A view of a mesh: rotated by `yaw` about the vertical through `middle`, which is at the pixel
/// `center`; `scale` in pixels per metre.
pub(crate) struct View {
    pub(crate) yaw: f32,
    pub(crate) middle: Vec3,
    pub(crate) center: [f32; 2],
    pub(crate) scale: f32,
}

impl Canvas {
    pub(crate) fn new(width: usize, height: usize) -> Self {
        Self {
            width,
            height,
            depth: vec![f32::INFINITY; width * height],
            pixels: vec![235; width * height * 3],
        }
    }

    /// Draws a mesh with vertices `positions` and `normals` from a view.
    pub(crate) fn draw(
        &mut self,
        positions: &[Vec3],
        normals: &[Vec3],
        triangles: &[[u32; 3]],
        view: &View,
    ) {
        let View { yaw, middle, center, scale } = *view;
        let turn = Quat::from_rotation_x(0.12) * Quat::from_rotation_y(yaw);
        let light = Vec3::new(-0.45, 0.7, 0.55).normalize_or_zero();
        for triangle in triangles {
            let corners = triangle.map(|corner| {
                let p = turn * (positions[corner as usize] - middle);
                (
                    Vec3::new(center[0] + p.x * scale, center[1] - p.y * scale, -p.z),
                    turn * normals[corner as usize],
                )
            });
            let [(a, na), (b, nb), (c, nc)] = corners;
            let area = (b - a).truncate().perp_dot((c - a).truncate());
            // Counter-clockwise from outside is clockwise where y points down.
            if area >= 0.0 {
                continue;
            }
            let (low, high) = (a.min(b).min(c), a.max(b).max(c));
            for y in
                low.y.floor().max(0.0) as usize..(high.y.ceil().max(0.0) as usize).min(self.height)
            {
                for x in low.x.floor().max(0.0) as usize
                    ..(high.x.ceil().max(0.0) as usize).min(self.width)
                {
                    let p = glam::Vec2::new(x as f32 + 0.5, y as f32 + 0.5);
                    let u = (b.truncate() - p).perp_dot(c.truncate() - p) / area;
                    let v = (c.truncate() - p).perp_dot(a.truncate() - p) / area;
                    let w = 1.0 - u - v;
                    let z = a.z * u + b.z * v + c.z * w;
                    let at = y * self.width + x;
                    if u < 0.0 || v < 0.0 || w < 0.0 || z >= self.depth[at] {
                        continue;
                    }
                    self.depth[at] = z;
                    let normal = (na * u + nb * v + nc * w).normalize_or(Vec3::Z);
                    let lit = 0.62 * normal.dot(light).max(0.0)
                        + 0.18 * (normal.y * 0.5 + 0.5)
                        + 0.14 * normal.z.max(0.0);
                    let shine = (normal.dot((light + Vec3::Z).normalize_or_zero()).max(0.0))
                        .powi(24)
                        * 0.10;
                    for (channel, clay) in [0.98, 0.95, 0.92].into_iter().enumerate() {
                        self.pixels[at * 3 + channel] =
                            (255.0 * (lit * clay + shine).clamp(0.0, 1.0).powf(0.7)) as u8;
                    }
                }
            }
        }
    }

    pub(crate) fn png(&self) -> Vec<u8> {
        let mut rows = ZlibEncoder::new(Vec::new(), Compression::fast());
        for row in self.pixels.chunks(self.width * 3) {
            rows.write_all(&[0]).unwrap();
            rows.write_all(row).unwrap();
        }
        let size = [self.width as u32, self.height as u32].map(u32::to_be_bytes);
        let header = [&size[0][..], &size[1], &[8, 2, 0, 0, 0]].concat();
        let mut file = b"\x89PNG\r\n\x1a\n".to_vec();
        for (kind, data) in
            [(b"IHDR", header), (b"IDAT", rows.finish().unwrap()), (b"IEND", vec![])]
        {
            let mut crc = Crc::new();
            crc.update(kind);
            crc.update(&data);
            file.extend((data.len() as u32).to_be_bytes());
            file.extend(kind);
            file.extend(&data);
            file.extend(crc.sum().to_be_bytes());
        }
        file
    }
}
