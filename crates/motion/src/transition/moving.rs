use crate::blend::{Source, translation_of};
use crate::math::{Planar, quat, wrap_angle};
use glam::{Quat, Vec3};

/// A pose in the character's own frame, and how it moves there.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MovingPose {
    /// Local rotations of all joints; the root's is `character_from_root`.
    pub rotations: Vec<Quat>,
    /// Angular velocities of these rotations, radians per second, in the frame that each rotation
    /// turns into.
    pub angular_velocities: Vec<Vec3>,
    /// Translations, metres: the root's in the character's frame first, then those of other joints
    /// that move against their parent.
    pub translations: Vec<Vec3>,
    /// Their velocities, metres per second.
    pub velocities: Vec<Vec3>,
    /// How the character goes over the ground, in its own frame: (sideways m/s, yaw rate rad/s,
    /// forward m/s).
    pub travel: Vec3,
    /// The same without the sway of the stride: its mean over about a second. What a transition
    /// hands over; sway only swings out. Equal to `travel` where nothing sways.
    pub steady_travel: Vec3,
}

/// A stride, seconds: over it the sway of walking and running averages out.
const STRIDE_SECS: f64 = 1.0;

/// One frame of a clip, as seen from where the character stands, or from a fixed place when `at`
/// says so.
pub(super) struct View<'a> {
    pub(super) source: &'a Source,
    /// The joints other than the root that have translations of their own.
    pub(super) moving: &'a [usize],
    /// Poses are taken in this fixed frame of reference (`here_from_clip`), not in the character's.
    pub(super) fixed: Option<Planar>,
}

impl View<'_> {
    fn here_from_clip(&self, frame: usize) -> Planar {
        self.fixed.unwrap_or_else(|| self.source.frames()[frame].inverse())
    }

    /// Rotations and translations of a frame, into buffers that are used again.
    pub(super) fn pose_into(
        &self,
        frame: usize,
        rotations: &mut Vec<Quat>,
        translations: &mut Vec<Vec3>,
    ) {
        let (clip, here) = (self.source.clip(), self.here_from_clip(frame));
        rotations.clear();
        rotations.extend_from_slice(clip.rotations(frame));
        if let Some(root) = rotations.first_mut() {
            *root = quat::renormalize(here.rotation() * *root);
        }
        translations.clear();
        translations.push(here.apply(clip.root_translations()[frame]));
        translations.extend(self.moving.iter().map(|&joint| translation_of(clip, joint, frame)));
    }

    pub(super) fn pose(&self, frame: usize) -> (Vec<Quat>, Vec<Vec3>) {
        let (mut rotations, mut translations) = (Vec::new(), Vec::new());
        self.pose_into(frame, &mut rotations, &mut translations);
        (rotations, translations)
    }

    /// The pose right before `frame`, moving as the step into `frame` does, and where the character
    /// stands in it.
    ///
    /// Before its first frame a clip is taken to have moved as in its first step, and behind its
    /// last one to go on as in its last; a clip of one frame stands still. One step at the clip's
    /// own rate, forward in time from the pose: two clips that are seen at frames where they do the
    /// same thing have no difference.
    pub(super) fn before(&self, frame: usize) -> (MovingPose, Planar) {
        let clip = self.source.clip();
        let (fps, frames) = (clip.fps() as f32, self.source.frames());
        let last = clip.frames().saturating_sub(1);
        // The step that stands for the one into `frame`.
        let (from, to) = if last == 0 {
            (0, 0)
        } else {
            let to = frame.clamp(1, last);
            (to - 1, to)
        };
        let (mut rotations, mut translations) = self.pose(from);
        let (next, next_translations) = self.pose(to);
        let turns: Vec<Vec3> = rotations
            .iter()
            .zip(&next)
            .map(|(&from, &to)| quat::log(to * from.conjugate()))
            .collect();
        let shifts: Vec<Vec3> =
            translations.iter().zip(&next_translations).map(|(&from, &to)| to - from).collect();
        let step = frames[from].inverse().after(&frames[to]);
        let mut standing = frames[from];
        if frame > last && frame > 0 {
            // What is before the frame behind the last one is the last one.
            (rotations, translations, standing) = (next, next_translations, frames[to]);
        } else if frame == 0 {
            for (rotation, turn) in rotations.iter_mut().zip(&turns) {
                *rotation = quat::renormalize(quat::exp(-*turn) * *rotation);
            }
            for (translation, shift) in translations.iter_mut().zip(&shifts) {
                *translation -= *shift;
            }
            standing = standing.after(&step.inverse());
        }
        let pose = MovingPose {
            rotations,
            angular_velocities: turns.into_iter().map(|turn| turn * fps).collect(),
            translations,
            velocities: shifts.into_iter().map(|shift| shift * fps).collect(),
            travel: travel(&step, clip.fps()),
            steady_travel: self.steady_travel(frame),
        };
        (pose, standing)
    }

    /// The mean travel over a stride around the step into `frame`; near an end of the clip, over
    /// the first or the last stride of it: a part of a stride has a sway of its own.
    fn steady_travel(&self, frame: usize) -> Vec3 {
        let (fps, last) = (self.source.clip().fps(), self.source.clip().frames().saturating_sub(1));
        let count = ((STRIDE_SECS * fps).round() as usize).clamp(1, last.max(1));
        let first =
            frame.saturating_sub(count / 2).clamp(1, (last + 1).saturating_sub(count).max(1));
        let sum: Vec3 =
            (first..first + count).map(|frame| travel(&self.source.step_into(frame), fps)).sum();
        sum / count as f32
    }
}

/// A step of the character in its own frame as velocities.
pub(super) fn travel(step: &Planar, fps: f64) -> Vec3 {
    Vec3::new(
        (step.shift.x * fps) as f32,
        (wrap_angle(step.yaw) * fps) as f32,
        (step.shift.y * fps) as f32,
    )
}

/// The step that adds `travel` for `secs` to another step.
pub(super) fn further(step: &Planar, travel: Vec3, secs: f64) -> Planar {
    let off = travel.as_dvec3() * secs;
    Planar::new(step.yaw + off.y, step.shift.x + off.x, step.shift.y + off.z)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::registration::fixtures::Walk;
    use crate::skeleton::Roles;
    use std::sync::Arc;

    fn source_of(walk: &Walk) -> Source {
        let clip = walk.clip();
        let roles = Roles::detect(clip.skeleton());
        Source::new(Arc::new(clip), &roles)
    }

    fn free(source: &Source) -> View<'_> {
        View { source, moving: &[], fixed: None }
    }

    #[test]
    fn clips_go_on_beyond_their_ends_as_in_their_last_step() {
        let source = source_of(&Walk { frames: 40, turning: 0.7, ..Walk::default() });
        let (clip, view) = (source.clip(), free(&source));
        let dt = clip.dt_secs();
        // The pose before a frame, one step on, is the frame; before the first frame with the step
        // behind it, behind the last with the one before.
        for (frame, arrives_at, step) in [
            (0, Some(0), 1),
            (1, Some(1), 1),
            (25, Some(25), 25),
            (39, Some(39), 39),
            (40, None, 39),
        ] {
            let (pose, standing) = view.before(frame);
            let stepped = standing.after(&source.step_into(step));
            if let Some(at) = arrives_at {
                let (rotations, translations) = view.pose(at);
                for ((from, velocity), to) in
                    pose.rotations.iter().zip(&pose.angular_velocities).zip(&rotations)
                {
                    assert!(
                        quat::angle_between(quat::exp(*velocity * dt) * *from, *to) < 1e-5,
                        "{frame}"
                    );
                }
                assert!(
                    (pose.translations[0] + pose.velocities[0] * dt).distance(translations[0])
                        < 1e-5
                );
                assert!(stepped.shift.distance(source.frames()[at].shift) < 1e-5, "{frame}");
            } else {
                assert_eq!((&pose.rotations, standing), (&view.pose(39).0, source.frames()[39]));
                let arm = quat::log(clip.rotations(39)[3] * clip.rotations(38)[3].conjugate()) / dt;
                assert!((pose.angular_velocities[3] - arm).length() < 1e-4);
            }
            assert!((pose.travel - travel(&source.step_into(step), 60.0)).length() < 1e-5);
        }
    }

    #[test]
    fn steady_travel_has_no_sway() {
        let source = source_of(&Walk { frames: 400, cadence: 1.0, ..Walk::default() });
        let view = free(&source);
        for frame in [0, 7, 200, 395, 400] {
            let (pose, _) = view.before(frame);
            assert!(
                (pose.steady_travel - Vec3::Z * 1.3).length() < 0.01,
                "{frame} {}",
                pose.steady_travel
            );
        }
        assert!((0..60).any(|frame| (view.before(frame).0.travel.z - 1.3).abs() > 0.1));
    }
}
