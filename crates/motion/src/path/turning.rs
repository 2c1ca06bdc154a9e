//! Turns that are sharper than those of a motion.

use super::{Carried, FittedPath, Waypoint};
use crate::math::{stats, wrap_angle};
use glam::DVec2;
use std::fmt;
use std::ops::Range;

/// Everyone who walks can turn this fast, radians per second: a motion that goes straight ahead
/// does not forbid every bend.
const ALWAYS_RADIANS_PER_SEC: f64 = 0.35;
/// Beyond the original by this share a turn is told.
const MARGIN: f64 = 1.05;
/// The share of the original's frames that turn at most as fast as is usual in it: the tip of a
/// hairpin is not.
const USUAL: f32 = 0.99;
/// Hurried places that are nearer to each other than this are one, seconds.
const MERGED_SECS: f64 = 0.25;

/// A place where the new path asks for more than the original motion does.
#[derive(Clone, Debug, PartialEq)]
pub struct HardTurn {
    /// The frames of the result.
    pub frames: Range<usize>,
    /// The frame that turns fastest.
    pub worst: usize,
    /// Where that is, (x, z) in metres.
    pub place: DVec2,
    /// Curvature × speed there, degrees per second.
    pub turn_dps: f64,
    /// What the original holds, degrees per second.
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

/// How fast the path turns under the motion in the step into each frame: curvature × speed, radians
/// per second, positive to the left. 0 in frame 0.
#[must_use]
pub fn turn_rates(places: &[Waypoint], fps: f64) -> Vec<f64> {
    let step = |pair: &[Waypoint]| wrap_angle(pair[1].frame.yaw - pair[0].frame.yaw) * fps;
    std::iter::repeat_n(0.0, places.len().min(1)).chain(places.windows(2).map(step)).collect()
}

/// Where the new path asks for faster turns than the motion does on the path that it was fitted
/// with: beyond the 99th percentile of curvature × speed, and beyond 20°/s. In the order of time;
/// neighbours within a quarter of a second are one.
#[must_use]
pub fn hard_turns(path: &FittedPath, carried: &Carried) -> Vec<HardTurn> {
    let fps = path.source().clip().fps();
    let own: Vec<f32> =
        turn_rates(path.places(), fps).iter().map(|rate| rate.abs() as f32).collect();
    let usual = f64::from(stats::percentile(&own, USUAL).unwrap_or(0.0));
    let limit = usual.max(ALWAYS_RADIANS_PER_SEC);
    let merged = (MERGED_SECS * fps) as usize;
    let mut found: Vec<HardTurn> = Vec::new();
    let rates = turn_rates(&carried.places, fps);
    // What the original does at the same moment it can do here as well.
    let held = |frame: f64| own.get(frame.round() as usize).map_or(0.0, |&own| f64::from(own));
    for (frame, (&rate, &at)) in rates.iter().zip(&carried.frames).enumerate() {
        if rate.abs() <= limit.max(held(at)) * MARGIN {
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
