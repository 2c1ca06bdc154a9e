use super::lowest::LowPoints;
use super::profile::turn;
use super::{Metric, SlideMeter};
use crate::clip::{Clip, Contacts};
use crate::math::{Planar, stats, wrap_angle};
use crate::skeleton::{Roles, WorldPose};
use glam::Vec3;

/// What one frame in a hundred does is usual.
const USUAL: f32 = 0.99;
/// Steps that are looked at for that: enough for a 99th percentile, and bounded for long clips.
const SAMPLES: usize = 1_000;
/// A spin is looked for in windows of this length, seconds.
const SPIN_SECS: f64 = 0.2;

/// What a viewer would point at in a whole clip of which nothing else is known: a capture, or a motion that another program made.
///
/// "Usual" is the 99th percentile over the steps of the same clip; a clip without a seam has little beyond it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ClipMetrics {
    /// Pose jump, degrees: over all joints and steps, the largest turn of a joint against its parent in one step, less what is usual for that joint.
    pub seam_deg: Option<f64>,
    /// Velocity jump, degrees per second: likewise the largest change of a joint's angular velocity (a vector in the parent's frame) from one
    /// step to the next.
    pub seam_dps: Option<f64>,
    /// Place jump, centimetres: the largest step of the character over the ground, less what is usual.
    pub jump_cm: Option<f64>,
    /// Spin, degrees: the most that the character turns in 0.2 s, to one side.
    pub spin_deg: Option<f64>,
    /// Foot slide, centimetres: [`foot_slide_cm`](super::foot_slide_cm). `None` without feet or stances.
    pub skate_cm: Option<f64>,
    /// Penetration, centimetres: how deep the deepest joint or end site is below the ground.
    pub penetration_cm: Option<f64>,
}

impl ClipMetrics {
    /// Measures a clip. `contacts` and `ground_frames` are the clip's own ([`Contacts::detect`], [`character_frames`](crate::clip::character_frames)).
    /// `ground_m` is the height of the ground ([`estimate_ground`](crate::clip::estimate_ground)). O(frames × joints).
    #[must_use]
    pub fn measure(clip: &Clip, roles: &Roles, contacts: &Contacts, ground_frames: &[Planar], ground_m: f32) -> Self {
        let mut meter = ClipMeter::new(clip, roles, ground_m);
        while meter.advance(clip, contacts, usize::MAX) {}
        meter.finish(clip, ground_frames)
    }

    /// All numbers with their names, units and explanations, in the order in which they are shown.
    #[must_use]
    pub fn list(&self) -> [Metric; 6] {
        [
            Metric::lower(
                "clip_seam_dps",
                "Largest velocity jump",
                self.seam_dps,
                "°/s",
                "How much a joint's angular velocity changes in one frame, beyond all but one in a hundred frames of the clip: the worst.",
            ),
            Metric::lower(
                "skate_cm",
                "Foot slide",
                self.skate_cm,
                "cm",
                "How far a planted foot slides in the worst stance.",
            ),
            Metric::lower(
                "clip_spin_deg",
                "Fastest turn in 0.2 s",
                self.spin_deg,
                "°",
                "How far the character turns within 0.2 s at most. More than 30° is a spin, unless it was meant.",
            ),
            Metric::lower(
                "clip_penetration_cm",
                "Deepest point",
                self.penetration_cm,
                "cm",
                "How deep the lowest point of the body is below the ground.",
            ),
            Metric::lower(
                "clip_seam_deg",
                "Largest pose jump",
                self.seam_deg,
                "°",
                "How far a joint turns in one frame, beyond all but one in a hundred frames of the clip: the worst.",
            ),
            Metric::lower(
                "clip_jump_cm",
                "Largest place jump",
                self.jump_cm,
                "cm",
                "How far the character moves over the ground in one frame, beyond all but one in a hundred frames of the clip: the worst.",
            ),
        ]
    }
}

/// [`ClipMetrics`] in slices, for clips that take longer than there is time for at once. Every call is given the same clip.
#[derive(Debug)]
pub struct ClipMeter {
    slide: SlideMeter,
    low_points: LowPoints,
    lowest: Option<f32>,
    ground_m: f32,
    frame: usize,
    joint: usize,
    joint_steps: JointSteps,
    found: ClipMetrics,
}

impl ClipMeter {
    /// Nothing is measured yet. `ground_m` is the height of the ground ([`estimate_ground`](crate::clip::estimate_ground)).
    #[must_use]
    pub fn new(clip: &Clip, roles: &Roles, ground_m: f32) -> Self {
        Self {
            slide: SlideMeter::new(clip, roles),
            low_points: LowPoints::of(clip.skeleton()),
            lowest: None,
            ground_m,
            frame: 0,
            joint: 0,
            joint_steps: JointSteps::default(),
            found: ClipMetrics::default(),
        }
    }

    /// Looks at so many more frames of the whole body, or, behind those, at ten times as many of one joint. `false` when it has seen all.
    pub fn advance(&mut self, clip: &Clip, contacts: &Contacts, frames: usize) -> bool {
        if self.frame < clip.frames() {
            self.slide.advance(clip, contacts, frames);
            let end = self.frame.saturating_add(frames.max(1)).min(clip.frames());
            let mut world = WorldPose::default();
            for frame in self.frame..end {
                clip.world_pose_into(frame, &mut world);
                self.lowest = self.lowest.into_iter().chain(self.low_points.lowest(&world)).min_by(f32::total_cmp);
            }
            self.frame = end;
            return true;
        }
        if self.joint >= clip.skeleton().len() {
            return false;
        }
        if self.joint_steps.advance(clip, self.joint, frames.saturating_mul(10).max(1)) {
            return true;
        }
        let JointSteps { turns, changes, .. } = std::mem::take(&mut self.joint_steps);
        let degrees = |radians: f32| f64::from(radians).to_degrees();
        self.found.seam_deg = larger(self.found.seam_deg, turns.beyond_usual().map(degrees));
        let per_sec = |radians: f32| degrees(radians) * clip.fps();
        self.found.seam_dps = larger(self.found.seam_dps, changes.beyond_usual().map(per_sec));
        self.joint += 1;
        true
    }

    /// How much is done, 0 to 1.
    #[must_use]
    pub fn progress(&self, clip: &Clip) -> f32 {
        let share = |done: usize, all: usize| done as f32 / all.max(1) as f32;
        let joint = self.joint as f32 + share(self.joint_steps.frame, clip.frames());
        0.5 * share(self.frame, clip.frames()) + 0.5 * joint / clip.skeleton().len().max(1) as f32
    }

    /// What was found. `ground_frames` are the clip's own.
    #[must_use]
    pub fn finish(self, clip: &Clip, ground_frames: &[Planar]) -> ClipMetrics {
        let mut steps = Steps::default();
        for (frame, pair) in ground_frames.windows(2).enumerate() {
            steps.add(pair[0].shift.distance(pair[1].shift) as f32, frame, stride(clip));
        }
        ClipMetrics {
            jump_cm: steps.beyond_usual().map(|metres| f64::from(metres) * 100.0),
            spin_deg: fastest_turn(ground_frames, clip.fps()).map(f64::to_degrees),
            skate_cm: self.slide.worst_cm(),
            penetration_cm: self.lowest.map(|lowest| f64::from((self.ground_m - lowest).max(0.0)) * 100.0),
            ..self.found
        }
    }
}

/// How one joint turns from frame to frame, as far as it was looked at.
#[derive(Debug, Default)]
struct JointSteps {
    frame: usize,
    before: Option<Vec3>,
    turns: Steps,
    changes: Steps,
}

impl JointSteps {
    /// Looks at so many more frames; `false` when it has seen all.
    fn advance(&mut self, clip: &Clip, joint: usize, frames: usize) -> bool {
        let (start, last) = (self.frame, clip.frames().saturating_sub(1));
        if start >= last {
            return false;
        }
        let stride = stride(clip);
        self.frame = start.saturating_add(frames).min(last);
        for frame in start..self.frame {
            let now = turn(clip.rotations(frame)[joint], clip.rotations(frame + 1)[joint]);
            self.turns.add(now.length(), frame, stride);
            if let Some(before) = self.before {
                self.changes.add(now.distance(before), frame, stride);
            }
            self.before = Some(now);
        }
        true
    }
}

/// How far one step is taken for the other when it is looked for what is usual.
fn stride(clip: &Clip) -> usize {
    clip.frames().div_ceil(SAMPLES).max(1)
}

/// Sizes of steps: the largest, and some of all.
#[derive(Debug, Default)]
struct Steps {
    most: Option<f32>,
    sampled: Vec<f32>,
}

impl Steps {
    fn add(&mut self, step: f32, frame: usize, stride: usize) {
        self.most = self.most.into_iter().chain([step]).max_by(f32::total_cmp);
        if frame.is_multiple_of(stride) {
            self.sampled.push(step);
        }
    }

    /// The largest step, less what is usual.
    fn beyond_usual(&self) -> Option<f32> {
        Some((self.most? - stats::percentile(&self.sampled, USUAL)?).max(0.0))
    }
}

fn larger(a: Option<f64>, b: Option<f64>) -> Option<f64> {
    a.into_iter().chain(b).max_by(f64::total_cmp)
}

/// The most yaw over any window of [`SPIN_SECS`] or less, radians.
fn fastest_turn(ground_frames: &[Planar], fps: f64) -> Option<f64> {
    let longest = (SPIN_SECS * fps).round().max(1.0) as usize;
    // Unwrapped, so that a window is a difference.
    let mut heading = 0.0;
    let mut headings = vec![0.0];
    for pair in ground_frames.windows(2) {
        heading += wrap_angle(pair[1].yaw - pair[0].yaw);
        headings.push(heading);
    }
    let turned = (0..headings.len()).flat_map(|start| {
        let window = &headings[start..headings.len().min(start + longest + 1)];
        let from = headings[start];
        window.iter().map(move |to: &f64| (to - from).abs())
    });
    turned.max_by(f64::total_cmp).filter(|_| ground_frames.len() > 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clip::{ContactOptions, character_frames};
    use crate::metrics::foot_slide_cm;
    use crate::synth::{Action, Params, synthesize};
    use glam::Quat;

    fn walk() -> (Clip, Roles) {
        let clip = synthesize(&Params::new(Action::Walk)).unwrap().clip;
        let roles = Roles::detect(clip.skeleton());
        (clip, roles)
    }

    fn measured(clip: &Clip, roles: &Roles) -> ClipMetrics {
        let contacts = Contacts::detect(clip, roles, &ContactOptions::default());
        ClipMetrics::measure(clip, roles, &contacts, &character_frames(clip, roles), 0.0)
    }

    /// The walk with each frame changed.
    fn changed(clip: &Clip, change: impl Fn(usize, &mut [Quat], &mut Vec3)) -> Clip {
        let (mut rotations, mut roots) = (Vec::new(), Vec::new());
        for frame in 0..clip.frames() {
            let (mut pose, mut root) = (clip.rotations(frame).to_vec(), clip.root_translations()[frame]);
            change(frame, &mut pose, &mut root);
            rotations.extend(pose);
            roots.push(root);
        }
        Clip::new("changed", std::sync::Arc::clone(clip.skeleton()), clip.fps(), rotations, roots).unwrap()
    }

    #[test]
    fn a_made_walk_is_smooth() {
        let (clip, roles) = walk();
        let metrics = measured(&clip, &roles);
        assert!(metrics.seam_deg.unwrap() < 1.0 && metrics.jump_cm.unwrap() < 0.5, "{metrics:?}");
        assert!(
            metrics.spin_deg.unwrap() < 20.0 && metrics.penetration_cm.unwrap() < 1.0,
            "{metrics:?}"
        );
    }

    #[test]
    fn what_is_done_to_a_clip_is_measured() {
        let (clip, roles) = walk();
        let half = clip.frames() / 2;
        let before = measured(&clip, &roles);
        // A knee that snaps by 20° and stays there.
        let joint = clip.skeleton().len() - 2;
        let snapped = changed(&clip, |frame, pose, _| {
            if frame >= half {
                pose[joint] *= Quat::from_rotation_x(20_f32.to_radians());
            }
        });
        let metrics = measured(&snapped, &roles);
        assert!((15.0..=21.0).contains(&metrics.seam_deg.unwrap()), "{metrics:?}");
        assert!(metrics.seam_dps.unwrap() > 15.0 * clip.fps(), "{metrics:?}");
        // A step aside of 10 cm, and sunk by 3 cm from there on.
        let sunk = changed(&clip, |frame, _, root| {
            if frame >= half {
                *root += Vec3::new(0.1, -0.03, 0.0);
            }
        });
        let metrics = measured(&sunk, &roles);
        // Across the way that it goes anyway, and beyond the usual step of 3 cm.
        assert!((6.5..=10.0).contains(&metrics.jump_cm.unwrap()), "{metrics:?}");
        let deeper = metrics.penetration_cm.unwrap() - before.penetration_cm.unwrap();
        assert!((1.5..=3.01).contains(&deeper), "{metrics:?}");
        // A turn by 90° within 0.1 s.
        let steps = 0.1 * clip.fps();
        let spun = changed(&clip, |frame, pose, _| {
            let share = ((frame as f64 - half as f64) / steps).clamp(0.0, 1.0);
            pose[0] = Quat::from_rotation_y((share as f32) * std::f32::consts::FRAC_PI_2) * pose[0];
        });
        let metrics = measured(&spun, &roles);
        assert!((80.0..=100.0).contains(&metrics.spin_deg.unwrap()), "{metrics:?}");
    }

    #[test]
    fn slices_find_the_same() {
        let (clip, roles) = walk();
        let contacts = Contacts::detect(&clip, &roles, &ContactOptions::default());
        let frames = character_frames(&clip, &roles);
        let mut meter = ClipMeter::new(&clip, &roles, 0.0);
        let mut progress = 0.0;
        while meter.advance(&clip, &contacts, 7) {
            assert!(meter.progress(&clip) > progress);
            progress = meter.progress(&clip);
        }
        let metrics = meter.finish(&clip, &frames);
        assert_eq!(metrics, measured(&clip, &roles));
        assert_eq!(metrics.skate_cm, foot_slide_cm(&clip, &roles, &contacts));
    }

    #[test]
    fn a_single_pose_has_nothing_to_jump() {
        let (clip, roles) = walk();
        let pose = changed(&clip, |_, _, _| {}).crop(0..1).unwrap();
        let metrics = measured(&pose, &roles);
        assert_eq!((metrics.seam_deg, metrics.jump_cm, metrics.spin_deg), (None, None, None));
    }
}
