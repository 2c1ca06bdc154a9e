// Background and floor of a pane, computed per pixel: a pool of light around the focus, and a grid
// that fades with it.

struct Pixel {
    @builtin(position) clip: vec4f,
    // -1 to 1 over the pane, to the right and up.
    @location(0) ndc: vec2f,
}

@vertex
fn vs_ground(@builtin(vertex_index) index: u32) -> Pixel {
    let corner = vec2f(f32((index << 1u) & 2u), f32(index & 2u));
    var out: Pixel;
    out.ndc = corner * 2.0 - 1.0;
    out.clip = vec4f(out.ndc, 0.0, 1.0);
    return out;
}

// Returns the share of a pixel that the lines of a grid cover. `cell` in metres, `width` in pixels.
fn grid_cover(at: vec2f, cell: f32, width: f32) -> f32 {
    let uv = at / cell;
    let footprint = max(fwidth(uv), vec2f(1e-6));
    let from_line = abs(fract(uv - 0.5) - 0.5);
    let drawn = max(footprint * width, vec2f(1e-6));
    // Lines thinner than a pixel fade instead of flickering.
    let line = smoothstep(drawn * 0.5 + footprint * 0.6, drawn * 0.5 - footprint * 0.6, from_line);
    let visible = line * clamp(1.5 - 3.0 * footprint, vec2f(0.0), vec2f(1.0));
    return max(visible.x, visible.y);
}

fn ground_color(in: Pixel) -> vec3f {
    var color = mix(view.background_bottom.rgb, view.background_top.rgb, smoothstep(-1.0, 1.0, in.ndc.y));
    let ahead = view.forward.xyz + view.right.xyz * in.ndc.x + view.up.xyz * in.ndc.y;
    let shift = view.right.xyz * in.ndc.x + view.up.xyz * in.ndc.y;
    let orthographic = view.eye.w > 0.5;
    let origin = select(view.eye.xyz, view.eye.xyz + shift, orthographic);
    let direction = select(ahead, view.forward.xyz, orthographic);
    let steep = select(direction.y, min(direction.y, -1e-5), origin.y > 0.0);
    let t = min(-origin.y / steep, 4000.0);
    // Measured from the focus' own cell of the grid, so that precision does not suffer far from the
    // origin.
    let cell = view.more.y;
    let base = floor(view.focus.xz / cell) * cell;
    let at = (origin.xz - base) + direction.xz * t;
    let from_focus = length(at - (view.focus.xz - base)) / view.floor.w;
    // Derivatives are taken below, so nothing may branch.
    let cover = grid_cover(at, cell, view.key.w);
    let facing = f32(origin.y > 0.0 && direction.y < -1e-5);
    let pool = exp(-from_focus * from_focus * 0.9) * facing;
    color = mix(color, view.floor.rgb, pool);
    let reach = exp(-from_focus * from_focus * 0.22) * facing;
    return mix(color, view.grid.rgb, cover * view.grid.a * reach);
}

@fragment
fn fs_ground(in: Pixel) -> @location(0) vec4f {
    return vec4f(ground_color(in) + dither(in.clip.xy), 1.0);
}

// Draws the ground again in full shadow, blended by the light that is left in the target's alpha.
@fragment
fn fs_shade(in: Pixel) -> @location(0) vec4f {
    // Seen from below, the ground is invisible, and so are the shadows on it.
    let dark = view.focus.w * f32(view.eye.y > 0.0);
    return vec4f(ground_color(in) * (1.0 - dark * vec3f(1.0, 0.97, 0.90)) + dither(in.clip.xy), 1.0);
}
