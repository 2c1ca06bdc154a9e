//! Poses with velocities, in the character's frame.

use crate::blend::translation_of;
use crate::clip::Motion;
use crate::math::{Planar, quat, wrap_angle};
use glam::{Quat, Vec3};

/// A pose with velocities in the character's own frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MovingPose {
    /// Local rotations of all joints; the root's is `character_from_root`.
    pub rotations: Vec<Quat>,
    /// Angular velocities of these rotations, radians per second, in the frame to which each
    /// rotation maps.
    pub angular_velocities: Vec<Vec3>,
    /// Translations, metres: the root's in the character's frame first, then those of other joints
    /// that move relative to their parent.
    pub translations: Vec<Vec3>,
    /// Their velocities, metres per second.
    pub velocities: Vec<Vec3>,
    /// Velocity of the character over the ground, in its own frame: (sideways m/s, yaw rate rad/s,
    /// forward m/s).
    pub travel: Vec3,
    /// Velocity over the ground without the sway of the stride: the mean of `travel` over about a
    /// second. A transition hands it over, whereas sway returns to 0.
    pub steady_travel: Vec3,
}

/// Duration of a stride, seconds: the sway of walking and running averages out over it.
const STRIDE_SECS: f64 = 1.0;

/// A view of a clip's frames relative to the ground frame of the character, or to a fixed frame.
pub(super) struct View<'a> {
    pub(super) source: &'a Motion,
    /// The joints other than the root that have translations.
    pub(super) moving: &'a [usize],
    /// The fixed frame of reference (`here_from_clip`) of poses; `None` for the character's.
    pub(super) fixed: Option<Planar>,
}

impl View<'_> {
    fn here_from_clip(&self, frame: usize) -> Planar {
        self.fixed.unwrap_or_else(|| self.source.ground_frames()[frame].inverse())
    }

    /// Computes rotations and translations of a frame into reusable buffers.
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

    /// Returns the pose right before `frame`, with the velocities of the step into `frame`, and its
    /// ground frame.
    ///
    /// Before its first frame a clip is extrapolated by its first step, and after its last one by
    /// its last step; a clip of one frame stands still. Velocities are those of one step at the
    /// clip's own rate, forward in time from the pose, so that two clips with equal steps have no
    /// difference.
    pub(super) fn before(&self, frame: usize) -> (MovingPose, Planar) {
        let clip = self.source.clip();
        let (fps, frames) = (clip.fps() as f32, self.source.ground_frames());
        let last = clip.frames().saturating_sub(1);
        // The step that represents the one into `frame`.
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
            // The frame before the one after the end is the last one.
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

    /// Returns the mean travel over a stride around the step into `frame`; near an end of the clip,
    /// over its first or last stride: a part of a stride has sway.
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

/// Returns a step of the character in its own frame as velocities.
pub(super) fn travel(step: &Planar, fps: f64) -> Vec3 {
    Vec3::new(
        (step.shift.x * fps) as f32,
        (wrap_angle(step.yaw) * fps) as f32,
        (step.shift.y * fps) as f32,
    )
}

/// Returns a step with `travel` for `secs` added.
pub(super) fn with_travel(step: &Planar, travel: Vec3, secs: f64) -> Planar {
    let off = travel.as_dvec3() * secs;
    Planar::new(step.yaw + off.y, step.shift.x + off.x, step.shift.y + off.z)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::registration::fixtures::Walk;

    fn source_of(walk: &Walk) -> Motion {
        Motion::analyze(walk.clip())
    }

    fn free(source: &Motion) -> View<'_> {
        View { source, moving: &[], fixed: None }
    }

    #[test]
    fn before_extrapolates_beyond_both_ends() {
        let source = source_of(&Walk { frames: 40, turning: 0.7, ..Walk::default() });
        let (clip, view) = (source.clip(), free(&source));
        let dt = clip.dt_secs();
        // The pose before a frame, one step on, is the frame; before the first frame with the step
        // after it, after the last with the one before.
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
                assert!(stepped.shift.distance(source.ground_frames()[at].shift) < 1e-5, "{frame}");
            } else {
                assert_eq!(
                    (&pose.rotations, standing),
                    (&view.pose(39).0, source.ground_frames()[39])
                );
                let arm = quat::log(clip.rotations(39)[3] * clip.rotations(38)[3].conjugate()) / dt;
                assert!((pose.angular_velocities[3] - arm).length() < 1e-4);
            }
            assert!((pose.travel - travel(&source.step_into(step), 60.0)).length() < 1e-5);
        }
    }

    #[test]
    fn steady_travel_is_without_sway() {
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
