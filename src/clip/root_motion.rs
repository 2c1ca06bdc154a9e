use super::Clip;
use crate::math::Planar;
use crate::skeleton::{Role, Roles, Side, WorldPose};
use glam::Vec3;

/// A joint moves when its positions over the clip spread by more than this, metres.
const MOVES_M: f32 = 1e-3;
/// Across axes whose share over the ground is below this are those of a character lying on its side: no facing.
const LEAST_ACROSS: f32 = 0.2;

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
    for frame in 0..clip.frames() {
        clip.world_pose_into(frame, &mut world);
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
    let (hips, shoulders) = (across(Role::thigh), across(Role::upper_arm));
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
    for frame in 0..clip.frames() {
        clip.world_pose_into(frame, &mut world);
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
    let mut next = values.to_vec();
    for i in (0..next.len().saturating_sub(1)).rev() {
        if next[i].is_none() {
            next[i] = next[i + 1];
        }
    }
    let mut filled = Vec::with_capacity(values.len());
    let mut last_known: Option<usize> = None;
    for (i, value) in values.iter().enumerate() {
        if value.is_some() {
            last_known = Some(i);
        }
        let to_next = values[i..].iter().position(Option::is_some);
        filled.push(match (last_known, to_next) {
            (Some(last), Some(ahead)) if ahead < i - last => next[i],
            (Some(last), _) => values[last],
            (None, _) => next[i],
        });
    }
    filled
}

/// The measured speed over the ground, metres per second: the length of the path of the frames' origins over its duration.
///
/// 0 for fewer than two frames or a frame rate that is not positive; never negative. The path contains the body's sway.
#[must_use]
pub fn ground_speed(frames: &[Planar], fps: f64) -> f32 {
    let steps = frames.len().saturating_sub(1);
    if steps == 0 || !(fps.is_finite() && fps > 0.0) {
        return 0.0;
    }
    let path: f64 = frames.windows(2).map(|pair| pair[0].shift.distance(pair[1].shift)).sum();
    (path * fps / steps as f64) as f32
}
