//! Interpolation curves on `[0, 1]` and through samples.

use glam::Vec3;

/// Returns 3t² - 2t³: from 0 to 1 with no slope at either end (C¹). `t` is clamped.
#[must_use]
pub fn smoothstep(t: f32) -> f32 {
    let t = t.clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// Returns `value` up to `from`, and above it a smooth curve (C¹) that never exceeds `to`.
#[must_use]
pub fn soft_limit(value: f32, from: f32, to: f32) -> f32 {
    if value <= from || to <= from {
        return value;
    }
    let room = to - from;
    from + room * (1.0 - libm::expf(-(value - from) / room))
}

/// Evaluates a Catmull-Rom spline: the cubic through `p1` (t = 0) and `p2` (t = 1) with slopes from
/// the neighbours `p0` and `p3`, uniform knots.
#[must_use]
pub fn catmull_rom(p0: Vec3, p1: Vec3, p2: Vec3, p3: Vec3, t: f32) -> Vec3 {
    hermite(p1, (p2 - p0) * 0.5, p2, (p3 - p1) * 0.5, t)
}

/// Evaluates the cubic Hermite curve from `p0` with slope `m0` (per unit of `t`) to `p1` with slope
/// `m1`.
#[must_use]
pub(crate) fn hermite(p0: Vec3, m0: Vec3, p1: Vec3, m1: Vec3, t: f32) -> Vec3 {
    let (t2, t3) = (t * t, t * t * t);
    p0 * (2.0 * t3 - 3.0 * t2 + 1.0)
        + m0 * (t3 - 2.0 * t2 + t)
        + p1 * (3.0 * t2 - 2.0 * t3)
        + m1 * (t3 - t2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn soft_limit_is_smooth_and_bounded() {
        assert_eq!(soft_limit(0.8, 0.9, 1.0), 0.8);
        assert!((soft_limit(0.9 + 1e-3, 0.9, 1.0) - 0.901).abs() < 1e-4);
        assert!(soft_limit(5.0, 0.9, 1.0) <= 1.0);
    }
}
