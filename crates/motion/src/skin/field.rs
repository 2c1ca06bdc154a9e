//! The surface around a set of rounded cones, as the zero of a field: negative inside, and
//! approximately the distance in metres near the surface.
//!
//! Shapes blend with each other where they meet (the quadratic smooth minimum of Quilez, "Smooth
//! minimum"), but only neighbours in the tree, and only as far as their surfaces differ in
//! direction, because two parts of one straight limb must not bulge where they meet (the idea of
//! Gourmel et al., "A Gradient-Based Implicit Blend", 2013).

use super::placed_shape::PlacedShape;
use glam::Vec3;

/// The width over which the surfaces of two neighbours blend, in radii of the thinner one.
const BLEND: f32 = 0.75;
/// The difference of normals from which on surfaces blend fully (1 − cosine; 70°).
const FULL_BLEND: f32 = 0.66;
/// The least flatness of a shape, and the inverse of the greatest. The field is at most the
/// distance from a flattened shape divided by this, and at least the distance times this.
const MIN_FLATNESS: f32 = 0.1;

/// A rounded cone with precomputed measures.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cone {
    a: Vec3,
    /// Unit vector from `a` to `b`, and their distance.
    along: Vec3,
    length: f32,
    radius_a: f32,
    /// The decrease of the radius from `a` to `b`.
    fall: f32,
    /// Tangent of the angle between the surface and the axis.
    lean: f32,
    flat: Vec3,
    flatness: f32,
}

/// The distance of a point from a shape.
#[derive(Clone, Copy, Debug)]
pub(super) struct ShapeDistance {
    /// Metres, negative inside; accurate to first order.
    pub(super) distance: f32,
    /// Unit vector away from the shape.
    pub(super) normal: Vec3,
    /// The radius at the nearest point.
    radius: f32,
    /// A lower bound of the distance, for any flatness.
    at_least: f32,
    /// The position of the nearest point along the axis, 0 at `a` to 1 at `b`.
    pub(super) share: f32,
}

impl Cone {
    pub(super) fn new(shape: &PlacedShape) -> Self {
        let (along, length) = (shape.b - shape.a)
            .try_normalize()
            .map_or((Vec3::Y, 0.0), |along| (along, shape.a.distance(shape.b)));
        let fall = shape.radius_a - shape.radius_b;
        // If one ball contains the other, only the larger one is visible.
        let (a, length, radius_a, fall) = if fall.abs() >= 0.98 * length {
            let a = if fall > 0.0 { shape.a } else { shape.b };
            (a, 0.0, shape.radius_a.max(shape.radius_b), 0.0)
        } else {
            (shape.a, length, shape.radius_a, fall)
        };
        let sine = if length > 0.0 { fall / length } else { 0.0 };
        let across =
            if length > 0.0 { shape.flat.reject_from_normalized(along) } else { shape.flat };
        let flat = across.try_normalize();
        Self {
            a,
            along,
            length,
            radius_a,
            fall,
            lean: sine / (1.0 - sine * sine).sqrt(),
            flat: flat.unwrap_or(Vec3::ZERO),
            flatness: flat
                .map_or(1.0, |_| shape.flatness.clamp(MIN_FLATNESS, MIN_FLATNESS.recip())),
        }
    }

    /// Returns half of the thickness in the middle, in the thinnest direction.
    pub(super) fn thinness(&self) -> f32 {
        (self.radius_a - 0.5 * self.fall) * self.flatness.min(1.0)
    }

    /// Returns the radius at a share of the length, in the thickest direction.
    pub(super) fn radius(&self, share: f32) -> f32 {
        self.radius_a - self.fall * share
    }

    /// Returns the greatest radius.
    fn thickest(&self) -> f32 {
        self.radius_a.max(self.radius_a - self.fall)
    }

    /// Returns the approximate area of the surface, square metres.
    pub(super) fn area(&self) -> f32 {
        let radius = self.radius_a - 0.5 * self.fall;
        std::f32::consts::TAU * radius * (self.length + 2.0 * radius)
    }

    /// Returns the bounding box: corners with the least and the greatest coordinates.
    fn bounds(&self) -> [Vec3; 2] {
        let b = self.a + self.along * self.length;
        let [reach_a, reach_b] = [self.radius_a, self.radius_a - self.fall]
            .map(|radius| Vec3::splat(radius * self.flatness.max(1.0)));
        [(self.a - reach_a).min(b - reach_b), (self.a + reach_a).max(b + reach_b)]
    }

    /// Returns the point of the axis at a share of its length.
    pub(super) fn at(&self, share: f32) -> Vec3 {
        self.a + self.along * (self.length * share)
    }

    pub(super) fn measure(&self, point: Vec3) -> ShapeDistance {
        let offset = point - self.a;
        // In a space in which the shape is round.
        let stretch = self.flatness.recip() - 1.0;
        let round = offset + self.flat * (offset.dot(self.flat) * stretch);
        let up = round.dot(self.along);
        let beside = (round - self.along * up).length();
        let at = (up - beside * self.lean).clamp(0.0, self.length);
        let share = if self.length > 0.0 { at / self.length } else { 0.0 };
        let radius = self.radius_a - self.fall * share;
        let outwards = round - self.along * at;
        let away = outwards.normalize_or(self.along.any_orthonormal_vector());
        let distance = outwards.length() - radius;
        let gradient = away + self.flat * (away.dot(self.flat) * stretch);
        let steepness = gradient.length().max(1e-6);
        ShapeDistance {
            distance: distance / steepness,
            normal: gradient / steepness,
            radius,
            at_least: distance * self.flatness.min(1.0),
            share,
        }
    }
}

/// Cones, and the pairs that may blend.
#[derive(Clone, Debug)]
pub(super) struct Field {
    pub(super) cones: Vec<Cone>,
    /// For each pair of cones whether they are neighbours, row by row.
    neighbours: Vec<bool>,
}

/// Bounds of the field around a point.
#[derive(Clone, Copy, Debug)]
pub(super) struct FieldBounds {
    /// A lower bound of the field at the point, metres.
    pub(super) least: f32,
    /// The smallest of the sizes of shapes with a surface near the point; infinite where there is
    /// none.
    pub(super) size: f32,
}

/// The field at a point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sample {
    pub(super) value: f32,
    /// Unit vector outwards.
    pub(super) normal: Vec3,
}

impl Field {
    /// Returns the field of these cones. `are_neighbours` is called once for each pair of indices
    /// into `cones`.
    pub(super) fn new(
        cones: Vec<Cone>,
        mut are_neighbours: impl FnMut(usize, usize) -> bool,
    ) -> Self {
        let count = cones.len();
        let mut neighbours = vec![false; count * count];
        for i in 0..count {
            for j in 0..i {
                let is = are_neighbours(i, j);
                neighbours[i * count + j] = is;
                neighbours[j * count + i] = is;
            }
        }
        Self { cones, neighbours }
    }

    /// Returns the bounding box of the surface: corners with the least and the greatest
    /// coordinates; `None` without shapes.
    pub(super) fn bounds(&self) -> Option<[Vec3; 2]> {
        let [low, high] = self
            .cones
            .iter()
            .map(Cone::bounds)
            .reduce(|[low, high], [a, b]| [low.min(a), high.max(b)])?;
        // A blend may extend beyond both of its shapes.
        let blend =
            Vec3::splat(0.25 * BLEND * self.cones.iter().map(Cone::thickest).fold(0.0, f32::max));
        Some([low - blend, high + blend])
    }

    /// Returns the field at a point, computed from the shapes in `near` alone. `scratch` is a
    /// reusable buffer.
    pub(super) fn sample(
        &self,
        point: Vec3,
        near: &[u16],
        scratch: &mut Vec<(usize, ShapeDistance)>,
    ) -> Sample {
        scratch.clear();
        scratch.extend(
            near.iter()
                .map(|&index| (usize::from(index), self.cones[usize::from(index)].measure(point))),
        );
        let nearest =
            scratch.iter().map(|(_, measured)| measured.distance).fold(f32::INFINITY, f32::min);
        scratch.retain(|(_, measured)| measured.distance <= nearest + BLEND * measured.radius);
        let mut best = Sample { value: f32::INFINITY, normal: Vec3::Y };
        for &(i, one) in scratch.iter() {
            let mut sum = Sample { value: one.distance, normal: one.normal };
            for &(j, other) in scratch.iter() {
                if self.neighbours[i * self.cones.len() + j] {
                    let turn = ((1.0 - sum.normal.dot(other.normal)) / FULL_BLEND).min(1.0);
                    sum = smooth_min(sum, other, BLEND * one.radius.min(other.radius) * turn);
                }
            }
            if sum.value < best.value {
                best = sum;
            }
        }
        best
    }

    /// Returns bounds of the field within `reach` of `center`, and puts the shapes of `near` that
    /// affect it there into `out`. `scratch` is a reusable buffer.
    pub(super) fn narrowed(
        &self,
        center: Vec3,
        reach: f32,
        near: &[u16],
        sizes: &[f32],
        out: &mut Vec<u16>,
        scratch: &mut Vec<(usize, ShapeDistance)>,
    ) -> FieldBounds {
        let mut around = FieldBounds { least: f32::INFINITY, size: f32::INFINITY };
        let mut nearest = f32::INFINITY;
        scratch.clear();
        for &index in near {
            let measured = self.cones[usize::from(index)].measure(center);
            scratch.push((usize::from(index), measured));
            let at_least = measured.at_least.min(measured.distance);
            nearest = nearest.min(measured.distance.max(measured.at_least));
            around.least = around
                .least
                .min(at_least - 0.25 * BLEND * self.cones[usize::from(index)].thickest());
            if measured.distance.abs() < 1.2 * reach {
                around.size = around.size.min(sizes[usize::from(index)]);
            }
        }
        let matter = near.iter().zip(scratch.iter()).filter(|(_, (index, measured))| {
            measured.at_least.min(measured.distance)
                <= nearest + 2.0 * reach + BLEND * self.cones[*index].thickest()
        });
        out.clear();
        out.extend(matter.map(|(&index, _)| index));
        around
    }

    /// Returns the shape with the surface nearest to a point, and the position along its axis.
    pub(super) fn nearest(&self, point: Vec3, near: &[u16]) -> Option<(usize, f32)> {
        let measured = near
            .iter()
            .map(|&index| (usize::from(index), self.cones[usize::from(index)].measure(point)));
        let nearest = measured.min_by(|(_, x), (_, y)| x.distance.total_cmp(&y.distance))?;
        Some((nearest.0, nearest.1.share))
    }
}

fn smooth_min(a: Sample, b: ShapeDistance, width: f32) -> Sample {
    let overlap =
        if width > 1e-9 { (width - (a.value - b.distance).abs()).max(0.0) / width } else { 0.0 };
    // The share of `b`: 1 where it is nearer by the width, a half where both are equally near.
    let share = if width > 1e-9 {
        (0.5 + 0.5 * (a.value - b.distance) / width).clamp(0.0, 1.0)
    } else {
        f32::from(u8::from(b.distance < a.value))
    };
    Sample {
        value: a.value.min(b.distance) - overlap * overlap * width * 0.25,
        normal: a.normal.lerp(b.normal, share).normalize_or(a.normal),
    }
}
