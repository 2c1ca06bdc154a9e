//! Unit quaternions as rotations: logarithm, exponential, hemispheres, angular velocity.

use glam::{Quat, Vec3};

/// Returns `q` or `-q`, whichever lies in the hemisphere of `reference`, so that interpolation
/// takes the shorter way.
#[must_use]
pub fn in_hemisphere_of(q: Quat, reference: Quat) -> Quat {
    if q.dot(reference) < 0.0 { -q } else { q }
}

/// Returns `q` or `-q`, whichever has a scalar part that is not negative: the rotation by at most
/// half a turn ("abs" in Holden's notes).
#[must_use]
pub fn with_positive_scalar(q: Quat) -> Quat {
    if q.w < 0.0 { -q } else { q }
}

/// Returns the rotation vector (axis × angle, radians, at most π long) of a unit quaternion, by the
/// shorter way.
///
/// Exact near the identity, where `acos(w)` loses half of the digits.
#[must_use]
pub fn log(q: Quat) -> Vec3 {
    log_as_given(with_positive_scalar(q))
}

/// Returns the rotation vector of a unit quaternion without choosing the shorter way: the sign of
/// `q` decides. At most 2π long, and continuous as long as the quaternion is.
#[must_use]
pub fn log_as_given(q: Quat) -> Vec3 {
    let v = Vec3::new(q.x, q.y, q.z);
    let sine = v.length();
    if sine < 1e-9 {
        return v * 2.0;
    }
    v * (2.0 * libm::atan2f(sine, q.w) / sine)
}

/// Returns the unit quaternion that turns by `rotation_vector` (axis × angle, radians).
#[must_use]
pub fn exp(rotation_vector: Vec3) -> Quat {
    let angle = rotation_vector.length();
    // Near 0, where sin(angle/2)/angle is 0/0, its series.
    let (scale, w) = if angle < 1e-4 {
        (0.5 - angle * angle / 48.0, 1.0 - angle * angle / 8.0)
    } else {
        (libm::sinf(angle * 0.5) / angle, libm::cosf(angle * 0.5))
    };
    let v = rotation_vector * scale;
    renormalize(Quat::from_xyzw(v.x, v.y, v.z, w))
}

/// Interpolates spherically by the shorter way, `t` from 0 (`a`) to 1 (`b`).
///
/// Neighbouring frames of a clip are close to each other: for those the two sines are computed by
/// their series, in a quarter of the time.
#[must_use]
pub fn slerp(a: Quat, b: Quat, t: f32) -> Quat {
    let b = in_hemisphere_of(b, a);
    let cos_minus_one = a.dot(b) - 1.0;
    if cos_minus_one > NEAR && (0.0..=1.0).contains(&t) {
        renormalize(a * sine_ratio(1.0 - t, cos_minus_one) + b * sine_ratio(t, cos_minus_one))
    } else {
        renormalize(far_slerp(a, b, t))
    }
}

/// Interpolates spherically between rotations of one hemisphere. The same as `Quat::slerp`, which
/// computes the sines in another way on each kind of processor.
fn far_slerp(a: Quat, b: Quat, t: f32) -> Quat {
    let angle = libm::acosf(a.dot(b).clamp(-1.0, 1.0));
    let sine = libm::sinf(angle);
    if sine < 1e-6 {
        return a.lerp(b, t);
    }
    (a * libm::sinf((1.0 - t) * angle) + b * libm::sinf(t * angle)) * (1.0 / sine)
}

/// Interpolates spherically without choosing the shorter way, `t` from 0 (`a`) to 1 (`b`): the
/// signs decide, and rotations in opposite hemispheres take the longer way. [`Hemispheres`] keeps
/// the signs from changing while both rotations move.
#[must_use]
pub fn slerp_as_given(a: Quat, b: Quat, t: f32) -> Quat {
    if a.dot(b) < 0.0 {
        renormalize(exp(log_as_given(b * a.conjugate()) * t) * a)
    } else {
        slerp(a, b, t)
    }
}

/// The signs by which pairs of moving rotations are interpolated: the shorter way in the first
/// frame, and the same way from then on.
///
/// If the shorter way were chosen anew in every frame, the interpolation would flip whenever two
/// rotations about half a turn apart pass that angle.
#[derive(Clone, Debug, Default)]
pub struct Hemispheres(Vec<Option<Quat>>);

impl Hemispheres {
    /// Returns `to` with the sign by which [`slerp_as_given`] continues from the frame before.
    /// `index` identifies the pair; call this once per pair and frame, in the order of frames.
    pub fn follow(&mut self, index: usize, from: Quat, to: Quat) -> Quat {
        if index >= self.0.len() {
            self.0.resize(index + 1, None);
        }
        let between = from.conjugate() * to;
        let known = self.0[index].unwrap_or(Quat::IDENTITY);
        let flips = between.dot(known) < 0.0;
        self.0[index] = Some(if flips { -between } else { between });
        if flips { -to } else { to }
    }
}

/// `cos θ − 1` of quaternions that are 26° apart, which are rotations by 52°: six terms of the
/// series leave less than 1e-8 there.
const NEAR: f32 = -0.1;

/// Returns `sin(tθ) / sin θ` for `t` in 0–1, as a series in `cos θ − 1` (Eberly, "A Fast and
/// Accurate Algorithm for Computing SLERP", 2011, section 3).
fn sine_ratio(t: f32, cos_minus_one: f32) -> f32 {
    let square = t * t;
    // The factors from each term to the next.
    let [one, two, three, four, five] =
        [1.0f32, 2.0, 3.0, 4.0, 5.0].map(|i| (square / i - i) / (2.0 * i + 1.0) * cos_minus_one);
    t * (1.0 + one * (1.0 + two * (1.0 + three * (1.0 + four * (1.0 + five)))))
}

/// Returns the angle between two rotations, radians in `[0, π]`.
#[must_use]
pub fn angle_between(a: Quat, b: Quat) -> f32 {
    log(b * a.conjugate()).length()
}

/// Returns the angular velocity (radians per second, in the world) that takes `from` to `to` in
/// `dt_secs`.
///
/// `log(to · from⁻¹)/dt` by the shorter way (Holden, "Joint limits, quaternions and angular
/// velocity").
#[must_use]
pub fn angular_velocity(from: Quat, to: Quat, dt_secs: f32) -> Vec3 {
    log(to * from.conjugate()) / dt_secs
}

/// Returns the angular velocity of `exp(x(t))` where `x` changes at the rate `rate`: the left
/// Jacobian of the rotation group applied to `rate`.
///
/// `J = I + (1 - cos θ)/θ² [x]ₓ + (θ - sin θ)/θ³ [x]ₓ²` (Solà, Deray, Atchuthan, "A micro Lie
/// theory", 2018, eq. 145). Rate and angular velocity are equal only for small `x`.
#[must_use]
pub fn rate_to_angular_velocity(x: Vec3, rate: Vec3) -> Vec3 {
    let angle = x.length();
    let (first, second) = if angle < 1e-2 {
        (0.5 - angle * angle / 24.0, 1.0 / 6.0 - angle * angle / 120.0)
    } else {
        ((1.0 - libm::cosf(angle)) / (angle * angle), (angle - libm::sinf(angle)) / angle.powi(3))
    };
    let across = x.cross(rate);
    rate + across * first + x.cross(across) * second
}

/// Returns the rate at which `x` changes when `exp(x(t))` has this angular velocity: the inverse of
/// [`rate_to_angular_velocity`] (ibid., eq. 146).
///
/// The map has no inverse at a whole turn; beyond 6 radians its value at 6 is used.
#[must_use]
pub fn vector_rate(x: Vec3, angular_velocity: Vec3) -> Vec3 {
    let angle = x.length();
    let second = if angle < 1e-2 {
        1.0 / 12.0 + angle * angle / 720.0
    } else {
        let held = angle.min(6.0);
        (1.0 / held - 0.5 / libm::tanf(0.5 * held)) / held
    };
    let across = x.cross(angular_velocity);
    angular_velocity - across * 0.5 + x.cross(across) * second
}

/// Scales `q` back to unit length after a chain of products; the identity when its length is 0.
#[must_use]
pub fn renormalize(q: Quat) -> Quat {
    let length_squared = q.length_squared();
    if length_squared > 1e-12 && length_squared.is_finite() {
        q * length_squared.sqrt().recip()
    } else {
        Quat::IDENTITY
    }
}

/// Returns the mean of rotations that are near each other: the sum of the quaternions in the
/// hemisphere of the first, of unit length. The identity for an empty list.
#[must_use]
pub fn mean(rotations: impl IntoIterator<Item = Quat>) -> Quat {
    let mut rotations = rotations.into_iter();
    let Some(first) = rotations.next() else {
        return Quat::IDENTITY;
    };
    renormalize(rotations.fold(first, |sum, rotation| sum + in_hemisphere_of(rotation, first)))
}

/// Returns the shortest rotation from the direction `from` to the direction `to`; the identity
/// where either is too short to have a direction.
#[must_use]
pub fn between_directions(from: Vec3, to: Vec3) -> Quat {
    match (from.try_normalize(), to.try_normalize()) {
        (Some(from), Some(to)) => Quat::from_rotation_arc(from, to),
        _ => Quat::IDENTITY,
    }
}

/// Returns the rotation that minimizes the sum of squared distances between each rotated first and
/// its second direction. Longer ones count more. `None` where the rotation is not unique, as for a
/// single direction.
///
/// It is the greatest eigenvector of a symmetric 4 × 4 matrix (Horn 1987, "Closed-form solution of
/// absolute orientation using unit quaternions", section 4), found by squaring the matrix.
#[must_use]
pub fn best_fit(pairs: &[(Vec3, Vec3)]) -> Option<Quat> {
    /// Directions within this of one line leave the rotation about it open: the sine of 3°.
    const ON_A_LINE: f32 = 0.05;
    /// After so many squarings even a close second eigenvalue has vanished.
    const SQUARINGS: usize = 40;
    let &(longest, _) = pairs.iter().max_by(|a, b| a.0.length().total_cmp(&b.0.length()))?;
    let axis = longest.try_normalize()?;
    if pairs.iter().all(|(from, _)| from.cross(axis).length() <= ON_A_LINE * longest.length()) {
        return None;
    }
    let mut sums = glam::DMat3::ZERO;
    for (from, to) in pairs {
        let (from, to) = (from.as_dvec3(), to.as_dvec3());
        sums += glam::DMat3::from_cols(from * to.x, from * to.y, from * to.z);
    }
    // `s(a, b)` is the sum of products of component a of the first and component b of the second.
    let s = |a: usize, b: usize| sums.col(b)[a];
    let matrix = glam::DMat4::from_cols_array(&[
        s(0, 0) + s(1, 1) + s(2, 2),
        s(1, 2) - s(2, 1),
        s(2, 0) - s(0, 2),
        s(0, 1) - s(1, 0),
        s(1, 2) - s(2, 1),
        s(0, 0) - s(1, 1) - s(2, 2),
        s(0, 1) + s(1, 0),
        s(2, 0) + s(0, 2),
        s(2, 0) - s(0, 2),
        s(0, 1) + s(1, 0),
        s(1, 1) - s(0, 0) - s(2, 2),
        s(1, 2) + s(2, 1),
        s(0, 1) - s(1, 0),
        s(2, 0) + s(0, 2),
        s(1, 2) + s(2, 1),
        s(2, 2) - s(0, 0) - s(1, 1),
    ]);
    let size = |m: &glam::DMat4| m.to_cols_array().into_iter().map(f64::abs).fold(0.0, f64::max);
    // No eigenvalue is less than minus the largest row sum: after the shift none is negative, and
    // the greatest remains the greatest.
    let mut power = matrix + glam::DMat4::IDENTITY * (4.0 * size(&matrix));
    for _ in 0..SQUARINGS {
        power = power * (1.0 / size(&power));
        power = power * power;
    }
    let column = (0..4)
        .map(|i| power.col(i))
        .max_by(|a, b| a.length_squared().total_cmp(&b.length_squared()))?;
    let q = column.try_normalize()?.as_vec4();
    Some(with_positive_scalar(Quat::from_xyzw(q.y, q.z, q.w, q.x)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn best_fit_of_one_direction_is_none() {
        assert_eq!(best_fit(&[]), None);
        assert_eq!(best_fit(&[(Vec3::X, Vec3::Y)]), None);
        assert_eq!(best_fit(&[(Vec3::X, Vec3::Y), (Vec3::X * -2.0, Vec3::NEG_Y)]), None);
        assert_eq!(best_fit(&[(Vec3::ZERO, Vec3::Y), (Vec3::ZERO, Vec3::Z)]), None);
    }

    proptest! {
        /// The rotation of rotated directions is found; equal offsets to either side do not change
        /// it.
        #[test]
        fn best_fit_of_rotated_directions_is_the_rotation(
            x in -1.8f32..1.8,
            y in -1.8f32..1.8,
            z in -1.8f32..1.8,
            long in 0.2f32..5.0,
        ) {
            let turn = exp(Vec3::new(x, y, z));
            let from = [Vec3::X * long, Vec3::new(0.1, 1.0, -0.3), Vec3::new(-0.4, -0.2, 0.5)];
            let pairs = from.map(|v| (v, turn * v));
            prop_assert!(angle_between(best_fit(&pairs).unwrap(), turn) < 1e-3);
            // No rotation near it fits better.
            let noisy = [
                (from[0], turn * (from[0] + Vec3::Y * 0.3)),
                (from[1], turn * (from[1] - Vec3::Z * 0.2)),
                pairs[2],
            ];
            let cost =
                |q: Quat| noisy.iter().map(|(u, v)| (q * *u).distance_squared(*v)).sum::<f32>();
            let best = best_fit(&noisy).unwrap();
            for axis in Vec3::AXES {
                for angle in [-0.02, 0.02] {
                    prop_assert!(
                        cost(Quat::from_axis_angle(axis, angle) * best) >= cost(best) - 1e-5
                    );
                }
            }
        }
    }

    proptest! {
        #[test]
        fn exp_of_log_is_identity(x in -1.8f32..1.8, y in -1.8f32..1.8, z in -1.8f32..1.8) {
            let v = Vec3::new(x, y, z);
            prop_assume!(v.length() < 3.1);
            prop_assert!((log(exp(v)) - v).length() < 2e-5, "{v}");
        }

        #[test]
        fn rate_to_angular_velocity_agrees_with_differences(
            x in -1.7f32..1.7,
            y in -1.7f32..1.7,
            z in -1.7f32..1.7,
            u in -3.0f32..3.0,
            v in -3.0f32..3.0,
        ) {
            for scale in [1.0, 1e-2, 1e-4] {
                let (at, rate, dt) = (Vec3::new(x, y, z) * scale, Vec3::new(u, v, u - v), 2e-3);
                let found =
                    angular_velocity(exp(at - rate * (0.5 * dt)), exp(at + rate * (0.5 * dt)), dt);
                let wanted = rate_to_angular_velocity(at, rate);
                prop_assert!((found - wanted).length() < 2e-3, "{found} {wanted}");
                prop_assert!((vector_rate(at, wanted) - rate).length() < 2e-4);
            }
        }

        #[test]
        fn slerp_turns_at_constant_speed(
            x in -1.8f32..1.8,
            y in -1.8f32..1.8,
            z in -1.8f32..1.8,
            angle in 0.0f32..3.0,
            t in 0.0f32..=1.0,
        ) {
            let start = exp(Vec3::new(x, y, z));
            let turn = Vec3::new(y, z, x + 0.01).normalize_or(Vec3::X) * angle;
            let found = slerp(start, exp(turn) * start, t);
            prop_assert!(angle_between(found, exp(turn * t) * start) < 2e-6, "{found}");
        }

        #[test]
        fn slerp_of_negated_quaternions_is_equal(
            x in -3.0f32..3.0,
            y in -3.0f32..3.0,
            z in -3.0f32..3.0,
            t in 0.0f32..1.0,
        ) {
            let (a, b) = (exp(Vec3::new(x, y, z)), exp(Vec3::new(z, x, y)));
            prop_assume!(a.dot(b).abs() > 1e-3);
            prop_assert!(angle_between(slerp(a, b, t), slerp(a, -b, t)) < 1e-3);
        }
    }

    #[test]
    fn hemispheres_past_half_a_turn_do_not_flip() {
        // `to` oscillates about half a turn from `from`, through the angle where the shorter way
        // changes sides.
        let (mut sides, mut before) = (Hemispheres::default(), None::<Quat>);
        for step in 0..=40 {
            let from = Quat::from_rotation_x(0.2);
            let angle = std::f32::consts::PI + 0.1 * (step as f32 * 0.5).sin() - 0.02;
            let to = Quat::from_rotation_y(angle) * from;
            let to = sides.follow(3, from, if step % 3 == 0 { -to } else { to });
            assert!(angle_between(slerp_as_given(from, to, 1.0), to) < 1e-5);
            assert!(angle_between(slerp_as_given(from, to, 0.0), from) < 1e-5);
            let half = slerp_as_given(from, to, 0.5);
            let expected = Quat::from_rotation_y(0.5 * angle) * from;
            assert!(angle_between(half, expected) < 1e-5, "step {step}");
            assert!(before.is_none_or(|before| angle_between(before, half) < 0.03), "step {step}");
            before = Some(half);
        }
    }

    #[test]
    fn log_of_small_rotation_keeps_its_digits() {
        let v = Vec3::new(3e-6, -2e-6, 1e-6);
        assert!((log(exp(v)) - v).length() < 1e-11);
    }

    #[test]
    fn angular_velocity_is_per_second() {
        let dt = 1.0 / 120.0;
        let to = Quat::from_rotation_y(3.0 * dt);
        assert!((angular_velocity(Quat::IDENTITY, -to, dt) - Vec3::Y * 3.0).length() < 1e-4);
    }
}
