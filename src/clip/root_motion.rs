use super::Clip;
use crate::math::Planar;
use crate::skeleton::{Role, Roles, Side, WorldPose};
use glam::Vec3;

/// A joint moves when its positions over the clip spread by more than this, metres.
const MOVES_M: f32 = 1e-3;
/// Across axes whose share over the ground is below this are those of a character lying on its side: no facing.
const LEAST_ACROSS: f32 = 0.2;

/// The pairs of joints whose axes say where the body faces.
const ACROSS: [fn(Side) -> Role; 2] = [Role::thigh, Role::upper_arm];

/// The joint that carries the character through the world: the first from the top whose world position varies, on the way from the root to
/// the hips. Some files hold a `ROOT` still and move the `Hips` below it. The root where nothing moves.
#[must_use]
pub fn motion_root(clip: &Clip, roles: &Roles) -> usize {
    let skeleton = clip.skeleton();
    let hips = roles.get_within(Role::Hips, skeleton.len());
    // Without hips every joint that has translations of its own is a candidate, from the top.
    let mut candidates: Vec<usize> = match hips {
        Some(hips) => std::iter::successors(Some(hips), |&joint| skeleton.parent(joint)).collect(),
        None => clip.translations().iter().map(|track| track.joint).chain([0]).collect(),
    };
    candidates.sort_unstable();
    let mut bounds: Vec<Option<(Vec3, Vec3)>> = vec![None; candidates.len()];
    let mut world = WorldPose::default();
    let needed = skeleton.with_ancestors(candidates.iter().copied());
    for frame in 0..clip.frames() {
        clip.world_pose_of(frame, &needed, &mut world);
        for (&joint, bound) in candidates.iter().zip(&mut bounds) {
            let p = world.positions[joint];
            *bound = Some(bound.map_or((p, p), |(low, high)| (low.min(p), high.max(p))));
        }
    }
    let moves = |bound: &Option<(Vec3, Vec3)>| bound.is_some_and(|(low, high)| (high - low).max_element() > MOVES_M);
    candidates
        .iter()
        .zip(&bounds)
        .find(|(_, bound)| moves(bound))
        .map_or(0, |(&joint, _)| joint)
}

/// Where the body faces, as a unit vector over the ground; `None` where it faces up, down or nowhere (a character lying on its side).
///
/// The mean of the axes across hips and shoulders (right to left), turned a quarter about up. Never an Euler angle: those jump where the
/// body does not. A rig without legs and arms faces along its root's +Z.
#[must_use]
pub fn facing(world: &WorldPose, roles: &Roles) -> Option<Vec3> {
    let at = |role| roles.get(role).and_then(|joint| world.positions.get(joint).copied());
    let across = |role: fn(Side) -> Role| (at(role(Side::Left))? - at(role(Side::Right))?).try_normalize();
    let [hips, shoulders] = ACROSS.map(across);
    let forward = if hips.is_none() && shoulders.is_none() {
        *world.rotations.first()? * Vec3::Z
    } else {
        // Left × up = forward.
        (hips.unwrap_or_default() + shoulders.unwrap_or_default())
            .try_normalize()?
            .cross(Vec3::Y)
    };
    let forward = Vec3::new(forward.x, 0.0, forward.z);
    if forward.length() < LEAST_ACROSS {
        None
    } else {
        forward.try_normalize()
    }
}

/// Where the character stands on the ground and what it faces, frame by frame: `world_from_character`.
///
/// The shift is the [`motion_root`] projected to the ground, the yaw that of [`facing`]. A frame without facing takes the yaw of the nearest
/// frame that has one (the earlier of two), so that the yaw never jumps to 0; without any such frame the yaw is 0.
#[must_use]
pub fn character_frames(clip: &Clip, roles: &Roles) -> Vec<Planar> {
    let root = motion_root(clip, roles);
    let mut world = WorldPose::default();
    let mut frames = Vec::with_capacity(clip.frames());
    let mut known: Vec<Option<f64>> = Vec::with_capacity(clip.frames());
    let across = ACROSS
        .into_iter()
        .flat_map(|role| Side::BOTH.map(role))
        .filter_map(|role| roles.get(role));
    let needed = clip.skeleton().with_ancestors(across.chain([root]));
    for frame in 0..clip.frames() {
        clip.world_pose_of(frame, &needed, &mut world);
        let facing = facing(&world, roles);
        let standing = Planar::standing_at(world.positions[root], facing.unwrap_or(Vec3::Z));
        known.push(facing.map(|_| standing.yaw));
        frames.push(standing);
    }
    for (frame, yaw) in frames.iter_mut().zip(nearest_known(&known)) {
        frame.yaw = yaw.unwrap_or(0.0);
    }
    frames
}

/// Every gap takes the value of the nearest known entry, of two equally near ones the earlier.
fn nearest_known(values: &[Option<f64>]) -> Vec<Option<f64>> {
    let mut filled = values.to_vec();
    let known: Vec<(usize, f64)> = values.iter().enumerate().filter_map(|(i, value)| Some((i, (*value)?))).collect();
    let mut next = 0;
    for (i, slot) in filled.iter_mut().enumerate() {
        // `known[next]` is the first known entry at or behind i.
        while known.get(next).is_some_and(|&(at, _)| at < i) {
            next += 1;
        }
        let before = next.checked_sub(1).and_then(|last| known.get(last));
        *slot = match (before, known.get(next)) {
            (Some(&(last, value)), Some(&(ahead, _))) if i - last <= ahead - i && ahead != i => Some(value),
            (_, Some(&(_, value))) | (Some(&(_, value)), None) => Some(value),
            (None, None) => None,
        };
    }
    filled
}

/// The measured speed over the ground, metres per second: the length of the path of the frames' origins over its duration.
///
/// 0 for fewer than two frames or a frame rate that is not positive; never negative. The path contains the body's sway.
///
/// ```
/// use segue::{clip::ground_speed, math::Planar};
///
/// // 31 frames, 2 cm apart, at 60 frames per second: half a second for 60 cm.
/// let walk: Vec<Planar> = (0..=30).map(|i| Planar::new(0.0, 0.0, 0.02 * f64::from(i))).collect();
/// assert!((ground_speed(&walk, 60.0) - 1.2).abs() < 1e-6);
/// ```
#[must_use]
pub fn ground_speed(frames: &[Planar], fps: f64) -> f32 {
    let steps = frames.len().saturating_sub(1);
    if steps == 0 || !(fps.is_finite() && fps > 0.0) {
        return 0.0;
    }
    let path: f64 = frames.windows(2).map(|pair| pair[0].shift.distance(pair[1].shift)).sum();
    (path * fps / steps as f64) as f32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clip::JointTranslations;
    use crate::clip::fixtures::{wander, wander_by};
    use crate::skeleton::fixtures;
    use glam::Quat;
    use proptest::prelude::*;
    use std::f64::consts::{FRAC_PI_2, PI};
    use std::sync::Arc;

    #[test]
    fn the_root_moves_unless_it_stands_still_above_moving_hips() {
        let skeleton = fixtures::bandai();
        let roles = fixtures::roles(&skeleton);
        let hips = roles.get(Role::Hips).unwrap();
        let moving = wander(&skeleton, 5, 1);
        assert_eq!(motion_root(&moving, &roles), 0);

        let still = Clip::new(
            "still",
            Arc::clone(&skeleton),
            30.0,
            vec![Quat::IDENTITY; 5 * skeleton.len()],
            vec![Vec3::ZERO; 5],
        )
        .unwrap();
        assert_eq!(motion_root(&still, &roles), 0);
        let values: Vec<Vec3> = (0..5).map(|i| Vec3::new(0.0, 0.95, 0.1 * i as f32)).collect();
        let carried = still.with_translations(vec![JointTranslations { joint: hips, values }]).unwrap();
        assert_eq!(motion_root(&carried, &roles), hips);
        assert_eq!(motion_root(&carried, &Roles::default()), hips);
        let frames = character_frames(&carried, &roles);
        assert!((frames[4].origin() - Vec3::Z * 0.4).length() < 1e-6);
        assert!((ground_speed(&frames, 30.0) - 3.0).abs() < 1e-5);
    }

    #[test]
    fn the_body_tells_where_it_faces_whatever_the_root_says() {
        for (rig, skeleton, _) in fixtures::all() {
            let roles = fixtures::roles(&skeleton);
            let world = wander_by(&skeleton, 1, 0, 0.0).world_pose(0);
            assert!((facing(&world, &roles).unwrap() - Vec3::Z).length() < 1e-6, "{rig}");
        }
        let skeleton = fixtures::lafan();
        let rest = wander_by(&skeleton, 1, 0, 0.0);
        // A rig whose root joint is turned by the file: the body still faces +X when its left is at -Z.
        let turned = rest.transformed(&Planar::new(FRAC_PI_2, 0.0, 0.0)).world_pose(0);
        assert!((facing(&turned, &fixtures::roles(&skeleton)).unwrap() - Vec3::X).length() < 1e-6);
        // Without roles the root's own +Z.
        assert!((facing(&turned, &Roles::default()).unwrap() - Vec3::X).length() < 1e-6);
        assert_eq!(facing(&WorldPose::default(), &Roles::default()), None);
    }

    /// A roll over the side: in the middle the axis across the body points up.
    #[test]
    fn lying_on_the_side_keeps_the_facing_of_the_neighbour() {
        let skeleton = fixtures::lafan();
        let roles = fixtures::roles(&skeleton);
        let yaw = Quat::from_rotation_y(0.5);
        let mut rotations = vec![Quat::IDENTITY; 3 * skeleton.len()];
        for (frame, roll) in [0.1f32, 1.57, 0.2].into_iter().enumerate() {
            rotations[frame * skeleton.len()] = yaw * Quat::from_rotation_z(roll);
        }
        let clip = Clip::new("roll", skeleton, 30.0, rotations, vec![Vec3::Y; 3]).unwrap();
        assert_eq!(facing(&clip.world_pose(1), &roles), None);
        for frame in character_frames(&clip, &roles) {
            assert!((frame.yaw - 0.5).abs() < 1e-5, "{}", frame.yaw);
        }
    }

    #[test]
    fn gaps_take_the_nearest_value() {
        let (a, b) = (Some(1.0), Some(2.0));
        assert_eq!(nearest_known(&[]), []);
        assert_eq!(nearest_known(&[None, None]), [None, None]);
        assert_eq!(nearest_known(&[None, a, None, None, None, b, None]), [a, a, a, a, b, b, b]);
        assert_eq!(nearest_known(&[a, None, None, b]), [a, a, b, b]);
        assert_eq!(nearest_known(&[a, b, a]), [a, b, a]);
    }

    #[test]
    fn speed_is_path_over_duration_and_never_negative() {
        let quarter: Vec<Planar> = (0..=90)
            .map(|i| f64::from(i) / 90.0 * FRAC_PI_2)
            .map(|a| Planar::new(0.0, 2.0 * a.cos(), 2.0 * a.sin()))
            .collect();
        // A quarter of a circle of 2 m in 3 s; the chords are shorter than the arc by 1.3e-5.
        assert!((f64::from(ground_speed(&quarter, 30.0)) - PI / 3.0).abs() < 2e-5);
        assert_eq!(ground_speed(&quarter[..1], 30.0), 0.0);
        assert_eq!(ground_speed(&[], 30.0), 0.0);
        for fps in [0.0, -30.0, f64::NAN, f64::INFINITY] {
            assert_eq!(ground_speed(&quarter, fps), 0.0);
        }
    }

    proptest! {
        /// Turning and moving the clip turns and moves its frames.
        #[test]
        fn frames_move_with_the_clip(seed in 0u64..500, yaw in -3.0f64..3.0, x in -5.0f64..5.0, z in -5.0f64..5.0) {
            let skeleton = fixtures::cmu_bvh();
            let roles = fixtures::roles(&skeleton);
            let clip = wander_by(&skeleton, 4, seed, 0.3);
            let placed = Planar::new(yaw, x, z);
            let moved = character_frames(&clip.transformed(&placed), &roles);
            for (before, after) in character_frames(&clip, &roles).iter().zip(&moved) {
                let wanted = placed.after(before);
                prop_assert!(crate::math::wrap_angle(after.yaw - wanted.yaw).abs() < 1e-5);
                prop_assert!(after.shift.distance(wanted.shift) < 1e-5);
            }
        }
    }
}
