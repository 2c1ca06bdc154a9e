//! The best rigid alignment of two point clouds over the ground.

use super::RegistrationError;
use super::points::checked_sum;
use crate::math::Planar;
use glam::{DVec2, DVec3, Vec3};

/// The best rigid ground-plane transform between two point clouds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Alignment {
    /// `source_from_target`: maps the target cloud (p' of the paper) onto the source cloud (p).
    pub transform: Planar,
    /// The weighted sum of squared distances after alignment, m²: the minimum over all transforms.
    pub distance: f64,
    /// The sum of weights over all points. `(distance / weight).sqrt()` is the root-mean-square
    /// distance per point, metres.
    pub weight: f64,
    /// Whether every yaw is equally good (all weight over one point of the ground, or a circular
    /// cloud): the yaw is then the caller's fallback.
    pub turn_is_free: bool,
}

impl Alignment {
    /// Returns the root-mean-square distance per point, metres.
    #[must_use]
    pub fn rms_m(&self) -> f64 {
        (self.distance / self.weight).sqrt()
    }
}

/// Returns the rigid transform of the ground that best maps the `target` points onto the `source`
/// points, in closed form (Kovar, Gleicher, Pighin 2002, section 3.1), and the remaining squared
/// distance. All sums are in `f64`.
///
/// Both clouds hold the same points in the same order: `frames × weights.len()` positions, metres,
/// frame-major. `weights` has one weight per joint and is used again in every frame. Where every
/// yaw fits equally well, `fallback_yaw` is used and [`Alignment::turn_is_free`] set: pass the yaw
/// of a neighbouring window, or the difference of the facings.
///
/// The yaw comes from `atan2`: `atan` of the quotient is off by half a turn for half of all clouds.
///
/// # Errors
/// [`RegistrationError`] when the clouds differ in size, the number of weights differs from that of
/// the joints, or a position is not finite.
pub fn align(
    source: &[Vec3],
    target: &[Vec3],
    weights: &[f64],
    fallback_yaw: f64,
) -> Result<Alignment, RegistrationError> {
    if source.len() != target.len() {
        return Err(RegistrationError::Points {
            source_points: source.len(),
            target_points: target.len(),
        });
    }
    checked_sum(weights, weights.len())?;
    if source.is_empty() || !source.len().is_multiple_of(weights.len()) {
        return Err(RegistrationError::Weights { found: weights.len(), expected: source.len() });
    }
    let (source_centre, target_centre) = (ground_mean(source), ground_mean(target));
    let mut sums = PairMoments::default();
    for (index, (p, q)) in source.iter().zip(target).enumerate() {
        let (p, q) = (p.as_dvec3() - source_centre, q.as_dvec3() - target_centre);
        sums.add(weights[index % weights.len()], p, q);
    }
    let ground = |v: DVec3| DVec2::new(v.x, v.z);
    sums.alignment(fallback_yaw, ground(source_centre), ground(target_centre), 1e-9)
}

/// Returns the mean of the points on the ground (with height 0): sums relative to it keep their
/// digits however far from the origin a clip is.
fn ground_mean(points: &[Vec3]) -> DVec3 {
    let sum: DVec3 = points.iter().map(|p| DVec3::new(f64::from(p.x), 0.0, f64::from(p.z))).sum();
    sum / points.len().max(1) as f64
}

/// The sums of Kovar, Gleicher, Pighin 2002, section 3.1, over pairs of points, `p` of the source
/// and `q` of the target.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct PairMoments {
    /// W = Σw
    pub(super) weight: f64,
    /// Σw·p on the ground.
    pub(super) source: DVec2,
    /// Σw·q on the ground.
    pub(super) target: DVec2,
    /// Σw(p.x² + p.z²)
    pub(super) source_square: f64,
    /// Σw(q.x² + q.z²)
    pub(super) target_square: f64,
    /// Σw(p.x q.x + p.z q.z)
    pub(super) dot: f64,
    /// Σw(p.x q.z - q.x p.z)
    pub(super) cross: f64,
    /// Σw(p.y - q.y)²
    pub(super) height: f64,
}

impl PairMoments {
    pub(super) fn add(&mut self, w: f64, p: DVec3, q: DVec3) {
        self.weight += w;
        self.source += w * DVec2::new(p.x, p.z);
        self.target += w * DVec2::new(q.x, q.z);
        self.source_square += w * (p.x * p.x + p.z * p.z);
        self.target_square += w * (q.x * q.x + q.z * q.z);
        self.dot += w * (p.x * q.x + p.z * q.z);
        self.cross += w * (p.x * q.z - q.x * p.z);
        self.height += w * (p.y - q.y) * (p.y - q.y);
    }

    /// Returns the best transform and its distance, for clouds whose sums are relative to the given
    /// centres on the ground. `rounding` is the possible error of the sums as a share of the
    /// spread.
    pub(super) fn alignment(
        &self,
        fallback_yaw: f64,
        source_centre: DVec2,
        target_centre: DVec2,
        rounding: f64,
    ) -> Result<Alignment, RegistrationError> {
        let (w, p, q) = (self.weight, self.source, self.target);
        let a = self.cross - (p.x * q.y - q.x * p.y) / w;
        let b = self.dot - p.dot(q) / w;
        let spread = (self.source_square - p.length_squared() / w)
            + (self.target_square - q.length_squared() / w);
        let strength = libm::hypot(a, b);
        // The strength that rounding alone gives a perfectly round or point-like cloud.
        let noise = rounding * spread + 1e-14 * (self.source_square + self.target_square);
        // Written as a negation, so that NaN counts as free and is caught by the test below.
        let turn_is_free = strength.partial_cmp(&noise) != Some(std::cmp::Ordering::Greater);
        let yaw = if turn_is_free { fallback_yaw } else { libm::atan2(a, b) };
        let (sin, cos) = libm::sincos(yaw);
        let turned = |v: DVec2| DVec2::new(v.x * cos + v.y * sin, -v.x * sin + v.y * cos);
        let shift = (p - turned(q)) / w + source_centre - turned(target_centre);
        let distance = (spread - 2.0 * strength + self.height).max(0.0);
        if !(distance.is_finite() && spread.is_finite() && shift.is_finite() && yaw.is_finite()) {
            return Err(RegistrationError::NotFinite);
        }
        Ok(Alignment { transform: Planar { yaw, shift }, distance, weight: w, turn_is_free })
    }
}

#[cfg(test)]
mod tests;
