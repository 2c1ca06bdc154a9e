// Skinned bodies: one mesh, moved by its joints. Solid bodies, ghosts, and edges.

// Two texels for each joint, 512 joints in a row: the rotation (quaternion, w last); the
// translation in metres, and the joint's colour as red + 256 green + 65,536 blue, each 0 to 255.
@group(2) @binding(0) var joints: texture_2d<f32>;
// The base colour texture of a part of the mesh; white where it has none.
@group(3) @binding(0) var skin_image: texture_2d<f32>;
@group(3) @binding(1) var skin_sampler: sampler;

struct Vertex {
    // Position in the bind pose, metres.
    @location(0) position: vec3f,
    @location(1) normal: vec4f,
    @location(2) joints: vec4u,
    @location(3) weights: vec4f,
    // The mesh's own colour, encoded.
    @location(4) tint: vec4f,
    // The first joint of the figure; the source of its colour: 0 the figure, 1 its joints, 2 the
    // mesh.
    @location(5) figure: vec2u,
    @location(6) color: vec4f,
    // The place in the texture, and the opacity below which a point is left out.
    @location(7) texture: vec3f,
}

struct Surface {
    @builtin(position) @invariant clip: vec4f,
    @location(0) world: vec3f,
    @location(1) normal: vec3f,
    @location(2) color: vec4f,
    // As that of the vertex; and its own opacity, or -1 where the mesh's own colours do not show. At
    // edges it is that of a point on the triangle: beyond a seam lies another part of the image.
    @location(3) @interpolate(perspective, centroid) texture: vec4f,
}

struct Moved {
    world: vec3f,
    normal: vec3f,
    color: vec3f,
}

fn joint_texel(figure: u32, joint: u32, part: u32) -> vec4f {
    let index = figure + joint;
    return textureLoad(joints, vec2u((index % 512u) * 2u + part, index / 512u), 0);
}

fn turned(q: vec4f, v: vec3f) -> vec3f {
    return v + 2.0 * cross(q.xyz, cross(q.xyz, v) + q.w * v);
}

fn product(a: vec4f, b: vec4f) -> vec4f {
    return vec4f(a.w * b.xyz + b.w * a.xyz + cross(a.xyz, b.xyz), a.w * b.w - dot(a.xyz, b.xyz));
}

fn unpacked(color: f32) -> vec3f {
    return vec3f(color % 256.0, floor(color / 256.0) % 256.0, floor(color / 65536.0)) / 255.0;
}

// Returns a vertex moved by its joints. Linear blend skinning takes the mean of the points to which
// the joints move it. Dual quaternion skinning takes the mean of the joints' motions (Kavan,
// Collins, Zara and O'Sullivan, "Skinning with Dual Quaternions", algorithm 1), all in the
// hemisphere of the joint with the largest weight.
fn skinned(vertex: Vertex) -> Moved {
    let dual = view.more.x > 0.5;
    var point = vec3f(0.0);
    var normal = vec3f(0.0);
    var real = vec4f(0.0);
    var moment = vec4f(0.0);
    var color = vec3f(0.0);
    var total = 0.0;
    var pivot = vec4f(0.0, 0.0, 0.0, 1.0);
    for (var k = 0u; k < 4u; k++) {
        let weight = vertex.weights[k];
        if weight <= 0.0 {
            break;
        }
        let rotation = joint_texel(vertex.figure.x, vertex.joints[k], 0u);
        let shift = joint_texel(vertex.figure.x, vertex.joints[k], 1u);
        if k == 0u {
            pivot = rotation;
        }
        if dual {
            let near = select(rotation, -rotation, dot(rotation, pivot) < 0.0);
            real += near * weight;
            moment += product(vec4f(shift.xyz, 0.0), near) * (0.5 * weight);
        } else {
            point += (turned(rotation, vertex.position) + shift.xyz) * weight;
            normal += turned(rotation, vertex.normal.xyz) * weight;
        }
        color += unpacked(shift.w) * weight;
        total += weight;
    }
    var out: Moved;
    if dual {
        let scale = inverseSqrt(max(dot(real, real), 1e-12));
        let unit = real * scale;
        let move_by = product(moment * scale, vec4f(-unit.xyz, unit.w)).xyz * 2.0;
        out.world = turned(unit, vertex.position) + move_by;
        out.normal = turned(unit, vertex.normal.xyz);
    } else {
        out.world = point / max(total, 1e-6);
        out.normal = normalize(normal + vertex.normal.xyz * 1e-6);
    }
    out.color = vertex.color.rgb;
    if vertex.figure.y == 1u {
        out.color = color / max(total, 1e-6);
    } else if vertex.figure.y == 2u {
        out.color = vertex.tint.rgb;
    }
    return out;
}

fn on_texture(vertex: Vertex) -> vec4f {
    return vec4f(vertex.texture, select(-1.0, vertex.tint.a, vertex.figure.y == 2u));
}

@vertex
fn vs_skin(vertex: Vertex) -> Surface {
    let moved = skinned(vertex);
    var out: Surface;
    out.world = moved.world;
    out.normal = moved.normal;
    out.clip = view.clip_from_world * vec4f(moved.world, 1.0);
    out.color = vec4f(moved.color, vertex.color.a);
    out.texture = on_texture(vertex);
    return out;
}

// Draws the skin, grown by the width of an edge, so that its back shows around the body, and where
// a limb passes in front of the trunk.
@vertex
fn vs_skin_edge(vertex: Vertex) -> Surface {
    let moved = skinned(vertex);
    var out: Surface;
    out.world = moved.world + moved.normal * pixel_size(moved.world) * view.style.x;
    out.normal = moved.normal;
    out.clip = view.clip_from_world * vec4f(out.world, 1.0);
    let deeper = view.clip_from_world * vec4f(out.world - towards_eye(out.world) * 0.03, 1.0);
    out.clip.z = deeper.z / deeper.w * out.clip.w;
    out.color = vec4f(moved.color, vertex.color.a);
    out.texture = on_texture(vertex);
    return out;
}

// Draws the depths for the light map.
@vertex
fn vs_skin_cast(vertex: Vertex) -> @builtin(position) vec4f {
    return vec4f(on_map(skinned(vertex).world), 1.0);
}

// Returns the share of the sky that reaches a point. It is less where the body leans over the
// point, and near the shaded ground.
fn sky_on_skin(world: vec3f, normal: vec3f) -> f32 {
    let low = smoothstep(0.35, 0.0, world.y) * (0.5 - 0.5 * normal.y);
    return 1.0 - 0.35 * low;
}

// Returns the linear colour of the texture at a point, and the opacity of the point; white where the
// mesh's own colours do not show. `dx` and `dy` are the derivatives of the place: inside of the
// branch, which neighbouring pixels may not take, there are none.
fn texel_at(place: vec4f, dx: vec2f, dy: vec2f) -> vec4f {
    if place.w < 0.0 {
        return vec4f(1.0);
    }
    return textureSampleGrad(skin_image, skin_sampler, place.xy, dx, dy) * vec4f(1.0, 1.0, 1.0, place.w);
}

fn solid_skin(in: Surface, texel: vec3f) -> vec4f {
    let normal = normalize(in.normal);
    let key = key_on_body(in.world, normal, in.clip.xy);
    let base = to_linear(in.color.rgb) * texel;
    return solid_color(shade(base, in.world, normal, sky_on_skin(in.world, normal), key), in.world, in.clip.xy);
}

@fragment
fn fs_skin(in: Surface) -> @location(0) vec4f {
    return solid_skin(in, texel_at(in.texture, dpdx(in.texture.xy), dpdy(in.texture.xy)).rgb);
}

@fragment
fn fs_skin_cut_out(in: Surface) -> @location(0) vec4f {
    let texel = texel_at(in.texture, dpdx(in.texture.xy), dpdy(in.texture.xy));
    if texel.a < in.texture.z {
        discard;
    }
    return solid_skin(in, texel.rgb);
}

@fragment
fn fs_skin_edge(in: Surface) -> @location(0) vec4f {
    return edge_color(in.world);
}

@fragment
fn fs_skin_edge_cut_out(in: Surface) -> @location(0) vec4f {
    let texel = texel_at(in.texture, dpdx(in.texture.xy), dpdy(in.texture.xy));
    if texel.a < in.texture.z {
        discard;
    }
    return edge_color(in.world);
}

@fragment
fn fs_skin_ghost(in: Surface) -> @location(0) vec4f {
    return ghost_color(in.color, in.world, normalize(in.normal));
}

// For passes that write only depths.
@fragment
fn fs_depth() -> @location(0) vec4f {
    return vec4f(0.0);
}
