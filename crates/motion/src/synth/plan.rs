//! What is going to happen: the way over the ground, and when and where each foot is set down.

use super::body::Body;
use super::foot::{Plant, Swing};
use super::gait::{Gait, gravity, pendulum_height};
use super::params::{Action, Params};
use super::path::{Path, Place};
use super::track::ramp;
use glam::DVec2;

/// Seconds that are made before and after the clip, so that filters see what comes and came:
/// e^(-3.2 × 3) of an edge's centimetres is left.
const MARGIN_SECS: f64 = 3.0;
/// How far the ankles of a standing adult of 1.75 m are behind the middle of the body, metres: it
/// rests over the middle of the feet.
pub(super) const STANDING_BEHIND: f64 = 0.05;
/// The coarsest time step that is planned with.
const COARSEST_SECS: f64 = 1.0 / 110.0;

/// The times of a jump, seconds.
#[derive(Clone, Copy, Debug)]
pub(super) struct JumpTimes {
    pub(super) dip: f64,
    pub(super) bottom: f64,
    pub(super) off: f64,
    pub(super) land: f64,
    pub(super) absorbed: f64,
    pub(super) stood: f64,
}

/// A plan on a grid of time steps of which every `substeps`th is a frame.
#[derive(Clone, Debug)]
pub(super) struct Plan {
    pub(super) action: Action,
    pub(super) gait: Gait,
    pub(super) path: Path,
    /// Left and right, in order of time.
    pub(super) plants: [Vec<Plant>; 2],
    pub(super) frames: usize,
    pub(super) substeps: usize,
    pub(super) dt_secs: f64,
    /// Grid steps before frame 0 and after the last frame.
    pub(super) margin: usize,
    /// Grid steps of one cycle, where the motion repeats exactly.
    pub(super) period: Option<usize>,
    /// When the left heel strikes, and between when the phase runs.
    pub(super) phase_zero: f64,
    pub(super) moving: (f64, f64),
    /// 0 standing to 1 going at full speed.
    pub(super) top_speed: f64,
    pub(super) jump: Option<JumpTimes>,
}

impl Plan {
    /// Number of grid steps.
    pub(super) fn len(&self) -> usize {
        (self.frames - 1) * self.substeps + 1 + 2 * self.margin
    }

    /// Time of a grid step; 0 at frame 0.
    pub(super) fn secs(&self, step: usize) -> f64 {
        (step as f64 - self.margin as f64) * self.dt_secs
    }

    /// The grid step of a frame.
    pub(super) fn step_of(&self, frame: usize) -> usize {
        self.margin + frame * self.substeps
    }

    /// Cycles since the left heel strike at `phase_zero`; stands still while the feet do.
    pub(super) fn cycles(&self, secs: f64) -> f64 {
        (secs.clamp(self.moving.0, self.moving.1) - self.phase_zero) / self.gait.cycle_secs
    }

    /// How much of a gait is going on, 0 to 1.
    pub(super) fn going(&self, secs: f64) -> f64 {
        if self.top_speed > 0.0 && self.jump.is_none() {
            (self.path.at(secs).speed / self.top_speed).clamp(0.0, 1.0)
        } else {
            0.0
        }
    }
}

/// Plans the motion of valid parameters.
pub(super) fn plan(params: &Params, body: &Body) -> Plan {
    let fps = f64::from(params.fps);
    let substeps = ((fps * COARSEST_SECS).recip().ceil() as usize).max(1);
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
        // Nobody keeps such a curve; a shorter contact keeps the legs from being torn apart by it.
        gait.duty /= 1.0 + 0.6 * ramp(sideways(params), 0.0, 1.2);
        gait.flat_from = gait.flat_from.min(0.25 * gait.duty);
        gait.flat_to = gait.flat_to.min(0.5 * gait.duty);
    }
    let mut frames = asked as usize + 1;
    let mut period = None;
    if matches!(params.action, Action::Walk | Action::Run) {
        // Whole cycles are whole frames: the cadence gives way by less than half a frame per clip,
        // the speed does not.
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

impl Plan {
    /// Integrates the way over the whole grid.
    pub(super) fn set_path(&mut self, rates: impl Fn(f64) -> (f64, f64)) {
        self.path = Path::integrate(self.secs(0), self.dt_secs, self.len(), rates);
    }

    /// Where the foot of a body belongs that stands at the place of `secs`: wider apart, and under
    /// the body.
    pub(super) fn standing_foothold(
        &self,
        side: usize,
        secs: f64,
        params: &Params,
        body: &Body,
    ) -> DVec2 {
        let place = self.path.at(secs);
        let half_width = standing_half_width(params, body);
        let outward = if side == 0 { half_width } else { -half_width };
        place.position + place.left() * outward
            - place.forward() * (STANDING_BEHIND * f64::from(body.scale))
    }

    /// Where the foot of a side belongs while the body passes the place of `secs`: to its side,
    /// and, since an inverted pendulum accelerates away from its foot by ω²(x - foot), away from
    /// where the body is heading.
    pub(super) fn foothold(
        &self,
        side: usize,
        secs: f64,
        half_width: f64,
        params: &Params,
        body: &Body,
    ) -> DVec2 {
        foothold_at(&self.path.at(secs), side, half_width, self.gait, params, body)
    }
}

/// Where the foot of a side belongs while the body passes `place`; see [`Plan::foothold`].
fn foothold_at(
    place: &Place,
    side: usize,
    half_width: f64,
    gait: Gait,
    params: &Params,
    body: &Body,
) -> DVec2 {
    let outward = if side == 0 { half_width } else { -half_width };
    // Half of speeding up and slowing down is done by the ankles and by the sway of the trunk.
    let eased = Place { thrust: 0.5 * place.thrust, ..*place };
    let support = eased.lean(gravity()) * -pendulum_height(params.height_m);
    let behind =
        f64::from(body.scale) * if gait.running { 0.20 - 0.03 * gait.quick_run() } else { 0.105 };
    place.position + support + place.left() * outward - place.forward() * behind
}

impl Plan {
    /// Bends the way of every swing around the other leg: half-way, the foot is as far to its side
    /// of the body as on the ground, and a little farther where it turns on the spot.
    fn keep_legs_apart(&mut self, params: &Params, body: &Body) {
        let spinning = self.action == Action::Spin;
        let room = if spinning { 0.06 * f64::from(body.scale) } else { 0.0 };
        for side in 0..2 {
            for index in 1..self.plants[side].len() {
                let (from, to) = (self.plants[side][index - 1], self.plants[side][index]);
                let middle = 0.5 * (from.to + to.from);
                let place = self.path.at(middle);
                let facing = if spinning {
                    Place { yaw: 0.5 * (from.yaw + to.yaw) - toe_out(side, false), ..place }
                } else {
                    place
                };
                let half_width = 0.5 * (from.half_width + to.half_width) + room;
                let wanted = foothold_at(&facing, side, half_width, self.gait, params, body);
                let left = facing.left();
                let missing = (wanted - 0.5 * (from.ankle + to.ankle)).dot(left);
                self.plants[side][index - 1].swing.aside = left * missing;
            }
        }
    }
}

/// Half the distance of standing feet, metres.
pub(super) fn standing_half_width(params: &Params, body: &Body) -> f64 {
    f64::from(body.scale) * 0.085 * f64::from(0.4 + 0.6 * params.style.stance_width)
}

/// Out-toeing, radians: about 7° per foot in walking (Murray 1967), less in running.
pub(super) fn toe_out(side: usize, running: bool) -> f64 {
    let angle = if running { 3.0_f64 } else { 6.5 };
    if side == 0 { angle.to_radians() } else { -angle.to_radians() }
}

/// Acceleration into the curve over gravity.
fn sideways(params: &Params) -> f64 {
    f64::from((params.speed_mps * params.turn_rate_dps.to_radians()).abs()) / gravity()
}

fn swing_of(gait: &Gait, share: f64, params: &Params, body: &Body) -> Swing {
    let scale = f64::from(body.scale);
    let energy = f64::from(params.style.energy);
    let degrees = f64::to_radians;
    if gait.running {
        let quick = gait.quick_run();
        // Deep in a curve there is less room under the hips.
        let lateral = sideways(params);
        let lift = (0.17 + 0.13 * quick) * (0.7 + 0.3 * energy) / (1.0 + lateral * lateral);
        return Swing {
            peak: (0.27, scale * lift),
            low: (0.66, scale * (0.07 + 0.04 * quick)),
            pitch: [(0.28, degrees(84.0 + 28.0 * quick)), (0.60, degrees(38.0))],
            toes_up: degrees(-2.0),
            eager: 0.65,
            late: 1.4,
            aside: DVec2::ZERO,
            spring: 0.0,
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
        eager: 1.2,
        late: 0.7,
        aside: DVec2::ZERO,
        spring: 0.0,
    }
}

/// The plant of a regular gait that begins at `from`; `share` of the full step (0 to 1) tempers its
/// angles.
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

/// A plant that has stood since ever (`from` = -∞) or will for ever (`to` = ∞).
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
    // The right foot closes up last, 1.2 s before the end; the speed is lost over the two steps
    // before (Jaeger and Vanitchatchavan 1992).
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
