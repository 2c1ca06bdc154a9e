use crate::clip::Clip;
use crate::math::stats;
use crate::metrics::profile::turn;
use glam::Vec3;

/// Angular velocities are compared over this long, seconds: what an eye that sees thirty pictures a
/// second takes for one moment.
const MOMENT_SECS: f64 = 1.0 / 30.0;
/// What one step in a hundred exceeds is no longer usual.
const USUAL: f32 = 0.99;

/// How a joint turns against its parent in a motion.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::metrics) struct JointTrace {
    /// Per step: the angle, degrees.
    pub(super) turns_deg: Vec<f32>,
    /// The 99.9th percentile of its angular speed, degrees per second.
    pub(super) rare_dps: f32,
    /// Its angular speed, degrees per second: at a frame, in the step behind it.
    pub(in crate::metrics) speed: Sizes,
    /// How much its angular velocity changes, degrees per second: at a frame, between the means
    /// over 1/30 s before it and behind it.
    pub(in crate::metrics) change: Sizes,
}

/// The sizes of something that is there in every frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(in crate::metrics) struct Sizes {
    /// The largest, and its frame.
    pub(in crate::metrics) most: f32,
    pub(in crate::metrics) frame: usize,
    /// The 99th percentile.
    pub(in crate::metrics) usual: f32,
}

impl Sizes {
    /// Of the frames from `first` on.
    fn of(sizes: &[f32], first: usize) -> Self {
        let most = (sizes.iter().enumerate()).max_by(|a, b| a.1.total_cmp(b.1));
        most.map_or_else(Self::default, |(at, &most)| Self {
            most,
            frame: first + at,
            usual: stats::percentile(sizes, USUAL).unwrap_or(0.0),
        })
    }
}

impl JointTrace {
    /// From how many frames it goes on to the next.
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
            rare_dps: stats::percentile(&speeds, super::RARE).unwrap_or(0.0),
            speed: Sizes::of(&speeds, 0),
            change: Sizes::of(&changes, first),
            turns_deg,
        }
    }
}

/// How much the mean angular velocity over [`MOMENT_SECS`] behind a frame differs from that before
/// it: the first frame with both, and the size for it and the following ones. `steps` are rotation
/// vectors, degrees.
///
/// Of a motion whose angular acceleration is `a` that is `a / 30 s`, and where its velocity jumps
/// the size of the jump, both at any frame rate from 30 on. A pose that jumps by 1° counts 30°/s. A
/// moment that is no whole number of frames takes its share of the last step. Below 30 frames per
/// second a moment is one step.
fn changes_dps(steps: &[Vec3], fps: f64) -> (usize, Vec<f32>) {
    let moment = (MOMENT_SECS * fps).max(1.0);
    // Not one more for what rounding leaves over.
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
