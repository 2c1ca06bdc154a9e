//! The uniform block of a pane: its camera, look and light.

use super::layout::ViewUniform;
use super::light::{self, LightBox, MAP_SIZE};
use glam::Vec4;
use segue_scene::{Lens, Look, Pane, Skinning, Stage, Viewport};

/// The ratio of the main light's radius to its distance, which is the widening of a shadow's edge
/// in metres per metre.
const SPREAD: f32 = 0.055;
/// The greatest width of a shadow's edge to either side, metres.
const MAX_SPREAD_M: f32 = 0.13;

/// Returns the uniform block of a pane, without its light. `stretch` scales widths of lines.
pub(super) fn view_uniform(
    pane: &Pane,
    viewport: Viewport,
    stage: &Stage,
    stretch: f32,
) -> ViewUniform {
    let camera = &pane.camera;
    let look = &stage.look;
    let [right, up, back] = camera.axes();
    let aspect = viewport.aspect();
    let orthographic = camera.lens == Lens::Orthographic;
    let half_height = if orthographic { camera.half_height() } else { (camera.fov_y * 0.5).tan() };
    let scale = stretch * if stage.pixels_per_point > 0.0 { stage.pixels_per_point } else { 1.0 };
    let key = light::key_direction(right, camera.yaw);
    ViewUniform {
        clip_from_world: (camera.projection(aspect) * camera.view()).to_cols_array(),
        eye: camera.eye().extend(if orthographic { 1.0 } else { 0.0 }).to_array(),
        right: (right * (half_height * aspect)).extend(0.0).to_array(),
        up: (up * half_height).extend(0.0).to_array(),
        forward: (-back)
            .extend(if orthographic { 0.0 } else { camera.depth_range()[0] })
            .to_array(),
        viewport: [viewport.x, viewport.y, viewport.width, viewport.height].map(|v| v as f32),
        key: key.extend(scale).to_array(),
        background_top: look.background_top,
        background_bottom: look.background_bottom,
        // The lit part of the ground grows with the distance of the camera, so that it fills the
        // middle of the picture.
        floor: Vec4::from(look.floor)
            .with_w(look.floor_radius.max(0.55 * camera.distance).max(0.1))
            .to_array(),
        focus: pane.focus.extend(look.shadow).to_array(),
        grid: look.grid,
        edge: look.edge,
        style: [look.edge_width * scale, look.rim, f32::from(u8::from(look.flat)), look.rim_light],
        light_center: [0.0, 0.0, 0.0, 1.0],
        light_right: [1.0, 0.0, 0.0, 1.0],
        light_up: [0.0, 1.0, 0.0, 0.0],
        light_tile: [0.0, 0.0, 1.0, 1.0],
        light_tile_metres: [0.0; 4],
        more: [
            f32::from(u8::from(pane.skinning == Skinning::Dual)),
            if stage.grid_metres > 1e-3 { stage.grid_metres } else { 1.0 },
            0.0,
            0.0,
        ],
    }
}

/// Fits the light map's part to the bodies of a pane. Returns `false` where none casts a shadow.
pub(super) fn add_light(view: &mut ViewUniform, pane: &Pane, look: &Look, tile: Viewport) -> bool {
    let key = Vec4::from(view.key).truncate();
    let Some(fit) = LightBox::about(pane, key, tile.width) else {
        return false;
    };
    let texel = 2.0 * fit.half_width / tile.width as f32;
    view.light_center = fit.center.extend(fit.half_width).to_array();
    view.light_right = fit.right.extend(fit.half_depth).to_array();
    view.light_up = fit.up.extend(1.0).to_array();
    view.light_tile =
        [tile.x, tile.y, tile.width, tile.height].map(|texels| texels as f32 / MAP_SIZE as f32);
    let [spread, max_spread] = if look.flat { [0.0, 0.0] } else { [SPREAD, MAX_SPREAD_M] };
    view.light_tile_metres = [texel, spread, max_spread, look.key_shadow];
    true
}
