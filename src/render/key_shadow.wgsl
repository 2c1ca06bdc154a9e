// The main light's shadow on the ground, where the pane's part of the light map meets it. The
// target's alpha is the share of light that is left.

struct Lit {
    @builtin(position) clip: vec4f,
    @location(0) world: vec3f,
}

@vertex
fn vs_key_shadow(@builtin(vertex_index) index: u32) -> Lit {
    let corner = vec2f(f32(index & 1u), f32((index >> 1u) & 1u)) * 2.0 - 1.0;
    let across = (view.light_right.xyz * corner.x + view.light_up.xyz * corner.y) * view.light_center.w;
    let start = view.light_center.xyz + across;
    var out: Lit;
    // The light is never horizontal.
    out.world = start - view.key.xyz * (start.y / view.key.y);
    out.clip = view.clip_from_world * vec4f(out.world, 1.0);
    return out;
}

@fragment
fn fs_key_shadow(in: Lit) -> @location(0) vec4f {
    let hidden = 1.0 - key_on_ground(in.world, in.clip.xy);
    return vec4f(0.0, 0.0, 0.0, hidden * view.light_tile_metres.w);
}
