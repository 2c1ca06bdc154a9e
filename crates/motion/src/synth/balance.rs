//! The trajectory of the hips over the ground: they balance on the feet as an inverted pendulum.

use super::body::Body;
use super::foot::{Foot, foot_at};
use super::gait::{gravity, pendulum_height};
use super::height::heights;
use super::params::Params;
use super::plan::Plan;
use super::posture::Posture;
use glam::{DVec2, Vec3};

/// The positions of the hips on the grid of a plan.
pub(super) struct Hips {
    pub(super) feet: Vec<[Foot; 2]>,
    pub(super) positions: Vec<Vec3>,
}

/// Computes the positions of the hips over planned feet.
pub(super) fn hips(plan: &Plan, posture: &Posture, params: &Params, body: &Body) -> Option<Hips> {
    let feet: Option<Vec<[Foot; 2]>> = (0..plan.len())
        .map(|step| {
            let secs = plan.secs(step);
            Some([foot_at(&plan.plants[0], body, secs)?, foot_at(&plan.plants[1], body, secs)?])
        })
        .collect();
    let feet = feet?;
    let ground = over_the_ground(plan, &feet, posture, params);
    let heights = heights(plan, &feet, &ground, posture, params, body);
    let positions = ground
        .iter()
        .zip(&heights)
        .map(|(xz, &y)| Vec3::new(xz.x as f32, y as f32, xz.y as f32))
        .collect();
    Some(Hips { feet, positions })
}

/// Returns the trajectory of the hips over the ground (x, z).
///
/// The body is a linear inverted pendulum on the centre of pressure p: ẍ = ω²(x - p). Its only
/// bounded motion is p convolved with the kernel ω/2·e^(-ω|t|), which looks ahead as far as back
/// (the preview of Kajita et al. 2003, in closed form). It contains the sway over the stance foot,
/// the shift of weight before a first step and the lean before a stop. Only the difference of p to
/// the foothold that follows from the planned path is filtered, so that a steady gait keeps its
/// speed and its circle exactly.
fn over_the_ground(
    plan: &Plan,
    feet: &[[Foot; 2]],
    posture: &Posture,
    params: &Params,
) -> Vec<DVec2> {
    let height = pendulum_height(params.height_m);
    let rate = (gravity() / height).sqrt();
    let places: Vec<_> = (0..plan.len()).map(|step| plan.path.at(plan.secs(step))).collect();
    let mut away: Vec<Option<DVec2>> = (feet.iter().zip(&places))
        .map(|(pair, place)| {
            let load: f64 = pair.iter().map(|foot| foot.load).sum();
            let pressure = pair.iter().map(|foot| foot.pressure * foot.load).sum::<DVec2>() / load;
            (load > 1e-6)
                .then(|| place.to_local(pressure - place.position + place.lean(gravity()) * height))
        })
        .collect();
    bridge(&mut away);
    let away: Vec<DVec2> = away.into_iter().map(Option::unwrap_or_default).collect();
    let mut swayed = two_sided(&away, libm::exp(-rate * plan.dt_secs));
    if let Some(period) = plan.period {
        let mean = swayed[plan.margin..plan.margin + period].iter().sum::<DVec2>() / period as f64;
        for sway in &mut swayed {
            *sway -= mean;
        }
    }
    // The hips sway farther than the centre of mass, because the trunk leans the other way
    // (Orendurff et al. 2004 measure 20 to 40 % more for the hips).
    let gain = DVec2::new(if plan.gait.running { 0.8 } else { 1.3 }, 1.0);
    (swayed.iter().zip(&places).enumerate())
        .map(|(step, (sway, place))| {
            place.position + place.to_world(*sway * gain + posture.drift(plan.secs(step)))
        })
        .collect()
}

/// Fills gaps (flight) linearly between their ends; gaps at the ends are filled with the nearest
/// value.
fn bridge(values: &mut [Option<DVec2>]) {
    let mut known: Option<(usize, DVec2)> = None;
    for i in 0..values.len() {
        let Some(here) = values[i] else { continue };
        let (start, before) = known.map_or((0, here), |(at, value)| (at, value));
        for (gone, gap) in values[start..i].iter_mut().enumerate() {
            gap.get_or_insert(before.lerp(here, gone as f64 / (i - start) as f64));
        }
        known = Some((i, here));
    }
    if let Some((at, value)) = known {
        values[at..].iter_mut().for_each(|v| *v = Some(v.unwrap_or(value)));
    }
}

/// Returns the two-sided exponential mean: half the sum of a forward and a backward pass.
fn two_sided(values: &[DVec2], keep: f64) -> Vec<DVec2> {
    let mut out = vec![DVec2::ZERO; values.len()];
    let mut state = values.first().copied().unwrap_or_default();
    for (sum, &value) in out.iter_mut().zip(values) {
        state = value + (state - value) * keep;
        *sum = state;
    }
    let mut state = values.last().copied().unwrap_or_default();
    for (sum, &value) in out.iter_mut().zip(values).rev() {
        state = value + (state - value) * keep;
        *sum = (*sum + state) * 0.5;
    }
    out
}
