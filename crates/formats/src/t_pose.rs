//! Detection of a leading T-pose, which converters of captured motion add.

use super::raw::RawMotion;
use glam::Quat;

/// Returns whether the first frame is a T-pose that does not belong to the motion, as
/// [`clean`](segue_motion::clean::first_frame_is_t_pose) defines it.
pub(super) fn first_frame_is_t_pose(raw: &RawMotion) -> bool {
    let rotation =
        |frame: usize, joint: usize| raw.pose(frame).get(joint).copied().unwrap_or(Quat::IDENTITY);
    segue_motion::clean::first_frame_is_t_pose(raw.frames(), raw.joints.len(), rotation)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;
    use segue_motion::skeleton::Joint;

    fn motion(angle: impl Fn(usize, usize) -> f32) -> RawMotion {
        let joint = |index: usize| Joint {
            name: String::new(),
            parent: index.checked_sub(1),
            offset: Vec3::Y,
            end_site: None,
            channels: vec![],
        };
        let angle = &angle;
        RawMotion {
            joints: (0..10).map(joint).collect(),
            rotations: (0..20)
                .flat_map(|frame| {
                    (0..10).map(move |joint| Quat::from_rotation_x(angle(frame, joint)))
                })
                .collect(),
            root_translations: vec![Vec3::ZERO; 20],
            ..RawMotion::default()
        }
    }

    #[test]
    fn first_frame_is_t_pose_only_before_a_jump() {
        let walk =
            |frame: usize, joint: usize| 0.4 + 0.1 * (frame as f32 * 0.3 + joint as f32).sin();
        assert!(first_frame_is_t_pose(&motion(|frame, joint| {
            if frame == 0 { 0.0 } else { walk(frame, joint) }
        })));
        let with_bent_arms = |frame, joint| {
            if frame == 0 { if joint < 3 { 0.3 } else { 0.0 } } else { walk(frame, joint) }
        };
        assert!(first_frame_is_t_pose(&motion(with_bent_arms)));
        assert!(!first_frame_is_t_pose(&motion(walk)), "no T-pose at all");
        assert!(
            !first_frame_is_t_pose(&motion(|frame, _| frame as f32 * 0.05)),
            "leaves the rest pose smoothly"
        );
        assert!(
            !first_frame_is_t_pose(&motion(|frame, _| if frame == 10 { 0.8 } else { 0.0 })),
            "a jump elsewhere"
        );
        assert!(!first_frame_is_t_pose(&motion(|_, _| 0.0)), "never moves");
    }
}
