//! The surface around a set of rounded cones, as the zero of a field: negative inside, about metres
//! of distance near the surface.
//!
//! Where two shapes meet they flow into each other (the quadratic smooth minimum of Quilez, "Smooth
//! minimum"), but only those that are neighbours in the tree, and only as far as their surfaces
//! differ in direction: two pieces of one straight limb must not swell where they meet (the idea of
//! Gourmel et al., "A Gradient-Based Implicit Blend", 2013).

use super::shapes::PlacedShape;
use glam::Vec3;

/// How wide the surfaces of two neighbours flow into each other, in radii of the thinner one.
const BLEND: f32 = 0.75;
/// Surfaces whose normals differ by this (1 − cosine; 70°) flow together fully.
const FULL_BLEND: f32 = 0.66;
/// The field says at most this many times the distance from a squashed shape, and never less than
/// one part in this.
const FLATTEST: f32 = 0.1;

/// One rounded cone, ready to be measured.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cone {
    a: Vec3,
    /// Unit vector from `a` to `b`, and the distance.
    along: Vec3,
    length: f32,
    radius_a: f32,
    /// By how much the radius falls from `a` to `b`.
    fall: f32,
    /// Tangent of the cone's lean.
    lean: f32,
    flat: Vec3,
    flatness: f32,
}

/// How far a point is from a shape.
#[derive(Clone, Copy, Debug)]
pub(super) struct Measured {
    /// Metres, negative inside; to first order.
    pub(super) distance: f32,
    /// Unit vector away from the shape.
    pub(super) normal: Vec3,
    /// The radius where the point is nearest.
    radius: f32,
    /// No more than the distance, whatever the shape.
    at_least: f32,
    /// Where along the axis the point is nearest, 0 at `a` to 1 at `b`.
    pub(super) share: f32,
}

impl Cone {
    pub(super) fn new(shape: &PlacedShape) -> Self {
        let (along, length) = (shape.b - shape.a)
            .try_normalize()
            .map_or((Vec3::Y, 0.0), |along| (along, shape.a.distance(shape.b)));
        let fall = shape.radius_a - shape.radius_b;
        // One ball within the other: the greater one is all there is to see.
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
            flatness: flat.map_or(1.0, |_| shape.flatness.clamp(FLATTEST, FLATTEST.recip())),
        }
    }

    /// Half of its thickness in the middle, where it is thinnest across.
    pub(super) fn thinness(&self) -> f32 {
        (self.radius_a - 0.5 * self.fall) * self.flatness.min(1.0)
    }

    /// The greatest radius.
    fn thickest(&self) -> f32 {
        self.radius_a.max(self.radius_a - self.fall)
    }

    /// About how large the surface is, square metres.
    pub(super) fn area(&self) -> f32 {
        let radius = self.radius_a - 0.5 * self.fall;
        std::f32::consts::TAU * radius * (self.length + 2.0 * radius)
    }

    /// A box around it: corners with the least and the greatest coordinates.
    fn bounds(&self) -> [Vec3; 2] {
        let b = self.a + self.along * self.length;
        let [reach_a, reach_b] = [self.radius_a, self.radius_a - self.fall]
            .map(|radius| Vec3::splat(radius * self.flatness.max(1.0)));
        [(self.a - reach_a).min(b - reach_b), (self.a + reach_a).max(b + reach_b)]
    }

    /// The point of the axis at a share of its way.
    pub(super) fn at(&self, share: f32) -> Vec3 {
        self.a + self.along * (self.length * share)
    }

    pub(super) fn measure(&self, point: Vec3) -> Measured {
        let offset = point - self.a;
        // In a space where the shape is round.
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
        Measured {
            distance: distance / steepness,
            normal: gradient / steepness,
            radius,
            at_least: distance * self.flatness.min(1.0),
            share,
        }
    }
}

/// Cones, and who flows into whom.
#[derive(Clone, Debug)]
pub(super) struct Field {
    pub(super) cones: Vec<Cone>,
    /// For each two of them whether they are neighbours, row by row.
    neighbours: Vec<bool>,
}

/// What is known of the field around a point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Around {
    /// The field at the point is no less, metres.
    pub(super) least: f32,
    /// The smallest of the sizes of shapes whose surface is near; infinite where none is.
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
    /// `are_neighbours` is asked once for each two indices into `cones`.
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

    /// A box around the surface: corners with the least and the greatest coordinates; `None`
    /// without a shape.
    pub(super) fn bounds(&self) -> Option<[Vec3; 2]> {
        let [low, high] = self
            .cones
            .iter()
            .map(Cone::bounds)
            .reduce(|[low, high], [a, b]| [low.min(a), high.max(b)])?;
        // A blend may rise over both of its shapes.
        let blend =
            Vec3::splat(0.25 * BLEND * self.cones.iter().map(Cone::thickest).fold(0.0, f32::max));
        Some([low - blend, high + blend])
    }

    /// The field, where no shapes but those in `near` matter. `scratch` is room to work in.
    pub(super) fn sample(
        &self,
        point: Vec3,
        near: &[u16],
        scratch: &mut Vec<(usize, Measured)>,
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

    /// What matters within `reach` of `center`: the shapes of `near` that do are put into `out`.
    /// `scratch` is room to work in.
    pub(super) fn narrowed(
        &self,
        center: Vec3,
        reach: f32,
        near: &[u16],
        sizes: &[f32],
        out: &mut Vec<u16>,
        scratch: &mut Vec<(usize, Measured)>,
    ) -> Around {
        let mut around = Around { least: f32::INFINITY, size: f32::INFINITY };
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

    /// The shape whose surface a point is nearest to, and where along its axis.
    pub(super) fn nearest(&self, point: Vec3, near: &[u16]) -> Option<(usize, f32)> {
        let measured = near
            .iter()
            .map(|&index| (usize::from(index), self.cones[usize::from(index)].measure(point)));
        let nearest = measured.min_by(|(_, x), (_, y)| x.distance.total_cmp(&y.distance))?;
        Some((nearest.0, nearest.1.share))
    }
}

fn smooth_min(a: Sample, b: Measured, width: f32) -> Sample {
    let overlap =
        if width > 1e-9 { (width - (a.value - b.distance).abs()).max(0.0) / width } else { 0.0 };
    // The share of `b`: all of it where it is nearer by the width, half where both are as near.
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
