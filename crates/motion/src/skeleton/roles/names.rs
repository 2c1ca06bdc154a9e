//! Roles by the names of joints.

use super::tokens::{self, Tokens};
use super::{RoleSource, Roles, is_below};
use crate::skeleton::{Role, Side, Skeleton};

/// The words for a part of the body, in groups: a word of an earlier group takes precedence over
/// those of later ones.
type Vocabulary = &'static [&'static [&'static str]];

const HIPS: Vocabulary = &[&["hips", "pelvis", "hip"], &["root"]];
const SPINE: Vocabulary = &[&[
    "spine",
    "lowerback",
    "lowerspine",
    "spinelower",
    "back",
    "abdomen",
    "abdomenlower",
    "ab",
    "waist",
    "torso",
    "stomach",
    "belly",
    "chest",
    "thorax",
    "upperback",
    "upperspine",
]];
const HEAD: Vocabulary = &[&["head", "skull"]];
// A lone "LeftHip" is the thigh, but beside "LeftUpLeg" it is the bone that leads there (CMU);
// "LeftLeg" is the shin, unless a "LeftKnee" follows it.
const THIGH: Vocabulary = &[&["thigh", "upleg", "upperleg", "uleg", "femur"], &["hip"], &["leg"]];
const SHIN: Vocabulary =
    &[&["shin", "calf", "lowerleg", "lowleg", "tibia", "shank", "knee"], &["leg"]];
// In SMPL, "L_Ankle" has a child "L_Foot", which is the ball of the foot. The same holds for
// "L_Wrist" and "L_Hand", and for "lwrist" and "lhand" in CMU's ASF.
const FOOT: Vocabulary = &[&["ankle"], &["foot"]];
const TOE: Vocabulary = &[&["toe", "toes", "ball"], &["foot"]];
// "LeftShoulder" is the upper arm only where no "LeftArm" follows it.
const UPPER_ARM: Vocabulary =
    &[&["upperarm", "uparm", "uarm", "humerus"], &["arm"], &["shoulder", "shldr"]];
const FOREARM: Vocabulary = &[&["forearm", "lowerarm", "lowarm", "farm", "radius", "elbow"]];
const HAND: Vocabulary = &[&["wrist"], &["hand"]];

/// The greatest number of limbs of one name on one side of a body with the limbs of a person; a
/// second one may be a control without a telling name.
const MAX_EQUAL_LIMBS: usize = 2;

pub(super) fn detect(skeleton: &Skeleton) -> Roles {
    let names: Vec<Tokens> = skeleton.joints().iter().map(|j| tokens::read(&j.name)).collect();
    let search = Search { skeleton, names: &names, depths: depths(skeleton) };
    let mut roles = Roles::default();
    let hips = search.best(HIPS, None, None);
    roles.assign(Role::Hips, hips, RoleSource::ByName);
    let spine = search.best(SPINE, None, hips).or_else(|| search.lumbar(hips));
    roles.assign(Role::Spine, spine, RoleSource::ByName);
    roles.assign(Role::Head, search.best(HEAD, None, spine.or(hips)), RoleSource::ByName);
    for side in Side::BOTH {
        let leg = Role::leg(side).into_iter().zip([THIGH, SHIN, FOOT, TOE]);
        let arm = Role::arm(side).into_iter().zip([UPPER_ARM, FOREARM, HAND]);
        for limb in [leg.collect::<Vec<_>>(), arm.collect()] {
            let mut above = None;
            let [(_, first), ..] = limb.as_slice() else { continue };
            if search.is_ambiguous(first, side) {
                continue;
            }
            for (role, words) in limb {
                let joint = search.best(words, Some(side), above);
                roles.assign(role, joint, RoleSource::ByName);
                above = joint.or(above);
            }
        }
    }
    roles
}

struct Search<'a> {
    skeleton: &'a Skeleton,
    names: &'a [Tokens],
    depths: Vec<usize>,
}

impl Search<'_> {
    /// Returns the joint of that side, below `above`, with the best word; of several the one
    /// nearest the root.
    fn best(&self, words: Vocabulary, side: Option<Side>, above: Option<usize>) -> Option<usize> {
        self.ranked(words, side, above).min().map(|(_, _, joint)| joint)
    }

    /// Returns whether a side has several limbs of the kind of `words`, as spiders have legs: none
    /// of them is the limb of a person.
    fn is_ambiguous(&self, words: Vocabulary, side: Side) -> bool {
        let best = self.ranked(words, Some(side), None).map(|(rank, depth, _)| (rank, depth)).min();
        let equal = self.ranked(words, Some(side), None);
        equal.filter(|&(rank, depth, _)| Some((rank, depth)) == best).count() > MAX_EQUAL_LIMBS
    }

    /// Returns the joints of that side, below `above`, with one of the words: its rank, their depth
    /// in the tree and their index.
    fn ranked(
        &self,
        words: Vocabulary,
        side: Option<Side>,
        above: Option<usize>,
    ) -> impl Iterator<Item = (usize, usize, usize)> {
        let rank = move |joint: usize, tokens: &Tokens| {
            if tokens.helper
                || tokens.side != side
                || above.is_some_and(|above| !is_below(self.skeleton, joint, above))
            {
                return None;
            }
            let group = |core: &str| words.iter().position(|group| group.contains(&core));
            // "torso_head" is taken as the base of the head, if no joint is called "head" itself.
            group(&tokens.core).or_else(|| group(&tokens.last).map(|g| g + words.len()))
        };
        self.names.iter().enumerate().filter_map(move |(joint, tokens)| {
            Some((rank(joint, tokens)?, self.depths[joint], joint))
        })
    }

    /// Returns the lowest joint of the back in Xsens files, which is named after its vertebra:
    /// `L5`.
    fn lumbar(&self, hips: Option<usize>) -> Option<usize> {
        self.names.iter().enumerate().find_map(|(joint, t)| {
            let is = t.core.is_empty()
                && t.side == Some(Side::Left)
                && matches!(t.numbers.as_slice(), [n] if n == "5");
            (is && hips.is_none_or(|hips| is_below(self.skeleton, joint, hips))).then_some(joint)
        })
    }
}

/// Returns the number of joints above each joint.
fn depths(skeleton: &Skeleton) -> Vec<usize> {
    let mut depths: Vec<usize> = Vec::with_capacity(skeleton.len());
    for joint in skeleton.joints() {
        depths.push(joint.parent.map_or(0, |parent| depths[parent] + 1));
    }
    depths
}
