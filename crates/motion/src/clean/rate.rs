//! The speed at which a take plays, judged by gravity and by the steps of a walk.

use super::fault::{Fault, FaultKind, Form, SizeUnit, confidence};
use crate::clip::Motion;
use crate::skeleton::Side;

/// The usual frame rates of files, frames per second.
const RATES: [f64; 10] = [15.0, 24.0, 25.0, 30.0, 50.0, 60.0, 90.0, 100.0, 120.0, 240.0];
/// The length of a step by its frequency is nearly the same at all usual speeds, metres per
/// (1/s): 0.64 cm per step a minute (Sekiya et al. 1996, "walk ratio").
const WALK_RATIO: f64 = 0.384;
/// The height of the person for which that holds, metres.
const HEIGHT_M: f64 = 1.7;
/// Only a rate that is wrong by more than this is told.
const MIN_FACTOR: f64 = 1.75;
/// The fewest steps, and the least length of one, metres.
const MIN_STEPS: usize = 4;
const MIN_STEP_M: f64 = 0.3;
/// Acceleration of gravity, metres per second squared.
const GRAVITY: f64 = 9.81;
/// The fewest frames of a flight.
const MIN_FLIGHT: usize = 7;

/// Returns a wrong frame rate.
pub(super) fn rate(motion: &Motion) -> Option<Fault> {
    let clip = motion.clip();
    let (factor, sure) = by_flight(motion).or_else(|| by_steps(motion))?;
    if (1.0 / MIN_FACTOR..MIN_FACTOR).contains(&factor) {
        return None;
    }
    let wanted = clip.fps() * factor;
    let fps = RATES.into_iter().min_by(|a, b| {
        let off = |rate: f64| libm::log(rate / wanted).abs();
        off(*a).total_cmp(&off(*b))
    })?;
    let size = (fps as f32, SizeUnit::FramesPerSecond);
    (fps != clip.fps())
        .then(|| Fault::of_body(FaultKind::Rate, 0..clip.frames(), Form::Rate(fps), size, sure))
}

/// Returns the factor on the frame rate at which the hips fall by gravity in flights, and how sure
/// it is: the square root of the ratio of the two accelerations.
fn by_flight(motion: &Motion) -> Option<(f64, f32)> {
    let clip = motion.clip();
    let contacts = motion.contacts();
    let flies = |frame: usize| contacts.feet().iter().all(|&foot| !contacts.planted(foot, frame));
    let heights = clip.root_translations();
    let mut found = Vec::new();
    let mut start = 0;
    while start < clip.frames() {
        let end = (start..clip.frames()).find(|&frame| !flies(frame)).unwrap_or(clip.frames());
        let inner = start + 1..end.saturating_sub(1);
        if start > 0 && end < clip.frames() && inner.len() >= MIN_FLIGHT {
            let values: Vec<f64> = inner.map(|frame| f64::from(heights[frame].y)).collect();
            let fall = -curvature(&values) * clip.fps() * clip.fps();
            if fall > 0.0 {
                found.push((GRAVITY / fall).sqrt());
            }
        }
        start = end.max(start) + 1;
    }
    found.sort_by(f64::total_cmp);
    let middle = *found.get(found.len() / 2)?;
    let agree = found.iter().filter(|factor| libm::log(*factor / middle).abs() < 0.25).count();
    (found.len() >= 2 && agree * 3 >= found.len() * 2)
        .then(|| (middle, confidence(agree as f32, 2.0)))
}

/// Returns the second derivative of the parabola through evenly spaced values, least squares.
fn curvature(values: &[f64]) -> f64 {
    let n = values.len() as f64;
    let at = |i: usize| i as f64 - (n - 1.0) / 2.0;
    let mean_square = (n * n - 1.0) / 12.0;
    // The quadratic that is orthogonal to the constant and the line.
    let (mut along, mut norm) = (0.0, 0.0);
    for (i, value) in values.iter().enumerate() {
        let p = at(i) * at(i) - mean_square;
        along += p * value;
        norm += p * p;
    }
    if norm > 0.0 { 2.0 * along / norm } else { 0.0 }
}

/// Returns the factor on the frame rate at which steps have the frequency that fits their length.
fn by_steps(motion: &Motion) -> Option<(f64, f32)> {
    let clip = motion.clip();
    // The ratio of step length and frequency is that of people.
    if motion.roles().is_quadruped() {
        return None;
    }
    let mut strikes: Vec<usize> = Side::BOTH
        .iter()
        .flat_map(|&side| motion.contacts().intervals(side))
        .map(|stance| stance.start)
        .filter(|&at| at > 0)
        .collect();
    strikes.sort_unstable();
    let (&first, &last) = strikes.first().zip(strikes.last())?;
    let steps = strikes.len() - 1;
    if steps < MIN_STEPS || last == first {
        return None;
    }
    let frames = motion.ground_frames();
    let way: f64 = (first..last).map(|at| frames[at].shift.distance(frames[at + 1].shift)).sum();
    let scale = f64::from(motion.body_height()) / HEIGHT_M;
    let step_m = way / steps as f64 / scale;
    if step_m < MIN_STEP_M {
        return None;
    }
    let hz = steps as f64 / ((last - first) as f64 / clip.fps());
    // Running steps are longer at their frequency: beyond 1 m they say nothing.
    let natural = (step_m.min(1.0) / WALK_RATIO).clamp(1.2, 3.2);
    let factor = natural / hz;
    Some((factor, confidence(factor.max(1.0 / factor) as f32, 2.2)))
}
