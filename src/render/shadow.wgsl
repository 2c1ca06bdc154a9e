// The soft shadow of one limb on the ground, under a wide light overhead.
//
// It is the limb's outline from above, blurred by a normal distribution that widens with the height
// above the ground: crisp under a planted foot, faint under the head. The target's alpha begins at
// 1 and is the share of light that is left.

struct Limb {
    @builtin(vertex_index) corner: u32,
    @builtin(instance_index) index: u32,
    @location(1) a: vec4f,
    @location(2) b: vec4f,
    @location(3) flat_axis: vec4f,
    // The strength of the shadow, 0 to 1.
    @location(10) strength: f32,
}

struct Blot {
    @builtin(position) clip: vec4f,
    // Position along and across the limb, metres from `a`.
    @location(0) at: vec2f,
    // Length on the ground, radius of a and b, strength.
    @location(1) @interpolate(flat) size: vec4f,
    // Width of the blur at a and b, and of an upright limb; a pseudorandom number of the limb.
    @location(2) @interpolate(flat) blur: vec4f,
}

fn blur_at(height: f32) -> f32 {
    return 0.012 + 0.26 * max(height, 0.0);
}

@vertex
fn vs_shadow(limb: Limb) -> Blot {
    let thin = mix(0.55, 1.0, limb.flat_axis.w);
    let radius = vec2f(limb.a.w, limb.b.w) * thin;
    let low = vec2f(limb.a.y - radius.x, limb.b.y - radius.y);
    let blur = vec2f(blur_at(low.x), blur_at(low.y));
    let span = limb.b.xz - limb.a.xz;
    let len = length(span);
    var along = vec2f(1.0, 0.0);
    if len > 1e-5 {
        along = span / len;
    }
    let across = vec2f(-along.y, along.x);
    let margin = max(radius.x + 2.6 * blur.x, radius.y + 2.6 * blur.y);
    // Two triangles.
    let corner = vec2f(f32(limb.corner & 1u), f32((limb.corner >> 1u) & 1u));
    let at = vec2f(mix(-margin, len + margin, corner.x), mix(-margin, margin, corner.y));
    let ground = limb.a.xz + along * at.x + across * at.y;
    var out: Blot;
    out.clip = view.clip_from_world * vec4f(ground.x, 0.0, ground.y, 1.0);
    out.at = at;
    out.size = vec4f(len, radius, limb.strength);
    out.blur = vec4f(blur, mix(min(blur.x, blur.y), max(blur.x, blur.y), 0.3), f32(limb.index % 61u));
    return out;
}

// Returns the error function, to 4e-4.
fn erf(x: f32) -> f32 {
    let y = clamp(x, -3.0, 3.0);
    return tanh(1.1283792 * y + 0.1009 * y * y * y);
}

// Returns the value at 0 of a box from `low` to `high` that is blurred by `sigma`.
fn blurred_box(low: f32, high: f32, sigma: f32) -> f32 {
    let scale = 0.70710678 / sigma;
    return 0.5 * (erf(high * scale) - erf(low * scale));
}

@fragment
fn fs_shadow(in: Blot) -> @location(0) vec4f {
    let len = in.size.x;
    let t = clamp(in.at.x / max(len, 1e-5), 0.0, 1.0);
    let radius = mix(in.size.y, in.size.z, t);
    // The lower part of an upright limb darkens the ground most.
    let lying = smoothstep(0.5, 1.5, len / max(in.size.y, in.size.z));
    let sigma = mix(in.blur.z, mix(in.blur.x, in.blur.y, t), lying);
    let across = blurred_box(-radius - in.at.y, radius - in.at.y, sigma);
    let along = blurred_box(-0.85 * in.size.y - in.at.x, len + 0.85 * in.size.z - in.at.x, sigma);
    // High limbs only dim a wide area, because light passes around them.
    let high = mix(1.0, 0.42, smoothstep(0.05, 0.45, sigma / 0.26));
    let dark = clamp(across * along, 0.0, 1.0) * high * in.size.w;
    // Noise of its own for each limb hides the steps of 8 bits. The same noise for all would add
    // up.
    let noise = dither(in.clip.xy + 17.0 * in.blur.w) * smoothstep(0.0, 3.0 / 255.0, dark);
    return vec4f(0.0, 0.0, 0.0, dark + noise);
}
