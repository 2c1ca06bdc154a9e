//! Plans of actions: gaits in steady motion, starts and stops, standing, and actions on the spot.

use super::body::Body;
use super::foot::{Plant, Swing};
use super::gait::{Gait, gravity};
use super::params::{Action, Params};
use super::path::Path;
use super::plan::{Plan, standing_half_width, toe_out};
use super::track::ramp;
use glam::DVec2;

/// Time that is planned before and after the clip, seconds, so that filters have data on both
/// sides: e^(-3.2 × 3) of a discontinuity of centimetres is left.
const MARGIN_SECS: f64 = 3.0;
/// The greatest time step of a plan.
const MAX_STEP_SECS: f64 = 1.0 / 110.0;

/// Plans the motion of valid parameters.
pub(super) fn plan(params: &Params, body: &Body) -> Plan {
    let fps = f64::from(params.fps);
    let substeps = ((fps * MAX_STEP_SECS).recip().ceil() as usize).max(1);
    let dt_secs = 1.0 / (fps * substeps as f64);
    let margin = (MARGIN_SECS / dt_secs).ceil() as usize;
    let speed = f64::from(params.speed_mps);
    let asked = (f64::from(params.duration_secs) * fps).round().max(1.0);
    let running = params.action == Action::Run;
    let mut gait = if running {
        Gait::run(speed, body, &params.style)
    } else {
        Gait::walk(speed.max(0.4), body, &params.style)
    };
    if running {
        // No person can run along such a tight curve. With a shorter contact the legs stay within
        // their reach.
        gait.duty /= 1.0 + 0.6 * ramp(sideways(params), 0.0, 1.2);
        gait.flat_from = gait.flat_from.min(0.25 * gait.duty);
        gait.flat_to = gait.flat_to.min(0.5 * gait.duty);
    }
    let mut frames = asked as usize + 1;
    let mut period = None;
    if matches!(params.action, Action::Walk | Action::Run) {
        // Whole cycles have a whole number of frames: the cadence is changed by less than half a
        // frame per clip, the speed is not.
        let cycles = (asked / (gait.cycle_secs * fps)).round().max(1.0);
        let whole = (cycles * gait.cycle_secs * fps).round();
        gait.cycle_secs = whole / (cycles * fps);
        frames = whole as usize + 1;
        period = Some(whole as usize * substeps);
    }
    let mut plan = Plan {
        action: params.action,
        gait,
        path: Path::integrate(0.0, 1.0, 0, |_| (0.0, 0.0)),
        plants: [Vec::new(), Vec::new()],
        frames,
        substeps,
        dt_secs,
        margin,
        period,
        phase_zero: 0.0,
        moving: (f64::NEG_INFINITY, f64::INFINITY),
        top_speed: speed,
        jump: None,
    };
    match params.action {
        Action::Walk | Action::Run => steady(&mut plan, params, body),
        Action::Start => start(&mut plan, params, body),
        Action::Stop => stop(&mut plan, params, body),
        Action::Idle | Action::Spin => super::spot::on_the_spot(&mut plan, params, body),
        Action::Jump => super::spot::jump(&mut plan, params, body),
    }
    plan.keep_legs_apart(params, body);
    plan
}

/// Returns the acceleration into the curve over gravity.
fn sideways(params: &Params) -> f64 {
    f64::from((params.speed_mps * params.turn_rate_dps.to_radians()).abs()) / gravity()
}

fn swing_of(gait: &Gait, share: f64, params: &Params, body: &Body) -> Swing {
    let scale = f64::from(body.scale);
    let energy = f64::from(params.style.energy);
    let degrees = f64::to_radians;
    if gait.running {
        let quick = gait.quick_run();
        // In a tight curve the hips are lower.
        let lateral = sideways(params);
        let lift = (0.17 + 0.13 * quick) * (0.7 + 0.3 * energy) / (1.0 + lateral * lateral);
        return Swing {
            peak: (0.27, scale * lift),
            low: (0.66, scale * (0.07 + 0.04 * quick)),
            pitch: [(0.28, degrees(84.0 + 28.0 * quick)), (0.60, degrees(38.0))],
            toes_up: degrees(-2.0),
            start_acceleration: 0.65,
            end_acceleration: 1.4,
            sideways: DVec2::ZERO,
            lift_off_mps: 0.0,
        };
    }
    let quick = (gait.alike_mps / 1.4).clamp(0.25, 1.6) * share;
    Swing {
        peak: (0.27, scale * (0.04 + 0.035 * quick) * (0.6 + 0.4 * energy)),
        low: (0.62, scale * (0.018 + 0.008 * energy + 0.012 * quick)),
        pitch: [
            (0.12, degrees(12.0) + degrees(54.0) * share.max(0.2) * quick.clamp(0.6, 1.2).sqrt()),
            (0.58, degrees(4.0)),
        ],
        toes_up: degrees(-3.0),
        start_acceleration: 1.2,
        end_acceleration: 0.7,
        sideways: DVec2::ZERO,
        lift_off_mps: 0.0,
    }
}

/// Returns the plant of a regular gait that begins at `from`; its angles are scaled by `share` of
/// the full step (0 to 1).
fn regular(plan: &Plan, side: usize, from: f64, share: f64, params: &Params, body: &Body) -> Plant {
    let gait = &plan.gait;
    let cycle = gait.cycle_secs;
    let to = from + gait.duty * cycle;
    let middle = from + 0.5 * gait.duty * cycle;
    Plant {
        from,
        flat_from: from + gait.flat_from * cycle,
        flat_to: from + gait.flat_to * cycle,
        to,
        ankle: plan.foothold(side, middle, gait.half_width, params, body),
        half_width: gait.half_width,
        yaw: plan.path.at(middle).yaw + toe_out(side, gait.running),
        strike_pitch: gait.strike_pitch * share,
        release_pitch: gait.release_pitch * (0.35 + 0.65 * share),
        load_secs: if gait.running { 0.3 * gait.duty * cycle } else { (gait.duty - 0.5) * cycle },
        stances_per_sec: (gait.duty * cycle).recip(),
        swing: swing_of(gait, share, params, body),
    }
}

fn steady(plan: &mut Plan, params: &Params, body: &Body) {
    let (speed, yaw_rate) =
        (f64::from(params.speed_mps), f64::from(params.turn_rate_dps).to_radians());
    plan.set_path(|_| (speed, yaw_rate));
    let cycle = plan.gait.cycle_secs;
    let (first, last) = (
        (plan.secs(0) / cycle).floor() as i64 - 1,
        (plan.secs(plan.len()) / cycle).ceil() as i64 + 1,
    );
    for side in 0..2 {
        plan.plants[side] = (first..=last)
            .map(|k| regular(plan, side, (k as f64 + 0.5 * side as f64) * cycle, 1.0, params, body))
            .collect();
    }
}

/// Returns a plant without a beginning (`from` = -∞) or without an end (`to` = ∞).
fn standing(
    mut plant: Plant,
    plan: &Plan,
    side: usize,
    params: &Params,
    body: &Body,
    before: bool,
) -> Plant {
    let at = if before { f64::NEG_INFINITY } else { f64::INFINITY };
    plant.half_width = standing_half_width(params, body);
    plant.ankle = plan.standing_foothold(side, at, params, body);
    plant.yaw = plan.path.at(at).yaw + toe_out(side, false);
    if before {
        (plant.from, plant.flat_from) = (at, at);
    } else {
        (plant.to, plant.flat_to) = (at, at);
    }
    plant
}

fn start(plan: &mut Plan, params: &Params, body: &Body) {
    let (speed, yaw_rate) =
        (f64::from(params.speed_mps), f64::from(params.turn_rate_dps).to_radians());
    let (cycle, duty) = (plan.gait.cycle_secs, plan.gait.duty);
    // The right foot lifts first. The body falls forward before that: 0.4 to 0.5 s from the first
    // shift of weight to the first toe-off, full speed after about two steps (Breniere and Do 1986;
    // Jian et al. 1993).
    let lift = 0.85;
    plan.phase_zero = lift - (duty - 0.5) * cycle;
    plan.moving = (lift - 0.1, f64::INFINITY);
    let (from, to) = (lift - 0.35, lift + 1.05 * cycle);
    plan.set_path(|t| {
        let share = ramp(t, from, to);
        (speed * share, yaw_rate * share)
    });
    let last = ((plan.secs(plan.len()) - plan.phase_zero) / cycle).ceil() as i64 + 1;
    for side in 0..2 {
        let first = -(side as i64);
        let plants = (first..=last).map(|k| {
            let strike = plan.phase_zero + (k as f64 + 0.5 * side as f64) * cycle;
            let share = plan.going(strike + 0.35 * duty * cycle).sqrt();
            let plant = regular(plan, side, strike, share, params, body);
            if k > first { plant } else { standing(plant, plan, side, params, body, true) }
        });
        plan.plants[side] = plants.collect();
    }
}

fn stop(plan: &mut Plan, params: &Params, body: &Body) {
    let (speed, yaw_rate) =
        (f64::from(params.speed_mps), f64::from(params.turn_rate_dps).to_radians());
    let (cycle, duty) = (plan.gait.cycle_secs, plan.gait.duty);
    // The right foot takes the last step, 1.2 s before the end; the speed is lost over the two
    // steps before (Jaeger and Vanitchatchavan 1992).
    let end = plan.secs(plan.step_of(plan.frames - 1));
    let closed = end - 1.2;
    plan.phase_zero = closed - 0.5 * cycle;
    plan.moving = (f64::NEG_INFINITY, closed + 0.1);
    let (from, to) = (closed - 1.4 * cycle, closed + 0.25);
    plan.set_path(|t| {
        let share = 1.0 - ramp(t, from, to);
        (speed * share, yaw_rate * share)
    });
    let first = ((plan.secs(0) - plan.phase_zero) / cycle).floor() as i64 - 1;
    for side in 0..2 {
        let plants = (first..=0).map(|k| {
            let strike = plan.phase_zero + (k as f64 + 0.5 * side as f64) * cycle;
            let share = plan.going(strike + 0.2 * duty * cycle).sqrt();
            let plant = regular(plan, side, strike, share, params, body);
            if k < 0 { plant } else { standing(plant, plan, side, params, body, false) }
        });
        plan.plants[side] = plants.collect();
    }
}
