//! Turns that are sharper than those of a motion.

use super::{CarriedMotion, FittedPath, Waypoint};
use crate::math::{stats, wrap_angle};
use glam::DVec2;
use std::fmt;
use std::ops::Range;

/// The turn rate that is allowed on any path, radians per second: every character can turn this
/// fast, even if its motion is straight.
const ALWAYS_RADIANS_PER_SEC: f64 = 0.35;
/// The least excess over the original's turn rate that is reported, as a share.
const MIN_EXCESS: f64 = 1.05;
/// The share of the original's frames from which its usual turn rate is computed: the tip of a
/// hairpin does not belong to them.
const USUAL: f32 = 0.99;
/// Hard turns with less time than this between them count as one, seconds.
const MERGED_SECS: f64 = 0.25;

/// A part of the new path that turns faster than the original motion does.
#[derive(Clone, Debug, PartialEq)]
pub struct HardTurn {
    /// The frames of the result.
    pub frames: Range<usize>,
    /// The frame that turns fastest.
    pub worst: usize,
    /// The position of that frame on the path, (x, z) in metres.
    pub place: DVec2,
    /// Curvature × speed in that frame, degrees per second.
    pub turn_dps: f64,
    /// The greatest turn rate of the original, degrees per second.
    pub limit_dps: f64,
}

impl fmt::Display for HardTurn {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { frames, turn_dps, limit_dps, .. } = self;
        write!(
            f,
            "frames {} to {} turn by up to {turn_dps:.0}°/s, and the original by {limit_dps:.0}°/s: widen the bend or slow down",
            frames.start,
            frames.end - 1
        )
    }
}

/// Returns the turn rate of the path in the step into each frame: curvature × speed, radians per
/// second, positive to the left. 0 in frame 0.
#[must_use]
pub fn turn_rates(places: &[Waypoint], fps: f64) -> Vec<f64> {
    let step = |pair: &[Waypoint]| wrap_angle(pair[1].frame.yaw - pair[0].frame.yaw) * fps;
    std::iter::repeat_n(0.0, places.len().min(1)).chain(places.windows(2).map(step)).collect()
}

/// Returns the parts of the new path that turn faster than the path that was fitted to the motion:
/// beyond the 99th percentile of its curvature × speed, and beyond 20°/s. In order of time; parts
/// with less than a quarter of a second between them are merged.
#[must_use]
pub fn hard_turns(path: &FittedPath, carried: &CarriedMotion) -> Vec<HardTurn> {
    let fps = path.source().clip().fps();
    let own: Vec<f32> =
        turn_rates(path.places(), fps).iter().map(|rate| rate.abs() as f32).collect();
    let usual = f64::from(stats::percentile(&own, USUAL).unwrap_or(0.0));
    let limit = usual.max(ALWAYS_RADIANS_PER_SEC);
    let merged = (MERGED_SECS * fps) as usize;
    let mut found: Vec<HardTurn> = Vec::new();
    let rates = turn_rates(&carried.places, fps);
    // The original's turn rate in the same frame is always allowed.
    let held = |frame: f64| own.get(frame.round() as usize).map_or(0.0, |&own| f64::from(own));
    for (frame, (&rate, &at)) in rates.iter().zip(&carried.frames).enumerate() {
        if rate.abs() <= limit.max(held(at)) * MIN_EXCESS {
            continue;
        }
        let (turn_dps, place) = (rate.abs().to_degrees(), carried.places[frame].frame.shift);
        match found.last_mut().filter(|last| frame <= last.frames.end + merged) {
            Some(last) => {
                last.frames.end = frame + 1;
                if turn_dps > last.turn_dps {
                    (last.worst, last.turn_dps, last.place) = (frame, turn_dps, place);
                }
            }
            None => found.push(HardTurn {
                frames: frame..frame + 1,
                worst: frame,
                place,
                turn_dps,
                limit_dps: limit.to_degrees(),
            }),
        }
    }
    found
}
