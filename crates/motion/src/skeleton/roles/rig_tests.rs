//! Tests of role detection by the joint names of rigs in use.

use super::*;
use crate::skeleton::{Joint, fixtures};

/// A rig of the listing.
struct Rig {
    title: &'static str,
    skeleton: Skeleton,
    /// The name of the joint of each role.
    wanted: BTreeMap<Role, String>,
}

/// Returns the rigs of the listing. Joints are in the order of the lines, those of both sides side
/// by side; a rest pose is not given, so that names alone count.
fn rigs() -> Vec<Rig> {
    let mut rigs: Vec<(&str, [&str; 2], Vec<&str>)> = Vec::new();
    for line in include_str!("rigs.txt").lines() {
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        match line.rsplit_once(": ") {
            Some((title, sides)) if !line.starts_with(' ') && !line.contains('=') => {
                let (left, right) = sides.split_once(' ').unwrap();
                rigs.push((title, [left, right], Vec::new()));
            }
            _ => rigs.last_mut().unwrap().2.push(line),
        }
    }
    rigs.into_iter().map(|(title, sides, lines)| rig(title, sides, &lines)).collect()
}

fn rig(title: &'static str, sides: [&str; 2], lines: &[&str]) -> Rig {
    let mut joints: Vec<Joint> = Vec::new();
    let mut wanted = BTreeMap::new();
    // The last joint at each depth, on the left and on the right.
    let mut above: [Vec<usize>; 2] = [Vec::new(), Vec::new()];
    for line in lines {
        let depth = line.len() - line.trim_start().len();
        let (name, role) = match line.trim().split_once(" = ") {
            Some((name, role)) => (name, Some(role)),
            None => (line.trim(), None),
        };
        let is_sided = name.contains('*');
        for side in Side::BOTH {
            let above = &mut above[side.index()];
            above.truncate(depth);
            assert_eq!(above.len(), depth, "{title}: {line}");
            if is_sided || side == Side::Left {
                let name = name.replace('*', sides[side.index()]);
                if let Some(role) = role {
                    let role = role_of_words(role, is_sided.then_some(side));
                    assert_eq!(wanted.insert(role, name.clone()), None, "{title}: {line}");
                }
                let parent = above.last().copied();
                joints.push(Joint {
                    name,
                    parent,
                    offset: Vec3::ZERO,
                    end_site: None,
                    channels: vec![],
                });
            }
            above.push(joints.len() - 1);
        }
    }
    Rig { title, skeleton: Skeleton::new(joints).unwrap(), wanted }
}

fn role_of_words(words: &str, side: Option<Side>) -> Role {
    let name = match side {
        Some(Side::Left) => format!("left {words}"),
        Some(Side::Right) => format!("right {words}"),
        None => words.to_owned(),
    };
    Role::ALL.into_iter().find(|role| role.name() == name).unwrap()
}

/// Returns the names of the joints that have roles.
fn found(skeleton: &Skeleton, roles: &Roles) -> BTreeMap<Role, String> {
    let name = |role| Some((role, skeleton.joints()[roles.get(role)?].name.clone()));
    Role::ALL.into_iter().filter_map(name).collect()
}

#[test]
fn rigs_in_use_have_their_roles_by_name() {
    let rigs = rigs();
    assert!(rigs.len() > 30);
    let mut wrong = Vec::new();
    for Rig { title, skeleton, wanted } in &rigs {
        assert!(wanted.len() >= 14, "{title}");
        let found = found(skeleton, &Roles::by_name(skeleton));
        for role in Role::ALL {
            let [found, wanted] = [&found, wanted].map(|map| map.get(&role));
            if found != wanted {
                wrong.push(format!("{title}: {role:?} is {found:?}, not {wanted:?}"));
            }
        }
    }
    assert_eq!(wrong, Vec::<String>::new(), "{}", wrong.join("\n"));
}

#[test]
fn rigs_in_use_in_another_order_have_the_same_roles() {
    for Rig { title, skeleton, wanted } in rigs() {
        for seed in 0..4 {
            let (other, _) = fixtures::shuffled(&skeleton, seed);
            assert_eq!(found(&other, &Roles::detect(&other)), wanted, "{title}, seed {seed}");
        }
    }
}

/// Returns the tree of SMPL with names made of numbers.
fn numbered(rigs: &[Rig], name: impl Fn(usize) -> String) -> (Skeleton, BTreeMap<Role, String>) {
    let smpl = rigs.iter().find(|rig| rig.title == "SMPL").unwrap();
    let order = "Pelvis L_Hip R_Hip Spine1 L_Knee R_Knee Spine2 L_Ankle R_Ankle Spine3 L_Foot R_Foot \
        Neck L_Collar R_Collar Head L_Shoulder R_Shoulder L_Elbow R_Elbow L_Wrist R_Wrist L_Hand \
        R_Hand";
    let order: Vec<&str> = order.split_whitespace().collect();
    let renamed = |own: &str| name(order.iter().position(|&known| known == own).unwrap());
    let joints = smpl.skeleton.joints().iter();
    let joints = joints.map(|joint| Joint { name: renamed(&joint.name), ..joint.clone() });
    let wanted = smpl.wanted.iter().map(|(&role, own)| (role, renamed(own)));
    (Skeleton::new(joints.collect()).unwrap(), wanted.collect())
}

#[test]
fn smpl_by_numbers_has_its_roles() {
    let rigs = rigs();
    let names: [fn(usize) -> String; 4] = [
        |number| number.to_string(),
        |number| format!("joint_{number}"),
        |number| format!("J{number:02}"),
        |number| format!("smpl {number}"),
    ];
    for name in names {
        let (skeleton, wanted) = numbered(&rigs, name);
        let roles = Roles::by_name(&skeleton);
        assert_eq!(found(&skeleton, &roles), wanted);
        assert_eq!(roles.source(Role::LeftHand), Some(RoleSource::ByName));
    }
    // Other numbers, or another tree, say nothing.
    let names: [fn(usize) -> String; 2] =
        [|number| (number + 1).to_string(), |number| (number / 2).to_string()];
    for name in names {
        assert_eq!(Roles::by_name(&numbered(&rigs, name).0).count(), 0);
    }
    for (number, parent) in [(4, 2), (20, 19)] {
        let (skeleton, _) = numbered(&rigs, |number| number.to_string());
        let named = |number: usize| {
            skeleton.joints().iter().position(|joint| joint.name == number.to_string())
        };
        let (joint, parent) = (named(number), named(parent));
        let mut joints = skeleton.joints().to_vec();
        joints[joint.unwrap()].parent = parent;
        if let Ok(other) = Skeleton::new(joints) {
            assert_eq!(Roles::by_name(&other).count(), 0, "{number}");
        }
    }
}
