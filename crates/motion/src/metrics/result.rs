//! Metrics of any result, compared with the clips from which it was made.

use super::MotionTrace;
use super::artefacts::{JointTrace, Statistics};
use crate::math::stats;

/// The percentile of the turn of the hips that counts as usual for a clip without sources.
const USUAL_TURN_PERCENTILE: f32 = 0.75;

/// The artefacts of a motion, however it was made, measured on all of it and compared with its
/// source clips.
///
/// Only the excess over the clips counts: a joint is measured beyond its greatest value in any of
/// them. A clip without sources is measured beyond its usual values: for a joint the 99th
/// percentile over its frames, for the heading the 75th percentile.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ResultMetrics {
    /// Pose jump, degrees: over all joints and steps, the largest turn of a joint relative to its
    /// parent in one step, minus its largest turn in the clips in the same time.
    pub pose_jump_deg: Option<f64>,
    /// The joint and the frame before the step; `None` where nothing exceeds the clips.
    pub pose_jump_at: Option<JointFrame>,
    /// Velocity jump, degrees per second: over all joints and frames, the largest difference (as a
    /// vector in the parent's frame) between the mean angular velocities over the 1/30 s after a
    /// frame and the 1/30 s before it, minus the largest difference in the clips. The same at all
    /// frame rates from 30 on.
    pub velocity_jump_dps: Option<f64>,
    /// Its joint and frame; `None` where nothing exceeds the clips.
    pub velocity_jump_at: Option<JointFrame>,
    /// Spin, degrees: the largest turn of the hips within 0.2 s, minus their largest turn in the
    /// clips in that time. `None` without hip joints.
    pub spin_deg: Option<f64>,
    /// The frame at which it begins; `None` where nothing exceeds the clips.
    pub spin_at: Option<usize>,
    /// Skating, centimetres per second: [`MotionTrace::skating_cm_per_sec`].
    pub skating_cm_per_sec: Option<f64>,
}

/// A joint in a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct JointFrame {
    /// The joint.
    pub joint: usize,
    /// The frame.
    pub frame: usize,
}

impl ResultMetrics {
    /// Measures a result against its clips; without any, against its own usual values. Clips with
    /// another number of joints are ignored for joints. O(joints), and O(frames) for a clip without
    /// sources.
    #[must_use]
    pub fn measure(result: &MotionTrace, clips: &[&MotionTrace]) -> Self {
        let alike = result.alike(clips);
        let worst = |sizes: fn(&JointTrace) -> Statistics| -> Option<(f32, JointFrame)> {
            let moving = result.joints.iter().enumerate().filter(|(_, trace)| trace.steps() > 0);
            let beyond = moving.map(|(joint, trace)| {
                let Statistics { most, frame, usual } = sizes(trace);
                let in_clips = alike
                    .iter()
                    .filter_map(|clip| clip.joints.get(joint))
                    .map(|trace| sizes(trace).most);
                let own = in_clips.reduce(f32::max).unwrap_or(usual);
                ((most - own).max(0.0), JointFrame { joint, frame })
            });
            beyond.reduce(|worst, other| if other.0 > worst.0 { other } else { worst })
        };
        let (pose, velocity) = (worst(|joint| joint.speed), worst(|joint| joint.change));
        let place = |found: Option<(f32, JointFrame)>| {
            found.filter(|(beyond, _)| *beyond > 0.0).map(|(_, at)| at)
        };
        let turned =
            (result.turned_deg().iter().copied().enumerate()).max_by(|a, b| a.1.total_cmp(&b.1));
        let own_turn = clips.iter().map(|clip| clip.max_turn_deg()).reduce(f64::max);
        let own_turn = own_turn.or_else(|| {
            stats::percentile(result.turned_deg(), USUAL_TURN_PERCENTILE).map(f64::from)
        });
        let spin =
            turned.map(|(frame, deg)| ((f64::from(deg) - own_turn.unwrap_or(0.0)).max(0.0), frame));
        Self {
            pose_jump_deg: pose.map(|(dps, _)| f64::from(dps) / result.fps),
            pose_jump_at: place(pose),
            velocity_jump_dps: velocity.map(|(dps, _)| f64::from(dps)),
            velocity_jump_at: place(velocity),
            spin_deg: spin.map(|(deg, _)| deg),
            spin_at: spin.filter(|(deg, _)| *deg > 0.0).map(|(_, frame)| frame),
            skating_cm_per_sec: result.skating_cm_per_sec(),
        }
    }
}

#[cfg(test)]
mod tests;
