//! Textures of a mesh: the base colours that an image spreads over its triangles.

use super::SkinnedMesh;
use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;

/// Triangles of a mesh that have a texture.
#[derive(Clone, Debug, PartialEq)]
pub struct TexturedPart {
    /// The triangles, indices of [`SkinnedMesh::triangles`].
    pub triangles: Range<usize>,
    /// Their texture.
    pub texture: Texture,
}

/// A base colour texture. The colour of a point is the product of that of its vertices and that of
/// the image at its texture coordinates, in linear light.
#[derive(Clone, Debug, PartialEq)]
pub struct Texture {
    /// The image as its file has it: PNG, JPEG or WebP.
    pub image: Arc<[u8]>,
    /// How the image is looked up.
    pub sampler: Sampler,
    /// The meaning of its opacity.
    pub alpha: AlphaMode,
}

/// The way in which an image is looked up.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, serde::Serialize, serde::Deserialize,
)]
pub struct Sampler {
    /// The wrap modes across and down.
    pub wraps: [Wrap; 2],
    /// Whether the nearest texel counts alone; otherwise those around a point are mixed.
    pub is_nearest: bool,
}

/// A wrap mode: the colours at texture coordinates outside of 0 to 1.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, serde::Serialize, serde::Deserialize,
)]
#[serde(rename_all = "snake_case")]
pub enum Wrap {
    /// The colour of the edge.
    Clamp,
    /// The image again.
    Repeat,
    /// The image again, mirrored.
    Mirror,
}

/// The meaning of the opacity of a texture.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum AlphaMode {
    /// It has none: everything is opaque.
    Opaque,
    /// Points below this opacity are left out, and the others are opaque. It is not negative; above
    /// 1, nothing is left.
    Mask(f32),
    /// Points are as opaque as it says.
    Blend,
}

impl AlphaMode {
    /// Returns the opacity below which a point is left out where nothing is drawn translucent.
    #[must_use]
    pub fn cutoff(self) -> f32 {
        match self {
            Self::Opaque => 0.0,
            Self::Mask(cutoff) => cutoff,
            Self::Blend => 0.5,
        }
    }
}

impl SkinnedMesh {
    /// Returns the parts of the mesh in the order of their triangles: those with a texture, and
    /// what lies between them. Triangles that the mesh does not have are left out.
    #[must_use]
    pub fn parts(&self) -> Vec<(Range<usize>, Option<&Texture>)> {
        let mut parts = Vec::new();
        let mut end = 0;
        for part in &self.textured {
            let triangles = part.triangles.start.max(end)..part.triangles.end;
            let triangles = triangles.start..triangles.end.min(self.triangles.len());
            if triangles.is_empty() {
                continue;
            }
            if end < triangles.start {
                parts.push((end..triangles.start, None));
            }
            end = triangles.end;
            parts.push((triangles, Some(&part.texture)));
        }
        if end < self.triangles.len() {
            parts.push((end..self.triangles.len(), None));
        }
        parts
    }

    /// Returns the number of the part that each vertex is on, an index of [`Self::parts`]; 0 for
    /// vertices without a triangle.
    #[must_use]
    pub fn part_of_vertices(&self) -> Vec<usize> {
        let mut of_vertices = vec![0; self.positions.len()];
        for (number, (triangles, _)) in self.parts().into_iter().enumerate() {
            for corner in self.triangles[triangles].as_flattened() {
                if let Some(part) = of_vertices.get_mut(*corner as usize) {
                    *part = number;
                }
            }
        }
        of_vertices
    }

    /// Reorders the triangles so that those with the same texture are one part; within a part, they
    /// stay in their order. Triangles without a texture come first.
    pub fn join_textured_parts(&mut self) {
        let mut plain = Vec::new();
        let mut places = BTreeMap::new();
        let mut textured: Vec<(Option<Texture>, Vec<[u32; 3]>)> = Vec::new();
        for (range, texture) in self.parts() {
            let triangles = match texture {
                None => &mut plain,
                Some(texture) => {
                    let image = Arc::as_ptr(&texture.image).addr();
                    let alpha = match texture.alpha {
                        AlphaMode::Opaque => (0, 0),
                        AlphaMode::Mask(cutoff) => (1, cutoff.to_bits()),
                        AlphaMode::Blend => (2, 0),
                    };
                    let place =
                        *places.entry((image, texture.sampler, alpha)).or_insert_with(|| {
                            textured.push((Some(texture.clone()), Vec::new()));
                            textured.len() - 1
                        });
                    &mut textured[place].1
                }
            };
            triangles.extend_from_slice(&self.triangles[range]);
        }
        self.triangles.clear();
        self.textured.clear();
        for (texture, triangles) in std::iter::once((None, plain)).chain(textured) {
            let start = self.triangles.len();
            self.triangles.extend(triangles);
            if let Some(texture) = texture {
                let triangles = start..self.triangles.len();
                self.textured.push(TexturedPart { triangles, texture });
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texture(image: &Arc<[u8]>) -> Texture {
        Texture {
            image: Arc::clone(image),
            sampler: Sampler { wraps: [Wrap::Repeat; 2], is_nearest: false },
            alpha: AlphaMode::Opaque,
        }
    }

    fn mesh(triangles: u32, textured: Vec<(Range<usize>, Texture)>) -> SkinnedMesh {
        let part = |(triangles, texture)| TexturedPart { triangles, texture };
        SkinnedMesh {
            triangles: (0..triangles).map(|index| [index; 3]).collect(),
            textured: textured.into_iter().map(part).collect(),
            ..SkinnedMesh::default()
        }
    }

    #[test]
    fn parts_are_the_textured_ones_and_what_lies_between() {
        let [skin, hair]: [Arc<[u8]>; 2] = [[1].into(), [2].into()];
        let parts = |mesh: &SkinnedMesh| -> Vec<_> {
            mesh.parts().into_iter().map(|(range, texture)| (range, texture.cloned())).collect()
        };
        assert_eq!(parts(&mesh(3, Vec::new())), [(0..3, None)]);
        assert_eq!(parts(&mesh(0, vec![(0..2, texture(&skin))])), []);
        let gaps = mesh(7, vec![(1..2, texture(&skin)), (2..4, texture(&hair))]);
        let expected = [
            (0..1, None),
            (1..2, Some(texture(&skin))),
            (2..4, Some(texture(&hair))),
            (4..7, None),
        ];
        assert_eq!(parts(&gaps), expected);
        // Ranges that overlap, or that reach beyond the mesh.
        let wrong =
            mesh(3, vec![(0..2, texture(&skin)), (1..9, texture(&hair)), (9..9, texture(&skin))]);
        assert_eq!(parts(&wrong), [(0..2, Some(texture(&skin))), (2..3, Some(texture(&hair)))]);
    }

    #[test]
    fn vertices_are_on_the_part_of_their_triangles() {
        let [skin, hair]: [Arc<[u8]>; 2] = [[1].into(), [2].into()];
        let mut mesh = mesh(5, vec![(1..2, texture(&skin)), (2..4, texture(&hair))]);
        // One without a triangle, and a triangle without a vertex.
        mesh.positions = vec![glam::Vec3::ZERO; 6];
        mesh.triangles.push([9; 3]);
        assert_eq!(mesh.part_of_vertices(), [0, 1, 2, 2, 3, 0]);
    }

    #[test]
    fn memory_counts_each_image_once() {
        let [skin, hair]: [Arc<[u8]>; 2] = [[1; 70].into(), [2; 7].into()];
        let plain = mesh(9, Vec::new()).bytes();
        let parts = vec![(0..2, texture(&skin)), (2..3, texture(&hair)), (4..9, texture(&skin))];
        assert_eq!((plain, mesh(9, parts).bytes()), (108, 108 + 77));
    }

    #[test]
    fn triangles_with_one_texture_become_one_part() {
        let [skin, hair]: [Arc<[u8]>; 2] = [[1].into(), [1].into()];
        let cut_out = Texture { alpha: AlphaMode::Mask(0.5), ..texture(&skin) };
        let mut mesh = mesh(
            8,
            vec![
                (1..2, texture(&skin)),
                (2..4, texture(&hair)),
                (5..6, texture(&skin)),
                (6..7, cut_out.clone()),
            ],
        );
        mesh.join_textured_parts();
        let order: Vec<u32> = mesh.triangles.iter().map(|triangle| triangle[0]).collect();
        assert_eq!(order, [0, 4, 7, 1, 5, 2, 3, 6]);
        let ranges: Vec<_> = mesh.textured.iter().map(|part| part.triangles.clone()).collect();
        assert_eq!(ranges, [3..5, 5..7, 7..8]);
        assert_eq!(mesh.textured[2].texture, cut_out);
    }
}
