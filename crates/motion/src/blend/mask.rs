//! Masks: weights of joints for parts of the body.

use crate::skeleton::{Role, Roles, Side, Skeleton};

/// A part of the body, in any rig.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[expect(missing_docs, reason = "the type's text and the names explain them")]
pub enum BodyPart {
    /// The whole body.
    Whole,
    /// The lowest joint of the spine that carries no leg, and all joints below it in the tree.
    UpperBody,
    /// All other joints: the root, the hips and the legs.
    LowerBody,
    /// From the collar bone outwards.
    LeftArm,
    RightArm,
    /// From the neck upwards.
    Head,
    /// From the lowest joint of the spine to the chest, without arms and head.
    Spine,
}

impl BodyPart {
    /// All parts, for a list of choices.
    pub const ALL: [Self; 7] = [
        Self::Whole,
        Self::UpperBody,
        Self::LowerBody,
        Self::LeftArm,
        Self::RightArm,
        Self::Head,
        Self::Spine,
    ];
}

/// Returns the weight of every joint of a skeleton, 0 to 1, for a set of parts; the larger weight
/// where parts overlap.
///
/// `feather` is the number of joints over which a part fades in along the tree from its first
/// joint: with 3, the first four joints of the spine have weights 1/4, 2/4, 3/4 and 1. The lower
/// body fades out over the same joints, so that the weights of lower and upper body sum to 1
/// everywhere. The whole body has no border. A part without known roles is empty.
#[must_use]
pub fn mask(skeleton: &Skeleton, roles: &Roles, parts: &[BodyPart], feather: usize) -> Vec<f32> {
    let body = Body::new(skeleton, roles);
    let mut weights = vec![0.0_f32; skeleton.len()];
    for &part in parts {
        for (joint, weight) in weights.iter_mut().enumerate() {
            *weight = weight.max(body.weight(part, joint, feather));
        }
    }
    weights
}

/// The joints at which the parts begin.
struct Body<'a> {
    skeleton: &'a Skeleton,
    upper: Vec<usize>,
    arms: [Option<usize>; 2],
    head: Option<usize>,
    /// The joint that carries the arms, or the head.
    chest: Option<usize>,
}

impl<'a> Body<'a> {
    fn new(skeleton: &'a Skeleton, roles: &Roles) -> Self {
        let joint = |role| roles.get_within(role, skeleton.len());
        let up = |from: usize| std::iter::successors(Some(from), |&joint| skeleton.parent(joint));
        let arms = Side::BOTH.map(|side| joint(Role::upper_arm(side)));
        let carries = |above: usize, joint: Option<usize>| {
            joint.is_some_and(|joint| up(joint).any(|j| j == above))
        };
        let ends = [arms[0], arms[1], joint(Role::Head)];
        // The lowest joint above two of the arms and the head.
        let chest = (0..skeleton.len())
            .rev()
            .find(|&above| ends.iter().filter(|&&end| carries(above, end)).count() >= 2);
        let below_chest = |end: Option<usize>| {
            let end = end?;
            up(end).take_while(|&joint| Some(joint) != chest).last()
        };
        let hips = joint(Role::Hips);
        let legs = Side::BOTH.map(|side| joint(Role::thigh(side)));
        let carries_leg = |above: usize| legs.iter().any(|&leg| carries(above, leg));
        // In some rigs the legs hang from the lowest joint of the spine, which then counts as a
        // second pelvis.
        let upper = match joint(Role::Spine).or(hips) {
            Some(lowest) if carries_leg(lowest) || Some(lowest) == hips => {
                skeleton.children(lowest).filter(|&child| !carries_leg(child)).collect()
            }
            spine => spine.into_iter().collect(),
        };
        Self { skeleton, upper, arms: arms.map(below_chest), head: below_chest(ends[2]), chest }
    }

    /// Returns the number of joints from the nearest of `tops` down to `joint`; `None` if it is
    /// below none of them.
    fn depth(&self, tops: &[usize], joint: usize) -> Option<usize> {
        std::iter::successors(Some(joint), |&joint| self.skeleton.parent(joint))
            .position(|joint| tops.contains(&joint))
    }

    fn weight(&self, part: BodyPart, joint: usize, feather: usize) -> f32 {
        let faded = |tops: &[usize]| {
            let depth = self.depth(tops, joint);
            depth.map_or(0.0, |depth| ((depth + 1) as f32 / (feather + 1) as f32).min(1.0))
        };
        let of = |top: Option<usize>| top.map_or(0.0, |top| faded(&[top]));
        match part {
            BodyPart::Whole => 1.0,
            BodyPart::UpperBody => faded(&self.upper),
            BodyPart::LowerBody => 1.0 - faded(&self.upper),
            BodyPart::LeftArm => of(self.arms[0]),
            BodyPart::RightArm => of(self.arms[1]),
            BodyPart::Head => of(self.head),
            BodyPart::Spine => {
                let carries_chest =
                    self.chest.is_some_and(|chest| self.depth(&[joint], chest).is_some());
                if carries_chest { faded(&self.upper) } else { 0.0 }
            }
        }
    }
}
