//! Roles by the names of joints.

use super::tokens::{self, Hinge, Tokens};
use super::{RoleSource, Roles, is_below};
use crate::skeleton::{Joint, Role, Side, Skeleton};

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
const THIGH: Vocabulary =
    &[&["thigh", "upleg", "upperleg", "uleg", "femur"], &["hip"], &["leg"], &[HIND_LEG]];
const SHIN: Vocabulary = &[
    &["shin", "calf", "lowerleg", "lowleg", "tibia", "shank", "knee"],
    &["leg"],
    &["stifle"],
    &[HIND_LEG],
];
// In SMPL, "L_Ankle" has a child "L_Foot", which is the ball of the foot. The same holds for
// "L_Wrist" and "L_Hand", and for "lwrist" and "lhand" in CMU's ASF.
const FOOT: Vocabulary = &[&["ankle"], &["foot"], &["hock"], &[HIND_LEG], &["paw", "hoof"]];
const TOE: Vocabulary = &[&["toe", "toes", "ball"], &["foot"], &["fetlock"], &["paw", "hoof"]];
// "LeftShoulder" is the upper arm only where no "LeftArm" follows it.
const UPPER_ARM: Vocabulary =
    &[&["upperarm", "uparm", "uarm", "humerus"], &["arm"], &["shoulder", "shldr"], &[FORELEG]];
const FOREARM: Vocabulary =
    &[&["forearm", "lowerarm", "lowarm", "farm", "radius", "elbow"], &[FORELEG]];
const HAND: Vocabulary = &[&["wrist"], &["hand"], &["cannon"], &[FORELEG], &["paw", "hoof"]];

/// The words for joints of a foreleg and of a hind leg whose names say no more: `FrontLeg2`.
const FORELEG: &str = "foreleg";
const HIND_LEG: &str = "hindleg";
/// The words of a leg's joints, and those of an arm's joints in the same places.
const LEG_TO_ARM: [(&str, &str); 17] = [
    ("upperleg", "upperarm"),
    ("upleg", "upperarm"),
    ("uleg", "upperarm"),
    ("thigh", "upperarm"),
    ("hip", "shoulder"),
    ("lowerleg", "forearm"),
    ("lowleg", "forearm"),
    ("shin", "forearm"),
    ("calf", "forearm"),
    ("knee", "forearm"),
    ("ankle", "wrist"),
    ("foot", "hand"),
    ("paw", "paw"),
    ("hoof", "hoof"),
    ("toe", "finger"),
    ("toes", "finger"),
    ("leg", FORELEG),
];
/// The words of legs, without which words for the front say nothing: a `forefoot` of a person is
/// the ball of the foot.
const LEGS: [&str; 7] = ["upperleg", "upleg", "uleg", "thigh", "lowerleg", "lowleg", "leg"];
/// The words that tell the pairs of legs of a body on four legs.
const FRONT: [&str; 2] = ["front", "fore"];
const BEHIND: [&str; 3] = ["hind", "back", "rear"];

/// The greatest number of limbs of one name on one side of a body with the limbs of a person; a
/// second one may be a control without a telling name.
const MAX_EQUAL_LIMBS: usize = 2;

/// The fewest joints named as those that deform the body (`DEF-spine`) for which all others are
/// controls.
const MIN_DEFORMING: usize = 8;
/// The fewest bones of the back above the arms of which the last one is the head.
const MIN_NECK: usize = 2;

pub(super) fn detect(skeleton: &Skeleton) -> Roles {
    let search = Search::of(skeleton);
    let mut limbs = Roles::default();
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
                // The hinges of a hip are apart: the leg is as long as from the first one.
                let is_hip = role == Role::thigh(side);
                let joint = joint.map(|at| if is_hip { at } else { search.last_hinge(at) });
                limbs.assign(role, joint, RoleSource::ByName);
                above = joint.or(above);
            }
        }
    }
    let mut roles = limbs;
    let hips = search.hips(&roles);
    roles.assign(Role::Hips, hips, RoleSource::ByName);
    let spine = search.best(SPINE, None, hips).or_else(|| search.lumbar(hips));
    roles.assign(Role::Spine, spine, RoleSource::ByName);
    let head = search.best(HEAD, None, spine.or(hips)).or_else(|| search.end_of_back(&roles));
    roles.assign(Role::Head, head, RoleSource::ByName);
    roles
}

/// Gives the forelegs of a body whose names tell front and hind legs apart the words of arms, and
/// its hind legs those of legs: `FrontUpperLeg.L`, `HindLeg1.L`, `LeftForeLowerLeg`.
fn rename_four_legs(names: &mut [Option<Tokens>]) {
    let part_of = |core: &str, words: &[&str]| {
        let rest = |word: &&str| core.strip_prefix(word).or_else(|| core.strip_suffix(word));
        let rest = words.iter().find_map(rest)?;
        LEG_TO_ARM.into_iter().find(|(leg, _)| *leg == rest)
    };
    let is_foreleg =
        |name: &&Tokens| part_of(&name.core, &FRONT).is_some_and(|(leg, _)| LEGS.contains(&leg));
    if names.iter().flatten().filter(is_foreleg).count() < Side::BOTH.len() {
        return;
    }
    for name in names.iter_mut().flatten() {
        let word = match (part_of(&name.core, &FRONT), part_of(&name.core, &BEHIND)) {
            (Some((_, arm)), _) => arm,
            (None, Some(("leg", _))) => HIND_LEG,
            (None, Some((leg, _))) => leg,
            (None, None) => continue,
        };
        word.clone_into(&mut name.core);
        word.clone_into(&mut name.last);
    }
}

struct Search<'a> {
    skeleton: &'a Skeleton,
    /// The parts of the names; `None` for joints that are no parts of the body.
    names: Vec<Option<Tokens>>,
    depths: Vec<usize>,
    /// Whether the joints are a robot's, which has a hinge for each axis.
    is_hinged: bool,
}

impl<'a> Search<'a> {
    fn of(skeleton: &'a Skeleton) -> Self {
        let mut names: Vec<Option<Tokens>> =
            skeleton.joints().iter().map(|joint| Some(tokens::read(&joint.name))).collect();
        let deforms = |joint: &Joint| {
            let prefix = joint.name.rsplit(':').next().and_then(|name| name.split_at_checked(4));
            prefix.is_some_and(|(prefix, _)| {
                prefix.to_ascii_lowercase().starts_with("def")
                    && !prefix.ends_with(char::is_alphanumeric)
            })
        };
        if skeleton.joints().iter().filter(|joint| deforms(joint)).count() >= MIN_DEFORMING {
            for (name, joint) in names.iter_mut().zip(skeleton.joints()) {
                *name = name.take().filter(|_| deforms(joint));
            }
        }
        let has = |hinge| names.iter().flatten().any(|name| name.hinge == Some(hinge));
        let is_hinged = [Hinge::Roll, Hinge::Pitch, Hinge::Yaw].into_iter().all(has);
        if is_hinged {
            for name in names.iter_mut().flatten().filter(|name| name.hinge.is_some()) {
                name.helper = false;
                for word in ["pitch", "yaw"] {
                    if let Some(part) = name.core.strip_suffix(word) {
                        name.core = part.to_owned();
                    }
                }
            }
        }
        rename_four_legs(&mut names);
        Self { skeleton, names, depths: depths(skeleton), is_hinged }
    }

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
            Some((rank(joint, tokens.as_ref()?)?, self.depths[joint], joint))
        })
    }

    /// Returns the hips. Where no joint is called so, or only a root is, they are the bone of the
    /// back from which both legs hang, as `DEF-spine` of Rigify.
    fn hips(&self, limbs: &Roles) -> Option<usize> {
        let best = self.ranked(HIPS, None, None).min();
        if let Some((0, _, hips)) = best {
            return Some(hips);
        }
        let of_legs = self.meeting(limbs, Role::thigh).filter(|&joint| self.is_of_back(joint));
        of_legs.or(best.map(|(_, _, joint)| joint))
    }

    /// Returns the last bone of the back above the arms, which is the head where none is called so:
    /// `DEF-spine.006` of Rigify.
    fn end_of_back(&self, limbs: &Roles) -> Option<usize> {
        let chest = self.meeting(limbs, Role::upper_arm)?;
        let above =
            |&joint: &usize| self.is_of_back(joint) && is_below(self.skeleton, joint, chest);
        let neck: Vec<usize> = (0..self.names.len()).filter(above).collect();
        let last = neck.iter().copied().max_by_key(|&joint| self.depths[joint]);
        last.filter(|_| neck.len() >= MIN_NECK)
    }

    /// Returns whether a joint is named as those of the back.
    fn is_of_back(&self, joint: usize) -> bool {
        self.names[joint].as_ref().is_some_and(|name| {
            !name.helper && name.side.is_none() && SPINE[0].contains(&name.core.as_str())
        })
    }

    /// Returns the lowest joint that is above the limbs of both sides.
    fn meeting(&self, limbs: &Roles, role: impl Fn(Side) -> Role) -> Option<usize> {
        let [left, right] = Side::BOTH.map(|side| limbs.get(role(side)));
        let (left, right) = (left?, right?);
        std::iter::successors(self.skeleton.parent(left), |&joint| self.skeleton.parent(joint))
            .find(|&joint| is_below(self.skeleton, right, joint))
    }

    /// Returns the last of a robot's hinges that turn the same part of the body, which has the
    /// rotation of all of them; the joint itself in other skeletons.
    fn last_hinge(&self, joint: usize) -> usize {
        let is_same_part = |one: usize, other: usize| {
            let [Some(one), Some(other)] = [&self.names[one], &self.names[other]] else {
                return false;
            };
            one.hinge.is_some()
                && other.hinge.is_some()
                && (one.side, &one.core) == (other.side, &other.core)
        };
        let mut last = joint;
        while self.is_hinged
            && let Some(next) = self.skeleton.children(last).find(|&next| is_same_part(last, next))
        {
            last = next;
        }
        last
    }

    /// Returns the lowest joint of the back in Xsens files, which is named after its vertebra:
    /// `L5`.
    fn lumbar(&self, hips: Option<usize>) -> Option<usize> {
        self.names.iter().enumerate().find_map(|(joint, name)| {
            let name = name.as_ref()?;
            let is = name.core.is_empty()
                && name.side == Some(Side::Left)
                && matches!(name.numbers.as_slice(), [n] if n == "5");
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
