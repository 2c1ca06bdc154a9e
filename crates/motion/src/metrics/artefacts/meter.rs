use super::joints::JointTrace;
use super::{Foot, MotionTrace, Places, RARE, largest, turned_deg};
use crate::clip::Clip;
use crate::math::stats;
use crate::skeleton::Roles;

/// [`MotionTrace`] in slices, for clips that take longer than there is time for at once. Every call
/// is given the same clip.
#[derive(Debug)]
pub struct TraceMeter {
    places: Places,
    frame: usize,
    joints: Vec<JointTrace>,
}

impl TraceMeter {
    /// Nothing is measured yet.
    #[must_use]
    pub fn new(clip: &Clip, roles: &Roles) -> Self {
        Self {
            places: Places::begun(clip, roles),
            frame: 0,
            joints: Vec::with_capacity(clip.skeleton().len()),
        }
    }

    /// Looks at so many more frames of the whole body, or, behind those, at ten times as many of
    /// single joints, at least at one joint. `false` when it has seen all.
    pub fn advance(&mut self, clip: &Clip, frames: usize) -> bool {
        if self.frame < clip.frames() {
            let end = self.frame.saturating_add(frames.max(1)).min(clip.frames());
            self.places.take(clip, self.frame..end);
            self.frame = end;
            return true;
        }
        let (known, all) = (self.joints.len(), clip.skeleton().len());
        let more = (frames.saturating_mul(10) / clip.frames().max(1)).max(1);
        let joints = known..known.saturating_add(more).min(all);
        self.joints.extend(joints.map(|joint| JointTrace::new(clip, joint)));
        self.joints.len() > known
    }

    /// What was found.
    #[must_use]
    pub fn finish(self, clip: &Clip) -> MotionTrace {
        let (places, fps) = (self.places, clip.fps());
        let scale = places.scale() * fps as f32;
        let root_mps: Vec<f32> = (clip.root_translations().windows(2))
            .map(|pair| pair[0].distance(pair[1]) * scale)
            .collect();
        let turned_deg = turned_deg(&places.headings, fps);
        let toes = places.scaled_toes();
        let feet: Vec<Foot> = toes.iter().map(|path| Foot::new(path, fps)).collect();
        let skating = feet.iter().map(Foot::skating_cm_per_sec);
        MotionTrace {
            fps,
            joints: self.joints,
            rare_mps: stats::percentile(&root_mps, RARE).unwrap_or(0.0),
            most_mps: largest(&root_mps),
            root_mps,
            most_turned_deg: largest(&turned_deg),
            turned_deg,
            stances_cm: feet.iter().flat_map(Foot::stances_cm).collect(),
            skating_cm_per_sec: (!feet.is_empty())
                .then(|| skating.sum::<f64>() / feet.len() as f64),
        }
    }
}
