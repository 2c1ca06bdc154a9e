//! Walking and running at a speed: timing and angles from the literature.

use super::body::Body;
use super::params::Style;

const GRAVITY: f64 = 9.81;
/// Hip height of the adult of 1.75 m to whom the speeds below apply.
const REFERENCE_LEG: f64 = 0.530 * 1.75;

/// Timing and angles of a gait at one speed. Angles in radians; a foot's pitch is positive when its
/// heel is higher than its ball.
#[derive(Clone, Copy, Debug)]
pub(super) struct Gait {
    pub(super) running: bool,
    /// Duration from a left heel strike to the next one, seconds.
    pub(super) cycle_secs: f64,
    /// The share of a cycle in which a foot is on the ground.
    pub(super) duty: f64,
    /// Half of the distance between the ankles across the heading, metres.
    pub(super) half_width: f64,
    /// Time from heel strike to flat foot, share of a cycle.
    pub(super) flat_from: f64,
    /// Time from heel strike to heel off, share of a cycle.
    pub(super) flat_to: f64,
    pub(super) strike_pitch: f64,
    pub(super) release_pitch: f64,
    /// The dynamically similar speed (equal Froude number) of an adult of 1.75 m, m/s.
    pub(super) alike_mps: f64,
}

impl Gait {
    /// Returns the gait of walking.
    ///
    /// Cadence: step length over cadence (the walk ratio) is the same at all comfortable speeds,
    /// 0.0065 to 0.0072 m per step/min (Inman, Ralston and Todd 1981; Sekiya and Nagasaki 1998),
    /// which is the square-root law of Grieve and Gear 1966. Stance falls from 68 % of the cycle in
    /// slow to 57 % in fast walking (Murray 1967; Perry and Burnfield 2010: 62 % at a free speed).
    /// Bodies of other sizes: equal Froude number v²/gl, times proportional to √(l/g) (Alexander
    /// and Jayes 1983).
    pub(super) fn walk(speed_mps: f64, body: &Body, style: &Style) -> Self {
        let size = f64::from(body.hip_height()) / REFERENCE_LEG;
        let alike = speed_mps / size.sqrt();
        let step_secs = (60.0 * 0.0066 / alike.max(0.3)).sqrt();
        let quick = (alike / 1.4).clamp(0.25, 1.6);
        Self {
            running: false,
            cycle_secs: 2.0 * step_secs * size.sqrt(),
            duty: (0.603 - 0.055 * (alike - 1.4)).clamp(0.56, 0.67),
            half_width: f64::from(body.scale)
                * (0.055 - 0.012 * (quick - 1.0))
                * f64::from(0.35 + 0.65 * style.stance_width),
            flat_from: 0.085,
            flat_to: 0.35 - 0.05 * (quick - 1.0),
            strike_pitch: -(19.0 * libm::pow(quick, 0.6)).to_radians(),
            release_pitch: (61.0 * libm::pow(quick, 0.2)).to_radians(),
            alike_mps: alike,
        }
    }

    /// Returns the gait of running.
    ///
    /// Stride rate: nearly constant at slow speeds and rising with the square of fast ones, 1.39
    /// strides/s at 3.5 m/s (Cavanagh and Kram 1989; Luhtanen and Komi 1978). Contact time falls
    /// with speed as v^-0.64 from 0.33 s at 2 m/s to 0.16 s at 6 m/s (Weyand et al. 2000; Minetti
    /// 1998).
    pub(super) fn run(speed_mps: f64, body: &Body, style: &Style) -> Self {
        let size = f64::from(body.hip_height()) / REFERENCE_LEG;
        let alike = speed_mps / size.sqrt();
        let strides_per_sec = 1.2 + 0.025 * alike + 0.008 * alike * alike;
        // A bouncier runner has a shorter contact and therefore a higher flight; gravity does not
        // change.
        let contact_secs =
            0.45 * libm::pow(alike.max(1.0), -0.64) * (1.12 - 0.12 * f64::from(style.bounce));
        let quick = ((alike - 1.8) / 4.7).clamp(0.0, 1.0);
        Self {
            running: true,
            cycle_secs: size.sqrt() / strides_per_sec,
            duty: (contact_secs * strides_per_sec).clamp(0.2, 0.47),
            half_width: f64::from(body.scale)
                * (0.035 - 0.015 * quick)
                * f64::from(0.3 + 0.7 * style.stance_width),
            flat_from: 0.055,
            flat_to: 0.48 * contact_secs * strides_per_sec,
            strike_pitch: -(10.0 * (1.0 - quick * 1.2)).max(0.0).to_radians(),
            release_pitch: (56.0 + 6.0 * quick).to_radians(),
            alike_mps: alike,
        }
    }

    /// Returns 0 for the slowest run to 1 for the fastest.
    pub(super) fn quick_run(&self) -> f64 {
        ((self.alike_mps - 1.8) / 4.7).clamp(0.0, 1.0)
    }

    /// Returns steps per minute.
    pub(super) fn cadence(&self) -> f64 {
        120.0 / self.cycle_secs
    }
}

/// Returns the height of the centre of mass, metres: 0.56 of body height (Winter, table 4.1). It is
/// the length of the inverted pendulum.
pub(super) fn pendulum_height(height_m: f32) -> f64 {
    0.56 * f64::from(height_m)
}

/// Returns gravity, m/s².
pub(super) const fn gravity() -> f64 {
    GRAVITY
}
