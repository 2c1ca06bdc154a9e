//! The number of legs on which a body stands, by its shape.

use super::{Roles, is_below};
use crate::skeleton::{BodyPlan, Foot, FootPair, Role, Skeleton, WorldPose, rests_on_two_legs};
use glam::Vec3;
use std::ops::Range;

/// The least distance from hip joints to shoulder joints, as a share of the length of thigh and
/// shin. People have 0.6, cats, dogs and horses 1.1 to 1.8.
const MIN_TRUNK: f32 = 0.8;
/// The greatest sine of the slope of a level trunk (37°).
const MAX_SLOPE: f32 = 0.6;
/// The least cosine of the angle of a leg, from its first joint to its foot, to the vertical.
const MIN_DOWN: f32 = 0.6;
/// The greatest distance of the level of the forefeet from that of the hind feet, as a share of the
/// height of the trunk above them: at rest, and in a pose, which may be one of a gallop.
const MAX_STEP: f32 = 0.3;
const MAX_STEP_IN_MOTION: f32 = 0.7;
/// The least share of the poses that have to stand on four legs.
const MIN_SHARE: f32 = 0.5;
/// The same where no pose stands on two: dogs sit, lie and gallop for most of some captures.
const MIN_SHARE_WITHOUT_TWO: f32 = 0.1;
/// The least sine of the slope of an upright trunk (53°).
const MIN_UPRIGHT: f32 = 0.8;

/// Returns the body plan that the rest pose shows.
pub(super) fn at_rest(skeleton: &Skeleton, roles: &Roles) -> BodyPlan {
    if stands_at_rest(skeleton, roles) { BodyPlan::Quadruped } else { BodyPlan::Biped }
}

/// Returns whether the rest pose stands on four legs, those of these roles.
pub(super) fn stands_at_rest(skeleton: &Skeleton, roles: &Roles) -> bool {
    FourLegs::of(skeleton, roles)
        .is_some_and(|legs| legs.stand_in(&skeleton.rest_positions(), MAX_STEP))
}

/// Returns the body plan that the rest pose shows, or, where that does not stand, the poses.
pub(super) fn of(
    skeleton: &Skeleton,
    roles: &Roles,
    poses: impl IntoIterator<Item = WorldPose>,
) -> BodyPlan {
    let Some(legs) = FourLegs::of(skeleton, roles) else { return BodyPlan::Biped };
    if legs.stand_in(&skeleton.rest_positions(), MAX_STEP) {
        return BodyPlan::Quadruped;
    }
    if rests_on_two_legs(skeleton, roles) {
        return BodyPlan::Biped;
    }
    let (mut on_four, mut on_two, mut all) = (0_usize, 0_usize, 0_usize);
    for pose in poses {
        on_four += usize::from(legs.stand_in(&pose.positions, MAX_STEP_IN_MOTION));
        on_two += usize::from(legs.stand_upright_in(&pose.positions));
        all += 1;
    }
    let least = if on_two == 0 { MIN_SHARE_WITHOUT_TWO } else { MIN_SHARE };
    let is_enough = all > 0 && on_four as f32 >= least * all as f32;
    if is_enough { BodyPlan::Quadruped } else { BodyPlan::Biped }
}

/// The legs that a body on four legs would have.
struct FourLegs {
    /// The joints at the beginning and the end of each leg, by [`Foot::index`].
    legs: [(usize, usize); 4],
    /// The joints of each foot: the end of the leg and everything below it.
    feet: [Vec<usize>; 4],
    /// The length of thigh and shin, metres.
    length_m: f32,
}

impl FourLegs {
    /// Returns the legs of a body whose trunk may be long enough; `None` where it is too short, or
    /// where roles are missing.
    fn of(skeleton: &Skeleton, roles: &Roles) -> Option<Self> {
        let joint = |role| roles.get_within(role, skeleton.len());
        let leg = |foot: Foot| {
            let [first, _, last] = foot.leg();
            Some((joint(first)?, joint(last)?))
        };
        let [Some(a), Some(b), Some(c), Some(d)] = Foot::ALL.map(leg) else { return None };
        let legs = [a, b, c, d];
        let length_m = roles.leg_length(skeleton)?;
        if longest_trunk_m(skeleton, a.0, c.0) < MIN_TRUNK * length_m {
            return None;
        }
        let feet = legs.map(|(_, end)| {
            let below =
                (end..skeleton.len()).filter(|&of| of == end || is_below(skeleton, of, end));
            below.collect()
        });
        Some(Self { legs, feet, length_m })
    }

    /// Returns the middle of the hip joints and that of the shoulder joints.
    fn trunk(&self, positions: &[Vec3]) -> [Vec3; 2] {
        let at = |joint: usize| positions.get(joint).copied().unwrap_or_default();
        let [a, b, c, d] = self.legs.map(|(start, _)| at(start));
        [(a + b) * 0.5, (c + d) * 0.5]
    }

    /// Returns whether these of the legs, by [`Foot::index`], point down.
    fn point_down(&self, legs: Range<usize>, positions: &[Vec3]) -> bool {
        let at = |joint: usize| positions.get(joint).copied().unwrap_or_default();
        self.legs[legs]
            .iter()
            .all(|&(start, end)| (at(start) - at(end)).normalize_or_zero().y >= MIN_DOWN)
    }

    /// Returns whether the trunk is upright above the hind legs, as that of a person.
    fn stand_upright_in(&self, positions: &[Vec3]) -> bool {
        let [hips, shoulders] = self.trunk(positions);
        (shoulders - hips).normalize_or_zero().y >= MIN_UPRIGHT && self.point_down(0..2, positions)
    }

    /// Returns whether the trunk is level and long, and all legs point down from it to one level,
    /// which may differ by `max_step` (see [`MAX_STEP`]).
    fn stand_in(&self, positions: &[Vec3], max_step: f32) -> bool {
        let at = |joint: usize| positions.get(joint).copied().unwrap_or_default();
        let [hips, shoulders] = self.trunk(positions);
        let trunk = shoulders - hips;
        let is_level = trunk.length() >= MIN_TRUNK * self.length_m
            && trunk.y.abs() <= MAX_SLOPE * trunk.length();
        let all_down = self.point_down(0..4, positions);
        let level = |pair: [usize; 2]| {
            let lowest = |foot: usize| {
                self.feet[foot].iter().map(|&joint| at(joint).y).fold(f32::INFINITY, f32::min)
            };
            lowest(pair[0]).min(lowest(pair[1]))
        };
        let (hind, fore) = (level([0, 1]), level([2, 3]));
        let height = (hips.y + shoulders.y - hind - fore) * 0.5;
        is_level && all_down && height > 0.0 && (hind - fore).abs() <= max_step * height
    }
}

/// Returns a length that the trunk does not exceed in any pose, metres: that of the bones between
/// a hip joint and the shoulder joint of the same side.
fn longest_trunk_m(skeleton: &Skeleton, thigh: usize, arm: usize) -> f32 {
    let up = |from: usize| std::iter::successors(Some(from), |&at| skeleton.parent(at));
    let Some(meeting) = up(arm).find(|&joint| up(thigh).any(|other| other == joint)) else {
        return 0.0;
    };
    let bones = |from: usize| up(from).take_while(move |&joint| joint != meeting);
    bones(thigh).chain(bones(arm)).map(|joint| skeleton.joints()[joint].offset.length()).sum()
}

/// Returns the points of a foot that can touch the ground: of a hind foot ankle, ball and tip, of a
/// forefoot the end of the leg, the next joint and the tip; each as a joint and a point in its
/// frame (metres), `None` where the skeleton has no such point.
pub(super) fn points_of(
    skeleton: &Skeleton,
    roles: &Roles,
    foot: Foot,
) -> [Option<(usize, Vec3)>; 3] {
    let joint = |role| roles.get_within(role, skeleton.len());
    let [_, _, end] = foot.leg();
    let ankle = joint(end);
    let toe = match foot.pair {
        FootPair::Hind => joint(Role::toe(foot.side)),
        FootPair::Fore => None,
    };
    let origin = |joint: Option<usize>| joint.map(|joint| (joint, Vec3::ZERO));
    if !roles.is_quadruped() {
        // The tip of a foot without toes is its own end site.
        let tip = toe.or(ankle).and_then(|last| Some((last, skeleton.joints()[last].end_site?)));
        return [origin(ankle), origin(toe), tip];
    }
    let ball = toe.or_else(|| longest_child(skeleton, ankle?));
    let Some(mut last) = ball.or(ankle) else { return [None; 3] };
    while let Some(next) = longest_child(skeleton, last) {
        last = next;
    }
    let tip = match skeleton.joints()[last].end_site {
        Some(end) => Some((last, end)),
        None => origin(Some(last)).filter(|_| Some(last) != ball && Some(last) != ankle),
    };
    [origin(ankle), origin(ball), tip]
}

/// Returns the child with the longest chain of bones below it, the first of equal ones.
fn longest_child(skeleton: &Skeleton, joint: usize) -> Option<usize> {
    let mut best: Option<(f32, usize)> = None;
    for child in skeleton.children(joint) {
        let mut longest = 0.0_f32;
        let mut left = vec![(child, skeleton.joints()[child].offset.length())];
        while let Some((at, along)) = left.pop() {
            let end = skeleton.joints()[at].end_site.map_or(0.0, Vec3::length);
            longest = longest.max(along + end);
            let below = skeleton.children(at);
            left.extend(below.map(|next| (next, along + skeleton.joints()[next].offset.length())));
        }
        if best.is_none_or(|(known, _)| longest > known) {
            best = Some((longest, child));
        }
    }
    best.map(|(_, child)| child)
}
