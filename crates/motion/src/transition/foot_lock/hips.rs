//! The height of the hips for planted feet.

use super::envelope::{largest, largest_around, smoothed};
use crate::transition::limb::LimbPose;
use glam::Vec3;

/// Time to either side over which the height of the hips is smoothed, seconds.
const SMOOTH_SECS: f64 = 0.08;
/// The least sine of a knee's flexion that is used as its weight: at full stretch the weight would
/// be infinite.
const MIN_SINE: f32 = 0.1;
/// The sine of the flexion of a knee that costs as much as the hips.
const HIP_SINE: f32 = 0.7;

/// Returns the change of the hips' height in every frame, metres.
pub(crate) fn heights(posed: &[Vec<LimbPose>], shifts: &[Vec<Vec3>], fps: f64) -> Vec<f32> {
    let frames = shifts.iter().map(Vec::len).min().unwrap_or(0);
    let legs = |frame: usize| {
        posed.iter().zip(shifts).map(move |(posed, shifts)| (&posed[frame], shifts[frame]))
    };
    let wanted: Vec<f32> = (0..frames).map(|frame| height_of_least_change(legs(frame))).collect();
    let reach = ((SMOOTH_SECS * fps).round() as usize).max(1);
    let mut heights = smoothed(&wanted, reach);
    let beyond: Vec<f32> = (0..frames).map(|frame| too_high(legs(frame), heights[frame])).collect();
    if beyond.iter().any(|&beyond| beyond > 0.0) {
        // The maximum over the neighbours, smoothed over the same neighbours, is nowhere less than
        // the value itself.
        for (height, lower) in
            heights.iter_mut().zip(smoothed(&largest_around(&beyond, reach), reach))
        {
            *height -= lower;
        }
    }
    heights
}

/// Returns the height at which both knees change least. A leg's length changes by `Δ + h cos θ`
/// when its ankle is moved and the hips are raised by `h`, and its knee by `d / (a b sin φ)` times
/// that; the result minimizes the sum of the squares of these and of the cost of the hips.
fn height_of_least_change<'a>(legs: impl Iterator<Item = (&'a LimbPose, Vec3)>) -> f32 {
    let (mut above, mut below) = (0.0, 0.0);
    for (leg, shift) in legs {
        let line = leg.line();
        let asked = line + shift;
        let (now, then) = (line.length(), asked.length().max(1e-6));
        let sides = (leg.thigh.length() * leg.shin.length()).max(1e-9);
        let turn_per_metre = |sine: f32| (now / (sides * sine)).powi(2);
        let (weight, cosine) = (turn_per_metre(leg.bend().length().max(MIN_SINE)), -asked.y / then);
        above += weight * cosine * (now - then);
        below += weight * cosine * cosine + turn_per_metre(HIP_SINE);
    }
    if below > 0.0 { above / below } else { 0.0 }
}

/// Returns by how much the hips would be too high for the legs to reach, metres.
fn too_high<'a>(legs: impl Iterator<Item = (&'a LimbPose, Vec3)>, height: f32) -> f32 {
    largest(legs.map(|(leg, shift)| leg.too_high(shift, height)))
}
