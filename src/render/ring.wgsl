// Rings on the ground.

struct Ring {
    @builtin(vertex_index) corner: u32,
    // x, z, radius and width in metres.
    @location(0) place: vec4f,
    @location(1) color: vec4f,
    @location(2) fill: f32,
}

struct Drawn {
    @builtin(position) clip: vec4f,
    // Position relative to the centre, metres.
    @location(0) at: vec2f,
    @location(1) @interpolate(flat) color: vec4f,
    // Radius, width, fill, unused.
    @location(2) @interpolate(flat) size: vec4f,
}

@vertex
fn vs_ring(ring: Ring) -> Drawn {
    let middle = vec3f(ring.place.x, 0.0, ring.place.y);
    let reach = ring.place.z + max(ring.place.w, 4.0 * view.key.w * pixel_size(middle) / max(abs(view.forward.y), 0.08));
    let corner = vec2f(f32(ring.corner & 1u), f32((ring.corner >> 1u) & 1u)) * 2.0 - 1.0;
    var out: Drawn;
    out.at = corner * reach;
    out.clip = view.clip_from_world * vec4f(middle.x + out.at.x, 0.0, middle.z + out.at.y, 1.0);
    out.color = ring.color;
    out.size = vec4f(ring.place.z, ring.place.w, ring.fill, 0.0);
    return out;
}

@fragment
fn fs_ring(in: Drawn) -> @location(0) vec4f {
    let from_middle = length(in.at);
    // Metres that a pixel covers in the direction of the radius.
    let pixel = max(length(vec2f(dpdx(from_middle), dpdy(from_middle))), 1e-6);
    let half_width = max(in.size.y * 0.5, 0.75 * view.key.w * pixel);
    let from_line = abs(from_middle - in.size.x);
    let line = clamp((half_width - from_line) / pixel + 0.5, 0.0, 1.0);
    let inside = clamp((in.size.x - from_middle) / pixel + 0.5, 0.0, 1.0) * in.size.z;
    return vec4f(in.color.rgb, in.color.a * max(line, inside));
}
