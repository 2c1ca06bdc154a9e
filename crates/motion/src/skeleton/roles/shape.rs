//! Roles by the shape of a skeleton at rest.

use super::{RoleSource, Roles, is_below, plan};
use crate::math::sort::sort_by;
use crate::skeleton::{Role, Side, Skeleton};
use glam::Vec3;

/// A bone belongs to the two main bones of a limb when it has at least this share of the limb's
/// longest bone; clavicles often do, feet and hands do not.
const LONG: f32 = 0.55;
/// The hips lie above the feet by at least this share of the skeleton's height.
const MIN_LEG: f32 = 0.25;
/// The feet end within this share of the skeleton's height above the lowest one.
const MAX_FOOT: f32 = 0.12;
/// The greatest number of feet of a body whose limbs are taken for those of a person.
const MAX_FEET: usize = 4;
/// The hands reach to either side by at least this share of the skeleton's height.
const MIN_REACH: f32 = 0.05;

/// Finds roles by the tree and the rest positions alone: the two lowest chains are legs, the two
/// that reach farthest sideways above them are arms, and the highest one between is the head. Of
/// four chains that reach the ground, the pair nearer to the head are the forelegs. +Y must be up
/// at rest.
pub(super) fn detect(skeleton: &Skeleton) -> Roles {
    let mut roles = Roles::default();
    let shape = Shape::of(skeleton);
    let on_four = shape.four_legs().map(|legs| shape.quadruped(&legs));
    if let Some(roles) = on_four.filter(|roles| plan::stands_at_rest(skeleton, roles)) {
        return roles;
    }
    let Some((hips, legs)) = shape.legs() else {
        return roles;
    };
    roles.assign(Role::Hips, Some(hips), RoleSource::ByShape);
    let legs: Vec<Leg> = legs.into_iter().map(|tip| shape.leg(hips, tip)).collect();
    let [Some(a), Some(b)] = [legs[0].thigh, legs[1].thigh] else {
        return roles;
    };
    // Left × up = forward, so left = up × forward.
    let forward = legs.iter().filter_map(|leg| leg.forward).sum::<Vec3>();
    let forward = if forward.length() > 0.01 * shape.height { forward } else { Vec3::Z };
    let left = Vec3::Y.cross(forward).normalize_or(Vec3::X);
    let side_of = |of: Vec3, other: Vec3| {
        if (of - other).dot(left) > 0.0 { Side::Left } else { Side::Right }
    };
    let first = side_of(shape.rest[a], shape.rest[b]);
    for (leg, side) in legs.iter().zip([first, first.other()]) {
        for (role, joint) in
            Role::leg(side).into_iter().zip([leg.thigh, leg.shin, leg.foot, leg.toe])
        {
            roles.assign(role, joint, RoleSource::ByShape);
        }
    }
    let body: Vec<usize> = legs.iter().filter_map(|leg| leg.thigh).collect();
    let above: Vec<usize> = (shape.leaves.iter().copied())
        .filter(|&leaf| {
            is_below(skeleton, leaf, hips)
                && !body.iter().any(|&thigh| leaf == thigh || is_below(skeleton, leaf, thigh))
        })
        .collect();
    let chest = shape.arms(&above, left, hips, &mut roles);
    shape.back_and_head(&above, hips, chest, &mut roles);
    roles
}

/// The legs of a body on four: where each pair meets, a leaf of each leg, and the leaves of the
/// neck and the head.
struct FourLegs {
    hips: usize,
    chest: usize,
    hind: [usize; 2],
    fore: [usize; 2],
    neck: Vec<usize>,
}

#[derive(Default)]
struct Leg {
    thigh: Option<usize>,
    shin: Option<usize>,
    foot: Option<usize>,
    toe: Option<usize>,
    /// Horizontal vector from the ankle to the tip of the toes, metres.
    forward: Option<Vec3>,
}

struct Shape<'a> {
    skeleton: &'a Skeleton,
    rest: Vec<Vec3>,
    /// Joints without children.
    leaves: Vec<usize>,
    height: f32,
}

impl<'a> Shape<'a> {
    fn of(skeleton: &'a Skeleton) -> Self {
        let rest = skeleton.rest_positions();
        let mut has_child = vec![false; skeleton.len()];
        for parent in skeleton.joints().iter().filter_map(|j| j.parent) {
            has_child[parent] = true;
        }
        let leaves: Vec<usize> = (0..skeleton.len()).filter(|&joint| !has_child[joint]).collect();
        let mut shape = Self { skeleton, rest, leaves, height: 0.0 };
        let heights = || (0..skeleton.len()).map(|joint| shape.tip(joint).y);
        shape.height = heights().fold(f32::MIN, f32::max) - heights().fold(f32::MAX, f32::min);
        shape
    }

    /// Returns the end site of a leaf, or its own position.
    fn tip(&self, joint: usize) -> Vec3 {
        self.rest[joint] + self.skeleton.joints()[joint].end_site.unwrap_or(Vec3::ZERO)
    }

    /// Returns the joints from below `top` down to `bottom`.
    fn path(&self, top: usize, bottom: usize) -> Vec<usize> {
        let mut path: Vec<usize> =
            std::iter::successors(Some(bottom), |&j| self.skeleton.parent(j))
                .take_while(|&joint| joint != top)
                .collect();
        path.reverse();
        path
    }

    /// Returns the lowest joint that is above both, or is one of them.
    fn meeting(&self, a: usize, b: usize) -> usize {
        let (mut a, mut b) = (a, b);
        // Parents have smaller indices, so the larger of the two is never above the other one.
        while a != b {
            let higher = self.skeleton.parent(a.max(b)).unwrap_or(0);
            (a, b) = (a.min(b), higher);
        }
        a
    }

    /// Returns the joint at which the legs meet, and a leaf of either leg.
    fn legs(&self) -> Option<(usize, [usize; 2])> {
        let by_height = self.by_height();
        let &first = by_height.first()?;
        by_height
            .iter()
            .skip(1)
            .find_map(|&second| {
                let meeting = self.meeting(first, second);
                let lower = self.tip(first).y.max(self.tip(second).y);
                (self.rest[meeting].y - lower > MIN_LEG * self.height)
                    .then_some((meeting, [first, second]))
            })
            .filter(|_| self.feet(&by_height).len() <= MAX_FEET)
    }

    /// Returns the leaves, the lowest first.
    fn by_height(&self) -> Vec<usize> {
        let mut by_height = self.leaves.clone();
        sort_by(&mut by_height, |&a, &b| self.tip(a).y.total_cmp(&self.tip(b).y));
        by_height
    }

    /// Returns the legs of a body that stands on four, whose hind legs meet at another joint than
    /// its forelegs.
    fn four_legs(&self) -> Option<FourLegs> {
        let &[a, b, c, d] = self.feet(&self.by_height()).as_slice() else { return None };
        // Legs of one pair meet farther from the root than legs of both.
        let pairs = [([a, b], [c, d]), ([a, c], [b, d]), ([a, d], [b, c])];
        let meetings = pairs.map(|(one, other)| {
            let meet = |[left, right]: [usize; 2]| self.meeting(left, right);
            (meet(one), meet(other))
        });
        let deepest = |index: &usize| {
            let (one, other) = meetings[*index];
            [one, other].map(|joint| self.path(0, joint).len()).into_iter().max()
        };
        let index = (0..pairs.len()).max_by_key(deepest)?;
        let ((one, other), (at_one, at_other)) = (pairs[index], meetings[index]);
        if at_one == at_other {
            return None;
        }
        let tops = [a, b, c, d].map(|foot| {
            let at = if one.contains(&foot) { at_one } else { at_other };
            self.path(at, foot).first().copied().unwrap_or(foot)
        });
        let in_leg =
            |leaf: usize| tops.iter().any(|&top| leaf == top || is_below(self.skeleton, leaf, top));
        let is_tail =
            |leaf: usize| self.skeleton.joints()[leaf].name.to_ascii_lowercase().contains("tail");
        let free = || self.leaves.iter().copied().filter(|&leaf| !in_leg(leaf) && !is_tail(leaf));
        let head = free().max_by(|&x, &y| self.tip(x).y.total_cmp(&self.tip(y).y))?;
        // The head follows one of the joints at which legs meet: the one farther from the root.
        let (deep, high) = if is_below(self.skeleton, at_one, at_other) {
            ((at_one, one), (at_other, other))
        } else {
            ((at_other, other), (at_one, one))
        };
        let ((hips, hind), (chest, fore)) =
            if is_below(self.skeleton, head, deep.0) { (high, deep) } else { (deep, high) };
        let neck = free().filter(|&leaf| is_below(self.skeleton, leaf, chest)).collect();
        Some(FourLegs { hips, chest, hind, fore, neck })
    }

    /// Returns the roles of a body on four legs. Its left follows from the way from its hind legs
    /// to its forelegs.
    fn quadruped(&self, legs: &FourLegs) -> Roles {
        let mut roles = Roles::default();
        let limbs = |top: usize, tips: [usize; 2]| tips.map(|tip| self.leg(top, tip));
        let (hind, fore) = (limbs(legs.hips, legs.hind), limbs(legs.chest, legs.fore));
        let at = |leg: &Leg| leg.thigh.map(|joint| self.rest[joint]);
        let [Some(a), Some(b), Some(c), Some(d)] = [&hind[0], &hind[1], &fore[0], &fore[1]].map(at)
        else {
            return roles;
        };
        let left = Vec3::Y.cross(c + d - a - b);
        roles.assign(Role::Hips, Some(legs.hips), RoleSource::ByShape);
        let sides = |one: Vec3, other: Vec3| {
            let first = if (one - other).dot(left) > 0.0 { Side::Left } else { Side::Right };
            [first, first.other()]
        };
        for (leg, side) in hind.iter().zip(sides(a, b)) {
            let joints = [leg.thigh, leg.shin, leg.foot, leg.toe];
            for (role, joint) in Role::leg(side).into_iter().zip(joints) {
                roles.assign(role, joint, RoleSource::ByShape);
            }
        }
        for (leg, side) in fore.iter().zip(sides(c, d)) {
            for (role, joint) in Role::arm(side).into_iter().zip([leg.thigh, leg.shin, leg.foot]) {
                roles.assign(role, joint, RoleSource::ByShape);
            }
        }
        if is_below(self.skeleton, legs.chest, legs.hips) {
            self.back_and_head(&legs.neck, legs.hips, Some(legs.chest), &mut roles);
        }
        roles
    }

    /// Returns a leaf of each chain that reaches the ground, where these meet at the height of
    /// hips; the leaves are sorted by height.
    fn feet(&self, leaves: &[usize]) -> Vec<usize> {
        let lowest = leaves.first().map_or(0.0, |&leaf| self.tip(leaf).y);
        let mut feet: Vec<usize> = Vec::new();
        for &leaf in leaves {
            if self.tip(leaf).y - lowest > MAX_FOOT * self.height || feet.len() > MAX_FEET {
                break;
            }
            let is_apart = |&foot: &usize| {
                self.rest[self.meeting(leaf, foot)].y - lowest > MIN_LEG * self.height
            };
            if feet.iter().all(is_apart) {
                feet.push(leaf);
            }
        }
        feet
    }

    /// Returns the last two long bones of a limb on the path from `top` to the leaf `tip`: (upper,
    /// lower, the joint at the lower one's end).
    fn limb(&self, top: usize, tip: usize) -> Option<(usize, usize, Option<usize>)> {
        // Joints at one position (bones without length) count as one. The last of them rotates the
        // bone that starts there, and the first one is the parent of everything at the end of the
        // bone before.
        let mut places: Vec<(usize, usize)> = Vec::new();
        for joint in self.path(top, tip) {
            match places.last_mut() {
                Some((_, last))
                    if self.rest[*last].distance(self.rest[joint]) < 1e-4 * self.height =>
                {
                    *last = joint;
                }
                _ => places.push((joint, joint)),
            }
        }
        let bone = |i: usize| match places.get(i + 1) {
            Some(&(next, _)) => self.rest[places[i].1].distance(self.rest[next]),
            None => self.rest[places[i].1].distance(self.tip(places[i].1)),
        };
        let longest = (0..places.len()).map(bone).fold(0.0, f32::max);
        let mut long =
            (0..places.len()).rev().filter(|&i| bone(i) > 0.0 && bone(i) >= LONG * longest);
        let (lower, upper) = (long.next()?, long.next()?);
        Some((places[upper].1, places[lower].1, places.get(lower + 1).map(|&(first, _)| first)))
    }

    fn leg(&self, hips: usize, tip: usize) -> Leg {
        let Some((thigh, shin, foot)) = self.limb(hips, tip) else {
            return Leg::default();
        };
        let Some(ankle) = foot else {
            return Leg { thigh: Some(thigh), shin: Some(shin), ..Leg::default() };
        };
        let over_ground =
            |leaf: usize| (self.tip(leaf) - self.rest[ankle]) * Vec3::new(1.0, 0.0, 1.0);
        // A heel may be the lowest point; the toes are the point farthest from the ankle.
        let leaves = self
            .leaves
            .iter()
            .copied()
            .filter(|&leaf| leaf == ankle || is_below(self.skeleton, leaf, ankle));
        let farthest =
            leaves.max_by(|&a, &b| over_ground(a).length().total_cmp(&over_ground(b).length()));
        let toe = farthest.and_then(|leaf| self.path(ankle, leaf).first().copied());
        Leg {
            thigh: Some(thigh),
            shin: Some(shin),
            foot: Some(ankle),
            toe: toe.filter(|&t| t != ankle),
            forward: farthest.map(over_ground),
        }
    }

    /// Assigns the arms and returns the joint where they meet.
    fn arms(&self, leaves: &[usize], left: Vec3, hips: usize, roles: &mut Roles) -> Option<usize> {
        let middle = self.rest[hips].dot(left);
        let reach = |leaf: usize| self.tip(leaf).dot(left) - middle;
        let by_reach = |a: &&usize, b: &&usize| reach(**a).total_cmp(&reach(**b));
        let (&right, &left) = (leaves.iter().min_by(by_reach)?, leaves.iter().max_by(by_reach)?);
        if reach(left) < MIN_REACH * self.height || reach(right) > -MIN_REACH * self.height {
            return None;
        }
        let chest = self.meeting(left, right);
        for (side, leaf) in [(Side::Left, left), (Side::Right, right)] {
            let (upper, fore, hand) = self.limb(chest, leaf)?;
            for (role, joint) in Role::arm(side).into_iter().zip([Some(upper), Some(fore), hand]) {
                roles.assign(role, joint, RoleSource::ByShape);
            }
        }
        Some(chest)
    }

    fn back_and_head(
        &self,
        leaves: &[usize],
        hips: usize,
        chest: Option<usize>,
        roles: &mut Roles,
    ) {
        let arms: Vec<usize> =
            Side::BOTH.into_iter().filter_map(|side| roles.get(Role::upper_arm(side))).collect();
        let in_arm =
            |leaf: usize| arms.iter().any(|&arm| leaf == arm || is_below(self.skeleton, leaf, arm));
        let highest = (leaves.iter().copied())
            .filter(|&leaf| !in_arm(leaf))
            .max_by(|&a, &b| self.tip(a).y.total_cmp(&self.tip(b).y));
        let Some(highest) = highest.filter(|&leaf| self.tip(leaf).y > self.rest[hips].y) else {
            return;
        };
        // A leaf without a bone of its own marks the end of the head, and one of several leaves is
        // an eye or an ear.
        let marks_the_end = self.skeleton.joints()[highest]
            .end_site
            .is_none_or(|end| end.length() < 1e-4 * self.height);
        let has_brothers = self
            .skeleton
            .parent(highest)
            .is_some_and(|parent| self.skeleton.children(parent).count() > 1);
        let head = if marks_the_end || has_brothers {
            self.skeleton.parent(highest)
        } else {
            Some(highest)
        };
        let head = head
            .filter(|&head| Some(head) != chest && is_below(self.skeleton, head, hips))
            .unwrap_or(highest);
        roles.assign(Role::Head, Some(head), RoleSource::ByShape);
        let spine = self.path(hips, chest.unwrap_or(head)).first().copied();
        roles.assign(Role::Spine, spine.filter(|&spine| spine != head), RoleSource::ByShape);
    }
}
