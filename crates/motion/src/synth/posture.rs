//! The posture of the trunk: tilt, list and rotation of the pelvis, counter-rotation of the chest,
//! steady head.

use super::gait::gravity;
use super::params::{Action, Params};
use super::plan::Plan;
use super::track::Spline;
use glam::{DVec2, Quat};
use std::f64::consts::TAU;

/// World rotations of the trunk at one moment.
pub(super) struct Trunk {
    pub(super) pelvis: Quat,
    pub(super) chest: Quat,
    pub(super) head: Quat,
    /// The frame of the arms: rotated with the chest, but more upright.
    pub(super) arms: Quat,
}

/// The parameters of the trunk that do not change with time.
pub(super) struct Posture {
    running: bool,
    idle: bool,
    loops: bool,
    energy: f64,
    lean: f64,
    quick: f64,
    size: f64,
    /// Small differences between persons: posture, list, head, asymmetry; each around 0.
    person: [f64; 4],
    period_secs: f64,
}

/// Returns four numbers in -1..1 determined by a seed; all 0 for seed 0.
pub(super) fn person(seed: u32, salt: u32) -> [f64; 4] {
    if seed == 0 {
        return [0.0; 4];
    }
    // SplitMix64 (Steele, Lea and Flood 2014).
    let mut state = u64::from(seed) << 32 | u64::from(salt);
    [(); 4].map(|()| {
        state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = state;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    })
}

fn turn(radians: f64) -> Quat {
    Quat::from_rotation_y(radians as f32)
}

/// Returns a rotation to the side, positive with the left side up.
fn list(radians: f64) -> Quat {
    Quat::from_rotation_z(radians as f32)
}

/// Returns a rotation forwards, positive forwards.
fn bow(radians: f64) -> Quat {
    Quat::from_rotation_x(radians as f32)
}

fn degrees(value: f64) -> f64 {
    value.to_radians()
}

/// Angles of one moment, radians.
#[derive(Clone, Copy, Default)]
struct Angles {
    heading: f64,
    into_curve: f64,
    pelvis_turn: f64,
    pelvis_list: f64,
    pelvis_tilt: f64,
    chest_heading: f64,
    chest_turn: f64,
    chest_list: f64,
    chest_bow: f64,
    head_heading: f64,
    head_bow: f64,
}

impl Posture {
    pub(super) fn new(plan: &Plan, params: &Params) -> Self {
        Self {
            running: plan.gait.running,
            idle: params.action == Action::Idle,
            loops: matches!(params.action, Action::Idle | Action::Walk | Action::Run),
            energy: f64::from(params.style.energy),
            lean: f64::from(params.style.lean),
            quick: if plan.gait.running {
                plan.gait.alike_mps / 3.5
            } else {
                (plan.gait.alike_mps / 1.4).clamp(0.3, 1.6)
            },
            size: f64::from(params.height_m) / 1.75,
            person: person(params.seed, 1),
            period_secs: (plan.frames.max(2) - 1) as f64 * plan.dt_secs * plan.substeps as f64,
        }
    }

    /// Returns the number of repetitions of an event of about `secs` that fits into a looping clip.
    fn looped(&self, secs: f64, at: f64) -> f64 {
        let whole = (self.period_secs / secs).round().max(1.0);
        TAU * if self.loops { at * whole / self.period_secs } else { at / secs }
    }

    /// Returns the slow sway of a standing body, (left, forward), metres: a few millimetres in
    /// quiet stance, centimetres when the weight is shifted.
    pub(super) fn drift(&self, secs: f64) -> DVec2 {
        if !self.idle {
            return DVec2::ZERO;
        }
        let shift = self.looped(6.0, secs);
        let (fast, faster) = (self.looped(2.6, secs), self.looped(1.7, secs));
        DVec2::new(
            0.022 * libm::sin(shift + 0.25 * libm::sin(shift)) + 0.003 * libm::sin(fast),
            0.006 * libm::sin(self.looped(3.3, secs) + 1.0) + 0.0025 * libm::sin(faster),
        ) * self.size
    }

    /// Returns the rise of the chest in breathing, -1..1: 14 breaths a minute, with inspiration
    /// faster than expiration.
    pub(super) fn breath(&self, secs: f64) -> f64 {
        let phase = self.looped(4.2, secs);
        libm::sin(phase + 0.35 * libm::sin(phase))
    }

    fn angles(&self, plan: &Plan, secs: f64) -> Angles {
        let place = plan.path.at(secs);
        let going = plan.going(secs);
        let phase = plan.cycles(secs) * TAU;
        let wave = |shift: f64| libm::cos(phase - shift * TAU);
        let twice = |shift: f64| libm::cos(2.0 * (phase - shift * TAU));
        let lean = place.to_local(place.lean(gravity()));
        let into_curve = libm::atan(lean.x) * (0.3 + 0.7 * self.lean) * 0.85;
        let thrust_lean = libm::atan(lean.y) * 0.45;
        let energy = (0.4 + 0.6 * self.energy) * going;
        let quick = self.quick;
        let mut a = Angles {
            heading: place.yaw,
            into_curve,
            chest_heading: plan.path.at(secs + 0.10).yaw,
            head_heading: plan.path.at(secs + 0.28).yaw,
            ..Angles::default()
        };
        if self.running {
            a.pelvis_turn = degrees(3.5) * energy * wave(0.0);
            a.pelvis_list = degrees(4.5) * energy * wave(0.14);
            a.pelvis_tilt = (degrees(8.0) + degrees(3.0) * quick) * self.lean
                + degrees(2.0) * energy * twice(0.02);
            a.chest_turn = degrees(11.0) * energy * wave(-0.08);
            a.chest_list = degrees(1.5) * energy * wave(0.64);
            a.chest_bow =
                (degrees(4.5) + degrees(4.5) * quick) * self.lean + degrees(1.5) * twice(0.06);
            a.head_bow = degrees(2.0) + 0.15 * a.chest_bow;
        } else {
            a.pelvis_turn = -degrees(3.0 + 2.5 * quick) * energy * wave(-0.01);
            a.pelvis_list = degrees(1.8 + 2.8 * quick)
                * energy
                * (0.85 * wave(0.20) + 0.15 * libm::cos(3.0 * (phase - 0.20 * TAU) + 0.5 * TAU));
            a.pelvis_tilt = degrees(3.0)
                + degrees(1.5) * going * quick * self.lean
                + degrees(1.2) * energy * twice(0.04);
            a.chest_turn = degrees(2.0 + 2.6 * quick) * energy * wave(0.02);
            a.chest_list = degrees(1.4) * energy * wave(0.68);
            a.chest_bow = degrees(1.0)
                + degrees(3.0) * quick * going * self.lean
                + degrees(0.8) * energy * twice(0.05);
            a.head_bow = degrees(2.5);
        }
        a.chest_bow += thrust_lean;
        a.pelvis_tilt += 0.6 * thrust_lean;
        if self.idle {
            let drift = self.drift(secs).x / self.size;
            a.pelvis_list += 1.6 * drift;
            a.chest_list -= 0.7 * drift;
            a.pelvis_turn -= 0.9 * drift;
            a.head_heading += degrees(1.5) * libm::sin(self.looped(6.0, secs) + 2.0);
        }
        let quiet = (1.0 - going) * degrees(0.9) * self.breath(secs);
        a.chest_bow -= quiet;
        if let Some(times) = plan.jump {
            let lean = Spline::clamped(
                &[
                    (times.dip, 0.0),
                    (times.bottom, 0.75),
                    (times.off - 0.02, 0.10),
                    (0.5 * (times.off + times.land), 0.02),
                    (times.land, 0.16),
                    (times.absorbed, 0.55),
                    (times.stood + 0.1, 0.0),
                ],
                0.0,
                0.0,
            )
            .at(secs);
            a.pelvis_tilt += 0.75 * lean;
            a.chest_bow += lean;
            a.head_bow += 0.25 * lean;
        }
        let [posture, level, head, twist] = self.person;
        a.chest_bow += degrees(1.5) * posture;
        a.pelvis_tilt += degrees(1.5) * twist;
        a.pelvis_list += degrees(0.5) * level;
        a.chest_list += degrees(0.7) * level;
        a.head_bow += degrees(2.0) * head;
        a.chest_turn *= 1.0 + 0.12 * twist;
        a
    }

    /// Returns the world rotation of the hips.
    pub(super) fn pelvis(&self, plan: &Plan, secs: f64) -> Quat {
        let a = self.angles(plan, secs);
        turn(a.heading)
            * list(-a.into_curve)
            * turn(a.pelvis_turn)
            * list(a.pelvis_list)
            * bow(a.pelvis_tilt)
    }

    /// Returns the world rotations of pelvis, chest and head.
    pub(super) fn trunk(&self, plan: &Plan, secs: f64) -> Trunk {
        let a = self.angles(plan, secs);
        let leaning = list(-a.into_curve);
        let chest_turn = turn(a.chest_heading) * leaning * turn(a.chest_turn);
        Trunk {
            pelvis: turn(a.heading)
                * leaning
                * turn(a.pelvis_turn)
                * list(a.pelvis_list)
                * bow(a.pelvis_tilt),
            chest: chest_turn * list(a.chest_list) * bow(a.chest_bow),
            head: turn(a.head_heading)
                * list(-0.4 * a.into_curve)
                * turn(0.12 * a.chest_turn)
                * bow(a.head_bow),
            arms: chest_turn * list(0.5 * a.chest_list) * bow(0.35 * a.chest_bow),
        }
    }
}
