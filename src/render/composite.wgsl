// Copies the finished stage into the page, pixel by pixel, or stretched where it is smaller.

@group(0) @binding(0) var stage: texture_2d<f32>;
@group(0) @binding(1) var linearly: sampler;

struct Pixel {
    @builtin(position) clip: vec4f,
    @location(0) uv: vec2f,
}

@vertex
fn vs_composite(@builtin(vertex_index) index: u32) -> Pixel {
    let corner = vec2f(f32((index << 1u) & 2u), f32(index & 2u));
    var out: Pixel;
    out.uv = vec2f(corner.x, 1.0 - corner.y);
    out.clip = vec4f(corner * 2.0 - 1.0, 0.0, 1.0);
    return out;
}

fn texel(uv: vec2f) -> vec3f {
    return textureSampleLevel(stage, linearly, uv, 0.0).rgb;
}

// For a target of the page that takes encoded colours.
@fragment
fn fs_encoded(in: Pixel) -> @location(0) vec4f {
    return vec4f(texel(in.uv), 1.0);
}

// For a target of the page that encodes linear colours.
@fragment
fn fs_linear(in: Pixel) -> @location(0) vec4f {
    let c = texel(in.uv);
    return vec4f(select(pow((c + 0.055) / 1.055, vec3f(2.4)), c / 12.92, c <= vec3f(0.04045)), 1.0);
}
