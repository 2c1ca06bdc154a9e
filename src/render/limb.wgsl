// Limbs: one mesh of a rounded cone, bent to each limb. Solid bodies, ghosts, and edges.

struct Figure {
    // 1 for a solid body; the rest is unused.
    about: vec4f,
    // Three for each limb of the body: centre and radius of its first ball, of its second,
    // direction and scale of its flattening.
    neighbours: array<vec4f, 144>,
}

@group(2) @binding(0) var<uniform> figure: Figure;

struct Limb {
    // Cosine and sine about the axis; position from the seam (0) to the pole (1); the ball (0 or
    // 1).
    @location(0) mesh: vec4f,
    // Centre and radius of the two balls.
    @location(1) a: vec4f,
    @location(2) b: vec4f,
    // Direction and scale of the flattening.
    @location(3) flat_axis: vec4f,
    @location(4) color: vec4f,
    // The indices of the nearest limbs of the body; 255 ends the list.
    @location(5) near_a: vec4u,
    @location(6) near_b: vec4u,
    @location(7) near_c: vec4u,
    @location(8) near_d: vec4u,
    @location(9) near_e: vec4u,
}

struct Surface {
    @builtin(position) @invariant clip: vec4f,
    @location(0) world: vec3f,
    @location(1) normal: vec3f,
    @location(2) color: vec4f,
    @location(3) @interpolate(flat) near_a: vec4u,
    @location(4) @interpolate(flat) near_b: vec4u,
    @location(5) @interpolate(flat) near_c: vec4u,
    @location(6) @interpolate(flat) near_d: vec4u,
    @location(7) @interpolate(flat) near_e: vec4u,
}

struct Bent {
    world: vec3f,
    normal: vec3f,
}

fn bend(limb: Limb) -> Bent {
    let span = limb.b.xyz - limb.a.xyz;
    let len = length(span);
    let has_axis = len > 1e-6;
    var axis = vec3f(0.0, 1.0, 0.0);
    if has_axis {
        axis = span / len;
    }
    // The flattening is across the axis; a ball is flattened along the given direction.
    var flat_axis = limb.flat_axis.xyz;
    if has_axis {
        flat_axis = flat_axis - axis * dot(flat_axis, axis);
    }
    let flat_length = length(flat_axis);
    var squash = limb.flat_axis.w;
    if flat_length > 1e-3 {
        flat_axis = flat_axis / flat_length;
    } else {
        flat_axis = vec3f(0.0);
        squash = 1.0;
    }
    var side = cross(axis, select(vec3f(1.0, 0.0, 0.0), vec3f(0.0, 0.0, 1.0), abs(axis.x) > 0.7));
    if has_axis && flat_length > 1e-3 {
        side = flat_axis;
    }
    side = normalize(side);
    let other = cross(axis, side);

    // Both balls touch the hull where its normal is inclined by `tilt` against the cross-section.
    // The caps begin there.
    let tilt = asin(clamp((limb.a.w - limb.b.w) / max(len, 1e-6), -1.0, 1.0));
    let pole = select(-1.5707963, 1.5707963, limb.mesh.w > 0.5);
    let angle = mix(tilt, pole, limb.mesh.z);
    let unit = (side * limb.mesh.x + other * limb.mesh.y) * cos(angle) + axis * sin(angle);
    let ball = select(limb.a, limb.b, limb.mesh.w > 0.5);
    let offset = ball.xyz - limb.a.xyz + unit * ball.w;
    var out: Bent;
    out.world = limb.a.xyz + offset + flat_axis * dot(offset, flat_axis) * (squash - 1.0);
    out.normal = normalize(unit + flat_axis * dot(unit, flat_axis) * (1.0 / max(squash, 0.05) - 1.0));
    return out;
}

@vertex
fn vs_limb(limb: Limb) -> Surface {
    let bent = bend(limb);
    var out: Surface;
    out.world = bent.world;
    out.normal = bent.normal;
    out.clip = view.clip_from_world * vec4f(bent.world, 1.0);
    out.color = limb.color;
    out.near_a = limb.near_a;
    out.near_b = limb.near_b;
    out.near_c = limb.near_c;
    out.near_d = limb.near_d;
    out.near_e = limb.near_e;
    return out;
}

// Draws the hull, grown by the width of an edge, so that its back shows around the limb. It is a
// little deeper than the limb, so that edges are drawn where one limb passes in front of another,
// and not where limbs blend.
@vertex
fn vs_edge(limb: Limb) -> Surface {
    let bent = bend(limb);
    var out: Surface;
    out.world = bent.world + bent.normal * pixel_size(bent.world) * view.style.x;
    out.normal = bent.normal;
    out.clip = view.clip_from_world * vec4f(out.world, 1.0);
    let deeper = view.clip_from_world * vec4f(out.world - towards_eye(out.world) * 0.03, 1.0);
    out.clip.z = deeper.z / deeper.w * out.clip.w;
    out.color = limb.color;
    out.near_a = limb.near_a;
    out.near_b = limb.near_b;
    out.near_c = limb.near_c;
    out.near_d = limb.near_d;
    out.near_e = limb.near_e;
    return out;
}

struct Around {
    // Normal of the body, blended between its limbs.
    normal: vec3f,
    // The share of the sky that the body's other limbs leave visible, 0 to 1.
    sky: f32,
}

// Returns the influence of the other limbs of the body on a point of its surface.
//
// The normal is the mean over every limb within a third of its radius, weighted by the nearness of
// its surface, so that seams between limbs vanish like in clay. The sky is the closed form of a
// ball in front of the sky (Quilez, "Sphere ambient occlusion"), for the nearest ball in each limb.
fn look_around(in: Surface) -> Around {
    let world = in.world;
    let normal = normalize(in.normal);
    var melted = normal;
    var sky = 1.0;
    var near = array<vec4u, 5>(in.near_a, in.near_b, in.near_c, in.near_d, in.near_e);
    for (var k = 0u; k < 20u; k++) {
        let i = near[k / 4u][k % 4u];
        if i > 47u {
            break;
        }
        let a = figure.neighbours[3u * i];
        let b = figure.neighbours[3u * i + 1u];
        let from_a = world - a.xyz;
        let span = b.xyz - a.xyz;
        // The flattening is undone, and the nearest ball of the round limb found: the line from it
        // to the point is perpendicular to the cone's side.
        let flattening = figure.neighbours[3u * i + 2u];
        let round = from_a + flattening.xyz * dot(from_a, flattening.xyz) * (1.0 / flattening.w - 1.0);
        let len = max(length(span), 1e-5);
        let axis = span / len;
        let height = dot(round, axis);
        let slope = clamp((a.w - b.w) / len, -0.98, 0.98);
        let away = sqrt(max(dot(round, round) - height * height, 0.0));
        let t = clamp((height - away * slope * inverseSqrt(1.0 - slope * slope)) / len, 0.0, 1.0);
        let radius = mix(a.w, b.w, t);
        let outward = round - span * t;
        let gap = max((length(outward) - radius) * flattening.w, 0.0);
        let other = normalize(outward + flattening.xyz * dot(outward, flattening.xyz) * (1.0 / flattening.w - 1.0) + normal * 1e-6);
        let closeness = max(1.0 - gap / clamp(radius * 0.42, 0.004, 0.034), 0.0);
        melted += other * closeness * closeness * smoothstep(-0.3, 0.3, dot(other, normal));

        if figure.about.x < 0.5 {
            continue;
        }
        let ball = radius * (0.5 + 0.5 * flattening.w);
        let to_ball = span * t - from_a;
        let distance = max(length(to_ball), 1e-5);
        let ratio = min(ball / distance, 1.0);
        // Limbs that blend are one surface, which does not shade itself. Otherwise the seam would
        // show.
        sky *= 1.0 - max(dot(normal, to_ball) / distance, 0.0) * ratio * ratio * smoothstep(0.0, 0.04, gap);
    }
    return Around(normalize(melted), sky);
}

@fragment
fn fs_solid(in: Surface) -> @location(0) vec4f {
    let around = look_around(in);
    let key = key_on_body(in.world, around.normal, in.clip.xy);
    return solid_color(shade(to_linear(in.color.rgb), in.world, around.normal, around.sky, key), in.world, in.clip.xy);
}

@fragment
fn fs_edge(in: Surface) -> @location(0) vec4f {
    return edge_color(in.world);
}

@fragment
fn fs_ghost(in: Surface) -> @location(0) vec4f {
    return ghost_color(in.color, in.world, look_around(in).normal);
}

// Draws the depths for the light map.
@vertex
fn vs_cast(limb: Limb) -> @builtin(position) vec4f {
    return vec4f(on_map(bend(limb).world), 1.0);
}

// For passes that write only depths.
@fragment
fn fs_depth() -> @location(0) vec4f {
    return vec4f(0.0);
}
