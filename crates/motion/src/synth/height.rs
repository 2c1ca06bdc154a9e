//! How high the hips are: as high as the legs let them in walking, as gravity has it in running and
//! jumping.

use super::body::Body;
use super::foot::Foot;
use super::gait::gravity;
use super::params::{Action, Params};
use super::plan::{JumpTimes, Plan};
use super::posture::Posture;
use super::track::{State, quintic};
use glam::DVec2;

/// The longest a swinging leg gets, as a share of its length: a knee is never quite straight (4°
/// are left).
pub(super) const LONGEST: f32 = 0.9994;

/// The least flexion of the knee of a planted leg, radians. It is about 5° in walking (Perry and
/// Burnfield 2010); runners land and leave with more.
pub(super) fn least_flexion(running: bool) -> f32 {
    if running { 15.0_f32.to_radians() } else { 6.0_f32.to_radians() }
}

/// How long a leg may be while it bears, and shortly before and after; a leg that pushes off or has
/// just left is bent by nearly 20° at least, for its foot trails behind.
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

/// The height of the hips at every step of the grid, metres, over their way `ground` (x, z).
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

/// One leg at one moment, as far as the height of the hips needs it.
#[derive(Clone, Copy)]
struct Leg {
    planted: bool,
    /// How long this leg may be, metres; `None` in the air.
    longest: Option<f64>,
    load: f64,
    progress: f64,
    /// From the hips' height to this hip joint's.
    hip_rise: f64,
    ankle_height: f64,
    /// Hip joint to ankle over the ground, metres.
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

    /// The height of the hips at which this leg is `reach` long; `None` where the leg is too short
    /// to reach at all.
    fn height_at(leg: &Leg, reach: f64) -> Option<f64> {
        let up = reach * reach - leg.across * leg.across;
        (up > 0.0).then(|| leg.ankle_height + up.sqrt() - leg.hip_rise)
    }

    /// The greatest height that the legs on the ground, and those about to leave or meet it, allow
    /// at a step.
    fn ceiling(&self, step: usize) -> f64 {
        (self.steps[step].iter())
            .filter_map(|leg| {
                leg.longest.map(|longest| Self::height_at(leg, longest).unwrap_or(0.3 * longest))
            })
            .fold(f64::INFINITY, f64::min)
    }

    /// The height at which the loaded legs have the wanted knee flexion (radians, by progress of
    /// stance), weighted by load; `None` in flight.
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

/// A mean over a compact window whose weights fall smoothly to 0 (raised cosine), `half` steps to
/// either side; the ends are held.
fn smoothed(values: &[f64], half: usize) -> Vec<f64> {
    let span = (half + 1) as f64;
    let weights: Vec<f64> =
        (0..=half).map(|k| 1.0 + (std::f64::consts::PI * k as f64 / span).cos()).collect();
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
/// over the same window, is never less than itself.
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

/// Rise and fall of the hips in walking from lowest to highest, metres: 2.7 cm at 0.7 m/s and 4.8
/// cm at 1.6 m/s (Orendurff et al. 2004).
fn walking_rise(alike_mps: f64) -> f64 {
    (0.006 + 0.0265 * alike_mps).max(0.0)
}

/// The hips ride as high as the legs let them, on a wave that is lowest just after a heel strike
/// and highest over the stance foot: what knees and heels have to make up for (Saunders, Inman and
/// Eberhart 1953) then follows from the feet.
fn walking(plan: &Plan, legs: &Legs, params: &Params) -> Vec<f64> {
    const LOWEST: f64 = 0.03;
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
                    * (2.0 * std::f64::consts::TAU * (plan.cycles(secs) - LOWEST)).cos()
        })
        .collect();
    // Over a whole step, so that the level gives way and the wave stays.
    kept_below(&mut heights, |step| legs.ceiling(step), steps_of(0.25));
    heights
}

/// Height over a step of running, from the strike, over the height at the strike; `m` metres.
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
        // Twice integrated with the rate `down` at the strike; symmetric about the middle, so the
        // release is the strike reversed.
        let from_force = g * peak * (secs / w - (w * secs).sin() / (w * w));
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
        |progress: f64| (14.0 + 27.0 * (std::f64::consts::PI * progress).sin()).to_radians();
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

/// Stand, dip, push, fly under gravity, land, absorb, stand.
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
    // It lands as high as it leaves, plus what is asked of the knees there: the rate at take-off
    // follows from both heights.
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
    // Nothing bends the flight.
    let flight = flight.start..flight.end.min(free.len());
    heights[flight.clone()].copy_from_slice(&free[flight]);
    heights
}
