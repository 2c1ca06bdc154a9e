//! Decay of an offset that starts with a velocity: spring, cubic and quintic.

use super::{Response, spring};
use glam::Vec3;

/// A decay curve for an offset that starts with a velocity of its own, as inertialization needs it.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum Decay {
    /// A critically damped spring ([`spring::response`]), which never reaches 0 exactly.
    Spring {
        /// Half-life, seconds.
        half_life_secs: f64,
    },
    /// The cubic that starts with the offset's velocity and ends at rest: Hermite, C¹ at both ends.
    Cubic {
        /// Duration, seconds.
        blend_secs: f64,
    },
    /// The quintic of Bollo, "Inertialization: High-Performance Animation Transitions in Gears of
    /// War" (GDC 2018): it ends without velocity and acceleration, and does not overshoot.
    ///
    /// An offset that closes fast would overshoot 0. As in Bollo, the blend time is therefore at
    /// most `5 |x| / closing speed`, and an initial acceleration `max(0, 8 · closing speed / T - 20
    /// |x| / T²)` opposes it; at the limit the curve is `(1 - t/T)⁵`. Bollo works on the length of
    /// the offset, and drops the velocity across it and away from 0. Here the whole vector is kept,
    /// so that the velocity stays continuous; the limits are those of the component along the
    /// offset, and only that component never overshoots. An offset near 0 with a high closing speed
    /// ends nearly at once, as Bollo's does.
    Quintic {
        /// Greatest duration, seconds.
        blend_secs: f64,
    },
}

impl Decay {
    /// Returns the rest of the offset `x` with velocity `v` after `secs`: the offset and its
    /// velocity.
    #[must_use]
    pub fn of_vec3(self, x: Vec3, v: Vec3, secs: f64) -> (Vec3, Vec3) {
        let closing = match self {
            Self::Quintic { .. } => {
                let square = f64::from(x.length_squared());
                // The comparison is also false for NaN.
                if square > 0.0 { -f64::from(x.dot(v)) / square } else { 0.0 }
            }
            _ => 0.0,
        };
        self.response(closing, secs).of_vec3(x, v)
    }

    /// Returns the response after `secs` for an offset that closes at the rate `closing`: `-v·x /
    /// |x|²`, per second. Only the quintic uses `closing`.
    #[must_use]
    pub fn response(self, closing: f64, secs: f64) -> Response {
        match self {
            Self::Spring { half_life_secs } => spring::response(half_life_secs, secs),
            Self::Cubic { blend_secs } => evaluate_within(blend_secs, secs, |s, period| Response {
                xx: (1.0 - s) * (1.0 - s) * (1.0 + 2.0 * s),
                xv: period * s * (1.0 - s) * (1.0 - s),
                vx: 6.0 * s * (s - 1.0) / period,
                vv: (1.0 - s) * (1.0 - 3.0 * s),
            }),
            Self::Quintic { blend_secs } => {
                let limited =
                    if closing > 0.0 { blend_secs.min(5.0 / closing) } else { blend_secs };
                evaluate_within(limited, secs, |s, period| {
                    // Accelerations are in units of |x|/T².
                    let push = (8.0 * closing * period - 20.0).max(0.0);
                    let rest = 1.0 - s;
                    Response {
                        xx: rest.powi(3) * (1.0 + s * (3.0 + 6.0 * s))
                            + 0.5 * push * s * s * rest.powi(3),
                        xv: period * s * rest.powi(3) * (1.0 + 3.0 * s),
                        vx: s * rest * rest * (-30.0 * s + 0.5 * push * (2.0 - 5.0 * s)) / period,
                        vv: rest * rest * (1.0 + s * (2.0 - 15.0 * s)),
                    }
                })
            }
        }
    }

    /// Returns the seconds until `share` (above 0, below 1) of an offset without velocity is left.
    #[must_use]
    pub fn secs_until(self, share: f64) -> f64 {
        match self {
            Self::Spring { half_life_secs } => spring::secs_until(half_life_secs, share),
            Self::Cubic { blend_secs } | Self::Quintic { blend_secs } => {
                let (mut low, mut high) = (0.0, blend_secs.max(0.0));
                for _ in 0..60 {
                    let middle = 0.5 * (low + high);
                    if self.response(0.0, middle).xx > share {
                        low = middle;
                    } else {
                        high = middle;
                    }
                }
                high
            }
        }
    }
}

/// Evaluates a curve over `s` from 0 to 1 in `period` seconds; zero after its end. With a period of
/// 0 the curve ends at once, but not before `secs` is 0.
fn evaluate_within(period: f64, secs: f64, curve: impl Fn(f64, f64) -> Response) -> Response {
    let period = period.max(1e-9);
    let s = secs.max(0.0) / period;
    if s < 1.0 { curve(s, period) } else { Response::ZERO }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const ALL: [Decay; 3] = [
        Decay::Spring { half_life_secs: 0.12 },
        Decay::Cubic { blend_secs: 0.4 },
        Decay::Quintic { blend_secs: 0.4 },
    ];

    proptest! {
        #[test]
        fn decay_starts_with_the_given_offset_and_velocity(
            x in -1.0f64..1.0,
            v in -9.0f64..9.0,
            t in 0.0f64..0.5,
        ) {
            for decay in ALL {
                let closing = if x == 0.0 { 0.0 } else { -v / x };
                prop_assert_eq!(decay.response(closing, 0.0).of(x, v), (x, v));
                let at = |t: f64| decay.response(closing, t).of(x, v);
                let support = match decay {
                    Decay::Quintic { blend_secs } if closing > 0.0 => blend_secs.min(5.0 / closing),
                    _ => 0.4,
                };
                let dt = 1e-6;
                if (t - support).abs() > 1e-3 && t > dt && support > 1e-2 {
                    let slope = (at(t + dt).0 - at(t - dt).0) / (2.0 * dt);
                    prop_assert!(
                        (slope - at(t).1).abs() < 1e-3,
                        "{:?} {} {}",
                        decay,
                        slope,
                        at(t).1
                    );
                }
            }
        }

        #[test]
        fn quintic_never_crosses_zero(x in 0.01f64..1.0, v in -50.0f64..0.0, t in 0.0f64..0.5) {
            let quintic = Decay::Quintic { blend_secs: 0.4 };
            let (left, _) = quintic.response(-v / x, t).of(x, v);
            prop_assert!(left >= -1e-12 * x && left <= x * (1.0 + 1e-12), "{left}");
        }
    }

    #[test]
    fn cubic_and_quintic_end_at_rest() {
        for decay in &ALL[1..] {
            assert_eq!(decay.response(0.0, 0.4), Response::ZERO);
            let (x, v) = decay.response(0.0, 0.4 - 1e-7).of(1.0, 5.0);
            assert!(x.abs() < 1e-9 && v.abs() < 1e-4, "{decay:?} {x} {v}");
            assert_eq!(decay.response(0.0, f64::INFINITY), Response::ZERO);
        }
        for decay in [Decay::Cubic { blend_secs: 0.0 }, Decay::Quintic { blend_secs: -1.0 }] {
            assert_eq!(decay.response(0.0, 1e-6), Response::ZERO);
        }
        for decay in ALL {
            assert!((decay.response(0.0, decay.secs_until(0.3)).xx - 0.3).abs() < 1e-9);
        }
    }

    #[test]
    fn cubic_overshoots_where_quintic_does_not() {
        let (x, v) = (Vec3::new(0.1, 0.0, 0.0), Vec3::new(-4.0, 0.5, 0.0));
        let lowest = |decay: Decay| {
            (0..100).map(|i| decay.of_vec3(x, v, f64::from(i) * 0.004).0.x).fold(f32::MAX, f32::min)
        };
        assert!(lowest(ALL[1]) < -0.1);
        assert!(lowest(ALL[2]) > -1e-6);
        assert_eq!(ALL[2].of_vec3(Vec3::ZERO, Vec3::ZERO, 0.1), (Vec3::ZERO, Vec3::ZERO));
    }

    #[derive(serde::Deserialize)]
    struct Golden {
        times: Vec<f64>,
        decays: Vec<GoldenDecay>,
        running_half_life: f64,
        running: Vec<(f64, f64)>,
    }

    #[derive(serde::Deserialize)]
    struct GoldenDecay {
        x: f64,
        v: f64,
        half_life: f64,
        period: f64,
        spring: Vec<(f64, f64)>,
        cubic: Vec<(f64, f64)>,
        quintic: Option<Vec<(f64, f64)>>,
    }

    #[test]
    fn decays_agree_with_scipy() {
        let golden: Golden =
            serde_json::from_str(include_str!("../../tests/oracles/transition.json")).unwrap();
        let near = |found: (f64, f64), wanted: (f64, f64)| {
            (found.0 - wanted.0).abs() < 1e-10 && (found.1 - wanted.1).abs() < 1e-8
        };
        for case in &golden.decays {
            let (half_life_secs, blend_secs) = (case.half_life, case.period);
            let none = vec![];
            for (decay, wanted) in [
                (Decay::Spring { half_life_secs }, &case.spring),
                (Decay::Cubic { blend_secs }, &case.cubic),
                (Decay::Quintic { blend_secs }, case.quintic.as_ref().unwrap_or(&none)),
            ] {
                for (&t, &wanted) in golden.times.iter().zip(wanted) {
                    let found = decay.response(-case.v / case.x, t).of(case.x, case.v);
                    assert!(near(found, wanted), "{decay:?} at {t}: {found:?} {wanted:?}");
                }
            }
        }
        for (&t, &wanted) in golden.times.iter().zip(&golden.running) {
            assert!(near(spring::velocity_decay(golden.running_half_life, t), wanted));
        }
        assert_eq!(golden.decays.len(), 6);
    }
}
