//! Metrics of a clip without sources.

use super::lowest::LowPoints;
use super::{Extreme, SlideMeter};
use crate::clip::{Clip, Contacts};
use crate::math::{Planar, stats};
use crate::skeleton::{Roles, WorldPose};

/// The percentile that counts as usual.
const USUAL_PERCENTILE: f32 = 0.99;

/// Metrics of a whole clip whose sources are unknown, such as a capture or the export of another
/// program, beyond those of every result ([`ResultMetrics`](super::ResultMetrics)).
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct ClipMetrics {
    /// Foot slide, centimetres: [`foot_slide_cm`](super::foot_slide_cm). `None` without feet or
    /// stances.
    pub foot_slide_cm: Option<f64>,
    /// The frame in which that foot slides fastest; `None` where none slides.
    pub foot_slide_at: Option<usize>,
    /// Position jump, centimetres: the largest step of the character over the ground, minus the
    /// 99th percentile of its steps.
    pub jump_cm: Option<f64>,
    /// The frame into which that step goes; `None` where all steps are the same.
    pub jump_at: Option<usize>,
    /// Penetration, centimetres: the depth of the deepest joint or end site below the ground.
    pub penetration_cm: Option<f64>,
    /// Its frame; `None` where nothing is below the ground.
    pub penetration_at: Option<usize>,
}

impl ClipMetrics {
    /// Measures a clip. `contacts` and `ground_frames` are the clip's own ([`Contacts::detect`],
    /// [`character_frames`](crate::clip::character_frames)). `ground_m` is the height of the ground
    /// ([`estimate_ground`](crate::clip::estimate_ground)). O(frames × joints).
    #[must_use]
    pub fn measure(
        clip: &Clip,
        roles: &Roles,
        contacts: &Contacts,
        ground_frames: &[Planar],
        ground_m: f32,
    ) -> Self {
        let mut meter = ClipMeter::new(clip, roles, ground_m);
        while meter.advance(clip, contacts, usize::MAX) {}
        meter.finish(ground_frames)
    }
}

/// The measurement of [`ClipMetrics`] in slices, for long clips. Every call must be given the same
/// clip.
#[derive(Debug)]
pub struct ClipMeter {
    slide: SlideMeter,
    low_points: LowPoints,
    /// The lowest point, metres, and its frame.
    lowest: Option<(f32, usize)>,
    ground_m: f32,
    frame: usize,
}

impl ClipMeter {
    /// Returns a meter that has measured nothing yet. `ground_m` is the height of the ground
    /// ([`estimate_ground`](crate::clip::estimate_ground)).
    #[must_use]
    pub fn new(clip: &Clip, roles: &Roles, ground_m: f32) -> Self {
        Self {
            slide: SlideMeter::new(clip, roles),
            low_points: LowPoints::of(clip.skeleton()),
            lowest: None,
            ground_m,
            frame: 0,
        }
    }

    /// Processes up to `frames` more frames (at least one). Returns `false` when all are done.
    pub fn advance(&mut self, clip: &Clip, contacts: &Contacts, frames: usize) -> bool {
        if self.frame >= clip.frames() {
            return false;
        }
        self.slide.advance(clip, contacts, frames);
        let end = self.frame.saturating_add(frames.max(1)).min(clip.frames());
        let mut world = WorldPose::default();
        for frame in self.frame..end {
            clip.world_pose_into(frame, &mut world);
            let low = self.low_points.lowest(&world).map(|low| (low, frame));
            let lowest = self.lowest.into_iter().chain(low);
            self.lowest = lowest.min_by(|a, b| a.0.total_cmp(&b.0));
        }
        self.frame = end;
        true
    }

    /// Returns the progress, 0 to 1.
    #[must_use]
    pub fn progress(&self, clip: &Clip) -> f32 {
        self.frame as f32 / clip.frames().max(1) as f32
    }

    /// Returns the metrics. `ground_frames` are the clip's own.
    #[must_use]
    pub fn finish(self, ground_frames: &[Planar]) -> ClipMetrics {
        let steps: Vec<f32> = (ground_frames.windows(2))
            .map(|pair| pair[0].shift.distance(pair[1].shift) as f32)
            .collect();
        let usual = stats::percentile(&steps, USUAL_PERCENTILE).unwrap_or(0.0);
        let jump = Extreme::largest(
            (steps.iter().enumerate())
                .map(|(step, metres)| (step + 1, f64::from((metres - usual).max(0.0)) * 100.0)),
        );
        let depth = self.lowest.map(|(lowest, frame)| Extreme {
            value: f64::from((self.ground_m - lowest).max(0.0)) * 100.0,
            frame,
        });
        let slide = self.slide.worst();
        ClipMetrics {
            foot_slide_cm: slide.map(|slide| slide.value),
            foot_slide_at: slide.and_then(|slide| slide.place()),
            jump_cm: jump.map(|jump| jump.value),
            jump_at: jump.and_then(|jump| jump.place()),
            penetration_cm: depth.map(|depth| depth.value),
            penetration_at: depth.and_then(|depth| depth.place()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clip::{ContactOptions, character_frames};
    use crate::metrics::foot_slide_cm;
    use crate::synth::{Action, Params, synthesize};
    use glam::Vec3;

    fn walk() -> (Clip, Roles) {
        let clip = synthesize(&Params::new(Action::Walk)).unwrap().clip;
        let roles = Roles::detect(clip.skeleton());
        (clip, roles)
    }

    fn measured(clip: &Clip, roles: &Roles) -> ClipMetrics {
        let contacts = Contacts::detect(clip, roles, &ContactOptions::default());
        ClipMetrics::measure(clip, roles, &contacts, &character_frames(clip, roles), 0.0)
    }

    /// Returns the walk with each frame changed.
    fn changed(clip: &Clip, change: impl Fn(usize, &mut Vec3)) -> Clip {
        let (mut rotations, mut roots) = (Vec::new(), Vec::new());
        for frame in 0..clip.frames() {
            let mut root = clip.root_translations()[frame];
            change(frame, &mut root);
            rotations.extend_from_slice(clip.rotations(frame));
            roots.push(root);
        }
        Clip::new("changed", std::sync::Arc::clone(clip.skeleton()), clip.fps(), rotations, roots)
            .unwrap()
    }

    #[test]
    fn metrics_of_a_made_walk_are_small() {
        let (clip, roles) = walk();
        let metrics = measured(&clip, &roles);
        assert!(
            metrics.jump_cm.unwrap() < 0.5 && metrics.penetration_cm.unwrap() < 1.0,
            "{metrics:?}"
        );
    }

    #[test]
    fn metrics_of_changed_frames_are_the_changes() {
        let (clip, roles) = walk();
        let half = clip.frames() / 2;
        let before = measured(&clip, &roles);
        // A step of 10 cm to the side, and 3 cm lower from there on.
        let sunk = changed(&clip, |frame, root| {
            if frame >= half {
                *root += Vec3::new(0.1, -0.03, 0.0);
            }
        });
        let metrics = measured(&sunk, &roles);
        // At right angles to its own direction, and beyond the usual step of 3 cm.
        assert!((6.5..=10.0).contains(&metrics.jump_cm.unwrap()), "{metrics:?}");
        assert_eq!(metrics.jump_at, Some(half));
        assert!(metrics.penetration_at.is_some_and(|frame| frame >= half), "{metrics:?}");
        let deeper = metrics.penetration_cm.unwrap() - before.penetration_cm.unwrap();
        assert!((1.5..=3.01).contains(&deeper), "{metrics:?}");
    }

    #[test]
    fn clip_meter_in_slices_equals_the_metrics() {
        let (clip, roles) = walk();
        let contacts = Contacts::detect(&clip, &roles, &ContactOptions::default());
        let frames = character_frames(&clip, &roles);
        let mut meter = ClipMeter::new(&clip, &roles, 0.0);
        let mut progress = 0.0;
        while meter.advance(&clip, &contacts, 7) {
            assert!(meter.progress(&clip) > progress);
            progress = meter.progress(&clip);
        }
        let metrics = meter.finish(&frames);
        assert_eq!(metrics, measured(&clip, &roles));
        assert_eq!(metrics.foot_slide_cm, foot_slide_cm(&clip, &roles, &contacts));
    }

    #[test]
    fn metrics_of_a_single_pose_have_no_jump() {
        let (clip, roles) = walk();
        let pose = clip.crop(0..1).unwrap();
        let metrics = measured(&pose, &roles);
        assert_eq!(metrics.jump_cm, None);
    }
}
