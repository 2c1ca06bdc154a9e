//! Characters from files, moved by clips of other skeletons.

use super::{RigidTransform, SkinnedMesh};
use crate::clip::{Clip, stance_for_rest};
use crate::math::sort::sort_by;
use crate::math::stats;
use crate::skeleton::{
    JointMap, Retargeting, Role, Roles, Side, Skeleton, WorldPose, local_pose, world_pose_into,
};
use glam::Vec3;
use std::sync::Arc;

/// Number of frames of a clip from which the height of its ground is computed.
const SAMPLES: usize = 48;
/// The least number of limbs of a figure that clips of other bodies can move.
const MIN_LIMBS: usize = 2;
/// Number of vertices of the sole that are evaluated.
const SOLE_VERTICES: usize = 32;
/// The greatest distance of a clip's lowest foot points from the ground on which it stands, as a
/// share of the leg's length.
const MAX_GROUND_DISTANCE: f32 = 0.2;
/// The share of frames in which a foot may be below its ground: outliers in single frames.
const GROUND_PERCENTILE: f32 = 0.05;

/// A skeleton with a mesh of its own.
#[derive(Clone, Debug, PartialEq)]
pub struct Character {
    /// The skeleton.
    pub skeleton: Arc<Skeleton>,
    /// The roles of its joints.
    pub roles: Roles,
    /// The mesh, bound to `skeleton`.
    pub mesh: Arc<SkinnedMesh>,
}

impl Character {
    /// Returns whether it has limbs that clips of other bodies can move: two arms or legs, of which
    /// both bones are known.
    #[must_use]
    pub fn has_limbs(&self) -> bool {
        self.limbs().count() >= MIN_LIMBS
    }

    /// Returns whether the poses of a skeleton move it as a body: its own skeleton, one with two
    /// limbs in common, or one that moves half of its joints by their names. A figure of which
    /// only the hips are moved would stand stiffly.
    #[must_use]
    pub fn is_moved_by(&self, skeleton: &Arc<Skeleton>, roles: &Roles) -> bool {
        if Arc::ptr_eq(skeleton, &self.skeleton) || *skeleton == self.skeleton {
            return true;
        }
        let map = JointMap::between(&self.skeleton, &self.roles, skeleton, roles);
        let is_mapped = |joint: &usize| map.source_of(*joint).is_some();
        let limbs = self.limbs().filter(|limb| limb.iter().all(is_mapped)).count();
        limbs >= MIN_LIMBS || 2 * map.count() >= self.skeleton.len().max(2)
    }

    /// Returns a motion of this character raised so that the soles of its mesh are on the ground
    /// on which the feet of `source` are, the motion that it was retargeted from. Some frames are
    /// read. A motion of the character's own skeleton stays where it is.
    #[must_use]
    pub fn standing_as(&self, made: Clip, source: &Clip, roles: &Roles) -> Clip {
        let own = source.skeleton();
        let is_own = Arc::ptr_eq(own, &self.skeleton) || *own == self.skeleton;
        let Some(scale) = self.size_beside(own, roles).filter(|_| !is_own) else {
            return made;
        };
        let lift = lift_of_soles(self, (source, roles), scale, |frame, _, out| {
            made.world_pose_into(frame, out);
        });
        made.raised(lift)
    }

    /// Returns the joints at which the two bones of each limb begin.
    fn limbs(&self) -> impl Iterator<Item = [usize; 2]> + '_ {
        let of_side = |side| {
            [[Role::thigh(side), Role::shin(side)], [Role::upper_arm(side), Role::forearm(side)]]
        };
        let joint = |role| self.roles.get_within(role, self.skeleton.len());
        Side::BOTH
            .into_iter()
            .flat_map(of_side)
            .filter_map(move |[upper, lower]| Some([joint(upper)?, joint(lower)?]))
    }

    /// Returns the ratio of its size to that of a body of another skeleton, as
    /// [`Retargeting::scale`] measures it; `None` where the two have no joint in common.
    #[must_use]
    pub fn size_beside(&self, skeleton: &Arc<Skeleton>, roles: &Roles) -> Option<f32> {
        if Arc::ptr_eq(skeleton, &self.skeleton) || *skeleton == self.skeleton {
            return Some(1.0);
        }
        let way = self
            .is_moved_by(skeleton, roles)
            .then(|| Retargeting::new(skeleton, roles, &self.skeleton, &self.roles));
        Some(way??.scale())
    }

    /// Returns the character with all lengths multiplied by `factor`.
    #[must_use]
    pub fn scaled(&self, factor: f32) -> Self {
        let mut mesh = SkinnedMesh::clone(&self.mesh);
        mesh.scale(factor);
        Self {
            skeleton: Arc::new(self.skeleton.scaled(factor)),
            roles: self.roles.clone(),
            mesh: Arc::new(mesh),
        }
    }
}

/// The mapping by which poses of one skeleton move a [`Character`], with rest poses taken into
/// account (see [`Retargeting`]).
///
/// ```
/// use segue_motion::skeleton::{Roles, WorldPose};
/// use segue_motion::skin::{Character, Drive, SkinnedMesh, linear_blend};
/// use segue_motion::synth::{Action, Params, humanoid, synthesize};
/// use std::sync::Arc;
///
/// let skeleton = humanoid(1.5)?;
/// let roles = Roles::detect(&skeleton);
/// let mesh = Arc::new(SkinnedMesh::around(&skeleton, &roles, 1.0));
/// let child = Character { skeleton, roles, mesh };
///
/// let walk = synthesize(&Params::new(Action::Walk))?.clip;
/// let roles = Roles::detect(walk.skeleton());
/// let drive = Drive::new(&walk, &roles, &child).expect("two people have joints in common");
/// let (mut pose, mut transforms) = (WorldPose::default(), vec![]);
/// let (mut positions, mut normals) = (vec![], vec![]);
/// drive.pose(&walk.world_pose(30), &mut pose);
/// child.mesh.joint_transforms(&pose, &mut transforms);
/// linear_blend(&child.mesh, &transforms, &mut positions, &mut normals);
/// let lowest = positions.iter().map(|p| p.y).fold(f32::INFINITY, f32::min);
/// assert!(lowest.abs() < 0.03, "the soles are at {lowest} m");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Drive {
    source: Arc<Skeleton>,
    target: Arc<Skeleton>,
    /// `None` where both skeletons are equal.
    way: Option<Retargeting>,
    /// The height added to all joints, metres.
    lift: f32,
}

impl Drive {
    /// Prepares retargeting from the skeleton of `clip` to the character; `None` when the skeleton
    /// does not move it ([`Character::is_moved_by`]). Some frames of the clip are read, so that the
    /// character's soles are on the ground where the clip's feet are; `clip` may be any clip
    /// similar to those that are retargeted later.
    #[must_use]
    pub fn new(clip: &Clip, roles: &Roles, character: &Character) -> Option<Self> {
        let (source, target) = (clip.skeleton(), &character.skeleton);
        if !character.is_moved_by(source, roles) {
            return None;
        }
        let way = if Arc::ptr_eq(source, target) || source == target {
            None
        } else {
            let stance = stance_for_rest(clip, roles);
            Some(Retargeting::standing(
                source,
                roles,
                stance.as_ref(),
                target,
                &character.roles,
                None,
            )?)
        };
        let mut drive =
            Self { source: Arc::clone(source), target: Arc::clone(target), lift: 0.0, way };
        drive.lift = drive.way.as_ref().map_or(0.0, |way| {
            lift_of_soles(character, (clip, roles), way.scale(), |_, from, to| {
                drive.pose(from, to);
            })
        });
        Some(drive)
    }

    /// Returns the character's joint that a joint of the clip's skeleton drives; `None` for a joint
    /// that drives none.
    #[must_use]
    pub fn joint_driven_by(&self, source: usize) -> Option<usize> {
        match &self.way {
            None => Some(source),
            Some(way) => {
                (0..self.target.len()).find(|&joint| way.map().source_of(joint) == Some(source))
            }
        }
    }

    /// Returns the pose of the character for a pose of the clip's skeleton; both are in the world.
    pub fn pose(&self, source: &WorldPose, out: &mut WorldPose) {
        let Some(way) = &self.way else {
            out.clone_from(source);
            return;
        };
        let pose = way.pose(&local_pose(&self.source, source));
        world_pose_into(
            &self.target,
            pose.root_translation,
            &pose.rotations,
            pose.translations.iter().copied(),
            out,
        );
        for position in &mut out.positions {
            position.y += self.lift;
        }
    }

    /// Returns the transforms that move the character's mesh for a pose of the clip's skeleton:
    /// [`Drive::pose`], then [`SkinnedMesh::joint_transforms`].
    pub fn transforms(
        &self,
        source: &WorldPose,
        mesh: &SkinnedMesh,
        out: &mut Vec<RigidTransform>,
    ) {
        let mut pose = WorldPose::default();
        self.pose(source, &mut pose);
        mesh.joint_transforms(&pose, out);
    }
}

/// Returns the height by which poses of a character are raised so that its soles are on the ground
/// on which the feet of `source` are, metres. `pose` stores the character's pose for a frame of the
/// source, whose own pose it is given; `scale` is the ratio of the sizes.
fn lift_of_soles(
    character: &Character,
    (source, roles): (&Clip, &Roles),
    scale: f32,
    mut pose: impl FnMut(usize, &WorldPose, &mut WorldPose),
) -> f32 {
    let sole = Sole::of(character);
    let skeleton = source.skeleton();
    let feet = |pose: &WorldPose| {
        let points = Side::BOTH.into_iter().flat_map(|side| roles.foot_points(skeleton, side));
        let heights = points.filter_map(|(joint, point)| {
            Some((*pose.positions.get(joint)? + *pose.rotations.get(joint)? * point).y)
        });
        heights.min_by(f32::total_cmp)
    };
    let (mut from, mut to) = (WorldPose::default(), WorldPose::default());
    let (mut theirs, mut ours) = (Vec::new(), Vec::new());
    let step = source.frames().div_ceil(SAMPLES).max(1);
    for frame in (0..source.frames()).step_by(step) {
        source.world_pose_into(frame, &mut from);
        pose(frame, &from, &mut to);
        theirs.extend(feet(&from));
        ours.extend(sole.height(&to));
    }
    let (Some(theirs), Some(ours)) = (
        stats::percentile(&theirs, GROUND_PERCENTILE),
        stats::percentile(&ours, GROUND_PERCENTILE),
    ) else {
        return 0.0;
    };
    let reach = MAX_GROUND_DISTANCE * roles.leg_length(skeleton).unwrap_or(0.0);
    let ground = if theirs.abs() < reach { 0.0 } else { theirs * scale };
    let lift = ground - ours;
    if lift.is_finite() { lift } else { 0.0 }
}

/// The lowest vertices of a character's feet, each with the joint that it follows most.
struct Sole {
    points: Vec<(usize, Vec3)>,
}

impl Sole {
    fn of(character: &Character) -> Self {
        let mesh = &character.mesh;
        let roles = &character.roles;
        let feet: Vec<usize> = (Side::BOTH.into_iter())
            .flat_map(|side| [roles.get(Role::foot(side)), roles.get(Role::toe(side))])
            .flatten()
            .collect();
        let vertices = mesh.positions.iter().zip(&mesh.joints);
        let mut points: Vec<(usize, Vec3)> = vertices
            .filter_map(|(&position, joints)| {
                let joint = usize::from(*joints.first()?);
                let in_joint = mesh.bind.get(joint)?.point(position);
                feet.contains(&joint).then_some((joint, in_joint))
            })
            .collect();
        // Joints have no rotation at rest, so the direction down is the same in all of their
        // frames; the lowest vertices at rest, over the whole foot.
        let rest = character.skeleton.rest_positions();
        sort_by(&mut points, |x, y| (rest[x.0] + x.1).y.total_cmp(&(rest[y.0] + y.1).y));
        // Evenly spaced ones of the lower half: heel, ball and tips.
        points.truncate(points.len() / 2);
        let step = points.len().div_ceil(SOLE_VERTICES).max(1);
        Self { points: points.into_iter().step_by(step).collect() }
    }

    fn height(&self, pose: &WorldPose) -> Option<f32> {
        let height = |&(joint, point): &(usize, Vec3)| {
            Some((*pose.positions.get(joint)? + *pose.rotations.get(joint)? * point).y)
        };
        self.points.iter().filter_map(height).min_by(f32::total_cmp)
    }
}
