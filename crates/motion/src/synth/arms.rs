//! The arms: swing against the legs, bend of the elbows by the gait, relaxed hands.

use super::params::Params;
use super::plan::Plan;
use super::posture::{Posture, person};
use super::track::Spline;
use glam::Quat;
use std::f64::consts::{FRAC_PI_2, TAU};

/// Angles of one arm, radians.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Arm {
    /// Flexion of the upper arm from hanging, forwards.
    pub(super) flexion: f64,
    /// Abduction of the upper arm from the body.
    pub(super) abduction: f64,
    /// Inward rotation of the upper arm about its own axis.
    pub(super) inward: f64,
    pub(super) elbow: f64,
    pub(super) wrist: f64,
}

fn degrees(value: f64) -> f64 {
    value.to_radians()
}

/// Returns swing and elbows after Murray, Sepic and Barnard 1967 (walking: 24° back to 8° forward
/// at a free speed, elbow 15 to 45°) and Hinrichs 1987 (running: elbow near 90°, the hand crossing
/// towards the middle in front).
pub(super) fn arm(plan: &Plan, posture: &Posture, params: &Params, side: usize, secs: f64) -> Arm {
    let gait = &plan.gait;
    let going = plan.going(secs);
    let swing = f64::from(params.style.arm_swing);
    let energy = 0.7 + 0.3 * f64::from(params.style.energy);
    let phase = plan.cycles(secs) * TAU;
    // The right arm is in front with the left leg.
    let opposite = if side == 0 { -1.0 } else { 1.0 };
    let wave = |shift: f64| opposite * libm::cos(phase - shift * TAU);
    let [a, b, c, _] = person(params.seed, 7 + side as u32);
    let mut arm = if gait.running {
        let quick = (gait.alike_mps / 3.5).clamp(0.5, 1.9);
        let amplitude = degrees(20.0 + 10.0 * quick) * swing * energy * (1.0 + 0.08 * a);
        let forward = wave(-0.07);
        Arm {
            flexion: degrees(-19.0) + amplitude * (forward + 0.08 * forward * forward),
            abduction: degrees(15.0) - degrees(4.0) * forward,
            inward: degrees(22.0) + degrees(9.0) * forward * swing,
            elbow: degrees(93.0 + 3.0 * quick) + degrees(13.0) * wave(-0.02) * swing,
            wrist: degrees(8.0),
        }
    } else {
        let quick = (gait.alike_mps / 1.4).clamp(0.3, 1.6);
        let amplitude = degrees(3.0 + 12.0 * quick) * swing * energy * (1.0 + 0.10 * a) * going;
        let forward = wave(0.035);
        // The elbow follows the upper arm a little later and straightens behind the body.
        let late = wave(0.08);
        Arm {
            flexion: degrees(-1.0) - degrees(4.0) * quick * going + amplitude * forward,
            abduction: degrees(7.0) + degrees(1.0) * (1.0 - going) - degrees(1.0) * forward * going,
            inward: degrees(5.0) + degrees(4.0) * forward * going * swing.min(1.5),
            elbow: degrees(12.0)
                + degrees(5.0 + 5.0 * quick) * going
                + degrees(3.0 + 9.0 * quick) * late * (0.7 + 0.3 * late) * going * swing,
            wrist: degrees(7.0),
        }
    };
    let turning = plan.path.at(secs).yaw_rate;
    if plan.top_speed == 0.0 && plan.jump.is_none() {
        // Arms trail a body that turns on the spot.
        let out = (turning / 2.5).clamp(-1.0, 1.0);
        arm.abduction += degrees(5.0) * out * out;
        arm.flexion += degrees(9.0) * out * if side == 0 { 1.0 } else { -1.0 };
        arm.elbow += degrees(8.0) * out * out;
    }
    if let Some(times) = plan.jump {
        let middle = 0.5 * (times.off + times.land);
        let curve = |values: [f64; 7]| {
            let at = [
                times.dip,
                times.bottom - 0.06,
                times.off,
                middle,
                times.land,
                times.absorbed,
                times.stood + 0.15,
            ];
            let mut knots = [(0.0, 0.0); 7];
            for (knot, (at, value)) in knots.iter_mut().zip(at.into_iter().zip(values)) {
                *knot = (at, degrees(value));
            }
            Spline::clamped(&knots, 0.0, 0.0).at(secs)
        };
        let swing = 0.4 + 0.6 * swing;
        arm.flexion += swing * curve([0.0, -48.0, 95.0, 118.0, 62.0, 14.0, 0.0]);
        arm.elbow += curve([0.0, 12.0, 38.0, 32.0, 28.0, 30.0, 0.0]);
        arm.abduction += curve([0.0, 6.0, 8.0, 12.0, 16.0, 10.0, 0.0]);
    }
    arm.abduction += degrees(1.5) * b + (1.0 - going) * degrees(0.6) * posture.breath(secs);
    arm.elbow += degrees(4.0) * c;
    arm.elbow = arm.elbow.max(degrees(4.0));
    arm
}

impl Arm {
    /// Returns the rotation of the upper arm in the frame of the trunk, from the T-pose. Rotations
    /// about its own axis are equal on both sides, because the T-pose is symmetric in x.
    pub(super) fn upper(&self, side: usize) -> Quat {
        let mirror = if side == 0 { 1.0 } else { -1.0 };
        Quat::from_rotation_x(-self.flexion as f32)
            * Quat::from_rotation_z((-mirror * (FRAC_PI_2 - self.abduction)) as f32)
            * Quat::from_rotation_x(self.inward as f32)
    }

    /// Returns the rotation of the forearm in the frame of the upper arm.
    pub(super) fn fore(&self, side: usize) -> Quat {
        let mirror = if side == 0 { 1.0 } else { -1.0 };
        Quat::from_rotation_y((-mirror * self.elbow) as f32)
    }

    /// Returns the rotation of the hand in the frame of the forearm: slightly towards the palm, and
    /// slightly inwards.
    pub(super) fn hand(&self, side: usize) -> Quat {
        let mirror = if side == 0 { 1.0 } else { -1.0 };
        Quat::from_rotation_z((-mirror * self.wrist) as f32) * Quat::from_rotation_x(-0.25)
    }
}
