//! Curves that close a cycle.

use crate::math::{Response, spring};

/// The distribution over a cycle of the difference between its two ends.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum LoopMethod {
    /// Springs from both ends, with initial values for which the cycle closes exactly in pose and
    /// velocity.
    Exact {
        /// Half-life, seconds.
        half_life_secs: f64,
    },
    /// Springs from both ends, with the difference itself as initial value (Holden, "Creating
    /// Looping Animations from Motion Capture", 2022). The offset that remains at the other end is
    /// a seam: `(1 + yT) e^(-yT)` of the difference, 14 % for a half-life of 0.2 s in a cycle of
    /// 0.5 s.
    Classic {
        /// Half-life, seconds.
        half_life_secs: f64,
    },
    /// Springs as for [`Self::Classic`], but the head takes `1 - r` of the velocities' difference
    /// with `r` of the poses': the result of mixing up the two shares, and the same for `r = 0.5`.
    Crossed {
        /// Half-life, seconds.
        half_life_secs: f64,
    },
    /// Linear over the whole cycle: the pose closes, the velocity does not.
    Linear,
    /// A Hermite cubic over the whole cycle: pose and velocity close.
    Cubic,
}

/// The greatest half-life of a spring, in durations of the cycle: beyond it, the equations for the
/// exact loop lose their digits, and the curve is the same straight line.
const MAX_CYCLES: f64 = 10.0;

/// The offset that closes a cycle, as shares of the difference `D` of its ends (last minus first)
/// and of their velocities' difference `V`.
///
/// With the ratio `r`, `r D` is added at the head and `(1 - r) D` subtracted at the tail, so that
/// `offset(0) - offset(T) = D`, and likewise for velocities. The springs' offset is
/// `decay(r X, r W; t) - decay((1 - r) X, -(1 - r) W; T - t)`. Each spring still has an offset at
/// the other end; X and W are the solution of
///
/// `(1 - k) X + (1 - 2r) T e W = D` and `(2r - 1) y² T e X + (1 - (1 - yT) e) W = V`, with
/// `e = e^(-yT)` and `k = (1 + yT) e`.
#[derive(Clone, Copy, Debug)]
pub struct LoopCurve {
    method: LoopMethod,
    ratio: f64,
    duration_secs: f64,
    /// X and W from D and V.
    initial: Response,
}

impl LoopCurve {
    /// Returns the curve for a cycle of `duration_secs` (above 0). `ratio` is clamped to [0, 1]: 1
    /// changes only the start, 0 only the end. Half-lives are limited to ten durations.
    #[must_use]
    pub fn new(method: LoopMethod, ratio: f64, duration_secs: f64) -> Self {
        let ratio = if ratio > 0.0 { ratio.min(1.0) } else { 0.0 };
        let duration_secs = duration_secs.max(1e-9);
        let held = |half_life_secs: f64| half_life_secs.min(MAX_CYCLES * duration_secs);
        let as_it_is = Response { xx: 1.0, xv: 0.0, vx: 0.0, vv: 1.0 };
        let (method, initial) = match method {
            LoopMethod::Exact { half_life_secs } => {
                let half_life_secs = held(half_life_secs);
                let far = spring::response(half_life_secs, duration_secs);
                let skew = 1.0 - 2.0 * ratio;
                // The two equations, and their solution by Cramer's rule. The determinant is
                // positive for every cycle with a duration.
                let [a, b, c, d] = [1.0 - far.xx, skew * far.xv, skew * far.vx, 1.0 - far.vv];
                let determinant = a * d - b * c;
                let initial = Response {
                    xx: d / determinant,
                    xv: -b / determinant,
                    vx: -c / determinant,
                    vv: a / determinant,
                };
                (LoopMethod::Exact { half_life_secs }, initial)
            }
            LoopMethod::Classic { half_life_secs } => {
                (LoopMethod::Classic { half_life_secs: held(half_life_secs) }, as_it_is)
            }
            LoopMethod::Crossed { half_life_secs } => {
                (LoopMethod::Crossed { half_life_secs: held(half_life_secs) }, as_it_is)
            }
            other => (other, as_it_is),
        };
        Self { method, ratio, duration_secs, initial }
    }

    /// Returns the offset and its rate `secs` after the start of the cycle, as shares of D and V.
    #[must_use]
    pub fn at(&self, secs: f64) -> Response {
        let (r, q, period) = (self.ratio, 1.0 - self.ratio, self.duration_secs);
        let s = secs / period;
        match self.method {
            LoopMethod::Linear => Response { xx: r - s, xv: 0.0, vx: -period.recip(), vv: 0.0 },
            LoopMethod::Cubic => {
                // Hermite from (rD, rV) to (-qD, -qV).
                let fall = (1.0 - s) * (1.0 - s) * (1.0 + 2.0 * s);
                let slope = 6.0 * s * (s - 1.0) / period;
                Response {
                    xx: r * fall - q * (1.0 - fall),
                    xv: period * s * (1.0 - s) * (r * (1.0 - s) + q * s),
                    vx: slope,
                    vv: r * (1.0 - s) * (1.0 - 3.0 * s) + q * s * (2.0 - 3.0 * s),
                }
            }
            LoopMethod::Exact { half_life_secs }
            | LoopMethod::Classic { half_life_secs }
            | LoopMethod::Crossed { half_life_secs } => {
                let head = spring::response(half_life_secs, secs);
                let tail = spring::response(half_life_secs, period - secs);
                let of_velocity =
                    if matches!(self.method, LoopMethod::Crossed { .. }) { q } else { r };
                // In X and W; the tail runs backwards.
                let [xx, xv] = [r * head.xx - q * tail.xx, of_velocity * head.xv + q * tail.xv];
                let [vx, vv] = [r * head.vx + q * tail.vx, of_velocity * head.vv - q * tail.vv];
                Response {
                    xx: xx * self.initial.xx + xv * self.initial.vx,
                    xv: xx * self.initial.xv + xv * self.initial.vv,
                    vx: vx * self.initial.xx + vv * self.initial.vx,
                    vv: vx * self.initial.xv + vv * self.initial.vv,
                }
            }
        }
    }

    /// Returns whether pose and velocity close by this method.
    pub(super) fn closes(&self) -> [bool; 2] {
        match self.method {
            LoopMethod::Exact { .. } | LoopMethod::Cubic => [true, true],
            LoopMethod::Linear => [true, false],
            LoopMethod::Classic { .. } | LoopMethod::Crossed { .. } => [false, false],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn seam(curve: &LoopCurve, duration: f64, d: f64, v: f64) -> (f64, f64) {
        let ((x0, v0), (x1, v1)) = (curve.at(0.0).of(d, v), curve.at(duration).of(d, v));
        (d - (x0 - x1), v - (v0 - v1))
    }

    proptest! {
        #[test]
        fn exact_loop_closes_in_pose_and_velocity(
            h in 0.01f64..3.0,
            r in 0.0f64..1.0,
            duration in 0.2f64..5.0,
            d in -1.0f64..1.0,
            v in -5.0f64..5.0,
        ) {
            for method in [LoopMethod::Exact { half_life_secs: h }, LoopMethod::Cubic] {
                for r in [0.0, 0.5, 1.0, r] {
                    let (x, w) = seam(&LoopCurve::new(method, r, duration), duration, d, v);
                    prop_assert!(
                        x.abs() < 1e-10 && w.abs() < 1e-10,
                        "{method:?} {r} {duration}: {x} {w}"
                    );
                }
            }
            prop_assert!(
                seam(&LoopCurve::new(LoopMethod::Linear, r, duration), duration, d, v).0.abs()
                    < 1e-12
            );
        }

        #[test]
        fn loop_curve_rate_is_its_derivative(
            h in 0.05f64..1.0,
            r in 0.0f64..1.0,
            duration in 0.3f64..3.0,
            share in 0.01f64..0.99,
        ) {
            for method in [
                LoopMethod::Exact { half_life_secs: h },
                LoopMethod::Classic { half_life_secs: h },
                LoopMethod::Crossed { half_life_secs: h },
                LoopMethod::Linear,
                LoopMethod::Cubic,
            ] {
                let curve = LoopCurve::new(method, r, duration);
                let (t, dt) = (share * duration, 1e-6);
                let [before, here, after] = [t - dt, t, t + dt].map(|t| curve.at(t));
                prop_assert!(
                    ((after.xx - before.xx) / (2.0 * dt) - here.vx).abs()
                        < 1e-4 * (1.0 + here.vx.abs())
                );
                prop_assert!(
                    ((after.xv - before.xv) / (2.0 * dt) - here.vv).abs()
                        < 1e-4 * (1.0 + here.vv.abs())
                );
            }
        }
    }

    #[test]
    fn classic_loop_leaves_the_documented_seam() {
        let curve = LoopCurve::new(LoopMethod::Classic { half_life_secs: 0.2 }, 0.5, 0.5);
        let (left, _) = seam(&curve, 0.5, 1.0, 0.0);
        let z = spring::rate(0.2) * 0.5;
        assert!((left - (1.0 + z) * (-z).exp()).abs() < 1e-12);
        assert!((left - 0.14).abs() < 0.005, "{left}");
    }

    #[test]
    fn crossed_loop_differs_in_the_velocity_of_the_head_alone() {
        let half_life_secs = 0.15;
        let of = |method, ratio| LoopCurve::new(method, ratio, 1.0).at(0.0);
        let [crossed, both] =
            [LoopMethod::Crossed { half_life_secs }, LoopMethod::Classic { half_life_secs }];
        assert_eq!(of(crossed, 0.5), of(both, 0.5));
        // At the head the spring has its initial offset and velocity; the rest of the tail's offset
        // there is the same.
        let (a, b) = (of(crossed, 0.8), of(both, 0.8));
        assert!(
            (a.vv - b.vv - (0.2 - 0.8)).abs() < 1e-12
                && (a.xx - b.xx).abs() < 1e-12
                && (a.vx - b.vx).abs() < 1e-12
        );
    }

    #[test]
    fn loop_curve_with_a_ratio_changes_that_end() {
        for method in
            [LoopMethod::Exact { half_life_secs: 0.05 }, LoopMethod::Cubic, LoopMethod::Linear]
        {
            assert!((LoopCurve::new(method, 1.0, 2.0).at(0.0).xx - 1.0).abs() < 1e-9);
            assert!(LoopCurve::new(method, 1.0, 2.0).at(2.0).xx.abs() < 1e-9);
            assert!((LoopCurve::new(method, f64::NAN, 2.0).at(2.0).xx + 1.0).abs() < 1e-9);
        }
        // For a very slow spring, too, the numbers stay finite and the loop closes.
        let slow = LoopCurve::new(LoopMethod::Exact { half_life_secs: 1e9 }, 0.3, 0.1);
        let (x, v) = seam(&slow, 0.1, 1.0, 2.0);
        assert!(x.abs() < 1e-9 && v.abs() < 1e-9, "{x} {v}");
    }

    #[derive(serde::Deserialize)]
    struct Golden {
        loops: Vec<Case>,
    }

    #[derive(serde::Deserialize)]
    struct Case {
        half_life: f64,
        ratio: f64,
        duration: f64,
        d: f64,
        v: f64,
        shares: Vec<f64>,
        offsets: Vec<(f64, f64)>,
    }

    #[test]
    fn loop_curve_agrees_with_scipy() {
        let golden: Golden =
            serde_json::from_str(include_str!("../../tests/oracles/transition.json")).unwrap();
        for case in &golden.loops {
            let method = LoopMethod::Exact { half_life_secs: case.half_life };
            let curve = LoopCurve::new(method, case.ratio, case.duration);
            for (&share, wanted) in case.shares.iter().zip(&case.offsets) {
                let found = curve.at(share * case.duration).of(case.d, case.v);
                assert!(
                    (found.0 - wanted.0).abs() < 1e-10 && (found.1 - wanted.1).abs() < 1e-9,
                    "{share} {found:?} {wanted:?}"
                );
            }
        }
        assert_eq!(golden.loops.len(), 5);
    }
}
