//! Critically damped springs, parametrized by half-life, and the durations that correspond to a
//! half-life.
//!
//! The half-life is a parameter with a unit that users can relate to. It is a half-life by
//! convention: the damping is `2y = 4 ln 2 / h` (Holden, "Spring-It-On: The Game Developer's
//! Spring-Roll-Call", 2021). From rest 59.7 % are left after one half-life, and half after 1.21.
//! [`secs_until`] and [`equivalent_window_secs`] convert half-lives to seconds.

use super::{Response, quat};
use glam::{Quat, Vec3};
use std::f64::consts::LN_2;

/// Returns half the damping of a critically damped spring, per second: `y = 2 ln 2 / h`. Below a
/// nanosecond (and for NaN) `h` counts as a nanosecond: the spring is then at rest at once.
#[must_use]
pub fn rate(half_life_secs: f64) -> f64 {
    2.0 * LN_2 / half_life_secs.max(1e-9)
}

/// Returns the response of a critically damped spring after `secs`:
/// `x(t) = e^(-yt) (x + (v + xy) t)` and its derivative. Exact for any step; two short steps equal
/// one long step.
#[must_use]
pub fn response(half_life_secs: f64, secs: f64) -> Response {
    let y = rate(half_life_secs);
    let t = secs.max(0.0);
    let e = libm::exp(-y * t);
    Response { xx: e * (1.0 + y * t), xv: e * t, vx: -e * y * y * t, vv: e * (1.0 - y * t) }
}

/// Steps a number towards `target`; returns its value and velocity after `dt_secs`.
#[must_use]
pub fn towards(x: f64, v: f64, target: f64, half_life_secs: f64, dt_secs: f64) -> (f64, f64) {
    let (offset, v) = response(half_life_secs, dt_secs).of(x - target, v);
    (target + offset, v)
}

/// Steps a point towards `target`; returns its position and velocity after `dt_secs`.
#[must_use]
pub fn towards_point(
    x: Vec3,
    v: Vec3,
    target: Vec3,
    half_life_secs: f64,
    dt_secs: f64,
) -> (Vec3, Vec3) {
    let (offset, v) = response(half_life_secs, dt_secs).of_vec3(x - target, v);
    (target + offset, v)
}

/// Steps a rotation towards `target` by the shorter way; returns the rotation and its angular
/// velocity (radians per second, in the frame that the rotations map to) after `dt_secs`. The
/// offset is a rotation vector that is applied on the left.
#[must_use]
pub fn towards_rotation(
    q: Quat,
    angular_velocity: Vec3,
    target: Quat,
    half_life_secs: f64,
    dt_secs: f64,
) -> (Quat, Vec3) {
    let offset = quat::log(q * target.conjugate());
    let rate = quat::vector_rate(offset, angular_velocity);
    let (offset, rate) = response(half_life_secs, dt_secs).of_vec3(offset, rate);
    (quat::renormalize(quat::exp(offset) * target), quat::rate_to_angular_velocity(offset, rate))
}

/// Returns the decay of a velocity with this half-life: the share of it that is left after `secs`,
/// and its integral over that time per unit of velocity, seconds: `e^(-yt)` and `(1 - e^(-yt)) / y`
/// with `y = ln 2 / h`. Extrapolated poses move by it (Holden, "Dead Blending", 2023).
#[must_use]
pub fn velocity_decay(half_life_secs: f64, secs: f64) -> (f64, f64) {
    let y = 0.5 * rate(half_life_secs);
    let t = secs.max(0.0);
    (libm::exp(-y * t), -libm::expm1(-y * t) / y)
}

/// Returns the seconds until a spring that starts at rest has only `share` (0 to 1) of its offset
/// left: the solution of `(1 + yt) e^(-yt) = share`. 1.211 half-lives for a half, 2.806 for a
/// tenth, 4.789 for a hundredth. 0 for a share of 1 and more; a share below 1e-12 counts as 1e-12.
#[must_use]
pub fn secs_until(half_life_secs: f64, share: f64) -> f64 {
    let share = share.clamp(1e-12, 1.0);
    // The left side decreases in z = yt; at z = 40 it is below 1e-15.
    let (mut low, mut high) = (0.0_f64, 40.0_f64);
    for _ in 0..80 {
        let middle = 0.5 * (low + high);
        if (1.0 + middle) * libm::exp(-middle) > share {
            low = middle;
        } else {
            high = middle;
        }
    }
    if share >= 1.0 { 0.0 } else { high / rate(half_life_secs) }
}

/// Returns the duration of the dissolve that is equivalent to a spring of this half-life, seconds:
/// 2.885 half-lives.
///
/// Equivalent means that both mix in the same amount of the old motion: the areas under their
/// weights are equal. The spring's `(1 + yt) e^(-yt)` has the area `2 / y`, the dissolve's
/// `2t³ - 3t² + 1` over `T` has `T / 2`, so `T = 4 / y = 2h / ln 2`. With this window the character
/// also ends in the same position: where velocities fade, the distance covered is the velocity
/// times that area. (Equal times to the last tenth would give 3.49 half-lives: a spring is fast at
/// first and has a long tail.)
#[must_use]
pub fn equivalent_window_secs(half_life_secs: f64) -> f64 {
    4.0 / rate(half_life_secs)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn secs_until_agrees_with_the_closed_form() {
        assert!((response(1.0, 1.0).xx - 0.596_573_590).abs() < 1e-9);
        for (share, half_lives) in [(0.5, 1.210_671_44), (0.1, 2.805_84), (0.01, 4.788_558_8)] {
            assert!((secs_until(0.2, share) - 0.2 * half_lives).abs() < 1e-6, "{share}");
            assert!((response(0.2, secs_until(0.2, share)).xx - share).abs() < 1e-12);
        }
        assert_eq!(secs_until(0.2, 1.0), 0.0);
        assert_eq!(secs_until(0.2, f64::INFINITY), 0.0);
        assert!(secs_until(0.2, 0.0) > secs_until(0.2, 1e-11));
    }

    #[test]
    fn equivalent_window_has_the_area_of_the_spring() {
        let (half_life, dt) = (0.17, 1e-4);
        let area: f64 =
            (0..40_000).map(|i| response(half_life, (f64::from(i) + 0.5) * dt).xx * dt).sum();
        assert!((equivalent_window_secs(half_life) / 2.0 - area).abs() < 1e-6);
    }

    #[test]
    fn half_life_of_zero_decays_at_once() {
        for half_life in [0.0, -1.0, f64::NAN] {
            let left = response(half_life, 1e-3);
            assert!(
                left.of(1.0, 100.0).0.abs() < 1e-12 && left.of(1.0, 100.0).1.abs() < 1e-12,
                "{left:?}"
            );
            assert_eq!(response(half_life, 0.0).of(1.0, 2.0), (1.0, 2.0));
        }
    }

    proptest! {
        #[test]
        fn response_of_two_steps_equals_one_long_step(
            x in -2.0f64..2.0,
            v in -9.0f64..9.0,
            h in 0.01f64..2.0,
            s in 0.0f64..1.0,
            t in 0.0f64..1.0,
        ) {
            let (p, q) = response(h, s).of(x, v);
            let (p, q) = response(h, t).of(p, q);
            let (a, b) = response(h, s + t).of(x, v);
            prop_assert!((p - a).abs() < 1e-12 && (q - b).abs() < 1e-9);
        }

        #[test]
        fn towards_rotation_starts_with_its_velocity_and_arrives(
            x in -1.5f32..1.5,
            y in -1.5f32..1.5,
            z in -1.5f32..1.5,
            w in -3.0f32..3.0,
            h in 0.05f64..0.5,
        ) {
            let (q, target, spin) = (
                quat::exp(Vec3::new(x, y, z)),
                quat::exp(Vec3::new(z, x, 0.3)),
                Vec3::new(w, 1.0, -w),
            );
            let (there, still) = towards_rotation(q, spin, target, h, 30.0 * h);
            prop_assert!(quat::angle_between(there, target) < 1e-4 && still.length() < 1e-3);
            let dt = 1e-3;
            let (next, velocity) = towards_rotation(q, spin, target, h, dt);
            let step = quat::angular_velocity(q, next, dt as f32);
            // At the start the spring accelerates by at most y² times the offset and 2y times the
            // velocity.
            let pull = (rate(h).powi(2) * 4.0 + 2.0 * rate(h) * 6.0) as f32 * dt as f32;
            prop_assert!((step - spin).length() < pull + 5e-3, "{step} {spin}");
            prop_assert!((velocity - step).length() < pull + 5e-3);
        }
    }

    #[test]
    fn towards_is_the_decay_of_the_difference() {
        let (x, v) = towards(3.0, -1.0, 2.0, 0.4, 0.25);
        let (offset, rate) = response(0.4, 0.25).of(1.0, -1.0);
        assert_eq!((x, v), (2.0 + offset, rate));
        let (p, _) = towards_point(
            Vec3::new(3.0, 2.0, 0.0),
            Vec3::new(-1.0, 0.0, 0.0),
            Vec3::splat(2.0),
            0.4,
            0.25,
        );
        assert!((f64::from(p.x) - x).abs() < 1e-6 && p.y == 2.0);
        let (left, made) = velocity_decay(0.5, 0.5);
        assert!((left - 0.5).abs() < 1e-12 && (made - 0.5 * 0.5 / LN_2).abs() < 1e-12);
        assert_eq!(velocity_decay(0.0, 1.0).0, 0.0);
    }
}
