//! Root motion: facing, ground frames and speed of the character.

use super::Clip;
use crate::math::{Planar, wrap_angle};
use crate::skeleton::{Role, Roles, Side, WorldPose};
use glam::{Quat, Vec3};

/// A lateral axis whose horizontal share is below this belongs to a character lying on its side,
/// which has no facing.
const MIN_HORIZONTAL_SHARE: f32 = 0.2;

/// The pairs of joints whose lateral axes determine the facing.
const LATERAL_PAIRS: [fn(Side) -> Role; 2] = [Role::thigh, Role::upper_arm];

/// Returns the facing of a body as a unit vector over the ground; `None` where it faces up, down or
/// nowhere (a character lying on its side).
///
/// It is the mean of the axes across hips and shoulders (right to left), rotated by a quarter turn
/// about up. It never uses an Euler angle, which can jump where the body does not. A rig without
/// legs and arms faces along its root's +Z. A body on four legs faces from its hip joints to its
/// shoulder joints; the more it rears, the more the axes across count.
#[must_use]
pub fn facing(world: &WorldPose, roles: &Roles) -> Option<Vec3> {
    let at = |role| roles.get(role).and_then(|joint| world.positions.get(joint));
    let has = |role: fn(Side) -> Role| Side::BOTH.into_iter().all(|side| at(role(side)).is_some());
    if LATERAL_PAIRS.into_iter().any(has) {
        return axis_facing(world, roles);
    }
    over_the_ground(*world.rotations.first()? * Vec3::Z)
}

/// Returns the facing by hips and shoulders alone; `None` without either.
fn axis_facing(world: &WorldPose, roles: &Roles) -> Option<Vec3> {
    let at = |role| roles.get(role).and_then(|joint| world.positions.get(joint).copied());
    let across =
        |role: fn(Side) -> Role| (at(role(Side::Left))? - at(role(Side::Right))?).try_normalize();
    let [hips, shoulders] = LATERAL_PAIRS.map(across);
    // Left × up = forward.
    let across = (hips.unwrap_or_default() + shoulders.unwrap_or_default()).try_normalize();
    if roles.is_quadruped()
        && let Some(trunk) = trunk_over_the_ground(world, roles)
    {
        let upright = 1.0 - trunk.length();
        return over_the_ground(trunk + across.unwrap_or_default().cross(Vec3::Y) * upright);
    }
    over_the_ground(across?.cross(Vec3::Y))
}

/// Returns the horizontal part of the unit vector from the middle of the hip joints to that of the
/// shoulder joints; `None` where one of them is missing.
fn trunk_over_the_ground(world: &WorldPose, roles: &Roles) -> Option<Vec3> {
    let at = |role| roles.get(role).and_then(|joint| world.positions.get(joint).copied());
    let middle = |role: fn(Side) -> Role| Some(at(role(Side::Left))? + at(role(Side::Right))?);
    let trunk = (middle(Role::upper_arm)? - middle(Role::thigh)?).try_normalize()?;
    Some(Vec3::new(trunk.x, 0.0, trunk.z))
}

fn over_the_ground(forward: Vec3) -> Option<Vec3> {
    let forward = Vec3::new(forward.x, 0.0, forward.z);
    if forward.length() < MIN_HORIZONTAL_SHARE { None } else { forward.try_normalize() }
}

/// Returns the ground frames of the character, one per frame: `world_from_character`.
///
/// The shift is the position of the first joint, the carrier ([`Clip::folded`]), projected to the
/// ground; the yaw is that of [`facing`]. Over frames without facing the yaw turns evenly, the
/// shorter way, from the last known one to the next, so that it is continuous; before the first and
/// after the last known one it is constant. Without any facing, as for creatures without hips and
/// shoulders, the yaw is the rotation of the first joint about +Y since the first frame, starting
/// at the direction of its +Z there: that is 0 for a joint that points up or down.
#[must_use]
pub fn character_frames(clip: &Clip, roles: &Roles) -> Vec<Planar> {
    frames_of(clip, roles, 0)
}

/// Returns the [`character_frames`] of a body whose carrier is not the first joint.
pub(super) fn frames_of(clip: &Clip, roles: &Roles, carrier: usize) -> Vec<Planar> {
    let mut world = WorldPose::default();
    let mut frames = Vec::with_capacity(clip.frames());
    let mut known: Vec<Option<f64>> = Vec::with_capacity(clip.frames());
    let mut turns: Vec<Quat> = Vec::with_capacity(clip.frames());
    let across: Vec<usize> = LATERAL_PAIRS
        .into_iter()
        .flat_map(|role| Side::BOTH.map(role))
        .filter_map(|role| roles.get_within(role, clip.skeleton().len()))
        .collect();
    let needed = clip.skeleton().with_ancestors(across.iter().copied().chain([carrier]));
    for frame in 0..clip.frames() {
        clip.world_pose_of(frame, &needed, &mut world);
        let facing = axis_facing(&world, roles);
        let standing = Planar::standing_at(world.positions[carrier], facing.unwrap_or(Vec3::Z));
        known.push(facing.map(|_| standing.yaw));
        turns.push(world.rotations[carrier]);
        frames.push(standing);
    }
    if known.iter().all(Option::is_none) {
        known = turned_since_the_first(&turns);
    }
    for (frame, yaw) in frames.iter_mut().zip(without_gaps(&known)) {
        frame.yaw = yaw.unwrap_or(0.0);
    }
    frames
}

/// Returns the yaw of a joint in every frame: its rotation about +Y since the first frame, plus the
/// yaw of its +Z there. Relative rotations do not depend on the axes of the joint. `None` where the
/// joint is upside down.
fn turned_since_the_first(turns: &[Quat]) -> Vec<Option<f64>> {
    let Some(&first) = turns.first() else {
        return Vec::new();
    };
    let forward = first * Vec3::Z;
    let start = if Vec3::new(forward.x, 0.0, forward.z).length() < MIN_HORIZONTAL_SHARE {
        0.0
    } else {
        libm::atan2(f64::from(forward.x), f64::from(forward.z))
    };
    let yaw = |turn: &Quat| {
        let since = *turn * first.conjugate();
        let upright = libm::hypotf(since.y, since.w) > MIN_HORIZONTAL_SHARE;
        upright
            .then(|| wrap_angle(start + 2.0 * libm::atan2(f64::from(since.y), f64::from(since.w))))
    };
    turns.iter().map(yaw).collect()
}

/// Fills gaps between known angles evenly, the shorter way; before the first and after the last
/// known one with that one.
fn without_gaps(values: &[Option<f64>]) -> Vec<Option<f64>> {
    let mut filled = values.to_vec();
    let known: Vec<(usize, f64)> =
        values.iter().enumerate().filter_map(|(i, value)| Some((i, (*value)?))).collect();
    for pair in known.windows(2) {
        let [(from, start), (to, end)] = [pair[0], pair[1]];
        for (step, slot) in (1..).zip(&mut filled[from + 1..to]) {
            let share = f64::from(step) / (to - from) as f64;
            *slot = Some(wrap_angle(start + wrap_angle(end - start) * share));
        }
    }
    if let (Some(&(first, start)), Some(&(last, end))) = (known.first(), known.last()) {
        filled[..first].fill(Some(start));
        filled[last + 1..].fill(Some(end));
    }
    filled
}

/// Returns the speed over the ground, metres per second: the length of the path of the frames'
/// origins over its duration.
///
/// It is 0 for fewer than two frames or a frame rate that is not positive; never negative. The path
/// contains the body's sway.
///
/// ```
/// use segue_motion::{clip::ground_speed, math::Planar};
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
    use crate::clip::fixtures::wander_by;
    use crate::skeleton::fixtures;
    use glam::Quat;
    use proptest::prelude::*;
    use std::f64::consts::{FRAC_PI_2, PI};
    use std::sync::Arc;

    #[test]
    fn facing_follows_the_body_whatever_the_root_is() {
        for (rig, skeleton, _) in fixtures::all() {
            let roles = fixtures::roles(&skeleton);
            let world = wander_by(&skeleton, 1, 0, 0.0).world_pose(0);
            assert!((facing(&world, &roles).unwrap() - Vec3::Z).length() < 1e-6, "{rig}");
        }
        let skeleton = fixtures::lafan();
        let rest = wander_by(&skeleton, 1, 0, 0.0);
        // A rig whose root joint is rotated by the file: the body still faces +X when its left is
        // at -Z.
        let turned = rest.transformed(&Planar::new(FRAC_PI_2, 0.0, 0.0)).world_pose(0);
        assert!((facing(&turned, &fixtures::roles(&skeleton)).unwrap() - Vec3::X).length() < 1e-6);
        // Without roles it faces along the root's own +Z.
        assert!((facing(&turned, &Roles::default()).unwrap() - Vec3::X).length() < 1e-6);
        assert_eq!(facing(&WorldPose::default(), &Roles::default()), None);
    }

    /// In the middle of a roll over the side the axis across the body points up.
    #[test]
    fn character_frames_of_a_roll_keep_the_neighbouring_facing() {
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
    fn without_gaps_interpolates_the_shorter_way() {
        let (a, b) = (Some(1.0), Some(2.0));
        assert_eq!(without_gaps(&[]), []);
        assert_eq!(without_gaps(&[None, None]), [None, None]);
        assert_eq!(
            without_gaps(&[None, a, None, None, None, b, None]),
            [a, a, Some(1.25), Some(1.5), Some(1.75), b, b]
        );
        let across_the_back = without_gaps(&[Some(3.0), None, Some(-3.0)])[1].unwrap();
        assert!((across_the_back.abs() - PI).abs() < 1e-12, "{across_the_back}");
    }

    /// A creature without hips and shoulders follows the rotation of its root, whatever the root's
    /// axes are.
    #[test]
    fn character_frames_without_limbs_turn_with_the_root() {
        let skeleton = fixtures::lafan();
        for axes in [
            Quat::IDENTITY,
            Quat::from_rotation_x(1.3),
            Quat::from_euler(glam::EulerRot::XYZ, 0.4, -2.0, 0.9),
        ] {
            let turned = |frame: usize| Quat::from_rotation_y(0.1 * frame as f32) * axes;
            let mut rotations = vec![Quat::IDENTITY; 60 * skeleton.len()];
            for (frame, root) in rotations.iter_mut().step_by(skeleton.len()).enumerate() {
                *root = turned(frame);
            }
            let clip =
                Clip::new("whirl", Arc::clone(&skeleton), 30.0, rotations, vec![Vec3::Y; 60])
                    .unwrap();
            let frames = character_frames(&clip, &Roles::default());
            for pair in frames.windows(2) {
                let turn = crate::math::wrap_angle(pair[1].yaw - pair[0].yaw);
                assert!((turn - 0.1).abs() < 1e-4, "{turn}");
            }
        }
    }

    #[test]
    fn ground_speed_is_path_length_over_duration() {
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
        /// Transforming the clip transforms its ground frames.
        #[test]
        fn character_frames_transform_with_the_clip(
            seed in 0u64..500,
            yaw in -3.0f64..3.0,
            x in -5.0f64..5.0,
            z in -5.0f64..5.0,
        ) {
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
