//! Roles of skeletons whose joints are named by their numbers in SMPL.

use super::tokens::{self, Tokens};
use super::{RoleSource, Roles};
use crate::skeleton::{Role, Side, Skeleton};

/// The parents of the joints of SMPL's body (`kintree_table` of its model): in most places, left,
/// right and middle in turn.
const PARENTS: [Option<usize>; 22] = [
    None,
    Some(0),
    Some(0),
    Some(0),
    Some(1),
    Some(2),
    Some(3),
    Some(4),
    Some(5),
    Some(6),
    Some(7),
    Some(8),
    Some(9),
    Some(9),
    Some(9),
    Some(12),
    Some(13),
    Some(14),
    Some(16),
    Some(17),
    Some(18),
    Some(19),
];
/// The left joints of leg and arm; the right ones are the next numbers.
const LEFT: [usize; 7] = [1, 4, 7, 10, 16, 18, 20];

/// Finds the roles of a skeleton with the tree of SMPL, SMPL-H or SMPL-X, whose joints are named by
/// their numbers alone: `0`, `joint_1`, `J02`.
pub(super) fn detect(skeleton: &Skeleton) -> Roles {
    roles_of(skeleton).unwrap_or_default()
}

fn roles_of(skeleton: &Skeleton) -> Option<Roles> {
    let names: Vec<Tokens> = skeleton.joints().iter().map(|j| tokens::read(&j.name)).collect();
    let word = &names.first()?.core;
    let mut joint_of = vec![None; names.len()];
    for (joint, name) in names.iter().enumerate() {
        let [number] = name.numbers.as_slice() else { return None };
        let place = joint_of.get_mut(number.parse::<usize>().ok()?)?;
        if place.replace(joint).is_some() || name.core != *word || name.side.is_some() {
            return None;
        }
    }
    let joint_of = |number: usize| joint_of.get(number).copied().flatten();
    for (number, parent) in PARENTS.into_iter().enumerate() {
        if skeleton.parent(joint_of(number)?) != parent.and_then(joint_of) {
            return None;
        }
    }
    let mut roles = Roles::default();
    let mut assign = |role, number| roles.assign(role, joint_of(number), RoleSource::ByName);
    for (role, number) in [(Role::Hips, 0), (Role::Spine, 3), (Role::Head, 15)] {
        assign(role, number);
    }
    for side in Side::BOTH {
        let limbs = Role::leg(side).into_iter().chain(Role::arm(side));
        for (role, left) in limbs.zip(LEFT) {
            assign(role, left + side.index());
        }
    }
    Some(roles)
}
