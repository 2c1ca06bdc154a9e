//! Measurement of motion traces in slices.

use super::joints::JointTrace;
use super::{BodyTracks, Foot, MotionTrace, RARE_PERCENTILE, largest, turned_deg};
use crate::clip::Clip;
use crate::math::stats;
use crate::skeleton::Roles;

/// The measurement of a [`MotionTrace`] in slices, for long clips. Every call must be given the
/// same clip.
#[derive(Debug)]
pub struct TraceMeter {
    tracks: BodyTracks,
    frame: usize,
    joints: Vec<JointTrace>,
}

impl TraceMeter {
    /// Returns a meter that has measured nothing yet.
    #[must_use]
    pub fn new(clip: &Clip, roles: &Roles) -> Self {
        Self {
            tracks: BodyTracks::new(clip, roles),
            frame: 0,
            joints: Vec::with_capacity(clip.skeleton().len()),
        }
    }

    /// Processes up to `frames` more frames of the whole body, or, after those, ten times as many
    /// of single joints, at least one joint. Returns `false` when all are done.
    pub fn advance(&mut self, clip: &Clip, frames: usize) -> bool {
        if self.frame < clip.frames() {
            let end = self.frame.saturating_add(frames.max(1)).min(clip.frames());
            self.tracks.take(clip, self.frame..end);
            self.frame = end;
            return true;
        }
        let (known, all) = (self.joints.len(), clip.skeleton().len());
        let more = (frames.saturating_mul(10) / clip.frames().max(1)).max(1);
        let joints = known..known.saturating_add(more).min(all);
        self.joints.extend(joints.map(|joint| JointTrace::new(clip, joint)));
        self.joints.len() > known
    }

    /// Returns the measurements.
    #[must_use]
    pub fn finish(self, clip: &Clip) -> MotionTrace {
        let (tracks, fps) = (self.tracks, clip.fps());
        let scale = tracks.scale() * fps as f32;
        let root_mps: Vec<f32> = (clip.root_translations().windows(2))
            .map(|pair| pair[0].distance(pair[1]) * scale)
            .collect();
        let turned_deg = turned_deg(&tracks.headings, fps);
        let toes = tracks.scaled_toes();
        let feet: Vec<Foot> = toes.iter().map(|path| Foot::new(path, fps)).collect();
        let skating = feet.iter().map(Foot::skating_cm_per_sec);
        MotionTrace {
            fps,
            joints: self.joints,
            rare_mps: stats::percentile(&root_mps, RARE_PERCENTILE).unwrap_or(0.0),
            max_mps: largest(&root_mps),
            root_mps,
            max_turn_deg: largest(&turned_deg),
            turned_deg,
            stances_cm: feet.iter().flat_map(Foot::stances_cm).collect(),
            skating_cm_per_sec: (!feet.is_empty())
                .then(|| skating.sum::<f64>() / feet.len() as f64),
        }
    }
}
