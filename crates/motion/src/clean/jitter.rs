//! Jitter: noise on top of a motion.

use super::fault::{Form, TrackFault, confidence};
use super::tracks::{Track, Tracks};
use crate::math::{LowPass, quat, stats};
use glam::{Quat, Vec3};
use std::ops::Range;

/// The duration of the windows in which noise is measured, seconds, and its least frames.
const WINDOW_SECS: f64 = 0.35;
const WINDOW_FRAMES: usize = 14;
/// The least noise that is reported, standard deviation per axis: radians and metres.
const MIN_NOISE: [f32; 2] = [0.006, 0.003];
/// The least ratio of fourth to second differences, squared, of which noise has 70 / 6.
const MIN_RATIO: f32 = 5.0;
/// The least ratio to the quieter part of the same track.
const MIN_CONTRAST: f32 = 3.5;
/// The median squared length of a vector of three standard normal variables.
const MEDIAN_SQUARE: f32 = 2.366;
/// The cut-off frequencies that are tried, hertz, from the lowest.
const CUTOFFS_HZ: [f64; 10] = [3.0, 4.0, 5.0, 6.0, 8.0, 10.0, 12.0, 15.0, 20.0, 25.0];
/// The context around noise that is filtered with it, seconds.
const CONTEXT_SECS: f64 = 0.5;
/// The correction fades in and out over this time, seconds.
const FADE_SECS: f64 = 0.04;

/// The noise in a window.
#[derive(Clone, Copy)]
struct Noise {
    deviation: f32,
    ratio: f32,
}

fn noise_in(steps: &[Vec3]) -> Noise {
    let median = |squares: Vec<f32>| stats::percentile(&squares, 0.5).unwrap_or(0.0);
    let second = median(steps.windows(2).map(|w| (w[1] - w[0]).length_squared()).collect());
    let fourth = median(
        (steps.windows(4))
            .map(|w| (w[3] - w[2] * 3.0 + w[1] * 3.0 - w[0]).length_squared())
            .collect(),
    );
    Noise { deviation: (fourth / (70.0 * MEDIAN_SQUARE)).sqrt(), ratio: fourth / second.max(1e-14) }
}

/// Returns the noisy parts of a track.
///
/// The fourth differences of white noise with deviation σ have variance 70 σ², its second
/// differences 6 σ², whereas those of a smooth motion become ever smaller. Medians keep single
/// spikes and strikes out (difference-based estimates of variance: Gasser, Sroka, Jennen-Steinmetz
/// 1986).
pub(super) fn of_track(track: &Track, index: usize, tracks: &Tracks) -> Vec<TrackFault> {
    let steps = track.steps();
    let window = tracks.frames_of(WINDOW_SECS, WINDOW_FRAMES);
    if steps.len() < window {
        return Vec::new();
    }
    let hop = (window / 4).max(1);
    let starts: Vec<usize> = (0..=steps.len() - window).step_by(hop).collect();
    let noise: Vec<Noise> = starts.iter().map(|&at| noise_in(&steps[at..at + window])).collect();
    let all: Vec<f32> = noise.iter().map(|noise| noise.deviation).collect();
    let quiet = stats::percentile(&all, 0.3).unwrap_or(0.0);
    let least = MIN_NOISE[usize::from(!track.is_turn())];
    let trembles = |noise: &Noise| {
        let stands_out = noise.deviation > MIN_CONTRAST * quiet && noise.ratio > MIN_RATIO;
        noise.deviation > least && (stands_out || noise.ratio > MIN_RATIO * 1.4)
    };
    let mut runs: Vec<(Range<usize>, f32, f32)> = Vec::new();
    for (&at, noise) in starts.iter().zip(&noise).filter(|(_, noise)| trembles(noise)) {
        match runs.last_mut() {
            Some((run, deviation, ratio)) if at <= run.end => {
                run.end = at + window + 1;
                *deviation = deviation.max(noise.deviation);
                *ratio = ratio.max(noise.ratio);
            }
            _ => runs.push((at..at + window + 1, noise.deviation, noise.ratio)),
        }
    }
    // A window counts as noisy once half of it is: the noise may begin before it, or end after it.
    let more = window / 3;
    runs.into_iter()
        .filter(|(run, ..)| run.len() > window + hop)
        .map(|(run, deviation, ratio)| {
            (run.start.saturating_sub(more)..(run.end + more).min(track.len()), deviation, ratio)
        })
        .map(|(frames, deviation, ratio)| TrackFault {
            track: index,
            frames,
            form: Form::Noise(deviation),
            size: tracks.size(index, deviation),
            confidence: confidence((deviation / least).min(ratio / MIN_RATIO * 2.0), 1.75),
        })
        .collect()
}

/// Filters the noise out of a part of a track. The cut-off is the lowest that takes away no more
/// than the noise: the filter's residual is as large as the noise that it should stop (the
/// discrepancy principle; Winter, section 3.4.4.3, reads the same from the residual's curve).
pub(super) fn filter(
    track: &mut Track,
    frames: &Range<usize>,
    deviation: f32,
    cutoff_hz: Option<f64>,
    fps: f64,
) {
    let context = ((CONTEXT_SECS * fps).round() as usize).max(8);
    let seen = frames.start.saturating_sub(context)..(frames.end + context).min(track.len());
    let inside = frames.start - seen.start..frames.end.min(seen.end) - seen.start;
    let axes = axes_of(track, &seen);
    let smoothed = |cutoff: f64| {
        let filter = LowPass::new(cutoff, fps)?;
        let mut axes = axes.clone();
        for axis in &mut axes {
            filter.apply(axis);
        }
        Some(axes)
    };
    let residual = |smooth: &[Vec<f64>]| -> f64 {
        let scale = if track.is_turn() { 4.0 } else { 1.0 };
        let squares = axes.iter().zip(smooth).map(|(axis, smooth)| {
            inside.clone().map(|at| (axis[at] - smooth[at]).powi(2)).sum::<f64>()
        });
        scale * squares.sum::<f64>() / inside.len().max(1) as f64
    };
    let variance = 3.0 * f64::from(deviation).powi(2);
    let chosen = if let Some(cutoff) = cutoff_hz {
        smoothed(cutoff)
    } else {
        let mut last = None;
        for cutoff in CUTOFFS_HZ {
            let Some(smooth) = smoothed(cutoff) else {
                break;
            };
            let stopped = variance * (1.0 - 2.0 * cutoff / fps).max(0.1);
            let fits = residual(&smooth) <= 1.2 * stopped;
            last = Some(smooth);
            if fits {
                break;
            }
        }
        last
    };
    let Some(smooth) = chosen else {
        return;
    };
    let fade = (FADE_SECS * fps).max(1.0) as f32;
    for at in inside.clone() {
        let from_start =
            if frames.start == 0 { f32::INFINITY } else { (at - inside.start + 1) as f32 };
        let from_end = if seen.start + inside.end == track.len() {
            f32::INFINITY
        } else {
            (inside.end - at) as f32
        };
        let share = (from_start.min(from_end) / fade).min(1.0);
        let value = |axis: usize| smooth[axis][at] as f32;
        match track {
            Track::Turn(values) => {
                let smooth =
                    quat::renormalize(Quat::from_xyzw(value(0), value(1), value(2), value(3)));
                let own = &mut values[seen.start + at];
                *own = quat::slerp(*own, smooth, share);
            }
            Track::Place(values) => {
                let own = &mut values[seen.start + at];
                *own = own.lerp(Vec3::new(value(0), value(1), value(2)), share);
            }
        }
    }
}

/// Returns the components of a track over some frames as separate signals.
fn axes_of(track: &Track, frames: &Range<usize>) -> Vec<Vec<f64>> {
    let column = |of: &dyn Fn(usize) -> f32| frames.clone().map(|f| f64::from(of(f))).collect();
    match track {
        Track::Turn(values) => {
            (0..4).map(|axis| column(&|frame| values[frame].to_array()[axis])).collect()
        }
        Track::Place(values) => {
            (0..3).map(|axis| column(&|frame| values[frame].to_array()[axis])).collect()
        }
    }
}
