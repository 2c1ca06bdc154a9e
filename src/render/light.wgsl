// The light on bodies and on the ground: the shadows of the main light, by a map of depths, and the
// shading of clay.

@group(1) @binding(0) var light_map: texture_depth_2d;
@group(1) @binding(1) var light_compare: sampler_comparison;
// The same texture, to read its depths.
@group(1) @binding(2) var light_depths: texture_2d<f32>;
// WebGL takes a depth texture without a sampler for incomplete.
@group(1) @binding(3) var light_exactly: sampler;

// Returns the position of a point in the pane's part of the map: -1 to 1 to the right and up, depth
// 0 to 1 away from the light.
fn on_map(world: vec3f) -> vec3f {
    let from_center = world - view.light_center.xyz;
    let across = vec2f(dot(from_center, view.light_right.xyz), dot(from_center, view.light_up.xyz)) / view.light_center.w;
    return vec3f(across, 0.5 - 0.5 * dot(from_center, view.key.xyz) / view.light_right.w);
}

// Returns the texture coordinates of a point of the map that is moved by `metres`.
fn map_uv(at: vec3f, metres: vec2f) -> vec2f {
    let place = at.xy + metres / view.light_center.w;
    let inside = clamp(place * vec2f(0.5, -0.5) + 0.5, vec2f(0.002), vec2f(0.998));
    return view.light_tile.xy + inside * view.light_tile.zw;
}

// Returns one of `count` points of even density on a disk, which is rotated by `turn` radians
// (Vogel, "A better way to construct the sunflower head").
fn disk_point(index: u32, count: f32, turn: f32) -> vec2f {
    let angle = f32(index) * 2.3999632 + turn;
    return sqrt((f32(index) + 0.5) / count) * vec2f(cos(angle), sin(angle));
}

// Returns a pseudorandom rotation for a pixel.
fn turn_of(pixel: vec2f) -> f32 {
    return 6.2831853 * fract(52.9829189 * fract(dot(floor(pixel), vec2f(0.06711056, 0.00583715))));
}

// Returns the share of the main light that reaches a point of a body, 0 to 1. The softness of the
// edge is that of a shadow cast from a hand's breadth away.
fn key_on_body(world: vec3f, normal: vec3f, pixel: vec2f) -> f32 {
    if view.light_up.w < 0.5 {
        return 1.0;
    }
    // The point is moved off the surface, so that it does not shade itself: the farther, the
    // flatter the light falls on it.
    let facing = dot(normal, view.key.xyz);
    let radius = 2.5 * view.light_tile_metres.x + 0.006;
    let at = on_map(world + normal * (radius * (1.1 - 0.5 * clamp(facing, 0.0, 1.0))));
    if any(abs(at.xy) > vec2f(0.999)) {
        return 1.0;
    }
    let turn = turn_of(pixel);
    let depth = at.z - 0.004 * 0.5 / view.light_right.w;
    var lit = 0.0;
    for (var i = 0u; i < 12u; i++) {
        lit += textureSampleCompareLevel(light_map, light_compare, map_uv(at, disk_point(i, 12.0, turn) * radius), depth);
    }
    // Surfaces that face away from the light are dark without the map, whose steps would show.
    return mix(1.0, lit / 12.0, smoothstep(-0.05, 0.30, facing));
}

// Returns the share of the main light that reaches a point of the ground, 0 to 1. A shadow is crisp
// under a foot, and softer with the distance of the body that casts it (Fernando,
// "Percentage-Closer Soft Shadows").
fn key_on_ground(world: vec3f, pixel: vec2f) -> f32 {
    let at = on_map(world);
    let turn = turn_of(pixel);
    let spread = view.light_tile_metres.y;
    let farthest = max(view.light_tile_metres.z, 3.0 * view.light_tile_metres.x);
    var above = 0.0;
    var found = 0.0;
    for (var i = 0u; i < 14u; i++) {
        let depth = textureSampleLevel(light_depths, light_exactly, map_uv(at, disk_point(i, 14.0, turn) * farthest), 0.0).r;
        let hides = select(0.0, 1.0, depth < at.z);
        above += hides * (at.z - depth);
        found += hides;
    }
    if found < 0.5 {
        return 1.0;
    }
    let distance = above / found * 2.0 * view.light_right.w;
    let radius = clamp(distance * spread, 1.3 * view.light_tile_metres.x, farthest);
    var lit = 0.0;
    for (var i = 0u; i < 28u; i++) {
        lit += textureSampleCompareLevel(light_map, light_compare, map_uv(at, disk_point(i, 28.0, turn) * radius), at.z);
    }
    return lit / 28.0;
}

struct Shade {
    linear: vec3f,
    // 0 where the surface faces the camera, 1 at the silhouette.
    rim: f32,
}

// Shades clay of a linear colour. `sky_seen` and `key_seen` are the shares of the sky and of the
// main light that reach the point.
fn shade(base: vec3f, world: vec3f, normal: vec3f, sky_seen: f32, key_seen: f32) -> Shade {
    let to_eye = towards_eye(world);
    let facing = clamp(dot(normal, to_eye), 0.0, 1.0);
    var out: Shade;
    let rim = 1.0 - facing;
    out.rim = rim * rim;

    // The flat look: two tones with a line between them.
    if view.style.z > 0.5 {
        let lit = smoothstep(-0.02, 0.02, dot(normal, view.key.xyz) - 0.24) * smoothstep(0.45, 0.55, key_seen);
        out.linear = base * mix(0.62, 1.0, lit);
        return out;
    }

    // A broad main light from above the camera's shoulder, wrapped softly around; sky from above,
    // light of the floor from below.
    let key = pow(clamp((dot(normal, view.key.xyz) + 0.35) / 1.35, 0.0, 1.0), 1.7) * key_seen;
    let upward = normal.y * 0.5 + 0.5;
    let near_floor = exp(-max(world.y, 0.0) * 4.0);
    let under = mix(0.15, 0.10, near_floor) * vec3f(1.0, 0.985, 0.97);
    let sky = mix(under, vec3f(0.29, 0.31, 0.355), upward) * sky_seen;
    let right = normalize(view.right.xyz);
    let fill = clamp(dot(normal, normalize(right - view.forward.xyz)), 0.0, 1.0) * 0.08 * sky_seen;
    let light = sky + fill * vec3f(0.85, 0.94, 1.0) + key * 0.80 * vec3f(1.0, 0.985, 0.955);

    let half_way = normalize(view.key.xyz + to_eye);
    let gloss = pow(clamp(dot(normal, half_way), 0.0, 1.0), 30.0) * 0.06 * key_seen;
    // A cool light from behind on the shadow's side separates the body from the background.
    let behind = normalize(right * 0.75 + vec3f(0.0, 0.55, 0.0) + view.forward.xyz * 0.6);
    let edge_light = smoothstep(0.25, 0.95, rim) * clamp(dot(normal, behind), 0.0, 1.0) * view.style.w * sky_seen;

    out.linear = base * (light + edge_light * vec3f(0.86, 0.94, 1.0)) + gloss;
    return out;
}

// Fades the parts of a body below the ground, which are faintly visible through it.
fn sink(color: vec3f, world: vec3f) -> vec3f {
    let depth = smoothstep(-0.008, -0.03, world.y);
    return mix(color, to_linear(view.floor.rgb), depth * 0.72);
}

// Returns the colour of a solid body, which is darker towards its silhouette.
fn solid_color(lit: Shade, world: vec3f, pixel: vec2f) -> vec4f {
    let rimmed = lit.linear * (1.0 - view.style.y * smoothstep(0.06, 0.85, lit.rim));
    return vec4f(to_srgb(sink(rimmed, world)) + dither(pixel), 1.0);
}

// Returns the colour of an edge, which fades where the body enters the ground.
fn edge_color(world: vec3f) -> vec4f {
    return vec4f(view.edge.rgb, view.edge.a * smoothstep(-0.02, 0.0, world.y));
}

// Returns the colour of a ghost, which is denser at the rim, like a shell of tinted glass.
fn ghost_color(color: vec4f, world: vec3f, normal: vec3f) -> vec4f {
    let base = to_linear(color.rgb);
    let lit = shade(base, world, normal, 1.0, 1.0);
    let tinted = mix(base, lit.linear * 1.15, 0.45);
    let density = clamp(color.a * (0.80 + 0.75 * lit.rim * lit.rim), 0.0, 1.0);
    let over_ground = mix(0.45, 1.0, smoothstep(-0.02, 0.0, world.y));
    return vec4f(to_srgb(tinted), density * over_ground);
}
