//! The height of the hips: as high as the legs allow in walking, and by gravity in running and
//! jumping.

use super::body::Body;
use super::foot::Foot;
use super::gait::gravity;
use super::params::{Action, Params};
use super::plan::{JumpTimes, Plan};
use super::posture::Posture;
use super::track::{State, quintic};
use glam::DVec2;

/// The greatest length of a swinging leg, as a share of its straight length: a knee is never fully
/// straight (4° are left).
pub(super) const MAX_SWING_LENGTH_SHARE: f32 = 0.9994;

/// Returns the least flexion of the knee of a planted leg, radians. It is about 5° in walking
/// (Perry and Burnfield 2010), and more at strike and release in running.
pub(super) fn least_flexion(running: bool) -> f32 {
    if running { 15.0_f32.to_radians() } else { 6.0_f32.to_radians() }
}

/// Returns the greatest length of a leg during stance, and shortly before and after. A leg that
/// pushes off or has just left the ground is bent by nearly 20° at least, because its foot trails
/// behind.
fn longest_bearing(foot: &Foot, running: bool, body: &Body) -> Option<f64> {
    let least = least_flexion(running);
    let pushing = 0.35;
    let flexion = match (foot.planted(), foot.progress) {
        (true, progress) if progress < 0.93 => least,
        (false, progress) if !running && progress > 0.86 => least,
        (true, _) => pushing,
        (false, progress) if progress < 0.15 => pushing,
        _ => return None,
    };
    Some(f64::from(body.reach_at_flexion(flexion)))
}

/// Returns the height of the hips at every step of the grid, metres, for their trajectory `ground`
/// (x, z).
pub(super) fn heights(
    plan: &Plan,
    feet: &[[Foot; 2]],
    ground: &[DVec2],
    posture: &Posture,
    params: &Params,
    body: &Body,
) -> Vec<f64> {
    let legs = Legs::new(plan, feet, ground, posture, body);
    match (plan.jump, plan.action) {
        (Some(times), _) => jumping(plan, &legs, &times),
        (None, Action::Run) => running(plan, &legs),
        (None, _) => walking(plan, &legs, params),
    }
}

/// The state of one leg at one moment that determines the height of the hips.
#[derive(Clone, Copy)]
struct Leg {
    planted: bool,
    /// The greatest length of this leg, metres; `None` in the air.
    longest: Option<f64>,
    load: f64,
    progress: f64,
    /// Height of this hip joint above the hips.
    hip_rise: f64,
    ankle_height: f64,
    /// Horizontal distance from hip joint to ankle, metres.
    across: f64,
}

struct Legs<'a> {
    body: &'a Body,
    steps: Vec<[Leg; 2]>,
}

impl<'a> Legs<'a> {
    fn new(
        plan: &Plan,
        feet: &[[Foot; 2]],
        ground: &[DVec2],
        posture: &Posture,
        body: &'a Body,
    ) -> Self {
        let steps = (feet.iter().zip(ground).enumerate())
            .map(|(step, (pair, ground))| {
                let pelvis = posture.pelvis(plan, plan.secs(step));
                [0, 1].map(|side| {
                    let foot = &pair[side];
                    let hip = pelvis * body.hip_in_hips[side];
                    let ankle = DVec2::new(f64::from(foot.ankle.x), f64::from(foot.ankle.z));
                    Leg {
                        planted: foot.planted(),
                        longest: longest_bearing(foot, plan.gait.running, body),
                        load: foot.load,
                        progress: foot.progress,
                        hip_rise: f64::from(hip.y),
                        ankle_height: f64::from(foot.ankle.y),
                        across: (ground + DVec2::new(f64::from(hip.x), f64::from(hip.z)) - ankle)
                            .length(),
                    }
                })
            })
            .collect();
        Self { body, steps }
    }

    /// Returns the height of the hips at which this leg has the length `reach`; `None` where the
    /// leg is too short.
    fn height_at(leg: &Leg, reach: f64) -> Option<f64> {
        let up = reach * reach - leg.across * leg.across;
        (up > 0.0).then(|| leg.ankle_height + up.sqrt() - leg.hip_rise)
    }

    /// Returns the greatest height at a step that is possible for the legs on the ground, and for
    /// those about to leave or reach it.
    fn ceiling(&self, step: usize) -> f64 {
        (self.steps[step].iter())
            .filter_map(|leg| {
                leg.longest.map(|longest| Self::height_at(leg, longest).unwrap_or(0.3 * longest))
            })
            .fold(f64::INFINITY, f64::min)
    }

    /// Returns the height at which the loaded legs have a given knee flexion (radians, by progress
    /// of stance), weighted by load; `None` in flight.
    fn wanted(
        &self,
        step: usize,
        weight: impl Fn(&Leg) -> f64,
        flexion: impl Fn(f64) -> f64,
    ) -> Option<(f64, f64)> {
        let mut sum = 0.0;
        let mut total = 0.0;
        for leg in self.steps[step].iter().filter(|leg| leg.planted) {
            let reach = self.body.reach_at_flexion(flexion(leg.progress) as f32);
            if let Some(height) = Self::height_at(leg, f64::from(reach)) {
                let w = weight(leg).max(1e-6);
                sum += w * height;
                total += w;
            }
        }
        (total > 0.0).then(|| (sum / total, total))
    }
}

/// Returns means over `half` steps to either side, with weights that fall smoothly to 0 (raised
/// cosine). Beyond the ends the first or last value is used.
fn smoothed(values: &[f64], half: usize) -> Vec<f64> {
    let span = (half + 1) as f64;
    let weights: Vec<f64> =
        (0..=half).map(|k| 1.0 + libm::cos(std::f64::consts::PI * k as f64 / span)).collect();
    let total: f64 = weights[0] + 2.0 * weights[1..].iter().sum::<f64>();
    let last = values.len().saturating_sub(1);
    (0..values.len())
        .map(|i| {
            let sides: f64 = (1..=half)
                .map(|k| weights[k] * (values[i.saturating_sub(k)] + values[(i + k).min(last)]))
                .sum();
            (weights[0] * values[i] + sides) / total
        })
        .collect()
}

/// Lowers `heights` to below `ceiling` everywhere, smoothly: the excess, widened and then smoothed
/// over the same window, is never less than the excess itself.
fn kept_below(heights: &mut [f64], ceiling: impl Fn(usize) -> f64, half: usize) {
    let excess: Vec<f64> =
        heights.iter().enumerate().map(|(i, h)| (h - ceiling(i)).max(0.0)).collect();
    if excess.iter().all(|&e| e == 0.0) {
        return;
    }
    let last = excess.len() - 1;
    let widened: Vec<f64> = (0..excess.len())
        .map(|i| {
            excess[i.saturating_sub(half)..=(i + half).min(last)]
                .iter()
                .copied()
                .fold(0.0, f64::max)
        })
        .collect();
    for (height, lower) in heights.iter_mut().zip(smoothed(&widened, half)) {
        *height -= lower;
    }
}

/// Returns the vertical range of the hips in walking, metres: 2.7 cm at 0.7 m/s and 4.8 cm at 1.6
/// m/s (Orendurff et al. 2004).
fn walking_rise(alike_mps: f64) -> f64 {
    (0.006 + 0.0265 * alike_mps).max(0.0)
}

/// Returns the heights in walking: as high as the legs allow, with a wave that is lowest just after
/// a heel strike and highest over the stance foot. The compensating motion of knees and heels
/// (Saunders, Inman and Eberhart 1953) then follows from the feet.
fn walking(plan: &Plan, legs: &Legs, params: &Params) -> Vec<f64> {
    const LOWEST_CYCLES: f64 = 0.03;
    const STANDING_FLEXION: f64 = 6.0;
    let cycle = plan.gait.cycle_secs;
    let mut level = f64::from(legs.body.hip_height());
    let raw: Vec<f64> = (0..plan.len())
        .map(|step| {
            level = legs
                .wanted(step, |leg| leg.load, |_| STANDING_FLEXION.to_radians())
                .map_or(level, |(height, _)| height);
            level
        })
        .collect();
    let steps_of = |share: f64| ((share * cycle / plan.dt_secs).round() as usize).max(2);
    let rise = walking_rise(plan.gait.alike_mps)
        * f64::from(legs.body.scale)
        * f64::from(params.style.bounce);
    let mut heights: Vec<f64> =
        (smoothed(&raw, steps_of(if plan.top_speed > 0.0 { 0.5 } else { 0.25 }))
            .into_iter()
            .enumerate())
        .map(|(step, level)| {
            let secs = plan.secs(step);
            level
                - 0.5
                    * rise
                    * plan.going(secs)
                    * libm::cos(2.0 * std::f64::consts::TAU * (plan.cycles(secs) - LOWEST_CYCLES))
        })
        .collect();
    // Over a whole step, so that the mean height is lowered and the wave is kept.
    kept_below(&mut heights, |step| legs.ceiling(step), steps_of(0.25));
    heights
}

/// Returns the height over a step of running, from the strike, relative to the height at the
/// strike, metres.
///
/// In flight gravity alone acts. On the ground the force is half a sine (Alexander, Maloiy, Hunter,
/// Jayes and Nturibi 1979; Blickhan 1989), which must carry the weight of the whole step: a =
/// g·(π/2 · T/c · sin(πt/c) - 1) for a step of T and a contact of c seconds.
fn spring_mass(secs: f64, step_secs: f64, contact_secs: f64) -> f64 {
    let g = gravity();
    let flight = step_secs - contact_secs;
    let down = -0.5 * g * flight;
    if secs < contact_secs {
        let (c, w) = (contact_secs, std::f64::consts::PI / contact_secs);
        let peak = 0.5 * std::f64::consts::PI * step_secs / c;
        // Integrated twice with the velocity `down` at the strike; symmetric about the middle, so
        // that the release mirrors the strike.
        let from_force = g * peak * (secs / w - libm::sin(w * secs) / (w * w));
        down * secs + from_force - 0.5 * g * secs * secs
    } else {
        let t = secs - contact_secs;
        -down * t - 0.5 * g * t * t
    }
}

fn running(plan: &Plan, legs: &Legs) -> Vec<f64> {
    let gait = &plan.gait;
    let (step_secs, contact) = (0.5 * gait.cycle_secs, gait.duty * gait.cycle_secs);
    let shape: Vec<f64> = (0..plan.len())
        .map(|step| {
            spring_mass(
                (plan.secs(step) - plan.phase_zero).rem_euclid(step_secs),
                step_secs,
                contact,
            )
        })
        .collect();
    // 12° at the strike, about 40° in the middle, 16° at the release (Novacheck 1998, figure 8).
    let flexion =
        |progress: f64| (14.0 + 27.0 * libm::sin(std::f64::consts::PI * progress)).to_radians();
    let mut sum = 0.0;
    let mut total = 0.0;
    let mut limit = f64::INFINITY;
    for (step, &shape) in shape.iter().enumerate().skip(plan.margin).take(plan.period.unwrap_or(1))
    {
        if let Some((height, weight)) = legs.wanted(step, |leg| leg.load, flexion) {
            sum += weight * (height - shape);
            total += weight;
        }
        limit = limit.min(legs.ceiling(step) - shape);
    }
    let level = if total > 0.0 { sum / total } else { f64::from(legs.body.hip_height()) };
    let level = level.min(limit);
    shape.into_iter().map(|height| level + height).collect()
}

/// Returns the heights of a jump: stand, dip, push, flight under gravity, landing, absorption,
/// stand.
fn jumping(plan: &Plan, legs: &Legs, times: &JumpTimes) -> Vec<f64> {
    let g = gravity();
    let leg = f64::from(legs.body.leg());
    let step_at = |secs: f64| {
        ((secs / plan.dt_secs).round() as i64 + plan.margin as i64).clamp(0, plan.len() as i64 - 1)
            as usize
    };
    let at_flexion = |secs: f64, degrees: f64| {
        legs.wanted(step_at(secs), |_| 1.0, |_| degrees.to_radians())
            .map_or(leg, |(height, _)| height)
            .min(legs.ceiling(step_at(secs)))
    };
    let stand = |secs: f64| at_flexion(secs, 5.0);
    let (before, after) = (stand(0.0), stand(plan.secs(plan.len() - 1)));
    let air = times.land - times.off;
    let off = at_flexion(times.off - plan.dt_secs, 30.0);
    let up = 0.5 * g * air;
    // The height of landing is that of take-off plus the difference of knee flexion: the velocity
    // at take-off follows from both heights.
    let land = at_flexion(times.land + plan.dt_secs, 34.0);
    let up = up + (land - off) / air;
    let down = up - g * air;
    let rest = State::rest;
    let fly = |value: f64, rate: f64| State { value, rate, acceleration: -g };
    let pieces = [
        (
            times.dip,
            times.bottom,
            rest(before),
            State { value: before - 0.30 * leg, rate: 0.0, acceleration: 9.0 },
        ),
        (
            times.bottom,
            times.off,
            State { value: before - 0.30 * leg, rate: 0.0, acceleration: 9.0 },
            fly(off, up),
        ),
        (
            times.land,
            times.absorbed,
            fly(land, down),
            State { value: after - 0.24 * leg, rate: 0.0, acceleration: 7.0 },
        ),
        (
            times.absorbed,
            times.stood,
            State { value: after - 0.24 * leg, rate: 0.0, acceleration: 7.0 },
            rest(after),
        ),
    ];
    let mut heights: Vec<f64> = (0..plan.len())
        .map(|step| {
            let secs = plan.secs(step);
            if (times.off..=times.land).contains(&secs) {
                let t = secs - times.off;
                return off + up * t - 0.5 * g * t * t;
            }
            let piece = pieces.iter().find(|piece| secs >= piece.0 && secs < piece.1);
            piece.map_or(if secs < times.dip { before } else { after }, |&(from, to, a, b)| {
                quintic(a, b, to - from, secs - from)
            })
        })
        .collect();
    let flight = step_at(times.off).saturating_sub(2)..step_at(times.land) + 2;
    let half = ((0.05 / plan.dt_secs) as usize).max(2);
    let free = heights.clone();
    kept_below(
        &mut heights,
        |step| {
            if flight.contains(&step) { f64::INFINITY } else { legs.ceiling(step) }
        },
        half,
    );
    // The flight is a parabola.
    let flight = flight.start..flight.end.min(free.len());
    heights[flight.clone()].copy_from_slice(&free[flight]);
    heights
}
