//! The words of joint names.

use crate::skeleton::Side;

/// Words that make up joint names. Only runs that consist of these words entirely are split
/// (`leftupleg`, `lowerback`).
const WORDS: &[&str] = &[
    "ab", "abdomen", "ankle", "arm", "back", "ball", "base", "calf", "chest", "clavicle", "collar",
    "effector", "elbow", "end", "f", "femur", "finger", "fingers", "foot", "fore", "forearm",
    "hand", "head", "heel", "hip", "hips", "humerus", "index", "joint", "knee", "left", "leg",
    "low", "lower", "middle", "neck", "nub", "pelvis", "pinky", "radius", "right", "ring", "roll",
    "root", "shank", "shin", "shldr", "shoulder", "site", "spine", "thigh", "thorax", "thumb",
    "tibia", "tip", "toe", "toes", "top", "torso", "twist", "u", "up", "upper", "waist", "wrist",
];

/// Words that say nothing about the function of a joint.
const NOISE: &[&str] = &[
    "avg",
    "b",
    "base",
    "bend",
    "bind",
    "bip",
    "biped",
    "bn",
    "bone",
    "c",
    "cc",
    "character",
    "def",
    "j",
    "jnt",
    "joint",
    "jt",
    "link",
    "m",
    "mixamorig",
    "mot",
    "org",
    "rig",
    "sk",
    "skel",
    "stretch",
    "x",
];

/// Words of joints that move no part of the body.
const HELPERS: &[&str] = &[
    "effector", "end", "helper", "ik", "nub", "pole", "roll", "site", "target", "tip", "top",
    "twist",
];

/// Words of joints that control others or share their twist, and lead to no end of the body.
const CONTROLS: &[&str] = &["effector", "helper", "ik", "pole", "roll", "target", "twist"];

/// Returns whether a joint's name is that of a control: an IK target, or a helper that shares the
/// twist of a limb.
pub(crate) fn is_control(name: &str) -> bool {
    let name = name.rsplit(':').next().unwrap_or(name);
    let parts = name.split(|c: char| !c.is_alphanumeric()).filter(|part| !part.is_empty());
    let mut all = parts.flat_map(split_by_case).flat_map(|run| words(&run));
    all.any(|word| CONTROLS.contains(&word.as_str()))
}

/// The parts of a joint's name.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Tokens {
    /// The side in the name, if it contains one side only.
    pub(crate) side: Option<Side>,
    /// The words without side, numbers and noise, joined: `upleg`.
    pub(crate) core: String,
    /// The same for the part after the last separator, where the name has several: `head` of
    /// `torso_head`.
    pub(crate) last: String,
    /// The numbers in the name, as written.
    pub(crate) numbers: Vec<String>,
    /// Whether the name is that of an end site, a twist joint or an IK target.
    pub(crate) helper: bool,
    /// The axis of a hinge, where the name tells nothing else against a part of the body.
    pub(super) hinge: Option<Hinge>,
}

/// The axis of a hinge by which robots name their joints: `left_hip_pitch`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Hinge {
    Roll,
    Pitch,
    Yaw,
}

/// Returns whether two names differ only in the side: `LeftHandIndex1` and `RightHandIndex1`.
pub(crate) fn are_counterparts(a: &Tokens, b: &Tokens) -> bool {
    a.side.is_some()
        && a.side.map(Side::other) == b.side
        && a.core == b.core
        && a.numbers == b.numbers
        && a.helper == b.helper
}

/// Splits a name into words by separators and changes of case.
pub(crate) fn read(name: &str) -> Tokens {
    // The part before a colon is a name space.
    let name = name.rsplit(':').next().unwrap_or(name);
    let mut sides = Vec::new();
    let (mut core, mut last) = (String::new(), String::new());
    let (mut numbers, mut helper, mut rolls, mut hinge) = (Vec::new(), false, false, None);
    for part in name.split(|c: char| !c.is_alphanumeric()).filter(|part| !part.is_empty()) {
        let mut of_part = String::new();
        for run in split_by_case(part) {
            if run.starts_with(|c: char| c.is_ascii_digit()) {
                numbers.push(run);
                continue;
            }
            for word in words(&run) {
                match word.as_str() {
                    "l" | "left" => sides.push(Side::Left),
                    "r" | "right" => sides.push(Side::Right),
                    "roll" => {
                        rolls = true;
                        hinge = Some(Hinge::Roll);
                    }
                    w if HELPERS.contains(&w) => helper = true,
                    w if NOISE.contains(&w) => {}
                    w => {
                        match w {
                            "pitch" => hinge = Some(Hinge::Pitch),
                            "yaw" => hinge = Some(Hinge::Yaw),
                            _ => {}
                        }
                        of_part.push_str(w);
                    }
                }
            }
        }
        core.push_str(&of_part);
        if !of_part.is_empty() {
            last = of_part;
        }
    }
    let side = sides.first().copied().filter(|first| sides.iter().all(|s| s == first));
    let hinge = hinge.filter(|_| !helper);
    // A bone that rolls carries a share of a limb's twist, unless it is one of a robot's hinges.
    let helper = helper || rolls;
    Tokens { side, core, last, numbers, helper, hinge }
}

/// Splits `LeftUpLeg1` into `left`, `up`, `leg`, `1`, and `LHipJoint` into `l`, `hip`, `joint`.
fn split_by_case(part: &str) -> Vec<String> {
    let chars: Vec<char> = part.chars().collect();
    let mut runs: Vec<String> = Vec::new();
    for (i, &c) in chars.iter().enumerate() {
        let starts = i.checked_sub(1).and_then(|p| chars.get(p)).is_none_or(|&before| {
            c.is_ascii_digit() != before.is_ascii_digit()
                || (c.is_uppercase()
                    && (before.is_lowercase()
                        || chars.get(i + 1).is_some_and(|after| after.is_lowercase())))
        });
        if starts {
            runs.push(String::new());
        }
        if let Some(run) = runs.last_mut() {
            run.extend(c.to_lowercase());
        }
    }
    runs
}

/// Splits a lower-case run into known words, after a leading `l` or `r` if necessary; a run that
/// does not consist of known words stays whole.
fn words(run: &str) -> Vec<String> {
    if let Some(split) = known_words(run) {
        return split;
    }
    if matches!(run.as_bytes().first(), Some(b'l' | b'r'))
        && let Some(mut split) = known_words(&run[1..])
    {
        split.insert(0, run[..1].to_owned());
        return split;
    }
    vec![run.to_owned()]
}

/// Returns the split into the fewest known words. The table has the length of the name, so very
/// long names are not split.
fn known_words(run: &str) -> Option<Vec<String>> {
    if run.is_empty() || run.len() > 64 || !run.is_ascii() {
        return None;
    }
    if WORDS.contains(&run) {
        return Some(vec![run.to_owned()]);
    }
    // best[i]: the last word of the shortest split of run[..i], and how many words it has.
    let mut best: Vec<Option<(usize, usize)>> = vec![None; run.len() + 1];
    best[0] = Some((0, 0));
    for end in 1..=run.len() {
        for word in WORDS.iter().filter(|word| word.len() <= end) {
            if let Some((_, count)) = best[end - word.len()]
                && best[end].is_none_or(|(_, c)| count + 1 < c)
                && run[..end].ends_with(word)
            {
                best[end] = Some((word.len(), count + 1));
            }
        }
    }
    let mut split = Vec::new();
    let mut end = run.len();
    while end > 0 {
        let (length, _) = best[end]?;
        split.push(run[end - length..end].to_owned());
        end -= length;
    }
    split.reverse();
    Some(split)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_joints_split_into_words() {
        for (name, side, core) in [
            ("LeftUpLeg", Some(Side::Left), "upleg"),
            ("leftupleg", Some(Side::Left), "upleg"),
            ("mixamorig:RightForeArm", Some(Side::Right), "forearm"),
            ("Bip01 L Thigh", Some(Side::Left), "thigh"),
            ("UpperLeg_R", Some(Side::Right), "upperleg"),
            ("upper_arm.L", Some(Side::Left), "upperarm"),
            ("lfemur", Some(Side::Left), "femur"),
            ("rradius", Some(Side::Right), "radius"),
            ("radius", None, "radius"),
            ("lowerback", None, "lowerback"),
            ("root", None, "root"),
            ("LHipJoint", Some(Side::Left), "hip"),
            ("LFArm", Some(Side::Left), "farm"),
            ("RUArm", Some(Side::Right), "uarm"),
            ("lToeJoint", Some(Side::Left), "toe"),
            ("LeftRight", None, ""),
            ("Hüfte", None, "hüfte"),
            ("", None, ""),
        ] {
            let read = read(name);
            assert_eq!((read.side, read.core.as_str()), (side, core), "{name}");
        }
    }

    #[test]
    fn names_of_end_sites_are_helpers_and_keep_numbers() {
        assert!(read("LeftToeBase_End").helper);
        assert!(read("Bip01 HeadNub").helper);
        assert!(read("LeftForeArmTwist").helper);
        assert!(!read("LeftToeBase").helper);
        assert_eq!(read("Bip01 L Finger02").numbers, ["01", "02"]);
        assert_eq!(read("lowerback_torso").last, "torso");
    }
}
