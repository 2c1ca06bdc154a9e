//! The rest pose: shapes of clusters, directions of bones, and anatomy from the roles of joints.

use super::body::Body;
use super::gaps::Track;
use crate::math::{quat, stats};
use crate::skeleton::{Role, Roles, Side, Skeleton};
use glam::{Mat3, Quat, Vec3};

/// The number of frames over which means are taken, spread over the motion.
const SAMPLES: usize = 400;

fn samples(frames: usize) -> impl Iterator<Item = usize> {
    let count = SAMPLES.min(frames);
    (0..count).map(move |index| index * frames / count)
}

/// Returns the median distance between two points; 0 if they are never seen together.
pub(super) fn median_length(from: &Track, to: &Track) -> f32 {
    let distances = from.known.iter().enumerate().filter_map(|(frame, _)| {
        let length = to.get(frame)?.distance(from.get(frame)?);
        length.is_finite().then_some(length)
    });
    stats::percentile(&distances.collect::<Vec<_>>(), 0.5).unwrap_or(0.0)
}

/// Points around a joint that move together.
pub(super) struct Cluster {
    /// Their mean offsets from the joint, in the orientation of one frame, at their median lengths.
    pub(super) shape: Vec<Vec3>,
    /// The rotation from that orientation, frame by frame.
    pub(super) rotations: Vec<Quat>,
    /// The frames in which it is known.
    pub(super) known: Vec<bool>,
}

impl Cluster {
    /// Returns the cluster of `members` around `centre`; `None` if it has no unique rotation in any
    /// frame.
    pub(super) fn of(centre: &Track, members: &[&Track], frames: usize) -> Option<Self> {
        let offset = |member: &Track, frame: usize| Some(member.get(frame)? - centre.get(frame)?);
        let seen = |frame: &usize| members.iter().filter(|m| offset(m, *frame).is_some()).count();
        let first = (0..frames).rev().max_by_key(seen)?;
        let pairs = |shape: &[Option<Vec3>], frame: usize| -> Vec<(Vec3, Vec3)> {
            let pair =
                |(at, member): (&Option<Vec3>, &&Track)| Some(((*at)?, offset(member, frame)?));
            shape.iter().zip(members).filter_map(pair).collect()
        };
        let shape: Vec<Option<Vec3>> = members.iter().map(|member| offset(member, first)).collect();
        let mut sums = vec![(Vec3::ZERO, 0.0_f32); members.len()];
        for frame in samples(frames) {
            let Some(turn) = quat::best_fit(&pairs(&shape, frame)) else { continue };
            for (sum, member) in sums.iter_mut().zip(members) {
                if let Some(offset) = offset(member, frame) {
                    *sum = (sum.0 + turn.conjugate() * offset, sum.1 + 1.0);
                }
            }
        }
        let shape: Vec<Option<Vec3>> = sums
            .iter()
            .zip(members)
            .map(|((sum, count), member)| {
                let mean = (*count > 0.0).then(|| *sum / *count)?;
                Some(mean.normalize_or_zero() * median_length(centre, member))
            })
            .collect();
        let mut known = Vec::with_capacity(frames);
        let mut rotations = Vec::with_capacity(frames);
        for frame in 0..frames {
            let found = quat::best_fit(&pairs(&shape, frame));
            known.push(found.is_some());
            rotations.push(found.unwrap_or(Quat::IDENTITY));
        }
        known.contains(&true).then(|| Self {
            shape: shape.into_iter().map(Option::unwrap_or_default).collect(),
            rotations,
            known,
        })
    }

    fn known_samples(&self) -> impl Iterator<Item = usize> + '_ {
        samples(self.known.len()).filter(|&frame| self.known[frame])
    }

    /// Returns the mean rotation of the shape in the parent's frame; the identity for a root.
    pub(super) fn mean_in(&self, above: &[Quat], parent: Option<usize>) -> Quat {
        if parent.is_none() {
            return Quat::IDENTITY;
        }
        quat::mean(
            self.known_samples().map(|frame| above[frame].conjugate() * self.rotations[frame]),
        )
    }

    /// Returns the mean of a world direction in the cluster's frame.
    fn mean_direction(&self, direction: impl Fn(usize) -> Option<Vec3>) -> Option<Vec3> {
        let seen = |frame: usize| Some(self.rotations[frame].conjugate() * direction(frame)?);
        self.known_samples().filter_map(seen).sum::<Vec3>().try_normalize()
    }
}

/// The axis about which a limb bends at its middle joint.
pub(super) struct Hinge {
    /// In the rest pose.
    pub(super) axis: Vec3,
    pub(super) is_knee: bool,
}

/// The parts of a body that are known from the roles of its joints.
pub(super) struct Anatomy {
    roles: Roles,
    pub(super) hips: Option<usize>,
    /// The joint at which the arms branch off.
    chest: Option<usize>,
    /// From the hips to the head.
    trunk: Vec<usize>,
    /// The joints of the two sides where they branch off from the hips and from the chest.
    thighs: Option<[usize; 2]>,
    shoulders: Option<[usize; 2]>,
}

impl Anatomy {
    pub(super) fn of(skeleton: &Skeleton) -> Self {
        let roles = Roles::by_name(skeleton);
        let chain = |joint: Option<usize>| -> Vec<usize> {
            std::iter::successors(joint, |&joint| skeleton.parent(joint)).collect()
        };
        // The last common ancestor of both sides, and the joints below it.
        let fork = |role: fn(Side) -> Role| {
            let [left, right] = Side::BOTH.map(|side| chain(roles.get(role(side))));
            let joint = *left.iter().find(|joint| right.contains(joint))?;
            let below = |chain: &[usize]| {
                let at = chain.iter().position(|&other| other == joint)?;
                chain.get(at.checked_sub(1)?).copied()
            };
            Some((joint, [below(&left)?, below(&right)?]))
        };
        let (hips, thighs) = fork(Role::thigh).unzip();
        let (chest, shoulders) = fork(Role::upper_arm).unzip();
        let hips = hips.or_else(|| roles.get(Role::Hips));
        let mut trunk = chain(roles.get(Role::Head).or(chest));
        match trunk.iter().position(|&joint| Some(joint) == hips) {
            Some(end) => trunk.truncate(end + 1),
            None => trunk.clear(),
        }
        trunk.reverse();
        Self { roles, hips, chest, trunk, thighs, shoulders }
    }

    /// Returns the rotation that takes the shape of a cluster to the T-pose; `None` without the
    /// roles that determine it.
    pub(super) fn cluster_rest(
        &self,
        joint: usize,
        cluster: &Cluster,
        body: &Body,
    ) -> Option<Quat> {
        let sides = if Some(joint) == self.chest {
            self.shoulders
        } else if Some(joint) == self.hips {
            self.thighs
        } else {
            None
        }?;
        let at = |side: usize| {
            let index = body.nodes[joint].children.iter().position(|&child| child == side)?;
            cluster.shape.get(index).copied()
        };
        let across = at(sides[0])? - at(sides[1])?;
        let up = cluster.mean_direction(|frame| self.upright(frame, body))?;
        let x = across.try_normalize()?;
        let z = x.cross(up).try_normalize()?;
        Some(Quat::from_mat3(&Mat3::from_cols(x, z.cross(x), z)).conjugate())
    }

    /// Returns the direction of the trunk in a frame: from hips to neck, otherwise from feet to
    /// hips.
    fn upright(&self, frame: usize, body: &Body) -> Option<Vec3> {
        let at = |joint: usize| body.nodes.get(joint)?.track.get(frame);
        let hips = at(self.hips?)?;
        if let [.., neck, _] = self.trunk.as_slice() {
            let top = if self.trunk.len() > 2 { *neck } else { *self.trunk.last()? };
            return (at(top)? - hips).try_normalize();
        }
        let feet = Side::BOTH.map(|side| self.roles.get(Role::foot(side)).and_then(at));
        let [left, right] = feet;
        (hips - left?.midpoint(right?)).try_normalize()
    }

    /// Returns the direction from right to left shoulder, and its share in the twist of a joint of
    /// the back; the remaining share is that of the hips.
    pub(super) fn across_trunk(
        &self,
        joint: usize,
        frame: usize,
        body: &Body,
    ) -> Option<(Vec3, f32)> {
        let place = self.trunk.iter().position(|&other| other == joint)?;
        let chest = self.trunk.iter().position(|other| Some(*other) == self.chest)?;
        if place == 0 || place > chest {
            return None;
        }
        let [left, right] = self.shoulders?.map(|side| body.nodes[side].track.get(frame));
        Some(((left? - right?).try_normalize()?, place as f32 / chest as f32))
    }

    /// Returns the axis about which the limb that begins at a joint bends.
    pub(super) fn hinge(&self, joint: usize) -> Option<Hinge> {
        match self.roles.role_of(joint)? {
            Role::LeftThigh | Role::RightThigh => Some(Hinge { axis: Vec3::X, is_knee: true }),
            // In a T-pose with palms down the forearms bend forward.
            Role::LeftUpperArm => Some(Hinge { axis: Vec3::NEG_Y, is_knee: false }),
            Role::RightUpperArm => Some(Hinge { axis: Vec3::Y, is_knee: false }),
            _ => None,
        }
    }

    /// Returns the direction of a bone in the T-pose.
    fn t_pose(&self, joint: usize, child: Option<usize>) -> Option<Vec3> {
        let role = self.roles.role_of(joint);
        let next = child.and_then(|child| self.roles.role_of(child));
        if let (Some(role), Some(next)) = (role, next) {
            for side in Side::BOTH {
                let [thigh, shin, foot, _] = Role::leg(side);
                if [(thigh, shin), (shin, foot)].contains(&(role, next)) {
                    return Some(Vec3::NEG_Y);
                }
                let [upper, fore, hand] = Role::arm(side);
                if [(upper, fore), (fore, hand)].contains(&(role, next)) {
                    return Some(if side == Side::Left { Vec3::X } else { Vec3::NEG_X });
                }
            }
        }
        let place = self.trunk.iter().position(|&other| other == joint)?;
        (self.trunk.get(place + 1).copied() == child && child.is_some()).then_some(Vec3::Y)
    }
}

/// Returns the direction of a bone in the rest pose: by roles, otherwise its mean direction in the
/// parent's frame; for a root, its first direction.
pub(super) fn rest_direction(
    joint: usize,
    direction: &impl Fn(usize) -> Option<Vec3>,
    above: &[Quat],
    body: &Body,
    anatomy: &Anatomy,
) -> Vec3 {
    let node = &body.nodes[joint];
    let by_role = || anatomy.t_pose(joint, node.children.first().copied());
    let mean = || match node.parent {
        None => (0..body.frames).find_map(direction),
        Some(_) => samples(body.frames)
            .filter_map(|frame| Some(above[frame].conjugate() * direction(frame)?))
            .sum::<Vec3>()
            .try_normalize()
            .or_else(|| {
                (0..body.frames)
                    .find_map(|frame| Some(above[frame].conjugate() * direction(frame)?))
            }),
    };
    by_role().or_else(mean).unwrap_or(Vec3::Y)
}
