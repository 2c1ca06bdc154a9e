// Lines of even width on the screen, mitred where pieces meet and rounded at free ends.

struct Stroke {
    @builtin(vertex_index) corner: u32,
    @location(0) before: vec3f,
    @location(1) start: vec3f,
    @location(2) end: vec3f,
    @location(3) after: vec3f,
    @location(4) color_start: vec4f,
    @location(5) color_end: vec4f,
    // Width in points.
    @location(6) width: f32,
}

struct Inked {
    @builtin(position) clip: vec4f,
    @location(0) color: vec4f,
    // Pixels across the line and along it from its start.
    @location(1) at: vec2f,
    // Half the width and the length in pixels; 1 for each free end.
    @location(2) @interpolate(flat) size: vec4f,
}

// Moves a point in front of the near plane along the line to `other`, up to the plane.
fn clip_near(point: vec3f, other: vec3f) -> vec3f {
    let near = view.forward.w * 1.01;
    let depth = dot(point - view.eye.xyz, view.forward.xyz);
    let other_depth = dot(other - view.eye.xyz, view.forward.xyz);
    if view.eye.w > 0.5 || depth >= near || other_depth <= depth {
        return point;
    }
    return mix(point, other, min((near - depth) / (other_depth - depth), 1.0));
}

fn to_pixels(clip: vec4f) -> vec2f {
    return clip.xy / max(clip.w, 1e-6) * view.viewport.zw * 0.5;
}

fn unit_or(v: vec2f, fallback: vec2f) -> vec2f {
    let len = length(v);
    return select(fallback, v / max(len, 1e-6), len > 1e-3);
}

@vertex
fn vs_line(stroke: Stroke) -> Inked {
    let start = clip_near(stroke.start, stroke.end);
    let end = clip_near(stroke.end, stroke.start);
    let clip_start = view.clip_from_world * vec4f(start, 1.0);
    let clip_end = view.clip_from_world * vec4f(end, 1.0);
    let a = to_pixels(clip_start);
    let b = to_pixels(clip_end);
    let along = unit_or(b - a, vec2f(1.0, 0.0));
    let normal = vec2f(-along.y, along.x);

    let at_end = (stroke.corner & 1u) == 1u;
    let side = select(-1.0, 1.0, (stroke.corner & 2u) == 2u);
    let free_start = distance(stroke.before, stroke.start) < 1e-6;
    let free_end = distance(stroke.after, stroke.end) < 1e-6;
    let free = select(free_start, free_end, at_end);

    let half_width = 0.5 * stroke.width * view.key.w;
    let reach = half_width + 1.0;
    var offset = normal * side * reach;
    if free {
        offset += along * select(-reach, reach, at_end);
    } else {
        // The neighbour's direction on the screen, from the visible side.
        let near_point = select(start, end, at_end);
        let neighbour = clip_near(select(stroke.before, stroke.after, at_end), near_point);
        let c = to_pixels(view.clip_from_world * vec4f(neighbour, 1.0));
        let other = unit_or(select(a - c, c - b, at_end), along);
        let mitre = unit_or(normal + vec2f(-other.y, other.x), normal);
        let stretch = dot(mitre, normal);
        if stretch > 0.45 {
            offset = mitre * (side * reach / stretch);
        }
    }
    let corner = select(a, b, at_end) + offset;
    let clip = select(clip_start, clip_end, at_end);
    var out: Inked;
    // Divided here, so that the position along and across the line is interpolated linearly on the
    // screen.
    out.clip = vec4f(corner / (view.viewport.zw * 0.5), clip.z / max(clip.w, 1e-6), 1.0);
    out.color = select(stroke.color_start, stroke.color_end, at_end);
    out.at = vec2f(side * reach, dot(corner - a, along));
    out.size = vec4f(half_width, distance(a, b), f32(free_start), f32(free_end));
    return out;
}

@fragment
fn fs_line(in: Inked) -> @location(0) vec4f {
    // The distance to the end counts past a free end, and the distance across elsewhere.
    let past_start = max(-in.at.y, 0.0) * in.size.z;
    let past_end = max(in.at.y - in.size.y, 0.0) * in.size.w;
    let from_line = length(vec2f(in.at.x, max(past_start, past_end)));
    // A line of less than a pixel is drawn a pixel wide, and fainter.
    let half_width = max(in.size.x, 0.5);
    let cover = clamp(half_width + 0.5 - from_line, 0.0, 1.0) * min(in.size.x / half_width, 1.0);
    if cover <= 0.004 {
        discard;
    }
    return vec4f(in.color.rgb, in.color.a * cover);
}
