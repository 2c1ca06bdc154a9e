// The uniforms and functions of all shaders of the stage. Colours come in and go out sRGB-encoded;
// light is computed linearly in between.

struct View {
    clip_from_world: mat4x4f,
    // Position of the camera; w is 1 for an orthographic lens.
    eye: vec4f,
    // World vectors of half the picture's width and height, at depth 1 for a perspective lens.
    right: vec4f,
    up: vec4f,
    // Viewing direction of the camera, unit; w is the depth of the near plane.
    forward: vec4f,
    // Rectangle of the pane in the target: left, top, width, height, pixels.
    viewport: vec4f,
    // Direction towards the main light, unit; w is the number of pixels per point.
    key: vec4f,
    background_top: vec4f,
    background_bottom: vec4f,
    // w is the radius of the lit part, metres.
    floor: vec4f,
    // Centre of the lit part; w is the darkness of shadows.
    focus: vec4f,
    grid: vec4f,
    edge: vec4f,
    // Width of edges in pixels, darkening of rims, 1 for two flat tones, light on rims from behind.
    style: vec4f,
    // Centre of the light map's box; w is half its width, metres.
    light_center: vec4f,
    // The map's directions, unit: to its right, with half its depth in metres as w; up, with w 1
    // where there is a map.
    light_right: vec4f,
    light_up: vec4f,
    // The pane's part of the map: left, top, width, height, 0 to 1.
    light_tile: vec4f,
    // Width of a texel in metres; widening of a shadow's edge with distance, metres per metre;
    // greatest width of the edge, metres; share of the main light in the light on the ground.
    light_tile_metres: vec4f,
    // 1 for dual quaternions; width of a cell of the grid, metres; unused, unused.
    more: vec4f,
}

@group(0) @binding(0) var<uniform> view: View;

fn to_linear(c: vec3f) -> vec3f {
    return select(pow((c + 0.055) / 1.055, vec3f(2.4)), c / 12.92, c <= vec3f(0.04045));
}

fn to_srgb(c: vec3f) -> vec3f {
    let x = clamp(c, vec3f(0.0), vec3f(1.0));
    return select(1.055 * pow(max(x, vec3f(1e-6)), vec3f(1.0 / 2.4)) - 0.055, x * 12.92, x <= vec3f(0.0031308));
}

// Returns the metres per pixel at a point of the world.
fn pixel_size(world: vec3f) -> f32 {
    let depth = select(dot(world - view.eye.xyz, view.forward.xyz), 1.0, view.eye.w > 0.5);
    return 2.0 * max(depth, view.forward.w) * length(view.up.xyz) / view.viewport.w;
}

// Returns the unit vector from a point to the camera.
fn towards_eye(world: vec3f) -> vec3f {
    return normalize(select(view.eye.xyz - world, -view.forward.xyz, view.eye.w > 0.5));
}

// Returns uniform noise for a pixel, within half a step of 8 bits. It hides bands, and leaves exact
// colours exact.
fn dither(pixel: vec2f) -> f32 {
    return (fract(52.9829189 * fract(dot(floor(pixel), vec2f(0.06711056, 0.00583715)))) - 0.5) * (0.96 / 255.0);
}
