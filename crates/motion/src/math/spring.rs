//! Critically damped springs by half-life, and what a half-life means in seconds and frames.
//!
//! The half-life is a knob with a unit that a person can feel. It is a half-life by convention: the
//! damping is `2y = 4 ln 2 / h` (Holden, "Spring-It-On: The Game Developer's Spring-Roll-Call",
//! 2021). From rest 59.7 % are left after one half-life, and half after 1.21. [`secs_until`] and
//! [`alike_window_secs`] say what that comes to.

use super::{Response, quat};
use glam::{Quat, Vec3};
use std::f64::consts::{E, LN_2};

/// Half the damping of a critically damped spring, per second: `y = 2 ln 2 / h`. Below a nanosecond
/// (and for NaN) `h` counts as one: the spring is then at rest at once.
#[must_use]
pub fn rate(half_life_secs: f64) -> f64 {
    2.0 * LN_2 / half_life_secs.max(1e-9)
}

/// What a critically damped spring leaves of an offset and its velocity after `secs`:
/// `x(t) = e^(-yt) (x + (v + xy) t)` and its derivative. Exact for any step; two short steps are
/// one long one.
#[must_use]
pub fn response(half_life_secs: f64, secs: f64) -> Response {
    let y = rate(half_life_secs);
    let t = secs.max(0.0);
    let e = (-y * t).exp();
    Response { xx: e * (1.0 + y * t), xv: e * t, vx: -e * y * y * t, vv: e * (1.0 - y * t) }
}

/// One step of a number towards `target`: where it is and how fast after `dt_secs`.
#[must_use]
pub fn towards(x: f64, v: f64, target: f64, half_life_secs: f64, dt_secs: f64) -> (f64, f64) {
    let (offset, v) = response(half_life_secs, dt_secs).of(x - target, v);
    (target + offset, v)
}

/// One step of a point towards `target`: where it is and how fast after `dt_secs`.
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

/// One step of a rotation towards `target` by the shorter way: the rotation and its angular
/// velocity (radians per second, in the frame that the rotations turn into) after `dt_secs`. The
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

/// The share of a velocity that is left after `secs`, and the seconds of that velocity which have
/// added up meanwhile, when the velocity decays with this half-life: `e^(-yt)` and
/// `(1 - e^(-yt)) / y` with `y = ln 2 / h`. With it a pose runs on (Holden, "Dead Blending", 2023).
#[must_use]
pub fn run_on(half_life_secs: f64, secs: f64) -> (f64, f64) {
    let y = 0.5 * rate(half_life_secs);
    let t = secs.max(0.0);
    ((-y * t).exp(), -(-y * t).exp_m1() / y)
}

/// Seconds until a spring that starts at rest has only `share` (0 to 1) of its offset left: the
/// solution of `(1 + yt) e^(-yt) = share`. 1.211 half-lives for a half, 2.806 for a tenth, 4.789
/// for a hundredth. 0 for a share of 1 and more; a share below 1e-12 counts as that.
#[must_use]
pub fn secs_until(half_life_secs: f64, share: f64) -> f64 {
    let share = share.clamp(1e-12, 1.0);
    // The left side falls steadily in z = yt; at z = 40 it is below 1e-15.
    let (mut low, mut high) = (0.0_f64, 40.0_f64);
    for _ in 0..80 {
        let middle = 0.5 * (low + high);
        if (1.0 + middle) * (-middle).exp() > share {
            low = middle;
        } else {
            high = middle;
        }
    }
    if share >= 1.0 { 0.0 } else { high / rate(half_life_secs) }
}

/// The length of the dissolve that feels like a spring of this half-life, seconds: 2.885
/// half-lives.
///
/// Alike means that the same amount of the old motion is mixed in altogether: equal areas under
/// what is left of it. The spring's `(1 + yt) e^(-yt)` has `2 / y`, the dissolve's `2t³ - 3t² + 1`
/// over `T` has `T / 2`, so `T = 4 / y = 2h / ln 2`. It is also the window after which the
/// character stands in the same place: where velocities fade, the way made is the velocity times
/// that area. (Equal times to the last tenth would give 3.49 half-lives: a spring hurries at first
/// and has a long tail.)
#[must_use]
pub fn alike_window_secs(half_life_secs: f64) -> f64 {
    4.0 / rate(half_life_secs)
}

/// Of an offset that starts at 0 with velocity 1: when it is largest, seconds, and how large,
/// seconds (times the velocity): `1 / y` and `1 / (e y)`, that is 0.721 h and 0.265 h.
#[must_use]
pub fn peak_of_velocity(half_life_secs: f64) -> (f64, f64) {
    let y = rate(half_life_secs);
    (y.recip(), (E * y).recip())
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn the_ruler_tells_the_facts() {
        assert!((response(1.0, 1.0).xx - 0.596_573_590).abs() < 1e-9);
        for (share, half_lives) in [(0.5, 1.210_671_44), (0.1, 2.805_84), (0.01, 4.788_558_8)] {
            assert!((secs_until(0.2, share) - 0.2 * half_lives).abs() < 1e-6, "{share}");
            assert!((response(0.2, secs_until(0.2, share)).xx - share).abs() < 1e-12);
        }
        assert_eq!(secs_until(0.2, 1.0), 0.0);
        assert_eq!(secs_until(0.2, f64::INFINITY), 0.0);
        assert!(secs_until(0.2, 0.0) > secs_until(0.2, 1e-11));
        let (when, how_far) = peak_of_velocity(0.3);
        assert!((how_far - 0.265_370 * 0.3).abs() < 1e-6 && (when - 0.721_348 * 0.3).abs() < 1e-6);
        let at = |t: f64| response(0.3, t).xv;
        assert!(
            (at(when) - how_far).abs() < 1e-12
                && at(when - 1e-3) < how_far
                && at(when + 1e-3) < how_far
        );
    }

    #[test]
    fn alike_windows_have_the_spring_s_area() {
        let (half_life, dt) = (0.17, 1e-4);
        let area: f64 =
            (0..40_000).map(|i| response(half_life, (f64::from(i) + 0.5) * dt).xx * dt).sum();
        assert!((alike_window_secs(half_life) / 2.0 - area).abs() < 1e-6);
    }

    #[test]
    fn no_half_life_is_no_time() {
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
        fn two_short_steps_are_a_long_one(x in -2.0f64..2.0, v in -9.0f64..9.0, h in 0.01f64..2.0, s in 0.0f64..1.0, t in 0.0f64..1.0) {
            let (p, q) = response(h, s).of(x, v);
            let (p, q) = response(h, t).of(p, q);
            let (a, b) = response(h, s + t).of(x, v);
            prop_assert!((p - a).abs() < 1e-12 && (q - b).abs() < 1e-9);
        }

        #[test]
        fn a_rotation_arrives_and_starts_with_its_own_velocity(
            x in -1.5f32..1.5, y in -1.5f32..1.5, z in -1.5f32..1.5, w in -3.0f32..3.0, h in 0.05f64..0.5
        ) {
            let (q, target, spin) = (quat::exp(Vec3::new(x, y, z)), quat::exp(Vec3::new(z, x, 0.3)), Vec3::new(w, 1.0, -w));
            let (there, still) = towards_rotation(q, spin, target, h, 30.0 * h);
            prop_assert!(quat::angle_between(there, target) < 1e-4 && still.length() < 1e-3);
            let dt = 1e-3;
            let (next, velocity) = towards_rotation(q, spin, target, h, dt);
            let step = quat::angular_velocity(q, next, dt as f32);
            // From the start the spring pulls with at most y² times the offset and 2y times the
            // velocity.
            let pull = (rate(h).powi(2) * 4.0 + 2.0 * rate(h) * 6.0) as f32 * dt as f32;
            prop_assert!((step - spin).length() < pull + 5e-3, "{step} {spin}");
            prop_assert!((velocity - step).length() < pull + 5e-3);
        }
    }

    #[test]
    fn steps_towards_a_target_are_the_decay_of_what_is_missing() {
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
        let (left, made) = run_on(0.5, 0.5);
        assert!((left - 0.5).abs() < 1e-12 && (made - 0.5 * 0.5 / LN_2).abs() < 1e-12);
        assert_eq!(run_on(0.0, 1.0).0, 0.0);
    }
}
