//! The main light's shadow map: the box around the bodies of a pane, and the map of depths that
//! they are drawn into.

use super::layout::MAP_FORMAT;
use super::pipelines::Pipelines;
use eframe::wgpu;
use glam::{Vec2, Vec3};
use segue_scene::{Figure, Pane, Viewport};

/// The width and the height of the map of all panes, texels.
pub(super) const MAP_SIZE: u32 = 2048;
/// The greatest distance from the pane's focus at which a limb casts a shadow, metres. A farther
/// one would make the map coarse for the others.
const MAX_DISTANCE_M: f32 = 16.0;
/// The greatest height from which a shadow reaches the ground, metres. A greater one would make the
/// map's depths coarse.
const MAX_HEIGHT_M: f32 = 30.0;
/// The margin around every limb, metres, because a skin may be wider than its limbs.
const MARGIN_M: f32 = 0.08;

/// Returns whether a figure casts a shadow of the main light: solid ones do, and those whose skin
/// is of glass.
pub(super) fn casts_key_shadow(figure: &Figure) -> bool {
    figure.shadow >= 1.0
}

/// A box around a pane's bodies, aligned with the light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LightBox {
    /// The centre, metres in the world.
    pub(super) center: Vec3,
    /// The unit vector to the right of the map.
    pub(super) right: Vec3,
    /// The unit vector up on the map.
    pub(super) up: Vec3,
    /// Half of its width and height, metres.
    pub(super) half_width: f32,
    /// Half of its depth, metres.
    pub(super) half_depth: f32,
}

/// Returns the unit vector towards the main light of a pane. The light is above the left shoulder
/// of the camera, so that the shape of a body shows from all sides.
pub(super) fn key_direction(right: Vec3, yaw: f32) -> Vec3 {
    let level_back = Vec3::new(yaw.sin(), 0.0, yaw.cos());
    (Vec3::Y * 0.86 - right * 0.62 + level_back * 0.55).normalize_or(Vec3::Y)
}

/// Returns a pane's part of the map, which is divided into equal squares.
pub(super) fn tile(index: usize, panes: usize) -> Viewport {
    let columns = (1..MAP_SIZE).find(|columns| (columns * columns) as usize >= panes).unwrap_or(1);
    let side = MAP_SIZE / columns;
    let index = index as u32;
    Viewport { x: index % columns * side, y: index / columns * side, width: side, height: side }
}

impl LightBox {
    /// Returns the box around every body that casts a shadow in the pane, and the ground that the
    /// shadows fall on; `None` where there is none.
    ///
    /// The box grows in steps, and moves by whole texels of a map of `texels` × `texels`. Otherwise
    /// the edges of shadows would crawl while a body walks.
    pub(super) fn about(pane: &Pane, key: Vec3, texels: u32) -> Option<Self> {
        let right = Vec3::Y.cross(key).try_normalize()?;
        let up = key.cross(right);
        let (mut low, mut high) = (Vec2::INFINITY, Vec2::NEG_INFINITY);
        let (mut near, mut far) = (f32::NEG_INFINITY, f32::INFINITY);
        for figure in pane.figures.iter().filter(|figure| casts_key_shadow(figure)) {
            for limb in pane.limbs.get(figure.limbs.clone()).unwrap_or_default() {
                for (point, radius) in [(limb.a, limb.radius_a), (limb.b, limb.radius_b)] {
                    let is_near = (point - pane.focus).abs().max_element() < MAX_DISTANCE_M;
                    if !(is_near && radius.is_finite()) {
                        continue;
                    }
                    let on_map = Vec2::new(point.dot(right), point.dot(up));
                    let along = point.dot(key);
                    let reach = radius + MARGIN_M;
                    (low, high) = (low.min(on_map - reach), high.max(on_map + reach));
                    near = near.max(along + reach);
                    // The ground where the ray of the light through the ball's lower end meets it.
                    far = far.min(
                        along - reach - (point.y + reach).clamp(0.0, MAX_HEIGHT_M) / key.y.max(0.1),
                    );
                }
            }
        }
        let half = ((high - low) * 0.5).max_element();
        if !(half.is_finite() && near > far) {
            return None;
        }
        let half_width = ((half.max(0.25).log2() * 2.0).ceil() * 0.5).exp2();
        let texel = 2.0 * half_width / texels.max(1) as f32;
        let middle = ((low + high) * (0.5 / texel)).round() * texel;
        // Depths need not be multiples of a texel, but those of a body at rest must not change.
        let (far, near) = ((far * 4.0).floor() * 0.25, (near * 4.0).ceil() * 0.25);
        Some(Self {
            center: right * middle.x + up * middle.y + key * ((near + far) * 0.5),
            right,
            up,
            half_width,
            half_depth: (near - far) * 0.5,
        })
    }
}

/// A shadow map, and the bind group by which shaders read it.
pub(super) struct LightMap {
    pub(super) depths: wgpu::TextureView,
    pub(super) bound: wgpu::BindGroup,
}

impl LightMap {
    /// Returns a map of `size` × `size` texels.
    pub(super) fn new(device: &wgpu::Device, pipelines: &Pipelines, size: u32) -> Self {
        let texture = device.create_texture(&wgpu::TextureDescriptor {
            label: Some("light map"),
            size: wgpu::Extent3d { width: size, height: size, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: MAP_FORMAT,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        });
        let depths = texture.create_view(&wgpu::TextureViewDescriptor::default());
        let bound = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("light map"),
            layout: &pipelines.light_layout,
            entries: &[
                wgpu::BindGroupEntry {
                    binding: 0,
                    resource: wgpu::BindingResource::TextureView(&depths),
                },
                wgpu::BindGroupEntry {
                    binding: 1,
                    resource: wgpu::BindingResource::Sampler(&pipelines.light_compare),
                },
                wgpu::BindGroupEntry {
                    binding: 2,
                    resource: wgpu::BindingResource::TextureView(&depths),
                },
                wgpu::BindGroupEntry {
                    binding: 3,
                    resource: wgpu::BindingResource::Sampler(&pipelines.light_exactly),
                },
            ],
        });
        Self { depths, bound }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use segue_scene::Limb;

    fn pane(centers: &[Vec3]) -> Pane {
        let limbs: Vec<Limb> = centers
            .iter()
            .map(|&center| Limb {
                a: center,
                b: center,
                radius_a: 0.2,
                radius_b: 0.2,
                flat: Vec3::ZERO,
                flatness: 1.0,
                color: [1.0; 4],
            })
            .collect();
        Pane {
            figures: vec![Figure { limbs: 0..limbs.len(), skin: None, ghost: false, shadow: 1.0 }],
            limbs,
            ..Pane::default()
        }
    }

    const KEY: Vec3 = Vec3::new(0.48, 0.64, 0.6);

    #[test]
    fn light_box_contains_the_bodies_and_their_shadows() {
        let centers =
            [Vec3::new(0.4, 1.7, -0.3), Vec3::new(-0.9, 0.1, 1.2), Vec3::new(90.0, 0.0, 0.0)];
        let fit = LightBox::about(&pane(&centers), KEY, 1024).unwrap();
        for center in &centers[..2] {
            for point in [*center, *center - KEY * (center.y / KEY.y)] {
                let from = point - fit.center;
                assert!(
                    from.dot(fit.right).abs() < fit.half_width
                        && from.dot(fit.up).abs() < fit.half_width
                );
                assert!(from.dot(KEY).abs() < fit.half_depth);
            }
        }
        // The far body does not make the shadows of the others coarse.
        assert!(fit.half_width < 3.0);
        assert_eq!(LightBox::about(&Pane::default(), KEY, 1024), None);
        assert_eq!(LightBox::about(&pane(&[Vec3::NAN]), KEY, 1024), None);
    }

    #[test]
    fn light_box_of_a_walking_body_moves_by_whole_texels() {
        let fit = |x: f32| {
            LightBox::about(&pane(&[Vec3::new(x, 1.0, 0.0), Vec3::new(x, 0.2, 0.5)]), KEY, 1024)
                .unwrap()
        };
        let first = fit(0.0);
        let texel = 2.0 * first.half_width / 1024.0;
        for step in 1..40u8 {
            let fit = fit(0.0137 * f32::from(step));
            assert_eq!(fit.half_width, first.half_width);
            for axis in [fit.right, fit.up] {
                let moved = fit.center.dot(axis) / texel;
                assert!((moved - moved.round()).abs() < 1e-2, "{moved}");
            }
        }
    }

    #[test]
    fn tiles_of_four_panes_are_quarters_of_the_map() {
        assert_eq!(tile(0, 1).width, MAP_SIZE);
        let tiles: Vec<_> = (0..4).map(|index| tile(index, 4)).collect();
        assert!(
            tiles.iter().all(|tile| tile.width == MAP_SIZE / 2 && tile.x + tile.width <= MAP_SIZE)
        );
        assert_eq!((tiles[3].x, tiles[3].y), (MAP_SIZE / 2, MAP_SIZE / 2));
    }
}
