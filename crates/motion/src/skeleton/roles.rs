//! The roles of a skeleton's joints: found by name, otherwise by shape, and corrected by hand.

mod names;
mod numbers;
mod plan;
#[cfg(test)]
mod rig_tests;
mod shape;
#[cfg(test)]
mod tests;
mod tokens;

use super::{BodyPlan, Foot, Role, Side, Skeleton, WorldPose};
use glam::Vec3;
use std::collections::BTreeMap;
pub(crate) use tokens::{Tokens, are_counterparts, is_control, read};

/// The evidence for the joint of a role; the most trustworthy first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum RoleSource {
    /// Chosen by the user.
    ByHand,
    /// Stated by the file, as the bone map of a VRM.
    ByFile,
    /// By the joint's name.
    ByName,
    /// By the skeleton's shape at rest.
    ByShape,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
struct RoleJoint {
    joint: usize,
    found: RoleSource,
}

/// At most one joint per [`Role`], and the [`BodyPlan`].
///
/// It is stored (serde) as a map from role to joint index; that of a quadruped has its plan, too.
/// The indices belong to one skeleton. Since roles may come from outside, every user of them treats
/// an index that the skeleton does not have as a missing role.
///
/// ```
/// use segue_motion::skeleton::{Joint, Role, Roles, Skeleton};
///
/// let joint = |name: &str, parent| {
///     let offset = glam::Vec3::NEG_Y;
///     Joint { name: name.into(), parent, offset, end_site: None, channels: vec![] }
/// };
/// let leg = Skeleton::new(vec![
///     joint("Hips", None),
///     joint("LeftUpLeg", Some(0)),
///     joint("LeftLeg", Some(1)),
///     joint("LeftFoot", Some(2)),
/// ])?;
/// let roles = Roles::detect(&leg);
/// assert_eq!(roles.get(Role::LeftShin), Some(2));
/// assert_eq!(roles.get(Role::RightShin), None);
/// # Ok::<(), segue_motion::skeleton::SkeletonError>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(from = "StoredRoles", into = "StoredRoles")]
pub struct Roles {
    assigned: [Option<RoleJoint>; Role::COUNT],
    plan: BodyPlan,
}

/// The form in which roles are stored.
#[derive(serde::Serialize, serde::Deserialize)]
struct StoredRoles {
    #[serde(default, skip_serializing_if = "is_biped")]
    plan: BodyPlan,
    #[serde(flatten)]
    joints: BTreeMap<Role, RoleJoint>,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde asks for a reference")]
fn is_biped(plan: &BodyPlan) -> bool {
    *plan == BodyPlan::Biped
}

impl From<StoredRoles> for Roles {
    fn from(stored: StoredRoles) -> Self {
        let mut roles = Self { plan: stored.plan, ..Self::default() };
        for (role, assigned) in stored.joints {
            roles.assigned[role.index()] = Some(assigned);
        }
        roles
    }
}

impl From<Roles> for StoredRoles {
    fn from(roles: Roles) -> Self {
        let joint = |role: Role| Some((role, roles.assigned[role.index()]?));
        Self { plan: roles.plan, joints: Role::ALL.into_iter().filter_map(joint).collect() }
    }
}

impl Roles {
    /// Finds the roles of a skeleton by the names of its joints, and the remaining ones by its
    /// shape at rest.
    ///
    /// Names: whole words are compared, without regard to case, after side (`left`, `L_`, `.L`,
    /// `lFemur`, …), name space (`mixamorig:`) and numbers are removed; CMU (ASF and BVH), Mixamo,
    /// `LaFAN1`, Bandai-Namco, Biped, SMPL, SOMA, `OptiTrack`, Rokoko, Xsens, Vicon, Perception
    /// Neuron, Unreal, Unity, VRM, Rigify, DAZ, Character Creator and Unitree rigs are covered; the
    /// joints of SMPL by their numbers, too.
    /// Shape: needs Y up and arms that are not folded over the legs; left and right follow from the
    /// toes, which point forward.
    ///
    /// Where the rest pose stands on four legs below a level trunk, the body is a
    /// [quadruped](BodyPlan::Quadruped); of a rest pose that does not show it, the frames of a clip
    /// do ([`Roles::with_plan_of`]).
    #[must_use]
    pub fn detect(skeleton: &Skeleton) -> Self {
        let mut roles = Self::by_name(skeleton);
        if roles.count() < Role::COUNT {
            roles.fill(skeleton, &shape::detect(skeleton));
        }
        roles.plan = plan::at_rest(skeleton, &roles);
        roles
    }

    /// Finds roles by the names of joints alone, whatever the rest pose. See [`Self::detect`].
    #[must_use]
    pub fn by_name(skeleton: &Skeleton) -> Self {
        let roles = names::detect(skeleton);
        if roles.count() == 0 { numbers::detect(skeleton) } else { roles }
    }

    /// Returns the roles that a file states, and where it states none, those that [`Self::detect`]
    /// finds and that fit the stated ones.
    ///
    /// A stated joint that the skeleton does not have is ignored; of several joints for one role,
    /// or roles for one joint, the first counts.
    #[must_use]
    pub fn detect_beside(skeleton: &Skeleton, stated: &[(Role, usize)]) -> Self {
        let mut roles = Self::default();
        for &(role, joint) in stated {
            if joint < skeleton.len() && roles.get(role).is_none() && roles.role_of(joint).is_none()
            {
                roles.assign(role, Some(joint), RoleSource::ByFile);
            }
        }
        roles.fill(skeleton, &Self::detect(skeleton));
        roles.plan = plan::at_rest(skeleton, &roles);
        roles
    }

    /// Returns the number of legs on which the body stands.
    #[must_use]
    pub fn body_plan(&self) -> BodyPlan {
        self.plan
    }

    /// Returns the same roles of a body that stands on this number of legs.
    #[must_use]
    pub fn with_body_plan(self, plan: BodyPlan) -> Self {
        Self { plan, ..self }
    }

    /// Returns whether the body stands on four legs, so that the roles of arms are those of its
    /// forelegs.
    #[must_use]
    pub fn is_quadruped(&self) -> bool {
        self.plan == BodyPlan::Quadruped
    }

    /// Returns the same roles with the body plan that the rest pose or these poses show; a body
    /// that is known to be a quadruped stays one.
    ///
    /// A quadruped has a trunk that is long beside its legs; at rest, or in half of the poses, it
    /// is level, and all four legs point down from it to one level. A tenth of the poses is enough
    /// where none stands upright: animals sit and lie. A person who crawls has a shorter trunk.
    /// Poses are asked for only where the rest pose stands on neither, and the trunk is long
    /// enough.
    #[must_use]
    pub fn with_plan_of(
        self,
        skeleton: &Skeleton,
        poses: impl IntoIterator<Item = WorldPose>,
    ) -> Self {
        if self.is_quadruped() {
            return self;
        }
        let plan = plan::of(skeleton, &self, poses);
        self.with_body_plan(plan)
    }

    /// Returns the roles in a skeleton that has the same joints in another order: `joint_from_own`
    /// is the new index of each joint. Roles of joints beyond its end are lost.
    #[must_use]
    pub fn renumbered(&self, joint_from_own: &[usize]) -> Self {
        let mut roles = Self::default().with_body_plan(self.plan);
        for role in Role::ALL {
            let Some(assigned) = self.assigned[role.index()] else {
                continue;
            };
            let joint = joint_from_own.get(assigned.joint).copied();
            if joint.is_some_and(|joint| roles.role_of(joint).is_none()) {
                roles.assign(role, joint, assigned.found);
            }
        }
        roles
    }

    /// Adds the missing roles of `other` that do not contradict the present ones.
    fn fill(&mut self, skeleton: &Skeleton, other: &Self) {
        for role in Role::ALL {
            let Some(candidate) = other.assigned[role.index()] else {
                continue;
            };
            if self.assigned[role.index()].is_none()
                && self.role_of(candidate.joint).is_none()
                && self.fits(skeleton, role, candidate.joint)
            {
                self.assigned[role.index()] = Some(candidate);
            }
        }
    }

    /// Returns whether `joint` is above or below the limb's other joints in the tree as `role`
    /// requires.
    fn fits(&self, skeleton: &Skeleton, role: Role, joint: usize) -> bool {
        let Some(side) = role.side() else { return true };
        let (leg, arm) = (Role::leg(side), Role::arm(side));
        let chain: &[Role] = if leg.contains(&role) { &leg } else { &arm };
        let place = chain.iter().position(|&r| r == role);
        chain.iter().enumerate().all(|(other_place, &other)| match self.get(other) {
            Some(found) if Some(other_place) < place => is_below(skeleton, joint, found),
            Some(found) => is_below(skeleton, found, joint),
            None => true,
        })
    }

    /// Returns the joint of a role.
    #[must_use]
    pub fn get(&self, role: Role) -> Option<usize> {
        self.assigned[role.index()].map(|a| a.joint)
    }

    /// Returns the joint of a role, if a skeleton of `joints` joints has it.
    #[must_use]
    pub fn get_within(&self, role: Role, joints: usize) -> Option<usize> {
        self.get(role).filter(|&joint| joint < joints)
    }

    /// Returns the evidence for the joint of a role; `None` for a role without a joint.
    #[must_use]
    pub fn source(&self, role: Role) -> Option<RoleSource> {
        self.assigned[role.index()].map(|a| a.found)
    }

    /// Sets by hand the joint of a role, or that it has none. A joint that had another role loses
    /// that one.
    pub fn set(&mut self, role: Role, joint: Option<usize>) {
        if let Some(previous) = joint.and_then(|joint| self.role_of(joint)) {
            self.assigned[previous.index()] = None;
        }
        self.assigned[role.index()] =
            joint.map(|joint| RoleJoint { joint, found: RoleSource::ByHand });
    }

    fn assign(&mut self, role: Role, joint: Option<usize>, found: RoleSource) {
        self.assigned[role.index()] = joint.map(|joint| RoleJoint { joint, found });
    }

    /// Returns the role of a joint.
    #[must_use]
    pub fn role_of(&self, joint: usize) -> Option<Role> {
        Role::ALL.into_iter().find(|&role| self.get(role) == Some(joint))
    }

    /// Returns the number of roles that have a joint, at most [`Role::COUNT`].
    #[must_use]
    pub fn count(&self) -> usize {
        self.assigned.iter().flatten().count()
    }

    /// Returns the roles that have no joint.
    pub fn missing(&self) -> impl Iterator<Item = Role> + '_ {
        Role::ALL.into_iter().filter(|&role| self.get(role).is_none())
    }

    /// Returns the points of a foot that can touch the ground: ankle, ball and tip, as far as the
    /// skeleton has them, each as a joint and a point in its frame (metres). Of a forefoot they are
    /// the end of the leg, the next joint and the tip.
    #[must_use]
    pub fn foot_points(&self, skeleton: &Skeleton, foot: impl Into<Foot>) -> Vec<(usize, Vec3)> {
        self.points_of_foot(skeleton, foot.into()).into_iter().flatten().collect()
    }

    /// Returns the points of [`foot_points`](Self::foot_points), each in its place; `None` where
    /// the skeleton has no such point.
    pub(crate) fn points_of_foot(
        &self,
        skeleton: &Skeleton,
        foot: Foot,
    ) -> [Option<(usize, Vec3)>; 3] {
        plan::points_of(skeleton, self, foot)
    }

    /// Returns the joint by which a foot's movement over the ground is told: its ball, the ankle
    /// where it has none.
    #[must_use]
    pub fn ball_or_ankle(&self, skeleton: &Skeleton, foot: Foot) -> Option<usize> {
        let [ankle, ball, _] = self.points_of_foot(skeleton, foot);
        ball.or(ankle).map(|(joint, _)| joint)
    }

    /// Returns the length of a leg from hip joint over knee to ankle, metres: the mean of both
    /// sides. `None` without a complete leg. It is the sum of bone lengths, so that it does not
    /// depend on the rest pose.
    #[must_use]
    pub fn leg_length(&self, skeleton: &Skeleton) -> Option<f32> {
        let joint = |role| self.get_within(role, skeleton.len());
        let legs: Vec<f32> = Side::BOTH
            .into_iter()
            .filter_map(|side| {
                let (hip, knee, ankle) =
                    (joint(Role::thigh(side))?, joint(Role::shin(side))?, joint(Role::foot(side))?);
                Some(length_between(skeleton, hip, knee)? + length_between(skeleton, knee, ankle)?)
            })
            .filter(|&length| length > 0.0)
            .collect();
        (!legs.is_empty()).then(|| legs.iter().sum::<f32>() / legs.len() as f32)
    }

    /// Returns the character's height standing upright, metres: thigh and shin are 0.491 of it
    /// (Winter, "Biomechanics and Motor Control of Human Movement", table 4.1). Without legs it is
    /// the longest path along bones, and without any length 1. Only bone lengths count, which no
    /// rest pose changes.
    #[must_use]
    pub fn body_height(&self, skeleton: &Skeleton) -> f32 {
        if let Some(leg) = self.leg_length(skeleton) {
            return leg / 0.491;
        }
        let longest = longest_path(skeleton);
        if longest > 0.0 { longest } else { 1.0 }
    }
}

/// Returns the sum of bone lengths from a joint down to one below it; `None` where it is not below.
fn length_between(skeleton: &Skeleton, above: usize, below: usize) -> Option<f32> {
    let mut length = 0.0;
    let mut joint = below;
    while joint != above {
        length += skeleton.joints().get(joint)?.offset.length();
        joint = skeleton.parent(joint)?;
    }
    Some(length)
}

/// Returns the length of the longest path along bones between two ends of the tree.
fn longest_path(skeleton: &Skeleton) -> f32 {
    let mut deepest = vec![0.0_f32; skeleton.len()];
    let mut longest = 0.0_f32;
    // Children come after their parents: in reverse order, the paths below a joint are known.
    for (index, joint) in skeleton.joints().iter().enumerate().rev() {
        if let Some(end) = joint.end_site {
            longest = longest.max(deepest[index] + end.length());
            deepest[index] = deepest[index].max(end.length());
        }
        if let Some(parent) = joint.parent {
            let branch = deepest[index] + joint.offset.length();
            longest = longest.max(deepest[parent] + branch);
            deepest[parent] = deepest[parent].max(branch);
        }
    }
    longest
}

/// Returns whether `joint` lies below `above` in the tree, and is not that joint itself.
pub(crate) fn is_below(skeleton: &Skeleton, joint: usize, above: usize) -> bool {
    std::iter::successors(skeleton.parent(joint), |&j| skeleton.parent(j)).any(|j| j == above)
}
