//! The canonical form of a motion, in which the first joint is the carrier of the body.

use super::{Clip, ClipError, JointTranslations, character_frames};
use crate::math::sort::sort_by_key;
use crate::math::{Planar, quat, wrap_angle};
use crate::skeleton::{
    ChainChild, ChainJoint, ChainMotion, FoldedChain, Joint, Pose, Roles, Skeleton, WorldPose,
    carrier,
};
use glam::{DVec2, Quat, Vec3};
use std::sync::Arc;

/// Joints that move by less than this over a clip count as still: metres, and radians (0.3°). Files
/// are written with a few digits.
const STILL_M: f32 = 2e-3;
const STILL_RADIANS: f32 = 5e-3;
/// Half the averaging time of a joint that moves over the ground, seconds: it removes the sway of
/// the hips.
const SMOOTH_SECS: f64 = 0.25;
/// Translations nearer than this to the rest offset are not stored, metres.
const SAME_PLACE_M: f32 = 1e-6;

impl Clip {
    /// Returns the same motion with the carrier ([`carrier`]) at the root: all joints that the file
    /// has above it, still or moving, are folded into it.
    ///
    /// Some files hold a `ROOT` still and move the hips below it; game engines put a root on the
    /// ground below the character. Relative to such a root the body hangs on a lever: blending the
    /// lever's angles swings the body. After folding, `root_translations` and the first joint's
    /// rotations are those of the carrier in the world, and all algorithms may rely on that. The
    /// world positions of the remaining joints do not change. Other joints that hang from the
    /// joints above become children of the carrier. [`Self::unfolded`] is the inverse.
    ///
    /// # Errors
    /// [`ClipError`] does not occur for a valid clip; it is passed on from the reassembly of the
    /// parts.
    pub fn folded(self) -> Result<Self, ClipError> {
        let roles = Roles::detect(self.skeleton());
        self.folded_by(&roles)
    }

    /// Returns the same motion with the carrier at the root, as [`folded`](Self::folded) does, for
    /// joints whose roles are known.
    ///
    /// # Errors
    /// The same as for [`folded`](Self::folded).
    pub fn folded_by(self, roles: &Roles) -> Result<Self, ClipError> {
        let skeleton = self.skeleton();
        let root = carrier(skeleton, roles);
        if root == 0 || skeleton.folded_chain().is_some() {
            return Ok(self);
        }
        Fold::new(&self, root).clip()
    }

    /// Returns the motion as in its file, with the joints above the carrier ([`FoldedChain`]): each
    /// of them stands still, moves over the ground below this motion, or moves with the body, as in
    /// the original file. `None` where the file has none.
    #[must_use]
    pub fn unfolded(&self) -> Option<Self> {
        let above = self.skeleton().folded_chain()?;
        Unfold::new(self, above)?.clip().ok()
    }
}

/// The conversion of a clip to the canonical form.
struct Fold<'a> {
    clip: &'a Clip,
    /// The joints above the carrier, the file's root first.
    chain: Vec<usize>,
    /// For each joint of the result, its index in the clip; the carrier first.
    file_index: Vec<usize>,
    /// Joints of the result that the file has as children of the chain.
    beside: Vec<ChainChild>,
    /// The world poses of the chain, the carrier and the children of the chain, per frame.
    chain_poses: Vec<Vec<(Vec3, Quat)>>,
    carrier_poses: Vec<(Vec3, Quat)>,
    beside_poses: Vec<Vec<(Vec3, Quat)>>,
}

impl<'a> Fold<'a> {
    fn new(clip: &'a Clip, root: usize) -> Self {
        let skeleton = clip.skeleton();
        let mut chain: Vec<usize> =
            std::iter::successors(skeleton.parent(root), |&joint| skeleton.parent(joint)).collect();
        chain.reverse();
        let others = (0..skeleton.len()).filter(|joint| *joint != root && !chain.contains(joint));
        let file_index: Vec<usize> = std::iter::once(root).chain(others).collect();
        let hangs_on = |joint: usize| {
            let parent = skeleton.parent(file_index[joint])?;
            chain.iter().position(|&above| above == parent)
        };
        let beside: Vec<ChainChild> = (1..file_index.len())
            .filter_map(|joint| {
                Some(ChainChild {
                    joint,
                    hangs_on: hangs_on(joint)?,
                    offset: skeleton.joints()[file_index[joint]].offset,
                })
            })
            .collect();
        let tops = beside.iter().map(|beside| file_index[beside.joint]);
        let needed = skeleton.with_ancestors(tops.chain([root]));
        let mut fold = Self {
            chain_poses: Vec::with_capacity(clip.frames()),
            carrier_poses: Vec::with_capacity(clip.frames()),
            beside_poses: Vec::with_capacity(clip.frames()),
            clip,
            chain,
            beside,
            file_index,
        };
        let mut world = WorldPose::default();
        for frame in 0..clip.frames() {
            clip.world_pose_of(frame, &needed, &mut world);
            let at = |joint: usize| (world.positions[joint], world.rotations[joint]);
            fold.chain_poses.push(fold.chain.iter().map(|&joint| at(joint)).collect());
            fold.carrier_poses.push(at(root));
            let tops = fold.beside.iter().map(|beside| at(fold.file_index[beside.joint]));
            fold.beside_poses.push(tops.collect());
        }
        fold
    }

    fn clip(self) -> Result<Clip, ClipError> {
        let (clip, file) = (self.clip, self.clip.skeleton().joints());
        let mut rotations = Vec::with_capacity(clip.frames() * self.file_index.len());
        let mut tracks: Vec<JointTranslations> = self
            .beside
            .iter()
            .map(|beside| JointTranslations {
                joint: beside.joint,
                values: Vec::with_capacity(clip.frames()),
            })
            .collect();
        for frame in 0..clip.frames() {
            let first = rotations.len();
            let local = clip.rotations(frame);
            rotations.extend(self.file_index.iter().map(|&joint| local[joint]));
            let (at, turned) = self.carrier_poses[frame];
            rotations[first] = quat::renormalize(turned);
            let back = turned.conjugate();
            for ((beside, track), (position, rotation)) in
                self.beside.iter().zip(&mut tracks).zip(&self.beside_poses[frame])
            {
                rotations[first + beside.joint] = quat::renormalize(back * *rotation);
                track.values.push(back * (*position - at));
            }
        }
        let place_of = |joint: usize| self.file_index.iter().position(|&file| file == joint);
        for track in clip.translations() {
            let place = place_of(track.joint).filter(|&joint| {
                joint != 0 && self.beside.iter().all(|beside| beside.joint != joint)
            });
            if let Some(joint) = place {
                let values = track.values.clone();
                tracks.push(JointTranslations { joint, values });
            }
        }
        sort_by_key(&mut tracks, |track| track.joint);
        let skeleton = Arc::new(self.skeleton()?.with_folded_chain(Some(self.above(file))));
        let roots = self.carrier_poses.iter().map(|(position, _)| *position).collect();
        Ok(Clip::new(clip.name(), skeleton, clip.fps(), rotations, roots)?
            .with_translations(tracks)?
            .with_provenance(clip.provenance()))
    }

    fn skeleton(&self) -> Result<Skeleton, ClipError> {
        let skeleton = self.clip.skeleton();
        // In the rest pose the root stands at its offset.
        let root = skeleton.joints()[0].offset;
        let rest = skeleton.rest_positions();
        let carrier = self.file_index[0];
        let mut joints: Vec<Joint> =
            self.file_index.iter().map(|&joint| skeleton.joints()[joint].clone()).collect();
        for joint in &mut joints {
            joint.parent = joint
                .parent
                .and_then(|parent| self.file_index.iter().position(|&file| file == parent))
                .or(Some(0));
        }
        joints[0].parent = None;
        joints[0].offset = root + rest[carrier];
        for beside in &self.beside {
            joints[beside.joint].offset = rest[self.file_index[beside.joint]] - rest[carrier];
        }
        // Parents still stand before their children: the carrier is first, and the others keep the
        // order of the file.
        Skeleton::new(joints).map_err(|_| ClipError::Translations(carrier))
    }

    fn above(&self, file: &[Joint]) -> FoldedChain {
        let follows = self.follows();
        let chain = self.chain.iter().enumerate().map(|(place, &index)| {
            let (translation, rotation) = match self.chain_poses.first() {
                Some(poses) => local(place.checked_sub(1).map(|above| poses[above]), poses[place]),
                None => (file[index].offset, Quat::IDENTITY),
            };
            ChainJoint { joint: file[index].clone(), file_index: index, rotation, translation }
        });
        FoldedChain {
            chain: chain.collect(),
            carrier_offset: file[self.file_index[0]].offset,
            beside: self.beside.clone(),
            file_index: self.file_index.clone(),
            follows,
        }
    }

    /// Returns how the chain moves: the motion of its first joint that is not still.
    fn follows(&self) -> ChainMotion {
        let Some(first) = self.chain_poses.first() else {
            return ChainMotion::Still;
        };
        let still = |a: &(Vec3, Quat), b: &(Vec3, Quat)| {
            a.0.distance(b.0) < STILL_M && quat::angle_between(a.1, b.1) < STILL_RADIANS
        };
        let moves = |place: &usize| {
            self.chain_poses.iter().any(|poses| !still(&poses[*place], &first[*place]))
        };
        let Some(joint) = (0..self.chain.len()).find(moves) else {
            return ChainMotion::Still;
        };
        let poses_of_joint: Vec<(Vec3, Quat)> =
            self.chain_poses.iter().map(|poses| poses[joint]).collect();
        self.on_ground(joint, &poses_of_joint).unwrap_or_else(|| {
            let (at, turned) = self.carrier_poses[0];
            let (translation, rotation) = local(Some((at, turned)), poses_of_joint[0]);
            ChainMotion::WithCarrier { joint, rotation, translation }
        })
    }

    /// Returns the motion of a joint of the chain over the ground; `None` where it rises, sinks or
    /// leans.
    fn on_ground(&self, joint: usize, poses_of_joint: &[(Vec3, Quat)]) -> Option<ChainMotion> {
        let &(start, upright) = poses_of_joint.first()?;
        let mut turns = Vec::with_capacity(poses_of_joint.len());
        for (position, rotation) in poses_of_joint {
            let turned = *rotation * upright.conjugate();
            let yaw = 2.0 * libm::atan2(f64::from(turned.y), f64::from(turned.w));
            let lean = quat::angle_between(turned, Quat::from_rotation_y(yaw as f32));
            if (position.y - start.y).abs() > STILL_M || lean > STILL_RADIANS {
                return None;
            }
            turns.push(wrap_angle(yaw));
        }
        let roles = Roles::detect(self.clip.skeleton());
        let skeleton = self.clip.skeleton();
        let placed = super::root_motion::frames_of(self.clip, &roles, self.file_index[0]);
        debug_assert_eq!(
            placed.len(),
            self.clip.frames(),
            "one for each frame of {}",
            skeleton.len()
        );
        let frames = smoothed(&placed, self.clip.fps());
        let does_turn = turns.iter().any(|turn| turn.abs() > f64::from(STILL_RADIANS));
        let count = poses_of_joint.len() as f64;
        let (mut sin, mut cos, mut shift) = (0.0, 0.0, DVec2::ZERO);
        for ((position, _), (turn, here)) in poses_of_joint.iter().zip(turns.iter().zip(&frames)) {
            let yaw = turn - here.yaw;
            sin += libm::sin(yaw);
            cos += libm::cos(yaw);
            let off = DVec2::new(f64::from(position.x), f64::from(position.z));
            shift += here.inverse().apply_ground(off) / count;
        }
        Some(ChainMotion::OnGround {
            joint,
            height: start.y,
            rotation: upright,
            shift: shift.to_array(),
            yaw: does_turn.then(|| libm::atan2(sin, cos)),
        })
    }
}

/// Returns the pose of a joint relative to its parent's, from both in the world.
fn local(parent: Option<(Vec3, Quat)>, (position, rotation): (Vec3, Quat)) -> (Vec3, Quat) {
    match parent {
        None => (position, rotation),
        Some((at, turned)) => {
            let back = turned.conjugate();
            (back * (position - at), quat::renormalize(back * rotation))
        }
    }
}

/// Returns the world pose of a joint from its local pose: the inverse of [`local`].
fn placed(parent: Option<(Vec3, Quat)>, (translation, rotation): (Vec3, Quat)) -> (Vec3, Quat) {
    match parent {
        None => (translation, rotation),
        Some((at, turned)) => (at + turned * translation, quat::renormalize(turned * rotation)),
    }
}

/// Returns the ground frames of a character without the sway of its steps: means over
/// [`SMOOTH_SECS`] to either side, narrower towards the ends.
pub(super) fn smoothed(frames: &[Planar], fps: f64) -> Vec<Planar> {
    let reach = (SMOOTH_SECS * fps).round() as usize;
    // Unwrapped yaws, and prefix sums.
    let mut sums = vec![(0.0, DVec2::ZERO)];
    let mut yaw = frames.first().map_or(0.0, |first| first.yaw);
    for frame in frames {
        yaw += wrap_angle(frame.yaw - yaw);
        let &(turned, moved) = sums.last().unwrap_or(&(0.0, DVec2::ZERO));
        sums.push((turned + yaw, moved + frame.shift));
    }
    let mean = |frame: usize| {
        let reach = reach.min(frame).min(frames.len() - 1 - frame);
        let ((from_yaw, from), (to_yaw, to)) = (sums[frame - reach], sums[frame + reach + 1]);
        let count = (2 * reach + 1) as f64;
        Planar { yaw: (to_yaw - from_yaw) / count, shift: (to - from) / count }
    };
    (0..frames.len()).map(mean).collect()
}

/// The conversion of a clip back to the form of its file.
struct Unfold<'a> {
    clip: &'a Clip,
    above: &'a FoldedChain,
    skeleton: Arc<Skeleton>,
    /// For each joint of the result, the joint of the clip; `None` for joints above the carrier.
    from: Vec<Option<usize>>,
}

impl<'a> Unfold<'a> {
    fn new(clip: &'a Clip, above: &'a FoldedChain) -> Option<Self> {
        let all = above.chain.len() + above.file_index.len();
        let mut joints: Vec<Option<Joint>> = vec![None; all];
        let mut from = vec![None; all];
        for part in &above.chain {
            *joints.get_mut(part.file_index)? = Some(part.joint.clone());
        }
        for (joint, &file) in above.file_index.iter().enumerate() {
            let mut own = clip.skeleton().joints().get(joint)?.clone();
            own.parent = own.parent.and_then(|parent| above.file_index.get(parent).copied());
            if joint == 0 {
                own.parent = above.chain.last().map(|last| last.file_index);
                own.offset = above.carrier_offset;
            }
            if let Some(beside) = above.beside.iter().find(|beside| beside.joint == joint) {
                own.parent = above.chain.get(beside.hangs_on).map(|part| part.file_index);
                own.offset = beside.offset;
            }
            *joints.get_mut(file)? = Some(own);
            *from.get_mut(file)? = Some(joint);
        }
        let skeleton = Skeleton::new(joints.into_iter().collect::<Option<Vec<Joint>>>()?).ok()?;
        Some(Self { clip, above, skeleton: Arc::new(skeleton), from })
    }

    fn clip(&self) -> Result<Clip, ClipError> {
        let clip = self.clip;
        let needs_frames = matches!(self.above.follows, ChainMotion::OnGround { .. });
        let frames = if needs_frames {
            smoothed(&character_frames(clip, &Roles::detect(clip.skeleton())), clip.fps())
        } else {
            Vec::new()
        };
        let poses = (0..clip.frames()).map(|frame| self.pose(&clip.pose(frame), frames.get(frame)));
        let poses: Vec<Pose> = without_still_tracks(poses.collect(), &self.skeleton);
        Ok(Clip::from_poses(clip.name(), Arc::clone(&self.skeleton), clip.fps(), poses)?
            .with_provenance(clip.provenance()))
    }

    /// Returns the world poses of the chain in a frame.
    fn chain(&self, carrier: (Vec3, Quat), here: Option<&Planar>) -> Vec<(Vec3, Quat)> {
        let moved = match (self.above.follows, here) {
            (ChainMotion::OnGround { joint, height, rotation, shift, yaw }, Some(here)) => {
                let ground = here.apply_ground(DVec2::from_array(shift));
                let turn = yaw.map_or(0.0, |yaw| here.yaw + yaw) as f32;
                let at = Vec3::new(ground.x as f32, height, ground.y as f32);
                Some((joint, (at, quat::renormalize(Quat::from_rotation_y(turn) * rotation))))
            }
            (ChainMotion::WithCarrier { joint, rotation, translation }, _) => {
                Some((joint, placed(Some(carrier), (translation, rotation))))
            }
            _ => None,
        };
        let mut chain: Vec<(Vec3, Quat)> = Vec::with_capacity(self.above.chain.len());
        for (place, part) in self.above.chain.iter().enumerate() {
            let pose = match moved {
                Some((joint, pose)) if joint == place => pose,
                _ => placed(chain.last().copied(), (part.translation, part.rotation)),
            };
            chain.push(pose);
        }
        chain
    }

    fn pose(&self, pose: &Pose, here: Option<&Planar>) -> Pose {
        let carrier = (pose.root_translation, pose.rotations[0]);
        let chain = self.chain(carrier, here);
        let locals =
            |place: usize| local(place.checked_sub(1).map(|above| chain[above]), chain[place]);
        let mut made = Pose {
            root_translation: Vec3::ZERO,
            rotations: vec![Quat::IDENTITY; self.skeleton.len()],
            translations: Vec::new(),
        };
        for (place, part) in self.above.chain.iter().enumerate() {
            let (translation, rotation) = locals(place);
            made.rotations[part.file_index] = rotation;
            made.translations.push((part.file_index, translation));
        }
        for (file, joint) in self.from.iter().enumerate() {
            let Some(joint) = *joint else { continue };
            let beside = self.above.beside.iter().find(|beside| beside.joint == joint);
            let translation = pose
                .translations
                .iter()
                .find(|(moved, _)| *moved == joint)
                .map(|(_, value)| *value);
            let own = (
                translation.unwrap_or(self.clip.skeleton().joints()[joint].offset),
                pose.rotations[joint],
            );
            let (translation, rotation) = match beside {
                _ if joint == 0 => local(chain.last().copied(), carrier),
                Some(beside) => {
                    local(chain.get(beside.hangs_on).copied(), placed(Some(carrier), own))
                }
                None if translation.is_none() => {
                    made.rotations[file] = own.1;
                    continue;
                }
                None => own,
            };
            made.rotations[file] = rotation;
            made.translations.push((file, translation));
        }
        sort_by_key(&mut made.translations, |(joint, _)| *joint);
        if let Some((0, root)) = made.translations.first().copied() {
            made.root_translation = root;
            made.translations.remove(0);
        }
        made
    }
}

/// Removes the translations of joints that stay at their offset in every pose.
fn without_still_tracks(mut poses: Vec<Pose>, skeleton: &Skeleton) -> Vec<Pose> {
    let mut moves = vec![false; skeleton.len()];
    for pose in &poses {
        for &(joint, value) in &pose.translations {
            moves[joint] |= !value.abs_diff_eq(skeleton.joints()[joint].offset, SAME_PLACE_M);
        }
    }
    for pose in &mut poses {
        pose.translations.retain(|&(joint, _)| moves[joint]);
    }
    poses
}

#[cfg(test)]
mod tests;
