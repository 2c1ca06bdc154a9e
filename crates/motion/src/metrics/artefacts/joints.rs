//! Angular speeds of joints, and their changes.

use crate::clip::{Clip, turn};
use crate::math::stats;
use glam::Vec3;

/// The time over which angular velocities are averaged and compared, seconds: one frame at thirty
/// frames per second.
const AVERAGING_SECS: f64 = 1.0 / 30.0;
/// The percentile that counts as usual.
const USUAL_PERCENTILE: f32 = 0.99;

/// The local rotation of a joint over a motion.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::metrics) struct JointTrace {
    /// Per step: the angle, degrees.
    pub(super) turns_deg: Vec<f32>,
    /// The 99.9th percentile of its angular speed, degrees per second.
    pub(super) rare_dps: f32,
    /// Its angular speed at each frame, from the step after it, degrees per second.
    pub(in crate::metrics) speed: Statistics,
    /// The change of its angular velocity at each frame, between the means over 1/30 s before and
    /// after it, degrees per second.
    pub(in crate::metrics) change: Statistics,
}

/// Statistics of a quantity that every frame has.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(in crate::metrics) struct Statistics {
    /// The maximum, and its frame.
    pub(in crate::metrics) most: f32,
    pub(in crate::metrics) frame: usize,
    /// The 99th percentile.
    pub(in crate::metrics) usual: f32,
}

impl Statistics {
    /// Computes the statistics of the frames from `first` on.
    fn of(sizes: &[f32], first: usize) -> Self {
        let most = (sizes.iter().enumerate()).max_by(|a, b| a.1.total_cmp(b.1));
        most.map_or_else(Self::default, |(at, &most)| Self {
            most,
            frame: first + at,
            usual: stats::percentile(sizes, USUAL_PERCENTILE).unwrap_or(0.0),
        })
    }
}

impl JointTrace {
    /// Returns the number of steps between frames.
    pub(in crate::metrics) fn steps(&self) -> usize {
        self.turns_deg.len()
    }

    /// Measures a joint of a clip. O(frames).
    pub(super) fn new(clip: &Clip, joint: usize) -> Self {
        let dps = clip.fps() as f32;
        let at = |frame: usize| clip.rotations(frame)[joint];
        let steps: Vec<Vec3> = (1..clip.frames())
            .map(|frame| turn(at(frame - 1), at(frame)) * 1_f32.to_degrees())
            .collect();
        let turns_deg: Vec<f32> = steps.iter().map(|step| step.length()).collect();
        let speeds: Vec<f32> = turns_deg.iter().map(|turn| turn * dps).collect();
        let (first, changes) = changes_dps(&steps, clip.fps());
        Self {
            rare_dps: stats::percentile(&speeds, super::RARE_PERCENTILE).unwrap_or(0.0),
            speed: Statistics::of(&speeds, 0),
            change: Statistics::of(&changes, first),
            turns_deg,
        }
    }
}

/// Returns the changes of the mean angular velocity between [`AVERAGING_SECS`] before and after a
/// frame: the first frame that has both, and the size of the change for it and the following ones.
/// `steps` are rotation vectors, degrees.
///
/// For a motion with angular acceleration `a` the change is `a / 30 s`, and for a discontinuity of
/// the velocity the size of the discontinuity, both at any frame rate from 30 on. A pose that jumps
/// by 1° counts 30°/s. If the averaging time is not a whole number of frames, it takes a share of
/// the last step. Below 30 frames per second it is one step.
fn changes_dps(steps: &[Vec3], fps: f64) -> (usize, Vec<f32>) {
    let moment = (AVERAGING_SECS * fps).max(1.0);
    // The tolerance avoids a further step for a remainder of rounding.
    let whole = (moment + 1e-3).floor();
    let share = ((moment - whole) as f32).max(0.0);
    let (whole, reach) = (whole as usize, whole as usize + usize::from(share > 1e-3));
    let part = |step: Option<&Vec3>| {
        if reach > whole { step.map_or(Vec3::ZERO, |step| *step * share) } else { Vec3::ZERO }
    };
    let last = (steps.len() + 1).saturating_sub(reach);
    let per_sec = (fps / moment) as f32;
    let changes = (reach..last).map(|frame| {
        let behind =
            steps[frame..frame + whole].iter().sum::<Vec3>() + part(steps.get(frame + whole));
        let before = steps[frame - whole..frame].iter().sum::<Vec3>()
            + part(steps.get((frame - whole).wrapping_sub(1)));
        behind.distance(before) * per_sec
    });
    (reach, changes.collect())
}
