//! Detection of a leading T-pose, which converters of captured motion add.

use super::raw::RawMotion;
use glam::Quat;
use segue_motion::math::quat;

/// Joints that are rotated by less than this are at rest, radians (1°).
const AT_REST: f32 = 0.017_453_3;

/// The number of frames after the first that are compared.
const FRAMES: usize = 30;

/// Returns whether the first frame is a T-pose that does not belong to the motion.
///
/// Two conditions must hold for the joints that move at all: most are at rest in the first frame
/// and not in the second, and the step from the first frame to the second is many times larger than
/// the following ones. A motion that starts in the rest pose and leaves it smoothly fails the
/// second condition, a cut within a take fails the first.
pub(super) fn first_frame_is_t_pose(raw: &RawMotion) -> bool {
    let frames = raw.frames().min(FRAMES);
    if frames < 3 {
        return false;
    }
    let (first, second) = (raw.pose(0), raw.pose(1));
    let moves = |joint: usize| {
        let of = |frame: usize| raw.pose(frame).get(joint).copied().unwrap_or(Quat::IDENTITY);
        (1..frames).any(|frame| quat::angle_between(of(0), of(frame)) > AT_REST)
    };
    let moving: Vec<usize> = (0..raw.joints.len()).filter(|&joint| moves(joint)).collect();
    let resting = |pose: &[Quat]| {
        let angle = |joint: &usize| {
            pose.get(*joint).map_or(0.0, |&q| quat::angle_between(Quat::IDENTITY, q))
        };
        moving.iter().filter(|joint| angle(joint) < AT_REST).count()
    };
    let mostly_at_rest =
        resting(first) * 10 >= moving.len() * 6 && resting(second) * 10 <= moving.len() * 5;
    if moving.is_empty() || !mostly_at_rest {
        return false;
    }
    let step = |frame: usize| {
        let angle =
            |joint: &usize| match (raw.pose(frame).get(*joint), raw.pose(frame + 1).get(*joint)) {
                (Some(&a), Some(&b)) => quat::angle_between(a, b),
                _ => 0.0,
            };
        moving.iter().map(angle).sum::<f32>() / moving.len() as f32
    };
    let mut later: Vec<f32> = (1..frames - 1).map(step).collect();
    later.sort_by(f32::total_cmp);
    let usual = later.get(later.len() / 2).copied().unwrap_or_default();
    step(0) > (5.0 * usual).max(3.0 * AT_REST)
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
            tracks: vec![],
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
