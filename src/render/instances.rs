//! Conversion of the parts of a draw list to instances for the GPU.

use super::layout::{
    FigureUniform, LimbInstance, MAX_NEAREST, MAX_NEIGHBOURS, RingInstance, StrokeInstance,
};
use glam::Vec4;
use segue_scene::{Color, Figure, Limb, Ring, Stroke};

/// The distance below which limbs blend into each other, metres.
const BLEND_DISTANCE_M: f32 = 0.02;
/// The end of a list of nearest limbs.
const NONE: u8 = 255;

/// Returns a colour in bytes.
pub(super) fn bytes(color: Color) -> [u8; 4] {
    color.map(|c| (c.clamp(0.0, 1.0) * 255.0 + 0.5) as u8)
}

/// Returns the height of a limb's lower end, metres.
pub(super) fn lowest(limb: &LimbInstance) -> f32 {
    limb.a[1].min(limb.b[1])
}

pub(super) fn limb_instance(limb: &Limb, shadow: f32) -> Option<LimbInstance> {
    let finite = limb.a.is_finite()
        && limb.b.is_finite()
        && limb.radius_a.is_finite()
        && limb.radius_b.is_finite();
    (finite && limb.radius_a >= 0.0 && limb.radius_b >= 0.0).then(|| LimbInstance {
        a: limb.a.extend(limb.radius_a).to_array(),
        b: limb.b.extend(limb.radius_b).to_array(),
        flat: limb.flat.extend(limb.flatness).to_array(),
        color: bytes(limb.color),
        near: [NONE; MAX_NEAREST],
        shadow,
    })
}

pub(super) fn stroke_instance(stroke: &Stroke) -> Option<StrokeInstance> {
    let points = [stroke.before, stroke.from, stroke.to, stroke.after];
    (points.iter().all(|p| p.is_finite()) && stroke.width > 0.0).then(|| StrokeInstance {
        points: points.map(|p| p.to_array()),
        colors: [bytes(stroke.color_from), bytes(stroke.color_to)],
        width: stroke.width,
    })
}

pub(super) fn ring_instance(ring: &Ring) -> Option<RingInstance> {
    (ring.center.is_finite() && ring.radius > 0.0 && ring.width >= 0.0).then(|| RingInstance {
        place: [ring.center.x, ring.center.z, ring.radius, ring.width],
        color: bytes(ring.color),
        fill: ring.fill,
    })
}

pub(super) fn figure_uniform(limbs: &[Limb], figure: &Figure) -> FigureUniform {
    let solid = if figure.ghost { 0.0 } else { 1.0 };
    let mut uniform =
        FigureUniform { about: [solid, 0.0, 0.0, 0.0], neighbours: [[0.0; 4]; 3 * MAX_NEIGHBOURS] };
    for (limb, triple) in limbs.iter().zip(uniform.neighbours.chunks_exact_mut(3)) {
        // The flattening is across the axis, as in the shader.
        let flat =
            limb.flat - limb.flat.project_onto_normalized((limb.b - limb.a).normalize_or_zero());
        let flatness = if flat.length() > 1e-3 { limb.flatness.max(0.05) } else { 1.0 };
        triple[0] = limb.a.extend(limb.radius_a).to_array();
        triple[1] = limb.b.extend(limb.radius_b).to_array();
        triple[2] = flat.normalize_or_zero().extend(flatness).to_array();
    }
    uniform
}

/// Fills in for every instance the indices in `limbs` of those that touch it or take the most light
/// from it. The limbs of a ghost shade nothing, so only touching ones count there.
pub(super) fn find_nearest(limbs: &[Limb], instances: &mut [LimbInstance], ghost: bool) {
    for instance in instances {
        let (a, b) = (Vec4::from(instance.a), Vec4::from(instance.b));
        let points = [a.truncate(), (a.truncate() + b.truncate()) * 0.5, b.truncate()];
        let (half, own_radius) = (points[0].distance(points[2]) * 0.5, a.w.max(b.w));
        let mut scores = [0.0f32; MAX_NEAREST];
        for (index, limb) in limbs.iter().enumerate() {
            let radius = limb.radius_a.max(limb.radius_b);
            // Touching limbs come first, then those that cover the largest angle seen from here.
            let score_at = |distance: f32, gap: f32| {
                if gap < BLEND_DISTANCE_M { 10.0 - gap } else { radius / distance.max(1e-4) }
            };
            let reach = (limb.b - limb.a).length() * 0.5 + half;
            let at_least = points[1].distance((limb.a + limb.b) * 0.5) - reach;
            let too_far = ghost && at_least - own_radius - radius >= BLEND_DISTANCE_M;
            if too_far
                || (at_least > 0.0
                    && score_at(at_least, at_least - own_radius - radius)
                        <= scores[MAX_NEAREST - 1])
            {
                continue;
            }
            let itself = limb.a == points[0]
                && limb.b == points[2]
                && limb.radius_a == a.w
                && limb.radius_b == b.w;
            if itself || limb_instance(limb, 0.0).is_none() {
                continue;
            }
            let span = limb.b - limb.a;
            let scale = span.length_squared().max(1e-9).recip();
            let own_radii = [a.w, 0.5 * (a.w + b.w), b.w];
            // The score is the best of both ends and the middle, each with the radii there.
            let score = (0..3).map(|i| {
                let t = ((points[i] - limb.a).dot(span) * scale).clamp(0.0, 1.0);
                let distance = points[i].distance(limb.a + span * t);
                let here = limb.radius_a + (limb.radius_b - limb.radius_a) * t;
                score_at(distance, distance - own_radii[i] - here)
            });
            let score = score.fold(0.0, f32::max);
            // Insert into the list in descending order.
            if score > scores[MAX_NEAREST - 1] && (score > 5.0 || !ghost) {
                let at = scores.partition_point(|&s| s >= score);
                scores[at..].rotate_right(1);
                instance.near[at..].rotate_right(1);
                scores[at] = score;
                instance.near[at] = index as u8;
            }
        }
    }
}
